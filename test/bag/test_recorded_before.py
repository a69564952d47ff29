# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags recorded before the code was restructured compute again to the last bit."""
from pathlib import Path

from fourbar_ros.bag.origin import origin_of
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.sides import AT_FLAT
from fourbar_ros.cli.main import main
from fourbar_ros.numerics.arrays import EPS
import numpy as np
import pytest

RECORDED = Path(__file__).parent.parent / 'support' / 'data' / 'recorded'
SCENES = {'paper': 5, 'slides_7_6': 3, 'slides_7_7': 3, 'slider_crank': 6, 'cylinder': 5}
# Driven by torque, with earlier steps. rocker and pushed pass toggles.
BEFORE = {'motor': 2, 'engine': 2, 'released': 3, 'pushed': 2, 'controlled': 2, 'engine_tables': 2}
# With these steps.
STEPPED = {'stepped_controlled': 2, 'stepped_rocker': 2}
# Of change points, when a mode was a side: a given motion, which jumped, and a simulated one.
SIDES = 'kite', 'parallelogram'


def test_there_is_a_bag_of_every_scene():
    assert {path.name for path in RECORDED.iterdir()} == {
        *SCENES, *BEFORE, *STEPPED, *SIDES, 'rocker'}


def test_a_bag_of_when_a_mode_was_a_side_tells_what_is_on_the_other_branch(capsys):
    driven = np.array([record.message.position
                       for record in Bag(RECORDED / 'kite').records(['/fourbar/driven'])])
    found = recompute(RECORDED / 'kite')
    other = found.other_branch
    assert other == np.count_nonzero(np.sin(0.5 * driven) < 0.0) > 40
    assert found.skipped == {AT_FLAT: 3} and found.compared == 3 * (found.inputs - 1) == 297
    assert found.problems(1e-9) == []
    found = recompute(RECORDED / 'parallelogram')       # it began below the flat position
    assert found.other_branch == found.inputs == 101 and found.compared == 303
    assert found.problems(1e-9) == []
    arguments = ['bag', 'recompute', str(RECORDED / 'kite'), '--tolerance', '1e-9']
    assert main(arguments) == 0
    assert f'{other} driven motions are on the other branch of a change' in capsys.readouterr().out
    assert main([*arguments, '--json']) == 0
    assert f'"other_branch": {other}' in capsys.readouterr().out


@pytest.mark.parametrize('scene', SCENES)
def test_a_bag_recorded_before_computes_again_within_rounding(scene):
    """Kinds were no machines then: their values have other last bits (CHANGELOG, Bags)."""
    found = recompute(RECORDED / scene)
    assert found.inputs > 90
    assert found.compared == SCENES[scene] * found.inputs
    assert found.problems(1e-10) == []


@pytest.mark.parametrize('scene', STEPPED)
def test_a_motion_that_followed_from_torque_is_stepped_again_exactly(scene):
    found = recompute(RECORDED / scene)
    assert found.inputs > 90 and found.stepped >= found.inputs - 2
    assert found.compared == STEPPED[scene] * found.inputs
    assert found.problems() == []


@pytest.mark.parametrize('scene', BEFORE)
def test_motion_that_followed_from_other_steps_is_computed_from_its_states(scene):
    found = recompute(RECORDED / scene)
    assert found.inputs >= 300 and found.stepped == 0
    assert found.compared == BEFORE[scene] * found.inputs
    # alpha2 of the engines reaches 2.6e4 rad/s^2: 4 eps of it
    assert found.problems(2e-11) == []


def test_beside_toggles_a_recorded_motion_is_that_of_an_input_within_its_rounding():
    path, change = RECORDED / 'rocker', {}
    linkage = origin_of(path).scene.linkage
    states = [record.message for record in Bag(path).records(['/fourbar/state'])]
    position, rate, acceleration, modes = (np.array([getattr(state, name) for state in states])
                                           for name in ('theta1', 'omega1', 'alpha1', 'mode'))
    for mode in (1, 2):
        there = modes == mode
        up, down = (linkage.in_mode(mode).step(position[there] * (1.0 + sign * EPS), rate[there],
                                               acceleration[there]) for sign in (1, -1))
        for name, high, low in zip(up[0]._fields + up[1]._fields, up[0] + up[1],
                                   down[0] + down[1]):
            change[name] = max(change.get(name, 0.0), np.abs(high - low).max())
    found = recompute(path)
    assert found.inputs > 200 and found.stepped == 0 and found.compared == 2 * found.inputs
    for difference in found.differences:
        assert difference.largest <= max(0.25 * change.get(difference.field, 0.0), 1e-12)
