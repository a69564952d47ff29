# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Any point fixed to any link: path, velocity, acceleration, and its image in the polygons.

A point is given as a centre of gravity is: along the link from its first joint, and across to its
left. All follows from the fields of a motion, so a point costs nothing until it is asked for.
"""
from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from math import atan2, nan
from typing import Any, TYPE_CHECKING

from fourbar_ros.mechanisms.curves import LinkFields, point_of, PointMotion
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.number_types import ARRAY, NumberType, REAL, Scalar
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Mechanism
    from fourbar_ros.mechanisms.parts import NamedFields


def link_fields(mechanism: Mechanism, motion: NamedFields, link: str) -> LinkFields:
    moved = mechanism.link_motion(motion, link)
    return LinkFields(atan2(moved.sine, moved.cosine), moved.omega, moved.alpha, *moved[:6])


def point_in(n: NumberType, mechanism: Mechanism, motion: NamedFields, link: str, along: Scalar,
             across: Scalar) -> PointMotion:
    """Return the motion of a point of a link in a motion of the mechanism, of a number type."""
    x, y, v_x, v_y, a_x, a_y = point_of(mechanism.link_motion(motion, link), along, across)
    speed = n.hypot(v_x, v_y)
    square = speed * speed
    # Where the point rests, the divisors are NaN: ``where`` computes both sides, so that no
    # quotient may divide by zero. Below some 1e-162 m/s the square is zero.
    divisor, of_curvature = n.where(square > 0.0, (speed, square), (nan, nan))
    tangential, normal = (a_x * v_x + a_y * v_y) / divisor, (a_y * v_x - a_x * v_y) / divisor
    curvature = normal / of_curvature
    return PointMotion(x, y, v_x, v_y, a_x, a_y, speed, tangential, normal, curvature)


def with_any_lengths(mechanism: Mechanism, lengths: Sequence[Any]) -> Mechanism:
    """Return a copy with unchecked lengths of any type of number, for motions of its points."""
    # These take lengths from its attributes (a1, a2, ...). A machine has none: there they follow
    # from its motion.
    copied = copy(mechanism)
    for name, length in zip(mechanism.length_names, lengths):
        if hasattr(mechanism, name):
            object.__setattr__(copied, name, length)
    return copied


def point_motion(mechanism: Mechanism, motion: NamedFields, link: str, along: float,
                 across: float = 0.0) -> PointMotion:
    """
    Return place, velocity, acceleration and path curvature of a point fixed to a link.

    ``motion`` is one of this mechanism, of one sample or of arrays; ``along`` and ``across`` [m]
    lead from the first joint of the link along it and to its left.

    Examples
    --------
    >>> from fourbar_ros import FourBar
    >>> linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    >>> middle = point_motion(linkage, linkage.motion([0.0, 0.5], 25.0), 'coupler', 0.6, 0.2)
    >>> middle.place.shape
    (2, 2)

    """
    along, across = finite('along', along), finite('across', across)
    shape = np.shape(motion[0])
    if not shape:
        return point_in(REAL, mechanism, motion, link, along, across)
    with np.errstate(divide='ignore', invalid='ignore'):
        fields = point_in(ARRAY, mechanism, motion, link, along, across)
    return PointMotion._make(np.broadcast_to(field, shape) for field in fields)
