# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The drive and start of a scene whose motion follows from torque."""
from dataclasses import MISSING
from math import isfinite, isnan
from typing import NamedTuple

from fourbar_ros.dynamics.sources import ConstantTorque, Drive, Law, Shaft
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanics.bodies import Base, UnknownBase
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arguments import quantities_of
from fourbar_ros.scene.linkage import require_masses
from fourbar_ros.scene.settings import GEAR, MOTORS, of_motor, ParameterValues


class Dynamics(NamedTuple):
    """The drive, and where the input starts [rad] or [m], [rad/s] or [m/s]."""

    drive: Drive
    position: float
    rate: float

    def system(self, mechanism: Mechanism) -> System:
        """Return the equation of motion; an unknown base does nothing before its first message."""
        if isinstance(mechanism.gravity, UnknownBase):
            mechanism = mechanism.with_base(Base())
        return System(mechanism, self.position, self.rate, self.drive)


def of_values(values: ParameterValues, mechanism: Mechanism) -> Dynamics:
    """Return the Dynamics of a scene that torque moves; InvalidParameter names the parameter."""
    require_masses(mechanism, 'motion that follows from torque')
    gear, stiffness = values[GEAR.name], values['shaft.stiffness']
    if gear == 0.0:
        raise InvalidParameter(GEAR.name, gear, 'must not be zero')
    rotor = gear * gear * values['motor.rotor_inertia']
    if not isfinite(rotor):
        raise InvalidParameter(GEAR.name, gear,
                               'its square times motor.rotor_inertia must be finite')
    shaft = None            # rigid
    if not isnan(stiffness):
        shaft = Shaft(stiffness, values['shaft.damping'])
        if values['motor.rotor_inertia'] == 0.0:
            raise InvalidParameter('motor.rotor_inertia', 0.0, 'must be positive: an elastic '
                                   'shaft (shaft.stiffness) needs an inertia on the side of the '
                                   'drive')
    elif values['shaft.damping'] != 0.0:
        raise InvalidParameter('shaft.damping', values['shaft.damping'],
                               'needs shaft.stiffness: a rigid shaft has no damping')
    drive = Drive(_source(values), rotor, values['flywheel.inertia'], shaft)
    dynamics = Dynamics(drive, values['drive.start'], values['drive.start_speed'])

    start, why = dynamics.position, ''
    try:
        system = dynamics.system(mechanism)
        accelerations = system.derivative(0.0, system.start)
        if not system.distance_to_limit(system.start[0]) > 0.0:
            why = 'no motion can start here: at or next to a limit of the input'
        elif not all(map(isfinite, accelerations)):
            why = 'the acceleration at the start is not finite'
    except InvalidParameter:
        raise
    except (FourBarError, ArithmeticError) as error:
        why = f'no motion can start here: {error}'
    if why:
        raise InvalidParameter('drive.start', start, why)
    return dynamics


def _source(values: ParameterValues) -> Law:
    """Return the source of torque: a topic (0 N m before its first message) or a motor."""
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
