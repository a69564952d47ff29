"""
Any point fixed to any link of any mechanism: path, velocity, acceleration, and its polygon's image.

A point is given as a centre of gravity is: along the link from its first joint, and across to its left.
From the fields of a motion alone, so a point costs nothing until it is asked for; vectors have shape
(..., 2), for one sample as for an array.
"""
from __future__ import annotations

from math import isfinite
from typing import NamedTuple

import numpy as np

from .errors import InvalidParameter
from .frames import relative_acceleration, relative_velocity, scaled, turned
from .inverted_slider import InvertedSlider
from .linkage import FourBar
from .slider_crank import SliderCrank

CRANK, COUPLER, OUTPUT = LINKS = ('crank', 'coupler', 'output')


class LinkMotion(NamedTuple):
    """
    Motion of a link: of its first joint (O1, A; O4, or B of a slider) and its turning.

    Vectors of shape (..., 2) along the ground axes, ``direction`` a unit vector; the rest of shape (...).
    """

    place: np.ndarray             # [m]
    velocity: np.ndarray          # [m/s]
    acceleration: np.ndarray      # [m/s^2]
    direction: np.ndarray
    omega: np.ndarray             # [rad/s]
    alpha: np.ndarray             # [rad/s^2]


class PointMotion(NamedTuple):
    """
    Motion of a point; vectors of shape (..., 2), the rest of shape (...).

    ``tangential`` and ``normal`` are the parts of the acceleration along the velocity and to its left;
    they and the curvature are NaN where the point rests.
    """

    place: np.ndarray             # [m]
    velocity: np.ndarray          # [m/s]
    acceleration: np.ndarray      # [m/s^2]
    speed: np.ndarray             # [m/s]
    tangential: np.ndarray        # [m/s^2] d speed / dt, Eq. (2)
    normal: np.ndarray            # [m/s^2] speed^2 times curvature
    curvature: np.ndarray         # [1/m] of the path, positive where it turns left


def vector(x, y):
    """Return components of one shape (...) as vectors of shape (..., 2)."""
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def link_motion(mechanism, motion, link):
    """
    Return the :class:`LinkMotion` of 'crank', 'coupler' or 'output'.

    Parameters
    ----------
    mechanism : FourBar, SliderCrank or InvertedSlider
    motion : Motion of that mechanism
        One sample or arrays.
    link : str
        As in Bodies: the coupler of an inverted slider is its block, the output of a slider-crank its
        slider, of an inverted one its bar.

    """
    if link not in LINKS:
        raise InvalidParameter('link', link, f'must be one of {", ".join(LINKS)}')
    rest = np.zeros(np.shape(motion.theta1) + (2,))
    crank = LinkMotion(rest, rest, rest, vector(motion.cos_x, motion.sin_x), motion.omega1, motion.alpha1)
    if link == CRANK:
        return crank
    end = point_of(crank, mechanism.a1)
    if isinstance(mechanism, SliderCrank):
        if link == COUPLER:
            return LinkMotion(*end, vector(motion.cos_b, motion.sin_b), motion.omega_beta, motion.alpha_beta)
        flat = rest[..., 0]
        return LinkMotion(vector(motion.slide, mechanism.offset), vector(motion.slide_velocity, flat),
                          vector(motion.slide_acceleration, flat), vector(1.0 + flat, flat), flat, flat)
    output = (vector(motion.cos_y, motion.sin_y), motion.omega4, motion.alpha4)
    if link == OUTPUT:
        return LinkMotion(rest + (mechanism.a4, 0.0), rest, rest, *output)
    if isinstance(mechanism, InvertedSlider):
        return LinkMotion(*end, *output)
    return LinkMotion(*end, vector(motion.cos_b, motion.sin_b), motion.omega_beta, motion.alpha_beta)


def point_of(link, along, across=0.0):
    """Return place, velocity and acceleration of a point of a LinkMotion, Eq. (6)."""
    arm = scaled(along, link.direction) + turned(across, link.direction)
    return (link.place + arm, relative_velocity(link.velocity, link.omega, arm),
            relative_acceleration(link.acceleration, link.omega, link.alpha, arm))


def point_motion(mechanism, motion, link, along, across=0.0):
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
    >>> from fourbar_ros.core import FourBar
    >>> linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    >>> middle = point_motion(linkage, linkage.motion([0.0, 0.5], 25.0), 'coupler', 0.6, 0.2)
    >>> middle.place.shape
    (2, 2)

    """
    for name, value in (('along', along), ('across', across)):
        if not isfinite(value):
            raise InvalidParameter(name, value, 'must be a finite number')
    place, velocity, acceleration = point_of(link_motion(mechanism, motion, link), along, across)
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    with np.errstate(divide='ignore', invalid='ignore'):
        tangent = velocity / speed[..., None]
        tangential = np.sum(acceleration * tangent, axis=-1)
        normal = np.sum(acceleration * turned(1.0, tangent), axis=-1)
        return PointMotion(place, velocity, acceleration, speed, tangential, normal, normal / np.square(speed))


def velocity_image(omega):
    """Return (scale [1/s], turn [rad]) of the velocity image of a link: |omega|, +-90 deg."""
    return np.abs(omega), np.copysign(0.5 * np.pi, omega)


def acceleration_image(omega, alpha):
    """
    Return (scale [1/s^2], turn [rad]) of the acceleration image of a link.

    The link's figure, sqrt(omega^4 + alpha^2) times as large and turned by 180 deg - atan(alpha/omega^2)
    counter-clockwise, is the figure of its points in the acceleration polygon (slides, after Eq. (6)).
    """
    square = np.square(omega)
    return np.hypot(square, alpha), np.pi - np.arctan2(alpha, square)
