# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a scene says of motion that follows from torque: drive, springs, the start."""
from __future__ import annotations

from dataclasses import MISSING
from math import inf, isfinite, isnan
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter, one_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.given import quantities_of
from fourbar_ros.scene.parameter_table import GEAR, MOTORS, OF_MOTORS, SOURCES
from fourbar_ros.scene.parameters import names_in, ParameterValues

if TYPE_CHECKING:      # other scenes do without
    from fourbar_ros.dynamics.model.drives import Drive, Law, Shaft
    from fourbar_ros.dynamics.model.elements import Element, PositionForce
    from fourbar_ros.dynamics.model.system import System


class Dynamics(NamedTuple):
    """Drive, springs and dampers, and where the input starts [rad] or [m], [rad/s] or [m/s]."""

    drive: Drive
    elements: tuple[Element, ...]
    position: float
    rate: float

    def system(self, linkage: Mechanism) -> System:
        """Return the System of a linkage with these."""
        from fourbar_ros.dynamics.model.system import System
        return System(linkage, self.position, self.rate, self.elements, self.drive)

    def modes_passed(self, linkage: Mechanism) -> tuple[int, ...]:
        """Return the assembly modes between which steps through toggles go; of others nothing."""
        from fourbar_ros.dynamics.step.mover import modes_of
        return modes_of(linkage)


def of_values(values: ParameterValues, linkage: Mechanism,
              forces: tuple[PositionForce, ...] = ()) -> Dynamics | None:
    """
    Return the Dynamics of a scene; None where the motion is given.

    ``forces``: those over a position, which the other elements join.

    Raises
    ------
    InvalidParameter
        Naming the parameter and what is allowed.

    """
    springs = [f'{group}.{name}' for group in ('springs', 'torsion_springs')
               for name in names_in(group, values)]
    if values['drive.source'] not in SOURCES:
        if springs:
            raise InvalidParameter(springs[0], None, 'a spring acts only where the motion follows '
                                   'from torque: drive.source: torque or motor')
        return None
    if linkage.bodies is None:
        raise InvalidParameter('bodies.crank.mass', None, 'must be given (or bodies.rods): motion '
                               'that follows from torque needs masses')
    from fourbar_ros.dynamics.model.drives import Drive
    gear = values[GEAR.name]
    rotor = gear * gear * values['motor.rotor_inertia']
    if not isfinite(rotor):
        raise InvalidParameter(GEAR.name, gear,
                               'its square times motor.rotor_inertia must be finite')
    drive = Drive(_source(values), rotor, values['flywheel.inertia'], _shaft(values))
    found = Dynamics(drive, (*(_element(values, name, linkage) for name in springs), *forces),
                     values['drive.start'], values['drive.start_speed'])
    _check_start(found, linkage)
    return found


def _source(values: ParameterValues) -> Law:
    from fourbar_ros.dynamics.model.drives import ConstantTorque
    if values[GEAR.name] == 0.0:
        raise InvalidParameter(GEAR.name, 0.0, 'must not be zero')
    if values['drive.source'] == 'torque':
        return ConstantTorque(0.0)
    kind = values['motor.kind']
    motor, names = MOTORS[kind], {field: one.name for field, one in OF_MOTORS[kind].items()}
    for field, default, _ in quantities_of(motor):
        if default is MISSING and isnan(values[names[field]]):
            raise InvalidParameter(names[field], None,
                                   f'must be given: {OF_MOTORS[kind][field].text}')
    try:
        return motor(**{field: values[name] for field, name in names.items()
                        if not isnan(values[name])})
    except InvalidParameter as error:
        raise InvalidParameter(names[error.name], error.value, error.allowed) from None


def _shaft(values: ParameterValues) -> Shaft | None:
    if isnan(values['shaft.stiffness']):
        if values['shaft.damping']:
            raise InvalidParameter('shaft.damping', values['shaft.damping'],
                                   'needs shaft.stiffness: a rigid shaft has no damping')
        return None
    if not values['motor.rotor_inertia']:
        raise InvalidParameter('motor.rotor_inertia', values['motor.rotor_inertia'],
                               'must be positive: an elastic shaft (shaft.stiffness) needs an '
                               'inertia on the side of the drive')
    from fourbar_ros.dynamics.model.drives import Shaft
    return Shaft(values['shaft.stiffness'], values['shaft.damping'])


def _element(values: ParameterValues, name: str, linkage: Mechanism) -> Element:
    from fourbar_ros.dynamics.model import elements
    from fourbar_ros.mechanisms.parts import GROUND
    links = (GROUND, *linkage.loads_of_links())

    def given(field: str) -> Any:
        value = values[f'{name}.{field}']
        if isinstance(value, str) and value not in links:
            raise InvalidParameter(f'{name}.{field}', value, one_of(links, value))
        return value

    try:
        if name.startswith('torsion'):
            return elements.TorsionSpring(given('first'), given('second'), given('stiffness'),
                                          given('free_angle'), given('damping'))
        first, second = (elements.Attachment(*(given(f'{end}.{field}')
                                               for field in ('link', 'along', 'across')))
                         for end in ('first', 'second'))
        return elements.Spring(first, second, given('stiffness'), given('free_length'),
                               given('damping'))
    except InvalidParameter as error:
        if error.name != 'second':
            raise
        field = 'second' if name.startswith('torsion') else 'second.link'
        raise InvalidParameter(f'{name}.{field}', error.value, error.allowed) from None


def _check_start(dynamics: Dynamics, linkage: Mechanism) -> None:
    """Refuse a start in which the links do not close or the equation of motion has no answer."""
    try:
        system = dynamics.system(linkage)
        rates = system.derivative(0.0, system.start)
        good = system.has_no_limits or system.distance_to_limit(system.start[0]) > 0.0
    except InvalidParameter:
        raise
    except (FourBarError, ArithmeticError) as error:
        raise InvalidParameter('drive.start', dynamics.position, f'no motion can start here: '
                               f'{error}') from None
    if not good:
        raise InvalidParameter('drive.start', dynamics.position, 'no motion can start here: at or '
                               'next to a limit of the input')
    if not all(abs(rate) < inf for rate in rates):
        raise InvalidParameter('drive.start', dynamics.position, 'the acceleration at the start '
                               'is not finite')
