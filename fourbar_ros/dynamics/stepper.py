# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
One step of given length at a time: stable whatever the stiffness, with a bounded amount of work.

A Rosenbrock method (:mod:`fourbar_ros.dynamics.rosenbrock`) takes one step over the whole length;
where its error is too large, shorter ones. Of the Jacobian of (N1), see
:mod:`fourbar_ros.dynamics.step_equations`, the acceleration by the coordinate is a difference, the
rest exact. The next state follows from the state alone, so one that is read from a bag gives the
same; what is kept from one step to the next, the terms at the last position, is only not computed
again. :mod:`fourbar_ros.dynamics.steps` goes from one coordinate to the other at toggles.
"""
from __future__ import annotations

from math import isfinite, nan
from typing import NamedTuple

from fourbar_ros.dynamics.drives import ConstantTorque, Drive
from fourbar_ros.dynamics.phase import Phase
from fourbar_ros.dynamics.pieces import always, make_begin, Piece, PieceAt
from fourbar_ros.dynamics.rosenbrock import EVALUATIONS, Rosenbrock
from fourbar_ros.dynamics.step_equations import Elastic, plus, Rigid, State, Terms
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError

DONE, BUDGET, LIMIT, FAILED = 'done', 'budget used up', 'at a limit', 'not finite'

DIFFERENCE = 1e-7          # of the input for the column of q, times its unit
SMALLEST, LARGEST, SAFETY = 0.1, 4.0, 0.85
SHORTEST, BISECTIONS = 1e-3, 40      # part of a step, in the search for a kink
CLOSEST = 1e-6                       # through toggles: part that a kink may be off
DEEPEST, SHORTER = 50.0, 0.3         # excess of a phase after a step; else it becomes shorter
RESERVE = 2                          # evaluations with which another coordinate finishes a step


class Advanced(NamedTuple):
    """The state after a step, how it went, evaluations of the equation of motion."""

    state: State
    status: str
    evaluations: int


class Part(NamedTuple):
    """A state on the way, the time left, whether it is as good as wanted."""

    state: State
    left: float
    is_good: bool


class Torques(NamedTuple):
    """What follows from a state: acceleration of the input, torques on the input, of the motor."""

    acceleration: float
    on_input: float
    of_motor: float


class OneStep:
    """
    Advances the state of a system in one coordinate.

    Parameters
    ----------
    system : System
    tolerance : float
        Allowed error of one step: in the coordinate and the twist, and in speeds times its length.
    budget : int
        Most evaluations of the equation of motion in one step.
    phase : Phase, optional
        Its coordinate and assembly mode; a part of a step then ends where another one takes over.
        Not given: the input in the mode of the system, up to its limits.

    """

    def __init__(self, system: System, tolerance: float, budget: int,
                 phase: Phase | None = None) -> None:
        self._system, self._phase, self._count = system, phase, 0
        self._budget = budget - RESERVE if phase else budget
        equation = phase.equation if phase else system.equation
        self._terms, self._unit = equation.of_one_with_ratio, equation.coordinate.input_unit
        self._tolerance = tolerance * self._unit
        self._drive = system.drive or Drive(ConstantTorque())
        self._begin = make_begin(self._drive.source)
        shaft, rotor = self._drive.shaft, self._drive.rotor
        self._motor = 3 if shaft else 1            # place of the speed behind the gear
        self._is_input = equation.is_input
        self._equations: Elastic | Rigid = Elastic(shaft, rotor) if shaft else Rigid()
        self._attempt = Rosenbrock(equation, self._equations, bool(self._drive.source.start))
        self._has_limits = not system.has_no_limits
        self._known: tuple[float, Terms] = (nan, (nan,) * 7)      # the last position, terms there

    @property
    def start(self) -> State:
        """Return the state at the start: the motor turns with the input, nothing is twisted."""
        position, rate = self._system.start[:2]
        own = self._drive.source.start
        return (position, rate, 0.0, rate if self._drive.shaft else 0.0, own[0] if own else 0.0)

    @staticmethod
    def held(state: State) -> State:
        """Return a state at rest at the same place, nothing twisted, nothing summed up."""
        return (state[0], 0.0, 0.0, 0.0, 0.0)

    def torques(self, state: State, command: float | None = None) -> Torques:
        """Return acceleration and torques of a state; ``command``: torque of the source."""
        speed, own = self._speed(state), state[4]
        piece = self.pieces(state, command)(speed, own)
        terms = self._terms_at(state[0])
        change = self._equations.derivative(terms, state, piece)
        return Torques(self._slope(terms, state, change),
                       self._equations.on_input(terms, state, piece), piece.torque_at(speed, own))

    def advance(self, state: State, length: float, command: float | None = None) -> Advanced:
        """
        Return the state after a time.

        Parameters
        ----------
        state : State
        length : float
            [s]
        command : float, optional
            Torque of the source during it [N m], in place of that of the drive.

        """
        self._count = 0
        try:
            new, _, is_good = self._integrate(state, length, self.pieces(state, command))
        except FourBarError:
            return Advanced(self.held(state), LIMIT, self._count)
        except ArithmeticError:
            return Advanced(self.held(state), FAILED, self._count)
        if not all(map(isfinite, new)):
            return Advanced(self.held(state), FAILED, self._count)
        if self._has_limits and self._system.distance_to_limit(0.0, new) <= 0.0:
            return Advanced(self.held(state), LIMIT, self._count)
        return Advanced(new, DONE if is_good else BUDGET, self._count)

    def part(self, state: State, left: float, piece_at: PieceAt, spent: int) -> tuple[Part, int]:
        """
        Return the Part of a step that this coordinate makes, and all evaluations so far.

        Time is left where another coordinate has to take over; without being as good as wanted,
        where this one cannot finish the step within the budget.

        Raises
        ------
        FourBarError, ArithmeticError

        """
        self._count = spent
        return self._integrate(state, left, piece_at), self._count

    def pieces(self, state: State, command: float | None) -> PieceAt:
        """Return the pieces of the source during a step."""
        if command is not None:
            return always(Piece(command))(0.0, 0.0)
        return self._begin(self._speed(state), state[4])

    # --- one step, or as many as the tolerance asks for -----------------------------------------

    def _speed(self, state: State) -> float:
        """Return the speed of the motor behind the gear."""
        if self._is_input or self._motor == 3:
            return state[self._motor]
        return self._terms_at(state[0])[5] * state[1]

    def _slope(self, terms: Terms, state: State, change: State) -> float:
        """Return the acceleration of the input, (T3)."""
        if self._is_input:
            return change[1]
        return terms[5] * change[1] + terms[6] * state[1] * state[1]

    def _terms_at(self, position: float) -> Terms:
        """Return the terms at a position, which the sample before may have asked for."""
        if position != self._known[0]:
            self._known = position, self._terms(position)
        return self._known[1]

    def _integrate(self, state: State, left: float, piece_at: PieceAt) -> Part:
        """Return the state after a time, or where another coordinate takes over."""
        h, closest = left, CLOSEST * left if self._phase else 0.0
        while left > 0.0:
            piece = piece_at(self._speed(state), state[4])
            terms, change, by_position = self._linear(state, piece)
            while True:
                h = min(h, left)
                more = 0 if h == left else 2 + EVALUATIONS
                if self._count + EVALUATIONS + more > self._budget:
                    return self._rest(state, left, piece, terms, by_position)
                new, scale = self._try(state, h, terms, by_position, piece)
                if scale >= 1.0:
                    slope = (change[3] if self._motor == 3
                             else self._slope(terms, state, change))
                    to_kink = self._to_kink(state, new, h * slope, piece, piece_at)
                    if to_kink == 1.0 or h <= closest:
                        break
                    scale = max(to_kink, closest / h)
                h *= scale
            state, left, h = new, left - h, h * scale
            if self._phase and left > 0.0 and self._phase.excess(0.0, state) > 0.0:
                break
        return Part(state, left, True)

    def _rest(self, state: State, left: float, piece: Piece, terms: Terms,
              by_position: float) -> Part:
        """Return the state after all that is left, at one go: both methods are stable."""
        if self._count + EVALUATIONS <= self._budget:
            new, scale = self._try(state, left, terms, by_position, piece)
            if scale > SMALLEST and (not self._phase or self._is_here(new)):
                return Part(new, 0.0, False)
        change = self._equations.derivative(terms, state, piece)
        solver = self._equations.linear(terms, state, piece, by_position)
        new = plus(state, 1.0, solver(1.0 / left)(change))       # implicit Euler
        if self._phase and not self._is_here(new):
            return Part(state, left, False)
        return Part(new, 0.0, False)

    def _is_here(self, state: State) -> bool:
        """Return whether a state is where the coordinate of the phase can tell it."""
        assert self._phase is not None
        try:
            return self._phase.excess(0.0, state) <= DEEPEST
        except (FourBarError, ArithmeticError):
            return False

    def _linear(self, state: State, piece: Piece) -> tuple[Terms, State, float]:
        """Return terms, dx/dt and, as a difference, the acceleration by the coordinate."""
        self._count += 2
        position, derivative = state[0], self._equations.derivative
        terms = self._terms_at(position)
        change = derivative(terms, state, piece)
        aside = position + DIFFERENCE * self._unit
        try:
            terms_aside = self._terms(aside)
        except FourBarError:                       # next to the upper limit
            aside = position - DIFFERENCE * self._unit
            terms_aside = self._terms(aside)
        other = derivative(terms_aside, state, piece)
        return terms, change, (other[1] - change[1]) / (aside - position)

    def _try(self, state: State, h: float, terms: Terms, by_position: float,
             piece: Piece) -> tuple[State, float]:
        """Return the state after one Rosenbrock step, and by how much the next may be longer."""
        self._count += EVALUATIONS
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
        return new, min(LARGEST, max(SMALLEST, SAFETY * max(error, 1e-10)**-0.25))

    def _to_kink(self, state: State, new: State, slope: float, piece: Piece,
                 piece_at: PieceAt) -> float:
        """
        Return the part of a step after which another piece of the source begins; 1: none does.

        Between its ends the speed is taken as quadratic, ``slope`` its derivative at the start
        times the length; the state of the source as linear.
        """
        speed, end = self._speed(state), self._speed(new)
        if piece_at(end, new[4]) is piece:
            return 1.0
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            part = 0.5 * (low + high)
            there = speed + part * (slope + part * (end - speed - slope))
            is_same = piece_at(there, state[4] + part * (new[4] - state[4])) is piece
            low, high = (part, high) if is_same else (low, part)
        return max(high, SHORTEST) if high < 1.0 - SHORTEST else 1.0
