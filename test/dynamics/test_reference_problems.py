# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Problems of the field against references of 20 and more digits, each by two routes."""
from math import pi

from fourbar_ros import SliderCrank
from fourbar_ros.dynamics.simulation import REACHED, simulate
from fourbar_ros.dynamics.sources import Drive, MotorLine, Shaft
from fourbar_ros.dynamics.system import System
import mpmath as mp
import numpy as np
import pytest
from support.dynamics_problems import (
    near_lock_up,
    one_window,
    one_window_exact,
    P2_ENERGY,
    P2_POSITION,
    P2_RATE,
    P3_POSITION,
    P4_POSITION,
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


@some('tolerance', [1e-5, 1e-9], (1e-9,))
def test_a_parallelogram_goes_through_its_change_points(tolerance):
    """21 half-turns in 20 s, each through a flat position, against elliptic functions."""
    run = simulate(one_window(), 20.0, tolerance)
    assert run.status == REACHED and run.position[0] - run.position[-1] > 20 * pi
    with mp.workdps(30):
        assert abs(run.position[-1] - one_window_exact(mp.mpf(20))) <= tolerance


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
    """
    P5, crank.f of the IVP Test Set.

    Printed values of the elastic rod, 1e-4 from the rigid one.
    """
    motion = SliderCrank(0.15, 0.30).motion(15.0, 150.0)
    assert motion.beta == pytest.approx(-0.3311734987910881, abs=1e-4)
    assert motion.slide == pytest.approx(0.1697373326718410, abs=1e-4)
    assert motion.omega_beta == pytest.approx(60.25346682645789, rel=1e-3)
    assert motion.slide_velocity == pytest.approx(-8.753116989887888, rel=1e-3)


@some('stiffness', [1e3, 1e5, 1e7], (1e5,))
def test_a_motor_through_an_elastic_shaft(stiffness):
    """
    P6: three methods agree, whatever the stiffness.

    A stiff shaft nears the rigid one as 1/k.
    """
    drive = Drive(MotorLine(400.0, 26.0), rotor=0.5, shaft=Shaft(stiffness, 1e-3 * stiffness))
    runs = [simulate(System(paper_linkage(), 0.0, drive=drive), 0.5, 1e-6, method)
            for method in ('auto', 'LSODA')]
    assert all(run.status == REACHED for run in runs)
    assert abs(runs[0].position[-1] - runs[1].position[-1]) <= 2e-6
    rigid = simulate(System(paper_linkage(), 0.0, drive=Drive(MotorLine(400.0, 26.0), rotor=0.5)),
                     0.5)
    assert abs(runs[0].position[-1] - rigid.position[-1]) <= 500.0 / stiffness + 2e-6


@some('stiffness', [10**3, 10**5, 10**7, 10**9], (10**7,))
def test_a_motor_and_its_shaft_against_many_digits(stiffness):
    pytest.importorskip('flint')
    from support.motor_problem import ANSWERS
    drive = Drive(MotorLine(400.0, 26.0), rotor=0.5, shaft=Shaft(stiffness, 1e-3 * stiffness))
    run = simulate(System(paper_linkage(), 0.0, drive=drive), 0.5, 1e-9)
    assert run.status == REACHED
    exact = np.array([float(text) for text in ANSWERS[stiffness]])
    assert np.max(np.abs(run.states[[0, 2], -1] - exact[[0, 2]])) <= 1e-9
    assert np.max(np.abs(run.states[[1, 3], -1] - exact[[1, 3]])) <= 1e-7


@pytest.mark.slow
def test_the_references_of_the_motor_by_two_formulations():
    stiffness = 1000
    pytest.importorskip('flint')
    from flint import arb
    from support.motor_problem import ANSWERS, one_equation, with_multipliers
    from support.taylor import taylor
    with mp.workdps(35):
        one = taylor(*one_equation(stiffness), arb('0.5'), 1000, 28, 34)
        other = taylor(*with_multipliers(stiffness), arb('0.5'), 1100, 28, 34)
        for text, a, b in zip(ANSWERS[stiffness], one, (other[i] for i in (0, 4, 3, 7))):
            assert abs(a - b) < mp.mpf('1e-21') and abs(a - mp.mpf(text)) < mp.mpf('1e-20')


@pytest.mark.slow
def test_the_references_of_stiff_shafts_by_two_formulations():
    """A mode of 5e4 1/s: implicit, of order 27 and 23, with other steps in each."""
    stiffness, first = 10**7, '1e-6'
    pytest.importorskip('flint')
    from support.collocation import collocation
    from support.motor_problem import ANSWERS, graded, one_equation, with_multipliers
    with mp.workdps(50):
        one = collocation(*one_equation(stiffness), graded(first, 120), 14)
        other = collocation(*with_multipliers(stiffness), graded(first, 100), 12)
        for text, a, b in zip(ANSWERS[stiffness], one, (other[i] for i in (0, 4, 3, 7))):
            assert abs(a - b) < mp.mpf('1e-20') and abs(a - mp.mpf(text)) < mp.mpf('1e-20')


@pytest.mark.slow
def test_the_reference_of_the_window_by_elliptic_functions_and_by_series():
    pytest.importorskip('flint')
    from flint import arb
    from support.taylor import taylor

    def pendulum(state):
        q, w = state
        return [w, -arb('9.81') * 2 / (arb(2) / 3 + 1) * q.sin_cos()[1]]
    with mp.workdps(40):
        exact = one_window_exact(mp.mpf(20))
        series = taylor(pendulum, lambda: [arb.pi() / 2, -1], 20, 1000, 34, 38)[0]
        assert abs(exact - series) < mp.mpf('1e-25')
        assert abs(exact - mp.mpf(P3_POSITION)) < mp.mpf('1e-25')


@pytest.mark.slow
def test_the_references_of_the_slider_crank_by_two_formulations():
    """One equation in q; and x, p, q with Lagrange multipliers, solved for accelerations."""
    from flint import arb
    from support.taylor import taylor
    half = arb(1) / 2

    def spring_force(q, p, v, w):
        (sin_q, cos_q), (sin_p, cos_p) = q.sin_cos(), p.sin_cos()
        x, y = cos_q / 4 + cos_p / 2, sin_q / 4 + sin_p / 2
        length = (x * x + y * y).sqrt()
        by_q, by_p = (y * cos_q - x * sin_q) / 4 / length, (y * cos_p - x * sin_p) / 2 / length
        force = length - 1 + by_q * v + by_p * w
        return -force * by_q, -force * by_p

    def with_multipliers(state):
        x, p, q, u, w, v = state
        (sin_q, cos_q), (sin_p, cos_p) = q.sin_cos(), p.sin_cos()
        on_q, on_p = spring_force(q, p, v, w)
        # constraints x - cos p - cos q / 2 = 0, sin p + sin q / 2 = 0; rows by (x, p, q)
        rows = ((1, sin_p, half * sin_q), (0, cos_p, half * cos_q))
        forces, masses = (1, on_p - sin_p, on_q), (1, 2, 1)
        right = (-cos_p * w * w - half * cos_q * v * v, sin_p * w * w + half * sin_q * v * v)

        def product(one, other):
            return sum((a * b / m for a, b, m in zip(one, other, masses)), arb(0) * q)
        a, b, d = product(rows[0], rows[0]), product(rows[0], rows[1]), product(rows[1], rows[1])
        e, f = (product(row, forces) - r for row, r in zip(rows, right))
        det = a * d - b * b
        first, second = (e * d - b * f) / det, (a * f - b * e) / det
        rates = [(force - r0 * first - r1 * second) / m
                 for force, r0, r1, m in zip(forces, *rows, masses)]
        return [u, w, v, *rates, (u * u + 2 * w * w + v * v) / 2]

    def start():
        p = -arb(half).asin()
        return [p.cos(), p, arb.pi() / 2, 0, 0, 0, 0]
    with mp.workdps(35):
        state = taylor(lambda state: with_multipliers(state[:6]), start, 10, 150)
        assert abs(state[2] - mp.mpf(P2_POSITION)) < mp.mpf('1e-24')
        assert abs(state[5] - mp.mpf(P2_RATE)) < mp.mpf('1e-24')
        assert abs(state[6] - mp.mpf(P2_ENERGY)) < mp.mpf('1e-24')
        state = taylor(lambda state: one_coordinate(state[:2]), lambda: [arb.pi() / 2, 0, 0], 10,
                       100, 36)
        assert abs(state[0] - mp.mpf(P2_POSITION)) < mp.mpf('1e-24')
        assert abs(state[2] - mp.mpf(P2_ENERGY)) < mp.mpf('1e-24')


def one_coordinate(state):
    """
    Return the derivative of (q, v) of P2 from J(q), and the kinetic energy.

    p, x and their derivatives by hand.
    """
    q, v = state
    sin_q, cos_q = q.sin_cos()
    sin_p = -sin_q / 2
    cos_p = (1 - sin_p * sin_p).sqrt()
    p1 = -cos_q / 2 / cos_p
    p2 = (sin_q / 2 + sin_p * p1 * p1) / cos_p
    x1, x2 = -sin_p * p1 - sin_q / 2, -cos_p * p1 * p1 - sin_p * p2 - cos_q / 2
    x, y = cos_q / 4 + cos_p / 2, sin_q / 4 + sin_p / 2
    dx, dy = -sin_q / 4 - sin_p * p1 / 2, cos_q / 4 + cos_p * p1 / 2
    length = (x * x + y * y).sqrt()
    slope = (x * dx + y * dy) / length
    force = x1 - sin_p * p1 - (length - 1 + slope * v) * slope
    inertia = 1 + 2 * p1 * p1 + x1 * x1
    return [v, (force - (2 * p1 * p2 + x1 * x2) * v * v) / inertia, inertia * v * v / 2]


@pytest.mark.slow
def test_the_reference_near_lock_up_by_quadrature_and_by_series():
    from flint import arb
    from support.taylor import taylor

    def derivative(state):
        (q, v), crank = state, arb(1.98)
        sin_q, cos_q = q.sin_cos()
        root = (4 - (crank * sin_q)**2).sqrt()
        slope = -crank * sin_q - crank**2 * sin_q * cos_q / root
        bend = -crank * cos_q - crank**2 * ((cos_q * cos_q - sin_q * sin_q) / root
                                            + crank**2 * (sin_q * cos_q)**2 / root**3)
        return [v, -slope * bend * v * v / (1 + slope * slope)]

    with mp.workdps(36):
        state = taylor(derivative, lambda: [0, 10], arb(4.99), 1500, 32)
        assert abs(state[0] - mp.mpf(P4_POSITION)) < mp.mpf('1e-20')
        crank = mp.mpf(1.98)

        def time_per_angle(q):
            root = mp.sqrt(4 - (crank * mp.sin(q))**2)
            slope = -crank * mp.sin(q) - crank**2 * mp.sin(q) * mp.cos(q) / root
            return mp.sqrt((1 + slope**2) / 100)
        turn = sum(time_per_angle(2 * mp.pi * i / 2048) for i in range(2048)) * 2 * mp.pi / 2048
        turns = int(mp.floor(mp.mpf(4.99) / turn))
        rest = mp.mpf(P4_POSITION) - 2 * mp.pi * turns
        time = turns * turn + mp.quad(time_per_angle, [rest * i / 40 for i in range(41)])
        assert abs(time - mp.mpf(4.99)) < mp.mpf('1e-25')
