# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Problems of the field against references of 20 and more digits."""

from fourbar_ros.dynamics.simulation import REACHED, simulate
from fourbar_ros.dynamics.sources import Drive, MotorLine, Shaft
from fourbar_ros.dynamics.system import System
import numpy as np
import pytest
from support.dynamics_problems import (
    near_lock_up,
    P2_ENERGY,
    P2_POSITION,
    P2_RATE,
    P4_POSITION,
    P6,
    paper_linkage,
    sundials_slider_crank,
)
from support.samples import some

scipy = pytest.importorskip('scipy')


@some('tolerance', [1e-6, 1e-9, 1e-12], (1e-9,))
def test_the_slider_crank_of_sundials(tolerance):
    run = simulate(sundials_slider_crank(), 10.0, tolerance)
    assert run.status == REACHED
    assert abs(run.position[-1] - float(P2_POSITION)) <= tolerance
    assert abs(run.rate[-1] - float(P2_RATE)) <= 10.0 * tolerance
    assert f'{run.position[-1]:.4f}' == '1.2757'        # printed by SUNDIALS


def test_the_integral_of_the_kinetic_energy_of_sundials():
    """G of the source: by Simpson's rule, 4000 intervals; printed with five right digits."""
    system = sundials_slider_crank()
    run = simulate(system, 10.0, 1e-10, times=np.linspace(0.0, 10.0, 4001).tolist())
    kinetic = 0.5 * system.equation.terms(run.position).inertia * run.rate**2
    total = (kinetic[0] + 4.0 * kinetic[1:-1:2].sum() + 2.0 * kinetic[2:-1:2].sum()
             + kinetic[-1]) / 1200.0
    assert abs(total - float(P2_ENERGY)) <= 1e-9
    assert abs(float(P2_ENERGY) - 3.3366160662934146) < 1e-5


def test_near_lock_up_the_check_finds_what_one_run_misses():
    reference = float(P4_POSITION)
    unchecked = simulate(near_lock_up(), 4.99, 1e-6, check=False)
    assert abs(unchecked.position[-1] - reference) > 3e-6 and unchecked.status == 'not checked'
    for tolerance in (1e-6, 1e-10):
        run = simulate(near_lock_up(), 4.99, tolerance)
        assert run.status == REACHED and abs(run.position[-1] - reference) <= tolerance


def test_what_cannot_be_reached_is_not_called_a_success():
    """1e-8 from lock-up the rate jumps by a factor of 1e4 within 1e-4 rad."""
    system = near_lock_up(2.0 * (1.0 - 1e-8))
    run = simulate(system, 0.5, 1e-12)
    other = simulate(system, 0.5, 1e-12, method='RK45', check=False)
    assert run.status != REACHED or abs(run.position[-1] - other.position[-1]) <= 1e-9


@some('stiffness', [10**3, 10**5, 10**7, 10**9], (10**7,))
def test_a_motor_and_its_shaft_against_many_digits(stiffness):
    drive = Drive(MotorLine(400.0, 26.0), rotor=0.5, shaft=Shaft(stiffness, 1e-3 * stiffness))
    run = simulate(System(paper_linkage(), 0.0, drive=drive), 0.5, 1e-9)
    assert run.status == REACHED
    exact = np.array(P6[stiffness])
    assert np.max(np.abs(run.states[[0, 2], -1] - exact[[0, 2]])) <= 1e-9
    assert np.max(np.abs(run.states[[1, 3], -1] - exact[[1, 3]])) <= 1e-7
