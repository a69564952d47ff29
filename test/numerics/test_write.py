# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A straight line of floats does what the formula with floats does, bit by bit, and no more."""
from dataclasses import replace
import linecache
from math import copysign, inf, pi
import traceback

from fourbar_ros import Applied, Body
from fourbar_ros.numerics.number_types import exact_sum, REAL
from fourbar_ros.numerics.trace import Trace
from fourbar_ros.numerics.write import KEPT, lines_of, straight_line
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from support.contract import every_case, every_mechanism
from support.strategies import mechanisms


@every_case
@given(st.data())
def test_coefficients_have_the_same_bits(case, data):
    """Every kind, input and mode, whatever the lengths: all numbers of all links."""
    mechanism, (value, _, _) = data.draw(mechanisms(case))

    def flat(n):
        coefficients = mechanism.make_coefficients(n)
        return lambda q: [number for link in coefficients(q) for number in link]
    assert list(straight_line(flat)(value)) == [float(v) for v in flat(REAL)(value)]


@every_case
@given(st.data())
def test_it_refuses_what_the_formula_refuses(case, data):
    """Out of range there is no square root, also where nothing of it is wanted."""
    mechanism, _ = data.draw(mechanisms(case))
    ends = [end for bounds in mechanism.closing_ranges for end in bounds]
    outside = max(map(abs, ends)) * 1.001
    if mechanism.turns_fully or not mechanism.is_driven_by_slide and outside > pi:
        return
    line = straight_line(lambda n: (
        lambda coefficients: lambda q: coefficients(q)[0][:2])(mechanism.make_coefficients(n)))
    with pytest.raises(ValueError):
        line(outside)


def bits(values):
    """Return bits; the sign of a zero is no part of a result."""
    return [(float(value) + 0.0).hex() for value in values]


@every_mechanism
@given(st.data())
def test_steps_have_the_bits_of_the_formulas(case, data):
    """With all masses, without gravity, with bodies of no mass, with other loads or with none."""
    mechanism, its = data.draw(mechanisms(case))
    nothing = type(mechanism.bodies)._make([Body(0.0)] * len(mechanism.bodies))
    loads = [type(mechanism.external)._make([acting] * len(mechanism.external))
             for acting in (Applied(), Applied(force_y=2.0),
                            Applied(1.0, -2.0, along=0.3, across=0.1, couple=5.0))]
    for one in (mechanism, replace(mechanism, gravity=(0.0, -0.0)),
                replace(mechanism, bodies=nothing, external=loads[0]),
                *map(mechanism.with_external, loads)):
        motion = one.motion_in(REAL, one.constants, *its)
        loads = one.loads_in(REAL, one.constants, motion)
        found = one.step(*its)
        assert bits(one.motion(*its)) == bits(motion) == bits(found[0])
        assert bits(found[1]) == bits(loads)


def test_a_line_is_written_once_for_a_structure():
    written = []

    def formula(n, data):
        written.append(data)
        (a, b), c = data
        ratio, total = a / b, n.exact_sum((a, b, c))
        return lambda x: ((ratio * x, c * x), total)
    lines = lines_of(Trace(formula, 1, ((1.0, 3.0), 0.0)), (), 'one of many')
    for a, b, c in ((1.0, 3.0, 0.0), (2.0, 7.0, -1.0), (0.1, 0.2, -0.3)):
        assert lines((a, b, c))(-5.0) == ((a / b * -5.0, c * -5.0), exact_sum((a, b, c)))
    assert len(written) == 1
    assert copysign(1.0, lines((1.0, 3.0, 0.0))(-5.0)[0][1]) == -1.0
    with pytest.raises(ZeroDivisionError):
        lines((1.0, 0.0, 0.0))


def test_data_known_to_be_zero_are_left_out():
    trace = Trace(lambda n, data: lambda x: (data[0] * x + data[1] * n.sin(x),), 1, (2.0, 0.0))
    lines = lines_of(trace, {trace.count + 1}, 'of one datum')
    line = lines((3.0, 0.0))
    assert line(2.0) == (6.0,) and 'sin' not in line.__code__.co_varnames


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


def test_a_traceback_shows_the_line_and_names_the_formula():
    line = straight_line(lambda n: lambda x: (1.0 / x, 2.0 * n.sqrt(x)), name='an example')
    for value, error in ((0.0, ZeroDivisionError), (-1.0, ValueError)):
        with pytest.raises(error) as raised:
            line(value)
        shown = ''.join(traceback.format_exception(error, raised.value, raised.tb))
        assert '<an example, line ' in shown
        assert ('sqrt(x0)' if value else '/ x0') in shown.rsplit('File', 1)[1]


def test_texts_for_tracebacks_are_kept_for_some_lines_only():
    for i in range(3 * KEPT):
        straight_line(lambda n, i=i: lambda x: (x + float(i),) + (x,) * i, name='one of many')(1.0)
    assert sum(name.startswith('<') and ', line ' in name
               for name in linecache.cache) <= KEPT


def test_a_minus_sign_goes_into_the_sum_without_a_bit_changed():
    def formula(n):
        return lambda x, y: (x + -y, -x + y, x - -y, -x * y + 1.0, 1.0 - (-x) / y, -(-x),
                             n.where(x > y, -x, y), -x * -y)
    line, plain = straight_line(formula, 2), formula(REAL)
    rng = np.random.default_rng(405)
    for x, y in [(0.0, 1.0), (-0.0, 1.0), (0.0, -1.0), *rng.normal(size=(50, 2)).tolist()]:
        assert bits(line(x, y)) == bits(plain(x, y))


def test_deep_formulas_and_infinite_constants():
    def deep(n):
        def polynomial(x):
            for i in range(500):
                x = x * 0.5 + float(i)
            return x, n.where(x > 0.0, inf, x)
        return polynomial
    assert straight_line(deep)(0.3) == deep(REAL)(0.3)
