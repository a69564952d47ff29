# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Masses and loads of a link in its own frame: origin at its first joint, x to its second."""
from collections.abc import Callable
from dataclasses import dataclass, fields, KW_ONLY
from math import nan, pi
from typing import NamedTuple, TypeVar

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.number_types import Scalar

_Kind = TypeVar('_Kind', bound='Body | Applied')


@dataclass(frozen=True)
class Body:
    """
    Rigid body of one link, all but the mass by name: ``Body(2.0, cg_along=0.1, inertia=0.02)``.

    ``mass`` [kg] and ``inertia`` about the centre of gravity [kg m^2] are zero or more.
    ``cg_along``, ``cg_across``: the centre of gravity from the first joint (O1 of the crank, A of
    the coupler, O4 of the output link), along the link and to its left [m]. ``Body(2.0)`` is a
    point mass at that joint; a uniform bar is :func:`flat_bar` or :func:`round_rod`.
    """

    mass: float
    _: KW_ONLY
    cg_along: float = 0.0
    cg_across: float = 0.0
    inertia: float = 0.0

    def __post_init__(self) -> None:
        for name in ('mass', 'inertia'):
            value = finite(name, getattr(self, name), 'must be a finite number, zero or more',
                           least=0.0)
            object.__setattr__(self, name, value)
        for name in ('cg_along', 'cg_across'):
            object.__setattr__(self, name, finite(name, getattr(self, name)))


@dataclass(frozen=True)
class Applied:
    """
    External force [N] and couple [N m] on a link: ``Applied(0.0, -5.0, along=0.2, couple=1.0)``.

    The force acts at a point fixed in the link, ``along`` it from its first joint (O1 of the
    crank, A of the coupler, O4 of the output link) and ``across`` to its left [m]. Its direction,
    like that of gravity, is constant along the ground axes (x from O1 to O4), whatever the link
    does. A couple is counter-clockwise positive. All but the force is given by name.
    """

    force_x: float = 0.0
    force_y: float = 0.0
    _: KW_ONLY
    along: float = 0.0
    across: float = 0.0
    couple: float = 0.0

    def __post_init__(self) -> None:
        for name in ('force_x', 'force_y', 'along', 'across', 'couple'):
            object.__setattr__(self, name, finite(name, getattr(self, name)))


NOT_APPLIED = Applied()


class Base(NamedTuple):
    """
    Motion of the body that carries the linkage, as an inertial measurement unit at O1 tells it.

    The specific force [m/s^2] along the linkage's axes, its acceleration less gravity: at rest and
    level (0, 9.81); the rate [rad/s] and angular acceleration [rad/s^2] in the linkage's plane. It
    stands in the place of gravity.
    """

    force_x: Scalar = 0.0
    force_y: Scalar = 0.0
    rate: Scalar = 0.0
    acceleration: Scalar = 0.0


class UnknownBase(Base):
    """A base whose motion is not known: with it there are no loads, see ``loads(base=...)``."""


UNKNOWN_BASE = UnknownBase(*[nan] * 4)

# What the loads of masses come from besides their own motion: a field of gravity, or the base's.
Gravity = tuple[Scalar, Scalar] | Base


def field_of(gravity: Gravity) -> tuple[Scalar, Scalar]:
    """Return the field of gravity (x, y) [m/s^2]; of a base minus its specific force."""
    return (-gravity.force_x, -gravity.force_y) if isinstance(gravity, Base) else gravity


def unchecked(kind: type[_Kind], *values: Scalar, **by_name: Scalar) -> _Kind:
    """Return a Body or Applied of all its fields, any numbers or arrays, without checks."""
    made = object.__new__(kind)
    for name, value in (*zip([field.name for field in fields(kind)], values), *by_name.items()):
        object.__setattr__(made, name, value)
    return made


class Bodies(NamedTuple):
    """Mass properties of the three moving links."""

    crank: Body
    coupler: Body
    output: Body


class External(NamedTuple):
    """External loads on the three moving links, besides the drive."""

    coupler: Applied = NOT_APPLIED
    output: Applied = NOT_APPLIED
    crank: Applied = NOT_APPLIED


def round_rod(length: float, density: float, radius: float) -> Body:
    """
    Return the body of a uniform round rod between its joints, as the links of the paper's Table 1.

    m = rho pi r^2 L, I = m (3 r^2 + L^2)/12, of a solid cylinder about a transverse axis. Length
    [m], density [kg/m^3] and radius [m] are positive.
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
    """Return the body by a function of checked sizes -> mass, cg_along, cg_across, inertia."""
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
