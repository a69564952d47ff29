# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of given length in one coordinate: stable whatever the stiffness, of bounded work.

A Rosenbrock method (:mod:`fourbar_ros.dynamics.step.rosenbrock`) takes one step over the whole
length, or shorter steps if its error is too large. The Jacobian of (N1), see
:mod:`fourbar_ros.dynamics.step.step_equations`, is exact, except for the derivative of the
acceleration by the coordinate, a finite difference. The next state follows from the state alone,
so a state read from a bag gives the same. The terms at the last position are kept only to save
time. :mod:`fourbar_ros.dynamics.step.mover` goes from one coordinate to the other at toggles.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import isfinite, nan

from fourbar_ros.dynamics.model.drives import (
    always,
    ConstantTorque,
    Drive,
    Law,
    NEAREST,
    Piece,
    Regime,
    RegimeAt,
)
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.phase import Phase
from fourbar_ros.dynamics.step.rosenbrock import EVALUATIONS, Rosenbrock
from fourbar_ros.dynamics.step.step_equations import Elastic, plus, Rigid, State, Terms
from fourbar_ros.errors import FourBarError, InvalidParameter

DIFFERENCE = 1e-7          # step of the coordinate for the column of the Jacobian, in its unit
SMALLEST, LARGEST, SAFETY = 0.1, 4.0, 0.85      # next step over this one: bounds, factor
SHORTEST, BISECTIONS = 1e-3, 40      # part of a step, in the search for a kink
CLOSEST = 1e-6                       # through toggles: part that a kink may be off
DEEPEST, SHORTER = 50.0, 0.3         # excess of a phase after a step; else it becomes shorter
RESERVE = 2                          # evaluations with which another coordinate finishes a step
Part = tuple[State, float, bool]     # result of :meth:`PhaseSteps.part`


class PhaseSteps:
    """
    Steps of a system in one coordinate.

    ``tolerance``, ``budget``: as of :class:`~fourbar_ros.dynamics.step.mover.Mover`. ``phase``:
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
        self._regime_at = self._drive.source.make_regime_at()
        shaft, rotor = self._drive.shaft, self._drive.rotor
        self._motor = 3 if shaft else 1            # place of the speed behind the gear
        self._is_input = equation.is_input
        self._equations: Elastic | Rigid = Elastic(shaft, rotor) if shaft else Rigid()
        has_own = bool(self._drive.source.start)

        self._attempt = cache(lambda tangent: Rosenbrock(equation, self._equations, has_own,
                                                         tangent))
        self._attempt(self._regime_at(0.0, 0.0).tangent)      # which takes long
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
        piece = self.regimes(command)(speed, own).piece_at(speed)
        terms = self._terms_at(state[0])
        change = self._equations.derivative(terms, state, piece)
        return (self._slope(terms, state, change), self._equations.on_input(terms, state, piece),
                piece.torque_at(speed, own))

    def part(self, state: State, left: float, regime_at: RegimeAt) -> Part:
        """
        Return (state, time left, is_good) after ``left`` seconds, or after a part of them.

        Time is left [s] where another coordinate has to take over. ``is_good``: the error is
        within the tolerance; if not and time is left, this coordinate cannot finish within the
        budget. ``regime_at``: of the source, by :meth:`regimes`. Steps that fail are made shorter;
        one that passes a kink of the source ends there. Raises FourBarError and ArithmeticError.
        """
        h, closest, near = left, CLOSEST * left if self._phase else 0.0, self._tolerance / left
        longest = 0.0
        while left > 0.0:
            regime, state = self._begun(state, regime_at, near)
            terms, change, by_position = self._linear(state, regime.piece)
            excess = self._equation.make_excess(state[0]) if self._equation.tables else None
            while True:
                h = min(h, left)
                if excess:
                    longest, h = h, h * _to_place(excess, state[0], h * state[1])
                more = 0 if h == left else 2 + EVALUATIONS
                if self.evaluations + EVALUATIONS + more > self._budget:
                    return self._rest(state, left, regime, terms, by_position)
                new, scale = self._try(state, h, terms, by_position, regime)
                if scale >= 1.0:
                    to_kink = (self._to_kink(state, new, h, self._gain(terms, state, change),
                                             regime) if regime.margins else 1.0)
                    if excess:
                        to_kink = min(to_kink, _to_place(excess, state[0], h * state[1],
                                                         new[0] - state[0] - h * state[1]))
                    if to_kink == 1.0 or h <= closest:
                        break
                    scale = max(to_kink, closest / h)
                h *= scale
            state, left, h = new, left - h, max(h * scale, longest)
            if self._phase and left > 0.0 and self._phase.excess(0.0, state) > 0.0:
                break
        return state, left, True

    def regimes(self, command: float | None) -> RegimeAt:
        """Return the law of the source during a step: its own, or a commanded torque [N m]."""
        return self._regime_at if command is None else always(Piece(command))

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

    def _begun(self, state: State, regime_at: RegimeAt, near: float) -> tuple[Regime, State]:
        """
        Return the regime of the source from a state on, and the state.

        A state that slides is put on the limit.
        A smooth law is replaced by its tangent at this speed. ``near``: error of the speed.
        """
        speed, own = self._speed(state), state[4]
        regime = regime_at(speed, own)
        if regime.margins:
            terms = self._terms_at(state[0])
            change = self._equations.derivative(terms, state, regime.piece)
            regime = regime_at(speed, own, self._gain(terms, state, change), near)
        if regime.tangent:
            regime = regime._replace(piece=regime.tangent(speed))
        return regime, self._on_edge(state, regime)

    def _on_edge(self, state: State, regime: Regime) -> State:
        """Return a state; of a source that slides along its torque limit the own state by (M2)."""
        if regime.edge is None:
            return state
        return (*state[:4], regime.own(self._speed(state), state[4]))

    def _gain(self, terms: Terms, state: State, change: State) -> float:
        """Return the derivative of the speed of the motor behind the gear."""
        return change[3] if self._motor == 3 else self._slope(terms, state, change)

    def _rest(self, state: State, left: float, regime: Regime, terms: Terms,
              by_position: float) -> Part:
        """
        Return the state after all the time left in one step, as the budget is used up.

        It is a Rosenbrock step if an evaluation is left for it, else implicit Euler. Both are
        stable: the error is bounded, but above the tolerance.
        """
        if self.evaluations + EVALUATIONS <= self._budget:
            new, scale = self._try(state, left, terms, by_position, regime)
            if scale > SMALLEST and (not self._phase or self._is_here(new)):
                return new, 0.0, False
        change = self._equations.derivative(terms, state, regime.piece)
        solver = self._equations.linear(terms, state, regime.piece, by_position)
        new = plus(state, 1.0, solver(1.0 / left)(change))       # implicit Euler
        new = self._on_edge(new, regime)
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
             regime: Regime) -> tuple[State, float]:
        """
        Return the state after one Rosenbrock step of ``h`` seconds, and the next length over it.

        Below 1 the step failed and is made again that much shorter: its error is too large, or it
        left the range of the coordinate. The fourth root follows from the order of the method.
        """
        self.evaluations += EVALUATIONS
        try:
            found = self._attempt(regime.tangent)(state, h, terms, by_position, regime.piece)
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
        return self._on_edge(new, regime), min(LARGEST, max(SMALLEST, longer))

    def _to_kink(self, state: State, new: State, h: float, gain: float, regime: Regime) -> float:
        """
        Return the part of a step, in (0, 1], after which the regime of the source ends.

        1: it holds. Bisection finds it, with a quadratic speed between both ends (``gain``: its
        derivative at the start) and a linear own state of the source.
        """
        speed, own, gain, margins = self._speed(state), state[4], h * gain, regime.margins
        bend = self._speed(new) - speed - gain
        assert margins is not None
        least = [min(0.0, margin) for margin in margins(speed, own, gain / h)]

        def ends_before(part: float) -> bool:
            """Return whether a margin is below zero after this part of the step."""
            there = speed + part * (gain + part * bend)
            found = margins(there, regime.own(there, own + part * (new[4] - own)),
                            (gain + 2.0 * part * bend) / h)
            return any(margin < low - NEAREST for margin, low in zip(found, least))
        if not ends_before(1.0):
            return 1.0
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            part = 0.5 * (low + high)
            low, high = (low, part) if ends_before(part) else (part, high)
        return max(high, SHORTEST) if high < 1.0 - SHORTEST else 1.0


def _to_place(excess: Callable[[float, bool], float], position: float, gain: float,
              bend: float = 0.0) -> float:
    """
    Return the part of a step, in (0, 1], after which a force table comes to its next piece.

    1: it comes to none. The position is quadratic: after a part x of the step it is
    ``position`` + x (gain + x bend).
    """
    if not excess(position + (gain + bend), False) > NEAREST:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        part = 0.5 * (low + high)
        if excess(position + part * (gain + part * bend), False) > NEAREST:
            high = part
        else:
            low = part
        if high - low <= SHORTEST * high:
            break
    return high if high < 1.0 - SHORTEST else 1.0
