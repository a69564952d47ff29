# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Dyads that close a loop of four rods with a change point.

A dyad RRR between the crank and the ground is coupler and output link of a 4R linkage O1 P B Q.
Where its lengths make a change point, as those of a parallelogram, position and rates are 0/0 in
the flat positions; the formulas of the loop (:mod:`fourbar_ros.mechanisms.loop`) go through them
with all their digits. So they do along a chain of loops, each between the output link of the one
before and the ground, that lie flat together. With x the angle of O P seen from O Q, a half-angle

    (P1)  sin^2(x/2), cos^2(x/2):  the larger one (1 + |cos x|)/2, the other sin^2 x / 4 over it
    (P2)  angle' = angle'(x) x',   angle'' = angle''(x) x'^2 + angle'(x) x''
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import atan2, fsum, hypot, pi
from typing import Any

from fourbar_ros.mechanisms.loop import make_loop
from fourbar_ros.mechanisms.machine.description import CRANK_LINK, CYLINDER, GROUND, RRR
from fourbar_ros.mechanisms.machine.dyads import Curve, DyadMotion, MAKERS, MovesDyad, Node
from fourbar_ros.mechanisms.machine.layout import Layout, Loop
from fourbar_ros.numerics.number_types import NumberType

SAME = 1e-12      # [rad] of directions


def lengths_of_loop(loop: Loop, numbers: Sequence[Any], own: Sequence[Any],
                    length: Any = hypot) -> tuple[Any, ...]:
    """Return a1, a2, a3, a4 of a loop, and cosine and sine of O P on its link and of O Q."""
    pin, fixed, r1, r2 = own[:2], own[2:4], own[4], own[5]
    if not loop.turns_first:
        pin, fixed, r1, r2 = fixed, pin, r2, r1
    x, y = fixed
    if loop.pivot:
        number, place = loop.pivot
        x, y = x - numbers[number][place], y - numbers[number][place + 1]
    a1, a4 = length(*pin), length(x, y)
    per_1, per_4 = 1.0 / a1, 1.0 / a4
    return a1, r1, r2, a4, pin[0] * per_1, pin[1] * per_1, x * per_4, y * per_4


def flats_of(a1: float, a2: float, a3: float, a4: float) -> tuple[bool, bool] | None:
    """
    Return whether a linkage whose crank turns fully lies flat at x = 0, at x = pi.

    None where its crank does not turn fully or nowhere lies flat. By exact sums of lengths.
    """
    far = fsum((a2, a3, -a1, -a4))
    near = fsum((a1, -a4, -a2, a3)) * fsum((a1, -a4, a2, -a3))
    is_flat = far >= 0.0 and near >= 0.0 and not far * near
    return (near == 0.0, far == 0.0) if is_flat else None


def find_loops(dyads: Sequence[Any]) -> tuple[dict[int, Loop], tuple[float, ...]]:
    """
    Return {number of a dyad: its :class:`Loop`}, and the angles of the crank where all lie flat.

    Of machines whose driven link is a crank. The first decides where the others must lie flat.
    """
    numbers = [dyad.numbers for dyad in dyads]
    # of links that turn about a point of the ground: where that is, their angle less x
    pivots: dict[str, tuple[Any, float]] = {}
    found: dict[int, Loop] = {}
    places: tuple[float, ...] = ()
    for i, dyad in enumerate(dyads):
        for loop, link in _as_loops(dyad, pivots):
            try:
                *lengths, c1, s1, c4, s4 = lengths_of_loop(loop, numbers, numbers[i])
            except ZeroDivisionError:       # its pin or Q is at the pivot: it does not turn
                continue
            flats = flats_of(*lengths)
            line, turn = atan2(s4, c4), atan2(s1, c1) - atan2(s4, c4)
            if not found and flats:
                pivots[CRANK_LINK] = None, -turn
                first, places = flats, tuple([k * pi - turn for k in (0, 1) if flats[k]])
            shift = pivots.get(link, (None, -turn))[1] + turn
            half_turns = round(shift / pi)
            if not flats or abs(shift - half_turns * pi) > SAME or first != (
                    flats[::-1] if half_turns % 2 else flats):
                continue
            found[i] = loop
            if lengths[0] == lengths[2] and lengths[1] == lengths[3]:     # y = x on and on
                own, place = (1, 2) if loop.turns_first else (0, 0)
                pivots[dyad.links[own]] = (i, place), line
    return found, places


def _as_loops(dyad: Any, pivots: dict[str, Any]) -> Iterator[tuple[Loop, str]]:
    """Yield a dyad as a loop, and the link that turns it."""
    for turns_first, (turning, fixed) in ((True, (dyad.first, dyad.second)),
                                          (False, (dyad.second, dyad.first))):
        link = turning.link
        if dyad.kind == RRR and fixed.link == GROUND and (link == CRANK_LINK or link in pivots):
            yield Loop(turns_first, pivots.get(link, (None, 0.0))[0]), link


def make_loop_dyad(n: NumberType, sign: Any, loop: Loop, numbers: Sequence[Any],
                   own: Sequence[Any]) -> MovesDyad:
    """Return the motion of a dyad RRR as coupler and output link of its loop."""
    a1, a2, a3, a4, c1, s1, c4, s4 = lengths_of_loop(loop, numbers, own, n.hypot)
    side = 1.0 if loop.turns_first else -1.0
    turns, infinitesimal = make_loop(n, a1, a2, a3, a4, side * sign), n.infinitesimal
    fabs, where = n.fabs, n.where
    # of the link of the pin, seen from O Q
    cos_0, sin_0 = c1 * c4 + s1 * s4, s1 * c4 - c1 * s4

    def motion(at_p: Node, at_q: Node, _apart: Node, first: Curve, second: Curve) -> DyadMotion:
        cosine, sine, turn, bend = (first if loop.turns_first else second)[6:]
        cos_x = cosine * cos_0 - sine * sin_0
        sin_x = sine * cos_0 + cosine * sin_0 + infinitesimal
        large = 0.5 * (1.0 + fabs(cos_x))                                               # (P1)
        small = 0.25 * sin_x * sin_x / large
        ss, cc = where(cos_x.real > 0.0, (small, large), (large, small))
        (_, _, _, _, cos_b, sin_b, cos_y, sin_y, cos_mu, sin_mu, _, _, d_y, d_b, _, dd_y, dd_b,
         _) = turns(ss, cc, 0.5 * sin_x)
        square = turn * turn
        coupler = (cos_b * c4 - sin_b * s4, sin_b * c4 + cos_b * s4,                    # (P2)
                   d_b * turn, dd_b * square + d_b * bend)
        output = (cos_y * c4 - sin_y * s4, sin_y * c4 + cos_y * s4,
                  d_y * turn, dd_y * square + d_y * bend)
        one, two = (coupler, output) if loop.turns_first else (output, coupler)
        return (*at_p, *one), (*at_q, *two), (), side * sin_mu, cos_mu
    return motion


def make_moves(n: NumberType, layout: Layout, numbers: Sequence[Any],
               signs: Sequence[Any]) -> list[MovesDyad]:
    """Return the motions of all dyads."""
    return [MAKERS[stage.kind](n, 1.0 if stage.name == CYLINDER else sign, *own[4:])
            if stage.loop is None else make_loop_dyad(n, sign, stage.loop, numbers, own)
            for stage, own, sign in zip(layout.stages, numbers, signs)]


def with_loops(layout: Layout, dyads: Sequence[Any]) -> tuple[Layout, tuple[float, ...]]:
    """Return the layout of dyads with its loops, and the inputs at which they lie flat."""
    found, places = find_loops(dyads) if layout.driver == CRANK_LINK else ({}, ())
    return layout._replace(stages=tuple([
        stage._replace(loop=found.get(i)) for i, stage in enumerate(layout.stages)])), places
