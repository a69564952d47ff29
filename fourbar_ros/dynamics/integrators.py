# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""scipy's integrators behind one function; between jumps of the torque each segment is a run."""
from __future__ import annotations

from collections.abc import Callable
from math import inf, nan, nextafter
from typing import Any, NamedTuple

from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError
from fourbar_ros.optional import MissingPackage
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
MOST_STEPS = 10**8
EPS = 2.0**-52


class Result(NamedTuple):
    """What an integrator did: times, states of shape (states, n), and how it ended."""

    time: Array
    states: Array
    is_complete: bool      # it did not give up
    is_at_limit: bool      # it stopped at a limit of the input
    evaluations: int


def integrate(system: System, until: float, method: str, tolerance: float, wanted: Array | None,
              also: Array | None = None) -> Result:
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

    """
    breaks = system.drive.source.breaks if system.drive else ()
    ends = [0.0, *sorted(t for t in breaks if 0.0 < t < until), until]
    state, parts, evaluations = np.array(system.start), [], 0
    is_plain = method == 'DOP853' and wanted is None and system.has_no_limits
    for first, last in zip(ends, ends[1:]):
        derivative = _before(system.derivative, last) if breaks else system.derivative
        run = _run_compiled if is_plain else _run_general
        part = run(Task(system, derivative, state, first, last, method, tolerance,
                        _inside(wanted, first, last), _inside(also, first, last)))
        parts.append(part)
        evaluations += part.evaluations
        state = part.states[:, -1]
        if not part.is_complete or part.is_at_limit:
            break
    time = np.concatenate([part.time[i > 0:] for i, part in enumerate(parts)])
    states = np.concatenate([part.states[:, i > 0:] for i, part in enumerate(parts)], axis=1)
    if wanted is not None:
        places = np.isin(time, wanted)
        places[-1] |= parts[-1].is_at_limit      # where it stops is of interest
        time, states = time[places], states[:, places]
    return Result(time, states, parts[-1].is_complete, parts[-1].is_at_limit, evaluations)


class Task(NamedTuple):
    """What one call of an integrator is to do."""

    system: System
    derivative: Callable[..., Any]
    start: Array
    first: float
    last: float
    method: str
    tolerance: float
    wanted: Array | None
    also: Array | None


def _inside(times: Array | None, first: float, last: float) -> Array | None:
    return None if times is None else times[(times > first) & (times < last)]


def _before(derivative: Callable[..., Any], last: float) -> Callable[..., Any]:
    """Return the derivative of a segment, also at its end, where the next torque begins."""
    latest = nextafter(last, -inf)
    return lambda time, state: derivative(min(time, latest), state)


def _run_compiled(task: Task) -> Result:
    """Run the compiled DOP853, with a tenth of the overhead of solve_ivp, step by step."""
    try:
        from scipy.integrate import ode
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error

    times, states, count = [], [], 0
    derivative = task.derivative

    def counted(time: float, state: Array) -> Any:
        nonlocal count
        count += 1
        return list(derivative(time, state.tolist()))      # a tuple would be several results

    def keep(time: float, state: Array) -> None:
        if not times or time > times[-1]:
            times.append(time)
            states.append(state.copy())

    solver = ode(counted).set_integrator('dop853', rtol=task.tolerance, atol=task.tolerance,
                                         nsteps=MOST_STEPS)
    solver.set_solout(keep)
    solver.set_initial_value(task.start, task.first)
    for time in [*(() if task.also is None else task.also), task.last]:
        solver.integrate(time)
        if not solver.successful():
            break
    return Result(np.array(times), np.array(states).T, solver.successful(), False, count)


def _run_general(task: Task) -> Result:
    """Run scipy's solve_ivp, which stops at the limits of the input."""
    try:
        from scipy.integrate import solve_ivp
    except ModuleNotFoundError as error:
        raise MissingPackage('simulation', error) from error

    count = len(task.start)

    def derivative(time: float, state: Array) -> Any:
        try:
            return task.derivative(time, state.tolist())
        except FourBarError:
            return [nan] * count      # the step is then refused

    events = [] if task.system.has_no_limits else [task.system.distance_to_limit]
    times = (None if task.wanted is None else
             np.unique([task.first, *task.wanted, task.last]))
    # solve_ivp limits rtol to 100 eps itself, and warns
    done = solve_ivp(derivative, (task.first, task.last), task.start, task.method, times,
                     events=events, rtol=max(task.tolerance, 100.0 * EPS), atol=task.tolerance,
                     dense_output=times is None and task.also is not None)
    time, states = done.t, done.y
    if done.sol is not None:
        also = task.also[task.also < time[-1]]
        order = np.argsort(np.concatenate([time, also]), kind='stable')
        time = np.concatenate([time, also])[order]
        states = np.concatenate([states, done.sol(also)], axis=1)[:, order]
        keep = np.concatenate([[True], np.diff(time) > 0.0])
        time, states = time[keep], states[:, keep]
    if done.status == 1 and times is not None:
        time = np.append(time, done.t_events[0])
        states = np.append(states, done.y_events[0].T, axis=1)
    return Result(time, states, done.status >= 0, done.status == 1, done.nfev)
