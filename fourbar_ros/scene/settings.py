# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All parameters of a scene: type, unit, default, allowed values, text. Imports no ROS.

They feed the declaration in the node, the check of scene files, the manual and the tests;
:mod:`fourbar_ros.scene.parameters` finds and checks them. Families are groups of which a scene may
have any number: in ``points.NAME.link`` NAME is free.
"""
from collections.abc import Iterable, Mapping
from math import inf, isfinite, nan
from types import MappingProxyType
from typing import Any, NamedTuple

from fourbar_ros.dynamics import sources
from fourbar_ros.mechanisms.kinds import kind_of, KINDS
from fourbar_ros.mechanisms.machine.structure import DIMENSIONS
from fourbar_ros.mechanisms.parts import GROUND, JOINT_A, Length, SLIDE
from fourbar_ros.numerics.arguments import FARTHEST, FASTEST, quantities_of
from fourbar_ros.scene import topics, units

ParameterValues = Mapping[str, Any]       # {name: value}; their types stand in the table

MODES = MappingProxyType({'crossed': 1, 'open': 2})
REQUIRED = object()        # as a default: the scene must give the value
MACHINE, NAME, COUPLE = 'machine', 'NAME', 'couple'
APART = 'apart'         # forces.NAME.acts between two points
IN_QUOTES = 'names as N, y, on need quotes'      # in YAML they are truth values
TIMER, MESSAGES = 'timer', tuple(topics.INPUTS)
# of drive.source, with which the motion follows from torque
SOURCES = (topics.TORQUE.name, 'motor')
# {unit: its size in SI} of both columns of a table of forces
POSITION_UNITS = {**units.UNITS['rad'], **units.UNITS['m']}
FORCE_UNITS = {**units.UNITS['N'], **units.UNITS['N m'], **units.UNITS['Pa']}


class Parameter(NamedTuple):
    """One parameter, declared in the node, checked in scene files, printed in the manual."""

    name: str
    type: str
    default: Any                    # NaN: not given
    unit: str
    text: str
    low: float = -inf               # low and high are inclusive
    high: float = inf
    positive: bool = False          # excludes zero
    choices: tuple[str, ...] = ()
    live: bool = True               # can be changed while the node runs
    words: Mapping[str, Any] = MappingProxyType({})       # names of some values
    least_but_zero: float = 0.0     # a value below it must be 0, which turns something off

    @property
    def allowed(self) -> str:
        """Return the allowed values as text: 'a, b', '0 or >= 1', '> 0', '[1, 2]'; '' for any."""
        if self.choices:
            return ', '.join(self.choices)
        if self.least_but_zero:
            return f'0 or >= {self.least_but_zero:g}'
        if self.positive:
            return '> 0' if self.high == inf else f'(0, {self.high:g}]'
        if self.low > -inf:
            return f'>= {self.low:g}' if self.high == inf else f'[{self.low:g}, {self.high:g}]'
        return ''


def _group(name: str, parameters: Iterable[Parameter]) -> list[Parameter]:
    return [parameter._replace(name=f'{name}.{parameter.name}') for parameter in parameters]


def _table(*parameters: Parameter) -> dict[str, Parameter]:
    return {parameter.name: parameter for parameter in parameters}


# --- the linkage ---------------------------------------------------------------------------------

def _length(name: str) -> Parameter:
    """Return the parameter of a length, whose text names the kinds that have it."""
    kinds: dict[Length, list[str]] = {}
    for kind_name, kind in KINDS.items():
        for length in kind.LENGTHS:
            if length.name == name:
                kinds.setdefault(length, []).append(kind_name)
    text = '; '.join(f'{length.text} ({", ".join(names)})' for length, names in kinds.items())
    is_signed = any(length.signed for length in kinds)
    return Parameter(f'linkage.{name}', 'double', 0.0 if is_signed else nan, 'm', text,
                     positive=not is_signed)


# of all kinds together: names of the lengths
LENGTHS = tuple(dict.fromkeys(length.name for kind in KINDS.values() for length in kind.LENGTHS))
_DRIVEN = tuple(dict.fromkeys(driven for kind in (*KINDS.values(), kind_of('four_bar', JOINT_A))
                              for driven in kind.INPUTS))
_KINDS_IN_WORDS = '; '.join(f'{kind.TEXT} ({name})' for name, kind in KINDS.items())
_JOINTS_IN_WORDS = '; '.join(f'{", ".join(joint.name for joint in kind.JOINTS)} ({name})'
                             for name, kind in KINDS.items())
_WITH_SLIDES = ' or '.join(name for name, kind in KINDS.items() if SLIDE in kind.INPUTS)


# --- motors --------------------------------------------------------------------------------------

# {kind of motor: its law}, whose numbers are motor.NAME
MOTORS: dict[str, type[sources.Law]] = {
    'line': sources.MotorLine, 'dc': sources.DCMotor, 'controller': sources.SpeedController,
    'induction': sources.InductionMotor}


def of_motor(kind: str) -> dict[str, Parameter]:
    """Return {number of the law of a motor: its parameter motor.NAME}."""
    parameters = {}
    for name, default, quantity in quantities_of(MOTORS[kind]):
        has_default = isinstance(default, (int, float)) and isfinite(default)
        parameters[name] = Parameter(
            f'motor.{quantity.parameter or name}', 'integer' if quantity.is_whole else 'double',
            default if has_default else nan, quantity.unit, f'{kind}: {quantity.text}',
            low=quantity.least, positive=quantity.above == 0.0)
    return parameters


GEAR = Parameter('motor.gear', 'double', 1.0, '',
                 'gear ratio: speed of the motor over that of the shaft behind the gear; not zero')


# --- groups --------------------------------------------------------------------------------------

_DRIVE = _group('drive', (
    Parameter('source', 'string', TIMER, '',
              'source of the input: the clock (timer), Motion messages (motion), one joint of '
              'JointState messages (joint_state); or the motion follows from torque: of a topic '
              '(torque) or of a motor (motor)', choices=(TIMER, *MESSAGES, *SOURCES), live=False),
    Parameter('speed', 'double', 1.0, 'rad/s or m/s',
              'with the timer: constant speed of the input', low=-FASTEST, high=FASTEST),
    Parameter('start', 'double', 0.0, 'rad or m', 'with the timer, torque or motor: input at the '
              'first sample', low=-FARTHEST, high=FARTHEST, live=False),
    Parameter('rate', 'double', 100.0, 'Hz',
              'with the timer, torque or motor: samples per second', low=0.001, high=5000.0),
    Parameter('start_speed', 'double', 0.0, 'rad/s or m/s', 'with torque or motor: speed of the '
              'input at the start', low=-FASTEST, high=FASTEST, live=False),
    Parameter('tolerance', 'double', 1e-6, '',
              'with torque or motor: largest error of one step of the node, of angles [rad] and, '
              'over one sample, of speeds [rad/s]', low=1e-12, high=0.1),
    Parameter('budget', 'integer', 60, '', 'with torque or motor: most evaluations of the '
              'equation of motion in one step; a step that needs more is finished less '
              'accurately, as its status shows', low=12, high=10000),
    Parameter('when_silent', 'string', 'zero', '', 'with torque: torque in effect before the '
              'first message, and after drive.timeout without one: none (zero), or the last one '
              '(hold; before the first, none)', choices=('zero', 'hold')),
    Parameter('torque_limit', 'double', nan, 'N m or N', 'with torque: a larger torque from the '
              'topic counts as this one; default: no limit', positive=True),
    Parameter('joint', 'string', '', '', 'with joint_state: name of the driven joint', live=False),
    Parameter('joint_ratio', 'double', 1.0, '', 'with joint_state: ratio in joint = ratio * input '
              '+ offset; negative if they turn in opposite directions', live=False),
    Parameter('joint_offset', 'double', 0.0, 'rad or m',
              'with joint_state: offset in joint = ratio * input + offset', live=False),
    Parameter('window', 'integer', 5, '', 'estimate of missing rates: number of latest samples '
              'that are fitted', low=3, high=50),
    Parameter('jump', 'double', 1.0, 'rad or m',
              'estimate of missing rates: a step between two samples that is larger, or differs '
              'by more from the one expected, restarts it', positive=True),
    Parameter('top_speed', 'double', nan, 'rad/s',
              'where positions wrap after a turn: largest speed of the input; a step so long that '
              'it could be a quarter turn at this speed restarts the estimate of missing rates; '
              'default: positions count their turns', positive=True),
    Parameter('carried_inertia', 'double', 0.0, 'kg m^2 or kg',
              'inertia that a simulator has in its own rotor for the linkage: torque_of_rest of '
              'the output equation is the driving torque without it', low=0.0),
    Parameter('timeout', 'double', 1.0, 's', 'with messages: after this time without input the '
              'status is STATUS_INPUT_TIMEOUT; 0: never', low=0.0),
    Parameter('out_of_range', 'string', 'none', '', 'published where the linkage cannot be '
              'assembled: NaN (none), the last good values (hold) or the pose at the nearest '
              'limit (clamp)', choices=('none', 'hold', 'clamp')),
))

_JOINT_STATES = _group('joint_states', (
    Parameter('prefix', 'string', '', '', 'prefix of every name in joint_names', live=False),
    Parameter('ratios', 'doubles', [], '', 'ratio of each joint: published position = ratio * '
              '(angle or slide) + offset; negative: opposite direction; empty: 1', live=False),
    Parameter('offsets', 'doubles', [], 'rad or m', 'offset of each joint: published position = '
              'ratio * (angle or slide) + offset; empty: 0', live=False),
    Parameter('when_unknown', 'string', 'skip', '',
              'published while a position is unknown: nothing (skip: robot_state_publisher keeps '
              'the last pose), the last known positions with NaN rates (hold), or NaN (send_nan)',
              choices=('skip', 'hold', 'send_nan')),
    Parameter('only_passive', 'bool', False, '', 'leave the driven joint out of joint_states: for '
              'a node that publishes on the topic it listens to, as a relay does', live=False),
    Parameter('leave_out', 'strings', [], '', 'names of joints that are left out of joint_states, '
              'as in joint_names, without the prefix: such as a cut joint that the URDF of the '
              'robot does not have. ratios and offsets count them', live=False),
))

_FRAME = _group('frame', (
    Parameter('parent', 'string', '', '',
              'frame of the robot in which frame_id lies fixed, as that of a link; empty: none. '
              'Its pose is published on /tf_static and written by fourbar describe', live=False),
    Parameter('xyz', 'doubles', [], 'm',
              'with frame.parent: O1 in that frame: x, y, z; empty: its origin'),
    Parameter('rpy', 'doubles', [], 'rad', 'with frame.parent: axes of the linkage in that frame: '
              'roll, pitch, yaw about fixed axes, as in URDF; [1.5708, 0.0, 0.0]: the plane is '
              'its x-z plane; empty: the same axes. gravity stays along the axes of the linkage'),
))

_RECORDING = _group('recording', (
    Parameter('start', 'bool', False, '', 'start recording with the first sample', live=False),
    Parameter('directory', 'string', 'bags', '', 'directory for the bags', live=False),
    Parameter('name', 'string', '', '',
              'name of the first bag; empty: a new name from the clock', live=False),
    Parameter('split_size', 'double', 0.0, 'MB', 'continue a bag in a new file when the current '
              'one exceeds this size; 0: never', low=0.0, live=False, least_but_zero=0.01),
    Parameter('split_duration', 'double', 0.0, 's',
              'continue a bag in a new file when the current one exceeds this duration; 0: never',
              low=0.0, live=False, least_but_zero=0.1),
))

_OF_TOPICS = _group('external', (
    Parameter('timeout', 'double', 1.0, 's', 'with from_topic: a link without a wrench for longer '
              'than this counts as silent; 0: never', low=0.0),
    Parameter('when_silent', 'string', 'unknown', '', 'external wrench of a silent link, and '
              'before its first message: unknown (all loads are NaN), constant (force_x, force_y, '
              'couple) or hold (the last wrench; before the first, constant)',
              choices=('unknown', 'constant', 'hold')),
    Parameter('extrapolated', 'bool', False, '',
              'with from_topic: take from the last two wrenches the one that is due a step later, '
              'for chains of nodes, whose reactions come one step late'),
))

_BASE = _group('base', (
    Parameter('topic', 'string', '', '', 'motion of the body that carries the linkage: from '
              f'{topics.BASES["imu"].topic} (imu), from {topics.BASES["motion_of_base"].topic} '
              '(motion_of_base), or none, with gravity at rest', choices=('', *topics.BASES),
              live=False),
    Parameter('rotation', 'doubles', [], 'rad',
              'with imu: frame of the linkage in that of the messages: roll, pitch, yaw, as in '
              'URDF, or a quaternion x, y, z, w; empty: the same axes'),
    Parameter('frame_id', 'string', '', '',
              'frame_id of the messages, which others are not taken; empty: that of the linkage'),
    Parameter('window', 'integer', 2, '', 'with imu: number of latest rates whose slope is the '
              'angular acceleration', low=2, high=50, live=False),
    Parameter('timeout', 'double', 0.2, 's', 'after this time without a message the motion of the '
              'base counts as unknown; 0: never', low=0.0),
    Parameter('when_silent', 'string', 'unknown', '',
              'motion of the base in a silence: unknown (all loads are NaN) or the last one '
              '(hold; before the first message, unknown)', choices=('unknown', 'hold')),
    Parameter('carried.mass', 'double', 0.0, 'kg', 'mass that a simulator has in its own body for '
              'the linkage: shaking force and moment are those of the rest', low=0.0),
    Parameter('carried.x', 'double', 0.0, 'm', 'centre of that mass from O1: x'),
    Parameter('carried.y', 'double', 0.0, 'm', 'centre of that mass from O1: y'),
    Parameter('carried.inertia', 'double', 0.0, 'kg m^2',
              'moment of inertia of that mass about its centre', low=0.0),
    Parameter('carried.mean', 'bool', False, '',
              'instead of these numbers the mean over the input, which fourbar show prints'),
))


def _point(name: str, text: str, link: Any, link_text: str, live: bool = True
           ) -> tuple[Parameter, ...]:
    """Return the parameters of a point; ``link``: default of the parameter of its link."""
    return (
        Parameter(f'{name}.link', 'string', link, '', link_text, live=live),
        Parameter(f'{name}.along', 'double', 0.0, 'm', f'{text}: distance from the first joint of '
                  'its link along the link; of the ground x from O1'),
        Parameter(f'{name}.across', 'double', 0.0, 'm', f'{text}: distance to the left of the '
                  'line of its link; of the ground y from O1'),
    )


# --- the table -----------------------------------------------------------------------------------

PARAMETERS = _table(
    Parameter('linkage.kind', 'string', 'four_bar', '', f'kind of linkage: {_KINDS_IN_WORDS}; a '
              f'driven link and dyads ({MACHINE})', choices=(*KINDS, MACHINE), live=False),
    Parameter('linkage.input', 'string', 'crank', '', 'driven joint: the crank, or the slide of a '
              f'{_WITH_SLIDES} or {MACHINE}; of a {MACHINE} also a cylinder that turns the crank, '
              'of a four_bar also A or B: a drive between two moving links, given theta2 or '
              'theta3', choices=(*_DRIVEN, 'cylinder'), live=False),
    *map(_length, LENGTHS),
    Parameter('linkage.range', 'doubles', [], 'rad or m',
              'where the driven joint may be: [lowest, highest], of angles in any turn; empty: '
              'wherever the linkage can be assembled', live=False),
    Parameter('linkage.mode', 'integer', 2, '', 'assembly mode: 1 or crossed, 2 or open; for the '
              'sliders see docs/conventions.md', 1, 2, words=MODES),
    Parameter('linkage.dyads', 'strings', [], '', f'names of the dyads of a {MACHINE}, each after '
              'those on whose links it hangs', live=False),
    Parameter('linkage.output', 'string', '', '',
              f'link of a {MACHINE} whose motion is the output; empty: the last link', live=False),
    Parameter('linkage.carrier', 'string', GROUND, '',
              f'link of a {MACHINE} to which the driven crank is pinned, at its origin: the '
              'ground, or for a drive between two moving links one that takes the place of the '
              'ground in dyads; see docs/machines.md', live=False),
    Parameter('linkage.pivot', 'string', '', '',
              f'of a {MACHINE}: name in pictures of the joint of its driven link with the ground; '
              'empty: O1', live=False),
    Parameter('linkage.joints', 'strings', [], '', 'of the other kinds: names in pictures of O1, '
              'A, B, O4, of those that it has, in this order; empty: these', live=False),
    *_point('cylinder.base', 'with linkage.input cylinder: pivot of its tube', GROUND,
            'with linkage.input cylinder: link on which its tube is pinned, the ground or one '
            'to which the crank is pinned at O1; see docs/machines.md', live=False),
    *_point('cylinder.pin', 'with linkage.input cylinder: pin of its rod', 'crank',
            'with linkage.input cylinder: link on which its rod is pinned, the crank', live=False),
    Parameter('cylinder.links', 'strings', ['rod', 'tube'], '',
              'with linkage.input cylinder: names of rod and tube', live=False),
    Parameter('cylinder.mode', 'integer', 2, '', 'with linkage.input cylinder: 2, from O1-pivot '
              'to O1-pin one turns left; 1, right', 1, 2),
    Parameter('gravity.x', 'double', 0.0, 'm/s^2', 'gravitational acceleration: x component'),
    Parameter('gravity.y', 'double', 0.0, 'm/s^2', 'gravitational acceleration: y component'),
    Parameter('bodies.rods.density', 'double', nan, 'kg/m^3',
              'model every link with two revolute joints and without a mass of its own as a solid '
              'cylinder, or a bar of rectangular section, of this density', positive=True),
    Parameter('bodies.rods.radius', 'double', nan, 'm',
              'radius of these cylinders (with bodies.rods.density)', positive=True),
    Parameter('bodies.rods.width', 'double', nan, 'm',
              'for bars of rectangular section instead: width, in the plane of the linkage (with '
              'bodies.rods.density and .thickness)', positive=True),
    Parameter('bodies.rods.thickness', 'double', nan, 'm',
              'thickness of these bars, square to the plane', positive=True),
    *_OF_TOPICS, *_BASE, *_DRIVE,
    Parameter('motor.kind', 'string', 'line', '', 'with motor: torque that falls linearly with '
              'speed (line), DC motor (dc), speed controller with a limited torque (controller), '
              "or induction motor by Kloss' formula (induction)", choices=tuple(MOTORS)),
    GEAR,
    Parameter('motor.rotor_inertia', 'double', 0.0, 'kg m^2 or kg',
              'inertia of the rotor itself; behind the gear it counts gear^2 times', low=0.0),
    *(parameter for kind in MOTORS for parameter in of_motor(kind).values()
      if parameter.name != GEAR.name),
    Parameter('shaft.stiffness', 'double', nan, 'N m/rad or N/m', 'elastic shaft between the '
              'drive and the input; default: a rigid one', positive=True),
    Parameter('shaft.damping', 'double', 0.0, 'N m s/rad or N s/m', 'damping of the elastic shaft',
              low=0.0),
    Parameter('flywheel.inertia', 'double', 0.0, 'kg m^2 or kg',
              'inertia on the input itself, on its side of an elastic shaft', low=0.0),
    Parameter('outputs', 'strings', ['state', 'output', 'joint_states'], '',
              'outputs to publish; those not listed are neither created nor computed',
              choices=(*topics.OUTPUTS, *topics.PICTURES)),
    Parameter('pictures.rate', 'double', 30.0, 'Hz',
              'output markers: messages per second at most; 0: one for every input', low=0.0),
    Parameter('services', 'strings', list(topics.SERVICES), '', 'services to offer',
              choices=tuple(topics.SERVICES), live=False),
    Parameter('frame_id', 'string', 'fourbar', '',
              'frame_id of all outputs; origin O1, x towards O4 or along the guide', live=False),
    Parameter('joint_names', 'strings', [], '', 'names of the joints in joint_states, in this '
              f'order; empty: {_JOINTS_IN_WORDS}', live=False),
    *_FRAME, *_JOINT_STATES,
    Parameter('trajectories', 'bool', False, '', 'translate trajectories of the output joint into '
              'those of the driven joint, and back; drive.start chooses the branch', live=False),
    Parameter('trajectory_fields', 'strings', ['velocities', 'accelerations'], '',
              'with trajectories: what answers hold beside positions. accelerations are answered '
              'where they are given; joint_trajectory_controller takes effort only if it commands '
              'effort', choices=('velocities', 'accelerations', 'effort')),
    *_RECORDING,
)


# --- families ------------------------------------------------------------------------------------

def _having(dimension: str) -> str:
    return ', '.join(kind for kind, names in DIMENSIONS.items() if dimension in names)


_POINT = _table(*_point('points.NAME', 'point NAME', 'coupler',
                        'link to which the point NAME is fixed'))
# of a machine; every number is NaN where it is not given
_NAMED_POINT = _table(
    *(Parameter(f'linkage.points.NAME.{axis}', 'double', nan, 'm', f'{axis} of the point NAME of '
                'the ground, from O1; with one of x and y the other is 0') for axis in 'xy'),
    Parameter('linkage.points.NAME.link', 'string', '', '',
              'in place of x and y: moving link that has the point NAME', live=False),
    Parameter('linkage.points.NAME.along', 'double', nan, 'm',
              'point NAME: distance from the first joint of its link along the link; default: 0'),
    Parameter('linkage.points.NAME.across', 'double', nan, 'm',
              'point NAME: distance to the left of the line of its link; default: 0'),
    Parameter('linkage.points.NAME.distance_1', 'double', nan, 'm',
              'in place of along and across: distance of the point NAME from the first joint of '
              'its link, a rod', low=0.0),
    Parameter('linkage.points.NAME.distance_2', 'double', nan, 'm',
              'distance of the point NAME from the inner pin of its link; without distance_1 it '
              'lies on the line of the link, with 0 it is the pin', low=0.0),
    Parameter('linkage.points.NAME.side', 'string', '', '',
              'with both distances: on which side of the line from the first joint to the inner '
              'pin the point NAME lies', choices=('', 'left', 'right')),
)
_DYAD = _table(
    *(Parameter(f'dyads.NAME.{end}', 'string', '', '',
                f'name of the point (linkage.points.*) on which dyad NAME hangs with its {end} '
                f'link, in place of {end}.link, {end}.along and {end}.across', live=False)
      for end in ('first', 'second')),
    Parameter('dyads.NAME.inner', 'string', '', '',
              'name in pictures of the inner joint of dyad NAME; empty: a letter', live=False),
    Parameter('dyads.NAME.kind', 'string', REQUIRED, '',
              'kind of dyad NAME by its joints, R a pin, P a slide: outer, inner, outer; '
              'see docs/machines.md', choices=tuple(DIMENSIONS), live=False),
    *(parameter for end in ('first', 'second') for parameter in _point(
        f'dyads.NAME.{end}', f'point on which dyad NAME hangs with its {end} link', REQUIRED,
        f'link on which dyad NAME hangs with its {end} link: ground, the driven link (crank or '
        'slider), or a link of a dyad before it', live=False)),
    Parameter('dyads.NAME.links', 'strings', REQUIRED, '',
              'names of the two links of dyad NAME, the one at `first` first', live=False),
    Parameter('dyads.NAME.length_1', 'double', nan, 'm',
              f'length of the first link ({_having("length_1")})', positive=True),
    Parameter('dyads.NAME.length_2', 'double', nan, 'm',
              f'length of the second link ({_having("length_2")})', positive=True),
    Parameter('dyads.NAME.offset', 'double', nan, 'm', "distance of the path of the block's pin "
              f'from the pivot of the bar, to its left ({_having("offset")}); default: 0'),
    Parameter('dyads.NAME.direction_1', 'double', nan, 'rad',
              'direction of the line along which the first link slides, from that of the link at '
              f'`first` ({_having("direction_1")})'),
    Parameter('dyads.NAME.direction_2', 'double', nan, 'rad',
              'direction of the line along which the second link slides, from that of the link at '
              f'`second` ({_having("direction_2")})'),
    Parameter('dyads.NAME.slot', 'double', nan, 'rad', 'direction of the slot of the yoke, from '
              f'that in which the yoke slides ({_having("slot")})'),
    Parameter('dyads.NAME.mode', 'integer', 2, '',
              'assembly mode of dyad NAME, see docs/machines.md', 1, 2),
)
# of each link of the mechanism
_BODY = _table(
    Parameter('bodies.NAME.mass', 'double', nan, 'kg', 'mass of the NAME', low=0.0),
    Parameter('bodies.NAME.inertia', 'double', nan, 'kg m^2', 'moment of inertia of the NAME '
              'about its centre of gravity; required with a mass', low=0.0),
    Parameter('bodies.NAME.cg_along', 'double', nan, 'm',
              'centre of gravity of the NAME: distance from its first joint along the link; '
              'default: half its length (0 for a link without a length)'),
    Parameter('bodies.NAME.cg_across', 'double', 0.0, 'm',
              'centre of gravity of the NAME: distance to the left of the line of the link'),
)
_EXTERNAL = _table(
    *(Parameter(f'external.NAME.force_{axis}', 'double', 0.0, 'N',
                f'external force on the NAME: {axis} component, constant') for axis in 'xy'),
    Parameter('external.NAME.along', 'double', 0.0, 'm', 'point where the external force acts on '
              'the NAME: distance from its first joint along the link'),
    Parameter('external.NAME.across', 'double', 0.0, 'm', 'point where the external force acts on '
              'the NAME: distance to the left of the line of the link'),
    Parameter('external.NAME.couple', 'double', 0.0, 'N m',
              'external couple on the NAME, constant, counter-clockwise positive'),
    Parameter('external.NAME.from_topic', 'bool', False, '', 'take the external force and couple '
              f'on the NAME from the topic {topics.wrench_topic(NAME).topic} instead of force_x, '
              'force_y and couple', live=False),
)
# A damper is a spring without stiffness.
_SPRING = _table(
    *(parameter for end in ('first', 'second') for parameter in _point(
        f'springs.NAME.{end}', f'{end} end of the spring NAME', GROUND,
        f'link to which the {end} end of the spring NAME is fixed')),
    Parameter('springs.NAME.stiffness', 'double', 0.0, 'N/m', 'stiffness of the spring NAME',
              low=0.0),
    Parameter('springs.NAME.free_length', 'double', 0.0, 'm',
              'length of the spring NAME without force', low=0.0),
    Parameter('springs.NAME.damping', 'double', 0.0, 'N s/m',
              'damping along the line between the two ends of the spring NAME', low=0.0),
    Parameter('springs.NAME.preload', 'double', 0.0, 'N',
              'tension of the spring NAME at its free length: initial tension'),
)
_TORSION = _table(
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
)
# NAME is a joint, or drive.
_FRICTION = _table(
    Parameter('friction.NAME.coefficient', 'double', 0.0, '',
              'coefficient of dry friction of the joint NAME', low=0.0),
    Parameter('friction.NAME.radius', 'double', 0.0, 'm', 'radius of the pin NAME: its dry '
              'friction is the couple coefficient radius |force|', low=0.0),
    Parameter('friction.NAME.length', 'double', nan, 'm',
              'length of the block of the guide NAME, whose two ends bear force and couple; '
              'default: the couple is borne without friction', positive=True),
    Parameter('friction.NAME.viscous', 'double', 0.0, '',
              'viscous friction of the pin NAME, or of a drive that turns [N m s/rad], of the '
              'guide NAME, or of a drive that slides [N s/m]', low=0.0),
    Parameter('friction.NAME.torque', 'double', 0.0, 'N m or N',
              'of friction.drive: constant friction of the drive itself', low=0.0),
    Parameter('friction.NAME.slip_speed', 'double', 0.0, 'rad/s or m/s',
              'of friction.drive: speed of the input below which dry friction and forces one way '
              'fall off smoothly; with torque or motor 0 stands for 1e-4, else for none', low=0.0),
)
# A table of forces stands in a file, or in places and values.
_FORCE = _table(
    *_point('forces.NAME', 'point where the force NAME acts', REQUIRED,
            'link on which the force NAME acts, also in a motion that is given'),
    Parameter('forces.NAME.acts', 'string', REQUIRED, '',
              'x or y of the ground; along the link, of a slider its guide, or across it, to its '
              'left; a couple, counter-clockwise; apart: away from forces.NAME.from',
              choices=('x', 'y', 'along', 'across', COUPLE, APART)),
    *_point('forces.NAME.from', 'point from which the force NAME pushes (acts: apart)', GROUND,
            'link of the point from which the force NAME pushes (acts: apart)'),
    Parameter('forces.NAME.direction', 'double', 0.0, 'rad',
              'angle by which the force NAME is turned from that direction'),
    Parameter('forces.NAME.over', 'string', 'input', '',
              'what the table of the force NAME is over: input (of a crank counted over whole '
              'turns), an angle or slide of the linkage as theta4 or slide, POINT.x, POINT.y '
              'of a point of the scene, or distance: of its point from that of forces.NAME.from'),
    Parameter('forces.NAME.when', 'string', 'both', '', 'the force NAME acts always (both), or '
              'only while what its table is over grows (forward) or falls (backward), as a cut '
              'does', choices=('both', 'forward', 'backward')),
    Parameter('forces.NAME.table', 'string', '', '',
              'CSV file, from the folder of the scene: a header with units, as "theta1 [deg], '
              'pressure [bar]", then a place and a value in each row (between ; decimals may have '
              'a comma); or give places and values', live=False),
    Parameter('forces.NAME.places', 'doubles', [], 'rad or m',
              'places of the table of the force NAME in order, as [0mm, 40mm]; at one that stands '
              'twice the force jumps from its first value to its second'),
    Parameter('forces.NAME.place_unit', 'string', '', '',
              'unit of places without one; default: rad or m', choices=('', *POSITION_UNITS)),
    Parameter('forces.NAME.values', 'doubles', [], 'N or N m or Pa',
              'forces, couples or pressures at these places; beyond the ends those at the ends'),
    Parameter('forces.NAME.value_unit', 'string', '', '', 'unit of values without one; default: '
              'N, of a couple N m', choices=('', *FORCE_UNITS)),
    Parameter('forces.NAME.periodic', 'bool', False, '',
              'the table of the force NAME repeats: its last place is the first one again, after '
              'a turn, a whole part of it, or, of a crank that is driven, some turns'),
    Parameter('forces.NAME.interpolation', 'string', 'smooth', '',
              'between places: cubic polynomials without overshoot (smooth) or lines (linear)',
              choices=('smooth', 'linear')),
    Parameter('forces.NAME.factor', 'double', 1.0, '', 'the force NAME is this times the value of '
              'its table; of pressures the area [m^2], negative against the direction'),
)
FAMILIES = {'points': _POINT, 'springs': _SPRING, 'torsion_springs': _TORSION, 'forces': _FORCE,
            'friction': _FRICTION, 'dyads': _DYAD, 'linkage.points': _NAMED_POINT,
            'bodies': _BODY, 'external': _EXTERNAL}
OF_LINKS = 'bodies', 'external'      # families of which every link of the mechanism is a member
