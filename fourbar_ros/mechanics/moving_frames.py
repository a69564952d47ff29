# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Moving frames: velocity and acceleration of a point seen from a frame that moves and turns.

Slides, Eqs. (9)-(15). Vectors are arrays of shape (2,) or (..., 2) along the ground axes; angular
rates and accelerations are about z, counter-clockwise positive, floats or arrays that broadcast
with ``...``.
"""
from __future__ import annotations

from math import inf
from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array, Value
import numpy as np
from numpy.typing import ArrayLike


class AccelerationTerms(NamedTuple):
    """The five terms of Eq. (9), each of shape (..., 2) [m/s^2]; their sum is the acceleration."""

    of_origin: Array      # A_A
    relative: Array       # A_rel, seen in the moving frame
    tangential: Array     # alpha x r
    normal: Array         # omega x (omega x r)
    coriolis: Array       # 2 omega x V_rel


class RollingContact(NamedTuple):
    """
    A disc that rolls on the ground.

    Its centre, and its point in contact, whose velocity is zero.
    """

    centre_velocity: Array         # [m/s]
    centre_acceleration: Array     # [m/s^2]
    contact_acceleration: Array    # [m/s^2] the rolling acceleration of Eq. (14)


def turned(rate: ArrayLike, r: ArrayLike) -> Array:
    """
    Return rate x r, the vector r turned by a right angle and scaled.

    Parameters
    ----------
    rate : float or array_like, shape (...)
        Component along z.
    r : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (..., 2)

    """
    rate, r = np.asarray(rate), np.asarray(r)
    return np.stack(np.broadcast_arrays(-rate * r[..., 1], rate * r[..., 0]), axis=-1)


def scaled(factor: ArrayLike, r: ArrayLike) -> Array:
    """Return factor * r for a factor of shape (...) and vectors of shape (..., 2)."""
    result: Array = np.asarray(factor)[..., None] * np.asarray(r)
    return result


def relative_velocity(v_a: ArrayLike, omega: ArrayLike, r: ArrayLike,
                      v_rel: ArrayLike = (0.0, 0.0)) -> Array:
    """
    Return V_B = V_A + omega x r + V_rel (slides, before Eq. (9)).

    Parameters
    ----------
    v_a : array_like, shape (..., 2)
        Velocity of the origin A of the moving frame [m/s].
    omega : float or array_like, shape (...)
        Angular velocity of the frame [rad/s].
    r : array_like, shape (..., 2)
        From A to B [m].
    v_rel : array_like, shape (..., 2)
        Velocity of B as seen in the frame [m/s]; zero: B is fixed in it.

    Returns
    -------
    ndarray, shape (..., 2)
        [m/s]

    """
    velocity: Array = np.asarray(v_a) + turned(omega, r) + np.asarray(v_rel)
    return velocity


def acceleration_terms(a_a: ArrayLike, omega: ArrayLike, alpha: ArrayLike, r: ArrayLike,
                       v_rel: ArrayLike = (0.0, 0.0),
                       a_rel: ArrayLike = (0.0, 0.0)) -> AccelerationTerms:
    """
    Return each term of Eq. (9): for polygons, and to see how large each one is.

    Parameters
    ----------
    a_a : array_like, shape (..., 2)
        Acceleration of the origin A of the moving frame [m/s^2].
    omega, alpha : float or array_like, shape (...)
        Angular velocity [rad/s] and acceleration [rad/s^2] of the frame.
    r, v_rel, a_rel : array_like, shape (..., 2)
        From A to B [m]; velocity [m/s] and acceleration [m/s^2] of B as seen in the frame.

    """
    return AccelerationTerms(np.asarray(a_a), np.asarray(a_rel), turned(alpha, r),
                             scaled(-np.square(omega), r), coriolis_acceleration(omega, v_rel))


def relative_acceleration(a_a: ArrayLike, omega: ArrayLike, alpha: ArrayLike, r: ArrayLike,
                          v_rel: ArrayLike = (0.0, 0.0), a_rel: ArrayLike = (0.0, 0.0)) -> Array:
    """
    Return A_B, Eqs.

    (9) and (10), with (6) as the case of a B fixed in the frame; see acceleration_terms.
    """
    terms = acceleration_terms(a_a, omega, alpha, r, v_rel, a_rel)
    of_frame = terms.tangential + terms.normal
    total: Array = (terms.of_origin + terms.relative) + of_frame + terms.coriolis
    return total


def coriolis_acceleration(omega: ArrayLike, v_rel: ArrayLike) -> Array:
    """Return 2 omega x V_rel: V_rel turned by 90 deg in the sense of omega [m/s^2]."""
    return turned(2.0 * np.asarray(omega), v_rel)


def coincident_acceleration(a_p: ArrayLike, omega: ArrayLike, v_rel: ArrayLike,
                            a_rel: ArrayLike = (0.0, 0.0)) -> Array:
    """Return A_B from that of the point P of the frame that B passes over, Eq. (11) [m/s^2]."""
    acceleration: Array = np.asarray(a_p) + coriolis_acceleration(omega, v_rel) + np.asarray(a_rel)
    return acceleration


def path_acceleration(tangent: ArrayLike, speed: ArrayLike, growth: ArrayLike,
                      curvature: ArrayLike) -> Array:
    """
    Return the acceleration along a path, Eq. (2): growth along it, speed^2 curvature to its left.

    Parameters
    ----------
    tangent : array_like, shape (..., 2)
        Unit vector along the path.
    speed, growth : float or array_like, shape (...)
        ds/dt [m/s] and d^2s/dt^2 [m/s^2].
    curvature : float or array_like, shape (...)
        1/radius [1/m], positive where the path turns left.

    """
    return scaled(growth, tangent) + turned(np.square(speed) * curvature, tangent)


def apparent_angular_acceleration(alpha3: Value, alpha2: Value) -> Value:
    """Return alpha_3/2 = alpha3 - alpha2 of link 3 as seen from link 2, Eq. (12) [rad/s^2]."""
    return alpha3 - alpha2


def rolling_contact(omega: ArrayLike, alpha: ArrayLike, radius: float, normal: ArrayLike,
                    ground_radius: float = inf) -> RollingContact:
    """
    Return the :class:`RollingContact` of a disc that rolls without slip on fixed ground, Eqs.

    (13)-(15).

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
    # the centre moves on a circle of ground_radius + radius
    hollow = radius / (ground_radius + radius)
    towards_ground = scaled(-np.square(omega) * hollow, arm)
    centre = turned(alpha, arm) + towards_ground
    return RollingContact(turned(omega, arm), centre,
                          relative_acceleration(centre, omega, alpha, -arm))
