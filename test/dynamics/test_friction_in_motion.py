# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Motion that follows from torque with friction: beside Cartesian coordinates and closed forms."""
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from math import ceil, cos, pi, sqrt

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    DriveFriction,
    External,
    FourBar,
    InvalidParameter,
    JointFriction,
    SliderCrank,
)
from fourbar_ros.dynamics import (
    Attachment,
    ConstantTorque,
    DCMotor,
    Drive,
    Equation,
    equilibria,
    flywheel_for,
    PositionForce,
    Shaft,
    simulate,
    System,
    TorsionSpring,
)
from fourbar_ros.dynamics.node_step import Mover, OK
from fourbar_ros.errors import Locked
from mechanisms.test_friction import PRESS, random_friction, RUBBING, RUBS
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support.contract import every_mechanism, ordinary
from support.random_machines import random_machines
from support.rubbing import loads_with, Locks
from support.samples import more

# its links move in parallel: J is constant
PARALLEL = FourBar(0.2, 0.5, 0.2, 0.5, gravity=(0.0, 0.0), bodies=Bodies(
    Body(1.0, inertia=0.01), Body(2.0, cg_along=0.25, inertia=0.05), Body(1.0, inertia=0.02)))
INERTIA = 0.01 + 0.02 + 2.0 * 0.2**2


def off(mechanism, given, friction):
    """Return how far the torque is from that which our acceleration needs, over all loads."""
    position, rate, acceleration = map(float, given)
    rate = rate if abs(rate) > 1e-2 else 1.0
    torque = getattr(mechanism.loads(position, rate, acceleration), mechanism.drive_load)
    system = System(mechanism.with_friction(friction), position, rate,
                    Drive(ConstantTorque(float(torque))))
    acceleration = system.derivative(0.0, system.start)[1]
    truth = loads_with(mechanism, (position, rate, acceleration), friction)
    return abs(truth[mechanism.drive_load] - torque) / max(map(abs, truth.values()))


def has_an_acceleration(mechanism, given, friction):
    """Return whether any acceleration of a wide range is that of the reference for the torque."""
    position, rate, acceleration = map(float, given)
    rate = rate if abs(rate) > 1e-2 else 1.0
    torque = getattr(mechanism.loads(position, rate, acceleration), mechanism.drive_load)
    lacks = []
    for change in np.sinh(np.linspace(-9.0, 9.0, 61)):
        with suppress(Locks):
            lacks.append(loads_with(mechanism, (position, rate, acceleration + change), friction)[
                mechanism.drive_load].real - torque)
    return any(low < 0.0 <= high for low, high in pairwise(lacks))


@pytest.mark.parametrize('count', [10, pytest.param(300, marks=pytest.mark.slow)])
def test_random_machines(count):
    """
    The acceleration is that of which Cartesian coordinates need the torque given.

    Where the joints lock, the reference has none either: of all accelerations it needs another.
    """
    rng, locked = np.random.default_rng(41), 0
    for strongest in (0.15, 0.4):
        for mechanism, given in random_machines(42, count, dyads=(1, 4), least_sine=0.05):
            friction = random_friction(rng, mechanism, strongest)
            try:
                assert off(mechanism, given, friction) <= 1e-12
            except Locked:
                locked += 1
                assert not has_an_acceleration(mechanism, given, friction)
    assert locked <= 1 + 0.05 * count


@every_mechanism
def test_every_kind(case, count=more(1, 10)):
    rng = np.random.default_rng(43)
    for mechanism, given in ordinary(case, 44, count):
        if np.isfinite(mechanism.inertia(given[0])):
            assert off(mechanism, given, random_friction(rng, mechanism, 0.3)) <= 1e-12


def test_beside_an_integration_in_cartesian_coordinates():
    """Acceleration by a root of the reference's torque, time by another method of scipy."""
    torque, until = 5.0, 0.012

    def change(_, state):
        def lack(acceleration):
            return loads_with(PRESS, (*state.tolist(), acceleration), RUBS)[
                'driving_torque'].real - torque
        low, high = -5e4, 5e4
        return state[1], brentq(lack, low, high, xtol=1e-9)
    truth = solve_ivp(change, (0.0, until), (0.3, 10.0), 'RK45', rtol=1e-6, atol=1e-8)
    run = simulate(System(RUBBING, 0.3, 10.0, Drive(ConstantTorque(torque))), until, 1e-9)
    assert run.at(until)[:2] == pytest.approx(truth.y[:, -1], rel=1e-6)


def test_dry_friction_of_the_drive_decelerates_evenly():
    """The rate falls in a straight line and stays at rest: w = w0 - F t / J."""
    torque, start = 0.3, 4.0
    friction = {'drive': DriveFriction(torque)}
    run = simulate(System(PARALLEL.with_friction(friction), 0.5, start), 3.0, 1e-9)
    stop = start * INERTIA / torque
    assert stop < 3.0
    for time in (0.3, 0.9 * stop):
        assert run.at(time).rate == pytest.approx(start - torque * time / INERTIA, abs=1e-8)
    stuck, = run.stuck()
    # within the slip speed it slows down at up to the same rate
    assert abs(stuck.begin - stop) <= 2.0 * run.system.mechanism.slip_speed * INERTIA / torque
    assert abs(run.position[-1] - 0.5 - 0.5 * start * stop) <= 1e-7
    assert run.states.dissipated[-1] == pytest.approx(0.5 * INERTIA * start**2, rel=1e-8)


@pytest.mark.parametrize('slip_speed', [1e-2, 1e-3, 1e-4])
def test_a_spring_swings_out_in_a_straight_line(slip_speed):
    """
    Coulomb's amplitudes fall by 2 F / k in each half swing, until the spring is too weak.

    What is left of them to the slip speed v is an error of the order of v over the frequency.
    """
    stiffness, torque, amplitude = 20.0, 0.6, 0.35
    swinging = PARALLEL.with_friction({'drive': DriveFriction(torque)}).with_elements(
        TorsionSpring('ground', 'crank', stiffness, free_angle=1.5))
    run = simulate(System(swinging, 1.5 + amplitude, 0.0, slip_speed=slip_speed), 3.0, 1e-8)
    frequency = sqrt(stiffness / INERTIA)
    allowed = 5.0 * slip_speed / frequency + 1e-6
    swings = ceil((amplitude - torque / stiffness) / (2.0 * torque / stiffness))
    for k in range(swings + 1):
        angle = 1.5 + (-1)**k * (amplitude - 2.0 * k * torque / stiffness)
        assert abs(run.at(k * pi / frequency).position - angle) <= allowed * (k + 1)
    # between two turns a cosine about where spring and friction balance
    middle = 1.5 + torque / stiffness
    half = amplitude - torque / stiffness
    assert abs(run.at(1.0 / frequency).position - middle - half * cos(1.0)) <= allowed
    assert run.stuck()[-1].end == 3.0
    assert abs(run.stuck()[-1].crept) <= slip_speed * 3.0


def energy(run):
    """Return kinetic plus potential energy plus what friction took at all times."""
    state, equation = run.states, run.system.equation
    return equation.energy(state.position, state.rate) + state.dissipated


@pytest.mark.parametrize('mechanism', [RUBBING, replace(
    RUBBING, external=External(output=Applied(couple=0.0)))], ids=['pressed', 'free'])
def test_power_balance(mechanism):
    """A free motion keeps the sum of its energy and of what friction takes, and that grows."""
    tolerance = 1e-8
    run = simulate(System(mechanism.with_friction(RUBS), 0.3, 8.0), 0.5, tolerance)
    total, taken = energy(run), run.states.dissipated
    assert run.drift <= tolerance
    assert np.ptp(total) <= 2.0 * tolerance * (np.ptp(taken) + 0.5 * run.system.equation.terms(
        0.3).inertia * 8.0**2 + np.ptp(total - taken))
    assert all(after >= before for before, after in pairwise(taken.tolist()))


def test_loads_are_those_of_the_motion_within_the_slip_speed_too():
    """The torque that loads need, and the flywheel's, is that of the drive."""
    run = simulate(System(RUBBING, 0.3, 0.0, Drive(ConstantTorque(3.0), flywheel=0.05)), 0.2)
    on_input = run.loads.driving_torque + 0.05 * run.acceleration
    assert on_input == pytest.approx(3.0, abs=1e-9)
    assert run.rate[0] == 0.0 and abs(run.rate[1]) < run.system.mechanism.slip_speed


def test_it_holds_between_the_bounds_at_rest():
    """Just within the torques that hold it creeps, just beyond them it starts."""
    lower, upper = RUBBING.holding(1.0)
    for torque, moves in ((lower - 0.01, -1), (lower + 0.01, 0), (upper - 0.01, 0),
                          (upper + 0.01, 1)):
        run = simulate(System(RUBBING, 1.0, 0.0, Drive(ConstantTorque(torque))), 0.1, 1e-6)
        way = run.position[-1] - 1.0
        assert (abs(way) <= 0.1 * run.system.mechanism.slip_speed if not moves
                else way * moves > 1e-5)
        assert bool(run.stuck(0.09)) != bool(moves)
    pieces = equilibria(Equation(RUBBING.with_slip_speed(1e-4)), 0.5 * (lower + upper))
    assert any(piece.is_stable and piece.position < 1.0 < piece.end for piece in pieces)


def test_a_force_one_way():
    """While the input goes forward it is the force that acts always, backward it is none."""
    force = PositionForce(Attachment('output', 0.02), lambda s: 40.0 + 10.0 * np.sin(s))
    for way, start in (('forward', 12.0), ('backward', -12.0)):
        runs = [simulate(System(PRESS.with_elements(*forces), 0.3, start, Drive(
            ConstantTorque(0.0), flywheel=0.2)), 0.1) for forces in (
                [replace(force, when=way)], [force], [replace(force, when='forward' if start < 0.0
                                                              else 'backward')], [])]
        rates = [run.rate[-1] for run in runs]
        assert all(run.status == 'reached the end' for run in runs)
        assert rates[0] == pytest.approx(rates[1], abs=1e-6) and abs(rates[0] - rates[2]) > 0.1
        assert rates[2] == pytest.approx(rates[3], abs=1e-6)


@pytest.mark.parametrize('drive', [
    Drive(ConstantTorque(2.0), flywheel=0.05),
    Drive(DCMotor(24.0, 0.5, 0.3, 0.005, gear=4.0), rotor=0.05, shaft=Shaft(400.0, 2.0))],
    ids=['torque', 'motor and shaft'])
def test_steps_of_the_node(drive):
    """They follow the run, into a stop too, within their tolerance for each step."""
    system = System(RUBBING, 0.3, 6.0, drive)
    mover, count, tolerance = Mover(system, 1e-7, 5000), 300, 1e-7
    values = mover.start()
    for _ in range(count):
        status, values = mover.next(values, 1e-3)
        assert status == OK
    end = simulate(system, 0.3, 1e-8).at(0.3)
    assert values.position == pytest.approx(end.position, abs=20.0 * count * tolerance)
    assert values.velocity == pytest.approx(end.rate, abs=1e3 * count * tolerance)


@pytest.mark.parametrize('voltage', [21.0, 23.0 + 2.0 / 3.0, 25.0, 27.0])
@pytest.mark.parametrize('tolerance', [1e-7, 1e-8])
def test_a_run_goes_on_where_a_joint_changes_its_face(voltage, tolerance):
    """Nine of fifty ended 'at a limit' there, where a leg began a rounding before the change."""
    motor = Drive(DCMotor(voltage, 0.5, 0.3, 0.005, gear=4.0), rotor=0.05,
                  shaft=Shaft(400.0, 2.0))
    run, other = (simulate(System(RUBBING, 0.3, 6.0, motor), 0.3, tolerance, method)
                  for method in ('auto', 'LSODA'))
    assert run.status == other.status == 'reached the end'
    assert run.position[-1] == pytest.approx(other.position[-1], abs=2.0 * tolerance)


@pytest.mark.parametrize('length', [1e-2, 1e-3])
@pytest.mark.parametrize('excess', [0.05, 1.0, 30.0, 1000.0])
def test_a_step_of_the_node_breaks_away_from_rest(excess, length):
    """Its first step goes with the acceleration that dry friction leaves."""
    friction, tolerance = 0.3, 1e-6
    system = System(PARALLEL.with_friction({'drive': DriveFriction(torque=friction)}), 0.3, 0.0,
                    Drive(ConstantTorque((1.0 + excess) * friction)))
    mover = Mover(system, tolerance, 60)
    status, values = mover.next(mover.start(), length)
    rate = excess * friction / INERTIA * length
    # within the slip speed friction is less, so the rate may be that much larger
    slip = system.mechanism.slip_speed * min(1.0 / excess, rate / system.mechanism.slip_speed)
    assert status == OK
    assert values.velocity == pytest.approx(rate, abs=slip + tolerance / length)
    assert values.position == pytest.approx(0.3 + 0.5 * rate * length,
                                            abs=slip * length + tolerance)


def test_flywheel():
    """A run of a turn with it comes back to its rate, and fluctuates as asked."""
    most, press = 0.05, PRESS.with_external(External()).with_friction(RUBS)
    wheel = flywheel_for(Equation(press), 9.0, most)
    system = System(press, 0.0, float(wheel.rate[0]),
                    Drive(ConstantTorque(wheel.torque), flywheel=wheel.inertia))
    run = simulate(system, 2.0, 1e-7, stop_when=lambda t, y: y[0] - 2.0 * pi)
    assert wheel.inertia > 0.0
    # the convergence of its samples, 1e-6 of the inertia, beside an energy of 1 / most of that
    assert run.rate[-1] == pytest.approx(wheel.rate[0], rel=1e-5)
    rates = run.at(np.linspace(0.0, run.time[-1], 2000)).rate
    assert np.ptp(rates) == pytest.approx(most * 9.0, rel=1e-3)


def test_what_is_refused():
    with pytest.raises(InvalidParameter, match='slip_speed'):
        System(RUBBING, 0.3, slip_speed=0.0)
    # the direction of the input turns back at a toggle: the run ends before it
    rocker = FourBar(1.2, 1.0, 0.4, 1.0, gravity=(0.0, -9.81), bodies=PARALLEL.bodies
                     ).with_friction({'A': JointFriction(0.1, radius=0.01)})
    low, high = rocker.input_ranges[0]
    run = simulate(System(rocker, 0.5 * (low + high), 3.0), 5.0, 1e-6)
    assert run.status == 'reached a limit of the input'
    assert SliderCrank(0.1, 0.3).with_slip_speed(1e-3).friction == ()


@pytest.mark.parametrize('viscous, torque', [(0.01, 0.0), (0.0, 0.15), (0.004, 0.2)])
def test_beside_mujoco(viscous, torque):
    """
    A parallelogram swings as the pendulum that it is for a hinge with the engine's friction.

    Its hinges have viscous damping and a constant torque (``frictionloss``, a soft constraint at
    rest); dry friction that grows with the force of a pin they do not have.
    """
    mujoco = pytest.importorskip('mujoco')
    model = mujoco.MjModel.from_xml_string(f"""
      <mujoco><option timestep="1e-4" gravity="0 -9.81 0" integrator="RK4"/><worldbody><body>
        <joint name="it" type="hinge" axis="0 0 1" damping="{4.0 * viscous}"
               frictionloss="{torque}" solreffriction="2e-4 1"
               solimpfriction="0.9999 0.9999 1e-3"/>
        <inertial pos="0.2 0 0" mass="2" diaginertia="0.03 0.03 0.03"/>
      </body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    data.qpos[0] = -0.6
    # its four pins turn at the rate of the crank, as the coupler does not turn
    swinging = replace(PARALLEL, gravity=(0.0, -9.81)).with_friction({
        **{name: JointFriction(viscous=viscous) for name in ('O1', 'A', 'B', 'O4')},
        'drive': DriveFriction(torque)})
    run = simulate(System(swinging, -0.6, 0.0), 2.0, 1e-8)
    for time in np.arange(1, 21) * 0.1:
        while data.time < time - 1e-9:
            mujoco.mj_step(model, data)
        # where it turns back the engine's friction is smooth too, by its own impedance
        assert run.at(time).position == pytest.approx(data.qpos[0], abs=1e-3 if torque else 1e-7)
