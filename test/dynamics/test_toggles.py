# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Through toggles and change points: against quadrature of the energy integral, and energy."""
from math import pi

from fourbar_ros import Applied, Bodies, Body, External
from fourbar_ros.dynamics.run import LIMIT, REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive, MotorLine, Shaft
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.elements import TorsionSpring
from fourbar_ros.mechanisms.sliders import ScotchYoke
import mpmath as mp
import numpy as np
import pytest
from support.machines import exact_inertia, exact_potential
from support.samples import some
from support.swings import Alone, BODIES, CASES

pytest.importorskip('scipy')
LOADS = External(Applied(0.3, 0.1, along=2.0, across=-3.0), Applied(force_x=4.0))


def swing(mechanism, position, count=160):
    """
    Return rate and period of a swing through both toggles of a range and back, to 10 digits.

    With q = c + h sin u the mode changes where cos u does, and the period is the integral of
    dt/du over a turn: t = integral of sqrt(J / (2 (E - V))) dq, which knows no equation of motion.
    """
    low, high = next(ends for ends in mechanism.input_ranges if ends[0] < position < ends[1])
    with mp.workdps(20):
        middle, half = (mp.mpf(low) + mp.mpf(high)) / 2, (mp.mpf(high) - mp.mpf(low)) / 2
        inertias, potentials = [], []
        for i in range(count):
            u = (i + mp.mpf(1) / 2) * 2 * mp.pi / count
            here = mechanism.in_mode(mechanism.mode if mp.cos(u) > 0 else 3 - mechanism.mode)
            q = middle + half * mp.sin(u)
            inertias.append((half * mp.cos(u))**2 * exact_inertia(here, q))
            potentials.append(exact_potential(here, (), q))
        inertia = exact_inertia(mechanism, position)
        start, most = exact_potential(mechanism, (), position), max(potentials)
        rate = float(mp.sqrt((3 * most - min(potentials) - 2 * start) / inertia))
        energy = inertia * mp.mpf(rate)**2 / 2 + start
        period = sum(mp.sqrt(j / (2 * (energy - v))) for j, v in zip(inertias, potentials))
        return rate, float(period * 2 * mp.pi / count)


@some('name', CASES, 1)
def test_a_linkage_swings_through_its_limits_as_the_quadrature_says(name):
    """Two periods, each through two toggles, under gravity and loads on the links."""
    mechanism, position, _ = CASES[name]
    mechanism = mechanism.with_external(LOADS)
    rate, period = swing(mechanism, position)
    times = [0.5 * period, period, 1.5 * period, 2.0 * period]
    run = simulate(System(mechanism, position, rate), times[-1], 1e-9, times=times)
    assert run.status == REACHED and run.drift <= 1e-9
    assert np.abs(run.position[1::2] - position).max() <= 2e-9 * mechanism.input_unit
    assert np.abs(run.rate[1::2] - rate).max() <= 1e-7
    assert run.modes[1] == run.modes[3] == mechanism.mode
    assert np.count_nonzero(np.diff(simulate(run.system, period, 1e-9).modes)) == 2


def test_a_yoke_pushed_at_its_slide_turns_its_crank_over_and_over():
    """The crank alone has mass: it turns evenly, the slide is its cosine."""
    bodies = Bodies(Body(0.0, inertia=0.4), Body(0.0), Body(0.0))
    yoke = ScotchYoke(0.5, 0.0, mode=2, input='slide', bodies=bodies)
    angle = 1.0
    run = simulate(System(yoke, 0.5 * np.cos(angle), -0.5 * np.sin(angle) * 7.0), 4.0, 1e-10,
                   times=np.linspace(0.1, 4.0, 40))
    turned = angle + 7.0 * run.time
    assert run.position == pytest.approx(0.5 * np.cos(turned), abs=1e-9)
    assert run.rate == pytest.approx(-3.5 * np.sin(turned), abs=1e-8)
    assert run.acceleration == pytest.approx(-24.5 * np.cos(turned), abs=1e-7)
    assert run.modes.tolist() == np.where(np.sin(turned) > 0.0, 2, 1).tolist()


@pytest.mark.parametrize('shaft', [None, Shaft(50.0, 0.5)])
def test_drive_flywheel_springs_and_work_go_through_toggles(shaft):
    """What drives acts on the input: the work of the torque is the integral of T dq."""
    mechanism, position, _ = CASES['rocker of a crank-rocker']
    drive = Drive(MotorLine(30.0, 40.0) if shaft else ConstantTorque(25.0), rotor=0.02,
                  flywheel=0.05, shaft=shaft)
    times = np.linspace(0.0, 1.5, 20001)
    spring = TorsionSpring('crank', 'coupler', 3.0, free_angle=0.2)
    run = simulate(System(mechanism.with_elements(spring), position, 2.0, drive), 1.5, 1e-9,
                   times=times)
    assert run.status == REACHED and run.drift <= 1e-9
    low, high = mechanism.input_ranges[-1]
    assert run.position.min() >= low - 1e-9 and run.position.max() <= high + 1e-9
    work = np.trapezoid if hasattr(np, 'trapezoid') else np.trapz
    assert run.states.work[-1] == pytest.approx(work(run.torque * run.rate, times), abs=1e-4)
    if not shaft:
        assert run.states.work[-1] == pytest.approx(25.0 * (run.position[-1] - position), abs=1e-8)


def test_a_start_next_to_a_toggle():
    mechanism, *_ = CASES['non-Grashof']
    limit = mechanism.input_ranges[0][1]
    run = simulate(System(mechanism, limit - 1e-9, 0.0), 1.0, 1e-8)
    assert run.status == REACHED and run.drift <= 1e-8


def test_an_input_beyond_half_a_turn_stays_continuous():
    """Whole turns of the start are kept, and the range that crosses pi."""
    mechanism, position, rate = CASES['non-Grashof, other class']
    runs = [simulate(System(mechanism, position + shift, rate), 3.0, 1e-9, times=[1.0, 2.0, 3.0])
            for shift in (0.0, 6.0 * pi)]
    assert runs[1].position - 6.0 * pi == pytest.approx(runs[0].position, abs=1e-8)


def test_without_another_coordinate_it_stops_before_its_toggle():
    rocker = Alone(0.8, 1.2, 0.4, 1.0, bodies=BODIES)
    run = simulate(System(rocker, sum(rocker.input_ranges[0]) / 2, 1.0), 50.0, 1e-6)
    assert run.status == LIMIT and run.time[-1] < 50.0
    low, high = rocker.input_ranges[0]
    assert low < run.position[-1] < high and high - run.position[-1] < 1e-5
