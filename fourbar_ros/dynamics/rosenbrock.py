# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
RODAS of Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.7.

Order 4, an error estimate of order 3, L-stable, stiffly accurate. A step is a formula of floats
and nothing else: written down once, it becomes one function without calls
(:mod:`fourbar_ros.numerics.straight_line`) with the bits of the formula.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.sources import always, Law, Piece
from fourbar_ros.dynamics.step_equations import Elastic, plus, Rigid, State, Terms
from fourbar_ros.numerics.number_types import Function, NumberType, REAL
from fourbar_ros.numerics.straight_line import straight_line

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
EVALUATIONS = len(A)       # of the equation of motion in one step, besides those at its start
Stepped = tuple[float, float, float, float, float, float, float, float, float]
# numbers that a step is a formula of: state, h, terms, derivative of du/dt by p, law of the source
# at its start, and what commands the source
GIVEN = 5 + 1 + 7 + 1 + len(Piece._fields) + 1


class Rosenbrock:
    """
    One step of given length, of an equation of motion with the equations of shaft and source.

    ``source``: its law is that of the start of the step, a smooth one is taken anew at each stage.
    """

    def __init__(self, equation: Equation, equations: Elastic | Rigid, source: Law) -> None:
        """Write the step as one function of floats where there is one formula."""
        self._equations, self._source, self._equation = equations, source, equation
        self._command = getattr(source, source.command) if source.command else 0.0
        self._formula = self._make(equation.of_one_with_ratio, REAL)
        # in both modes of a change point there is no one formula
        self._line = (self._formula if equation.changes_mode else
                      straight_line(self.make, GIVEN))

    def __call__(self, state: State, h: float, terms: Terms, by_position: float,
                 piece: Piece) -> Stepped:
        """
        Return the state after a step of ``h`` seconds and its estimated error, as nine numbers.

        They are (p, u, s, v, z, dp, du, ds, dv). ``terms``: at this state; ``by_position``:
        derivative of its acceleration by p; ``piece``: law of the source. Raises FourBarError
        where the mechanism cannot reach a stage, ArithmeticError where a number is too large.
        """
        try:
            stepped: Stepped = self._line(*state, h, *terms, by_position, *piece, self._command)
        except (ValueError, ArithmeticError):      # of a number; the formula says why
            stepped = self._formula(*state, h, *terms, by_position, *piece, self._command)
        return stepped

    def make(self, n: NumberType) -> Function:
        """Return the formula of a step for a number type, in the mode of the equation."""
        return self._make(self._equation.make_with_ratio(self._equation.coordinate, n), n)

    def _make(self, terms_at: Function, n: NumberType) -> Function:
        """Return the function of GIVEN numbers -> step; ``terms_at``: position p -> Terms."""
        derivative, linear = self._equations.derivative, self._equations.linear
        has_shaft, source = isinstance(self._equations, Elastic), self._source
        is_input, has_own = self._equation.is_input, bool(source.start)

        def formula(p: Any, u: Any, s: Any, v: Any, z: Any, h: Any, *given: Any) -> Any:
            """
            Return the nine numbers of ``__call__`` from its arguments one by one, of any type.

            ``given``: 7 terms, by_position, 6 of the piece, the source's law (M1), and a command:
            t and d are torque and dz/dt, t_w, d_w and t_z, d_z their derivatives by speed and own
            state.
            """
            terms: Any = (*given[:5], 1.0, 0.0) if is_input else given[:7]
            by_position, t, t_w, t_z, d, d_w, d_z, command = given[7:]
            s, v = (s, v) if has_shaft else (0.0, 0.0)
            z, t_z, d, d_w, d_z = (z, t_z, d, d_w, d_z) if has_own else (0.0,) * 5
            state, piece = (p, u, s, v, z), Piece(t, t_w, t_z, d, d_w, d_z)
            law = (source.make_piece(n, command if source.command else None)
                   if source.is_smooth else always(piece))
            solve = linear(terms, state, piece, by_position)(1.0 / (GAMMA * h))
            stages = [solve(derivative(terms, state, piece))]

            def add_stage(at: State, weights: Sequence[float]) -> None:
                """Solve for the next u_i: dx/dt at a state, plus earlier u_j times weights / h."""
                position, rate, _, motor_speed, _ = at
                terms_there: Terms = terms_at(position)
                *_, ratio, _ = terms_there               # r = dq/dp, r'
                speed = motor_speed if has_shaft else ratio * rate
                slope = derivative(terms_there, at, law(speed, at[4]))
                stages.append(solve(_sum(slope, [weight / h for weight in weights], stages)))

            for a, c in zip(A[1:], C[1:]):
                place = _sum(state, a, stages)
                add_stage(place, c)
            place = plus(place, 1.0, stages[-1])
            add_stage(place, C_LAST)
            return (*plus(place, 1.0, stages[-1]), *stages[-1][:4])
        return formula


def _sum(x: State, weights: Sequence[float], stages: Sequence[State]) -> State:
    """Return the state x + weights[0] stages[0] + weights[1] stages[1] + ..."""
    for weight, u in zip(weights, stages):
        x = plus(x, weight, u)
    return x
