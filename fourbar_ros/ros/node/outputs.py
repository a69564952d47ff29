# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All outputs of a scene.

Which of them are needed, and sending them to subscribers and to the bag.
"""
from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

from fourbar_ros.pipeline.status import OK
from fourbar_ros.ros.messages import Stamp
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.publishers import TopicPublisher
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.message_fields import mode_number
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, Topic


class Wanted(NamedTuple):
    """The outputs that a step is for, and what it has to compute for them."""

    driven: bool
    drive_state: bool
    outputs: list[TopicPublisher]
    with_loads: bool
    parts: frozenset[str]     # the points and links among them


class Outputs:
    """
    The publishers of a scene: the driven motion and those that the scene names.

    Parameters
    ----------
    node : Base
    recording : Recording

    Attributes
    ----------
    named : list of TopicPublisher
        The outputs that the scene names.
    mode : int
        The assembly mode that messages tell.
    are_heard : bool
        Whether any has a subscriber.

    """

    def __init__(self, node: Base, recording: Recording) -> None:
        self._node, self._recording = node, recording
        # (topic, bytes), to be recorded at the end of the step
        self._sent: list[tuple[str, bytes]] = []
        self._drive_state: TopicPublisher | None = None
        self.named: list[TopicPublisher] = []
        # Kept when a scene no longer names them: an event of a publisher that is gone ends the
        # process in rclpy's EventsExecutor, and who listens to it makes such events.
        self._made: dict[str, TopicPublisher] = {}
        self._driven = self._publisher(DRIVEN)

    def apply(self, scene: Scene) -> None:
        """Take over a scene: create publishers, leave those silent that it does not name."""
        self.mode = mode_number(scene.linkage.mode)
        for name, topic in scene.topics.items():
            if name not in self._made:
                self._made[name] = self._publisher(topic)
        self.named = [self._made[name] for name in scene.topics]
        if scene.dynamics and not self._drive_state:
            self._drive_state = self._publisher(DRIVE_STATE)
        for output in self._every():
            output.apply(scene)
        self._update()

    def topics(self) -> list[str]:
        """Return the full names of what is sent for every input."""
        return [output.topic for output in self._every()]

    def _every(self) -> list[TopicPublisher]:
        return [self._driven, *([self._drive_state] if self._drive_state else []), *self.named]

    def _publisher(self, topic: Topic) -> TopicPublisher:
        return TopicPublisher(self._node, topic, self._update)

    def _update(self) -> None:
        """Note what is needed: when a subscriber comes or leaves, not in every step."""
        every = self._every()
        subscribed = [output for output in every if output.is_subscribed]
        self._all, self._subscribed = self._needed_for(every), self._needed_for(subscribed)
        self.are_heard = bool(subscribed)

    def _needed_for(self, those: Collection[TopicPublisher]) -> Wanted:
        outputs = [output for output in self.named if output in those]
        return Wanted(self._driven in those, self._drive_state in those, outputs,
                      any(output.needs_loads for output in outputs),
                      frozenset(output.name for output in outputs if output.is_part))

    def wanted(self) -> Wanted:
        """Return what is Wanted now: all outputs while recording, else those with subscribers."""
        return self._all if self._recording.active else self._subscribed

    def send_driven(self, stamp: Stamp, values: Sequence[float]) -> None:
        """Send the driven motion; it is recorded by :meth:`record` or with what follows."""
        self._send([self._driven], stamp, OK, values)

    def send_drive_state(self, stamp: Stamp, status: int, values: Sequence[float]) -> None:
        """Send the state of a drive that works by torque; recorded as the driven motion is."""
        if self._drive_state is not None:
            self._send([self._drive_state], stamp, status, values)

    def send(self, stamp: Stamp, status: int, values: Sequence[float],
             outputs: Sequence[TopicPublisher] | None = None) -> None:
        """Send these outputs, all of the scene by default, and record what was sent."""
        outputs = self.named if outputs is None else outputs
        if status != OK:
            outputs = [output for output in outputs if output.has_something(values)]
        self._send(outputs, stamp, status, values)
        self.record()

    def record(self) -> None:
        """Record what was sent since the last time, at one go."""
        if self._sent:
            sent, self._sent = self._sent, []
            self._recording.write_all(sent)

    def _send(self, outputs: Sequence[TopicPublisher], stamp: Stamp, status: int,
              values: Sequence[float]) -> None:
        """Pack all messages, then send them together: so the middleware wakes up less often."""
        mode = self.mode
        packed = [(output, output.pack(stamp, status, mode, values)) for output in outputs]
        for output, data in packed:
            if output.is_subscribed:                          # it may be wanted for the bag alone
                output.publish(data)
        if self._recording.active:
            self._sent += [(output.name, data) for output, data in packed]
