# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene: one linkage, what drives it, what it publishes.

Read from a ROS 2 parameter file, without ROS.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
import json
from pathlib import Path
from typing import Any, cast, NamedTuple, TYPE_CHECKING, TypeVar

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import Function, point_acceleration, point_speed
from fourbar_ros.pipeline.message_fields import FieldMap, layout, Names
from fourbar_ros.scene import parameters
from fourbar_ros.scene.checks import check_link, check_together
from fourbar_ros.scene.dynamics import Dynamics, of_values
from fourbar_ros.scene.families import names_in
from fourbar_ros.scene.files import as_text, flatten, read_values, SceneError  # noqa: F401
from fourbar_ros.scene.linkage import linkage_of
from fourbar_ros.scene.topics import (
    applied_topic,
    DRIVE_STATE,
    PICTURES,
    Topic,
    topics_of,
    TORQUE,
    wrench_topic,
)

if TYPE_CHECKING:      # other scenes do without
    from fourbar_ros.dynamics.mover import Mover


Settings = TypeVar('Settings')


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
    def are_plain(self) -> bool:
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
    values: dict[str, Any]       # every parameter by name

    @property
    def as_json(self) -> str:
        """Return the given parameters as JSON (NaN stands for "not given", and is no JSON)."""
        return json.dumps({name: value for name, value in self.values.items() if value == value})

    def in_mode(self, mode: int | None) -> Mechanism:
        """Return the linkage in an assembly mode; None or 0: that of the scene."""
        known = self.linkage.modes
        if mode and mode not in known:
            raise InvalidParameter('mode', mode, 'must be '
                                   f'{" or ".join(map(str, known))}: {self.linkage.description}')
        return self.linkage.in_mode(mode or self.linkage.mode)

    def taken_in(self, mode: int) -> Scene:
        """Return this scene with its linkage in another assembly mode, as beyond a toggle."""
        return self._replace(linkage=self.linkage.in_mode(mode))

    @property
    def as_text(self) -> str:
        """Return the text of its scene file: what is given and no default."""
        return as_text({name: value for name, value in self.values.items()
                        if value != parameters.of_name(name).default})

    @property
    def topics(self) -> dict[str, Topic]:
        """Return {name: Topic} of all outputs; each point has one, named points/NAME."""
        return topics_of(self.outputs, self.members)

    @property
    def members(self) -> dict[str, dict[str, str]]:
        """Return {family of outputs: {name: what it is}}: points, links, reactions."""
        return {'points': {name: f'point of the {point.link}'
                           for name, point in self.points.items()},
                'links': {link.name: f'motion of the {link.text}' for link in self.linkage.LINKS},
                'reactions': {reaction.joint: f'{reaction.text}, at {reaction.joint}'
                              for reaction in self.linkage.REACTIONS}}

    @property
    def pictures(self) -> dict[str, Topic]:
        """Return {name: Topic} of the outputs for people to look at."""
        return {name: PICTURES[name] for name in self.outputs if name in PICTURES}

    @property
    def wrench_topics(self) -> list[Topic]:
        """
        Return the topics of forces from outside.

        Those that come, and those that say what acts.
        """
        return [topic(link) for link in self.wrenches.links
                for topic in (wrench_topic, applied_topic)]

    @property
    def drive_topics(self) -> list[Topic]:
        """Return the topics of a drive that works by torque: what comes, and its state."""
        if self.dynamics is None:
            return []
        return [TORQUE, DRIVE_STATE] if self.drive.source == TORQUE.name else [DRIVE_STATE]

    @property
    def loaded(self) -> Callable[[float, float], Any] | None:
        """Return (position, rate) -> linkage with the forces of springs; None without springs."""
        if self.dynamics is None or not self.dynamics.elements:
            return None
        from fourbar_ros.dynamics.spring_forces import make_loaded
        return make_loaded(self.linkage, self.dynamics.elements)

    @property
    def known_linkage(self) -> Mechanism:
        """
        Return the linkage as far as its loads are known from its motion alone.

        With springs or dampers, whose forces the loads do not have, it has no masses.
        """
        has_elements = self.dynamics and self.dynamics.elements
        return replace(self.linkage, bodies=None) if has_elements else self.linkage

    @property
    def mover(self) -> Mover:
        """Return the :class:`~fourbar_ros.dynamics.mover.Mover`, which makes the motion."""
        from fourbar_ros.dynamics.mover import Mover
        assert self.dynamics is not None        # only scenes that have it are driven so
        return Mover(self.dynamics.system(self.linkage), self.drive.tolerance, self.drive.budget,
                     self.drive.source == TORQUE.name)

    def mover_in(self, mode: int) -> Mover:
        """Return the Mover in a mode beyond a toggle; an unknown mode is that of the scene."""
        # through the flat positions of a change point, one equation holds in both modes
        is_other = mode in self.linkage.modes_passed and self.linkage.change_point_margin != 0.0
        return self.taken_in(mode).mover if is_other else self.mover

    @property
    def layout(self) -> FieldMap:
        """Return the :class:`~fourbar_ros.pipeline.message_fields.FieldMap` of its values."""
        found = layout(Names.of(self.linkage, 'links' in self.outputs), tuple(self.points),
                       self.needs_loads, not self.joint_states.are_plain,
                       'drive_wrench' in self.outputs)
        return found.showing(self.joints_shown) if self.joint_states.only_passive else found

    @property
    def joints_shown(self) -> tuple[int, ...]:
        """Return the places of the joints in joint_states: all, or all but the driven one."""
        driven = self.linkage.input_coordinate
        return tuple(place for place, joint in enumerate(self.linkage.JOINTS)
                     if not (self.joint_states.only_passive and joint.coordinate == driven))

    @property
    def names_shown(self) -> list[str]:
        """Return the names of the joints in joint_states."""
        return [self.joint_names[place] for place in self.joints_shown]

    @property
    def needs_loads(self) -> bool:
        """Return whether any output is a load; the effort in joint_states alone is not."""
        return any(topic.needs_loads for topic in self.topics.values())

    @property
    def point_quantities(self) -> list[Function]:
        """Return the quantities of its points: NAME.speed and NAME.acceleration."""
        return [make(self.linkage, *point, name=name)
                for name, point in self.points.items()
                for make in (point_speed, point_acceleration)]


def from_values(values: Mapping[str, Any]) -> Scene:
    """
    Return the Scene of a flat dict of parameters, ``{'linkage.a1': 0.4, ...}``.

    Raises
    ------
    InvalidParameter
        Naming the parameter, what was given and what is allowed.

    """
    values = parameters.check(values)
    points = {name: Point(*(values[f'points.{name}.{field}'] for field in Point._fields))
              for name in names_in('points', values)}
    linkage = linkage_of(values)
    for name, point in points.items():
        check_link(f'points.{name}.link', point.link, linkage)
    shown = _group(JointStates, 'joint_states', values)
    shown = shown._replace(ratios=shown.ratios or [1.0] * len(linkage.JOINTS),
                           offsets=shown.offsets or [0.0] * len(linkage.JOINTS))
    names = values['joint_names'] or [joint.name or joint.place for joint in linkage.JOINTS]
    wrenches = Wrenches(tuple(link for link in linkage.EXTERNAL._fields
                              if values[f'external.{link}.from_topic']),
                        values['external.timeout'], values['external.when_silent'])
    scene = Scene(linkage, points, wrenches, _group(DriveSettings, 'drive', values),
                  tuple(values['outputs']),
                  values['frame_id'], tuple(shown.prefix + name for name in names), shown,
                  _group(RecordingSettings, 'recording', values),
                  of_values(values, linkage), values)
    check_together(scene)
    return scene


def _group(kind: type[Settings], name: str, values: Mapping[str, Any]) -> Settings:
    made: Any = kind                    # a NamedTuple
    return cast(Settings, made(*(values[f'{name}.{field}'] for field in made._fields)))


def load(path: str | Path) -> Scene:
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
