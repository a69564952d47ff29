# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Velocity and acceleration in moving frames, as the slides have them, Eqs. (9)-(15).

Vectors are arrays of shape (2,) or (..., 2) along the ground axes; angular rates and accelerations
are about z, counter-clockwise positive, floats or arrays that broadcast with ``...``.
"""
from __future__ import annotations

from math import inf
from typing import NamedTuple

from fourbar_ros.mechanics.moving_frames import (
    acceleration_terms,
    coriolis_acceleration,
    scaled,
    turned,
)
from fourbar_ros.numerics.arrays import Array, Value
import numpy as np
from numpy.typing import ArrayLike


class RollingContact(NamedTuple):
    """A disc that rolls on the ground: its centre, and its point in contact, which is at rest."""

    centre_velocity: Array         # [m/s]
    centre_acceleration: Array     # [m/s^2]
    contact_acceleration: Array    # [m/s^2] the rolling acceleration of Eq. (14)


def relative_velocity(v_a: ArrayLike, omega: ArrayLike, r: ArrayLike,
                      v_rel: ArrayLike = (0.0, 0.0)) -> Array:
    """
    Return V_B = V_A + omega x r + V_rel [m/s], shape (..., 2) (slides, before Eq. (9)).

    A is the origin of the moving frame, r [m] leads from A to B, omega [rad/s] is the turning of
    the frame, and V_rel the velocity of B as seen in it: zero if B is fixed in it.
    """
    velocity: Array = np.asarray(v_a) + turned(omega, r) + np.asarray(v_rel)
    return velocity


def relative_acceleration(a_a: ArrayLike, omega: ArrayLike, alpha: ArrayLike, r: ArrayLike,
                          v_rel: ArrayLike = (0.0, 0.0), a_rel: ArrayLike = (0.0, 0.0)) -> Array:
    """
    Return A_B [m/s^2], the sum of the terms of :func:`acceleration_terms`: Eqs. (9) and (10).

    Without ``v_rel`` and ``a_rel`` B is fixed in the frame: Eq. (6).
    """
    terms = acceleration_terms(a_a, omega, alpha, r, v_rel, a_rel)
    of_frame = terms.tangential + terms.normal
    total: Array = (terms.of_origin + terms.relative) + of_frame + terms.coriolis
    return total


def coincident_acceleration(a_p: ArrayLike, omega: ArrayLike, v_rel: ArrayLike,
                            a_rel: ArrayLike = (0.0, 0.0)) -> Array:
    """Return A_B = A_P + 2 omega x V_rel + A_rel [m/s^2], P of the frame under B, Eq. (11)."""
    acceleration: Array = np.asarray(a_p) + coriolis_acceleration(omega, v_rel) + np.asarray(a_rel)
    return acceleration


def path_acceleration(tangent: ArrayLike, speed: ArrayLike, growth: ArrayLike,
                      curvature: ArrayLike) -> Array:
    """
    Return the acceleration [m/s^2] of a point on a path with a unit ``tangent``, Eq. (2).

    ``growth``, d^2s/dt^2 [m/s^2], along the path, and speed^2 times ``curvature`` to its left;
    the curvature is 1/radius [1/m], positive where the path turns left.
    """
    return scaled(growth, tangent) + turned(np.square(speed) * curvature, tangent)


def apparent_angular_acceleration(alpha3: Value, alpha2: Value) -> Value:
    """Return alpha_3/2 = alpha3 - alpha2 of link 3 as seen from link 2, Eq. (12) [rad/s^2]."""
    return alpha3 - alpha2


def rolling_contact(omega: ArrayLike, alpha: ArrayLike, radius: float, normal: ArrayLike,
                    ground_radius: float = inf) -> RollingContact:
    """
    Return the motion of a disc that rolls without slip on fixed ground, Eqs. (13) to (15).

    The contact point has no tangential acceleration: all of it is the rolling acceleration, along
    the normal and towards the centre of the disc for ground that is flat or convex.

    Parameters
    ----------
    omega, alpha : float or array_like, shape (...)
        Angular velocity and acceleration of the disc [rad/s], [rad/s^2].
    radius : float
        Radius of the disc [m].
    normal : array_like, shape (..., 2)
        Unit vector from the contact to the centre of the disc.
    ground_radius : float
        Radius of the ground [m]: infinite if flat, positive if convex, negative if the disc rolls
        inside a ring (then longer than the disc's).

    """
    arm = scaled(radius, normal)
    velocity = turned(omega, arm)
    # the centre moves on a circle of ground_radius + radius: v^2 / that, towards the ground
    centripetal = scaled(-np.square(omega) * (radius / (ground_radius + radius)), arm)
    acceleration = turned(alpha, arm) + centripetal
    return RollingContact(velocity, acceleration,
                          relative_acceleration(acceleration, omega, alpha, -arm))
