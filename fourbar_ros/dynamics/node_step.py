# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of given length through the toggle positions of the input, in numbers of DriveState messages.

A step is made in the input q, near a toggle in the other coordinate p of the phases of
:mod:`fourbar_ros.dynamics.coordinate`. At its start p takes over if |dp/dq| > 2. Within the step
the other coordinate takes over where the one in use changes too slowly. At the end of the first
step with |dp/dq| <= 2, q takes over again. So q, its rate and the assembly mode tell the state of
most samples. Next to a toggle they hardly change: there (p, dp/dt) is the state.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, isnan, nan, tau
from typing import NamedTuple

from fourbar_ros.dynamics.coordinate import Phase
from fourbar_ros.dynamics.elements import Element, PositionForce
from fourbar_ros.dynamics.force_table import ForceTable
from fourbar_ros.dynamics.phase_steps import PhaseSteps
from fourbar_ros.dynamics.sources import Law, Source, SpeedController
from fourbar_ros.dynamics.step_equations import State
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import Mechanism

KEY = 'integrator'         # key in a bag: the integrator of its motion
# Only the same version steps a bag again. Versions differ where the input has toggles, for force
# tables, which steps once passed over, and for controllers, whose integral once stopped where the
# torque was at its limit.
NAME, NAME_WITH_TOGGLES, NAME_WITH_TABLES, NAME_WITH_CONTROLLER = (
    f'steps of the node, version {number}' for number in (1, 2, 4, 5))
LARGEST_MODE = 255         # in a message
# The same numbers as the STATUS_ constants of fourbar_msgs/DriveState (a test compares them).
OK, SILENT, OUT_OF_BUDGET, AT_LIMIT, NOT_FINITE = range(5)
STATUS_NAMES = ('ok', 'no torque comes', 'budget of the step used up', 'held at a limit',
                'held: not finite')


class Place(NamedTuple):
    """The full state of a system between steps, next to a toggle in the other coordinate."""

    phase: Phase
    state: State           # in the coordinate of the phase
    mode: int              # assembly mode of the mechanism
    rising: int            # mode in which the input grows with the coordinate
    turns: float           # of the input beyond the range of the course [rad]


class Stepped(NamedTuple):
    """Result of a step."""

    place: Place           # after it
    status: int            # OK, OUT_OF_BUDGET, AT_LIMIT or NOT_FINITE
    evaluations: int       # of the equation of motion


class DriveValues(NamedTuple):
    """Fields of a DriveState message, in its units; NaN where a drive has none."""

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


def modes_of(mechanism: Mechanism) -> tuple[int, ...]:
    """
    Return the two assembly modes between which steps go through toggles, or () where they do not.

    They do not if the input has no toggles, or no other coordinate leads through them, at an exact
    change point, or if the modes do not fit into a message.
    """
    mechanism = mechanism.without_stroke()
    if mechanism.turns_fully or mechanism.change_point_margin == 0.0:
        return ()
    modes: tuple[int, ...] = mechanism.modes_passed
    passes = (len(modes) == 2 and max(modes) <= LARGEST_MODE
              and bool(mechanism.driven_otherwise()))
    return modes if passes else ()


def in_message(mode: int) -> int:
    """Return a mode as the uint8 of a message; 0 if it does not fit."""
    return int(mode) if mode <= LARGEST_MODE else 0


def name_of(mechanism: Mechanism, source: Source | None = None,
            elements: Sequence[Element] = ()) -> str:
    """
    Return the name of the integrator that a bag records.

    A recomputation steps a bag again only if it bears the name of its own steps.
    """
    if isinstance(source, SpeedController):
        return NAME_WITH_CONTROLLER
    if any(isinstance(e, PositionForce) and isinstance(e.value, ForceTable) for e in elements):
        return NAME_WITH_TABLES
    return NAME_WITH_TOGGLES if modes_of(mechanism) else NAME


class Mover:
    """
    Advances a drive and its linkage, from place to place or from message to message.

    A DriveState message holds the whole state, so a bag can be stepped again. Next to a toggle it
    does not (:meth:`tells_all` is false); the mover then keeps the rest for the values that it
    gave last.

    ``tolerance``: allowed error of one step, in the coordinate and the twist, and in speeds times
    its length. ``budget``: most evaluations of the equation of motion in one step.
    ``takes_commands``: the torque comes from a topic. ``mode``: assembly mode of the values that
    it gave last; 0: a message cannot tell it. ``passes``: whether it goes through toggles.
    """

    def __init__(self, system: System, tolerance: float, budget: int,
                 takes_commands: bool = False) -> None:
        """Set up steps within ``tolerance``, of at most ``budget`` evaluations each."""
        self._system, self._given = system, (system, tolerance, budget)
        self._takes_commands = takes_commands
        self._modes = modes_of(system.mechanism)
        self.passes = bool(self._modes)
        self._phases: dict[Phase, PhaseSteps] = {}               # the steps of each coordinate
        # the last message and its place: mostly the next step begins there
        self._last: tuple[DriveValues, Place] | None = None
        self._spent = 0            # evaluations in this step
        self.mode = in_message(system.mechanism.mode)
        drive = system.drive
        self._has_shaft = drive is not None and drive.shaft is not None
        source = drive.source if drive else None
        self._own = source.own if isinstance(source, Law) and source.start else ''

    def prepare(self) -> None:
        """Make the functions of all phases now: it takes as long as thousands of steps."""
        phases = self._system.course.prepare() if self.passes else [self._system.course.first]
        for phase in phases:
            self._steps(phase)

    # --- messages -------------------------------------------------------------------------------

    def start(self, command: float = 0.0) -> DriveValues:
        """Return the values at the start."""
        return self._kept(self.first, 0.0, command, 0)

    def next(self, values: DriveValues, step: float, command: float = 0.0,
             is_silent: bool = False, mode: int | None = None) -> tuple[int, DriveValues]:
        """
        Return (status, values) a ``step`` [s] after some values.

        ``command``: torque of the source [N m], if it comes from a topic; ``is_silent``: it has
        not come for long. ``mode``: assembly mode of values from elsewhere, as a bag; None: that
        of the system.
        """
        place = (self._last[1] if self._last and values is self._last[0]
                 else self.place(self.state(values), mode))
        place, status, evaluations = self.advance(place, step, self._torque(command))
        return (SILENT if status == OK and is_silent else status,
                self._kept(place, step, command, evaluations))

    def values(self, place: Place, step: float, command: float, evaluations: float) -> DriveValues:
        """Return the fields of a DriveState message for a place; NaN where a drive has none."""
        position, rate, twist, speed, own = self.state_of_input(place)
        try:
            acceleration, on_input, of_motor = self._steps(place.phase).torques(
                place.state, self._torque(command))
        except FourBarError:           # the rounded input of a run through a toggle is beyond it
            acceleration, on_input, of_motor = nan, nan, nan
        twist, speed = (twist, speed) if self._has_shaft else (nan, rate)
        return DriveValues(
            step, command if self._takes_commands else nan, position, rate, acceleration, twist,
            position + twist if self._has_shaft else position, speed, of_motor, on_input,
            own if self._own == 'current' else nan,
            own if self._own == 'speed_error_integral' else nan, float(evaluations))

    def state(self, values: DriveValues) -> State:
        """Return the state of the input in a message; a part that it lacks, as NaN, is zero."""
        own = getattr(values, self._own) if self._own else 0.0
        own = 0.0 if isnan(own) else own
        if not self._has_shaft:
            return values.position, values.velocity, 0.0, 0.0, own
        twist = 0.0 if isnan(values.twist) else values.twist
        return values.position, values.velocity, twist, values.motor_velocity, own

    def _kept(self, place: Place, step: float, command: float, evaluations: int) -> DriveValues:
        """Return the values of a place, and keep the place: next to a toggle it tells more."""
        self.mode = in_message(place.mode)
        values = self.values(place, step, command, evaluations)
        self._last = values, place
        return values

    def _torque(self, command: float) -> float | None:
        return command if self._takes_commands else None

    # --- places ---------------------------------------------------------------------------------

    @property
    def first(self) -> Place:
        """Return the place at the start."""
        return self.place(self._steps(self._system.course.first).start)

    def place(self, state: State, mode: int | None = None) -> Place:
        """Return the place of a state of the input in a mode; None: the mode of the system."""
        own, course = int(self._system.mechanism.mode), self._system.course
        if mode is None or mode == own or mode not in self._modes:
            return Place(course.first, state, own, own, 0.0)
        return Place(course.input_in(mode), state, mode, mode, 0.0)

    def tells_all(self, place: Place) -> bool:
        """
        Return whether a message with input, rate and mode tells the place, as it mostly does.

        Next to a toggle it does not: there the input hardly changes with the state.
        """
        if not self.passes:
            return True
        try:
            return place.phase.is_input and place.phase.excess(0.0, place.state) <= 0.0
        except FourBarError:
            return False

    def state_of_input(self, place: Place) -> State:
        """Return the state of a place in the input, turns of a crank counted on."""
        if place.phase.is_input:
            return place.state
        p, rate, twist, speed, own = place.state
        value, ratio, _ = place.phase.input_of(p)
        return value + place.turns, ratio * rate, twist, speed, own

    def advance(self, place: Place, length: float, command: float | None = None) -> Stepped:
        """
        Return the place after a step of a length [s]; at a limit or an overflow, the same at rest.

        ``command``: torque of the source during the step [N m], in place of the drive's own law.
        """
        self._spent = 0
        if not (0.0 < length < inf and all(map(isfinite, place.state))):
            return Stepped(_held(place), NOT_FINITE, 0)
        try:
            new, is_good = self._passed(place, length, command)
        except (FourBarError, ArithmeticError) as error:
            # an input that turns fully has no limit: a number was too large
            is_limit = isinstance(error, FourBarError) and not self._system.has_no_limits
            return Stepped(_held(place), AT_LIMIT if is_limit else NOT_FINITE,
                           self._spent if self.passes
                           else self._steps(place.phase).evaluations)
        if not all(map(isfinite, new.state)):
            return Stepped(_held(place), NOT_FINITE, self._spent)
        if self._is_at_limit(new):
            return Stepped(_held(place), AT_LIMIT, self._spent)
        return Stepped(new, OK if is_good else OUT_OF_BUDGET, self._spent)

    def _is_at_limit(self, place: Place) -> bool:
        """Return whether the input is at an end of its stroke, or at a toggle it cannot pass."""
        if self.passes:
            return self._system.distance_to_end(self.state_of_input(place)[0]) <= 0.0
        return (not self._system.has_no_limits
                and self._system.distance_to_limit(place.state[0]) <= 0.0)

    def _steps(self, phase: Phase) -> PhaseSteps:
        """Return the steps in the coordinate of a phase, made when first needed."""
        steps = self._phases.get(phase)
        if steps is None:
            steps = self._phases[phase] = PhaseSteps(*self._given, phase if self.passes else None)
        return steps

    def _passed(self, place: Place, left: float, command: float | None) -> tuple[Place, bool]:
        """
        Return the place after ``left`` seconds, and whether its error is within the tolerance.

        The step is made in parts, each in one coordinate, until no time is left. A second part in
        a row that is not good means that no coordinate can finish: FourBarError.
        """
        if self.passes and place.phase.is_input and not self.tells_all(place):
            place = self._next(place)
        steps = self._steps(place.phase)
        is_good, law = True, steps.law(command)
        while True:
            steps.evaluations = self._spent
            state, left, is_part_good = steps.part(place.state, left, law)
            place, self._spent = place._replace(state=state), steps.evaluations
            if not left:
                return self._settled(place), is_good and is_part_good
            if not (is_good or is_part_good):
                raise FourBarError('no coordinate finishes this step')
            is_good = is_good and is_part_good
            place = self._next(place)
            steps = self._steps(place.phase)

    def _next(self, place: Place) -> Place:
        """Return the same place in the coordinate that takes over from its own."""
        if not place.phase.is_input:
            return self._in_input(place)
        course, q = self._system.course, place.state[0]
        turns = tau * round((q - course.continuous(q)) / tau)
        phase, state = place.phase.next(place.state)
        grows = phase.input_of(state[0])[1] > 0.0
        rising = place.mode if grows else self._partner(place.mode)
        p, rate, twist, speed, own = state
        return Place(phase, (p, rate, twist, speed, own), place.mode, rising, turns)

    def _in_input(self, place: Place) -> Place:
        """
        Return a place in the other coordinate as one in the input.

        Its assembly mode follows from the sign of dq/dp: it is ``rising`` where q grows with p.
        """
        grows = place.phase.input_of(place.state[0])[1] > 0.0
        mode = place.rising if grows else self._partner(place.rising)
        return self.place(self.state_of_input(place), mode)

    def _settled(self, place: Place) -> Place:
        """Return a place at the end of a step: in the input again, if a message can tell that."""
        if place.phase.is_input:
            return place
        in_input = self._in_input(place)
        return in_input if self.tells_all(in_input) else place._replace(mode=in_input.mode)

    def _partner(self, mode: int) -> int:
        return self._modes[self._modes[0] == mode]


def _held(place: Place) -> Place:
    """Return a place at rest, nothing twisted, nothing summed up."""
    return place._replace(state=(place.state[0], 0.0, 0.0, 0.0, 0.0))
