# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of the node: of given length, through toggles, in numbers of DriveState messages."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain
from math import inf, isfinite, isnan, nan
from typing import NamedTuple

from fourbar_ros.dynamics.coordinate import MotionCoordinate
from fourbar_ros.dynamics.rosenbrock import (
    count_of,
    Place,
    SMALLEST,
    State,
    StepFormulas,
    TOLD,
)
from fourbar_ros.dynamics.sources import ConstantTorque, Drive, Law
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import LARGEST_MODE, mode_number

KEY = 'integrator'         # key in a bag: the integrator of its motion
NAME = 'steps of the node, version 6'      # only the same version steps a bag again
# The same numbers as the STATUS_ constants of fourbar_msgs/DriveState (a test compares them).
OK, SILENT, OUT_OF_BUDGET, AT_LIMIT, NOT_FINITE = range(5)
STATUS_NAMES = ('ok', 'no torque comes', 'budget of the step used up', 'held at a limit',
                'held: not finite')
# evaluations of the equation of motion: of a state, of a step by RODAS, of one by implicit Euler
PLACE, ATTEMPT, EULER = 1, 6, 1
LATE = 1e-2                          # part of a step by which a bend of a law may be passed
SHORTEST, BISECTIONS = 1e-3, 40      # part of a step, in the search for a place of a table
NEAREST = 1e-9                       # distance beyond a place, in the size of it
LEAST = 1.01 * SMALLEST              # of a step over the next one, where the budget is used up
DEEPEST, SHORTER = 50.0, 0.3         # lack of room after a step; else it becomes shorter
REFUSALS = FourBarError, ValueError, ArithmeticError
UNKNOWN = Place(nan, nan, nan, nan, nan, nan, nan, ())


class Refused(FourBarError):
    """The mechanism cannot reach a state, or its equation of motion has no finite terms there."""


class At(NamedTuple):
    """The full state of a system between steps, next to a toggle in the other coordinate."""

    coordinate: MotionCoordinate
    state: State           # in this coordinate
    mode: int              # assembly mode of the mechanism


Part = tuple[At, float, bool]        # state, time left, whether the error is within the tolerance


class Stepped(NamedTuple):
    """Result of a step."""

    at: At                 # after it
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

    A stroke is left out: it would hide that the input turns fully.
    """
    mechanism = mechanism.without_stroke()
    if mechanism.turns_fully:                            # it has no toggles
        return ()
    if mechanism.change_point_margin == 0.0:             # both modes meet at its change points too
        return ()
    if not mechanism.driven_otherwise():                 # no other coordinate leads through them
        return ()
    modes: tuple[int, ...] = mechanism.modes_passed
    # a machine may pass more than two; and a mode must fit into the byte of a message
    fits = len(modes) == 2 and max(modes) <= LARGEST_MODE
    return modes if fits else ()


class Mover:
    """
    Advances a drive and its linkage, from state to state or from message to message.

    A step is made in the input q, next to a toggle in the coordinate p that goes on there
    (:mod:`fourbar_ros.dynamics.coordinate`). At its start p takes over if |dp/dq| > 2. Within the
    step the other coordinate takes over where the one in use changes too slowly. At the end of the
    first step with |dp/dq| <= 2, q takes over again. So q, its rate and the assembly mode tell the
    state of most samples, as a message does, and a bag can be stepped again. Next to a toggle they
    hardly change (:meth:`tells_all` is false); the mover then keeps (p, dp/dt) for the values that
    it gave last.

    In a coordinate a step of RODAS (:mod:`fourbar_ros.dynamics.rosenbrock`) goes over the whole
    length, or shorter steps where its error is too large or a force table bends: stable whatever
    the stiffness, of bounded work. The next state follows from the state alone.

    ``tolerance``: allowed error of one step, in the coordinate and the twist, and in speeds times
    its length; ``budget``: most evaluations of the equation of motion in a step;
    ``takes_commands``: the torque comes from a topic; ``acting``: what acts from outside, names of
    links and of the base, unknown before :meth:`act`.
    """

    def __init__(self, system: System, tolerance: float, budget: int,
                 takes_commands: bool = False, acting: Sequence[str] = ()) -> None:
        drive = system.drive or Drive(ConstantTorque())
        source = drive.source
        if not isinstance(source, Law):
            raise InvalidParameter('source', source, 'cannot drive steps: it must be a constant '
                                   'torque, a motor or a controller')
        self.system, self._takes_commands = system, takes_commands
        self._torque = getattr(source, source.command) if source.command else 0.0
        # between which it goes through toggles; () where it does not
        self.modes = modes_of(system.mechanism)
        self.passes = bool(self.modes)
        # {coordinate: (one that takes over where it falls with it, one where it grows)}
        self.taking_over = (system.coordinates.prepare() if self.passes
                            else {system.coordinates.first: ()})
        # the first is the input in the mode of the system
        self.formulas = {coordinate: StepFormulas(coordinate, drive, self.passes, tolerance,
                                                  acting) for coordinate in self.taking_over}
        self._acting: dict[str, Sequence[float]] = {name: (nan,) * count_of(name)
                                                    for name in acting}
        self._outside = tuple(chain(*self._acting.values()))        # their numbers, in this order
        self.budget = budget - EULER - (PLACE + EULER if self.passes else 0)
        self._evaluations = 0        # in this step
        # the last message and its state: mostly the next step begins there; what is known of it
        self._last: tuple[DriveValues, At] | None = None
        self._known: tuple[At, Place] | None = None
        # assembly mode of the values that it gave last; 0: a message cannot tell it
        self.mode = mode_number(system.mechanism.mode)
        self._has_shaft = drive.shaft is not None
        self._own = source.own if source.start else ''
        own = source.start[0] if source.start else 0.0
        position, rate = system.start[:2]
        self.first = self.at((position, rate, 0.0, rate if self._has_shaft else 0.0, own))

    def act(self, name: str, what: Sequence[float]) -> None:
        """Let the base move, or a wrench act on a link, so from the next step on."""
        self._acting[name] = what
        self._outside, self._known = tuple(chain(*self._acting.values())), None

    def prepare(self) -> None:
        """Make the functions of all coordinates now: it takes as long as thousands of steps."""
        for formulas in self.formulas.values():
            for function in (formulas.place, formulas.attempt, formulas.euler):
                assert function is not None

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
        at = (self._last[1] if self._last and values is self._last[0]
              else self.at(self.state(values), mode))
        at, status, evaluations = self.advance(at, step, command)
        return (SILENT if status == OK and is_silent else status,
                self._kept(at, step, command, evaluations))

    def values(self, at: At, step: float, command: float, evaluations: float) -> DriveValues:
        """Return the fields of a DriveState message for a state; NaN where a drive has none."""
        self._take(command)
        position, rate, twist, speed, own = self.state_of_input(at)
        try:
            place = self._place(at)
        except Refused:                # the rounded input of a run through a toggle is beyond it
            place = UNKNOWN
        twist, speed = (twist, speed) if self._has_shaft else (nan, rate)
        return DriveValues(
            step, command if self._takes_commands else nan, position, rate, place.acceleration,
            twist, position + twist if self._has_shaft else position, speed, place.of_motor,
            place.on_input, own if self._own == 'current' else nan,
            own if self._own == 'speed_error_integral' else nan, float(evaluations))

    def state(self, values: DriveValues) -> State:
        """Return the state of the input in a message; a part that it lacks, as NaN, is zero."""
        own = getattr(values, self._own) if self._own else 0.0
        own = 0.0 if isnan(own) else own
        if not self._has_shaft:
            return values.position, values.velocity, 0.0, 0.0, own
        twist = 0.0 if isnan(values.twist) else values.twist
        return values.position, values.velocity, twist, values.motor_velocity, own

    def _kept(self, at: At, step: float, command: float, evaluations: int) -> DriveValues:
        """Return the values of a state, and keep it: next to a toggle it tells more."""
        self.mode = mode_number(at.mode)
        values = self.values(at, step, command, evaluations)
        self._last = values, at
        return values

    # --- states ---------------------------------------------------------------------------------

    def at(self, state: State, mode: int | None = None) -> At:
        """Return a state of the input in a mode; None: the mode of the system."""
        mode = mode if mode in self.modes else int(self.system.mechanism.mode)
        coordinate = next(one for one in self.taking_over if one.is_input and one.mode == mode)
        return At(coordinate, state, mode)

    def tells_all(self, at: At) -> bool:
        """
        Return whether a message with input, rate and mode tells a state, as it mostly does.

        Next to a toggle it does not: there the input hardly changes with the state.
        """
        if not self.passes:
            return True
        try:
            return at.coordinate.is_input and self._place(at).room >= 0.0
        except Refused:
            return False

    def state_of_input(self, at: At) -> State:
        """Return a state in the input."""
        if at.coordinate.is_input:
            return at.state
        place, (_, rate, *others) = self._place(at), at.state
        return (self.system.coordinates.continuous(place.other), place.other_ratio * rate,
                *others)

    def _take(self, command: float) -> None:
        """Take a torque of the source [N m], where it comes from outside."""
        if self._takes_commands and command != self._torque:
            self._torque, self._known = command, None

    def _place(self, at: At) -> Place:
        """Return what is known of a state; the last one is kept, as values ask for it again."""
        if self._known is None or self._known[0] != at:
            try:
                found = self.formulas[at.coordinate].place(*at.state, self._torque,
                                                           *self._outside)
            except REFUSALS:
                raise Refused from None
            self._known = at, Place._make((*found[:TOLD], found[TOLD:]))
        return self._known[1]

    # --- steps ----------------------------------------------------------------------------------

    def advance(self, at: At, length: float, command: float = 0.0) -> Stepped:
        """
        Return the state after a step of a length [s]; at a limit or an overflow, the same at rest.

        ``command``: torque of the source during the step [N m], where it takes commands.
        """
        self._take(command)
        self._evaluations, limited = 0, not self.system.mechanism.turns_fully
        held = at._replace(state=(at.state[0], 0.0, 0.0, 0.0, 0.0))
        if not (0.0 < length < inf and all(map(isfinite, (*at.state, *self._outside)))):
            return Stepped(held, NOT_FINITE, 0)
        try:
            new, is_good = self._moved(at, length)
            status = OK if is_good else OUT_OF_BUDGET
            if not all(map(isfinite, new.state)):
                status = NOT_FINITE
            elif limited and self._is_at_end(new):
                status = AT_LIMIT
        except REFUSALS:           # an input that turns fully has no limit: a number was too large
            status = AT_LIMIT if limited else NOT_FINITE
        return Stepped(new if status in (OK, OUT_OF_BUDGET) else held, status, self._evaluations)

    def _is_at_end(self, at: At) -> bool:
        """Return whether the input is at an end of its stroke, or at a toggle it cannot pass."""
        return (self.system.distance_to_end(self.state_of_input(at)[0]) <= 0.0
                or not self.passes and self._place(at).room <= 0.0)

    def _moved(self, at: At, left: float) -> tuple[At, bool]:
        """
        Return the state after ``left`` seconds, and whether its error is within the tolerance.

        The step is made in parts, each in one coordinate, until no time is left.
        """
        if self.passes and at.coordinate.is_input and self._place(at).room < 0.0:
            at = self._handed_over(at)
        at, left, is_good = self._part(at, left)
        while left > 0.0:
            if not self.passes:
                raise Refused
            at, left, is_part_good = self._part(self._handed_over(at), left)
            if left > 0.0 and not (is_good or is_part_good):
                raise Refused                   # neither coordinate can finish
            is_good = is_good and is_part_good
        if at.coordinate.is_input or not all(map(isfinite, at.state)):
            return at, is_good
        in_input = self._handed_over(at)
        return (in_input if self.tells_all(in_input) else at._replace(mode=in_input.mode)), is_good

    def _handed_over(self, at: At) -> At:
        """Return the same state in the coordinate that takes over; its mode by dq/dp."""
        place, (_, rate, *others) = self._place(at), at.state
        coordinate = self.taking_over[at.coordinate][place.other_ratio > 0.0]
        other, mode = place.other, at.mode
        if coordinate.is_input:
            other, mode = self.system.coordinates.continuous(other), coordinate.mode
        return At(coordinate, (other, place.other_ratio * rate, *others), mode)

    def _part(self, at: At, left: float) -> tuple[At, float, bool]:
        """
        Return (state, time left, is_good) after ``left`` seconds, or after a part of them.

        Time is left [s] where another coordinate has to take over. ``is_good``: the error is
        within the tolerance; if not and time is left, this coordinate cannot finish within the
        budget. Steps that fail are made shorter; one that would pass a place of a force table ends
        there. Where the budget is used up, all that is left is one step of RODAS, or else of
        implicit Euler: stable, its error bounded.
        """
        formulas, equation = self.formulas[at.coordinate], at.coordinate.equation
        place, latest, h = self._place(at), LATE * left, left
        while left > 0.0:
            self._evaluations += PLACE
            excess = equation.make_excess(at.state[0]) if equation.tables else None
            new = None
            while new is None:
                longest = min(h, left)
                h = min(longest, max(place.to_bend, latest))   # not far beyond a bend of the law
                if excess:
                    h = h * _to_table(excess, at.state[0], h * at.state[1],
                                      0.5 * h * h * place.linear[1])
                # a step that leaves time over needs what another one takes
                needed = ATTEMPT if h == left else ATTEMPT + PLACE + ATTEMPT
                if self._evaluations + needed > self.budget:
                    return self._rest(formulas, at, place, left)
                new, scale = self._attempted(formulas, at, place, h, 1.0)
                if new is None:
                    h *= scale
            at, left, h = new, left - h, max(h * scale, longest)
            place = self._place(at)
            if left > 0.0 and place.room < 0.0:
                break
        return at, left, True

    def _attempted(self, formulas: StepFormulas, at: At, place: Place, h: float, least: float
                   ) -> tuple[At | None, float]:
        """
        Return the state after a step of RODAS of ``h`` seconds, and the next length over it.

        None where that is below ``least``: the error is too large, or the step left the range of
        the coordinate; it is to be made again, so much shorter.
        """
        self._evaluations += ATTEMPT
        try:
            *state, scale = formulas.attempt(*at.state, h, self._torque, *place.linear,
                                             *self._outside)
        except REFUSALS:
            if self.system.mechanism.turns_fully:               # a number was too large
                raise
            return None, SMALLEST                        # a shorter step may be inside
        if not scale >= least:
            return None, scale
        new = self._here(at, state)
        return new, scale if new else SHORTER

    def _here(self, at: At, state: Sequence[float]) -> At | None:
        """Return a state after another one, None where its coordinate is not regular."""
        new = at._replace(state=tuple(state))
        try:
            return new if self._place(new).room >= -DEEPEST else None
        except Refused:
            return None

    def _rest(self, formulas: StepFormulas, at: At, place: Place, left: float) -> Part:
        """
        Return the state after all the time left in one step, as the budget is used up.

        It is one of RODAS if evaluations are left for it, else of implicit Euler. Both are stable:
        the error is bounded, but above the tolerance.
        """
        new = None
        if self._evaluations + ATTEMPT <= self.budget:
            new, _ = self._attempted(formulas, at, place, left, LEAST)
        if new is None:
            self._evaluations += EULER
            new = self._here(at, formulas.euler(*at.state, left, self._torque, *place.linear,
                                                *self._outside))
        return (new, 0.0, False) if new else (at, left, False)


def _to_table(excess: Callable[[float], float], position: float, gain: float, bend: float
              ) -> float:
    """
    Return the part of a step, in (0, 1], after which a force table comes to its next piece.

    1: it comes to none. The position is quadratic: after a part x of the step it is
    ``position`` + x (gain + x bend); out of reach counts as beyond.
    """
    def is_beyond(part: float) -> bool:
        try:
            return excess(position + part * (gain + part * bend)) > NEAREST
        except REFUSALS:
            return True
    if not is_beyond(1.0):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        part = 0.5 * (low + high)
        if is_beyond(part):
            high = part
        else:
            low = part
        if high - low <= SHORTEST * high:
            break
    return high if high < 1.0 - SHORTEST else 1.0
