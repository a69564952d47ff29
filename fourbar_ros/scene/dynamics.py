# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The drive, springs and start of a scene whose motion follows from torque."""
from __future__ import annotations

from dataclasses import MISSING
from math import inf, isfinite, isnan
from typing import NamedTuple

from fourbar_ros.dynamics.elements import (
    Attachment,
    Element,
    PositionForce,
    Spring,
    TorsionSpring,
)
from fourbar_ros.dynamics.sources import ConstantTorque, Drive, Law, Shaft
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter, one_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.number_fields import quantities_of
from fourbar_ros.scene.parameters import names_in, point_in
from fourbar_ros.scene.settings import GEAR, MOTORS, of_motor, ParameterValues, SOURCES


class Dynamics(NamedTuple):
    """Drive, springs and dampers, and where the input starts [rad] or [m], [rad/s] or [m/s]."""

    drive: Drive
    elements: tuple[Element, ...]
    position: float
    rate: float

    def system(self, mechanism: Mechanism) -> System:
        """Return the equation of motion of a linkage with this drive and these springs."""
        return System(mechanism, self.position, self.rate, self.elements, self.drive)


def of_values(values: ParameterValues, mechanism: Mechanism,
              forces: tuple[PositionForce, ...] = ()) -> Dynamics | None:
    """
    Return the Dynamics of a scene; None where the motion is given.

    ``forces``: the scene's forces over a position, which act besides its springs. InvalidParameter
    names the parameter and the allowed values.
    """
    springs = [f'{group}.{name}' for group in ('springs', 'torsion_springs')
               for name in names_in(group, values)]
    if values['drive.source'] not in SOURCES:
        if springs:
            raise InvalidParameter(springs[0], None, 'a spring acts only where the motion follows '
                                   'from torque: drive.source: torque or motor')
        return None
    if mechanism.bodies is None:
        raise InvalidParameter('bodies.crank.mass', None, 'must be given (or bodies.rods): motion '
                               'that follows from torque needs masses')
    gear = values[GEAR.name]
    rotor = gear * gear * values['motor.rotor_inertia']
    if not isfinite(rotor):
        raise InvalidParameter(GEAR.name, gear,
                               'its square times motor.rotor_inertia must be finite')
    drive = Drive(_source(values), rotor, values['flywheel.inertia'], _shaft(values))
    springs_made = tuple(_spring(values, name, mechanism) for name in springs)
    dynamics = Dynamics(drive, springs_made + forces, values['drive.start'],
                        values['drive.start_speed'])
    _check_start(dynamics, mechanism)
    return dynamics


def _source(values: ParameterValues) -> Law:
    """Return the source of torque: a topic (0 N m before its first message) or a motor."""
    if values[GEAR.name] == 0.0:
        raise InvalidParameter(GEAR.name, 0.0, 'must not be zero')
    if values['drive.source'] == 'torque':
        return ConstantTorque(0.0)
    kind = values['motor.kind']
    parameters, law = of_motor(kind), MOTORS[kind]
    arguments = {field: values[parameter.name] for field, parameter in parameters.items()}
    for field, default, _ in quantities_of(law):
        if default is MISSING and isnan(arguments[field]):
            raise InvalidParameter(parameters[field].name, None,
                                   f'must be given: {parameters[field].text}')
    try:
        return law(**{field: value for field, value in arguments.items() if not isnan(value)})
    except InvalidParameter as error:          # names the field of the motor
        raise InvalidParameter(parameters[error.name].name, error.value, error.allowed) from None


def _shaft(values: ParameterValues) -> Shaft | None:
    """
    Return the elastic shaft between drive and input; None without ``shaft.stiffness``: rigid.

    InvalidParameter for damping of a rigid shaft, or an elastic one on a motor without inertia.
    """
    if isnan(values['shaft.stiffness']):
        if values['shaft.damping'] != 0.0:
            raise InvalidParameter('shaft.damping', values['shaft.damping'],
                                   'needs shaft.stiffness: a rigid shaft has no damping')
        return None
    if values['motor.rotor_inertia'] == 0.0:
        raise InvalidParameter('motor.rotor_inertia', values['motor.rotor_inertia'],
                               'must be positive: an elastic shaft (shaft.stiffness) needs an '
                               'inertia on the side of the drive')
    return Shaft(values['shaft.stiffness'], values['shaft.damping'])


def _spring(values: ParameterValues, name: str, mechanism: Mechanism) -> Element:
    """Return the spring of the parameters ``name``.*, springs.NAME or torsion_springs.NAME."""
    links, turns = (GROUND, *mechanism.loads_of_links()), name.startswith('torsion')
    of_links = [f'{name}.{end}' if turns else f'{name}.{end}.link' for end in ('first', 'second')]
    for parameter in of_links:
        if values[parameter] not in links:
            raise InvalidParameter(parameter, values[parameter], one_of(links, values[parameter]))
    stiffness, damping = values[f'{name}.stiffness'], values[f'{name}.damping']
    try:
        if turns:
            return TorsionSpring(values[of_links[0]], values[of_links[1]], stiffness,
                                 free_angle=values[f'{name}.free_angle'], damping=damping)
        first, second = (Attachment(*point_in(f'{name}.{end}', values))
                         for end in ('first', 'second'))
        return Spring(first, second, stiffness, free_length=values[f'{name}.free_length'],
                      damping=damping)
    except InvalidParameter as error:
        if error.name != 'second':
            raise
        raise InvalidParameter(of_links[1], error.value, error.allowed) from None


def _check_start(dynamics: Dynamics, mechanism: Mechanism) -> None:
    """Refuse a start in which the links do not close or the equation of motion has no answer."""
    def refuse(why: str) -> InvalidParameter:
        return InvalidParameter('drive.start', dynamics.position, why)

    try:
        system = dynamics.system(mechanism)
        rates = system.derivative(0.0, system.start)
        good = system.mechanism.turns_fully or system.distance_to_limit(system.start[0]) > 0.0
    except InvalidParameter:
        raise
    except (FourBarError, ArithmeticError) as error:
        raise refuse(f'no motion can start here: {error}') from None
    if not good:
        raise refuse('no motion can start here: at or next to a limit of the input')
    if not all(abs(rate) < inf for rate in rates):
        raise refuse('the acceleration at the start is not finite')
