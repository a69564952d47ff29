# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Joint reactions, driving torque and shaking wrench: Newton-Euler in closed form.

The paper's 9x9 system, Eq. (9), solved once by hand. F1, F2, F3 and M1, M2, M3 are what the joints
of crank, coupler and output link must give: M2 about A, M3 about O4, and M1 about O1 of crank and
coupler together less M2; (N1) to (N5) of :mod:`fourbar_ros.mechanics.newton_euler`. The two moment
equations give the force at B directly,

    (L1)  F32 = (M3/a3 e_b + M2/a2 e_y) / sin(mu),     e_b, e_y: directions of coupler and output
    link,

and every other reaction follows by subtraction:

    (L2)  F21 = F32 - F2
    (L3)  F43 = F3 + F32
    (L4)  F41 = F1 - F21

The torque is that of virtual power at unit speed of the crank, and the shaking wrench is summed
over the links, not over the reactions: inner forces much larger than the sums would spoil them.

    (L5)  T41 = M1 + M2 b' + M3 y',   terms of a x r collected
    (L6)  shaking force = -(F1 + F2 + F3)
    (L7)  shaking moment about O1 = -(M1 + M2 + M3 + (O4 - O1) x F3)

Assumed: rigid links moving in one plane; joints without clearance and without friction (a joint
transmits a force through its centre and no couple); gravity uniform; external forces and couples
constant along the ground axes, at points fixed in their link. The drive is a pure torque on the
crank.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    make_needs_of_crank_and_carried,
    make_needs_of_pivoted,
)
from fourbar_ros.numerics.number_types import Function, NumberType


class Loads(NamedTuple):
    """
    Loads for one input; each field a float, or an array of the input's shape.

    fij = force of link i ON link j (1 crank, 2 coupler, 3 output link, 4 ground) along the ground
    axes (x from O1 to O4); fji = -fij. Forces in [N], moments in [N m], counter-clockwise
    positive.
    """

    f41_x: float
    f41_y: float
    f21_x: float
    f21_y: float
    f32_x: float
    f32_y: float
    f43_x: float
    f43_y: float
    f41: float                # magnitudes
    f21: float
    f32: float
    f43: float
    driving_torque: float     # T41, of the drive on the crank
    shaking_force_x: float    # F14 + F34, on the ground
    shaking_force_y: float
    shaking_force: float      # magnitude
    shaking_moment: float     # on the ground about O1: T14 + (O4 - O1) x F34


def make_loads(n: NumberType, a1: Any, a2: Any, a3: Any, a4: Any, bodies: Bodies,
               gravity: tuple[Any, Any], external: External) -> Function:
    """
    Return the function (fields of Motion) -> fields of :class:`Loads` for a fixed linkage.

    ``gravity``: (x, y) of the field [m/s^2]. Lengths are scaled by a power of two into masses and
    inertias, so that no square of a length can overflow.
    """
    hypot, unit = n.hypot, n.power_of_two(a1, a2, a3, a4)
    a1, a2, a3, a4 = a1 / unit, a2 / unit, a3 / unit, a4 / unit
    mass2 = bodies.coupler.mass * unit
    coupler = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    output = about_first_joint(bodies.output, unit, gravity, external.output)
    crank = crank_with_pin(bodies, unit, gravity, external, coupler, a1)
    needs_of_crank_and_carried = make_needs_of_crank_and_carried(crank, coupler, mass2, a1)
    needs_of_pivoted = make_needs_of_pivoted(output)

    def loads(motion: tuple[Any, ...]) -> tuple[Any, ...]:
        (_, omega1, alpha1, _, omega2, _, _, _, _, _, omega4, alpha4, _, omega_beta, alpha_beta,
         _, velocity_ratio, coupler_ratio, _,
         cos_x, sin_x, cos_b, sin_b, cos_y, sin_y, _, sin_mu) = motion
        square = omega1 * omega1
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            cos_x, sin_x, square, alpha1,
            cos_b, sin_b, omega_beta * omega_beta, alpha_beta)
        f3_x, f3_y, moment3 = needs_of_pivoted(cos_y, sin_y, omega4 * omega4, alpha4)

        moment2 = about_a + aside * square
        from_output, from_coupler = moment3 / (a3 * sin_mu), moment2 / (a2 * sin_mu)
        f32_x = from_output * cos_b + from_coupler * cos_y                              # (L1)
        f32_y = from_output * sin_b + from_coupler * sin_y
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y                                       # (L2)
        f43_x, f43_y = f3_x + f32_x, f3_y + f32_y                                       # (L3)
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y                                       # (L4)
        f41, f21, f32, f43 = (hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y),
                              hypot(f43_x, f43_y))
        torque = (moment1 + about_a * coupler_ratio - aside * (omega_beta * omega2)
                  + moment3 * velocity_ratio)
        driving_torque = unit * torque                                                  # (L5)
        shaking_force_x, shaking_force_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)     # (L6)
        shaking_force = hypot(shaking_force_x, shaking_force_y)
        shaking_moment = unit * (aside * (omega2 * (omega1 + omega_beta))                # (L7)
                                 - (moment1 + about_a + moment3 + a4 * f3_y))
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y, f41, f21, f32, f43,
                driving_torque, shaking_force_x, shaking_force_y, shaking_force, shaking_moment)
    return loads
