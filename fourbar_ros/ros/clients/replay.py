# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Publish a bag again: the recorded bytes, as they are."""
from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from itertools import islice
from pathlib import Path
import signal
from struct import unpack_from
import time
from typing import Any, NamedTuple

from fourbar_ros.bag.read.playback import Pace, play, TICK
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Raw
from fourbar_ros.errors import BagError
from fourbar_ros.ros.messages import resolve, to_stamp
from fourbar_ros.ros.schemas import type_hash
from fourbar_ros.ros.stop import Stop
import rclpy
from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rclpy.qos import (
    DurabilityPolicy,
    qos_check_compatible,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.signals import SignalHandlerOptions
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosgraph_msgs.msg import Clock

DEPTH = 1000                # queue of a publisher: a late replay sends bursts, unlike the original
PATIENCE = 10.0             # [s] for readers that the graph shows to be matched
SETTLED = 1.0               # [s] without anything new in the graph: discovery is done
ALONE = 5.0                 # [s] without any reader: discovery takes 4 s at its worst
POLL = 0.02                 # [s] between two looks at the graph
FAR = 3600 * 10**9          # [ns] a stamp so long before its log time is of simulated time
FEW = 1000                  # messages to look for such a stamp in
FAREWELL = 2.0              # [s] for reliable readers to get the last messages


def installed(type_name: str, recorded_hash: str) -> tuple[type[Any] | None, str]:
    """
    Return (class, '') of a recorded message type, or (None, why it cannot be sent here).

    A type installed with another definition would read recorded bytes as other numbers.
    """
    try:
        message_class, installed_hash = resolve(type_name), type_hash(type_name)
    except (LookupError, ModuleNotFoundError, AttributeError, ValueError, OSError):
        return None, f'{type_name} is not installed'
    if recorded_hash and recorded_hash != installed_hash:
        return None, f'{type_name} was recorded by another definition than the one installed'
    return message_class, ''


class Replayer:
    """
    A node, in a ``with`` block, that publishes messages of a bag with their recorded QoS.

    ``clock_rate``: how often to publish /clock, per second of wall time; ``pace``: how fast the
    time of the bag passes; ``ros_args``: as ``['--ros-args', '-r', ...]``.
    """

    def __init__(self, bag: Bag, clock_rate: float | None = None, pace: Pace | None = None,
                 ros_args: Sequence[str] = ()) -> None:
        self._stop = Stop().catch()
        rclpy.init(args=list(ros_args), signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node('fourbar_replay')
        self.bag = bag
        self._publishers: dict[str, Publisher | None] = {}   # by topic; None: type not installed
        self._clock = self.node.create_publisher(Clock, '/clock', 10) if clock_rate else None
        self.period = 1.0 / clock_rate if clock_rate else TICK       # [s] of wall time
        self._pace = pace or Pace()
        self._ticked = 0                                 # [ns] time of the bag last on /clock
        self._simulated: int | None = None    # [ns] the newest stamp, in a bag of simulated time

    def __enter__(self) -> Replayer:
        return self

    def __exit__(self, *_: object) -> None:
        """
        Wait up to FAREWELL until all messages were received; then end the node and ROS.

        A signal ends the process as if it had come only now.
        """
        for publisher in filter(None, (*self._publishers.values(), self._clock)):
            publisher.wait_for_all_acked(Duration(seconds=FAREWELL))
        self.node.destroy_node()
        rclpy.try_shutdown()
        self._stop.restore()
        if self._stop.requested:
            signal.raise_signal(signal.Signals[self._stop.name])

    def tick(self, now: int) -> bool:
        """Publish the time of the bag [ns] on /clock if due; return False once a signal came."""
        now = now if self._simulated is None else self._simulated
        if self._clock and not 0 <= now - self._ticked < self.period * self._pace.rate * 1e9:
            self._ticked = now
            self._clock.publish(Clock(clock=to_stamp(now)))
        return not self._stop.requested

    def wait(self, seconds: float, topics: Collection[str] | None = None, readers: int = 0) -> int:
        """
        Create the publishers of the bag's topics; wait for their readers; return how many came.

        Messages sent before a reader is matched are lost to it. So this waits until all readers
        that the ROS graph shows are matched and it has not changed for SETTLED: at least
        ``seconds``, ALONE while nobody reads, at most PATIENCE. ``seconds`` 0: do not wait.
        ``readers``: wait for so many, however long it takes.
        """
        for topic in {channel.topic for channel in self.bag.channels.values()}:
            if (topics is None or topic in topics) and topic not in self._publishers:
                self._make(topic, self.bag.type_of(topic))
        begin = changed = time.monotonic()
        graph = None
        while not self._stop.requested:
            now, before, graph = time.monotonic(), graph, self._graph()
            if graph != before:
                changed = now
            wanted = max(graph.known, readers)
            is_settled = not seconds or now - changed >= SETTLED and now - begin >= (
                seconds if graph.matched else max(seconds, ALONE))
            if graph.matched >= wanted and is_settled:
                break
            if not readers and now - begin >= max(seconds, PATIENCE if seconds else 0.0):
                self.node.get_logger().warning(f'{wanted - graph.matched} of {wanted} readers are '
                                               f'not matched after {now - begin:.1f} s: they may '
                                               'miss the first messages')
                break
            time.sleep(POLL)
        return self._graph().matched

    def _graph(self) -> _Graph:
        """Return the nodes and readers that can be seen now."""
        publishers = [publisher for publisher in self._publishers.values() if publisher]
        known = sum(_can_read(info, publisher) for publisher in publishers
                    for info in self.node.get_subscriptions_info_by_topic(publisher.topic_name))
        return _Graph(sorted(self.node.get_node_names_and_namespaces()),
                      sum(publisher.get_subscription_count() for publisher in publishers), known)

    def publish(self, raw: Raw) -> bool:
        """Publish one message; return whether its type is installed."""
        if raw.topic not in self._publishers:
            self._make(raw.topic, raw.type)
        publisher = self._publishers[raw.topic]
        if publisher:
            self.note_time(raw)
            publisher.publish(raw.data)
        return publisher is not None

    def note_time(self, raw: Raw) -> bool:
        """Note the stamp of a message if it is of simulated time; return whether it is."""
        publisher = self._publishers.get(raw.topic)
        if not self._clock or len(raw.data) < 12 or not hasattr(
                publisher and publisher.msg_type, 'header'):
            return False
        sec, nanosec = unpack_from('<iI' if raw.data[1] & 1 else '>iI', raw.data, 4)
        stamp = sec * 10**9 + nanosec
        if 0 < stamp < raw.time - FAR:
            self._simulated = stamp
        return self._simulated is not None

    def _make(self, topic: str, type_name: str) -> None:
        """Create the publisher of a topic; warn and note None if its type is not installed."""
        message_class, why = installed(type_name, self.bag.hash_of(topic))
        if why:
            self.node.get_logger().warning(f'{topic}: left out: {why}')
        self._publishers[topic] = (
            self.node.create_publisher(message_class, topic, self._qos(topic))
            if message_class else None)

    def _qos(self, topic: str) -> QoSProfile:
        """Return the QoS that the first recorded publisher of a topic offered."""
        offered = (self.bag.qos_of(topic) or [{}])[0]
        # bags of Jazzy have words, older ones rmw's numbers
        is_latched = offered.get('durability') in ('transient_local', 1)
        is_best_effort = offered.get('reliability') in ('best_effort', 2)
        return QoSProfile(
            depth=max(offered.get('depth', 1), 1 if is_latched else DEPTH),
            reliability=(ReliabilityPolicy.BEST_EFFORT if is_best_effort
                         else ReliabilityPolicy.RELIABLE),
            durability=(DurabilityPolicy.TRANSIENT_LOCAL if is_latched
                        else DurabilityPolicy.VOLATILE))


class _Graph(NamedTuple):
    """The nodes of the ROS graph, how many readers are matched, how many are known to fit."""

    nodes: list[tuple[str, str]]
    matched: int
    known: int


def _can_read(info: TopicEndpointInfo, publisher: Publisher) -> bool:
    """Return whether a subscription has the type of a publisher and a QoS that fits."""
    message_class = publisher.msg_type
    package, _, name = info.topic_type.split('/')
    if (package, name) != (message_class.__module__.split('.')[0], message_class.__name__):
        return False
    compatibility, _ = qos_check_compatible(publisher.qos_profile, info.qos_profile)
    return bool(compatibility != QoSCompatibility.ERROR)


def replay(path: str | Path, topics: Sequence[str] | None = None, rate: float = 1.0,
           start: float = 0.0, loop: bool = False, follow: bool = False,
           clock_rate: float | None = None, delay: float = 0.0, ros_args: Sequence[str] = (),
           pace: Pace | None = None, on_tick: Callable[[int], None] | None = None, readers: int = 0
           ) -> int:
    """
    Publish a bag until its end or a signal; print and return how many messages.

    ``rate``, ``start``, ``loop``, ``follow``: see :func:`fourbar_ros.bag.read.playback.play`;
    ``delay``, ``readers``: ``seconds`` and ``readers`` of :meth:`Replayer.wait`; ``pace``: a Pace
    to pause or change the rate meanwhile; ``on_tick`` is called with the time of the bag [ns] at
    every tick.

    Raises
    ------
    BagError
        The bag cannot be read, or has no message on the ``topics`` asked for.

    """
    bag, count, pace = Bag(path), 0, pace or Pace(rate)
    first = next(bag.raw(), None)                        # now its topics are known
    with Replayer(bag, clock_rate, pace, ros_args) as replayer:
        replayer.wait(delay, topics, readers)
        if first:
            begin = first.time + round(start * 1e9)
            any(map(replayer.note_time, islice(bag.raw(topics, begin), FEW)))

        def tick(now: int) -> bool:
            if on_tick:
                on_tick(now)
            return replayer.tick(now)
        for raw in play(bag, topics, rate, start, loop, follow, tick, replayer.period, pace):
            count += replayer.publish(raw)
        print(f'{count} messages published')
    if not count and topics:
        raise BagError(f'{path}: no message on {", ".join(topics)}')
    return count
