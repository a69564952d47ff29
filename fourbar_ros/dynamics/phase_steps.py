# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of given length in one coordinate: stable whatever the stiffness, of bounded work.

A Rosenbrock method (:mod:`fourbar_ros.dynamics.rosenbrock`) takes one step over the whole
length, or shorter steps if its error is too large. The Jacobian of (N1), see
:mod:`fourbar_ros.dynamics.step_equations`, is exact, except for the derivative of the
acceleration by the coordinate, a finite difference. The next state follows from the state alone,
so a state read from a bag gives the same. The terms at the last position are kept only to save
time. :mod:`fourbar_ros.dynamics.node_step` goes from one coordinate to the other at toggles.
"""
from __future__ import annotations

from collections.abc import Callable
from math import isfinite, nan

from fourbar_ros.dynamics.coordinate import Phase
from fourbar_ros.dynamics.rosenbrock import EVALUATIONS, Rosenbrock
from fourbar_ros.dynamics.sources import always, ConstantTorque, Drive, Law, MakePiece, Piece
from fourbar_ros.dynamics.step_equations import Elastic, plus, Rigid, State, Terms
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter

DIFFERENCE = 1e-7          # step of the coordinate for the column of the Jacobian, in its unit
SMALLEST, LARGEST, SAFETY = 0.1, 4.0, 0.85      # next step over this one: bounds, factor
SHORTEST, BISECTIONS = 1e-3, 40      # part of a step, in the search for a place of a table
LATE = 1e-2                          # part by which another piece of the source's law may be late
NEAREST = 1e-9                       # distance beyond a place, in the size of it
CLOSEST = 1e-6                       # through toggles: part that a place may be off
DEEPEST, SHORTER = 50.0, 0.3         # excess of a phase after a step; else it becomes shorter
RESERVE = 2                          # evaluations with which another coordinate finishes a step
Part = tuple[State, float, bool]     # result of :meth:`PhaseSteps.part`


class PhaseSteps:
    """
    Steps of a system in one coordinate.

    ``tolerance``, ``budget``: as of :class:`~fourbar_ros.dynamics.node_step.Mover`. ``phase``:
    its coordinate and assembly mode; a part of a step then ends where another one takes over.
    None: the input in the mode of the system, up to its limits. ``evaluations``: of the equation
    of motion; to be set to zero where a step begins.
    """

    def __init__(self, system: System, tolerance: float, budget: int,
                 phase: Phase | None = None) -> None:
        """Make the terms, the law of the source and the Rosenbrock step of one coordinate."""
        self._system, self._phase, self.evaluations = system, phase, 0
        self._budget = budget - RESERVE if phase else budget
        self._equation = equation = phase.equation if phase else system.equation
        self._terms, self._unit = equation.of_one_with_ratio, equation.coordinate.input_unit
        self._tolerance = tolerance * self._unit
        self._drive = system.drive or Drive(ConstantTorque())
        if not isinstance(self._drive.source, Law):
            raise InvalidParameter('source', self._drive.source, 'cannot drive steps: it must be '
                                   'a constant torque, a motor or a controller')
        self._law, self._is_smooth = self._drive.source.make_piece(), self._drive.source.is_smooth
        shaft, rotor = self._drive.shaft, self._drive.rotor
        self._motor = 3 if shaft else 1            # place of the speed behind the gear
        self._is_input = equation.is_input
        self._equations: Elastic | Rigid = Elastic(shaft, rotor) if shaft else Rigid()
        self._attempt = Rosenbrock(equation, self._equations, self._drive.source)
        self._known: tuple[float, Terms] = (nan, (nan,) * 7)      # the last position, terms there

    @property
    def start(self) -> State:
        """Return the state at the start: the motor turns with the input, nothing is twisted."""
        position, rate = self._system.start[:2]
        own = self._drive.source.start
        return (position, rate, 0.0, rate if self._drive.shaft else 0.0, own[0] if own else 0.0)

    def torques(self, state: State, command: float | None = None) -> tuple[float, float, float]:
        """
        Return the acceleration of the input, and the torques on the input and of the motor.

        ``command``: torque of the source, in place of that of the drive.
        """
        speed, own = self._speed(state), state[4]
        piece = self.law(command)(speed, own)
        terms = self._terms_at(state[0])
        change = self._equations.derivative(terms, state, piece)
        return (self._slope(terms, state, change), self._equations.on_input(terms, state, piece),
                piece.torque_at(speed, own))

    def part(self, state: State, left: float, law: MakePiece) -> Part:
        """
        Return (state, time left, is_good) after ``left`` seconds, or after a part of them.

        Time is left [s] where another coordinate has to take over. ``is_good``: the error is
        within the tolerance; if not and time is left, this coordinate cannot finish within the
        budget. ``law``: of the source, by :meth:`law`. Steps that fail are made shorter; one that
        passes a place of a force table ends there. Raises FourBarError and ArithmeticError.
        """
        h, closest, longest = left, CLOSEST * left if self._phase else 0.0, 0.0
        shortest = LATE * left
        while left > 0.0:
            piece = law(self._speed(state), state[4])
            terms, change, by_position = self._linear(state, piece)
            excess = self._equation.make_excess(state[0]) if self._equation.tables else None
            while True:
                h = min(h, left)
                if excess:
                    longest, h = h, h * _to_place(excess, state[0], h * state[1])
                more = 0 if h == left else 2 + EVALUATIONS
                if self.evaluations + EVALUATIONS + more > self._budget:
                    return self._rest(state, left, piece, terms, change, by_position)
                new, scale = self._try(state, h, terms, by_position, piece)
                if scale >= 1.0:
                    part = (self._to_change(law, piece, state, new,
                                            h * self._gain(terms, state, change))
                            if h > shortest else 1.0)
                    if excess:
                        part = min(part, _to_place(excess, state[0], h * state[1],
                                                   new[0] - state[0] - h * state[1]))
                    if part == 1.0 or h <= closest:
                        break
                    scale = max(part, closest / h)
                h *= scale
            state, left, h = new, left - h, max(h * scale, longest)
            if self._phase and left > 0.0 and self._phase.excess(0.0, state) > 0.0:
                break
        return state, left, True

    def law(self, command: float | None) -> MakePiece:
        """Return the law of the source during a step: its own, or a commanded torque [N m]."""
        return self._law if command is None else always(Piece(command))

    # --- one step, or as many as the tolerance asks for -----------------------------------------

    def _speed(self, state: State) -> float:
        """Return the speed of the motor behind the gear [rad/s], [m/s]."""
        if self._is_input or self._motor == 3:
            return state[self._motor]
        *_, ratio, _ = self._terms_at(state[0])
        return ratio * state[1]

    def _slope(self, terms: Terms, state: State, change: State) -> float:
        """Return the acceleration of the input, (T3)."""
        if self._is_input:
            return change[1]
        *_, ratio, ratio_slope = terms
        return ratio * change[1] + ratio_slope * state[1] * state[1]

    def _terms_at(self, position: float) -> Terms:
        """Return the terms at a position; the last ones are kept, as values ask for them again."""
        if position != self._known[0]:
            self._known = position, self._terms(position)
        return self._known[1]

    def _gain(self, terms: Terms, state: State, change: State) -> float:
        """Return the derivative of the speed of the motor behind the gear."""
        return change[3] if self._motor == 3 else self._slope(terms, state, change)

    def _to_change(self, law: MakePiece, piece: Piece, state: State, new: State,
                   gain: float) -> float:
        """
        Return the part of a step, in (0, 1], after which another piece of the source's law holds.

        1: none does. The speed is quadratic, ``gain`` its derivative times the length of the step,
        the own state of the source linear.
        """
        speed, own, after = self._speed(state), state[4], self._speed(new)
        if self._is_smooth or law(after, new[4]) == piece:
            return 1.0
        bend = after - speed - gain
        return max(LATE, _first_part(lambda part: law(
            speed + part * (gain + part * bend), own + part * (new[4] - own)) != piece))

    def _rest(self, state: State, left: float, piece: Piece, terms: Terms, change: State,
              by_position: float) -> Part:
        """
        Return the state after all the time left in one step, as the budget is used up.

        It is a Rosenbrock step if an evaluation is left for it, else implicit Euler. Both are
        stable: the error is bounded, but above the tolerance.
        """
        if self.evaluations + EVALUATIONS <= self._budget:
            new, scale = self._try(state, left, terms, by_position, piece)
            if scale > SMALLEST and (not self._phase or self._is_here(new)):
                return new, 0.0, False
        solver = self._equations.linear(terms, state, piece, by_position)
        new = plus(state, 1.0, solver(1.0 / left)(change))       # implicit Euler
        if self._phase and not self._is_here(new):
            return state, left, False
        return new, 0.0, False

    def _is_here(self, state: State) -> bool:
        """Return whether a state is in the part of the range where its coordinate is regular."""
        assert self._phase is not None
        try:
            return self._phase.excess(0.0, state) <= DEEPEST
        except (FourBarError, ArithmeticError):
            return False

    def _linear(self, state: State, piece: Piece) -> tuple[Terms, State, float]:
        """Return the terms, dx/dt and, as a difference, the derivative of du/dt by p."""
        self.evaluations += 2
        position, derivative = state[0], self._equations.derivative
        terms = self._terms_at(position)
        change = derivative(terms, state, piece)
        aside = position + DIFFERENCE * self._unit
        if self._equation.tables and state[1] < 0.0:       # in the piece that lies ahead
            aside = position - DIFFERENCE * self._unit
        try:
            terms_aside = self._terms(aside)
        except FourBarError:                       # next to the upper limit
            aside = position - DIFFERENCE * self._unit
            terms_aside = self._terms(aside)
        other = derivative(terms_aside, state, piece)
        return terms, change, (other[1] - change[1]) / (aside - position)

    def _try(self, state: State, h: float, terms: Terms, by_position: float,
             piece: Piece) -> tuple[State, float]:
        """
        Return the state after one Rosenbrock step of ``h`` seconds, and the next length over it.

        Below 1 the step failed and is made again that much shorter: its error is too large, or it
        left the range of the coordinate. The fourth root follows from the order of the method.
        """
        self.evaluations += EVALUATIONS
        try:
            found = self._attempt(state, h, terms, by_position, piece)
        except FourBarError:
            if not self._phase:
                raise
            return state, SMALLEST                 # a shorter step is inside
        new, (dq, dw, ds, dv) = found[:5], found[5:]
        error = max(abs(dq), abs(ds), h * abs(dw), h * abs(dv)) / self._tolerance
        if not isfinite(error):
            return new, SMALLEST
        if self._phase and error <= 1.0 and not self._is_here(new):
            return new, SHORTER
        longer = SAFETY * max(error, 1e-10)**-0.25
        return new, min(LARGEST, max(SMALLEST, longer))


def _to_place(excess: Callable[[float, bool], float], position: float, gain: float,
              bend: float = 0.0) -> float:
    """
    Return the part of a step, in (0, 1], after which a force table comes to its next piece.

    1: it comes to none. The position is quadratic: after a part x of the step it is
    ``position`` + x (gain + x bend).
    """
    if not excess(position + (gain + bend), False) > NEAREST:
        return 1.0
    return _first_part(lambda part: excess(
        position + part * (gain + part * bend), False) > NEAREST)


def _first_part(is_beyond: Callable[[float], bool]) -> float:
    """Return the least part of a step, in (0, 1], that is beyond something, by bisection."""
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
