# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Three loops with one slide, for kinds and machines alike, stable in the last bits.

A triangle driven by a side that slides; a rod that a crank moves along a line; a bar through a
block on a crank. The triangle is a slider-crank driven by its slider, and, for an observer on its
bar, an inverted one driven by its cylinder.
"""
from typing import NamedTuple

from fourbar_ros.mechanisms.curves import Direction
from fourbar_ros.mechanisms.loop import HalfAngle, in_one_turn
from fourbar_ros.numerics.number_types import is_zero, NumberType, Scalar

Slide = tuple[Scalar, Scalar, Scalar]       # a place along a line, its first and second derivative


class BarMotion(NamedTuple):
    """Directions y, theta2 and the slide l by (B1) to (B6), derivatives by x."""

    y: Direction
    theta2: Direction
    slide: Slide
    sine: Scalar            # of the transmission angle, from the bar to A - O4
    cosine: Scalar


def triangle(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, sign: Scalar,
             s: Scalar, can_lie_flat: bool = True) -> tuple[Direction, Direction, Direction]:
    """
    Return x, b and theta2 of a triangle by its side s: a1 e^{ix} + a2 e^{ib} = s + i e.

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

    Where K- = 0 both rods fold onto the line at s = 0, a change point: w = s^2, root = R s, and R
    keeps its sign, so that s is left out of each quotient; q too is s^2 where also e = 0.

    ``sign``: of R, so that of sin(theta2) where the lengths make no change point. Lengths within a
    few powers of two of one.
    """
    sqrt, where, ee = n.sqrt, n.where, e * e
    k_plus = n.difference_of_squares(a1, a2, e, 0.0)
    k_minus = n.difference_of_squares(a1, -a2, e, 0.0)
    flat_at_0 = can_lie_flat and is_zero(n, k_minus)
    meets = can_lie_flat and is_zero(
        n, n.fabs(n.exact_sum((a1, -a2, e))) + n.fabs(n.exact_sum((a1, -a2, -e))))
    # a1 - a2 is as large as e there, which may have more digits
    less_a2 = where(flat_at_0, where((a1 - a2).real > 0.0, n.fabs(e), -n.fabs(e)), a1 - a2)
    f, k_product, u_plus_w = less_a2 * (a1 + a2), k_plus * k_minus, 4.0 * a1 * a2
    f, e = where(meets, 0.0, f), where(meets, 0.0, e)
    per_a1_a2, half_per_a1, half_per_a2 = 0.25 / (a1 * a2), 0.5 / a1, 0.5 / a2
    plus_1, plus_2 = 2.0 * a1 * (a1 + a2), 2.0 * a2 * (a1 + a2)       # q + f + u, q - f + u
    minus_1, minus_2 = 2.0 * a1 * less_a2, -2.0 * a2 * less_a2     # q + f - w, q - f - w
    k, s_left, ss = where(flat_at_0, s, 1.0), where(flat_at_0, 1.0, s), s * s
    q = where(meets, 1.0, ss + ee)
    u, w = k_plus - ss, ss - k_minus                                                    # (T1)
    # their sum is given: so the rounding of one is that of the other, as in the shape of a
    # triangle
    small, sum_1, sum_2, side = where(u.real < w.real, (u, plus_1, plus_2, -1.0),
                                      (w, minus_1, minus_2, 1.0))
    large, change = u_plus_w - small, side * small
    uw, u_minus_w = small * large, side * (large - small)
    root = sign * sqrt(where(flat_at_0, where(side.real > 0.0, large, small), uw))      # R
    cos_2, sin_2 = -u_minus_w * per_a1_a2 + (root - root), 2.0 * (root * k) * per_a1_a2
    per_q, per_root = 1.0 / q, 1.0 / root
    # (q + f)/q, (q - f)/q, R/q, s root/q
    more, less = where(meets, (1.0, 1.0), ((sum_1 + change) * per_q, (sum_2 + change) * per_q))
    turn, s_turn = root * per_q, where(meets, root, s * (root * k * per_q))
    # 2 a1 cos x and 2 a2 cos b, over k
    along_1, along_2 = s_left * more + e * turn, s_left * less - e * turn
    e_turn = e * k * turn
    cos_x, sin_x = (s * more + e_turn) * half_per_a1, (e * more - s_turn) * half_per_a1  # (T2)
    cos_b, sin_b = (s * less - e_turn) * half_per_a2, (e * less + s_turn) * half_per_a2  # (T3)
    d_x, d_b = along_2 * per_root, -along_1 * per_root                                  # (T4)
    d_2 = -2.0 * s_left * per_root                                                      # (T5)
    bend = where(flat_at_0, -s, where(ss.real < u_plus_w, k_product - ss * ss,
                                      ss * u_minus_w - uw))
    dd_2 = 2.0 * bend * per_root * per_root * per_root                                  # (T6)
    common, half = (2.0 * e - f * d_2) * s * per_q * per_q, 0.5 * dd_2
    # (T7), (T8)
    dd_x, dd_b = common - half * less, common + half * more
    return (cos_x, sin_x, d_x, dd_x), (cos_b, sin_b, d_b, dd_b), (cos_2, sin_2, d_2, dd_2)


def rod_on_line(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, sign: Scalar, cos_x: Scalar,
                sin_x: Scalar, sin_v: Scalar, cos_v: Scalar,
                can_lie_flat: bool = True) -> tuple[Direction, Direction, Slide]:
    """
    Return b, theta2 and s of a rod that a crank carries to a line, with derivatives by x.

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

    Change points. With v = x/2 + pi/4, 1 + sin x = 2 sin^2 v and 1 - sin x = 2 cos^2 v. So where
    a2 - e = a1, u = 2 a1 sin^2 v, and where a2 + e = a1, w = 2 a1 cos^2 v: root = R k with

        (R10) k = (sin v if a2 - e = a1) (cos v if a2 + e = a1),   R keeps its sign,
              gap = 4 a1 e k^2, -4 a1 e k^2 or 0,   b'' R^3 = 4 a1^2 e (the other one of sin v,
              cos v)

    and k is left out of every quotient. With both, a1 = a2 and e = 0, b = -x and s = 2 a1 cos x
    (mode 2) all the way. A crank that swings through one of them is where it was after a turn.
    Elsewhere k is 1.

    Lengths within a few powers of two of one; ``sign``: of R, so that of cos b where k is 1.
    ``sin_v``, ``cos_v``: of v.
    """
    sqrt, fabs, where, exact_sum = n.sqrt, n.fabs, n.where, n.exact_sum
    # u, w and gap at sin x = 0, 1 and -1, and that sine
    about_0 = a2 - e, a2 + e, n.difference_of_squares(a2, 0.0, a1, 0.0) - e * e, 0.0
    about_up = (exact_sum((a2, -e, a1)), exact_sum((a2, e, -a1)),
                n.difference_of_squares(a2, 0.0, e, -a1), 1.0)
    about_down = (exact_sum((a2, -e, -a1)), exact_sum((a2, e, a1)),
                  n.difference_of_squares(a2, 0.0, e, a1), -1.0)
    per_a2, a1_e, two_a1_e, level_square = 1.0 / a2, a1 * e, 2.0 * a1 * e, 0.25 * a2 * a2
    low, is_about_0 = cos_x * cos_x / (1.0 + fabs(sin_x)), fabs(sin_x).real < 0.5
    u, w, gap, start = where(is_about_0, about_0, where(sin_x.real > 0.0, about_up, about_down))
    d, rest = where(is_about_0, (sin_x, a1_e * (1.0 + sin_x * sin_x)),
                    (-start * low, a1_e * low * low))
    at_x, step, h = a1 * cos_x, a1 * d, e - a1 * sin_x
    # b'' root^3 / a1 = factor sine + rest
    u, w, factor, sine = u + step, w - step, gap, start + d                             # (R8)
    up, down = a2 - h, a2 + h
    u, w, factor, sine, rest = where(                                                   # (R9)
        (h * h).real < level_square, (up, down, up * down, sin_x, at_x * h * cos_x),
        (u, w, factor, sine, rest))
    flat_down = can_lie_flat and is_zero(n, about_down[0])                              # (R10)
    flat_up = can_lie_flat and is_zero(n, about_up[1])
    sin_v, cos_v = in_one_turn(n, (sin_v, cos_v), where(flat_down, about_up[1], 0.0),
                               where(flat_up, about_down[0], 0.0))
    k_s, k_c = where(flat_down, sin_v, 1.0), where(flat_up, cos_v, 1.0)
    k, is_flat = k_s * k_c, can_lie_flat and is_zero(n, about_down[0] * about_up[1])
    cos_x_left = where(is_flat, 2.0 * (where(flat_down, 1.0, sin_v) * where(flat_up, 1.0, cos_v)),
                       cos_x)
    u, w = where(flat_down, 2.0 * a1, u), where(flat_up, 2.0 * a1, w)
    gap = where(flat_up, where(flat_down, 0.0, -4.0 * a1_e),
                where(flat_down, 4.0 * a1_e, gap + two_a1_e * d))
    bend = where(is_flat, where(flat_up, where(flat_down, 0.0, cos_v), sin_v) * (4.0 * a1_e),
                 factor * sine + rest)
    root = sign * sqrt(u * w)                                               # R of (R1), (R10)
    # NaN too where nothing is real
    cos_b, sin_b = root * k * per_a2, h * per_a2 + (root - root)
    cos_2, sin_2 = cos_b * cos_x + sin_b * sin_x, sin_b * cos_x - cos_b * sin_x
    at_x_left = a1 * cos_x_left
    over, under = where((root * cos_x_left).real > 0.0, (at_x_left + root, 1.0),
                        (gap, root - at_x_left))
    s_left, per = over / under, 1.0 / root                                              # (R2)
    s = s_left * k
    d_b, d_theta2 = -at_x_left * per, -s_left * per                               # (R3), (R4)
    d_s = a1 * (e * cos_x_left - s_left * sin_x) * per                                  # (R5)
    dd_b = a1 * bend * per * per * per                                                  # (R6)
    dd_s = at_x * d_theta2 - h * dd_b                                                   # (R7)
    return (cos_b, sin_b, d_b, dd_b), (cos_2, sin_2, d_theta2, dd_b), (s, d_s, dd_s)


def block_on_bar(n: NumberType, a1: Scalar, a4: Scalar, h: Scalar, sign: Scalar,
                 half: HalfAngle, can_lie_flat: bool = True) -> BarMotion:
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

    Where a1 - a4 = +-h, l = L sin(x/2): the block passes the foot, a change point. L keeps its
    sign, and sin(x/2) is left out of the quotients, of those with q too where also h = 0.

    ``half``: of x. Lengths within a few powers of two of one; ``sign``: of L, so that of l
    elsewhere.
    """
    where, (s, c, ss, cc, sc) = n.where, half
    a1_a4, more = a1 * a4, a1 + a4
    near = n.difference_of_squares(a1, -a4, h, 0.0)
    far = n.difference_of_squares(a1, a4, h, 0.0)
    flat_at_0 = can_lie_flat and is_zero(n, near)
    meets = can_lie_flat and is_zero(
        n, n.fabs(n.exact_sum((a1, -a4, h))) + n.fabs(n.exact_sum((a1, -a4, -h))))
    h = where(meets, 0.0, h)
    # a1 - a4 is as large as h there, which may have more digits
    less = where(flat_at_0, where((a1 - a4).real > 0.0, n.fabs(h), -n.fabs(h)), a1 - a4)
    q_near, q_far, a4_minus_a1 = less * less, more * more, -less * more
    two_h, k, k_q = 2.0 * h, where(flat_at_0, s, 1.0), where(meets, s, 1.0)
    L = sign * n.sqrt(where(flat_at_0, far, near * cc + far * ss))                      # (B1)
    l, l_left = L * k, where(meets, L, L * k)        # noqa: E741  (l is the slides' letter)
    # over k_q^2: q, A - O4 = (x, y), a1 - a4 cos x; the last three over k_q too, sin x over k, k_q
    q, x_left, ahead_left = where(meets, (q_far, -more, more), (
        q_near * cc + q_far * ss, less * cc - more * ss, less * cc + more * ss))
    sin_x, sin_x_k, sin_x_q = 2.0 * sc, 2.0 * where(flat_at_0, c, sc), 2.0 * where(meets, c, sc)
    r_x, r_y, ahead = x_left * k_q, a1 * sin_x_q, ahead_left * k_q
    per_q, per_l = 1.0 / q, 1.0 / L
    cos_y, sin_y = (r_x * l_left + r_y * h) * per_q, (r_y * l_left - r_x * h) * per_q
    cos_2, sin_2 = ((ahead * l_left + a4 * h * sin_x_q) * per_q,
                    (a4 * l_left * sin_x_q - ahead * h) * per_q)
    d_l = a1_a4 * sin_x_k * per_l                                                       # (B2)
    dd_l = a1_a4 * where(flat_at_0, -far * s, near * cc * cc - far * ss * ss) * (       # (B3)
        per_l * per_l * per_l)
    d_y = (a1 * ahead_left + h * d_l) * per_q                                           # (B4)
    d_theta2 = (a4 * x_left + h * d_l) * per_q                                          # (B5)
    dd_y = (a1_a4 * sin_x * (a4_minus_a1 - two_h * d_l) * per_q + h * dd_l) * per_q     # (B6)
    per_distance = n.sqrt(per_q)
    return BarMotion((cos_y, sin_y, d_y, dd_y), (cos_2, sin_2, d_theta2, dd_y), (l, d_l, dd_l),
                     l_left * per_distance, h * per_distance)
