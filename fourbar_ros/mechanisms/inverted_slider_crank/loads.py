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

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.newton_euler import (
    about_first_joint,
    crank_with_pin,
    Gravity,
    joint_loads,
    needs_of_crank_and_carried,
    needs_of_pivoted,
    Turning,
)
from fourbar_ros.mechanisms.inverted_slider_crank.motion import InvertedSliderMotion
from fourbar_ros.mechanisms.slide_dyad import SliderLoads
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.vectors import Vector


def make_loads(n: NumberType, a1: Scalar, a4: Scalar, h: Scalar, is_crank_driven: bool,
               bodies: Bodies, gravity: Gravity, external: External) -> Function:
    """
    Return the function InvertedSliderMotion -> :class:`.SliderLoads`.

    The force between block and bar follows from the moments of both about O4 and, for a driven
    slide, of the crank; the drive from virtual power. Lengths [m] are scaled by a power of two, so
    that no square overflows.
    """
    unit = n.power_of_two(a1, a4, h)
    a1, a4, h, per_unit = a1 / unit, a4 / unit, h / unit, 1.0 / unit
    block_terms = about_first_joint(bodies.coupler, unit, gravity, external.coupler)
    bar_terms = about_first_joint(bodies.output, unit, gravity, external.output)
    crank_terms = crank_with_pin(bodies, unit, gravity, external, block_terms, a1)

    def loads(m: InvertedSliderMotion) -> SliderLoads:
        """Return the loads of a motion, by (L1) to (L5)."""
        e_x, e_y = Vector(m.cos_x, m.sin_x), Vector(m.cos_y, m.sin_y)
        of_bar = Turning(e_y, m.omega4, m.alpha4)
        crank, block = needs_of_crank_and_carried(
            crank_terms, Turning(e_x, m.omega1, m.alpha1), block_terms, of_bar, a1)
        bar = needs_of_pivoted(bar_terms, of_bar)

        M2 = block.moment + block.a_cross_r * (m.omega1 * m.omega1)
        drive = unit * (crank.moment * m.crank_ratio                                    # (L4)
                        + (block.moment + bar.moment) * m.output_ratio
                        - block.a_cross_r * (m.omega4 * m.omega2) * m.crank_ratio)
        if is_crank_driven:
            driving_torque, driving_force = drive, 0.0
            N = -(M2 + bar.moment) / (m.slide * per_unit)                               # (L1)
        else:
            driving_torque, driving_force = 0.0, drive
            M1 = crank.moment - block.a_cross_r * (m.omega4 * m.omega4)
            N = (h * M1 / a1 - (M2 + bar.moment) * m.sin_2) / (a4 * m.sin_x)            # (L2)
        F32 = e_y * driving_force + e_y.normal * N                                      # (L3)
        shaking_moment = (block.a_cross_r * (m.omega2 * (m.omega1 + m.omega4))          # (L5)
                          - (crank.moment + block.moment + bar.moment + a4 * bar.force.y))
        return joint_loads(
            n, SliderLoads, (crank.force, block.force, bar.force), F32, bar.force + F32,
            guide_force=N, guide_couple=unit * M2, driving_torque=driving_torque,
            driving_force=driving_force, shaking_moment=unit * shaking_moment)
    return loads
