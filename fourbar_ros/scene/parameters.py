"""
The parameters of a scene, once: type, unit, default, allowed values, text. No ROS is imported here.

This table feeds the declaration in the node, the check of scene files, the manual and the tests.
"""
from __future__ import annotations

import re
from array import array
from math import inf, isfinite, isnan, nan
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.errors import nearest
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.mechanism import CRANK, SLIDE
from fourbar_ros.mechanisms.points import COUPLER, LINKS
from fourbar_ros.scene.topics import INPUTS, OUTPUTS, WRENCHES

REQUIRED = object()        # as a default: the scene must give the value
TYPES = {'double': float, 'integer': int, 'string': str, 'bool': bool, 'strings': list, 'doubles': list}


class Parameter(NamedTuple):
    """One parameter; ``default`` NaN means "not given", low and high are inclusive unless 0 < is said."""

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
        if kind is list and isinstance(value, (tuple, array)):      # an array of doubles comes so from rclpy
            value = list(value)
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            raise InvalidParameter(self.name, value, f'must be {self._article} {self.type}')
        if self.type == 'strings':
            for item in value:
                if not isinstance(item, str) or (self.choices and item not in self.choices):
                    raise InvalidParameter(self.name, item, f'must be some of {", ".join(self.choices)}')
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


def _body(link, first_joint):
    name = f'bodies.{link}.'
    return (
        Parameter(name + 'mass', 'double', nan, 'kg', f'mass of the {link}', low=0.0),
        Parameter(name + 'inertia', 'double', nan, 'kg m^2',
                  'moment of inertia about the centre of gravity; needed with a mass', low=0.0),
        Parameter(name + 'cg_along', 'double', nan, 'm',
                  f'centre of gravity from {first_joint} along the link; not given: half its length, if it has one'),
        Parameter(name + 'cg_across', 'double', 0.0, 'm',
                  'centre of gravity to the left of the link line'),
    )


def _external(link, first_joint):
    name = f'external.{link}.'
    return (
        Parameter(name + 'force_x', 'double', 0.0, 'N', f'constant force on the {link} along O1-O4, of anything outside'),
        Parameter(name + 'force_y', 'double', 0.0, 'N', 'and across O1-O4'),
        Parameter(name + 'along', 'double', 0.0, 'm', f'where it acts: from {first_joint} along the link'),
        Parameter(name + 'across', 'double', 0.0, 'm', 'and to the left of the link line'),
        Parameter(name + 'couple', 'double', 0.0, 'N m', f'constant couple on the {link}, counter-clockwise'),
        Parameter(name + 'from_topic', 'bool', False, '',
                  f'force and couple come from the topic {WRENCHES[link].topic} in place of these', live=False),
    )


PARAMETERS = {parameter.name: parameter for parameter in (
    Parameter('linkage.kind', 'string', 'four_bar', '',
              'four joints that turn; a slider on a guide parallel to x; a block on a bar that turns about O4 '
              '(inverted slider-crank, oscillating cylinder)', choices=tuple(KINDS), live=False),
    Parameter('linkage.input', 'string', CRANK, '',
              'what is driven: the crank, or the slide of a slider_crank or inverted_slider', choices=(CRANK, SLIDE),
              live=False),
    Parameter('linkage.a1', 'double', REQUIRED, 'm', 'length of the crank O1-A', positive=True),
    Parameter('linkage.a2', 'double', nan, 'm', 'length of the coupler A-B (not of an inverted_slider)', positive=True),
    Parameter('linkage.a3', 'double', nan, 'm', 'length of the output link O4-B (four_bar)', positive=True),
    Parameter('linkage.a4', 'double', nan, 'm', 'length of the ground O1-O4 (not of a slider_crank)', positive=True),
    Parameter('linkage.offset', 'double', 0.0, 'm',
              'slider_crank: y of the guide; inverted_slider: of the line of A from O4, to the left of the bar'),
    Parameter('linkage.range', 'doubles', [], 'm',
              'driven slide: [shortest, longest], its stroke; empty: all where the links close', live=False),
    Parameter('linkage.mode', 'integer', 2, '',
              'assembly mode: 1 crossed, 2 open; of the sliders see docs/conventions.md', 1, 2),
    Parameter('gravity.x', 'double', 0.0, 'm/s^2', 'field of gravity along x'),
    Parameter('gravity.y', 'double', 0.0, 'm/s^2', 'field of gravity across x'),
    Parameter('bodies.rods.density', 'double', nan, 'kg/m^3',
              'all links that have two joints that turn are uniform round rods of this density', positive=True),
    Parameter('bodies.rods.radius', 'double', nan, 'm', 'and of this radius', positive=True),
    *_body('crank', 'O1'),
    *_body('coupler', 'A'),
    *_body('output', 'O4, of a slider from B,'),
    *_external('coupler', 'A'),
    *_external('output', 'O4, of a slider from B,'),
    Parameter('external.timeout', 'double', 1.0, 's', 'from_topic: longer without a wrench is a silence; 0: never',
              low=0.0),
    Parameter('external.when_silent', 'string', 'unknown', '',
              'in a silence, and before the first wrench: unknown (all loads NaN), constant (force_x, force_y, couple), '
              'or hold the last wrench (before the first: constant)', choices=('unknown', 'constant', 'hold')),
    Parameter('drive.source', 'string', 'timer', '',
              'what drives the input: the clock, a Motion message, or a joint of a JointState',
              choices=('timer', *INPUTS), live=False),
    Parameter('drive.speed', 'double', 1.0, 'rad/s or m/s', 'timer: constant speed of the input'),
    Parameter('drive.start', 'double', 0.0, 'rad or m', 'timer: input at the first sample', live=False),
    Parameter('drive.rate', 'double', 100.0, 'Hz', 'timer: samples a second', high=5000.0, positive=True),
    Parameter('drive.joint', 'string', '', '', 'joint_state: name of the joint that is the input',
              live=False),
    Parameter('drive.joint_ratio', 'double', 1.0, '',
              'joint_state: joint = ratio * input + offset; negative where they turn in opposite senses', live=False),
    Parameter('drive.joint_offset', 'double', 0.0, 'rad or m', 'joint_state: position of the joint where the input is 0',
              live=False),
    Parameter('drive.window', 'integer', 5, '',
              'missing rates: number of newest samples the estimate is fitted to', 3, 50),
    Parameter('drive.jump', 'double', 1.0, 'rad or m',
              'missing rates: a larger step between two samples starts the estimate afresh', positive=True),
    Parameter('drive.timeout', 'double', 1.0, 's',
              'messages: longer without input and the status says so; 0: never', low=0.0),
    Parameter('drive.out_of_range', 'string', 'none', '',
              'where the linkage cannot be assembled: none (all NaN), hold the last good values, or clamp to the limit',
              choices=('none', 'hold', 'clamp')),
    Parameter('outputs', 'strings', ['state', 'output', 'joint_states'], '',
              'what is published, by name; what is not named is not computed', choices=tuple(OUTPUTS)),
    Parameter('frame_id', 'string', 'fourbar', '', 'frame of all outputs: origin O1, x towards O4',
              live=False),
    Parameter('joint_names', 'strings', ['crank', 'coupler', 'coupler_output', 'output'], '',
              'names in joint_states of the joints at O1, A, B, O4 (slider_crank: O1, A, B, guide; inverted_slider: '
              'O1, A, slide, O4)', live=False),
    Parameter('joint_states.prefix', 'string', '', '', 'put before each of joint_names', live=False),
    Parameter('joint_states.ratios', 'doubles', [1.0] * 4, '',
              'for each joint: position sent = ratio * angle or slide + offset; negative: opposite sense', live=False),
    Parameter('joint_states.offsets', 'doubles', [0.0] * 4, 'rad or m', 'for each joint: the offset', live=False),
    Parameter('joint_states.when_unknown', 'string', 'skip', '',
              'where a position is not known: skip (no message: robot_state_publisher keeps the last pose), hold (the '
              'last known positions, rates NaN), send_nan', choices=('skip', 'hold', 'send_nan')),
    Parameter('recording.start', 'bool', False, '', 'record from the first sample on', live=False),
    Parameter('recording.directory', 'string', 'bags', '', 'where bags go', live=False),
    Parameter('recording.name', 'string', '', '', 'name of the first bag; empty: a fresh one',
              live=False),
    Parameter('recording.split_size', 'double', 0.0, 'MB', 'a bag goes on in a new file when one is larger; 0: never',
              low=0.0, live=False),
    Parameter('recording.split_duration', 'double', 0.0, 's', 'or when one is longer; 0: never', low=0.0, live=False),
    Parameter('recording.keep', 'double', 0.0, 's',
              'files that the newest so many seconds do not need are removed; 0: all are kept (a tenth of it is a file, '
              'unless split_size or split_duration says otherwise)', low=0.0, live=False),
)}


# Of every point of a scene, under any name: points.NAME.link and so on.
POINT = {parameter.name: parameter for parameter in (
    Parameter('points.NAME.link', 'string', COUPLER, '', 'link that the point NAME is fixed to', choices=LINKS),
    Parameter('points.NAME.along', 'double', 0.0, 'm', 'where it is: from the first joint of the link along it'),
    Parameter('points.NAME.across', 'double', 0.0, 'm', 'and to the left of the link line'),
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
        return f'{parts[1]!r} is no name of a point: letters, digits and _, the first a letter'
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
    of_points = [find(name.replace('NAME', point)) for point in points_in(values) for name in POINT]
    return {parameter.name: parameter.check(values.get(parameter.name, parameter.default))
            for parameter in (*PARAMETERS.values(), *of_points)}
