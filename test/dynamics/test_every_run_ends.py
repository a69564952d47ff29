# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every run ends with a status: limited controllers, hostile sources, bounds; threads."""
from concurrent.futures import ThreadPoolExecutor
from math import pi

from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.node_step import Mover, NOT_FINITE, OK
from fourbar_ros.dynamics.run import LIMIT, NOT_CONVERGED, REACHED, STOPPED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import (
    ConstantTorque,
    Drive,
    MotorLine,
    Shaft,
    SpeedController,
    TorqueTable,
)
from fourbar_ros.dynamics.statics import equilibria
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.elements import Attachment, GROUND, Spring, TorsionSpring
from fourbar_ros.scene.scene import load
import numpy as np
import pytest
from support.dynamics_problems import paper_linkage, steps, wheel
from support.samples import some

scipy = pytest.importorskip('scipy')
STATUSES = {REACHED, LIMIT, NOT_CONVERGED, STOPPED}
HEAVY = paper_linkage(gravity=(0.0, -9.81))


def test_a_controller_at_its_limit_takes_its_integral_back():
    """Linear between the limits of the torque and beyond: matrix exponentials, one by one."""
    from scipy.linalg import expm
    from scipy.optimize import brentq
    kp, ki, limit, wanted, inertia = 10.0, 1000.0, 300.0, 25.0, 2.0
    # (angle, speed, integral, 1) by the linear law and at the upper and the lower limit, where
    # dz/dt = e + (T - kp e - ki z) / kp = (T - ki z) / kp
    inner = np.array([[0.0, inertia, 0.0, 0.0], [0.0, -kp, ki, kp * wanted],
                      [0.0, -inertia, 0.0, inertia * wanted], [0.0] * 4]) / inertia

    def at_limit(torque):
        return np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, torque / inertia],
                         [0.0, 0.0, -ki / kp, torque / kp], [0.0] * 4])

    def torque(state):
        return kp * (wanted - state[1]) + ki * state[2]
    until, time, state, exact = 0.3, 0.0, np.array([0.0, 0.0, 0.0, 1.0]), []
    while until - time > 1e-12:
        over = abs(torque(expm(1e-9 * inner) @ state)) > limit
        law = at_limit(np.copysign(limit, torque(state))) if over else inner
        ahead = np.linspace(0.0, until - time, 301)[1:]
        sides = [abs(torque(expm(t * law) @ state)) - limit for t in ahead]
        changes = [i for i, side in enumerate(sides[1:], 1) if side * sides[i - 1] < 0.0]
        last = (brentq(lambda t, law=law, state=state: abs(torque(expm(t * law) @ state)) - limit,
                       ahead[changes[0] - 1], ahead[changes[0]], xtol=1e-15)
                if changes else until - time)
        time, state = time + last, expm(last * law) @ state
        exact.append((time, *state[:3]))
    assert len(exact) >= 3
    system = System(wheel(), 0.0, drive=Drive(SpeedController(wanted, kp, ki, limit)))
    run = simulate(system, until, 1e-10)
    assert run.status == REACHED
    for time, angle, _, integral in exact:
        state = run.at(min(time, until))
        assert abs(state.position - angle) <= 1e-9 and abs(state.source[0] - integral) <= 1e-9


def test_the_node_follows_the_limit_within_its_steps():
    """As shipped it used up its budget 32 times in 8 s, and was 2e-3 rad away."""
    scene = load('controlled')
    system, until = scene.dynamics.system(scene.linkage), 2.0
    run = simulate(system, until, 1e-9, times=1e-3 * np.arange(1, 2001))
    went = steps(Mover(system, scene.drive.tolerance, scene.drive.budget), 2000)
    assert {done.status for done in went} == {OK}
    assert np.abs(run.position - [done.state.vector.position for done in went]).max() <= 1e-6


def test_a_crank_that_turns_fully_is_never_at_a_limit():
    mover = Mover(System(HEAVY, 0.0, drive=Drive(ConstantTorque())), 1e-6, 60, True)
    assert mover.advance(mover.first, 1e-3, 1e300).status == NOT_FINITE


class Coulomb:
    """Dry friction as a user may write it: the torque jumps at rest."""

    start, breaks = (), ()

    def torque(self, time, speed, state):
        """Return it."""
        return -50.0 * float(np.sign(speed)), ()


HOSTILE = {
    'dry friction': Drive(Coulomb()), 'torque 1e308': Drive(ConstantTorque(1e308), 0.5),
    'gain 1e7': Drive(SpeedController(25.0, 1e7, 0.0, 400.0), 0.5),
    'integral at 1e7': Drive(SpeedController(25.0, 1e7, 1e9, 400.0), 0.5),
    'limit 1e-300': Drive(SpeedController(25.0, 10.0, 1e3, 1e-300), 0.5),
    'gain 1e300': Drive(SpeedController(25.0, 1e300, 1e300, 400.0), 0.5),
    'rotor 1e-300': Drive(MotorLine(400.0, 26.0), 1e-300, shaft=Shaft(1e5)),
    'motor 1e-9': Drive(MotorLine(400.0, 1e-9), 0.5)}


@pytest.mark.parametrize('name', HOSTILE)
def test_a_hostile_drive_ends_with_a_status(name):
    # at a gain of 1e7 rounding decides on the steps: 89,000 to 182,000 evaluations from starts
    # 1e-9 rad apart
    most = 400_000 if name == 'gain 1e7' else 100_000
    run = simulate(System(HEAVY, 0.0, 5.0, drive=HOSTILE[name]), 3.0, 1e-6, evaluations=most)
    assert run.status in STATUSES and run.evaluations <= 1.1 * most
    assert bool(run.reason) is (run.status == STOPPED)
    if name == 'gain 1e7':
        assert run.status == REACHED and run.method == 'LSODA'


@some('method', ['LSODA', 'Radau', 'BDF', 'RK45', 'DOP853'], ('Radau',))
def test_every_method_ends(method):
    run = simulate(System(HEAVY, 0.0, 5.0, drive=Drive(Coulomb())), 3.0, 1e-6, method,
                   evaluations=5_000)
    assert run.status == STOPPED and run.time[-1] < 3.0 and run.reason


def test_a_run_that_will_not_end_within_its_evaluations_says_so_early():
    """Nothing damps the torque: turns grow with the square of the time."""
    system = System(load('paper').linkage, -0.5, drive=Drive(ConstantTorque(0.1)))
    run = simulate(system, 600.0, evaluations=300_000)
    assert run.status == STOPPED and run.evaluations <= 0.25 * 300_000
    assert 'evaluations are still needed: ask for evaluations=' in run.reason
    done = simulate(system, 20.0, evaluations=300_000)      # which needs more than a tenth of them
    assert done.status == REACHED and done.evaluations > 30_000


def test_the_bounds_of_a_run_and_its_progress():
    system, done = System(HEAVY, 0.0, drive=Drive(MotorLine(400.0, 26.0), 0.5)), []
    run = simulate(system, 1.0, progress=done.append)
    assert run.status == REACHED and max(done) == 1.0 and len(done) > 20
    few = simulate(system, 1.0, evaluations=500)
    assert few.status == STOPPED and few.evaluations < 600 and '500 evaluations' in few.reason
    none = simulate(system, 1.0, seconds=1e-9)
    assert none.status == STOPPED and '1e-09 s are used up' in none.reason


@some('seed', range(12), 2)
def test_random_drives_and_springs_end(seed):
    random = np.random.default_rng(seed)

    def size(low=-3.0, high=8.0):
        return float(10.0**random.uniform(low, high))
    source = [lambda: ConstantTorque(size() * random.choice([-1.0, 1.0])),
              lambda: MotorLine(size(), size(-3.0, 3.0)),
              lambda: SpeedController(size(-2.0, 2.0), size(), size(), size()),
              lambda: TorqueTable(np.cumsum(random.uniform(1e-4, 0.1, 50)),
                                  size(-1.0, 4.0) * random.standard_normal(50),
                                  bool(random.integers(2)))][seed % 4]()
    shaft = Shaft(size(0.0, 10.0), size(-6.0, 4.0)) if seed % 3 == 0 else None
    springs = [TorsionSpring(GROUND, 'crank', size(), free_angle=1.0, damping=size(-6.0, 3.0)),
               Spring(Attachment(GROUND, 0.3, 0.5), Attachment('coupler', 0.2), size(),
                      free_length=0.1)]
    drive = Drive(source, size(-3.0, 2.0), 0.0, shaft)
    system = System(HEAVY.with_elements(*springs[:seed % 3]), 0.4, 1.0, drive)
    run = simulate(system, 1.0, 1e-6, evaluations=40_000)
    assert run.status in STATUSES and run.evaluations <= 50_000
    assert all(np.isfinite(part).all() for part in run.states) and run.time[-1] <= 1.0


# --- checks that mean something -----------------------------------------------------------------


@pytest.mark.parametrize('method', ['auto', 'DOP853'])
@some('amplitude', [0.0, 1e-6, 1e-4], (1e-6,))
def test_rest_and_small_swings_converge(amplitude, method):
    place = next(e for e in equilibria(Equation(HEAVY)) if e.is_stable)
    run = simulate(System(HEAVY, place.position + amplitude), 1.0, 1e-8, method, times=[0.3, 1.0])
    assert run.status == REACHED and run.drift <= 1e-8
    # a small swing is a cosine but for the square of its amplitude
    swing = amplitude * np.cos(2.0 * pi * place.frequency * run.time)
    assert np.abs(run.position - place.position - swing).max() <= 1e-8 + 3.0 * amplitude**2


def test_drift_is_measured_at_the_steps_not_at_the_times_asked_for():
    system = System(HEAVY, -0.5)
    period = simulate(system, 1.0).system and 1.64314493083574
    strobe = simulate(system, 5.0, method='DOP853', times=period * np.arange(1, 4))
    assert strobe.status == REACHED and strobe.drift <= 1e-8
    rough = simulate(system, 5.0, 1e-3, 'RK45', times=[5.0], check=False)
    assert rough.drift > 1e-6          # not 0 by construction


def test_the_error_of_a_table_is_that_of_other_steps():
    table = TorqueTable(np.linspace(0.0, 2.0, 200), 60.0 + 100.0 * np.sin(np.arange(200) * 0.09))
    system = System(HEAVY, 0.0, drive=Drive(table, 0.5))
    run, exact = simulate(system, 2.0, 1e-4), simulate(system, 2.0, 1e-9)
    assert exact.status == REACHED and exact.error > 1e-14
    assert abs(run.position[-1] - exact.position[-1]) <= run.error <= 1e-4


@some('kind', ['pulse', 'smooth', 'noise'], 1)
def test_long_linear_tables_against_their_double_integral(kind):
    """J q.. = T: q is the sum of cubic pieces; no pulse between two steps is missed."""
    times = np.linspace(0.0, 2.0, 5001)
    torques = {'smooth': 5.0 * np.sin(9.0 * times),
               'noise': np.random.default_rng(1).standard_normal(5001),
               'pulse': np.where(np.arange(5001) == 2507, 1e3, 0.0)}[kind]
    run = simulate(System(wheel(), 0.0, drive=Drive(TorqueTable(times, torques, True))), 2.0, 1e-7)
    step, low, high = np.diff(times), torques[:-1] / 2.0, torques[1:] / 2.0
    speed = np.append(0.0, np.cumsum(0.5 * step * (low + high)))
    angle = np.sum(speed[:-1] * step + step**2 * (2.0 * low + high) / 6.0)
    assert run.status == REACHED and abs(run.position[-1] - angle) <= 1e-7
    assert run.evaluations <= 60 * times.size


def test_a_smooth_table_of_many_points_costs_about_what_its_interpolation_does():
    """
    Bends too small to see need no restart: 1e5 points, and numpy's interpolation of them.

    Between points the torque is off by up to h^2 w^2 3/8 = 7e-9 N m, the position after 2 s by
    3e-8 rad at an inertia of 0.5 kg m^2: no step that passes over points is better.
    """
    times = np.linspace(0.0, 2.0, 100_001)
    torques = 5.0 + 3.0 * np.sin(7.0 * times)

    class Interpolated:
        start, breaks = (), ()

        def torque(self, time, speed, state):
            """Return it."""
            return float(np.interp(time, times, torques)), ()
    run, other = (simulate(System(HEAVY, 0.3, 2.0, drive=Drive(source, 0.5)), 2.0, 1e-7)
                  for source in (TorqueTable(times, torques, True), Interpolated()))
    assert run.status == other.status == REACHED
    assert run.evaluations <= 3 * other.evaluations
    assert abs(run.position[-1] - other.position[-1]) <= 2e-7


@pytest.mark.parametrize('method', ['auto', 'LSODA'])
def test_runs_in_threads_are_those_of_one(method):
    def run(seed):
        drive = Drive(MotorLine(400.0, 26.0), 0.5, shaft=Shaft(1e6 * (1 + seed), 100.0))
        return simulate(System(HEAVY, 0.0, drive=drive), 0.1, 1e-6, method).position
    alone = [run(seed) for seed in range(3)]
    with ThreadPoolExecutor(3) as pool:
        for one, other in zip(alone, pool.map(run, range(3))):
            assert np.array_equal(one, other)
