# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Feedback: messages of the node that come back to its input, directly or through other nodes.

rclpy does not say who sent a message. So the node keeps the newest messages that it has sent on a
topic to which it also listens; one that comes with the same bytes is its own.
"""
from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import suppress
import threading
import time
from typing import Any

from fourbar_ros.ros.node.quiet_log import Logger
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import Topic
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.publisher import Publisher

KEPT = 1000                    # messages of a topic: more than any queue holds
HEADER = 4                     # first bytes, of the encoding, which a middleware may rewrite
OF_ALL = ('/rosout', '/parameter_events')      # topics that every node publishes


class Circles:
    """
    Tells the node's own messages from other nodes' messages, on topics to which it also listens.

    A circle is such a topic: the node must not take its outputs for inputs. ``own_count`` is the
    number of its own messages that have come back.
    """

    def __init__(self, node: Node, scene: Scene) -> None:
        self._log: Logger = node.get_logger()
        # whether joint_states leaves out the driven joint, so that sharing its topic is no mistake
        self._is_relay = scene.joint_states.only_passive
        # inputs by full topic names, as '/fourbar/input'
        self._inputs = {node.resolve_topic_name(topic.topic): topic for topic in scene.received}
        # {full topic name: its newest KEPT messages, oldest first, without the HEADER}; the inner
        # dict is a set that keeps the order
        self._sent: dict[str, dict[bytes, None]] = {}
        self._lock = threading.Lock()        # while a message is added: worker threads send too
        self.own_count = 0

    def sender(self, publisher: Publisher, topic: Topic) -> Callable[[bytes], None]:
        """Return the function that publishes bytes, and keeps them if the node listens there."""
        # This takes half the time of Publisher.publish, which also guards against its destruction
        # meanwhile; ours are destroyed between two steps only.
        publish: Callable[[bytes], None] = publisher.handle.publish_raw
        name = publisher.topic_name
        its_input = self._inputs.get(name)
        if its_input is None or its_input.type != topic.type:
            return publish
        if name not in self._sent:
            self._log_shared_topic(its_input, topic, name)
        sent = self._sent.setdefault(name, {})

        def keep_and_publish(data: bytes) -> None:
            with self._lock:
                sent[data[HEADER:]] = None
                if len(sent) > KEPT:
                    del sent[next(iter(sent))]
            publish(data)
        return keep_and_publish

    def _log_shared_topic(self, received: Topic, sent: Topic, name: str) -> None:
        """Log that an input and an output are remapped to one topic, which may be a mistake."""
        text = (f'{sent.topic} and {received.topic} are one topic, {name}: the node does not take '
                'its own messages')
        if received.name != 'joint_state' or self._is_relay:
            self._log.info(text)
        else:
            self._log.warning(f'{text}; joint_states.only_passive leaves the driven joint to its '
                              'publisher')

    def is_own(self, topic: str, data: bytes) -> bool:
        """Return whether this node sent the bytes that came on a topic (full name); count it."""
        sent = self._sent.get(topic)
        if sent is None or data[HEADER:] not in sent:
            return False
        self.own_count += 1
        return True


class Repeats:
    """
    Counts inputs with a stamp that the node has answered already.

    Other nodes make such inputs from our outputs and keep the stamps: a loop that may go on for
    ever. Topics have their full names; ``output_topics()`` returns the topics of the answers.
    """

    def __init__(self, node: Node, input_topic: str,
                 output_topics: Callable[[], Collection[str]]) -> None:
        self._node, self._input_topic, self._output_topics = node, input_topic, output_topics
        self._stamps: dict[int, None] = {}           # the newest KEPT ones [ns], oldest first
        self._count = 0                              # inputs that repeated one of them
        self._before = time.monotonic(), 0           # [s] and count at the last state()

    def take(self, stamp: int) -> None:
        """Note the stamp of an input [ns]."""
        if stamp in self._stamps:
            self._count += 1
            return
        self._stamps[stamp] = None
        if len(self._stamps) > KEPT:
            del self._stamps[next(iter(self._stamps))]

    def state(self) -> tuple[dict[str, Any], list[str]]:
        """Return (values, problems) of the time since the last call, for the diagnostics."""
        (since, count_then), now = self._before, time.monotonic()
        self._before = now, self._count
        grown, problems = self._count - count_then, []
        if grown and (path := through(self._node, self._input_topic, self._output_topics())):
            rate = grown / max(now - since, 1e-9)
            problems = [f'in a circle through {", ".join(reversed(path))}: {rate:.0f} inputs a '
                        'second repeat a stamp']
        return {'repeated stamps': self._count}, problems


def through(node: Node, input_topic: str, output_topics: Collection[str]) -> list[str]:
    """
    Return the nodes through which outputs of a node come back to its input, the last one first.

    A breadth-first search of the ROS graph, from publishers to subscribers; empty if none come.
    """
    this = node.get_fully_qualified_name()
    predecessor: dict[str, str] = {this: ''}         # of each node reached
    topics = dict.fromkeys(output_topics, this)      # {topic: its publisher} of the last round
    while topics:
        reached: list[str] = []
        for topic, sender in topics.items():
            for info in node.get_subscriptions_info_by_topic(topic):
                name = f'{info.node_namespace.rstrip("/")}/{info.node_name}'
                # A node that was not discovered yet, unlike its endpoint, has no name.
                if name.startswith('/') and name not in predecessor:
                    predecessor[name] = sender
                    reached.append(name)
        topics = {topic: name for name in reached for topic in _published_by(node, name)}
        if input_topic in topics:
            path = [topics[input_topic]]
            while predecessor[path[-1]] != this:
                path.append(predecessor[path[-1]])
            return path
    return []


def _published_by(node: Node, name: str) -> list[str]:
    """Return the topics that the node of a full name publishes; none if it has left."""
    namespace, _, short = name.rpartition('/')
    with suppress(NodeNameNonExistentError):
        return [topic for topic, _ in
                node.get_publisher_names_and_types_by_node(short, namespace or '/')
                if topic not in OF_ALL]
    return []
