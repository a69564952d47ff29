# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recompute tells differences by rounding from real ones, by a bound computed for each value."""
import json
import math
import struct

from fourbar_ros.bag.difference import (
    Condition,
    EPS,
    LIMIT,
    needs_condition,
    rounding_units,
)
from fourbar_ros.bag.recompute import recompute
from fourbar_ros.bag.reader import Bag
from fourbar_ros.cli.main import main
from fourbar_ros.scene.scene import from_values
import mpmath
import numpy as np
import pytest
from support import bags
from support.scenes import PAPER, RODS, TIP

FULL = {**PAPER, **RODS, **TIP, 'outputs': ['state', 'loads', 'points'],
        'drive.source': 'motion'}
STEPS = 60
TURNS = [(0.11 * k, 25.0, 3.0) for k in range(STEPS)]


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return bags.run(tmp_path_factory.mktemp('rounding'), 'run', FULL, TURNS)


def changed(bag, directory, name, topic, field, change):
    """Copy a bag; ``change(value, number of the message)`` gives another value of a field."""
    decoders, seen = Bag(bag), [0]
    for _ in decoders.chunks():
        pass

    def edit(raw):
        if raw.topic != topic:
            return raw.data
        leaf = next(leaf for leaf in decoders.decoder(topic).layout(raw.data).leaves
                    if leaf.name == field)
        data = bytearray(raw.data)
        value, = struct.unpack_from('<d', data, leaf.offset)
        struct.pack_into('<d', data, leaf.offset, change(value, seen[0]))
        seen[0] += 1
        return bytes(data)
    return bags.copy(bag, directory, name, edit)


def shaking_moment_condition(number):
    scene = from_values(FULL)
    condition = Condition(scene, {}).of(np.array(TURNS[number]).reshape(3, 1))
    return condition[scene.layout.place['shaking_moment'], 0]


@pytest.mark.parametrize('field', ['shaking_moment', 'f32', 'driving_torque'])
def test_values_off_by_a_few_last_bits_differ_by_rounding(bag, tmp_path, capsys, field):
    path = changed(bag, tmp_path, 'run', '/fourbar/loads', field,
                   lambda value, k: value * (1.0 + 4.0 * EPS * (k % 3)))
    found = recompute(path)
    assert found.is_rounding and 0.0 < found.units <= LIMIT
    assert main(['bag', 'recompute', str(path)]) == 3
    assert 'differences by rounding only: at most' in capsys.readouterr().out
    assert main(['bag', 'recompute', '--rounding', str(path)]) == 0
    assert main(['bag', 'recompute', '--rounding', '--json', str(path)]) == 0
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert told['by_rounding'] and told['good'] and 'rounding only' in told['verdict']


@pytest.mark.parametrize(('sizes', 'is_rounding'), [((0.9 * LIMIT,), True),
                                                    ((0.0, 1.1 * LIMIT), False)])
def test_the_bound_is_that_of_each_value_not_of_the_largest(bag, tmp_path, sizes, is_rounding):
    number = 7              # one message of 60: what counts is its own condition
    condition = shaking_moment_condition(number)
    path = changed(bag, tmp_path, 'run', '/fourbar/loads', 'shaking_moment',
                   lambda value, k: value + sizes[-1] * EPS * condition if k == number else value)
    assert recompute(path).is_rounding is is_rounding


def test_values_that_are_held_have_the_condition_of_the_motion_they_are_of(tmp_path):
    values = {**FULL, 'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.out_of_range': 'hold'}
    scene = from_values(values)
    low, high = scene.linkage.input_ranges[-1]
    good = high - 0.02, 2.0, 3.0
    path = bags.run(tmp_path, 'held', values, [good] * 4 + [(high + 0.1, 2.0, 3.0)] * 4)
    condition = Condition(scene, {}).of(np.array(good).reshape(3, 1))
    at = scene.layout.place['shaking_moment']
    value = scene.linkage.loads(*good).shaking_moment
    assert condition[at, 0] > 2.0 * abs(value)           # else the value's own size would do
    path = changed(path, tmp_path, 'changed', '/fourbar/loads', 'shaking_moment',
                   lambda value, k: value + 0.9 * LIMIT * EPS * condition[at, 0] * (k == 6))
    assert compare(path).is_rounding


def test_a_real_difference_is_named_also_beside_rounding(bag, tmp_path, capsys):
    path = changed(bag, tmp_path, 'one', '/fourbar/loads', 'f32',
                   lambda value, k: value * (1.0 + EPS))
    path = changed(path, tmp_path, 'two', '/fourbar/state', 'alpha4',
                   lambda value, k: value * (1.0 + 1e-9 * (k == 30)))
    assert main(['bag', 'recompute', '--rounding', str(path)]) == 3
    assert 'real differences: /fourbar/state alpha4 by' in capsys.readouterr().out
    nan = changed(bag, tmp_path, 'nan', '/fourbar/state', 'alpha4',
                  lambda value, k: float('nan') if k == 5 else value)
    assert main(['bag', 'recompute', '--rounding', str(nan)]) == 3
    assert 'which rounding does not explain' in capsys.readouterr().out


def test_the_condition_is_that_of_mpmath():
    """Condition of theta4: sum of |p dtheta4/dp| over lengths and theta1, plus |theta4|."""
    scene, given = from_values(FULL), [FULL[f'linkage.a{i}'] for i in (1, 2, 3, 4)]
    for theta1 in (0.3, 1.9, 4.4):
        guess = scene.linkage.motion(theta1, 0.0, 0.0).theta4

        def theta4(*numbers, guess=guess):
            a1, a2, a3, a4, angle = numbers
            return mpmath.findroot(
                lambda x: (a4 + a3 * mpmath.cos(x) - a1 * mpmath.cos(angle))**2
                + (a3 * mpmath.sin(x) - a1 * mpmath.sin(angle))**2 - a2**2, guess)
        with mpmath.workdps(30):
            numbers = [*given, math.remainder(theta1, 2.0 * math.pi)]
            slopes = [mpmath.diff(theta4, numbers, tuple(int(i == j) for j in range(5)))
                      for i in range(5)]
            want = sum(abs(p * slope) for p, slope in zip(numbers, slopes)) + abs(guess)
        have = Condition(scene, {}).of(np.array([[theta1], [0.0], [0.0]]))
        assert have[scene.layout.place['theta4'], 0] == pytest.approx(float(want), rel=1e-6)


def test_units_of_what_is_not_finite():
    one, nan = np.ones(2), np.array([1.0, np.nan])
    assert rounding_units(one, one, one) == 0.0 and rounding_units(nan, nan, one) == 0.0
    assert rounding_units(one, nan, one) == rounding_units(nan, one, one) == np.inf
    assert rounding_units(np.zeros(2), np.array([0.0, 1e-300]), np.zeros(2)) == np.inf
    assert rounding_units(one, one + 4 * EPS, 2 * one) == 2.0
    assert needs_condition(one, one + 4 * EPS).all() and not needs_condition(nan, nan).any()
