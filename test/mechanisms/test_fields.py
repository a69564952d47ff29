# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Some fields alone: the numbers of the whole, less work; short arrays; what a record does."""
from dataclasses import replace
from itertools import islice

from fourbar_ros import Applied, Body
from fourbar_ros.numerics import write_arrays
from fourbar_ros.numerics.number_types import ARRAY
import numpy as np
import pytest
from support import contract
from support.contract import every_case
from support.samples import more


def loaded(case):
    """Return a mechanism with everything acting; of most, many inputs are out of range."""
    return next(contract.ordinary(case, 601, 1))[0]


def by_formula(mechanism, *given):
    """Return all fields by the formulas on arrays, in one piece."""
    given = [np.asarray(v, float) for v in np.broadcast_arrays(*given)]
    with np.errstate(all='ignore'):
        motion = mechanism.motion_in(ARRAY, mechanism.constants, *given)
        return [np.broadcast_to(field, given[0].shape) for field in motion
                + mechanism.loads_in(ARRAY, mechanism.constants, motion)]


def with_less(mechanism):
    """Yield a mechanism with everything acting, and with some of it zero."""
    nothing = type(mechanism.bodies)._make([Body(0.0)] * len(mechanism.bodies))
    no_load = type(mechanism.external)()
    yield mechanism
    yield replace(mechanism, gravity=(0.0, 0.0), external=no_load)
    for link, body in mechanism.bodies._asdict().items():
        yield replace(mechanism, bodies=nothing._replace(**{link: body}), external=no_load)
    yield replace(mechanism, bodies=nothing, external=no_load)
    for acting in (Applied(couple=2.0), Applied(1.0, 2.0)):
        yield replace(mechanism, bodies=nothing, external=no_load._replace(output=acting))


# the cosine of a Scotch yoke's crank is its slide over a length: known also out of range
@pytest.mark.parametrize('case', [case for case in contract.CASES
                                  if case[::2] != ('scotch_yoke', 'slide')], ids=contract.name_of)
def test_a_program_gives_the_bits_of_the_formula(case, size=more(100, 1000)):
    """Whether rate and acceleration are one number or one a sample; NaN out of range."""
    rng = np.random.default_rng(601)
    for mechanism in islice(with_less(loaded(case)), more(3, 9)):
        names = mechanism.MOTION._fields + mechanism.LOADS._fields
        x, w, a = rng.uniform(-4.0, 4.0, size), rng.normal(size=size), rng.normal(size=size)
        for given in ((x, w, a), (x, 3.0, a), (x, w, 0.0), (x, 3.0, -2.0)):
            expected = by_formula(mechanism, *given)
            for name, one, other in zip(names, sum(mechanism.step(*given), ()), expected):
                assert are_equal(name, one, other), name
        for name, other in zip(names, expected):
            assert are_equal(name, mechanism.step(*given, fields=(name,))[0], other), name


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
