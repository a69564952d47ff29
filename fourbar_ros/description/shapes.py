# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Solids to draw links with: rods between their joints, pins, blocks on rails.

They follow from the connections alone, so mechanisms of any kind have them. Sizes are in
proportion to the radius of the rods.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import atan2, hypot, pi
from typing import NamedTuple

from fourbar_ros.description.connections import Connection
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
import numpy as np

Place = tuple[float, float]
JointWithTravel = tuple[Connection, tuple[float, float] | None]    # with the travel of a slide [m]


class Shape(NamedTuple):
    """
    A solid: a ``form``, cylinder or box, with its sizes, as words of URDF [m].

    ``pose``: x, y, z, roll, pitch, yaw in the frame of its link; a cylinder lies along z of it.
    """

    form: str
    sizes: Mapping[str, float | tuple[float, ...]]
    pose: tuple[float, float, float, float, float, float]


def _rod(start: Place, end: Place, radius: float) -> Shape:
    """Return a round rod between two places of the plane."""
    (x, y), (u, v) = start, end
    return Shape('cylinder', {'radius': radius, 'length': hypot(u - x, v - y)},
                 (0.5 * (x + u), 0.5 * (y + v), 0.0, 0.0, 0.5 * pi, atan2(v - y, u - x)))


def _pin(at: Place, radius: float, length: float) -> Shape:
    """Return a cylinder square to the plane."""
    return Shape('cylinder', {'radius': radius, 'length': length}, (*at, 0.0, 0.0, 0.0, 0.0))


def _block(at: Place, angle: float, size: tuple[float, float, float]) -> Shape:
    """Return a box: ``size`` along, across and out of the plane, turned by an angle."""
    return Shape('box', {'size': size}, (*at, 0.0, 0.0, 0.0, angle))


def shapes_of(mechanism: Mechanism, joints: Iterable[JointWithTravel],
              points: Iterable[tuple[str, float, float]], radius: float) -> dict[str, list[Shape]]:
    """
    Return {link, or GROUND: list of shapes in its frame}, with rods of a radius [m].

    A pin joint is a pin on its parent; a slide is a rail on its parent, as long as its ``travel``
    (low, high), and a block on its child. Rods of a link reach to its joints and ``points``, given
    as (link, along, across).
    """
    places: dict[str, list[Place]] = {GROUND: [], **{link.name: [(0.0, 0.0)]
                                                     for link in mechanism.LINKS}}
    shapes: dict[str, list[Shape]] = {name: [] for name in places}
    for connection, travel in joints:
        parent, child, turn = connection.parent, connection.child, connection.turn
        if connection.axis is None or travel is None:
            places[parent].append(connection.on_parent)
            places[child].append(connection.on_child)
            shapes[parent].append(_pin(connection.on_parent, 1.3 * radius, 3.0 * radius))
        else:
            (x, y), (u, v) = connection.on_parent, connection.axis
            low, high = travel
            if low < high:
                shapes[parent].append(_rod((x + low * u, y + low * v),
                                           (x + high * u, y + high * v), 0.6 * radius))
            shapes[child].append(_block(connection.on_child, atan2(v, u) - turn,
                                        (6.0 * radius, 3.5 * radius, 3.0 * radius)))
    for name, along, across in points:
        places[name].append((along, across))
    for link in mechanism.LINKS:
        shapes[link.name] += _rods(places[link.name], radius)
    return shapes


def _rods(places: Sequence[Place], radius: float) -> list[Shape]:
    """Return rods through the places of a link, from one to the next along it; none too short."""
    different = sorted(set(places))
    return [_rod(start, end, radius) for start, end in zip(different, different[1:])
            if np.hypot(end[0] - start[0], end[1] - start[1]) > 0.1 * radius]
