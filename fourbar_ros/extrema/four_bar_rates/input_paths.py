# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Sample points of the input angle that resolve any 4R linkage: uniform in the elliptic parameter u.

With x = theta1 and du = dx / (a2 a3 sin mu), tan(x/2) is a Jacobi function of u: of

    (d tan(x/2) / du)^2 = (s1b + s1 tan^2(x/2)) (s2 + s2b tan^2(x/2)) / 16,

s1 = (a2+a3)^2 - (a1+a4)^2, s1b = (a2+a3)^2 - (a1-a4)^2, s2 = (a1-a4)^2 - (a2-a3)^2 and
s2b = (a1+a4)^2 - (a2-a3)^2, products of the bilinear factors. All quantities of the linkage are
smooth in u at one scale: near a change point, where they change within sqrt(gap) in x, equal steps
in u need only log(1/gap) points; at a toggle, u passes from one assembly mode into the other
without a root.

Input ranges are symmetric about theta1 = 0, so the points of 0 < theta1 < pi give all.

Jacobi's functions are computed by the descending Landen transformation from the complementary
parameter m1 = 1 - m. scipy.special.ellipj will not do: it takes m, and next to a change point (m
-> 1) everything depends on digits of 1 - m that m has lost.

Sources: NIST Digital Library of Mathematical Functions, section 22.7(i); Abramowitz and Stegun,
section 16.12.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

from fourbar_ros.extrema.input_paths import closer_points, End, InputPath
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.exact_sums import difference_of_squares, scaled
import numpy as np

# At a change point itself the period of u is infinite. There the branches are smooth in x, so the
# points of a linkage that clears the flat position by this much (of 4 a1 a4) serve.
CLEARANCE = 2.0**-6
POINTS_PER_FEATURE = 4      # samples for each unit of :attr:`HalfTurn.period`


class HalfTurn(NamedTuple):
    """theta1/2 as a function of u over theta1 in [0, pi], of one linkage or of many."""

    period: Array        # K: length of the range in units of about the narrowest feature
    unit: Array          # such a unit, in u
    up: Array            # factor of the numerator of tan(theta1/2)
    down: Array          # factor of its denominator
    steps: list[tuple[Array, Array]]      # from :func:`.landen_steps`
    crosses: tuple[bool, bool]            # whether theta1 reaches pi, and whether it reaches 0

    def __call__(self, sine: Array, cosine: Array) -> tuple[Array, Array]:
        """
        Return numerator and denominator of tan(theta1/2) at the sine and cosine of pi t/2.

        t is uniform in u: 0 at the lower end of theta1 in [0, pi], 1 at the upper end.
        """
        up, down, (out, inside) = self.up, self.down, self.crosses
        if not out:
            _, cn, dn = jacobi(cosine, sine, self.steps)
            return up * (cn if inside else dn), down
        sn, cn, _ = jacobi(sine, cosine, self.steps)
        return up * sn if inside else up, down * cn

    def part(self, which: slice) -> HalfTurn:
        """Return the half turns of some of many linkages."""
        period, unit, up, down, steps, crosses = self
        return HalfTurn(period[which], unit[which], up[which], down[which],
                        [(k[which], k1[which]) for k, k1 in steps], crosses)


def half_turn(s1: Values, s2: Values, k: Values, crosses_out: bool, crosses_in: bool) -> HalfTurn:
    """
    Return the :class:`HalfTurn` of one or many linkages with s1, s2, not zero, and k = 4 a1 a4.

    ``crosses_out``: s1 > 0, so that theta1 reaches pi; ``crosses_in``: s2 > 0, so that it reaches
    0.
    """
    s1, s2 = np.asarray(s1), np.asarray(s2)
    s1b, s2b = s1 + k, s2 + k
    p, q = abs(s1 * s2), s1b * s2b
    up = (abs(s2) if crosses_out else s1b)**0.5
    down = (s2b if crosses_out else abs(s1))**0.5
    q = q if crosses_out == crosses_in else p + q
    steps, unit = landen_steps(p / q), 4.0 / q**0.5

    period = np.asarray(0.5 * pi)
    for step, _ in steps:
        period = period * (1.0 + step)
    return HalfTurn(period, unit, up, down, steps, (crosses_out, crosses_in))


def phases(count: int, low_is_toggle: bool, high_is_toggle: bool) -> tuple[Array, Array, float]:
    """
    Return (sines, cosines) of pi t/2 at ``count`` equal steps of t in [0, 1], and the step.

    An end that is a toggle is a sample; at an end where the motion goes on symmetrically, through
    theta1 = 0 or pi, samples begin half a step inside.
    """
    first, last = 0.5 * (not low_is_toggle), 0.5 * (not high_is_toggle)
    step = 1.0 / (count - 1 + first + last)
    t = (np.arange(count) + first) * step
    return np.sin(0.5 * pi * t), np.sin(0.5 * pi * (1.0 - t)), step


def input_paths(linkage: FourBar, points: int) -> list[InputPath]:
    """
    Return the paths that make up the motion of a linkage in its mode, sampled uniformly in u.

    ``points`` is the least number of points of a full turn, without those added at the ends. They
    are computed for 0 < theta1 < pi and mirrored.
    """
    a1, a2, a3, a4 = scaled(linkage.lengths)
    k = 4.0 * a1 * a4
    s1, s2 = difference_of_squares(a2, a3, a1, a4), difference_of_squares(a1, -a4, a2, -a3)
    low_end, high_end = linkage.input_ranges[-1]
    low = End(max(low_end, 0.0), s2 == 0.0) if s2 <= 0.0 else None
    high = End(min(high_end, pi), s1 == 0.0) if s1 <= 0.0 else None
    s1, s2 = s1 or CLEARANCE * k, s2 or CLEARANCE * k

    half = half_turn(s1, s2, k, s1 > 0.0, s2 > 0.0)
    count = int(max(points // 2, POINTS_PER_FEATURE * float(half.period)))
    before, after = closer_points(low, count), closer_points(high, count)
    phase = 0.5 * pi * np.concatenate((before[::-1], (np.arange(count) + 0.5) / count,
                                       1.0 - after))
    x = 2.0 * np.arctan2(*half(np.sin(phase), np.cos(phase)))

    # Nearer to a toggle than this, x has no digits left for the distance.
    beyond = [np.abs(x - end.x) < 2.0**-40 * end.x if end else np.zeros(x.shape, bool)
              for end in (low, high)]
    first, last = before.size - int(beyond[0].sum()), after.size - int(beyond[1].sum())
    x = x[~(beyond[0] | beyond[1])]
    if low and high:
        return [InputPath(-x[::-1], _mirror(high), _mirror(low), last, x.size - 1 - first),
                InputPath(x, low, high, first, x.size - 1 - last)]
    if low:
        return [InputPath(np.concatenate((x, -x[::-1])), low, _mirror(low), first,
                          2 * x.size - 1 - first)]
    return [InputPath(np.concatenate((-x[::-1], x)), high and _mirror(high), high, last,
                      2 * x.size - 1 - last)]


def _mirror(end: End) -> End:
    return End(-end.x, end.is_flat)


def landen_steps(m1: Array) -> list[tuple[Array, Array]]:
    """
    Return the steps of the descending Landen transformation.

    ``m1`` = 1 - m, the complementary parameter, is a float or an array, in (0, 1]. Each step is
    the modulus k it leads to and that modulus' complement k' before it; the last step first, as
    :func:`jacobi` needs them. Written in the complementary modulus, with sums of positive terms
    only, it loses nothing for m1 -> 0. It ends where k' is 1 to 1e-3, and errors are of this size:
    the functions only place samples.
    """
    steps: list[tuple[Array, Array]] = []
    modulus, smallest = m1**0.5, float(np.min(m1))**0.5
    while not steps or smallest < 1.0 - 1e-3:
        next_one = 1.0 / (1.0 + modulus)
        steps.append(((1.0 - modulus) * next_one, 2.0 * modulus * next_one))
        modulus, smallest = 2.0 * modulus**0.5 * next_one, 2.0 * smallest**0.5 / (1.0 + smallest)
    return steps[::-1]


def jacobi(sine: Array, cosine: Array,
           steps: Sequence[tuple[Array, Array]]) -> tuple[Array, Array, Array]:
    """
    Return Jacobi's elliptic functions sn, cn, dn of u from sine and cosine of pi u/(2 K).

    K is their quarter period. ``steps``: (k, k') of :func:`landen_steps`; each turns the functions
    of modulus k into those of the next, larger one. The first are nearly of modulus 0, where sn,
    cn, dn are sine, cosine and 1.
    """
    sn, cn, dn = sine, cosine, sine * sine + cosine * cosine
    for k, k1 in steps:
        square = sn * sn
        scale = 1.0 / (1.0 + k * square)
        sn, cn, dn = (1.0 + k) * sn * scale, cn * dn * scale, (k1 + k * cn * cn) * scale
    return sn, cn, dn
