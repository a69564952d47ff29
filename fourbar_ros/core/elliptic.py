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

from math import pi
from typing import NamedTuple

import numpy as np

from .factors import difference_of_squares

# At a change point itself K is infinite. There the branches are smooth in x, so the points of a
# linkage that clears the flat position by this much (of 4 a1 a4) serve.
CLEARANCE = 2.0**-6
# Points added towards an end of a path, each four times closer than the one before.
END_POINTS = 7


class End(NamedTuple):
    """End of an input path: a toggle of a rocker, or (``is_flat``) the flat position of a change point."""

    theta1: float
    is_flat: bool


class InputPath(NamedTuple):
    """
    A range of theta1 in which the linkage moves smoothly in one assembly mode.

    theta1 : ndarray, shape (n,)
        Increasing [rad]; inside the range.
    low, high : End or None
        None, None: full turns; the point after the last is the first one plus 2 pi.
    uniform : slice
        The points which are half a step, one and a half, ... from the ends in u.
    """

    theta1: np.ndarray
    low: End | None
    high: End | None
    uniform: slice


def jacobi(sine, cosine, m1):
    """
    Return sn, cn, dn at the phases pi u/(2 K) of given sine and cosine.

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
    Return the :class:`InputPath` of each range of theta1 in one assembly mode.

    Parameters
    ----------
    linkage : FourBar
    points : int
        Number of points over all paths together, before those added at the ends.

    """
    a1, a2, a3, a4 = (length / max(linkage.lengths) for length in linkage.lengths)
    k = 4.0 * a1 * a4
    s1, s2 = difference_of_squares(a2, a3, a1, a4), difference_of_squares(a1, -a4, a2, -a3)
    flat_out, flat_in = s1 == 0.0, s2 == 0.0       # flat position at theta1 = pi, 0
    s1, s2 = s1 or CLEARANCE * k, s2 or CLEARANCE * k
    s1b, s2b = s1 + k, s2 + k

    toggles = [End(angle, False) for bounds in linkage.input_ranges for angle in bounds]
    out, inner = End(pi, True), End(0.0, True)
    if s1 > 0.0 and s2 > 0.0:
        def angle(phase):
            sn, cn, _ = jacobi(np.sin(phase), np.cos(phase), s1 * s2 / (s1b * s2b))
            return 2.0 * np.arctan2(np.sqrt(s2) * sn, np.sqrt(s2b) * cn)
        low, high = (End(-pi, True), out) if flat_out else (None, None)
        pieces = [(-0.5 * pi, low, 0.5 * pi, high)]
        if flat_in and flat_out:
            pieces = [(-0.5 * pi, low, 0.0, inner), (0.0, inner, 0.5 * pi, high)]
        elif flat_in:
            pieces = [(0.0, inner, pi, End(2.0 * pi, True))]
    elif s2 > 0.0:
        def angle(phase):
            _, cn, _ = jacobi(np.sin(phase), np.cos(phase), -s1 * s2 / (-s1 * s2 + s1b * s2b))
            return -2.0 * np.arctan2(np.sqrt(s1b) * cn, np.sqrt(-s1))
        pieces = [(0.0, toggles[0], pi, toggles[-1])]
        if flat_in:
            pieces = [(0.0, toggles[0], 0.5 * pi, inner), (0.5 * pi, inner, pi, toggles[-1])]
    elif s1 > 0.0:
        def angle(phase):
            _, cn, _ = jacobi(np.sin(phase), np.cos(phase), -s1 * s2 / (-s1 * s2 + s1b * s2b))
            return 2.0 * np.arctan2(np.sqrt(-s2), np.sqrt(s2b) * cn)
        pieces = [(0.0, toggles[0], pi, toggles[-1])]
        if flat_out:
            pieces = [(0.0, toggles[0], 0.5 * pi, out), (0.5 * pi, out, pi, toggles[-1])]
    else:
        def angle(phase):
            _, _, dn = jacobi(np.sin(phase), np.cos(phase), s1 * s2 / (s1b * s2b))
            return np.copysign(2.0, phase) * np.arctan2(np.sqrt(s1b) * dn, np.sqrt(-s1))
        raise NotImplementedError
    return [_path(angle, *piece, points // len(pieces)) for piece in pieces]
