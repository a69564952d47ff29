# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Position, velocity and acceleration of the slider-crank RRRP with offset, stable in the last bits.

O1 = (0, 0); crank O1-A of length a1, coupler A-B of length a2; B slides along y = offset, the
guide, parallel to x. Loop (slides, before Eq. (7)): a1 e^{ix} + a2 e^{ib} = s + i e with x =
theta1, b = beta, s = slide, e = offset; primes are derivatives with respect to the input.

Crank input: the rod on a line of :mod:`fourbar_ros.mechanisms.slide_dyad`, (R1) to (R9), and

    (M1)  condition = (a1 |cos theta2| + a2 + |e sin b|) a2 / |root|

Slider input: the triangle of :mod:`fourbar_ros.mechanisms.slide_dyad`, (T1) to (T8). Every
difference in these is one that the data make.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.mechanisms.slide_dyad import make_rod_on_line, make_triangle
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar


class SliderCrankMotion(NamedTuple):
    """
    Pose, rates and accelerations; each field a float, or an array of the input's shape.

    Angles [rad], in [-pi, pi] but for a theta1 that is the input; theta2 is relative (coupler to
    crank), theta3 = -beta (slider to coupler): theta1 + theta2 + theta3 = 0.
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
    slide: float                   # [m] x of B, along the guide
    slide_velocity: float          # [m/s]
    slide_acceleration: float      # [m/s^2]
    beta: float                    # absolute coupler angle
    omega_beta: float
    alpha_beta: float
    # [rad] in [0, pi]: of coupler and normal of the guide (slider input: crank)
    transmission_angle: float
    crank_ratio: float             # d theta1, d beta, d slide over d input
    coupler_ratio: float
    slide_ratio: float
    # relative error of the lengths -> error of slide [m] (of theta1 [rad])
    condition: float
    cos_x: float                   # directions of crank and coupler, and of theta2
    sin_x: float
    cos_b: float
    sin_b: float
    cos_2: float
    sin_2: float


def make_crank_motion(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, sign: Scalar,
                      is_long: bool) -> Function:
    """Return (theta1, omega1, alpha1) -> motion; ``is_long``: a1 > 2 a2, see make_rod_on_line."""
    sin, cos, atan2, fabs = n.sin, n.cos, n.atan2, n.fabs
    unit = n.power_of_two(a1, a2, e)
    a1, a2, e = a1 / unit, a2 / unit, e / unit
    rod_on_line = make_rod_on_line(n, a1, a2, e, sign, is_long)

    def motion(theta1: Scalar, omega1: Scalar, alpha1: Scalar) -> SliderCrankMotion:
        """Return the motion for a crank angle."""
        cos_x, sin_x = cos(theta1), sin(theta1)
        at = rod_on_line(cos_x, sin_x)
        square = omega1 * omega1
        condition = unit * ((a1 * fabs(at.cos_2) + a2 + fabs(e * at.sin_b))                  # (M1)
                            * a2 * fabs(at.per_root))
        beta, omega_beta = atan2(at.sin_b, at.cos_b), at.d_b * omega1
        alpha_beta = at.d_b * alpha1 + at.dd_b * square
        return SliderCrankMotion(
            theta1, omega1, alpha1,
            theta2=atan2(at.sin_2, at.cos_2), omega2=at.d_theta2 * omega1,
            alpha2=at.d_theta2 * alpha1 + at.dd_b * square,
            theta3=-beta, omega3=-omega_beta, alpha3=-alpha_beta,
            slide=unit * at.s, slide_velocity=unit * (at.d_s * omega1),
            slide_acceleration=unit * (at.d_s * alpha1 + at.dd_s * square),
            beta=beta, omega_beta=omega_beta, alpha_beta=alpha_beta,
            transmission_angle=atan2(fabs(at.cos_b), at.sin_b),
            crank_ratio=1.0, coupler_ratio=at.d_b, slide_ratio=unit * at.d_s,
            condition=condition, cos_x=cos_x, sin_x=sin_x, cos_b=at.cos_b, sin_b=at.sin_b,
            cos_2=at.cos_2, sin_2=at.sin_2)
    return motion


def make_slider_motion(n: NumberType, a1: Scalar, a2: Scalar, e: Scalar, sign: Scalar) -> Function:
    """Return the function (slide, velocity, acceleration) -> :class:`SliderCrankMotion`."""
    atan2, fabs = n.atan2, n.fabs
    unit = n.power_of_two(a1, a2, e)
    a1, a2, e, per_unit = a1 / unit, a2 / unit, e / unit, 1.0 / unit
    triangle = make_triangle(n, a1, a2, e, sign)

    def motion(slide: Scalar, slide_velocity: Scalar,
               slide_acceleration: Scalar) -> SliderCrankMotion:
        """Return the motion for a slide."""
        at = triangle(slide * per_unit)
        v, a = slide_velocity * per_unit, slide_acceleration * per_unit
        square = v * v
        theta2 = atan2(at.sin_2, at.cos_2)
        beta, omega_beta = atan2(at.sin_b, at.cos_b), at.d_b * v
        alpha_beta = at.d_b * a + at.dd_b * square
        condition = 2.0 * a2 * (a1 * fabs(at.cos_2) + a2 + fabs(e * at.sin_b)) * fabs(at.per_root)
        return SliderCrankMotion(
            theta1=atan2(at.sin_x, at.cos_x), omega1=at.d_x * v,
            alpha1=at.d_x * a + at.dd_x * square,
            theta2=theta2, omega2=at.d_theta2 * v, alpha2=at.d_theta2 * a + at.dd_theta2 * square,
            theta3=-beta, omega3=-omega_beta, alpha3=-alpha_beta,
            slide=slide, slide_velocity=slide_velocity, slide_acceleration=slide_acceleration,
            beta=beta, omega_beta=omega_beta, alpha_beta=alpha_beta,
            transmission_angle=fabs(theta2), crank_ratio=at.d_x * per_unit,
            coupler_ratio=at.d_b * per_unit, slide_ratio=1.0, condition=condition,
            cos_x=at.cos_x, sin_x=at.sin_x, cos_b=at.cos_b, sin_b=at.sin_b, cos_2=at.cos_2,
            sin_2=at.sin_2)
    return motion
