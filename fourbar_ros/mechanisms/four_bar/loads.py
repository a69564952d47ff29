# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Joint reactions, driving torque and shaking wrench: Newton-Euler in closed form.

The paper's 9x9 system, Eq. (9), solved once by hand as Eq. (10) does by an inverse. F1, F2, F3 and
M1, M2, M3 are what the joints of crank, coupler and output link must give: M2 about A, M3 about
O4, and M1 about O1 of crank and coupler together less M2; (N1) to (N5) of
:mod:`fourbar_ros.mechanics.newton_euler`. The two moment equations give the force at B directly,

    (L1)  F32 = (M3/a3 e_b + M2/a2 e_y) / sin(mu),     e_b, e_y: directions of coupler and output
    link,

and every other reaction follows by subtraction:

    (L2)  F21 = F32 - F2
    (L3)  F43 = F3 + F32
    (L4)  F41 = F1 - F21

The torque follows from virtual power at unit speed of the crank. The shaking wrench is summed over
the links, not over the reactions: inner forces much larger than the sums would spoil them.

    (L5)  T41 = M1 + M2 b' + M3 y',   terms of a x r collected
    (L6)  shaking force = -(F1 + F2 + F3)
    (L7)  shaking moment about O1 = -(M1 + M2 + M3 + (O4 - O1) x F3)

A drive between two links, at A or B, changes two equations. Its torque follows from virtual power
at unit rate of its own joint, x' = d(theta1)/d(theta2 or theta3),

    (L8)  T = M1 x' + M2 b' + M3 y'

and the moments in which it does not appear give the force at B: of crank and coupler together
about O1 and of the output link about O4 for A, of the crank alone about O1 and of all about O1
for B,

    (L9)   at A:  F32 = ((M1 + M2 + M3) e_y + a4/a3 M3 x) / (a4 sin(y))
    (L10)  at B:  F32 = ((M1 + M2 + M3)/a4 e_x - M1/a1 x) / sin(x),   x also the unit vector O1-O4

Assumed: rigid links moving in one plane; joints without clearance and without friction (a joint
transmits a force through its centre and no couple); gravity uniform; external forces and couples
constant along the ground axes, at points fixed in their link. The drive is a pure torque on the
crank, or on the second of two links from the first.
"""
from __future__ import annotations

from typing import Any, TYPE_CHECKING

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    Gravity,
    joint_loads,
    Needs,
    needs_of_crank_and_carried,
    needs_of_pivoted,
    NeedsOfCarried,
    Turning,
)
from fourbar_ros.mechanisms.contract import CRANK, JOINT_A
from fourbar_ros.mechanisms.four_bar.motion import Loads
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.vectors import Vector

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.four_bar.moving_joint import MovingJointMotion


def make_loads(n: NumberType, a1: Scalar, a2: Scalar, a3: Scalar, a4: Scalar, bodies: Bodies,
               gravity: Gravity, external: External, driven: str = CRANK) -> Function:
    """
    Return the function Motion -> :class:`.Loads` for a fixed linkage.

    ``driven``: the crank, or the joint A or B, then of a :class:`.MovingJointMotion`; ``gravity``:
    (x, y) of the field [m/s^2]. Lengths [m] are scaled by a power of two, so that no square of one
    overflows.
    """
    unit = n.power_of_two(a1, a2, a3, a4)
    a1, a2, a3, a4 = a1 / unit, a2 / unit, a3 / unit, a4 / unit
    coupler_terms = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    output_terms = about_first_joint(bodies.output, unit, gravity, external.output)
    crank_terms = crank_with_pin(bodies, unit, gravity, external, coupler_terms, a1)

    def loads(m: Any) -> Loads:
        """Return the loads of a motion, by (L1) to (L8)."""
        e_x, e_b = Vector(m.cos_x, m.sin_x), Vector(m.cos_b, m.sin_b)
        e_y = Vector(m.cos_y, m.sin_y)
        crank, coupler = needs_of_crank_and_carried(
            crank_terms, Turning(e_x, m.omega1, m.alpha1),
            coupler_terms, Turning(e_b, m.omega_beta, m.alpha_beta), a1)
        output = needs_of_pivoted(output_terms, Turning(e_y, m.omega4, m.alpha4))

        if driven == CRANK:
            M2 = coupler.moment + coupler.a_cross_r * (m.omega1 * m.omega1)
            F32 = e_b * (output.moment / (a3 * m.sin_mu)) + e_y * (M2 / (a2 * m.sin_mu))    # (L1)
            T = (crank.moment + coupler.moment * m.coupler_ratio                        # (L5)
                 - coupler.a_cross_r * (m.omega_beta * m.omega2)
                 + output.moment * m.velocity_ratio)
        else:
            T = (crank.moment * m.crank_ratio + coupler.moment * m.coupler_ratio        # (L8)
                 - coupler.a_cross_r * (m.crank_ratio * m.omega_beta * m.omega2)
                 + output.moment * m.velocity_ratio)
            F32 = _force_at_b(m, driven == JOINT_A, (a1, a3, a4), crank, coupler, output)
        shaking_moment = (coupler.a_cross_r * (m.omega2 * (m.omega1 + m.omega_beta))    # (L7)
                          - (crank.moment + coupler.moment + output.moment
                             + a4 * output.force.y))
        return joint_loads(                                         # (L2), (L4), (L6); (L3)
            n, Loads, (crank.force, coupler.force, output.force), F32, output.force + F32,
            driving_torque=unit * T, shaking_moment=unit * shaking_moment)
    return loads


def _force_at_b(m: MovingJointMotion, is_driven_at_a: bool, lengths: tuple[Scalar, Scalar, Scalar],
                crank: Needs, coupler: NeedsOfCarried, output: Needs) -> Vector:
    """
    Return F32, the force of the output link on the coupler, of a drive at joint A or else at B.

    It follows from the moments in which the drive's torque does not appear. ``lengths``: a1, a3,
    a4.
    """
    a1, a3, a4 = lengths
    x = Vector(1.0, 0.0)
    all_moments = (crank.moment + coupler.moment + output.moment
                   - coupler.a_cross_r * (m.omega2 * (m.omega1 + m.omega_beta)))
    if is_driven_at_a:
        e_y = Vector(m.cos_y, m.sin_y)
        return (e_y * all_moments + x * (a4 / a3 * output.moment)) * (1.0 / (a4 * m.sin_y))  # (L9)
    M1 = crank.moment - coupler.a_cross_r * (m.omega_beta * m.omega_beta)
    e_x = Vector(m.cos_x, m.sin_x)
    return (e_x * (all_moments / a4) - x * (M1 / a1)) * (1.0 / m.sin_x)                 # (L10)
