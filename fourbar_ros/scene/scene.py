# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene: one linkage, what drives it, what it publishes.

Read from a ROS 2 parameter file, without ROS.
"""
from __future__ import annotations

from dataclasses import replace
import json
from math import isnan
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Applied, Body, round_rod
from fourbar_ros.mechanisms.contract import SLIDE
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import point_acceleration, point_speed
from fourbar_ros.pipeline.message_fields import layout, Names
from fourbar_ros.scene import of_kinds, parameters
from fourbar_ros.scene.dynamics import Dynamics, of_values
from fourbar_ros.scene.files import as_text, flatten, read_values, SceneError  # noqa: F401
from fourbar_ros.scene.topics import (
    APPLIED,
    DRIVE_STATE,
    PICTURES,
    topics_of,
    TORQUE,
    WRENCHES,
)

IN_WORDS = {1: 'one', 2: 'two', 3: 'three', 4: 'four', 5: 'five', 6: 'six', 7: 'seven', 8: 'eight'}


class DriveSettings(NamedTuple):
    """What moves the input, by ``source``; see the parameter table."""

    source: str
    speed: float
    start: float
    rate: float
    joint: str
    joint_ratio: float
    joint_offset: float
    window: int
    jump: float
    timeout: float
    out_of_range: str
    start_speed: float
    tolerance: float
    budget: int
    when_silent: str
    torque_limit: float


class RecordingSettings(NamedTuple):
    """Where and when to record, when to split [MB], [s], and how much to keep [s]."""

    start: bool
    directory: str
    name: str
    split_size: float
    split_duration: float
    keep: float


class Wrenches(NamedTuple):
    """Which links are loaded by a topic, and what acts while it is silent."""

    links: tuple[str, ...]
    timeout: float
    when_silent: str


class Point(NamedTuple):
    """A point fixed to a link, see :mod:`fourbar_ros.mechanisms.points`."""

    link: str
    along: float
    across: float


class JointStates(NamedTuple):
    """How joint_states shows the joints; see the parameter table."""

    prefix: str
    ratios: list[float]
    offsets: list[float]
    when_unknown: str
    only_passive: bool

    @property
    def are_plain(self):
        """Return whether positions, rates and efforts go out as they are."""
        return (set(self.ratios) == {1.0} and set(self.offsets) == {0.0} and self.when_unknown
                != 'hold')


class Scene(NamedTuple):
    """Everything a node needs to know, checked; ``points`` by their names."""

    linkage: Mechanism
    points: dict[str, Point]
    wrenches: Wrenches
    drive: DriveSettings
    outputs: tuple[str, ...]
    frame_id: str
    joint_names: tuple[str, ...]      # with their prefix
    joint_states: JointStates
    recording: RecordingSettings
    dynamics: Dynamics | None         # where the motion follows from torque
    values: dict       # every parameter by name

    @property
    def as_json(self):
        """Return the given parameters as JSON (NaN stands for "not given", and is no JSON)."""
        return json.dumps({name: value for name, value in self.values.items() if value == value})

    @property
    def as_text(self):
        """Return the text of its scene file: what is given and no default."""
        return as_text({name: value for name, value in self.values.items()
                        if value != parameters.find(name).default})

    @property
    def topics(self):
        """Return {name: Topic} of all outputs; each point has one, named points/NAME."""
        return topics_of(self.outputs, self.points)

    @property
    def pictures(self):
        """Return {name: Topic} of the outputs for people to look at."""
        return {name: PICTURES[name] for name in self.outputs if name in PICTURES}

    @property
    def wrench_topics(self):
        """
        Return the topics of forces from outside.

        Those that come, and those that say what acts.
        """
        return [topics[link] for link in self.wrenches.links for topics in (WRENCHES, APPLIED)]

    @property
    def drive_topics(self):
        """Return the topics of a drive that works by torque: what comes, and its state."""
        if self.dynamics is None:
            return []
        return [TORQUE, DRIVE_STATE] if self.drive.source == TORQUE.name else [DRIVE_STATE]

    @property
    def known_linkage(self):
        """
        Return the linkage as far as its loads are known from its motion alone.

        With springs or dampers, whose forces the loads do not have, it has no masses.
        """
        has_elements = self.dynamics and self.dynamics.elements
        return replace(self.linkage, bodies=None) if has_elements else self.linkage

    @property
    def mover(self):
        """Return the :class:`~fourbar_ros.dynamics.mover.Mover`, which makes the motion."""
        from fourbar_ros.dynamics.mover import Mover
        return Mover(self.dynamics.system(self.linkage), self.drive.tolerance, self.drive.budget,
                     self.drive.source == TORQUE.name)

    @property
    def layout(self):
        """Return the :class:`~fourbar_ros.pipeline.message_fields.FieldMap` of its values."""
        found = layout(Names.of(self.linkage), tuple(self.points), self.needs_loads,
                       not self.joint_states.are_plain, 'drive_wrench' in self.outputs)
        return found.showing(self.joints_shown) if self.joint_states.only_passive else found

    @property
    def joints_shown(self):
        """Return the places of the joints in joint_states: all, or all but the driven one."""
        driven = self.linkage.input_coordinate
        return tuple(place for place, joint in enumerate(self.linkage.JOINTS)
                     if not (self.joint_states.only_passive and joint.coordinate == driven))

    @property
    def names_shown(self):
        """Return the names of the joints in joint_states."""
        return [self.joint_names[place] for place in self.joints_shown]

    @property
    def needs_loads(self):
        """Return whether any output is a load; the effort in joint_states alone is not."""
        return any(topic.needs_loads for topic in self.topics.values())

    @property
    def point_quantities(self):
        """Return the quantities of its points: NAME.speed and NAME.acceleration."""
        return [make(self.linkage, *point, name=name)
                for name, point in self.points.items()
                for make in (point_speed, point_acceleration)]


def from_values(values):
    """
    Return the Scene of a flat dict of parameters, ``{'linkage.a1': 0.4, ...}``.

    Raises
    ------
    InvalidParameter
        Naming the parameter, what was given and what is allowed.

    """
    values = parameters.check(values)
    points = {name: Point(*(values[f'points.{name}.{field}'] for field in Point._fields))
              for name in parameters.names_in('points', values)}
    shown = _group(JointStates, 'joint_states', values)
    linkage = _linkage(values)
    wrenches = Wrenches(tuple(link for link in linkage.EXTERNAL._fields
                              if values[f'external.{link}.from_topic']),
                        values['external.timeout'], values['external.when_silent'])
    scene = Scene(linkage, points, wrenches, _group(DriveSettings, 'drive', values),
                  tuple(values['outputs']),
                  values['frame_id'], tuple(shown.prefix + name for name in values['joint_names']),
                  shown,
                  _group(RecordingSettings, 'recording', values),
                  of_values(values, linkage), values)
    _check_together(scene)
    return scene


def _group(kind, name, values):
    return kind(*(values[f'{name}.{field}'] for field in kind._fields))


def _linkage(values):
    """Return the mechanism of a scene."""
    name = values['linkage.kind']
    kind = KINDS[name]
    lengths = [length.name for length in kind.LENGTHS]
    for length in of_kinds.LENGTHS:
        parameter = parameters.PARAMETERS[f'linkage.{length}']
        value = values[parameter.name]
        if length in lengths and isnan(value):
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
        if length not in lengths and not isnan(value) and value != parameter.default:
            raise InvalidParameter(parameter.name, value, f'linkage.kind {name} has '
                                                          f'{", ".join(lengths)} only')
    arguments = {length: values[f'linkage.{length}'] for length in lengths}
    if len(kind.INPUTS) > 1:
        arguments['input'] = values['linkage.input']
    elif values['linkage.input'] not in kind.INPUTS:
        raise InvalidParameter('linkage.input', values['linkage.input'],
                               f'linkage.kind {name} is driven at its crank')
    if values['linkage.range']:
        if arguments.get('input') != SLIDE:
            raise InvalidParameter('linkage.range', values['linkage.range'],
                                   'only a driven slide has a stroke')
        arguments['stroke'] = tuple(values['linkage.range'])
    try:
        linkage = kind(**arguments, mode=values['linkage.mode'], bodies=_bodies(values, kind),
                       gravity=(values['gravity.x'], values['gravity.y']),
                       external=_external(values, kind))
        linkage.prepare()
        return linkage
    except InvalidParameter as error:
        if error.name in values:
            raise
        name = {'stroke': 'range'}.get(error.name, error.name)
        raise InvalidParameter(f'linkage.{name}', error.value, error.allowed) from None
    except (ArithmeticError, ValueError):
        raise InvalidParameter('linkage', list(arguments.values()),
                               'lengths and bodies are too large, too small or too '
                               'far apart to be computed with') from None


def _check_together(scene):
    """Check what no parameter shows alone."""
    def refuse(name, why):
        value = scene.values[name]
        # NaN: not given
        raise InvalidParameter(name, value if value == value else None, why)

    if scene.needs_loads and scene.linkage.bodies is None:
        loads = [name for name, topic in scene.topics.items() if topic.needs_loads]
        refuse('bodies.crank.mass', f'must be given (or bodies.rods): output {loads[0]} needs '
                                    'masses')
    if not scene.frame_id:
        refuse('frame_id', 'must not be empty')
    names = scene.values['joint_names']
    count = len(scene.linkage.JOINTS)
    if len(names) != count or len(set(names)) != count or '' in names:
        refuse('joint_names', f'must be {IN_WORDS.get(count, count)} different names, one for '
                              'each joint')
    for name in ('ratios', 'offsets'):
        if len(getattr(scene.joint_states, name)) != count:
            refuse(f'joint_states.{name}', f'must be {IN_WORDS.get(count, count)} numbers, one '
                                           'for each joint')
    if 0.0 in scene.joint_states.ratios:
        refuse('joint_states.ratios', 'must not be zero')
    if scene.drive.joint_ratio == 0.0:
        refuse('drive.joint_ratio', 'must not be zero')
    if len(set(scene.outputs)) != len(scene.outputs):
        refuse('outputs', 'names an output twice')
    if 'points' in scene.outputs and not scene.points:
        refuse('outputs', 'points: the scene has none; give points.NAME.link, .along, .across')
    if scene.dynamics and scene.wrenches.links:
        refuse(f'external.{scene.wrenches.links[0]}.from_topic', 'motion that follows from torque '
               'takes constant external forces only')
    if scene.dynamics and scene.dynamics.elements and scene.needs_loads:
        refuse('outputs', 'loads are those of rods, weight and external forces; with springs or '
               'dampers they would be wrong')
    if scene.drive.source == 'joint_state' and not scene.drive.joint:
        refuse('drive.joint', 'must name the joint that is the input')


def _external(values, kind):
    return kind.EXTERNAL(*(Applied(*(values[f'external.{link}.{field}']
                                     for field in Applied.__dataclass_fields__))
                           for link in kind.EXTERNAL._fields))


def _bodies(values, kind):
    """Return the Bodies, or None if the scene gives no mass at all."""
    def given(name):
        return not isnan(values[name])

    has_rods = given('bodies.rods.density') or given('bodies.rods.radius')
    if not has_rods and not any(given(f'bodies.{link.name}.mass') for link in kind.LINKS):
        return None
    for name in ('bodies.rods.density', 'bodies.rods.radius'):
        if has_rods and not given(name):
            raise InvalidParameter(name, None, 'must be given: rods have density and radius')
    return kind.BODIES(*((_rod if has_rods and link.length else _body)(values, link, given)
                         for link in kind.LINKS))


def _rod(values, link, given):
    for field in ('mass', 'inertia', 'cg_along'):
        name = f'bodies.{link.name}.{field}'
        if given(name):
            raise InvalidParameter(name, values[name],
                                   'give either bodies.rods or the bodies one by one, not both')
    return round_rod(values[f'linkage.{link.length}'], values['bodies.rods.density'],
                     values['bodies.rods.radius'])


def _body(values, link, given):
    name = f'bodies.{link.name}.'
    for field in ('mass', 'inertia') if link.turns else ('mass',):
        if not given(name + field):
            raise InvalidParameter(name + field, None,
                                   f'must be given: loads need mass{" and inertia" * link.turns} '
                                   f'of the {link.name}')
    along = (values[name + 'cg_along'] if given(name + 'cg_along')
             else 0.5 * values[f'linkage.{link.length}'] if link.length else 0.0)
    return Body(values[name + 'mass'], along, values[name + 'cg_across'],
                values[name + 'inertia'] if given(name + 'inertia') else 0.0)


def load(path):
    """
    Return the Scene of a ROS 2 parameter file (``/**: ros__parameters: ...``).

    Or of one by name (``paper``).

    Raises
    ------
    SceneError
        The file cannot be read or is no parameter file of one node.
    InvalidParameter
        A value is not allowed.

    """
    return from_values(read_values(path))
