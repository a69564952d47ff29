# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One publisher: each message is serialised once, for the wire and for the bag."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isnan
from typing import Any

from fourbar_ros.ros.messages import resolve, set_constants
from fourbar_ros.ros.node import packed, qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.scene.message_fields import FieldMap
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVE_STATE, QUEUE_DEPTH, Topic
from rclpy.event_handler import PublisherEventCallbacks, UnsupportedEventTypeError
from rclpy.publisher import Publisher

PARTS = 'points', 'links'      # families whose values are computed for a topic alone


class TopicPublisher:
    """
    One published topic; ``is_subscribed`` tells whether it has subscribers.

    ``changed()`` is called when the first subscriber has come or the last one has left.
    """

    def __init__(self, node: Base, topic: Topic, changed: Callable[[], None]) -> None:
        self.name, self._topic, self._node = topic.name, topic, node
        self.is_part = topic.name.partition('/')[0] in PARTS
        self.is_subscribed, self._changed = False, changed
        self._message = resolve(topic.type)()
        try:
            self._publisher = self._create(PublisherEventCallbacks(matched=self._matched))
        except UnsupportedEventTypeError:                # this middleware has none: always send
            self.is_subscribed = True
            self._publisher = self._create(None)

    def _create(self, callbacks: PublisherEventCallbacks | None) -> Publisher:
        return qos.create(self._node, 'publisher', type(self._message), self._topic.topic,
                          QUEUE_DEPTH, event_callbacks=callbacks)

    @property
    def topic(self) -> str:
        """Return the full name of the topic."""
        return str(self._publisher.topic_name)

    def _matched(self, info: Any) -> None:
        """Note how many subscribers there are: rclpy's event."""
        is_subscribed = info.current_count > 0
        if is_subscribed != self.is_subscribed:
            self.is_subscribed = is_subscribed
            self._changed()

    def apply(self, scene: Scene) -> None:
        """Take over a scene: make ``pack``, values to bytes, ``publish`` and ``needs_loads``."""
        set_constants(self.name, self._message, scene)
        self._positions = scene.needed_for(self.name)
        layout = drive_layout() if self.name == DRIVE_STATE.name else scene.layout
        self.pack, is_packed = packed.writer(self.name, self._message, layout)
        if not is_packed:
            self._node.get_logger().info(f'{self._topic.topic}: {self._topic.type} cannot be '
                                         'packed here, ROS serialises every message', once=True)
        self.needs_loads = (self._topic.needs_loads
                            or (self.name == 'joint_states' and scene.needs_loads))
        self.publish = self._node.circles.sender(self._publisher, self._topic)

    def has_something(self, values: Sequence[float]) -> bool:
        """Return False if a value is NaN that it must not send, as a position in joint_states."""
        return not any(isnan(values[place]) for place in self._positions)


def drive_layout() -> FieldMap:
    """Return which value of DriveValues goes into which field of DriveState: names are equal."""
    from fourbar_ros.dynamics.step.mover import DriveValues  # only these scenes need it
    names = DriveValues._fields
    return FieldMap({DRIVE_STATE.name: dict(zip(names, names))}, {},
                    {name: i for i, name in enumerate(names)}, ())
