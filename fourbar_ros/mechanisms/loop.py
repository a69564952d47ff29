# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A loop of four rods: where they are and how they turn, stable in the last bits.

It serves the 4R linkage, and such loops within a machine. x is the angle of its crank a1, y of its
output a3, b of its coupler a2, all from its ground line a4; mu = y - b, q = |A O4|^2, primes are
derivatives with respect to x. Loop: a1 e^{ix} + a2 e^{ib} = a4 + a3 e^{iy}.

Positions. Every angle z of y, y - x and b - x comes from its own homogeneous half-angle quadratic
(lecture set 7, Eqs. (16), (17) and their rotations)

    (M1)  p t^2 - 2 m t + r = 0,   t = tan(z/2) = r / (m + root) = (m - root) / p

with, of y, p = A sin^2(x/2) + C cos^2(x/2), r = B sin^2(x/2) + D cos^2(x/2), m = 4 a1 a3 sin(x/2)
cos(x/2), and A = A1 A2, ..., D = D1 D2 of :func:`bilinear_factors`; in (1) of plain.py, whose x is
theta1 + pi, these are second, constant, both and first. Negative or exchanged lengths turn it into
the equations of the other angles, and their sums into the same but for signs: -a4, a3, -a2, -a1
give b - x, and -a4, a2, a3, -a1 give y - x, with A and B of y exchanged. t is kept as
a pair g, h, so that no angle is special (t = tan(pi/2) is just h = 0), and of its two forms the
one without cancellation is taken: "side" is +1 for t = g/h, g = r, h = m + root, and -1 for t =
h/g, g = p, h = m - root. Then

    (M2)  sin z = 2 g h / (g^2 + h^2),   cos z = side (h^2 - g^2) / (g^2 + h^2)

The quadratics share one discriminant root^2 = (2 a2 a3 sin mu)^2 = u w,

    (M3)  u = 4 a2 a3 cos^2(mu/2) = s1 sin^2(x/2) + c1 cos^2(x/2)
          w = 4 a2 a3 sin^2(mu/2) = c2 sin^2(x/2) + s2 cos^2(x/2)

    s1 = (a2 + a3)^2 - (a1 + a4)^2     c1 = (a2 + a3)^2 - (a1 - a4)^2
    s2 = (a1 - a4)^2 - (a2 - a3)^2     c2 = (a1 + a4)^2 - (a2 - a3)^2

whose coefficients are products of two bilinear factors each: they keep their digits near toggles
and change points, where coordinates lose them.

Rates. The relative rates at the four joints are as the areas of the triangles of the other three
joints, so each is a product, without a difference of rates:

    (M4)  theta2' = b' - 1 = -a4 sin y / (a2 sin mu)
    (M5)  theta3' = mu' = y' - b' = a1 a4 sin x / (a2 a3 sin mu)
    (M6)  y' = a1 sin(x - b) / (a3 sin mu)
    (M7)  b' = a1 sin(x - y) / (a2 sin mu)

Accelerations. mu is a function of q alone, and y and b are the direction of the diagonal A-O4 plus
or minus an angle of the triangle A-B-O4. With e = a1^2 - a4^2, f = a2^2 - a3^2:

    (M8)   q = (a1 - a4)^2 + 4 a1 a4 sin^2(x/2)
    (M9)   turn = a1 a4 sin x rho,   rho = y' + b' - 1 = (e + f mu')/q
    (M10)  mu'' = 2 a1 a4 (s2 cos^2(x/2) u - s1 sin^2(x/2) w) / root^3
    (M11)  y'' = ((f + q) mu''/2 - turn) / q
    (M12)  b'' = ((f - q) mu''/2 - turn) / q

where the second form of rho is for large q, so for all where a1 = a4. Every difference in these is
one that the data make: the error stays within a few eps times the condition at any link ratio.

Change points. Where s2 = 0, w contains s^2, with s = sin(x/2); where s1 = 0, u contains c^2, with
c = cos(x/2). Then root, sin mu, sin x and one of each pair g, h, or both, vanish at x = 0 or pi
with

    (M13)  k = (s if s2 = 0) (c if s1 = 0),   root = R k,   R^2 = u w / k^2

and R keeps its sign: the assembly mode. So the branch goes on through the flat position, where k
changes its sign, without a jump and without 0/0, as k is left out of every quotient:

    (M14)  sin x / k,  m / k and sin z / k in (M4) to (M7);   g = j^2 g2,   h = k h',
           sin z = 2 k g2 h' / n,   cos z = side ((k h'/j)^2 - (j g2)^2) / n,
           n = (j g2)^2 + (k h'/j)^2,   j = (s if g has it twice) (c if g has it twice)
    (M15)  mu'' = 2 a1 a4 (s2 c (c/kc) u - s1 s (s/ks) w) / R^3 with k = ks kc, and with u, w
           without kc^2, ks^2

A parallelogram (s1 = s2 = 0) repeats after one turn, a kite after two; one that swings through its
flat position, s1 < 0 or s2 < 0, is where it was after one. Where a1 = a4 and a2 = a3 also q
vanishes at x = 0, with (M11) and (M12) y'' = mu''/2 = -b''. Elsewhere k is 1.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from fourbar_ros.mechanisms.curves import Direction
from fourbar_ros.numerics.number_types import exact_sum, Function, is_zero, NumberType, Scalar

# Each coefficient of Eqs. (16)-(21) of lecture set 7 is a product of two sums +-a1 +-a2 +-a3 +-a4.
# Near a change point one of them cancels; as exact sums they keep all digits, and so do products.


def bilinear_factors(a1: Scalar, a2: Scalar, a3: Scalar, a4: Scalar,
                     exact_sum: Function = exact_sum) -> dict[str, Scalar]:
    """Return the eight sums of four lengths [m] by the lectures' letters, each rounded once."""
    # At a change point one is 0.0. The paper gives these letters to other sums.
    return {'A1': exact_sum((a1, -a2, -a3, a4)), 'A2': exact_sum((a1, a2, -a3, a4)),
            'B1': exact_sum((a1, -a2, a3, a4)), 'B2': exact_sum((a1, a2, a3, a4)),
            'C1': exact_sum((a1, -a2, a3, -a4)), 'C2': exact_sum((a1, a2, a3, -a4)),
            'D1': exact_sum((a1, a2, -a3, -a4)), 'D2': exact_sum((a1, -a2, -a3, -a4))}


class HalfAngle(NamedTuple):
    """Half an angle x: sine and cosine of x/2, which tell odd turns of x from even ones."""

    # And their squares and product, which keep their digits near x = 0 and pi.
    sine: Scalar
    cosine: Scalar
    ss: Scalar
    cc: Scalar
    sc: Scalar

    @classmethod
    def of(cls, cosine: Scalar, sine: Scalar) -> HalfAngle:
        return cls(sine, cosine, sine * sine, cosine * cosine, sine * cosine)


class LoopMotion(NamedTuple):
    """Directions of the rods of a loop, with their derivatives with respect to x."""

    b: Direction            # coupler
    y: Direction            # output
    theta2: Direction       # coupler from the crank, b - x
    mu: Direction           # output from the coupler


def in_one_turn(n: NumberType, half: tuple[Scalar, Scalar], of_sine: Scalar,
                of_cosine: Scalar) -> tuple[Scalar, Scalar]:
    """Return sine and cosine of x/2, the same after a turn of a crank that swings through flat."""
    # of_sine: below zero if it swings through the zero of the sine, so that the cosine is
    # positive; of_cosine: if through that of the cosine.
    where, (s, c) = n.where, half
    turn = where(of_sine.real < 0.0, where(c.real < 0.0, -1.0, 1.0),
                 where(of_cosine.real < 0.0, where(s.real < 0.0, -1.0, 1.0), 1.0))
    return turn * s, turn * c


def loop(n: NumberType, lengths: Sequence[Scalar], sign: Scalar, half: HalfAngle,
         can_lie_flat: bool = True) -> LoopMotion:
    """Return the motion of a loop of crank a1, coupler a2, output a3, ground a4: ``lengths``."""
    # half: of the angle x of the crank; sign: of R, the assembly mode; can_lie_flat: else k is 1
    # whatever the lengths.
    fabs, where, unit = n.fabs, n.where, n.power_of_two(*lengths)
    a1, a2, a3, a4 = [length / unit for length in lengths]
    A1, A2, B1, B2, C1, C2, D1, D2 = bilinear_factors(
        a1, a2, a3, a4, n.exact_sum).values()
    A, B, C, D = A1 * A2, B1 * B2, C1 * C2, D1 * D2                                     # of y
    A_bx, B_bx, C_bx, D_bx = A1 * B1, A2 * B2, C1 * D2, C2 * D1                         # of b - x
    f, q_near, q_far = (a2 - a3) * (a2 + a3), (a1 - a4)**2, (a1 + a4)**2
    # (f + q)/2 at x = 0 and x = pi, then (f - q)/2 at both. The odd one of three squares is paired
    # with the larger of the others: the remaining cancellation comes from the data.
    is_near, is_far = fabs(a1 - a4) > a2, a1 + a4 > a2
    y_near = where(is_near, n.difference_of_squares(a1, -a4, a3, 0.0) + a2 * a2, f + q_near)
    y_far = where(is_far, n.difference_of_squares(a1, a4, a3, 0.0) + a2 * a2, f + q_far)
    is_near, is_far = fabs(a1 - a4) > a3, a1 + a4 > a3
    b_near = where(is_near, n.difference_of_squares(a2, 0.0, a1, -a4) - a3 * a3, f - q_near)
    b_far = where(is_far, n.difference_of_squares(a2, 0.0, a1, a4) - a3 * a3, f - q_far)
    s1, c1, s2, c2 = -A1 * B2, -C2 * D2, C1 * D1, A2 * B1
    m_y, m_yx, m_bx = 4.0 * a1 * a3, 4.0 * a4 * a3, -4.0 * a4 * a2      # m / (sin(x/2) cos(x/2))
    e, y_near, y_far = (a1 - a4) * (a1 + a4), 0.5 * y_near, 0.5 * y_far
    b_near, b_far = 0.5 * b_near, 0.5 * b_far
    s, c, ss, cc, sc = half
    u, w = s1 * ss + c1 * cc, c2 * ss + s2 * cc                                         # (M3)
    flat_at_0, flat_at_pi = [can_lie_flat and is_zero(n, factor) for factor in (s2, s1)]
    s, c = in_one_turn(n, (s, c), where(flat_at_0, s1, 0.0), where(flat_at_pi, s2, 0.0))
    k_s, k_c = where(flat_at_0, s, 1.0), where(flat_at_pi, c, 1.0)                      # (M13)
    sc_left = where(flat_at_0, where(flat_at_pi, 1.0, c), where(flat_at_pi, s, sc))
    u_left, w_left, k = where(flat_at_pi, c1, u), where(flat_at_0, c2, w), k_s * k_c
    root = sign * n.sqrt(u_left * w_left)     # R, not real where the linkage cannot close
    # 1/(4 a2 a3) with the roundings of u and w; NaN where the root is not real
    per = 1.0 / (u + w + (root - root))
    cos_mu, sin_mu_over_k = (u - w) * per, (root + root) * per
    # m and root have equal signs for all three angles, or for none: the sum does not cancel
    adds = (sc_left * root).real > 0.0
    side = where(adds, 1.0, -1.0)

    def angle(p_s: Scalar, p_c: Scalar, r_s: Scalar, r_c: Scalar, m: Scalar,
              signed_root: Scalar) -> tuple[Scalar, Scalar]:
        """Return cos z and sin(z)/k of an angle, from its p, r and m, (M14)."""
        forms = []
        for g_s, g_c in ((r_s, r_c), (p_s, p_c)):       # t = g/h, t = h/g
            twice_s = can_lie_flat and is_zero(n, fabs(s2) + fabs(g_c))
            twice_c = can_lie_flat and is_zero(n, fabs(s1) + fabs(g_s))
            forms.append((g_s, g_c, where(twice_s, 1.0, ss), where(twice_c, 1.0, cc),
                          where(twice_s, s, 1.0) * where(twice_c, c, 1.0),
                          where(twice_s, 1.0, k_s) * where(twice_c, 1.0, k_c)))
        g_s, g_c, ss_left, cc_left, j, k_over_j = where(adds, *forms)
        g, h = g_s * ss_left + g_c * cc_left, m * sc_left + signed_root                 # (M1)
        large, small = k_over_j * h, j * g
        square = large * large
        per = 2.0 / (small * small + square)
        return side * (square * per - 1.0), g * h * per                                 # (M2)

    signed = side * root
    cos_y, sin_y = angle(A, C, B, D, m_y, signed)
    _, sin_yx = angle(B, C, A, D, m_yx, signed)
    cos_bx, sin_bx = angle(A_bx, C_bx, B_bx, D_bx, m_bx, -signed)
    cos_x, sin_x, sin_x_over_k = cc - ss, sc + sc, sc_left + sc_left
    sin_bx_k = sin_bx * k
    cos_b, sin_b = cos_x * cos_bx - sin_x * sin_bx_k, sin_x * cos_bx + cos_x * sin_bx_k

    per = 1.0 / sin_mu_over_k
    d_bx = -a4 / a2 * sin_y * per                                                       # (M4)
    d_mu = a1 * a4 / (a2 * a3) * sin_x_over_k * per                                     # (M5)
    d_y = -a1 / a3 * sin_bx * per                                                       # (M6)
    d_b = -a1 / a2 * sin_yx * per                                                       # (M7)
    meets = can_lie_flat and is_zero(n, fabs(C1) + fabs(D1))                # a1 = a4, a2 = a3
    q = where(meets, 1.0, (a1 - a4)**2 + 4.0 * a1 * a4 * ss)                            # (M8)
    per = 1.0 / q
    turn = a1 * a4 * sin_x * where(q.real > fabs(e), (e + f * d_mu) * per, d_y + d_bx)  # (M9)
    dd_mu = (2.0 * a1 * a4 * s2 * where(flat_at_pi, c, cc) * u_left              # (M10), (M15)
             - 2.0 * a1 * a4 * s1 * where(flat_at_0, s, ss) * w_left) / (u_left * w_left * root)
    dd_y = where(meets, 0.5 * dd_mu, ((y_near * cc + y_far * ss) * dd_mu - turn) * per)   # (M11)
    dd_b = where(meets, -0.5 * dd_mu, ((b_near * cc + b_far * ss) * dd_mu - turn) * per)  # (M12)
    return LoopMotion((cos_b, sin_b, d_b, dd_b), (cos_y, sin_y * k, d_y, dd_y),
                      (cos_bx, sin_bx_k, d_bx, dd_b), (cos_mu, sin_mu_over_k * k, d_mu, dd_mu))
