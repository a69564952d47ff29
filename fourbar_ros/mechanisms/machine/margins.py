# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Assembly margins: numbers whose signs tell whether dyads can be assembled.

A dyad closes where its *assembly margin* is positive, a number without unit that vanishes at its
toggles. That of a pair is in :mod:`.pairs`; of others

    (R1)  RRR: ((r1 + r2)^2 - q)(q - (r1 - r2)^2) / (r1 + r2)^4
    (R2)  RRP: (r1 - h)(r1 + h) / r1^2        RPR: (|d|^2 - h^2) / (|d|^2 + (a length)^2)
    (R3)  PRP: t1 x t2, which may have either sign: a range ends where the lines are parallel
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.machine.joined import PairRange
from fourbar_ros.mechanisms.machine.solve.dyads import turned
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.motion import driven_link
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves
from fourbar_ros.mechanisms.machine.structure import CYLINDER, Layout, Numbers, Stage
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

CLOSING = ('RRR', 'RRP', 'RPR', 'PRP')     # kinds that do not close at any input


def assembly_margin(n: NumberType, kind: str, own: Numbers, apart: Sequence[Scalar],
                    first: LinkMotion, second: LinkMotion) -> Scalar:
    """
    Return a number that is positive where a dyad closes, zero at its toggles, by (R1) to (R3).

    ``apart``: D; ``first``, ``second``: curves of the links it hangs on.
    """
    sizes, size = own.sizes, sum(map(n.fabs, (*own.p, *own.q, *own.sizes)), start=0.0)
    if kind == 'PRP':
        (x1, y1), (x2, y2) = turned(first, *sizes[:2])[:2], turned(second, *sizes[2:])[:2]
        return x1 * y2 - y1 * x2
    x, y = apart[:2]
    q = x * x + y * y
    if kind == 'RRR':
        r1, r2 = sizes
        outer, inner = (r1 + r2) * (r1 + r2), (r1 - r2) * (r1 - r2)
        return (outer - q) / outer * ((q - inner) / outer)
    if kind == 'RRP':
        t_x, t_y = turned(second, *sizes[1:])[:2]
        h = (y * t_x - x * t_y) / sizes[0]
        return (1.0 - h) * (1.0 + h)
    return (q - sizes[0] * sizes[0]) / (q + size * size)


def make_assembly_margin(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
                         signs: Sequence[Scalar], number: int,
                         given: Sequence[Numbers] | None = None) -> Function:
    """
    Return input -> assembly margin of dyad ``number``.

    ``given``: the ``numbers`` as the number type has them, if it is not one of floats.
    """
    stage, given = layout.stages[number], numbers if given is None else given
    margin = (partial(PairRange(stage, numbers[number]).assembly_margin, n) if stage.pair
              else partial(assembly_margin, n, stage.kind, given[number]))
    return make_along(n, layout, given, signs, number, margin)


def make_square(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
                signs: Sequence[Scalar], number: int) -> Function:
    """Return input -> |D|^2, scaled, of RRR or RPR; where it is zero, links have a pole."""
    stage, own = layout.stages[number], numbers[number]
    size = sum(map(abs, (*own.p, *own.q, *own.sizes)), start=0.0)

    def square(apart: Sequence[Scalar], *_: LinkMotion) -> Scalar:
        return (apart[0] * apart[0] + apart[1] * apart[1]) / (size * size)
    return make_along(n, layout, numbers, signs, number, partial(
        PairRange(stage, own).square, n) if stage.pair else square)


def make_place(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
               signs: Sequence[Scalar], number: int,
               given: Sequence[Numbers] | None = None) -> Function:
    """
    Return input -> (distance from a flat position, side) of pair ``number``.

    ``given``: as for :func:`make_assembly_margin`.
    """
    place = PairRange(layout.stages[number], numbers[number]).place
    return make_along(n, layout, numbers if given is None else given, signs, number,
                      lambda relative, _first, _second: place(relative))


def make_along(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
               signs: Sequence[Scalar], number: int, measure: Function) -> Function:
    """
    Return input -> the measure of dyad ``number``, which may be unable to close.

    ``measure``: takes D (of a pair its angle or slide) and the curves of the links it hangs on.
    """
    hanging, moves = hangings(layout, numbers), make_moves(n, layout, numbers, signs)

    def along(x: Scalar) -> Any:
        poses = Poses(hanging, driven_link(n, layout, numbers, signs, x))
        for before in range(number):
            poses.add(before, moves[before](*poses.hang(before)))
        return measure(*poses.hang(number)[2:])
    return along


def has_toggles(stage: Stage, own: Numbers) -> bool:
    """Return whether a dyad has toggles, at real or at complex inputs."""
    if stage.pair:
        return PairRange(stage, own).has_toggles
    return stage.kind in CLOSING and stage.name != CYLINDER
