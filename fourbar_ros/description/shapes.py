# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What links look like: rods between their joints, pins, blocks, arms to centres of gravity.

From the connections alone, so that a mechanism of any kind has a look. Sizes are in proportion to
the radius of the rods.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import atan2, hypot
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.parts import GROUND
import numpy as np

Place = tuple[float, float]


class Rod(NamedTuple):
    """A round rod between two places of the plane [m]."""

    start: Place
    end: Place
    radius: float

    @property
    def middle(self) -> Place:
        """Return its middle."""
        return 0.5 * (self.start[0] + self.end[0]), 0.5 * (self.start[1] + self.end[1])

    @property
    def length(self) -> float:
        """Return its length [m]."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    @property
    def angle(self) -> float:
        """Return its direction [rad]."""
        return atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])


class Pin(NamedTuple):
    """A cylinder square to the plane, ``length`` long."""

    at: Place
    radius: float
    length: float


class Block(NamedTuple):
    """A box: ``size`` along, across and out of the plane, turned by ``angle``."""

    at: Place
    angle: float
    size: tuple[float, float, float]


Shape = Rod | Pin | Block


def shapes_of(mechanism: Any, joints: Sequence[Any], points: Iterable[Any],
              radius: float) -> dict[str, list[Any]]:
    """
    Return {link, or GROUND: list of shapes in its frame}.

    Parameters
    ----------
    mechanism : Mechanism
    joints : sequence of ModelJoint
        In the order of its ``JOINTS``.
    points : iterable of Point
        Links reach as far as the points on them.
    radius : float
        Radius of the rods [m].

    """
    places: dict[str, list[Place]] = {GROUND: [], **{link.name: [(0.0, 0.0)]
                                                     for link in mechanism.LINKS}}
    found: dict[str, list[Any]] = {name: [] for name in places}
    for joint in joints:
        its = joint.connection
        if its.axis is None:
            places[its.parent].append(its.on_parent)
            places[its.child].append(its.on_child)
            found[its.parent].append(Pin(its.on_parent, 1.3 * radius, 3.0 * radius))
        else:
            found[its.parent].append(_rail(joint, 0.6 * radius))
            angle = atan2(its.axis[1], its.axis[0]) - its.turn
            found[its.child].append(Block(its.on_child, angle,
                                          (6.0 * radius, 3.5 * radius, 3.0 * radius)))
    for link, along, across in points:
        places[link].append((along, across))
    for link in mechanism.LINKS:
        found[link.name] += _rods(places[link.name], radius)
    found[GROUND] = [shape for shape in found[GROUND] if not isinstance(shape, Rod)
                     or shape.length > 0.0]
    return found


def _rail(joint: Any, radius: float) -> Rod:
    """Return the rod that a slide moves along, as far as it goes."""
    (x, y), (a_x, a_y) = joint.connection.on_parent, joint.connection.axis
    low, high = sorted(joint.ratio * (end - joint.offset) for end in joint.limits)
    return Rod((x + low * a_x, y + low * a_y), (x + high * a_x, y + high * a_y), radius)


def _rods(places: Sequence[Place], radius: float) -> list[Rod]:
    """Return rods through the places of a link, from one to the next along it."""
    different = sorted(set(places))
    return [Rod(one, other, radius) for one, other in zip(different, different[1:])
            if np.hypot(other[0] - one[0], other[1] - one[1]) > 0.1 * radius]
