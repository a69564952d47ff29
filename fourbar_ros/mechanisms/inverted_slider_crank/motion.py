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

Crank input. With q = |A O4|^2 and the half-angle of x, as in the 4R:

    (M1)  l^2 = ((a1-a4)^2 - h^2) cos^2(x/2) + ((a1+a4)^2 - h^2) sin^2(x/2)
    (M2)  l' = a1 a4 sin x / l
    (M3)  l'' = a1 a4 (((a1-a4)^2 - h^2) cos^4(x/2) - ((a1+a4)^2 - h^2) sin^4(x/2)) / l^3
    (M4)  y' = (a1 (a1 - a4 cos x) + h l') / q
    (M5)  theta2' = y' - 1 = (a4 (a1 cos x - a4) + h l') / q
    (M6)  y'' = (a1 a4 sin x (a4^2 - a1^2 - 2 h l')/q + h l'') / q
    (M7)  condition = (a1 |sin theta2| + a4 |sin y| + |h|) / |l|

Slide input: an observer on the bar sees a slider-crank, with a4 for its crank, a1 for its coupler,
h for its offset and A for its slider. So the angles are those of
:mod:`fourbar_ros.mechanisms.slide_dyad`, (T1) to (T8), turned back:

    (M8)  y = pi - x_seen,   theta1 = pi + theta2_seen,   theta2 = y - theta1 = -b_seen
    (M9)  condition = 2 (a1 |a1 - a4 cos x| + a4 |a4 - a1 cos x| + h^2) / |root|
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanisms.slide_dyad import make_triangle
from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.number_types import Function, NumberType


class InvertedSliderMotion(NamedTuple):
    """
    Pose, rates and accelerations for one input.

    Each field a float, or an array of the input's shape.

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


def make_crank_motion(n: NumberType, a1: Any, a4: Any, h: Any, sign: Any) -> Function:
    """Return the function (theta1, omega1, alpha1) -> fields of :class:`InvertedSliderMotion`."""
    sin, cos, sqrt, atan2, fabs, infinitesimal = (n.sin, n.cos, n.sqrt, n.atan2, n.fabs,
                                                  n.infinitesimal)
    unit = n.power_of_two(a1, a4, h)
    a1, a4, h = a1 / unit, a4 / unit, h / unit
    a1_a4, less, more, two_h = a1 * a4, a1 - a4, a1 + a4, 2.0 * h
    # of squares
    q_near, q_far, a4_minus_a1 = (a1 - a4)**2, (a1 + a4)**2, (a4 - a1) * (a4 + a1)
    near = difference_of_squares(a1, -a4, h, 0.0, n.exact_sum)
    far = difference_of_squares(a1, a4, h, 0.0, n.exact_sum)

    def motion(theta1: Any, omega1: Any, alpha1: Any) -> tuple[Any, ...]:
        half = 0.5 * theta1
        sh, ch = sin(half) + infinitesimal, cos(half)
        ss, cc, sc = sh * sh, ch * ch, sh * ch
        cos_x, sin_x = cc - ss, sc + sc
        l = sign * sqrt(near * cc + far * ss)  # (M1)  # noqa: E741, the slides' letter
        q = q_near * cc + q_far * ss
        per_q, per_l = 1.0 / q, 1.0 / l
        r_x, r_y = less * cc - more * ss, a1 * sin_x     # A - O4
        ahead = less * cc + more * ss                    # a1 - a4 cos x
        cos_y, sin_y = (r_x * l + r_y * h) * per_q, (r_y * l - r_x * h) * per_q
        cos_2, sin_2 = (ahead * l + a4 * h * sin_x) * per_q, (a4 * l * sin_x - ahead * h) * per_q
        pull = a1_a4 * sin_x
        d_l = pull * per_l                                                              # (M2)
        dd_l = a1_a4 * (near * cc * cc - far * ss * ss) * per_l * per_l * per_l         # (M3)
        output_ratio = (a1 * ahead + h * d_l) * per_q                                   # (M4)
        d_theta2 = (a4 * r_x + h * d_l) * per_q                                         # (M5)
        dd_y = (pull * (a4_minus_a1 - two_h * d_l) * per_q + h * dd_l) * per_q          # (M6)
        condition = (a1 * fabs(sin_2) + a4 * fabs(sin_y) + fabs(h)) * fabs(per_l)       # (M7)

        square = omega1 * omega1
        theta2, omega2, alpha2 = (atan2(sin_2, cos_2), d_theta2 * omega1,
                                  d_theta2 * alpha1 + dd_y * square)
        theta4, omega4, alpha4 = (atan2(sin_y, cos_y), output_ratio * omega1, output_ratio * alpha1
                                  + dd_y * square)
        slide, slide_velocity, slide_acceleration = (unit * l, unit * (d_l * omega1),
                                                     unit * (d_l * alpha1 + dd_l * square))
        crank_ratio, slide_ratio, transmission_angle = 1.0, unit * d_l, atan2(fabs(l), h)
        return (theta1, omega1, alpha1, theta2, omega2, alpha2, theta4, omega4, alpha4,
                slide, slide_velocity, slide_acceleration,
                transmission_angle, crank_ratio, output_ratio, slide_ratio, condition,
                cos_x, sin_x, cos_y, sin_y, cos_2, sin_2)
    return motion


def make_slide_motion(n: NumberType, a1: Any, a4: Any, h: Any, sign: Any) -> Function:
    """Return (slide, velocity, acceleration) -> fields of :class:`InvertedSliderMotion`."""
    atan2, fabs = n.atan2, n.fabs
    unit = n.power_of_two(a1, a4, h)
    a1, a4, h, per_unit = a1 / unit, a4 / unit, h / unit, 1.0 / unit
    hh, triangle = h * h, make_triangle(n, a4, a1, h, -sign)

    def motion(slide: Any, slide_velocity: Any, slide_acceleration: Any) -> tuple[Any, ...]:
        (seen_cos_x, seen_sin_x, seen_cos_b, seen_sin_b, seen_cos_2, seen_sin_2, seen_d_x, d_b,
         d_x, seen_dd_x, dd_b, dd_x,
         per_root) = triangle(slide * per_unit)
        cos_x, sin_x, cos_y, sin_y = -seen_cos_2, -seen_sin_2, -seen_cos_x, seen_sin_x  # (M8)
        cos_2, sin_2, d_y, dd_y = seen_cos_b, -seen_sin_b, -seen_d_x, -seen_dd_x
        v, a = slide_velocity * per_unit, slide_acceleration * per_unit
        square = v * v
        ahead = a1 - a4 * cos_x
        theta1, omega1, alpha1 = atan2(sin_x, cos_x), d_x * v, d_x * a + dd_x * square
        theta2, omega2, alpha2 = -atan2(seen_sin_b, seen_cos_b), -d_b * v, -(d_b * a + dd_b
                                                                             * square)
        theta4, omega4, alpha4 = atan2(sin_y, cos_y), d_y * v, d_y * a + dd_y * square
        transmission_angle = atan2(a4 * fabs(sin_x), ahead)
        crank_ratio, output_ratio, slide_ratio = d_x * per_unit, d_y * per_unit, 1.0
        # (M9)
        condition = 2.0 * (a1 * fabs(ahead) + a4 * fabs(a4 - a1 * cos_x) + hh) * fabs(per_root)
        return (theta1, omega1, alpha1, theta2, omega2, alpha2, theta4, omega4, alpha4,
                slide, slide_velocity, slide_acceleration,
                transmission_angle, crank_ratio, output_ratio, slide_ratio, condition,
                cos_x, sin_x, cos_y, sin_y, cos_2, sin_2)
    return motion
