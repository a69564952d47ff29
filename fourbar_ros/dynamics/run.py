# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A simulated run: its states over time, what follows from them, and how exact they are."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isnan, nan
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.dynamics.coordinate import MotionCoordinate
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.notebook import from_lab, html_table, short_repr
from fourbar_ros.numerics.arguments import array
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# how a run ends
REACHED, LIMIT = 'reached the end', 'reached a limit of the input'
EVENT, STOPPED = 'stopped where asked', 'gave up'
NOT_CONVERGED, NOT_CHECKED = 'not converged', 'not checked'
# how a leg may end besides: the run goes on
HANDED_OVER, AT_KINK = 'handed over', 'at a kink'
EXPLICIT = 'DOP853', 'RK45'     # methods that say less between steps than at them
COMPARED, SHARE = 400, 0.25     # most times at which runs are compared, shares of steps apart
ROUNDING = 32.0 * EPS           # of an energy over the sizes of its parts


class RunState(NamedTuple):
    """The state of a run, each field a float or an array of the shape of its times."""

    position: Any              # of the input [rad] or [m]
    rate: Any                  # of the input [rad/s] or [m/s]
    motor_position: Any        # before an elastic shaft, else that of the input; NaN: no drive
    motor_rate: Any
    source: tuple[Any, ...]    # states of the torque source: current [A], integral [rad]
    dissipated: Any            # by friction since the start [J]; 0 without any
    work: Any                  # done by all that is not conservative since the start [J]

    def __repr__(self) -> str:
        return short_repr('RunState', self._asdict())


class Stuck(NamedTuple):
    """A time in which the input is slower than the slip speed of its friction."""

    begin: float       # [s]
    end: float
    crept: float       # how far the input goes meanwhile [rad], [m]; with less slip speed less


class Leg(NamedTuple):
    """A stretch of a run in one coordinate."""

    coordinate: MotionCoordinate
    time: Array                        # steps of the integrator [s], (n,)
    states: Array                      # there, in that coordinate, (states, n)
    between: Callable[[Array], Array]  # times -> states, interpolated
    end: str                           # how it ended: REACHED, LIMIT, ...

    def at(self, times: Array) -> Array:
        """Return the states at times within the leg, (fields, times); at steps exact ones."""
        steps = np.clip(np.searchsorted(self.time, times), 0, self.time.size - 1)
        states, is_between = self.states[:, steps], self.time[steps] != times
        if is_between.any():
            states[:, is_between] = self.between(times[is_between])
        return states


@dataclass(frozen=True, repr=False)
class Run:
    """
    A simulated run.

    ``status`` is :data:`REACHED`, :data:`LIMIT`, :data:`EVENT`, :data:`NOT_CONVERGED`,
    :data:`STOPPED` (``reason`` says why) or :data:`NOT_CHECKED`; ``error`` the largest difference
    of the position to a run at a looser tolerance [rad] or [m]; ``drift`` the largest change of
    energy less work, which must be constant, beyond rounding, over the energy in play.
    """

    system: System
    legs: tuple[Leg, ...]      # its stretches, each in one coordinate
    asked: Array | None        # times of the run [s]; None: the steps of the integrator
    status: str
    error: float
    drift: float
    method: str                # integrator of scipy
    tolerance: float           # of the integrator
    evaluations: int           # of the equation of motion, in all runs
    reason: str = ''

    @cached_property
    def time(self) -> Array:
        """Return the times [s], of shape (n,); where a run stops early is one of them."""
        if self.asked is None:
            return np.asarray(np.unique(np.concatenate([leg.time for leg in self.legs])))
        asked, end = self.asked[self.asked <= self.duration], self.duration
        stops_early = self.legs[-1].end != REACHED and not (asked.size and asked[-1] == end)
        return np.append(asked, end) if stops_early else asked

    def stuck(self, shortest: float = 1e-3) -> tuple[Stuck, ...]:
        """Return when friction held the mechanism: within its slip speed for ``shortest`` [s]."""
        # a motion that turns back is within it for less
        slip_speed, intervals = self.system.mechanism.slip_speed, list[Stuck]()
        for leg in self.legs if slip_speed else ():
            positions, rates = leg.states[:2]
            if abs(rates[rates.size // 2]) > slip_speed:
                continue
            begin, crept = float(leg.time[0]), float(positions[-1] - positions[0])
            if intervals and begin == intervals[-1].end:
                begin, crept = intervals[-1].begin, crept + intervals.pop().crept
            intervals.append(Stuck(begin, float(leg.time[-1]), crept))
        return tuple([each for each in intervals if each.end - each.begin >= shortest])

    @property
    def duration(self) -> float:
        """Return the time at which the run ends [s]."""
        return float(self.legs[-1].time[-1])

    def _on_legs(self, times: Array) -> Iterator[tuple[Leg, NDArray[np.bool_], Array]]:
        """Yield (leg, which of the times are on it, its states there) in order."""
        starts = np.array([leg.time[0] for leg in self.legs])
        indices = np.maximum(np.searchsorted(starts, times, 'left') - 1, 0)
        for i in np.unique(indices):
            there = indices == i
            yield self.legs[i], there, self.legs[i].at(times[there])

    def _states(self, times: Array) -> Array:
        """Return the states in the input at times, rows in the order of the system's names."""
        rows: Array = np.empty((len(self.system.names), times.size))
        for leg, there, states in self._on_legs(times):
            rows[:, there] = leg.coordinate.states_of_input(states)
        return rows

    @cached_property
    def _rows(self) -> Array:
        return self._states(self.time)

    def _record(self, rows: Array) -> RunState:
        """Return states, rows in the order of the names of the system, as a record."""
        drive = self.system.drive
        has_shaft = drive is not None and drive.shaft is not None
        motor = rows[2:4] if has_shaft else rows[:2] if drive else np.full_like(rows[:2], nan)
        names, none = self.system.names, np.zeros(rows.shape[1:])[()]
        dissipated, work = [rows[names.index(name)] if name in names else none
                            for name in ('dissipated', 'work')]
        source = tuple(rows[self.system.of_source])
        return RunState(rows[0], rows[1], motor[0], motor[1], source, dissipated, work)

    @property
    def states(self) -> RunState:
        """Return the state over time, fields of shape (n,)."""
        return self._record(self._rows)

    @cached_property
    def modes(self) -> NDArray[Any]:
        """Return the assembly mode over time, which changes at toggles."""
        return np.concatenate([leg.coordinate.modes(states[0])
                               for leg, _, states in self._on_legs(self.time)])

    @property
    def position(self) -> Array:
        """Return the input over time [rad] or [m]."""
        return np.asarray(self._rows[0])

    @property
    def rate(self) -> Array:
        """Return the rate of the input over time [rad/s] or [m/s]."""
        return np.asarray(self._rows[1])

    @property
    def torque(self) -> Array:
        """Return the torque (force) of the drive on the input over time [N m] or [N]."""
        return np.array([self.system.torque(t, y)
                         for t, y in zip(self.time.tolist(), self._rows.T.tolist())])

    @property
    def motor_torque(self) -> Array:
        """Return the torque (force) of the motor over time, before an elastic shaft."""
        return np.array([self.system.motor_torque(t, y)
                         for t, y in zip(self.time.tolist(), self._rows.T.tolist())])

    @property
    def acceleration(self) -> Array:
        """Return the acceleration of the input over time [rad/s^2] or [m/s^2]."""
        values: Array = np.empty(self.time.size)
        for leg, there, states in self._on_legs(self.time):
            values[there] = [leg.coordinate.acceleration(t, y) for t, y in
                             zip(self.time[there].tolist(), states.T.tolist())]
        return values

    # --- between its times, and derived results -------------------------------------------------

    def at(self, time: ArrayLike) -> RunState:
        """Return the state at any times [s] of the run, in any order: fields of their shape."""
        # interpolated between the steps of the integrator; the error is that of the run
        times = array('time', time)
        if not times.size or not (np.min(times) >= 0.0 and np.max(times) <= self.duration):
            raise InvalidParameter('time', time, f'must lie between 0 and {self.duration:.17g} s')
        return self._record(self._states(np.ravel(times)).reshape(-1, *times.shape))

    @cached_property
    def loads(self) -> NamedFields:
        """Return the loads over time, the forces of all elements in them, fields of shape (n,)."""
        mechanism, modes = self.system.mechanism, self.modes
        motion = np.array([self.position, self.rate, self.acceleration])
        rows = np.full((len(mechanism.LOADS._fields), self.time.size), np.nan)
        for mode in np.unique(modes).tolist():
            in_mode = modes == mode
            rows[:, in_mode] = mechanism.in_mode(mode).loads(*motion[:, in_mode])
        return mechanism.LOADS(*rows)

    def loads_at(self, time: ArrayLike) -> NamedFields:
        """Return the loads at increasing times [s], fields of their shape."""
        times = array('time', time)
        loads = replace(self, asked=checked_times(np.ravel(times), self.duration)).loads
        return loads._make(
            [field.reshape(times.shape) if times.shape else float(field[0]) for field in loads])

    def plot(self) -> Figure:
        """Return a figure of position, rate, acceleration and drive over time, by matplotlib."""
        return from_lab('plot_run', 'a plot', self)

    @property
    def _facts(self) -> dict[str, object]:
        mechanism = self.system.mechanism
        return {'status': self.status, 'reason': self.reason, 'end': f'{self.duration:.6g} s',
                'times': self.time.size,
                'error': f'{self.error:.3g} {mechanism.input_coordinate.unit}',
                'drift': f'{self.drift:.3g}', 'method': self.method,
                'evaluations': self.evaluations, 'linkage': mechanism.description}

    def __repr__(self) -> str:
        return short_repr('Run', self._facts)

    def _repr_html_(self) -> str:
        return html_table(('', ''), list(self._facts.items()))


def checked_times(times: ArrayLike, until: float) -> Array:
    wanted = array('times', times)
    if wanted.ndim != 1 or not wanted.size or not (wanted[0] >= 0.0 and wanted[-1] <= until
                                                   and np.all(np.diff(wanted) > 0.0)):
        raise InvalidParameter('times', times, f'must increase, from 0 to {until:g} s at most')
    return wanted


def difference_of_runs(rough: Run, fine: Run) -> float:
    """Return the largest difference of the input of two runs [rad] or [m]."""
    # At steps of the rougher run and, of explicit methods, between them: their interpolants are
    # less exact than steps, and both may step to the same ends of pieces. Where both stop as
    # asked, the difference of their last times counts too, times the rate.
    if (rough.status == EVENT) != (fine.status == EVENT) or fine.status == STOPPED:
        return inf
    times = np.unique(np.concatenate([leg.time for leg in rough.legs]))
    if rough.method in EXPLICIT:
        steps = np.arange(times.size)
        times = np.interp(np.arange(0.0, times.size - 1 + SHARE, SHARE), steps, times)
    times = times[np.unique(np.linspace(0, times.size - 1, COMPARED).astype(int))]
    times = np.unique(np.minimum(times, min(rough.duration, fine.duration)))
    difference = np.abs(rough._states(times)[0] - fine._states(times)[0])
    if fine.status == EVENT:
        late = (rough.duration - fine.duration) * fine._states(np.array([fine.duration]))[1]
        difference = np.append(difference, np.abs(late))
    return float(np.max(np.nan_to_num(difference, nan=inf), initial=0.0))


def energy_drift(run: Run) -> float:
    """Return the largest change of energy less work at the steps, over the energy in play."""
    # It must be constant, so it measures the error of a run; a change that rounding explains does
    # not count. Computed for all legs in a coordinate at once.
    by_coordinate = dict[int, list[Leg]]()
    for leg in run.legs:
        by_coordinate.setdefault(id(leg.coordinate), []).append(leg)
    of_legs: list[tuple[Array, ...]] = []
    for legs in by_coordinate.values():
        equation = legs[0].coordinate.equation
        states = np.concatenate([leg.states for leg in legs], axis=1)
        kinetic = 0.5 * equation.terms(states[0]).inertia * states[1]**2
        work = 0.0 * kinetic if run.system.is_conservative else states[-1]
        potential, size = equation.potential_and_size(states[0])
        of_legs.append((kinetic, potential, work, size))
    kinetic, potential, work, size = (np.concatenate(rows) for rows in zip(*of_legs))
    constant = kinetic + potential - work
    in_play = float(np.max(kinetic) + np.ptp(potential) + np.ptp(work))
    rounding = ROUNDING * float(np.max(kinetic) + np.max(size) + np.max(np.abs(work)))
    drift = float(np.max(np.abs(constant - constant[0]))) - rounding
    if isnan(drift):        # of energies that are too large
        return inf
    return drift / in_play if drift > 0.0 and in_play > 0.0 else 0.0
