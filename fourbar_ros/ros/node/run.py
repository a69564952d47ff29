# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene with all that its steps need: made beside the stream, swapped as a whole."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import nan
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.pipeline.stepper import InModes
from fourbar_ros.ros.messages import Message, Pack, packer, resolve, set_constants, Stamp
from fourbar_ros.scene.message_fields import FieldMap, mode_number
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, Topic
from rclpy.serialization import serialize_message
from std_msgs.msg import String

if TYPE_CHECKING:      # scenes with wrenches need it
    from fourbar_ros.pipeline.wrenches import Wrench

Make = Callable[[Stamp, Sequence[float]], Message]      # None where the pose is not known


class Writer(NamedTuple):
    """Makes the messages of a topic; ``key``: all of the scene that is in their bytes."""

    key: object
    pack: Pack
    is_packed: bool


class Run:
    """
    A scene in force: its steppers, its messages, its pictures, its equation of motion.

    ``topics`` and ``writers`` have an entry for each topic that answers a step. ``mover``
    integrates the motion where it follows from torque. ``wrenches`` act on links from the first
    step on. ``before`` is the run whose writers are used again where nothing in their bytes has
    changed. FourBarError for a scene whose pictures cannot be drawn.
    """

    def __init__(self, scene: Scene, before: Run | None = None,
                 wrenches: Mapping[str, Wrench] | None = None) -> None:
        self.scene, self.layout = scene, scene.layout
        self.mode = mode_number(scene.linkage.mode)
        self.unknown = (nan,) * len(self.layout.place)
        self.input_places = [self.layout.place[name] for name in scene.linkage.input_coordinate]
        own = [DRIVEN, DRIVE_STATE] if scene.dynamics else [DRIVEN]
        self.outputs = scene.topics
        self.topics = {topic.name: topic for topic in own} | self.outputs
        known: Mapping[str, Writer] = before.writers if before else {}
        self.writers: dict[str, Writer] = {}
        for name, topic in self.topics.items():
            layout = drive_layout() if topic is DRIVE_STATE else self.layout
            self.writers[name] = writer_of(topic, scene, layout, known.get(name))
        # places of the values without which a message of an output is not sent
        self.needed = {name: scene.needed_for(name) for name in self.outputs}
        self.makers: dict[str, Make] = {}        # of pictures
        self.latched: dict[str, bytes] = {}
        if scene.pictures:
            from fourbar_ros.ros.node.pictures import drawn_of  # and their messages
            self.makers, self.latched = drawn_of(scene)
        self.data = bytes(serialize_message(String(data=scene.as_json)))
        self.mover = scene.mover if scene.dynamics else None
        if self.mover:
            self.mover.prepare()             # now, not in the first step
        self.conversion = None
        if scene.values['trajectories']:
            from fourbar_ros.ros.node.trajectories import Conversion  # and its messages
            self.conversion = Conversion(scene)
        self.renew(wrenches)

    def renew(self, wrenches: Mapping[str, Wrench] | None = None) -> None:
        """Evaluate the scene from now on without values held from before."""
        self.stepper = InModes(self.scene, wrenches)
        if self.scene.dynamics:
            self.stepper.prepare(self.scene.dynamics.modes_passed(self.scene.linkage))

    def needs_loads(self, name: str) -> bool:
        """Return whether an output needs the loads of a step."""
        return self.outputs[name].needs_loads or (name == 'joint_states'
                                                  and self.scene.needs_loads)


def writer_of(topic: Topic, scene: Scene, layout: FieldMap, known: Writer | None) -> Writer:
    """Return the Writer of a topic: the known one, unless more than numbers has changed."""
    kind = resolve(topic.type)
    key = (layout, scene.frame_id, scene.names_shown,
           scene.linkage.change_point_margin if hasattr(kind, 'change_point_margin') else None)
    if known and known.key == key:
        return known
    message = kind()                         # one for all steps
    set_constants(topic.name, message, scene)
    return Writer(key, *packer(topic.name, message, layout))


def drive_layout() -> FieldMap:
    """Return which value of DriveValues goes into which field of DriveState: names are equal."""
    from fourbar_ros.dynamics.node_step import DriveValues  # only these scenes need it
    names = DriveValues._fields
    return FieldMap({DRIVE_STATE.name: dict(zip(names, names))}, {},
                    {name: i for i, name in enumerate(names)}, ())
