# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Step a drive again from each recorded state to the next, as the mover of the node does."""
from collections.abc import Mapping, Sequence
from math import inf, isfinite, isnan
from typing import Any

from fourbar_ros.bag.outputs import distance
from fourbar_ros.dynamics.node_step import DriveValues, KEY, limited, Mover, NAME, OK, SILENT
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import TORQUE


class DriveStates:
    """
    Compares the recorded states of a drive with steps from the state before.

    If another version of the integrator made the bag, accelerations and torques alone are computed
    again, from the states. Next to a toggle, input and rate do not determine the state; a mover
    that stepped there knows the rest. Without one, as where a bag begins next to a toggle, states
    are not compared up to the first one past the toggle. ``about``: custom_data of the bag.
    """

    def __init__(self, scene: Scene, about: Mapping[str, str]) -> None:
        """Begin with the scene at the start of a bag."""
        self._has_our_integrator = scene.dynamics is not None and about.get(KEY) == NAME
        self.largest: dict[str, float] = {}         # {field: largest difference}
        # states that were compared with a step from the state before; that had none before (at a
        # start, after a gap, from another integrator); that could not be compared
        self.stepped = self.alone = self.unknown = 0
        self._before: DriveValues | None = None     # None: no state to step from
        self._mode = self._stamp = 0                # of the state before; stamp in ns
        self._torque: float | None = None           # of the newest message; None: not known
        self._acting: dict[str, Sequence[float]] = {}
        self.change(scene)

    @property
    def compared(self) -> int:
        return self.stepped + self.alone

    def change(self, scene: Scene) -> None:
        """Step from here on with the drive of another scene."""
        self._scene = scene
        self._movers: dict[int, Mover] = {}         # by mode; 0: of the scene

    def _mover(self, mode: int = 0) -> Mover:
        if mode not in self._movers:
            self._movers[mode] = self._scene.mover_in(mode)
            for name, acting in self._acting.items():
                self._movers[mode].act(name, acting)
        return self._movers[mode]

    def act(self, name: str, acting: Sequence[float]) -> None:
        """Take a wrench on a link, or a motion of the base, that acts from here on."""
        self._acting[name] = acting
        for mover in self._movers.values():
            mover.act(name, acting)

    def command(self, message: Any) -> None:
        """Take a message of the torque topic."""
        is_slide = self._scene.linkage.is_driven_by_slide
        torque = message.wrench.force.x if is_slide else message.wrench.torque.z
        if isfinite(torque):
            self._torque = torque

    def take(self, stamp: int, message: Any, mode: int) -> None:
        """Compare a state of a stamp [ns] in a mode: with a step from the one before, or alone."""
        values = DriveValues(*(getattr(message, name) for name in DriveValues._fields))
        status, mover = message.status, self._mover()
        self._note('command', self._command_difference(status, values.command))
        # the stamps are a step apart: no message between them is missing
        follows = 0.5 < (stamp - self._stamp) * 1e-9 / (values.step or inf) < 1.5
        known: DriveValues | None = values
        if self._before is not None and follows and self._has_our_integrator:
            expected_status, expected = mover.next(
                self._before, values.step, values.command, status == SILENT, self._mode)
            self._note('status', 0.0 if expected_status == status else inf)
            self._note('mode', 0.0 if mover.mode == mode else inf)
            self.stepped += 1
            if self._note_values(values, expected) == 0.0:
                known = expected     # next to a toggle the mover knows more than the message
        elif values.step and not mover.is_told_by_message(mover.state_of(values, mode)):
            self.unknown += 1
            known = None
        else:
            self.alone += 1
            mover = self._mover(mode)
            self._note_values(values, mover.values(
                mover.state_of(values), values.step, values.command, values.evaluations))
        self._before, self._mode, self._stamp = known, mode, stamp

    def _note_values(self, values: DriveValues, expected: DriveValues) -> float:
        apart = [distance(*pair) for pair in zip(values, expected)]
        for field, difference in zip(DriveValues._fields, apart):
            self._note(field, difference)
        return max(apart)

    def _command_difference(self, status: int, command: float) -> float:
        """Return |torque in effect - torque by the topic and its policy| [N m]; 0 if not known."""
        if self._scene.drive.source != TORQUE.name:
            return 0.0 if isnan(command) else inf
        has_zero = self._scene.drive.when_silent == 'zero'
        if status == SILENT and has_zero:
            return distance(command, 0.0)
        if self._torque is None:                         # sent before the bag began
            return 0.0
        torque = limited(self._torque, self._scene.drive.torque_limit)
        # At a limit or out of budget the status says that, though the topic may be silent too.
        may_be_silent = has_zero and status not in (OK, SILENT)
        return min(distance(command, torque),
                   distance(command, 0.0) if may_be_silent else inf)

    def _note(self, field: str, difference: float) -> None:
        self.largest[field] = max(self.largest.get(field, 0.0), difference)
