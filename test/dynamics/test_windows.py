# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""P3, the N-four-bar, as a machine of N loops: through every change point for 20 s."""
from math import pi

from fourbar_ros import FourBar
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.simulation import REACHED, simulate
from fourbar_ros.mechanisms.machine.describe.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np
import pytest
from support.dynamics_problems import one_window, windows, windows_exact
from support.samples import more

pytest.importorskip('scipy')
TOLERANCE = 1e-9


@pytest.mark.parametrize('count', [more(2, 40)])
def test_windows_swing_as_one_pendulum(count):
    """21 half-turns, each through a posture flat on the ground, against elliptic functions."""
    run = simulate(windows(count), 20.0, TOLERANCE, times=(5.0, 12.0, 20.0))
    assert run.status == REACHED
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


def test_one_window_is_the_four_bar():
    """The machine of one loop has the inertia of the kind, at flat positions and next to them."""
    ours = Equation(windows(1).mechanism, start=pi / 2)
    kind = Equation(one_window().mechanism, start=pi / 2)
    for position in (-4.0, -1e-9, 0.0, 1e-12, 1.0, pi, 3.2, 7.0):
        assert np.allclose(ours.terms(position), kind.terms(position), rtol=1e-14, atol=1e-13)


@pytest.mark.parametrize(('lengths', 'flats'), [
    ((1.0, 3.0, 1.0, 3.0), (0.0, pi)), ((1.0, 2.0, 3.0, 2.0), (0.0,)),
    ((1.0, 1.0, 2.0, 2.0), (0.0, pi)), ((1.0, 2.5, 2.5, 1.0), (0.0,)),
    ((1.0, 2.0, 3.0, 4.0), (pi,)),
])
@pytest.mark.parametrize('mode', [1, 2])
def test_any_change_point_is_that_of_the_four_bar(lengths, flats, mode):
    a1, a2, a3, a4 = lengths
    kind, machine = FourBar(*lengths, mode=mode), loop(a1, a2, a3, a4, mode)
    assert machine.flat_inputs == flats
    assert machine.change_point_margin == kind.change_point_margin == 0.0
    for position in (*np.linspace(0.3, 6.0, 9).tolist(), 1e-9, pi - 1e-9, pi + 1e-9, -1e-9):
        one, other = kind.motion(position, 2.0, -1.0), machine.motion(position, 2.0, -1.0)
        for ours, theirs in (('omega_output', 'omega4'), ('alpha_output', 'alpha4'),
                             ('omega_coupler', 'omega_beta'), ('alpha_coupler', 'alpha_beta'),
                             ('theta_output', 'theta4'), ('theta_coupler', 'beta')):
            expected = getattr(one, theirs)
            size = (1.0 + abs(expected)) * (1.0 + one.condition)
            assert abs(getattr(other, ours) - expected) <= 1e-13 * size, (ours, position)


def loop(a1, a2, a3, a4, mode=2, mirrored=False):
    pin, pivot = Point('crank', a1), Point('ground', a4)
    if mirrored:
        return Machine([Dyad('d', 'RRR', pivot, pin, ('output', 'coupler'), length_1=a3,
                             length_2=a2, mode=3 - mode)])
    return Machine([Dyad('d', 'RRR', pin, pivot, ('coupler', 'output'), length_1=a2,
                         length_2=a3, mode=mode)])


def test_a_loop_is_the_same_from_either_end():
    one, other = loop(1.0, 2.0, 3.0, 2.0), loop(1.0, 2.0, 3.0, 2.0, mirrored=True)
    assert one.flat_inputs == other.flat_inputs
    for position in (0.5, 2.0, 4.0):
        m, n = one.motion(position, 1.0), other.motion(position, 1.0)
        for name in ('theta_output', 'omega_output', 'alpha_coupler'):
            assert getattr(m, name) == getattr(n, name)
