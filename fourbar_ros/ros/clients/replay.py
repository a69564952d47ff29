# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Publish a bag again: the recorded bytes, as they are."""
from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from pathlib import Path
import time
from typing import Any

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

# of volatile publishers: a late replay sends bursts that the original did not
DEPTH = 1000
PATIENCE = 10.0             # [s] for readers that the graph shows to be matched
# [s] without anything new in the graph: all that is near has been found
SETTLED = 1.0
ALONE = 5.0                 # [s] without any reader: discovery takes 4 s at its worst
POLL = 0.02                 # [s] between two looks at the graph
FAREWELL = 2.0              # [s] for reliable readers to get the last messages


def installed(type_name: str, recorded_hash: str) -> tuple[type[Any] | None, str]:
    """Return (class, '') of a message type, or (None, why it cannot be sent here)."""
    try:
        kind, here = resolve(type_name), type_hash(type_name)
    except (LookupError, ModuleNotFoundError, AttributeError, ValueError, OSError):
        return None, f'{type_name} is not installed'
    if recorded_hash and recorded_hash != here:
        return None, f'{type_name} was recorded by another definition than the one installed'
    return kind, ''


class Replayer:
    """
    A node that publishes what it is given.

    Each message on its topic with its recorded quality of service.

    Parameters
    ----------
    bag : Bag
    clock_rate : float, optional
        Publish /clock so often a second of wall time.
    pace : Pace, optional
        How fast the time of the bag passes.
    ros_args : list of str
        As ``['--ros-args', '-r', ...]``.

    """

    def __init__(self, bag: Bag, clock_rate: float | None = None, pace: Pace | None = None,
                 ros_args: Sequence[str] = ()) -> None:
        self._stop = Stop().catch()
        rclpy.init(args=list(ros_args), signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node('fourbar_replay')
        self.bag = bag
        self._publishers: dict[str, Publisher | None] = {}
        self._clock = self.node.create_publisher(Clock, '/clock', 10) if clock_rate else None
        self.period = 1.0 / clock_rate if clock_rate else TICK
        self._pace, self._ticked = pace or Pace(), 0

    def __enter__(self) -> Replayer:
        return self

    def __exit__(self, *_: object) -> None:
        for publisher in filter(None, (*self._publishers.values(), self._clock)):
            publisher.wait_for_all_acked(Duration(seconds=FAREWELL))
        self.node.destroy_node()
        rclpy.try_shutdown()
        self._stop.restore()

    def tick(self, now: int) -> bool:
        """Publish the time of the bag [ns]; returns False when it is time to stop."""
        if self._clock and not 0 <= now - self._ticked < self.period * self._pace.rate * 1e9:
            self._ticked = now
            self._clock.publish(Clock(clock=to_stamp(now)))
        return not self._stop.requested

    def wait(self, seconds: float, topics: Collection[str] | None = None, readers: int = 0) -> int:
        """
        Create the publishers of all topics known by now and wait until their readers are matched.

        These are the readers that the graph shows, once nothing new has come for a moment, at
        least ``seconds`` and at most PATIENCE after the beginning; ALONE if there are none; with
        ``seconds`` 0 nobody is waited for. With ``readers`` until there are so many, however long
        it takes.
        Returns how many are matched.
        """
        for topic in {channel.topic for channel in self.bag.channels.values()}:
            if (topics is None or topic in topics) and topic not in self._publishers:
                self._make(topic, self.bag.type_of(topic))
        begin = settled = time.monotonic()
        before = None
        while not self._stop.requested:
            now, state = time.monotonic(), self._graph()
            if state != before:
                before, settled = state, now
            matched, wanted = state[1], max(state[2], readers)
            is_quiet = not seconds or now - settled >= SETTLED and now - begin >= (
                seconds if matched else max(seconds, ALONE))
            if matched >= wanted and is_quiet:
                break
            if not readers and now - begin >= max(seconds, PATIENCE if seconds else 0.0):
                self.node.get_logger().warning(f'{wanted - matched} of {wanted} readers are not '
                                               f'matched after {now - begin:.1f} s: they may miss '
                                               'the first messages')
                break
            time.sleep(POLL)
        return self._graph()[1]

    def _graph(self) -> tuple[list[tuple[str, str]], int, int]:
        """Return (names of all nodes, readers that are matched, readers that could be)."""
        publishers = [publisher for publisher in self._publishers.values() if publisher]
        known = sum(self._fits(publisher, info) for publisher in publishers
                    for info in self.node.get_subscriptions_info_by_topic(publisher.topic_name))
        return (sorted(self.node.get_node_names_and_namespaces()),
                sum(publisher.get_subscription_count() for publisher in publishers), known)

    @staticmethod
    def _fits(publisher: Publisher, info: TopicEndpointInfo) -> bool:
        kind = publisher.msg_type
        package, _, name = info.topic_type.split('/')
        if (package, name) != (kind.__module__.split('.')[0], kind.__name__):
            return False
        found: bool = qos_check_compatible(publisher.qos_profile,
                                           info.qos_profile)[0] != QoSCompatibility.ERROR
        return found

    def publish(self, raw: Raw) -> bool:
        """Publish one message; return whether its type is installed."""
        if raw.topic not in self._publishers:
            self._make(raw.topic, raw.type)
        publisher = self._publishers[raw.topic]
        if publisher:
            publisher.publish(raw.data)
        return publisher is not None

    def _make(self, topic: str, type_name: str) -> None:
        kind, why = installed(type_name, self.bag.hash_of(topic))
        if why:
            self.node.get_logger().warning(f'{topic}: left out: {why}')
        self._publishers[topic] = (self.node.create_publisher(kind, topic, self._qos(topic))
                                   if kind else None)

    def _qos(self, topic: str) -> QoSProfile:
        offered = (self.bag.qos_of(topic) or [{}])[0]
        # words of Jazzy, numbers of before
        latched = offered.get('durability') in ('transient_local', 1)
        best_effort = offered.get('reliability') in ('best_effort', 2)
        return QoSProfile(
            depth=max(offered.get('depth', 1), 1 if latched else DEPTH),
            reliability=ReliabilityPolicy.BEST_EFFORT if best_effort
            else ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE)


def replay(path: str | Path, topics: Sequence[str] | None = None, rate: float = 1.0,
           start: float = 0.0, loop: bool = False, follow: bool = False,
           clock_rate: float | None = None, delay: float = 0.0, ros_args: Sequence[str] = (),
           pace: Pace | None = None, on_tick: Callable[[int], None] | None = None, readers: int = 0
           ) -> int:
    """
    Publish a bag until its end or a signal; return how many messages; see bag.replay.play.

    ``delay``, ``readers``: see :meth:`Replayer.wait`; ``pace``: a Pace to change meanwhile;
    ``on_tick`` is called with the time of the bag [ns] again and again.
    """
    bag = Bag(path)
    next(bag.raw(), None)                                # so that its topics are known
    count = 0
    pace = pace or Pace(rate)
    with Replayer(bag, clock_rate, pace, ros_args) as replayer:
        replayer.wait(delay, topics, readers)

        def tick(now: int) -> bool:
            if on_tick:
                on_tick(now)
            return replayer.tick(now)
        for raw in play(bag, topics, rate, start, loop, follow, tick, replayer.period, pace):
            count += replayer.publish(raw)
    if not count and topics:
        raise BagError(f'{path}: no message on {", ".join(topics)}')
    return count
