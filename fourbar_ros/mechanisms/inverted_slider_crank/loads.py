# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of the inverted slider-crank: Newton-Euler in closed form, one system solved by hand.

With F1, F2, F3 and M1, M2, M3 as for the 4R (link 2 the block, link 3 the bar), N the force of the
bar on the block to the left of the bar, and P the driving force along it:

    (L1)  crank driven:  l N = -(M2 + M3)
    (L2)  slide driven:  a4 sin x N = h M1/a1 - (M2 + M3) sin(theta2)
    (L3)  F32 = P e_y + N (k x e_y),   F21 = F32 - F2,   F43 = F3 + F32,   F41 = F1 - F21
    (L4)  drive = M1 theta1' + (M2 + M3) y'
    (L5)  shaking force = -(F1 + F2 + F3),   shaking moment about O1 = -(M1 + M2 + M3 + a4 F3_y)

Assumed as for the 4R (:mod:`fourbar_ros.mechanisms.four_bar.loads`); the bar transmits to the
block, without friction, a force square to it and a couple. The drive is a pure torque on the
crank, or a force along the slide.
"""
from __future__ import annotations

from typing import Any

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    make_needs_of_crank_and_carried,
    make_needs_of_pivoted,
)
from fourbar_ros.numerics.number_types import Function, NumberType


def make_loads(n: NumberType, a1: Any, a4: Any, h: Any, is_crank_driven: bool, bodies: Bodies,
               gravity: tuple[Any, Any], external: External) -> Function:
    """
    Return the function (fields of InvertedSliderMotion) -> fields of :class:`.SliderLoads`.

    The force between block and bar from the moments of both about O4 and, for a driven slide, of
    the crank; the drive from virtual power.
    """
    hypot, unit = n.hypot, n.power_of_two(a1, a4, h)
    a1, a4, h, per_unit = a1 / unit, a4 / unit, h / unit, 1.0 / unit
    mass2 = bodies.coupler.mass * unit
    block = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    bar = about_first_joint(bodies.output, unit, gravity, external.output)
    crank = crank_with_pin(bodies, unit, gravity, external, block, a1)
    needs_of_crank_and_carried = make_needs_of_crank_and_carried(crank, block, mass2, a1)
    needs_of_pivoted = make_needs_of_pivoted(bar)

    def loads(motion: tuple[Any, ...]) -> tuple[Any, ...]:
        (_, omega1, alpha1, _, omega2, _, _, omega4, alpha4, slide, _, _,
         _, crank_ratio, output_ratio, _, _, cos_x, sin_x, cos_y, sin_y, _, sin_2) = motion
        square, square_4 = omega1 * omega1, omega4 * omega4
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            cos_x, sin_x, square, alpha1, cos_y, sin_y, square_4, alpha4)
        f3_x, f3_y, moment3 = needs_of_pivoted(cos_y, sin_y, square_4, alpha4)
        moment2 = about_a + aside * square
        # (L4)
        drive = unit * (moment1 * crank_ratio + (about_a + moment3) * output_ratio
                        - aside * (omega4 * omega2) * crank_ratio)
        turning = moment2 + moment3
        if is_crank_driven:
            driving_torque, driving_force = drive, 0.0
            guide_force = -turning / (slide * per_unit)                                 # (L1)
        else:
            driving_torque, driving_force = 0.0, drive
            # (L2)
            guide_force = (h * (moment1 - aside * square_4) / a1 - turning * sin_2) / (a4 * sin_x)
        # (L3)
        f32_x = driving_force * cos_y - guide_force * sin_y
        f32_y = driving_force * sin_y + guide_force * cos_y
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        f43_x, f43_y = f3_x + f32_x, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        f41, f21, f32, f43 = (hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y),
                              hypot(f43_x, f43_y))
        guide_couple = unit * moment2
        shaking_force_x, shaking_force_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)     # (L5)
        shaking_force = hypot(shaking_force_x, shaking_force_y)
        shaking_moment = unit * (aside * (omega2 * (omega1 + omega4))
                                 - (moment1 + about_a + moment3 + a4 * f3_y))
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y, f41, f21, f32, f43,
                guide_force, guide_couple, driving_torque, driving_force,
                shaking_force_x, shaking_force_y, shaking_force, shaking_moment)
    return loads
