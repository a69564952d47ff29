# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact number of extrema of the output's rate and acceleration at constant input rate.

In q = |A O4|^2 both are roots of polynomials with integer coefficients, as every float is an
integer over a power of two. With e = a1^2 - a4^2, f = a2^2 - a3^2 and

    S = ((a1+a4)^2 - q)(q - (a1-a4)^2) = (2 a1 a4 sin theta1)^2,
    T = ((a2+a3)^2 - q)(q - (a2-a3)^2) = (2 a2 a3 sin mu)^2,

theta4'' = [-e rS + s R/T^(3/2)]/(2 q^2) and theta4''' = [e (4 S - q S_q) + s rS M/T^(5/2)]/(4
q^3), where rS^2 = S with the sign of sin theta1, s is the assembly mode, R = -f S T + q (q+f)(S_q
T - S T_q)/2, M = 2 q T R_q - 4 R T - 3 q R T_q. So the extrema are the roots of P6 = (e^2 S T^3 -
R^2)/q^2 and P11 = (e^2 (4 S - q S_q)^2 T^5 - S M^2)/q^3, of degree 6 and 11, each in one theta1 of
each mode, between the largest and the smallest q of the motion; Sturm's theorem counts them. Where
theta1 passes through 0 or pi, at an end of that range of q, S is zero and so is theta4'' if R is;
it then changes its sign with that of rS.
"""
from __future__ import annotations

from collections.abc import Sequence

from fourbar_ros.numerics.sturm import count_roots, Polynomial


def count_extrema(lengths: Sequence[float]) -> list[int | None]:
    """
    Return the numbers of extrema of theta4' and theta4'' in one mode.

    Ends of the input range excluded.

    Parameters
    ----------
    lengths : sequence of 4 floats
        a1, a2, a3, a4.

    Returns
    -------
    list of 2 (int or None)
        The counts for theta4' and theta4''. None where the count proves nothing: the quantity is
        constant in a range, or its derivative may touch zero without a change of sign.

    """
    ratios = [float(length).as_integer_ratio() for length in lengths]
    unit = max(denominator for _, denominator in ratios)
    a1, a2, a3, a4 = (numerator * (unit // denominator) for numerator, denominator in ratios)
    e, f = (a1 - a4) * (a1 + a4), (a2 - a3) * (a2 + a3)
    q, q_plus_f = Polynomial([0, 1]), Polynomial([f, 1])
    S = Polynomial([(a1 + a4)**2, -1]) * Polynomial([-(a1 - a4)**2, 1])
    T = Polynomial([(a2 + a3)**2, -1]) * Polynomial([-(a2 - a3)**2, 1])
    S_q, T_q = S.derivative, T.derivative
    R2 = -2 * f * (S * T) + q * q_plus_f * (S_q * T - S * T_q)            # 2 R
    M2 = 2 * (q * T * R2.derivative) - R2 * (4 * T + 3 * (q * T_q))       # 2 M
    low, high = max((a1 - a4)**2, (a2 - a3)**2), min((a1 + a4)**2, (a2 + a3)**2)
    # both signs of theta1 for each root, and theta4''' is also zero at theta1 = pi
    if e == 0:
        numbers = [count_roots(P, low, high) for P in (R2, M2)]
        through_pi = high < (a2 + a3)**2
        return [number if number is None else 2 * number + extra
                for number, extra in zip(numbers, (0, through_pi))]
    W = 4 * S - q * S_q
    P6 = 4 * e * e * (S * T**3) - R2 * R2
    P11 = 4 * e * e * (W * W * T**5) - S * M2 * M2
    rates, accelerations = (count_roots(P, low, high) for P in (P6, P11))
    passed = ((a1 - a4)**2, (a2 - a3)**2 < (a1 - a4)**2), ((a1 + a4)**2,
                                                           (a1 + a4)**2 < (a2 + a3)**2)
    extra = sum(is_passed and R2(at) == 0 for at, is_passed in passed)
    return [rates if rates is None else rates + extra, accelerations]
