# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Which links each joint of a mechanism connects, and where: URDF and MJCF are made of it."""
from __future__ import annotations

from functools import singledispatch
from math import cos, pi, sin
from typing import Any, NamedTuple

from fourbar_ros.mechanisms import four_bars, sliders
from fourbar_ros.mechanisms.parts import GROUND, SLIDE
from fourbar_ros.numerics.number_types import direction

X, Y = (1.0, 0.0), (0.0, 1.0)       # directions of slides


class Connection(NamedTuple):
    """
    Which two links a joint connects, and where.

    Joints are at ``on_parent`` and ``on_child``, along each link from its first joint and across
    to its left [m]. With the coordinate q of the joint, the angle of the child is that of the
    parent plus ``turn`` [rad], plus q of a joint that turns. A joint that slides has moved on the
    child from its point on the parent by q along ``axis``, a unit vector in the parent's frame.
    """

    parent: str
    child: str
    on_parent: tuple[float, float] = (0.0, 0.0)
    on_child: tuple[float, float] = (0.0, 0.0)
    axis: tuple[float, float] | None = None
    turn: float = 0.0

    def pose(self, q: float) -> tuple[float, float, float]:
        """Return (x, y, angle) of the child's frame in the parent's at a coordinate."""
        (x, y), turn = self.on_parent, self.turn
        if self.axis is None:
            turn += q
        else:
            x, y = x + q * self.axis[0], y + q * self.axis[1]
        if any(self.on_child):
            (along, across), (c, s) = self.on_child, direction(turn)
            x, y = x - (along * c - across * s), y - (along * s + across * c)
        return x, y, turn

    def reversed(self) -> Connection:
        """Return the same joint with parent and child exchanged; a pin has -q then."""
        c, s = cos(self.turn), sin(self.turn)
        axis = self.axis and (-c * self.axis[0] - s * self.axis[1],
                              s * self.axis[0] - c * self.axis[1])
        return Connection(self.child, self.parent, self.on_child, self.on_parent, axis, -self.turn)


@singledispatch
def connections_of(mechanism: Any) -> tuple[Connection, ...]:
    """
    Return the connections in the order of a mechanism's joints; the ground is never a child.

    Each kind has a function below. This one is of machines.
    """
    frame, driven, *_ = mechanism.layout.links
    connections = [Connection(frame, driven, axis=X if mechanism.input == SLIDE else None)]
    for dyad in mechanism.stages:       # dimensions that its kind has are known: checked
        connections += [
            joint.reversed() if joint.child == GROUND else joint
            for joint in (_end(dyad.first, dyad.links[0], dyad.direction_1, dyad.kind == 'PRP'),
                          _inner(dyad),
                          _end(dyad.second, dyad.links[1], dyad.direction_2,
                               dyad.kind in ('RRP', 'RPP', 'PRP')))]
    return tuple(connections)


def _end(point: Any, link: str, angle: float, slides: bool) -> Connection:
    pin = Connection(point.link, link, tuple(point[1:]))
    return pin._replace(axis=direction(angle), turn=angle) if slides else pin


def _inner(dyad: Any) -> Connection:
    """Return the joint between the two links of a dyad; an axis is in the frame of its parent."""
    first, second = dyad.links
    if dyad.kind == 'RRR':                         # the ends of both links
        return Connection(first, second, (dyad.length_1, 0.0), (dyad.length_2, 0.0))
    if dyad.kind == 'RRP':                         # the end of the rod on the slider
        return Connection(first, second, (dyad.length_1, 0.0))
    if dyad.kind == 'RPR':                         # the block on its bar
        return Connection(second, first, (0.0, dyad.offset), axis=X)
    if dyad.kind == 'RPP':                         # the block in the slot of its yoke
        return Connection(second, first, axis=direction(dyad.slot), turn=dyad.slot)
    return Connection(first, second)               # PRP: the pin of both sliders


O1 = Connection(GROUND, 'crank')        # of every kind


@connections_of.register(four_bars.FourBarLinks)
def _four_bar(mechanism: four_bars.FourBarLinks) -> tuple[Connection, ...]:
    return (O1, Connection('crank', 'coupler', (mechanism.a1, 0.0)),
            Connection('coupler', 'output', (mechanism.a2, 0.0), (mechanism.a3, 0.0), turn=pi),
            Connection(GROUND, 'output', (mechanism.a4, 0.0)))


@connections_of.register(sliders.SliderCrank)
def _slider_crank(mechanism: sliders.SliderCrank) -> tuple[Connection, ...]:
    return (O1, Connection('crank', 'coupler', (mechanism.a1, 0.0)),
            Connection('coupler', 'output', (mechanism.a2, 0.0)),
            Connection(GROUND, 'output', (0.0, mechanism.offset), axis=X))


@connections_of.register(sliders.InvertedSlider)
def _inverted_slider(mechanism: sliders.InvertedSlider) -> tuple[Connection, ...]:
    return (O1, Connection('crank', 'coupler', (mechanism.a1, 0.0)),
            Connection('output', 'coupler', (0.0, mechanism.offset), axis=X),
            Connection(GROUND, 'output', (mechanism.a4, 0.0)))


@connections_of.register(sliders.ScotchYoke)
def _scotch_yoke(mechanism: sliders.ScotchYoke) -> tuple[Connection, ...]:
    return (O1, Connection('crank', 'coupler', (mechanism.a1, 0.0)),
            Connection('output', 'coupler', axis=Y, turn=0.5 * pi),      # the slot, along y
            Connection(GROUND, 'output', (0.0, mechanism.offset), axis=X))
