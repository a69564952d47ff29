# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Numbers at the ends of their range, and columns of them beside single ones."""
from fractions import Fraction
from math import fsum

from fourbar_ros.numerics.number_types import ARRAY, power_of_two, scaled
from fourbar_ros.numerics.tables import ARRAYS
import numpy as np
import pytest
from support.cartesian import EPS

STEP = 1e-40


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


def test_scaling_rounds_nothing():
    lengths = [0.1, 1.7e-200, 3.3e5]
    ours = scaled(lengths)
    assert 0.5 <= max(ours) < 1.0
    assert len({Fraction(a) / Fraction(b) for a, b in zip(lengths, ours)}) == 1
    assert power_of_two(*lengths) == 2.0**19 and power_of_two(-0.75) == 1.0
