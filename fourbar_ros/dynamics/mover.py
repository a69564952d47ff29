# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The state of a drive from one sample to the next, in the numbers of a DriveState message."""
from __future__ import annotations

from math import isnan, nan
from typing import NamedTuple

from fourbar_ros.dynamics.drives import DCMotor
from fourbar_ros.dynamics.step_equations import State
from fourbar_ros.dynamics.stepper import BUDGET, DONE, FAILED, LIMIT, Torques
from fourbar_ros.dynamics.steps import in_message, Place, Steps
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError

# The same numbers as the STATUS_ constants of fourbar_msgs/DriveState (a test compares them).
OK, SILENT, OUT_OF_BUDGET, AT_LIMIT, NOT_FINITE = range(5)
STATUS_NAMES = ('ok', 'no torque comes', 'budget of the step used up', 'held at a limit',
                'held: not finite')
_STATUS = {DONE: OK, BUDGET: OUT_OF_BUDGET, LIMIT: AT_LIMIT, FAILED: NOT_FINITE}


class DriveValues(NamedTuple):
    """Fields of a DriveState message, in its units; what a drive does not have is NaN."""

    step: float
    command: float
    position: float
    velocity: float
    acceleration: float
    twist: float
    motor_position: float
    motor_velocity: float
    motor_torque: float
    torque: float
    current: float
    speed_error_integral: float
    evaluations: float


class _Ahead(NamedTuple):
    """A step from values under a torque (None: of the motor), and what came of it."""

    start: DriveValues
    origin: Place
    step: float
    torque: float | None
    status: int
    values: DriveValues
    place: Place


class Mover:
    """
    Advances a drive and its linkage from one message to the next.

    The numbers of a message are all there is to know of the state: a bag can be stepped again.
    Only next to a toggle are they not, where :meth:`tells_all` says so; the mover then knows more
    of the values that it has given itself.

    Parameters
    ----------
    system : System
    tolerance, budget : float, int
        Those of a step, see :class:`~fourbar_ros.dynamics.stepper.OneStep`.
    takes_commands : bool
        The torque comes from a topic.

    Attributes
    ----------
    mode : int
        Assembly mode of the values that it gave last; 0: a message cannot tell it.

    """

    def __init__(self, system: System, tolerance: float, budget: int,
                 takes_commands: bool) -> None:
        self._steps, self._takes_commands = Steps(system, tolerance, budget), takes_commands
        self._ahead: _Ahead | None = None
        self.mode = in_message(system.mechanism.mode)
        drive = system.drive
        self._has_shaft = drive is not None and drive.shaft is not None
        source = drive.source if drive else None
        self._own = ('' if source is None or not source.start else
                     'current' if isinstance(source, DCMotor) else 'speed_error_integral')

    def prepare(self) -> None:
        """Make all that steps need; otherwise the first ones do, which takes them much longer."""
        self._steps.prepare()

    def start(self, command: float = 0.0) -> DriveValues:
        """Return the values at the start."""
        start = self._steps.start
        self.mode = in_message(start.mode)
        return self._values(start, 0.0, command, 0)

    def values(self, state: State, step: float, command: float, evaluations: float
               ) -> DriveValues:
        """Return the values of a state of the input in the mode of the system."""
        return self._values(self._steps.place(state), step, command, evaluations)

    def _values(self, place: Place, step: float, command: float, evaluations: float
                ) -> DriveValues:
        position, rate, twist, speed, own = self._steps.state_of_input(place)
        command = command if self._takes_commands else nan
        try:
            found = self._steps.torques(place, command if self._takes_commands else None)
        except FourBarError:           # the rounded input of a run through a toggle is beyond it
            found = Torques(nan, nan, nan)
        twist, speed = (twist, speed) if self._has_shaft else (nan, rate)
        return DriveValues(
            step, command, position, rate, found.acceleration, twist,
            position + twist if self._has_shaft else position, speed, found.of_motor,
            found.on_input, own if self._own == 'current' else nan,
            own if self._own == 'speed_error_integral' else nan, float(evaluations))

    def state(self, values: DriveValues) -> State:
        """Return the state that values stand for, also after a change of shaft or source."""
        own = getattr(values, self._own) if self._own else 0.0
        own = 0.0 if isnan(own) else own
        if not self._has_shaft:
            return values.position, values.velocity, 0.0, 0.0, own
        twist = 0.0 if isnan(values.twist) else values.twist
        return values.position, values.velocity, twist, values.motor_velocity, own

    def tells_all(self, values: DriveValues, mode: int) -> bool:
        """Return whether values and a mode tell the state, which next to a toggle they do not."""
        return self._steps.tells_all(self._steps.place(self.state(values), mode))

    def _place(self, values: DriveValues, mode: int | None) -> Place:
        """Return where values are: of own ones all that is known."""
        ahead = self._ahead
        if ahead is not None and values is ahead.values:
            return ahead.place
        if ahead is not None and values is ahead.start:
            return ahead.origin
        return self._steps.place(self.state(values), mode)

    def work_ahead(self, values: DriveValues, step: float, command: float = 0.0,
                   mode: int | None = None) -> _Ahead:
        """Make the next step if it is not made yet; :meth:`next` returns it if asked for it."""
        ahead, torque = self._ahead, command if self._takes_commands else None
        if (ahead is None or ahead.start is not values
                or (ahead.step, ahead.torque) != (step, torque)):
            origin = self._place(values, mode)
            place, status, evaluations = self._steps.advance(origin, step, torque)
            ahead = self._ahead = _Ahead(values, origin, step, torque, _STATUS[status],
                                         self._values(place, step, command, evaluations), place)
        return ahead

    def next(self, values: DriveValues, step: float, command: float = 0.0,
             is_silent: bool = False, mode: int | None = None) -> tuple[int, DriveValues]:
        """
        Return (status, values) after a time [s] under the torque of a topic, or of a motor.

        ``mode``: assembly mode of values that are not this mover's own; None: that of the system.
        """
        ahead = self.work_ahead(values, step, command, mode)
        self.mode = in_message(ahead.place.mode)
        return (SILENT if ahead.status == OK and is_silent else ahead.status), ahead.values
