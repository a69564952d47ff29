# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How a link and a point fixed to it move: place, velocity and acceleration."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Scalar
import numpy as np

# Cosine and sine of the angle of a link, its first and second derivative.
Direction = tuple[Scalar, Scalar, Scalar, Scalar]


class LinkMotion(NamedTuple):
    """Motion of a link: of its first joint (O1, A; O4, or B of a slider) and its turning."""

    # At unit rate and zero acceleration of the input, its rates and accelerations are first and
    # second derivatives with respect to the input.
    x: Scalar                 # [m] of the first joint
    y: float
    v_x: Scalar               # [m/s]
    v_y: float
    a_x: Scalar               # [m/s^2]
    a_y: float
    cosine: Scalar            # direction of the link
    sine: float
    omega: Scalar             # [rad/s]
    alpha: Scalar             # [rad/s^2]

    @property
    def direction(self) -> Array:
        return vector(self.cosine, self.sine)

    def at(self, rate: Scalar, acceleration: Scalar) -> LinkMotion:
        """Return the motion at a rate and acceleration of the input, from that at unit rate."""
        square = rate * rate
        return LinkMotion(
            self.x, self.y, self.v_x * rate, self.v_y * rate,
            self.v_x * acceleration + self.a_x * square,
            self.v_y * acceleration + self.a_y * square, self.cosine, self.sine,
            self.omega * rate, self.omega * acceleration + self.alpha * square)


# Returns the motions of all links of a mechanism at unit rate, at an input.
Coefficients = Callable[[Scalar], Sequence[LinkMotion]]


# The ground as a link.
FIXED = LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


class Point(NamedTuple):
    """
    A point fixed to a link or the 'ground'.

    ``along``, ``across`` [m]: from the first joint of the link, along it and to its left; of the
    ground x and y.
    """

    link: str
    along: float = 0.0
    across: float = 0.0


class LinkFields(NamedTuple):
    """A :class:`LinkMotion` by its direction as an angle, as messages have it."""

    angle: float              # [rad] in (-pi, pi]
    angular_velocity: float   # [rad/s]
    angular_acceleration: float     # [rad/s^2]
    x: float                  # [m] of the first joint
    y: float
    velocity_x: float         # [m/s]
    velocity_y: float
    acceleration_x: float     # [m/s^2]
    acceleration_y: float


class PointMotion(NamedTuple):
    """
    Motion of a point; each field a float, or an array of the input's shape.

    The tangential and normal acceleration are the parts along the velocity and to its left; they
    and the curvature are NaN where the point rests.
    """

    x: float                  # [m]
    y: float
    velocity_x: float         # [m/s]
    velocity_y: float
    acceleration_x: float     # [m/s^2]
    acceleration_y: float
    speed: float              # [m/s]
    tangential_acceleration: float     # [m/s^2] d speed / dt, Eq. (2)
    normal_acceleration: float         # [m/s^2] speed^2 times curvature
    curvature: float          # [1/m] of the path, positive where it turns left

    def __repr__(self) -> str:
        return short_repr('PointMotion', self._asdict())

    @property
    def place(self) -> Array:
        """Return the place as a vector of shape (..., 2) [m]."""
        return vector(self.x, self.y)

    @property
    def velocity(self) -> Array:
        return vector(self.velocity_x, self.velocity_y)

    @property
    def acceleration(self) -> Array:
        return vector(self.acceleration_x, self.acceleration_y)


class MovingPoint(NamedTuple):
    """Place, velocity and acceleration of a point; or its derivatives, if its link has those."""

    x: Scalar
    y: Scalar
    v_x: Scalar
    v_y: Scalar
    a_x: Scalar
    a_y: Scalar


def between(first: MovingPoint, second: MovingPoint) -> MovingPoint:
    """Return the vector from the first point to the second, with its derivatives."""
    return MovingPoint(*[b - a for a, b in zip(first, second)])


def vector(x: Scalar | Array, y: Scalar | Array) -> Array:
    """Return components of one shape (...) as vectors of shape (..., 2)."""
    if isinstance(x, float) and isinstance(y, float):
        return np.array((x, y))                          # takes a tenth of the time
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def point_of(link: LinkMotion, along: Scalar, across: Scalar = 0.0) -> MovingPoint:
    """Return place, velocity and acceleration of a point of a link, slides Eq. (6)."""
    # link: a LinkMotion; if it has derivatives by the input in place of rates, so has the point.
    # along, across [m]: from the first joint of the link along it, and to its left.
    cosine, sine, omega, alpha = link.cosine, link.sine, link.omega, link.alpha
    x, y = along * cosine - across * sine, along * sine + across * cosine
    square = omega * omega
    return MovingPoint(link.x + x, link.y + y, link.v_x - omega * y, link.v_y + omega * x,
                       link.a_x - alpha * y - square * x, link.a_y + alpha * x - square * y)
