# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The solids that links are drawn as: rods between their joints, pins, blocks on rails.

From the connections alone, so that a mechanism of any kind has a look. Sizes are in proportion to
the radius of the rods. Each solid has a ``pose`` (x, y, z, roll, pitch, yaw) in the frame of its
link, a ``form`` in the words of URDF and SDF, and the ``sizes`` of that form.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import atan2, hypot, pi
from typing import NamedTuple, Union

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Connection, GROUND
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
        """Return the pose of a cylinder along z that it is."""
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


class Block(NamedTuple):
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


Shape = Rod | Pin | Block
Joint = tuple[Connection, tuple[float, float] | None]     # with the travel of a slide [m]


def shapes_of(mechanism: Mechanism, joints: Iterable[Joint],
              points: Iterable[tuple[str, float, float]], radius: float) -> dict[str, list[Shape]]:
    """
    Return {link, or GROUND: list of shapes in its frame}.

    Parameters
    ----------
    mechanism : Mechanism
    joints : iterable of (Connection, travel)
        Its joints; of one that slides how far it goes along its axis, (low, high).
    points : iterable of (link, along, across)
        Links reach as far as the points on them.
    radius : float
        Radius of the rods [m].

    """
    places: dict[str, list[Place]] = {GROUND: [], **{link.name: [(0.0, 0.0)]
                                                     for link in mechanism.LINKS}}
    found: dict[str, list[Shape]] = {name: [] for name in places}
    for its, travel in joints:
        if its.axis is None or travel is None:
            places[its.parent].append(its.on_parent)
            places[its.child].append(its.on_child)
            found[its.parent].append(Pin(its.on_parent, 1.3 * radius, 3.0 * radius))
        else:
            (x, y), (u, v) = its.on_parent, its.axis
            ends = [(x + way * u, y + way * v) for way in travel]
            found[its.parent].append(Rod(ends[0], ends[1], 0.6 * radius))
            angle = atan2(its.axis[1], its.axis[0]) - its.turn
            found[its.child].append(Block(its.on_child, angle,
                                          (6.0 * radius, 3.5 * radius, 3.0 * radius)))
    for name, along, across in points:
        places[name].append((along, across))
    for link in mechanism.LINKS:
        found[link.name] += _rods(places[link.name], radius)
    found[GROUND] = [shape for shape in found[GROUND] if not isinstance(shape, Rod)
                     or shape.length > 0.0]
    return found


def _rods(places: Sequence[Place], radius: float) -> list[Rod]:
    """Return rods through the places of a link, from one to the next along it."""
    different = sorted(set(places))
    return [Rod(one, other, radius) for one, other in zip(different, different[1:])
            if np.hypot(other[0] - one[0], other[1] - one[1]) > 0.1 * radius]
