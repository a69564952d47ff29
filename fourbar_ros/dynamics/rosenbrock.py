# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The formulas of an implicit step: RODAS of Hairer and Wanner, of input, shaft and source.

The state is x = (p, u, s, v, z): coordinate and its rate, twist of the elastic shaft, speed of the
motor behind the gear, state of the torque source. Twist and motor speed are zero for a rigid
shaft. The terms are those of (E1) in p and (A9) for the source; the shaft has the stiffness k and
the damping c. With r = dq/dp, q the input, and r' = dr/dp (1 and 0 if p is the input),

    dp/dt = u                       du/dt = (Q - D u - J'/2 u^2 + r T_in) / J
    ds/dt = v - r u                 dv/dt = (T - T_in) / J_m                               (RB1)
    T_in = k s + c (v - r u), of a rigid shaft T at the speed r u;   dz/dt of the source

The twist is a state of its own, not a difference of angles that grow: a stiff shaft would multiply
their rounding.

RODAS (Solving Ordinary Differential Equations II, section IV.7) has order 4, an error estimate of
order 3, is L-stable and stiffly accurate. Its Jacobian is exact at the start of the step, except
for the derivative of du/dt by p, a finite difference.

All are formulas of any number type. The node has them as functions of floats without calls
(:mod:`fourbar_ros.numerics.write`), generated code as C, both from one trace.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial, reduce
from itertools import islice
from math import nan
from typing import Any, NamedTuple

from fourbar_ros.dynamics.coordinate import FARTHEST, LONGEST, MotionCoordinate
from fourbar_ros.dynamics.equation import Outside
from fourbar_ros.dynamics.sources import Drive, Piece
from fourbar_ros.dynamics.system import NEAR_TOGGLE
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.write import straight_line

State = tuple[float, ...]        # five numbers
BASE = 'base'              # name of the base among what acts, beside those of links
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
DIFFERENCE = 1e-7          # step of p for the derivative of du/dt by it, in the unit of p
HUGE = 1e100               # derivatives beyond it count as not finite
SMALLEST, LARGEST, SAFETY = 0.1, 4.0, 0.85      # next step over this one: bounds, factor


class StepTerms(NamedTuple):
    """The terms of (E1) in a coordinate, and the coordinate that takes over there."""

    inertia: Scalar
    half_slope: Scalar
    force: Scalar
    damping: Scalar
    couples: Scalar
    ratio: Scalar             # r = dq/dp
    ratio_slope: Scalar       # r'
    other: Scalar             # the coordinate that takes over, where one may
    other_ratio: Scalar       # its derivative by p
    room: Scalar              # positive while this coordinate may go on


class Place(NamedTuple):
    """What is known of a state. ``linear``: what a step from there needs, 14 numbers."""

    room: float
    other: float
    other_ratio: float
    to_bend: float            # time to the next bend of the source's law [s], about
    acceleration: float       # of the input, (Q3)
    on_input: float           # torque (force) of the drive on it
    of_motor: float           # torque of the source
    linear: tuple[float, ...]    # dx/dt; J, J'/2, D, r, r'; dT/dw, dT/dz and those of dz/dt


TOLD, LINEAR = len(Place._fields) - 1, 14
GIVEN, GIVEN_STEP = 5 + 1, 5 + 2 + LINEAR     # x and a command; x, h, a command, linear


def count_of(name: str) -> int:
    """Return how many numbers tell what acts: four of the base, three of a wrench on a link."""
    return len(Base._fields) if name == BASE else 3


class StepFormulas:
    """
    The formulas of a step in one coordinate, in the assembly mode of its equation.

    ``passes``: through toggles, where another coordinate takes over; else they are limits.
    ``tolerance``: allowed error of a step, in the coordinate and the twist, and in speeds times
    its length. ``acting``: names of what acts from outside, in the order of the numbers that
    follow the other arguments of all functions: four of the base, three of the wrench on a link.
    """

    def __init__(self, coordinate: MotionCoordinate, drive: Drive, passes: bool, tolerance: float,
                 acting: Sequence[str] = ()) -> None:
        self._coordinate, self._equation = coordinate, coordinate.equation
        self._source, self._passes = drive.source, passes
        self._shaft, self._rotor = drive.shaft, drive.rotor
        self._acting, self._more = acting, sum(map(count_of, acting))
        self.unit = self._equation.coordinate.input_unit
        self._tolerance = tolerance * self.unit
        # the parts of the state that there are, as they are eliminated
        self._order = (0, *((2,) if drive.shaft else ()), *((4,) if drive.source.start else ()), 1,
                       *((3,) if drive.shaft else ()))

    # --- as functions of floats -----------------------------------------------------------------

    @cached_property
    def place(self) -> Function:
        """Return (p, u, s, v, z, command, *acting) -> numbers of a Place, flat."""
        return straight_line(self.make_place, GIVEN + self._more)

    @cached_property
    def attempt(self) -> Function:
        """Return (p, u, s, v, z, h, command, linear, *acting) -> state after h, next length/h."""
        return straight_line(self.make_attempt, GIVEN_STEP + self._more)

    @cached_property
    def euler(self) -> Function:
        """Return the same arguments -> state after h by implicit Euler."""
        return straight_line(self.make_euler, GIVEN_STEP + self._more)

    # --- formulas -------------------------------------------------------------------------------

    def _outside(self, acting: Sequence[Scalar]) -> Outside | None:
        """Return what acts from outside, by its numbers; None if nothing does."""
        if not acting:
            return None
        numbers = iter(acting)
        each = {name: list(islice(numbers, count_of(name))) for name in self._acting}
        base = Base(*each.pop(BASE)) if BASE in each else None
        return Outside(base, each)

    def _make_terms(self, n: NumberType, acting: Sequence[Scalar]) -> Function:
        """Return the formula p -> :class:`StepTerms`."""
        terms, coordinate = self._make_step_terms(n, acting), self._coordinate
        if self._passes:
            other = coordinate.make_other(self._equation.coordinate, n)
            middle, half = coordinate.all.middle, coordinate.all.half

            def between_toggles(p: Scalar) -> Any:
                value, ratio, _ = other(p)
                room = LONGEST - n.fabs(ratio) * coordinate.unit_of_ratio
                if coordinate.is_input:            # not in another range, beyond a gap
                    room = n.where(n.fabs(p - middle) < half, room, -FARTHEST)
                return (*terms(p), value, ratio, room)
            return between_toggles
        mechanism = self._equation.mechanism
        if mechanism.turns_fully:
            return lambda p: (*terms(p), 0.0, 1.0, 1.0)
        motion_of = mechanism.motion_formula(n, mechanism.constants)
        return lambda p: (*terms(p), 0.0, 1.0, n.fabs(mechanism.transmission_sine(
            mechanism.MOTION._make(motion_of(p, 0.0, 0.0)))) - NEAR_TOGGLE)

    def _make_step_terms(self, n: NumberType, acting: Sequence[Scalar]) -> Function:
        """Return the formula p -> terms within a step, which do not ask what takes over."""
        return self._equation.make_terms(self._equation.coordinate, n, self._outside(acting))

    def make_tables(self, n: NumberType) -> Function:
        """Return the formula p -> the places of all forces with a table."""
        return self._equation.make_places(self._equation.coordinate, n)

    def make_place(self, n: NumberType) -> Function:
        """Return the formula of :attr:`place`."""
        def place(p: Any, u: Any, s: Any, v: Any, z: Any, command: Any, *acting: Any) -> Any:
            terms = StepTerms(*self._make_terms(n, acting)(p))
            change, on_input, of_motor, piece = self._rates(n, terms, (p, u, s, v, z), command)
            acceleration = (change[1] if self._equation.is_input else
                            terms.ratio * change[1] + terms.ratio_slope * u * u)            # (Q3)
            slope = change[3] if self._shaft else acceleration
            speed = v if self._shaft else terms.ratio * u
            to_bend = self._to_bend(n, command, (speed, z), (slope, change[4]))
            return (terms.room, terms.other, terms.other_ratio, to_bend, acceleration, on_input,
                    of_motor, *change, terms.inertia, terms.half_slope, terms.damping, terms.ratio,
                    terms.ratio_slope, piece.by_speed, piece.by_state, piece.change_by_speed,
                    piece.change_by_state)
        return place

    def make_attempt(self, n: NumberType) -> Function:
        """Return the formula of :attr:`attempt`: a step of RODAS."""
        def attempt(p: Any, u: Any, s: Any, v: Any, z: Any, h: Any, command: Any,
                    *given: Any) -> Any:
            x = p, u, s, v, z
            terms_there = self._make_step_terms(n, given[LINEAR:])
            solve = self._solver(n, x, command, given, 1.0 / (GAMMA * h), terms_there)
            stages = [solve(given[:5])]

            def add_stage(at: State, weights: Sequence[float]) -> None:
                """Solve for the next u_i: dx/dt at a state, plus earlier u_j times weights / h."""
                change, *_ = self._rates(n, terms_there(at[0]), at, command)
                stages.append(solve(_sum(change, [weight / h for weight in weights], stages)))
            for a, c in zip(A[1:], C[1:]):
                at = _sum(x, a, stages)
                add_stage(at, c)
            at = _plus(at, 1.0, stages[-1])
            add_stage(at, C_LAST)
            dp, du, ds, dv, _ = stages[-1]
            errors = [n.fabs(part) for part in (dp, ds, h * du, h * dv)]
            return (*_plus(at, 1.0, stages[-1]), self._scale(n, errors))
        return attempt

    def make_euler(self, n: NumberType) -> Function:
        """Return the formula of :attr:`euler`: less accurate, and stable whatever the error."""
        def euler(p: Any, u: Any, s: Any, v: Any, z: Any, h: Any, command: Any,
                  *given: Any) -> Any:
            x = p, u, s, v, z
            terms_there = self._make_step_terms(n, given[LINEAR:])
            solve = self._solver(n, x, command, given, 1.0 / h, terms_there)
            # a rate that grows so fast would leave nothing of the Jacobian but rounding
            whole = n.where(n.fabs(given[1]) < HUGE, 1.0, nan)
            return _plus(x, whole, solve(given[:5]))
        return euler

    def _to_bend(self, n: NumberType, command: Scalar, at: Sequence[Scalar],
                 slopes: Sequence[Scalar]) -> Scalar:
        """
        Return the time after which the law of the source bends, 1e300 where it does not.

        By a tangent: of speed and own state of the source, ``at`` a place, with their ``slopes``
        over time.
        """
        bounded = self._source.bounded(command)
        if bounded is None:
            return 1e300
        inner, bound = bounded
        torque = inner.torque_at(*at)
        slope = inner.by_speed * slopes[0] + inner.by_state * slopes[1]
        sign = n.where(slope < 0.0, -1.0, 1.0)
        torque, slope = sign * torque, n.fabs(slope)                 # rises
        gap = n.where(torque < -bound, -bound - torque, bound - torque)
        found: Scalar = n.where(gap > 0.0, gap / _larger(n, slope, 1e-300), 1e300)
        return found

    def _rates(self, n: NumberType, terms: Sequence[Any], x: State, command: Scalar
               ) -> tuple[State, Scalar, Scalar, Piece]:
        """Return dx/dt by (RB1), the torques on the input and of the source, and its law there."""
        _, u, s, v, z = x
        inertia, half_slope, force, damping, _, r, *_ = terms
        w, shaft = r * u, self._shaft
        speed = v if shaft else w
        piece = self._source.piece(speed, z, n, command)
        motor = on_input = piece.torque_at(speed, z)
        if shaft:
            on_input = shaft.stiffness * s + shaft.damping * (v - w)
        change = (u, (force + r * on_input - (damping + half_slope * u) * u) / inertia,
                  *((v - w, (motor - on_input) / self._rotor) if shaft else (0.0, 0.0)),
                  piece.change_at(speed, z) if 4 in self._order else 0.0)
        return change, on_input, motor, piece

    def _solver(self, n: NumberType, x: State, command: Scalar, linear: Sequence[Scalar],
                g: Scalar, terms_at: Function) -> Callable[[State], State]:
        """Return b -> y, the solution of (g - d(dx/dt)/dx) y = b at the start of a step."""
        step = DIFFERENCE * self.unit
        if self._equation.tables:                  # in the piece that lies ahead
            step = n.where(x[1] < 0.0, -step, step)
        aside = x[0] + step
        (_, change, *_), *_ = self._rates(n, terms_at(aside), (aside, *x[1:]), command)
        jacobian = self._jacobian(x, linear, (change - linear[1]) / (aside - x[0]))
        solve = _eliminated([[(g if i == j else 0.0) - jacobian[i][j] for j in self._order]
                             for i in self._order])

        def solve_all(right: State) -> State:
            found: list[Any] = [0.0] * 5
            for i, y in zip(self._order, solve([right[i] for i in self._order])):
                found[i] = y
            return tuple(found)
        return solve_all

    def _jacobian(self, x: State, linear: Sequence[Scalar], by_position: Scalar
                  ) -> list[list[Scalar]]:
        """
        Return d(dx/dt)/dx of (RB1), rows and columns in the order of x.

        ``by_position``: derivative of du/dt by p, the one entry that is not known in closed form.
        """
        u, (J, half_slope, D, r, r_slope, T_w, T_z, d_w, d_z) = x[1], linear[5:LINEAR]
        w_p = r_slope * u                          # of the speed w = r u by p
        if not self._shaft:
            return [[0.0, 1.0, 0.0, 0.0, 0.0],
                    [by_position, (r * r * T_w - D - 2.0 * half_slope * u) / J, 0.0, 0.0,
                     r * T_z / J],
                    [0.0] * 5,
                    [0.0] * 5,
                    [w_p * d_w, r * d_w, 0.0, 0.0, d_z]]
        k, c, J_m = self._shaft.stiffness, self._shaft.damping, self._rotor
        return [[0.0, 1.0, 0.0, 0.0, 0.0],
                [by_position, -(D + r * r * c + 2.0 * half_slope * u) / J, r * k / J, r * c / J,
                 0.0],
                [-w_p, -r, 0.0, 1.0, 0.0],
                [c * w_p / J_m, r * c / J_m, -k / J_m, (T_w - c) / J_m, T_z / J_m],
                [0.0, 0.0, 0.0, d_w, d_z]]

    def _scale(self, n: NumberType, errors: Sequence[Scalar]) -> Scalar:
        """
        Return the next length over that of a step, by its estimated errors.

        Below 1 the step failed and is made again that much shorter. The fourth root follows from
        the order of the method.
        """
        error = reduce(partial(_larger, n), errors) / self._tolerance
        longer = SAFETY * _larger(n, error, 1e-10)**-0.25
        longer = _larger(n, n.where(longer < LARGEST, longer, LARGEST), SMALLEST)
        found: Scalar = n.where(sum(errors) < 1e300, longer, SMALLEST)
        return found


def _eliminated(rows: Sequence[Sequence[Scalar]]) -> Callable[[Sequence[Scalar]], list[Scalar]]:
    """Return b -> y of M y = b, by elimination without pivots: M is g less a Jacobian, g large."""
    count, left = len(rows), [list(row) for row in rows]
    for k in range(count):
        for i in range(k + 1, count):
            left[i][k] = share = left[i][k] / left[k][k]
            for j in range(k + 1, count):
                left[i][j] = left[i][j] - share * left[k][j]

    def solve(right: Sequence[Scalar]) -> list[Scalar]:
        y = list(right)
        for i in range(count):
            for k in range(i):
                y[i] = y[i] - left[i][k] * y[k]
        for i in reversed(range(count)):
            for k in range(i + 1, count):
                y[i] = y[i] - left[i][k] * y[k]
            y[i] = y[i] / left[i][i]
        return y
    return solve


def _larger(n: NumberType, one: Scalar, other: Scalar) -> Scalar:
    """Return the larger of two numbers."""
    larger: Scalar = n.where(one < other, other, one)
    return larger


def _plus(x: State, weight: float, u: State) -> State:
    """Return x + weight u for states."""
    return tuple([a + weight * b for a, b in zip(x, u)])


def _sum(x: State, weights: Sequence[float], stages: Sequence[State]) -> State:
    """Return the state x + weights[0] stages[0] + weights[1] stages[1] + ..."""
    for weight, u in zip(weights, stages):
        x = _plus(x, weight, u)
    return x
