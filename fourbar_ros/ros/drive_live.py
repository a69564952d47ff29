"""Drive a live node with the recorded motion of the driven joint; compare its answers with the recorded ones."""
from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
from rclpy.experimental import EventsExecutor
from rclpy.qos import QoSProfile

from .. import interfaces
from ..bag import BagError
from ..bag.reader import Bag
from ..bag.recompute import distance, scene_of
from ..bag.replay import play
from .messages import resolve
from .remote import NoAnswer
from .replay import Replayer, installed

PATIENCE = 5.0          # [s] for the node to be found
QUIET = 1.0             # [s] without an answer: no more will come


class Answer(NamedTuple):
    """What a live node said on one topic, beside what was recorded; ``field`` differs most."""

    topic: str
    messages: int
    missing: int
    largest: float
    field: str


def drive_live(path, node_name=None, rate=1.0, start=0.0, ros_args=()):
    """
    Return a list of :class:`Answer`, one for every output in the bag.

    The recorded motion of the driven joint goes to the ``~/input`` of the node, which must be driven by
    ``motion`` and have the scene of the bag (``fourbar bag scene`` writes it). Answers are matched by
    their stamp, that of their input.
    """
    bag = Bag(path)
    _, topics = scene_of(path)
    recorded_node = (bag.metadata()['custom_data'] or {}).get('node', '/fourbar')
    outputs = {topic: name for name, topic in topics.items() if name in interfaces.OUTPUTS}
    next(bag.raw(), None)                                # so that its topics are known
    for topic in (topics['driven'], *outputs):
        _, why = installed(bag.type_of(topic), bag.hash_of(topic))
        if why:
            raise BagError(f'{path}: {topic}: {why}')
    with Replayer(bag, ros_args=ros_args) as replayer:
        live = _Live(replayer, outputs, recorded_node, node_name or recorded_node)
        live.wait_until_found()
        played = play(bag, [topics['driven'], *outputs], rate, start, tick=live.tick)
        for raw in played:
            if raw.topic == topics['driven']:
                live.send(raw)
            else:
                live.expect(raw)
        live.wait_for_the_rest()
        return live.compared()


class _Live:
    """The node on the other side."""

    def __init__(self, replayer, outputs, recorded_node, node_name):
        self._replayer, self._node = replayer, replayer.node
        self._executor = EventsExecutor()
        self._executor.add_node(self._node)
        self._expected = {topic: {} for topic in outputs}        # {stamp: bytes}
        self._answers = {topic: {} for topic in outputs}
        self._sent, self._heard = set(), time.monotonic()
        topic = interfaces.INPUTS['motion']
        self._name = topic.topic.replace('~', node_name)
        self._input = self._node.create_publisher(resolve(topic.type), self._name, interfaces.INPUT_DEPTH)
        self._subscriptions = [self._listen(topic, interfaces.OUTPUTS[name], recorded_node, node_name)
                               for topic, name in outputs.items()]

    def _listen(self, topic, output, recorded_node, node_name):
        there = topic.replace(recorded_node, node_name, 1) if topic.startswith(recorded_node + '/') else topic
        answers = self._answers[topic]

        def take(data):
            self._heard = time.monotonic()
            answers[stamp_of(data)] = data
        return self._node.create_subscription(resolve(output.type), there, take, QoSProfile(depth=1000), raw=True)

    def wait_until_found(self):
        """Wait for the node's input and outputs."""
        end = time.monotonic() + PATIENCE
        while not (self._input.get_subscription_count()
                   and all(s.get_publisher_count() for s in self._subscriptions)):
            if time.monotonic() > end or not self.tick(0):
                raise NoAnswer(f'{self._name}: no node with drive.source: motion and the outputs of the bag '
                               f'(waited {PATIENCE:g} s)')
        self.wait_for_the_rest(0.3)

    def tick(self, _):
        """Handle what came in."""
        for _ in range(1000):
            before = self._heard
            self._executor.spin_once(timeout_sec=0.0 if self._sent else 0.02)
            if self._heard == before:
                break
        return self._replayer.tick(0)

    def send(self, raw):
        """Send one motion of the driven joint."""
        self._sent.add(stamp_of(raw.data))
        self._input.publish(raw.data)

    def expect(self, raw):
        """Keep what was recorded, if its motion was sent."""
        stamp = stamp_of(raw.data)
        if stamp in self._sent:
            self._expected[raw.topic][stamp] = raw.data

    def wait_for_the_rest(self, quiet=QUIET):
        """Wait until nothing has come for some time, or all has."""
        self._heard = time.monotonic()
        while time.monotonic() - self._heard < quiet and (
                not self._sent or any(e.keys() - a.keys() for e, a in self._pairs())):
            self._executor.spin_once(timeout_sec=0.02)

    def _pairs(self):
        return [(self._expected[topic], self._answers[topic]) for topic in self._expected]

    def compared(self):
        """Return the answers beside what was recorded."""
        found = []
        for topic, expected in self._expected.items():
            both = sorted(expected.keys() & self._answers[topic].keys())
            worst, where = 0.0, ''
            for field, value in self._differences(topic, both).items():
                if value > worst:
                    worst, where = value, field
            found.append(Answer(topic, len(both), len(expected) - len(both), worst, where))
        if not self._sent:
            raise BagError('the bag has no motion of the driven joint')
        self._executor.shutdown()
        return found

    def _differences(self, topic, stamps):
        largest = {}
        if not stamps:
            return largest
        decoder = self._replayer.bag.decoder(topic)
        here, there = self._expected[topic], self._answers[topic]
        for layout, rows, records in decoder.arrays([here[stamp] for stamp in stamps]):
            answers = [there[stamps[row]] for row in rows]
            if not all(map(layout.matches, answers)):
                return {'(lengths)': np.inf}
            others = np.frombuffer(b''.join(answers), layout.dtype)
            for leaf in layout.leaves:
                if leaf.format[0] != 'S':
                    value = distance(records[leaf.name].astype(float), others[leaf.name].astype(float))
                    largest[leaf.name] = max(largest.get(leaf.name, 0.0), value)
        return largest


def stamp_of(data):
    """Return the stamp of a message that begins with a header, as the bytes it has on the wire."""
    return bytes(data[4:12])
