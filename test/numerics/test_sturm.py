# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Exact counts of roots: polynomials made of known roots."""
from fourbar_lab.reproduction.exact_count import count_roots, Polynomial
import numpy as np
import pytest


def from_roots(roots, others=()):
    """Return (x - r)... for whole roots, times (x^2 + b x + c)... without real roots."""
    P = Polynomial([1])
    for root in roots:
        P = P * Polynomial([-int(root), 1])
    for b, c in others:
        assert b * b < 4 * c
        P = P * Polynomial([c, b, 1])
    return P


@pytest.mark.parametrize('seed', range(20))
def test_known_roots_are_counted(seed):
    rng = np.random.default_rng(seed)
    roots = rng.choice(np.arange(-40, 41), rng.integers(1, 9), replace=False)
    P = from_roots(roots, [(1, 7), (-2, 30)][:rng.integers(0, 3)])
    for low, high in ((-50, 50), (-11, 13), (0, 41)):
        inside = roots[(roots > low) & (roots < high) & (roots != 0)]       # 0: see there
        if not {low, high} & set(roots.tolist()):
            assert count_roots(P, low, high) == len(inside)


def test_large_coefficients_and_close_roots():
    """Two roots that a double cannot tell apart: exact all the same."""
    far = 10**20
    P = from_roots([far, far + 1, -3])
    assert count_roots(P, far - 5, far + 5) == 2 and count_roots(P, -10, 10) == 1
    assert float(far) == float(far + 1)


def test_arithmetic_is_that_of_integers():
    P, Q = Polynomial([1, -2, 3]), Polynomial([0, 5])
    for x in (-3, 0, 4, 10**30):
        assert (P * Q)(x) == P(x) * Q(x)
        assert (P + Q)(x) == P(x) + Q(x) and (P - Q)(x) == P(x) - Q(x)
        assert (P**3)(x) == P(x)**3
    assert P.derivative.c == [-2, 6] and (P - P).c == []
