# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of scenes whose motion follows from torque: drive, motor, shaft, springs."""
from __future__ import annotations

from math import nan

from fourbar_ros.scene.parameter import Parameter

SOURCES = ('torque', 'motor')      # of drive.source, with which the motion follows from torque
GROUND = 'ground'

DRIVE = (
    Parameter('drive.start_speed', 'double', 0.0, 'rad/s or m/s',
              'with torque or motor: speed of the input at the start', live=False),
    Parameter('drive.tolerance', 'double', 1e-6, '',
              'with torque or motor: largest error of one step of the node, of angles [rad] and, '
              'over one sample, of speeds [rad/s]', low=1e-12, high=0.1),
    Parameter('drive.budget', 'integer', 60, '',
              'with torque or motor: most evaluations of the equation of motion in one step; a '
              'step that needs more is finished less accurately, as its status shows', 12, 10000),
    Parameter('drive.when_silent', 'string', 'zero', '',
              'with torque: torque in effect before the first message, and after drive.timeout '
              'without one: none (zero), or the last one (hold; before the first, none)',
              choices=('zero', 'hold')),
    Parameter('drive.torque_limit', 'double', nan, 'N m or N',
              'with torque: a larger torque from the topic counts as this one; default: no limit',
              positive=True),
)

MOTOR = (
    Parameter('motor.kind', 'string', 'line', '',
              'with motor: torque that falls linearly with speed (line), DC motor (dc), or speed '
              'controller with a limited torque (controller)',
              choices=('line', 'dc', 'controller')),
    Parameter('motor.gear', 'double', 1.0, '',
              'gear ratio: speed of the motor over that of the shaft behind the gear; not zero'),
    Parameter('motor.rotor_inertia', 'double', 0.0, 'kg m^2 or kg',
              'inertia of the rotor itself; behind the gear it counts gear^2 times', low=0.0),
    Parameter('motor.stall_torque', 'double', nan, 'N m or N',
              'line: torque of the motor at rest'),
    Parameter('motor.free_speed', 'double', nan, 'rad/s or m/s',
              'line: speed of the motor without load'),
    Parameter('motor.voltage', 'double', nan, 'V', 'dc: voltage of the armature'),
    Parameter('motor.resistance', 'double', nan, 'ohm', 'dc: resistance of the armature',
              positive=True),
    Parameter('motor.inductance', 'double', 0.0, 'H',
              'dc: inductance of the armature; 0: the current follows at once', low=0.0),
    Parameter('motor.torque_constant', 'double', nan, 'N m/A',
              'dc: torque per current, and voltage per speed [V s/rad]', positive=True),
    Parameter('motor.speed', 'double', nan, 'rad/s or m/s',
              'controller: speed wanted of the shaft behind the gear'),
    Parameter('motor.proportional', 'double', nan, 'N m s/rad',
              'controller: torque behind the gear per error of the speed', low=0.0),
    Parameter('motor.integral', 'double', 0.0, 'N m/rad',
              'controller: torque behind the gear per integral of that error', low=0.0),
    Parameter('motor.torque_limit', 'double', nan, 'N m or N',
              'controller: largest torque behind the gear; default: no limit', positive=True),
    Parameter('shaft.stiffness', 'double', nan, 'N m/rad or N/m',
              'elastic shaft between the drive and the input; default: a rigid one',
              positive=True),
    Parameter('shaft.damping', 'double', 0.0, 'N m s/rad or N s/m', 'damping of the elastic shaft',
              low=0.0),
    Parameter('flywheel.inertia', 'double', 0.0, 'kg m^2 or kg',
              'inertia on the input itself, on its side of an elastic shaft', low=0.0),
)


def _end(which: str) -> tuple[Parameter, ...]:
    name = f'springs.NAME.{which}'
    return (
        Parameter(f'{name}.link', 'string', GROUND, '',
                  f'link to which the {which} end of the spring NAME is fixed'),
        Parameter(f'{name}.along', 'double', 0.0, 'm',
                  f'{which} end of the spring NAME: distance from the first joint of its link '
                  'along the link; on the ground x from O1'),
        Parameter(f'{name}.across', 'double', 0.0, 'm',
                  f'{which} end of the spring NAME: distance to the left of the line of its link; '
                  'on the ground y from O1'),
    )


# One set for each spring of a scene; NAME is free. A damper is a spring without stiffness.
SPRING = {parameter.name: parameter for parameter in (
    *_end('first'), *_end('second'),
    Parameter('springs.NAME.stiffness', 'double', 0.0, 'N/m', 'stiffness of the spring NAME',
              low=0.0),
    Parameter('springs.NAME.free_length', 'double', 0.0, 'm',
              'length of the spring NAME without force', low=0.0),
    Parameter('springs.NAME.damping', 'double', 0.0, 'N s/m',
              'damping along the line between the two ends of the spring NAME', low=0.0),
)}
TORSION = {parameter.name: parameter for parameter in (
    Parameter('torsion_springs.NAME.first', 'string', GROUND, '',
              'link at one end of the torsion spring NAME'),
    Parameter('torsion_springs.NAME.second', 'string', 'crank', '',
              'link at the other end of the torsion spring NAME'),
    Parameter('torsion_springs.NAME.stiffness', 'double', 0.0, 'N m/rad',
              'stiffness of the torsion spring NAME', low=0.0),
    Parameter('torsion_springs.NAME.free_angle', 'double', 0.0, 'rad',
              'angle of the second link relative to the first without moment'),
    Parameter('torsion_springs.NAME.damping', 'double', 0.0, 'N m s/rad',
              'damping of the torsion spring NAME', low=0.0),
)}
