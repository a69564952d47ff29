# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The single table of scene parameters: type, unit, default, allowed values, text. Imports no ROS.

It feeds the declaration in the node, the check of scene files, the manual and the tests.
"""
from __future__ import annotations

from math import nan
import re

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.scene import of_dynamics, of_kinds
from fourbar_ros.scene.parameter import Parameter, REQUIRED
from fourbar_ros.scene.topics import INPUTS, OUTPUTS, PICTURES, WRENCHES


def _length(name, length):
    name = f'linkage.{name}'
    if length.signed:
        return Parameter(name, 'double', 0.0, 'm', length.text)
    return Parameter(name, 'double', REQUIRED if length.is_in_all else nan, 'm', length.text,
                     positive=True)


def _body(link, first_joint):
    name = f'bodies.{link}.'
    return (
        Parameter(name + 'mass', 'double', nan, 'kg', f'mass of the {link}', low=0.0),
        Parameter(name + 'inertia', 'double', nan, 'kg m^2',
                  f'moment of inertia of the {link} about its centre of gravity; required with a '
                  'mass', low=0.0),
        Parameter(name + 'cg_along', 'double', nan, 'm',
                  f'centre of gravity of the {link}: distance from {first_joint} along the link; '
                  'default: half its length (0 for a link without a length)'),
        Parameter(name + 'cg_across', 'double', 0.0, 'm',
                  f'centre of gravity of the {link}: distance to the left of the line of the '
                  'link'),
    )


def _external(link, first_joint):
    name = f'external.{link}.'
    return (
        Parameter(name + 'force_x', 'double', 0.0, 'N', f'external force on the {link}: x '
                                                        'component, constant'),
        Parameter(name + 'force_y', 'double', 0.0, 'N', f'external force on the {link}: y '
                                                        'component, constant'),
        Parameter(name + 'along', 'double', 0.0, 'm',
                  f'point where the external force acts on the {link}: distance from '
                  f'{first_joint} along the link'),
        Parameter(name + 'across', 'double', 0.0, 'm',
                  f'point where the external force acts on the {link}: distance to the left of '
                  'the line of the link'),
        Parameter(name + 'couple', 'double', 0.0, 'N m', f'external couple on the {link}, '
                                                         'constant, counter-clockwise positive'),
        Parameter(name + 'from_topic', 'bool', False, '',
                  f'take the external force and couple on the {link} from the topic '
                  f'{WRENCHES[link].topic} instead of force_x, force_y and couple', live=False),
    )


PARAMETERS = {parameter.name: parameter for parameter in (
    Parameter('linkage.kind', 'string', 'four_bar', '',
              f'kind of linkage: {of_kinds.KINDS_IN_WORDS}', choices=tuple(KINDS), live=False),
    Parameter('linkage.input', 'string', 'crank', '',
              f'driven joint: the crank, or the slide of a {of_kinds.MORE_INPUTS_IN_WORDS}',
              choices=of_kinds.INPUTS,
              live=False),
    *(_length(*item) for item in of_kinds.LENGTHS.items()),
    Parameter('linkage.range', 'doubles', [], 'm',
              'stroke of a driven slide: [shortest, longest]; empty: every position where the '
              'linkage can be assembled', live=False),
    Parameter('linkage.mode', 'integer', 2, '',
              'assembly mode: 1 crossed, 2 open; for the sliders see docs/conventions.md', 1, 2),
    Parameter('gravity.x', 'double', 0.0, 'm/s^2', 'gravitational acceleration: x component'),
    Parameter('gravity.y', 'double', 0.0, 'm/s^2', 'gravitational acceleration: y component'),
    Parameter('bodies.rods.density', 'double', nan, 'kg/m^3',
              'model every link with two revolute joints as a solid cylinder of this density',
              positive=True),
    Parameter('bodies.rods.radius', 'double', nan, 'm',
              'radius of these cylinders (with bodies.rods.density)', positive=True),
    *(parameter for item in of_kinds.LINKS.items() for parameter in _body(*item)),
    *(parameter for item in of_kinds.LOADED_LINKS.items() for parameter in _external(*item)),
    Parameter('external.timeout', 'double', 1.0, 's', 'with from_topic: a link without a wrench '
                                                      'for longer than this counts as silent; 0: '
                                                      'never',
              low=0.0),
    Parameter('external.when_silent', 'string', 'unknown', '',
              'external wrench of a silent link, and before its first message: unknown (all loads '
              'are NaN), constant (force_x, force_y, couple) or hold (the last wrench; before the '
              'first, constant)', choices=('unknown', 'constant', 'hold')),
    Parameter('drive.source', 'string', 'timer', '',
              'source of the input: the clock (timer), Motion messages (motion), one joint of '
              'JointState messages (joint_state); or the motion follows from torque: of a topic '
              '(torque) or of a motor (motor)',
              choices=('timer', *INPUTS, *of_dynamics.SOURCES), live=False),
    Parameter('drive.speed', 'double', 1.0, 'rad/s or m/s',
              'with the timer: constant speed of the input'),
    Parameter('drive.start', 'double', 0.0, 'rad or m',
              'with the timer, torque or motor: input at the first sample', live=False),
    Parameter('drive.rate', 'double', 100.0, 'Hz',
              'with the timer, torque or motor: samples per second', high=5000.0, positive=True),
    *of_dynamics.DRIVE,
    Parameter('drive.joint', 'string', '', '', 'with joint_state: name of the driven joint',
              live=False),
    Parameter('drive.joint_ratio', 'double', 1.0, '',
              'with joint_state: ratio in joint = ratio * input + offset; negative if they turn '
              'in opposite directions', live=False),
    Parameter('drive.joint_offset', 'double', 0.0, 'rad or m',
              'with joint_state: offset in joint = ratio * input + offset',
              live=False),
    Parameter('drive.window', 'integer', 5, '',
              'estimate of missing rates: number of latest samples that are fitted', 3, 50),
    Parameter('drive.jump', 'double', 1.0, 'rad or m',
              'estimate of missing rates: a larger step between two samples restarts it',
              positive=True),
    Parameter('drive.timeout', 'double', 1.0, 's',
              'with messages: after this time without input the status is STATUS_INPUT_TIMEOUT; '
              '0: never', low=0.0),
    Parameter('drive.out_of_range', 'string', 'none', '',
              'published where the linkage cannot be assembled: NaN (none), the last good values '
              '(hold) or the pose at the nearest limit (clamp)',
              choices=('none', 'hold', 'clamp')),
    *of_dynamics.MOTOR,
    Parameter('outputs', 'strings', ['state', 'output', 'joint_states'], '',
              'outputs to publish; those not listed are neither created nor computed',
              choices=(*OUTPUTS, *PICTURES)),
    Parameter('pictures.rate', 'double', 30.0, 'Hz',
              'outputs tf and markers: messages per second at most; 0: one for every input',
              low=0.0),
    Parameter('frame_id', 'string', 'fourbar', '', 'frame_id of all outputs; origin O1, x towards '
                                                   'O4 or along the guide',
              live=False),
    Parameter('joint_names', 'strings', ['crank', 'coupler', 'coupler_output', 'output'], '',
              f'names of the joints in joint_states, in this order: {of_kinds.JOINTS_IN_WORDS}',
              live=False),
    Parameter('joint_states.prefix', 'string', '', '', 'prefix of every name in joint_names',
              live=False),
    Parameter('joint_states.ratios', 'doubles', [1.0] * 4, '',
              'ratio of each joint: published position = ratio * (angle or slide) + offset; '
              'negative: opposite direction', live=False),
    Parameter('joint_states.offsets', 'doubles', [0.0] * 4, 'rad or m',
              'offset of each joint: published position = ratio * (angle or slide) + offset',
              live=False),
    Parameter('joint_states.when_unknown', 'string', 'skip', '',
              'published while a position is unknown: nothing (skip: robot_state_publisher keeps '
              'the last pose), the last known positions with NaN rates (hold), or NaN (send_nan)',
              choices=('skip', 'hold', 'send_nan')),
    Parameter('joint_states.only_passive', 'bool', False, '',
              'leave the driven joint out of joint_states: for a node that publishes on the topic '
              'it listens to, as a relay does', live=False),
    Parameter('trajectories', 'bool', False, '',
              'translate trajectories of the output joint into those of the driven joint, and '
              'back; drive.start chooses the branch', live=False),
    Parameter('recording.start', 'bool', False, '', 'start recording with the first sample',
              live=False),
    Parameter('recording.directory', 'string', 'bags', '', 'directory for the bags', live=False),
    Parameter('recording.name', 'string', '', '', 'name of the first bag; empty: a new name from '
                                                  'the clock',
              live=False),
    Parameter('recording.split_size', 'double', 0.0, 'MB',
              'continue a bag in a new file when the current one exceeds this size; 0: never',
              low=0.0, live=False),
    Parameter('recording.split_duration', 'double', 0.0, 's',
              'continue a bag in a new file when the current one exceeds this duration; 0: never',
              low=0.0, live=False),
    Parameter('recording.keep', 'double', 0.0, 's',
              'keep only the files that hold the last so many seconds; 0: keep all (a file covers '
              'a tenth of this, unless split_size or split_duration is given)', low=0.0,
              live=False),
)}


# One set for each point of a scene; NAME is free: points.NAME.link and so on.
POINT = {parameter.name: parameter for parameter in (
    Parameter('points.NAME.link', 'string', 'coupler', '', 'link to which the point NAME is fixed',
              choices=tuple(of_kinds.LINKS)),
    Parameter('points.NAME.along', 'double', 0.0, 'm', 'position of the point NAME: distance '
              'from the first joint of its link along the link'),
    Parameter('points.NAME.across', 'double', 0.0, 'm',
              'position of the point NAME: distance to the left of the line of its link'),
)}
# Groups of which a scene may have any number.
NAMED = {'points': POINT, 'springs': of_dynamics.SPRING, 'torsion_springs': of_dynamics.TORSION}
_OF_ONE = re.compile(rf'({"|".join(NAMED)})\.([A-Za-z]\w*)\.([\w.]+)')


def find(name):
    """Return the Parameter of this name, one of the table or of a point or spring, or None."""
    match = _OF_ONE.fullmatch(name)
    general = NAMED[match[1]].get(f'{match[1]}.NAME.{match[3]}') if match else None
    if general is None:
        return PARAMETERS.get(name)
    return general._replace(name=name)


def names_in(group, values):
    """Return the names in a group of :data:`NAMED` that have a parameter, in order."""
    return list(dict.fromkeys(match[2] for match in map(_OF_ONE.fullmatch, values)
                              if match and match[1] == group))


def _why_unknown(name):
    parts = name.split('.')
    if parts[0] in NAMED and len(parts) >= 3 and not _OF_ONE.fullmatch(name):
        return (f'{parts[1]!r} is not a valid {parts[0][:-1].replace("_", " ")} name: use '
                'letters, digits and _, starting with a letter')
    every = [*PARAMETERS, *(name for table in NAMED.values() for name in table)]
    return f'unknown parameter{nearest(name, every, 0.75)}'


def check(values):
    """
    Return all parameters with defaults filled in, each in its own type.

    Raises
    ------
    InvalidParameter
        For the first unknown, missing or bad one.

    """
    for name in values:
        if find(name) is None:
            raise InvalidParameter(name, values[name], _why_unknown(name))
    for parameter in PARAMETERS.values():
        if parameter.default is REQUIRED and parameter.name not in values:
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
    named = [find(name.replace('NAME', one)) for group, table in NAMED.items()
             for one in names_in(group, values) for name in table]
    return {parameter.name: parameter.check(values.get(parameter.name, parameter.default))
            for parameter in (*PARAMETERS.values(), *named)}
