# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How another frame, of a robot's link or of messages, lies to that of the mechanism."""
from collections.abc import Sequence
from math import atan2, cos, hypot, sin

from fourbar_ros.errors import InvalidParameter

Rows = tuple[tuple[float, float, float], ...]


def quaternion_of(rpy: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w of roll, pitch, yaw [rad] about fixed axes, as in URDF."""
    half = [0.5 * angle for angle in rpy]
    (c_r, s_r), (c_p, s_p), (c_y, s_y) = [(cos(angle), sin(angle)) for angle in half]
    return (s_r * c_p * c_y - c_r * s_p * s_y, c_r * s_p * c_y + s_r * c_p * s_y,
            c_r * c_p * s_y - s_r * s_p * c_y, c_r * c_p * c_y + s_r * s_p * s_y)


def rpy_of(axes: Sequence[Sequence[float]]) -> list[float]:
    """Return roll, pitch, yaw [rad] about fixed axes of the axes that rotation_of() gives."""
    (x_x, x_y, x_z), (y_x, y_y, _), (z_x, z_y, _) = axes
    # where x is along z any yaw will do, and the roll is what it leaves
    yaw = atan2(x_y, x_x)
    return [atan2(sin(yaw) * z_x - cos(yaw) * z_y, cos(yaw) * y_y - sin(yaw) * y_x),
            atan2(-x_z, hypot(x_x, x_y)), yaw]


def rotation_of(rotation: Sequence[float]) -> Rows:
    """Return axes as rows, of nothing, roll, pitch, yaw [rad] or a quaternion x, y, z, w."""
    if not rotation:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    if len(rotation) == 3:
        rotation = quaternion_of(rotation)
    size = hypot(*rotation)
    if len(rotation) != 4 or not 0.5 < size < 2.0:
        raise InvalidParameter('base.rotation', list(rotation), 'must be roll, pitch, yaw, or a '
                               'quaternion x, y, z, w of length 1')
    x, y, z, w = [value / size for value in rotation]
    return ((1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
            (2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
            (2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)))
