# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""joint_states and the input joint over the wire: what is not known, ratio and offset, prefix."""
import math

from fourbar_msgs.msg import Motion
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.scene import scene
import pytest
from sensor_msgs.msg import JointState
from support.harness import ALL_OUTPUTS
from support.scenes import PAPER, ROCKER, RODS


def test_a_geared_joint_comes_in_and_goes_out_by_the_same_formula(run_node, client):
    gear = {'drive.joint_ratio': -3.0, 'drive.joint_offset': 0.25,
            'joint_states.ratios': [-3.0, 1.0, 1.0, 2.0],
            'joint_states.offsets': [0.25, 0.0, 0.0, -0.5],
            'joint_states.prefix': 'left_'}
    given = {**PAPER, **RODS, **gear, 'drive.source': 'joint_state', 'drive.joint': 'motor',
             'outputs': ['state', 'joint_states', 'loads']}
    run_node(given)
    client.listen(['state', 'joint_states', 'loads'])
    send = client.driving('joint_state', name=['motor'], position=[0.0], velocity=[0.0])
    sent = [JointState(name=['motor'], position=[0.01 * k], velocity=[6.0]) for k in range(1, 4)]
    for message in sent:
        send(message)
    client.until(lambda: all(len(inbox) >= 3 for inbox in client.received.values()), 'the answers')
    states, joints = client.received['state'], client.received['joint_states']
    for message, state, joint, loads in zip(sent, states, joints, client.received['loads']):
        assert (state.theta1, state.omega1) == ((message.position[0] - 0.25) / -3.0, -2.0)
        assert joint.position[0] == pytest.approx(message.position[0], abs=4 * 2.0**-54)
        assert joint.velocity[0] == 6.0
        assert (joint.position[3] == 2.0 * state.theta4 - 0.5 and joint.velocity[3]
                == 2.0 * state.omega4)
        assert joint.effort[0] == loads.driving_torque / -3.0
        assert list(joint.name) == ['left_crank', 'left_coupler', 'left_coupler_output',
                                    'left_output']
    assert scene.from_values(given).linkage.motion(states[-1].theta1).theta4 == states[-1].theta4


def test_a_bag_that_begins_while_positions_are_held_computes_again(run_node, client, tmp_path):
    node = run_node({**ROCKER, **RODS, 'drive.source': 'motion', 'outputs': ALL_OUTPUTS,
                     'recording.directory': 'runs',
                     'joint_states.when_unknown': 'hold',
                     'joint_states.ratios': [1.0, 1.0, -1.5, 1.0],
                     'drive.out_of_range': 'hold'})
    client.listen(['state', 'joint_states'])
    send = client.driving()
    send(Motion(position=0.2))
    send(Motion(position=1.0))
    client.until(lambda: len(client.received['state']) >= 2, 'a held answer')
    answer = client.call('start_recording', name='held')
    assert answer.path == str(tmp_path / 'runs/held')
    for k, position in enumerate([1.0, 1.1, 0.3, 1.0, 0.1, math.nan, 0.2]):
        send(Motion(position=position, velocity=float(k)))
    client.until(lambda: len(client.received['state']) >= 9, 'the answers')
    assert client.call('stop_recording').message == str(tmp_path / 'runs/held')
    assert node.stop() == 0
    found = recompute(tmp_path / 'runs/held')
    assert found.inputs == 7 and not found.unmatched
    assert {d.field for d in found.differences
            if d.topic == '/joint_states'} >= {'position', 'velocity', 'effort'}
    assert found.largest == 0.0, [d for d in found.differences if d.largest]
