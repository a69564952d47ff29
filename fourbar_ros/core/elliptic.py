"""
Sample points of the input angle that resolve any 4R linkage: uniform in the elliptic parameter u.

With x = theta1 and du = dx / (a2 a3 sin mu), tan(x/2) is a Jacobi function of u: of

    (d tan(x/2) / du)^2 = (s1b + s1 tan^2(x/2)) (s2 + s2b tan^2(x/2)) / 16,

s1 = (a2+a3)^2 - (a1+a4)^2, s1b = (a2+a3)^2 - (a1-a4)^2, s2 = (a1-a4)^2 - (a2-a3)^2 and s2b = (a1+a4)^2
- (a2-a3)^2, products of the bilinear factors. All quantities of the linkage are smooth in u at one
scale: near a change point, where they change within sqrt(gap) in x, equal steps in u need only
log(1/gap) points; at a toggle, u passes from one assembly mode into the other without a root.
"""
from __future__ import annotations

from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from .factors import difference_of_squares

# At a change point itself K is infinite. There the branches are smooth in x, so the points of a
# linkage that clears the flat position by this much (of 4 a1 a4) serve.
CLEARANCE = 2.0**-6
# Points added towards a toggle and a flat position, each four times closer than the one before. The
# last are 1e-6 in u away: at a toggle 1e-12 in x, where x itself has four digits left.
END_POINTS = {False: 7, True: 3}


class End(NamedTuple):
    """End of an input path: a toggle of a rocker, or (``is_flat``) the flat position of a change point."""

    theta1: float
    is_flat: bool


class InputPath(NamedTuple):
    """
    A range of theta1 in which the linkage moves smoothly in one assembly mode.

    Parameters
    ----------
    theta1 : ndarray, shape (n,)
        Increasing [rad], inside the range.
    low, high : End or None
        None for full turns: the point after the last is the first plus 2 pi.
    first : int
        Index of the point half a step of u after ``low``; points one step apart follow. By symmetry
        the point with index -1 - first is as far from ``high``.

    """

    theta1: np.ndarray
    low: End | None
    high: End | None
    first: int

    @property
    def is_closed(self):
        """Return whether the path is a full turn."""
        return self.low is None


def jacobi(sine, cosine, m1):
    """
    Return sn, cn, dn of u at the phase pi u/(2 K), given by its sine and cosine.

    Descending Landen steps written in the complementary parameter m1 = 1 - m, with sums of positive
    terms only: nothing is lost for m1 -> 0.
    """
    modulus, steps = np.sqrt(m1), []
    while np.min(modulus) < 1.0 - 1e-12:
        steps.append(modulus)
        modulus = 2.0 * np.sqrt(modulus) / (1.0 + modulus)
    sn, cn, dn = sine, cosine, np.ones_like(sine)
    for modulus in reversed(steps):
        k = (1.0 - modulus) / (1.0 + modulus)
        scale = 1.0 / (1.0 + k * sn * sn)
        sn, cn, dn = ((1.0 + k) * sn * scale, cn * dn * scale,
                      (2.0 * modulus / (1.0 + modulus) + k * cn * cn) * scale)
    return sn, cn, dn


def input_paths(linkage, points):
    """
    Return the list of :class:`InputPath` that make up the motion of a linkage in its mode.

    ``points`` is their number over all paths together, without those added at the ends.
    """
    a1, a2, a3, a4 = (length / max(linkage.lengths) for length in linkage.lengths)
    k = 4.0 * a1 * a4
    s1, s2 = difference_of_squares(a2, a3, a1, a4), difference_of_squares(a1, -a4, a2, -a3)
    flat_in, flat_out = s2 == 0.0, s1 == 0.0       # flat position at theta1 = 0, at pi
    s1, s2 = s1 or CLEARANCE * k, s2 or CLEARANCE * k
    s1b, s2b = s1 + k, s2 + k
    p, q = abs(s1 * s2), s1b * s2b
    toggles = [End(angle, False) for bounds in linkage.input_ranges for angle in bounds]

    # Phases of the ends in order; None where the motion goes on.
    if s1 > 0.0 and s2 > 0.0:
        def angle(phase):
            sn, cn, _ = jacobi(np.sin(phase), np.cos(phase), p / q)
            return 2.0 * np.arctan2(sqrt(s2) * sn, sqrt(s2b) * cn)
        ends = [(-0.5 * pi, flat_out and End(-pi, True)), (0.0, flat_in and End(0.0, True)),
                (0.5 * pi, flat_out and End(pi, True)), (pi, flat_in and End(2.0 * pi, True))]
        ends = [end for end in ends if end[1]][:2 + (flat_in and flat_out)]
        ends = ends or [(-0.5 * pi, None), (0.5 * pi, None)]
    elif s1 < 0.0 and s2 < 0.0:
        def angle(phase):
            _, _, dn = jacobi(np.sin(phase), np.cos(phase), p / q)
            return np.copysign(2.0, -phase) * np.arctan2(sqrt(s1b) * dn, sqrt(-s1))
        far_low, near_low, near, far = toggles
        return [_path(angle, 0.0, far_low, 0.5 * pi, near_low, points // 2),
                _path(angle, -0.5 * pi, near, 0.0, far, points // 2)]
    else:
        def angle(phase):
            _, cn, _ = jacobi(np.sin(phase), np.cos(phase), p / (p + q))
            if s1 < 0.0:
                return -2.0 * np.arctan2(sqrt(s1b) * cn, sqrt(-s1))
            return 2.0 * np.arctan2(sqrt(-s2), sqrt(s2b) * cn)
        middle = flat_in and End(0.0, True) if s1 < 0.0 else flat_out and End(pi, True)
        ends = [(0.0, toggles[0]), *([(0.5 * pi, middle)] if middle else []), (pi, toggles[-1])]
    return [_path(angle, *one, *other, points // (len(ends) - 1)) for one, other in zip(ends, ends[1:])]


def _path(angle, phase_low, low, phase_high, high, points):
    """Return the path between two phases."""
    step = (phase_high - phase_low) / points
    phase = phase_low + step * (np.arange(points) + 0.5)
    if low is None:
        return InputPath(angle(phase), low, high, 0)
    before, after = (0.5 * step * 4.0**-np.arange(1.0, 1 + END_POINTS[end.is_flat])
                     for end in (low, high))
    x = angle(np.concatenate((phase_low + before[::-1], phase, phase_high - after)))
    return InputPath(x, low, high, (before.size, after.size))
