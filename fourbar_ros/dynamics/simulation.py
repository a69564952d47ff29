# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion over time by scipy's solve_ivp, with the result checked: no wrong answer is a success.

A run is integrated leg by leg. A leg is one coordinate (:mod:`fourbar_ros.dynamics.coordinate`)
and one stretch between jumps of the torque; it ends at a limit, where another coordinate takes
over near a toggle, or at a point of a force table. A crank that turns fully goes over many such
points in one leg, by steps in the input (:mod:`.piece_steps`). DOP853 integrates, or LSODA where a
shaft or a drive makes the system stiff.

A run is compared with one at a tenth of its tolerance, all along it, and the energy less the work
of drive and dampers must stay constant at every step. While the difference or the drift of the
energy exceeds the tolerance asked for, the tolerance of the integrator is tightened. If that does
not help, or takes more than allowed, the status says so. The difference is the error of the
rougher run; the finer one is returned.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import copysign, inf, isfinite, isnan, log2, nan, nextafter
from threading import Lock
import time as clock
from typing import Any, NamedTuple, TYPE_CHECKING
import warnings

from fourbar_ros.dynamics.coordinate import MotionCoordinate
from fourbar_ros.dynamics.piece_steps import BetweenSteps, InputStep, steps_over_pieces
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter, Locked
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.notebook import from_lab, html_table, short_repr
from fourbar_ros.numerics.arguments import array, finite
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.optional import MissingPackage
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Stop = Callable[[float, Any], float]      # (time, state) -> number, zero where a run stops
# how a run ends
REACHED, LIMIT = 'reached the end', 'reached a limit of the input'
EVENT, STOPPED = 'stopped where asked', 'gave up'
NOT_CONVERGED, NOT_CHECKED = 'not converged', 'not checked'
# how a leg may end besides: the run goes on
HANDED_OVER, AT_KINK = 'handed over', 'at a kink'
EXPLICIT = 'DOP853', 'RK45'
METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
TIGHTER = 0.1              # tolerance of a finer run over that of the rougher run
TIGHTEST = 1e-14           # tolerance of the finest run; below it rounding governs
MOST = 3_000_000           # evaluations in all runs
FIRST_TRY = 0.1            # part of them after which LSODA takes the place of DOP853
# A run is judged after that part, or so many at least: if each quarter took it hardly farther than
# the one before, and it needs so many times what is left, it is given up.
LEAST_JUDGED, SLOWER, HOPELESS = 10_000, 1.1, 1.2
AIM = 0.3                  # error to aim at, over the tolerance
STIFF = 1e4                # fastest mode at the start times the run, above which LSODA integrates
HUGE = 1e100               # states and derivatives beyond it count as not finite
WITHIN_A_STEP = 5000       # evaluations beyond the bound after which a step is broken off
LONGER = 1.01              # first step in a piece of a table over the time in the one before
LOW_ORDER = 1e-7           # least tolerance at which a method of order 5 is the cheaper one
AHEAD = 1e-7               # way over the unit, and rate over the slip speed, to just after a start
NONE_AHEAD = 1e-9          # what is not smooth at less is so at the start already
SAME = 1e-12               # how far beyond a piece of a table a leg ends
COMPARED, SHARE = 400, 0.25     # most times at which runs are compared, shares of steps apart
ROUNDING = 32.0 * EPS      # of an energy over the sizes of its parts
_LSODA = Lock()            # before scipy 1.17 it serves one thread at a time


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


class Event(NamedTuple):
    """Something that ends a leg of a run."""

    function: Callable[..., float]       # (time, state in the coordinate) -> number: at its zeros
    end: str                             # how the leg then ends, as LIMIT
    direction: float = 0.0               # 1: where it rises, -1: where it falls, 0: both
    before: float | None = None          # its value at the start, if not that of the function


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
    # RK45 takes the place of DOP853 in the rougher run; else the finer one cuts pieces of tables
    is_rough_of_low_order: bool = False
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
        asked, end = self.asked[self.asked <= self._end], self._end
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
    def _end(self) -> float:
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
        if not times.size or not (np.min(times) >= 0.0 and np.max(times) <= self._end):
            raise InvalidParameter('time', time, f'must lie between 0 and {self._end:.17g} s')
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
        loads: NamedFields = mechanism.LOADS(*rows)
        return loads

    def loads_at(self, time: ArrayLike) -> NamedFields:
        """Return the loads at increasing times [s], fields of their shape."""
        times = array('time', time)
        loads = replace(self, asked=_checked_times(np.ravel(times), self._end)).loads
        record: NamedFields = loads._make(
            [field.reshape(times.shape) if times.shape else float(field[0]) for field in loads])
        return record

    def plot(self) -> Figure:
        """Return a figure of position, rate, acceleration and drive over time, by matplotlib."""
        figure: Figure = from_lab('plot_run', 'a plot', self)
        return figure

    @property
    def _facts(self) -> dict[str, object]:
        mechanism = self.system.mechanism
        return {'status': self.status, 'reason': self.reason, 'end': f'{self._end:.6g} s',
                'times': self.time.size,
                'error': f'{self.error:.3g} {mechanism.input_coordinate.unit}',
                'drift': f'{self.drift:.3g}', 'method': self.method,
                'evaluations': self.evaluations, 'linkage': mechanism.description}

    def __repr__(self) -> str:
        return short_repr('Run', self._facts)

    def _repr_html_(self) -> str:
        return html_table(('', ''), list(self._facts.items()))


def simulate(system: System, until: float, tolerance: float = 1e-8, method: str = 'auto',
             times: ArrayLike | None = None, check: bool = True, evaluations: float = MOST,
             seconds: float = inf, progress: Callable[[float], None] | None = None,
             stop_when: Stop | None = None) -> Run:
    """
    Integrate a system from time 0 and check the result.

    ``until``: end of the run [s]. ``tolerance``: largest error of the position at every time,
    relative to 1 rad (of a slide to its unit of length), and of the energy relative to the energy
    in play. ``method``: one of :data:`METHODS`. ``times``: where the answer is wanted [s]; not
    given: at the steps of the integrator. ``check``: False gives one run at this tolerance of the
    integrator, with the status :data:`NOT_CHECKED`. ``evaluations``, ``seconds``: most evaluations
    of the equation of motion in all runs, and most time [s]; a run that needs more ends with the
    status :data:`STOPPED`. ``progress``: called with the part of a run that is done, 0 to 1, once
    for each step.

    ``stop_when``: (time, state) -> number; the run stops where it crosses zero after the start,
    with the status :data:`EVENT`. The state is that of the input, named by ``system.names``:
    ``lambda t, y: y[0] - pi`` stops at half a turn, ``lambda t, y: y[1]`` at the next rest. It is
    asked after each step of the integrator: two zeros within one step are not seen.

    Raises InvalidParameter, and MissingPackage without scipy.
    """
    if not isinstance(system, System):
        raise InvalidParameter('system', system, 'must be a System')
    until = finite('until', until, 'must be a positive number', above=0.0)
    if not 0.0 < finite('tolerance', tolerance) < 1.0:
        raise InvalidParameter('tolerance', tolerance, 'must lie between 0 and 1')
    if method not in METHODS:
        raise InvalidParameter('method', method, f'must be one of {", ".join(METHODS)}')
    if stop_when is not None and not callable(stop_when):
        raise InvalidParameter('stop_when', stop_when, 'must be a function of time and state')
    _check_start(system)
    evaluations, seconds = (
        value if value == inf else finite(name, value, 'must be a positive number', above=0.0)
        for name, value in (('evaluations', evaluations), ('seconds', seconds)))
    work = Work(system, until, None if times is None else _checked_times(times, until), stop_when,
                evaluations, seconds, progress)
    if check:
        return _checked(work, method, tolerance)
    only = _first_run(work, method, max(tolerance, TIGHTEST))
    return only if only.status == STOPPED else replace(only, status=NOT_CHECKED, error=nan)


def _checked(work: Work, method: str, tolerance: float) -> Run:
    """Return a run that agrees with a rougher one; tolerances are tightened until it does."""
    system, allowed = work.system, tolerance * work.system.mechanism.input_unit
    breaks = system.drive.source.breaks if system.drive else ()
    work.is_rough_of_low_order = bool(tolerance >= LOW_ORDER and system.equation.tables and not (
        breaks or system.equation.has_resistance))
    rough = _first_run(work, method, max(TIGHTER * tolerance, TIGHTEST / TIGHTER))
    while rough.status != STOPPED:
        fine = _run(work, rough.method, max(TIGHTER * rough.tolerance, TIGHTEST), is_finer=True)
        fine = replace(fine, error=_difference(rough, fine))
        if fine.status == STOPPED or fine.error <= allowed and fine.drift <= tolerance:
            return fine
        if fine.tolerance < 2.0 * TIGHTEST:
            return replace(fine, status=NOT_CONVERGED)
        if work.is_rough_of_low_order and rough.method == 'DOP853':
            work.is_rough_of_low_order, rough = False, fine
            continue
        # as if errors were in proportion to the tolerance
        share = AIM * allowed / fine.error if fine.error > 0.0 else TIGHTER
        tighter = max(rough.tolerance * min(TIGHTER, max(1e-4, share)), TIGHTEST / TIGHTER)
        # the finer run is the next rough one, unless both would take the same steps
        is_next = (TIGHTEST / TIGHTER <= fine.tolerance <= 2.0 * tighter
                   and not system.equation.has_position_forces and not breaks)
        rough = fine if is_next else _run(work, rough.method, tighter)
    return rough


def _first_run(work: Work, method: str, tolerance: float) -> Run:
    """Return a run by a method; of 'auto' by LSODA, if the system is stiff or DOP853 struggles."""
    if method != 'auto':
        return _run(work, method, tolerance)
    if _is_stiff(work.system, work.until):
        return _run(work, 'LSODA', tolerance)
    # many short legs are no sign of a stiff system: half is left for the finer run
    equation = work.system.equation
    share = 0.5 if equation.has_position_forces or equation.has_resistance else FIRST_TRY
    run = _run(work, 'DOP853', tolerance, share=share)
    if run.status != STOPPED:
        return run
    work.reason = ''
    stiff_run = _run(work, 'LSODA', tolerance)
    return run if stiff_run.status == STOPPED and run._end > stiff_run._end else stiff_run


def _run(work: Work, method: str, tolerance: float, is_finer: bool = False, share: float = 1.0
         ) -> Run:
    work.most, work.first, work.marks = share * work.evaluations, work.used, []
    legs = tuple(_integrate(work, method, tolerance, is_finer))
    run = Run(work.system, legs, work.asked, legs[-1].end, error=inf, drift=nan, method=method,
              tolerance=tolerance, evaluations=work.used, reason=work.reason)
    return replace(run, drift=energy_drift(run))


def _check_start(system: System) -> None:
    """Refuse a start without inertia, or whose kinetic energy overflows."""
    position, rate = system.start[:2]
    try:
        inertia = float(system.equation.terms(position).inertia)
    except InvalidParameter:
        raise
    except FourBarError:           # at a toggle, where another coordinate goes on
        return
    if inertia == 0.0:
        raise InvalidParameter('bodies', None, 'the inertia of the input is zero at '
                               f'{position}: no acceleration follows from a torque')
    if not isfinite(0.5 * inertia * rate * rate):
        raise InvalidParameter('rate', rate, 'is too large: its kinetic energy is no number')


def _checked_times(times: ArrayLike, until: float) -> Array:
    wanted = array('times', times)
    if wanted.ndim != 1 or not wanted.size or not (wanted[0] >= 0.0 and wanted[-1] <= until
                                                   and np.all(np.diff(wanted) > 0.0)):
        raise InvalidParameter('times', times, f'must increase, from 0 to {until:g} s at most')
    return wanted


def _is_stiff(system: System, until: float) -> bool:
    """Return whether stability, not accuracy, would limit the steps of DOP853."""
    # So it is where the fastest mode at the start is far faster than the run: an eigenvalue of the
    # Jacobian, by central differences.
    coordinate, state = system.coordinates.begin(system.start)
    if system.equation.has_resistance:         # within the slip speed LSODA takes over anyway
        state[1] = copysign(max(abs(state[1]), 2.0 * system.mechanism.slip_speed), state[1])
    columns = []
    try:
        for i, value in enumerate(state):
            step = 1e-6 * (1.0 + abs(value))
            rates = [coordinate.derivative(0.0, [*state[:i], value + side, *state[i + 1:]])
                     for side in (step, -step)]
            columns.append([(a - b) / (2.0 * step) for a, b in zip(*rates)])
    except (FourBarError, ArithmeticError):
        return False
    jacobian = np.array(columns)             # transposed: its eigenvalues are the same
    # at each point of a table LSODA starts anew from its lowest order
    allowed = 100.0 * STIFF if system.equation.has_position_forces else STIFF
    return bool(np.all(np.isfinite(jacobian))
                and until * np.max(np.abs(np.linalg.eigvals(jacobian))) > allowed)


# --- one integration -----------------------------------------------------------------------------


def _integrate(work: Work, method: str, tolerance: float, is_finer: bool) -> Iterator[Leg]:
    """Yield the legs of one integration from time 0, to the end or to where the run stops."""
    # A leg ends where the torque jumps, the coordinate hands over to another one, a piece of a
    # force table ends, or the run stops. is_finer: legs between jumps of the torque, and in a
    # piece that takes as long as the one before, are cut in two, so that the run whose error is
    # estimated and the finer one do not take the same steps, unless that takes another method.
    system, stop_when = work.system, work.stop_when
    source = system.drive.source if system.drive else None
    breaks: Array = np.array(source.breaks if source else (), float)
    breaks = breaks[(breaks > 0.0) & (breaks < work.until)]
    if is_finer and breaks.size:
        ends = np.concatenate([[0.0], breaks, [work.until]])
        breaks = np.unique(np.concatenate([breaks, 0.5 * (ends[1:] + ends[:-1])]))
    (coordinate, state), first = system.coordinates.begin(system.start), 0.0
    stop_value = nan         # last value of stop_when that is not zero: no run stops at its start
    end, step = REACHED, None
    leg: Leg | None = None
    begun, middle = 0.0, 0.0    # times at which a piece of a table began and may be half over [s]
    while first < work.until:
        if end == HANDED_OVER:
            coordinate, state = coordinate.next(state)
        events = [*_limits(system, coordinate), _watch(work, first)]
        if coordinate.can_end:
            events.append(Event(coordinate.excess, HANDED_OVER, 1.0))
        is_of_low_order = work.is_rough_of_low_order and method == 'DOP853'
        used = 'RK45' if is_of_low_order and not is_finer else method
        if coordinate.equation.has_resistance:
            beyond = abs(state[1]) / system.mechanism.slip_speed - 1.0
            is_slow = beyond < 0.0 if abs(beyond) > AHEAD else bool(
                coordinate.derivative(first, state)[1] * state[1] < 0.0)
            events.append(_not_smooth(system, coordinate, first, state, is_slow))
            if is_slow and method in EXPLICIT:      # friction is stiff there
                used = 'LSODA'
        if stop_when is not None:
            stop = _of_input(coordinate, stop_when)
            if first == 0.0:
                stop_value = _unless_zero(stop(first, np.array(state)), nan)
            events.append(Event(stop, EVENT, before=stop_value))
        after = int(np.searchsorted(breaks, first, 'right'))
        last = float(breaks[after]) if after < breaks.size else work.until
        # where steps in the input have ended, a leg in time goes on to the end of the piece
        leg, was_in_input = None, leg is not None and isinstance(leg.between, BetweenSteps)
        if coordinate.equation.has_position_forces:
            if used in EXPLICIT and system.mechanism.turns_fully and not (
                    was_in_input or coordinate.equation.has_resistance):
                longest = 0.5 if is_finer and not is_of_low_order else 1.0
                leg = _leg_over_pieces(coordinate, (first, last), state, used, tolerance, longest,
                                       work, events)
            excess = coordinate.equation.make_excess(state[0])
            events.append(Event(lambda time, state, excess=excess: excess(float(state[0])) - SAME,
                                AT_KINK, direction=1.0))
        if leg:
            begun = float(leg.time[max(-leg.time.size, -3 if is_finer else -2)])
        else:
            if first < middle < last and not is_of_low_order:
                last = middle
            leg = _leg(coordinate, (first, last), state, used, tolerance, work, events, step)
        # a leg without length, as two coordinates handing over to each other: nothing goes on
        stands = leg.time[-1] <= nextafter(first, inf)
        if stands and leg.end in (HANDED_OVER, AT_KINK):
            leg = leg._replace(end=LIMIT)
        yield leg
        # The first step into the next piece of a table, which takes about as long. Were it as long
        # as the piece, it would end exactly at its end, and scipy before 1.12 would stop there.
        first, state, end = float(leg.time[-1]), leg.states[:, -1].tolist(), leg.end
        if end == AT_KINK and coordinate.equation.has_position_forces:
            length, begun = first - begun, first
            step, middle = LONGER * length, 0.0
            if is_finer:
                step, middle = 0.5 * step, first + 0.5 * length
        elif end != REACHED:
            step = None
        if end not in (REACHED, HANDED_OVER, AT_KINK):
            return
        if stop_when is not None:
            stop_value = _unless_zero(stop(first, leg.states[:, -1]), stop_value)


def _unless_zero(value: float, instead: float) -> float:
    return instead if value == 0.0 else value


def _leg(coordinate: MotionCoordinate, span: tuple[float, float], state: list[float], method: str,
         tolerance: float, work: Work, events: list[Event], step: float | None) -> Leg:
    """Return the leg that begins at a state, over a span of time or to the first of the events."""
    start = np.array(state)
    rates = work.counted(coordinate.derivative, span[1])
    result = _solved(rates, span, start, method, tolerance, dense_output=True,
                     events=[_remembered(event, span[0]) for event in events],
                     first_step=None if step is None else min(step, span[1] - span[0]))
    if result is None or result.t.size < 2 or not np.all(np.abs(result.y) < HUGE):
        work.reason = _why_no_step(work, method, span[0])
        return Leg(coordinate, np.array(span[:1]), start[:, None],
                   lambda times: np.repeat(start[:, None], times.size, 1), STOPPED)
    end = REACHED
    if result.status == 1:
        end = next(event.end for event, times in zip(events, result.t_events) if times.size)
    elif result.status == -1:
        end, work.reason = STOPPED, _why_no_step(work, method, float(result.t[-1]))
    length = result.t[-1] - result.t[-2]
    if end in (HANDED_OVER, AT_KINK) and length > 0.0:
        # where the run goes on a step is more exact than the interpolant
        last = _solved(rates, result.t[-2:], result.y[:, -2], method, tolerance, first_step=length)
        if last is not None and last.status == 0:
            result.y[:, -1] = last.y[:, -1]
    return Leg(coordinate, result.t, result.y, result.sol, end)


def _leg_over_pieces(coordinate: MotionCoordinate, span: tuple[float, float], state: list[float],
                     method: str, tolerance: float, longest: float, work: Work,
                     events: list[Event]) -> Leg | None:
    """Return the leg in steps of the input, up to that in which an event is; None: no step."""
    steps, start = list[InputStep](), np.array(state)
    before = [event.function(span[0], start) if event.before is None else event.before
              for event in events]
    try:
        for step in steps_over_pieces(coordinate, span, start, getattr(_integrators(), method),
                                      tolerance, longest, work.counted):
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


def _solved(rates: Callable[..., Any], span: Sequence[float], start: Array, method: str,
            tolerance: float, **options: Any) -> Any:
    """Return the result of solve_ivp, or None where numbers overflow."""
    solve_ivp = _integrators().solve_ivp
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
            return resisting(time, state).edges
        except (FourBarError, ArithmeticError):      # no step of the integrator ends there
            return ()
    # the start may be such an event itself: the signs are read a little ahead, and an edge that
    # is zero there too ends nothing (its sign is 0)
    position, rate, *rest = state
    ahead = position + copysign(AHEAD * coordinate.equation.coordinate.input_unit, rate)
    signs = [copysign(1.0, edge) if abs(edge) > NONE_AHEAD else 0.0
             for edge in edges_at(time, [ahead, rate, *rest])]

    def excess(time: float, state: Array) -> float:     # negative until the event
        beyond = abs(state[1]) / system.mechanism.slip_speed - 1.0
        changed = [-sign * edge for sign, edge in zip(signs, edges_at(time, state.tolist()))]
        return float(max([beyond if is_slow else -beyond, *changed])) - SAME
    return Event(excess, AT_KINK, direction=1.0)


def _of_input(coordinate: MotionCoordinate, stop_when: Stop) -> Stop:
    return lambda time, state: finite('stop_when', stop_when(
        time, coordinate.states_of_input(np.asarray(state))))


# --- checks --------------------------------------------------------------------------------------


def _difference(rough: Run, fine: Run) -> float:
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
    times = np.unique(np.minimum(times, min(rough._end, fine._end)))
    difference = np.abs(rough._states(times)[0] - fine._states(times)[0])
    if fine.status == EVENT:
        late = (rough._end - fine._end) * fine._states(np.array([fine._end]))[1]
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
