# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Number types: each function of each against mpmath, and one type against the others."""
from fractions import Fraction
from math import fsum

from fourbar_ros.numerics.exact_sums import difference_of_squares, scaled
from fourbar_ros.numerics.number_types import ARRAY, converted, power_of_two, REAL
from fourbar_ros.numerics.tables import ARRAYS
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import EPS

FUNCTIONS = {
    'sin': ((-7.0, 7.0),), 'cos': ((-7.0, 7.0),), 'sqrt': ((1e-3, 9.0),), 'fabs': ((-3.0, 3.0),),
    'hypot': ((-3.0, 3.0), (-3.0, 3.0)), 'atan2': ((-3.0, 3.0), (-3.0, 3.0)),
}
STEP = 1e-40


def exact(name, *values):
    """Return a function of mpmath of these values."""
    own = {'fabs': abs, 'atan2': mp.atan2, 'hypot': mp.hypot}
    return own.get(name, getattr(mp, name, None))(*map(mp.mpf, values))


def drawn(rng, name, count=40):
    return [rng.uniform(low, high, count) for low, high in FUNCTIONS[name]]


@pytest.mark.parametrize('name', FUNCTIONS)
@pytest.mark.parametrize('kind', ['floats', 'arrays', 'complex arrays'])
def test_values_are_those_of_mpmath(kind, name):
    function, values = getattr(REAL if kind == 'floats' else ARRAY, name), drawn(
        np.random.default_rng(1), name)
    found = ([function(*each) for each in zip(*(v.tolist() for v in values))] if kind == 'floats'
             else function(*(values if kind == 'arrays' else [v + 0j for v in values])))
    for one, *given in zip(found, *values):
        truth = exact(name, *given)
        assert abs(one - truth) <= 4 * EPS * max(abs(truth), EPS)


@pytest.mark.parametrize('name', FUNCTIONS)
def test_a_complex_step_gives_the_derivative(name):
    values = drawn(np.random.default_rng(2), name)
    for i in range(len(values)):
        moved = [v + 1j * STEP * (k == i) for k, v in enumerate(values)]
        found = getattr(ARRAY, name)(*moved).imag / STEP
        for ours, *given in zip(found, *values):
            def along(t, given=given, i=i):
                return exact(name, *(mp.mpf(v) + t * (k == i) for k, v in enumerate(given)))
            with mp.workdps(60):
                h = mp.mpf(10)**-20
                truth = (along(h) - along(-h)) / (2 * h)
            assert abs(ours - truth) <= 64 * EPS * max(1, abs(truth))


@pytest.mark.parametrize('numbers', [REAL, ARRAY], ids=['floats', 'arrays'])
def test_where_chooses_one_number_or_each_of_a_tuple(numbers):
    assert numbers.where(True, 1.0, 2.0) == 1.0
    assert numbers.where(False, (1.0, 3.0), (2.0, 4.0)) == (2.0, 4.0)
    if numbers is ARRAY:
        mask = np.array([True, False])
        assert numbers.where(mask, np.ones(2), np.zeros(2)).tolist() == [1.0, 0.0]
        one, other = numbers.where(mask, (1.0, 5.0), (2.0, 6.0))
        assert one.tolist() == [1.0, 2.0] and other.tolist() == [5.0, 6.0]


def test_hypot_of_arrays_neither_overflows_nor_underflows():
    x = np.array([3e200, 3e-200, 0.0])
    with np.errstate(over='ignore', under='ignore'):        # as where formulas are evaluated
        found = ARRAY.hypot(x, 4.0 / 3.0 * x)
        assert ARRAY.hypot(x[:1], np.array([1.0])) == x[:1]
    assert found == pytest.approx(5.0 / 3.0 * x, rel=4 * EPS)
    assert ARRAY.hypot(x[:0], x[:0]).size == 0


@pytest.mark.parametrize('step', [0.0, 1j * STEP])
def test_columns_are_single_mechanisms(step):
    sizes = 10.0**np.arange(0, 12, 3).reshape(4, 1, 1)
    lengths = sizes * np.random.default_rng(3).uniform(-1.0, 1.0, (4, 6, 1)) + step
    sums, powers = ARRAYS['exact_sum'](*lengths), ARRAYS['power_of_two'](*lengths)
    assert sums.shape == powers.shape == (6, 1)
    for i in range(6):
        one = lengths[:, i, 0].real.tolist()
        assert sums[i, 0] == fsum(one) + 4 * step and powers[i, 0] == power_of_two(*one)


@pytest.mark.parametrize('sizes', [(1.0, 1.0), (1e8, 1.0), (1.0, 1e-16)])
def test_differences_of_squares_that_cancel(sizes):
    """Against fractions: the factors are rounded once each, and their product."""
    rng, cancelled = np.random.default_rng(4), 0
    for _ in range(200):
        a, b = (rng.uniform(0.5, 1.0) * size for size in sizes)
        c = a * (1.0 + rng.integers(-3, 4) * EPS)
        d = b * (1.0 + rng.integers(-3, 4) * EPS)
        truth = (Fraction(a) + Fraction(b))**2 - (Fraction(c) + Fraction(d))**2
        cancelled += 0 < abs(truth) < Fraction(a)**2 / 10**12
        found = Fraction(difference_of_squares(a, b, c, d))
        assert abs(found - truth) <= Fraction(2 * EPS) * abs(truth)
    assert cancelled > 50


def test_scaling_rounds_nothing():
    lengths = [0.1, 1.7e-200, 3.3e5]
    ours = scaled(lengths)
    assert 0.5 <= max(ours) < 1.0
    assert len({Fraction(a) / Fraction(b) for a, b in zip(lengths, ours)}) == 1
    assert power_of_two(*lengths) == 2.0**19 and power_of_two(-0.75) == 1.0


def test_records_are_converted_throughout():
    from fourbar_ros import Bodies, Body
    bodies = Bodies(*(Body(float(i), 0.5, 0.25, 2.0) for i in range(3)))
    exactly = converted(bodies, Fraction)
    assert exactly.output.mass == Fraction(2) and isinstance(exactly.crank.inertia, Fraction)
    assert bodies.output.mass == 2.0 and isinstance(bodies.output.mass, float)
    assert converted((None, (1.0, 2)), Fraction) == (None, (Fraction(1), Fraction(2)))
