# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact extrema of the output's rate and acceleration at constant input rate.

In q = |A O4|^2 both are roots of polynomials with integer coefficients, as every float is an
integer over a power of two; FLINT isolates them. With e = a1^2 - a4^2, f = a2^2 - a3^2 and

    S = ((a1+a4)^2 - q)(q - (a1-a4)^2) = (2 a1 a4 sin theta1)^2,
    T = ((a2+a3)^2 - q)(q - (a2-a3)^2) = (2 a2 a3 sin mu)^2,

theta4'' = [-e rS + s R/T^(3/2)]/(2 q^2) and theta4''' = [e (4 S - q S_q) + s rS M/T^(5/2)]/(4
q^3), where rS^2 = S with the sign of sin theta1, s is the assembly mode, R = -f S T + q (q+f)(S_q
T - S T_q)/2, M = 2 q T R_q - 4 R T - 3 q R T_q. So the extrema are the roots of P6 = (e^2 S T^3 -
R^2)/q^2 and P11 = (e^2 (4 S - q S_q)^2 T^5 - S M^2)/q^3, of degree 6 and 11, each in one theta1 of
each mode, between the largest and the smallest q of the motion. Where theta1 passes through 0 or
pi, at an end of that range of q, S is zero and so is theta4'' if R is; it then changes its sign
with that of rS.
"""
from typing import NamedTuple

from flint import ctx, fmpz_poly
import mpmath

BITS = 400      # of roots: enough to tell those of doubles from each other


class InQ(NamedTuple):
    """The polynomials above for whole lengths; 2 R and 2 M have whole coefficients."""

    S: fmpz_poly
    T: fmpz_poly
    R2: fmpz_poly
    M2: fmpz_poly
    W: fmpz_poly        # 4 S - q S_q


def whole(lengths):
    """Return the lengths in units of the last bit of the shortest."""
    ratios = [float(length).as_integer_ratio() for length in lengths]
    unit = max(denominator for _, denominator in ratios)
    return [numerator * (unit // denominator) for numerator, denominator in ratios]


def in_q(a1, a2, a3, a4):
    """Return :class:`InQ` of whole lengths."""
    f, q = a2**2 - a3**2, fmpz_poly([0, 1])
    S = ((a1 + a4)**2 - q) * (q - (a1 - a4)**2)
    T = ((a2 + a3)**2 - q) * (q - (a2 - a3)**2)
    R2 = -2 * f * S * T + q * (q + f) * (S.derivative() * T - S * T.derivative())
    M2 = 2 * q * T * R2.derivative() - 4 * R2 * T - 3 * q * R2 * T.derivative()
    return InQ(S, T, R2, M2, 4 * S - q * S.derivative())


def condition(p, e, order):
    """Return the multiple of P6 (``order`` 0) or P11 (1) with whole coefficients."""
    if order == 0:
        return 4 * e**2 * p.S * p.T**3 - p.R2**2
    return 4 * e**2 * p.W**2 * p.T**5 - p.S * p.M2**2


def limits(a1, a2, a3, a4):
    """Return the least and the largest q of the motion."""
    return max((a1 - a4)**2, (a2 - a3)**2), min((a1 + a4)**2, (a2 + a3)**2)


def roots_between(P, low, high):
    """Return [(root, multiplicity)] of P between low and high, without both ends and 0."""
    for end in (0, low, high):
        while P.degree() >= 0 and P(end) == 0:
            P //= fmpz_poly([-end, 1])
    before, ctx.prec = ctx.prec, BITS
    try:
        found = [(root.real, multiplicity) for root, multiplicity in P.complex_roots()
                 if root.imag == 0]
        assert all((root < high or root > high) and (root < low or root > low)
                   for root, _ in found)
        return [(root, multiplicity) for root, multiplicity in found if low < root < high]
    finally:
        ctx.prec = before


def exact_roots(lengths, order):
    """
    Return (theta1, value) of all extrema inside the input range, mode 2, input rate 1 rad/s.

    In mpmath. ``order``: 0 for theta4', 1 for theta4''; theta1 in (-pi, pi]. For a1 != a4 and
    simple roots.
    """
    a1, a2, a3, a4 = sides = whole(lengths)
    e, f, p = a1**2 - a4**2, a2**2 - a3**2, in_q(*sides)
    factor = p.R2 * e if order == 0 else p.W * p.M2 * -e
    found = []
    for root, _ in roots_between(condition(p, e, order), *limits(*sides)):
        with mpmath.workprec(BITS):
            q = mpmath.ldexp(*map(int, root.mid().man_exp()))
            x = 2 * mpmath.atan2(mpmath.sqrt(q - (a1 - a4)**2), mpmath.sqrt((a1 + a4)**2 - q))
            steepness, s, t, r2 = (mpmath.polyval([int(c) for c in reversed(P.coeffs())], q)
                                   for P in (factor, p.S, p.T, p.R2))
            sign = 1 if steepness > 0 else -1
            if order == 0:
                value = (q + e + (q + f) * sign * mpmath.sqrt(s / t)) / (2 * q)
            else:
                value = (-e * sign * mpmath.sqrt(s) + r2 / 2 / mpmath.sqrt(t)**3) / (2 * q**2)
            found.append((sign * x, value))
    return found
