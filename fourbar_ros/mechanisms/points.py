# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Any point fixed to any link of any mechanism.

Path, velocity, acceleration, and its polygon's image.

A point is given as a centre of gravity is: along the link from its first joint, and across to its
left.
From the fields of a motion alone, so a point costs nothing until it is asked for.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, nan
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.given import number
from fourbar_ros.numerics.number_types import ARRAY, Function, NumberType, REAL, Scalar
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Mechanism
    from fourbar_ros.mechanisms.parts import NamedFields


class LinkMotion(NamedTuple):
    """
    Motion of a link: of its first joint (O1, A; O4, or B of a slider) and its turning.

    Of any numbers that the fields of the motion are. At unit rate and zero acceleration of the
    input, its rates and accelerations are first and second derivatives with respect to the input.
    """

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
        """Return the direction of the link as a unit vector of shape (..., 2)."""
        return vector(self.cosine, self.sine)


# The numbers of a LinkMotion, and the function that gives them for all links of a mechanism at a
# value of its input, as derivatives with respect to that.
Curve = tuple[Scalar, Scalar, Scalar, Scalar, Scalar, Scalar, Scalar, Scalar, Scalar, Scalar]
Coefficients = Callable[[Scalar], Sequence[Curve]]
# The ground as a link.
FIXED = LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


class MovingPoint(NamedTuple):
    """
    Place, velocity and acceleration of a point of a link.

    Or place and derivatives with respect to the input, if the link's motion is one of these.
    """

    x: Scalar
    y: Scalar
    v_x: Scalar
    v_y: Scalar
    a_x: Scalar
    a_y: Scalar


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


def link_fields(mechanism: Mechanism, motion: NamedFields, link: str) -> LinkFields:
    """Return the :class:`LinkFields` of a link in one sample of a motion."""
    x, y, v_x, v_y, a_x, a_y, cosine, sine, omega, alpha = link_motion(mechanism, motion, link)
    return LinkFields(atan2(sine, cosine), omega, alpha, x, y, v_x, v_y, a_x, a_y)


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

    @property
    def place(self) -> Array:
        """Return the place as a vector of shape (..., 2) [m]."""
        return vector(self.x, self.y)

    @property
    def velocity(self) -> Array:
        """Return the velocity as a vector of shape (..., 2) [m/s]."""
        return vector(self.velocity_x, self.velocity_y)

    @property
    def acceleration(self) -> Array:
        """Return the acceleration as a vector of shape (..., 2) [m/s^2]."""
        return vector(self.acceleration_x, self.acceleration_y)


def vector(x: Scalar | Array, y: Scalar | Array) -> Array:
    """Return components of one shape (...) as vectors of shape (..., 2)."""
    if isinstance(x, float) and isinstance(y, float):
        return np.array((x, y))                          # a tenth of the time
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def link_motion(mechanism: Mechanism, motion: NamedFields, link: str) -> LinkMotion:
    """
    Return the :class:`LinkMotion` of a link.

    Parameters
    ----------
    mechanism : Mechanism
    motion : Motion of that mechanism
        One sample or arrays.
    link : str
        Name of one of its ``LINKS``: the coupler of an inverted slider is its block, the output of
        a slider-crank its slider, of an inverted one its bar.

    """
    return mechanism.link_motion(motion, mechanism.link(link).name)


def point_of(link: Curve, along: Scalar,
             across: Scalar = 0.0) -> MovingPoint:
    """
    Return the :class:`MovingPoint` of a link, slides Eq. (6).

    Plain arithmetic, for whatever numbers the LinkMotion is made of; with derivatives by the input
    in place of those by time it gives these of the point.
    """
    x0, y0, v_x, v_y, a_x, a_y, cosine, sine, omega, alpha = link
    x, y = along * cosine - across * sine, along * sine + across * cosine
    square = omega * omega
    return MovingPoint(x0 + x, y0 + y, v_x - omega * y, v_y + omega * x,
                       a_x - alpha * y - square * x, a_y + alpha * x - square * y)


def crank_motion(motion: NamedFields) -> LinkMotion:
    """Return the :class:`LinkMotion` of a crank that turns about O1."""
    return LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, motion.cos_x, motion.sin_x, motion.omega1,
                      motion.alpha1)


def instant_centre(link: LinkMotion, other: LinkMotion | None = None) -> Array:
    """
    Return the instant centre of a link relative to another one, or to the ground.

    The point where both have one velocity (Aronhold and Kennedy): v + omega x (P - O) is the same
    for both. At infinity, as NaN or inf, where both turn at one rate.

    Parameters
    ----------
    link, other : LinkMotion
        Two links, each of floats or arrays of shape (...). None: the ground.

    Returns
    -------
    ndarray, shape (..., 2) [m]

    """
    def at_origin(one: LinkMotion) -> tuple[Scalar, Scalar]:
        return one.v_x + one.omega * one.y, one.v_y - one.omega * one.x

    (v_x, v_y), omega = at_origin(link), link.omega
    if other is not None:
        u_x, u_y = at_origin(other)
        v_x, v_y, omega = v_x - u_x, v_y - u_y, omega - other.omega
    with np.errstate(divide='ignore', invalid='ignore'):
        return vector(np.divide(-v_y, omega), np.divide(v_x, omega))


def make_point(n: NumberType, mechanism: Mechanism, link: str, along: float,
               across: float) -> Function:
    """Return motion -> fields of :class:`PointMotion` for a point fixed to a link."""
    hypot, where = n.hypot, n.where

    def point(motion: NamedFields) -> tuple[Scalar, ...]:
        x, y, v_x, v_y, a_x, a_y = point_of(link_motion(mechanism, motion, link), along, across)
        speed = hypot(v_x, v_y)
        square = speed * speed
        moves = square > 0.0     # the square of less underflows
        per, per_square = where(moves, (speed, square), (nan, nan))
        tangential, normal = (a_x * v_x + a_y * v_y) / per, (a_y * v_x - a_x * v_y) / per
        return (x, y, v_x, v_y, a_x, a_y, speed, tangential, normal, normal / per_square)
    return point


def point_motion(mechanism: Mechanism, motion: NamedFields, link: str, along: float,
                 across: float = 0.0) -> PointMotion:
    """
    Return the :class:`PointMotion` of a point fixed to a link.

    Parameters
    ----------
    mechanism, motion, link
        As for :func:`link_motion`.
    along, across : float
        From the first joint of the link along it and to its left [m].

    Examples
    --------
    >>> from fourbar_ros import FourBar
    >>> linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    >>> middle = point_motion(linkage, linkage.motion([0.0, 0.5], 25.0), 'coupler', 0.6, 0.2)
    >>> middle.place.shape
    (2, 2)

    """
    along, across = number('along', along), number('across', across)
    shape = np.shape(motion[0])
    if not shape:
        return PointMotion(*make_point(REAL, mechanism, link, along, across)(motion))
    with np.errstate(divide='ignore', invalid='ignore'):
        fields = make_point(ARRAY, mechanism, link, along, across)(motion)
    return PointMotion._make(np.broadcast_to(field, shape) for field in fields)


def velocity_image(omega: Scalar) -> tuple[Scalar, Scalar]:
    """Return (scale [1/s], turn [rad]) of the velocity image of a link: |omega|, +-90 deg."""
    return np.abs(omega), np.copysign(0.5 * np.pi, omega)


def acceleration_image(omega: Scalar, alpha: Scalar) -> tuple[Scalar, Scalar]:
    """
    Return (scale [1/s^2], turn [rad]) of the acceleration image of a link.

    The link's figure, sqrt(omega^4 + alpha^2) times as large and turned by 180 deg -
    atan(alpha/omega^2) counter-clockwise, is the figure of its points in the acceleration polygon
    (slides, after Eq. (6)).
    """
    square = np.square(omega)
    return np.hypot(square, alpha), np.pi - np.arctan2(alpha, square)
