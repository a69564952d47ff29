# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which number goes into which message field, for the node and for recomputing a bag.

A value is named by its field in the mechanism's motion or loads, by ``NAME.FIELD`` in the motion
of a point, or by ``link NAME.FIELD`` in the motion of a link.
"""
from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from math import nan
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.kinds import LOADS
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import BETA, Coordinate, THETA1, THETA2, THETA3, THETA4, TRAVEL
from fourbar_ros.mechanisms.points import LinkFields, PointMotion
from fourbar_ros.numerics.arrays import Array

# Fields of LinkageState, which like LinkageLoads is made for four joints. Those that a mechanism
# does not have are NaN; further links and joints have links/NAME, reactions/NAME.
STATE_FIELDS = (*THETA1, *THETA2, *THETA3, *THETA4, *BETA, 'transmission_angle', 'velocity_ratio',
                'condition', *TRAVEL)
OF_JOINTS = ('position', 'velocity', 'effort')          # of a JointState
DRIVE_WRENCH = ('drive wrench force_x', 'drive wrench force_y', 'drive wrench torque')
EQUATION = ('inertia', 'inertia_slope', 'bias', 'static_torque', 'torque_of_rest')
RIGID = ('mass', 'x', 'y', 'inertia')                  # of the linkage held rigid
PASSIVE_EFFORT = 0.0                                   # frictionless joints
Source = str | tuple[str | None, ...]      # of a field: see FieldMap


def joint_values(count: int) -> tuple[str, ...]:
    """Return the names of scaled positions, velocities and efforts of joints: joint 1 position."""
    return tuple(f'joint {i + 1} {what}' for what in OF_JOINTS for i in range(count))


class FieldMap(NamedTuple):
    """
    Maps values of a mechanism and its points to fields of messages.

    Attributes
    ----------
    fields : dict
        {output: {field of the message: name of the value, or a tuple of names}}; None stands for
        the effort of a passive joint.
    absent : dict
        {output: fields that are always NaN}.
    place : dict
        {name of a value: its index in (*motion, *loads, *motion of each point, *motion of each
        link, *equation, *rigid, *drive wrench, *joints)}.
    joints : tuple
        (coordinate, name of the effort of its drive or None) of each joint.

    """

    fields: Mapping[str, Mapping[str, Source]]
    absent: dict[str, tuple[str, ...]]
    place: dict[str, int]
    joints: tuple[tuple[Coordinate, str | None], ...]

    def expected(self, output: str, values: Sequence[float] | Array) -> dict[str, Any]:
        """
        Return {field: number or tuple of numbers} of one output message.

        ``values`` are ordered by ``place``; of shape (values, n) they give arrays for n messages.
        """
        def pick(source: Source | None) -> Any:
            """Return the value of a name, a tuple of them for a tuple."""
            if isinstance(source, tuple):
                return tuple(map(pick, source))
            return PASSIVE_EFFORT if source is None else values[self.place[source]]

        return {**{field: pick(source) for field, source in self.fields[output].items()},
                **dict.fromkeys(self.absent.get(output, ()), nan)}

    def in_use(self, output: str) -> set[int]:
        """Return the indices of all values that an output shows."""
        return {self.place[name] for source in self.fields[output].values()
                for name in (source if isinstance(source, tuple) else (source,))
                if name is not None}


def layout(mechanism: Mechanism, points: Iterable[str], outputs: Collection[str],
           with_effort: bool, own_joints: bool, shown: Sequence[int]) -> FieldMap:
    """
    Return the :class:`FieldMap` of a mechanism with named points, for some outputs.

    ``with_effort``: joint_states have it; ``own_joints``: they show scaled values of
    :mod:`fourbar_ros.pipeline.joints`, not the motion itself; ``shown``: of which joints.
    """
    names = mechanism.MOTION._fields + mechanism.LOADS._fields
    driven, (output, ratio) = mechanism.input_coordinate, mechanism.outputs[0]
    joints = [joint.coordinate for joint in mechanism.JOINTS]
    motion = ('position', 'velocity', 'acceleration')
    wrench = ('wrench.force.x', 'wrench.force.y', 'wrench.torque.z')
    # a machine may call its input otherwise than LinkageState does
    state = THETA1 if driven.unit == 'rad' else TRAVEL
    renamed = {} if state.position in names else dict(zip(state, driven))
    own: dict[str, Mapping[str, Source]] = {
        f'points/{point}': {name: f'{point}.{name}' for name in PointMotion._fields}
        for point in points}
    own |= {f'links/{link.name}': {name: f'link {link.name}.{name}' for name in LinkFields._fields}
            for link in mechanism.LINKS if 'links' in outputs}
    if 'equation' in outputs:
        own['equation'] = {name: f'equation {name}' for name in EQUATION}
    if 'inertia' in outputs:
        own['inertia'] = dict(zip(('inertia.m', 'inertia.com.x', 'inertia.com.y', 'inertia.izz'),
                                  [f'rigid {name}' for name in RIGID]))
    fields: dict[str, Mapping[str, Source]] = {
        'driven': dict(zip(motion, driven)),
        'output': dict(zip(motion, output)),
        'state': {'velocity_ratio': ratio, **renamed,
                  **{name: name for name in STATE_FIELDS if name in names}},
        'loads': {name: name for name in LOADS if name in names},
        'shaking_wrench': dict(zip(wrench, ('shaking_force_x', 'shaking_force_y',
                                            'shaking_moment'))),
        'joint_states': _joint_states(joints, driven, with_effort, own_joints, shown),
        **own,
        **{f'reactions/{reaction.joint}': dict(zip(wrench, filter(None, (
            reaction.x, reaction.y, reaction.couple)))) for reaction in mechanism.REACTIONS},
    }
    absent = {'state': tuple(name for name in STATE_FIELDS if name not in fields['state']),
              'loads': tuple(name for name in LOADS if name not in names)}
    for sources in own.values():
        names += tuple(map(str, sources.values()))
    if 'equation' in outputs:
        fields['equation'] = {**dict(zip(motion[:2], driven)), **own['equation']}
    if 'drive_wrench' in outputs:
        fields['drive_wrench'] = dict(zip(wrench, DRIVE_WRENCH))
        names += DRIVE_WRENCH
    if own_joints:
        names += joint_values(len(joints))
    return FieldMap(fields, absent, {name: i for i, name in enumerate(names)},
                    tuple((joint, _effort(joint, driven)) for joint in joints))


def _effort(joint: Coordinate, driven: Coordinate) -> str | None:
    """Return the load that is the effort of a joint: the drive's load, None for passive joints."""
    if joint != driven:
        return None
    return 'driving_torque' if driven.unit == 'rad' else 'driving_force'


def _joint_states(joints: Sequence[Coordinate], driven: Coordinate, with_effort: bool, own: bool,
                  shown: Sequence[int]) -> dict[str, Source]:
    """Return {field of a JointState: names of the values of joints}; ``own``: scaled ones."""
    sources: list[tuple[str | None, ...]] = [
        tuple(joint.position for joint in joints), tuple(joint.rate for joint in joints),
        tuple(_effort(joint, driven) for joint in joints)]
    if own:
        names, count = joint_values(len(joints)), len(joints)
        sources = [names[count * i:count * (i + 1)] for i in range(len(OF_JOINTS))]
    fields: dict[str, Source] = {field: tuple(names[place] for place in shown)
                                 for field, names in zip(OF_JOINTS, sources)}
    if not with_effort:
        del fields['effort']                             # empty in the message: not known
    return fields


def driven_of(message: Any, joint: str = '') -> Any:
    """
    Return (position, velocity, acceleration) from a Motion or of a joint of a JointState.

    A rate that the message does not have is NaN. None if it does not have the joint.
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
    Return whether a stamp is a valid time; element by element for arrays.

    A node takes the time of arrival in place of an invalid stamp, and of 0.
    """
    return (sec >= 0) & (nanosec < 10**9)
