# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The motion of the driven joint in the bytes of an input message."""
from __future__ import annotations

from fourbar_ros.ros.messages import resolve, Stamp
from fourbar_ros.scene.message_fields import driven_of
from rclpy.serialization import deserialize_message

Given = tuple[float, float, float]      # position, velocity, acceleration; NaN where not given


class Reader:
    """Reads input messages of a type; ``joint``: name of the driven joint in a JointState."""

    def __init__(self, type_name: str, joint: str = ''):
        self._type, self._joint = resolve(type_name), joint

    def __call__(self, data: bytes) -> tuple[Stamp, Given | None]:
        """
        Return stamp and motion of a serialised message; no motion (None) if it lacks the joint.

        Raises what ROS raises for bytes that are no message of this type.
        """
        message = deserialize_message(data, self._type)
        stamp = message.header.stamp
        return (stamp.sec, stamp.nanosec), driven_of(message, self._joint)
