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
from .messages import resolve, to_stamp
from .schemas import type_hash

DEPTH = 1000                # of volatile publishers: a late replay sends bursts that the original did not
FAREWELL = 2.0              # [s] for reliable readers to get the last messages


def installed(type_name, recorded_hash):
    """Return (class, '') of a message type, or (None, why its recorded bytes cannot be sent here)."""
    try:
        kind, here = resolve(type_name), type_hash(type_name)
    except (LookupError, ModuleNotFoundError, AttributeError, ValueError, OSError):
        return None, f'{type_name} is not installed'
    if recorded_hash and recorded_hash != here:
        return None, f'{type_name} was recorded by another definition than the one installed'
    return kind, ''


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
        self.bag, self._publishers = bag, {}
        self._clock = self.node.create_publisher(Clock, '/clock', 10) if clock_rate else None
        self.period = 1.0 / clock_rate if clock_rate else TICK
        self._step, self._ticked = self.period * rate * 1e9, 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for publisher in filter(None, (*self._publishers.values(), self._clock)):
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

    def wait(self, seconds, topics=None):
        """Create the publishers of all topics known by now and give readers the time to find them."""
        for topic in {channel.topic for channel in self.bag.channels.values()}:
            if topics is None or topic in topics:
                self._make(topic, self.bag.type_of(topic))
        self._stop.wait(seconds)

    def publish(self, raw):
        """Publish one message; return whether its type is installed."""
        if raw.topic not in self._publishers:
            self._make(raw.topic, raw.type)
        publisher = self._publishers[raw.topic]
        if publisher:
            publisher.publish(raw.data)
        return publisher is not None

    def _make(self, topic, type_name):
        kind, why = installed(type_name, self.bag.hash_of(topic))
        if why:
            self.node.get_logger().warning(f'{topic}: left out: {why}')
        self._publishers[topic] = self.node.create_publisher(kind, topic, self._qos(topic)) if kind else None

    def _qos(self, topic):
        offered = (self.bag.qos_of(topic) or [{}])[0]
        latched = offered.get('durability') in ('transient_local', 1)       # words of Jazzy, numbers of before
        best_effort = offered.get('reliability') in ('best_effort', 2)
        return QoSProfile(
            depth=max(offered.get('depth', 1), 1 if latched else DEPTH),
            reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE)


def replay(path, topics=None, rate=1.0, start=0.0, loop=False, follow=False, clock_rate=None, delay=0.0, ros_args=()):
    """Publish a bag until its end or a signal; return how many messages; see bag.replay.play."""
    bag = Bag(path)
    next(bag.raw(), None)                                # so that its topics are known
    count = 0
    with Replayer(bag, clock_rate, rate, ros_args) as replayer:
        replayer.wait(delay, topics)
        for raw in play(bag, topics, rate, start, loop, follow, replayer.tick, replayer.period):
            count += replayer.publish(raw)
    if not count and topics:
        raise BagError(f'{path}: no message on {", ".join(topics)}')
    return count
