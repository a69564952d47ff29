# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Through toggles and change points: against free bodies with joints, quadrature, energy."""
from math import pi

from fourbar_ros import Applied, Bodies, Body, External
from fourbar_ros.dynamics.elements import TorsionSpring
from fourbar_ros.dynamics.simulation import LIMIT, REACHED, simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive, MotorLine, Shaft
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.sliders import ScotchYoke
from fourbar_ros.numerics.number_types import REAL
import numpy as np
import pytest
from support.multibody import Multibody
from support.samples import some
from support.swings import Alone, BODIES, CASES

scipy = pytest.importorskip('scipy')


def state_of(multibody, rate):
    mechanism, position, _ = rate
    curves = mechanism.make_coefficients(REAL)(position)
    return multibody.start(curves, rate[2])


@some('name', CASES, 1)
def test_a_released_linkage_swings_through_its_limits_as_three_bodies_with_joints(name):
    """Positions, modes and energy of a swing through several toggles, to 1e-8."""
    mechanism, position, rate = CASES[name]
    times = np.linspace(0.0, 3.0, 121)
    run = simulate(System(mechanism, position, rate), 3.0, 1e-9, times=times)
    assert run.status == REACHED and run.time.tolist() == times.tolist()
    multibody = Multibody(mechanism)
    there = multibody.run(state_of(multibody, CASES[name]), times)
    # the inverted slider's place along its bar is not a coordinate of a body: compare angles
    curves = [mechanism.in_mode(int(mode)).make_coefficients(REAL)(q)
              for q, mode in zip(run.position.tolist(), run.modes.tolist())]
    directions = np.array([[curve[6:8] for curve in one] for one in curves])
    theirs = np.stack([np.cos(there[[2, 5, 8]]), np.sin(there[[2, 5, 8]])], axis=-1)
    off = np.abs(directions - theirs.transpose(1, 0, 2)).max(axis=(1, 2))
    far = np.array([c.condition < 20.0 * mechanism.input_unit for c in
                    (mechanism.in_mode(int(m)).motion(q)
                     for q, m in zip(run.position.tolist(), run.modes.tolist()))])
    assert np.max(off[far]) <= 1e-7 and np.count_nonzero(far) > 60
    assert run.drift <= 1e-9
    assert set(run.modes.tolist()) == {1, 2}


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
    run = simulate(System(mechanism, position, 2.0, [TorsionSpring('crank', 'coupler', 3.0, 0.2)],
                          drive), 1.5, 1e-9, times=times)
    assert run.status == REACHED and run.drift <= 1e-9
    low, high = mechanism.input_ranges[-1]
    assert run.position.min() >= low - 1e-9 and run.position.max() <= high + 1e-9
    work = np.trapezoid if hasattr(np, 'trapezoid') else np.trapz
    assert run.states[-1, -1] == pytest.approx(work(run.torque * run.rate, times), abs=1e-4)
    if not shaft:
        assert run.states[-1, -1] == pytest.approx(25.0 * (run.position[-1] - position), abs=1e-8)


def test_a_start_next_to_a_toggle():
    mechanism, *_ = CASES['non-Grashof']
    limit = mechanism.input_ranges[0][1]
    run = simulate(System(mechanism, limit - 1e-9, 0.0), 1.0, 1e-8)
    assert run.status == REACHED and run.drift <= 1e-8
    multibody = Multibody(mechanism)
    there = multibody.run(state_of(multibody, (mechanism, limit - 1e-9, 0.0)), [1.0])
    assert run.position[-1] == pytest.approx(there[2, -1], abs=1e-4)


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


def test_loads_on_links_act_through_toggles():
    mechanism, position, rate = CASES['driven slider']
    external = External(Applied(0.3, 0.1, 2.0, -3.0), Applied(force_x=4.0))
    mechanism = mechanism.with_external(external)
    run = simulate(System(mechanism, position, rate), 2.0, 1e-9, times=[0.7, 1.3, 2.0])
    multibody = Multibody(mechanism)
    there = multibody.run(state_of(multibody, (mechanism, position, rate)), [0.7, 1.3, 2.0])
    assert run.position + 0.4 == pytest.approx(there[6], abs=1e-8)      # of its centre of gravity
    assert run.rate == pytest.approx(there[15], abs=1e-7)
