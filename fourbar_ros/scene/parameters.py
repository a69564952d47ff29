# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The single table of scene parameters: type, unit, default, allowed values, text. Imports no ROS.

It feeds the declaration in the node, the check of scene files, the manual and the tests.
"""
from __future__ import annotations

from array import array
from math import inf, isfinite, isnan, nan
import re
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.scene import of_kinds
from fourbar_ros.scene.topics import INPUTS, OUTPUTS, WRENCHES

REQUIRED = object()        # as a default: the scene must give the value
TYPES = {'double': float, 'integer': int, 'string': str, 'bool': bool, 'strings': list,
         'doubles': list}


class Parameter(NamedTuple):
    """
    One parameter.

    A ``default`` of NaN means "not given". ``low`` and ``high`` are inclusive; ``positive``
    excludes zero.
    """

    name: str
    type: str
    default: Any
    unit: str
    text: str
    low: float = -inf
    high: float = inf
    positive: bool = False
    choices: tuple[str, ...] = ()
    live: bool = True          # can be changed while the node runs

    def check(self, value):
        """Return the value in its own type, or raise InvalidParameter saying what is allowed."""
        kind = TYPES[self.type]
        if kind is float:
            value = _as_float(value)
        # an array of doubles comes so from rclpy
        if kind is list and isinstance(value, (tuple, array)):
            value = list(value)
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            raise InvalidParameter(self.name, value, f'must be {self._article} {self.type}')
        if self.type == 'strings':
            for item in value:
                if not isinstance(item, str) or (self.choices and item not in self.choices):
                    raise InvalidParameter(self.name, item,
                                           f'must be some of {", ".join(self.choices)}')
        elif self.type == 'doubles':
            value = [_as_float(item) for item in value]
            for item in value:
                if not isinstance(item, float) or not isfinite(item):
                    raise InvalidParameter(self.name, item, 'must hold finite numbers')
        elif self.choices and value not in self.choices:
            raise InvalidParameter(self.name, value, f'must be one of {", ".join(self.choices)}')
        if kind in (float, int):
            self._check_number(value)
        return value

    @property
    def _article(self):
        return 'an' if self.type == 'integer' else 'some' if TYPES[self.type] is list else 'a'

    def _check_number(self, value):
        if isnan(value) and isinstance(self.default, float) and isnan(self.default):
            return                                             # not given
        if not isfinite(value):
            raise InvalidParameter(self.name, value, 'must be a finite number')
        if self.positive and value <= 0:
            raise InvalidParameter(self.name, value, 'must be positive')
        if not self.low <= value <= self.high:
            raise InvalidParameter(self.name, value, f'must lie in {self.allowed}')

    @property
    def allowed(self):
        """Return the allowed values as text."""
        if self.choices:
            return ', '.join(self.choices)
        if self.positive:
            return '> 0' if self.high == inf else f'(0, {self.high:g}]'
        if self.low > -inf:
            return f'>= {self.low:g}' if self.high == inf else f'[{self.low:g}, {self.high:g}]'
        return ''


def _as_float(value):
    """Return an integer as a float, anything else as it is."""
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


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
              'source of the input: the clock (timer), Motion messages (motion) or one joint of '
              'JointState messages (joint_state)',
              choices=('timer', *INPUTS), live=False),
    Parameter('drive.speed', 'double', 1.0, 'rad/s or m/s',
              'with the timer: constant speed of the input'),
    Parameter('drive.start', 'double', 0.0, 'rad or m',
              'with the timer: input at the first sample', live=False),
    Parameter('drive.rate', 'double', 100.0, 'Hz', 'with the timer: samples per second',
              high=5000.0, positive=True),
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
    Parameter('outputs', 'strings', ['state', 'output', 'joint_states'], '',
              'outputs to publish; those not listed are neither created nor computed',
              choices=tuple(OUTPUTS)),
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
_POINT_NAME = re.compile(r'points\.([A-Za-z]\w*)\.\w+')


def find(name):
    """Return the Parameter of this name, one of the table or of a point, or None."""
    match = _POINT_NAME.fullmatch(name)
    general = POINT.get(name.replace(f'.{match[1]}.', '.NAME.', 1)) if match else None
    return general._replace(name=name) if general else PARAMETERS.get(name)


def points_in(values):
    """Return the names of the points that have a parameter, in order."""
    return list(dict.fromkeys(match[1] for match in map(_POINT_NAME.fullmatch, values) if match))


def _why_unknown(name):
    parts = name.split('.')
    if parts[0] == 'points' and len(parts) == 3 and not _POINT_NAME.fullmatch(name):
        return (f'{parts[1]!r} is not a valid point name: use letters, digits and _, starting '
                'with a letter')
    return f'unknown parameter{nearest(name, [*PARAMETERS, *POINT], 0.75)}'


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
    of_points = [find(name.replace('NAME', point)) for point in points_in(values)
                 for name in POINT]
    return {parameter.name: parameter.check(values.get(parameter.name, parameter.default))
            for parameter in (*PARAMETERS.values(), *of_points)}
