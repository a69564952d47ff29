# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Move the input by torque, of a topic or of a motor, on the grid of the clock."""
from functools import partial
from math import isfinite, nan

from fourbar_ros.dynamics import node_step
from fourbar_ros.dynamics.node_step import DriveValues, Mover, OK, STATUS_NAMES
from fourbar_ros.ros.messages import Message, sec_nanosec
from fourbar_ros.ros.node import clock_input, entities
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene import message_fields, scene, topics
from rclpy.node import Node

_COUNTER = {node_step.OUT_OF_BUDGET: 'budgets_used_up', node_step.AT_LIMIT: 'stops_at_a_limit',
            node_step.NOT_FINITE: 'failures'}


class TorqueInput(clock_input.ClockInput):
    """
    The state of the motion, which each sample moves on by one period.

    Samples missed by a machine that was too slow or suspended are not made up for: the motion
    stands still meanwhile. The torque of a topic is the last finite one, within the limit; when
    it is silent for ``drive.timeout``, the scene says whether it holds or is zero.
    """

    def __init__(self, node: Node, stream: Stream, troubles: entities.Troubles) -> None:
        """Begin the motion at the start of the scene; subscribe to the torque, if one comes."""
        # before the base begins to sample
        self._scene: scene.Scene | None = None             # of the last step
        self._mover: Mover                           # of that scene, made by the first step
        self._subscription = None
        super().__init__(node, stream, troubles)
        troubles.expect('torques', 'malformed', 'not_finite', 'limited', 'silences',
                        *_COUNTER.values())
        if stream.scene.drive.source == topics.TORQUE.name:
            self._subscription = entities.subscription(node, topics.TORQUE, entities.reader(
                topics.TORQUE, self._take, partial(troubles.count, 'malformed')), troubles)

    def stop(self) -> None:
        super().stop()
        if self._subscription:
            self._node.destroy_subscription(self._subscription)

    def age(self) -> float:
        """Return the time since the newest torque [s], NaN before the first."""
        return nan if self._received is None else (self._time() - self._received) * 1e-9

    def report(self) -> clock_input.Reported:
        if self._values is None:
            return {}, []
        return ({'drive': STATUS_NAMES[self._status],
                 'input': f'{self._values.position:.6g}', 'speed': f'{self._values.velocity:.6g}',
                 'torque': f'{self._values.torque:.6g}',
                 'evaluations in a step': f'{self._values.evaluations:.0f}'},
                [STATUS_NAMES[self._status]] if self._status != OK else [])

    # --- the motion ------------------------------------------------------------------------------

    def _prepare(self) -> None:
        self._values: DriveValues | None = None      # the state; None before the first step
        self._mode: int | None = None
        self._status = OK
        self._torque, self._was_silent = 0.0, True
        self._received: int | None = None            # [ns] when the last torque came

    def _sample(self, stamp: int, passed: float) -> None:
        self._stream.step_by(sec_nanosec(stamp), self._move)

    def _leave(self, speed: float, passed: float) -> None:
        """Go on from the state of now."""

    def _move(self) -> tuple[int, int, DriveValues]:
        """Return (status, assembly mode, state) a period later; at first, of the start."""
        run = self._stream.run
        if self._scene is not run.scene:
            assert run.mover is not None                 # this input's scenes have one
            self._scene, self._mover = run.scene, run.mover
        command, is_silent = self._command() if self._subscription else (nan, False)
        if self._values is None:
            self._values = self._mover.start(command)
            self._mode = self._mover.mode
            return node_step.SILENT if is_silent else OK, self._mode, self._values
        status, self._values = self._mover.next(self._values, 1.0 / self._settings.rate, command,
                                                is_silent, mode=self._mode)    # of a new scene
        self._mode = self._mover.mode
        if status != self._status:
            self._status = status
            self._troubles.log(f'drive_{status}', f'drive: {STATUS_NAMES[status]}')
        if status in _COUNTER:
            self._troubles.count(_COUNTER[status])
        return status, self._mode, self._values

    # --- the topic -------------------------------------------------------------------------------

    def _command(self) -> tuple[float, bool]:
        """Return (torque in effect [N m or N], whether the topic is silent)."""
        settings = self._stream.scene.drive
        if self._received == 0:              # the torque came before simulated time began
            self._received = self._time()
        is_silent = self._received is None or (
            0 < message_fields.nanoseconds(settings.timeout) < self._time() - self._received)
        if is_silent and not self._was_silent:
            self._note('silences', f'no torque for {settings.timeout:g} s: '
                                   f'{settings.when_silent}')
        self._was_silent = is_silent
        return (0.0 if is_silent and settings.when_silent == 'zero' else
                node_step.limited(self._torque, settings.torque_limit)), is_silent

    def _take(self, message: Message) -> None:
        """Take a torque, or the force of a slide; the executor calls this between two steps."""
        is_slide, wrench = self._stream.scene.linkage.is_driven_by_slide, message.wrench
        torque = wrench.force.x if is_slide else wrench.torque.z
        self._troubles.count('torques')
        self._stream.record_input(topics.TORQUE.name, message)
        if not isfinite(torque):
            self._note('not_finite', 'a torque that is not finite: ignored')
            return
        if node_step.limited(torque, self._stream.scene.drive.torque_limit) != torque:
            self._note('limited', f'a torque of {torque:g} is more than drive.torque_limit')
        self._torque, self._received = torque, self._time()

    def _note(self, cause: str, text: str) -> None:
        self._troubles.count(cause, f'{topics.TORQUE.topic}: {text}')
