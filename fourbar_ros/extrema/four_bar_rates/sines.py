# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The output's rate and acceleration at constant input rate, and all that their extrema need.

With x = theta1, y = theta4, b = beta and u the elliptic parameter of
:mod:`fourbar_ros.extrema.four_bar_rates.input_paths`, the derivatives

    X = dx/du = a2 a3 sin(y-b),    Y = dy/du = a1 a2 sin(x-b),    B = db/du = a1 a3 sin(x-y)

are sines, and by the loop so are their differences, X - B = a3 a4 sin(y), Y - B = a1 a4 sin(x).
Then dy/dx = Y/X, d2y/dx2 = g/X^3, d3y/dx3 = k/X^5 with g = Y_u X - Y X_u and k = g_u X - 3 g X_u,
smooth everywhere, toggles included. The roots of g are the extrema of theta4', those of k the
extrema of theta4''.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.mechanisms.half_angle import Factors, half_angle_coefficients
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.number_types import NumberType, Scalar

Sines = Callable[..., tuple[Any, ...]]


def make_sines(n: NumberType, constants: Sequence[Scalar] | Array, by_loop: bool = False) -> Sines:
    """
    Return the function (ss, cc, sc) -> (g, g_u, k, k_u, X, Y), of s, c = sin, cos(theta1/2).

    Roots of g and k are the extrema, see above. ``constants`` are those of :func:`sine_constants`;
    the pose is found as in :func:`~fourbar_ros.mechanisms.four_bar.motion.make_motion`. u is in
    units of 1/(a2 a3): X = sin(y-b). A fourth argument tells whether sc has the sign of X, where
    that is known beforehand. ``by_loop``: Y and the cosine that belongs to it follow from the
    others by the loop, which is faster, but loses digits where lengths are unequal.
    """
    sqrt, fabs, where = n.sqrt, n.fabs, n.where
    s1, s2, k, yA, yB, yC, yD, yM, bA, bB, bC, bD, bM, r13, r42, half, sign = constants
    # as in the motion of a four-bar, (M1) and (M2): what adds for one angle adds for both
    adding, other = (yB, yD, bB, bD, 1.0), (yA, yC, bA, bC, -1.0)
    half_k, half_cX = half * k, 0.5 * half
    half_cx = half_cX * k
    if by_loop:     # (a3^2 + a4^2 - a1^2 - a2^2) / (2 a2 a3)
        excess = 0.25 * half * (yM * (1.0 / r13 - r13) + bM * (1.0 / r42 - r42))

    def sines(ss: Scalar, cc: Scalar, sc: Scalar, adds: bool | None = None) -> tuple[Scalar, ...]:
        """
        Return g, g_u, k, k_u, X, Y at a theta1, by the squares and product of s, c = sin, cos.

        X, Y are dtheta4/du and dtheta1/du as sines, g and k vanish at extrema; names like XB are
        X - B, cX is the cosine of the angle whose sine is X.
        """
        u, w = s1 + k * cc, s2 + k * ss
        root = sign * sqrt(fabs(u * w))       # at a toggle u or w may round to less than zero
        y_s, y_c, b_s, b_c, side = where(sc * root > 0.0 if adds is None else adds, adding, other)
        signed = side * root
        p, q = y_s * ss + y_c * cc, yM * sc + signed
        scale = side * r42 / (p * p + q * q)
        cy, XB = (q - p) * (q + p) * scale, 2.0 * side * p * q * scale     # a3 a4 cos(y), X - B
        cX, X = half_cX * (u - w), half * root                         # a2 a3 cos(y-b)
        cx, YB = half_cx * (cc - ss), half_k * sc                      # a1 a4 cos(x), Y - B
        if by_loop:
            cY, Y = cy + excess, YB + (X - XB)                         # a1 a2 cos(x-b)
        else:
            p, q = b_s * ss + b_c * cc, bM * sc - signed
            scale = side * r13 / (p * p + q * q)
            cY, Y = (q - p) * (q + p) * scale, -2.0 * side * p * q * scale
        Xu = cX * YB
        Yu = cY * XB
        P, Q = cY * cy - XB * XB, cX * cx - YB * YB                    # Y_uu/Y, X_uu/X
        XY, PQ = X * Y, P - Q
        g, gu = Yu * X - Y * Xu, XY * PQ
        guu = (Xu * Y + X * Yu) * PQ + XY * (X * YB * (3.0 * cx + cX) - Y * XB * (3.0 * cy + cY))
        return g, gu, gu * X - 3.0 * g * Xu, guu * X - 2.0 * gu * Xu - 3.0 * g * X * Q, X, Y
    return sines


def sine_constants(lengths: Sequence[Values], factors: Factors, sign: Values) -> tuple[Any, ...]:
    """
    Return the constants of :func:`make_sines`; the largest length should be about one.

    ``factors`` are the :func:`.bilinear_factors` of the lengths. Their products are s1, s2 of
    :mod:`.input_paths` and the :func:`.half_angle_coefficients`.
    """
    (a1, a2, a3, a4), f = lengths, factors
    of_y, of_bx = half_angle_coefficients(f)
    return (-f.A1 * f.B2, f.C1 * f.D1, 4.0 * a1 * a4,
            *of_y, 4.0 * a1 * a3, *of_bx, -4.0 * a2 * a4,
            a1 / a3, a4 / a2, 0.5 / (a2 * a3), sign)
