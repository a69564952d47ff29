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

from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    make_needs_of_crank_and_carried,
)
from fourbar_ros.numerics.number_types import Function, NumberType


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


def make_loads(n: NumberType, a1: Any, e: Any, is_crank_driven: bool, bodies: Bodies,
               gravity: tuple[Any, Any],
               external: External) -> Function:
    """Return the function (fields of ScotchYokeMotion) -> fields of :class:`ScotchYokeLoads`."""
    hypot, unit = n.hypot, n.power_of_two(a1, e)
    a1, e, per_unit = a1 / unit, e / unit, 1.0 / unit
    mass2, mass3 = bodies.coupler.mass * unit, bodies.output.mass * unit
    block = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    yoke = about_first_joint(bodies.output, unit, gravity, external.output)
    crank = crank_with_pin(bodies, unit, gravity, external, block, a1)
    across, hold_x, f3_y, couple = (yoke.across, yoke.hold_x, yoke.hold_y,
                                    yoke.by_cosine + yoke.couple)
    needs_of_crank_and_carried = make_needs_of_crank_and_carried(crank, block, mass2, a1)

    def loads(motion: tuple[Any, ...]) -> tuple[Any, ...]:
        (_, omega1, alpha1, _, _, _, slide, _, slide_acceleration, slot, _, _, _, crank_ratio,
         slide_ratio, _,
         cos_x, sin_x) = motion
        square = omega1 * omega1
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            cos_x, sin_x, square, alpha1, 0.0, 1.0, 0.0, 0.0)
        acceleration, moment2 = slide_acceleration * per_unit, about_a + aside * square
        f3_x, moment3 = mass3 * acceleration + hold_x, couple - across * acceleration

        drive = unit * (moment1 * crank_ratio) + f3_x * slide_ratio
        if is_crank_driven:
            driving_torque, driving_force, f32_x = drive, 0.0, -f3_x                    # (L1)
        else:
            driving_torque, driving_force, f32_x = 0.0, drive, -moment1 / (a1 * sin_x)
        f32_y = 0.0 * f32_x
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        f43_x, f43_y = driving_force, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        f41, f21, f32, f43 = (hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y),
                              hypot(f43_x, f43_y))
        slot_couple, guide_force = unit * moment2, f43_y                                # (L2)
        guide_couple = unit * (moment3 - slot * per_unit * f32_x + moment2)             # (L3)
        shaking_force_x, shaking_force_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)
        shaking_force = hypot(shaking_force_x, shaking_force_y)
        shaking_moment = -unit * (moment1 + moment2 + moment3 + slide * per_unit * f3_y - e * f3_x)
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y, f41, f21, f32, f43,
                guide_force, guide_couple, slot_couple, driving_torque, driving_force,
                shaking_force_x, shaking_force_y, shaking_force, shaking_moment)
    return loads
