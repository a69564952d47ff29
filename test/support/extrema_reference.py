# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact extrema of theta4' and theta4'' at constant input rate.

By another road than the package takes.

In q = |A O4|^2 they are roots of polynomials of degree 6 and 11 with rational coefficients. Here
their real roots are isolated by Descartes' rule with bisection (the package counts with Sturm's
theorem), in integers, and refined by bisection; theta1 follows in mpmath, its sign from the
equation that was squared.
"""
from itertools import zip_longest

import mpmath
import numpy as np

BITS = 160       # after the point of q in units of the last bit of the shortest length


class Polynomial:
    """Polynomial with integer coefficients, lowest power first."""

    def __init__(self, *coefficients):
        self.c = coefficients

    def __add__(self, other):
        return Polynomial(*(a + b for a, b in zip_longest(self.c, other.c, fillvalue=0)))

    def __sub__(self, other):
        return self + other * -1

    def __mul__(self, other):
        if isinstance(other, int):
            return Polynomial(*(v * other for v in self.c))
        product = [0] * (len(self.c) + len(other.c) - 1)
        for i, a in enumerate(self.c):
            for j, b in enumerate(other.c):
                product[i + j] += a * b
        return Polynomial(*product)

    def __call__(self, x):
        value = 0
        for c in reversed(self.c):
            value = value * x + c
        return value

    def derivative(self):
        return Polynomial(*[i * c for i, c in enumerate(self.c)][1:])

    def at(self, x, bits):
        """Return P(x / 2^bits) times a positive integer, for an integer x."""
        value = 0
        for i, c in enumerate(reversed(self.c)):
            value = value * x + (c << (bits * i))
        return value


def exact_roots(lengths, order):
    """
    Return (theta1, value) of all extrema inside the input range, mode 2, input rate 1 rad/s.

    In mpmath.

    ``order``: 0 for theta4', 1 for theta4''; theta1 in (-pi, pi]. For a1 != a4 and simple roots.
    """
    ratios = [float(length).as_integer_ratio() for length in lengths]
    unit = max(denominator for _, denominator in ratios)
    a1, a2, a3, a4 = (numerator * unit // denominator for numerator, denominator in ratios)
    e, f, q = a1**2 - a4**2, a2**2 - a3**2, Polynomial(0, 1)
    S = Polynomial((a1 + a4)**2, -1) * Polynomial(-(a1 - a4)**2, 1)
    T = Polynomial((a2 + a3)**2, -1) * Polynomial(-(a2 - a3)**2, 1)
    dS, dT = S.derivative(), T.derivative()
    R = S * T * (-2 * f) + q * Polynomial(f, 1) * (dS * T - S * dT)                  # 2 R
    if order == 0:
        P, factor = S * T * T * T * (4 * e**2) - R * R, R * e
    else:
        M = q * T * R.derivative() * 2 - R * T * 4 - q * R * dT * 3                  # 2 M
        W = S * 4 - q * dS
        P, factor = W * W * T * T * T * T * T * (4 * e**2) - S * M * M, W * M * -e
    found = []
    for root in isolated_roots(P, max((a1 - a4)**2, (a2 - a3)**2),
                               min((a1 + a4)**2, (a2 + a3)**2)):
        with mpmath.workprec(2 * BITS):
            q = mpmath.ldexp(root, -BITS)
            x = 2 * mpmath.atan2(mpmath.sqrt(q - (a1 - a4)**2), mpmath.sqrt((a1 + a4)**2 - q))
            sign = 1 if factor.at(root, BITS) > 0 else -1
            sine, t = sign * mpmath.sqrt(S(q)), T(q)
            if order == 0:
                value = (q + e + (q + f) * sine / mpmath.sqrt(t)) / (2 * q)
            else:
                value = (-e * sine + R(q) / 2 / mpmath.sqrt(t)**3) / (2 * q**2)
            found.append((sign * x, value))
    return found


def isolated_roots(P, low, high):
    """Return the roots of P between two integers, times 2^BITS, rounded down."""
    work, found = [(low, high, 0)], []
    while work:
        a, b, bits = work.pop()
        changes = descartes(P, a, b, bits)
        if changes == 1:
            found.append(bisected(P, a, b, bits))
        elif changes > 1:
            assert P.at(a + b, bits + 1) != 0
            work += [(2 * a, a + b, bits + 1), (a + b, 2 * b, bits + 1)]
    return found


def descartes(P, a, b, bits):
    """
    Return the sign changes of the coefficients of (1+t)^n P((a + b t)/(1 + t)).

    Roots between, or more.
    """
    c = [v << (bits * i) for i, v in enumerate(reversed(P.c))][::-1]
    shifted(c, a)
    c = [v * (b - a)**i for i, v in enumerate(c)][::-1]
    shifted(c, 1)
    signs = [v > 0 for v in c if v]
    return sum(one != other for one, other in zip(signs, signs[1:]))


def shifted(c, a):
    """Turn the coefficients of P(x) into those of P(x + a)."""
    for i in range(len(c) - 1):
        for j in range(len(c) - 2, i - 1, -1):
            c[j] += a * c[j + 1]


def bisected(P, a, b, bits):
    """
    Return the one root between a and b, of 2^bits, with BITS bits.

    The ends may be roots themselves.
    """
    a, b = a << (BITS - bits), b << (BITS - bits)
    sign = P.at(a + 1, BITS) > 0
    while b - a > 1:
        middle = (a + b) // 2
        if (P.at(middle, BITS) > 0) == sign:
            a = middle
        else:
            b = middle
    return a


def families():
    """
    Return the 19 families of linkages.

    Name -> function of a random generator to four lengths.
    """
    def uniform(rng):
        return rng.uniform(0.1, 1.0, 4)

    def shortest_plus_longest(rng, gap):
        """
        Lengths from short to long.

        The gap of Grashof's sum, relative to the longest, if any.
        """
        a = np.sort(uniform(rng))
        if gap is not None:
            a[3] = (a[1] + a[2] - a[0]) / (1.0 + gap * rng.choice((-1.0, 1.0)))
        return a

    def crank(gap=None):
        def draw(rng):
            while True:
                a = shortest_plus_longest(rng, None if gap is None else abs(gap))
                if gap is not None:
                    a[3] = (a[1] + a[2] - a[0]) * (1.0 - gap)
                if a[0] + a[3] < a[1] + a[2] and a[3] > 0.0:
                    return np.concatenate((a[:1], rng.permutation(a[1:])))
        return draw

    def grashof(wanted):
        def draw(rng):
            while True:
                a = np.sort(uniform(rng))
                if (a[0] + a[3] < a[1] + a[2]) == wanted and a[3] < a[:3].sum():
                    return rng.permutation(a)
        return draw

    def any_gap(gap):
        return lambda rng: rng.permutation(shortest_plus_longest(rng, gap))

    def near_isosceles(size):
        def draw(rng):
            a = uniform(rng)
            a[3] = a[0] * (1.0 + size * rng.normal())
            return a
        return draw

    def near_parallelogram(size):
        def draw(rng):
            a, b = rng.uniform(0.1, 1.0, 2)
            return np.array((a, b, a, b)) * (1.0 + size * rng.normal(size=4))
        return draw

    def ratios(smallest):
        return lambda rng: smallest**rng.uniform(0.0, 1.0, 4)

    return {'crank': crank(), 'Grashof': grashof(True), 'non-Grashof': grashof(False),
            'a1 near a4 1e-6': near_isosceles(1e-6), 'a1 near a4 1e-12': near_isosceles(1e-12),
            **{f'crank gap {gap:.0e}': crank(gap) for gap in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10,
                                                              1e-12)},
            **{f'gap {gap:.0e}': any_gap(gap) for gap in (1e-4, 1e-8)},
            **{f'near parallelogram {size:.0e}': near_parallelogram(size)
               for size in (1e-3, 1e-6, 1e-9)},
            **{f'ratios {size:.0e}': ratios(size) for size in (1e-2, 1e-4, 1e-6)}}
