# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""TF: the frames of the links, each in that of its parent in the URDF, and those of the points."""
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

    ``values``: in the places of the scene's layout.
    """
    model, place = model_of(scene), scene.layout.place
    message, moving = TFMessage(), []
    for link in model.links:
        one = _frame(message, link.parent, link.frame)
        moving.append((one.transform, link.joint.connection,
                       place[link.joint.coordinate.position]))
    for name, (frame, x, y) in model.points.items():
        translation = _frame(message, frame, name).transform.translation
        translation.x, translation.y = x, y

    def make(stamp: Stamp, values: Sequence[float]) -> TFMessage | None:
        for one in message.transforms:
            one.header.stamp.sec, one.header.stamp.nanosec = stamp
        for transform, connection, at in moving:
            if isnan(values[at]):
                return None
            _move(transform, connection, values[at])
        return message
    return make


def frames_of(scene: Scene) -> set[str]:
    """Return the names of the frames that a scene moves."""
    model = model_of(scene)
    return {*(link.frame for link in model.links), *model.points}


def _frame(message: TFMessage, parent: str, child: str) -> TransformStamped:
    """Add a frame to the message and return it."""
    one = TransformStamped(child_frame_id=child)
    one.header.frame_id = parent
    message.transforms.append(one)
    return one


def _move(transform: Transform, connection: Connection, q: float) -> None:
    """Place a child in the frame of its parent; ``q``: coordinate of the joint."""
    (x, y), angle = connection.on_parent, connection.turn
    if connection.axis is None:
        angle += q
    else:
        x, y = x + q * connection.axis[0], y + q * connection.axis[1]
    transform.translation.x, transform.translation.y = x, y
    transform.rotation.z, transform.rotation.w = sin(0.5 * angle), cos(0.5 * angle)
