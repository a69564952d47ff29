# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The published topics of a node, and which of them a step has to make."""
from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from fourbar_ros.ros.node import entities
from fourbar_ros.ros.node.run import Run
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, Topic
from rclpy.event_handler import PublisherEventCallbacks, UnsupportedEventTypeError
from rclpy.node import Node
from rclpy.publisher import Publisher

PARTS = 'points/', 'links/'    # outputs whose values are computed for their topic alone


class TopicPublisher:
    """
    One published topic; ``is_subscribed`` tells whether it has subscribers.

    ``changed()`` is called when the first subscriber has come or the last one has left. Where the
    middleware has no event for that, the topic counts as subscribed. It is kept when a scene no
    longer names it: rclpy's EventsExecutor ends the process at an event of a publisher that is
    gone, as when its last subscriber leaves.
    """

    def __init__(self, node: Node, topic: Topic, changed: Callable[[], None]) -> None:
        self._node, self._topic, self._changed = node, topic, changed
        self.is_subscribed = False
        try:
            self._publisher = self._create(PublisherEventCallbacks(matched=self._matched))
        except UnsupportedEventTypeError:
            self.is_subscribed = True
            self._publisher = self._create(None)
        self.topic = str(self._publisher.topic_name)     # its full name
        # This takes half the time of Publisher.publish, which also guards against its destruction
        # meanwhile.
        self.publish: Callable[[bytes], None] = self._publisher.handle.publish_raw

    def _create(self, callbacks: PublisherEventCallbacks | None) -> Publisher:
        return entities.publisher(self._node, self._topic, event_callbacks=callbacks)

    def _matched(self, info: Any) -> None:
        """Note how many subscribers there are: rclpy's event."""
        is_subscribed = info.current_count > 0
        if is_subscribed != self.is_subscribed:
            self.is_subscribed = is_subscribed
            self._changed()


class Wanted(NamedTuple):
    """The topics that a step has to send, and the parts of a step that they need."""

    driven: bool
    drive_state: bool
    outputs: list[str]        # names of the scene's outputs
    with_loads: bool
    parts: frozenset[str]     # the points and links among them

    @classmethod
    def of(cls, run: Run, names: Iterable[str]) -> Wanted:
        """Return the work of a step of a run that sends the topics of these names."""
        wanted = set(names)
        outputs = [name for name in run.outputs if name in wanted]
        return cls(DRIVEN.name in wanted, DRIVE_STATE.name in wanted, outputs,
                   any(map(run.needs_loads, outputs)),
                   frozenset(name for name in outputs if name.startswith(PARTS)))
