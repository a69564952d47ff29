# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene: one mechanism with its drive and topics.

Read from a ROS 2 parameter file, without ROS.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
import json
from math import inf, isfinite, isnan, tau
from pathlib import Path
from typing import Any, NoReturn, TYPE_CHECKING
import warnings

from fourbar_ros.errors import FourBarError, InvalidParameter, OutOfRange, SceneWarning
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields, record_type
from fourbar_ros.notebook import as_html, from_lab, in_lines, short_repr
from fourbar_ros.scene import parameters, topics
from fourbar_ros.scene.linkage import linkage_of, warnings_of
from fourbar_ros.scene.message_fields import FieldMap, layout
from fourbar_ros.scene.settings import MACHINE, PARAMETERS, ParameterValues, SOURCES
from fourbar_ros.scene.topics import Topic

if TYPE_CHECKING:      # imported where a scene needs them
    from fourbar_ros.dynamics.node_step import Mover
    from fourbar_ros.mechanisms.inertia import Rigid
    from fourbar_ros.mechanisms.quantities import Function
    from fourbar_ros.scene.dynamics import Dynamics
    from fourbar_ros.transmission import Transmission
    from matplotlib.figure import Figure
    from pandas import DataFrame


def no_pause() -> None:
    """Do nothing between two pieces of work."""


@dataclass(frozen=True, eq=False, repr=False)
class Scene:
    """
    A mechanism with its drive, outputs and recording, checked: all that a node or a bag needs.

    ``kind`` is linkage.kind; ``linkage`` the mechanism with all that acts on it; ``points`` by
    their names; ``dynamics`` where the motion follows from torque; ``values``: every parameter by
    name; ``name``: of its file and node. Groups are records of the parameters of :mod:`.settings`:
    ``drive.speed`` is drive.speed.
    """

    kind: str
    linkage: Mechanism
    points: dict[str, Point]
    wrenches: NamedFields             # external.*, and ``links`` whose wrench a topic sends
    base: NamedFields                 # base.*, and ``carried`` with base.carried.*
    drive: NamedFields
    outputs: tuple[str, ...]
    frame_id: str
    frame: NamedFields
    joint_names: tuple[str, ...]      # with their prefix
    joint_states: NamedFields         # ratios and offsets of every joint, whether given or not
    recording: NamedFields
    dynamics: Dynamics | None
    values: ParameterValues
    name: str = ''
    with_unit: frozenset[str] = frozenset()     # parameters that were given as 40mm

    _repr_html_ = as_html

    def __repr__(self) -> str:
        return in_lines(short_repr('Scene', {
            'name': self.name, 'kind': self.kind, 'speed': self.drive.speed,
            'outputs': len(self.outputs), 'points': list(self.points), 'linkage': self.linkage}))

    def draw(self, at: float | str | None = None, **options: Any) -> Figure:
        """
        Return a pose as a figure, as ``fourbar draw`` writes it; requires matplotlib.

        ``at``: the input [deg], of a slide [m], or with a unit: '1.2rad'; and the options of the
        verb: ``over`` 'linkage' (alone), 'paths', 'forces' or 'axis', ``speed``,
        ``acceleration``, ``mode``, ``title``, ``width`` ('88mm').
        """
        return from_lab('draw', 'a drawing', self, at, **options)

    def plot(self, *quantities: str, **options: Any) -> Figure:
        """
        Return quantities over the input as a figure, as ``fourbar plot``; requires matplotlib.

        Of none: rates, accelerations, loads. Options: ``speed``, ``acceleration``, ``mode``,
        ``samples``, ``units`` ('mm,kN'), ``title``, ``width``.
        """
        return from_lab('plot', 'a plot', self, *quantities, **options)

    def table(self, *quantities: str, **options: Any) -> DataFrame:
        """
        Return quantities over the input as a frame, as ``fourbar table``; requires pandas.

        Of none: all. Options: ``speed``, ``acceleration``, ``mode``, ``samples``, ``units``, or
        ``speeds`` (low, high): what the drive must give.
        """
        return from_lab('table', 'a frame', self, *quantities, **options)

    @cached_property
    def warnings(self) -> list[str]:
        """Return a line for each value that is allowed but probably not meant."""
        return [*warnings_of(self)]

    @cached_property
    def as_json(self) -> str:
        """Return the given parameters as JSON (NaN stands for "not given", and is no JSON)."""
        return json.dumps({name: value for name, value in self.values.items() if value == value})

    def in_mode(self, mode: int | None) -> Mechanism:
        """Return the mechanism in an assembly mode; None or 0: the scene's mode."""
        known = list(self.linkage.modes)
        if mode and mode not in known:
            where = ', or change dyads.NAME.mode in the scene' if self.kind == MACHINE else ''
            raise InvalidParameter('mode', mode, f'must be {" or ".join(map(str, known))}: '
                                   f'{self.linkage.description}{where}')
        return self.linkage.in_mode(mode or self.linkage.mode)

    def with_values(self, changes: ParameterValues, pause: Callable[[], None] = no_pause) -> Scene:
        """
        Return this scene with other values of parameters that may change while a node runs.

        InvalidParameter as of :func:`from_values`. Values that stay are not checked again, which
        would take half the time of a live change. ``pause()`` is called between pieces of work.
        """
        checked = {name: parameters.check_value(parameters.of_name(name), value, self.values)
                   for name, value in changes.items()}
        pause()
        with_unit = self.with_unit - changes.keys() | parameters.with_unit(changes)
        return _build({**self.values, **checked}, with_unit, self.name, pause)

    def taken_in(self, mode: int) -> Scene:
        """Return this scene with the mechanism in another assembly mode, as beyond a toggle."""
        return replace(self, linkage=self.linkage.in_mode(mode))

    @property
    def as_text(self) -> str:
        from fourbar_ros.scene.files import as_text
        return as_text(parameters.without_defaults(self.values))

    @cached_property
    def topics(self) -> dict[str, Topic]:
        """Return {name: Topic} of all outputs; each point has one, named points/NAME."""
        return topics.topics_of(self.outputs, {
            'points': {name: f'point of the {point.link}' for name, point in self.points.items()},
            'links': {link.name: f'motion of the {link.text}' for link in self.linkage.LINKS},
            'reactions': {reaction.joint: f'{reaction.text}, at {reaction.joint}'
                          for reaction in self.linkage.REACTIONS}})

    @property
    def pictures(self) -> dict[str, Topic]:
        """Return {name: Topic} of the outputs for people to look at, and of the static frame."""
        named = {name: topics.PICTURES[name] for name in self.outputs if name in topics.PICTURES}
        return named | ({topics.FRAME.name: topics.FRAME} if self.frame.parent else {})

    @property
    def acting(self) -> tuple[str, ...]:
        """Return the links whose wrench comes from a topic, and the base if its motion does."""
        return (*self.wrenches.links, *([topics.BASE.name] if self.base.topic else []))

    @property
    def received(self) -> list[Topic]:
        """Return the topics on which the node listens: of what acts, its input, trajectories."""
        base = [topics.BASES[self.base.topic]] if self.base.topic else []
        inputs = [topic for topic in (*topics.INPUTS.values(), topics.TORQUE)
                  if topic.name == self.drive.source]
        return [*map(topics.wrench_topic, self.wrenches.links), *base, *inputs,
                *(topics.TRAJECTORIES[name] for name in topics.ANSWERS
                  if self.values['trajectories'])]

    @property
    def published(self) -> list[Topic]:
        """Return the topics on which the node sends, except those of every ROS node."""
        answers = [topic for name, topic in topics.TRAJECTORIES.items()
                   if self.values['trajectories'] and name not in topics.ANSWERS]
        states = [topics.DRIVE_STATE] if self.dynamics else []
        return [*map(topics.applied_topic, self.acting), *states, *answers, topics.DRIVEN,
                topics.SCENE, *self.topics.values(), *self.pictures.values()]

    @property
    def recorded(self) -> list[Topic]:
        """Return the topics of a bag but the input and pictures: what acts, moves, comes out."""
        not_here = *topics.INPUTS.values(), *topics.TRAJECTORIES.values(), *self.pictures.values()
        of_node = [topic for topic in (*self.received, *self.published) if topic not in not_here]
        return list(dict.fromkeys([topics.DRIVEN, topics.SCENE, *of_node]))

    @property
    def transmission(self) -> Transmission:
        """
        Return the Transmission from drive to output, on the branch about ``drive.start``.

        If drive.start is 0, the default, and the mechanism does not close there: on the branch
        about the middle of the first range. Raises FourBarError.
        """
        from fourbar_ros.transmission import Transmission
        try:
            return Transmission(self.linkage, self.drive.start)
        except OutOfRange:
            if self.drive.start != parameters.of_name('drive.start').default:
                raise
            low, high = self.linkage.input_ranges[0]
            return Transmission(self.linkage, 0.5 * (low + high))

    @cached_property
    def must_count_turns(self) -> bool:
        """Return whether a turn of the incoming angle leads to another pose."""
        is_geared = self.drive.source == 'joint_state' and abs(self.drive.joint_ratio) != 1.0
        return is_geared or tau < self.linkage.period < inf

    @cached_property
    def carried(self) -> Rigid | None:
        """Return the inertia that a body of a simulator has for the mechanism; None: none."""
        body = self.base.carried
        if not any(body):
            return None
        from fourbar_ros.mechanisms.inertia import mean_rigid, Rigid  # few scenes need them
        if not body.mean:
            return Rigid(body.mass, body.x, body.y, body.inertia)
        mean = mean_rigid(self.linkage)
        if not all(map(isfinite, mean)):
            raise InvalidParameter('base.carried.mean', True, f'the mean is not finite: {mean}')
        return mean

    @property
    def mover(self) -> Mover:
        from fourbar_ros.dynamics.node_step import Mover
        assert self.dynamics is not None        # only scenes that have it are driven so
        return Mover(self.dynamics.system(self.linkage), self.drive.tolerance,
                     self.drive.budget, self.drive.source == topics.TORQUE.name, self.acting)

    def mover_in(self, mode: int) -> Mover:
        """Return the Mover in another mode; for an unknown mode, the scene's."""
        known = *self.linkage.modes, *self.linkage.modes_passed
        return self.taken_in(mode).mover if mode in known else self.mover

    @cached_property
    def layout(self) -> FieldMap:
        return layout(self.linkage, self.points, self.outputs, self.needs_loads, self.joints_shown)

    @cached_property
    def joints_shown(self) -> tuple[int, ...]:
        """Return the indices of the joints in joint_states, in order: all that stay in."""
        driven, shown = self.linkage.input_coordinate, self.joint_states
        left_out = {shown.prefix + name for name in shown.leave_out}
        return tuple(index for index, joint in enumerate(self.linkage.JOINTS)
                     if self.joint_names[index] not in left_out
                     and not (shown.only_passive and joint.coordinate == driven))

    @property
    def leaves_driven_out(self) -> bool:
        """Return whether another program publishes the driven joint: that of a relay."""
        shown = [self.linkage.JOINTS[index].coordinate for index in self.joints_shown]
        return self.joint_states.only_passive or (
            bool(self.joint_states.leave_out) and self.linkage.input_coordinate not in shown)

    def needed_for(self, output: str) -> list[int]:
        """Return the values (indices) without which joint_states are skipped; [] of the others."""
        if output != 'joint_states' or self.joint_states.when_unknown != 'skip':
            return []
        positions = self.layout.fields[output]['position']
        return [self.layout.index_of[name] for name in positions if name]

    @property
    def names_shown(self) -> list[str]:
        return [self.joint_names[index] for index in self.joints_shown]

    @property
    def needs_loads(self) -> bool:
        """Return whether any output is a load; the effort in joint_states alone is not."""
        return any(topic.needs_loads for topic in self.topics.values())

    @property
    def point_quantities(self) -> list[Function]:
        """Return NAME.x, .y [m], .speed [m/s] and .acceleration [m/s^2] of all points."""
        from fourbar_ros.mechanisms.quantities import POINT_QUANTITIES
        return [make(self.linkage, *point, name=name)
                for name, point in self.points.items() for make in POINT_QUANTITIES]


def from_values(values: ParameterValues) -> Scene:
    """Return the Scene of {'linkage.a1': 0.4, ...}; InvalidParameter says which value is bad."""
    return _build(parameters.check(values), parameters.with_unit(values))


def _build(values: ParameterValues, with_unit: frozenset[str], name: str = '',
           pause: Callable[[], None] = no_pause) -> Scene:
    """Return the Scene of all parameters, each of which is checked; check them together."""
    mechanism, kind, outputs = linkage_of(values), values['linkage.kind'], tuple(values['outputs'])
    pause()
    links, joints = [link.name for link in mechanism.LINKS], mechanism.JOINTS
    families = {name.partition('.')[0] for name in values}
    points = {name: parameters.point_in(f'points.{name}', values)
              for name in (parameters.names_in('points', values) if 'points' in families else ())}
    for point_name, point in points.items():
        parameters.require_choice(f'points.{point_name}.link', point.link, links)
    base = _group('base', values, carried=_group('base.carried', values))
    wrenches = _group('external', values, links=tuple(
        link for link in mechanism.EXTERNAL._fields if values[f'external.{link}.from_topic']))
    offsets = values['joint_states.offsets']
    if str in map(type, offsets) and len(offsets) == len(joints):       # 90deg, or 5mm of a slide
        offsets = [parameters.as_number('joint_states.offsets', offset, joint.coordinate.unit)
                   for offset, joint in zip(offsets, joints)]
        values = {**values, 'joint_states.offsets': offsets}
    joint_states = _group('joint_states', values,
                          ratios=values['joint_states.ratios'] or [1.0] * len(joints),
                          offsets=offsets or [0.0] * len(joints))
    joint_names = values['joint_names'] or [joint.name or joint.place for joint in joints]
    if families & {'forces', 'springs', 'torsion_springs', 'friction'}:
        from fourbar_ros.scene import elements  # few scenes have any
        mechanism = mechanism.with_elements(*elements.elements_of(values, mechanism))
        if 'friction' in families:
            mechanism = mechanism.with_friction(elements.friction_of(values, mechanism))
    dynamics = None
    if values['drive.source'] in SOURCES:
        from fourbar_ros.dynamics.system import SLIP_SPEED  # nor torque
        from fourbar_ros.scene.dynamics import of_values
        mechanism = mechanism.with_slip_speed(SLIP_SPEED)
        dynamics = of_values(values, mechanism)
    scene = Scene(
        kind=kind, linkage=mechanism, points=points, wrenches=wrenches, base=base,
        drive=_group('drive', values), outputs=outputs, frame_id=values['frame_id'],
        frame=_group('frame', values, xyz=values['frame.xyz'] or [0.0] * 3,
                     rpy=values['frame.rpy'] or [0.0] * 3), joint_states=joint_states,
        joint_names=tuple(joint_states.prefix + name for name in joint_names),
        recording=_group('recording', values), dynamics=dynamics, values=values, name=name,
        with_unit=with_unit)
    _check_together(scene)
    return scene


# {group: names of its parameters without it}: those of one level below
_FIELDS = {group: [name.removeprefix(f'{group}.') for name in PARAMETERS
                   if name.rpartition('.')[0] == group]
           for group in ('base', 'base.carried', 'drive', 'external', 'frame', 'joint_states',
                         'recording')}


def _group(name: str, values: ParameterValues, **derived: Any) -> NamedFields:
    """Return the parameters NAME.* as a record; ``derived``: fields with other values, or more."""
    fields = {field: values[f'{name}.{field}'] for field in _FIELDS[name]} | derived
    return record_type(name.rpartition('.')[2].title(), tuple(fields))(*fields.values())


def load(path: str | Path) -> Scene:
    """
    Return the Scene of a ROS 2 parameter file, or of a shipped one by its name, as ``paper``.

    Raises SceneError if it is no parameter file of one node, InvalidParameter for a value that is
    not allowed. A value that is allowed but probably not meant is warned of, as a SceneWarning.
    """
    from fourbar_ros.scene.files import name_of, read_values
    values = read_values(path)
    with naming_nan(values):
        scene = _build(parameters.check(values), parameters.with_unit(values), name_of(path))
    give_warnings(scene, path)
    return scene


@contextmanager
def naming_nan(values: ParameterValues) -> Iterator[None]:
    """Refuse NaN from a user with "NaN is not a number", where a value must be given."""
    try:
        yield
    except InvalidParameter as error:       # checks take NaN for "not given" and say that
        value = values.get(error.name)
        if isinstance(value, float) and isnan(value):
            unit = parameters.unit_in(parameters.of_name(error.name), values)
            raise InvalidParameter(error.name, value, 'NaN is not a number'
                                   + (f' in {unit}' if unit else '')) from None
        raise


def give_warnings(scene: Scene, path: str | Path) -> None:
    """Give a SceneWarning for each value in a file that is allowed but probably not meant."""
    for line in scene.warnings:
        warnings.warn(f'{path}: {line}', SceneWarning, stacklevel=3)


# --- checks of the scene as a whole --------------------------------------------------------------

def _check_together(scene: Scene) -> None:
    """Refuse parameters that are allowed, but not with others of the scene."""
    def refuse(name: str, why: str) -> NoReturn:
        value = scene.values[name]
        raise InvalidParameter(name, value if value == value else None, why)    # NaN: not given

    if scene.needs_loads and scene.linkage.bodies is None:
        loads = [name for name, topic in scene.topics.items() if topic.needs_loads]
        refuse('bodies.crank.mass', f'must be given (or bodies.rods): output {loads[0]} needs '
                                    'masses. Or leave it out of outputs')
    if not scene.frame_id:
        refuse('frame_id', 'must not be empty')
    if scene.frame.parent == scene.frame_id:
        refuse('frame.parent', 'must be another frame than frame_id, which lies in it')
    for name, numbers in (('xyz', scene.frame.xyz), ('rpy', scene.frame.rpy)):
        if scene.values[f'frame.{name}'] and not scene.frame.parent:
            refuse(f'frame.{name}', 'has no effect without frame.parent')
        if len(numbers) != 3:
            refuse(f'frame.{name}', 'must be 3 numbers: '
                   + ('x, y, z' if name == 'xyz' else 'roll, pitch, yaw'))
    for name, frame in (('frame_id', scene.frame_id), ('frame.parent', scene.frame.parent),
                        ('joint_states.prefix', scene.joint_states.prefix)):
        if frame.startswith('/'):
            refuse(name, 'must not begin with a slash: tf2 takes no such frame')
    names, count = scene.joint_names, len(scene.linkage.JOINTS)
    # a name that is the prefix alone was empty
    if len(names) != count or len(set(names)) != count or scene.joint_states.prefix in names:
        refuse('joint_names', f'must be {count} different names, one for each joint, none empty')
    shown = scene.joint_states
    without_prefix = [name.removeprefix(shown.prefix) for name in names]
    for name in shown.leave_out:
        parameters.require_choice('joint_states.leave_out', name, without_prefix, some=True)
    if shown.leave_out and 'joint_states' in scene.outputs and not scene.joints_shown:
        refuse('joint_states.leave_out', 'leaves no joint: leave joint_states out of outputs')
    for name, scales in (('ratios', shown.ratios), ('offsets', shown.offsets)):
        if len(scales) != count:
            refuse(f'joint_states.{name}', f'must be {count} numbers, one for each joint')
    if 0.0 in shown.ratios:
        refuse('joint_states.ratios', 'must not be zero')
    if scene.drive.joint_ratio == 0.0:
        refuse('drive.joint_ratio', 'must not be zero')
    if not isnan(scene.drive.top_speed):
        if scene.linkage.is_driven_by_slide:
            refuse('drive.top_speed', 'is for positions that wrap after a turn: a slide has none')
        if scene.must_count_turns:
            refuse('drive.top_speed', 'is for positions that wrap after a turn: with a '
                   'drive.joint_ratio other than 1 and -1, and at a change point that repeats '
                   'after two turns, they must count their turns')
    if len(set(scene.outputs)) != len(scene.outputs):
        refuse('outputs', 'names an output twice')
    if 'points' in scene.outputs and not scene.points:
        refuse('outputs', 'points: the scene has none; give points.NAME.link, .along, .across')
    if scene.base.topic and scene.linkage.bodies is None:
        refuse('base.topic', 'has no effect without masses')
    carried = [name for name, value in scene.base.carried._asdict().items() if value != 0]
    if carried and scene.linkage.bodies is None:
        refuse(f'base.carried.{carried[0]}', 'has no effect without masses')
    if 'mean' in carried and len(carried) > 1:
        refuse('base.carried.mean', 'and numbers of base.carried exclude each other')
    if scene.base.rotation:
        from fourbar_ros.scene.base import rotation_of
        rotation_of(scene.base.rotation)
    if scene.values['trajectories'] and scene.base.topic:
        refuse('trajectories', f'{scene.linkage.why_no_loads}: their effort would be wrong')
    if scene.drive.source == 'joint_state' and not scene.drive.joint:
        refuse('drive.joint', 'must name the joint that is the input')
    if scene.values['trajectories']:
        output = scene.linkage.outputs[0].coordinate
        coordinates = [joint.coordinate for joint in scene.linkage.JOINTS]
        if output not in coordinates:
            of_joints = ', '.join(coordinate.position for coordinate in coordinates)
            refuse('trajectories', f'the output {output.position} is of no joint of joint_names; '
                                   f'of joints are {of_joints}')
        try:
            _ = scene.transmission
        except FourBarError as error:
            refuse('drive.start', f'chooses the branch of trajectories, but {error}')
