# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of the node: of given length, through toggles, from one DriveState message to the next.

A step is made in the input q, next to a toggle in the coordinate p that goes on there
(:mod:`.coordinate`). At its start p takes over if |dp/dq| > 2. Within the step the other
coordinate takes over where the one in use changes too slowly. At the end of the first step with
|dp/dq| <= 2, q takes over again. So q, its rate and the assembly mode tell the state of most
samples, as a message does, and a bag can be stepped again. Next to a toggle they hardly change;
the mover then keeps (p, dp/dt) for the values that it gave last.

In a coordinate a step of RODAS (:mod:`.rosenbrock`) goes over the whole length, or shorter steps
where its error is too large or a force table bends: stable whatever the stiffness, of bounded
work. The next state follows from the state alone.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain
from math import inf, isfinite, isnan, nan
from typing import NamedTuple

from fourbar_ros.dynamics import rosenbrock
from fourbar_ros.dynamics.coordinate import MotionCoordinate
from fourbar_ros.dynamics.rosenbrock import Linearization, SMALLEST, StateVector
from fourbar_ros.dynamics.sources import ConstantTorque, Drive, has_law
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import LARGEST_MODE, mode_number

KEY = 'integrator'         # key in a bag: the integrator of its motion
NAME = 'steps of the node, version 8'      # only the same version steps a bag again
# The same numbers as the STATUS_ constants of fourbar_msgs/DriveState (a test compares them).
OK, SILENT, OUT_OF_BUDGET, AT_LIMIT, NOT_FINITE = range(5)
STATUS_NAMES = ('ok', 'no torque comes', 'budget of the step used up', 'held at a limit',
                'held: not finite')
# evaluations of the equation of motion: at a state, of a step by RODAS, of one by implicit Euler
LINEARIZE, ATTEMPT, EULER = 1, 6, 1
LATE = 1e-4                          # share of a step by which a bend may be passed
SHORTEST, BISECTIONS = 1e-3, 40      # share of a step, in the search for a point of a table
NEAREST = 1e-9                       # distance beyond a point of a table, in the size of it
LEAST = 1.01 * SMALLEST              # of a step over the next one, where the budget is used up
DEEPEST, SHORTER = 50.0, 0.3         # lack of room after a step; else it becomes shorter
REFUSALS = FourBarError, ValueError, ArithmeticError


class CannotGoOn(FourBarError):
    """The mechanism cannot reach a state, or its equation of motion has no finite terms there."""


class FullState(NamedTuple):
    """The state of a system between steps, next to a toggle in the other coordinate."""

    coordinate: MotionCoordinate
    vector: StateVector    # in this coordinate
    mode: int              # assembly mode of the mechanism

    def at_rest(self) -> FullState:
        """Return the state at rest, nothing twisted, nothing summed up."""
        return self._replace(vector=StateVector(self.vector.position, 0.0, 0.0, 0.0, 0.0))


class Stepped(NamedTuple):
    """Result of a step."""

    state: FullState       # after it
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
    """Return the two assembly modes between which steps go through toggles, or () of no steps."""
    mechanism = mechanism.without_stroke()          # which would hide that the input turns fully
    if (mechanism.turns_fully or mechanism.has_direction        # it has no toggles, or ends there
            or not mechanism.driven_otherwise()):        # no other coordinate leads through them
        return ()
    modes: tuple[int, ...] = mechanism.modes_passed
    # a machine may pass more than two; and a mode must fit into the byte of a message
    return modes if len(modes) == 2 and max(modes) <= LARGEST_MODE else ()


def limited(torque: float, limit: float) -> float:
    """Return a torque that a topic asks for, cut to the limit of the scene; NaN: none."""
    return min(max(torque, -limit), limit)      # NaN is neither less nor more


class Mover:
    """Advances a drive and its linkage, from state to state or from message to message."""

    # tolerance: allowed error of one step, in the coordinate and the twist, and in speeds times
    # its length; budget: most evaluations of the equation of motion in a step; takes_commands: the
    # torque comes from a topic; acting: names of the links, and of the base, whose wrenches and
    # motion come from outside: unknown before act.

    def __init__(self, system: System, tolerance: float, budget: int,
                 takes_commands: bool = False, acting: Sequence[str] = ()) -> None:
        drive = system.drive or Drive(ConstantTorque())
        source = drive.source
        if not has_law(source):
            raise InvalidParameter('source', source, 'cannot drive steps: it must be a constant '
                                   'torque, a motor or a controller')
        self.system, self._takes_commands = system, takes_commands
        self._torque = getattr(source, source.command) if source.command else 0.0
        # between which it goes through toggles; () where it does not
        self.modes = modes_of(system.mechanism)
        self.passes = bool(self.modes)
        # {coordinate: (that which takes over where it falls with it, and where it grows), or ()}
        self.taking_over = (system.coordinates.prepare() if self.passes
                            else {system.coordinates.first: ()})
        # the first is the input in the mode of the system
        self.formulas = {coordinate: rosenbrock.StepFormulas(
            coordinate, drive, self.passes, tolerance, acting) for coordinate in self.taking_over}
        self._acting: dict[str, Sequence[float]] = {
            name: (nan,) * rosenbrock.count_of(name) for name in acting}
        self._outside = tuple(chain(*self._acting.values()))        # their numbers, in this order
        self.budget = budget - EULER - (LINEARIZE + EULER if self.passes else 0)
        self._evaluations = 0        # in this step
        # the last message and its state: mostly the next step begins there
        self._last: tuple[DriveValues, FullState] | None = None
        # the last state at which the equations were linearized
        self._linear: tuple[FullState, Linearization] | None = None
        # assembly mode of the values that it gave last; 0: a message cannot tell it
        self.mode = mode_number(system.mechanism.mode)
        self._has_shaft = drive.shaft is not None
        self._source_field = source.state_field if source.start else ''
        position, rate = system.start[:2]
        self.first = self.state_at(StateVector(
            position, rate, twist=0.0, motor_speed=rate if self._has_shaft else 0.0,
            source=source.start[0] if source.start else 0.0))

    def act(self, name: str, numbers: Sequence[float]) -> None:
        """Let the base move, or a wrench act on a link, from the next step on."""
        self._acting[name] = numbers
        self._outside, self._linear = tuple(chain(*self._acting.values())), None

    def prepare(self) -> None:
        """Make the functions of all coordinates now: it takes as long as thousands of steps."""
        for formulas in self.formulas.values():
            for function in (formulas.linearize, formulas.attempt, formulas.euler):
                assert function is not None

    # --- messages -------------------------------------------------------------------------------

    def start(self, command: float = 0.0) -> DriveValues:
        return self._told(self.first, 0.0, command, 0)

    def next(self, values: DriveValues, step: float, command: float = 0.0,
             is_silent: bool = False, mode: int | None = None) -> tuple[int, DriveValues]:
        """Return (status, values) a ``step`` [s] after some values."""
        # command: torque of the source [N m], if it comes from a topic; is_silent: it has not come
        # for long. mode: assembly mode of values from elsewhere, as a bag; None: that of the
        # system.
        state = (self._last[1] if self._last and values is self._last[0]
                 else self.state_of(values, mode))
        state, status, evaluations = self.advance(state, step, command)
        return (SILENT if status == OK and is_silent else status,
                self._told(state, step, command, evaluations))

    def _told(self, state: FullState, step: float, command: float, evaluations: int
              ) -> DriveValues:
        # the state is kept, as next to a toggle it tells more than its values
        self.mode = mode_number(state.mode)
        self._last = self.values(state, step, command, evaluations), state
        return self._last[0]

    def values(self, state: FullState, step: float, command: float, evaluations: float
               ) -> DriveValues:
        """Return the fields of a DriveState message for a state; NaN where a drive has none."""
        self._take(command)
        position, rate, twist, motor_speed, source = self.in_input(state)
        try:
            linear = self._linearized(state)
            acceleration, torque = linear.acceleration, linear.torque
            motor_torque = linear.motor_torque
        except CannotGoOn:             # the rounded input of a run through a toggle is beyond it
            acceleration = torque = motor_torque = nan
        return DriveValues(
            step, command if self._takes_commands else nan, position, rate, acceleration,
            twist=twist if self._has_shaft else nan,
            motor_position=position + twist if self._has_shaft else position,
            motor_velocity=motor_speed if self._has_shaft else rate,
            motor_torque=motor_torque, torque=torque,
            current=source if self._source_field == 'current' else nan,
            speed_error_integral=source if self._source_field == 'speed_error_integral' else nan,
            evaluations=float(evaluations))

    def state_of(self, values: DriveValues, mode: int | None = None) -> FullState:
        """Return the state that a message tells, in a mode; None: the mode of the system."""
        source = getattr(values, self._source_field) if self._source_field else 0.0
        twist, speed = (values.twist, values.motor_velocity) if self._has_shaft else (0.0, 0.0)
        source, twist = (0.0 if isnan(value) else value for value in (source, twist))
        return self.state_at(StateVector(values.position, values.velocity, twist, speed, source),
                             mode)

    # --- states ---------------------------------------------------------------------------------

    def state_at(self, vector: StateVector, mode: int | None = None) -> FullState:
        """Return a state of the input in a mode; None: the mode of the system."""
        mode = mode if mode in self.modes else int(self.system.mechanism.mode)
        return FullState(next(coordinate for coordinate in self.taking_over
                              if coordinate.is_input and coordinate.mode == mode), vector, mode)

    def is_told_by_message(self, state: FullState) -> bool:
        """Return whether a message with input, rate and mode suffices to know a state."""
        # Next to a toggle it does not: there the input hardly changes with the state, which the
        # mover keeps beside the message, and which nobody knows from a bag.
        if not self.passes:
            return True
        try:
            return state.coordinate.is_input and self._linearized(state).room >= 0.0
        except CannotGoOn:              # no motion goes on from this state
            return False

    def in_input(self, state: FullState) -> StateVector:
        """Return the state vector in the input."""
        if state.coordinate.is_input:
            return state.vector
        linear = self._linearized(state)
        return state.vector._replace(
            position=self.system.coordinates.continuous(linear.next_position),
            rate=linear.next_ratio * state.vector.rate)

    def _take(self, command: float) -> None:
        """Take a torque of the source [N m], where it comes from outside."""
        if self._takes_commands and command != self._torque:
            self._torque, self._linear = command, None

    def _linearized(self, state: FullState) -> Linearization:
        """Return the equations at a state, kept for the last one; raises CannotGoOn."""
        if self._linear is None or self._linear[0] != state:
            try:
                *fields, change, coefficients = self.formulas[state.coordinate].linearize(
                    *state.vector, self._torque, *self._outside)
            except REFUSALS:
                raise CannotGoOn from None
            self._linear = state, Linearization._make(
                (*fields, StateVector(*change), rosenbrock.Coefficients(*coefficients)))
        return self._linear[1]

    # --- steps ----------------------------------------------------------------------------------

    def advance(self, state: FullState, length: float, command: float = 0.0) -> Stepped:
        """Return the state after a step of a length [s]; at a limit or an overflow, at rest."""
        self._take(command)
        self._evaluations, limited = 0, self.system.has_limits
        if not (0.0 < length < inf and all(map(isfinite, (*state.vector, *self._outside)))):
            return Stepped(state.at_rest(), NOT_FINITE, 0)
        try:
            new, is_good = self._moved(state, length)
            status = OK if is_good else OUT_OF_BUDGET
            if not all(map(isfinite, new.vector)):
                status = NOT_FINITE
            elif limited and (           # at an end of the stroke, or at a toggle it cannot pass
                    self.system.distance_to_end(self.in_input(new).position) <= 0.0
                    or not self.passes and self._linearized(new).room <= 0.0):
                status = AT_LIMIT
        except REFUSALS:           # an input without a limit: a number was too large
            status = AT_LIMIT if limited else NOT_FINITE
        if status not in (OK, OUT_OF_BUDGET):
            new = state.at_rest()
        return Stepped(new, status, self._evaluations)

    def _moved(self, state: FullState, left: float) -> tuple[FullState, bool]:
        """Return the state after ``left`` seconds, and whether its error is within tolerance."""
        # in stretches, each in one coordinate, until no time is left
        if self.passes and state.coordinate.is_input and self._linearized(state).room < 0.0:
            state = self._handed_over(state)
        state, left, is_good = self._moved_in_one(state, left)
        while left > 0.0:
            if not self.passes:
                raise CannotGoOn
            state, left, is_stretch_good = self._moved_in_one(self._handed_over(state), left)
            if left > 0.0 and not (is_good or is_stretch_good):
                raise CannotGoOn                # neither coordinate can finish
            is_good = is_good and is_stretch_good
        if state.coordinate.is_input or not all(map(isfinite, state.vector)):
            return state, is_good
        in_input = self._handed_over(state)
        return (in_input if self.is_told_by_message(in_input)
                else state._replace(mode=in_input.mode)), is_good

    def _handed_over(self, state: FullState) -> FullState:
        """Return a state in the coordinate that takes over there."""
        # next_ratio: rate of the next coordinate over that of this one; taking_over: {coordinate:
        # the ones that follow where next_ratio is negative, positive}, if these are known
        linear = self._linearized(state)
        position, mode = linear.next_position, state.mode
        known = self.taking_over[state.coordinate]
        if known:
            where_it_falls, where_it_grows = known
            coordinate = where_it_grows if linear.next_ratio > 0.0 else where_it_falls
        else:
            coordinate = self.system.coordinates.taking_over(
                state.coordinate, state.vector.position, position, linear.next_ratio)
        # there is an input for each mode; another coordinate goes through toggles between them
        if coordinate.is_input:
            position, mode = self.system.coordinates.continuous(position), coordinate.mode
        return FullState(coordinate, state.vector._replace(
            position=position, rate=linear.next_ratio * state.vector.rate), mode)

    def _moved_in_one(self, state: FullState, left: float) -> tuple[FullState, float, bool]:
        """Return (state, time left, is_good) after ``left`` seconds or less in one coordinate."""
        # Time is left [s] where another coordinate has to take over. is_good: the error is within
        # the tolerance; if not and time is left, this coordinate cannot finish within the budget.
        # Steps that fail are made shorter; one that would pass a point of a force table ends
        # there.
        equation, linear = state.coordinate.equation, self._linearized(state)
        latest, h = LATE * left, left
        while left > 0.0:
            self._evaluations += LINEARIZE
            position, rate = state.vector.position, state.vector.rate
            excess = equation.make_excess(position) if equation.tables else None
            new = None
            while new is None:
                longest = min(h, left)
                h = min(longest, max(linear.to_bend, latest))  # not far beyond a bend
                if excess:
                    h = h * _share_to_table(excess, position, h * rate,
                                            0.5 * h * h * linear.change.rate)
                # a step that leaves time over needs what another one takes
                needed = ATTEMPT if h == left else ATTEMPT + LINEARIZE + ATTEMPT
                if self._evaluations + needed > self.budget:
                    return self._rest(state, linear, left)
                new, scale = self._attempted(state, linear, h, 1.0)
                if new is None:
                    h *= scale
            state, left, h = new, left - h, max(h * scale, longest)
            linear = self._linearized(state)
            if left > 0.0 and linear.room < 0.0:
                break
        return state, left, True

    def _rest(self, state: FullState, linear: Linearization, left: float
              ) -> tuple[FullState, float, bool]:
        """Return (state, time left, False) after all time left in one step, over the budget."""
        # It is one of RODAS if evaluations are left for it, else of implicit Euler. Both are
        # stable: the error is bounded, but above the tolerance.
        new = None
        if self._evaluations + ATTEMPT <= self.budget:
            new, _ = self._attempted(state, linear, left, LEAST)
        if new is None:
            self._evaluations += EULER
            new = self._regular(state, self.formulas[state.coordinate].euler(
                *state.vector, left, self._torque, *linear.change, *linear.coefficients,
                *self._outside))
        return (new, 0.0, False) if new else (state, left, False)

    def _attempted(self, state: FullState, linear: Linearization, h: float, least: float
                   ) -> tuple[FullState | None, float]:
        """Return the state after a step of RODAS of ``h`` seconds, and the next length over it."""
        # None where that is below least: the error is too large, or the step left the range of the
        # coordinate; it is to be made again, so much shorter.
        self._evaluations += ATTEMPT
        try:
            vector, scale = self.formulas[state.coordinate].attempt(
                *state.vector, h, self._torque, *linear.change, *linear.coefficients,
                *self._outside)
        except REFUSALS:
            if not self.system.has_limits:                      # a number was too large
                raise
            return None, SMALLEST                        # a shorter step may be inside
        if not scale >= least:
            return None, scale
        new = self._regular(state, vector)
        return new, scale if new else SHORTER

    def _regular(self, state: FullState, vector: Sequence[float]) -> FullState | None:
        new = FullState(state.coordinate, StateVector(*vector), state.mode)
        try:
            return new if self._linearized(new).room >= -DEEPEST else None
        except CannotGoOn:
            return None


def _share_to_table(excess: Callable[[float], float], position: float, gain: float, bend: float
                    ) -> float:
    """Return the share of a step, in (0, 1], after which a force table comes to its next piece."""
    # 1: it comes to none. excess: of Equation.make_excess; gain, bend: of the step, its length
    # times the rate, and half its square times the acceleration: after a share x of it the input
    # is position + x (gain + x bend). Out of reach counts as beyond.
    def is_beyond(share: float) -> bool:
        try:
            return excess(position + share * (gain + share * bend)) > NEAREST
        except REFUSALS:
            return True
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS if is_beyond(1.0) else 0):
        share = 0.5 * (low + high)
        low, high = (low, share) if is_beyond(share) else (share, high)
        if high - low <= SHORTEST * high:
            break
    return high if high < 1.0 - SHORTEST else 1.0
