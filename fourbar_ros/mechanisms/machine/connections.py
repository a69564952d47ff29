# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Which links the joints of a machine connect, and where: three of each dyad."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from fourbar_ros.mechanisms.machine.description import (
    direction,
    Dyad,
    PRP,
    RPP,
    RPR,
    RRP,
    RRR,
    SLIDER_LINK,
)
from fourbar_ros.mechanisms.parts import Connection, GROUND

X = (1.0, 0.0)


def connections_of(driven: str, stages: Sequence[Dyad]) -> tuple[Connection, ...]:
    """Return the connections in the order of a machine's joints."""
    base = Connection(GROUND, driven, axis=X if driven == SLIDER_LINK else None)
    return (base, *(its for stage in stages for its in _of_dyad(stage)))


def _of_dyad(dyad: Any) -> Iterator[Connection]:     # its kind has these dimensions: checked
    """Yield those of the first, the inner and the second joint."""
    one, other = dyad.links
    yield (_slide(dyad.first, one, dyad.direction_1) if dyad.kind == PRP
           else Connection(dyad.first.link, one, tuple(dyad.first[1:])))
    yield _inner(dyad, one, other)
    yield (_slide(dyad.second, other, dyad.direction_2) if dyad.kind in (RRP, RPP, PRP)
           else Connection(dyad.second.link, other, tuple(dyad.second[1:])))


def _inner(dyad: Any, one: str, other: str) -> Connection:
    if dyad.kind == RRR:
        return Connection(one, other, (dyad.length_1, 0.0), (dyad.length_2, 0.0))
    if dyad.kind == RRP:
        return Connection(one, other, (dyad.length_1, 0.0))
    if dyad.kind == RPR:                         # the block on its bar
        return Connection(other, one, (0.0, dyad.offset), axis=X)
    if dyad.kind == RPP:                         # the block in the slot of its yoke
        return Connection(other, one, axis=direction(dyad.slot), turn=dyad.slot)
    return Connection(one, other)


def _slide(point: Any, link: str, angle: float) -> Connection:
    """Return the slide of a link through a point, along a line at an angle to the carrier."""
    return Connection(point.link, link, tuple(point[1:]), axis=direction(angle), turn=angle)
