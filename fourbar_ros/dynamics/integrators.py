# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
scipy's integrators behind one function.

Each part of a run, between jumps of the torque and in one coordinate, is an integration of its
own. A free motion is projected back to its energy every so many steps (Hairer, Lubich and Wanner,
Geometric Numerical Integration, section IV.4): its errors then do not add up in the energy.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, nan, nextafter
from typing import Any, NamedTuple
import warnings

from fourbar_ros.dynamics.phase import (
    AT_CHANGE_POINT,
    AT_LIMIT,
    COMPLETE,
    GAVE_UP,
    HANDED_OVER,
    Phase,
    PROJECTED,
)
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError
from fourbar_ros.optional import MissingPackage
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
MOST_STEPS = 10**8
PROJECT_EVERY = 50      # steps
EPS = 2.0**-52


class Part(NamedTuple):
    """A part of a run, in one coordinate: times, states in it of shape (states, n), its end."""

    phase: Phase
    time: Array
    states: Array
    end: str
    evaluations: int
    given: float = 0.0      # energy that projections gave before it [J]

    def at(self, places: Any) -> Part:
        """Return it at some of its times."""
        return self._replace(time=self.time[places], states=self.states[:, places])


class Result(NamedTuple):
    """What an integrator did, part by part, and how it ended."""

    parts: tuple[Part, ...]
    end: str

    @property
    def time(self) -> Array:
        """Return the times [s]."""
        return np.concatenate([part.time for part in self.parts])

    @property
    def states(self) -> Array:
        """Return the states in the input of the mechanism, of shape (states, n)."""
        return np.concatenate([part.phase.states_of_input(part.states) for part in self.parts],
                              axis=1)

    @property
    def evaluations(self) -> int:
        """Return how often the equation of motion was evaluated."""
        return sum(part.evaluations for part in self.parts)


class Task(NamedTuple):
    """What one call of an integrator is to do."""

    phase: Phase
    derivative: Callable[..., Any]
    events: tuple[Callable[..., float], ...]
    start: Sequence[float]
    first: float
    last: float
    method: str
    tolerance: float
    wanted: Array | None
    also: Array | None
    most: float
    is_projected: bool
    step: float             # the first one [s]; 0: the integrator chooses


class _UsedUp(Exception):
    """More evaluations than allowed: the error estimate of the integrator is rounding."""


def integrate(system: System, until: float, method: str, tolerance: float, wanted: Array | None,
              also: Array | None = None, most: float = inf) -> Result:
    """
    Integrate from time 0.

    Parameters
    ----------
    system : System
    until : float
        [s]
    method : str
    tolerance : float
        Relative and absolute, of every state.
    wanted : ndarray, optional
        Times of the result; not given: those of the steps, and ``also``.
    also : ndarray, optional
        Times that must be among those of the steps.
    most : float
        Evaluations of the equation of motion after which it gives up.

    """
    breaks = system.drive.source.breaks if system.drive else ()
    ends = [*sorted(t for t in breaks if 0.0 < t < until), until]
    (phase, state), first, has_ended = system.course.at(system.start), 0.0, False
    evaluations, given, step = 0, 0.0, 0.0
    parts: list[Part] = []
    energy = phase.energy(state) if system.is_conservative else None
    while ends:
        if has_ended:
            phase, state = phase.next(state)
        last = ends[0]
        part = _run(Task(phase, _before(phase.derivative, last) if breaks else phase.derivative,
                         system.events(phase), state, first, last, method, tolerance,
                         _inside(wanted, first, last), _inside(also, first, last),
                         most - evaluations, energy is not None, step))
        evaluations += part.evaluations
        stands = part.end == HANDED_OVER and part.time[-1] <= nextafter(first, inf)
        part = part._replace(given=given)
        parts.append(part._replace(end=AT_LIMIT) if stands else part)
        state, first = part.states[:, -1].tolist(), float(part.time[-1])
        has_ended = parts[-1].end == HANDED_OVER
        if energy is not None:
            before, state = phase.energy(state), phase.with_energy(state, energy)
            given += phase.energy(state) - before
        # a projection changes the state by a few tolerances: the last step still fits
        step = float(part.time[-1] - part.time[-2]) if part.end == PROJECTED else 0.0
        if parts[-1].end == COMPLETE:
            ends.pop(0)
        elif not has_ended and parts[-1].end != PROJECTED:
            break
    return Result(tuple(_of_interest(parts, wanted)), parts[-1].end)


def _of_interest(parts: Sequence[Part], wanted: Array | None) -> list[Part]:
    """Return the parts at the times of the result, none twice."""
    found = []
    for i, part in enumerate(parts):
        is_wanted = np.ones(part.time.size, bool) if wanted is None else np.isin(part.time, wanted)
        if i and part.time[0] == parts[i - 1].time[-1]:
            is_wanted[0] = False
        if part is parts[-1] and part.end in (AT_LIMIT, AT_CHANGE_POINT):
            is_wanted[-1] = True      # where it stops is of interest
        found.append(part.at(is_wanted))
    return found


def _inside(times: Array | None, first: float, last: float) -> Array | None:
    return None if times is None else times[(times > first) & (times < last)]


def _before(derivative: Callable[..., Any], last: float) -> Callable[..., Any]:
    """Return the derivative of a segment, also at its end, where the next torque begins."""
    latest = nextafter(last, -inf)
    return lambda time, state: derivative(min(time, latest), state)


def _run(task: Task) -> Part:
    if task.method == 'DOP853' and task.wanted is None and not task.events:
        return _run_compiled(task)
    return _run_general(task)


def _run_compiled(task: Task) -> Part:
    """Run the compiled DOP853, with a tenth of the overhead of solve_ivp, step by step."""
    try:
        from scipy.integrate import ode
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error

    times: list[float] = []
    states: list[Array] = []
    count, end = 0, COMPLETE
    derivative, excess = task.derivative, task.phase.excess if task.phase.can_end else None

    def counted(time: float, state: Array) -> Any:
        nonlocal count
        count += 1
        try:
            return list(derivative(time, state.tolist()))      # a tuple would be several results
        except FourBarError:
            return [nan] * len(state)      # the step is then refused

    def keep(time: float, state: Array) -> int:
        nonlocal end
        if not times or time > times[-1]:
            times.append(time)
            states.append(state.copy())
            if excess is not None and len(times) > 1 and excess(time, state) > 0.0:
                end = HANDED_OVER
            elif count > task.most:
                end = GAVE_UP
            elif task.is_projected and len(times) > PROJECT_EVERY and time < task.last:
                end = PROJECTED
        return 0 if end == COMPLETE else -1

    solver = ode(counted).set_integrator('dop853', rtol=task.tolerance, atol=task.tolerance,
                                         nsteps=MOST_STEPS, first_step=task.step,
                                         max_step=task.last - task.first)  # scipy 1.17.0: else 1 s
    solver.set_solout(keep)
    solver.set_initial_value(task.start, task.first)
    for time in [*(() if task.also is None else task.also), task.last]:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore', UserWarning)      # of what the end of the part says
            solver.integrate(time)
        if not solver.successful():
            end = GAVE_UP
        if end != COMPLETE:
            break
    return Part(task.phase, np.array(times), np.array(states).T, end, count)


def _run_general(task: Task) -> Part:
    """Run scipy's solve_ivp, which stops at limits of the input and where a phase ends."""
    try:
        from scipy.integrate import solve_ivp
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error

    count = len(task.start)

    evaluations = 0

    def derivative(time: float, state: Array) -> Any:
        nonlocal evaluations
        evaluations += 1
        if evaluations > task.most:
            raise _UsedUp
        try:
            return task.derivative(time, state.tolist())
        except FourBarError:
            return [nan] * count      # the step is then refused

    events = [*task.events, *([task.phase.excess] if task.phase.can_end else [])]
    times = (None if task.wanted is None else
             np.unique([task.first, *task.wanted, task.last]))
    try:      # solve_ivp limits rtol to 100 eps itself, and warns
        done = solve_ivp(derivative, (task.first, task.last), task.start, task.method, times,
                         events=events, rtol=max(task.tolerance, 100.0 * EPS), atol=task.tolerance,
                         dense_output=times is None and task.also is not None)
    except _UsedUp:
        return Part(task.phase, np.array([task.first]), np.array([task.start]).T, GAVE_UP,
                    evaluations)
    time, states = done.t, done.y
    if done.sol is not None and task.also is not None:
        time, states = _with(time, states, task.also, done.sol)
    end = COMPLETE if done.status == 0 else GAVE_UP
    if done.status == 1:
        which = next(i for i, found in enumerate(done.t_events) if found.size)
        end = events[which].end      # type: ignore[attr-defined]
        if times is not None:
            time = np.append(time, done.t_events[which])
            states = np.append(states, done.y_events[which].T, axis=1)
    return Part(task.phase, time, states, end, done.nfev)


def _with(time: Array, states: Array, also: Array, solution: Any) -> tuple[Array, Array]:
    """Return times and states with those of further times among them."""
    also = also[also < time[-1]]
    order = np.argsort(np.concatenate([time, also]), kind='stable')
    time = np.concatenate([time, also])[order]
    states = np.concatenate([states, solution(also)], axis=1)[:, order]
    keep = np.concatenate([[True], np.diff(time) > 0.0])
    return time[keep], states[:, keep]
