# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion over time, with the result checked: no wrong answer is a success.

A run (:mod:`.run`, of :mod:`.legs`) is compared with one at a tenth of its tolerance, all along
it, and the energy less the work of drive and dampers must stay constant at every step. While the
difference or the drift of the energy exceeds the tolerance asked for, the tolerance of the
integrator is tightened. If that does not help, or takes more than allowed, the status says so. The
difference is the error of the rougher run; the finer one is returned.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import copysign, inf, isfinite, nan

from fourbar_ros.dynamics.legs import FIRST_TRY, integrate, Integration, Stop, Work
from fourbar_ros.dynamics.run import (
    checked_times,
    difference_of_runs,
    energy_drift,
    NOT_CHECKED,
    NOT_CONVERGED,
    Run,
    STOPPED,
)
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arguments import finite
import numpy as np
from numpy.typing import ArrayLike

METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
TIGHTER = 0.1              # tolerance of a finer run over that of the rougher run
TIGHTEST = 1e-14           # tolerance of the finest run; below it rounding governs
MOST = 3_000_000           # evaluations in all runs
AIM = 0.3                  # error to aim at, over the tolerance
STIFF = 1e4                # fastest mode at the start times the run, above which LSODA integrates
LOW_ORDER = 1e-7           # least tolerance at which a method of order 5 is the cheaper one


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
    work = Work(system, until, None if times is None else checked_times(times, until), stop_when,
                evaluations, seconds, progress)
    if check:
        return _checked(work, method, tolerance)
    only = _first_run(work, method, max(tolerance, TIGHTEST))
    return only if only.status == STOPPED else replace(only, status=NOT_CHECKED, error=nan)


def _checked(work: Work, method: str, tolerance: float) -> Run:
    """Return a run that agrees with a rougher one; tolerances are tightened until it does."""
    equation, allowed = work.system.equation, tolerance * work.system.mechanism.input_unit
    breaks = work.system.drive.source.breaks if work.system.drive else ()
    # The two must not take the same steps, as from end to end of a piece of a table. Another
    # method does not; where that does not do, the finer one cuts pieces in two.
    is_of_low_order = bool(
        tolerance >= LOW_ORDER and method in ('auto', 'DOP853') and equation.tables
        and not (breaks or equation.has_resistance))
    rough = _first_run(work, method, max(TIGHTER * tolerance, TIGHTEST / TIGHTER),
                       'RK45' if is_of_low_order else 'DOP853')
    while rough.status != STOPPED:
        finer = max(TIGHTER * rough.tolerance, TIGHTEST)
        if is_of_low_order and rough.method == 'RK45':
            fine = _run(work, Integration('DOP853', finer))
        else:
            fine = _run(work, Integration(rough.method, finer, cuts_pieces=True))
        fine = replace(fine, error=difference_of_runs(rough, fine))
        if fine.status == STOPPED or fine.error <= allowed and fine.drift <= tolerance:
            return fine
        if fine.tolerance < 2.0 * TIGHTEST:
            return replace(fine, status=NOT_CONVERGED)
        if rough.method != fine.method:
            rough = fine
            continue
        # as if errors were in proportion to the tolerance
        share = AIM * allowed / fine.error if fine.error > 0.0 else TIGHTER
        tighter = max(rough.tolerance * min(TIGHTER, max(1e-4, share)), TIGHTEST / TIGHTER)
        # the finer run is the next rough one, unless both would take the same steps
        is_next = (TIGHTEST / TIGHTER <= fine.tolerance <= 2.0 * tighter
                   and not equation.has_position_forces and not breaks)
        rough = fine if is_next else _run(work, Integration(rough.method, tighter))
    return rough


def _first_run(work: Work, method: str, tolerance: float, explicit: str = 'DOP853') -> Run:
    """Return a run; of 'auto' by LSODA if the system is stiff or the explicit method struggles."""
    if method != 'auto':
        return _run(work, Integration(explicit if method == 'DOP853' else method, tolerance))
    lsoda = Integration('LSODA', tolerance)
    if _is_stiff(work.system, work.until):
        return _run(work, lsoda)
    # many short legs are no sign of a stiff system: half is left for the finer run
    equation = work.system.equation
    share = 0.5 if equation.has_position_forces or equation.has_resistance else FIRST_TRY
    run = _run(work, Integration(explicit, tolerance), share)
    if run.status != STOPPED:
        return run
    work.reason = ''
    stiff_run = _run(work, lsoda)
    return run if stiff_run.status == STOPPED and run.duration > stiff_run.duration else stiff_run


def _run(work: Work, integration: Integration, share: float = 1.0) -> Run:
    work.most, work.first, work.marks = share * work.evaluations, work.used, []
    legs = tuple(integrate(work, integration))
    run = Run(work.system, legs, work.asked, legs[-1].end, error=inf, drift=nan,
              method=integration.method, tolerance=integration.tolerance,
              evaluations=work.used, reason=work.reason)
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
