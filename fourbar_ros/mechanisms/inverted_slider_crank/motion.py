# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Position, velocity and acceleration of the inverted slider-crank RPR with offset.

Stable in the last bits.

O1 = (0, 0), O4 = (a4, 0); crank O1-A of length a1. The block is pinned to the crank at A and
slides on the bar, which turns about O4. l = slide is how far A is along the bar from the foot of
O4 on the line of A, h = offset how far that line is from O4, to the left of the bar. Loop, with x
= theta1, y = theta4 the direction of the bar: a1 e^{ix} = a4 + (l + i h) e^{iy}; primes are
derivatives with respect to the input.

Crank input: the block on a bar of :mod:`fourbar_ros.mechanisms.slide_dyad`, (B1) to (B6), and

    (M1)  condition = (a1 |sin theta2| + a4 |sin y| + |h|) / |l|

Slide input: an observer on the bar sees a slider-crank, with a4 for its crank, a1 for its coupler,
h for its offset and A for its slider. So the angles are those of
:mod:`fourbar_ros.mechanisms.slide_dyad`, (T1) to (T8), turned back:

    (M2)  y = pi - x_seen,   theta1 = pi + theta2_seen,   theta2 = y - theta1 = -b_seen
    (M3)  condition = 2 (a1 |a1 - a4 cos x| + a4 |a4 - a1 cos x| + h^2) / |root|
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.mechanisms.slide_dyad import make_block_on_bar, make_triangle
from fourbar_ros.numerics.number_types import Function, nudge, NumberType, Scalar


class InvertedSliderMotion(NamedTuple):
    """
    Pose, rates and accelerations; each field a float, or an array of the input's shape.

    Angles [rad], in [-pi, pi] but for a theta1 that is the input; theta2 = theta4 - theta1 is
    relative (block to crank). Block and bar turn together.
    """

    theta1: float
    omega1: float
    alpha1: float
    theta2: float
    omega2: float
    alpha2: float
    theta4: float                  # absolute, of the bar
    omega4: float
    alpha4: float
    slide: float                   # [m] of the block along the bar
    slide_velocity: float          # [m/s] V_rel of Eq. (9)
    slide_acceleration: float      # [m/s^2] A_rel
    # [rad] in [0, pi], at A: line to O4 and normal of the bar (slide input: crank)
    transmission_angle: float
    crank_ratio: float             # d theta1, d theta4, d slide over d input
    output_ratio: float
    slide_ratio: float
    # relative error of the lengths -> error of theta4 (slide input: theta1) [rad]
    condition: float
    cos_x: float                   # directions of crank and bar, and of theta2
    sin_x: float
    cos_y: float
    sin_y: float
    cos_2: float
    sin_2: float


def make_crank_motion(n: NumberType, a1: Scalar, a4: Scalar, h: Scalar, sign: Scalar) -> Function:
    """Return the function (theta1, omega1, alpha1) -> :class:`InvertedSliderMotion`."""
    sin, cos, atan2, fabs = n.sin, n.cos, n.atan2, n.fabs
    beside_0 = nudge(n, n.exact_sum((a1, -a4, h)), n.exact_sum((a1, -a4, -h)))
    unit = n.power_of_two(a1, a4, h)
    a1, a4, h = a1 / unit, a4 / unit, h / unit
    block_on_bar = make_block_on_bar(n, a1, a4, h, sign)

    def motion(theta1: Scalar, omega1: Scalar, alpha1: Scalar) -> InvertedSliderMotion:
        """Return the motion for a crank angle."""
        half = 0.5 * theta1
        sh, ch = sin(half) + beside_0, cos(half)
        at = block_on_bar(sh * sh, ch * ch, sh * ch)
        square = omega1 * omega1
        condition = (a1 * fabs(at.sin_2) + a4 * fabs(at.sin_y) + fabs(h)) * fabs(at.per_l)   # (M1)
        return InvertedSliderMotion(
            theta1, omega1, alpha1,
            theta2=atan2(at.sin_2, at.cos_2), omega2=at.d_theta2 * omega1,
            alpha2=at.d_theta2 * alpha1 + at.dd_y * square,
            theta4=atan2(at.sin_y, at.cos_y), omega4=at.d_y * omega1,
            alpha4=at.d_y * alpha1 + at.dd_y * square,
            slide=unit * at.l, slide_velocity=unit * (at.d_l * omega1),
            slide_acceleration=unit * (at.d_l * alpha1 + at.dd_l * square),
            transmission_angle=atan2(fabs(at.l), h),
            crank_ratio=1.0, output_ratio=at.d_y, slide_ratio=unit * at.d_l, condition=condition,
            cos_x=at.cos_x, sin_x=at.sin_x, cos_y=at.cos_y, sin_y=at.sin_y, cos_2=at.cos_2,
            sin_2=at.sin_2)
    return motion


def make_slide_motion(n: NumberType, a1: Scalar, a4: Scalar, h: Scalar, sign: Scalar) -> Function:
    """Return the function (slide, velocity, acceleration) -> :class:`InvertedSliderMotion`."""
    atan2, fabs = n.atan2, n.fabs
    unit = n.power_of_two(a1, a4, h)
    a1, a4, h, per_unit = a1 / unit, a4 / unit, h / unit, 1.0 / unit
    hh, triangle = h * h, make_triangle(n, a4, a1, h, -sign)

    def motion(slide: Scalar, slide_velocity: Scalar,
               slide_acceleration: Scalar) -> InvertedSliderMotion:
        """Return the motion for a slide."""
        seen = triangle(slide * per_unit)
        v, a = slide_velocity * per_unit, slide_acceleration * per_unit
        square = v * v
        cos_x, sin_x, cos_y, sin_y = -seen.cos_2, -seen.sin_2, -seen.cos_x, seen.sin_x       # (M2)
        d_y, dd_y = -seen.d_x, -seen.dd_x
        ahead = a1 - a4 * cos_x
        condition = 2.0 * (a1 * fabs(ahead) + a4 * fabs(a4 - a1 * cos_x) + hh) * fabs(       # (M3)
            seen.per_root)
        return InvertedSliderMotion(
            theta1=atan2(sin_x, cos_x), omega1=seen.d_theta2 * v,
            alpha1=seen.d_theta2 * a + seen.dd_theta2 * square,
            theta2=-atan2(seen.sin_b, seen.cos_b), omega2=-seen.d_b * v,
            alpha2=-(seen.d_b * a + seen.dd_b * square),
            theta4=atan2(sin_y, cos_y), omega4=d_y * v, alpha4=d_y * a + dd_y * square,
            slide=slide, slide_velocity=slide_velocity, slide_acceleration=slide_acceleration,
            transmission_angle=atan2(a4 * fabs(sin_x), ahead),
            crank_ratio=seen.d_theta2 * per_unit, output_ratio=d_y * per_unit, slide_ratio=1.0,
            condition=condition, cos_x=cos_x, sin_x=sin_x, cos_y=cos_y, sin_y=sin_y,
            cos_2=seen.cos_b, sin_2=-seen.sin_b)
    return motion
