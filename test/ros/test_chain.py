# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads pass back along a chain of nodes, fall silent, and recompute from the bag."""
import math
import time

from builtin_interfaces.msg import Time
from fourbar_lab.clients.node_client import name_on
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros import Applied, External
from fourbar_ros.bag.reader import records
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.scene import scene
from fourbar_ros.scene.topics import applied_topic, wrench_topic
from geometry_msgs.msg import WrenchStamped
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from support.samples import some
from support.scenes import PAPER, RODS, SLIDES_7_6

LOADED = {**PAPER, **RODS, 'outputs': ['state', 'loads'], 'drive.source': 'motion',
          'drive.timeout': 0.0}


def motion(position, velocity=2.0, stamp=1):
    message = Motion(position=position, velocity=velocity, acceleration=3.0)
    message.header.stamp = Time(sec=stamp)
    return message


def wrench(force_x=0.0, force_y=0.0, couple=0.0, frame=''):
    message = WrenchStamped()
    message.header.frame_id = frame
    message.wrench.force.x, message.wrench.force.y, message.wrench.torque.z = (force_x, force_y,
                                                                               couple)
    return message


class Loaded:
    """A node that a test loads and drives."""

    def __init__(self, run_node, client, link='output', arguments=(), **parameters):
        self.client = client
        parameters = {name.replace('__', '.'): value for name, value in parameters.items()}
        self.given = {**LOADED, f'external.{link}.from_topic': True, **parameters}
        self.node = run_node(self.given, arguments=arguments)
        self.scene = scene.from_values(self.given)
        self.link, self.applied, self.stamp = link, [], 1
        client.node.create_subscription(
            WrenchStamped, name_on('fourbar', applied_topic(link)), self.applied.append,
            QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self._wrenches = client.node.create_publisher(WrenchStamped,
                                                      name_on('fourbar', wrench_topic(link)), 10)
        client.listen(['state', 'loads'])
        self._drive = client.publisher()
        client.handshake(lambda: self._drive.publish(motion(0.1)))
        client.until(lambda: self._wrenches.get_subscription_count() and self.applied,
                     'the wrench topics')

    def load(self, *numbers, frame=''):
        """
        Send a wrench until it acts.

        An earlier one that was sent twice must not be taken for it.
        """
        given = wrench(*numbers).wrench
        while True:
            self._wrenches.publish(wrench(*numbers, frame=frame))
            end = time.monotonic() + 0.5
            while time.monotonic() < end:
                self.client.executor.spin_once(timeout_sec=0.05)
                if repr(self.applied[-1].wrench) == repr(given):     # NaN is NaN here
                    return

    def answer(self, position):
        """
        Return (state, loads) of an input.

        Those with its stamp, so that no late answer is taken for them.
        """
        self.stamp += 1
        inboxes = self.client.received['state'], self.client.received['loads']
        self._drive.publish(motion(position, stamp=self.stamp))
        self.client.until(lambda: all(inbox and inbox[-1].header.stamp.sec == self.stamp
                                      for inbox in inboxes),
                          'an answer')
        return tuple(inbox[-1] for inbox in inboxes)

    def under(self, position, *numbers):
        """Return the driving torque of the core under a wrench, in the place of the scene."""
        given = getattr(self.scene.linkage.external, self.link)
        applied = Applied(*numbers[:2], given.along, given.across, numbers[2])
        loaded = self.scene.linkage.with_external(External(**{self.link: applied}))
        return loaded.loads(position, 2.0, 3.0).driving_torque


@some('link', ['crank', 'output'], 1)
def test_a_wrench_from_a_topic_acts_from_the_next_step_on(run_node, client, link):
    node = Loaded(run_node, client, link, **{f'external.{link}.along': 0.4,
                                             'external.timeout': 0.0})
    state, loads = node.answer(0.3)
    assert state.status == loads.status == LinkageState.STATUS_LOADS_UNKNOWN
    assert math.isfinite(state.alpha4) and math.isnan(loads.driving_torque)
    for numbers, frame in (((5.0, -3.0, 0.5), ''), ((-1.0, 0.0, 0.0), 'fourbar'),
                           ((0.0, 0.0, 7.0), 'other')):
        node.load(*numbers, frame=frame)
        state, loads = node.answer(0.3)
        assert (state.status == LinkageState.STATUS_OK and loads.driving_torque
                == node.under(0.3, *numbers))
    applied = node.applied[-1]
    assert (applied.header.frame_id, applied.wrench.torque.z) == ('fourbar', 7.0)
    node.load(math.nan)
    assert node.answer(0.4)[1].status == LinkageState.STATUS_LOADS_UNKNOWN


def test_a_force_of_another_frame_does_not_act(run_node, client):
    node = Loaded(run_node, client, external__timeout=0.0)
    node.load(5.0)
    for _ in range(3):
        node._wrenches.publish(wrench(9.0, frame='tool'))
    client.until(lambda: "'tool'" in node.node.said, 'the warning')
    assert node.answer(0.3)[1].driving_torque == node.under(0.3, 5.0, 0.0, 0.0)
    node.node.stop()
    assert node.node.said.count("'tool'") == 1


@some('policy', ['unknown', 'constant'], 1)
def test_a_silence(run_node, client, policy):
    node = Loaded(run_node, client, external__timeout=0.4, external__when_silent=policy,
                  external__output__couple=2.5)
    node.load(5.0, 1.0, -1.0)
    client.until(lambda: 'no wrench for' in node.node.said, 'the silence')
    # ours had no stamp
    client.until(lambda: node.applied[-1].header.stamp.sec > 0, 'what acts now')
    state, loads = node.answer(0.3)
    if policy == 'unknown':
        assert state.status == LinkageState.STATUS_LOADS_UNKNOWN and math.isnan(loads.f41)
    else:
        acts = (5.0, 1.0, -1.0) if policy == 'hold' else (0.0, 0.0, 2.5)
        assert loads.driving_torque == node.under(0.3, *acts)


@pytest.mark.slow
def test_a_silence_runs_on_simulated_time(run_node, client):
    node = Loaded(run_node, client, arguments=('-p', 'use_sim_time:=true'),
                  external__timeout=0.4)
    clock, now = client.node.create_publisher(Clock, '/clock', 10), [10.0]
    client.until(clock.get_subscription_count, 'the node at the clock')

    def tick(seconds):
        now[0] += seconds
        clock.publish(Clock(clock=Time(sec=int(now[0]), nanosec=round(now[0] % 1.0 * 1e9))))
        client.spin(0.02)

    tick(0.1)
    node.load(5.0, 1.0, -1.0)
    for _ in range(3):
        client.spin(0.6)                     # longer than the timeout, and simulated: nothing
        tick(0.05)
        assert node.answer(0.3)[0].status == LinkageState.STATUS_OK
        node.load(5.0, 1.0, -1.0)
    now[0] = 3.0                             # back: it counts from there
    for _ in range(4):
        tick(0.05)
    assert 'no wrench for' not in node.node.said
    client.until(lambda: tick(0.05) or 'no wrench for' in node.node.said, 'the silence')
    assert 3.4 < now[0]
    assert node.answer(0.3)[0].status == LinkageState.STATUS_LOADS_UNKNOWN


def test_loads_go_back_along_a_chain_and_both_bags_compute_again(run_node, client, tmp_path):
    chained = {'drive.source': 'motion', 'drive.timeout': 0.0, 'recording.start': True}
    first = {**PAPER, **RODS, **chained, 'outputs': ['output', 'loads', 'state'],
             'external.output.from_topic': True,
             'external.timeout': 0.0, 'recording.name': 'one'}
    second = {**SLIDES_7_6, **RODS, **chained, 'outputs': ['loads', 'drive_wrench', 'state'],
              'frame_id': 'next',
              'recording.name': 'two'}
    nodes = [run_node(first, name='one', remaps=['~/external/output:=/two/drive_wrench']),
             run_node(second, name='two', remaps=['~/input:=/one/output'])]
    client.listen(['loads'], node='one')
    publisher = client.publisher(node='one')

    def settled(position):
        """Send a pose until the torque is what it was: the wrench of a step acts in the next."""
        torques = [m.driving_torque for m in client.received['loads'] if m.header.stamp.sec
                   == position[1]]
        return len(torques) > 2 and torques[-1] == torques[-2]

    for stamp, angle in ((1, 0.3), (2, 1.4), (3, -2.0)):
        def send():
            publisher.publish(motion(angle, stamp=stamp))
            client.executor.spin_once(timeout_sec=0.05)
            return settled((angle, stamp))
        client.until(send, 'the same torque twice')
        between = scene.from_values(PAPER).linkage.motion(angle, 2.0, 3.0)
        torque = scene.from_values(second).linkage.loads(between.theta4, between.omega4,
                                                         between.alpha4).driving_torque
        alone = scene.from_values(first).linkage
        loaded = alone.with_external(External(output=Applied(couple=-torque)))
        together = loaded.loads(angle, 2.0, 3.0).driving_torque
        assert (client.received['loads'][-1].driving_torque == together
                != alone.loads(angle, 2.0, 3.0).driving_torque)
    for node in nodes:
        assert node.stop() == 0
    for name in ('one', 'two'):
        found = recompute(tmp_path / 'bags' / name)
        assert found.inputs > 8 and max(d.largest for d in found.differences) == 0.0
    topics = {record.topic for record in records(tmp_path / 'bags/one')}
    assert {'/two/drive_wrench', '/one/applied/output'} <= topics


@some('policy', ['unknown', 'hold', 'constant'], 1)
def test_a_bag_with_wrenches_silences_and_changes_computes_again(run_node, client, tmp_path,
                                                                 policy):
    from ros.test_inputs import set_parameters
    node = Loaded(run_node, client, external__timeout=0.0, external__when_silent=policy,
                  external__output__couple=2.5)
    node.load(5.0, 1.0, -1.0)
    # while something acts from before
    assert client.call('start_recording', name='run').success
    torques = [node.answer(0.3)[1].driving_torque]
    node.load(-2.0, 0.0, 0.3)
    torques.append(node.answer(0.3)[1].driving_torque)
    assert set_parameters(client, {'external.output.along': 0.2})[0].successful
    torques.append(node.answer(0.3)[1].driving_torque)
    assert set_parameters(client, {'external.timeout': 0.1})[0].successful
    client.until(lambda: 'no wrench for' in node.node.said, 'the silence')
    assert set_parameters(client, {'external.timeout': 0.0})[0].successful
    torques.append(node.answer(0.3)[1].driving_torque)
    assert set_parameters(client, {'external.output.couple': -1.5})[0].successful
    torques.append(node.answer(0.3)[1].driving_torque)
    node.load(1.0, 1.0, 1.0)
    torques.append(node.answer(0.3)[1].driving_torque)
    assert node.node.stop() == 0
    assert len(set(map(repr, torques))) == {'unknown': 5, 'hold': 4,
                                            'constant': 6}[policy], torques
    found = recompute(tmp_path / 'bags/run')
    assert found.inputs == 6 and max(d.largest for d in found.differences) == 0.0
    torque, = [d for d in found.differences if d.field == 'driving_torque']
    assert torque.messages == 6


@pytest.mark.slow
def test_a_split_bag_recomputes_and_a_later_file_alone_says_why_not(run_node, client, tmp_path):
    node = Loaded(run_node, client, external__timeout=0.0, recording__split_duration=0.5)
    node.load(5.0, 1.0, -1.0)                            # once, before the bag
    assert client.call('start_recording', name='run').success
    end = time.monotonic() + 1.3
    while time.monotonic() < end:
        assert node.answer(0.3)[1].driving_torque == node.under(0.3, 5.0, 1.0, -1.0)
        client.executor.spin_once(timeout_sec=0.05)
    assert node.node.stop() == 0
    parts = sorted((tmp_path / 'bags/run').glob('*.mcap'))
    assert len(parts) > 1
    for bag in (tmp_path / 'bags/run', parts[0]):
        found = recompute(bag)
        assert found.compared and found.largest == 0.0 and not found.skipped, bag
    assert recompute(parts[1]).skipped == {'depend on what came before this file':
                                           2 * recompute(parts[1]).inputs}


@pytest.mark.slow
def test_what_is_no_wrench_is_in_no_bag(run_node, client, tmp_path):
    loaded = Loaded(run_node, client, external__timeout=0.0, recording__start=True,
                    recording__name='run', recording__directory=str(tmp_path))
    # a shorter message of another type on the same topic: only raw bytes get there
    for data in (b'\x00\x01\x00\x00', serialize_message(wrench(1.0))[:-9], b''):
        loaded._wrenches.publish(data)
    loaded.load(3.0, -2.0, 1.0)
    loaded.answer(0.4)
    assert loaded.node.stop() == 0
    kept = [r.message for r in records(tmp_path / 'run') if r.topic == '/fourbar/external/output']
    assert kept and all(message.wrench.force.x == 3.0 for message in kept)
    assert max(d.largest for d in recompute(tmp_path / 'run').differences) == 0.0


@pytest.mark.slow
def test_a_wrench_of_a_chain_can_be_taken_a_step_further(run_node, client, tmp_path):
    """On the line through the last two; after a silence, and with a NaN, as it came."""
    loaded = Loaded(run_node, client, external__timeout=0.0, external__extrapolated=True,
                    recording__start=True, recording__name='run',
                    recording__directory=str(tmp_path))

    def sent(couple):
        count = len(loaded.applied)
        loaded._wrenches.publish(wrench(couple=couple))
        client.until(lambda: len(loaded.applied) > count, 'what acts')
        return loaded.applied[-1].wrench.torque.z
    assert [sent(couple) for couple in (1.0, 4.0, 5.0, 1e308, -1e308)] == [
        1.0, 7.0, 6.0, 1e308, -1e308]
    assert math.isnan(sent(math.nan)) and sent(2.0) == 2.0 and sent(3.0) == 4.0
    _, loads = loaded.answer(0.7)
    assert loads.driving_torque == loaded.under(0.7, 0.0, 0.0, 4.0)
    assert loaded.node.stop() == 0
    assert max(d.largest for d in recompute(tmp_path / 'run').differences) == 0.0
