# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Moving frames: the acceleration of a point seen from a frame that moves and turns.

Slides, Eq. (9). Vectors are arrays of shape (2,) or (..., 2) along the ground axes; angular
rates and accelerations are about z, counter-clockwise positive, floats or arrays that broadcast
with ``...``.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array
import numpy as np
from numpy.typing import ArrayLike


class AccelerationTerms(NamedTuple):
    """The five terms of Eq. (9), each of shape (..., 2) [m/s^2]; their sum is the acceleration."""

    of_origin: Array      # A_A
    relative: Array       # A_rel, seen in the moving frame
    tangential: Array     # alpha x r
    normal: Array         # omega x (omega x r)
    coriolis: Array       # 2 omega x V_rel


def turned(rate: ArrayLike, r: ArrayLike) -> Array:
    """Return rate x r for rates about z of shape (...) and vectors of shape (..., 2)."""
    rate, r = np.asarray(rate), np.asarray(r)
    return np.stack(np.broadcast_arrays(-rate * r[..., 1], rate * r[..., 0]), axis=-1)


def scaled(factor: ArrayLike, r: ArrayLike) -> Array:
    """Return factor * r for a factor of shape (...) and vectors of shape (..., 2)."""
    result: Array = np.asarray(factor)[..., None] * np.asarray(r)
    return result


def acceleration_terms(a_a: ArrayLike, omega: ArrayLike, alpha: ArrayLike, r: ArrayLike,
                       v_rel: ArrayLike = (0.0, 0.0),
                       a_rel: ArrayLike = (0.0, 0.0)) -> AccelerationTerms:
    """
    Return each term of Eq. (9) [m/s^2]: for polygons, and to see how large each one is.

    ``a_a`` is the acceleration of the origin A of the moving frame [m/s^2], omega [rad/s] and
    alpha [rad/s^2] turn the frame, r [m] leads from A to B, and ``v_rel`` [m/s] and ``a_rel``
    [m/s^2] are velocity and acceleration of B as seen in the frame. Vectors of shape (..., 2).
    """
    return AccelerationTerms(np.asarray(a_a), np.asarray(a_rel), turned(alpha, r),
                             scaled(-np.square(omega), r), coriolis_acceleration(omega, v_rel))


def coriolis_acceleration(omega: ArrayLike, v_rel: ArrayLike) -> Array:
    """Return 2 omega x V_rel: V_rel turned by 90 deg in the sense of omega [m/s^2]."""
    return turned(2.0 * np.asarray(omega), v_rel)
