# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drives and integration: against closed solutions, conservation, order, limits, bad input."""
from dataclasses import replace
from math import exp, inf, pi

from fourbar_ros import Applied, Bodies, Body, External, FourBar, InvalidParameter, SliderCrank
from fourbar_ros.dynamics.node_step import Mover
from fourbar_ros.dynamics.run import LIMIT, REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import (
    ConstantTorque,
    DCMotor,
    Drive,
    Law,
    MotorLine,
    Piece,
    Shaft,
    SpeedController,
    TorqueTable,
)
from fourbar_ros.dynamics.statics import free_period
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.elements import GROUND, TorsionSpring
import numpy as np
import pytest
from support.dynamics_problems import wheel
from support.samples import some

scipy = pytest.importorskip('scipy')
NOTHING = Body(0.0)


def test_constant_torque_and_flywheel():
    run = simulate(System(wheel(), 0.3, 1.0, drive=Drive(ConstantTorque(6.0), rotor=0.5,
                                                         flywheel=0.5)), 2.0)
    assert run.status == REACHED
    assert run.position[-1] == pytest.approx(0.3 + 2.0 + 0.5 * 2.0 * 4.0, abs=1e-8)
    assert run.torque[-1] == 6.0 and run.acceleration[-1] == pytest.approx(2.0, rel=1e-14)


class Pulse(ConstantTorque):
    """A torque that a user lets end at 1 s."""

    breaks = (1.0,)

    def torque(self, time, speed, state):
        """Return it."""
        return (self.value if time < 1.0 else 0.0), ()


def test_a_source_that_overrides_the_torque_of_another_drives_by_its_own():
    run = simulate(System(wheel(), 0.0, 1.0, drive=Drive(Pulse(4.0))), 2.0, 1e-8)
    assert run.status == REACHED
    assert run.position[-1] == pytest.approx(2.0 + 0.5 * 2.0 + 2.0, abs=1e-8)
    with pytest.raises(InvalidParameter, match='cannot drive steps'):
        Mover(System(wheel(), 0.0, drive=Drive(Pulse(4.0))), 1e-6, 60)


class Cut(Law):
    """A torque of a user's, of floats alone, that is cut above a speed."""

    def piece(self, speed, state, n=None, command=None):
        """Return it."""
        return Piece(4.0 if abs(speed) < 100.0 else 0.0)


def test_a_law_of_floats_alone_drives_a_run():
    run = simulate(System(wheel(), 0.0, 1.0, drive=Drive(Cut())), 2.0, 1e-8)
    assert run.status == REACHED and run.position[-1] == pytest.approx(6.0, abs=1e-8)


def test_a_motor_line_nears_its_free_speed_exponentially():
    run = simulate(System(wheel(), 0.0, drive=Drive(MotorLine(40.0, 20.0))), 1.5, times=[0.5, 1.5])
    assert run.time.tolist() == [0.5, 1.5]
    for time, rate in zip(run.time, run.rate):      # J w. = 40 - 2 w
        assert rate == pytest.approx(20.0 * (1.0 - exp(-time)), rel=1e-8)


@pytest.mark.parametrize('gear', [4.0, -4.0, 0.25])
def test_a_gear_passes_the_power_of_a_motor_line(gear):
    motor, behind = MotorLine(8.0, 30.0), MotorLine(8.0, 30.0, gear=gear)
    for speed in (-3.0, 0.0, 2.0, 9.0):                  # behind the gear
        of_motor, _ = motor.torque(0.0, gear * speed, ())
        torque, _ = behind.torque(0.0, speed, ())
        assert torque * speed == pytest.approx(of_motor * gear * speed, rel=1e-14, abs=1e-13)
        assert torque == pytest.approx(gear * of_motor, rel=1e-14, abs=1e-13)


def test_a_dc_motor_with_inductance_and_gear():
    """A linear system of the speed and the current: against its matrix exponential."""
    from scipy.linalg import expm
    motor = DCMotor(voltage=24.0, resistance=0.5, constant=0.1, inductance=0.05, gear=10.0)
    run = simulate(System(wheel(), 0.0, drive=Drive(motor)), 1.0, 1e-10)
    matrix = np.array([[0.0, 0.5, 0.0], [-20.0, -10.0, 480.0], [0.0, 0.0, 0.0]])      # w, i, 1
    rate, current, _ = expm(matrix) @ [0.0, 0.0, 1.0]
    assert run.system.names == ('position', 'rate', 'source_0', 'work')
    assert run.rate[-1] == pytest.approx(rate, rel=1e-9)
    assert run.states.source[0][-1] == pytest.approx(current, rel=1e-9)
    without = DCMotor(24.0, 0.5, 0.1, gear=10.0)      # a motor line: 48 N m to 24 rad/s
    assert without.torque(0.0, 12.0, ()) == (pytest.approx(24.0), ())


def test_a_table_is_held_or_linear_and_its_jumps_are_steps_of_their_own():
    table = TorqueTable([0.0, 1.0, 1.5], [2.0, -4.0, 0.0])
    run = simulate(System(wheel(1.0), 0.0, drive=Drive(table)), 2.0, times=[0.5, 1.0, 2.0])
    assert run.rate == pytest.approx([1.0, 2.0, 0.0], abs=1e-12)
    assert run.position == pytest.approx([0.25, 1.0, 1.0 + 1.0 - 0.5], abs=1e-12)
    linear = TorqueTable([0.0, 1.0], [0.0, 3.0], linear=True)
    assert [linear.torque(t, 0.0, ())[0] for t in (-1.0, 0.5, 2.0)] == [0.0, 1.5, 3.0]


def test_a_stiff_shaft_is_integrated_implicitly_and_a_soft_one_is_not():
    """Judged by its steps: the run says from when on."""
    def run(stiffness):
        drive = Drive(MotorLine(40.0, 20.0), rotor=0.5, shaft=Shaft(stiffness, 1e-3 * stiffness))
        return simulate(System(wheel(), 0.0, drive=drive), 1.0, 1e-6)
    soft, stiff = run(1e2), run(1e9)
    assert soft.method == 'DOP853' and stiff.method == 'LSODA'
    assert soft.status == stiff.status == REACHED


@some('method', ['DOP853', 'RK45', 'LSODA', 'Radau', 'BDF'], 2)
def test_every_method_gives_the_same(method):
    bodies = Bodies(Body(1.0, cg_along=0.2, inertia=0.1),
                    Body(2.0, cg_along=0.6, cg_across=0.1, inertia=0.2),
                    Body(1.5, cg_along=0.4, inertia=0.1))
    spring = TorsionSpring('coupler', 'output', 4.0, free_angle=0.3)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, gravity=(0.0, -9.81),
                      elements=(spring,))
    system = System(linkage, 0.2, 9.0)
    run = simulate(system, 1.0, 1e-6, method)
    assert run.status == REACHED and run.drift <= 1e-6
    exact = simulate(system, 1.0, 1e-11, times=[1.0])
    assert abs(run.position[-1] - exact.position[0]) <= 1e-6


def test_couples_do_work_over_turns():
    """J w^2 / 2 = couple times angle, also past half a turn of the link."""
    linkage = FourBar(1.0, 2.0, 1.0, 2.0, bodies=Bodies(*[Body(0.0, inertia=0.5)] * 3),
                      external=External(output=Applied(couple=3.0)))
    # a parallelogram: output turns as the crank
    run = simulate(System(linkage, 0.5), 3.0, 1e-9)
    assert run.status == REACHED and run.position[-1] > 2.0 * pi
    assert run.position[-1] == pytest.approx(0.5 + 0.5 * 3.0 * 9.0, abs=1e-8)


def test_a_driven_slide_stops_at_the_end_of_its_stroke():
    """At the end of the stroke at the time at which the free run is there."""
    bodies = Bodies(Body(1.0, cg_along=0.2, inertia=0.1), NOTHING, Body(3.0))
    options = {'input': 'slide', 'bodies': bodies}
    push = Drive(ConstantTorque(5.0))
    run = simulate(System(SliderCrank(0.5, 1.0, stroke=(0.8, 1.2), **options), 1.0, drive=push),
                   5.0)
    assert run.status == LIMIT and run.position[-1] == pytest.approx(1.2, abs=1e-8)
    free = simulate(System(SliderCrank(0.5, 1.0, **options), 1.0, drive=push), float(run.time[-1]))
    assert free.status == REACHED and free.position[-1] == pytest.approx(1.2, abs=1e-7)


@pytest.mark.parametrize('stroke, start, end', [
    ((0.0, 0.85), 0.4, 0.85), ((0.0, 0.85), 0.4 - 4.0 * pi, 0.85 - 4.0 * pi),
    ((-1.0, 9.0), 0.4, 9.0), ((-1.0, 9.0), 0.4 + 2.0 * pi, 9.0)])
def test_a_crank_that_turns_fully_stops_at_the_end_of_its_range(stroke, start, end):
    """At the time at which the free run is there, in the turn of its start."""
    bodies = Bodies(Body(1.0, cg_along=0.2, inertia=0.1), Body(1.0, inertia=0.1), NOTHING)
    free, push = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies), Drive(ConstantTorque(5.0))
    run = simulate(System(replace(free, stroke=stroke), start, drive=push), 9.0)
    assert run.status == LIMIT and run.position[-1] == pytest.approx(end, abs=1e-7)
    there = simulate(System(free, start, drive=push), float(run.time[-1]))
    assert there.position[-1] == pytest.approx(end, abs=1e-6)
    with pytest.raises(InvalidParameter, match='must not reach a limit'):
        free_period(System(replace(free, stroke=stroke), stroke[0] + 0.1, 9.0))


def test_ground_springs_make_a_crank_swing_and_dampers_stop_it():
    spring = TorsionSpring(GROUND, 'crank', 8.0, damping=2.0)
    run = simulate(System(wheel(elements=(spring,)), 0.5), 20.0, 1e-9)
    assert run.status == REACHED
    root = (4.0 - 0.25)**0.5      # 2 q.. + 2 q. + 8 q = 0
    assert run.position[-1] == pytest.approx(
        0.5 * exp(-10.0) * (np.cos(20.0 * root) + 0.5 / root * np.sin(20.0 * root)), abs=1e-9)


@pytest.mark.parametrize('make, name', [
    (lambda: MotorLine(1.0, 0.0), 'free_speed'),
    (lambda: DCMotor(24.0, 0.0, 0.1), 'resistance'),
    (lambda: DCMotor(24.0, 1.0, 0.1, gear=0.0), 'gear'),
    (lambda: SpeedController(10.0, -1.0), 'proportional'),
    (lambda: SpeedController(10.0, 1.0, limit=0.0), 'limit'),
    (lambda: ConstantTorque(inf), 'value'),
    (lambda: TorqueTable([0.0, 0.0], [1.0, 2.0]), 'times'),
    (lambda: TorqueTable([0.0], [1.0, 2.0]), 'torques'),
    (lambda: Shaft(0.0), 'stiffness'),
    (lambda: Drive(ConstantTorque(), shaft=Shaft(1.0)), 'rotor'),
    (lambda: Drive(ConstantTorque(), flywheel=-1.0), 'flywheel'),
    (lambda: System(wheel(), float('nan')), 'position'),
    (lambda: simulate(System(wheel(), 0.0), 0.0), 'until'),
    (lambda: simulate(System(wheel(), 0.0), 1.0, 0.0), 'tolerance'),
    (lambda: simulate(System(wheel(), 0.0), 1.0, method='Euler'), 'method'),
    (lambda: MotorLine(400.0, -26.0), 'free_speed'),
    (lambda: MotorLine(-400.0, 26.0), 'free_speed'),
    (lambda: Drive(5), 'source'), (lambda: Drive(ConstantTorque(), 1.0, shaft=3.0), 'shaft'),
    (lambda: System(wheel(), 0.0, drive=ConstantTorque(5.0)), 'drive'),
    (lambda: simulate(System(wheel(), 0.0, 1e160), 1.0), 'rate'),
    (lambda: simulate(System(wheel(0.0), 0.0), 1.0), 'bodies'),
    (lambda: simulate(wheel(), 1.0), 'system'),
    (lambda: simulate(System(wheel(), 0.0), 1.0, evaluations=0), 'evaluations'),
    (lambda: simulate(System(wheel(), 0.0), 1.0, seconds=-1.0), 'seconds'),
    (lambda: TorqueTable([0.0, 1.0], [1.0, inf]), 'torques'),
    (lambda: TorqueTable(5.0, [1.0]), 'torques'),
])
def test_what_is_wrong_is_refused_by_name(make, name):
    with pytest.raises(InvalidParameter) as caught:
        make()
    assert caught.value.name == name
