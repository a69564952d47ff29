# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ratio, offset and sense of joints; positions that are not known."""
import math

from fourbar_ros.description.model import model_of
from fourbar_ros.pipeline.joints import Scale, TurnCounter
from fourbar_ros.pipeline.stepper import Stepper, Wanted
from fourbar_ros.scene import scene as scenes
from hypothesis import given
import numpy as np
import pytest
from support.power import power
from support.scenes import PAPER, ROCKER, RODS
from support.strategies import inputs

LOADS = {**PAPER, **RODS, 'outputs': ['joint_states', 'loads']}
TURNED = {'joint_states.ratios': [-2.0, 1, 0.25, 1.0], 'joint_states.offsets': [0.5, 0, 0.0, -1.0]}


def joint_states(scene, *sent):
    """Return {field: numbers} of joint_states after each input, as (status, fields)."""
    stepper = Stepper(scene)
    found = []
    for each in sent:
        status, values = stepper.step(*each, Wanted(with_loads=scene.needs_loads))
        found.append((status, scene.layout.expected('joint_states', values)))
    return found


@given(inputs)
def test_positions_and_rates_go_through_ratio_and_offset_and_power_stays(given):
    plain, turned = scenes.from_values(LOADS), scenes.from_values({**LOADS, **TURNED})
    ratios, offsets = turned.joint_states.ratios, turned.joint_states.offsets
    (_, ours), (_, theirs) = joint_states(plain, given)[0], joint_states(turned, given)[0]
    assert theirs['position'] == tuple(r * x + o for r, x, o in zip(ratios, ours['position'],
                                                                    offsets))
    assert theirs['velocity'] == tuple(r * v for r, v in zip(ratios, ours['velocity']))
    for a, b, c, d in zip(ours['effort'], ours['velocity'], theirs['effort'], theirs['velocity']):
        assert a * b == pytest.approx(c * d, rel=4e-16, abs=0.0)


def test_the_effort_of_a_driven_slide_is_what_power_asks_for():
    scene = scenes.from_values({**scenes.load('cylinder').values, 'outputs': LOADS['outputs'],
                                'joint_states.ratios': [2.0] * 4})
    linkage, given = scene.linkage, (1.4, 0.8, 3.0)
    driven = [joint.coordinate for joint in linkage.JOINTS].index(linkage.input_coordinate)
    (_, found), = joint_states(scene, given)
    wanted, size = power(linkage, *given)
    taken = [effort * rate for effort, rate in zip(found['effort'], found['velocity'])]
    assert abs(taken.pop(driven) - wanted) <= 1e-12 * size and taken == [0.0] * 3


def test_what_goes_out_of_one_joint_comes_in_through_the_same_numbers():
    """A finite difference of the joint is the reference for the rates."""
    scale, h = Scale(-0.4, 2.0), 2.0**-20

    def joint(t):
        return scale.ratio * (0.3 + 5.0 * t - 2.0 * t * t) + scale.offset
    rate, bend = (joint(h) - joint(-h)) / (2 * h), (joint(h) - 2 * joint(0.0) + joint(-h)) / h**2
    assert scale.to_input(joint(0.0), rate, bend) == pytest.approx((0.3, 5.0, -4.0), rel=1e-3)
    assert all(map(math.isnan, scale.to_input(1.0, math.nan, math.nan)[1:]))


@pytest.mark.parametrize('policy', ['skip', 'hold', 'send_nan'])
@pytest.mark.parametrize('shown', [{}, TURNED])
def test_positions_that_are_not_known(policy, shown):
    scene = scenes.from_values({**ROCKER, **shown, 'joint_states.when_unknown': policy})
    (_, good), (_, out), (_, rateless) = joint_states(scene, (0.2, 1.0, 0.0), (1.0, 1.0, 0.0),
                                                      (0.1, math.nan, math.nan))
    if policy == 'hold':
        assert out['position'] == good['position']
    else:
        assert math.isnan(out['position'][3])
    assert math.isnan(out['velocity'][3]) and all(map(math.isfinite, rateless['position']))


def test_held_positions_survive_silence_and_nothing_is_held_before_the_first():
    scene = scenes.from_values({**ROCKER, 'joint_states.when_unknown': 'hold'})
    stepper = Stepper(scene)

    def position(values):
        return scene.layout.expected('joint_states', values)['position']
    assert all(map(math.isnan, position(stepper.silence())))
    good = position(stepper.step(0.2, 1.0, 0.0, Wanted())[1])
    assert position(stepper.silence()) == good and all(map(math.isfinite, good))


@pytest.mark.parametrize('outputs, has',
                         [(['joint_states'], False), (['joint_states', 'loads'], True)])
def test_effort_is_absent_where_it_is_not_computed(outputs, has):
    for shown in ({}, TURNED):
        scene = scenes.from_values({**LOADS, **shown, 'outputs': outputs})
        assert ('effort' in joint_states(scene, (0.2, 1.0, 0.0))[0][1]) == has


def test_a_prefix_stands_before_every_name():
    scene = scenes.from_values({**PAPER, 'joint_states.prefix': 'left_'})
    assert scene.joint_names == ('left_crank', 'left_coupler', 'left_coupler_output',
                                 'left_output')
    assert scenes.from_values(scene.values).joint_names == scene.joint_names


# --- turns ---------------------------------------------------------------------------------------

SHIPPED = ['jansen', 'slides_7_6', 'quick_return', 'watt', 'v_engine', 'bucket', 'paper']
# its output turns fully
ROUND = {'linkage.a1': 0.5, 'linkage.a2': 0.45, 'linkage.a3': 0.5, 'linkage.a4': 0.2,
         'drive.source': 'motion', 'outputs': ['joint_states'],
         'joint_states.ratios': [1.0, 1.0, 1.0, 1.5], 'joint_states.offsets': [0, 0, 0, 0.25]}


def positions(scene, inputs):
    """Return the positions of all joints over inputs [rad or m], one after the other."""
    return np.array([fields['position'] for _, fields in
                     joint_states(scene, *[(float(x), 1.0, 0.0) for x in inputs])])


@pytest.mark.parametrize('name', SHIPPED)
def test_a_joint_that_swings_has_one_position_at_each_input_wherever_it_begins(name):
    """It begins in the turn of its angle at drive.start, which is that of the description."""
    values = scenes.load(name).values
    scene = scenes.from_values({**values, 'outputs': ['joint_states']})
    (low, high), count = scene.linkage.input_ranges[0], 1500
    inputs = np.linspace(low, high, count)[1:-1]
    found = positions(scene, np.r_[inputs, inputs[::-1]])
    driven = [joint.coordinate for joint in scene.linkage.JOINTS].index(
        scene.linkage.input_coordinate)
    found, back = np.delete(found[:len(inputs)], driven, 1), np.delete(
        found[len(inputs):][::-1], driven, 1)
    assert np.abs(np.diff(found, axis=0)).max() < 0.1
    swings = np.abs(found[-1] - found[0]) < 6.0
    assert (found == back)[:, swings].all() and np.count_nonzero(swings) >= 2
    for x in inputs[::97]:
        alone = np.delete(positions(scene, [x])[0], driven)
        assert (alone == found[inputs == x][0])[swings].all()
    start = [(joint.name, joint.start) for joint in model_of(scene).joints]
    shown = dict(zip(scene.joint_names, positions(scene, [model_of(scene).position])[0]))
    assert start == [(joint, shown[joint]) for joint, _ in start]


def test_ratio_and_offset_act_on_the_angle_that_goes_on():
    """With ratio 1.5 a wrapped angle made the pose half a turn wrong."""
    scene, inputs = scenes.from_values(ROUND), np.linspace(0.0, 6.0 * np.pi, 2000)
    theta4 = np.unwrap(scene.linkage.motion(inputs).theta4)
    assert abs(theta4[-1] - theta4[0]) > 18.0
    assert np.abs(positions(scene, inputs)[:, 3] - (1.5 * theta4 + 0.25)).max() < 1e-13


def test_a_driven_joint_counts_turns_where_its_input_wraps():
    inputs = np.linspace(0.0, 15.0, 800)
    wrapped = (inputs + np.pi) % (2.0 * np.pi) - np.pi
    scene = scenes.from_values({**ROUND, 'drive.top_speed': 30.0})
    assert np.abs(positions(scene, wrapped) - positions(scene, inputs)).max() < 1e-13
    as_it_came = positions(scenes.from_values(ROUND), wrapped)
    assert (as_it_came[:, 0] == wrapped).all()
    assert all(map(math.isfinite, positions(scene, [1e16, -1e16]).ravel()))


# --- an input that wraps ------------------------------------------------------------------------

def wrapped(angles):
    return (np.asarray(angles) + np.pi) % (2.0 * np.pi) - np.pi


def counted(angles, seconds, rates=None):
    """Return (joint, positions counted, how many were in doubt)."""
    joint, rates = TurnCounter(1.0), [math.nan] * len(angles) if rates is None else rates
    found = [joint.counted(round(1e9 * t), float(x), float(v))
             for t, x, v in zip(seconds, angles, rates)]
    return joint, np.array([x for x, _ in found]), sum(is_in_doubt for _, is_in_doubt in found)


@pytest.mark.parametrize('speed', [-30.0, -3.0, 3.0, 30.0])
@pytest.mark.parametrize('has_rates', [False, True])
def test_turns_of_an_encoder_that_wraps_are_counted(speed, has_rates):
    t = np.arange(500) * 0.01
    angles = 0.2 + speed * t + 2.0 * np.sin(t)
    joint, found, in_doubt = counted(wrapped(angles), t, speed + 2.0 * np.cos(t)
                                     if has_rates else None)
    assert joint.wraps and not in_doubt and np.abs(found - angles).max() < 1e-12


def test_an_encoder_that_stands_at_its_edge_stays_in_its_turn():
    rng, t = np.random.default_rng(3), np.arange(300) * 0.01
    angles = np.pi + 1e-3 * rng.normal(size=300)
    joint, found, _ = counted(wrapped(angles), t)
    assert joint.wraps and np.ptp(found[20:]) < 0.01


def test_a_motor_that_counts_its_turns_is_taken_as_it_comes():
    """Fast, back and forth, jumping from rest, late: none of them wraps."""
    rng, t = np.random.default_rng(4), np.arange(400) * 0.01
    for angles in (50.0 * t, -400.0 * t, 9.0 * np.sin(3.0 * t), 3.0 * np.sin(40.0 * t),
                   np.where(t > 2.0, 5.0 + 300.0 * (t - 2.0), 0.0),
                   np.where(t > 2.0, 3.0, -3.0), np.where(t > 2.0, -3.0, 2.9 + 0.02 * t),
                   np.cumsum(rng.normal(0.0, 0.5, 400))):
        order = np.arange(400)
        order[100:102] = 101, 100
        joint, found, in_doubt = counted(angles[order], t[order])
        assert (found == angles[order]).all() and not joint.wraps and not in_doubt


@pytest.mark.parametrize('bad, turns', [([150], 0), ([150, 151], 3), ([10], 1)])
def test_a_bad_position_does_not_end_the_count_of_turns_for_good(bad, turns):
    """A single one costs no turn; two, or one before it is known to wrap, some, in doubt."""
    t = np.arange(600) * 0.01
    angles = 10.0 * t
    sent = wrapped(angles)
    sent[bad] += 4.0
    joint, found, in_doubt = counted(sent, t)
    apart = np.delete(found - angles, bad)[-300:]
    assert joint.wraps and 0 < in_doubt <= 4 and np.ptp(apart) < 1e-12
    assert abs(apart[-1]) <= 2.0 * np.pi * turns + 1e-12


@pytest.mark.parametrize('turn', [2.0 * np.pi, -2.0 * np.pi])
def test_one_position_a_turn_away_makes_no_motor_wrap_that_counts_its_turns(turn):
    """As of an encoder that reads its turn and its angle at different times."""
    t = np.arange(600) * 0.01
    angles = 30.0 + 2.0 * t
    sent = angles.copy()
    sent[400] += turn                    # all before it are beyond a turn
    for rates in (None, np.full(600, 2.0)):
        joint, found, in_doubt = counted(sent, t, rates)
        assert np.abs(found - angles).max() < 1e-12 and in_doubt == 1 and not joint.wraps


def test_after_a_pause_the_turn_of_an_encoder_that_wraps_is_in_doubt():
    t = np.r_[np.arange(300) * 0.01, 5.0, 5.01]
    _, found, in_doubt = counted(wrapped(4.0 * t), t)
    assert in_doubt == 1 and np.abs(found[:300] - 4.0 * t[:300]).max() < 1e-12
    assert np.abs(np.diff(found[299:])).max() < np.pi
