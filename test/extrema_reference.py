"""
Exact extremes of theta4' and theta4'' at constant input rate, by another road than the package takes.

In q = |A O4|^2 they are roots of polynomials of degree 6 and 11 with rational coefficients. Here their real
roots are isolated by Descartes' rule with bisection (the package counts with Sturm's theorem), in integers,
and refined by bisection to 400 bits; theta1 follows in mpmath, its sign from the equation that was squared.
"""
from fractions import Fraction

import mpmath
import numpy as np

BITS = 400


class Polynomial:
    """Polynomial with Fraction coefficients, lowest power first."""

    def __init__(self, *coefficients):
        self.c = [Fraction(v) for v in coefficients]

    def __add__(self, other):
        size = max(len(self.c), len(other.c))
        a, b = (p.c + [Fraction(0)] * (size - len(p.c)) for p in (self, other))
        return Polynomial(*(x + y for x, y in zip(a, b)))

    def __sub__(self, other):
        return self + other * -1

    def __mul__(self, other):
        if not isinstance(other, Polynomial):
            return Polynomial(*(v * other for v in self.c))
        product = [Fraction(0)] * (len(self.c) + len(other.c) - 1)
        for i, a in enumerate(self.c):
            for j, b in enumerate(other.c):
                product[i + j] += a * b
        return Polynomial(*product)

    def __call__(self, x):
        value = 0 * x
        for c in reversed(self.c):
            value = value * x + (c if isinstance(x, Fraction) else mpmath.mpf(c.numerator) / c.denominator)
        return value

    def derivative(self):
        return Polynomial(*(i * c for i, c in enumerate(self.c)), 0) .shift_down()

    def shift_down(self):
        return Polynomial(*self.c[1:])


def exact_roots(lengths, order):
    """
    Return the theta1 of mode 2, as mpmath numbers in (-pi, pi], of all extremes inside the input range.

    ``order``: 0 for theta4', 1 for theta4''. For a1 != a4 and simple roots.
    """
    a1, a2, a3, a4 = map(Fraction, lengths)
    e, f, q = a1**2 - a4**2, a2**2 - a3**2, Polynomial(0, 1)
    S = Polynomial((a1 + a4)**2, -1) * Polynomial(-(a1 - a4)**2, 1)
    T = Polynomial((a2 + a3)**2, -1) * Polynomial(-(a2 - a3)**2, 1)
    dS, dT = S.derivative(), T.derivative()
    R = S * T * -f + q * Polynomial(f, 1) * (dS * T - S * dT) * Fraction(1, 2)
    if order == 0:
        P, factor = S * T * T * T * e**2 - R * R, R * e
    else:
        M = q * T * R.derivative() * 2 - R * T * 4 - q * R * dT * 3
        W = S * 4 - q * dS
        P, factor = W * W * T * T * T * T * T * e**2 - S * M * M, W * M * -e
    low, high = max((a1 - a4)**2, (a2 - a3)**2), min((a1 + a4)**2, (a2 + a3)**2)
    found = []
    for root in isolated_roots(P, low, high):
        with mpmath.workprec(BITS):
            sine = mpmath.sqrt(root - mpmath.mpf(((a1 - a4)**2).numerator) / ((a1 - a4)**2).denominator)
            k = 4 * a1 * a4
            cosine = mpmath.sqrt(mpmath.mpf(((a1 + a4)**2).numerator) / ((a1 + a4)**2).denominator - root)
            x = 2 * mpmath.atan2(sine, cosine)
            found.append(x if factor(root) > 0 else -x)
    return found


def isolated_roots(P, low, high):
    """Return the roots of P between two bounds, none of them a root inside, to BITS bits."""
    work, found = [(low, high)], []
    while work:
        a, b = work.pop()
        changes = descartes(P, a, b)
        if changes == 1:
            found.append(bisected(P, a, b))
        elif changes > 1:
            middle = (a + b) / 2
            assert P(middle) != 0
            work += [(a, middle), (middle, b)]
    return found


def descartes(P, a, b):
    """Return the sign changes of the coefficients of (1+t)^n P((a + b t)/(1 + t)): roots in (a, b), or more."""
    c = list(P.c)
    n = len(c)
    for i in range(n - 1):                              # P(x + a)
        for j in range(n - 2, i - 1, -1):
            c[j] += a * c[j + 1]
    c = [v * (b - a)**i for i, v in enumerate(c)][::-1]    # t = 1/x - 1 on (0, 1)
    for i in range(n - 1):
        for j in range(n - 2, i - 1, -1):
            c[j] += c[j + 1]
    signs = [v > 0 for v in c if v]
    return sum(one != other for one, other in zip(signs, signs[1:]))


def bisected(P, a, b):
    """Return the one root between a and b as an mpmath number."""
    with mpmath.workprec(4 * BITS):
        def at(x):
            return P(x)
        a, b = (mpmath.mpf(v.numerator) / v.denominator for v in (a, b))
        width = b - a
        # the ends may be roots themselves: step inside by less than any distance of roots
        sign = at(a + mpmath.ldexp(width, -BITS)) > 0
        for _ in range(BITS):
            middle = (a + b) / 2
            if (at(middle) > 0) == sign:
                a = middle
            else:
                b = middle
        return (a + b) / 2


def families():
    """Return the 19 families of linkages: name -> function of a random generator to four lengths."""
    def uniform(rng):
        return rng.uniform(0.1, 1.0, 4)

    def shortest_plus_longest(rng, gap):
        """Lengths from short to long; the gap of Grashof's sum, relative to the longest, if any."""
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
            **{f'crank gap {gap:.0e}': crank(gap) for gap in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)},
            **{f'gap {gap:.0e}': any_gap(gap) for gap in (1e-4, 1e-8)},
            **{f'near parallelogram {size:.0e}': near_parallelogram(size) for size in (1e-3, 1e-6, 1e-9)},
            **{f'ratios {size:.0e}': ratios(size) for size in (1e-2, 1e-4, 1e-6)}}
