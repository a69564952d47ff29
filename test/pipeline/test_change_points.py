# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Samples of change points: the mode is a branch, which goes on through the flat positions."""
from math import isfinite, isnan, pi, remainder, tau

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.pipeline.rate_estimator import estimator_of
from fourbar_ros.pipeline.stepper import INVALID_INPUT, OK, Stepper, TOGGLE, Wanted
from fourbar_ros.scene import from_values
import numpy as np
import pytest
from support.scenes import kite_angle, RODS

SHORT, LONG = 0.5, 1.0


def linkage(*lengths, **more):
    """Return the parameters of a four-bar of these lengths, with rods."""
    return {**{f'linkage.a{i}': length for i, length in enumerate(lengths, 1)}, **RODS,
            'outputs': ['state', 'loads', 'joint_states'], **more}


PARALLELOGRAM, KITE = linkage(SHORT, LONG, SHORT, LONG), linkage(SHORT, LONG, LONG, SHORT)


def stepping(values, outputs=None):
    """Return a scene and the function inputs -> (status, {name: value})."""
    scene = from_values(values)
    stepper, wanted = Stepper(scene), Wanted.of(scene, outputs)

    def step(*given):
        status, found = stepper.step(*given, wanted)
        return status, {name: found[i] for name, i in scene.layout.index_of.items()}
    return scene, step


@pytest.mark.parametrize('outputs', [['state', 'loads', 'joint_states'], ['state']])
@pytest.mark.parametrize('mode', [1, 2])
def test_at_a_flat_position_the_motion_is_given_and_loads_are_not(mode, outputs):
    scene, step = stepping({**PARALLELOGRAM, 'linkage.mode': mode}, outputs)
    for x in (-1e-9, 0.0, 1e-9):
        status, values = step(x, 2.0, 3.0)
        loads = [values[name] for name in scene.linkage.LOADS._fields]
        assert status == (OK if x else TOGGLE) and values['theta1'] == x
        if not x:
            assert all(map(isnan, loads)) and isnan(values['condition'])
        elif 'loads' in outputs:
            assert all(map(isfinite, loads))
        # the crossed one rolls on ellipses of ratio -(d^2 - a^2) / (d - a)^2 there
        ratio = 1.0 if mode == 2 else -(LONG**2 - SHORT**2) / (LONG - SHORT)**2
        assert values['omega4'] == pytest.approx(2.0 * ratio, abs=1e-14)
        assert values['theta4'] == pytest.approx(ratio * x, abs=1e-14)
        assert values['alpha4'] == pytest.approx(3.0 * ratio, abs=1e-6)
    assert all(map(isfinite, (values['omega2'], values['alpha3'], values['transmission_angle'])))


def test_every_kind_has_its_motion_at_a_flat_position_and_an_overflow_has_none():
    scene, step = stepping(KITE)
    assert step(0.0, 1e160, 0.0)[0] == step(0.5, 1e160, 0.0)[0] == INVALID_INPUT
    for values in (KITE, linkage(0.1, 0.5, 0.2, 0.4), {
            'linkage.kind': 'inverted_slider', 'linkage.a1': 0.3, 'linkage.a4': 0.5,
            'linkage.offset': 0.2, 'outputs': ['state']}):
        scene, step = stepping(values)
        flat, = scene.linkage.flat_inputs
        status, there = step(flat, 1.0, 1.0)
        assert status == TOGGLE and flat == 0.0
        beside = [step(x, 1.0, 1.0)[1] for x in (-1e-8, 1e-8)]
        for name in scene.linkage.MOTION._fields:
            if name != 'condition' and not isnan(beside[0][name]):
                apart = [there[name] - values[name] for values in beside]
                if name.startswith(('theta', 'beta')):
                    apart = [remainder(angle, tau) for angle in apart]
                assert max(map(abs, apart)) < 1e-6, name


@pytest.mark.parametrize('mode', [1, 2])
def test_a_kite_repeats_after_two_turns_and_its_joints_do_not_jump(mode):
    scene, step = stepping({**KITE, 'linkage.mode': mode})
    joint = [joint.coordinate.position for joint in scene.linkage.JOINTS].index('theta4')
    inputs = np.linspace(0.01, 8.0 * pi, 2001)
    expected, shown = kite_angle(SHORT, LONG, mode, inputs), []
    for x, angle in zip(inputs.tolist(), expected):
        status, values = step(x, 1.0, 0.0)
        assert status == OK and abs(remainder(values['theta4'] - angle, tau)) < 1e-15 * (4 + x)
        shown.append(values[f'joint {joint + 1} position'])
    assert np.abs(np.diff(shown)).max() < 0.1
    assert np.ptp(shown - np.unwrap(expected)) < 1e-13
    assert scene.linkage.period == 4.0 * pi
    assert abs(remainder(expected[500] - expected[1000], tau)) > 0.1    # a turn is another pose


def test_positions_count_turns_where_a_turn_is_another_pose():
    kite, plain = from_values(KITE), from_values(PARALLELOGRAM)
    assert kite.must_count_turns and not plain.must_count_turns
    with pytest.raises(InvalidParameter, match='repeats after two turns'):
        from_values({**KITE, 'drive.top_speed': 3.0})
    from_values({**PARALLELOGRAM, 'drive.top_speed': 3.0})
    times, positions = [10**7 * k for k in range(4)], [3.0, 3.05, 3.1, 3.15 - tau]
    wrapped = [[estimator.update(t, x, 5.0)[1] for t, x in zip(times, positions)][-1]
               for estimator in map(estimator_of, (kite, plain))]
    assert isnan(wrapped[0]) and not isnan(wrapped[1])      # there it is a jump
