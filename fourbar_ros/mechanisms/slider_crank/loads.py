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

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    Gravity,
    joint_loads,
    needs_of_crank_and_carried,
    Turning,
)
from fourbar_ros.mechanisms.slide_dyad import SliderLoads
from fourbar_ros.mechanisms.slider_crank.motion import SliderCrankMotion
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.vectors import Vector


def make_loads(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, is_crank_driven: bool,
               bodies: Bodies, gravity: Gravity, external: External) -> Function:
    """
    Return the function SliderCrankMotion -> :class:`.SliderLoads`.

    The force at B follows from the moment of the coupler and, for a driven crank, the force of
    the slider along the guide, for a driven slider the moment of the crank; the drive from virtual
    power. Lengths [m] are scaled by a power of two, so that no square overflows.
    """
    unit = n.power_of_two(a1, a2, e)
    a1, a2, e, per_unit = a1 / unit, a2 / unit, e / unit, 1.0 / unit
    coupler_terms = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    slider = about_first_joint(bodies.output, unit, gravity, external.output)
    crank_terms = crank_with_pin(bodies, unit, gravity, external, coupler_terms, a1)
    at_rest = slider.by_cosine + slider.couple          # the moment that the slider needs

    def loads(m: SliderCrankMotion) -> SliderLoads:
        """Return the loads of a motion, by (L1) to (L5)."""
        e_x, e_b = Vector(m.cos_x, m.sin_x), Vector(m.cos_b, m.sin_b)
        crank, coupler = needs_of_crank_and_carried(
            crank_terms, Turning(e_x, m.omega1, m.alpha1),
            coupler_terms, Turning(e_b, m.omega_beta, m.alpha_beta), a1)
        acceleration = m.slide_acceleration * per_unit
        F3 = Vector(slider.mass * acceleration + slider.held.x, slider.held.y)
        M3 = at_rest - slider.first_moment.y * acceleration

        drive = (unit * (crank.moment * m.crank_ratio + coupler.moment * m.coupler_ratio     # (L4)
                         - coupler.a_cross_r * (m.omega_beta * m.omega2) * m.crank_ratio)
                 + F3.x * m.slide_ratio)
        M2_per_a2 = (coupler.moment + coupler.a_cross_r * (m.omega1 * m.omega1)) / a2
        if is_crank_driven:
            driving_torque, driving_force = drive, 0.0
            F32 = Vector(-F3.x, (M2_per_a2 - m.sin_b * F3.x) / m.cos_b)                 # (L1)
        else:
            driving_torque, driving_force = 0.0, drive
            M1 = crank.moment - coupler.a_cross_r * (m.omega_beta * m.omega_beta)
            F32 = (e_b * (M1 / a1) - e_x * M2_per_a2) / m.sin_2                         # (L2)
        F43 = Vector(driving_force, F3.y + F32.y)                                       # (L3)
        shaking_moment = (coupler.a_cross_r * (m.omega2 * (m.omega1 + m.omega_beta))    # (L5)
                          - (crank.moment + coupler.moment + M3 + (m.slide * per_unit) * F3.y
                             - e * F3.x))
        return joint_loads(
            n, SliderLoads, (crank.force, coupler.force, F3), F32, F43, guide_force=F43.y,
            guide_couple=unit * M3, driving_torque=driving_torque, driving_force=driving_force,
            shaking_moment=unit * shaking_moment)
    return loads
