# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of the slider-crank: Newton-Euler in closed form, one system solved by hand.

With F1, F2, F3 and M1, M2, M3 as for the 4R (M3 about B), and e_x, e_b the directions of crank and
coupler:

    (L1)  crank driven:  F32_x = -F3_x,   a2 (cos b F32_y - sin b F32_x) = M2
    (L2)  slide driven:  F32 = (M1/a1 e_b - M2/a2 e_x) / sin(theta2)
    (L3)  F21 = F32 - F2,   F41 = F1 - F21,   F43 = (driving force, F3_y + F32_y)
    (L4)  drive = M1 theta1' + M2 b' + F3_x s'
    (L5)  shaking force = -(F1 + F2 + F3),
          shaking moment about O1 = -(M1 + M2 + M3 + s F3_y - e F3_x)

Assumed as for the 4R (:mod:`fourbar_ros.mechanisms.four_bar.loads`); the guide transmits, without
friction, a force square to it and a couple. The drive is a pure torque on the crank, or a force
along the slide.
"""
from __future__ import annotations

from typing import Any

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    make_needs_of_crank_and_carried,
)
from fourbar_ros.numerics.number_types import Function, NumberType


def make_loads(n: NumberType, a1: Any, a2: Any, e: Any, is_crank_driven: bool, bodies: Bodies,
               gravity: tuple[Any, Any], external: External) -> Function:
    """
    Return the function (fields of SliderCrankMotion) -> fields of :class:`.SliderLoads`.

    The force at B from the moment of the coupler and, for a driven crank, the slider's own
    equation along the guide, for a driven slider the moment of the crank; the drive from virtual
    power.
    """
    hypot, unit = n.hypot, n.power_of_two(a1, a2, e)
    a1, a2, e, per_unit = a1 / unit, a2 / unit, e / unit, 1.0 / unit
    mass2, mass3 = bodies.coupler.mass * unit, bodies.output.mass * unit
    coupler = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    slider = about_first_joint(bodies.output, unit, gravity, external.output)
    crank = crank_with_pin(bodies, unit, gravity, external, coupler, a1)
    across, hold_x, f3_y, couple = (slider.across, slider.hold_x, slider.hold_y,
                                    slider.by_cosine + slider.couple)
    needs_of_crank_and_carried = make_needs_of_crank_and_carried(crank, coupler, mass2, a1)

    def loads(motion: tuple[Any, ...]) -> tuple[Any, ...]:
        (_, omega1, alpha1, _, omega2, _, _, _, _, slide, _, slide_acceleration,
         _, omega_beta, alpha_beta, _, crank_ratio, coupler_ratio, slide_ratio, _,
         cos_x, sin_x, cos_b, sin_b, _, sin_2) = motion
        square, square_b = omega1 * omega1, omega_beta * omega_beta
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            cos_x, sin_x, square, alpha1, cos_b, sin_b, square_b, alpha_beta)
        acceleration = slide_acceleration * per_unit
        f3_x, moment3 = mass3 * acceleration + hold_x, couple - across * acceleration
        drive = (unit * (moment1 * crank_ratio + about_a * coupler_ratio             # (L4)
                         - aside * (omega_beta * omega2) * crank_ratio) + f3_x * slide_ratio)
        along_x = -(about_a + aside * square) / a2
        if is_crank_driven:
            driving_torque, driving_force = drive, 0.0
            f32_x, f32_y = -f3_x, (-along_x - sin_b * f3_x) / cos_b                     # (L1)
        else:
            driving_torque, driving_force = 0.0, drive
            along_b = (moment1 - aside * square_b) / a1
            f32_x = (along_b * cos_b + along_x * cos_x) / sin_2                         # (L2)
            f32_y = (along_b * sin_b + along_x * sin_x) / sin_2
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y                                       # (L3)
        f43_x, f43_y = driving_force, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        f41, f21, f32, f43 = (hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y),
                              hypot(f43_x, f43_y))
        guide_force, guide_couple = f43_y, unit * moment3
        shaking_force_x, shaking_force_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)     # (L5)
        shaking_force = hypot(shaking_force_x, shaking_force_y)
        shaking_moment = unit * (aside * (omega2 * (omega1 + omega_beta))
                                 - (moment1 + about_a + moment3 + (slide * per_unit) * f3_y
                                    - e * f3_x))
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y, f41, f21, f32, f43,
                guide_force, guide_couple, driving_torque, driving_force,
                shaking_force_x, shaking_force_y, shaking_force, shaking_moment)
    return loads
