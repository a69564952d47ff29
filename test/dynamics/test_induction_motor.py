# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""An induction motor by Kloss' formula: law, steady slip, run-up, steps of the node."""
from math import tau

from fourbar_ros import InvalidParameter
from fourbar_ros.dynamics.node_step import Mover, OK
from fourbar_ros.dynamics.run import REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import Drive, InductionMotor, Shaft
from fourbar_ros.dynamics.system import System
from fourbar_ros.scene.scene import from_values
import mpmath as mp
import numpy as np
import pytest
from support.dynamics_problems import steps, wheel
from support.samples import some
from support.scenes import PAPER, RODS

scipy = pytest.importorskip('scipy')
MOTOR = InductionMotor(60.0, 0.2, 50.0, 2, 5.0)
INERTIA = 3.0


def kloss(motor, speed):
    """Return the torque by the formula as books give it, at 40 digits."""
    with mp.workdps(40):
        gear, synchronous = mp.mpf(motor.gear), 2 * mp.pi * motor.frequency / motor.pole_pairs
        slip = (synchronous - gear * mp.mpf(speed)) / synchronous
        return float(gear * 2 * motor.breakdown_torque
                     / (slip / motor.breakdown_slip + motor.breakdown_slip / slip))


@pytest.mark.parametrize('gear', [1.0, 5.0, -30.0])
def test_the_law_is_that_of_the_book(gear):
    motor = InductionMotor(60.0, 0.2, 60.0, 3, gear)
    law, w_s = motor.piece, motor.synchronous_speed
    assert w_s == pytest.approx(tau * 60.0 / 3.0 / gear, rel=1e-15)
    for share in (-2.0, -0.3, 0.0, 0.7, 0.8, 0.93, 1.05, 1.2, 3.0):      # of the synchronous speed
        speed, step = share * w_s, 1e-4 * w_s
        torque, _ = motor.torque(0.0, speed, ())
        # the tangent's own part and slope cancel: so many eps times the sum of both
        piece = law(speed, 0.0)
        size = abs(piece.torque) + abs(piece.by_speed * speed)
        assert abs(torque - kloss(motor, speed)) <= 16.0 * 2.0**-52 * (size + 60.0 * abs(gear))
        slope = (kloss(motor, speed + step) - kloss(motor, speed - step)) / (2.0 * step)
        assert piece.by_speed == pytest.approx(slope, rel=1e-5, abs=1e-5 * 600.0 / abs(w_s))
    # breakdown, and no torque at the synchronous speed
    assert motor.torque(0.0, 0.8 * w_s, ())[0] == pytest.approx(60.0 * gear, rel=1e-14)
    assert abs(motor.torque(0.0, w_s, ())[0]) <= 1e-12 * 60.0 * abs(gear)


def test_it_runs_up_as_the_integral_over_the_slip_says():
    """J W ds/dt = -2 T_b / (s/s_b + s_b/s): (s^2 - 1)/(2 s_b) + s_b ln s = -2 T_b t / (J W)."""
    w_s, top = MOTOR.synchronous_speed, 60.0 * MOTOR.gear
    run = simulate(System(wheel(INERTIA), 0.0, drive=Drive(MOTOR)), 1.0, 1e-9,
                   times=np.linspace(0.05, 1.0, 20))
    assert run.status == REACHED
    for time, rate in zip(run.time, run.rate):
        slip = 1.0 - rate / w_s
        spent = (1.0 - slip * slip) / (2.0 * 0.2) - 0.2 * np.log(slip)
        assert spent == pytest.approx(2.0 * top * time / (INERTIA * w_s), rel=1e-6)


@some('shaft', [Shaft(1e8, 10.0), None, Shaft(2e3, 5.0)], 1, ids=str)
def test_steps_of_the_node_are_of_order_four_and_as_simulate(shaft):
    values = {**PAPER, **RODS, 'gravity.y': -9.81, 'drive.source': 'motor', 'outputs': ['state']}
    linkage = from_values({**values, 'motor.stall_torque': 1.0, 'motor.free_speed': 1.0}).linkage
    system = System(linkage, 0.3, drive=Drive(MOTOR, 0.5, 2.0, shaft))
    run, errors = simulate(system, 0.4, 1e-9, times=[0.4]), []
    for tick in (4e-3, 2e-3, 1e-3):
        mover = Mover(system, 1e9 if shaft is None else 1e-8, 10_000)
        went = steps(mover, round(0.4 / tick), tick)
        assert {done.status for done in went} == {OK}
        errors.append(abs(went[-1].state.vector.position - run.position[-1]))
    assert errors[-1] < 1e-6, errors
    if shaft is None:
        assert np.log2(errors[0] / errors[2]) > 2 * 3.5, errors


def test_a_scene_gives_it_and_refuses_by_its_own_names():
    given = {**PAPER, **RODS, 'drive.source': 'motor', 'motor.kind': 'induction',
             'motor.breakdown_torque': 60, 'motor.breakdown_slip': 0.2, 'motor.gear': 5.0,
             'motor.rotor_inertia': 0.01}
    drive = from_values(given).dynamics.drive
    assert drive == Drive(MOTOR, 25.0 * 0.01)
    for name, value in (('breakdown_torque', 0.0), ('breakdown_slip', -0.1), ('frequency', 0.0),
                        ('pole_pairs', 0), ('pole_pairs', 1.5), ('gear', 0.0)):
        with pytest.raises(InvalidParameter) as caught:
            from_values({**given, f'motor.{name}': value})
        assert caught.value.name == f'motor.{name}'
        with pytest.raises(InvalidParameter) as caught:
            InductionMotor(**{'breakdown_torque': 60.0, 'breakdown_slip': 0.2, name: value})
        assert caught.value.name == name
    with pytest.raises(InvalidParameter, match='motor.breakdown_slip') as caught:
        from_values({**given, 'motor.breakdown_slip': float('nan')})
    assert 'must be given' in caught.value.allowed
