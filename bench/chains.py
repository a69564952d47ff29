# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Latency of chains of nodes, beside one bare rclpy node that echoes.

Each node is a process; the output of one is the input of the next. The time is from publishing an
input to hearing the output of the last node with its stamp. Rounds of all chains alternate, so
that the load of the machine is the same for all. Lost are inputs that were never answered, late
those that were answered after the next one had been sent.
"""
import json
from os import getloadavg
from pathlib import Path
import statistics
import tempfile
import time

from fourbar_msgs.msg import Motion
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy

from .processes import Child, PATIENCE

LENGTHS = {'linkage.a1': 0.4, 'linkage.a2': 1.2, 'linkage.a3': 0.8, 'linkage.a4': 1.0,
           'drive.source': 'motion', 'drive.timeout': 0.0, 'outputs': ['output']}
CHAINS = (1, 2, 4, 8)
RATE = 100.0           # [Hz]
ROUNDS = 3
ECHO = """
import rclpy
from fourbar_msgs.msg import Motion
from rclpy.experimental import EventsExecutor
rclpy.init()
node = rclpy.create_node('bare')
publisher = node.create_publisher(Motion, '/bare/output', 10)
node.create_subscription(Motion, '/bare/input', publisher.publish, 100)
executor = EventsExecutor()
executor.add_node(node)
while rclpy.ok():
    executor.spin_once(timeout_sec=0.2)
"""


def start(count):
    """Return (processes, first input topic, last output topic) of a chain; 0: the bare node."""
    if not count:
        return [Child('bare', '-c', ECHO)], '/bare/input', '/bare/output'
    file, names = Path(tempfile.mkdtemp()) / 'scene.yaml', [f'c{count}_{i}' for i in range(count)]
    file.write_text(json.dumps({'/**': {'ros__parameters': LENGTHS}}))
    children = [Child(name, '-m', 'fourbar_ros.ros.node.start', '--ros-args', '--params-file',
                      str(file), '-r', f'__node:={name}',
                      *(('-r', f'~/input:=/{before}/output') if before else ()))
                for before, name in zip(['', *names], names)]
    return children, f'/{names[0]}/input', f'/{names[-1]}/output'


class Chain:
    """A chain and its ends in this process."""

    def __init__(self, node, count):
        self.count, self.delays, self.sent = count, [], 0
        self.children, first, last = start(count)
        self._publisher = node.create_publisher(Motion, first, 10)
        node.create_subscription(Motion, last, self._hear, QoSProfile(
            depth=100, reliability=ReliabilityPolicy.BEST_EFFORT))
        self._times, self.is_awake = {}, False

    def send(self, k):
        message = Motion(position=0.01 * (k % 600), velocity=1.0, acceleration=0.0)
        message.header.stamp.sec, message.header.stamp.nanosec = 1 + k // 1000, k % 1000 * 10**6
        self._times[message.header.stamp.sec, message.header.stamp.nanosec] = time.perf_counter()
        self._publisher.publish(message)
        self.sent += 1

    def _hear(self, message):
        began = self._times.pop((message.header.stamp.sec, message.header.stamp.nanosec), None)
        self.is_awake = True
        if began is not None:
            self.delays.append(time.perf_counter() - began)

    def forget(self):
        self.delays, self.sent, self._times = [], 0, {}


def wake(executor, chains):
    """Send until every chain answers, then forget what it took."""
    end, k = time.monotonic() + 2.0 * PATIENCE, 0
    while not all(chain.is_awake for chain in chains):
        if time.monotonic() > end:
            raise SystemExit(f'silent: {[c.count for c in chains if not c.is_awake]}')
        k += 1
        for chain in chains:
            chain.send(k)
        until = time.monotonic() + 0.2
        while time.monotonic() < until:
            executor.spin_once(timeout_sec=0.02)
    for chain in chains:
        chain.forget()


def drive(executor, chain, samples, first):
    """Send samples at the rate to one chain, and hear what comes."""
    began = time.monotonic()
    for k in range(samples):
        while (left := began + k / RATE - time.monotonic()) > 0.0:
            executor.spin_once(timeout_sec=left)
        chain.send(first + k)
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)


def report(chains, samples):
    """Print the table."""
    echo = statistics.median(chains[0].delays)
    print(f'{ROUNDS} rounds of {samples} inputs at {RATE:g} Hz each; p50 over that of the echo; '
          f'late: after {1e3 / RATE:g} ms, when the next input was sent. '
          f'Load of the machine at the end: {getloadavg()[0]:.1f}.\n')
    print('| nodes | p50 [us] | over echo | p99 [us] | jitter p99 - p50 [us] | inputs | late '
          '| lost |\n|' + ' --- |' * 8)
    for chain in chains:
        delays = sorted(chain.delays)
        p50, p99 = statistics.median(delays), delays[int(0.99 * len(delays))]
        late = sum(delay > 1.0 / RATE for delay in delays)
        print(f'| {chain.count or "bare echo"} | {1e6 * p50:.0f} | {p50 / echo:.2f} | '
              f'{1e6 * p99:.0f} | {1e6 * (p99 - p50):.0f} | {chain.sent} | '
              f'{late} ({100.0 * late / chain.sent:.2g} %) | {chain.sent - len(delays)} |')


def main(samples=300):
    """Measure and print a table."""
    rclpy.init()
    node, executor = rclpy.create_node('ends'), EventsExecutor()
    executor.add_node(node)
    chains = [Chain(node, count) for count in (0, *CHAINS)]
    try:
        wake(executor, chains)
        for turn in range(ROUNDS):
            for chain in chains:
                drive(executor, chain, samples, 10**6 * (turn + 1))
    finally:
        for chain in chains:
            for child in chain.children:
                child.stop()
    report(chains, samples)
    node.destroy_node()
    rclpy.try_shutdown()
