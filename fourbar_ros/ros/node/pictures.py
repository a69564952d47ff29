# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Outputs for the eye: URDF, TF, markers, traces, and where all of it lies in the robot.

Only scenes that have them import their messages.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import cos, isnan, sin
from typing import TYPE_CHECKING

from fourbar_ros.description.model import model_of
from fourbar_ros.ros.messages import Message, Stamp
from fourbar_ros.scene import base, topics
from fourbar_ros.scene.scene import Scene
from geometry_msgs.msg import TransformStamped
from rclpy.serialization import serialize_message

if TYPE_CHECKING:      # run imports this file
    from fourbar_ros.ros.node.stream import Make
    from tf2_msgs.msg import TFMessage


def drawn_of(scene: Scene) -> tuple[dict[str, Make], dict[str, bytes]]:
    """Return {name: function} of moving pictures, {name: bytes} of latched; or FourBarError."""
    makers: dict[str, Make] = {}
    latched: dict[str, Message] = {}
    if topics.FRAME.name in scene.pictures:
        latched[topics.FRAME.name] = static_frame(scene)
    if 'tf' in scene.pictures:
        makers['tf'] = frames_maker(scene)
    if {'markers', 'traces'} & scene.pictures.keys():
        from fourbar_ros.ros.node import markers
        if 'markers' in scene.pictures:
            makers['markers'] = markers.maker(scene)
        if 'traces' in scene.pictures:
            latched['traces'] = markers.traces(scene)
    if 'robot_description' in scene.pictures:
        from fourbar_ros.description.formats import describe
        from std_msgs.msg import String
        latched['robot_description'] = String(data=describe(scene))
    return makers, {name: serialize_message(message) for name, message in latched.items()}


def static_frame(scene: Scene) -> TFMessage:
    """Return the TFMessage with the frame of a scene in that of its ``frame.parent``."""
    from tf2_msgs.msg import TFMessage
    message = TFMessage()
    transform = _add_frame(message, scene.frame.parent, scene.frame_id).transform
    translation, rotation = transform.translation, transform.rotation
    translation.x, translation.y, translation.z = scene.frame.xyz
    rotation.x, rotation.y, rotation.z, rotation.w = base.quaternion_of(scene.frame.rpy)
    return message


# --- TF: the frame of each link in that of its parent, as in the URDF; frames of points ----------

def frames_maker(scene: Scene) -> Make:
    """Return the function (stamp, values) -> TFMessage, None where a position is not known."""
    from tf2_msgs.msg import TFMessage  # only scenes that name tf
    model, index_of = model_of(scene), scene.layout.index_of
    message = TFMessage()
    moving = []              # (transform of a link, its Connection, index of its coordinate)
    for joint in model.joints:
        frame = _add_frame(message, joint.parent, joint.child)
        moving.append((frame.transform, joint.connection, index_of[joint.coordinate.position]))
    for name, (link_frame, x, y) in model.points.items():
        translation = _add_frame(message, link_frame, name).transform.translation
        translation.x, translation.y = x, y

    def make(stamp: Stamp, values: Sequence[float]) -> TFMessage | None:
        for frame in message.transforms:
            frame.header.stamp.sec, frame.header.stamp.nanosec = stamp
        for transform, connection, i in moving:
            q = values[i]                        # the joint coordinate [rad or m]
            if isnan(q):
                return None
            transform.translation.x, transform.translation.y, angle = connection.pose(q)
            transform.rotation.z, transform.rotation.w = sin(0.5 * angle), cos(0.5 * angle)
        return message
    return make


def frames_of(scene: Scene) -> set[str]:
    frames = {scene.frame_id} if topics.FRAME.name in scene.pictures else set[str]()
    if 'tf' in scene.pictures:
        model = model_of(scene)
        frames |= {*(joint.child for joint in model.joints), *model.points}
    return frames


def _add_frame(message: TFMessage, parent: str, child: str) -> TransformStamped:
    frame = TransformStamped(child_frame_id=child)
    frame.header.frame_id = parent
    message.transforms.append(frame)
    return frame
