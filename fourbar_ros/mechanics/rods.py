# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bodies of uniform rods and bars, by their dimensions and density."""
from __future__ import annotations

from collections.abc import Callable
from math import pi

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.number_types import Scalar


def round_rod(length: float, density: float, radius: float) -> Body:
    """
    Return the body of a uniform round rod between its joints, the centre of gravity in the middle.

    m = rho pi r^2 L, I = m (3 r^2 + L^2)/12, a solid cylinder about a transverse axis, as the
    links of the paper's Table 1. Length [m], density [kg/m^3] and radius [m] are positive.
    """
    return _uniform(rod_numbers, length=length, density=density, radius=radius)


def flat_bar(length: float, density: float, width: float, thickness: float) -> Body:
    """
    Return the body of a uniform flat bar between its joints, the centre of gravity in the middle.

    m = rho w t L, I = m (w^2 + L^2)/12. Length [m], density [kg/m^3], width in the plane of the
    mechanism and thickness square to it [m] are positive.
    """
    return _uniform(bar_numbers, length=length, density=density, width=width, thickness=thickness)


def _uniform(numbers_of: Callable[..., tuple[float, ...]], **values: float) -> Body:
    sizes = [finite(name, value, 'must be a positive number', above=0.0)
             for name, value in values.items()]
    try:
        mass, along, across, inertia = numbers_of(*sizes)
        return Body(mass, cg_along=along, cg_across=across, inertia=inertia)
    except (OverflowError, InvalidParameter):
        raise InvalidParameter(', '.join(values), sizes, 'so large that mass or inertia '
                                                         'overflows') from None


def rod_numbers(length: Scalar, density: Scalar, radius: Scalar) -> tuple[Scalar, ...]:
    """Return mass, cg_along, cg_across, inertia of a :func:`round_rod` of any numbers."""
    mass = density * pi * radius**2 * length
    return mass, 0.5 * length, 0.0, mass * (3.0 * radius**2 + length**2) / 12.0


def bar_numbers(length: Scalar, density: Scalar, width: Scalar,
                thickness: Scalar) -> tuple[Scalar, ...]:
    """Return mass, cg_along, cg_across, inertia of a :func:`flat_bar` of any numbers."""
    mass = density * width * thickness * length
    return mass, 0.5 * length, 0.0, mass * (width**2 + length**2) / 12.0
