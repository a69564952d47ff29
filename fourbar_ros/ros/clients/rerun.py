# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Drive a live node with the recorded motion of the driven joint; compare its answers with the bag.

An answer of the live node and a recorded message belong together if they have the stamp of one
input.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
import json
from math import isfinite, isnan
from pathlib import Path
import struct
import time
from typing import NamedTuple

from fourbar_ros.bag.cdr import Decoder
from fourbar_ros.bag.comparison.difference import distance
from fourbar_ros.bag.read.origin import Origin, origin_of
from fourbar_ros.bag.read.playback import Pace, play
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Raw
from fourbar_ros.errors import BagError
from fourbar_ros.ros.clients.client import Client, name_on, NoAnswer
from fourbar_ros.ros.clients.replay import installed, Replayer
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene import parameters
from fourbar_ros.scene.message_fields import driven_of
from fourbar_ros.scene.parameters import ParameterValues
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.topics import INPUT_DEPTH, INPUTS
import numpy as np
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

QUIET = 2.0             # [s] without an answer after the last motion: no more will come
HELD_UP = 20.0          # [s] without an answer while motions are left: the node stands still
# [s] between copies of the first motion until it is answered, and after which no more are sent.
# All copies and AHEAD motions fit in the queue of a node that wakes up late.
AGAIN, INTRODUCTION = 0.1, 5.0
AHEAD = INPUT_DEPTH // 2        # motions without an answer: the queue of a busy node holds them
OURS = ('drive.', 'recording.')         # parameters that a live node has its own of


class LiveRun(NamedTuple):
    """The answers of a live node by topic; ``notes``: changes of the scene, motions left out."""

    answers: list[Answer]
    notes: list[str]


def drive_live(path: str | Path, node_name: str | None = None, rate: float = 1.0,
               start: float = 0.0, ros_args: Sequence[str] = ()) -> LiveRun:
    """
    Send the recorded motion of a bag to a live node; compare its outputs with the bag's.

    The motion goes to the ``~/input`` of the node, which must be driven by ``motion`` and have the
    scene of the bag (``fourbar bag scene`` writes it). Where the scene changes in the bag it is
    changed in the node. Memory does not grow with the bag.
    """
    bag = Bag(path)
    origin = origin_of(bag)
    next(bag.raw(), None)                                # so that its topics are known
    known = {channel.topic for channel in bag.channels.values()}
    outputs = {origin.topics[name]: topic.type for name, topic in origin.scene.topics.items()
               if origin.topics.get(name) in known}
    driven, scene_topic = origin.topics['driven'], origin.topics.get('scene')
    for topic in (driven, *outputs):
        _, why = installed(bag.type_of(topic), bag.hash_of(topic))
        if why:
            raise BagError(f'{path}: {topic}: {why}')
    pace = Pace(rate)
    with Replayer(bag, ros_args=ros_args) as replayer:
        live = _Live(replayer, outputs, origin, node_name or origin.node, pace)
        live.wait_until_found()
        changes = _Changes(live, bag, origin.scene, scene_topic, pace)
        changes.before(start)
        wanted = [topic for topic in (driven, scene_topic, *outputs) if topic]
        for raw in play(bag, wanted, rate, start, tick=live.tick, pace=pace):
            if raw.topic == driven:
                live.send(raw)
            elif raw.topic == scene_topic:
                changes.take(raw)
            else:
                live.expect(raw)
        live.wait_for_the_rest()
        live.close()
        if live.left_out:
            changes.notes.append(f'{live.left_out} motions left out: their rates were unknown')
        return LiveRun(live.compared(), changes.notes)


class _Changes:
    """Changes the parameters of a live node wherever the recorded scene changes."""

    def __init__(self, live: _Live, bag: Bag, scene: Scene, topic: str | None, pace: Pace) -> None:
        self._live, self._bag, self._topic, self._pace = live, bag, topic, pace
        self._values = scene.values          # parameters of the recorded scene in force
        self._origin = next(bag.raw()).time              # [ns] of the first message
        self.notes: list[str] = []

    def before(self, start: float) -> None:
        """Take over the changes of the first ``start`` seconds of the bag, which are skipped."""
        if start and self._topic:
            begin = self._origin + round(start * 1e9)
            for raw in self._bag.raw([self._topic]):
                if raw.time >= begin:
                    break
                self.take(raw)

    def take(self, raw: Raw) -> None:
        """Apply a recorded scene's changes, once the node has answered all motions before it."""
        values = from_values(json.loads(self._bag.decode(raw).data)).values
        changed = {name: value for name, value in values.items()
                   if not name.startswith(OURS) and not _is_same(value, self._values.get(name))}
        self._values = values
        if not changed:
            return
        self._pace.pause()
        self._live.wait_for_the_rest()
        at = (raw.time - self._origin) * 1e-9
        text = ', '.join(f'{name} {value}' for name, value in changed.items())
        self.notes.append(f'the scene of the bag changed after {at:.3f} s: {text}: '
                          f'{self._live.set(changed)}')
        self._pace.pause(False)


def _is_same(a: float | None, b: float | None) -> bool:
    """Return whether two values of a parameter are equal; NaN stands for one not given."""
    return bool(a == b or (a != a and b != b))


class _Live(Client):
    """The live node: sends it recorded motions and collects its answers."""

    def __init__(self, replayer: Replayer, outputs: Mapping[str, str], origin: Origin,
                 node_name: str, pace: Pace) -> None:
        super().__init__(replayer.node)
        self._replayer, self._pace = replayer, pace
        self._in_order = origin.in_order     # whether each output stands behind its motion
        self._topics = {topic: Meeting(replayer.bag.decoder(topic)) for topic in outputs}
        self._first, self._last = b'', b''          # stamps of motions; empty before the first
        self._unanswered = b''      # the first motion, until it is answered
        self._last_arrival = time.monotonic()
        self.left_out = 0           # motions that were not sent: their rates were unknown
        self._unsent: set[bytes] = set()            # stamps of those
        self._given_up = 0          # motions whose answers are not waited for any more
        self._silent = False        # whether the last wait for answers failed
        self._input_name = name_on(node_name, INPUTS['motion'])
        self._input = self.publisher('motion', node_name)
        self._subscriptions = [self._listen(topic, type_name, origin.node, node_name)
                               for topic, type_name in outputs.items()]
        self._parameters = AsyncParameterClient(self.node, node_name)

    def _listen(self, topic: str, type_name: str, recorded_node: str, node_name: str
                ) -> Subscription:
        """Subscribe to the live topic of a recorded one; below the node, its name may differ."""
        live_topic = (topic.replace(recorded_node, node_name, 1)
                      if topic.startswith(recorded_node + '/') else topic)
        answers = self._topics[topic]

        def take(data: bytes) -> None:
            self._last_arrival, self._silent = time.monotonic(), False
            answers.answer(stamp_of(data), data)
        return self.node.create_subscription(resolve(type_name), live_topic, take,
                                             QoSProfile(depth=1000), raw=True)

    def wait_until_found(self) -> None:
        """Wait until the node's input and all its outputs are discovered; raise NoAnswer."""
        what = (f'{self._input_name}: no node with drive.source: motion and the outputs of the '
                'bag; "fourbar bag scene BAG > FILE" writes the parameters of one')

        def is_found() -> bool:
            if not self.tick(0):
                raise NoAnswer(f'{what} (interrupted)')
            return (self._input.get_subscription_count()
                    and all(subscription.get_publisher_count()
                            for subscription in self._subscriptions))
        self.until(is_found, what)
        self.wait_for_the_rest(0.3)

    def tick(self, _: int) -> bool:
        """Handle the messages that have come; return False once a signal has come."""
        for _ in range(1000):
            before = self._last_arrival
            self.executor.spin_once(timeout_sec=0.0 if self._last else 0.02)
            if self._last_arrival == before:
                break
        return self._replayer.tick(0)

    def set(self, changed: ParameterValues) -> str:
        """Change parameters of the node; return the outcome in words."""
        fixed = [name for name in changed if not parameters.of_name(name).live]
        if fixed:
            return f'not applied: {fixed[0]} cannot be changed while the node runs'
        future = self._parameters.set_parameters_atomically(
            [Parameter(name, value=list(value) if isinstance(value, tuple) else value)
             for name, value in changed.items()])
        try:
            result = self.result_of(future, 'the parameters of the node').result
        except NoAnswer as error:
            return f'not applied: {error}'
        return 'applied' if result.successful else f'not applied: {result.reason}'

    def send(self, raw: Raw) -> None:
        """
        Send one recorded motion; first wait if AHEAD motions have not been answered.

        More would overflow the queue of a busy node, and the lost ones look like its fault.
        A motion whose rates were unknown is left out: the node would estimate them.
        """
        position, *rates = driven_of(self._replayer.bag.decode(raw))
        if isfinite(position) and any(map(isnan, rates)):
            self.left_out += 1
            if not self._in_order:       # its outputs may stand before or behind it
                self._unsent.add(stamp_of(raw.data))
                for topic in self._topics.values():
                    topic.forget(stamp_of(raw.data))
            return
        self._introduce()
        waiting = self._waiting()
        # For a node that stands still we wait once only. Later answers do not count as missing.
        self._given_up = waiting if self._silent else min(self._given_up, waiting)
        if waiting >= self._given_up + AHEAD:
            self.wait_for_the_rest(HELD_UP, self._given_up + AHEAD - 1)
            self._silent = self._waiting() >= self._given_up + AHEAD
        self._last = stamp_of(raw.data)
        self._input.publish(raw.data)
        if not self._first:
            self._first, self._unanswered = self._last, raw.data

    def _introduce(self) -> None:
        """
        Send the first motion again and again until all its answers have come.

        Motions or answers are lost until the node has matched our publisher and we have matched
        its publishers. Neither side can see whether the other has.
        """
        motion, self._unanswered = self._unanswered, b''
        if not motion:
            return
        was_paused = self._pace.is_paused
        self._pace.pause()
        end = time.monotonic() + INTRODUCTION
        while self._is_first_missing() and time.monotonic() < end and self._replayer.tick(0):
            again = time.monotonic() + AGAIN
            while self._is_first_missing() and time.monotonic() < again:
                self.executor.spin_once(timeout_sec=AGAIN / 10.0)
            if self._is_first_missing():
                self._input.publish(motion)
        self._pace.pause(was_paused)

    def _is_first_missing(self) -> bool:
        return any(topic.is_waiting_for(self._first) for topic in self._topics.values())

    def expect(self, raw: Raw) -> None:
        """
        Keep a recorded output for comparison if its motion was sent.

        Our bags hold it right after its motion; bags of rosbag2 hold it in the order of arrival.
        """
        stamp = stamp_of(raw.data)
        if stamp in self._unsent:
            return
        if (stamp == self._last or not self._in_order and self._last
                and moment_of(stamp) >= moment_of(self._first)):
            self._topics[raw.topic].expect(stamp, raw.data)

    def _waiting(self) -> int:
        """Return how many motions have not all their answers."""
        return max([topic.waiting for topic in self._topics.values()], default=0)

    def wait_for_the_rest(self, quiet: float = QUIET, rest: int = 0) -> None:
        """Wait until no answer has come for ``quiet`` [s], or at most ``rest`` are missing."""
        self._introduce()
        self._last_arrival = time.monotonic()
        while time.monotonic() - self._last_arrival < quiet and (
                not self._last or self._waiting() > rest) and self._replayer.tick(0):
            self.executor.spin_once(timeout_sec=0.02)

    def compared(self) -> list[Answer]:
        """Return an Answer for each topic, once all motions were sent."""
        if not self._last:
            raise BagError('the bag has no motion of the driven joint with known rates')
        return [topic.finished(name) for name, topic in self._topics.items()]


def moment_of(stamp: bytes) -> tuple[int, int]:
    """Return the bytes of a stamp as (seconds, nanoseconds), which sort by time."""
    return struct.unpack('<iI', stamp)


BLOCK = 2000            # pairs of messages that are compared at once
LATE = 10_000           # messages of a topic that wait for their partner; older ones have none


class Answer(NamedTuple):
    """
    The answers of a live node on one topic beside the recorded messages.

    ``messages`` were compared, ``missing`` were not answered; ``largest`` is the largest
    difference, in ``field``.
    """

    topic: str
    messages: int
    missing: int
    largest: float
    field: str


class Meeting:
    """Recorded messages and live answers of one topic, which wait here for their partner."""

    def __init__(self, decoder: Decoder) -> None:
        self._decoder = decoder
        # messages without their partner yet, {stamp: message}, oldest first
        self._expected: dict[bytes, bytes] = {}          # recorded
        self._answers: dict[bytes, bytes] = {}
        self._pairs: list[tuple[bytes, bytes]] = []      # (recorded, answer), not yet compared
        self.messages = self.missing = 0                 # see Answer
        self.largest, self.field = 0.0, ''

    def expect(self, stamp: bytes, data: bytes) -> None:
        """Take a recorded message."""
        self._meet(stamp, data, self._expected, self._answers, False)

    def answer(self, stamp: bytes, data: bytes) -> None:
        """Take an answer of the live node."""
        self._meet(stamp, data, self._answers, self._expected, True)

    @property
    def waiting(self) -> int:
        """Return how many answers are still to come."""
        return len(self._expected)

    def is_waiting_for(self, stamp: bytes) -> bool:
        """Return whether the answer of this stamp is still to come."""
        return stamp in self._expected

    def forget(self, stamp: bytes) -> None:
        """Expect no answer of this stamp."""
        self._expected.pop(stamp, None)

    def _meet(self, stamp: bytes, data: bytes, own: dict[bytes, bytes], others: dict[bytes, bytes],
              is_answer: bool) -> None:
        """
        Pair a message with the one of its stamp among ``others``, or let it wait among ``own``.

        ``own``: messages of its side, recorded or live, without a partner yet; ``others``: waiting
        messages of the other side.
        """
        other = others.pop(stamp, None)
        if other is None:
            own[stamp] = data
            if len(own) > LATE:
                del own[next(iter(own))]
                self.missing += not is_answer
            return
        self._pairs.append((other, data) if is_answer else (data, other))
        if len(self._pairs) >= BLOCK:
            self.compare()

    def compare(self) -> None:
        """Compare the pairs so far field by field, note the largest difference, drop them."""
        recorded, answers = [pair[0] for pair in self._pairs], [pair[1] for pair in self._pairs]
        self.messages += len(self._pairs)
        self._pairs = []
        for layout, rows, records in self._decoder.arrays(recorded):
            its_answers = [answers[row] for row in rows]
            if not all(map(layout.matches, its_answers)):
                self.largest, self.field = np.inf, '(lengths)'
                continue
            live_records = np.frombuffer(b''.join(its_answers), layout.dtype)
            for leaf in layout.leaves:
                if leaf.format[0] != 'S':                # numbers; texts have no distance
                    difference = distance(records[leaf.name].astype(float),
                                          live_records[leaf.name].astype(float))
                    if difference > self.largest:
                        self.largest, self.field = difference, leaf.name

    def finished(self, topic: str) -> Answer:
        """Compare the last pairs; recorded messages without an answer are missing."""
        if self._pairs:
            self.compare()
        return Answer(topic, self.messages, self.missing + len(self._expected), self.largest,
                      self.field)


def stamp_of(data: bytes) -> bytes:
    """Return the stamp of a message that begins with a header, as the bytes it has on the wire."""
    return bytes(data[4:12])
