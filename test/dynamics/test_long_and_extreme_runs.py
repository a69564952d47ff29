# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Energy over many turns, extreme scenes, what is refused."""
from dataclasses import replace
from math import pi

from fourbar_ros import Bodies, Body, FourBar
from fourbar_ros.dynamics.run import energy_drift, NOT_CONVERGED, REACHED, STOPPED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.statics import free_period, NotResolved
from fourbar_ros.dynamics.system import System
import numpy as np
import pytest
from support.dynamics_problems import EXTREMES, light_crank, near_change_point
from support.samples import some

scipy = pytest.importorskip('scipy')
BODIES = Bodies(Body(1.0, cg_along=0.2, inertia=0.1),
                Body(2.0, cg_along=0.6, cg_across=0.1, inertia=0.2),
                Body(1.5, cg_along=0.4, inertia=0.1))


def free(**options):
    return System(FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, **options), 0.2, 9.0)


def test_a_wrong_energy_is_seen():
    run = simulate(free(), 5.0, 1e-8, check=False)
    wrong = [leg._replace(states=leg.states * np.array([[1.0], [1.0]]) * np.where(
        np.arange(leg.time.size) < 9, 1.0, 1.0 + 1e-5)) for leg in run.legs]
    assert energy_drift(run) <= 1e-7 and energy_drift(replace(run, legs=tuple(wrong))) > 1e-5


@some('name', EXTREMES, ['light rods 1e-8'])
@pytest.mark.parametrize('method', ['auto', 'LSODA', 'Radau'])
@pytest.mark.parametrize('tolerance', [1e-6, 1e-9])
def test_a_wrong_answer_is_never_a_success(name, tolerance, method):
    """J changes by up to 1e12 within a small angle; what is asked for holds, or is refused."""
    run = simulate(EXTREMES[name].make(), 3.0, tolerance, method)
    error = abs(run.position[-1] - EXTREMES[name].at[3.0])
    assert run.status in (NOT_CONVERGED, STOPPED) or (
        run.status == REACHED and error <= tolerance)
    if method == 'auto' and tolerance == 1e-6 and name != 'near a change point 1e-10':
        assert run.status == REACHED


def test_what_no_tolerance_resolves_is_refused_and_soon():
    """Rounding governs below 1e-9 where J falls to 1e-12: refused after bounded work."""
    run = simulate(light_crank(1e-12), 3.0, 1e-9)
    assert run.status in (NOT_CONVERGED, STOPPED) and run.error > 1e-9
    assert (run.status == STOPPED) == bool(run.reason)
    assert run.evaluations < 5_000_000


def test_quadrature_refuses_peaks_between_its_samples():
    """1e-10 from a change point the crank rests within 1e-5 rad: no sample sees it."""
    with pytest.raises(NotResolved):
        free_period(near_change_point(1e-10))
    system = near_change_point(1e-3)
    period = free_period(system)
    assert simulate(system, period, 1e-9).position[-1] == pytest.approx(1.0 + 2.0 * pi, abs=1e-8)
