# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Some fields alone: the numbers of the whole, less work; short arrays; what a record does."""
from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    FourBar,
    InvertedSlider,
    round_rod,
    SliderCrank,
)
from fourbar_ros.numerics import write_arrays
from fourbar_ros.numerics.number_types import ARRAY
import numpy as np
import pytest
from support import contract
from support.contract import every_case
from support.samples import some

MASSES = Bodies(Body(1.0, 0.1, 0.02, 0.1), Body(2.0, 0.3, -0.1, 0.3), Body(1.5, 0.05, 0.1, 0.7))


def loaded(case):
    """Return a mechanism with everything acting; of most, many inputs are out of range."""
    return next(contract.ordinary(case, 601, 1))[0]


def names_of(mechanism):
    return mechanism.MOTION._fields + mechanism.LOADS._fields


def by_formula(mechanism, *given):
    """Return all fields by the formulas on arrays, in one piece."""
    given = [np.asarray(v, float) for v in np.broadcast_arrays(*given)]
    with np.errstate(all='ignore'):
        motion = mechanism.motion_formula(ARRAY, mechanism.constants)(*given)
        return [np.broadcast_to(field, given[0].shape) for field in motion
                + mechanism.loads_formula(ARRAY, mechanism.constants)(motion)]


# the cosine of a Scotch yoke's crank is its slide over a length: known also out of range
@pytest.mark.parametrize('case', [case for case in contract.CASES
                                  if case[::2] != ('scotch_yoke', 'slide')], ids=contract.name_of)
def test_a_program_gives_the_bits_of_the_formula(case):
    """Whether rate and acceleration are one number or one a sample; out of range too."""
    mechanism, rng = loaded(case), np.random.default_rng(601)
    for size in (100, 1000):
        x, w, a = rng.uniform(-4.0, 4.0, size), rng.normal(size=size), rng.normal(size=size)
        for given in ((x, w, a), (x, 3.0, a), (x, w, 0.0), (x, 3.0, -2.0)):
            for name, one, other in zip(names_of(mechanism), sum(mechanism.step(*given), ()),
                                        by_formula(mechanism, *given)):
                assert are_equal(name, one, other), name


def are_equal(name, one, other):
    """Return whether numbers are equal; what no lengths and angles enter is known everywhere."""
    known = ~np.isnan(other) if name in ('guide_couple', 'f43_x') else slice(None)
    return np.array_equal(one[known], other[known], equal_nan=True)


@every_case
def test_chunks_give_the_bits_of_one_piece(case, monkeypatch):
    mechanism = loaded(case)
    x = np.linspace(-3.0, 3.0, 1003)
    whole = mechanism.step(x, 3.0, x)
    monkeypatch.setattr(write_arrays, 'CHUNK', 128)
    for one, other in zip(sum(mechanism.step(x, 3.0, x), ()), sum(whole, ())):
        assert np.array_equal(one, other, equal_nan=True)


@every_case
def test_results_share_no_memory(case):
    mechanism, x = loaded(case), np.linspace(0.3, 1.1, 100)
    for size in (10, 100):
        fields = sum(mechanism.step(x[:size], x[:size]), ())
        for i, field in enumerate(fields):
            field[:] = i
        assert [field[-1] for field in fields] == list(range(len(fields))) and x[0] == 0.3


@every_case
def test_a_sample_does_not_depend_on_those_beside_it(case):
    """Short arrays have the bits of long ones, also beside what is out of range."""
    mechanism, rng = loaded(case), np.random.default_rng(603)
    x, w, a = rng.uniform(-4.0, 4.0, 400), rng.normal(size=400), rng.normal(size=400)
    whole = sum(mechanism.step(x, w, a), ())
    for size in (1, 2, 3, 7, 30, 61):
        part = slice(200, 200 + size)
        for one, other in zip(sum(mechanism.step(x[part], w[part], a[part]), ()), whole):
            assert np.array_equal(one, other[part], equal_nan=True)


def test_short_arrays_with_what_is_out_of_range_are_nan_there():
    rocker = FourBar(4.0, 3.0, 2.0, 8.0, bodies=MASSES)
    found = rocker.loads([0.1, 1.0, 0.2], 1.0)
    assert all(np.isnan(field).tolist() == [False, True, False] for field in found)
    assert np.isnan(rocker.step([np.inf, 0.1], 1.0, fields=('f41',))[0]).tolist() == [True, False]


SOME = Bodies(*(round_rod(0.5, 7750.0, 0.01) for _ in range(3)))
NONE = Body(0.0)


@some('acting', [
    {'bodies': SOME}, {'bodies': SOME, 'gravity': (0.0, -9.81)},
    {'bodies': Bodies(MASSES.crank, NONE, NONE)},
    {'bodies': Bodies(NONE, Body(2.0), NONE)}, {'bodies': Bodies(NONE, NONE, Body(1.0, 0.1))},
    {'bodies': Bodies(NONE, NONE, NONE)}, {'bodies': Bodies(NONE, NONE, NONE),
                                           'external': External(Applied(couple=2.0))},
    {'bodies': Bodies(NONE, NONE, NONE), 'external': External(output=Applied(1.0, 2.0))}], 1)
@pytest.mark.parametrize('mechanism',
                         [FourBar(0.4, 1.2, 0.8, 1.0), FourBar(4.0, 3.0, 2.0, 8.0, mode=1), *(
                             kind(0.9, 0.4, -0.1, input=driven)
                             for kind in (SliderCrank, InvertedSlider)
                             for driven in ('crank', 'slide'))],
                         ids=lambda m: f'{type(m).__name__}-{m.input}')
def test_what_adds_zero_may_be_left_out(mechanism, acting):
    """The same numbers, and NaN where the formula has it, whichever masses and loads are zero."""
    mechanism, x = type(mechanism)(*mechanism.lengths, mechanism.mode, **(
        {} if isinstance(mechanism, FourBar) else {'input': mechanism.input}),
                                   **acting), np.linspace(-3.0, 3.0, 101)
    for given in ((x, 3.0, -2.0), (x, np.cos(x), x), (x, 3.0, 0.0)):
        for name, one, other in zip(names_of(mechanism), sum(mechanism.step(*given), ()),
                                    by_formula(mechanism, *given)):
            assert are_equal(name, one, other), name
        for name, other in zip(names_of(mechanism), by_formula(mechanism, *given)):
            assert are_equal(name, mechanism.step(*given, fields=(name,))[0], other), name
