# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Roots: intervals that have them, Newton's method in brackets, in floats and arrays."""
from math import pi

from fourbar_ros.numerics import roots
from fourbar_ros.numerics.roots import newton_roots
import numpy as np
import pytest
from scipy.optimize import brentq
from support.cartesian import EPS


@pytest.mark.parametrize('function, derivative, low, high', [
    (lambda x: x * x - 2.0, lambda x: 2.0 * x, 0.0, 2.0),
    (lambda x: x**3, lambda x: 3.0 * x * x, -1.0, 0.7),         # the slope is zero at the root
    (np.arctan, lambda x: 1.0 / (1.0 + x * x), -20.0, 30.0),    # Newton alone diverges
    (lambda x: np.exp(-x) - 1e-6, lambda x: -np.exp(-x), 0.0, 300.0),
    (lambda x: np.sign(x - 0.3) * np.abs(x - 0.3)**0.5,         # Newton alone jumps to and fro
     lambda x: 0.5 * (np.abs(x - 0.3) + 1e-300)**-0.5, 0.0, 1.0)])
def test_newton_in_a_bracket_against_brentq(function, derivative, low, high):
    def step(x):
        f, slope = float(function(x)), float(derivative(x))
        return f, f / slope if slope else np.inf

    truth = brentq(function, low, high, xtol=1e-15, rtol=4 * EPS, maxiter=1000)
    guess = 0.5 * (low + high)
    given = [np.array([v, v]) for v in (low, high, function(low), guess)]
    many = newton_roots(lambda x, row: tuple(np.array(v) for v in zip(*map(step, x))),
                        np.arange(2), *given)
    # x^3 is flat
    tolerance = 1e-5 if abs(derivative(truth)) < 1e-4 else 1e-14 * max(1.0, abs(truth))
    assert np.abs(many - truth).max() <= tolerance


@pytest.mark.parametrize('low, high, at_low', [(0.0, 3.0, 0.0), (-3.0, 0.0, -3.0)])
def test_a_zero_at_an_end_is_not_taken_for_the_change_of_sign(low, high, at_low):
    """Zero counts as positive: |x| (2 - |x|) is positive from 0 on and changes its sign at +-2."""
    def step(x):
        f = np.abs(x) * (2.0 - np.abs(x))
        return f, f / (2.0 * np.sign(x) - 2.0 * x)

    given = [np.array([v]) for v in (low, high, at_low, 0.0)]
    many = newton_roots(lambda x, row: step(x), np.arange(1), *given)
    assert abs(many[0]) == pytest.approx(2.0, rel=2 * EPS)


def test_slopes_from_samples_are_exact_for_polynomials():
    """Five samples: exact to the fourth power inside, at the ends by cubics to the third."""
    x = np.arange(9.0)
    for power in range(5):
        f = x[:, None] ** power
        exact = power * x ** (power - 1 if power else 0) / 3.0
        inside = slice(2, -2) if power == 4 else slice(None)
        assert np.abs(roots.rises(f, False)[:, 0] - exact)[inside].max() <= (
            64 * EPS * max(1.0, 8.0**power))


def test_a_pair_of_roots_between_two_samples_is_found():
    """A dip that crosses zero twice between samples of one sign, however narrow."""
    interval = [np.array([v]) for v in (0, 0.0, 1.0)]
    for gap in (1e-2, 1e-4, 1e-6):
        which, xa, xb, fa, fb = roots.look_closer(
            lambda x, row, gap=gap: (x - 0.52)**2 - gap * gap, *interval)
        assert which.tolist() == [0, 0]
        assert ((fa >= 0.0) != (fb >= 0.0)).all()
        for end in (0.52 - gap, 0.52 + gap):
            assert ((xa <= end) & (end <= xb)).sum() == 1
    which, *_ = roots.look_closer(lambda x, row: (x - 0.52)**2 + 1e-3, *interval)
    assert which.size == 0


def test_angles_are_folded_into_a_turn():
    x = np.array([-pi, -1e-300, 0.0, 1.0, 2.0 * pi, 3.0 * pi, -EPS / 8])
    folded = roots.fold(x)
    assert ((folded >= 0.0) & (folded < 2.0 * pi)).all()
    assert [roots.fold(v) for v in x.tolist()] == folded.tolist()
    assert np.abs(np.exp(1j * folded) - np.exp(1j * x)).max() <= 4 * EPS
    assert roots.turn_after(0.1, 6.0) == 0.1 + 2.0 * pi and roots.turn_after(6.1, 6.0) == 6.1
