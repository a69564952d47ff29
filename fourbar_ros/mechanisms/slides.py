# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Three loops with one slide, for kinds and machines alike, stable in the last bits.

A triangle driven by a side that slides; a rod that a crank moves along a line; a bar through a
block on a crank. The triangle is a slider-crank driven by its slider, and, for an observer on its
bar, an inverted one driven by its cylinder.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.number_types import nudge, NumberType, Scalar


class TriangleMotion(NamedTuple):
    """Directions x, b and theta2 by (T1) to (T3), and their derivatives by s."""

    cos_x: Scalar
    sin_x: Scalar
    cos_b: Scalar
    sin_b: Scalar
    cos_2: Scalar
    sin_2: Scalar
    d_x: Scalar
    d_b: Scalar
    d_theta2: Scalar
    dd_x: Scalar
    dd_b: Scalar
    dd_theta2: Scalar


class RodMotion(NamedTuple):
    """Directions b and theta2, the place s, by (R1) to (R9), derivatives by x."""

    cos_b: Scalar
    sin_b: Scalar
    cos_2: Scalar
    sin_2: Scalar
    s: Scalar
    d_b: Scalar
    d_theta2: Scalar
    d_s: Scalar
    dd_b: Scalar
    dd_s: Scalar


class BarMotion(NamedTuple):
    """Directions y, theta2 and the slide l by (B1) to (B6), derivatives by x, and 1/q."""

    cos_y: Scalar
    sin_y: Scalar
    cos_2: Scalar
    sin_2: Scalar
    l: Scalar         # noqa: E741  (the slides' letter)
    d_l: Scalar
    d_y: Scalar
    d_theta2: Scalar
    dd_l: Scalar
    dd_y: Scalar
    per_q: Scalar


def triangle(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, sign: Scalar,
             s: Scalar) -> TriangleMotion:
    """
    Return a triangle by its side s: x and b of a1 e^{ix} + a2 e^{ib} = s + i e.

    With q = s^2 + e^2, f = a1^2 - a2^2, theta2 = b - x as the 4R's mu
    (:mod:`fourbar_ros.mechanisms.loop`):

        (T1)  root^2 = (2 a1 a2 sin theta2)^2 = u w,   u = K+ - s^2,   w = s^2 - K-,
              K+- = (a1 +- a2)^2 - e^2
        (T2)  2 a1 e^{ix} = (q + f - i root)(s + i e) / q
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
    """
    sqrt, where, ee = n.sqrt, n.where, e * e
    k_plus = difference_of_squares(a1, a2, e, 0.0, n.exact_sum)
    k_minus = difference_of_squares(a1, -a2, e, 0.0, n.exact_sum)
    beside_0 = nudge(n, k_minus)
    f, k_product, u_plus_w = (a1 - a2) * (a1 + a2), k_plus * k_minus, 4.0 * a1 * a2
    two_e, two_a1, two_a2 = 2.0 * e, 2.0 * a1, 2.0 * a2
    per_a1_a2, half_per_a1, half_per_a2 = 0.25 / (a1 * a2), 0.5 / a1, 0.5 / a2
    plus_1, plus_2 = 2.0 * a1 * (a1 + a2), 2.0 * a2 * (a1 + a2)       # q + f + u, q - f + u
    minus_1, minus_2 = 2.0 * a1 * (a1 - a2), 2.0 * a2 * (a2 - a1)     # q + f - w, q - f - w
    s = s + beside_0
    ss = s * s
    q = ss + ee
    u, w = k_plus - ss, ss - k_minus                                                    # (T1)
    # their sum is given: so the rounding of one is that of the other, as in the shape of a
    # triangle
    small, sum_1, sum_2, side = where(u.real < w.real, (u, plus_1, plus_2, -1.0),
                                      (w, minus_1, minus_2, 1.0))
    large, change = u_plus_w - small, side * small
    uw, u_minus_w = small * large, side * (large - small)
    root = sign * sqrt(uw)
    cos_2, sin_2 = -u_minus_w * per_a1_a2 + (root - root), 2.0 * root * per_a1_a2
    per_q, per_root = 1.0 / q, 1.0 / root
    # (q + f)/q, (q - f)/q, root/q
    more, less, turn = (sum_1 + change) * per_q, (sum_2 + change) * per_q, root * per_q
    # (T2)
    cos_x, sin_x = (s * more + e * turn) * half_per_a1, (e * more - s * turn) * half_per_a1
    # (T3)
    cos_b, sin_b = (s * less - e * turn) * half_per_a2, (e * less + s * turn) * half_per_a2
    d_x, d_b = two_a2 * cos_b * per_root, -two_a1 * cos_x * per_root                    # (T4)
    d_2 = -2.0 * s * per_root                                                           # (T5)
    bend = where(ss.real < u_plus_w, k_product - ss * ss, ss * u_minus_w - uw)
    dd_2 = 2.0 * bend * per_root * per_root * per_root                                  # (T6)
    common, half = (two_e - f * d_2) * s * per_q * per_q, 0.5 * dd_2
    # (T7), (T8)
    dd_x, dd_b = common - half * less, common + half * more
    return TriangleMotion(cos_x, sin_x, cos_b, sin_b, cos_2, sin_2, d_x, d_b, d_2, dd_x, dd_b,
                          dd_2)


def rod_on_line(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, sign: Scalar, cos_x: Scalar,
                sin_x: Scalar) -> RodMotion:
    """
    Return where a rod that a crank carries meets a line, and its derivatives.

    The crank a1 at the angle x to the line, the rod a2 from its pin at the angle b; e is the
    distance of the line from the pivot of the crank, to its left, and s the place of the end of
    the rod along it: a1 e^{ix} + a2 e^{ib} = s + i e (slides, before Eq. (7)); theta2 = b - x,
    primes are derivatives with respect to x. The end is where a circle meets the line; with the
    height h = e - a1 sin x of the line above the pin:

        (R1)  u w = (a2 cos b)^2 = root^2,   u = a2 - h,   w = a2 + h,   a2 sin b = h
        (R2)  s = a1 cos x + root = gap / (root - a1 cos x),
              gap = a2^2 - a1^2 - e^2 + 2 a1 e sin x
        (R3)  b' = -a1 cos x / root
        (R4)  theta2' = b' - 1 = -s / root
        (R5)  s' = a1 (e cos x - s sin x) / root
        (R6)  b'' = a1 ((a2^2 - a1^2 - e^2) sin x + a1 e (1 + sin^2 x)) / root^3
        (R7)  s'' = a1 cos x theta2' - h b''

    u, w and gap are linear in sin x. Their exact values at sin x = 0, 1 or -1, whichever is
    nearest, are the start, so that they keep their digits next to limits and change points, which
    lie there: sin x = start + d, and near +-1 d = -+(1 - |sin x|) = -+cos^2 x / (1 + |sin x|):

        (R8)  u = u(start) + a1 d,   w = w(start) - a1 d,   gap = gap(start) + 2 a1 e d
              b'' root^3 / a1 = gap(start) sin x + a1 e (1 + d^2 about 0, d^2 about +-1)

    Where the pin is near the level of the line, |h| < a2/2, all follows from h instead,

        (R9)  u w = (a2 - h)(a2 + h),   b'' = a1 (u w sin x + a1 h cos^2 x) / root^3

    because h of a long crank has an error of up to eps a1, which is much beside a2: u, w and b''
    then have the same error, and fit together.

    Lengths within a few powers of two of one; ``sign``: of cos b.
    """
    sqrt, fabs, where, exact_sum = n.sqrt, n.fabs, n.where, n.exact_sum

    def squares(a: Scalar, b: Scalar, c: Scalar, d: Scalar) -> Scalar:
        return difference_of_squares(a, b, c, d, exact_sum)

    # u, w and gap at sin x = 0, 1 and -1, and that sine
    about_0 = a2 - e, a2 + e, squares(a2, 0.0, a1, 0.0) - e * e, 0.0
    about_up = (exact_sum((a2, -e, a1)), exact_sum((a2, e, -a1)), squares(a2, 0.0, e, -a1), 1.0)
    about_down = (exact_sum((a2, -e, -a1)), exact_sum((a2, e, a1)), squares(a2, 0.0, e, a1), -1.0)
    per_a2, a1_e, two_a1_e, level_square = 1.0 / a2, a1 * e, 2.0 * a1 * e, 0.25 * a2 * a2
    low, is_about_0 = cos_x * cos_x / (1.0 + fabs(sin_x)), fabs(sin_x).real < 0.5
    u, w, gap, start = where(is_about_0, about_0,
                             where(sin_x.real > 0.0, about_up, about_down))
    d, rest = where(is_about_0, (sin_x, a1_e * (1.0 + sin_x * sin_x)),
                    (-start * low, a1_e * low * low))
    at_x, step, h = a1 * cos_x, a1 * d, e - a1 * sin_x
    # b'' root^3 / a1 = factor sine + rest
    u, w, factor, sine = u + step, w - step, gap, start + d                             # (R8)
    up, down = a2 - h, a2 + h
    u, w, factor, sine, rest = where(                                                   # (R9)
        (h * h).real < level_square, (up, down, up * down, sin_x, at_x * h * cos_x),
        (u, w, factor, sine, rest))
    root = sign * sqrt(u * w)                                                           # (R1)
    # NaN too where nothing is real
    cos_b, sin_b = root * per_a2, h * per_a2 + (root - root)
    cos_2, sin_2 = cos_b * cos_x + sin_b * sin_x, sin_b * cos_x - cos_b * sin_x
    over, under = where((root * cos_x).real > 0.0, (at_x + root, 1.0),
                        (gap + two_a1_e * d, root - at_x))
    s, per = over / under, 1.0 / root                                                   # (R2)
    d_b, d_theta2 = -at_x * per, -s * per                                         # (R3), (R4)
    d_s = a1 * (e * cos_x - s * sin_x) * per                                            # (R5)
    dd_b = a1 * (factor * sine + rest) * per * per * per                                # (R6)
    dd_s = at_x * d_theta2 - h * dd_b                                                   # (R7)
    return RodMotion(cos_b, sin_b, cos_2, sin_2, s, d_b, d_theta2, d_s, dd_b, dd_s)


def block_on_bar(n: NumberType, a1: Scalar, a4: Scalar, h: Scalar, sign: Scalar, ss: Scalar,
                 cc: Scalar, sc: Scalar) -> BarMotion:
    """
    Return the motion of a bar through a block on a crank.

    The crank a1 at the angle x to the line to the pivot of the bar, a4 away; the block is pinned
    to its end A. l is how far A is along the bar from the foot of the pivot on the line of A, h
    how far that line is from the pivot, to the left of the bar, y the angle of the bar: a1 e^{ix}
    = a4 + (l + i h) e^{iy}. Primes are derivatives with respect to x, q = |A O4|^2:

        (B1)  l^2 = ((a1-a4)^2 - h^2) cos^2(x/2) + ((a1+a4)^2 - h^2) sin^2(x/2)
        (B2)  l' = a1 a4 sin x / l
        (B3)  l'' = a1 a4 (((a1-a4)^2 - h^2) cos^4(x/2) - ((a1+a4)^2 - h^2) sin^4(x/2)) / l^3
        (B4)  y' = (a1 (a1 - a4 cos x) + h l') / q
        (B5)  theta2' = y' - 1 = (a4 (a1 cos x - a4) + h l') / q
        (B6)  y'' = (a1 a4 sin x (a4^2 - a1^2 - 2 h l')/q + h l'') / q

    ``ss``, ``cc``, ``sc``: sin^2, cos^2 and sin cos of x/2. Lengths within a few powers of two of
    one; ``sign``: of l.
    """
    sqrt = n.sqrt
    a1_a4, less, more, two_h = a1 * a4, a1 - a4, a1 + a4, 2.0 * h
    # of squares
    q_near, q_far, a4_minus_a1 = (a1 - a4)**2, (a1 + a4)**2, (a4 - a1) * (a4 + a1)
    near = difference_of_squares(a1, -a4, h, 0.0, n.exact_sum)
    far = difference_of_squares(a1, a4, h, 0.0, n.exact_sum)
    sin_x = sc + sc
    l = sign * sqrt(near * cc + far * ss)  # (B1)  # noqa: E741, the slides' letter
    q = q_near * cc + q_far * ss
    per_q, per_l = 1.0 / q, 1.0 / l
    r_x, r_y = less * cc - more * ss, a1 * sin_x     # A - O4
    ahead = less * cc + more * ss                    # a1 - a4 cos x
    cos_y, sin_y = (r_x * l + r_y * h) * per_q, (r_y * l - r_x * h) * per_q
    cos_2, sin_2 = (ahead * l + a4 * h * sin_x) * per_q, (a4 * l * sin_x - ahead * h) * per_q
    pull = a1_a4 * sin_x
    d_l = pull * per_l                                                                  # (B2)
    dd_l = a1_a4 * (near * cc * cc - far * ss * ss) * per_l * per_l * per_l             # (B3)
    d_y = (a1 * ahead + h * d_l) * per_q                                                # (B4)
    d_theta2 = (a4 * r_x + h * d_l) * per_q                                             # (B5)
    dd_y = (pull * (a4_minus_a1 - two_h * d_l) * per_q + h * dd_l) * per_q              # (B6)
    return BarMotion(cos_y, sin_y, cos_2, sin_2, l, d_l, d_y, d_theta2, dd_l, dd_y, per_q)
