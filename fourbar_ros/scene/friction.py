# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Friction of the joints and of the drive of a scene; imported for scenes that have any."""
from __future__ import annotations

from math import isnan

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.friction import DriveFriction, Friction, JointFriction
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import DRIVE
from fourbar_ros.scene.parameters import names_in, of_name
from fourbar_ros.scene.settings import ParameterValues

OF_DRIVE = 'torque', 'viscous', 'slip_speed'
OF_JOINTS = 'coefficient', 'radius', 'length', 'viscous'


def friction_of(values: ParameterValues, mechanism: Mechanism) -> Friction:
    names = names_in('friction', values)
    if mechanism.bodies is None:
        raise InvalidParameter('bodies.crank.mass', None, 'must be given (or bodies.rods): '
                               f'friction.{names[0]} needs masses')
    if 'equation' in values['outputs']:
        raise InvalidParameter('outputs', 'equation', 'has no friction, which depends on the '
                               f'acceleration: leave it out, or friction.{names[0]}')
    pairs = list[tuple[str, JointFriction | DriveFriction]]()
    for name in names:
        fields, others = ((OF_DRIVE, OF_JOINTS) if name == DRIVE else (OF_JOINTS, OF_DRIVE))
        for field in others:
            parameter = of_name(f'friction.{name}.{field}')
            value = values[parameter.name]
            if field not in fields and value == value and value != parameter.default:
                raise InvalidParameter(parameter.name, value, f'friction.{name} has '
                                       f'{", ".join(fields)} only')
        given = {field: values[f'friction.{name}.{field}'] for field in fields}
        pairs.append((name, DriveFriction(**given) if name == DRIVE else JointFriction(
            **{field: value for field, value in given.items() if not isnan(value)})))
    return tuple(pairs)
