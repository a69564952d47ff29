# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A machine driven at a link on the ground, in place of its crank: motion by torque through a toggle.

Where the dyad RRR between crank and ground is in line the crank turns back, and the dyad's link on
the ground goes on. Driven at that link, which turns about Q, the rod and the crank are the dyad of
a loop of four rods (:mod:`..loop`) with the ground line from Q to O1, and P the pin of the crank:

    (O1)  a1 = |B - Q|,   a2 = |P - B|,   a3 = |P - O1|,   a4 = |O1 - Q|

All other dyads hang as before.
"""
from collections.abc import Callable, Sequence
from math import hypot
from typing import NoReturn

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.curves import Coefficients, FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.loop import HalfAngle, loop
from fourbar_ros.mechanisms.machine.solve.dyads import Driven, DyadMotion, ORIGIN
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.motion import EXACT
from fourbar_ros.mechanisms.machine.solve.pairs import half_angle, turned_by
from fourbar_ros.mechanisms.machine.structure import DyadLengths, Layout
from fourbar_ros.numerics.number_types import NumberType, REAL, Scalar


class SeenFromLink:
    """A machine driven at a link on the ground, whose angle is the coordinate p [rad]."""

    # layout, dyad_lengths, signs: as for motion_of(); dyad: index of the dyad that has this link;
    # mode 2: from the rod, B to P, to the crank, O1 to P, the turn is to the left by less than pi,
    # 1: to the right; of a change point the sign of R, (M13).
    input_unit = 1.0

    def __init__(self, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                 signs: Sequence[float], dyad: int, mode: int) -> None:
        self._layout, self._dyad_lengths, self._signs = layout, dyad_lengths, signs
        self._dyad, self.mode = dyad, mode
        stage = layout.stages[dyad]
        self._is_rod_first = stage.second == 0      # the dyad's second link is then on the ground
        self._link = stage.link - 1 + int(self._is_rod_first)     # among the moving ones

    def motion(self, position: float, *_: float) -> NoReturn:
        """Refuse an angle at which the dyad does not close, which an integrator may try."""
        link = self._layout.moving[self._link]
        raise FourBarError(f'theta_{link} = {position!r}: the links do not close')

    def make_coefficients(self, n: NumberType) -> Coefficients:
        """Return p -> coefficients of all links, as those of a mechanism."""
        inverse = self._make_inverse(n)
        hanging = hangings(n, self._layout, self._dyad_lengths, self._signs)

        def coefficients(position: Scalar) -> list[LinkMotion]:
            crank, first, second = inverse(position)
            poses, curves = Poses(hanging, Driven(crank, EXACT)), [crank]
            for i in range(len(hanging)):
                curves += poses.add(i, DyadMotion(first, second, (), 1.0, 0.0, {})
                                    if i == self._dyad else None)
            return curves
        return coefficients

    def _make_inverse(self, n: NumberType
                      ) -> Callable[[Scalar], tuple[LinkMotion, LinkMotion, LinkMotion]]:
        """Return p -> curves of the crank and of both links of the dyad, (O1)."""
        lengths, is_rod_first = self._dyad_lengths[self._dyad], self._is_rod_first
        pin, at_q, (rod, output) = lengths.p, lengths.q, lengths.sizes
        if not is_rod_first:
            pin, at_q, rod, output = at_q, pin, output, rod
        arm, ground = hypot(*pin), hypot(*at_q)
        # directions of the ground line, Q to O1, and of the crank from the arm of its pin
        of_ground, of_arm = (-at_q[0] / ground, -at_q[1] / ground), (pin[0] / arm, -pin[1] / arm)
        ground_back = half_angle(REAL, of_ground[0], -of_ground[1], False)     # - its angle / 2
        back = ground_back.cosine, ground_back.sine
        sign = 1.0 if self.mode == 2 else -1.0

        def inverse(p: Scalar) -> tuple[LinkMotion, LinkMotion, LinkMotion]:
            """Return the curves of the crank and of both links of the dyad at p."""
            # half angles tell odd turns of p from even ones, as branches of change points need
            from_ground = HalfAngle.of(*turned_by((n.cos(0.5 * p), n.sin(0.5 * p)), back))
            bars = loop(n, (output, rod, arm, ground), sign, from_ground)
            toward = turned_by(turned_by(bars.y[:2], of_ground), of_arm)
            crank = LinkMotion(*ORIGIN, *toward, *bars.y[2:])
            # the bars run from Q over P to O1: the rod, B to P, lies the opposite way
            cos_b, sin_b, *changes = bars.b
            along = turned_by((-cos_b, -sin_b), of_ground)
            coupler = LinkMotion(*point_of(crank, *pin), *along, *changes)
            driven = LinkMotion(*point_of(FIXED, *at_q), n.cos(p), n.sin(p), 1.0, 0.0)
            return crank, *((coupler, driven) if is_rod_first else (driven, coupler))
        return inverse

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        link = curves[self._link]
        return n.atan2(link.sine, link.cosine), link.omega, link.alpha
