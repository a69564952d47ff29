# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""TF: the frame of each link in the frame of its parent, as in the URDF; frames of points."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, isnan, sin

from fourbar_ros.description.model import model_of
from fourbar_ros.mechanisms.parts import Connection
from fourbar_ros.ros.messages import Stamp
from fourbar_ros.scene.scene import Scene
from geometry_msgs.msg import Transform, TransformStamped
from tf2_msgs.msg import TFMessage


def maker(scene: Scene) -> Callable[[Stamp, Sequence[float]], TFMessage | None]:
    """
    Return the function (stamp, values) -> TFMessage, None where a position is not known.

    ``values`` in the order of the scene's layout. The message is made once; a step sets the
    stamps and the frames of links, each by the coordinate of the joint it hangs on.
    """
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
