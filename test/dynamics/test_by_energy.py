# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Motion by the energy integral: against digits, closed forms and an integrator over time."""
from math import pi

from fourbar_ros import Applied, Bodies, Body, External, FourBar
from fourbar_ros.dynamics.model.drives import ConstantTorque, Drive, MotorLine, Shaft
from fourbar_ros.dynamics.model.elements import Attachment, GROUND, Spring
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.by_energy import can_follow, follow
from fourbar_ros.dynamics.solve.simulate import ENERGY, REACHED, simulate
import mpmath as mp
import numpy as np
import pytest
from support.andrews import ANDREWS_ANGLE, ANDREWS_RATE, UNTIL
from support.dynamics_problems import exact_free_time, EXTREMES, one_window
from support.machines import andrews, ANDREWS_BETA
from support.samples import some

pytest.importorskip('scipy')
EPS = 2.0**-52
BODIES = Bodies(Body(1.0, 0.2, 0.0, 0.1), Body(2.0, 0.6, 0.1, 0.2), Body(1.5, 0.4, 0.0, 0.1))
WHEEL = Bodies(Body(0.0, inertia=2.0), Body(0.0), Body(0.0))


def loaded(torque, rate, bodies=BODIES, **options):
    """Return a crank-rocker with everything that depends on its input alone."""
    external = External(Applied(0.3, 0.1, 2.0, -3.0, 0.4), Applied(couple=-0.5))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, gravity=(0.0, -9.81), external=external)
    spring = Spring(Attachment(GROUND, 0.1, 0.9), Attachment('coupler', 0.3, 0.2), 40.0, 0.5,
                    **options)
    return System(linkage, 0.3, rate, [spring],
                  Drive(ConstantTorque(torque), rotor=0.05, flywheel=0.1))


def wheel(torque, rate, **options):
    """Return a linkage of which only the crank has mass: J is constant."""
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=WHEEL, **options)
    return System(linkage, 0.3, rate, drive=Drive(ConstantTorque(torque)))


def test_andrews_squeezer_to_the_rounding_of_its_inertia_from_a_few_hundred_poses():
    """Two and a half turns from rest; an integrator over time takes some 8000 evaluations."""
    machine, spring, torque = andrews()
    system = System(machine, ANDREWS_BETA, 0.0, [spring], Drive(ConstantTorque(torque)))
    run = simulate(system, UNTIL, 1e-9)
    assert (run.status, run.method) == (REACHED, ENERGY)
    assert abs(run.position[-1] - float(ANDREWS_ANGLE)) <= 1e-12 and run.error <= 1e-9
    assert abs(run.rate[-1] - float(ANDREWS_RATE)) <= 1e-12 * run.rate[-1]
    assert run.drift <= 1e-13 and run.evaluations <= 500
    assert run.position[0] == ANDREWS_BETA and run.rate[0] == 0.0
    assert run.acceleration[0] == pytest.approx(14222.4439199541, rel=1e-14)


@pytest.mark.parametrize(('torque', 'rate'), [(20.0, 8.0), (-20.0, -8.0), (40.0, 0.0),
                                              (-40.0, 0.0)])
def test_it_is_what_integration_over_time_gives(torque, rate):
    """With weight, forces, couples, a spring and a flywheel, to either side, also from rest."""
    system, times = loaded(torque, rate), np.linspace(0.0, 1.2, 13).tolist()
    runs = [simulate(system, 1.2, 1e-9, method, times) for method in ('auto', 'DOP853')]
    assert [run.status for run in runs] == [REACHED] * 2
    assert [run.method for run in runs] == [ENERGY, 'DOP853']
    assert runs[0].time.tolist() == times and abs(runs[0].position[-1]) > 2.0 * pi
    assert np.abs(runs[0].position - runs[1].position).max() <= 2e-9
    sizes = np.abs(runs[1].states).max(axis=1, keepdims=True)
    assert np.all(np.abs(runs[0].states - runs[1].states) <= 1e-8 * sizes)
    assert runs[0].drift <= 1e-12


@pytest.mark.parametrize(('torque', 'rate'), [(6.0, 1.0), (6.0, 0.0), (-6.0, -1.0), (0.0, 3.0)])
def test_a_flywheel_under_a_constant_torque(torque, rate):
    run = simulate(wheel(torque, rate), 3.0, 1e-10)
    assert run.method == ENERGY
    exact = 0.3 + rate * run.time + 0.25 * torque * run.time**2
    assert np.abs(run.position - exact).max() <= 64 * EPS * np.abs(exact).max()
    assert np.abs(run.states[2] - torque * (exact - 0.3)).max() <= 1e-12


def test_hundreds_of_turns_cost_hardly_more_evaluations_than_one():
    system = loaded(20.0, 30.0)
    found = [follow(system, until, 1e-6, np.array([until])) for until in (0.5, 10.0)]
    (_, _, one), (part, _, many) = found
    assert part.states[0, -1] > 200.0 * pi and many <= 2 * one


def test_what_turns_back_rests_or_depends_on_the_rate_is_integrated():
    back = simulate(wheel(-6.0, 1.0), 3.0, 1e-9)
    assert back.method == 'DOP853' and back.status == REACHED
    assert back.position[-1] == pytest.approx(0.3 + 3.0 - 0.25 * 6.0 * 9.0, abs=1e-9)
    at_rest = simulate(wheel(0.0, 0.0), 1.0)
    assert at_rest.method == 'DOP853' and at_rest.position[-1] == 0.3
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES)
    others = [loaded(20.0, 8.0, damping=0.1), System(linkage, 0.0, 9.0, drive=Drive(
        MotorLine(40.0, 20.0))), System(linkage, 0.0, 9.0, drive=Drive(
            ConstantTorque(1.0), rotor=0.1, shaft=Shaft(1e3))),
        System(FourBar(1.0, 1.2, 0.8, 1.5, bodies=BODIES), 1.0, 0.1),
        System(one_window().mechanism, 1.0, 5.0, stops_at_change_points=True)]
    assert not any(can_follow(system) for system in others)


def test_one_that_stops_just_before_the_top_is_slow_there_and_right():
    """A weight over its top with 1e-9 of its energy left: as in (F1), in 20 digits."""
    bodies = Bodies(Body(1.0, 0.2, 0.0, 0.1), Body(0.0), Body(0.0))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, gravity=(0.0, -9.81))
    inertia, lift = 0.1 + 0.04, 9.81 * 0.2
    rate = float(np.sqrt(2.0 * lift * (2.0 + 1e-9) / inertia))
    run = simulate(System(linkage, -pi / 2, rate), 4.0, 1e-6)
    assert run.method == ENERGY and run.status == REACHED
    with mp.workdps(20):
        def slowness(q):
            spare = mp.mpf(inertia) * mp.mpf(rate)**2 / 2 - mp.mpf(lift) * (mp.sin(q) + 1)
            return mp.sqrt(mp.mpf(inertia) / (2 * spare))
        top, end = mp.pi / 2, mp.mpf(float(run.position[-1]))
        assert end > top
        near = [top + side * mp.mpf(2)**-i for side in (-1, 1) for i in range(0, 24, 2)]
        places = [-mp.pi / 2, *sorted(p for p in [*near, top] if p < end), end]
        assert abs(mp.quad(slowness, places) - 4) * run.rate[-1] <= 1e-6


@some('name', EXTREMES, ['light crank 1e-12', 'near a change point 1e-10'])
def test_its_error_is_not_more_than_it_says(name):
    """J changes by up to 1e12 within a small angle; or it gives none, for rounding governs."""
    system = EXTREMES[name]()
    found = follow(system, 3.0, 1e-6, np.array([3.0]))
    if found is None:
        assert name == 'near a change point 1e-10'
        return
    part, error, _ = found
    position, rate = part.states[:, -1].tolist()
    assert abs(exact_free_time(system, position) - 3) * abs(rate) <= error + 1e-14
