# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
One step of given length at a time: stable whatever the stiffness, with a bounded amount of work.

A Rosenbrock method (RODAS of Hairer and Wanner, Solving Ordinary Differential Equations II,
section IV.7: order 4, an error estimate of order 3, L-stable, stiffly accurate) takes one step
over the whole length; where its error is too large, shorter ones. Of the Jacobian of (N1), see
:mod:`fourbar_ros.dynamics.step_equations`, the column of q is a difference, the rest exact.
Nothing is kept from one step to the next, so a state that is read from a bag gives the same next
state.
"""
from __future__ import annotations

from math import isfinite
from typing import NamedTuple

from fourbar_ros.dynamics.drives import ConstantTorque, Drive
from fourbar_ros.dynamics.pieces import begin, Piece, PieceAt
from fourbar_ros.dynamics.step_equations import Elastic, plus, Rigid, Solver, State
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError

KEY = 'integrator'         # in a bag: what made its motion
NAME = 'steps of the node, version 1'     # a bag is stepped again by the same version only
DONE, BUDGET, LIMIT, FAILED = 'done', 'budget used up', 'at a limit', 'not finite'

GAMMA = 0.25
# u_i depends on f(x + sum A_ij u_j) and on sum C_ij u_j / h; the last starts where the one before
# ends, the result is where it ends, and it is itself the estimate of the error
A: tuple[tuple[float, ...], ...] = (
    (), (1.544,), (0.9466785280815826, 0.2557011698983284),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817),
    (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950))
C: tuple[tuple[float, ...], ...] = (
    (), (-5.6688,), (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160))
C_LAST = (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
          -6.058818238834054)
DIFFERENCE = 1e-7          # of the input for the column of q, times its unit
SMALLEST, LARGEST, SAFETY = 0.1, 4.0, 0.85
SHORTEST, BISECTIONS = 1e-3, 40      # part of a step, in the search for a kink


class Advanced(NamedTuple):
    """The state after a step, how it went, evaluations of the equation of motion."""

    state: State
    status: str
    evaluations: int


class Torques(NamedTuple):
    """What follows from a state: acceleration of the input, torques on the input, of the motor."""

    acceleration: float
    on_input: float
    of_motor: float


class OneStep:
    """
    Advances the state of a system.

    Parameters
    ----------
    system : System
    tolerance : float
        Allowed error of one step: in the input and the twist, and in speeds times its length.
    budget : int
        Most evaluations of the equation of motion in one step.

    """

    def __init__(self, system: System, tolerance: float, budget: int) -> None:
        self._system, self._budget, self._count = system, budget, 0
        self._terms, self._unit = system.equation.of_one, system.mechanism.input_unit
        self._tolerance = tolerance * self._unit
        self._drive = system.drive or Drive(ConstantTorque())
        shaft, rotor = self._drive.shaft, self._drive.rotor
        self._motor = 3 if shaft else 1            # place of the speed behind the gear
        self._equations: Elastic | Rigid = Elastic(shaft, rotor) if shaft else Rigid()

    @property
    def start(self) -> State:
        """Return the state at the start: the motor turns with the input, nothing is twisted."""
        position, rate = self._system.start[:2]
        own = self._drive.source.start
        return (position, rate, 0.0, rate if self._drive.shaft else 0.0, own[0] if own else 0.0)

    @staticmethod
    def held(state: State) -> State:
        """Return a state at rest at the same input, nothing twisted, nothing summed up."""
        return (state[0], 0.0, 0.0, 0.0, 0.0)

    def torques(self, state: State, command: float | None = None) -> Torques:
        """Return acceleration and torques of a state; ``command``: torque of the source."""
        speed, own = state[self._motor], state[4]
        piece = self._pieces(state, command)(speed, own)
        change = self._equations.derivative(self._terms(state[0]), state, piece)
        return Torques(change[1], self._equations.on_input(state, piece),
                       piece.torque_at(speed, own))

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
        self._count, system = 0, self._system
        try:
            new, is_good = self._integrate(state, length, self._pieces(state, command))
        except FourBarError:
            return Advanced(self.held(state), LIMIT, self._count)
        except ArithmeticError:
            return Advanced(self.held(state), FAILED, self._count)
        if not all(map(isfinite, new)):
            return Advanced(self.held(state), FAILED, self._count)
        if not system.has_no_limits and system.distance_to_limit(0.0, new) <= 0.0:
            return Advanced(self.held(state), LIMIT, self._count)
        return Advanced(new, DONE if is_good else BUDGET, self._count)

    # --- one step, or as many as the tolerance asks for -----------------------------------------

    def _pieces(self, state: State, command: float | None) -> PieceAt:
        if command is not None:
            piece = Piece(command)
            return lambda speed, state: piece
        return begin(self._drive.source, state[self._motor], state[4])

    def _integrate(self, state: State, length: float, piece_at: PieceAt) -> tuple[State, bool]:
        """Return the state after a time, and whether it is as good as wanted."""
        left = h = length
        while left > 0.0:
            piece = piece_at(state[self._motor], state[4])
            change, solver = self._linear(state, piece)
            while True:
                h = min(h, left)
                if self._count + len(A) + (0 if h == left else 2 + len(A)) > self._budget:
                    return self._rest(state, left, piece, change, solver), False
                new, scale = self._try(state, h, piece, change, solver)
                if scale >= 1.0:
                    to_kink = self._to_kink(state, new, h * change[self._motor], piece, piece_at)
                    if to_kink == 1.0:
                        break
                    scale = to_kink
                h *= scale
            state, left, h = new, left - h, h * scale
        return state, True

    def _rest(self, state: State, left: float, piece: Piece, change: State,
              solver: Solver) -> State:
        """Return the state after all that is left, at one go: both methods are stable."""
        if self._count + len(A) <= self._budget:
            new, scale = self._try(state, left, piece, change, solver)
            if scale > SMALLEST:
                return new
        return plus(state, 1.0, solver(1.0 / left)(change))      # implicit Euler

    def _linear(self, state: State, piece: Piece) -> tuple[State, Solver]:
        """Return dx/dt, and the solver of its Jacobian, whose column of q is a difference."""
        self._count += 2
        position, equations, terms = state[0], self._equations, self._terms(state[0])
        change = equations.derivative(terms, state, piece)
        aside = position + DIFFERENCE * self._unit
        try:
            terms_aside = self._terms(aside)
        except FourBarError:                       # next to the upper limit of the input
            aside = position - DIFFERENCE * self._unit
            terms_aside = self._terms(aside)
        other = equations.derivative(terms_aside, state, piece)
        by_position = (other[1] - change[1]) / (aside - position)
        return change, equations.linear(terms, state, piece, by_position)

    def _try(self, state: State, h: float, piece: Piece, change: State,
             solver: Solver) -> tuple[State, float]:
        """Return the state after one Rosenbrock step, and by how much the next may be longer."""
        self._count += len(A)
        terms, derivative = self._terms, self._equations.derivative
        solve = solver(1.0 / (GAMMA * h))
        stages = [solve(change)]
        for a, c in zip(A[1:], C[1:]):
            place = state
            for weight, u in zip(a, stages):
                place = plus(place, weight, u)
            right = derivative(terms(place[0]), place, piece)
            for weight, u in zip(c, stages):
                right = plus(right, weight / h, u)
            stages.append(solve(right))
        place = plus(place, 1.0, stages[-1])
        right = derivative(terms(place[0]), place, piece)
        for weight, u in zip(C_LAST, stages):
            right = plus(right, weight / h, u)
        last = solve(right)
        dq, dw, ds, dv, _ = last
        error = max(abs(dq), abs(ds), h * abs(dw), h * abs(dv)) / self._tolerance
        if not isfinite(error):
            return place, SMALLEST
        return (plus(place, 1.0, last),
                min(LARGEST, max(SMALLEST, SAFETY * max(error, 1e-10)**-0.25)))

    def _to_kink(self, state: State, new: State, slope: float, piece: Piece,
                 piece_at: PieceAt) -> float:
        """
        Return the part of a step after which another piece of the source begins; 1: none does.

        Between its ends the speed is taken as quadratic, ``slope`` its derivative at the start
        times the length; the state of the source as linear.
        """
        speed, end = state[self._motor], new[self._motor]
        if piece_at(end, new[4]) is piece:
            return 1.0
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            part = 0.5 * (low + high)
            there = speed + part * (slope + part * (end - speed - slope))
            is_same = piece_at(there, state[4] + part * (new[4] - state[4])) is piece
            low, high = (part, high) if is_same else (low, part)
        return max(high, SHORTEST) if high < 1.0 - SHORTEST else 1.0
