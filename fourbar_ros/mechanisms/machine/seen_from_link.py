# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A machine driven at a link on the ground, in place of its crank: motion by torque through a toggle.

Where the dyad RRR between crank and ground is in line the crank turns back, and the dyad's link on
the ground goes on. Driven at that link, the rod and the crank are a dyad
themselves, from the pin B of the rods to O1:

    (O1)  B = Q + a3 e(p);   RRR of the rod, from B to P, and the crank, from O1 to P

All other dyads hang as before.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import hypot, pi, remainder
from typing import NoReturn

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.curves import Coefficients, FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.machine.solve.dyads import between, Driven, DyadMotion, ORIGIN, rrr
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.motion import EXACT
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves
from fourbar_ros.mechanisms.machine.structure import Layout, Numbers
from fourbar_ros.mechanisms.parts import Ranges
from fourbar_ros.numerics.number_types import NumberType, Scalar


class SeenFromLink:
    """
    A machine driven at a link on the ground, whose angle is the coordinate p [rad].

    ``layout``, ``numbers``, ``signs``: as for :func:`.motion.motion_of`; ``number``: of the dyad
    that has this link; ``mode`` 2: from the rod, B to P, to the crank, O1 to P, one turns left by
    less than pi, 1: right. It never lies flat.
    """

    change_point_margin, input_unit, is_driven_by_slide, turns_fully = 1.0, 1.0, False, False
    input_ranges: Ranges = ()
    flat_inputs: tuple[float, ...] = ()

    def __init__(self, layout: Layout, numbers: Sequence[Numbers], signs: Sequence[float],
                 number: int, mode: int) -> None:
        """Keep the structure, and which link of the dyad drives."""
        self._layout, self._numbers, self._signs = layout, numbers, signs
        self._number, self.mode = number, mode
        stage = layout.stages[number]
        self._is_rod_first = stage.second == 0      # the dyad's second link is then on the ground
        self._link = stage.number - 1 + int(self._is_rod_first)     # among the moving ones

    def in_mode(self, mode: int) -> SeenFromLink:
        """Return the same in another assembly mode."""
        return SeenFromLink(self._layout, self._numbers, self._signs, self._number, mode)

    def distance(self, one: float, other: float) -> float:
        """Return one angle less another, the short way round [rad]."""
        return remainder(one - other, 2.0 * pi)

    def mode_beyond(self, _limit: float) -> int:
        """Return the other mode."""
        return 3 - self.mode

    def motion(self, position: float, *_: float) -> NoReturn:
        """Refuse an angle at which the dyad does not close, which an integrator may try."""
        link = self._layout.moving[self._link]
        raise FourBarError(f'theta_{link} = {position!r}: the links do not close')

    def make_coefficients(self, numbers: NumberType) -> Coefficients:
        """Return p -> coefficients of all links, as those of a mechanism."""
        inverse, number = self._make_inverse(numbers), self._number
        hanging = hangings(self._layout, self._numbers)
        work = make_moves(numbers, self._layout, self._numbers, self._signs)

        def coefficients(position: Scalar) -> list[LinkMotion]:
            """Return the curves of all links: first crank and dyad, then the other dyads."""
            crank, one, two = inverse(position)
            poses, curves = Poses(hanging, Driven(crank, EXACT)), [crank]
            for i, moves in enumerate(work):
                moved = (DyadMotion(one, two, (), 1.0, 0.0, {}) if i == number
                         else moves(*poses.hang(i)))
                curves += poses.add(i, moved)
            return curves
        return coefficients

    def _make_inverse(self, n: NumberType
                      ) -> Callable[[Scalar], tuple[LinkMotion, LinkMotion, LinkMotion]]:
        """Return p -> curves of the crank and of both links of the dyad, (O1)."""
        own, is_rod_first = self._numbers[self._number], self._is_rod_first
        pin, at_q, (rod, output) = own.p, own.q, own.sizes
        if not is_rod_first:
            pin, at_q, rod, output = at_q, pin, output, rod
        length = hypot(*pin)
        sign = 1.0 if self.mode == 2 else -1.0
        sin, cos, c0, s0 = n.sin, n.cos, pin[0] / length, pin[1] / length

        def inverse(p: Scalar) -> tuple[LinkMotion, LinkMotion, LinkMotion]:
            driven = LinkMotion(*point_of(FIXED, *at_q), cos(p), sin(p), 1.0, 0.0)
            at_b = point_of(driven, output, 0.0)
            first, arm, *_ = rrr(n, sign, (rod, length), at_b, ORIGIN, between(at_b, ORIGIN),
                                 FIXED, FIXED)
            crank = LinkMotion(*ORIGIN, arm.cosine * c0 + arm.sine * s0,
                               arm.sine * c0 - arm.cosine * s0, arm.omega, arm.alpha)
            coupler = LinkMotion(*point_of(crank, *pin), -first.cosine, -first.sine,
                                 first.omega, first.alpha)
            return crank, *((coupler, driven) if is_rod_first else (driven, coupler))
        return inverse

    def read_coordinate(self, numbers: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        link = curves[self._link]
        return numbers.atan2(link.sine, link.cosine), link.omega, link.alpha
