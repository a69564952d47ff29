# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the mechanisms with a sliding joint share.

The triangle of which one side slides, and their loads by name.

The triangle is the dyad of every mechanism that is driven by its slide: a slider-crank driven by
its slider, and, for an observer on its bar, an inverted one driven by its cylinder.
"""
from __future__ import annotations

from math import fsum, sqrt
from typing import Any, NamedTuple

from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.number_types import Function, NumberType, power_of_two


class SliderLoads(NamedTuple):
    """
    Loads for one input; each field a float, or an array of the input's shape.

    fij = all that link i does ON link j along the ground axes (1 crank, 2 coupler or block, 3
    slider or bar, 4 ground), the drive's force included where the drive is between them; fji =
    -fij. Forces [N], moments [N m], counter-clockwise positive.
    """

    f41_x: float
    f41_y: float
    f21_x: float
    f21_y: float
    f32_x: float
    f32_y: float
    f43_x: float
    f43_y: float
    f41: float                # magnitudes
    f21: float
    f32: float
    f43: float
    guide_force: float        # normal, at the pin; see the mechanism for its sense
    guide_couple: float       # about the pin
    driving_torque: float     # of the drive on the crank; zero for a driven slide
    driving_force: float      # of the drive along the slide; zero for a driven crank
    shaking_force_x: float    # of all links on the ground
    shaking_force_y: float
    shaking_force: float      # magnitude
    shaking_moment: float     # about O1


def make_triangle(n: NumberType, a1: Any, a2: Any, e: Any, sign: Any) -> Function:
    """
    Return the function s -> angles x, b of a1 e^{ix} + a2 e^{ib} = s + i e, and their derivatives.

    With q = s^2 + e^2, f = a1^2 - a2^2, theta2 = b - x as the 4R's mu
    (:mod:`fourbar_ros.mechanisms.four_bar.motion`):

        (T1)  root^2 = (2 a1 a2 sin theta2)^2 = u w,   u = K+ - s^2,   w = s^2 - K-,   K+- = (a1 +-
        a2)^2 - e^2 (T2)  2 a1 e^{ix} = (q + f - i root)(s + i e) / q
        (T3)  2 a2 e^{ib} = (q - f + i root)(s + i e) / q
        (T4)  x' = cos b / (a1 sin theta2),   b' = -cos x / (a2 sin theta2)
        (T5)  theta2' = -s / (a1 a2 sin theta2)
        (T6)  theta2'' = 2 (K+ K- - s^4) / root^3
        (T7)  x'' = (2 e - f theta2') s/q^2 - theta2'' (q - f)/(2 q)
        (T8)  b'' = (2 e - f theta2') s/q^2 + theta2'' (q + f)/(2 q)

    All is computed from the smaller of u and w, as u + w = 4 a1 a2. Of links of very
    different length both are small beside s^2: hence q + f = 2 a1 (a1 + a2) - u = 2 a1 (a1 - a2) +
    w, and K+ K- - s^4 = s^2 (u - w) - u w where s^2 > 4 a1 a2.

    ``sign``: of sin(theta2). Lengths within a few powers of two of one. At s = 0 of a change point
    the values are those for s -> 0 from above.

    Returns
    -------
    callable
        s -> (cos x, sin x, cos b, sin b, cos theta2, sin theta2, x', b', theta2', x'', b'',
        theta2'', 1/root).

    """
    sqrt, where, infinitesimal, ee = n.sqrt, n.where, n.infinitesimal, e * e
    k_plus = difference_of_squares(a1, a2, e, 0.0, n.exact_sum)
    k_minus = difference_of_squares(a1, -a2, e, 0.0, n.exact_sum)
    f, k_product, u_plus_w = (a1 - a2) * (a1 + a2), k_plus * k_minus, 4.0 * a1 * a2
    two_e, two_a1, two_a2 = 2.0 * e, 2.0 * a1, 2.0 * a2
    per_a1_a2, half_per_a1, half_per_a2 = 0.25 / (a1 * a2), 0.5 / a1, 0.5 / a2
    plus_1, plus_2 = 2.0 * a1 * (a1 + a2), 2.0 * a2 * (a1 + a2)       # q + f + u, q - f + u
    minus_1, minus_2 = 2.0 * a1 * (a1 - a2), 2.0 * a2 * (a2 - a1)     # q + f - w, q - f - w

    def triangle(s: Any) -> tuple[Any, ...]:
        s = s + infinitesimal
        ss = s * s
        q = ss + ee
        u, w = k_plus - ss, ss - k_minus                                                # (T1)
        # their sum is given: so the rounding of one is that of the other, as in the shape of a
        # triangle
        small, plus, minus, side = where(u.real < w.real, (u, plus_1, plus_2, -1.0),
                                         (w, minus_1, minus_2, 1.0))
        large, change = u_plus_w - small, side * small
        uw, u_minus_w = small * large, side * (large - small)
        root = sign * sqrt(uw)
        cos_2, sin_2 = -u_minus_w * per_a1_a2 + 0.0 * root, 2.0 * root * per_a1_a2
        per_q, per_root = 1.0 / q, 1.0 / root
        more, less, turn = (plus + change) * per_q, (minus + change) * per_q, root * per_q
        # (T2)
        cos_x, sin_x = (s * more + e * turn) * half_per_a1, (e * more - s * turn) * half_per_a1
        # (T3)
        cos_b, sin_b = (s * less - e * turn) * half_per_a2, (e * less + s * turn) * half_per_a2
        d_x, d_b = two_a2 * cos_b * per_root, -two_a1 * cos_x * per_root                # (T4)
        d_2 = -2.0 * s * per_root                                                       # (T5)
        bend = where(ss.real < u_plus_w, k_product - ss * ss, ss * u_minus_w - uw)
        dd_2 = 2.0 * bend * per_root * per_root * per_root                              # (T6)
        common, half = (two_e - f * d_2) * s * per_q * per_q, 0.5 * dd_2
        # (T7), (T8)
        dd_x, dd_b = common - half * less, common + half * more
        return cos_x, sin_x, cos_b, sin_b, cos_2, sin_2, d_x, d_b, d_2, dd_x, dd_b, dd_2, per_root
    return triangle


def closes(p: float, r: float, e: float) -> bool:
    """Return whether the triangle of :func:`make_triangle` closes for some s."""
    return fsum((p, r, -abs(e))) > 0.0


def margins(p: float, r: float, e: float) -> tuple[float, float]:
    """Return r - p - |e| and p - r - |e| [m], which are zero at change points."""
    return fsum((r, -p, -abs(e))), fsum((p, -r, -abs(e)))


def reach(p: float, r: float, e: float) -> tuple[float, float]:
    """
    Return (inner, outer) distances squared, minus e^2.

    (p - r)^2 - e^2 and (p + r)^2 - e^2 [m^2].
    """
    return difference_of_squares(p, -r, e, 0.0), difference_of_squares(p, r, e, 0.0)


def slide_ranges(p: float, r: float, e: float) -> tuple[tuple[float, float], ...]:
    """Return the ranges of s in which the triangle closes, in rising order [m]."""
    unit = power_of_two(p, r, e)
    inner, outer = reach(p / unit, r / unit, e / unit)
    far = unit * sqrt(outer)
    if inner <= 0.0:
        return ((-far, far),)
    near = unit * sqrt(inner)
    return ((-far, -near), (near, far))


def singular_slides(p: float, r: float, e: float) -> list[complex]:
    """Return the complex s where that triangle is flat, and those where it has no side q [m]."""
    unit = power_of_two(p, r, e)
    roots = [complex(unit * sqrt(k)) if k >= 0.0 else complex(0.0, unit * sqrt(-k))
             for k in reach(p / unit, r / unit, e / unit)]
    return [*roots, *(-z for z in roots if z.imag == 0.0 != z.real),
            *([complex(0.0, e)] if e else [])]
