# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Whether a dyad can be assembled: a number that tells.

A dyad closes where its *closing* is positive, a number without unit that vanishes at its toggles:

    (R1)  RRR: ((r1 + r2)^2 - q)(q - (r1 - r2)^2) / (r1 + r2)^4
    (R2)  RRP: (r1 - h)(r1 + h) / r1^2        RPR: (|d|^2 - h^2) / (a length)^2
    (R3)  PRP: t1 x t2, which may have either sign: a range ends where the lines are parallel

With a weighted d (:mod:`.far`) that of RPR is times the square of the weight.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.mechanisms.machine.description import CYLINDER, PRP, RPR, RRP, RRR
from fourbar_ros.mechanisms.machine.dyads import turned
from fourbar_ros.mechanisms.machine.frames import Frames
from fourbar_ros.mechanisms.machine.layout import Layout, Stage
from fourbar_ros.mechanisms.machine.loops import make_moves
from fourbar_ros.mechanisms.machine.motion import make_driver
from fourbar_ros.numerics.number_types import NumberType

CLOSING = (RRR, RRP, RPR, PRP)     # kinds that do not close at any input
Closing = Callable[[Any], Any]      # of an input, returns the closings of some dyads


def make_closing(n: NumberType, kind: str, numbers: Sequence[Any]) -> Callable[..., Any]:
    """Return the function (D, curves of the links it hangs on) -> closing of a dyad."""
    sizes, size = numbers[4:], sum(map(abs, numbers))

    def closing(apart: Sequence[Any], first: Any, second: Any) -> Any:
        if kind == PRP:
            (x1, y1), (x2, y2) = turned(first, *sizes[:2])[:2], turned(second, *sizes[2:])[:2]
            return x1 * y2 - y1 * x2
        x, y = apart[:2]
        q = x * x + y * y
        if len(apart) > 6:       # weighted: of a bar on a link that may run to infinity
            return (q - apart[6] * apart[6] * sizes[0] * sizes[0]) / (size * size)
        if kind == RRR:
            r1, r2 = sizes
            outer, inner = (r1 + r2) * (r1 + r2), (r1 - r2) * (r1 - r2)
            return (outer - q) / outer * ((q - inner) / outer)
        if kind == RRP:
            t_x, t_y = turned(second, *sizes[1:])[:2]
            h = (y * t_x - x * t_y) / sizes[0]
            return (1.0 - h) * (1.0 + h)
        return (q - sizes[0] * sizes[0]) / (size * size)
    return closing


def make_closings(n: NumberType, layout: Layout, numbers: Sequence[Any], signs: Sequence[Any],
                  count: int) -> Closing:
    """Return input -> closings of the first ``count`` dyads; 1 of those that have none."""
    driver, frames = make_driver(n, layout, numbers, signs), Frames(layout, numbers)
    work = [(moves, make_closing(n, stage.kind, its) if closes_somewhere(stage) else None)
            for stage, its, moves in list(zip(layout.stages, numbers, make_moves(
                n, layout, numbers, signs)))[:count]]

    def closings_at(x: Any) -> list[Any]:
        poses, found = frames.begin(driver(x)[0]), []
        for number, (moves, closing) in enumerate(work):
            hung = frames.hang(number, poses)
            found.append(closing(*hung[2:]) if closing else 1.0)
            if len(found) < count:
                frames.add(number, poses, moves(*hung))
        return found
    return closings_at


def closes_somewhere(stage: Stage) -> bool:
    """Return whether a dyad does not close at every input."""
    return stage.kind in CLOSING and stage.name != CYLINDER and stage.loop is None
