# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What people look at: URDF, TF, markers. Sent when asked for, at most as often as eyes need it.

Their messages and the description are imported by the scenes that name them.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from fourbar_ros.ros.messages import Message, resolve, Stamp
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import QUEUE_DEPTH, Topic
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message

Make = Callable[[Stamp, Sequence[float]], Message]      # None where there is nothing to see


class Drawn(NamedTuple):
    """The pictures of a scene: what makes those of a step, and the latched ones as bytes."""

    makers: dict[str, Make]
    latched: dict[str, bytes]


class Pictures:
    """
    The outputs ``robot_description``, ``tf``, ``markers`` and ``traces`` of a scene.

    Parameters
    ----------
    node : rclpy.node.Node
    recording : Recording

    Attributes
    ----------
    of_loads : bool
        Whether a step for them needs the loads.

    """

    def __init__(self, node: Node, recording: Recording) -> None:
        self._node, self._recording = node, recording
        self._publishers: dict[str, Publisher] = {}
        self._makers, self._latched = Drawn({}, {})
        self._last: int | None = None
        self._period, self.of_loads = 0.0, False

    def apply(self, scene: Scene, drawn: Drawn) -> None:
        """Take over a scene and what :func:`drawn_of` makes of it; send what is latched."""
        for name, topic in scene.pictures.items():
            if name not in self._publishers:             # and kept: see Outputs
                self._publishers[name] = self._publisher(topic)
        rate = scene.values['pictures.rate']
        self._period, self._last = 1e9 / rate if rate else 0.0, None
        self._makers, self._latched = drawn
        self.of_loads = 'markers' in self._makers and scene.linkage.bodies is not None
        for name, data in self._latched.items():
            self._send(name, data)

    def record_latched(self) -> None:
        """Have a new bag begin with what is latched."""
        for name, data in self._latched.items():
            self._recording.write(name, data)

    def are_due(self, stamp: Stamp) -> bool:
        """Return whether a step at this time, (seconds, nanoseconds), is to be seen."""
        if not (self._makers and (self._recording.active or self.are_seen)):
            return False
        now = stamp[0] * 10**9 + stamp[1]
        # the grid of the input is kept: every third sample, say, not every fourth
        if self._last is not None and 0 <= now - self._last < 0.99 * self._period:
            return False
        self._last = now
        return True

    @property
    def are_seen(self) -> bool:
        """Return whether anyone listens to the pictures of steps."""
        return any(map(self._is_subscribed, self._makers))

    def send(self, stamp: Stamp, values: Sequence[float]) -> None:
        """Send the pictures of one step: its values in the places of the layout."""
        for name, make in self._makers.items():
            message = make(stamp, values)
            if message is not None and (self._recording.active or self._is_subscribed(name)):
                self._send(name, serialize_message(message))

    def _publisher(self, topic: Topic) -> Publisher:
        profile = (QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
                   if topic.latched else QUEUE_DEPTH)
        return qos.create(self._node, 'publisher', resolve(topic.type), topic.topic, profile)

    def _is_subscribed(self, name: str) -> bool:
        return bool(self._publishers[name].get_subscription_count() > 0)

    def _send(self, name: str, data: bytes) -> None:
        self._publishers[name].publish(data)
        self._recording.write(name, data)


def drawn_of(scene: Scene) -> Drawn:
    """Return the pictures of a scene; raise FourBarError for one that cannot be drawn."""
    wanted = scene.pictures
    if not wanted:
        return Drawn({}, {})
    return Drawn({name: make(scene) for name, make in _makers().items() if name in wanted},
                 {name: serialize_message(make(scene)) for name, make in _latched().items()
                  if name in wanted})


def _makers() -> dict[str, Callable[[Scene], Make]]:
    """Return {output: function (scene) -> function (stamp, values) -> message or None}."""
    from fourbar_ros.ros.node import markers, transforms
    return {'tf': transforms.maker, 'markers': markers.maker}


def _latched() -> dict[str, Callable[[Scene], Message]]:
    """Return {output: function (scene) -> message}."""
    from fourbar_ros.description.formats import describe
    from fourbar_ros.ros.node import traces
    from std_msgs.msg import String
    return {'robot_description': lambda scene: String(data=describe(scene)),
            'traces': traces.message}
