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
from fourbar_ros.mechanisms.machine.solve.dyads import (
    between,
    Driven,
    DyadMotion,
    Ends,
    ORIGIN,
    rrr,
)
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.motion import EXACT
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves
from fourbar_ros.mechanisms.machine.structure import DyadLengths, Layout
from fourbar_ros.mechanisms.parts import Ranges
from fourbar_ros.numerics.number_types import NumberType, Scalar


class SeenFromLink:
    """
    A machine driven at a link on the ground, whose angle is the coordinate p [rad].

    ``layout``, ``dyad_lengths``, ``signs``: as for :func:`.motion.motion_of`; ``dyad``: index of
    the dyad that has this link; ``mode`` 2: from the rod, B to P, to the crank, O1 to P, the turn
    is to the left by less than pi, 1: to the right. It never lies flat.
    """

    change_point_margin, input_unit, is_driven_by_slide, turns_fully = 1.0, 1.0, False, False
    input_ranges: Ranges = ()
    flat_inputs: tuple[float, ...] = ()

    def __init__(self, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                 signs: Sequence[float], dyad: int, mode: int) -> None:
        """Keep the structure, and which link of the dyad drives."""
        self._layout, self._dyad_lengths, self._signs = layout, dyad_lengths, signs
        self._dyad, self.mode = dyad, mode
        stage = layout.stages[dyad]
        self._is_rod_first = stage.second == 0      # the dyad's second link is then on the ground
        self._link = stage.link - 1 + int(self._is_rod_first)     # among the moving ones

    def in_mode(self, mode: int) -> SeenFromLink:
        """Return the same in another assembly mode."""
        return SeenFromLink(self._layout, self._dyad_lengths, self._signs, self._dyad, mode)

    def distance(self, first: float, second: float) -> float:
        """Return the first angle less the second, the short way round [rad]."""
        return remainder(first - second, 2.0 * pi)

    def mode_beyond(self, _limit: float) -> int:
        """Return the other mode."""
        return 3 - self.mode

    def motion(self, position: float, *_: float) -> NoReturn:
        """Refuse an angle at which the dyad does not close, which an integrator may try."""
        link = self._layout.moving[self._link]
        raise FourBarError(f'theta_{link} = {position!r}: the links do not close')

    def make_coefficients(self, n: NumberType) -> Coefficients:
        """Return p -> coefficients of all links, as those of a mechanism."""
        inverse, hanging = self._make_inverse(n), hangings(self._layout, self._dyad_lengths)
        moves = make_moves(n, self._layout, self._dyad_lengths, self._signs)

        def coefficients(position: Scalar) -> list[LinkMotion]:
            """Return the curves of all links: crank, this dyad as it is driven, other dyads."""
            crank, first, second = inverse(position)
            poses, curves = Poses(hanging, Driven(crank, EXACT)), [crank]
            for i, moves_dyad in enumerate(moves):
                moved = (DyadMotion(first, second, (), 1.0, 0.0, {}) if i == self._dyad
                         else moves_dyad(poses.hang(i)))
                curves += poses.add(i, moved)
            return curves
        return coefficients

    def _make_inverse(self, n: NumberType
                      ) -> Callable[[Scalar], tuple[LinkMotion, LinkMotion, LinkMotion]]:
        """Return p -> curves of the crank and of both links of the dyad, (O1)."""
        lengths, is_rod_first = self._dyad_lengths[self._dyad], self._is_rod_first
        pin, at_q, (rod, output) = lengths.p, lengths.q, lengths.sizes
        if not is_rod_first:
            pin, at_q, rod, output = at_q, pin, output, rod
        length = hypot(*pin)
        sign = 1.0 if self.mode == 2 else -1.0
        sin, cos, c0, s0 = n.sin, n.cos, pin[0] / length, pin[1] / length

        def inverse(p: Scalar) -> tuple[LinkMotion, LinkMotion, LinkMotion]:
            driven = LinkMotion(*point_of(FIXED, *at_q), cos(p), sin(p), 1.0, 0.0)
            at_b = point_of(driven, output, 0.0)
            first, arm, *_ = rrr(n, sign, (rod, length), Ends(
                at_b, ORIGIN, between(at_b, ORIGIN), None, None, FIXED, FIXED))
            crank = LinkMotion(*ORIGIN, arm.cosine * c0 + arm.sine * s0,
                               arm.sine * c0 - arm.cosine * s0, arm.omega, arm.alpha)
            coupler = LinkMotion(*point_of(crank, *pin), -first.cosine, -first.sine,
                                 first.omega, first.alpha)
            return crank, *((coupler, driven) if is_rod_first else (driven, coupler))
        return inverse

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        link = curves[self._link]
        return n.atan2(link.sine, link.cosine), link.omega, link.alpha
