# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The legs of one integration, by solve_ivp.

A leg is one coordinate (:mod:`fourbar_ros.dynamics.coordinate`) and one stretch between jumps of
the torque; it ends at a limit, where another coordinate takes over near a toggle, or at a point of
a force table. A crank that turns fully goes over many such points in one leg, by steps in the
input (:mod:`.piece_steps`). DOP853 integrates, or LSODA where friction makes the system stiff.
"""
from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from math import copysign, inf, isfinite, log2, nan, nextafter
from threading import Lock
import time as clock
from typing import Any, NamedTuple
import warnings

from fourbar_ros.dynamics.coordinate import MotionCoordinate
from fourbar_ros.dynamics.piece_steps import BetweenSteps, InputStep, steps_over_pieces
from fourbar_ros.dynamics.run import (
    AT_KINK,
    EVENT,
    EXPLICIT,
    HANDED_OVER,
    Leg,
    LIMIT,
    REACHED,
    STOPPED,
)
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, Locked
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.optional import MissingPackage
import numpy as np

Stop = Callable[[float, Any], float]      # (time, state) -> number, zero where a run stops
FIRST_TRY = 0.1            # part of the evaluations after which LSODA takes the place of DOP853
# A run is judged after that part, or so many at least: if each quarter took it hardly farther than
# the one before, and it needs so many times what is left, it is given up.
LEAST_JUDGED, SLOWER, HOPELESS = 10_000, 1.1, 1.2
HUGE = 1e100               # states and derivatives beyond it count as not finite
WITHIN_A_STEP = 5000       # evaluations beyond the bound after which a step is broken off
LONGER = 1.01              # first step in a piece of a table over the time in the one before
AHEAD = 1e-7               # way over the unit, and rate over the slip speed, to just after a start
NONE_AHEAD = 1e-9          # what is not smooth at less is so at the start already
SAME = 1e-12               # how far beyond a piece of a table a leg ends
_LSODA = Lock()            # before scipy 1.17 it serves one thread at a time


class Integration(NamedTuple):
    """How a run is integrated."""

    method: str                 # of scipy
    tolerance: float            # of the method
    # whether steps end in the middle of a piece of a table, and of a stretch between jumps of the
    # torque: not where they else would
    cuts_pieces: bool = False


@dataclass
class Work:
    """What a simulation is asked for, what all of its runs may use, and what they have used."""

    system: System
    until: float                   # end of a run [s]
    asked: Array | None            # times at which it is wanted [s]
    stop_when: Stop | None
    evaluations: float             # most evaluations of the equation of motion
    seconds: float                 # most time [s]
    progress: Callable[[float], None] | None     # called with the share of a run, 0 to 1
    most: float = inf              # evaluations after which the run at hand ends
    first: int = 0                 # evaluations before the run at hand
    marks: list[float] = field(default_factory=list)    # times of quarters before it is judged [s]
    used: int = 0                  # evaluations so far
    began: float = field(default_factory=clock.monotonic)
    reason: str = ''               # why a run was given up
    locked: Locked | None = None   # the last state that was tried in which friction locks

    def is_spent(self, time: float) -> bool:
        """Return whether a run must be given up at a time [s]; ``reason`` then says why."""
        if self.progress is not None:
            self.progress(time / self.until)
        judged, is_fourth = max(FIRST_TRY * self.evaluations, LEAST_JUDGED), False
        while len(self.marks) < 4 and (
                self.used - self.first >= 0.25 * judged * (len(self.marks) + 1)):
            self.marks.append(time)
            is_fourth = len(self.marks) == 4
        if self.used > self.most:
            self.reason = f'{self.evaluations:.0f} evaluations are used up at {time:.6g} s'
        elif is_fourth and 0.0 < self.marks[1] < time:
            steps = np.diff([0.0, *self.marks])
            # ever slower, and on as the time grows with a power of the evaluations
            missing = judged * ((self.until / time)**(1.0 / log2(time / self.marks[1])) - 1.0)
            if (steps[1:] <= SLOWER * steps[:-1]).all() and (
                    missing > HOPELESS * (self.evaluations - self.used)):
                self.reason = (f'at {time:.6g} s about {missing:.1g} evaluations are still '
                               f'needed: ask for evaluations={2.0 * (missing + self.used):.1g}')
        elif clock.monotonic() - self.began > self.seconds:
            self.reason = f'{self.seconds:g} s are used up at {time:.6g} s'
        return bool(self.reason)

    def counted(self, derivative: Callable[..., Any], until: float) -> Callable[..., Any]:
        """Return a derivative as integrators take it, up to a time ``until`` [s]."""
        # It counts calls, has the torque of just before until, where it may jump, and gives NaN
        # for an error or a huge number: the integrator then takes a shorter step.
        latest = nextafter(until, -inf)

        def rates(time: float, state: Array) -> list[float]:
            self.used += 1
            if self.used > self.most + WITHIN_A_STEP:
                raise ArithmeticError('evaluations are used up within a step')
            change = [nan]
            try:
                change = list(derivative(min(time, latest), state.tolist()))
            except Locked as error:
                if isfinite(state[0]):
                    self.locked = error
            except (FourBarError, ArithmeticError):
                pass
            is_good = min(change) > -HUGE and max(change) < HUGE
            return change if is_good else [nan] * state.size
        return rates


class Event(NamedTuple):
    """Something that ends a leg of a run."""

    function: Callable[..., float]       # (time, state in the coordinate) -> number: at its zeros
    end: str                             # how the leg then ends, as LIMIT
    direction: float = 0.0               # 1: where it rises, -1: where it falls, 0: both
    before: float | None = None          # its value at the start, if not that of the function


def integrate(work: Work, integration: Integration) -> Iterator[Leg]:
    """Yield the legs of a run from time 0, to its end or to where it stops."""
    system, stop_when, cuts_pieces = work.system, work.stop_when, integration.cuts_pieces
    jumps = [time for time in (system.drive.source.breaks if system.drive else ())
             if 0.0 < time < work.until] + [work.until]       # of the torque [s]
    if cuts_pieces and len(jumps) > 1:
        jumps = sorted([*jumps, *(0.5 * (a + b) for a, b in zip([0.0, *jumps], jumps))])
    (coordinate, state), first = system.coordinates.begin(system.start), 0.0
    stop_value = nan         # last value of stop_when that is not zero: no run stops at its start
    leg: Leg | None = None
    # when the input came to the piece of a table in which it is, and how long it was in the one
    # before; 0: not known [s]
    begun, length = 0.0, 0.0
    while first < work.until:
        if leg and leg.end == HANDED_OVER:
            coordinate, state = coordinate.next(state)
        equation, method = coordinate.equation, integration.method
        events = [*_limits(system, coordinate), _watch(work, first)]
        if coordinate.can_end:
            events.append(Event(coordinate.excess, HANDED_OVER, 1.0))
        if equation.has_resistance:
            beyond = abs(state[1]) / system.mechanism.slip_speed - 1.0
            is_slow = beyond < 0.0 if abs(beyond) > AHEAD else bool(
                coordinate.derivative(first, state)[1] * state[1] < 0.0)
            events.append(_not_smooth(system, coordinate, first, state, is_slow))
            if is_slow and method in EXPLICIT:      # friction is stiff there
                method = 'LSODA'
        if stop_when is not None:
            stop = _of_input(coordinate, stop_when)
            if first == 0.0:
                stop_value = _unless_zero(stop(first, np.array(state)), nan)
            events.append(Event(stop, EVENT, before=stop_value))
        last = jumps[bisect_right(jumps, first)]
        # where steps in the input have ended, a leg in time goes on to the end of the piece
        was_in_input, leg = leg is not None and isinstance(leg.between, BetweenSteps), None
        if equation.has_position_forces:
            if method in EXPLICIT and system.mechanism.turns_fully and not (
                    was_in_input or equation.has_resistance):
                leg = _leg_over_pieces(coordinate, (first, last), state, integration, work, events)
            excess = equation.make_excess(state[0])
            events.append(Event(lambda time, state, excess=excess: excess(float(state[0])) - SAME,
                                AT_KINK, direction=1.0))
        if leg:
            steps_of_piece = 2 if cuts_pieces else 1
            begun = float(leg.time[max(-leg.time.size, -1 - steps_of_piece)])
        else:
            # The piece takes about as long as the one before. Were the first step exactly so long,
            # it would end at the end of the piece, and scipy before 1.12 would stop there.
            share = 0.5 if cuts_pieces else 1.0
            if cuts_pieces and first < begun + share * length < last:
                last = begun + share * length
            leg = _leg(coordinate, (first, last), state, integration._replace(method=method), work,
                       events, LONGER * share * length)
        if leg.time[-1] <= nextafter(first, inf):       # nothing goes on
            if leg.end == HANDED_OVER:                  # of two coordinates to each other
                leg = leg._replace(end=LIMIT)
            elif leg.end == AT_KINK:
                work.reason = _why_no_step(work, method, first)
                leg = leg._replace(end=STOPPED)
        yield leg
        first, state = float(leg.time[-1]), leg.states[:, -1].tolist()
        if leg.end == AT_KINK and equation.has_position_forces:
            length, begun = first - begun, first
        elif leg.end in (AT_KINK, HANDED_OVER):
            length = 0.0
        elif leg.end != REACHED:
            return
        if stop_when is not None:
            stop_value = _unless_zero(stop(first, leg.states[:, -1]), stop_value)


def _unless_zero(value: float, instead: float) -> float:
    return instead if value == 0.0 else value


def _leg(coordinate: MotionCoordinate, span: tuple[float, float], state: list[float],
         integration: Integration, work: Work, events: list[Event], step: float) -> Leg:
    """Return the leg from a state over a span of time, or to the first of the events."""
    # step: the first one [s]; 0: as the method has it
    start = np.array(state)
    rates = work.counted(coordinate.derivative, span[1])
    result = _solved(rates, span, start, integration, dense_output=True,
                     events=[_remembered(event, span[0]) for event in events],
                     first_step=min(step, span[1] - span[0]) or None)
    if result is None or result.t.size < 2 or not np.all(np.abs(result.y) < HUGE):
        work.reason = _why_no_step(work, integration.method, span[0])
        return Leg(coordinate, np.array(span[:1]), start[:, None],
                   lambda times: np.repeat(start[:, None], times.size, 1), STOPPED)
    end = REACHED
    if result.status == 1:
        end = next(event.end for event, times in zip(events, result.t_events) if times.size)
    elif result.status == -1:
        end, work.reason = STOPPED, _why_no_step(work, integration.method, float(result.t[-1]))
    length = result.t[-1] - result.t[-2]
    if end in (HANDED_OVER, AT_KINK) and length > 0.0:
        # where the run goes on a step is more exact than the interpolant
        last = _solved(rates, result.t[-2:], result.y[:, -2], integration, first_step=length)
        if last is not None and last.status == 0:
            result.y[:, -1] = last.y[:, -1]
    return Leg(coordinate, result.t, result.y, result.sol, end)


def _leg_over_pieces(coordinate: MotionCoordinate, span: tuple[float, float], state: list[float],
                     integration: Integration, work: Work, events: list[Event]) -> Leg | None:
    """Return the leg in steps of the input, up to that in which an event is; None: no step."""
    steps, start = list[InputStep](), np.array(state)
    before = [event.function(span[0], start) if event.before is None else event.before
              for event in events]
    try:
        for step in steps_over_pieces(
                coordinate, span, start, getattr(_integrators(), integration.method),
                integration.tolerance, 0.5 if integration.cuts_pieces else 1.0, work.counted):
            after = [event.function(step.time, step.state) for event in events]
            if any(map(_is_passed, events, before, after)):
                break
            steps.append(step)
            before = after
    except ArithmeticError:         # evaluations are used up, as the next leg says
        pass
    if not steps:
        return None
    times = np.array([span[0], *[step.time for step in steps]])
    return Leg(coordinate, times, np.array([start, *[step.state for step in steps]]).T,
               BetweenSteps(times, steps), AT_KINK)


def _is_passed(event: Event, before: float, after: float) -> bool:
    """Return whether an event is between two of its values, as solve_ivp has it."""
    return (before <= 0.0 <= after and event.direction >= 0.0
            or before >= 0.0 >= after and event.direction <= 0.0)


def _why_no_step(work: Work, method: str, time: float) -> str:
    why = f': {work.locked}' if work.locked else ''
    return f'no step of {method} is short enough at {time:.6g} s{why}'


def _integrators() -> Any:
    try:
        from scipy import integrate
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error
    return integrate


def _solved(rates: Callable[..., Any], span: Sequence[float], start: Array,
            integration: Integration, **options: Any) -> Any:
    """Return the result of solve_ivp, or None where numbers overflow."""
    solve_ivp, method, tolerance = _integrators().solve_ivp, *integration[:2]
    with warnings.catch_warnings(), _LSODA if method == 'LSODA' else nullcontext():
        warnings.simplefilter('ignore')      # of what the end of the leg says
        try:
            return solve_ivp(rates, span, start, method, rtol=max(tolerance, 100.0 * EPS),
                             atol=tolerance, **options)
        except ArithmeticError:
            return None
        except ValueError as error:          # of a Jacobian
            if 'infs or NaNs' in str(error):
                return None
            raise


def _limits(system: System, coordinate: MotionCoordinate) -> list[Event]:
    """Return the event, if any, at which the input comes to an end of its range or stroke."""
    passes_toggles = coordinate.can_end or system.mechanism.turns_fully

    def limit(time: float, state: Any) -> float:
        position = float(coordinate.states_of_input(np.asarray(state))[0])
        return (system.distance_to_end(position) if passes_toggles
                else system.distance_to_limit(position))
    is_limited = not passes_toggles or system.has_stroke
    return [Event(limit, LIMIT, -1.0)] if is_limited else []


def _remembered(event: Event, first: float) -> Callable[..., float]:
    """Return an event as solve_ivp takes it, with one value for each time."""
    # Its search for the zero in a step then finds the values that it found at the ends of the
    # step, though the interpolant differs from the step by rounding.
    known = {} if event.before is None else {first: event.before}

    def function(time: float, state: Array) -> float:
        if time not in known:
            known[time] = event.function(time, state)
        return known[time]
    vars(function).update(terminal=True, direction=event.direction)     # as solve_ivp reads them
    return function


def _watch(work: Work, first: float) -> Event:
    """Return an event in the middle of the step in which the work that is allowed is done."""
    before, stop = first, inf

    def left(time: float, state: Array) -> float:
        nonlocal before, stop
        if time > before:          # the end of a step, not the search within it
            if work.is_spent(time):
                stop = 0.5 * (before + time)
            before = time
        return min(stop - time, 1.0)
    return Event(left, STOPPED, -1.0)


def _not_smooth(system: System, coordinate: MotionCoordinate, time: float, state: list[float],
                is_slow: bool) -> Event:
    """Return the event at which R of (E9) is not smooth: there the integrator starts anew."""
    # There the input passes the slip speed, or one of the edges of Resistance changes its sign: a
    # joint turns back, or a guide changes the face that bears.
    resisting = system.make_resisting(coordinate)

    def edges_at(time: float, state: Sequence[float]) -> Sequence[float]:
        try:
            return resisting(time, state)[1]
        except (FourBarError, ArithmeticError):      # no step of the integrator ends there
            return ()
    # the start may be such an event itself: the signs are read a little ahead, and an edge that
    # is zero there too ends nothing (its sign is 0)
    position, rate, *rest = state
    ahead = position + copysign(AHEAD * coordinate.equation.coordinate.input_unit, rate)
    signs = [copysign(1.0, edge) if abs(edge) > NONE_AHEAD else 0.0
             for edge in edges_at(time, [ahead, rate, *rest])]
    # one at which the leg before ended has just changed, though its sign follows from rates too
    for i, edge in enumerate(edges_at(time, state) if signs else ()):
        if 0.5 * SAME < abs(edge) < 2.0 * SAME:
            signs[i] = copysign(1.0, edge)

    def excess(time: float, state: Array) -> float:     # negative until the event
        beyond = abs(state[1]) / system.mechanism.slip_speed - 1.0
        changed = [-sign * edge for sign, edge in zip(signs, edges_at(time, state.tolist()))]
        return float(max([beyond if is_slow else -beyond, *changed])) - SAME
    return Event(excess, AT_KINK, direction=1.0)


def _of_input(coordinate: MotionCoordinate, stop_when: Stop) -> Stop:
    return lambda time, state: finite('stop_when', stop_when(
        time, coordinate.states_of_input(np.asarray(state))))
