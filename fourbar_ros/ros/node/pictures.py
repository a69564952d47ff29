# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Outputs for the eye: URDF, TF, markers, traces; sent if anyone looks.

Only scenes that name them import their messages.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from fourbar_ros.ros.messages import Message, Stamp
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.scene import Scene
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message

Make = Callable[[Stamp, Sequence[float]], Message]      # None where the pose is not known


class Drawn(NamedTuple):
    """The pictures of a scene by name: functions for those of a step, bytes of latched ones."""

    makers: dict[str, Make]
    latched: dict[str, bytes]


class Pictures:
    """
    The outputs ``robot_description``, ``tf``, ``markers`` and ``traces`` of a scene.

    ``of_loads`` tells whether a step for the markers needs the loads. ``pictures.rate`` limits
    markers alone: a frame of ``tf`` must not be older than the joint states.
    """

    def __init__(self, node: Node, recording: Recording) -> None:
        self._node, self._recording = node, recording
        self._publishers: dict[str, Publisher] = {}      # by the names of outputs, as 'tf'
        self._makers, self._latched = Drawn({}, {})      # until the first apply()
        self._last: int | None = None                    # [ns] stamp of the last markers
        self._period = 0.0                               # [ns] between markers; 0: every step
        self.of_loads = False

    def apply(self, scene: Scene, drawn: Drawn) -> None:
        """Take over a scene with its pictures from :func:`drawn_of`; send the latched ones."""
        for name, topic in scene.pictures.items():
            if name not in self._publishers:             # and kept: see Outputs
                self._publishers[name] = qos.publisher(self._node, topic)
        rate = scene.values['pictures.rate']
        self._period, self._last = 1e9 / rate if rate else 0.0, None
        self._makers, self._latched = drawn
        self.of_loads = 'markers' in self._makers and scene.has_loads
        for name, data in self._latched.items():
            self._send(name, data)

    def record_latched(self) -> None:
        """Write the latched pictures into a new bag, which then needs no earlier messages."""
        for name, data in self._latched.items():
            self._recording.write(name, data)

    def due(self, stamp: Stamp) -> list[str]:
        """Return the pictures to make of the step of this stamp, and count from it for markers."""
        names = [name for name in self._makers
                 if self._recording.active or self._is_subscribed(name)]
        if 'markers' in names:
            now = stamp[0] * 10**9 + stamp[1]
            # 0.99: jitter of stamps must not turn every third sample into every fourth
            if self._last is not None and 0 <= now - self._last < 0.99 * self._period:
                names.remove('markers')
            else:
                self._last = now
        return names

    @property
    def are_seen(self) -> bool:
        """Return whether anyone listens to the pictures of steps."""
        return any(map(self._is_subscribed, self._makers))

    def send(self, names: Iterable[str], stamp: Stamp, values: Sequence[float]) -> None:
        """Send these pictures of one step; ``values`` in the order of the scene's layout."""
        for name in names:
            message = self._makers[name](stamp, values)
            if message is not None:
                self._send(name, serialize_message(message))

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
    from fourbar_ros.description.formats import describe
    from fourbar_ros.ros.node import markers, traces, transforms
    from std_msgs.msg import String
    makers = {'tf': transforms.maker, 'markers': markers.maker}
    latched = {'robot_description': lambda scene: String(data=describe(scene)),
               'traces': traces.message}
    return Drawn({name: make(scene) for name, make in makers.items() if name in wanted},
                 {name: serialize_message(make(scene)) for name, make in latched.items()
                  if name in wanted})
