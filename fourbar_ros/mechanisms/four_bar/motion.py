# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of the 4R linkage: of its loop (:mod:`fourbar_ros.mechanisms.loop`), for a given input.

Angles in [-pi, pi]; rates are ratios times that of the input, accelerations the ratio times its
acceleration plus the second derivative times its rate squared.
"""
from __future__ import annotations

from math import pi
from typing import NamedTuple

from fourbar_ros.mechanisms.loop import make_loop
from fourbar_ros.numerics.number_types import Function, nudge, NumberType, Scalar


class Motion(NamedTuple):
    """
    Pose, rates and accelerations; each field a float, or an array of the input's shape.

    Angles in [rad], rates in [rad/s], accelerations in [rad/s^2]; angles other than theta1 lie in
    [-pi, pi]. theta2 and theta3 are relative (coupler to crank, output link to coupler): theta1 +
    theta2 + theta3 = theta4 + pi.
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
    theta4: float
    omega4: float
    alpha4: float
    beta: float                  # absolute coupler angle
    omega_beta: float
    alpha_beta: float
    transmission_angle: float    # [rad] |theta4 - beta|, in [0, pi]
    velocity_ratio: float        # d theta4 / d theta1
    coupler_ratio: float         # d beta / d theta1
    condition: float             # relative error of the lengths -> error of theta4 [rad]
    # directions of crank, coupler, output link and of mu = theta4 - beta
    cos_x: float
    sin_x: float
    cos_b: float
    sin_b: float
    cos_y: float
    sin_y: float
    cos_mu: float
    sin_mu: float


class Loads(NamedTuple):
    """
    Loads for one input; each field a float, or an array of the input's shape.

    fij = force of link i ON link j (1 crank, 2 coupler, 3 output link, 4 ground) along the ground
    axes (x from O1 to O4); fji = -fij. Forces in [N], moments in [N m], counter-clockwise
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
    driving_torque: float     # T41, of the drive on the crank, or on the next link at A or B
    shaking_force_x: float    # F14 + F34, on the ground
    shaking_force_y: float
    shaking_force: float      # magnitude
    shaking_moment: float     # on the ground about O1: T14 + (O4 - O1) x F34


def make_motion(n: NumberType, a1: Scalar, a2: Scalar, a3: Scalar, a4: Scalar,
                sign: Scalar) -> Function:
    """
    Return the function (theta1, omega1, alpha1) -> :class:`Motion` for fixed lengths.

    Crank a1, coupler a2, output link a3, ground a4; x, b and y are the angles theta1, beta and
    theta4, mu is theta4 - beta, d_ and dd_ derivatives with respect to x. ``sign`` is that of sin
    mu: +1 for mode 2 (open), -1 for mode 1 (crossed).
    """
    sin, cos, atan2, straight = n.sin, n.cos, n.atan2, sign * pi
    # infinitesimal where the links lie flat at theta1 = 0, for the pose just beside it; else 0
    beside_0 = nudge(n, n.exact_sum((a1, -a4, a2, -a3)), n.exact_sum((a1, -a4, -a2, a3)))
    loop = make_loop(n, a1, a2, a3, a4, sign)

    def motion(theta1: Scalar, omega1: Scalar, alpha1: Scalar) -> Motion:
        """Return pose, rates and accelerations for theta1 [rad], omega1 and alpha1."""
        half = 0.5 * theta1
        sh, ch = sin(half) + beside_0, cos(half)
        at = loop(sh * sh, ch * ch, sh * ch)
        mu, square = atan2(at.sin_mu, at.cos_mu), omega1 * omega1
        return Motion(
            theta1, omega1, alpha1,
            theta2=atan2(at.sin_bx, at.cos_bx), omega2=at.d_bx * omega1,
            alpha2=at.d_bx * alpha1 + at.dd_b * square,
            theta3=mu - straight, omega3=at.d_mu * omega1,
            alpha3=at.d_mu * alpha1 + at.dd_mu * square,
            theta4=atan2(at.sin_y, at.cos_y), omega4=at.d_y * omega1,
            alpha4=at.d_y * alpha1 + at.dd_y * square,
            beta=atan2(at.sin_b, at.cos_b), omega_beta=at.d_b * omega1,
            alpha_beta=at.d_b * alpha1 + at.dd_b * square,
            transmission_angle=sign * mu, velocity_ratio=at.d_y, coupler_ratio=at.d_b,
            condition=at.condition, cos_x=at.cos_x, sin_x=at.sin_x, cos_b=at.cos_b,
            sin_b=at.sin_b, cos_y=at.cos_y, sin_y=at.sin_y, cos_mu=at.cos_mu, sin_mu=at.sin_mu)
    return motion
