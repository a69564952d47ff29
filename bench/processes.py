# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Nodes in processes of their own, and one that listens and drives them."""
from contextlib import contextmanager
import gc
import os
from pathlib import Path
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time

from support.scenes import file_of, PAPER, RODS

from . import ROOT

KINEMATICS = ['state']
FULL = ['state', 'output', 'joint_states', 'loads', 'shaking_wrench']
PATIENCE = 30.0        # [s] for discovery
SETTLE = 1.0           # [s] after it, before anything is measured
STAMP = struct.Struct('<iI')
os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
os.environ.setdefault('ROS_LOG_DIR', tempfile.mkdtemp(prefix='fourbar_bench_'))


class Child:
    """A process under measurement."""

    def __init__(self, name, *command):
        self.name = name
        self.process = subprocess.Popen([sys.executable, *command], cwd=ROOT,
                                        stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        # clock_getcpuclockid(3): all its threads, in nanoseconds
        self._clock = (~self.process.pid << 3) | 2

    def cpu(self):
        """Return the CPU time used so far [s]."""
        return time.clock_gettime(self._clock)

    def stop(self):
        """End it."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(20)


def node_of(values, name='fourbar'):
    """Start fourbar_node with these parameters."""
    return Child(name, '-m', 'fourbar_ros.ros.node.start', '--ros-args', '--params-file',
                 str(file_of(values, Path(tempfile.mkdtemp()))), '-r', f'__node:={name}', '-r',
                 f'joint_states:=/{name}/joint_states')


def ours(outputs=KINEMATICS, name='fourbar', **parameters):
    """Start fourbar_node with these outputs and parameters (dots written as two underscores)."""
    return node_of({**PAPER, **RODS, 'drive.speed': 25.0, 'outputs': outputs, **{
        key.replace('__', '.'): value for key, value in parameters.items()}}, name)


def bare(kind, outputs=KINEMATICS, rate=1.0):
    """Start the bare node."""
    return Child('bare', '-m', 'bench.bare', kind, str(rate), *outputs)


class Listener:
    """
    Hears the state of a child in raw bytes: arrival times and stamps; drives its input.

    Its other outputs have a reader too, but of a node that nobody spins: they are delivered, and
    cost this process as little as can be.
    """

    def __init__(self, name, outputs=KINEMATICS):
        from fourbar_msgs.msg import Motion
        from fourbar_ros.ros.messages import resolve
        from fourbar_ros.scene.topics import OUTPUTS
        import rclpy
        from rclpy.experimental import EventsExecutor
        from rclpy.serialization import serialize_message

        self.node = rclpy.create_node(f'listener_of_{name}')
        self._deaf = rclpy.create_node(f'reader_of_{name}')
        self.arrived = []                               # (time of arrival, stamp) [ns]
        self._given = bytearray(serialize_message(Motion(position=0.3, velocity=25.0)))
        for output in outputs:
            reader, take, depth = ((self.node, self._take, 1000) if output == 'state' else
                                   (self._deaf, lambda data: None, 1))
            reader.create_subscription(resolve(OUTPUTS[output].type), f'/{name}/{output}', take,
                                       depth, raw=True)
        self._input = self.node.create_publisher(Motion, f'/{name}/input', 10)
        self._executor = EventsExecutor()
        self._executor.add_node(self.node)
        self._running = True
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self):
        while self._running:
            self._executor.spin_once(timeout_sec=0.1)

    def _take(self, data):
        now = time.time_ns()
        sec, nanosec = STAMP.unpack_from(data, 4)       # behind the 4 bytes of the encapsulation
        self.arrived.append((now, sec * 10**9 + nanosec))

    def send(self):
        """Send an input stamped with the time."""
        STAMP.pack_into(self._given, 4, *divmod(time.time_ns(), 10**9))
        self._input.publish(bytes(self._given))

    def wait(self, poke=None):
        """
        Wait for the first message, and then until all is found.

        ``poke`` is called meanwhile.
        """
        end = time.monotonic() + PATIENCE
        while not self.arrived and time.monotonic() < end:
            if poke:
                poke()
            time.sleep(0.02)
        if not self.arrived:
            raise RuntimeError('nothing heard')
        time.sleep(SETTLE)

    def close(self):
        """Leave the graph."""
        self._running = False
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        self._deaf.destroy_node()


class Slice:
    """CPU time and answers of a child during a part of a measurement: between entry and exit."""

    def __init__(self, child, listener):
        self._child, self._listener = child, listener

    def __enter__(self):
        self._cpu, self._count = self._child.cpu(), len(self._listener.arrived)
        self.began = time.monotonic()
        return self

    def __exit__(self, *_):
        got = self._listener.arrived[self._count:]
        self.seconds, self.cpu = time.monotonic() - self.began, self._child.cpu() - self._cpu
        self.late = [(arrived - stamp) * 1e-3 for arrived, stamp in got]      # [us]

    @property
    def per_step(self):
        """Return the CPU time per answer [us]."""
        return self.cpu / max(len(self.late), 1) * 1e6


def sent(rate, seconds, sends):
    """
    Call the functions in turn, ``rate`` times a second, on an absolute grid.

    Return how often.
    """
    began, total = time.monotonic(), int(rate * seconds)
    for k in range(total):
        wait = began + k / rate - time.monotonic()
        if wait > 0.0:
            time.sleep(wait)
        sends[k % len(sends)]()
    return total


@contextmanager
def undisturbed():
    """Let this process be in the graph all the time, and collect no garbage meanwhile."""
    import rclpy
    rclpy.init()
    anchor = rclpy.create_node('bench')
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        anchor.destroy_node()
        rclpy.try_shutdown()


def percentile(values, share):
    """Return a percentile of a list, NaN of an empty one."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else float('nan')
