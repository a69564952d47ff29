# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Energy over many turns, order of the integrators, power at every sample, extreme scenes."""
from dataclasses import replace
from math import pi

from fourbar_ros import Applied, Bodies, Body, External, FourBar
from fourbar_ros.dynamics.elements import Attachment, GROUND, Spring, TorsionSpring
from fourbar_ros.dynamics.simulation import (
    energy_drift,
    NOT_CONVERGED,
    REACHED,
    simulate,
    STOPPED,
)
from fourbar_ros.dynamics.sources import DCMotor, Drive
from fourbar_ros.dynamics.statics import free_period, NotResolved
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.points import point_motion
import mpmath as mp
import numpy as np
import pytest
from support.dynamics_problems import exact_free_time, EXTREMES, light_crank, near_change_point
from support.samples import some

scipy = pytest.importorskip('scipy')
BODIES = Bodies(Body(1.0, 0.2, 0.0, 0.1), Body(2.0, 0.6, 0.1, 0.2), Body(1.5, 0.4, 0.0, 0.1))


def free(**options):
    return System(FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, **options), 0.2, 9.0)


@pytest.mark.parametrize('turns', [1, 10])
def test_energy_of_a_free_motion_stays_over_turns(turns):
    """A free crank is where it was after each turn, and its energy is that of the start."""
    system = free(gravity=(0.0, -9.81))
    run = simulate(system, turns * free_period(system), 1e-8)
    energy = system.equation.energy(run.position, run.rate)
    assert run.status == REACHED and np.ptp(energy) <= 1e-8 * np.max(energy)
    assert run.position[-1] == pytest.approx(0.2 + 2.0 * pi * turns, abs=1e-8)


def test_a_wrong_energy_is_seen():
    run = simulate(free(), 5.0, 1e-8, check=False)
    wrong = [leg._replace(states=leg.states * np.array([[1.0], [1.0]]) * np.where(
        np.arange(leg.time.size) < 9, 1.0, 1.0 + 1e-5)) for leg in run.legs]
    assert energy_drift(run) <= 1e-7 and energy_drift(replace(run, legs=tuple(wrong))) > 1e-5


@pytest.mark.parametrize('method, order', [('RK45', 5), ('Radau', 5), ('DOP853', 8)])
def test_errors_fall_with_the_order_of_the_method_at_least(method, order):
    """Error against evaluations, logarithmically; steps that adapt make it steeper."""
    system = free()
    exact = float(simulate(system, 1.0, 1e-12, times=[1.0]).position[0])
    points = []
    for tolerance in 10.0**-np.arange(5.0, 11.0):
        run = simulate(system, 1.0, float(tolerance), method, check=False)
        points.append((run.evaluations, abs(run.position[-1] - exact)))
    evaluations, errors = np.log(np.array(points)).T
    assert order <= -np.polyfit(evaluations, errors, 1)[0] <= 2.0 * order


@pytest.mark.parametrize('method', ['LSODA', 'BDF'])
def test_errors_of_methods_of_variable_order_follow_their_tolerance(method):
    """Their order changes on the way: the error falls about as the tolerance does."""
    system = free()
    exact = float(simulate(system, 1.0, 1e-12, times=[1.0]).position[0])
    tolerances = 10.0**-np.arange(4.0, 11.0)
    errors = [abs(simulate(system, 1.0, tolerance, method, check=False).position[-1] - exact)
              for tolerance in tolerances.tolist()]
    slope = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.6 <= slope <= 1.3, (slope, errors)


def test_power_balances_at_every_sample():
    """Motor, flywheel, loads, springs and dampers: of the bodies alone, sum to 1e-12 of parts."""
    external = External(Applied(0.3, 0.1, 2.0, -3.0, 0.4), Applied(couple=-0.5))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(0.0, -9.81), external=external)
    spring = Spring(Attachment(GROUND, 0.1, 0.9), Attachment('coupler', 0.3, 0.2), 40.0, 0.5, 3.0)
    torsion = TorsionSpring('crank', 'coupler', 3.0, 0.2, 0.6)
    drive = Drive(DCMotor(24.0, 0.5, 0.1, 0.01, 10.0), rotor=0.05, flywheel=0.1)
    run = simulate(System(linkage, 0.3, 2.0, [spring, torsion], drive), 2.0, 1e-6,
                   times=np.linspace(0.0, 2.0, 101))
    assert run.status == REACHED
    for sample in zip(run.position.tolist(), run.rate.tolist(), run.acceleration.tolist(),
                      run.torque.tolist()):
        parts = power_of(linkage, spring, torsion, sample, drive.rigid_inertia)
        assert abs(sum(parts)) <= 1e-12 * sum(map(abs, parts))


def power_of(linkage, spring, torsion, sample, inertia):
    """Return what bodies and dampers take up, less what loads, springs and drive give [W]."""
    position, rate, acceleration, torque = sample
    motion = linkage.motion(position, rate, acceleration)
    parts = [inertia * rate * acceleration, -torque * rate]
    for link, body in linkage.bodies._asdict().items():
        centre = point_motion(linkage, motion, link, body.cg_along, body.cg_across)
        turning = linkage.link_motion(motion, link)
        parts += [*(body.mass * centre.velocity * (centre.acceleration - linkage.gravity)),
                  body.inertia * turning.omega * turning.alpha]
        if link in linkage.external._fields:
            applied = getattr(linkage.external, link)
            at = point_motion(linkage, motion, link, applied.along, applied.across).velocity
            parts += [-applied.force_x * at[0], -applied.force_y * at[1],
                      -applied.couple * turning.omega]
    end = point_motion(linkage, motion, 'coupler', spring.second.along, spring.second.across)
    apart = end.place - (spring.first.along, spring.first.across)
    length = np.hypot(*apart)
    growth = float(apart @ end.velocity) / length
    crank, coupler = (linkage.link_motion(motion, link) for link in ('crank', 'coupler'))
    angle = np.angle(complex(coupler.cosine, coupler.sine) / complex(crank.cosine, crank.sine)
                     * np.exp(-1j * torsion.free_angle))
    turn = coupler.omega - crank.omega
    return [*parts, spring.stiffness * (length - spring.free_length) * growth,
            spring.damping * growth**2, torsion.stiffness * angle * turn,
            torsion.damping * turn**2]


@some('name', EXTREMES, ['light rods 1e-8'])
@pytest.mark.parametrize('method', ['auto', 'LSODA'])
def test_a_wrong_answer_is_never_a_success(name, method):
    """J changes by up to 1e12 within a small angle; what is asked for holds, or is refused."""
    system, tolerance = EXTREMES[name](), 1e-6
    run = simulate(system, 3.0, tolerance, method)
    time = exact_free_time(system, float(run.position[-1]))
    error = float(abs(time - mp.mpf(float(run.time[-1])))) * abs(run.rate[-1])
    assert run.status in (NOT_CONVERGED, STOPPED) or (
        run.status == REACHED and error <= tolerance)
    if method == 'auto' and name != 'near a change point 1e-10':
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
