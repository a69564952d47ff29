# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Numbers of many digits: functions against mpmath, formulas where floats lose all theirs."""
from decimal import Decimal, localcontext
from math import atan2

from fourbar_ros.numerics.digits import DECIMALS, in_decimals, MANY_DIGITS, quarter_turn
from fourbar_ros.numerics.trace import flat, Trace
import mpmath as mp
import numpy as np
import pytest


def exactly(number):
    return mp.mpf(str(number))


@pytest.mark.parametrize('x', [0.3, -5.7, 1e-20, np.pi, 0.5 * np.pi, 40.0, 0.0])
def test_functions_against_mpmath(x):
    with localcontext(MANY_DIGITS), mp.workdps(200):
        for name in ('sin', 'cos'):
            found = exactly(DECIMALS[name](Decimal(x)))
            assert abs(found - getattr(mp, name)(mp.mpf(x))) <= mp.mpf(10)**-154
        assert float(DECIMALS['atan2'](Decimal(x), Decimal('0.4'))) == atan2(x, 0.4)
        with pytest.raises(ValueError):
            DECIMALS['sqrt'](Decimal(-1))


def test_quarter_turns_are_exact():
    with localcontext(MANY_DIGITS):
        for number, sine in ((0, 0), (1, 1), (2, 0), (3, -1), (-1, -1), (5, 1)):
            assert DECIMALS['sin'](number * quarter_turn()) == sine
            assert DECIMALS['cos']((number - 1) * quarter_turn()) == sine


def test_formulas_keep_their_digits_where_sums_cancel():
    """Of (t - sin t)/t^3 the value 1/6; of 1 - sin^2 - cos^2 nothing is left."""
    def make(n, data):
        return lambda t: ((t - n.sin(t)) / (t * t * t) * data[0],
                          1.0 - n.sin(t) * n.sin(t) - n.cos(t) * n.cos(t))

    trace = Trace(make, 1, (6.0,))
    with localcontext(MANY_DIGITS):
        for t in ('1e-22', '1e-24'):
            one, nothing = in_decimals(trace, [6.0], flat(trace.results))(Decimal(t))
            assert abs(one - 1) < Decimal('1e-43') and nothing == 0
