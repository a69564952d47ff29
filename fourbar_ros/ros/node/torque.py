# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Move the input by torque, of a topic or of a motor, on the grid of the clock."""
from __future__ import annotations

from math import inf, isfinite, isnan, nan

from fourbar_ros.dynamics.step.mover import (
    AT_LIMIT,
    DriveValues,
    Mover,
    NOT_FINITE,
    OK,
    OUT_OF_BUDGET,
    SILENT,
    STATUS_NAMES,
)
from fourbar_ros.ros.messages import resolve, sec_nanosec, Stamp
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.drives import CATCH_UP, Drive, Reported, SimulatedDrive, TimerDrive
from fourbar_ros.ros.node.steady import clock_of
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.scene import DriveSettings, Scene
from fourbar_ros.scene.topics import TORQUE
from rclpy.serialization import deserialize_message

COUNTED = ('late', 'missed', 'clock_steps', 'torques', 'malformed', 'not_finite', 'limited',
           'silences', 'budgets_used_up', 'stops_at_a_limit', 'failures')
_COUNTER = {OUT_OF_BUDGET: 'budgets_used_up', AT_LIMIT: 'stops_at_a_limit',
            NOT_FINITE: 'failures'}


class Command:
    """
    The torque of the topic: the last finite one, within the limit.

    When the topic is silent for ``drive.timeout``, the scene says whether it holds or is zero.
    ``counts`` are the drive's counters, which go up here too.
    """

    def __init__(self, node: Base, stream: Stream, counts: dict[str, int]) -> None:
        self._node, self._stream, self._counts = node, stream, counts
        self._type, self._now = resolve(TORQUE.type), clock_of(node)
        self._forget()
        self._subscription = qos.subscription(node, TORQUE, self._receive)

    def destroy(self) -> None:
        """Unsubscribe."""
        self._node.destroy_subscription(self._subscription)

    def _forget(self) -> None:
        self._torque, self._received, self._was_silent = 0.0, -inf, True

    @property
    def age(self) -> float:
        """Return the time since the newest torque [s], NaN before the first."""
        return self._now() - self._received if self._received > -inf else nan

    def now(self, settings: DriveSettings) -> tuple[float, bool]:
        """Return (torque in effect [N m or N], whether the topic is silent); called in a step."""
        if self._received == 0.0:            # the torque came before simulated time began
            self._received = self._now()
        elif self.age < 0.0:                 # simulated time went back: as at the start
            self._forget()
        is_silent = self._received == -inf or 0.0 < settings.timeout < self.age
        if is_silent and not self._was_silent:
            self._counts['silences'] += 1
            self._node.log.warning('torque', f'{TORQUE.topic}: no torque for '
                                             f'{settings.timeout:g} s: {settings.when_silent}')
        self._was_silent = is_silent
        return (0.0 if is_silent and settings.when_silent == 'zero' else self._torque), is_silent

    def _receive(self, data: bytes) -> None:
        """Take a message between two steps; one that ROS cannot read is not recorded either."""
        if self._node.circles.is_own(self._subscription.topic_name, data):
            return
        try:
            wrench = deserialize_message(data, self._type).wrench
        except Exception:
            self._note('malformed', f'a message that is no {TORQUE.type}')
            return
        scene = self._stream.scene
        torque = wrench.force.x if scene.linkage.is_driven_by_slide else wrench.torque.z
        self._counts['torques'] += 1

        def take() -> None:
            if isfinite(torque):
                self._torque, self._received = self._limited(torque, scene.drive), self._now()
        if not isfinite(torque):
            self._note('not_finite', 'a torque that is not finite: ignored')
        self._stream.between_steps(TORQUE.name, data, take)

    def _limited(self, torque: float, settings: DriveSettings) -> float:
        """Return a torque cut to ``drive.torque_limit``; NaN there is no limit."""
        limit = inf if isnan(settings.torque_limit) else settings.torque_limit
        if abs(torque) > limit:
            self._note('limited', f'a torque of {torque:g} is more than drive.torque_limit')
        return min(max(torque, -limit), limit)

    def _note(self, counter: str, text: str) -> None:
        self._counts[counter] += 1
        self._node.log.warning(counter, f'{TORQUE.topic}: {text}')


class Moving(Drive):
    """Base of both drives by torque: the state of the motion, which each step integrates."""

    COUNTED: tuple[str, ...] = COUNTED
    _mover: Mover               # of the scene in force

    def _prepare(self) -> None:
        """Set the state before the first step, and subscribe to the torque if a topic gives it."""
        self._scene: Scene | None = None             # of the last step
        self._values: DriveValues | None = None      # the state; None before the first step
        self._mode: int | None = None
        self._status, scene = OK, self._stream.scene
        self.prepare(scene)
        self._command = (Command(self._node, self._stream, self.counts)
                         if scene.drive.source == TORQUE.name else None)

    def prepare(self, scene: Scene) -> None:
        """Make the equation of motion of a scene, which takes as long as hundreds of steps."""
        self._prepared = scene, _mover_of(scene)

    def age(self) -> float:
        """Return the time since the newest torque [s], NaN if there is none to wait for."""
        return self._command.age if self._command else nan

    def state(self) -> Reported:
        """Return (values, problems) for the diagnostics."""
        if self._values is None:
            return {}, []
        return ({'drive': STATUS_NAMES[self._status],
                 'input': f'{self._values.position:.6g}', 'speed': f'{self._values.velocity:.6g}',
                 'torque': f'{self._values.torque:.6g}',
                 'evaluations in a step': f'{self._values.evaluations:.0f}'},
                [STATUS_NAMES[self._status]] if self._status != OK else [])

    def _move(self, step: float) -> tuple[int, int, DriveValues]:
        """
        Return (status, assembly mode, state) after ``step`` seconds; the first time, of the start.

        When the scene has changed, its equation of motion goes on from the same state.
        """
        scene = self._stream.scene
        if self._scene is not scene:
            prepared, mover = self._prepared
            self._scene, self._mover = scene, mover if prepared is scene else _mover_of(scene)
        command, is_silent = self._command.now(scene.drive) if self._command else (nan, False)
        if self._values is None:
            self._values = self._mover.start(command)
            self._mode = self._mover.mode
            return SILENT if is_silent else OK, self._mode, self._values
        status, self._values = self._mover.next(self._values, step, command, is_silent,
                                                self._mode)
        self._mode = self._mover.mode
        if status != self._status:
            self._status = status
            self._node.log.warning(f'drive {status}', f'drive: {STATUS_NAMES[status]}')
        if status in _COUNTER:
            self.counts[_COUNTER[status]] += 1
        return status, self._mode, self._values


def _mover_of(scene: Scene) -> Mover:
    mover = scene.mover
    mover.prepare()              # now, not in the first step
    return mover


class TorqueDrive(Moving, TimerDrive):
    """
    Torque on the wall clock: sample k belongs to start + k / rate.

    Every sample moves the state by one period. Samples missed by a machine that was too slow or
    suspended are not made up for: the motion stands still meanwhile.
    """

    _may_sleep = False                # the state depends on every step before it

    def start(self) -> None:
        """Subscribe, start the thread."""
        self._prepare()
        super().start()

    def stop(self) -> None:
        """Stop it and wait for the sample in hand."""
        super().stop()
        if self._command:
            self._command.destroy()

    def _begin(self, settings: DriveSettings) -> None:
        """Begin at the start of the scene."""

    def _sample(self, stamp: Stamp, settings: DriveSettings, elapsed: float) -> None:
        self._stream.step_by(stamp, lambda: self._move(1.0 / settings.rate))

    def _go_on(self, settings: DriveSettings, elapsed: float) -> None:
        """Go on from the state of now."""


class SimulatedTorqueDrive(Moving, SimulatedDrive):
    """Torque on simulated time: each sample moves the state by the time that has passed."""

    def start(self) -> None:
        """Subscribe, start the timer."""
        self._prepare()
        super().start()

    def stop(self) -> None:
        """Stop it."""
        super().stop()
        if self._command:
            self._command.destroy()

    def _begin_again(self) -> None:
        self._values = None

    def _sample_at(self, now: int, passed: float) -> None:
        if passed > CATCH_UP:                            # the motion stands still meanwhile
            self.counts['missed'] += 1
            passed = 1.0 / self.settings.rate
        if passed or self._values is None:               # the first step ends at the start
            self._stream.step_by(sec_nanosec(now), lambda: self._move(passed))
