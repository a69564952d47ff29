# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion over time, with the result checked: no wrong answer is called a success.

A motion without drive and dampers that goes round or swings is periodic: a Fourier series
(:mod:`fourbar_ros.dynamics.free_motion`). The motion of a crank that goes round under a constant
torque follows from its energy (:mod:`fourbar_ros.dynamics.solve.by_energy`). Scipy integrates all
others over time, by DOP853, and from where a system turns out to be stiff by LSODA.

A run is compared with one at a tighter tolerance, at times all along it, and its energy, less the
work of drive and dampers, must stay constant at every step. While the difference or the drift of
the energy exceeds the given tolerance, the tolerance of the integrator is tightened. If that does
not help, or takes more evaluations than allowed, the status says so. The difference is the error
of the rougher run; the finer one is returned.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isfinite, nan
from typing import TYPE_CHECKING

from fourbar_ros.dynamics import free_motion
from fourbar_ros.dynamics.model.element_forces import loads_with
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve import by_energy
from fourbar_ros.dynamics.solve.integrators import (
    Allowance,
    integrate,
    METHODS,
    of_interest,
    Part,
    Result,
    Stop,
)
from fourbar_ros.dynamics.solve.phase import AT_CHANGE_POINT, AT_EVENT, AT_LIMIT, COMPLETE, GAVE_UP
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.given import array, number
from fourbar_ros.optional import MissingPackage
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REACHED, LIMIT = 'reached the end', 'reached a limit of the input'
CHANGE_POINT, EVENT = 'reached a change point', 'stopped where asked'
NOT_CONVERGED, NOT_CHECKED, STOPPED = 'not converged', 'not checked', 'gave up'
ENDS = {COMPLETE: REACHED, AT_LIMIT: LIMIT, AT_CHANGE_POINT: CHANGE_POINT, AT_EVENT: EVENT,
        GAVE_UP: STOPPED}
PERIODIC, ENERGY = 'Fourier series', 'energy integral'     # as methods
FIRST = 0.1                # tolerance of the first run over the given one
TIGHTER = 0.1              # tolerance of a finer run over that of the rougher run
LAST, TIGHTEST = 1e-13, 1e-14     # least ones of both runs; below them rounding governs
MOST = 3_000_000           # evaluations in all runs
# evaluations of runs after the first: so many, plus so many times those of the first
LEAST_MOST, MOST_MORE = 300_000, 100
COMPARED = 12              # steps of a run at which it is compared, beside the times asked for
ROUNDING = 32.0 * 2.0**-52        # of an energy over the sizes of its parts


@dataclass(frozen=True)
class Run:
    """
    A simulated run.

    Parameters
    ----------
    system : System
    parts : tuple of Part
        Pieces of the run, each in one coordinate.
    status : str
        :data:`REACHED`, :data:`LIMIT`, :data:`CHANGE_POINT`, :data:`EVENT`,
        :data:`NOT_CONVERGED`, :data:`STOPPED` or :data:`NOT_CHECKED`.
    error : float
        Largest difference of the position to a run at a looser tolerance [rad] or [m].
    drift : float
        Largest change of energy less work, which must be constant, beyond rounding, over the
        energy in play.
    method : str
        The method; of several integrators each, with the time of its first use.
    tolerance : float
        Tolerance of the integrator in the last run.
    evaluations : int
        How often the equation of motion was evaluated in all runs.
    reason : str
        Why it gave up; else nothing.

    """

    system: System
    parts: tuple[Part, ...]
    status: str
    error: float
    drift: float
    method: str
    tolerance: float
    evaluations: int
    reason: str = ''

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
        return np.asarray(self.states[0])

    @property
    def rate(self) -> Array:
        """Return the rate of the input over time [rad/s] or [m/s]."""
        return np.asarray(self.states[1])

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

    # --- between its times, and derived results -------------------------------------------------

    def resampled(self, times: ArrayLike) -> Run:
        """
        Return the same run at other times, increasing; it is integrated again, as well as before.

        Raises
        ------
        InvalidParameter
            For times that are not within the run.

        """
        end = float(self.time[-1])
        if self.method in (PERIODIC, ENERGY):
            return simulate(self.system, end, self.tolerance, times=times)
        wanted = _checked_times(times, end)
        allowance = Allowance(end, LEAST_MOST + 2.0 * self.evaluations)
        result = integrate(self.system, self.method if self.method in METHODS else 'auto',
                           self.tolerance, wanted, allowance,
                           is_finer=self.status != NOT_CHECKED)
        run = _run(self.system, result, wanted, self.error, self.tolerance, allowance)
        missing = np.setdiff1d(wanted[wanted <= run.time[-1]], run.time)
        if missing.size:
            raise InvalidParameter('times', missing[0], 'is not in the run integrated again')
        return run

    def at(self, time: ArrayLike) -> Array:
        """
        Return the states at any times, one or more, in any order, as a solution of scipy does.

        The error is that of the run. Each call integrates again: ask for many times at once.

        Parameters
        ----------
        time : float or array_like, shape (...)
            [s], from 0 to the end of the run.

        Returns
        -------
        ndarray, shape (states, ...)

        """
        given = array('time', time)
        if not given.size or not (np.min(given) >= 0.0 and np.max(given) <= self.time[-1]):
            raise InvalidParameter('time', time, f'must lie between 0 and {self.time[-1]:.17g} s')
        times, places = np.unique(given, return_inverse=True)
        states = self.resampled(times).states
        # a limit that rounding has put before the last time
        places = np.minimum(places.ravel(), states.shape[1] - 1)
        return np.reshape(states[:, places], (-1, *given.shape))

    @cached_property
    def loads(self) -> NamedFields:
        """Return the loads over time, the forces of all elements in them, fields of shape (n,)."""
        mechanism, modes = self.system.mechanism, self.modes
        elements = self.system.equation.elements
        motion = np.array([self.position, self.rate, self.acceleration])
        rows = np.full((len(mechanism.LOADS._fields), self.time.size), np.nan)
        for mode in np.unique(modes).tolist():
            in_mode = modes == mode
            rows[:, in_mode] = loads_with(mechanism.in_mode(mode), elements, *motion[:, in_mode])
        loads: NamedFields = mechanism.LOADS(*rows)
        return loads

    def loads_at(self, time: ArrayLike) -> NamedFields:
        """Return the loads at increasing times [s], fields of their shape; it integrates again."""
        given = array('time', time)
        loads = self.resampled(np.ravel(given)).loads
        record: NamedFields = loads._make(
            [field.reshape(given.shape) if given.shape else float(field[0]) for field in loads])
        return record

    def plot(self) -> Figure:
        """
        Return a matplotlib figure of position, rate, acceleration and torque over time.

        Raises
        ------
        MissingPackage

        """
        try:
            from matplotlib.figure import Figure
        except ModuleNotFoundError as error:
            raise MissingPackage('a plot', error) from error
        unit = self.system.mechanism.input_coordinate.unit
        rows = {f'position [{unit}]': self.position, f'rate [{unit}/s]': self.rate,
                f'acceleration [{unit}/s²]': self.acceleration}
        if self.system.drive:
            rows[f'drive [{"N" if unit == "m" else "N m"}]'] = self.torque
        figure = Figure(figsize=(7.0, 1.8 * len(rows)), layout='constrained')
        axes = figure.subplots(len(rows), 1, sharex=True)
        for ax, (name, values) in zip(axes, rows.items()):
            ax.plot(self.time, values)
            ax.set_ylabel(name)
        axes[-1].set_xlabel('time [s]')
        return figure


def simulate(system: System, until: float, tolerance: float = 1e-8, method: str = 'auto',
             times: ArrayLike | None = None, check: bool = True, evaluations: float = MOST,
             seconds: float = inf, progress: Callable[[float], None] | None = None,
             stop_when: Stop | None = None) -> Run:
    """
    Integrate a system from time 0 and check the result.

    Parameters
    ----------
    system : System
    until : float
        End of the run [s].
    tolerance : float
        Largest error of the position at every time, relative to 1 rad (of a slide to its unit of
        length), and of the energy relative to the energy in play.
    method : str
        One of :data:`METHODS`.
    times : sequence of float, optional
        Where the answer is wanted; not given: at the steps of the integrator.
    check : bool
        False: one run at this tolerance of the integrator, with the status :data:`NOT_CHECKED`.
    evaluations, seconds : float
        Most evaluations of the equation of motion in all runs, and most time [s]. A run that needs
        more ends with the status :data:`STOPPED`, as soon as that is clear.
    progress : callable, optional
        Called with the part of a run that is done, 0 to 1, once for each step.
    stop_when : callable, optional
        (time, state) -> number: the run stops where it crosses zero after the start, with the
        status :data:`EVENT`. The state is that of the input, named by ``system.names``:
        ``lambda t, y: y[0] - pi`` stops at half a turn, ``lambda t, y: y[1]`` at the next rest.
        It is asked eight times in each step of the integrator.

    Raises
    ------
    InvalidParameter, MissingPackage

    """
    if not isinstance(system, System):
        raise InvalidParameter('system', system, 'must be a System')
    until = number('until', until, 'must be a positive number', above=0.0)
    if not 0.0 < number('tolerance', tolerance) < 1.0:
        raise InvalidParameter('tolerance', tolerance, 'must lie between 0 and 1')
    if method not in METHODS:
        raise InvalidParameter('method', method, f'must be one of {", ".join(METHODS)}')
    if stop_when is not None and not callable(stop_when):
        raise InvalidParameter('stop_when', stop_when, 'must be a function of time and state')
    allowance = Allowance(until, _most('evaluations', evaluations), _most('seconds', seconds),
                          progress, stop_when is not None)
    wanted = None if times is None else _checked_times(times, until)
    _check_start(system)
    if check and method == 'auto' and stop_when is None:
        for name, follow in ((PERIODIC, free_motion.follow), (ENERGY, by_energy.follow)):
            followed = follow(system, until, tolerance * system.mechanism.input_unit, wanted)
            if followed is not None:
                part, error, used = followed
                drift = energy_drift(system, (part,))
                if drift <= tolerance:
                    return Run(system, (part,), REACHED, error, drift, name, tolerance, used)
    if check:
        return _checked(system, tolerance, method, wanted, allowance, stop_when)
    tolerance = max(tolerance, TIGHTEST)
    result = integrate(system, method, tolerance, _asked(wanted), allowance, stop_when)
    run = _run(system, result, wanted, nan, tolerance, allowance)
    return run if run.status == STOPPED else replace(run, status=NOT_CHECKED)


def _most(name: str, value: float) -> float:
    return inf if value == inf else number(name, value, 'must be a positive number', above=0.0)


def _check_start(system: System) -> None:
    """Refuse a start without inertia, or with a kinetic energy that overflows a float."""
    equation, (position, rate) = system.equation, system.start[:2]
    try:
        inertia = float(equation.terms(position).inertia)
        if inertia == 0.0:
            raise InvalidParameter('bodies', None, 'the inertia of the input is zero at '
                                   f'{position}: no acceleration follows from a torque')
        energy = 0.5 * inertia * rate * rate
    except InvalidParameter:
        raise
    except FourBarError:           # at a toggle, where another coordinate goes on
        return
    if not isfinite(energy):
        raise InvalidParameter('rate', rate, 'is too large: its kinetic energy is no number')


def _checked(system: System, asked: float, method: str, wanted: Array | None,
             allowance: Allowance, stop_when: Stop | None) -> Run:
    """
    Integrate at two tolerances, ever tighter, until both runs agree to the one asked for.

    Returns the finer run. The difference is the error of the rougher one, so it is safe; the next
    tolerance is chosen as if errors were in proportion to it, between 0.1 and 1e-4 of this one.
    """
    unit, tolerance, is_first = system.mechanism.input_unit, max(FIRST * asked, LAST), True
    while True:
        rough = integrate(system, method, tolerance, _asked(wanted), allowance, stop_when)
        if rough.end == GAVE_UP:
            return _run(system, rough, wanted, inf, tolerance, allowance)
        if is_first:
            allowance.evaluations = min(allowance.evaluations,
                                        LEAST_MOST + MOST_MORE * allowance.used)
        tighter, is_first = max(TIGHTER * tolerance, TIGHTEST), False
        fine = integrate(system, method, tighter, np.union1d(_asked(wanted), _some(rough.time)),
                         allowance, stop_when, is_finer=True)
        error = _difference(rough, fine)
        run = _run(system, fine, wanted, error, tighter, allowance)
        if run.status == STOPPED or error <= asked * unit and run.drift <= asked:
            return run
        if tolerance <= LAST:
            return replace(run, status=NOT_CONVERGED)
        share = 0.3 * asked * unit / max(error, 1e-300)
        tolerance = max(tolerance * min(0.1, max(1e-4, share)), LAST)


def _checked_times(times: ArrayLike, until: float) -> Array:
    """Return the times at which a run is wanted [s]; refuse any that do not increase from 0."""
    wanted = array('times', times)
    if wanted.ndim != 1 or not wanted.size or not (wanted[0] >= 0.0 and wanted[-1] <= until
                                                   and np.all(np.diff(wanted) > 0.0)):
        raise InvalidParameter('times', times, f'must increase, from 0 to {until:g} s at most')
    return wanted


def _asked(wanted: Array | None) -> Array:
    return np.empty(0) if wanted is None else wanted


def _some(times: Array) -> Array:
    """Return some of the times of a run, its last among them."""
    return np.asarray(times[np.unique(np.linspace(0, times.size - 1, COMPARED).astype(int))])


def _difference(rough: Result, fine: Result) -> float:
    """
    Return the largest difference of the input of two runs at common times [rad] or [m].

    Where both stop as asked, the difference of their last times counts too, times the rate.
    """
    if (rough.end == AT_EVENT) != (fine.end == AT_EVENT):
        return inf
    _, in_rough, in_fine = np.intersect1d(rough.time, fine.time, return_indices=True)
    difference = np.abs(rough.states[0, in_rough] - fine.states[0, in_fine])
    if fine.end == AT_EVENT:
        late = (rough.time[-1] - fine.time[-1]) * fine.states[1, -1]
        difference = np.append(difference, abs(late))
    return float(np.max(np.nan_to_num(difference, nan=inf), initial=0.0))


def _run(system: System, result: Result, wanted: Array | None, error: float, tolerance: float,
         allowance: Allowance) -> Run:
    """Return the :class:`Run` of a result; its method reads 'DOP853, LSODA from 0.31 s'."""
    first, *later = result.methods
    method = ', '.join([first[1], *(f'{name} from {time:.4g} s' for time, name in later[:3])])
    end = f'{result.parts[-1].time[-1]:.6g} s'
    return Run(system, of_interest(result.parts, wanted), ENDS[result.end], error,
               energy_drift(system, result.parts), method + (' and so on' if later[3:] else ''),
               tolerance, allowance.used, f'{allowance.reason} at {end}' * bool(allowance.reason))


def energy_drift(system: System, parts: Sequence[Part]) -> float:
    """
    Return the largest change of energy less work, over the energy in play.

    It must be constant, so it measures the error of a run. Energy that projections gave or took
    counts as an error; a change that rounding explains does not.
    """
    of_parts: list[tuple[Array, ...]] = []
    for part in parts:
        equation, states = part.phase.equation, part.states
        kinetic = 0.5 * equation.terms(states[0]).inertia * states[1]**2
        work = 0.0 * kinetic if system.is_conservative else states[-1]
        potential, size = equation.potential_and_size(states[0])
        of_parts.append((kinetic, potential, work + part.given, size))
    kinetic, potential, work, size = (np.concatenate(rows) for rows in zip(*of_parts))
    constant = kinetic + potential - work
    in_play = float(np.max(kinetic) + np.ptp(potential) + np.ptp(work))
    rounding = ROUNDING * float(np.max(kinetic) + np.max(size) + np.max(np.abs(work)))
    drift = float(np.max(np.abs(constant - constant[0]))) - rounding
    return drift / in_play if drift > 0.0 < in_play else 0.0
