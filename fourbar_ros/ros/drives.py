"""What moves the crank: a thread on the clock's grid, a timer of simulated time, or a subscription."""
from __future__ import annotations

import threading
import time

from builtin_interfaces.msg import Time
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from .. import interfaces, records
from .messages import resolve

SLEEP = 0.1            # [s] longest sleep: how soon a thread sees that it shall stop
CATCH_UP = 1.0         # [s] a later thread than this skips the samples it missed


def to_stamp(nanoseconds):
    """Return the Time message of a time [ns]."""
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


class TimerDrive:
    """
    Constant speed on the wall clock: sample k belongs to start + k / rate, whatever the scheduler does.

    An own thread, not a ROS timer: rclpy's timers drop the ticks they miss and slip their grid.
    """

    def __init__(self, node, drive, step):
        self._node, self._drive, self._step = node, drive, step
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name='drive', daemon=True)

    def start(self):
        """Start the thread."""
        self._thread.start()

    def stop(self):
        """Stop it and wait for the sample in hand."""
        self._stop.set()
        self._thread.join()

    def _run(self):
        speed, start, period = self._drive.speed, self._drive.start, 1.0 / self._drive.rate
        began, stamp0 = time.monotonic(), self._node.get_clock().now().nanoseconds
        sample = 0
        while not self._stop.is_set():
            elapsed = sample * period
            wait = began + elapsed - time.monotonic()
            if wait > 0.0:
                time.sleep(min(wait, SLEEP))
                continue
            if wait < -CATCH_UP:
                sample = int((time.monotonic() - began) / period)
                continue
            self._step(to_stamp(stamp0 + round(elapsed * 1e9)), start + speed * elapsed, speed, 0.0)
            sample += 1


class SimulatedTimerDrive:
    """Constant speed on simulated time: a ROS timer, the angle taken from the clock."""

    def __init__(self, node, drive, step):
        self._node, self._drive, self._step = node, drive, step
        self._timer, self._began = None, None

    def start(self):
        """Start the timer."""
        self._timer = self._node.create_timer(1.0 / self._drive.rate, self._tick)

    def stop(self):
        """Stop it."""
        self._timer.cancel()

    def _tick(self):
        now = self._node.get_clock().now().nanoseconds
        if self._began is None:
            self._began = now
        angle = self._drive.start + self._drive.speed * (now - self._began) * 1e-9
        self._step(to_stamp(now), angle, self._drive.speed, 0.0)


class TopicDrive:
    """Every input message makes one step, stamped as the message."""

    def __init__(self, node, drive, step):
        self._node, self._drive, self._step = node, drive, step
        self._topic = interfaces.INPUTS[drive.source]
        self._type = resolve(self._topic.type)
        self._subscription, self._joint_seen = None, True

    def start(self):
        """Subscribe. Raw bytes: they are what is recorded."""
        qos = QoSProfile(depth=interfaces.INPUT_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._subscription = self._node.create_subscription(
            self._type, self._topic.topic, self._receive, qos, raw=True)

    def stop(self):
        """Unsubscribe."""
        self._node.destroy_subscription(self._subscription)

    def _receive(self, data):
        message = deserialize_message(data, self._type)
        crank = records.crank_of(message, self._drive)
        if (crank is not None) != self._joint_seen:      # once per change, not per message
            self._joint_seen = crank is not None
            if not self._joint_seen:
                self._node.get_logger().warning(f'joint {self._drive.joint!r} is not in the input message')
        if crank is not None:
            self._step(message.header.stamp, *crank, data)
