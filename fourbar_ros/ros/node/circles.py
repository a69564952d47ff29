# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What comes back to a node: its own messages, and those of nodes that answer its answers.

rclpy does not say who sent a message. So the newest messages that a node has sent on a topic on
which it also listens are kept, and what comes with the same bytes is its own.
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

KEPT = 1000                    # messages of a topic: more than wait anywhere
HEADER = 4                     # [bytes] which a middleware may write anew
OF_ALL = ('/rosout', '/parameter_events')      # which every node publishes


class Circles:
    """
    Knows the node's own messages on the topics to which it listens.

    Parameters
    ----------
    node : rclpy.node.Node
    scene : Scene

    Attributes
    ----------
    own : int
        Messages of its own that it has not taken.

    """

    def __init__(self, node: Node, scene: Scene) -> None:
        self._log: Logger = node.get_logger()
        self._is_relay = scene.joint_states.only_passive
        self._heard = {node.resolve_topic_name(topic.topic): topic for topic in scene.received}
        self._sent: dict[str, dict[bytes, None]] = {}
        self._lock = threading.Lock()
        self.own = 0

    def sender(self, publisher: Publisher, topic: Topic) -> Callable[[bytes], None]:
        """Return the function that publishes bytes, and keeps them if the node listens there."""
        # Half the time of Publisher.publish, which guards against being destroyed meanwhile: that
        # happens between two steps only.
        publish: Callable[[bytes], None] = publisher.handle.publish_raw
        name = publisher.topic_name
        heard = self._heard.get(name)
        if heard is None or heard.type != topic.type:
            return publish
        if name not in self._sent:
            self._say(heard, topic, name)
        sent = self._sent.setdefault(name, {})

        def keep_and_publish(data: bytes) -> None:
            with self._lock:                 # several outputs and threads may send there
                sent[data[HEADER:]] = None
                if len(sent) > KEPT:
                    del sent[next(iter(sent))]
            publish(data)
        return keep_and_publish

    def _say(self, heard: Topic, topic: Topic, name: str) -> None:
        text = (f'{topic.topic} and {heard.topic} are one topic, {name}: the node does not take '
                'its own messages')
        if heard.name != 'joint_state' or self._is_relay:
            self._log.info(text)
        else:
            self._log.warning(f'{text}; joint_states.only_passive leaves the driven joint to its '
                              'publisher')

    def is_own(self, topic: str, data: bytes) -> bool:
        """Return, and count, whether this node has sent what came on a topic, by its full name."""
        sent = self._sent.get(topic)
        if sent is None or data[HEADER:] not in sent:
            return False
        self.own += 1
        return True


class Repeats:
    """
    Counts inputs whose stamps were answered already, as those that come round through others.

    Parameters
    ----------
    node : rclpy.node.Node
    input_topic : str
        Full name.
    output_topics : callable
        Returns the full names of the topics of the answers.

    """

    def __init__(self, node: Node, input_topic: str,
                 output_topics: Callable[[], Collection[str]]) -> None:
        self._node, self._heard, self._sent = node, input_topic, output_topics
        self._stamps: dict[int, None] = {}           # the newest ones [ns], in order
        self._count, self._before = 0, (time.monotonic(), 0)

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
        (since, before), now = self._before, time.monotonic()
        self._before = now, self._count
        grown, problems = self._count - before, []
        if grown and (way := through(self._node, self._heard, self._sent())):
            rate = grown / max(now - since, 1e-9)
            problems = [f'in a circle through {", ".join(reversed(way))}: {rate:.0f} inputs a '
                        'second repeat a stamp']
        return {'repeated stamps': self._count}, problems


def through(node: Node, heard: str, sent: Collection[str]) -> list[str]:
    """Return the nodes by which what is sent on topics comes back on another, last first."""
    this = node.get_fully_qualified_name()
    before: dict[str, str] = {this: ''}
    topics = dict.fromkeys(sent, this)
    while topics:
        found: dict[str, str] = {}
        for topic, sender in topics.items():
            for info in node.get_subscriptions_info_by_topic(topic):
                name = f'{info.node_namespace.rstrip("/")}/{info.node_name}'
                # A node that was not discovered yet, unlike its endpoint, has no name.
                if name.startswith('/') and name not in before:
                    before[name] = found[name] = sender
        topics = {topic: name for name in found for topic in _sent_by(node, name)}
        if heard in topics:
            way = [topics[heard]]
            while before[way[-1]] != this:
                way.append(before[way[-1]])
            return way
    return []


def _sent_by(node: Node, name: str) -> list[str]:
    """Return the topics that a node publishes."""
    namespace, _, short = name.rpartition('/')
    with suppress(NodeNameNonExistentError):             # it has left meanwhile
        return [topic for topic, _ in
                node.get_publisher_names_and_types_by_node(short, namespace or '/')
                if topic not in OF_ALL]
    return []
