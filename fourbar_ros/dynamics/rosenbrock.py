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
from fourbar_ros.dynamics.equation import Terms
from fourbar_ros.dynamics.sources import Drive, Piece
from fourbar_ros.dynamics.system import NEAR_TOGGLE
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.write import straight_line

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
LEAST_PUSH = 1e-200        # [N m], [N]: no difference is zero
HUGE = 1e100               # derivatives beyond it count as not finite
NEVER = 1e300              # [s]; generated C has no infinity
SMALLEST, LARGEST, SAFETY = 0.1, 4.0, 0.85      # next step over this one: bounds, factor


class StateVector(NamedTuple):
    """The state x of (RB1) in a coordinate p; floats or numbers of a formula."""

    position: Scalar       # p
    rate: Scalar           # u
    twist: Scalar          # s
    motor_speed: Scalar    # v
    source: Scalar         # z


class Rates(NamedTuple):
    """The right side of (RB1) at a state, and what it was made of."""

    change: StateVector       # dx/dt
    torque: Scalar            # (force) on the input
    motor_torque: Scalar
    law: Piece                # of the source
    felt: Sequence[Any]       # forces in the joints with friction


class Coefficients(NamedTuple):
    """What the Jacobian of (RB1) needs besides the state: terms of (E1), slopes of (A9)."""

    inertia: Scalar
    half_slope: Scalar
    damping: Scalar
    ratio: Scalar             # r = dq/dp
    ratio_slope: Scalar       # r'
    torque_by_speed: Scalar
    torque_by_state: Scalar
    change_by_speed: Scalar
    change_by_state: Scalar


class Linearization(NamedTuple):
    """The equations (RB1) at a state: all that a step from there and a message need."""

    room: float               # positive while this coordinate may go on
    next_position: float      # of the coordinate that takes over, where one may
    next_ratio: float         # its derivative by this coordinate
    to_bend: float            # time to the next bend of the source's law [s], about
    acceleration: float       # of the input, (Q3)
    torque: float             # (force) of the drive on the input
    motor_torque: float       # of the source
    change: StateVector       # dx/dt
    coefficients: Coefficients


class StepStart(NamedTuple):
    """The arguments of a step: its start, its length h and what acts during it."""

    state: StateVector
    length: Scalar
    command: Scalar
    change: StateVector       # dx/dt at the start
    coefficients: Coefficients
    acting: Sequence[Scalar]

    @classmethod
    def of(cls, numbers: Sequence[Scalar]) -> StepStart:
        """Return the record of all these numbers, one after the other."""
        rest = iter(numbers)
        return cls(StateVector(*islice(rest, 5)), next(rest), next(rest),
                   StateVector(*islice(rest, 5)), Coefficients(*islice(rest, 9)), list(rest))


# numbers that the functions of a state and of a step take, besides what acts from outside
AT_STATE = len(StateVector._fields) + 1
OF_STEP = 2 * len(StateVector._fields) + 2 + len(Coefficients._fields)


def count_of(name: str) -> int:
    """Return how many numbers tell what acts: four of the base, three of a wrench on a link."""
    return len(Base._fields) if name == BASE else 3


class StepFormulas:
    """The formulas of a step in one coordinate, in the assembly mode of its equation."""

    # passes: through toggles, where another coordinate takes over; else they are limits.
    # tolerance: allowed error of a step, in the coordinate and the twist, and in speeds times its
    # length. acting: names of what acts from outside, in the order of the numbers that follow the
    # other arguments of all functions: four of the base, three of the wrench on a link.

    def __init__(self, coordinate: MotionCoordinate, drive: Drive, passes: bool, tolerance: float,
                 acting: Sequence[str] = ()) -> None:
        self._coordinate, self._equation = coordinate, coordinate.equation
        self._source, self._passes = drive.source, passes
        self._shaft, self._rotor = drive.shaft, drive.rotor
        self._has_source_state = bool(drive.source.start)
        self._acting, self._acting_count = acting, sum(map(count_of, acting))
        self.unit = self._equation.coordinate.input_unit
        self._tolerance = tolerance * self.unit
        # the fields of the state that this drive has, as they are eliminated
        self._order = [StateVector._fields.index(field) for field in (
            'position', *(('twist',) if drive.shaft else ()),
            *(('source',) if drive.source.start else ()), 'rate',
            *(('motor_speed',) if drive.shaft else ()))]

    # --- as functions of floats -----------------------------------------------------------------

    @cached_property
    def linearize(self) -> Function:
        """Return (p, u, s, v, z, command, *acting) -> fields of a Linearization."""
        return straight_line(self.make_linearization, AT_STATE + self._acting_count)

    @cached_property
    def attempt(self) -> Function:
        """Return (p, u, s, v, z, *StepStart's other numbers) -> (x after h, next length / h)."""
        return straight_line(self.make_attempt, OF_STEP + self._acting_count)

    @cached_property
    def euler(self) -> Function:
        """Return the same arguments -> x after h by implicit Euler."""
        return straight_line(self.make_euler, OF_STEP + self._acting_count)

    # --- formulas -------------------------------------------------------------------------------

    def _make_terms(self, n: NumberType, acting: Sequence[Scalar]) -> tuple[Function, Function]:
        """Return the formulas p -> :class:`Terms` of (E1), (p, u, push, J) -> R of (E9)."""
        outside = iter(acting)
        wrenches = {name: list(islice(outside, count_of(name))) for name in self._acting}
        base = Base(*wrenches.pop(BASE)) if BASE in wrenches else None
        return (self._equation.make_terms(self._equation.coordinate, n, base, wrenches),
                self._equation.make_resistance(n, base, wrenches))

    def make_table_positions(self, n: NumberType) -> Function:
        """Return the formula p -> the positions s of all forces with a table."""
        return self._equation.make_table_positions(self._equation.coordinate, n)

    def make_linearization(self, n: NumberType) -> Function:
        """Return the formula of :attr:`linearize`."""
        coordinate = self._coordinate
        middle, half = coordinate.all.middle, coordinate.all.half

        def linearization(p: Any, u: Any, s: Any, v: Any, z: Any, command: Any,
                          *acting: Any) -> Linearization:
            x, (terms_of, resists) = StateVector(p, u, s, v, z), self._make_terms(n, acting)
            next_position, next_ratio, room = 0.0, 1.0, 1.0
            if self._passes:
                successor = coordinate.make_successor(self._equation.coordinate, n)
                next_position, next_ratio, _ = successor(p)
                room = LONGEST - n.fabs(next_ratio) * coordinate.unit_of_ratio
                if coordinate.is_input:            # not in another range, beyond a gap
                    room = n.where(n.fabs(p - middle) < half, room, -FARTHEST)
            elif not self._equation.mechanism.turns_fully:
                room = 1.0 - NEAR_TOGGLE - n.fabs(p - middle) / half
            terms = terms_of(p)
            change, torque, motor_torque, law, felt = self._rates(n, terms, resists, x, command)
            acceleration = (change.rate if self._equation.is_input else
                            terms.ratio * change.rate + terms.ratio_slope * u * u)          # (Q3)
            slope = change.motor_speed if self._shaft else acceleration
            speed = v if self._shaft else terms.ratio * u
            to_bend = self._to_bend(n, command, (speed, z), (slope, change.source))
            if self._equation.has_resistance:
                leaving = self._to_slip(n, u, change.rate)
                to_bend = n.where(leaving < to_bend, leaving, to_bend)
                terms = self._with_resistance(n, terms, resists, p, u, torque, felt)
            return Linearization(
                room, next_position, next_ratio, to_bend, acceleration, torque, motor_torque,
                change, Coefficients(
                    terms.inertia, terms.half_slope, terms.damping, terms.ratio,
                    terms.ratio_slope, law.by_speed, law.by_state, law.change_by_speed,
                    law.change_by_state))
        return linearization

    def make_attempt(self, n: NumberType) -> Function:
        """Return the formula of :attr:`attempt`: a step of RODAS."""
        # Stages u_i solve the linearized equation; each is made at the state plus earlier ones
        # times a row of A, and takes earlier ones times a row of C. The last two close the step:
        # the difference of the embedded solution and the final one, ``last``, is the error.
        def attempt(*numbers: Any) -> tuple[StateVector, Scalar]:
            start = StepStart.of(numbers)
            h, (terms_of, resists) = start.length, self._make_terms(n, start.acting)
            # what joints with friction transmit at the start: from there stages iterate less
            near = self._rates(n, terms_of(start.state.position), resists, start.state,
                               start.command).felt if self._equation.has_resistance else ()
            solve = self._solver(n, start, 1.0 / (GAMMA * h), terms_of, resists, near)
            stages = [solve(start.change)]

            def add_stage(x: StateVector, weights: Sequence[float]) -> None:
                """Solve for the next u_i: dx/dt at a state, plus earlier u_j times weights / h."""
                change = self._rates(n, terms_of(x.position), resists, x, start.command,
                                     near).change
                stages.append(solve(_sum(change, [weight / h for weight in weights], stages)))
            for a, c in zip(A[1:], C[1:]):
                x = _sum(start.state, a, stages)
                add_stage(x, c)
            x = _plus(x, 1.0, stages[-1])
            add_stage(x, C_LAST)
            last = stages[-1]
            errors = [n.fabs(error) for error in (last.position, last.twist, h * last.rate,
                                                  h * last.motor_speed)]
            end = _plus(x, 1.0, last)
            # The next length over this one; below 1 the step failed and is made again that much
            # shorter. The fourth root follows from the order of the method.
            error = reduce(partial(_larger, n), errors) / self._tolerance
            longer = SAFETY * _larger(n, error, 1e-10)**-0.25
            longer = _larger(n, n.where(longer < LARGEST, longer, LARGEST), SMALLEST)
            scale = n.where(sum(errors) < 1e300, longer, SMALLEST)
            return end, scale
        return attempt

    def make_euler(self, n: NumberType) -> Function:
        """Return the formula of :attr:`euler`: less accurate, and stable whatever the error."""
        def euler(*numbers: Any) -> StateVector:
            start = StepStart.of(numbers)
            solve = self._solver(n, start, 1.0 / start.length, *self._make_terms(n, start.acting))
            # a rate that grows so fast would leave nothing of the Jacobian but rounding
            whole = n.where(n.fabs(start.change.rate) < HUGE, 1.0, nan)
            return _plus(start.state, whole, solve(start.change))
        return euler

    def _to_slip(self, n: NumberType, rate: Scalar, acceleration: Scalar) -> Scalar:
        """Return the time [s] in which a rate within the slip speed gains as much, else NEVER."""
        # The steep friction in there, of which the Jacobian at the start tells, holds down the
        # estimate of the error too: a step that leaves it would pass as one that stays.
        slip_speed = self._equation.mechanism.slip_speed
        time: Scalar = n.where(n.fabs(rate) < slip_speed,
                               slip_speed / _larger(n, n.fabs(acceleration), 1e-300), NEVER)
        return time

    def _to_bend(self, n: NumberType, command: Scalar, values: tuple[Scalar, Scalar],
                 slopes: tuple[Scalar, Scalar]) -> Scalar:
        """Return the time [s] until the source's torque comes to its limit, where a step ends."""
        # That of the tangent. values: speed and state of the source; slopes: their derivatives by
        # time. NEVER where the torque has no limit or is beyond it for good.
        limited = self._source.limited(command)
        if limited is None:
            return NEVER
        law, limit = limited
        torque = law.torque_at(*values)
        slope = law.by_speed * slopes[0] + law.by_state * slopes[1]
        sign = n.where(slope < 0.0, -1.0, 1.0)
        torque, slope = sign * torque, n.fabs(slope)         # mirrored, so that it always rises
        gap = n.where(torque < -limit, -limit - torque, limit - torque)
        time: Scalar = n.where(gap > 0.0, gap / _larger(n, slope, 1e-300), NEVER)
        return time

    def _with_resistance(self, n: NumberType, terms: Terms, resists: Function, p: Scalar,
                         u: Scalar, torque: Scalar, felt: Any) -> Terms:
        """Return terms for the Jacobian, which lacks R: with a J and D that account for it."""
        # With them du/dt without R has the slopes by torque and rate, by differences, that it has
        # with R.
        def change(rate: Scalar, more: Scalar) -> tuple[Scalar, Scalar]:
            push = (terms.force + terms.ratio * torque + more
                    - (terms.damping + terms.half_slope * rate) * rate)
            effort = resists(p, rate, push, terms.inertia, felt).effort
            return (push - effort) / terms.inertia, n.fabs(push) + n.fabs(effort)
        here, size = change(u, 0.0)
        more = DIFFERENCE * (size + LEAST_PUSH)
        aside = u + DIFFERENCE * (n.fabs(u) + self._equation.mechanism.slip_speed)
        inertia = more / (change(u, more)[0] - here)
        damping = inertia * (here - change(aside, 0.0)[0]) / (aside - u)
        return terms._replace(inertia=inertia, damping=damping - 2.0 * terms.half_slope * u)

    def _rates(self, n: NumberType, terms: Terms, resists: Function, x: StateVector,
               command: Scalar, near: Sequence[Any] = ()) -> Rates:
        """Return dx/dt by (RB1); ``near``, the ``felt`` of a state near by, saves iterations."""
        u, v, shaft = x.rate, x.motor_speed, self._shaft
        input_rate = terms.ratio * u
        speed = v if shaft else input_rate
        law = self._source.piece(speed, x.source, n, command)
        motor_torque = torque = law.torque_at(speed, x.source)
        twist_rate = motor_acceleration = 0.0       # of a rigid shaft, whose rotor is part of J
        if shaft:
            twist_rate = v - input_rate
            torque = shaft.stiffness * x.twist + shaft.damping * twist_rate
            motor_acceleration = (motor_torque - torque) / self._rotor
        push = (terms.force + terms.ratio * torque
                - (terms.damping + terms.half_slope * u) * u)
        resistance = resists(x.position, u, push, terms.inertia, near)
        acceleration = (push - resistance.effort) / terms.inertia
        source_change = law.change_at(speed, x.source) if self._has_source_state else 0.0
        return Rates(StateVector(u, acceleration, twist_rate, motor_acceleration, source_change),
                     torque, motor_torque, law, resistance.felt)

    def _solver(self, n: NumberType, start: StepStart, g: Scalar, terms_of: Function,
                resists: Function, near: Sequence[Any] = ()
                ) -> Callable[[StateVector], StateVector]:
        """Return b -> y of (g - Jacobian at the start of the step) y = b."""
        step, x = DIFFERENCE * self.unit, start.state
        if self._equation.tables:                  # in the piece that lies ahead
            step = n.where(x.rate < 0.0, -step, step)
        aside = x._replace(position=x.position + step)
        there = self._rates(n, terms_of(aside.position), resists, aside, start.command, near)
        jacobian = self._jacobian(x, start.coefficients, (there.change.rate - start.change.rate)
                                  / (aside.position - x.position))
        solve = _eliminated([[(g if i == j else 0.0) - jacobian[i][j] for j in self._order]
                             for i in self._order])

        def solve_all(right: StateVector) -> StateVector:
            solution: list[Any] = [0.0] * 5
            for i, y in zip(self._order, solve([right[i] for i in self._order])):
                solution[i] = y
            return StateVector(*solution)
        return solve_all

    def _jacobian(self, x: StateVector, coefficients: Coefficients, by_position: Scalar
                  ) -> list[list[Scalar]]:
        """Return d(dx/dt)/dx of (RB1), rows and columns in the order of x."""
        # by_position: derivative of du/dt by p, the one entry that is not known in closed form.
        u, (J, half_slope, D, r, r_slope, T_w, T_z, d_w, d_z) = x.rate, coefficients
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


def _larger(n: NumberType, a: Scalar, b: Scalar) -> Scalar:
    larger: Scalar = n.where(a < b, b, a)
    return larger


def _plus(x: StateVector, weight: float, u: StateVector) -> StateVector:
    return StateVector(*[a + weight * b for a, b in zip(x, u)])


def _sum(x: StateVector, weights: Sequence[float], stages: Sequence[StateVector]) -> StateVector:
    """Return x + weights[0] stages[0] + weights[1] stages[1] + ..."""
    for weight, u in zip(weights, stages):
        x = _plus(x, weight, u)
    return x
