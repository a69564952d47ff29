# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""P3, the N-four-bar, as a machine of N loops: through all its change points for 20 s."""
from math import pi

from fourbar_ros.dynamics.simulation import REACHED, simulate
import mpmath as mp
import pytest
from support.dynamics_problems import one_window, windows, windows_exact
from support.samples import more

pytest.importorskip('scipy')
TOLERANCE = 1e-9


@pytest.mark.parametrize('count', [1, more(2, 40)])
def test_windows_swing_as_one_pendulum(count):
    """21 half-turns, each through a posture flat on the ground, against elliptic functions."""
    system = windows(count) if count > 1 else one_window()
    run = simulate(system, 20.0, TOLERANCE, times=(5.0, 12.0, 20.0))
    assert run.status == REACHED and 0.5 * pi - run.position[-1] > 20.0 * pi
    with mp.workdps(30):
        for time, position in zip(run.time.tolist(), run.position.tolist()):
            assert abs(position - windows_exact(mp.mpf(time), count)) <= TOLERANCE
    assert set(run.modes.tolist()) <= {1, 2**count}
    assert run.drift <= TOLERANCE


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
