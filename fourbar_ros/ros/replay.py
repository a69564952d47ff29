"""Publish a bag again: the recorded bytes, as they are."""
from __future__ import annotations

import signal
import threading

import rclpy
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

from ..bag import BagError
from ..bag.reader import Bag
from ..bag.replay import TICK, play
from .drives import to_stamp
from .messages import resolve

DEPTH = 100                 # of publishers whose bag does not say
FAREWELL = 2.0              # [s] for reliable readers to get the last messages


class Replayer:
    """
    A node that publishes what it is given, each message on its topic with its recorded quality of service.

    Parameters
    ----------
    bag : Bag
    clock_rate : float, optional
        Publish /clock so often a second of wall time.
    rate : float
        Times as fast as recorded.
    ros_args : list of str
        As ``['--ros-args', '-r', ...]``.

    """

    def __init__(self, bag, clock_rate=None, rate=1.0, ros_args=()):
        self._stop = threading.Event()
        self._old = {number: signal.signal(number, lambda *_: self._stop.set())
                     for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
        rclpy.init(args=list(ros_args), signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node('fourbar_replay')
        self.bag, self._publishers, self._left_out = bag, {}, set()
        self._clock = self.node.create_publisher(Clock, '/clock', 10) if clock_rate else None
        self.period = 1.0 / clock_rate if clock_rate else TICK
        self._step, self._ticked = self.period * rate * 1e9, 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for publisher in self._publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=FAREWELL))
        self.node.destroy_node()
        rclpy.try_shutdown()
        for number, handler in self._old.items():
            signal.signal(number, handler)

    def tick(self, now):
        """Publish the time of the bag [ns]; returns False when it is time to stop."""
        if self._clock and not 0 <= now - self._ticked < self._step:
            self._ticked = now
            self._clock.publish(Clock(clock=to_stamp(now)))
        return not self._stop.is_set()

    def publish(self, raw):
        """Publish one message; return whether its type is installed."""
        publisher = self._publishers.get(raw.topic) or self._make(raw)
        if publisher:
            publisher.publish(raw.data)
        return bool(publisher)

    def _make(self, raw):
        if raw.topic in self._left_out:
            return None
        try:
            kind = resolve(raw.type)
        except (ModuleNotFoundError, AttributeError, ValueError):
            self._left_out.add(raw.topic)
            self.node.get_logger().warning(f'{raw.topic}: {raw.type} is not installed, left out')
            return None
        self._publishers[raw.topic] = self.node.create_publisher(kind, raw.topic, self._qos(raw.topic))
        return self._publishers[raw.topic]

    def _qos(self, topic):
        offered = (self.bag.qos_of(topic) or [{}])[0]
        return QoSProfile(
            depth=offered.get('depth') or DEPTH,
            reliability=ReliabilityPolicy.BEST_EFFORT if offered.get('reliability') in ('best_effort', 2)
            else ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if offered.get('durability') in ('transient_local', 1)
            else DurabilityPolicy.VOLATILE)


def replay(path, topics=None, rate=1.0, start=0.0, loop=False, follow=False, clock_rate=None, ros_args=()):
    """Publish a bag until its end or a signal; return how many messages; see bag.replay.play."""
    bag = Bag(path)
    count = 0
    with Replayer(bag, clock_rate, rate, ros_args) as replayer:
        for raw in play(bag, topics, rate, start, loop, follow, replayer.tick, replayer.period):
            count += replayer.publish(raw)
    if not count and topics:
        raise BagError(f'{path}: no message on {", ".join(topics)}')
    return count
