# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What can be asked for by name: searched for extrema, tabulated, plotted."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial
from typing import Any, NamedTuple, Union

from fourbar_ros.errors import FourBarError, nearest
from fourbar_ros.mechanisms.contract import CRANK
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate, NamedFields, Quantity
from fourbar_ros.mechanisms.points import link_motion, point_of
from fourbar_ros.numerics.number_types import Scalar
import numpy as np


class UnknownQuantity(FourBarError, KeyError):
    """A mechanism has no quantity of this name; the message names the nearest or lists all."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        self.name = name
        super().__init__(f'unknown quantity {name!r}{nearest(name, known)}')

    def __str__(self) -> str:
        found: str = self.args[0]
        return found


class Function(NamedTuple):
    """A quantity: a function (Motion, Loads) -> value for floats and arrays."""

    name: str
    unit: str
    text: str
    of: Callable[..., Any]
    is_load: bool = False     # not known; without masses, loads raise MissingBodies when used


def point_speed(mechanism: Mechanism, link: str, along: float, across: float = 0.0,
                name: str = 'point') -> Function:
    """Return the speed [m/s] of a point fixed to a link, the quantity ``name.speed``."""
    return Function(f'{name}.speed', 'm/s', f'speed of the point ({along:g}, {across:g}) m of the '
                                            f'{link}',
                    partial(_length, mechanism, link, along, across, 2))


def point_acceleration(mechanism: Mechanism, link: str, along: float, across: float = 0.0,
                       name: str = 'point') -> Function:
    """Return the acceleration's magnitude [m/s^2] of a point, ``name.acceleration``."""
    return Function(f'{name}.acceleration', 'm/s^2', f'acceleration of the point ({along:g}, '
                                                     f'{across:g}) m of the {link}',
                    partial(_length, mechanism, link, along, across, 4))


def _length(mechanism: Mechanism, link: str, along: float, across: float, first: int,
            motion: NamedFields, loads: NamedFields) -> Scalar:
    """Return the length of a vector of :func:`.point_of` whose x is number ``first``."""
    x, y = point_of(link_motion(mechanism, motion, link), along, across)[first:first + 2]
    found: Scalar = np.sqrt(x * x + y * y)
    return found


Asked = Union[Quantity, Function]      # what may be asked for

QUANTITIES = {quantity.name: quantity for quantity in (
    Quantity('omega4', 'rad/s', 'angular velocity of the output link', False),
    Quantity('alpha4', 'rad/s^2', 'angular acceleration of the output link', False),
    Quantity('omega1', 'rad/s', 'angular velocity of a crank that is not driven', False),
    Quantity('alpha1', 'rad/s^2', 'angular acceleration of a crank that is not driven', False),
    Quantity('omega_beta', 'rad/s', 'angular velocity of the coupler', False),
    Quantity('alpha_beta', 'rad/s^2', 'angular acceleration of the coupler', False),
    Quantity('slide_velocity', 'm/s', 'velocity of a slider that is not driven', False),
    Quantity('slide_acceleration', 'm/s^2', 'acceleration of a slider that is not driven', False),
    Quantity('shaking_force', 'N', 'magnitude of the force on the ground', True),
    Quantity('shaking_moment', 'N m', 'moment on the ground about O1', True),
    Quantity('driving_torque', 'N m', 'torque of the drive on a driven crank', True),
    Quantity('driving_force', 'N', 'force of the drive along a driven slide', True),
    Quantity('f41', 'N', 'magnitude of the reaction at O1', True),
    Quantity('f21', 'N', 'magnitude of the reaction at A', True),
    Quantity('f32', 'N', 'magnitude of the reaction at B, or of the bar on its block', True),
    Quantity('f43', 'N', 'magnitude of the reaction at O4, or of the guide', True),
    Quantity('guide_force', 'N', 'force of the guide, square to it', True),
    Quantity('guide_couple', 'N m', 'couple of the guide', True),
)}
QUANTITIES |= {quantity.name: quantity for kind in KINDS.values() for quantity in kind.QUANTITIES}

# By name alone: they turn back at dead points and at the ends of the input, which are known in
# closed form, so that a request for everything leaves them out.
POSITIONS = {quantity.name: quantity for quantity in (
    Quantity('theta4', 'rad', 'angle of the output link, continuous', False),
    Quantity('theta1', 'rad', 'angle of a crank that is not driven, continuous', False),
    Quantity('slide', 'm', 'position of a slider that is not driven', False),
    Quantity('transmission_angle', 'rad', 'transmission angle', False),
)}


def known(mechanism: Mechanism, driven: str = CRANK) -> dict[str, Quantity]:
    """Return {name: Quantity} of a mechanism, or of a kind driven at its crank or slide."""
    return _known(mechanism.MOTION._fields, mechanism.LOADS._fields, mechanism.INPUTS[driven],
                  mechanism.QUANTITIES)


@cache
def _known(motion: Sequence[str], loads: Sequence[str], coordinate: Coordinate,
           own: tuple[Quantity, ...]) -> dict[str, Quantity]:
    """Return {name: Quantity} of these fields, without those that are given or zero."""
    absent = {coordinate.rate, coordinate.acceleration,
              'driving_force' if coordinate.unit == 'rad' else 'driving_torque'}
    every = QUANTITIES | {quantity.name: quantity for quantity in own if not is_position(quantity)}
    return {name: quantity for name, quantity in every.items()
            if name not in absent and name in (loads if quantity.is_load else motion)}


def positions(mechanism: Mechanism, driven: str = CRANK) -> dict[str, Quantity]:
    """Return {name: Quantity} of the positions of a mechanism, or a kind, that are not given."""
    return _positions(mechanism.MOTION._fields, mechanism.INPUTS[driven], mechanism.QUANTITIES)


@cache
def _positions(motion: Sequence[str], coordinate: Coordinate,
               own: tuple[Quantity, ...]) -> dict[str, Quantity]:
    """Return {name: Quantity} of these fields of a motion, without the one that is given."""
    every = POSITIONS | {quantity.name: quantity for quantity in own if is_position(quantity)}
    return {name: quantity for name, quantity in every.items()
            if name in motion and name != coordinate.position}


def is_published(quantity: Asked) -> bool:
    """Return whether this is one of the quantities with a name."""
    return isinstance(quantity, Quantity)


def is_position(quantity: Asked) -> bool:
    """Return whether this is one of the positions with a name."""
    return is_published(quantity) and not quantity.is_load and quantity.unit in ('rad', 'm')


def select(names: Sequence[str], mechanism: Mechanism,
           others: Sequence[Asked] = ()) -> list[Asked]:
    """
    Return the quantities of these names.

    Or all rates, accelerations and loads that a mechanism has data for.

    ``others``: more quantities that have a name, as those of a scene's points; of no names these
    are part too.
    """
    available = known(mechanism, mechanism.input) | {quantity.name: quantity
                                                     for quantity in others}
    if names:
        available |= positions(mechanism, mechanism.input)
    for name in names:
        if name not in available:
            raise UnknownQuantity(name, available)
    if names:
        return [available[name] for name in names]
    return [quantity for quantity in available.values() if mechanism.bodies is not None
            or not quantity.is_load]
