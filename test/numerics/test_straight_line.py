# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A straight line of floats does what the formula with floats does, bit by bit, and no more."""
from math import copysign, inf, pi

from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.numerics.straight_line import straight_line
import numpy as np
import pytest
from support import contract
from support.contract import CASES

every_case = pytest.mark.parametrize('case', CASES, ids=contract.name_of)


@every_case
def test_coefficients_have_the_same_bits(case):
    """Every kind, input and mode, whatever the lengths: all numbers of all links."""
    for mechanism, (value, _, _) in contract.ordinary(case, 400, 30):
        def flat(n, mechanism=mechanism):
            coefficients = mechanism.make_coefficients(n)
            return lambda q: [number for link in coefficients(q) for number in link]
        assert list(straight_line(flat)(value)) == [float(v) for v in flat(REAL)(value)]


@every_case
def test_it_refuses_what_the_formula_refuses(case):
    """Out of range there is no square root, also where nothing of it is wanted."""
    for mechanism, _ in contract.ordinary(case, 401, 20):
        ends = [end for bounds in mechanism.closing_ranges for end in bounds]
        outside = max(map(abs, ends)) * 1.001
        if mechanism.turns_fully or not mechanism.is_driven_by_slide and outside > pi:
            continue
        line = straight_line(lambda n, mechanism=mechanism: (
            lambda coefficients: lambda q: coefficients(q)[0][:2])(mechanism.make_coefficients(n)))
        with pytest.raises(ValueError):
            line(outside)


def test_the_registry_is_covered():
    assert {case.name for case in CASES} == set(KINDS)


def test_only_what_is_needed_is_done():
    done = []

    def formula(n):
        def sine(value):
            done.append(value)
            return n.sin(value)
        return lambda x, y: (0.0 * sine(x) + 1.0 * (x - 0.0) * (y / 1.0), n.sin(y) + n.sin(y))
    line = straight_line(formula, 2)
    names = line.__code__.co_freevars
    assert names == ('sin',) and line(3.0, 2.0) == (6.0, 2.0 * np.sin(2.0))
    assert len(done) == 1      # when it was recorded, and not again


def test_zeros_keep_their_signs_and_functions_of_constants_are_constants():
    line = straight_line(lambda n: lambda x: (n.atan2(0.0 * x, -1.0), n.where(x > 1.0, x, -0.0),
                                              n.where(x > 1.0, x, 0.0), n.exact_sum((0.1, 0.2))))
    angle, minus, plus, total = line(0.5)
    assert angle == pi and copysign(1.0, minus) == -1.0 and copysign(1.0, plus) == 1.0
    assert total == 0.1 + 0.2


def test_deep_formulas_and_infinite_constants():
    def deep(n):
        def polynomial(x):
            for i in range(500):
                x = x * 0.5 + float(i)
            return x, n.where(x > 0.0, inf, x)
        return polynomial
    assert straight_line(deep)(0.3) == deep(REAL)(0.3)
