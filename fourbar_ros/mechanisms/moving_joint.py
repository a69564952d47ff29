# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The four-bar driven at A or B, between two moving links.

>>> linkage = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input='A')
>>> motion = linkage.motion(-0.5, 2.0)
>>> print(f'{motion.theta1:.6f} {motion.theta4:.6f} rad, {motion.omega1:.6f} rad/s')
0.835757 1.045407 rad, -1.807550 rad/s
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fourbar_ros.mechanics.bodies import Bodies, External, Gravity
from fourbar_ros.mechanisms.closed_forms import (
    four_bar_ranges,
    singular_angles,
    turned_angles,
    turned_ranges,
)
from fourbar_ros.mechanisms.four_bars import condition_of_rods, FourBar, FourBarLinks, two_rods
from fourbar_ros.mechanisms.kind import DrivenMachine, results
from fourbar_ros.mechanisms.parts import (
    BETA,
    GROUND,
    JOINT_A,
    JOINT_B,
    OPEN,
    Output,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
)
from fourbar_ros.numerics.number_types import NumberType


@dataclass(frozen=True)
class MovingJointFourBar(FourBarLinks):
    """
    Planar four-bar linkage O1-A-B-O4 that is driven at A or at B, between two moving links.

    Parameters
    ----------
    a1, a2, a3, a4 : float
        As of :class:`~FourBar`.
    mode : int
        Assembly mode: 2 has sin(theta4) > 0 of a drive at A, sin(theta1) > 0 of one at B; 1 < 0.
    input : str
        'A': theta2, coupler to crank, is given; 'B': theta3, output link to coupler.
    bodies : Bodies, optional
        Masses; without them there are no loads.
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on the links.

    Its ``driving_torque`` acts on the coupler from the crank (A), or on the output link from the
    coupler (B).

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = OPEN
    input: str = JOINT_A
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()

    MODES = {1: '1', OPEN: '2'}
    INPUTS = {JOINT_A: THETA2, JOINT_B: THETA3}
    OUTPUTS = {joint: (Output(THETA4, 'velocity_ratio'), Output(THETA1, 'crank_ratio'))
               for joint in INPUTS}
    RATIOS = {'velocity_ratio': THETA4, 'coupler_ratio': BETA, 'crank_ratio': THETA1}
    DRIVES = {
        JOINT_A: DrivenMachine(
            ('crank', 'coupler', 'output', GROUND), 'RRR',
            lambda lengths: two_rods(lengths[1], lengths[0], lengths[2], lengths[3]),
            lambda a1, a2, a3, a4: turned_ranges(four_bar_ranges(a2, a3, a4, a1)),
            lambda a1, a2, a3, a4: turned_angles(singular_angles(a2, a3, a4, a1)),
            {'f41': ('second', -1.0), 'f21': ('base', -1.0), 'f32': ('first', -1.0),
             'f43': ('inner', 1.0)},
            ('sin_y', 1.0), lambda f, a, d, _: condition_of_rods(
                f, (a[1], a[0], a[2], a[3]), d[THETA3][0], d[THETA4],
                d[THETA1][0] * d[THETA4][0] + d[THETA1][1] * d[THETA4][1]),
            reversed=('crank', 'output'), turn=-1.0),
        JOINT_B: DrivenMachine(
            ('coupler', 'output', GROUND, 'crank'), 'RRR',
            lambda lengths: two_rods(lengths[2], lengths[1], lengths[3], lengths[0]),
            lambda a1, a2, a3, a4: turned_ranges(four_bar_ranges(a3, a4, a1, a2)),
            lambda a1, a2, a3, a4: turned_angles(singular_angles(a3, a4, a1, a2)),
            {'f41': ('inner', -1.0), 'f21': ('second', 1.0), 'f32': ('base', -1.0),
             'f43': ('first', -1.0)},
            ('sin_x', 1.0), lambda f, a, d, _: condition_of_rods(
                f, (a[2], a[1], a[3], a[0]), d[THETA4][0], d[THETA1], d[BETA][0]),
            reversed=('coupler', 'output', GROUND, 'crank'), turn=-1.0)}

    @property
    def description(self) -> str:
        """Return a short text: type, input."""
        return f'{self.classification}, driven at its joint {self.input}'

    @property
    def TORQUE(self) -> str:        # type: ignore[override]  # of each input  # noqa: N802
        """Return the symbol of the torque: of crank on coupler, of coupler on output link."""
        return 'T_{12}' if self.input == JOINT_A else 'T_{23}'

    def driven_otherwise(self) -> tuple[FourBar, ...]:
        """Return the same links driven at the crank, which goes on at toggles of this drive."""
        a1, a2, a3, a4 = self.lengths
        return tuple(FourBar(a1, a2, a3, a4, mode, self.bodies, self.gravity, self.external)
                     for mode in FourBar.MODES)

    def read_coordinate(self, n: NumberType, curves: Any) -> tuple[Any, Any, Any]:
        """Return theta2 or theta3 and two derivatives by the input; ``curves`` of the links."""
        # angle of the second link to the first; theta3 counts from B A, half a turn on
        first, side = (0, 1.0) if self.input == JOINT_A else (1, -1.0)
        turns_from, turns = curves[first:first + 2]
        sine = turns.sine * turns_from.cosine - turns.cosine * turns_from.sine
        cosine = turns.cosine * turns_from.cosine + turns.sine * turns_from.sine
        return (n.atan2(side * sine, side * cosine),
                turns.omega - turns_from.omega, turns.alpha - turns_from.alpha)


results(MovingJointFourBar, 'MovingJointMotion', 'Loads')
