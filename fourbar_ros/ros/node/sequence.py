# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages that were sent but never taken, by their sequence numbers."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fourbar_ros.ros.node import entities
from fourbar_ros.ros.node.rclpy_guard import with_info
from fourbar_ros.scene.topics import Topic
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.subscription import Subscription


class SequenceNumbers:
    """
    Counts the messages that were lost on one topic, by gaps in their sequence numbers.

    Every publisher counts its messages, but a message does not name its publisher. So the next
    number of each publisher is kept; a number that fits none leaves a gap behind the nearest
    below. With several publishers a gap may be counted for the wrong publisher; the sum is right.
    ``publishers()`` returns how many there are. ``is_numbered`` is False with a middleware that
    gives no sequence numbers: then nothing is known.
    """

    def __init__(self, publishers: Callable[[], int]) -> None:
        self._publishers = publishers
        self._next: list[int] = []       # the number that each publisher will give next
        self._heard: set[int] = set()    # indices there of those that sent lately
        self.is_numbered = True

    def forget(self) -> None:
        """Start anew: publishers have come or gone."""
        self._next, self._heard = [], set()

    def heard(self) -> int:
        heard, self._heard = self._heard, set()
        return len(heard)

    def lost_before(self, sequence: int | None) -> int:
        """Return how many were lost before a message with a number, None if it has none."""
        if sequence is None:
            self.is_numbered = False
            return 0
        lost = 0
        expected = self._next
        if sequence in expected:
            publisher = expected.index(sequence)
        elif len(expected) < self._publishers():
            publisher = len(expected)                    # its first message
            expected.append(sequence)
        elif before := [due for due in expected if due < sequence]:
            lost = sequence - max(before)                # 5, 6, 9: 7 and 8 are lost
            publisher = expected.index(max(before))
        else:
            publisher, self._next = 0, [sequence]        # a publisher that has started again
            self._heard.clear()
        self._next[publisher] = sequence + 1
        self._heard.add(publisher)
        return lost


def subscribe(node: Node, topic: Topic, take: Callable[[bytes, int], None],
              troubles: entities.Troubles, is_reliable: bool = False,
              deadline: Callable[[Any], None] | None = None
              ) -> tuple[Subscription, SequenceNumbers]:
    """
    Subscribe to bytes; return the subscription and its sequence numbers.

    ``take`` is called with each message and how many were lost since the one before.
    """
    sequence = SequenceNumbers(lambda: made.get_publisher_count())
    events = SubscriptionEventCallbacks(matched=lambda _: sequence.forget())
    if deadline:
        events.deadline = deadline           # not every middleware knows this event

    def receive(data: bytes, info: dict[str, Any]) -> None:
        take(data, sequence.lost_before(info['publication_sequence_number']))

    made = entities.subscription(node, topic, with_info(receive), troubles, is_reliable, events)
    return made, sequence
