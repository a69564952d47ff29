# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The relay: on one topic with the robot's own joint states, it adds the passive joints.

Judged by the core and by the bag.
"""
from builtin_interfaces.msg import Time
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from support import contract
from support.harness import recomputed, recording_in
from support.samples import some
from support.scenes import PAPER, RODS, values_of

SAME_TOPIC = ('~/input_joint_states:=joint_states',)
RELAY = {'drive.source': 'joint_state', 'drive.joint': 'motor', 'drive.jump': 100.0,
         'joint_states.only_passive': True, 'outputs': ['joint_states', 'loads']}


def joint_state(positions, velocities, stamp):
    """Return a JointState of joints by name."""
    message = JointState(name=list(positions), position=list(positions.values()),
                         velocity=list(velocities))
    message.header.stamp = Time(sec=stamp)
    return message


class Robot:
    """Publishes the robot's joints on /joint_states and hears who answers there."""

    def __init__(self, client):
        self.client, self.answers, self.stamp = client, [], 0
        self._publisher = client.node.create_publisher(JointState, '/joint_states', 100)
        client.node.create_subscription(JointState, '/joint_states', self._take, 100)

    def _take(self, message):
        if 'wheel' not in message.name:
            self.answers.append(message)

    def move(self, joint, position, velocity):
        """Publish a joint among others until the answer with its stamp has come; return that."""
        self.stamp += 1

        def answered():
            self._publisher.publish(joint_state({'wheel': 7.0, joint: position},
                                                (1.0, velocity), self.stamp))
            self.client.executor.spin_once(timeout_sec=0.2)
            return self.answers and self.answers[-1].header.stamp.sec == self.stamp
        self.client.until(answered, f'an answer of {joint}')
        return self.answers[-1]


@some('case', contract.CASES[::6], 1, ids=contract.name_of)
def test_the_answers_are_the_passive_joints_of_the_core(run_node, client, tmp_path, case):
    mechanism, _ = next(contract.ordinary(case, 11, 1))
    coordinates = {f'joint_{i}': joint.coordinate for i, joint in enumerate(mechanism.JOINTS)}
    driven = next(name for name, its in coordinates.items() if its == mechanism.input_coordinate)
    node = run_node(values_of(mechanism, case.name, **RELAY)
                    | {'joint_names': list(coordinates), 'drive.joint': driven,
                       **recording_in(tmp_path)}, remaps=SAME_TOPIC)
    del coordinates[driven]
    robot, (low, high) = Robot(client), mechanism.input_ranges[0]
    for share in np.linspace(0.05, 0.95, 19):
        position = low + share * (high - low)
        answer, motion = robot.move(driven, position, 2.0), mechanism.motion(position, 2.0)
        passive = coordinates.values()
        assert list(answer.name) == list(coordinates)
        wanted = [getattr(motion, its.position) for its in passive]
        assert list(answer.position) == pytest.approx(
            wanted, rel=0.0, abs=1e-12 * max(1.0, motion.condition))
        assert list(answer.velocity) == [getattr(motion, its.rate) for its in passive]
        # frictionless, whether the acceleration is known or not
        assert list(answer.effort) == [0.0] * len(passive)
    assert node.stop() == 0 and 'without' not in node.said
    found = recomputed(tmp_path / 'run')
    assert {d.topic for d in found.differences} >= {'/joint_states', '/fourbar/loads'}


# --- what comes back -----------------------------------------------------------------------------

HEARS_ITSELF = [({'drive.source': 'joint_state', 'drive.joint': 'O1', 'outputs': ['joint_states']},
                 '~/input_joint_states:=joint_states', '/joint_states',
                 'joint_states.only_passive leaves the driven joint to its publisher'),
                ({'drive.source': 'motion', 'outputs': ['output']}, '~/input:=/fourbar/output',
                 '/fourbar/output', 'would take its own answers for inputs')]


@some('values, remap, topic, said', HEARS_ITSELF, 1)
def test_an_answer_on_the_topic_of_the_input_is_refused(run_node, values, remap, topic, said):
    node = run_node({**PAPER, **values}, remaps=[remap])
    assert node.wait() == 2
    assert f'are one topic, {topic}' in node.said and said in node.said


@pytest.mark.slow
def test_a_driven_joint_that_never_comes_is_missed(run_node, client, diagnosed):
    node = run_node({**PAPER, **RODS, **RELAY, 'drive.joint': 'motr',
                     'joint_names': ['motr', 'a', 'b', 'c']}, remaps=SAME_TOPIC)
    publisher = client.node.create_publisher(JointState, '/joint_states', 10)

    def told():
        publisher.publish(joint_state({'wheel': 7.0, 'motor': 0.2}, (0.0, 1.0), 1))
        client.spin(0.02)
        return ('did you mean motor?' in node.said
                and "joint 'motr' never came" in diagnosed()[0].message)
    client.until(told, 'the warning')
    assert ("drive.joint = 'motr' had a position in none of the first 20 messages on /joint_states"
            in node.said)
