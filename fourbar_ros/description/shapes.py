# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Solids to draw links with: rods between their joints, pins, blocks on rails.

They follow from the connections alone, so mechanisms of any kind have them. Sizes are in
proportion to the radius of the rods. Each solid has a ``pose`` (x, y, z, roll, pitch, yaw) in the
frame of its link, and a ``form``: a word of URDF and SDF with its sizes [m].
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import atan2, hypot, pi
from typing import NamedTuple, Union

from fourbar_ros.description.connections import Connection
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
import numpy as np

Place = tuple[float, float]
Pose = tuple[float, float, float, float, float, float]
Sizes = Mapping[str, Union[float, tuple[float, ...]]]


class Rod(NamedTuple):
    """A round rod between two places of the plane [m]."""

    start: Place
    end: Place
    radius: float

    @property
    def length(self) -> float:
        """Return its length [m]."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    @property
    def pose(self) -> Pose:
        """Return the pose of its cylinder, which URDF and SDF have along z."""
        (x, y), (u, v) = self.start, self.end
        return 0.5 * (x + u), 0.5 * (y + v), 0.0, 0.0, 0.5 * pi, atan2(v - y, u - x)

    @property
    def form(self) -> tuple[str, Sizes]:
        """Return its form and sizes."""
        return 'cylinder', {'radius': self.radius, 'length': self.length}


class Pin(NamedTuple):
    """A cylinder square to the plane, ``length`` long."""

    at: Place
    radius: float
    length: float

    @property
    def pose(self) -> Pose:
        """Return its pose."""
        return (*self.at, 0.0, 0.0, 0.0, 0.0)

    @property
    def form(self) -> tuple[str, Sizes]:
        """Return its form and sizes."""
        return 'cylinder', {'radius': self.radius, 'length': self.length}


class Box(NamedTuple):
    """A box: ``size`` along, across and out of the plane, turned by ``angle``."""

    at: Place
    angle: float
    size: tuple[float, float, float]

    @property
    def pose(self) -> Pose:
        """Return its pose."""
        return (*self.at, 0.0, 0.0, 0.0, self.angle)

    @property
    def form(self) -> tuple[str, Sizes]:
        """Return its form and sizes."""
        return 'box', {'size': self.size}


Shape = Rod | Pin | Box
JointWithTravel = tuple[Connection, tuple[float, float] | None]    # with the travel of a slide [m]


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
            shapes[parent].append(Pin(connection.on_parent, 1.3 * radius, 3.0 * radius))
        else:
            (x, y), (u, v) = connection.on_parent, connection.axis
            low, high = travel
            if low < high:
                shapes[parent].append(Rod((x + low * u, y + low * v), (x + high * u, y + high * v),
                                          0.6 * radius))
            shapes[child].append(Box(connection.on_child, atan2(v, u) - turn,
                                     (6.0 * radius, 3.5 * radius, 3.0 * radius)))
    for name, along, across in points:
        places[name].append((along, across))
    for link in mechanism.LINKS:
        shapes[link.name] += _rods(places[link.name], radius)
    return shapes


def _rods(places: Sequence[Place], radius: float) -> list[Rod]:
    """Return rods through the places of a link, from one to the next along it; none too short."""
    different = sorted(set(places))
    return [Rod(start, end, radius) for start, end in zip(different, different[1:])
            if np.hypot(end[0] - start[0], end[1] - start[1]) > 0.1 * radius]
