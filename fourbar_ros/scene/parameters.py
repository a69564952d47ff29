# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The single table of scene parameters: type, unit, default, allowed values, text. Imports no ROS.

It feeds the declaration in the node, the check of scene files, the manual and the tests.
"""
from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import Any

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.scene import families, of_dynamics, of_kinds
from fourbar_ros.scene.families import body, external, NAMED, names_in, OF_MACHINES
from fourbar_ros.scene.parameter import Parameter, REQUIRED
from fourbar_ros.scene.topics import INPUTS, OUTPUTS, PICTURES

MACHINE = 'machine'


def _length(name: str, length: of_kinds.KnownLength) -> Parameter:
    name = f'linkage.{name}'
    if length.signed:
        return Parameter(name, 'double', 0.0, 'm', length.text)
    of = ' (all kinds but machine)' if length.is_in_all else ''
    return Parameter(name, 'double', nan, 'm', f'{length.text}{of}', positive=True)


PARAMETERS = {parameter.name: parameter for parameter in (
    Parameter('linkage.kind', 'string', 'four_bar', '',
              f'kind of linkage: {of_kinds.KINDS_IN_WORDS}; a driven link and dyads ({MACHINE})',
              choices=(*KINDS, MACHINE), live=False),
    Parameter('linkage.input', 'string', 'crank', '',
              f'driven joint: the crank, or the slide of a {of_kinds.MORE_INPUTS_IN_WORDS} or '
              f'{MACHINE}; of a {MACHINE} also a cylinder that turns the crank',
              choices=(*of_kinds.INPUTS, 'cylinder'), live=False),
    *(_length(*item) for item in of_kinds.LENGTHS.items()),
    Parameter('linkage.range', 'doubles', [], 'm',
              'stroke of a driven slide: [shortest, longest]; empty: every position where the '
              'linkage can be assembled', live=False),
    Parameter('linkage.mode', 'integer', 2, '',
              'assembly mode: 1 crossed, 2 open; for the sliders see docs/conventions.md', 1, 2),
    Parameter('linkage.dyads', 'strings', [], '',
              f'names of the dyads of a {MACHINE}, each after those on whose links it hangs',
              live=False),
    Parameter('linkage.output', 'string', '', '',
              f'link of a {MACHINE} whose motion is the output; empty: the last link', live=False),
    Parameter('cylinder.base.along', 'double', 0.0, 'm',
              'with linkage.input cylinder: x of the pivot of its tube on the ground'),
    Parameter('cylinder.base.across', 'double', 0.0, 'm',
              'with linkage.input cylinder: y of that pivot'),
    Parameter('cylinder.pin.along', 'double', 0.0, 'm',
              'with linkage.input cylinder: pin of its rod on the crank, distance from O1 along '
              'the crank'),
    Parameter('cylinder.pin.across', 'double', 0.0, 'm',
              'with linkage.input cylinder: pin of its rod, distance to the left of the crank'),
    Parameter('cylinder.links', 'strings', ['rod', 'tube'], '',
              'with linkage.input cylinder: names of rod and tube', live=False),
    Parameter('cylinder.mode', 'integer', 2, '',
              'with linkage.input cylinder: 2, from O1-pivot to O1-pin one turns left; 1, right',
              1, 2),
    Parameter('gravity.x', 'double', 0.0, 'm/s^2', 'gravitational acceleration: x component'),
    Parameter('gravity.y', 'double', 0.0, 'm/s^2', 'gravitational acceleration: y component'),
    Parameter('bodies.rods.density', 'double', nan, 'kg/m^3',
              'model every link with two revolute joints as a solid cylinder of this density',
              positive=True),
    Parameter('bodies.rods.radius', 'double', nan, 'm',
              'radius of these cylinders (with bodies.rods.density)', positive=True),
    *(parameter for item in of_kinds.LINKS.items() for parameter in body(*item)),
    *(parameter for item in of_kinds.LOADED_LINKS.items() for parameter in external(*item)),
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
    Parameter('joint_names', 'strings', [], '',
              'names of the joints in joint_states, in this order; empty: '
              f'{of_kinds.JOINTS_IN_WORDS}',
              live=False),
    Parameter('joint_states.prefix', 'string', '', '', 'prefix of every name in joint_names',
              live=False),
    Parameter('joint_states.ratios', 'doubles', [], '',
              'ratio of each joint: published position = ratio * (angle or slide) + offset; '
              'negative: opposite direction; empty: 1', live=False),
    Parameter('joint_states.offsets', 'doubles', [], 'rad or m',
              'offset of each joint: published position = ratio * (angle or slide) + offset; '
              'empty: 0',
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


def find(name: str) -> Parameter | None:
    """Return the Parameter of this name, one of the table or of a member of a family, or None."""
    return PARAMETERS.get(name) or families.find(name)


def of_name(name: str) -> Parameter:
    """Return the Parameter of a name that a checked scene has."""
    found = find(name)
    assert found is not None, name
    return found


def _is_known(name: str, is_machine: bool) -> bool:
    """Return whether a scene may have this parameter; links of their own only machines have."""
    member = families.member_of(name)
    return name in PARAMETERS or (member is not None and families.find(name) is not None
                                  and (is_machine or member.family not in OF_MACHINES))


def _why_unknown(name: str, is_machine: bool) -> str:
    parts = name.split('.')
    if parts[0] in NAMED and len(parts) > 2 and not families.member_of(name):
        of_what = {'bodies': 'link', 'external': 'link'}.get(parts[0], parts[0][:-1])
        return (f'{parts[1]!r} is not a valid {of_what.replace("_", " ")} name: use letters, '
                'digits and _, starting with a letter')
    if parts[0] == 'dyads' and not is_machine:
        return f'linkage.kind {MACHINE} alone has dyads'
    member = families.member_of(name)
    known = [*PARAMETERS, *NAMED['points']]
    if member and (is_machine or member.family not in OF_MACHINES):
        known = [p.name for p in families.parameters_of(member.family, member.name)]
    return f'unknown parameter{nearest(name, known, 0.75)}'


def _members(values: Mapping[str, Any], is_machine: bool) -> list[tuple[str, str]]:
    """Return (family, name) of all members of a scene; every link of a machine has a body."""
    found = [(group, name) for group in NAMED if group not in OF_MACHINES
             for name in names_in(group, values)]
    if is_machine:
        dyads = dict.fromkeys([*as_names(values.get('linkage.dyads')),
                               *names_in('dyads', values)])
        found += [('dyads', name) for name in dyads]
        links = [link for name in dyads for link in as_names(values.get(f'dyads.{name}.links'))]
        links += _driven_links(values)
        for family in ('bodies', 'external'):
            names = dict.fromkeys([*links, *names_in(family, values)])
            found += [(family, name) for name in names if name != 'rods']
    return found


def _driven_links(values: Mapping[str, Any]) -> list[str]:
    """Return the links of a machine that need not be named, those of its cylinder included."""
    driver = values.get('linkage.input')
    rods = as_names(values.get('cylinder.links', PARAMETERS['cylinder.links'].default))
    return {'slide': ['slider'], 'cylinder': ['crank', *rods]}.get(str(driver), [])


def as_names(value: Any) -> list[str]:
    """Return the texts in a value, whatever it is."""
    return ([item for item in value if families.is_name(item)]
            if isinstance(value, (list, tuple)) else [])


def check(values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return all parameters with defaults filled in, each in its own type.

    Raises
    ------
    InvalidParameter
        For the first unknown, missing or bad one.

    """
    is_machine = values.get('linkage.kind') == MACHINE
    for name in values:
        if not _is_known(name, is_machine):
            raise InvalidParameter(name, values[name], _why_unknown(name, is_machine))
    of_members = [parameter for family, name in _members(values, is_machine)
                  for parameter in families.parameters_of(family, name)]
    every = {parameter.name: parameter for parameter in of_members} | PARAMETERS
    for parameter in every.values():
        if parameter.default is REQUIRED and parameter.name not in values:
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
    return {name: every[name].check(values.get(name, every[name].default))
            for name in (*PARAMETERS, *(name for name in every if name not in PARAMETERS))}
