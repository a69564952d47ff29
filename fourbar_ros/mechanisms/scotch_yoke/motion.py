# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Position, velocity and acceleration of the Scotch yoke.

O1 = (0, 0); crank O1-A of length a1; the block at its pin A slides in a straight slot of the yoke,
square to the guide y = offset on which the yoke slides. With x = theta1, s = slide, t = slot (of A
above the guide):

    (M1)  s + i (t + e) = a1 e^{ix}

Primes are derivatives with respect to the input. Crank input, harmonic motion:

    (M2)  s' = -a1 sin x,   s'' = -a1 cos x
    (M3)  t' = a1 cos x,    t'' = -a1 sin x
    (M4)  condition of s = a1 |cos x|

Slide input, with root = a1 sin x of the sign of the assembly mode:

    (M5)  root^2 = (a1 - s)(a1 + s)
    (M6)  x' = -1 / root,   x'' = -s / root^3
    (M7)  t' = -s / root,   t'' = -a1^2 / root^3
    (M8)  condition of x = |s / root|
"""
from __future__ import annotations

from math import pi
from typing import NamedTuple

from fourbar_ros.numerics.number_types import Function, NumberType, Scalar


class ScotchYokeMotion(NamedTuple):
    """
    Pose, rates and accelerations; each field a float, or an array of the input's shape.

    Angles [rad], in [-pi, pi] but for a theta1 that is the input; theta2 is relative (block to
    crank):
    theta1 + theta2 = pi/2.
    """

    theta1: float
    omega1: float
    alpha1: float
    theta2: float
    omega2: float
    alpha2: float
    slide: float                   # [m] of the yoke along the guide
    slide_velocity: float          # [m/s]
    slide_acceleration: float      # [m/s^2]
    slot: float                    # [m] of the block along the slot, from the guide
    slot_velocity: float           # [m/s]
    slot_acceleration: float       # [m/s^2]
    # [rad] in [0, pi]: of the slot's normal and the motion of what is driven by it
    transmission_angle: float
    crank_ratio: float             # d theta1, d slide over d input
    slide_ratio: float
    # relative error of the lengths -> error of slide [m] (of theta1 [rad])
    condition: float
    cos_x: float                   # direction of the crank
    sin_x: float


def make_crank_motion(n: NumberType, a1: Scalar, e: Scalar, sign: Scalar) -> Function:
    """Return the function (theta1, omega1, alpha1) -> :class:`ScotchYokeMotion`."""
    sin, cos, atan2, fabs = n.sin, n.cos, n.atan2, n.fabs

    def motion(theta1: Scalar, omega1: Scalar, alpha1: Scalar) -> ScotchYokeMotion:
        """Return the motion for a crank angle."""
        cos_x, sin_x = cos(theta1), sin(theta1)
        slide, rise, square = a1 * cos_x, a1 * sin_x, omega1 * omega1                   # (M1)
        return ScotchYokeMotion(
            theta1, omega1, alpha1, theta2=atan2(cos_x, sin_x), omega2=-omega1, alpha2=-alpha1,
            slide=slide, slide_velocity=-rise * omega1,                                 # (M2)
            slide_acceleration=-rise * alpha1 - slide * square,
            slot=rise - e, slot_velocity=slide * omega1,                                # (M3)
            slot_acceleration=slide * alpha1 - rise * square,
            transmission_angle=0.5 * pi, crank_ratio=1.0, slide_ratio=-rise,
            condition=fabs(slide), cos_x=cos_x, sin_x=sin_x)                            # (M4)
    return motion


def make_slide_motion(n: NumberType, a1: Scalar, e: Scalar, sign: Scalar) -> Function:
    """Return the function (slide, velocity, acceleration) -> :class:`ScotchYokeMotion`."""
    sqrt, atan2, fabs = n.sqrt, n.atan2, n.fabs
    unit = n.power_of_two(a1, e)
    a1, e, per_unit = a1 / unit, e / unit, 1.0 / unit
    per_a1, square_1 = 1.0 / a1, a1 * a1

    def motion(slide: Scalar, slide_velocity: Scalar,
               slide_acceleration: Scalar) -> ScotchYokeMotion:
        """Return the motion for a slide."""
        s, v, a = slide * per_unit, slide_velocity * per_unit, slide_acceleration * per_unit
        square = v * v
        root = sign * sqrt((a1 - s) * (a1 + s))                                         # (M5)
        cos_x, sin_x = s * per_a1 + 0.0 * root, root * per_a1     # NaN too where nothing is real
        per = 1.0 / root
        cube, d_t = per * per * per, -s * per                                           # (M7)
        theta1 = atan2(sin_x, cos_x)
        omega1, alpha1 = -per * v, -per * a - s * cube * square                         # (M6)
        return ScotchYokeMotion(
            theta1, omega1, alpha1, theta2=atan2(cos_x, sin_x), omega2=-omega1, alpha2=-alpha1,
            slide=slide, slide_velocity=slide_velocity, slide_acceleration=slide_acceleration,
            slot=unit * (root - e), slot_velocity=unit * (d_t * v),
            slot_acceleration=unit * (d_t * a - square_1 * cube * square),
            transmission_angle=fabs(theta1), crank_ratio=-per * per_unit, slide_ratio=1.0,
            condition=fabs(d_t), cos_x=cos_x, sin_x=sin_x)                              # (M8)
    return motion
