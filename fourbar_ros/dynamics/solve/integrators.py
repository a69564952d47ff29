# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
scipy's integrators behind one function.

Each part of a run, between jumps and kinks of the torque and in one coordinate, is an integration
of its own. Every 50 steps a test tells whether stability, not accuracy, limits the steps of
DOP853. Then LSODA goes on, and Radau if LSODA fails. A free motion is projected back to its energy
every 50 steps (Hairer, Lubich and Wanner, Geometric Numerical Integration, section IV.4): its
errors then do not add up in the energy.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf, nan, nextafter
from threading import Lock
import time as clock
from typing import Any, NamedTuple
import warnings

from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.phase import (
    AT_EVENT,
    AT_LIMIT,
    COMPLETE,
    Event,
    GAVE_UP,
    HANDED_OVER,
    Phase,
    PROJECTED,
)
from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.given import number
from fourbar_ros.optional import MissingPackage
import numpy as np

Stop = Callable[[float, Any], float]      # (time, state) -> number, zero where a run stops
METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
NEXT = {'DOP853': 'LSODA', 'LSODA': 'Radau'}      # which method goes on where one struggles
# other ends of a part: at a kink of the drive; steps as long as stability allows; more evaluations
# than the method before; no step short enough
KINK, STIFF, SLOWER, FAILED = 'at a kink', 'stiff', 'slower than the one before', 'failed'
MOST_STEPS = 10**8
PROJECT_EVERY = JUDGE_EVERY = 50      # steps
STABLE = 3.0            # step times fastest mode, above which a step does not follow that mode
MOST_STOPS = 32         # times at which the compiled integrator stops rather than interpolates
HUGE = 1e100            # states and derivatives beyond it count as not finite
# a run is given up after so many evaluations if all would be so many times those allowed, or if
# in so many the time grows by less than this part of the run, or of the time up to then
EARLY, FAR = 200_000, 1.5
WINDOW, LEAST = 50_000, 1e-6
TRIED = 3_000            # evaluations after which the pace of a method is judged
MOST_TINY = 20          # steps one after the other that hardly change the time
SAME = 1e-12            # distance behind a kink at which a regime has ended
LOOKS = 8               # of a function at whose zeros a run stops, in each step
SHORTEST = 16.0 * EPS   # step over the time
_LSODA = Lock()         # before scipy 1.17 it serves one thread at a time


class Part(NamedTuple):
    """A part of a run, in one coordinate."""

    phase: Phase
    time: Array             # [s], (n,)
    states: Array           # in the coordinate of the phase, (states, n)
    end: str                # how it ended: COMPLETE, AT_LIMIT, STIFF, ...
    step: float = 0.0       # the last step of the integrator [s]
    given: float = 0.0      # energy that projections gave before this part [J]

    def at(self, places: Any) -> Part:
        """Return the part at some of its times, by index or mask."""
        return self._replace(time=self.time[places], states=self.states[:, places])


class Result(NamedTuple):
    """One whole integration."""

    parts: tuple[Part, ...]
    end: str                                   # how the last part ended
    methods: tuple[tuple[float, str], ...]     # each with the time of its first use [s]

    @property
    def time(self) -> Array:
        """Return the times [s]."""
        return np.concatenate([part.time for part in self.parts])

    @property
    def states(self) -> Array:
        """Return the states in the input of the mechanism, of shape (states, n)."""
        return np.concatenate([part.phase.states_of_input(part.states) for part in self.parts],
                              axis=1)


@dataclass
class Allowance:
    """Budget of all runs of a simulation together, and its use so far."""

    until: float                   # end of a run [s]
    evaluations: float = inf       # most evaluations of the equation of motion
    seconds: float = inf           # most time [s]
    progress: Callable[[float], None] | None = None     # called with the share of a run, 0 to 1
    may_stop: bool = False         # a run may end long before: its length does not tell its cost
    used: int = 0                  # evaluations so far
    reason: str = ''               # why a run was given up
    _before: int = 0
    _window: tuple[int, float] = (0, 0.0)
    _began: float = field(default_factory=clock.monotonic)

    def begin(self) -> None:
        """Begin another run of the same simulation."""
        self._before, self._window = self.used, (self.used, 0.0)

    def ends(self, time: float) -> bool:
        """Return whether a run must be given up at a time [s]; ``reason`` then says why."""
        share = time / self.until
        if self.progress is not None:
            self.progress(share)
        of_run = self.used - self._before
        if self.used > self.evaluations:
            self.reason = f'{self.evaluations:.0f} evaluations are used up'
        elif clock.monotonic() - self._began > self.seconds:
            self.reason = f'{self.seconds:g} s are used up'
        elif not self.may_stop and of_run > EARLY and of_run > FAR * self.evaluations * share:
            self.reason = (f'the whole run would take about {of_run / max(share, 1e-300):.0e} '
                           f'evaluations, and {self.evaluations:.0e} are allowed')
        elif self.used > self._window[0] + WINDOW:
            if share < self._window[1] + LEAST * (share if self.may_stop else 1.0):
                self.reason = f'{WINDOW} evaluations lead hardly any further'
            self._window = self.used, share
        return bool(self.reason)


class Task(NamedTuple):
    """Task of one call of an integrator."""

    phase: Phase
    derivative: Callable[..., Any]
    events: list[Event]
    kinks: Callable[..., tuple[float, ...]] | None      # margins of the regime, if it has any
    start: Sequence[float]
    first: float
    last: float
    method: str
    tolerance: float
    stops: Array            # times at which an integration restarts, with those on its way
    asked: Array            # times that the part must contain
    allowance: Allowance
    is_projected: bool
    judges: bool            # it ends where it is stiff
    pace: float             # it ends if it takes more evaluations for a second than so many
    step: float             # the first one [s]; 0: the integrator chooses
    compiled: str           # the compiled method


def integrate(system: System, method: str, tolerance: float, asked: Array, allowance: Allowance,
              stop_when: Stop | None = None, is_finer: bool = False) -> Result:
    """
    Integrate a system from time 0, part by part, to the end or to where the run stops.

    ``tolerance``: relative and absolute, of every state. ``asked``: times that the result must
    contain. ``stop_when``: (time, state of the input) -> number at whose zeros after the start the
    run ends. ``is_finer``: it also restarts between jumps of the torque, so that two runs differ.
    """
    allowance.begin()
    plan = _Plan(system, method, tolerance, asked, allowance, stop_when, is_finer)
    (phase, state), first, given = system.course.at(system.start), 0.0, 0.0
    parts: list[Part] = []
    energy = phase.energy(state) if system.is_conservative else None
    while first < allowance.until:
        if parts and parts[-1].end == HANDED_OVER:
            phase, state = phase.next(state)
        part = plan.part(phase, state, first)
        # two coordinates that hand over to each other at one time: nothing goes on
        stands = part.end == HANDED_OVER and part.time[-1] <= nextafter(first, inf)
        parts.append(part._replace(given=given, end=AT_LIMIT if stands else part.end))
        state, first, end = part.states[:, -1].tolist(), float(part.time[-1]), parts[-1].end
        if end not in (COMPLETE, KINK, PROJECTED, HANDED_OVER) and not plan.changes(end):
            break
        if energy is not None:
            before, state = phase.energy(state), phase.with_energy(state, energy)
            given += phase.energy(state) - before
        if first < allowance.until and allowance.ends(first):
            parts[-1] = parts[-1]._replace(end=GAVE_UP)
            break
    end, last = parts[-1].end, plan.methods[-1][1]
    if end in (STIFF, FAILED):
        allowance.reason = (f'no step of {last} is short enough' if end == FAILED
                            else f'too stiff for {last}')
    return Result(tuple(parts), {STIFF: GAVE_UP, FAILED: GAVE_UP, KINK: COMPLETE}.get(end, end),
                  tuple(plan.methods))


class _Plan:
    """
    Integrates one part of a run after the other: chooses methods, restarts and tolerances.

    ``methods``: the methods used so far, each with the time of its first use [s].
    """

    def __init__(self, system: System, method: str, tolerance: float, asked: Array,
                 allowance: Allowance, stop_when: Stop | None, is_finer: bool) -> None:
        """Find the times of restarts: where the torque jumps or bends."""
        self._system, self._method, self._tolerance = system, method, tolerance
        self._asked, self._allowance, self._is_finer = asked, allowance, is_finer
        self._stop_when, self._stop_value = stop_when, nan      # its last value that was not zero
        self._breaks = _restarts(system, allowance.until, is_finer)
        self._step = (float(np.median(np.diff(self._breaks))) if self._breaks.size > MOST_STOPS
                      else 0.0)
        self._chosen: dict[Any, str] = {}        # methods of regimes
        self._paces: dict[Any, float] = {}       # evaluations for a second of DOP853 there
        self.methods: list[tuple[float, str]] = []

    def part(self, phase: Phase, state: Sequence[float], first: float) -> Part:
        """
        Return the part of the run that begins at a state [in the phase] and a time [s].

        It ends where the drive has a kink, another coordinate takes over, or the method struggles.
        The compiled DOP853 serves where nothing has to be located within a step: it costs a tenth.
        """
        system, asked, last = self._system, self._asked, self._allowance.until
        self._regime = regime = system.regime(phase, first, state)
        tables = phase.equation.tables      # they bend forces: a high order does not help
        self._now = now = (self._chosen.setdefault(regime, 'LSODA' if tables else 'DOP853')
                           if self._method == 'auto' else self._method)
        if not self.methods or self.methods[-1][1] != now:
            self.methods.append((first, now))
        stop = self._make_stop(phase, first, state)
        events = [*system.events(phase), *([stop] if stop else [])]
        stops = self._breaks[(self._breaks > first) & (self._breaks < last)]
        compiled = (now == 'DOP853' and not events and not regime
                    and not tables and (asked.size <= MOST_STOPS or stops.size > MOST_STOPS))
        end = last if compiled or not stops.size else float(stops[0])
        before, is_judged = self._allowance.used, self._method == 'auto'
        part = (_run_compiled if compiled else _run_by_steps)(Task(
            phase=phase, derivative=system.make_derivative(phase, regime), events=events,
            kinks=system.kinks(phase, regime) if regime else None,
            start=system.on_edge(phase, state, regime), first=first, last=end, method=now,
            tolerance=self._tolerance, stops=stops, asked=asked[(asked > first) & (asked < end)],
            allowance=self._allowance, is_projected=system.is_conservative,
            judges=is_judged and now == 'DOP853' and regime not in self._paces,
            pace=self._paces.get(regime, inf) if is_judged and now == 'LSODA' else inf,
            step=self._step,
            compiled='dop853' if self._is_finer or stops.size <= MOST_STOPS else 'dopri5'))
        if stop:
            self._stop_value = (stop.function(float(part.time[-1]), part.states[:, -1])
                                or self._stop_value)
        # a projection changes the state by a few tolerances: the last step still fits
        self._step = part.step if part.end == PROJECTED else 0.0
        if part.end == STIFF:
            self._paces[regime] = (self._allowance.used - before) / (float(part.time[-1]) - first)
        return part

    def _make_stop(self, phase: Phase, first: float, state: Sequence[float]) -> Event | None:
        """Return the event at which the run stops as asked by ``stop_when``, if it was asked."""
        stop_when = self._stop_when
        if stop_when is None:
            return None

        def stop(time: float, state: Any) -> float:      # state: in the coordinate of the phase
            return number('stop_when', stop_when(time, phase.states_of_input(np.asarray(state))))
        if first == 0.0:
            self._stop_value = stop(first, state) or nan      # nothing stops at the start
        # the value before: a projection or another coordinate may step over zero at the start
        return Event(stop, AT_EVENT, self._stop_value)

    def changes(self, end: str) -> bool:
        """Take another method after a part that ended so, and return whether there is one."""
        if self._method != 'auto' or end not in (STIFF, FAILED, SLOWER):
            return False
        if end != SLOWER and self._now not in NEXT:
            return False
        self._chosen[self._regime] = 'DOP853' if end == SLOWER else NEXT[self._now]
        return True


def _restarts(system: System, until: float, is_finer: bool) -> Array:
    """
    Return the times at which integrations restart: where the torque jumps or bends.

    A finer run also restarts between them: otherwise both runs would take the same single step
    there. Where restarts are many, the rougher run takes a method of lower order instead.
    """
    source = system.drive.source if system.drive else None
    breaks: Array = np.array(source.breaks if source else (), float)
    breaks = breaks[(breaks > 0.0) & (breaks < until)]
    if is_finer and 0 < breaks.size <= MOST_STOPS:
        ends = np.concatenate([[0.0], breaks, [until]])
        found: Array = np.unique(np.concatenate([breaks, 0.5 * (ends[1:] + ends[:-1])]))
        return found
    return breaks


def of_interest(parts: Sequence[Part], wanted: Array | None) -> tuple[Part, ...]:
    """
    Return the parts with the wanted times [s] alone (None: all), none twice where parts meet.

    Where a run stops early is of interest too, wanted or not.
    """
    kept: list[Part] = []
    for i, part in enumerate(parts):
        is_wanted = np.ones(part.time.size, bool) if wanted is None else np.isin(part.time, wanted)
        if i and part.time[0] == parts[i - 1].time[-1]:
            is_wanted[0] = False
        if part is parts[-1] and part.end != COMPLETE and not (
                kept and part.time[-1] == max((*kept[-1].time, -1.0))):
            is_wanted[-1] = True
        kept.append(part.at(is_wanted))
    return tuple(kept)


class _Counted:
    """The derivative of a task as integrators take it: counts calls, gives NaN for errors."""

    def __init__(self, task: Task, stop: float) -> None:
        """Use the derivative of a task up to the time ``stop`` [s]."""
        self._derivative, self._allowance = task.derivative, task.allowance
        self._refused = [nan] * len(task.start)
        self.stop_at(stop)

    def stop_at(self, time: float) -> None:
        """Use the torque just before a time [s] at which it jumps, for that time and later."""
        self._latest = nextafter(time, -inf)

    def __call__(self, time: float, state: Array) -> Any:
        """Return d state / dt as a list; NaN where it is an error or huge: the step is refused."""
        self._allowance.used += 1
        try:      # a list: a tuple would be several results
            change: list[float] = list(self._derivative(min(time, self._latest), state.tolist()))
        except (FourBarError, ArithmeticError):
            return self._refused
        return change if min(change) > -HUGE and max(change) < HUGE else self._refused


def _is_stiff(task: Task, time: float, state: Array, step: float) -> bool:
    """
    Return whether stability, not accuracy, limits steps of this length [s].

    So it is if the step times the largest eigenvalue of the Jacobian, by central differences, is
    above 3: the boundary of DOP853 is about 6.
    """
    derivative, start, columns = task.derivative, state.tolist(), []
    try:
        for i, value in enumerate(start):
            aside = 1e-6 * max(1.0, abs(value))
            ends = [derivative(time, [*start[:i], value + side * aside, *start[i + 1:]])
                    for side in (-1.0, 1.0)]
            columns.append([(up - down) / (2.0 * aside) for down, up in zip(*ends)])
    except (FourBarError, ArithmeticError):
        return False
    task.allowance.used += 2 * len(start)
    jacobian = np.array(columns)      # transposed: its eigenvalues are the same
    return bool(np.all(np.isfinite(jacobian))
                and step * np.max(np.abs(np.linalg.eigvals(jacobian))) > STABLE)


def _ends_at(task: Task, times: Sequence[float], state: Array) -> str:
    """Return how a part ends after a step of the compiled integrator; COMPLETE: it goes on."""
    steps, time = len(times) - 1, times[-1]
    if steps and task.phase.can_end and task.phase.excess(time, state) > 0.0:
        return HANDED_OVER
    if task.allowance.ends(time):
        return GAVE_UP
    if task.is_projected and steps >= PROJECT_EVERY and time < task.last:
        return PROJECTED
    if (task.judges and steps and steps % JUDGE_EVERY == 0 and time < task.last
            and _is_stiff(task, time, state, (time - times[-1 - JUDGE_EVERY]) / JUDGE_EVERY)):
        return STIFF
    return COMPLETE


def _targets(task: Task) -> list[tuple[float, float]]:
    """Return (time, next stop) of all times to go to, in order: stops and times asked for."""
    stops = np.unique(np.concatenate([task.stops, [task.last]]))
    next_stops = stops[np.searchsorted(stops, task.asked)] if task.asked.size else task.asked
    return sorted({*zip(stops.tolist(), stops.tolist()),
                   *zip(task.asked.tolist(), next_stops.tolist())})


def _run_compiled(task: Task) -> Part:
    """
    Run a task by the compiled DOP853, with a tenth of the overhead of scipy's solvers in Python.

    It goes from stop to stop, where the torque jumps, and to each time asked for; all its steps
    are kept.
    """
    try:
        from scipy.integrate import ode
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error
    times, states = list[float](), list[Array]()
    end, counted = COMPLETE, _Counted(task, task.last)

    def keep(time: float, state: Array) -> int:
        """Keep a step, and return -1 to end the integration there, else 0."""
        nonlocal end
        if not times or time > times[-1]:
            times.append(time)
            states.append(state.copy())
            end = _ends_at(task, times, state)
        return 0 if end == COMPLETE else -1

    def begin(time: float, state: Sequence[float] | Array, step: float) -> None:
        """Restart at a state; ``keep`` is called with (time, state) after each step."""
        solver.set_integrator(task.compiled, rtol=task.tolerance, atol=task.tolerance,
                              nsteps=MOST_STEPS, first_step=step,
                              max_step=task.last - task.first)      # scipy 1.17.0: else 1 s
        solver.set_solout(keep)
        solver.set_initial_value(state, time)

    solver: Any = ode(counted)
    begin(task.first, task.start, task.step)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', UserWarning)      # of what the end of the part says
        for time, stop in _targets(task):
            counted.stop_at(stop)
            if times and time <= times[-1] * (1.0 + SHORTEST):      # one time, differently rounded
                begin(time, solver.y, task.step)
                keep(time, solver.y)
                continue
            if len(times) > 2:      # scipy 1.17 would guess a step, too long behind a bend
                begin(times[-1], solver.y,
                      max(times[-1] - times[-2], times[-2] - times[-3], 100.0 * EPS * times[-1]))
            solver.integrate(time)
            if not solver.successful() and end == COMPLETE:
                end = STIFF if solver.get_return_code() == -4 else FAILED
            if end != COMPLETE:
                break
            times[-1] = time      # the last step may end a rounding beside the time asked for
    return Part(task.phase, np.array(times), np.array(states).T, end,
                times[-1] - times[-2] if len(times) > 1 else 0.0)


def _run_by_steps(task: Task) -> Part:
    """Run an integrator of scipy step by step, to where a phase or a regime ends."""
    try:
        from scipy import integrate as scipys
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error
    if task.method != 'LSODA':
        return _Steps(task, getattr(scipys, task.method)).part()
    with _LSODA:
        return _Steps(task, scipys.LSODA).part()


class Crossing(NamedTuple):
    """A zero of an event or of a margin within a step."""

    function: Callable[..., float]      # of time and state
    end: str                            # how the part ends there
    first: float                        # times between which the zero lies [s]
    last: float


class _Steps:
    """Runs a task by a solver of scipy, of the class ``kind``, and locates events in steps."""

    def __init__(self, task: Task, kind: Any) -> None:
        """Start the solver, and take the values of events and margins at the start."""
        self._task = task
        counted = _Counted(task, task.last)
        options = {'first_step': min(task.step, task.last - task.first)} if task.step else {}
        self._solver: Any = None
        if np.all(np.isfinite(counted(task.first, np.array(task.start)))):
            with warnings.catch_warnings():      # of a relative tolerance below 100 eps
                warnings.simplefilter('ignore')
                self._solver = kind(counted, task.first, np.array(task.start), task.last,
                                    rtol=max(task.tolerance, 100.0 * EPS), atol=task.tolerance,
                                    **options)
        self._times, self._states = [np.array([task.first])], [np.array([task.start]).T]
        start = np.array(task.start)
        self._events = [*task.events, *([Event(task.phase.excess, HANDED_OVER)]
                                        if task.phase.can_end else [])]
        self._values = [event.before or event.function(task.first, start)
                        for event in self._events]
        equation = task.phase.equation
        self._excess = equation.make_excess(float(start[0])) if equation.tables else None
        margins = task.kinks(task.first, start) if task.kinks else ()
        self._lowest = [min(0.0, margin) - SAME for margin in margins]     # below: it has ended

    def part(self) -> Part:
        """Run to the end of the task, or to where it ends before, and return the part."""
        end = FAILED
        if self._solver is not None:
            with warnings.catch_warnings():
                warnings.simplefilter('ignore')      # of what the end of the part says
                end = self._run()
        step = self._solver.step_size if self._solver is not None else None
        return Part(self._task.phase, np.concatenate(self._times),
                    np.concatenate(self._states, axis=1), end, step or 0.0)

    def _run(self) -> str:
        """Step until the part ends, and return how it ended."""
        task, solver, judged = self._task, self._solver, self._task.first
        steps, tiny, before = 0, 0, task.allowance.used
        while solver.status == 'running':
            try:
                solver.step()
            except (RuntimeError, ValueError) as error:
                # another program's LSODA in another thread; a Jacobian that is not finite
                if (type(error).__name__ != 'IntegratorConcurrencyError'
                        and 'infs or NaNs' not in str(error)):
                    raise
                return FAILED
            if solver.status == 'failed' or not np.all(np.abs(solver.y) < HUGE):
                return FAILED
            steps += 1
            tiny = tiny + 1 if solver.t - solver.t_old <= SHORTEST * solver.t else 0
            if tiny > MOST_TINY:
                return FAILED
            end = self._keep()
            if end:
                return end
            if task.allowance.ends(solver.t):
                return GAVE_UP
            taken = task.allowance.used - before
            if taken > TRIED and taken > task.pace * (solver.t - task.first):
                return SLOWER
            if task.is_projected and steps >= PROJECT_EVERY and solver.t < task.last:
                return PROJECTED
            if task.judges and steps % JUDGE_EVERY == 0 and solver.t < task.last:
                if _is_stiff(task, solver.t, solver.y, (solver.t - judged) / JUDGE_EVERY):
                    return STIFF
                judged = solver.t
        return COMPLETE

    def _keep(self) -> str:
        """Keep the last step, and times asked for in it; return how the part ends, '' if not."""
        task, solver = self._task, self._solver
        first, last = float(solver.t_old), float(solver.t)
        asked = task.asked[(task.asked > first) & (task.asked < last)]
        looks = any(event.end == AT_EVENT for event in self._events)
        dense: Any = solver.dense_output() if looks or asked.size else None
        crossings = self._crossings(first, last, solver.y, dense)
        if not crossings:
            end, state = '', solver.y.copy()
        else:
            dense = dense or solver.dense_output()
            last, end = min((_root(crossing, dense), crossing.end) for crossing in crossings)
            asked, state = asked[asked < last], dense(last)
        if asked.size:
            self._times.append(asked)
            self._states.append(dense(asked))
        self._times.append(np.array([last]))
        self._states.append(state[:, None])
        return end

    def _crossings(self, first: float, last: float, state: Array, dense: Any) -> list[Crossing]:
        """
        Return the zeros of events and margins within the step from ``first`` to ``last`` [s].

        ``state``: at its end; ``dense``: the interpolant, time -> state, in which events of a user
        are looked at eight times.
        """
        kinks: Any = self._task.kinks
        crossings: list[Crossing] = []
        for i, event in enumerate(self._events):
            before, begin = self._values[i], first
            looks = (np.linspace(first, last, LOOKS + 1)[1:-1].tolist()
                     if event.end == AT_EVENT else [])
            for time in (*looks, last):
                now = event.function(time, state if time == last else dense(time))
                if before * now < 0.0 or (now == 0.0 != before):
                    crossings.append(Crossing(event.function, event.end, begin, time))
                    break
                before, begin = now, time
            self._values[i] = now
        margins = kinks(last, state) if kinks else ()
        for i, (margin, lowest) in enumerate(zip(margins, self._lowest)):
            if margin < lowest:
                crossings.append(Crossing(lambda t, y, i=i, lowest=lowest: kinks(t, y)[i] - lowest,
                                          KINK, first, last))
        excess, position = self._excess, float(state[0])
        if excess and excess(position, True) > 0.0:      # it passed over a whole piece
            crossings.append(Crossing(lambda t, y: excess(float(y[0]), False) - SAME, KINK,
                                      first, last))
        elif excess and excess(position, False) > 0.0:
            self._excess = self._task.phase.equation.make_excess(position)
        return crossings


def _root(crossing: Crossing, dense: Any) -> float:
    """Return the time of a crossing [s]; ``dense``: the interpolant of the step."""
    from scipy.optimize import brentq

    function, _, first, last = crossing

    def along(time: float) -> float:
        return float(function(time, dense(time)))
    begin, end = along(first), along(last)
    if begin * end > 0.0:      # rounding of the dense output, a state changed before this step
        return last if abs(end) <= abs(begin) else nextafter(first, inf)
    found = float(brentq(along, first, last, xtol=4.0 * EPS, rtol=4.0 * EPS))
    return max(found, nextafter(first, inf))
