# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Outputs for the eye: URDF, TF, markers, traces; sent if anyone looks.

Only scenes that name them import their messages.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import cos, isnan, sin
from typing import TYPE_CHECKING

from fourbar_ros.description.model import model_of
from fourbar_ros.mechanisms.parts import Connection
from fourbar_ros.ros.messages import Stamp
from fourbar_ros.ros.node import entities
from fourbar_ros.scene.scene import Scene
from geometry_msgs.msg import Transform, TransformStamped
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message

if TYPE_CHECKING:      # run imports this file
    from fourbar_ros.ros.node.stream import Make, RunningScene, Stream
    from tf2_msgs.msg import TFMessage


class Pictures:
    """
    The outputs ``robot_description``, ``tf``, ``markers`` and ``traces`` of the run in force.

    ``pictures.rate`` limits markers alone: a frame of ``tf`` must not be older than the joint
    states.
    """

    def __init__(self, node: Node, stream: Stream) -> None:
        self._node, self._stream = node, stream
        self._publishers: dict[str, Publisher] = {}      # by the names of outputs, and kept
        self._last: int | None = None                    # [ns] stamp of the last markers

    def publish_latched(self, run: RunningScene) -> None:
        """Send the latched pictures of a run that is to be in force."""
        for name, topic in run.scene.pictures.items():
            if name not in self._publishers:
                self._publishers[name] = entities.publisher(self._node, topic)
        self._last = None
        for name, data in run.latched.items():
            self._send(name, data)

    def record_latched(self, run: RunningScene) -> None:
        """Write the latched pictures into a new bag, which then needs no earlier messages."""
        for name, data in run.latched.items():
            self._stream.record(name, data)

    def due(self, run: RunningScene, stamp: Stamp) -> list[str]:
        """Return the pictures to make of the step of this stamp, and count from it for markers."""
        names = [name for name in run.makers if self._stream.is_recording
                 or self._publishers[name].get_subscription_count() > 0]
        if 'markers' in names:
            now, rate = stamp[0] * 10**9 + stamp[1], run.scene.values['pictures.rate']
            # 0.99: jitter of stamps must not turn every third sample into every fourth
            if rate and self._last is not None and 0 <= now - self._last < 0.99e9 / rate:
                names.remove('markers')
            else:
                self._last = now
        return names

    def send(self, run: RunningScene, names: Iterable[str], stamp: Stamp,
             values: Sequence[float]) -> None:
        """Send these pictures of one step; ``values`` in the order of the scene's layout."""
        for name in names:
            message = run.makers[name](stamp, values)
            if message is not None:
                self._send(name, serialize_message(message))

    def _send(self, name: str, data: bytes) -> None:
        self._publishers[name].publish(data)
        self._stream.record(name, data)


def drawn_of(scene: Scene) -> tuple[dict[str, Make], dict[str, bytes]]:
    """
    Return {name: function} of the pictures of a step, {name: bytes} of the latched ones.

    FourBarError for one that cannot be drawn.
    """
    from fourbar_ros.description.formats import describe
    from fourbar_ros.ros.node import markers, traces
    from std_msgs.msg import String
    wanted = scene.pictures
    makers = {'tf': frames_maker, 'markers': markers.maker}
    latched = {'robot_description': lambda scene: String(data=describe(scene)),
               'traces': traces.message}
    return ({name: make(scene) for name, make in makers.items() if name in wanted},
            {name: serialize_message(make(scene)) for name, make in latched.items()
             if name in wanted})


# --- TF: the frame of each link in that of its parent, as in the URDF; frames of points ----------

def frames_maker(scene: Scene) -> Make:
    """
    Return the function (stamp, values) -> TFMessage, None where a position is not known.

    ``values`` in the order of the scene's layout. The message is made once; a step sets the
    stamps and the frames of links, each by the coordinate of the joint it hangs on.
    """
    from tf2_msgs.msg import TFMessage  # only scenes that name tf
    model, place = model_of(scene), scene.layout.place
    message = TFMessage()
    moving = []              # (transform of a link, its Connection, index of its coordinate)
    for link in model.links:
        frame = _add_frame(message, link.parent, link.frame)
        moving.append((frame.transform, link.joint.connection,
                       place[link.joint.coordinate.position]))
    for name, (link_frame, x, y) in model.points.items():
        translation = _add_frame(message, link_frame, name).transform.translation
        translation.x, translation.y = x, y

    def make(stamp: Stamp, values: Sequence[float]) -> TFMessage | None:
        for frame in message.transforms:
            frame.header.stamp.sec, frame.header.stamp.nanosec = stamp
        for transform, connection, i in moving:
            if isnan(values[i]):
                return None
            _move(transform, connection, values[i])
        return message
    return make


def frames_of(scene: Scene) -> set[str]:
    """Return the names of the frames that a scene moves."""
    model = model_of(scene)
    return {*(link.frame for link in model.links), *model.points}


def _add_frame(message: TFMessage, parent: str, child: str) -> TransformStamped:
    """Add the frame of a child, at its parent's for now, to the message and return it."""
    frame = TransformStamped(child_frame_id=child)
    frame.header.frame_id = parent
    message.transforms.append(frame)
    return frame


def _move(transform: Transform, connection: Connection, q: float) -> None:
    """Set the pose of a child in its parent's frame for the joint coordinate q [rad or m]."""
    (x, y), angle = connection.on_parent, connection.turn
    if connection.axis is None:
        angle += q
    else:
        x, y = x + q * connection.axis[0], y + q * connection.axis[1]
    transform.translation.x, transform.translation.y = x, y
    transform.rotation.z, transform.rotation.w = sin(0.5 * angle), cos(0.5 * angle)
