# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which value goes into which message field, for the node and for recomputing a bag.

A value is named by its field in the mechanism's motion or loads, by ``NAME.FIELD`` in the motion
of a point, or by ``link NAME.FIELD`` in the motion of a link.
"""
from collections.abc import Collection, Iterable, Mapping, Sequence
from math import nan
from typing import Any, NamedTuple

from fourbar_ros.mechanisms import curves, load_table
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import BETA, Coordinate, THETA1, THETA2, THETA3, THETA4, TRAVEL
from fourbar_ros.numerics.arrays import Array

# Fields of LinkageState, which like LinkageLoads is made for four joints. Those that a mechanism
# does not have are NaN; further links and joints have links/NAME, reactions/NAME.
STATE_FIELDS = (*THETA1, *THETA2, *THETA3, *THETA4, *BETA, 'transmission_angle', 'velocity_ratio',
                'condition', *TRAVEL)
MOTION = ('position', 'velocity', 'acceleration')
WRENCH = ('wrench.force.x', 'wrench.force.y', 'wrench.torque.z')
DRIVE_WRENCH = ('drive wrench force_x', 'drive wrench force_y', 'drive wrench torque')
EQUATION = ('inertia', 'inertia_slope', 'bias', 'static_torque', 'torque_of_rest')
RIGID = ('mass', 'x', 'y', 'inertia')                  # of the linkage held rigid
PASSIVE_EFFORT = 0.0                                   # frictionless joints
Source = str | tuple[str | None, ...]      # of a field: see FieldMap


class FieldMap(NamedTuple):
    """Maps values of a mechanism and its points to fields of messages."""

    # {output: {field of the message: name of the value, or a tuple of names}}; None stands for the
    # effort of a passive joint
    fields: Mapping[str, Mapping[str, Source]]
    absent: dict[str, tuple[str, ...]]      # {output: fields that are always NaN}
    index_of: dict[str, int]                # {name of a value: its index in a sample}
    joints: tuple[tuple[Coordinate, str | None], ...]   # with the effort of the drive, or None
    # {group: slice of a sample}, in this order: motion, loads, and those of the scene's outputs
    # points/NAME, links/NAME, equation, inertia, drive_wrench, joint_states
    groups: Mapping[str, slice]

    @property
    def unknown(self) -> tuple[float, ...]:
        return (nan,) * len(self.index_of)

    def expected(self, output: str, values: Sequence[float] | Array) -> dict[str, Any]:
        """Return {field: number or tuple} of one output message; arrays of values (values, n)."""
        def pick(source: Source | None) -> Any:
            if isinstance(source, tuple):
                return tuple(map(pick, source))
            return PASSIVE_EFFORT if source is None else values[self.index_of[source]]

        return {**{field: pick(source) for field, source in self.fields[output].items()},
                **dict.fromkeys(self.absent.get(output, ()), nan)}

    def in_use(self, output: str) -> set[int]:
        return {self.index_of[name] for source in self.fields[output].values()
                for name in (source if isinstance(source, tuple) else (source,))
                if name is not None}


def layout(mechanism: Mechanism, points: Iterable[str], outputs: Collection[str],
           with_effort: bool, shown: Sequence[int]) -> FieldMap:
    """
    Return the :class:`FieldMap` of a mechanism with named points, for some outputs.

    ``with_effort``: joint_states have it; ``shown``: of which joints. They show values of
    :mod:`fourbar_ros.pipeline.joints`, not the motion itself.
    """
    known = mechanism.MOTION._fields + mechanism.LOADS._fields
    driven, (output, ratio) = mechanism.input_coordinate, mechanism.outputs[0]
    joints = tuple([(joint.coordinate, mechanism.drive_load if joint.coordinate == driven
                     else None) for joint in mechanism.JOINTS])
    # the input of a machine may have another name than in LinkageState
    state = THETA1 if driven.unit == 'rad' else TRAVEL
    renamed = {} if state.position in known else dict(zip(state, driven))
    fields: dict[str, Mapping[str, Source]] = {
        'driven': dict(zip(MOTION, driven)),
        'output': dict(zip(MOTION, output)),
        'state': {'velocity_ratio': ratio, **renamed,
                  **{name: name for name in STATE_FIELDS if name in known}},
        'loads': {name: name for name in load_table.LOADS if name in known},
        'shaking_wrench': dict(zip(WRENCH, ('shaking_force_x', 'shaking_force_y',
                                            'shaking_moment'))),
        **{f'reactions/{reaction.joint}': dict(zip(WRENCH, filter(None, (
            reaction.x, reaction.y, reaction.couple)))) for reaction in mechanism.REACTIONS}}
    absent = {'state': tuple(name for name in STATE_FIELDS if name not in fields['state']),
              'loads': tuple(name for name in load_table.LOADS if name not in known)}
    names = list(known)         # of the values of a sample, in their order
    end_of_motion = len(mechanism.MOTION._fields)
    groups = {'motion': slice(end_of_motion), 'loads': slice(end_of_motion, len(known))}

    def add(name: str, sources: dict[str, str]) -> None:
        """Let an output show further values, a group that follows the last one."""
        fields[name] = sources
        groups[name] = slice(len(names), len(names) + len(sources))
        names.extend(sources.values())

    for point in points:
        add(f'points/{point}', {name: f'{point}.{name}' for name in curves.PointMotion._fields})
    for link in mechanism.LINKS if 'links' in outputs else ():
        add(f'links/{link.name}',
            {name: f'link {link.name}.{name}' for name in curves.LinkFields._fields})
    if 'equation' in outputs:
        add('equation', {name: f'equation {name}' for name in EQUATION})
        fields['equation'] = {**dict(zip(MOTION[:2], driven)), **fields['equation']}
    if 'inertia' in outputs:
        add('inertia', dict(zip(('inertia.m', 'inertia.com.x', 'inertia.com.y', 'inertia.izz'),
                                [f'rigid {name}' for name in RIGID])))
    if 'drive_wrench' in outputs:
        add('drive_wrench', dict(zip(WRENCH, DRIVE_WRENCH)))
    if 'joint_states' in outputs:
        scaled = {field: [f'joint {i} {field}' for i in range(1, len(joints) + 1)]
                  for field in ('position', 'velocity', 'effort')}
        begin = len(names)
        names += [name for of_joints in scaled.values() for name in of_joints]
        groups['joint_states'] = slice(begin, len(names))
        fields['joint_states'] = {
            field: tuple(of_joints[joint] for joint in shown)
            for field, of_joints in scaled.items()
            if field != 'effort' or with_effort}     # else empty in the message: not known
    return FieldMap(fields, absent, {name: i for i, name in enumerate(names)}, joints, groups)


def driven_of(message: Any, joint: str = '') -> Any:
    """
    Return (position, velocity, acceleration), unknown rates NaN; None without the joint.

    Numbers of a JointState that are not as many as its names may be those of other joints; of a
    joint that is named twice nobody knows which is right.
    """
    if not hasattr(message, 'name'):
        return message.position, message.velocity, message.acceleration
    names, velocities = message.name, message.velocity
    if names.count(joint) != 1 or len(message.position) != len(names):
        return None
    i = names.index(joint)
    return message.position[i], velocities[i] if len(velocities) == len(names) else nan, nan


def nanoseconds(seconds: float) -> int:
    """Return a time [s] in whole nanoseconds, as stamps and clocks have it: compare such alone."""
    return round(seconds * 1e9)
