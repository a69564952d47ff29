# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A real node in a process of its own and a real client beside it."""
from contextlib import suppress
from operator import attrgetter
import os
from pathlib import Path
import re
import resource
import signal
import subprocess
import sys
import threading
import time

from fourbar_lab.clients.node_client import NoAnswer, NodeClient
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.ros.messages import resolve, to_stamp
from fourbar_ros.scene.topics import DRIVEN, FAMILIES, full_name, OUTPUTS, PICTURES
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
import rclpy
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from support.scenes import file_of

# Requests that change nothing, to learn whether a service and its client have seen each other.
HARMLESS = {'find_extrema': {'quantities': ['?']}, 'evaluate': {},
            'start_recording': {'name': '..'}}
# [s] discovery takes 0.3 s mostly, 4 s sometimes; 30 s are too few beside 20 busy processes
PATIENCE = 120.0
LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# the others have a topic for each of their members
ALL_OUTPUTS = [name for name in OUTPUTS if name not in FAMILIES]


def nanoseconds(message):
    """Return the stamp of a message [ns]."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def recording_in(folder):
    """Return the parameters of a node that records from its start, as ``run`` in a folder."""
    return {'recording.start': True, 'recording.name': 'run',
            'recording.directory': str(folder)}


def in_bag(path, topic):
    """Return the messages of a topic in a bag."""
    return [record.message for record in Bag(path).records([topic])]


def recomputed(path):
    """Recompute a bag, demand that nothing differs, and return what was found."""
    found = recompute(path)
    assert found.inputs and not found.problems() and found.largest == 0.0, found
    return found


def cpu_of(pid):
    """Return the CPU time that a process has used, by all its threads [s]."""
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def cpu_of_ended():
    """Return the CPU time of all processes that this one has waited for [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def fields_of(layout, output, message):
    """Return the fields of a message as FieldMap.expected does."""
    def plain(value):
        return tuple(value) if hasattr(value, '__len__') else value

    return {field: plain(attrgetter(field)(message))
            for field in layout.expected(output, [0.0] * len(layout.index_of))}


class NodeProcess:
    """
    fourbar_node with these parameters, after the code ``first``; what it says is kept in ``said``.

    Silence is no timeout unless a test says so: on a slow machine its default would be one more
    message.
    """

    def __init__(self, parameters, tmp_path, name='fourbar', remaps=(), first=''):
        self.name = name
        file = file_of({'drive.timeout': 0.0, **parameters}, tmp_path, name)
        remap = [part for rule in (f'__node:={name}', *remaps) for part in ('-r', rule)]
        run = ['-c', f'{first}\nimport sys; from fourbar_ros.ros.node.start import main; '
                     'sys.exit(main())']
        self.process = subprocess.Popen(
            [sys.executable, *(run if first else ['-m', 'fourbar_ros.ros.node.start']),
             '--ros-args', '--params-file', str(file), *remap],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=tmp_path,
            env=os.environ)
        self.said = ''
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.said += line

    def wait(self):
        """Wait for its end and return the exit code."""
        code = self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        return code

    def stop(self, number=signal.SIGTERM):
        """Signal it and return the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.wait()


class Client(NodeClient):
    """The product's own client, with the patience of a test; collects what it hears."""

    def __init__(self):
        rclpy.init()
        super().__init__(rclpy.create_node('tester'), PATIENCE)
        self.received, self._parameters = {}, {}

    def listen(self, names=ALL_OUTPUTS, node='fourbar', depth=1000):
        """Collect all messages in ``received``: of topics by name, or {name: topic}."""
        topics = names if isinstance(names, dict) else {**OUTPUTS, **PICTURES, 'driven': DRIVEN}
        for name in names:
            self.node.create_subscription(
                resolve(topics[name].type), full_name(topics[name].topic, node),
                self.received.setdefault(name, []).append,
                LATCHED if topics[name].latched else depth)

    def hear(self, kind, topic, depth=1000):
        """Return the growing list of the messages on a topic."""
        heard = []
        self.node.create_subscription(kind, topic, heard.append, depth)
        return heard

    def publisher(self, source='motion', node='fourbar'):
        """Return a publisher on the input topic."""
        return super().publisher(source, node)

    def driving(self, source='motion', node='fourbar', **fields):
        """Return the function that sends an input, once its node and all listeners have met."""
        publisher = self.publisher(source, node)
        kind = publisher.msg_type
        self.handshake(lambda: publisher.publish(kind(**fields or {'position': 0.1})))
        return publisher.publish

    def handshake(self, send):
        """
        Send until an answer comes on every listened topic; return the answers, then forgotten.

        It ends when nothing more has come for ten times as long as an answer let wait, 0.3 to 3 s:
        one on its way would be taken for an answer of the test.
        """
        end = time.monotonic() + PATIENCE
        while not all(self.received.values()):
            assert time.monotonic() < end, (
                f'no answer: {({k: len(v) for k, v in self.received.items()})}')
            send()
            sent = time.monotonic()
            self.executor.spin_once(timeout_sec=0.05)
        last, wait = time.monotonic(), 10.0 * (time.monotonic() - sent)
        count = sum(map(len, self.received.values()))
        while (now := time.monotonic()) - last < max(0.3, min(wait, 3.0)):
            self.executor.spin_once(timeout_sec=0.05)
            if (found := sum(map(len, self.received.values()))) != count:
                wait, count, last = max(wait, 10.0 * (time.monotonic()
                                                      - now)), found, time.monotonic()
        found = {name: list(messages) for name, messages in self.received.items()}
        for messages in self.received.values():
            messages.clear()
        return found

    def service(self, service_name, node='fourbar'):
        """Return the client of a service, one that its server knows."""
        known = len(self._services)
        service = super().service(service_name, node)
        if len(self._services) > known and service_name in HARMLESS:
            self.introduce(service, service_name)
        return service

    def introduce(self, service, service_name):
        """
        Ask until the first answer.

        A server that has not seen its client yet drops what it answers.
        """
        request = service.srv_type.Request(**HARMLESS[service_name])
        end = time.monotonic() + PATIENCE
        while True:
            future, again = service.call_async(request), time.monotonic() + 3.0
            while time.monotonic() < again:
                self.executor.spin_once(timeout_sec=0.05)
                if future.done():
                    return
            assert time.monotonic() < end, f'no answer of {service_name}'

    def ask(self, kind, node='fourbar', **fields):
        """
        Return the answer of a parameter service.

        It is asked again: what leaves a server before it has found a new client is dropped.
        """
        name = f'/{node}/' + re.sub('(?<!^)([A-Z])', r'_\1', kind.__name__).lower()
        if name not in self._parameters:
            self._parameters[name] = self.node.create_client(kind, name)
        caller = self._parameters[name]
        self.until(caller.service_is_ready, name)
        for _ in range(4):
            future = caller.call_async(kind.Request(**fields))
            with suppress(NoAnswer):
                self.until(future.done, name, 0.25 * self.patience)
                return future.result()
        raise NoAnswer(f'{name}: no answer to {fields}'[:200])

    def close(self):
        """Leave the graph."""
        super().close()
        self.node.destroy_node()
        rclpy.try_shutdown()


class SimulatedClock:
    """
    Publishes /clock, in steps [ns] by :meth:`tick`.

    ``repeats``: the time is sent again and again, as by a simulation that stands.
    """

    def __init__(self, client, now=10**9, step=20_000_000, repeats=False):
        self.now, self.step, self._client = now, step, client
        self._publisher = client.node.create_publisher(Clock, '/clock', 10)
        if repeats:
            client.node.create_timer(0.02, self.send)

    def send(self):
        """Publish the time."""
        self._publisher.publish(Clock(clock=to_stamp(self.now)))

    def tick(self):
        """Go on by a step; handle messages for a while."""
        self.now += self.step
        self.send()
        self._client.spin(0.01)


def set_parameters(client, values, atomically=False, node='fourbar'):
    """Change parameters of a node; return the results."""
    given = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
    answer = client.ask(SetParametersAtomically if atomically else SetParameters, node,
                        parameters=given)
    return [answer.result] if atomically else answer.results
