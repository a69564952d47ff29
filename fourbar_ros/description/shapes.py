# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Solids to draw links with: rods between their joints, pins, blocks on rails.

They follow from the connections alone, so mechanisms of any kind have them. Sizes are in
proportion to the radius of the rods.
"""
from collections.abc import Iterable, Mapping
from math import atan2, hypot, pi
from typing import NamedTuple

from fourbar_ros.description.connections import Connection
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
import numpy as np

Point = tuple[float, float]
JointWithTravel = tuple[Connection, tuple[float, float] | None]    # with the travel of a slide [m]


class Shape(NamedTuple):
    """
    A solid: a ``form``, cylinder or box, with its sizes, as words of URDF [m].

    ``pose``: x, y, z, roll, pitch, yaw in the frame of its link; a cylinder lies along z of it.
    """

    form: str
    sizes: Mapping[str, float | tuple[float, ...]]
    pose: tuple[float, float, float, float, float, float]


def _rod(start: Point, end: Point, radius: float) -> Shape:
    (x, y), (u, v) = start, end
    return Shape('cylinder', {'radius': radius, 'length': hypot(u - x, v - y)},
                 (0.5 * (x + u), 0.5 * (y + v), 0.0, 0.0, 0.5 * pi, atan2(v - y, u - x)))


def shapes_of(mechanism: Mechanism, joints: Iterable[JointWithTravel],
              points: Iterable[tuple[str, float, float]], radius: float) -> dict[str, list[Shape]]:
    """
    Return {link, or GROUND: list of shapes in its frame}, with rods of a radius [m].

    A pin joint is a pin on its parent; a slide is a rail on its parent, as long as its ``travel``
    (low, high), and a block on its child. Rods of a link reach to its joints and ``points``, given
    as (link, along, across).
    """
    ends: dict[str, list[Point]] = {GROUND: [], **{link.name: [(0.0, 0.0)]
                                                   for link in mechanism.LINKS}}
    shapes: dict[str, list[Shape]] = {name: [] for name in ends}
    for connection, travel in joints:
        parent, child, turn = connection.parent, connection.child, connection.turn
        if connection.axis is None or travel is None:
            ends[parent].append(connection.on_parent)
            ends[child].append(connection.on_child)
            shapes[parent].append(Shape(
                'cylinder', {'radius': 1.3 * radius, 'length': 3.0 * radius},
                (*connection.on_parent, 0.0, 0.0, 0.0, 0.0)))
        else:
            (x, y), (u, v) = connection.on_parent, connection.axis
            low, high = travel
            if low < high:
                shapes[parent].append(_rod((x + low * u, y + low * v),
                                           (x + high * u, y + high * v), 0.6 * radius))
            # along, across and out of the plane
            sizes = 6.0 * radius, 3.5 * radius, 3.0 * radius
            shapes[child].append(Shape('box', {'size': sizes}, (
                *connection.on_child, 0.0, 0.0, 0.0, atan2(v, u) - turn)))
    for name, along, across in points:
        ends[name].append((along, across))
    for link in mechanism.LINKS:
        along_link = sorted(set(ends[link.name]))
        shapes[link.name] += [
            _rod(start, end, radius) for start, end in zip(along_link, along_link[1:])
            if np.hypot(end[0] - start[0], end[1] - start[1]) > 0.1 * radius]    # not too short
    return shapes
