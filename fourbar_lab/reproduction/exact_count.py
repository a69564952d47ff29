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

Source of the theorem: Basu, Pollack, Roy, Algorithms in Real Algebraic Geometry, section 2.2.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import gcd


def count_extrema(lengths: Sequence[float]) -> list[int | None]:
    """
    Return the numbers of extrema of theta4' and theta4'' in one mode, without ends of the range.

    ``lengths``: a1, a2, a3, a4. A count is None where it proves nothing: the quantity is constant
    in a range, or its derivative may touch zero without a change of sign.
    """
    ratios = [float(length).as_integer_ratio() for length in lengths]
    unit = max(denominator for _, denominator in ratios)
    a1, a2, a3, a4 = (numerator * (unit // denominator) for numerator, denominator in ratios)
    R2, M2, P6, P11 = rate_polynomials(a1, a2, a3, a4)
    low, high = max((a1 - a4)**2, (a2 - a3)**2), min((a1 + a4)**2, (a2 + a3)**2)
    # both signs of theta1 for each root, and theta4''' is also zero at theta1 = pi
    if a1 == a4:
        numbers = [count_roots(P, low, high) for P in (R2, M2)]
        through_pi = high < (a2 + a3)**2
        return [number if number is None else 2 * number + extra
                for number, extra in zip(numbers, (0, through_pi))]
    rates, accelerations = (count_roots(P, low, high) for P in (P6, P11))
    passed = ((a1 - a4)**2, (a2 - a3)**2 < (a1 - a4)**2), ((a1 + a4)**2,
                                                           (a1 + a4)**2 < (a2 + a3)**2)
    extra = sum(is_passed and R2(at) == 0 for at, is_passed in passed)
    return [rates if rates is None else rates + extra, accelerations]


def rate_polynomials(a1: int, a2: int, a3: int, a4: int) -> tuple[Polynomial, ...]:
    """
    Return the polynomials 2 R, 2 M, 4 q^2 P6, 4 q^3 P11 in q = |A O4|^2, for whole lengths.

    The top of this file defines them; factors make all coefficients integers.
    """
    e, f = (a1 - a4) * (a1 + a4), (a2 - a3) * (a2 + a3)
    q, q_plus_f = Polynomial([0, 1]), Polynomial([f, 1])
    S = Polynomial([(a1 + a4)**2, -1]) * Polynomial([-(a1 - a4)**2, 1])
    T = Polynomial([(a2 + a3)**2, -1]) * Polynomial([-(a2 - a3)**2, 1])
    S_q, T_q = S.derivative, T.derivative
    R2 = -2 * f * (S * T) + q * q_plus_f * (S_q * T - S * T_q)            # 2 R
    M2 = 2 * (q * T * R2.derivative) - R2 * (4 * T + 3 * (q * T_q))       # 2 M
    W = 4 * S - q * S_q
    return (R2, M2, 4 * e * e * (S * T**3) - R2 * R2,
            4 * e * e * (W * W * T**5) - S * M2 * M2)


class Polynomial:
    """A polynomial with integer coefficients c of any size, the lowest power first."""

    __slots__ = ('c',)

    def __init__(self, c: Sequence[int]):
        """Drop zeros at the end, so that the degree is right."""
        size = len(c)
        while size and c[size - 1] == 0:
            size -= 1
        self.c = list(c[:size])

    def __call__(self, x: int) -> int:
        """Return the value at x, by Horner's rule."""
        value = 0
        for c in reversed(self.c):
            value = value * x + c
        return value

    def __add__(self, other: Polynomial) -> Polynomial:
        longer, shorter = (self.c, other.c) if len(self.c) > len(other.c) else (other.c, self.c)
        return Polynomial([a + b for a, b in zip(longer, shorter)] + longer[len(shorter):])

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + -1 * other

    def __mul__(self, other: Polynomial) -> Polynomial:
        """Return the product, coefficient by coefficient."""
        c = [0] * (len(self.c) + len(other.c))
        for i, a in enumerate(self.c):
            for j, b in enumerate(other.c):
                c[i + j] += a * b
        return Polynomial(c)

    def __rmul__(self, factor: int) -> Polynomial:
        return Polynomial([factor * c for c in self.c])

    def __pow__(self, exponent: int) -> Polynomial:
        power = Polynomial([1])
        for _ in range(exponent):
            power = power * self
        return power

    @property
    def derivative(self) -> Polynomial:
        """Return the first derivative."""
        return Polynomial([i * c for i, c in enumerate(self.c)][1:])

    def without_root(self, root: int) -> Polynomial:
        """Return the quotient by (x - root), which leaves no remainder."""
        quotient, carry = [], 0
        for c in reversed(self.c):
            carry = c + root * carry
            quotient.append(carry)
        return Polynomial(quotient[-2::-1])


def count_roots(P: Polynomial, low: int, high: int) -> int | None:
    """
    Return the number of roots of P between low and high, without both ends and 0.

    None if one of them is not simple, or P is zero. (x - 1)(x - 2)(x - 5) has 2 between 0 and 3.
    """
    for end in (0, low, high):
        while P.c and P(end) == 0:
            P = P.without_root(end)
    if not P.c:
        return None
    chain = sturm_chain(P)
    if len(chain[-1].c) > 1 and _changes(sturm_chain(chain[-1]), low, high):
        return None
    return _changes(chain, low, high)


def _changes(chain: list[Polynomial], low: int, high: int) -> int:
    """
    Return the number of distinct roots between low and high of the first of a Sturm chain.

    Sturm: the chain changes its sign from member to member so many times less at ``high``.
    """
    def sign_changes(x: int) -> int:
        """Return how often neighbours in the chain, without zeros, differ in sign at x."""
        signs = [value > 0 for value in (P(x) for P in chain) if value]
        return sum(one is not other for one, other in zip(signs, signs[1:]))
    return sign_changes(low) - sign_changes(high)


def sturm_chain(P: Polynomial) -> list[Polynomial]:
    """
    Return the Sturm chain of P, not zero: P, P', then minus the remainder of each two before.

    Common factors are divided out, or integers would grow to thousands of digits.
    """
    chain = [_primitive(P), _primitive(P.derivative)]
    while len(chain[-1].c) > 1:
        remainder = _negative_remainder(chain[-2], chain[-1])
        if not remainder.c:
            break
        chain.append(_primitive(remainder))
    return chain


def _negative_remainder(P: Polynomial, D: Polynomial) -> Polynomial:
    """Return -(P mod D) times a positive integer, by which it stays a polynomial of integers."""
    size, sign = abs(D.c[-1]), 1 if D.c[-1] > 0 else -1
    while len(P.c) >= len(D.c):
        shift = [0] * (len(P.c) - len(D.c))
        P = size * P - sign * P.c[-1] * Polynomial([*shift, *D.c])
    return -1 * P


def _primitive(P: Polynomial) -> Polynomial:
    """Return P divided by the greatest common divisor of its coefficients."""
    content = gcd(*P.c) or 1
    return Polynomial([c // content for c in P.c])
