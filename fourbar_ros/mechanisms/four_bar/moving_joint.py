# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The 4R linkage driven at a joint that moves: a motor at A on the crank, or at B on the coupler.

Held at another link it is a four-bar with a driven crank, so that its loop
(:mod:`fourbar_ros.mechanisms.loop`) serves. Held at the crank the coupler turns about A, by
theta2 + pi from A O1; held at the coupler the output link turns about B, by theta3 + pi from B A:

    (J1)  at A:  a2, a3, a4, a1 at X = theta2 - pi:   theta1 = -pi - Y,   theta4 = -pi - (Y - B)
    (J2)  at B:  a3, a4, a1, a2 at X = theta3 - pi:   theta2 = -Y,   beta = -B,   theta1 = Y - B

with Y, B the angles of that loop's output link and coupler. Both toggles of the pose are then
where output link and ground, or ground and crank are in line: sin(theta4) or sin(theta1) is zero,
and its sign is the assembly mode.

>>> linkage = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input='A')
>>> motion = linkage.motion(-0.5, 2.0)
>>> print(f'{motion.theta1:.6f} {motion.theta4:.6f} rad, {motion.omega1:.6f} rad/s')
0.835757 1.045407 rad, -1.807550 rad/s
"""
from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanisms.contract import Constants, JOINT_A, JOINT_B, of_geometry, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import (
    FourBar,
    FourBarLinks,
    ranges_of,
    singular_angles,
    turned_ranges,
)
from fourbar_ros.mechanisms.loop import make_loop
from fourbar_ros.mechanisms.parts import Output, Ranges, THETA1, THETA2, THETA3, THETA4
from fourbar_ros.numerics.number_types import Function, nudge, NumberType, Scalar


class MovingJointMotion(NamedTuple):
    """
    Pose, rates and accelerations, as :class:`~fourbar_ros.mechanisms.four_bar.motion.Motion`.

    Ratios are per unit of the driven joint, theta2 or theta3; ``transmission_angle`` is the angle
    at O4 between output link and ground for A, at O1 between ground and crank for B.
    """

    theta1: float
    omega1: float
    alpha1: float
    theta2: float
    omega2: float
    alpha2: float
    theta3: float
    omega3: float
    alpha3: float
    theta4: float
    omega4: float
    alpha4: float
    beta: float
    omega_beta: float
    alpha_beta: float
    transmission_angle: float
    velocity_ratio: float        # d theta4 / d input
    coupler_ratio: float         # d beta / d input
    crank_ratio: float           # d theta1 / d input
    condition: float             # relative error of the lengths -> that of theta1, theta2 [rad]
    cos_x: float
    sin_x: float
    cos_b: float
    sin_b: float
    cos_y: float
    sin_y: float
    cos_mu: float
    sin_mu: float


def make_motion_at(n: NumberType, lengths: tuple[Scalar, ...], sign: Scalar,
                   joint: str) -> Function:
    """Return (theta, omega, alpha) of a joint -> motion; sign: of sin(theta4) (A), theta1 (B)."""
    sin, cos, atan2 = n.sin, n.cos, n.atan2
    first, second, third, held = seen_lengths(lengths, joint)
    # infinitesimal where the links lie flat at theta = 0, X = -pi, for the pose just beside it
    beside_0 = nudge(n, n.exact_sum((first, held, -second, -third)))
    loop = make_loop(n, first, second, third, held, sign)

    def motion(theta: Scalar, omega: Scalar, alpha: Scalar) -> MovingJointMotion:
        """Return the motion by (J1) or (J2); x, b, y: (slope, bend) of theta1, beta, theta4."""
        sh, ch = sin(0.5 * theta) + beside_0, cos(0.5 * theta)
        at = loop(ch * ch, sh * sh, -sh * ch)               # of X = theta - pi
        square, facing = omega * omega, atan2(at.sin_mu, at.cos_mu)

        def rates(slope: Scalar, bend: Scalar) -> tuple[Scalar, Scalar]:
            """Return rate and acceleration of an angle by its derivatives by theta."""
            return slope * omega, slope * alpha + bend * square
        if joint == JOINT_A:                                                            # (J1)
            cos_x, sin_x, cos_y, sin_y = -at.cos_y, at.sin_y, -at.cos_mu, at.sin_mu
            cos_b = at.cos_x * at.cos_y + at.sin_x * at.sin_y       # of X - Y
            sin_b = at.sin_x * at.cos_y - at.cos_x * at.sin_y
            cos_3, sin_3 = at.cos_bx, at.sin_bx
            x, b, y = (-at.d_y, -at.dd_y), (1.0 - at.d_y, -at.dd_y), (-at.d_mu, -at.dd_mu)
            two = theta, omega, alpha
            three = (atan2(sin_3, cos_3), *rates(at.d_bx, at.dd_b))
        else:                                                                           # (J2)
            cos_x, sin_x, cos_b, sin_b = at.cos_mu, at.sin_mu, at.cos_b, -at.sin_b
            cos_y, sin_y = at.cos_bx, -at.sin_bx                    # of X - B
            cos_2, sin_2, cos_3, sin_3 = at.cos_y, -at.sin_y, -at.cos_x, -at.sin_x
            x, b, y = (at.d_mu, at.dd_mu), (-at.d_b, -at.dd_b), (-at.d_bx, -at.dd_b)
            two = (atan2(sin_2, cos_2), *rates(-at.d_y, -at.dd_y))
            three = theta, omega, alpha
        (omega1, alpha1), (omega4, alpha4), (omega_beta, alpha_beta) = (
            rates(*derivatives) for derivatives in (x, y, b))
        return MovingJointMotion(
            atan2(sin_x, cos_x), omega1, alpha1, *two, *three, atan2(sin_y, cos_y), omega4, alpha4,
            atan2(sin_b, cos_b), omega_beta, alpha_beta,
            transmission_angle=sign * facing, velocity_ratio=y[0], coupler_ratio=b[0],
            crank_ratio=x[0], condition=at.condition, cos_x=cos_x, sin_x=sin_x, cos_b=cos_b,
            sin_b=sin_b, cos_y=cos_y, sin_y=sin_y, cos_mu=-cos_3, sin_mu=-sin_3)
    return motion


def seen_lengths(lengths: tuple[Scalar, ...],
                 joint: str) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return the lengths as seen from the link before a driven joint: that one is the ground."""
    a1, a2, a3, a4 = lengths
    return (a2, a3, a4, a1) if joint == JOINT_A else (a3, a4, a1, a2)


@dataclass(frozen=True)
class MovingJointFourBar(FourBarLinks):
    """
    Planar four-bar linkage O1-A-B-O4 that is driven at A or at B, between two moving links.

    Parameters
    ----------
    a1, a2, a3, a4 : float
        As of :class:`~fourbar_ros.mechanisms.four_bar.four_bar.FourBar`.
    mode : int
        Assembly mode: 2 has sin(theta4) > 0 of a drive at A, sin(theta1) > 0 of one at B; 1 < 0.
    input : str
        'A': theta2, coupler to crank, is given; 'B': theta3, output link to coupler.
    bodies : Bodies, optional
        Masses; without them there are no loads.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on the links.

    Its ``driving_torque`` acts on the coupler from the crank (A), or on the output link from the
    coupler (B).

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = OPEN
    input: str = JOINT_A
    bodies: Bodies | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    external: External = External()

    MODES = {1: '1', OPEN: '2'}
    INPUTS = {JOINT_A: THETA2, JOINT_B: THETA3}
    OUTPUTS = {joint: (Output(THETA4, 'velocity_ratio'), Output(THETA1, 'crank_ratio'))
               for joint in INPUTS}
    MOTION = MovingJointMotion

    @property
    def description(self) -> str:
        """Return a short text: type, input."""
        return f'{self.classification}, driven at its joint {self.input}'

    @property
    def TORQUE(self) -> str:        # type: ignore[override]  # of each input  # noqa: N802
        """Return the symbol of the torque: of crank on coupler, of coupler on output link."""
        return 'T_{12}' if self.input == JOINT_A else 'T_{23}'

    @of_geometry
    def closing_ranges(self) -> Ranges:
        """Return the ranges of theta2 or theta3 in which the linkage can be assembled [rad]."""
        return turned_ranges(ranges_of(*seen_lengths(self.lengths, self.input)))

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the complex inputs at which output and ground (A), or crank and ground, align."""
        return [complex(x.real + (pi if x.real <= 0.0 else -pi), x.imag)
                for x in singular_angles(*seen_lengths(self.lengths, self.input))]

    @property
    def turns_fully(self) -> bool:
        """Return whether the driven joint makes full turns."""
        return self.input_ranges == ((-pi, pi),)

    def driven_otherwise(self) -> tuple[FourBar, ...]:
        """Return the same links driven at the crank, which goes on at toggles of this drive."""
        a1, a2, a3, a4 = self.lengths
        return tuple(FourBar(a1, a2, a3, a4, mode, self.bodies, self.gravity, self.external)
                     for mode in FourBar.MODES)

    def read_coordinate(self, numbers: NumberType, curves: Any) -> tuple[Any, Any, Any]:
        """Return theta2 or theta3 and two derivatives by the input; ``curves`` of the links."""
        # angle of the second link to the first; theta3 counts from B A, half a turn on
        first, side = (0, 1.0) if self.input == JOINT_A else (1, -1.0)
        (*_, c1, s1, d1, dd1), (*_, c2, s2, d2, dd2) = curves[first:first + 2]
        return (numbers.atan2(side * (s2 * c1 - c2 * s1), side * (c2 * c1 + s2 * s1)),
                d2 - d1, dd2 - dd1)

    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        return make_motion_at(numbers, tuple(constants.lengths), constants.sign, self.input)

    def transmission_sine(self, motion: Any) -> Any:
        """Return a number that is zero where the dyad is in line, at most one."""
        return motion.sin_y if self.input == JOINT_A else motion.sin_x
