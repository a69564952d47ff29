# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion over time, with the result checked: no wrong answer is called a success.

The motion of a crank that goes round under forces that depend on its angle alone, a constant
torque among them, follows from its energy (:mod:`fourbar_ros.dynamics.by_energy`): two
quadratures, their error by polynomials of half the degree. Scipy integrates all others over time.

Systems that are not stiff go to DOP853, stiff ones to LSODA. Stiff means: the fastest mode at the
start is so fast that an explicit method would need many more steps for stability than for
accuracy.

A run is compared with one at a tighter tolerance, at times all along it, and its energy, less the
work of drive and dampers, must stay constant. Where the difference or the drift of the energy is
more than the tolerance asked for, the tolerance of the integrator is tightened until it is not;
where that does not help, the status says so. The difference is the error of the rougher run; the
finer one is returned.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

from fourbar_ros.dynamics.by_energy import can_follow, follow
from fourbar_ros.dynamics.integrators import integrate, METHODS, Part, Result
from fourbar_ros.dynamics.phase import AT_CHANGE_POINT, AT_LIMIT, COMPLETE, GAVE_UP
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.given import number
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
REACHED, LIMIT = 'reached the end', 'reached a limit of the input'
CHANGE_POINT = 'reached a change point'
NOT_CONVERGED, NOT_CHECKED = 'not converged', 'not checked'
ENDS = {COMPLETE: REACHED, AT_LIMIT: LIMIT, AT_CHANGE_POINT: CHANGE_POINT}
ENERGY = 'energy integral'     # as a method
STIFF = 2.0e3              # fastest mode [rad] in the run for each rad that the input covers
FIRST = 0.1                # tolerance of the first run over that asked for
TIGHTER = 0.1              # tolerance of a run over that of the one it is compared with
LAST, TIGHTEST = 1e-13, 1e-14     # of these two; beyond them rounding governs
# evaluations after which a run gives up: so many, and so many times those of the first
LEAST_MOST, MOST_MORE = 300_000, 100
COMPARED = 12              # times of a run at which it is compared, if none are asked for


@dataclass(frozen=True)
class Run:
    """
    A simulated run.

    Parameters
    ----------
    system : System
    parts : tuple of Part
        What the integrator did, in one coordinate after the other.
    status : str
        :data:`REACHED`, :data:`LIMIT`, :data:`CHANGE_POINT`, :data:`NOT_CONVERGED` or
        :data:`NOT_CHECKED`.
    error : float
        Largest difference of the position to a run at a looser tolerance [rad] or [m].
    drift : float
        Largest change of what must be constant, energy less work, over the energy in play.
    method : str
    tolerance : float
        Tolerance of the integrator in the last run.
    evaluations : int
        How often the equation of motion was evaluated in all runs.

    """

    system: System
    parts: tuple[Part, ...]
    status: str
    error: float
    drift: float
    method: str
    tolerance: float
    evaluations: int

    @cached_property
    def time(self) -> Array:
        """Return the times [s], of shape (n,)."""
        return np.concatenate([part.time for part in self.parts])

    @cached_property
    def states(self) -> Array:
        """Return the states over time, named by ``system.names``, of shape (states, n)."""
        return np.concatenate([part.phase.states_of_input(part.states) for part in self.parts],
                              axis=1)

    @cached_property
    def modes(self) -> NDArray[np.int64]:
        """Return the assembly mode over time, which changes at toggles and change points."""
        return np.concatenate([part.phase.modes(part.states) for part in self.parts])

    @property
    def position(self) -> Array:
        """Return the input over time [rad] or [m]."""
        position: Array = self.states[0]
        return position

    @property
    def rate(self) -> Array:
        """Return the rate of the input over time [rad/s] or [m/s]."""
        rate: Array = self.states[1]
        return rate

    @property
    def torque(self) -> Array:
        """Return the torque (force) of the drive on the input over time [N m] or [N]."""
        return np.array([self.system.torque(t, y)
                         for t, y in zip(self.time.tolist(), self.states.T.tolist())])

    @property
    def acceleration(self) -> Array:
        """Return the acceleration of the input over time [rad/s^2] or [m/s^2]."""
        return np.array([part.phase.acceleration(t, y) for part in self.parts
                         for t, y in zip(part.time.tolist(), part.states.T.tolist())])


def simulate(system: System, until: float, tolerance: float = 1e-8, method: str = 'auto',
             times: Sequence[float] | None = None, check: bool = True) -> Run:
    """
    Integrate a system from time 0.

    Parameters
    ----------
    system : System
    until : float
        [s]
    tolerance : float
        Largest error of the position at every time, relative to 1 rad (of a slide to its unit of
        length), and of the energy relative to the energy in play.
    method : str
        One of :data:`METHODS`.
    times : sequence of float, optional
        Where the answer is wanted; not given: at the steps of the integrator.
    check : bool
        False: one run at this tolerance of the integrator, with the status :data:`NOT_CHECKED`.

    Raises
    ------
    InvalidParameter, MissingPackage

    """
    until = number('until', until, 'must be a positive number', above=0.0)
    if not 0.0 < number('tolerance', tolerance) < 1.0:
        raise InvalidParameter('tolerance', tolerance, 'must lie between 0 and 1')
    if method not in METHODS:
        raise InvalidParameter('method', method, f'must be one of {", ".join(METHODS)}')
    wanted = None if times is None else _wanted(times, until)
    if check and method == 'auto' and can_follow(system):
        run = _by_energy(system, until, tolerance, wanted)
        if run is not None:
            return run
    chosen = choose_method(system, until) if method == 'auto' else method
    if not check:
        result = integrate(system, until, chosen, max(tolerance, TIGHTEST), wanted)
        return _run(system, result, NOT_CHECKED, np.nan, chosen, tolerance, result.evaluations)
    return _checked(system, until, tolerance, chosen, wanted)


def _by_energy(system: System, until: float, asked: float, wanted: Array | None) -> Run | None:
    """Return the run that the energy gives, if it is as good as asked."""
    found = follow(system, until, asked, wanted)
    if found is None:
        return None
    part, error = found
    run = _run(system, Result((part,), part.end), REACHED, error, ENERGY, asked, part.evaluations)
    return run if run.drift <= asked else None


def _checked(system: System, until: float, asked: float, method: str,
             wanted: Array | None) -> Run:
    """Integrate at two tolerances, ever tighter, until their difference is small enough."""
    unit, evaluations = system.mechanism.input_unit, 0
    tolerance, most = max(FIRST * asked, LAST), inf
    while True:
        rough = integrate(system, until, method, tolerance, wanted, None, most)
        most = min(most, LEAST_MOST + MOST_MORE * rough.evaluations)
        tighter = max(TIGHTER * tolerance, TIGHTEST)
        fine = integrate(system, until, method, tighter, wanted, _some(rough.time), most)
        evaluations += rough.evaluations + fine.evaluations
        error = _difference(rough, fine)
        run = _run(system, fine, ENDS.get(fine.end, NOT_CONVERGED), error, method, tighter,
                   evaluations)
        if error <= asked * unit and run.drift <= asked:
            return run
        if tolerance <= LAST or evaluations > most:
            return replace(run, status=NOT_CONVERGED)
        # the error of a run is in proportion to its tolerance
        wanted_part = 0.3 * asked * unit / max(error, 1e-300)
        tolerance = max(tolerance * min(0.1, max(1e-4, wanted_part)), LAST)


def choose_method(system: System, until: float) -> str:
    """Return LSODA for a system that is stiff at its start, else DOP853."""
    fastest = float(np.max(np.abs(np.linalg.eigvals(_jacobian(system)))))
    covered = max(1.0, abs(system.start[1]) * until)
    return 'LSODA' if fastest * until > STIFF * covered else 'DOP853'


def _jacobian(system: System) -> Array:
    """Return d derivative / d state at the start by differences: enough to tell stiff from not."""
    columns = []
    phase, start = system.course.at(system.start)
    for i, value in enumerate(start):
        step = 1e-6 * max(1.0, abs(value))
        up, down = list(start), list(start)
        up[i], down[i] = value + step, value - step
        change = np.array(phase.derivative(0.0, up)) - np.array(phase.derivative(0.0, down))
        columns.append(change / (2.0 * step))
    jacobian: Array = np.array(columns).T
    return jacobian


def _wanted(times: Sequence[float], until: float) -> Array:
    wanted: Array = np.asarray(times, float)
    if wanted.ndim != 1 or not wanted.size or not (wanted[0] >= 0.0 and wanted[-1] <= until
                                                   and np.all(np.diff(wanted) > 0.0)):
        raise InvalidParameter('times', times, f'must increase, from 0 to {until:g} s at most')
    return wanted


def _some(times: Array) -> Array:
    """Return some of the times of a run, its last among them."""
    some: Array = times[np.unique(np.linspace(0, times.size - 1, COMPARED).astype(int))]
    return some


def _difference(rough: Result, fine: Result) -> float:
    """Return the largest difference of the positions of two results at common times."""
    if GAVE_UP in (rough.end, fine.end):
        return float('inf')
    _, in_rough, in_fine = np.intersect1d(rough.time, fine.time, return_indices=True)
    difference = np.abs(rough.states[0, in_rough] - fine.states[0, in_fine])
    if not difference.size or np.isnan(difference).any():
        return float('inf')
    return float(np.max(difference))


def _run(system: System, result: Result, status: str, error: float, method: str, tolerance: float,
         evaluations: int) -> Run:
    return Run(system, result.parts, status, error, energy_drift(system, result.parts), method,
               tolerance, evaluations)


def energy_drift(system: System, parts: Sequence[Part]) -> float:
    """
    Return the largest change of energy less work, over the energy in play of these states.

    What projections gave or took counts as an error.
    """
    found: list[tuple[Array, Array, Array]] = []
    for part in parts:
        equation, states = part.phase.equation, part.states
        kinetic = 0.5 * equation.terms(states[0]).inertia * states[1]**2
        work = 0.0 * kinetic if system.is_conservative else states[-1]
        found.append((kinetic, equation.potential(states[0]), work + part.given))
    kinetic, potential, work = (np.concatenate(rows) for rows in zip(*found))
    constant = kinetic + potential - work
    in_play = np.max(kinetic) + np.ptp(potential) + np.ptp(work)
    drift = float(np.max(np.abs(constant - constant[0])))
    return drift / float(in_play) if in_play > 0.0 else 0.0
