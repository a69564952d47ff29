# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven motion: error against CPU time of simulate and scipy's integrators."""
from itertools import groupby, product
from operator import attrgetter
import time
from typing import NamedTuple
import warnings

from fourbar_ros import SliderCrank
from fourbar_ros.dynamics.run import REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import Drive, MotorLine, Shaft, SpeedController
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError
import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp
from support.dynamics_problems import (
    EXTREMES,
    near_lock_up,
    one_window,
    P2_POSITION,
    P4_POSITION,
    paper_linkage,
    sundials_slider_crank,
    windows_exact,
)

from .pages import table

TOLERANCES = (1e-6, 1e-10)
METHODS = ('RK45', 'DOP853', 'LSODA', 'Radau', 'BDF')
BUDGET = 60_000            # evaluations after which a method counts as stuck
ALLOWED = 10.0             # times the tolerance: errors above it are called wrong


class Scene(NamedTuple):
    """A problem: its system, its end [s], the position there, where that is from."""

    family: str
    name: str
    system: System
    until: float
    exact: float
    source: str


class Outcome(NamedTuple):
    """What one run gave: error of the last position, CPU time, what was reported."""

    error: float
    milliseconds: float
    status: str


class StuckError(Exception):
    """More evaluations than the budget."""


def motor(k=None, flywheel=0.0):
    """P6: the paper's crank-rocker, a motor line, a rotor, an elastic shaft."""
    shaft = None if k is None else Shaft(k, 1e-3 * k)
    drive = Drive(MotorLine(400.0, 26.0), rotor=0.5, shaft=shaft, flywheel=flywheel)
    return System(paper_linkage(), 0.0, 0.0, drive=drive)


def controlled(gain):
    """Return a slider-crank held at 150 rad/s by a proportional controller."""
    bodies = type(paper_linkage().bodies)
    crank = SliderCrank(0.15, 0.30, bodies=bodies(*paper_linkage().bodies))
    return System(crank, 0.0, 149.0, drive=Drive(SpeedController(150.0, proportional=gain)))


def by_two(system, until):
    """Return the position by Radau and LSODA at the tightest tolerances, and their difference."""
    ends = [solve_ivp(lambda t, y: system.derivative(t, y.tolist()), (0.0, until), system.start,
                      method, rtol=tolerance, atol=tolerance).y[0, -1]
            for method, tolerance in (('Radau', 1e-11), ('LSODA', 1e-12))]
    return float(ends[0]), f'Radau 1e-11, LSODA 1e-12 differ by {abs(ends[1] - ends[0]):.0e}'


def scenes():
    """Yield all scenes, from soft to extreme."""
    with mp.workdps(30):
        window = float(windows_exact(mp.mpf(20), 1))
    yield Scene('soft', 'P2', sundials_slider_crank(), 10.0, float(P2_POSITION), '29 digits')
    yield Scene('soft', 'P3, N = 1', one_window(), 20.0, window, 'elliptic functions')
    yield Scene('soft', 'P4', near_lock_up(), 4.99, float(P4_POSITION), '32 digits')
    for k in (1e2, 1e5, 1e7, 1e9):
        system = motor(k)
        yield Scene('stiff', f'P6, shaft {k:.0e}', system, 0.3, *by_two(system, 0.3))
    system = controlled(1e6)
    yield Scene('stiff', 'controller gain 1e6', system, 0.05, *by_two(system, 0.05))
    system = motor(1e5, flywheel=1e6)
    yield Scene('stiff', 'flywheel 1e6', system, 0.3, *by_two(system, 0.3))
    for name, its in (('light rods 1e-8', 'light rods 1e-8'),
                      ('light crank 1e-12', 'light crank 1e-12'),
                      ('lock-up 1e-8', 'near lock-up 1e-8'),
                      ('change point 1e-6', 'near a change point 1e-6')):
        make, at = EXTREMES[its]
        yield Scene('extreme', name, make(), 2.0, at[2.0], 'quadrature')


def timed(run):
    """Return the result of a call and its CPU time [ms], the least of two."""
    spent = []
    for _ in range(2):
        start = time.process_time()
        result = run()
        spent.append(1e3 * (time.process_time() - start))
        if spent[0] > 300.0:
            break
    return result, min(spent)


def ours(scene, tolerance):
    """Return the Outcome of simulate, which checks itself."""
    run, spent = timed(lambda: simulate(scene.system, scene.until, tolerance))
    return Outcome(abs(run.position[-1] - scene.exact), spent, run.status)


def theirs(scene, method, tolerance):
    """Return the Outcome of solve_ivp on the same equation."""
    derivative, count = scene.system.derivative, 0

    def counted(now, state):
        nonlocal count
        count += 1
        if count > BUDGET:
            raise StuckError
        try:
            return derivative(now, state.tolist())
        except FourBarError:
            return [np.nan] * len(state)

    def run():
        nonlocal count
        count = 0
        try:
            return solve_ivp(counted, (0.0, scene.until), scene.system.start, method,
                             rtol=tolerance, atol=tolerance)
        except StuckError:
            return None
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        done, spent = timed(run)
    if done is None:
        return Outcome(np.nan, spent, 'stuck')
    return Outcome(abs(done.y[0, -1] - scene.exact), spent,
                   REACHED if done.success else 'failed')


def cell(outcome, tolerance):
    """Return an outcome as text; a wrong answer that was called a success in bold."""
    if outcome.status != REACHED:
        return f'{outcome.status}, {outcome.milliseconds:.0f}'
    text = f'{outcome.error:.0e}, {outcome.milliseconds:.1f}'
    return f'**{text}**' if outcome.error > ALLOWED * tolerance else text


def main():
    """Print all tables."""
    print('Error of the last position [rad], CPU time [ms], at tolerances 1e-6 and 1e-10. '
          '`simulate` runs twice or more and checks itself; the others are `solve_ivp`, once, on '
          'the same equation. Bold: success was reported with an error above 10 tolerances. '
          f'*Stuck*: more than {BUDGET} evaluations.\n')
    every = {method: [] for method in ('simulate', *METHODS)}
    for family, its in groupby(scenes(), attrgetter('family')):
        print(f'\n## {family.capitalize()}\n')
        rows = []
        for scene, tolerance in product(its, TOLERANCES):
            found = [ours(scene, tolerance),
                     *(theirs(scene, method, tolerance) for method in METHODS)]
            for outcomes, outcome in zip(every.values(), found):
                outcomes.append((outcome, tolerance))
            rows.append((f'{scene.name} ({scene.source})', f'{tolerance:.0e}',
                         *(cell(outcome, tolerance) for outcome in found)))
        table(('scene, reference', 'tolerance', *every), rows)
    print('## All of them\n')
    rows = []
    for method, outcomes in every.items():
        good = [each.error <= ALLOWED * tolerance for each, tolerance in outcomes
                if each.status == REACHED]
        rows.append((method, sum(good), len(good) - sum(good), len(outcomes) - len(good)))
    table(('', 'right', 'success reported, error > 10 tolerances', 'stuck or gave up'), rows)
