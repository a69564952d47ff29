# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The node cannot be broken from outside: garbage, floods, storms, restarts; nothing leaks.

``make soak`` runs the same for SOAK_MINUTES (default there: 60) instead of some seconds.
"""
import math
import os
from pathlib import Path
import random
import shutil
import signal
import struct
import time

from builtin_interfaces.msg import Duration, Time
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.ros.node.trajectories import FIELDS
from fourbar_ros.scene import scene
from geometry_msgs.msg import WrenchStamped
import pytest
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from support.faults import Faults
from support.harness import ALL_OUTPUTS, NodeProcess, set_parameters
from support.scenes import PAPER, RODS
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

SOAK = float(os.environ.get('SOAK_MINUTES', '0')) * 60.0
ROUNDS = 200 if not SOAK else 10_000            # malformed inputs of each kind
EDGES = [0.0, -0.0, 1.0, math.nan, math.inf, -math.inf, 5e-324, -5e-324, 1.7e308, -1.7e308, 1e154,
         1e16, math.pi]


def usage(process):
    """Return (memory [MB], threads, file descriptors, shared-memory maps) of a process."""
    proc = Path(f'/proc/{process.pid}')
    status = dict(line.split(':', 1) for line in (proc / 'status').read_text().splitlines())
    shared = sum('/dev/shm/' in line for line in (proc / 'maps').read_text().splitlines())
    return (int(status['VmRSS'].split()[0]) / 1024.0, int(status['Threads']),
            len(os.listdir(proc / 'fd')), shared)


def answered(client, send, angle):
    """Send a good message until it is answered; return the answer."""
    client.received['state'].clear()
    found = []

    def is_there():
        send()
        client.spin(0.05)            # all that came: one message at a time, the queue would grow
        found.extend(s for s in client.received['state'] if s.theta1 == angle)
        return found
    client.until(is_there, 'an answer to a good message')
    return found[0]


def check_alive(client, publisher, linkage):
    """Send a good message and demand the exact answer."""
    angle = random.uniform(0.0, 6.0)
    state = answered(client, lambda: publisher.publish(
        Motion(position=angle, velocity=2.0, acceleration=1.0)), angle)
    expected = linkage.motion(angle, 2.0, 1.0)
    assert (state.status, state.theta4, state.alpha4) == (LinkageState.STATUS_OK, expected.theta4,
                                                          expected.alpha4)


def stream(client, publisher, seconds, rate, also=lambda: None):
    """Send inputs at a rate [Hz] for some seconds; after every tenth ``also()``."""
    began, k = time.monotonic(), 0
    while time.monotonic() - began < seconds:
        publisher.publish(Motion(position=0.001 * k, velocity=1.0))
        k += 1
        if k % 10 == 0:
            also()
        ahead = k / rate - (time.monotonic() - began)
        if ahead > 0.0 or k % 20 == 0:
            client.executor.spin_once(timeout_sec=max(ahead, 0.0))


def random_motion(rng):
    message = Motion(position=rng.choice(EDGES), velocity=rng.choice(EDGES),
                     acceleration=rng.choice(EDGES))
    message.header.stamp = Time(sec=rng.choice([0, 1, -1, -2**31, 2**31 - 1]),
                                nanosec=rng.choice([0, 1, 999_999_999, 2**32 - 1]))
    message.header.frame_id = rng.choice(['', 'x' * 3000, 'ä\n'])
    return message


def random_bytes(rng):
    """Return a serialised Motion that is cut, filled up or overwritten somewhere."""
    data = bytearray(serialize_message(random_motion(rng)))
    for _ in range(rng.randint(1, 6)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    if rng.random() < 0.5:
        data = data[:rng.randrange(4, len(data) + 1)]
    if rng.random() < 0.2:
        # a string of two gigabytes that is not there
        data[4:] = struct.pack('<IIIQ', 0, 0, 2**31 - 1, 0)
    return bytes(data)


@pytest.fixture
def driven(run_node, client):
    """Return (node, publisher, linkage) of a node driven by Motion messages."""
    parameters = {**PAPER, **RODS, 'drive.source': 'motion', 'drive.timeout': 0.0,
                  'outputs': ALL_OUTPUTS}
    node = run_node(parameters)
    client.listen()
    publisher = client.publisher()
    client.handshake(lambda: publisher.publish(Motion(position=0.1)))
    return node, publisher, scene.from_values(parameters).linkage


def test_malformed_inputs_of_every_kind(driven, client):
    node, publisher, linkage = driven
    rng = random.Random(1)
    for k in range(ROUNDS):
        publisher.publish(random_motion(rng))
        publisher.publish(random_bytes(rng))
        if k % 50 == 0:
            check_alive(client, publisher, linkage)
    check_alive(client, publisher, linkage)
    for messages in client.received.values():
        for message in messages:
            for value in (getattr(message, name) for name in ('theta4', 'omega4', 'f41')
                          if hasattr(message, name)):
                assert (math.isnan(value) or message.status in (LinkageState.STATUS_OK,
                                                                LinkageState.STATUS_RATES_UNKNOWN))
    assert node.process.poll() is None and 'Traceback' not in node.said


@pytest.mark.slow
def test_joint_states_of_every_shape(run_node, client):
    node = run_node({**PAPER, 'drive.source': 'joint_state', 'drive.joint': 'motor',
                     'outputs': ['state']})
    client.listen(['state'])
    publisher = client.publisher('joint_state')
    client.handshake(lambda: publisher.publish(JointState(name=['motor'], position=[0.1],
                                                          velocity=[1.0])))
    rng = random.Random(2)
    for _ in range(ROUNDS):
        lengths = [rng.randrange(4) for _ in range(3)]
        publisher.publish(JointState(name=[rng.choice(['motor', '', 'x'])
                                           for _ in range(lengths[0])],
                                     position=rng.choices(EDGES, k=lengths[1]),
                                     velocity=rng.choices(EDGES, k=lengths[2])))
    many = JointState(name=[f'joint_{k}' for k in range(1_000_000)] + ['motor'],
                      position=[0.0] * 1_000_001)
    publisher.publish(many)
    assert answered(client, lambda: publisher.publish(
        JointState(name=['motor'], position=[1.25], velocity=[0.5])), 1.25)
    assert 'Traceback' not in node.said


@pytest.mark.slow
def test_a_parameter_storm_while_streaming_never_gives_a_mixed_answer(driven, client):
    _, publisher, _ = driven
    kinds = [scene.from_values({**PAPER, 'linkage.a1': a1, 'linkage.mode': mode}).linkage
             for a1, mode in ((0.4, 2), (0.3, 1))]
    for k in range(max(ROUNDS // 10, 20)):
        linkage = kinds[k % 2]
        publisher.publish(Motion(position=1.0, velocity=1.0))
        assert set_parameters(client, {'linkage.a1': linkage.a1, 'linkage.mode': linkage.mode},
                              atomically=True)[0].successful
        publisher.publish(Motion(position=1.0, velocity=1.0))
    allowed = {(linkage.mode, linkage.motion(1.0, 1.0).theta4) for linkage in kinds}
    client.until(lambda: len(client.received['state']) > 20, 'answers')
    assert {(s.mode, s.theta4) for s in client.received['state']} == allowed


class Beside:
    """A node for each round, moved by torque, that translates trajectories, good and bad ones."""

    def __init__(self, client, faults, folder, rng):
        self._client, self._faults, self._folder, self._rng = client, faults, folder, rng
        self._torque = client.node.create_publisher(WrenchStamped, '/beside/torque', 10)
        self._trajectory = client.node.create_publisher(JointTrajectory,
                                                        '/beside/output_trajectory', 10)
        self.answered = client.hear(JointTrajectory, '/beside/output_trajectory/drive')
        self.refused = client.hear(String, '/beside/trajectory_refused')
        self._points = [JointTrajectoryPoint(
            positions=[1.6 + 0.5 * math.sin(0.01 * i)], velocities=[0.5 * math.cos(0.01 * i)],
            time_from_start=Duration(nanosec=10**7 * (i % 100), sec=i // 100)) for i in range(200)]

    def start(self, number):
        """Start the node of a round."""
        self.answered.clear()
        self.refused.clear()
        self.node = self._faults.start(lambda: NodeProcess(
            {**PAPER, **RODS, 'drive.source': 'torque', 'drive.rate': 100.0, 'drive.start': 1.0,
             'trajectories': True, 'recording.start': True, 'recording.name': f'beside{number}'},
            self._folder, name='beside'))

    def disturb(self):
        """Send a torque, now and then a trajectory, seldom anything else."""
        rng, torque = self._rng, WrenchStamped()
        torque.wrench.torque.z = rng.choice([rng.uniform(-20.0, 20.0), rng.choice(EDGES)])
        self._torque.publish(torque)
        if rng.random() < 0.2:
            data = serialize_message(JointTrajectory(joint_names=['output'], points=self._points))
            broken = bytearray(data)
            broken[rng.randrange(4, 60)] = rng.randrange(256)
            self._trajectory.publish(data if rng.random() < 0.8 else bytes(broken))
        if rng.random() < 0.1:
            joint = rng.choice(['output', 'crank', ''])
            point = JointTrajectoryPoint(**{name: [rng.choice(EDGES)] for name in FIELDS})
            self._trajectory.publish(JointTrajectory(joint_names=[joint], points=[point]))
            self._torque.publish(random_bytes(rng))

    def end(self, number):
        """Have it answer still, then end by a signal, by its number."""
        count = len(self.answered)

        def is_answered():
            self.disturb()
            self._client.spin(0.02)
            return len(self.answered) > count and self.refused
        self._client.until(is_answered, 'an answer to a trajectory')
        assert self.node.stop(number) == 0, self.node.said
        assert 'Traceback' not in self.node.said, self.node.said


class Soak:
    """Rounds of all troubles in turn, for a node that records and one beside it: :meth:`round`."""

    def __init__(self, driven, client, faults, tmp_path):
        (self.node, self.publisher, self.linkage), self.client = driven, client
        self.faults, self.folder, self.rng = faults, tmp_path, random.Random(4)
        self.number = self.messages = self.dropped = self.steps = 0
        self._beside = Beside(client, faults, tmp_path, self.rng)

    def round(self, seconds):
        """Do it all once, 500 inputs a second between; return the usage of the node."""
        self.number += 1
        assert self.client.call('start_recording',
                                name=f'soak{self.number}').success, self.node.said
        self._beside.start(self.number)
        for trouble in (self._flood, self._garbage, self._set_clock, self._slow_disk,
                        self._readers, self._set_clock,
                        self._services):
            trouble()
            self.stream(seconds / 7.0)
        end = self.rng.choice([signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
        self._beside.end(end)
        check_alive(self.client, self.publisher, self.linkage)
        self._check(Path(self.client.call('stop_recording').message),
                    'stopped by ~/stop_recording')
        self._check(self.folder / f'bags/beside{self.number}', f'the node ended by {end.name}')
        assert 'Traceback' not in self.node.said
        self.faults.set()
        for messages in self.client.received.values():
            messages.clear()
        return usage(self.node.process)

    def stream(self, seconds):
        """Send inputs to the one node, torques and trajectories to the one beside."""
        stream(self.client, self.publisher, seconds, 500.0, self._beside.disturb)

    def _flood(self):
        # as fast as it goes: 20 times a usual rate
        stream(self.client, self.publisher, 1.0, math.inf)

    def _garbage(self):
        for _ in range(50):
            self.publisher.publish(random_motion(self.rng))
            self.publisher.publish(random_bytes(self.rng))

    def _set_clock(self):
        self.steps += 1
        self._clock = self.rng.choice([-3600.0, -100.0, -0.3, 0.3, 100.0, 3600.0])
        self.faults.set(clock=self._clock)

    def _slow_disk(self):
        self.faults.set(clock=self._clock, fsync=1.5, write=0.2)

    def _readers(self):
        passing = [self.client.node.create_subscription(LinkageState, '/fourbar/state',
                                                        lambda m: None, 1)
                   for _ in range(5)]
        check_alive(self.client, self.publisher, self.linkage)
        for subscription in passing:
            self.client.node.destroy_subscription(subscription)

    def _services(self):
        rng = self.rng
        quantities = rng.choice([[''], ['x' * 10_000], ['omega4', 'ä\n\t'], ['omega4', 'alpha4'],
                                 ['alpha4'] * 3])
        self.client.call('find_extrema', quantities=quantities, mode=rng.randrange(256),
                         velocity=rng.choice([1.0, *EDGES]))
        self.client.call('evaluate', position=rng.choice(EDGES), velocity=rng.choice(EDGES),
                         acceleration=rng.choice(EDGES), mode=rng.randrange(256))
        bad = {'linkage.a1': [-1.0, math.nan, math.inf, 'long', True, 99.0],
               'linkage.mode': [0, 3, 2.0, -2**63], 'outputs': [['x'], 5, 'state']}
        results = set_parameters(self.client, {name: rng.choice(values)
                                               for name, values in bad.items()})
        assert not any(result.successful or not result.reason for result in results), results

    def _check(self, path, ended):
        """Demand a whole bag that computes again; a full queue may leave gaps it tells of."""
        found = info(path, check=True)
        assert found.is_sound and found.is_finished, found
        assert found.ended == ended, found
        assert found.missing == found.dropped, found
        if not found.missing:
            compared = recompute(path)
            assert compared.inputs and not any(d.largest for d in compared.differences), (
                compared.differences)
        self.messages += sum(topic.messages for topic in found.topics)
        self.dropped += found.dropped
        shutil.rmtree(path)


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which('cc'), reason='needs a C compiler')
def test_all_troubles_in_turn_leave_nothing_behind(run_node, client, tmp_path):
    faults = Faults(tmp_path)
    parameters = {**PAPER, **RODS, 'drive.source': 'motion', 'drive.timeout': 0.5,
                  'outputs': ALL_OUTPUTS}
    node = faults.start(lambda: run_node(parameters))
    client.listen()
    publisher = client.publisher()
    client.handshake(lambda: publisher.publish(Motion(position=0.1)))
    soak = Soak((node, publisher, scene.from_values(parameters).linkage), client, faults, tmp_path)
    began, found = time.monotonic(), []
    while len(found) < 2 or time.monotonic() - began < SOAK:
        found.append(soak.round(20.0 if SOAK else 1.4))
        if SOAK:
            memory, threads, files, shared = found[-1]
            print(f'{time.monotonic() - began:6.0f} s, round {soak.number}: {memory:.1f} MB, '
                  f'{threads} threads, {files} files, {shared} shared maps; {soak.messages} '
                  f'messages recorded, {soak.dropped} dropped, {soak.steps} clock steps',
                  flush=True)
    # the first flood fills what the middleware keeps
    settled = found[len(found) // 4:]
    memory, threads, files, shared = (max(column) - column[0] for column in zip(*settled))
    # allocator noise; a leak per message is 100 MB
    assert memory < 20.0, f'memory grew by {memory:.1f} MB'
    assert (threads, files) == (0, 0)
    # Fast DDS keeps one map of each node that has left
    assert shared <= len(settled) + 2
