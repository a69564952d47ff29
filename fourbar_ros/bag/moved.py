# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Check the motion that a node computed from torque.

Every DriveState is recomputed from the one before it, and the torque in effect from the messages
on its topic. If another version of the integrator made the bag, accelerations and torques are
recomputed from the states. Next to a toggle, input and rate do not determine the state. A
mover that came there by its own steps knows it; of a bag that begins there, the states up to the
first one past the toggle are not compared.
"""
from __future__ import annotations

from math import inf, isfinite, isnan

from fourbar_ros.bag.difference import apart
from fourbar_ros.bag.records import Columns
from fourbar_ros.dynamics.mover import DriveValues, Mover, OK, SILENT
from fourbar_ros.dynamics.steps import name_of
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import TORQUE
import numpy as np


class Moved:
    """
    Goes through the states of a drive as a mover does.

    Parameters
    ----------
    scene : Scene
    integrator : str
        What the bag says of it.

    Attributes
    ----------
    largest : dict
        {field: largest difference}.
    compared, alone : int
        States that were stepped again from the one before; those of which the accelerations and
        torques alone were: at a start, after a gap, of another integrator.
    unknown : int
        States next to a toggle near which the bag begins: not compared.

    """

    def __init__(self, scene: Scene, integrator: str) -> None:
        self.integrator = integrator
        self._steps = integrator == name_of(scene.linkage)
        self.largest: dict[str, float] = {}
        self.compared = self.alone = self.unknown = 0
        # values, mode, stamp [ns]; no values where they do not tell the state
        self._before: tuple[DriveValues | None, int, int] = (None, 0, 0)
        self._commands: list[tuple[int, float]] = []
        self._torque: float | None = None
        self.change(scene)

    def change(self, scene: Scene) -> None:
        """Take another scene; the state stays."""
        self._scene, self._mover = scene, scene.mover
        self._movers: dict[int, Mover] = {}

    def commands(self, columns: Columns) -> None:
        """Take messages of the torque topic."""
        wrench = columns.tree.wrench
        torques = (wrench.force.x if self._scene.linkage.is_driven_by_slide else wrench.torque.z)
        limit = self._scene.drive.torque_limit
        limit = inf if isnan(limit) else limit
        self._commands += [(place, min(max(torque, -limit), limit))
                           for place, torque in zip(columns.places.tolist(), torques.tolist())
                           if isfinite(torque)]

    def compare(self, columns: Columns) -> None:
        """Compare DriveStates, in order."""
        statuses = columns.records['status'].tolist()
        modes = columns.records['mode'].tolist()
        rows = np.stack([columns.records[name] for name in DriveValues._fields], axis=1)
        for place, stamp, status, mode, row in zip(columns.places.tolist(),
                                                   columns.headed.tolist(), statuses, modes,
                                                   rows.tolist()):
            self._one(place, stamp, status, mode, DriveValues(*row))

    def _in_mode(self, mode: int) -> Mover:
        """Return what gives accelerations and torques in a mode; of an unknown one the scene's."""
        if mode not in self._movers:
            self._movers[mode] = self._scene.mover_in(mode)
        return self._movers[mode]

    def _one(self, place: int, stamp: int, status: int, mode: int, values: DriveValues) -> None:
        while self._commands and self._commands[0][0] < place:
            self._torque = self._commands.pop(0)[1]
        self._note('command', self._command_apart(status, values.command))
        before, mode_before, at = self._before
        follows = before is not None and 0.5 < (stamp - at) * 1e-9 / (values.step or inf) < 1.5
        known: DriveValues | None = values
        if before is not None and follows and self._steps:
            expected, again = self._mover.next(before, values.step, values.command,
                                               status == SILENT, mode_before)
            self._note('status', 0.0 if expected == status else inf)
            self._note('mode', 0.0 if self._mover.mode == mode else inf)
            self.compared += 1
            if self._compared(values, again) == 0.0:
                known = again                            # of which the mover knows more
        elif self._steps and values.step and not self._mover.tells_all(values, mode):
            known = None
            self.unknown += 1
        else:
            mover = self._in_mode(mode)
            self._compared(values, mover.values(mover.state(values), values.step, values.command,
                                                values.evaluations))
            self.alone += 1
        self._before = known, mode, stamp

    def _compared(self, values: DriveValues, again: DriveValues) -> float:
        """Note the differences of values; return the largest."""
        found = {name: apart(there, computed)
                 for name, there, computed in zip(values._fields, values, again)}
        for name, value in found.items():
            self._note(name, value)
        return max(found.values())

    def _command_apart(self, status: int, command: float) -> float:
        """Return how far a torque in effect is from what the topic and its policy say."""
        if self._scene.drive.source != TORQUE.name:
            return 0.0 if isnan(command) else inf
        has_zero = self._scene.drive.when_silent == 'zero'
        if status == SILENT and has_zero:
            return apart(command, 0.0)
        if self._torque is None:                         # what came before the bag is not known
            return 0.0
        # held at a limit, or out of budget, it may be silent too
        return min(apart(command, self._torque),
                   apart(command, 0.0) if has_zero and status not in (OK, SILENT) else inf)

    def _note(self, field: str, value: float) -> None:
        self.largest[field] = max(self.largest.get(field, 0.0), value)
