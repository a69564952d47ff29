# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Which links each joint of a mechanism connects, and where: URDF and MJCF are made of it."""
from __future__ import annotations

from cmath import phase
from math import cos, pi, sin
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.four_bars import FourBar
from fourbar_ros.mechanisms.kind import Kind
from fourbar_ros.mechanisms.machine.description import ANGLES, Dyad
from fourbar_ros.mechanisms.machine.structure import DIMENSIONS
from fourbar_ros.mechanisms.parts import CRANK, GROUND, SLIDE
from fourbar_ros.numerics.number_types import direction

X = 1.0, 0.0        # direction of a slide


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


def connections_of(mechanism: Any) -> tuple[Connection, ...]:
    """Return the connections in the order of a mechanism's joints; the ground is never a child."""
    if isinstance(mechanism, Kind):
        connections, dyads = [Connection(GROUND, CRANK)], (_dyad_of(mechanism),)
    else:
        frame, driven, *_ = mechanism.layout.links
        connections = [Connection(frame, driven, axis=X if mechanism.input == SLIDE else None)]
        dyads = mechanism.stages
    dyad: Any                   # dimensions that its kind has are known: checked
    for dyad in dyads:
        connections += [
            joint.reversed() if joint.child == GROUND else joint
            for joint in (_end(dyad.first, dyad.links[0], dyad.direction_1, dyad.kind == 'PRP'),
                          _inner(dyad),
                          _end(dyad.second, dyad.links[1], dyad.direction_2,
                               dyad.kind in ('RRP', 'RPP', 'PRP')))]
    if isinstance(mechanism, Kind) and mechanism.FROM_HALF_A_TURN:      # that of the inner joint
        connections[2] = connections[2]._replace(turn=pi)
    return tuple(connections)


def _dyad_of(kind: Kind) -> Dyad:
    """Return the dyad of the machine that a kind is, driven at its crank as any other input."""
    drive = (kind if CRANK in kind.DRIVES else FourBar).DRIVES[CRANK]
    (stage,), lengths = drive.layout.stages, drive.lengths(*kind.lengths)
    sizes = iter(lengths.sizes)         # of a direction cosine and sine
    dimensions: dict[str, Any] = {
        name: phase(complex(next(sizes), next(sizes))) if name in ANGLES else next(sizes)
        for name in DIMENSIONS[stage.kind]}
    return Dyad('dyad', stage.kind, Point(CRANK, *lengths.p), Point(GROUND, *lengths.q),
                stage.links, **dimensions)


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
