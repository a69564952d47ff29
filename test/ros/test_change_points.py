# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A node through the flat positions of a kite, over four turns, against its geometry."""
from math import isnan, pi, remainder, tau

from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.scene import scene
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from support.harness import recomputed, recording_in
from support.scenes import kite_angle, RODS

SHORT, LONG = 0.5, 1.0
KITE = {'linkage.a1': SHORT, 'linkage.a2': LONG, 'linkage.a3': LONG, 'linkage.a4': SHORT, **RODS,
        'outputs': ['state', 'joint_states', 'loads']}
# over four turns, with samples exactly at flat positions that are floats
TURNS = np.r_[np.linspace(-0.31, 8.0 * pi, 240), 0.0]


def answered(client, send, messages):
    """Send messages one by one, each when the one before is answered; return the states."""
    for count, message in enumerate(messages, 1):
        send(message)
        client.until(lambda count=count: min(map(len, client.received.values())) >= count,
                     f'answer {count}')
    return client.received['state']


def check(states, inputs, mode=2):
    """Compare states with the kite and the library: the mode stays, nothing jumps."""
    linkage = scene.from_values({**KITE, 'linkage.mode': mode}).linkage
    for state, x in zip(states, inputs.tolist()):
        assert state.mode == mode and state.theta1 == pytest.approx(x, abs=1e-12)
        assert abs(remainder(state.theta4 - kite_angle(SHORT, LONG, mode, x), tau)) < 1e-11
        motion = linkage.motion(state.theta1, state.omega1, state.alpha1)
        assert (state.theta4, state.omega4, state.alpha4) == (motion.theta4, motion.omega4,
                                                              motion.alpha4)


@pytest.mark.parametrize('mode', [1, 2])
def test_motions_over_four_turns(run_node, client, tmp_path, mode):
    node = run_node({**KITE, 'linkage.mode': mode, 'drive.source': 'motion',
                     **recording_in(tmp_path)})
    client.listen(['state', 'loads', 'joint_states'])
    send = client.driving('motion')
    states = answered(client, send, [Motion(position=float(x), velocity=2.0, acceleration=0.5)
                                     for x in TURNS])
    check(states, TURNS, mode)
    loads = client.received['loads']
    for state, load, x in zip(states, loads, TURNS):
        assert state.status == load.status == (LinkageState.STATUS_OK if x else
                                               LinkageState.STATUS_TOGGLE)
        assert isnan(load.driving_torque) == isnan(load.f21) == isnan(state.condition) == (x == 0)
    joints = client.received['joint_states'][:-1]
    assert np.abs(np.diff([joint.position for joint in joints], axis=0)).max() < 0.5
    assert node.stop() == 0
    assert recomputed(tmp_path / 'run').inputs >= len(TURNS)


def test_a_joint_that_wraps_has_its_turns_counted(run_node, client):
    """Folded by a turn, the pose would be that of the other half of the period."""
    node = run_node({**KITE, 'drive.source': 'joint_state', 'drive.joint': 'motor',
                     'drive.window': 3})
    client.listen(['state', 'loads', 'joint_states'])
    send = client.driving('joint_state', name=['motor'], position=[0.0])
    messages, inputs = [], np.linspace(0.05, 8.0 * pi, 300)
    for k, x in enumerate(inputs.tolist()):
        message = JointState(name=['motor'], position=[remainder(x, tau)])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(10**10 + 10**7 * k, 10**9)
        messages.append(message)
    states = answered(client, send, messages)
    check(states[3:], inputs[3:])
    assert {state.status for state in states[3:]} == {LinkageState.STATUS_OK}
    client.until(lambda: 'its turns are counted from the first message on' in node.said, 'the log')


def test_a_timer_turns_on_through_flat_positions(run_node, client):
    node = run_node({**KITE, 'drive.source': 'timer', 'drive.speed': 12.0, 'drive.rate': 100.0,
                     'drive.start': 0.0})
    client.listen(['state'])
    states = client.received['state']
    client.until(lambda: states and states[-1].theta1 - states[0].theta1 > 8.0 * pi, 'four turns')
    assert node.stop() == 0
    check(states, np.array([state.theta1 for state in states]))


def test_services_tell_turns_apart(run_node, client):
    run_node({**KITE, 'drive.source': 'motion'})
    linkage, found = scene.from_values(KITE).linkage, []
    for x in (1.0, 1.0 + tau, 1.0 + 2.0 * tau, 0.0):
        answer = client.call('evaluate', position=x, velocity=1.0)
        assert answer.result == (answer.RESULT_OK if x else answer.RESULT_TOGGLE)
        found.append(answer.state.theta4)
        assert found[-1] == linkage.motion(x, 1.0, 0.0).theta4
    assert 'flat position' in answer.message and isnan(answer.loads.f21)
    assert abs(found[0] - found[1]) > 0.1 and abs(found[0] - found[2]) < 1e-14
    answer = client.call('find_extrema', quantities=['omega4', 'f21'], velocity=1.0)
    assert answer.result == answer.RESULT_OK and answer.extrema
    assert all(0.0 <= extremum.theta1 < 4.0 * pi for extremum in answer.extrema)
    assert {extremum.place for extremum in answer.extrema} <= {0, 1}
    assert any(extremum.theta1 > tau for extremum in answer.extrema)
