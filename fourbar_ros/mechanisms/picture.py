# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The picture of a mechanism as a list of primitives, which matplotlib, SVG and RViz draw.

Places are in metres. Blocks and pivots have no size of their own: their outlines take that of the
sign, about an inch of the paper. Behind comes first.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import hypot
from typing import NamedTuple, TypeVar

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Bar, Block, Diagram, NamedFields
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.numerics.arrays import Array
import numpy as np

Points = Mapping[str, tuple[str, float, float]]      # {name: (link, along, across)}


class Pivot(NamedTuple):
    """A joint on the ground, under its :class:`NamedJoint`."""

    place: Array


class NamedJoint(NamedTuple):
    """A joint by its name in the diagram."""

    name: str
    place: Array


class Arm(NamedTuple):
    """A point of a link: first joint of the link, foot of the point on its line, the point."""

    name: str
    start: Array
    foot: Array
    end: Array


Primitive = Bar | Block | Pivot | NamedJoint | Arm
Drawn = TypeVar('Drawn', Bar, Block, NamedJoint, Arm)


class Force(NamedTuple):
    """A force [N] at a joint; ``name``: its field of the loads."""

    name: str
    joint: str
    place: Array
    vector: Array

    @property
    def size(self) -> float:
        """Return its magnitude [N]."""
        return hypot(*self.vector)


def picture(mechanism: Mechanism, motion: NamedFields, points: Points | None = None
            ) -> list[Primitive]:
    """Return the primitives of a mechanism in a pose, with points that are fixed to its links."""
    diagram = mechanism.diagram(motion)
    arms = [Arm(name, *(point_motion(mechanism, motion, link, *place).place
                        for place in ((0.0, 0.0), (along, 0.0), (along, across))))
            for name, (link, along, across) in (points or {}).items()]
    return [*(Pivot(diagram.joints[name]) for name in diagram.ground), *diagram.bars, *arms,
            *diagram.blocks, *(NamedJoint(*item) for item in diagram.joints.items())]


def forces_of(diagram: Diagram, loads: NamedFields) -> list[Force]:
    """Return the forces [N] at the joints whose fields of the loads a diagram names."""
    return [Force(name, joint, diagram.joints[joint],
                  np.array([getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')]))
            for name, joint in diagram.forces.items()]


def of_kind(kind: type[Drawn], parts: Iterable[Primitive]) -> list[Drawn]:
    """Return the primitives of one kind."""
    return [part for part in parts if isinstance(part, kind)]


def outlines(sign: Block | Pivot, size: float) -> tuple[Array, Array | None]:
    """
    Return the outline of a block or a pivot, shape (n, 2), and the line of its ground, (2, 2) [m].

    The ground is None of a block that slides on a moving link. ``size``: an inch of the paper [m].
    """
    corners, ground, (x, y) = _TRIANGLE, _GROUND, (1.0, 0.0)
    if isinstance(sign, Block):
        corners, ground, (x, y) = _BOX, _GUIDE if sign.is_guided else None, sign.direction
    axes = size * np.array([(x, y), (-y, x)])
    return sign.place + corners @ axes, None if ground is None else sign.place + ground @ axes


# in inches: (along, across) of the corners, and of the ends of the line of the ground
_TRIANGLE = np.array([(0.0, 0.0), (-0.12, -0.19), (0.12, -0.19)])
_GROUND: Array | None = np.array([(-0.19, -0.19), (0.19, -0.19)])
_BOX = np.array([(0.2, 0.11), (0.2, -0.11), (-0.2, -0.11), (-0.2, 0.11)])
_GUIDE = np.array([(-0.7, -0.11), (0.7, -0.11)])
