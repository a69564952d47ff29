# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of the 4R linkage: of its loop (:mod:`fourbar_ros.mechanisms.loop`), for a given input.

Angles in [-pi, pi]; rates are ratios times that of the input, accelerations the ratio times its
acceleration plus the second derivative times its rate squared.
"""
from __future__ import annotations

from math import pi
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.loop import make_loop
from fourbar_ros.numerics.number_types import Function, NumberType


class Motion(NamedTuple):
    """
    Pose, rates and accelerations for one input.

    Each field a float, or an array of the input's shape.

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


def make_motion(n: NumberType, a1: Any, a2: Any, a3: Any, a4: Any, sign: Any) -> Function:
    """
    Return the function (theta1, omega1, alpha1) -> fields of :class:`Motion` for fixed lengths.

    ``sign`` is the sign of sin(theta4 - beta): +1 for mode 2 (open), -1 for mode 1 (crossed).
    """
    sin, cos, atan2, infinitesimal, straight = n.sin, n.cos, n.atan2, n.infinitesimal, sign * pi
    loop = make_loop(n, a1, a2, a3, a4, sign)

    def motion(theta1: Any, omega1: Any, alpha1: Any) -> tuple[Any, ...]:
        half = 0.5 * theta1
        sh, ch = sin(half) + infinitesimal, cos(half)
        (cos_x, sin_x, cos_bx, sin_bx, cos_b, sin_b, cos_y, sin_y, cos_mu, sin_mu, d_theta2,
         d_theta3, velocity_ratio, coupler_ratio, dd_mu, dd_y, dd_b,
         condition) = loop(sh * sh, ch * ch, sh * ch)
        mu, square = atan2(sin_mu, cos_mu), omega1 * omega1
        transmission_angle = sign * mu
        theta2, omega2 = atan2(sin_bx, cos_bx), d_theta2 * omega1
        theta3, omega3 = mu - straight, d_theta3 * omega1
        theta4, omega4 = atan2(sin_y, cos_y), velocity_ratio * omega1
        beta, omega_beta = atan2(sin_b, cos_b), coupler_ratio * omega1
        alpha2, alpha3 = d_theta2 * alpha1 + dd_b * square, d_theta3 * alpha1 + dd_mu * square
        alpha4 = velocity_ratio * alpha1 + dd_y * square
        alpha_beta = coupler_ratio * alpha1 + dd_b * square
        return (theta1, omega1, alpha1, theta2, omega2, alpha2, theta3, omega3, alpha3,
                theta4, omega4, alpha4, beta, omega_beta, alpha_beta,
                transmission_angle, velocity_ratio, coupler_ratio, condition,
                cos_x, sin_x, cos_b, sin_b, cos_y, sin_y, cos_mu, sin_mu)
    return motion
