# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which number goes into which message field, for the node and for recomputing a bag.

A value is named by its field in the mechanism's motion or loads, NAME.FIELD of the motion of a
point, link NAME.FIELD of that of a link.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from math import nan
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import (
    BETA,
    Coordinate,
    Output,
    Reaction,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
    TRAVEL,
)
from fourbar_ros.mechanisms.points import LinkFields, PointMotion
from fourbar_ros.numerics.arrays import Array

# Fields of the messages LinkageState and LinkageLoads, which are made for four joints: what a
# mechanism does not have is NaN there, what it has more goes out as links/NAME, reactions/NAME.
STATE_FIELDS = (*THETA1, *THETA2, *THETA3, *THETA4, *BETA, 'transmission_angle', 'velocity_ratio',
                'condition', *TRAVEL)
LOADS_FIELDS = ('f41_x', 'f41_y', 'f21_x', 'f21_y', 'f32_x', 'f32_y', 'f43_x', 'f43_y', 'f41',
                'f21', 'f32', 'f43',
                'driving_torque', 'shaking_force_x', 'shaking_force_y', 'shaking_force',
                'shaking_moment',
                'guide_force', 'guide_couple', 'driving_force')
OF_JOINTS = ('position', 'velocity', 'effort')          # of a JointState
DRIVE_WRENCH = ('drive wrench force_x', 'drive wrench force_y', 'drive wrench torque')
PASSIVE_EFFORT = 0.0                                   # frictionless joints
Source = str | tuple[str | None, ...]      # of a field: see FieldMap


def joint_values(count: int) -> tuple[str, ...]:
    """Return the names of what joint_states shows of so many joints by scales of their own."""
    return tuple(f'joint {i + 1} {what}' for what in OF_JOINTS for i in range(count))


class FieldMap(NamedTuple):
    """
    Where the numbers of a mechanism and its points go.

    ``fields``: {output: {field of the message: name of the value, or a tuple of names}}, a None
    standing for the effort of a passive joint; ``absent``: {output: fields that are always NaN};
    ``place``: where a value stands in the tuple (*motion, *loads, *motion of the first point, ...,
    *motion of the first link, ..., *drive wrench, *joints); ``joints``: a coordinate and the name
    of its drive, None if it has none, for each joint.
    """

    fields: Mapping[str, Mapping[str, Source]]
    absent: dict[str, tuple[str, ...]]
    place: dict[str, int]
    joints: tuple[tuple[Coordinate, str | None], ...]

    def expected(self, output: str, values: Sequence[float] | Array) -> dict[str, Any]:
        """
        Return {field: number or tuple of numbers} of one output message.

        If ``values`` are arrays, those of many messages.
        """
        def pick(source: Source | None) -> Any:
            if isinstance(source, tuple):
                return tuple(map(pick, source))
            return PASSIVE_EFFORT if source is None else values[self.place[source]]

        return {**{field: pick(source) for field, source in self.fields[output].items()},
                **dict.fromkeys(self.absent.get(output, ()), nan)}

    def showing(self, places: Iterable[int]) -> FieldMap:
        """Return the same with only these joints, by their places, in joint_states."""
        shown: dict[str, Source] = {}
        for what, names in self.fields['joint_states'].items():
            assert isinstance(names, tuple)
            shown[what] = tuple(names[place] for place in places)
        return self._replace(fields={**self.fields, 'joint_states': shown})

    def in_use(self, output: str) -> set[int]:
        """Return the places of all values that an output has."""
        return {self.place[name] for source in self.fields[output].values()
                for name in (source if isinstance(source, tuple) else (source,))
                if name is not None}


class Names(NamedTuple):
    """
    The names of a mechanism's numbers.

    Fields of motion and loads, input, output with its ratio, joints, reactions, and the links
    whose motion is wanted.
    """

    motion: tuple[str, ...]
    loads: tuple[str, ...]
    driven: Coordinate
    output: Output
    joints: tuple[Coordinate, ...]
    reactions: tuple[Reaction, ...]
    links: tuple[str, ...]

    @classmethod
    def of(cls, mechanism: Mechanism, with_links: bool = False) -> Names:
        """Return the names of a mechanism, with those of its links or without."""
        return cls(mechanism.MOTION._fields, mechanism.LOADS._fields, mechanism.input_coordinate,
                   mechanism.outputs[0], tuple(joint.coordinate for joint in mechanism.JOINTS),
                   tuple(mechanism.REACTIONS),
                   tuple(link.name for link in mechanism.LINKS) if with_links else ())


@cache
def layout(given: Names, points: tuple[str, ...] = (), with_effort: bool = True,
           own_joints: bool = False, with_drive: bool = False) -> FieldMap:
    """
    Return the :class:`FieldMap` of a mechanism by its :class:`Names`, with named points.

    ``with_effort``: joint_states have it; ``own_joints``: what they show are values of
    :mod:`fourbar_ros.pipeline.joints`, not those of the motion; ``with_drive``: with the drive
    wrench.
    """
    names = given.motion + given.loads
    output, ratio = given.output
    motion = ('position', 'velocity', 'acceleration')
    fields: dict[str, Mapping[str, Source]] = {
        'driven': dict(zip(motion, given.driven)),
        'output': dict(zip(motion, output)),
        'state': {'velocity_ratio': ratio, **_input_as_state(given.driven, names),
                  **{name: name for name in STATE_FIELDS if name in names}},
        'loads': {name: name for name in LOADS_FIELDS if name in names},
        'shaking_wrench': {'wrench.force.x': 'shaking_force_x',
                           'wrench.force.y': 'shaking_force_y',
                           'wrench.torque.z': 'shaking_moment'},
        'joint_states': _joint_states(given, with_effort, own_joints),
        **{f'points/{point}': {name: f'{point}.{name}' for name in PointMotion._fields}
           for point in points},
        **{f'links/{link}': {name: f'link {link}.{name}' for name in LinkFields._fields}
           for link in given.links},
        **{f'reactions/{reaction.joint}': _reaction(reaction) for reaction in given.reactions},
    }
    absent = {'state': tuple(name for name in STATE_FIELDS if name not in fields['state']),
              'loads': tuple(name for name in LOADS_FIELDS if name not in names)}
    names += tuple(f'{point}.{name}' for point in points for name in PointMotion._fields)
    names += tuple(f'link {link}.{name}' for link in given.links for name in LinkFields._fields)
    if with_drive:
        fields['drive_wrench'] = dict(zip(('wrench.force.x', 'wrench.force.y', 'wrench.torque.z'),
                                          DRIVE_WRENCH))
    names += ((DRIVE_WRENCH if with_drive else ())
              + (joint_values(len(given.joints)) if own_joints else ()))
    return FieldMap(fields, absent, {name: i for i, name in enumerate(names)},
                    tuple((joint, _effort(joint, given.driven)) for joint in given.joints))


def _reaction(reaction: Reaction) -> dict[str, str]:
    """Return {field of a WrenchStamped: name of the value}."""
    force = {'wrench.force.x': reaction.x, 'wrench.force.y': reaction.y}
    return force | ({'wrench.torque.z': reaction.couple} if reaction.couple else {})


def _input_as_state(driven: Coordinate, names: tuple[str, ...]) -> dict[str, str]:
    """Return the fields of a LinkageState for an input that is called otherwise, of a machine."""
    fields = THETA1 if driven.unit == 'rad' else TRAVEL
    return {} if fields.position in names else dict(zip(fields, driven))


def _effort(joint: Coordinate, driven: Coordinate) -> str | None:
    """Return the name of the effort of a joint; None: passive."""
    if joint != driven:
        return None
    return 'driving_torque' if driven.unit == 'rad' else 'driving_force'


def _joint_states(given: Names, with_effort: bool, own: bool) -> dict[str, Source]:
    fields: dict[str, Source]
    coordinates = given.joints
    if own:
        count, names = len(coordinates), joint_values(len(coordinates))
        fields = {what: names[count * i:count * (i + 1)] for i, what in enumerate(OF_JOINTS)}
    else:
        fields = {'position': tuple(joint.position for joint in coordinates),
                  'velocity': tuple(joint.rate for joint in coordinates),
                  'effort': tuple(_effort(joint, given.driven) for joint in coordinates)}
    if not with_effort:
        del fields['effort']                             # empty in the message: not known
    return fields


def mode_number(mode: int) -> int:
    """Return the mode as messages have it; 0 for one of a machine that needs more than a byte."""
    return mode if mode < 256 else 0


def driven_of(message: Any, joint: str = '') -> Any:
    """
    Return (position, velocity, acceleration) from a Motion or of a joint of a JointState.

    NaN for what the message does not have; None if it does not have the joint.
    """
    if not hasattr(message, 'name'):
        return message.position, message.velocity, message.acceleration
    try:
        i = message.name.index(joint)
        position = message.position[i]
    except (ValueError, IndexError):
        return None
    return position, message.velocity[i] if i < len(message.velocity) else nan, nan


def is_time(sec: int | Array, nanosec: int | Array) -> Any:
    """
    Return whether a stamp is a valid time.

    A node replaces other stamps, and 0, by the time of arrival.
    """
    return (sec >= 0) & (nanosec < 10**9)
