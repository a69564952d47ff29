# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Problems of the field against references of 20 and more digits."""

from math import pi

from fourbar_ros import SliderCrank
from fourbar_ros.dynamics.run import REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import Drive, MotorLine, Shaft
from fourbar_ros.dynamics.system import System
import mpmath as mp
import numpy as np
import pytest
from support.dynamics_problems import (
    near_lock_up,
    one_window,
    P2_ENERGY,
    P2_POSITION,
    P2_RATE,
    P4_POSITION,
    P6,
    paper_linkage,
    sundials_slider_crank,
    windows,
    windows_exact,
)
from support.samples import more, some

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


def test_rigid_limit_of_the_flexible_slider_crank():
    """P5, crank.f of the IVP Test Set: printed values of the elastic rod, 1e-4 from the rigid."""
    motion = SliderCrank(0.15, 0.30).motion(15.0, 150.0)
    assert motion.beta == pytest.approx(-0.3311734987910881, abs=1e-4)
    assert motion.slide == pytest.approx(0.1697373326718410, abs=1e-4)
    assert motion.omega_beta == pytest.approx(60.25346682645789, rel=1e-3)
    assert motion.slide_velocity == pytest.approx(-8.753116989887888, rel=1e-3)


@some('stiffness', [10**3, 10**5, 10**7, 10**9], (10**7,))
def test_a_motor_and_its_shaft_against_many_digits(stiffness):
    drive = Drive(MotorLine(400.0, 26.0), rotor=0.5, shaft=Shaft(stiffness, 1e-3 * stiffness))
    run = simulate(System(paper_linkage(), 0.0, drive=drive), 0.5, 1e-9)
    assert run.status == REACHED
    exact = np.array(P6[stiffness])
    error = np.abs(np.array(run.at(0.5)[:4]) - exact[:4])
    assert np.max(error[[0, 2]]) <= 1e-9 and np.max(error[[1, 3]]) <= 1e-7


# --- P3, the N-four-bar, as a machine of N loops: through all its change points for 20 s ---------

@pytest.mark.parametrize('count', [1, more(2, 40)])
def test_windows_swing_as_one_pendulum(count):
    """21 half-turns, each through a posture flat on the ground, against elliptic functions."""
    system = windows(count) if count > 1 else one_window()
    run = simulate(system, 20.0, 1e-9, times=(5.0, 12.0, 20.0))
    assert run.status == REACHED and 0.5 * pi - run.position[-1] > 20.0 * pi
    with mp.workdps(30):
        for time, position in zip(run.time.tolist(), run.position.tolist()):
            assert abs(position - windows_exact(mp.mpf(time), count)) <= 1e-9
    assert set(run.modes.tolist()) == {system.mechanism.mode} and len(run.legs) == 1
    assert run.drift <= 1e-9


@pytest.mark.slow
@pytest.mark.parametrize('count', [64, 200])
def test_more_windows_than_an_integer_has_bits(count):
    """Each dyad is a bit of the mode: 65 of them and more, through one flat posture."""
    run = simulate(windows(count), 1.0, 1e-6, times=(0.5, 1.0))
    assert run.status == REACHED and run.position[0] > 0.0 > run.position[1]
    assert run.modes.tolist() == [2**count, 2**count]
    assert np.isfinite(run.loads.driving_torque).all()
    assert abs(run.position[1] - windows_exact(mp.mpf(1), count)) <= 1e-6


@pytest.mark.parametrize('count', [more(10, 40)])
def test_posts_stay_parallel_to_the_crank(count):
    """At the flat posture and 1e-9 rad and less from it, and both postures are flat ones."""
    machine = windows(count).mechanism
    assert machine.flat_inputs == (0.0, pi) and machine.turns_fully
    for position in (0.0, 1e-300, 1e-9, 1.0, 2.0, 3.0, pi - 1e-9, pi):
        motion = machine.motion(position, 2.0, 3.0)
        for i in (0, count // 2, count - 1):
            assert abs(getattr(motion, f'theta_post{i}') - position) <= 1e-15
            assert abs(getattr(motion, f'omega_post{i}') - 2.0) <= 1e-14
            assert abs(getattr(motion, f'omega_beam{i}')) <= 1e-14
            assert abs(getattr(motion, f'alpha_post{i}') - 3.0) <= 1e-13
