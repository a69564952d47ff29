# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Trouble around the node.

Lost and bad inputs, clocks that are set, a log and diagnostics that stay readable.
"""
import math
import shutil
import signal
import subprocess
import sys
import time

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.ros.node.entities import SequenceNumbers
import pytest
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy
from ros.test_inputs import answers, SECOND, stamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from support.faults import Faults
from support.harness import (
    nanoseconds,
    PATIENCE,
    set_parameters,
)
from support.scenes import PAPER

DRIVEN = {**PAPER, 'drive.source': 'motion', 'drive.timeout': 0.0, 'outputs': ['state']}


# --- lost inputs ---------------------------------------------------------------------------------

SLOW = """
import time
from fourbar_ros.ros.node.stream import Stream
step = Stream.step
Stream.step = lambda self, *given: (time.sleep(0.001), step(self, *given))
"""


def test_what_is_lost_is_counted_to_the_last_message(run_node, client, diagnosed):
    """Inputs faster than a step, and more than are kept: received and lost are all."""
    run_node(DRIVEN, first=SLOW)
    client.listen(['state'])
    sending = [client.publisher() for _ in range(2)]
    for publisher in sending:
        client.handshake(lambda publisher=publisher: publisher.publish(Motion(position=0.1)))

    def counted():
        _, values = diagnosed()
        return int(values.get('received', 0)) + int(values.get('lost', 0))
    seen = -1
    while seen != counted() or not seen:                             # the handshake is counted
        seen, number = counted(), len(diagnosed.messages)
        client.until(lambda number=number: len(diagnosed.messages) > number + 1, 'diagnostics')
    for k in range(3000):
        sending[k % 2].publish(Motion(position=0.001 * k))
    client.until(lambda: counted() == seen + 3000, 'all counted')
    status, values = diagnosed()
    assert int(values['lost']) > 0
    client.until(lambda: 'lost' not in diagnosed()[0].message, 'the next second')
    lost = [m.status[0] for m in diagnosed.messages if ' lost' in m.status[0].message]
    assert lost and all(s.level == DiagnosticStatus.WARN for s in lost)


def test_gaps_in_the_numbers_of_several_publishers():
    sequence = SequenceNumbers(lambda: 2)
    lost = [sequence.lost_before(number) for number in (1, 2, 901, 3, 902, 6, 903, 7, 905)]
    assert lost == [0, 0, 0, 0, 0, 2, 0, 0, 1]                       # 4, 5; 904
    assert sequence.is_numbered
    # one of them was started again; then a middleware without numbers
    assert sequence.lost_before(1) == sequence.lost_before(None) == 0
    assert not sequence.is_numbered
    sequence.forget()
    assert not any(map(sequence.lost_before, (40, 10, 11, 41)))


def test_a_late_input_is_counted_and_a_publisher_without_the_deadline_is_named(
        run_node, client, diagnosed):
    node = run_node({**PAPER, 'drive.source': 'motion', 'drive.timeout': 0.0, 'outputs': ['state'],
                     'qos_overrides./fourbar/input.subscription.deadline': SECOND // 5})
    client.listen(['state'])
    client.publisher()                                   # offers none
    client.until(lambda: 'incompatible' in node.said.lower() or 'DEADLINE' in node.said,
                 'the warning')
    offered = QoSProfile(depth=10, deadline=Duration(nanoseconds=SECOND // 5))
    publisher = client.node.create_publisher(Motion, '/fourbar/input', offered)
    client.handshake(lambda: publisher.publish(Motion(position=0.1)))
    # nothing is sent now
    client.until(lambda: int(diagnosed()[1].get('deadlines missed', 0)) >= 2, 'the count')


def test_a_publisher_that_does_not_match_is_no_silence(run_node, client, diagnosed):
    node = run_node({**DRIVEN, 'qos_overrides./fourbar/input.subscription.reliability':
                     'reliable'})
    sender = client.node.create_publisher(
        Motion, '/fourbar/input', QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT))

    def is_said():
        sender.publish(Motion(position=0.1))
        return ('no input yet: the publisher of /fourbar/input has an incompatible reliability'
                in diagnosed()[0].message)
    client.until(is_said, 'the diagnostics')
    assert diagnosed()[1]['incompatible publishers'] == '1'
    assert '~/input: nothing is received from a publisher with an incompatible reliab' in node.said


# --- the log -------------------------------------------------------------------------------------

def test_good_and_bad_inputs_in_turns_are_a_few_lines(run_node, client, diagnosed):
    node, began = run_node(DRIVEN), time.monotonic()
    client.listen(['state'])
    send = client.driving()
    # as many at once as are kept for certain
    for _ in range(30):
        states = answers(client, send, [Motion(position=0.2), Motion(position=math.nan)] * 10)
    assert [s.status for s in states[:2]] == [LinkageState.STATUS_OK,
                                              LinkageState.STATUS_INVALID_INPUT]
    for use_sim_time in (True, False):
        changed = set_parameters(client, {'use_sim_time': use_sim_time})[0]
        assert changed.successful is not use_sim_time
        assert changed.successful or 'at start' in changed.reason
    assert node.stop() == 0
    lines = [line for line in node.said.splitlines() if 'theta1 =' in line or 'good again' in line]
    assert 2 <= len(lines) <= 2 * (1 + (time.monotonic() - began) / 10.0)    # each in ten seconds


# --- clocks --------------------------------------------------------------------------------------

@pytest.mark.skipif(not shutil.which('cc'), reason='needs a C compiler')
def test_a_node_on_a_timer_stops_whatever_the_clock(run_node, client, diagnosed, tmp_path):
    """Nothing comes in that would wake it, and its executor waits by the clock that was set."""
    faults = Faults(tmp_path)
    node = faults.start(lambda: run_node({**PAPER, 'outputs': ['state']}))
    client.until(lambda: diagnosed.messages, 'diagnostics')
    faults.set(clock=-3600.0)
    node.process.send_signal(signal.SIGTERM)
    assert node.process.wait(PATIENCE) == 0


# --- stamps and estimates ------------------------------------------------------------------------

def test_a_stamp_that_is_no_time_is_replaced_and_counted(run_node, client, diagnosed):
    run_node(DRIVEN)
    client.listen(['state'])
    send = client.driving()
    for sec, nanosec in ((0, 0), (-1, 5), (5, 10**9), (-2**31, 2**32 - 1)):   # 0 is none given
        message = Motion(position=0.3)
        message.header.stamp = Time(sec=sec, nanosec=nanosec)
        before = client.node.get_clock().now().nanoseconds
        state, = answers(client, send, [message])
        assert before <= nanoseconds(state) <= client.node.get_clock().now().nanoseconds
        assert state.status == LinkageState.STATUS_OK
    client.until(lambda: diagnosed()[1].get('bad stamps') == '3', 'the count')


@pytest.mark.slow
def test_an_estimated_acceleration_that_is_noise_is_reported(run_node, client, diagnosed):
    """An encoder of 1000 counts at 500 Hz: its acceleration is 1e3 rad/s2 of nothing."""
    run_node({**DRIVEN, 'drive.source': 'joint_state', 'drive.joint': 'motor'})
    client.listen(['state'])
    publisher = client.publisher('joint_state')
    sent = [0]

    def send(resolution):
        sent[0] += 1
        position = 3.0 * sent[0] * 0.002
        if resolution:
            position = round(position / resolution) * resolution
        publisher.publish(stamped(JointState(name=['motor'], position=[position]),
                                  10**18 + sent[0] * 2_000_000))
    client.handshake(lambda: send(0.0))
    for is_noise, resolution in ((True, math.tau / 1000.0), (False, 0.0)):
        def is_said(is_noise=is_noise, resolution=resolution):
            send(resolution)
            status, values = diagnosed()
            return 'noise of the estimated acceleration [rad/s^2]' in values and (
                'acceleration is noise' in status.message) is is_noise
        client.until(is_said, f'noise: {is_noise}')
    # window 5
    assert float(diagnosed()[1]['lag of the estimated acceleration [s]']) == pytest.approx(0.004)


def test_an_input_that_never_comes_is_told_with_where_its_type_comes(run_node, client, diagnosed):
    assert client.node.create_publisher(JointState, '/robot/joint_states', 10)
    run_node({**PAPER, 'drive.source': 'joint_state', 'drive.joint': 'crank',
              'outputs': ['joint_states']})          # of its own they are no hint
    client.until(lambda: 'comes on /robot/joint_states' in diagnosed()[0].message, 'diagnostics')
    status, _ = diagnosed()
    assert status.level == DiagnosticStatus.WARN
    assert status.message == ('no input yet: /fourbar/input_joint_states has no publisher; '
                              'sensor_msgs/msg/JointState comes on /robot/joint_states')


def test_a_second_node_of_one_name_is_told(run_node, client, diagnosed):
    nodes = [run_node(PAPER) for _ in range(2)]
    client.until(lambda: 'another node has this name' in diagnosed()[0].message, 'a warning')
    client.until(lambda: all('another node has this name' in node.said for node in nodes),
                 'a line in both logs')
    assert all(node.process.poll() is None for node in nodes)


def test_frames_that_two_nodes_move_are_told(client, tmp_path):
    """One process, two fingers: without a prefix TF would jump between them."""
    hand = tmp_path / 'hand.yaml'
    hand.write_text('\n'.join(f"""/{name}:
  ros__parameters:
    linkage: {{a1: 0.4, a2: 1.2, a3: 0.8, a4: 1.0}}
    joint_states: {{prefix: {prefix}}}
    outputs: [tf]""" for name, prefix in (('left', 'l_'), ('right', "''"), ('third', "''"))))
    process = subprocess.Popen(
        [sys.executable, '-m', 'fourbar_ros.ros.node.start', 'left', 'right', 'third',
         '--ros-args', '--params-file', str(hand)], stderr=subprocess.PIPE, text=True)
    said = [process.stderr.readline() for _ in range(4)]      # how each moves, and the warning
    process.terminate()
    assert process.wait(PATIENCE) == 0
    warned, = (line for line in said if 'keep them apart' in line)
    assert 'frames coupler_link, crank_link, output_link: also of right' in warned


def test_a_clock_below_zero_is_told_and_ignored(run_node, client):
    """It ends a bare rclpy node."""
    node = run_node({**PAPER, 'use_sim_time': True, 'outputs': ['state']})
    client.listen(['state'])
    clock = client.node.create_publisher(Clock, '/clock', 10)

    def tick(sec):
        message = Clock()
        message.clock.sec = sec
        clock.publish(message)
        client.spin(0.05)
    client.until(lambda: tick(1) or client.received['state'], 'a state')
    client.until(lambda: tick(-1) or '/clock: -1 s is no time: ignored' in node.said, 'a line')
    client.until(lambda: tick(7) or client.received['state'][-1].header.stamp.sec == 7, 'time 7')


def test_a_fault_in_a_sample_of_the_timer_does_not_end_the_node(run_node, client):
    broken = """
from fourbar_ros.pipeline.stepper import Stepper
step, calls = Stepper.step, []
def fail(self, *given):
    calls.append(given)
    if len(calls) == 5:
        raise ValueError('as a test')
    return step(self, *given)
Stepper.step = fail
"""
    node = run_node({**PAPER, 'outputs': ['state'], 'drive.rate': 50.0}, first=broken)
    client.listen(['state'])
    client.until(lambda: 'as a test' in node.said and len(client.received['state']) > 20,
                 'samples after the fault')
    assert 'a fault in a sample' in node.said
    node.said = node.said.replace('Traceback', '')       # this one was asked for
