# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of the Scotch yoke: Newton-Euler in closed form.

Assumed as for the 4R (:mod:`fourbar_ros.mechanisms.four_bar.loads`); slot and guide transmit,
without friction, a force square to them and a couple. Block and yoke do not turn. The drive is a
pure torque on the crank, or a force on the yoke along x. With F_i and M_i what the joints of link
i must add up to:

    (L1)  F32 = (N, 0),   N = -F3x of a driven crank,   N = -M1 / (a1 sin x) of a driven slide
    (L2)  slot couple, of the yoke on the block about A:    M2
    (L3)  guide couple, of the guide on the yoke about B:   M3 - t N + M2

where M1 is the moment about O1 of the crank and what it carries, and the drive is that of virtual
power.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    Gravity,
    joint_loads,
    needs_of_crank_and_carried,
    Turning,
)
from fourbar_ros.mechanisms.scotch_yoke.motion import ScotchYokeMotion
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.vectors import Vector


class ScotchYokeLoads(NamedTuple):
    """
    Loads for one input; each field a float, or an array of the input's shape.

    fij = all that link i does ON link j along the ground axes (1 crank, 2 block, 3 yoke, 4
    ground), the drive's force included; fji = -fij. Forces [N], moments [N m], counter-clockwise
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
    guide_force: float        # of the guide on the yoke, along y
    guide_couple: float       # of the guide on the yoke about B
    slot_couple: float        # of the yoke on the block about A
    driving_torque: float     # of the drive on the crank; zero for a driven slide
    driving_force: float      # of the drive along the slide; zero for a driven crank
    shaking_force_x: float    # of all links on the ground
    shaking_force_y: float
    shaking_force: float      # magnitude
    shaking_moment: float     # about O1


def make_loads(n: NumberType, a1: Scalar, e: Scalar, is_crank_driven: bool, bodies: Bodies,
               gravity: Gravity, external: External) -> Function:
    """
    Return the function ScotchYokeMotion -> :class:`ScotchYokeLoads`.

    Lengths [m] are scaled by a power of two, so that no square overflows.
    """
    unit = n.power_of_two(a1, e)
    a1, e, per_unit = a1 / unit, e / unit, 1.0 / unit
    block_terms = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    yoke = about_first_joint(bodies.output, unit, gravity, external.output)
    crank_terms = crank_with_pin(bodies, unit, gravity, external, block_terms, a1)
    upright = Turning(Vector(0.0, 1.0), 0.0, 0.0)       # the block stands along the slot
    at_rest = yoke.by_cosine + yoke.couple              # the moment that the yoke needs

    def loads(m: ScotchYokeMotion) -> ScotchYokeLoads:
        """Return the loads of a motion, by (L1) to (L3)."""
        crank, block = needs_of_crank_and_carried(
            crank_terms, Turning(Vector(m.cos_x, m.sin_x), m.omega1, m.alpha1),
            block_terms, upright, a1)
        acceleration = m.slide_acceleration * per_unit
        F3 = Vector(yoke.mass * acceleration + yoke.held.x, yoke.held.y)
        M2 = block.moment + block.a_cross_r * (m.omega1 * m.omega1)
        M3 = at_rest - yoke.first_moment.y * acceleration

        drive = unit * (crank.moment * m.crank_ratio) + F3.x * m.slide_ratio
        if is_crank_driven:
            driving_torque, driving_force, N = drive, 0.0, -F3.x                        # (L1)
        else:
            driving_torque, driving_force, N = 0.0, drive, -crank.moment / (a1 * m.sin_x)
        F32 = Vector(N, 0.0 * N)                        # NaN too where nothing is known
        F43 = Vector(driving_force, F3.y + F32.y)
        guide_couple = M3 - m.slot * per_unit * N + M2                                  # (L3)
        shaking_moment = -unit * (crank.moment + M2 + M3 + m.slide * per_unit * F3.y - e * F3.x)
        return joint_loads(
            n, ScotchYokeLoads, (crank.force, block.force, F3), F32, F43, guide_force=F43.y,
            guide_couple=unit * guide_couple, slot_couple=unit * M2,                    # (L2)
            driving_torque=driving_torque, driving_force=driving_force,
            shaking_moment=shaking_moment)
    return loads
