# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A machine by the angle of another link than its crank: through the toggles of the crank.

Where the dyad RRR between crank and ground is in line the crank turns back, and the dyad's link on
the ground goes on. Driven at that link, the rod and the crank are a dyad themselves, from the pin
B of the rods to O1:

    (O1)  B = Q + a3 e(p);   RRR of the rod, from B to P, and the crank, from O1 to P

All other dyads hang as before.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import hypot
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.machine.description import Dyad, GROUND, RRR
from fourbar_ros.mechanisms.machine.dyads import (
    between,
    Curve,
    FIXED,
    make_rrr,
    node_of,
    ORIGIN,
)
from fourbar_ros.mechanisms.machine.frames import Frames
from fourbar_ros.mechanisms.machine.layout import Layout
from fourbar_ros.mechanisms.machine.loops import make_moves
from fourbar_ros.numerics.number_types import Function, NumberType


def can_drive(dyad: Dyad, driven: str) -> bool:
    """Return whether a dyad is one between the driven crank and the ground, away from O1."""
    ends = {dyad.first.link: dyad.first, dyad.second.link: dyad.second}
    return (dyad.kind == RRR and set(ends) == {driven, GROUND}
            and any(ends[driven][1:]) and any(ends[GROUND][1:]))


class SeenFromLink:
    """
    A machine whose coordinate p is the angle of a link on the ground [rad].

    Parameters
    ----------
    layout, numbers, signs
        As for :func:`.motion.make_motion`.
    number : int
        Of the dyad whose link on the ground it is.
    mode : int
        2: from the rod, B to P, to the crank, O1 to P, one turns left by less than pi; 1: right.

    """

    change_point_margin, input_unit, is_driven_by_slide, turns_fully = 1.0, 1.0, False, False

    def __init__(self, layout: Layout, numbers: Sequence[Any], signs: Sequence[Any], number: int,
                 mode: int) -> None:
        self._layout, self._numbers, self._signs = layout, numbers, signs
        self._number, self.mode = number, mode
        stage = layout.stages[number]
        self._turns_first = stage.second == 0
        self._link = stage.number - 1 + int(self._turns_first)     # among the moving ones

    def in_mode(self, mode: int) -> SeenFromLink:
        """Return the same in another assembly mode."""
        return SeenFromLink(self._layout, self._numbers, self._signs, self._number, mode)

    def motion(self, position: float, *_: float) -> Any:
        """Refuse an angle at which the dyad does not close, which an integrator may try."""
        link = self._layout.moving[self._link]
        raise FourBarError(f'theta_{link} = {position!r}: the links do not close')

    def make_coefficients(self, numbers: NumberType) -> Function:
        """Return p -> coefficients of all links, as those of a mechanism."""
        inverse, number = self._make_inverse(numbers), self._number
        frames = Frames(self._layout, self._numbers)
        work = make_moves(numbers, self._layout, self._numbers, self._signs)

        def coefficients(position: Any) -> list[Curve]:
            crank, one, two = inverse(position)
            poses, curves = frames.begin(crank), [crank]
            for i, moves in enumerate(work):
                moved = ((one, two, (), 1.0, 0.0) if i == number
                         else moves(*frames.hang(i, poses)))
                curves += frames.add(i, poses, moved)
            return curves
        return coefficients

    def _make_inverse(self, n: NumberType) -> Callable[[Any], tuple[Curve, Curve, Curve]]:
        """Return p -> curves of the crank and of both links of the dyad, (O1)."""
        own, turns_first = self._numbers[self._number], self._turns_first
        pin, at_q, rod, output = own[:2], own[2:4], own[4], own[5]
        if not turns_first:
            pin, at_q, rod, output = at_q, pin, output, rod
        length = hypot(*pin)
        moves = make_rrr(n, 1.0 if self.mode == 2 else -1.0, rod, length)
        sin, cos, c0, s0 = n.sin, n.cos, pin[0] / length, pin[1] / length

        def inverse(p: Any) -> tuple[Curve, Curve, Curve]:
            driven = (*node_of(FIXED, *at_q), cos(p), sin(p), 1.0, 0.0)
            at_b = node_of(driven, output, 0.0)
            (*_, c1, s1, d_rod, dd_rod), (*_, c2, s2, turn, bend), *_ = moves(
                at_b, ORIGIN, between(at_b, ORIGIN), FIXED, FIXED)
            crank = (*ORIGIN, c2 * c0 + s2 * s0, s2 * c0 - c2 * s0, turn, bend)
            coupler = (*node_of(crank, *pin), -c1, -s1, d_rod, dd_rod)
            return crank, *((coupler, driven) if turns_first else (driven, coupler))
        return inverse

    def read_coordinate(self, numbers: NumberType, curves: Any) -> tuple[Any, Any, Any]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        *_, cosine, sine, turn, bend = curves[self._link]
        return numbers.atan2(sine, cosine), turn, bend
