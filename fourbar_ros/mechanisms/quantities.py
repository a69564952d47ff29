# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quantities by name, to be searched for extrema, tabulated and plotted."""
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.mechanisms.curves import point_of
from fourbar_ros.mechanisms.load_table import LOADS
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate, CRANK, NamedFields, Quantity
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Scalar
import numpy as np
from numpy.typing import ArrayLike


class UnknownQuantity(FourBarError, KeyError):
    """No such quantity of a mechanism; the message names the nearest, or the first ten."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        self.name, known = name, list(known)
        point, dot, _ = name.partition('.')
        hint = nearest(name, known) or (
            f': there is no point {point}; a scene has them, of joints too, as points.NAME' if dot
            else f'; known: {", ".join(known[:10])}, {len(known) - 10} more')
        super().__init__(f'unknown quantity {name!r}{hint}')

    def __str__(self) -> str:
        return str(self.args[0])


class Function(NamedTuple):
    """A quantity that is a function ``of`` (motion, loads), of floats or arrays."""

    name: str
    unit: str
    text: str
    of: Callable[..., Any]
    is_load: bool = False     # the search finds out whether it reads loads
    is_smooth: bool = False   # plain arithmetic and numpy: a complex step gives its derivative
    is_position: bool = False


class OfDrive(NamedTuple):
    """A quantity of the drive at a rate and acceleration that are not those of the input."""

    name: str
    unit: str
    text: str
    quantity: Quantity
    rate: float | None = 0.0        # [rad/s] or [m/s]; None: that of the input
    acceleration: float = 0.0
    is_weightless: bool = False     # of the links without weight and external loads
    is_inverse: bool = False        # one over the quantity

    @property
    def is_load(self) -> bool:
        return self.quantity.is_load

    def links(self, linkage: Mechanism) -> Mechanism:
        return linkage.weightless if self.is_weightless else linkage

    def rates(self, rate: float) -> tuple[float, float]:
        return (rate if self.rate is None else self.rate), self.acceleration

    def values(self, linkage: Mechanism, position: ArrayLike, rate: float) -> Array:
        links, rates = self.links(linkage), self.rates(rate)
        value = np.asarray(self.quantity.of(*(
            links.step(position, *rates) if self.is_load
            else (links.motion(position, *rates), None))))
        with np.errstate(divide='ignore'):
            return 1.0 / value if self.is_inverse else value


def point_x(mechanism: Mechanism, link: str, along: float, across: float = 0.0,
            name: str = 'point') -> Function:
    """Return the quantity ``name.x`` [m] of a point fixed to a link."""
    return _of_point(name, 'x', 'm', (mechanism, link, along, across), _coordinate, 0)


def point_y(mechanism: Mechanism, link: str, along: float, across: float = 0.0,
            name: str = 'point') -> Function:
    """Return the quantity ``name.y`` [m] of a point fixed to a link."""
    return _of_point(name, 'y', 'm', (mechanism, link, along, across), _coordinate, 1)


def point_speed(mechanism: Mechanism, link: str, along: float, across: float = 0.0,
                name: str = 'point') -> Function:
    """Return the quantity ``name.speed`` [m/s] of a point fixed to a link."""
    return _of_point(name, 'speed', 'm/s', (mechanism, link, along, across), _size, slice(2, 4))


def point_acceleration(mechanism: Mechanism, link: str, along: float, across: float = 0.0,
                       name: str = 'point') -> Function:
    """Return the quantity ``name.acceleration``, its magnitude [m/s^2], of a point of a link."""
    return _of_point(name, 'acceleration', 'm/s^2', (mechanism, link, along, across), _size,
                     slice(4, 6))


POINT_QUANTITIES = point_x, point_y, point_speed, point_acceleration


def _of_point(name: str, what: str, unit: str, point: tuple[Mechanism, str, float, float],
              of: Callable[..., Scalar], fields: int | slice) -> Function:
    _, link, along, across = point
    return Function(f'{name}.{what}', unit,
                    f'{what} of the point ({along:g}, {across:g}) m of the {link}',
                    partial(of, *point, fields), is_smooth=True, is_position=of is _coordinate)


def _coordinate(mechanism: Mechanism, link: str, along: float, across: float, field: int,
                motion: NamedFields, loads: NamedFields) -> Scalar:
    return point_of(mechanism.link_motion(motion, link), along, across)[field]


def _size(mechanism: Mechanism, link: str, along: float, across: float, fields: slice,
          motion: NamedFields, loads: NamedFields) -> Scalar:
    """Return the length of two ``fields`` (x, y) of the :class:`.MovingPoint` of a point."""
    x, y = tuple(point_of(mechanism.link_motion(motion, link), along, across))[fields]
    size: Scalar = np.sqrt(x * x + y * y)
    return size


Asked = Quantity | Function      # what follows from a motion and its loads
Named = Asked | OfDrive          # what may be asked for by name

QUANTITIES = {quantity.name: quantity for quantity in (
    Quantity('omega4', 'rad/s', 'angular velocity of the output link', False),
    Quantity('alpha4', 'rad/s^2', 'angular acceleration of the output link', False),
    Quantity('omega1', 'rad/s', 'angular velocity of a crank that is not driven', False),
    Quantity('alpha1', 'rad/s^2', 'angular acceleration of a crank that is not driven', False),
    Quantity('omega_beta', 'rad/s', 'angular velocity of the coupler', False),
    Quantity('alpha_beta', 'rad/s^2', 'angular acceleration of the coupler', False),
    Quantity('slide_velocity', 'm/s', 'velocity of a slider that is not driven', False),
    Quantity('slide_acceleration', 'm/s^2', 'acceleration of a slider that is not driven', False),
    *(Quantity(row.name, row.unit, row.text, True) for row in LOADS.values() if row.text),
    # of the Scotch yoke alone
    Quantity('slot_velocity', 'm/s', 'velocity of the block in the slot', False),
    Quantity('slot_acceleration', 'm/s^2', 'acceleration of the block in the slot', False),
    Quantity('slot_couple', 'N m', 'couple of the slot on its block', True),
)}

# Given only if asked for by name, not with "all": their extrema are at dead points and at the ends
# of the input, which are known in closed form.
POSITIONS = {quantity.name: quantity for quantity in (
    Quantity('theta4', 'rad',
             'angle of the output link, from -pi to pi; its extrema go on', False),
    Quantity('theta1', 'rad',
             'angle of a crank that is not driven, from -pi to pi; its extrema go on', False),
    Quantity('slide', 'm', 'position of a slider that is not driven', False),
    Quantity('transmission_angle', 'rad', 'transmission angle', False),
)}


def known_quantities(mechanism: Mechanism, driven: str = CRANK) -> dict[str, Quantity]:
    """Return {name: Quantity} of rates, accelerations and loads of a mechanism or its class."""
    # Without the rates of the input driven, and without the driving force of a crank or the
    # driving torque of a slide.
    if driven not in mechanism.INPUTS:
        raise InvalidParameter('driven', driven, f'must be one of {", ".join(mechanism.INPUTS)}')
    coordinate = mechanism.INPUTS[driven]
    absent = {coordinate.rate, coordinate.acceleration,
              'driving_force' if coordinate.unit == 'rad' else 'driving_torque'}
    motion, loads = set(mechanism.MOTION._fields), set(mechanism.LOADS._fields)
    of_mechanism = {quantity.name: quantity for quantity in mechanism.QUANTITIES}
    return {name: quantity for name, quantity in (QUANTITIES | of_mechanism).items()
            if name not in absent and not is_position(quantity)
            and name in (loads if quantity.is_load else motion)}


def positions(mechanism: Mechanism, driven: str = CRANK) -> dict[str, Quantity]:
    """Return {name: Quantity} of the positions of a mechanism, or a kind, beside the input."""
    motion = mechanism.MOTION._fields
    of_mechanism = {quantity.name: quantity for quantity in mechanism.QUANTITIES}
    return {name: quantity for name, quantity in (POSITIONS | of_mechanism).items()
            if is_position(quantity) and name in motion
            and name != mechanism.INPUTS[driven].position}


def of_drive(mechanism: Mechanism, driven: str = CRANK) -> dict[str, OfDrive]:
    """Return {name: quantity} of what the drive of a mechanism, or a kind, can be asked for."""
    is_angle, (output, _) = mechanism.INPUTS[driven].unit == 'rad', mechanism.OUTPUTS[driven][0]
    unit, effort = ('N m', 'torque') if is_angle else ('N', 'force')
    drive = Quantity(f'driving_{effort}', unit, '', is_load=True)
    output_rate = Quantity(output.rate, f'{output.unit}/s', '', is_load=False)
    advantage = {('N', 'rad'): 'N m/N', ('N m', 'm'): 'N/(N m)'}.get((unit, output.unit), '')
    return {quantity.name: quantity for quantity in (
        OfDrive('inertia', 'kg m^2' if is_angle else 'kg',
                'inertia at the input: J of T = J alpha + b', drive,
                acceleration=1.0, is_weightless=True),
        OfDrive('bias', unit, 'drive without acceleration: b of T = J alpha + b', drive,
                rate=None),
        OfDrive(f'holding_{effort}', unit, f'{effort} of the drive at rest', drive),
        OfDrive('mechanical_advantage', advantage,
                'torque or force that the output can hold, over that of the drive, without '
                'weight and friction', output_rate, rate=1.0, is_inverse=True))}


def by_name(mechanism: Mechanism, more: Sequence[Asked] = ()) -> dict[str, Named]:
    driven = mechanism.input
    return {**positions(mechanism, driven), **known_quantities(mechanism, driven),
            **of_drive(mechanism, driven), **{quantity.name: quantity for quantity in more}}


def fields_of(mechanism: Any, driven: Coordinate | None = None) -> dict[str, Quantity]:
    """Return {field of motion or loads: what it is}, in order, without numbers in between."""
    # mechanism: one, or what states its names, a kind, with the driven coordinate. Later entries
    # are more exact: of a load its unit alone, then of a reaction its joint, then what a quantity
    # says of itself.
    known: dict[str, Quantity] = {'condition': Quantity(
        'condition', '', 'error of the output per relative error of the lengths', False)}
    driven = driven or mechanism.input_coordinate
    moving = {driven: 'the input'} | {joint.coordinate: f'the joint {joint.place}'
                                      for joint in mechanism.JOINTS} | dict(mechanism.PARTS)
    for coordinate, part in moving.items():
        for name, unit, text in zip(coordinate, coordinate.units, (
                'angle' if coordinate.unit == 'rad' else 'position', 'rate', 'acceleration')):
            known[name] = Quantity(name, unit, f'{text} of {part}', False)
    for name in mechanism.LOADS._fields:
        known[name] = Quantity(name, LOADS[name].unit if name in LOADS else 'N', '', True)
    for reaction in mechanism.REACTIONS:
        for name, which in ((reaction.magnitude, 'magnitude'), (reaction.x, 'x'),
                            (reaction.y, 'y')):
            known[name] = Quantity(
                name, 'N', f'{which} of the force of {reaction.text}, at {reaction.joint}', True)
    for axis in 'xy':
        name = f'shaking_force_{axis}'
        known[name] = Quantity(name, 'N', f'{axis} of the force on the ground', True)
    known |= {quantity.name: quantity for quantity in (
        *QUANTITIES.values(), *POSITIONS.values(), *mechanism.QUANTITIES)
        if quantity.name not in driven}
    return {name: known[name] for name in (*mechanism.MOTION._fields, *mechanism.LOADS._fields)
            if name in known}


def is_published(quantity: Named) -> bool:
    """Return whether this is a field of motion or loads, which messages and bags have too."""
    return isinstance(quantity, Quantity)


def is_position(quantity: Named) -> bool:
    return quantity.is_position if isinstance(quantity, Function) else (
        is_published(quantity) and not quantity.is_load and quantity.unit in ('rad', 'm'))


def select(names: Sequence[str], mechanism: Mechanism, more: Sequence[Asked] = ()) -> list[Named]:
    """Return the quantities of these names; of none all but positions and those of the drive."""
    # Loads are left out where the mechanism has none. more: quantities that may be named too, as
    # those of the points of a scene, and that are part of "all" too if they are no positions.
    if not names:
        every = *known_quantities(mechanism, mechanism.input).values(), *more
        return [quantity for quantity in every if (mechanism.has_loads or not quantity.is_load)
                and not is_position(quantity)]
    available = by_name(mechanism, more)
    for name in names:
        if name not in available:
            raise UnknownQuantity(name, available)
    return [available[name] for name in names]
