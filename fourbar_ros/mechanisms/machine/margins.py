# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Assembly margins: scalars whose signs tell whether dyads can be assembled.

A dyad closes where its *assembly margin* is positive, a number without unit that vanishes at its
toggles. That of a pair is in :mod:`.pairs`; of others

    (X1)  RRR: ((r1 + r2)^2 - q)(q - (r1 - r2)^2) / (r1 + r2)^4
    (X2)  RRP: (r1 - h)(r1 + h) / r1^2        RPR: (|d|^2 - h^2) / (|d|^2 + (a length)^2)
    (X3)  PRP: t1 x t2, which may have either sign: a range ends where the lines are parallel
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from fourbar_ros.mechanisms.machine.joined import PairRange
from fourbar_ros.mechanisms.machine.solve.dyads import Ends, Node, turned
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.motion import driven_link
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Stage
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

CLOSING = ('RRR', 'RRP', 'RPR', 'PRP')     # kinds that do not close at any input


def assembly_margin(n: NumberType, kind: str, lengths: DyadLengths, ends: Ends) -> Scalar:
    """
    Return a scalar that is positive where a dyad closes, zero at its toggles, by (X1) to (X3).

    Of dyads whose carriers are not joined to each other.
    """
    sizes = lengths.sizes
    if kind == 'PRP':
        (x1, y1), (x2, y2) = (turned(ends.first, *sizes[:2])[:2],
                              turned(ends.second, *sizes[2:])[:2])
        return x1 * y2 - y1 * x2
    node: Node = ends.apart
    x, y = node[:2]
    q = x * x + y * y
    if kind == 'RRR':
        r1, r2 = sizes
        outer, inner = (r1 + r2) * (r1 + r2), (r1 - r2) * (r1 - r2)
        return (outer - q) / outer * ((q - inner) / outer)
    if kind == 'RRP':
        t_x, t_y = turned(ends.second, *sizes[1:])[:2]
        h = (y * t_x - x * t_y) / sizes[0]
        return (1.0 - h) * (1.0 + h)
    size = sum(map(n.fabs, (*lengths.p, *lengths.q, *sizes)), start=0.0)
    return (q - sizes[0] * sizes[0]) / (q + size * size)


def make_assembly_margin(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                         signs: Sequence[Scalar], dyad: int,
                         converted: Sequence[DyadLengths] | None = None) -> Function:
    """
    Return input -> assembly margin of the dyad of this index.

    ``converted``: the ``dyad_lengths`` as the number type has them, if it is not one of floats.
    """
    stage, converted = layout.stages[dyad], dyad_lengths if converted is None else converted
    margin = (partial(PairRange(stage, dyad_lengths[dyad]).assembly_margin, n) if stage.pair
              else partial(assembly_margin, n, stage.kind, converted[dyad]))
    return make_along(n, layout, converted, signs, dyad, margin)


def make_square(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                signs: Sequence[Scalar], dyad: int) -> Function:
    """Return input -> |D|^2, scaled, of RRR or RPR; where it is zero, links have a pole."""
    stage, lengths = layout.stages[dyad], dyad_lengths[dyad]
    if stage.pair:
        return make_along(n, layout, dyad_lengths, signs, dyad,
                          partial(PairRange(stage, lengths).square, n))
    size = sum(map(abs, (*lengths.p, *lengths.q, *lengths.sizes)), start=0.0)

    def square(ends: Ends) -> Scalar:
        node: Node = ends.apart
        x, y = node[:2]
        return (x * x + y * y) / (size * size)
    return make_along(n, layout, dyad_lengths, signs, dyad, square)


def make_flatness(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                  signs: Sequence[Scalar], dyad: int) -> Function:
    """Return input -> (distance from a flat position, side) of the pair of this index."""
    flatness = PairRange(layout.stages[dyad], dyad_lengths[dyad]).flatness
    return make_along(n, layout, dyad_lengths, signs, dyad, lambda ends: flatness(ends.relative))


def make_along(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
               signs: Sequence[Scalar], dyad: int,
               measure: Callable[[Ends], Any]) -> Function:
    """Return input -> the measure of the ends of a dyad, which may be unable to close."""
    hanging = hangings(n, layout, dyad_lengths, signs)

    def along(x: Scalar) -> Any:
        poses = Poses(hanging, driven_link(n, layout, dyad_lengths, signs, x))
        for before in range(dyad):
            poses.add(before)
        return measure(poses.ends(dyad))
    return along


def has_toggles(stage: Stage, lengths: DyadLengths) -> bool:
    """Return whether a dyad has toggles, at real or at complex inputs."""
    if stage.pair:
        return PairRange(stage, lengths).has_toggles
    return stage.kind in CLOSING and stage.name != CYLINDER
