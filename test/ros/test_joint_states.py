# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Joints of a robot: a relay adds the passive ones on their topic; gears, prefix, what is held."""
from collections import Counter
from functools import partial
from itertools import count
import math

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from fourbar_msgs.msg import Motion
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene import scene
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from support import bags, contract
from support.harness import ALL_OUTPUTS, LATCHED, recomputed, recording_in, set_parameters
from support.samples import some
from support.scenes import PAPER, ROCKER, RODS, values_of

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

    def has_listeners(self, count):
        """Return whether so many hear it."""
        self.client.executor.spin_once(timeout_sec=0.2)
        return self._publisher.get_subscription_count() >= count

    def say(self, joint, position, velocity, stamp):
        """Publish a joint among others once."""
        self._publisher.publish(joint_state({'wheel': 7.0, joint: position}, (1.0, velocity),
                                            stamp))

    def move(self, joint, position, velocity):
        """Publish a joint among others until the answer with its stamp has come; return that."""
        self.stamp += 1

        def answered():
            self.say(joint, position, velocity, self.stamp)
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
        apart = np.subtract(answer.position, wanted)
        turns = [its.unit == 'rad' and round(x / math.tau) for its, x in zip(passive, apart)]
        assert np.abs(apart - math.tau * np.array(turns, float)).max() <= (
            1e-12 * max(1.0, motion.condition))
        assert list(answer.velocity) == [getattr(motion, its.rate) for its in passive]
        # frictionless, whether the acceleration is known or not
        assert list(answer.effort) == [0.0] * len(passive)
    assert node.stop() == 0 and 'without' not in node.said
    found = recomputed(tmp_path / 'run')
    assert {d.topic for d in found.differences} >= {'/joint_states', '/fourbar/loads'}


@pytest.mark.slow
def test_a_bag_of_all_that_is_said_on_the_topic_of_a_relay_recomputes(run_node, client, tmp_path):
    """As ``ros2 bag record`` does, it has the robot's joint states beside the node's answers."""
    topics = {'/joint_states': 'sensor_msgs/msg/JointState', '/fourbar/scene':
              'std_msgs/msg/String', '/fourbar/driven': 'fourbar_msgs/msg/Motion',
              '/fourbar/loads': 'fourbar_msgs/msg/LinkageLoads'}
    writer, heard = BagWriter(tmp_path, 'all', [
        bags.channel(*topic) for topic in topics.items()], {}), Counter()

    def hear(number, topic, data):
        writer.write(number, data)
        heard[topic] += 1
    for number, (topic, kind) in enumerate(topics.items()):
        client.node.create_subscription(
            resolve(kind), topic, partial(hear, number, topic),
            LATCHED if topic.endswith('scene') else 100, raw=True)
    run_node({**PAPER, **RODS, **RELAY, 'joint_names': ['motor', 'a', 'b', 'c']},
             remaps=SAME_TOPIC)
    robot = Robot(client)
    client.until(lambda: heard['/fourbar/scene'] and robot.has_listeners(3), 'the node')
    for k in range(1, 31):
        robot.say('motor', 0.05 * k, 1.0, k)
        client.until(lambda k=k: heard['/joint_states'] == 2 * k and heard['/fourbar/loads'] == k
                     and heard['/fourbar/driven'] == k, f'answer {k}')
    found = recompute(writer.close())
    assert (found.inputs, found.compared, found.problems()) == (30, 60, []), found


def test_a_joint_that_is_left_out_is_in_no_answer(run_node, client, tmp_path):
    names = ['motor', 'a', 'cut', 'c']
    node = run_node({**PAPER, **RODS, **RELAY, 'joint_names': names, 'drive.joint': 'l_motor',
                     'joint_states.only_passive': False, 'joint_states.prefix': 'l_',
                     'joint_states.leave_out': ['motor', 'cut'],
                     'joint_states.offsets': [0.0, 0.5, 7.0, 0.25], **recording_in(tmp_path)},
                    remaps=SAME_TOPIC)
    robot, linkage = Robot(client), scene.from_values(PAPER).linkage
    client.until(lambda: robot.has_listeners(2), 'the node')
    for k in range(5):
        answer, motion = robot.move('l_motor', 0.3 + 0.1 * k, 2.0), linkage.motion(
            0.3 + 0.1 * k, 2.0)
        assert answer.name == ['l_a', 'l_c']
        assert list(answer.position) == [motion.theta2 + 0.5, motion.theta4 + 0.25]
        assert list(answer.velocity) == [motion.omega2, motion.omega4]
    assert node.stop() == 0
    recomputed(tmp_path / 'run')


def test_a_joint_geared_to_the_input_is_published_on_its_topic(run_node, client):
    """The driven joint is the node's own where a motor elsewhere is geared to it."""
    names = ['right', 'a', 'b', 'c']
    node = run_node({**PAPER, **RELAY, 'joint_names': names, 'drive.joint': 'left',
                     'drive.joint_ratio': -1.0, 'joint_states.only_passive': False,
                     'outputs': ['joint_states']}, remaps=SAME_TOPIC)
    robot, linkage = Robot(client), scene.from_values(PAPER).linkage
    client.until(lambda: robot.has_listeners(2), 'the node')
    for k in range(5):
        answer, motion = robot.move('left', -0.3 - 0.1 * k, -2.0), linkage.motion(
            0.3 + 0.1 * k, 2.0)
        assert answer.name == names
        # the command is the given one over -1, to its last bits
        assert [answer.position[index] for index in (0, 1, 3)] == pytest.approx(
            [0.3 + 0.1 * k, motion.theta2, motion.theta4], abs=8.0 * 2.0**-52 * motion.condition)
    robot.say('right', 1.0, 0.0, 99)            # as another publisher of its joint
    answer = robot.move('left', -0.2, 0.0)
    assert answer.position[0] == 0.2
    assert node.stop() == 0 and 'without' not in node.said


# --- what comes back -----------------------------------------------------------------------------

HEARS_ITSELF = [({'drive.source': 'joint_state', 'drive.joint': 'crank',
                  'outputs': ['joint_states']},
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
    assert ("/joint_states: drive.joint = 'motr' had a position in none of the first 20 messages"
            in node.said)


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


def test_joints_go_on_through_bags_and_changes_and_recompute(run_node, client, tmp_path):
    """Three turns of an output with ratio 1.5; a live change and two bags on the way."""
    given = {'linkage.a1': 0.5, 'linkage.a2': 0.45, 'linkage.a3': 0.5, 'linkage.a4': 0.2,
             'drive.source': 'motion', 'outputs': ['joint_states', 'state'],
             'joint_states.ratios': [1.0, 1.0, 1.0, 1.5], 'recording.directory': str(tmp_path)}
    node, inputs = run_node(given), np.linspace(0.0, 6.0 * math.pi, 600)
    client.listen(['joint_states', 'state'])
    send = client.driving(position=0.0)
    for k, x in enumerate(inputs.tolist()):
        if k in (150, 400):
            assert client.call('start_recording', name=f'run{k}').success
        if k == 300:
            assert client.call('stop_recording').success
        if k in (200, 450):
            assert set_parameters(client, {'linkage.a1': 0.5 + 1e-4 * k})[0].successful
        send(Motion(position=x))
        client.until(lambda k=k: min(map(len, client.received.values())) > k, f'answer {k}')
    assert node.stop() == 0
    found = np.array([message.position for message in client.received['joint_states']])
    theta4 = np.unwrap([state.theta4 for state in client.received['state']])
    assert abs(theta4[-1] - theta4[0]) > 18.0
    assert np.abs(found[:, 3] - 1.5 * theta4).max() < 1e-13
    assert recomputed(tmp_path / 'run150').inputs == 150
    assert recomputed(tmp_path / 'run400').inputs == 200


def test_a_geared_encoder_that_wraps_goes_on(run_node, client, diagnosed):
    """The crank of a motor with ratio -3 was 2.1 rad off after each turn, with STATUS_OK."""
    node = run_node({**PAPER, 'drive.source': 'joint_state', 'drive.joint': 'motor',
                     'drive.joint_ratio': -3.0, 'outputs': ['state']})
    client.listen(['state'])
    send = client.driving('joint_state', name=['motor'], position=[0.0])
    motor = 0.05 * np.arange(400)
    for k, angle in enumerate(motor):
        message = joint_state({'motor': (angle + math.pi) % math.tau - math.pi}, (), 0)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(10**10 + 10**7 * k, 10**9)
        send(message)
        client.until(lambda k=k: len(client.received['state']) > k, f'answer {k}')
    states = client.received['state']
    assert [state.theta1 for state in states] == pytest.approx(-motor / 3.0, abs=1e-12)
    assert [state.omega1 for state in states[3:]] == pytest.approx([-5.0 / 3.0] * 397, abs=1e-9)
    client.until(lambda: 'its turns are counted from the first message on' in node.said, 'the log')
    assert 'top_speed' not in node.said


def test_another_publisher_of_the_driven_joint_or_of_ours_is_said(run_node, client, diagnosed):
    """As joint_state_publisher beside a broadcaster: zeros for all joints between the real."""
    node = run_node({**PAPER, **RODS, **RELAY, 'joint_names': ['motor', 'a', 'b', 'c']},
                    remaps=SAME_TOPIC)
    robot, other, wheels = (client.node.create_publisher(JointState, '/joint_states', 100)
                            for _ in range(3))
    stamp = count(1)

    def problems(*messages):
        """Return the problems of the diagnostics that follow some rounds of messages."""
        seen = len(diagnosed.messages)
        while len(diagnosed.messages) < seen + 3:
            for publisher, positions in messages:
                publisher.publish(joint_state(positions, (0.0,) * len(positions), next(stamp)))
                client.spin(0.02)
        return diagnosed()[0].message
    real, wheel = (robot, {'motor': 0.3}), (wheels, {'wheel': 7.0})
    client.until(lambda: 'more than one' not in problems(real, wheel), 'a sound robot')
    assert 'another publisher' not in problems(real, wheel)
    zeros = (other, {'motor': 0.0, 'a': 0.0, 'b': 0.0, 'c': 0.0})
    said = problems(real, wheel, zeros)
    assert "more than one publisher sends joint 'motor' on /joint_states" in said
    assert 'another publisher sends a, b, c on /joint_states, which this node computes' in said
    assert 'more than one publisher' in problems(real, (other, {'motor': 0.0}))
    assert 'another publisher sends a on' in problems(real, (other, {'a': 0.0}))
    assert node.said.count('more than one publisher') >= 1


def test_two_publishers_of_a_motion_are_said(run_node, client, diagnosed):
    run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state']})
    both = [client.publisher(), client.publisher()]

    def is_said():
        for publisher in both:
            publisher.publish(Motion(position=0.1))
        client.spin(0.02)
        return ('more than one publisher sends on /fourbar/input' in diagnosed()[0].message
                and diagnosed()[0].level == DiagnosticStatus.WARN)
    client.until(is_said, 'the diagnostics')
