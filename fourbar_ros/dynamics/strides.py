# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of scipy's explicit integrators that end where a piece of a force table does.

With the polynomials of a piece in place of the tables the equation is smooth beyond its end. So
the time to the end is predicted, one step goes there, and a Taylor series of two terms over the
rest, a part of 1e-5 of the way or so, ends it there: a stride. A search for the end in an
interpolant, and the step again up to it, take five times as long.
"""
from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import cached_property
from math import copysign, inf
from typing import Any, NamedTuple

from fourbar_ros.dynamics.equation import Equation, REACH
from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function

LANDED = 1e-3          # rest over the way that is left to the Taylor series, at most
LANDINGS = 4           # tries to come so near
MOST_STEPS = 8         # of a solver in a stride: it is for smooth motion alone
SLOWEST = 0.1          # rate in a stride over that at its start, at least: it does not turn back


class Step(NamedTuple):
    """A step of an integrator."""

    time: float            # where it ends [s]
    state: Array           # there
    between: Any = None    # its interpolant: times -> states; None of the start


class LateInterpolant:
    """The interpolant of the last step of a solver, made when it is first asked for."""

    def __init__(self, solver: Any) -> None:
        self._solver = solver

    @cached_property
    def made(self) -> Any:
        return self._solver.dense_output()

    def __call__(self, times: Any) -> Any:
        """Return the states at times."""
        return self.made(times)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle what is made: a solver cannot be pickled."""
        return copy, (self.made,)


class Strider:
    """Makes one stride after the other in the input."""

    # rates_of: terms -> (time, state) -> rates, with these Terms of the equation. sure: a stride
    # is so short that the tolerances allow a step so many times as long.

    def __init__(self, equation: Equation, rates_of: Callable[[Function], Function], method: str,
                 rtol: float, atol: float, sure: float) -> None:
        from scipy import integrate
        self._pieces, self._rates_of, self._sure = equation.table_pieces, rates_of, sure
        self._solver, self._tolerances = getattr(integrate, method), {'rtol': rtol, 'atol': atol}
        self._reach = self._longest = REACH * equation.coordinate.input_unit

    def stride(self, start: Step, last: float) -> list[Step]:
        """Return the steps to the end of a piece, over a way in it or to the last time [s]."""
        # None where the input may turn back, or no step is short enough.
        (position, rate), first = start.state[:2].tolist(), start.time
        whole = self._pieces.end_ahead(position, rate) - position
        to_end = abs(whole) <= self._longest
        way = whole if to_end else copysign(min(self._longest, 0.5 * abs(whole)), rate)
        try:
            rates = self._rates_of(self._pieces.terms_about(position + 0.5 * way))
        except FourBarError:        # a piece that ends out of reach
            return []

        def begin() -> Any:
            return self._solver(rates, first, start.state, last, first_step=last - first,
                                **self._tolerances)
        solver = begin()
        change = solver.f
        length = _time_over(way, rate, change[1])
        if length < inf:        # of an acceleration that changes evenly
            later = rates(first + length, start.state + length * change)[1]
            length = _time_over(way, rate, (2.0 * change[1] + later) / 3.0)
        for _ in range(LANDINGS):
            solver.t_bound = min(first + length, last)
            steps = _steps(solver) if first < solver.t_bound < inf else []
            if not steps or min(step.state[1] / rate for step in steps) < SLOWEST:
                break
            gone, spent = solver.y[0] - position, solver.t - first
            self._longest = min(abs(gone) * solver.h_abs / (spent * self._sure), self._reach)
            left = way - gone
            if (left * rate >= 0.0 and solver.t == last
                    or not to_end and (whole - gone) * rate > 0.0):
                return steps
            if abs(left) <= LANDED * abs(way):
                late = _time_over(left, solver.y[1], solver.f[1])
                state = solver.y + late * (
                    solver.f + 0.5 * late / spent * (solver.f - change))
                return [*steps[:-1], Step(solver.t + late, state, steps[-1].between)]
            length, solver = length + left / solver.y[1], begin()
        return []


def _steps(solver: Any) -> list[Step]:
    """Return the steps of a solver to its bound; none where one fails, or they are many."""
    steps = list[Step]()
    try:
        while solver.status == 'running' and len(steps) < MOST_STEPS:
            solver.step()
            is_last = solver.t == solver.t_bound
            steps.append(Step(solver.t, solver.y, LateInterpolant(solver) if is_last
                              else solver.dense_output()))
    except ArithmeticError:         # evaluations are used up
        return []
    return steps if solver.status == 'finished' else []


def _time_over(way: float, rate: float, change: float) -> float:
    """Return the time for a way at a rate that changes evenly; infinite if it nearly ends."""
    square = rate * rate + 2.0 * change * way       # of the rate at the end of the way
    if not square > (SLOWEST * rate)**2:
        return inf
    return float(2.0 * way / (rate + copysign(square**0.5, rate)))
