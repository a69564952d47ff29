# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Which links each joint of a mechanism connects, and where: URDF and MJCF are made of it."""
from __future__ import annotations

from collections.abc import Iterator
from math import cos, pi, sin
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.four_bars import FourBarLinks
from fourbar_ros.mechanisms.parts import GROUND, SLIDE
from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank
from fourbar_ros.numerics.number_types import direction

X, Y = (1.0, 0.0), (0.0, 1.0)       # directions of slides


class Connection(NamedTuple):
    """
    Which two links a joint connects, and where.

    With the coordinate q of the joint, the angle of the child is that of the parent plus ``turn``,
    plus q of a joint that turns. The joint's place on the child is its place on the parent, moved
    by q along ``axis`` of a joint that slides.

    Parameters
    ----------
    parent, child : str
        Names of links, or :data:`GROUND`.
    on_parent, on_child : tuple of 2 floats
        The joint, along each link from its first joint and across to its left [m].
    axis : tuple of 2 floats, optional
        Unit vector of a joint that slides, in the frame of the parent; None: it turns.
    turn : float
        Angle from the parent to the child, of a joint that turns at q = 0 [rad].

    """

    parent: str
    child: str
    on_parent: tuple[float, float] = (0.0, 0.0)
    on_child: tuple[float, float] = (0.0, 0.0)
    axis: tuple[float, float] | None = None
    turn: float = 0.0

    def reversed(self) -> Connection:
        """Return the same joint with parent and child exchanged; a pin has -q then."""
        c, s = cos(self.turn), sin(self.turn)
        axis = self.axis and (-c * self.axis[0] - s * self.axis[1],
                              s * self.axis[0] - c * self.axis[1])
        return Connection(self.child, self.parent, self.on_child, self.on_parent, axis, -self.turn)


def connections_of(mechanism: Any) -> tuple[Connection, ...]:
    """Return the connections in the order of a mechanism's joints; the ground is never a child."""
    if isinstance(mechanism, (FourBarLinks, SliderCrank, InvertedSlider, ScotchYoke)):
        return (Connection(GROUND, 'crank'), Connection('crank', 'coupler', (mechanism.a1, 0.0)),
                *_of_kind(mechanism))
    frame, driven, *_ = mechanism.layout.links
    base = Connection(frame, driven, axis=X if mechanism.input == SLIDE else None)
    return (base, *(its.reversed() if its.child == GROUND else its
                    for dyad in mechanism.stages for its in _of_dyad(dyad)))


def _of_kind(mechanism: Any) -> tuple[Connection, Connection]:
    """Return the connections of coupler and output, and of the ground and the output."""
    if isinstance(mechanism, FourBarLinks):
        return (Connection('coupler', 'output', (mechanism.a2, 0.0), (mechanism.a3, 0.0), turn=pi),
                Connection(GROUND, 'output', (mechanism.a4, 0.0)))
    offset = 0.0, mechanism.offset
    if isinstance(mechanism, InvertedSlider):
        return (Connection('output', 'coupler', offset, axis=X),
                Connection(GROUND, 'output', (mechanism.a4, 0.0)))
    guide = Connection(GROUND, 'output', offset, axis=X)
    if isinstance(mechanism, SliderCrank):
        return Connection('coupler', 'output', (mechanism.a2, 0.0)), guide
    return Connection('output', 'coupler', axis=Y, turn=0.5 * pi), guide     # the slot, along y


def _of_dyad(dyad: Any) -> Iterator[Connection]:     # its kind has these dimensions: checked
    """Yield the connections of the first, the inner and the second joint of a dyad."""
    one, other = dyad.links
    yield (_slide(dyad.first, one, dyad.direction_1) if dyad.kind == 'PRP'
           else Connection(dyad.first.link, one, tuple(dyad.first[1:])))
    yield _inner(dyad, one, other)
    yield (_slide(dyad.second, other, dyad.direction_2) if dyad.kind in ('RRP', 'RPP', 'PRP')
           else Connection(dyad.second.link, other, tuple(dyad.second[1:])))


def _inner(dyad: Any, one: str, other: str) -> Connection:
    """Return the connection of both links of a dyad; of a slide its carrier is the parent."""
    if dyad.kind == 'RRR':
        return Connection(one, other, (dyad.length_1, 0.0), (dyad.length_2, 0.0))
    if dyad.kind == 'RRP':
        return Connection(one, other, (dyad.length_1, 0.0))
    if dyad.kind == 'RPR':                         # the block on its bar
        return Connection(other, one, (0.0, dyad.offset), axis=X)
    if dyad.kind == 'RPP':                         # the block in the slot of its yoke
        return Connection(other, one, axis=direction(dyad.slot), turn=dyad.slot)
    return Connection(one, other)


def _slide(point: Any, link: str, angle: float) -> Connection:
    """Return the slide of a link through a point, along a line at an angle to the carrier."""
    return Connection(point.link, link, tuple(point[1:]), axis=direction(angle), turn=angle)
