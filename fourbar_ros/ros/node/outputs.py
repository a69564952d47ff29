# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The outputs of a node: only needed ones are made, and each message is serialised once.

The same bytes go to the subscribers and to the bag.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from math import isnan
from typing import Any, NamedTuple

from fourbar_ros.pipeline.status import OK
from fourbar_ros.ros.messages import resolve, set_constants, Stamp
from fourbar_ros.ros.node import packed, qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.message_fields import FieldMap, mode_number
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, Topic
from rclpy.event_handler import PublisherEventCallbacks, UnsupportedEventTypeError
from rclpy.publisher import Publisher

PARTS = 'points', 'links'      # families whose values are computed for a topic alone


class Writer(NamedTuple):
    """Makes the messages of a topic; ``key``: all of the scene that is in their bytes."""

    key: object
    pack: packed.Pack
    is_packed: bool


def writer_of(topic: Topic, scene: Scene, layout: FieldMap, known: Writer | None) -> Writer:
    """Return the Writer of a topic: the known one, unless more than numbers has changed."""
    kind = resolve(topic.type)
    key = (layout, scene.frame_id, scene.names_shown,
           scene.linkage.change_point_margin if hasattr(kind, 'change_point_margin') else None)
    if known and known.key == key:
        return known
    message = kind()                         # one for all steps
    set_constants(topic.name, message, scene)
    return Writer(key, *packed.writer(topic.name, message, layout))


class TopicPublisher:
    """
    One published topic; ``is_subscribed`` tells whether it has subscribers.

    ``changed()`` is called when the first subscriber has come or the last one has left. Where the
    middleware has no event for that, the topic counts as subscribed.
    """

    def __init__(self, node: Base, topic: Topic, changed: Callable[[], None]) -> None:
        self.name, self._topic, self._node = topic.name, topic, node
        self.is_part = topic.name.partition('/')[0] in PARTS     # as 'points/coupler'
        self.is_subscribed, self._changed = False, changed
        try:
            self._publisher = self._create(PublisherEventCallbacks(matched=self._matched))
        except UnsupportedEventTypeError:
            self.is_subscribed = True
            self._publisher = self._create(None)

    def _create(self, callbacks: PublisherEventCallbacks | None) -> Publisher:
        return qos.publisher(self._node, self._topic, event_callbacks=callbacks)

    @property
    def topic(self) -> str:
        """Return the full name of the topic."""
        return str(self._publisher.topic_name)

    def _matched(self, info: Any) -> None:
        """Note how many subscribers there are: rclpy's event."""
        is_subscribed = info.current_count > 0
        if is_subscribed != self.is_subscribed:
            self.is_subscribed = is_subscribed
            self._changed()

    def apply(self, scene: Scene, writer: Writer) -> None:
        """Take over a scene: set ``pack``, values to bytes, ``publish`` and ``needs_loads``."""
        self._positions, self.pack = scene.needed_for(self.name), writer.pack
        if not writer.is_packed:
            self._node.get_logger().info(f'{self._topic.topic}: {self._topic.type} cannot be '
                                         'packed here, ROS serialises every message', once=True)
        self.needs_loads = (self._topic.needs_loads
                            or (self.name == 'joint_states' and scene.needs_loads))
        self.publish = self._node.circles.sender(self._publisher, self._topic)

    def has_something(self, values: Sequence[float]) -> bool:
        """Return whether no value is NaN that it must not send, as a position in joint_states."""
        return not any(isnan(values[place]) for place in self._positions)


def drive_layout() -> FieldMap:
    """Return which value of DriveValues goes into which field of DriveState: names are equal."""
    from fourbar_ros.dynamics.step.mover import DriveValues  # only these scenes need it
    names = DriveValues._fields
    return FieldMap({DRIVE_STATE.name: dict(zip(names, names))}, {},
                    {name: i for i, name in enumerate(names)}, ())


class Wanted(NamedTuple):
    """The outputs that a step has to send, and the parts of a step that they need."""

    driven: bool
    drive_state: bool
    outputs: list[TopicPublisher]
    with_loads: bool
    parts: frozenset[str]     # the points and links among them


class Outputs:
    """
    The publishers of a node: the driven motion, the drive's state, and the scene's outputs.

    ``named`` are the scene's outputs, ``mode`` is the assembly mode in their messages, and
    ``are_heard`` tells whether any publisher has a subscriber.
    """

    def __init__(self, node: Base, recording: Recording) -> None:
        self._node, self._recording = node, recording
        self._sent: list[tuple[str, bytes]] = []     # (topic, bytes) to record at the step's end
        self._drive_state: TopicPublisher | None = None      # in scenes with dynamics only
        self.named: list[TopicPublisher] = []
        # Publishers are kept when a scene no longer names them: rclpy's EventsExecutor ends the
        # process at an event of a publisher that is gone, as when its last subscriber leaves.
        # By the names of outputs, of all scenes so far.
        self._made: dict[str, TopicPublisher] = {}
        self._driven = self._publisher(DRIVEN)
        self._writers: dict[str, Writer] = {}        # by the names of topics

    def prepare(self, scene: Scene) -> dict[str, Writer]:
        """Return the Writer of each topic of a scene, by its name, while steps go on."""
        layout = scene.layout
        writers = {topic.name: writer_of(topic, scene, layout, self._writers.get(topic.name))
                   for topic in (DRIVEN, *scene.topics.values())}
        if scene.dynamics:
            writers[DRIVE_STATE.name] = writer_of(DRIVE_STATE, scene, drive_layout(),
                                                  self._writers.get(DRIVE_STATE.name))
        return writers

    def apply(self, scene: Scene, writers: dict[str, Writer]) -> None:
        """Take over a scene: create its publishers; others of an earlier scene become silent."""
        self._writers = writers
        self.mode = mode_number(scene.linkage.mode)
        for name, topic in scene.topics.items():
            if name not in self._made:
                self._made[name] = self._publisher(topic)
        self.named = [self._made[name] for name in scene.topics]
        if scene.dynamics and not self._drive_state:
            self._drive_state = self._publisher(DRIVE_STATE)
        for output in self._every():
            output.apply(scene, writers[output.name])
        self._update()

    def topics(self) -> list[str]:
        """Return the full names of the topics that answer every input."""
        return [output.topic for output in self._every()]

    def _every(self) -> list[TopicPublisher]:
        return [self._driven, *([self._drive_state] if self._drive_state else []), *self.named]

    def _publisher(self, topic: Topic) -> TopicPublisher:
        return TopicPublisher(self._node, topic, self._update)

    def _update(self) -> None:
        """
        Note the outputs that steps have to compute, while a bag is recorded and while none is.

        It is called when a subscriber comes or leaves: in every step it would take too long.
        """
        every = self._every()
        subscribed = [output for output in every if output.is_subscribed]
        self._all, self._subscribed = self._wanted_for(every), self._wanted_for(subscribed)
        self.are_heard = bool(subscribed)

    def _wanted_for(self, publishers: Collection[TopicPublisher]) -> Wanted:
        """Return the work of a step whose messages go to these publishers."""
        outputs = [output for output in self.named if output in publishers]
        return Wanted(self._driven in publishers, self._drive_state in publishers, outputs,
                      any(output.needs_loads for output in outputs),
                      frozenset(output.name for output in outputs if output.is_part))

    def wanted(self) -> Wanted:
        """Return the work of a step now: all outputs while recording, else subscribed ones."""
        return self._all if self._recording.active else self._subscribed

    def send_driven(self, stamp: Stamp, values: Sequence[float]) -> None:
        """Send the driven motion; it is recorded by the next :meth:`send` or :meth:`record`."""
        self._send([self._driven], stamp, OK, values)

    def send_drive_state(self, stamp: Stamp, status: int, values: Sequence[float]) -> None:
        """Send the state of a torque drive; recorded as :meth:`send_driven` is."""
        if self._drive_state is not None:
            self._send([self._drive_state], stamp, status, values)

    def send(self, stamp: Stamp, status: int, values: Sequence[float],
             outputs: Sequence[TopicPublisher] | None = None) -> None:
        """
        Send the messages of one step, and record them with its driven motion and drive state.

        ``values``: the floats of the step in the order of ``layout.place``; ``outputs``: where
        they go, by default all that the scene names. If ``status`` is not OK, as in a position
        that cannot be assembled, values may be NaN, and outputs that must not send NaN are left
        out (see :meth:`TopicPublisher.has_something`).
        """
        outputs = self.named if outputs is None else outputs
        if status != OK:
            outputs = [output for output in outputs if output.has_something(values)]
        self._send(outputs, stamp, status, values)
        self.record()

    def record(self) -> None:
        """Record all that was sent since the last time, in one call of the writer."""
        if self._sent:
            sent, self._sent = self._sent, []
            self._recording.write_all(sent)

    def _send(self, outputs: Sequence[TopicPublisher], stamp: Stamp, status: int,
              values: Sequence[float]) -> None:
        """
        Pack all messages, then publish those that have a subscriber; keep all for the bag.

        They go out together, so the middleware wakes up less often.
        """
        messages = [(output, output.pack(stamp, status, self.mode, values)) for output in outputs]
        for output, data in messages:
            if output.is_subscribed:                     # others are for the bag alone
                output.publish(data)
        if self._recording.active:
            self._sent += [(output.name, data) for output, data in messages]
