# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Number of real roots of a polynomial with integer coefficients in an interval.

Sturm's theorem, exact.

Source: Basu, Pollack, Roy, Algorithms in Real Algebraic Geometry, section 2.2. The optional
python-flint has such polynomials too, but an exact count is to be there without it, and takes
milliseconds.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import gcd


class Polynomial:
    """
    A polynomial with integer coefficients of any size.

    Parameters
    ----------
    c : sequence of int
        Coefficients, the lowest power first; zeros at the end are dropped.

    """

    __slots__ = ('c',)

    def __init__(self, c: Sequence[int]):
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
    Return the number of roots of P between low and high, both excluded, and without that at 0.

    None if one of them is not simple, or P is zero.
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
    """Return the number of distinct roots of the first of a Sturm chain between low and high."""
    def sign_changes(x: int) -> int:
        signs = [value > 0 for value in (P(x) for P in chain) if value]
        return sum(one is not other for one, other in zip(signs, signs[1:]))
    return sign_changes(low) - sign_changes(high)


def sturm_chain(P: Polynomial) -> list[Polynomial]:
    """
    Return the Sturm chain of P, not zero.

    Each member divided by the content of its coefficients.
    """
    chain = [_primitive(P), _primitive(P.derivative)]
    while len(chain[-1].c) > 1:
        remainder = _negative_remainder(chain[-2], chain[-1])
        if not remainder.c:
            break
        chain.append(_primitive(remainder))
    return chain


def _negative_remainder(P: Polynomial, D: Polynomial) -> Polynomial:
    """Return -(P mod D) times a positive integer."""
    size, sign = abs(D.c[-1]), 1 if D.c[-1] > 0 else -1
    while len(P.c) >= len(D.c):
        shift = [0] * (len(P.c) - len(D.c))
        P = size * P - sign * P.c[-1] * Polynomial([*shift, *D.c])
    return -1 * P


def _primitive(P: Polynomial) -> Polynomial:
    """Return P divided by the greatest common divisor of its coefficients."""
    content = gcd(*P.c) or 1
    return Polynomial([c // content for c in P.c])
