# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Publish a bag again: the recorded bytes, as they are, by the times of their recording."""
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite, isnan
from pathlib import Path
from struct import unpack_from
import time
from typing import Any

from fourbar_ros.bag import metadata, reader
from fourbar_ros.errors import BagError
from fourbar_ros.ros import messages, schemas
from fourbar_ros.ros.node.start import caught_signals, Signals
from fourbar_ros.ros.refusals import init
import rclpy
from rclpy.duration import Duration
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

CLOCK = '/clock'
FAR = 3600 * 10**9  # [ns] a stamp so long before its log time is of simulated time
LATE = 10**9        # [ns] a stamp may be so much behind others; more: the simulation began again
MOST_WAITING = 10_000       # messages: a bag may have no stamps and be larger than the memory
DEPTH = 1000        # queue of a publisher: a late replay sends bursts, unlike the original
TICK = 0.002        # [s] longest sleep
PATIENCE = 10.0     # [s] for a node to be found
FAREWELL = 2.0      # [s] for reliable readers to get the last messages


def replay(path: str | Path, topics: Mapping[str, str] | None = None, rate: float = 1.0,
           start: float = 0.0, loop: bool = False, clock_rate: float = 0.0, delay: float = 1.0,
           ros_args: Sequence[str] = (), waits_for_node: bool = False) -> tuple[int, int]:
    """
    Publish a bag until its end or a signal; return how many messages, and the signal or 0.

    ``topics``: {topic in the bag: topic to publish on}, default all; ``rate``: so many times as
    fast; ``start``: skip so many seconds, of all but latched topics; ``clock_rate``: how often a
    second to publish the bag's time on /clock, 0: never; ``delay``: time for readers to find the
    topics [s]; ``waits_for_node``: begin when all topics have a reader. Raises BagError.
    """
    bag, count = reader.Bag(path), 0
    if missing := set(topics or ()) - bag.types.keys():
        raise BagError(f'{path}: no message on {", ".join(sorted(missing))}')
    init(ros_args, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('fourbar_replay')
    names = topics or {topic: topic for topic in bag.types}
    publishers = {topic: made for topic, name in names.items()
                  if not (clock_rate and name == CLOCK)       # there are no two clocks
                  and (made := _publisher(node, bag, topic, name))}
    clock = node.create_publisher(Clock, CLOCK, 10) if clock_rate != 0.0 else None
    first, ticked = 0, -1

    def tick() -> None:
        """Publish the time of the bag, ``clock_rate`` times a second, up to the next message."""
        nonlocal ticked
        passed = time.monotonic() - begun
        if clock and (tick_count := int(passed * clock_rate)) != ticked:
            ticked = tick_count
            now = min(first + round((start + passed * rate) * 1e9), raw.time) - ahead
            clock.publish(Clock(clock=messages.to_stamp(max(now, reached))))

    try:
        with caught_signals() as signals:
            end = time.monotonic() + PATIENCE
            for publisher in publishers.values() if waits_for_node else ():
                while not signals and not publisher.get_subscription_count():
                    if time.monotonic() > end:
                        raise BagError(f'no node listens on {publisher.topic_name}')
                    time.sleep(TICK)
            _sleep_until(time.monotonic() + delay, signals)
            while not signals:
                first, begun, skipped = 0, time.monotonic(), list[reader.Raw]()
                for raw, ahead, reached in _messages(                # noqa: B007 (tick)
                        bag, publishers, waits_for_node):
                    first = first or raw.time
                    # messages of several topics need not be written in the order of their times
                    passed = max(raw.time - first, 0) * 1e-9 - start
                    if passed < 0.0:
                        skipped += [raw] if _is_latched(bag, raw.topic) else []
                        continue
                    _sleep_until(begun + passed / rate, signals, tick)
                    if signals:
                        break
                    tick()                  # a late replay waits for no message
                    for each in (*skipped, raw):
                        publishers[each.topic].publish(each.data)
                    count, skipped = count + len(skipped) + 1, []
                if not loop or not count:           # nor does the next round have any
                    break
            for publisher in (*publishers.values(), *([clock] if clock else [])):
                publisher.wait_for_all_acked(Duration(seconds=FAREWELL))
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    bag.refuse_damage()
    return count, signals[0] if signals else 0


def _messages(bag: reader.Bag, publishers: Mapping[str, Publisher], for_a_node: bool
              ) -> Iterator[tuple[reader.Raw, int, int]]:
    """
    Yield each message, how far its log time is ahead of simulated time, and that so far [ns].

    ``for_a_node``: motions whose rates a node would have to estimate are left out. Stamps tell
    simulated time, which may stand or run at any speed; messages without one wait for the next, if
    that is among the next MOST_WAITING.
    """
    ahead = reached = unknown = 0
    waiting: list[reader.Raw] = []
    stamped = {topic for topic, publisher in publishers.items()
               if [*publisher.msg_type.get_fields_and_field_types()][:1] == ['header']}
    for raw in bag.raw(set(publishers)):
        motion = bag.decode(raw) if for_a_node else None
        if motion and isfinite(motion.position) and isnan(motion.velocity + motion.acceleration):
            unknown += 1
            continue
        waiting.append(raw)
        stamp = 0
        if raw.topic in stamped and len(raw.data) >= 12:
            sec, nanosec = unpack_from('<iI' if raw.data[1] & 1 else '>iI', raw.data, 4)
            stamp = sec * 10**9 + nanosec
        if stamp > 0:
            ahead = raw.time - stamp if stamp < raw.time - FAR else ahead
        elif stamped and len(waiting) < MOST_WAITING:
            continue
        for each in waiting:
            yield each, ahead, reached
        waiting, now = [], raw.time - ahead
        reached = reached if 0 <= reached - now < LATE else now
    for each in waiting:
        yield each, ahead, reached
    if unknown:
        print(f'{unknown} motions left out: their rates were unknown')


def _sleep_until(moment: float, signals: Signals,
                 tick: Callable[[], object] = lambda: None) -> None:
    """Wait for a moment of the monotonic clock [s], or for a signal; call ``tick`` meanwhile."""
    while not signals and (left := moment - time.monotonic()) > 0.0:
        tick()
        time.sleep(min(left, TICK))


def _publisher(node: Node, bag: reader.Bag, topic: str, name: str) -> Publisher | None:
    """Return a publisher; None if its type differs here: it would read other numbers."""
    type_name, recorded = bag.types[topic], bag.channel_of(topic)
    try:
        message_class, installed_hash = messages.resolve(type_name), schemas.type_hash(type_name)
    except (LookupError, ModuleNotFoundError, AttributeError, ValueError, OSError):
        node.get_logger().warning(f'{topic}: left out: {type_name} is not installed')
        return None
    if recorded.get(metadata.HASH, installed_hash) not in ('', installed_hash):
        node.get_logger().warning(f'{topic}: left out: {type_name} was recorded by another '
                                  'definition than the one installed')
        return None
    offered, is_latched = _offered(bag, topic), _is_latched(bag, topic)
    is_best_effort, depth = offered.get('reliability') in ('best_effort', 2), offered.get('depth')
    if not isinstance(depth, int) or not 0 < depth < 2**31:
        depth = 1
    try:
        return node.create_publisher(message_class, name, QoSProfile(
            depth=max(depth, 1 if is_latched else DEPTH),
            reliability=(ReliabilityPolicy.BEST_EFFORT if is_best_effort
                         else ReliabilityPolicy.RELIABLE),
            durability=(DurabilityPolicy.TRANSIENT_LOCAL if is_latched
                        else DurabilityPolicy.VOLATILE)))
    except InvalidTopicNameException:
        node.get_logger().warning(f'{topic!r}: left out: ROS 2 has no such names of topics')
        return None


def _offered(bag: reader.Bag, topic: str) -> dict[str, Any]:
    """Return the quality of service of a topic; of Jazzy in words, of older bags rmw's numbers."""
    return (metadata.profiles(bag.channel_of(topic)) or [{}])[0]


def _is_latched(bag: reader.Bag, topic: str) -> bool:
    return _offered(bag, topic).get('durability') in ('transient_local', 1)
