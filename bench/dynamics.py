# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven motion: error against CPU time on the reference problems."""
from pathlib import Path
import sys
import time

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).parent.parent / 'test'))
from fourbar_ros.dynamics.free_motion import FreeMotion  # noqa: E402, I100
from fourbar_ros.dynamics.simulate import simulate  # noqa: E402
from support.dynamics_problems import (  # noqa: E402
    near_lock_up,
    one_window,
    one_window_exact,
    P2_POSITION,
    P4_POSITION,
    sundials_slider_crank,
)

ROUNDS = 5


def timed(run):
    """Return the result and the least CPU time of some rounds [ms]."""
    least = np.inf
    for _ in range(ROUNDS):
        start = time.process_time()
        result = run()
        least = min(least, time.process_time() - start)
    return result, 1e3 * least


def scipy_alone(system, until, tolerance):
    """Return the position at the end by solve_ivp's DOP853 on the same equation."""
    def derivative(now, state):
        return system.derivative(now, state.tolist())
    return solve_ivp(derivative, (0.0, until), system.start, 'DOP853', rtol=max(tolerance, 3e-14),
                     atol=tolerance).y[0, -1]


def problems():
    """Yield name, system, end and exact position."""
    with mp.workdps(30):
        yield 'P2', sundials_slider_crank(), 10.0, float(P2_POSITION)
        yield 'P3', one_window(), 20.0, float(one_window_exact(mp.mpf(20)))
        yield 'P4', near_lock_up(), 4.99, float(P4_POSITION)


def main():
    """Print a table in Markdown."""
    print('| problem | tolerance '
          '| checked: error, ms | one run: error, ms | solve_ivp: error, ms |')
    print('| --- | --- | --- | --- | --- |')
    for name, system, until, exact in problems():
        for tolerance in (1e-6, 1e-9, 1e-12):
            cells = []
            for run in (lambda: simulate(system, until, tolerance).position[-1],
                        lambda: simulate(system, until, tolerance, check=False).position[-1],
                        lambda: scipy_alone(system, until, tolerance)):
                position, milliseconds = timed(run)
                cells.append(f'{abs(position - exact):.1e}, {milliseconds:.1f}')
            print(f'| {name} | {tolerance:.0e} | {" | ".join(cells)} |', flush=True)
        if system.is_conservative:
            position, milliseconds = timed(lambda: FreeMotion(system).position(until))
            cell = f'{abs(position - exact):.1e}, {milliseconds:.1f}'
            print(f'| {name} | quadrature | {cell} | | |', flush=True)


if __name__ == '__main__':
    main()
