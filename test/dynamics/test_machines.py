# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines of dyads moved by a torque: Andrews' squeezer."""
from fourbar_ros.dynamics.drives import ConstantTorque, Drive
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.simulate import REACHED, simulate
from fourbar_ros.dynamics.system import System
import mpmath as mp
import numpy as np
import pytest
from support.andrews import ANDREWS_ANGLE, ANDREWS_RATE, energies, UNTIL
from support.dyad_reference import random_machines
from support.machines import andrews, ANDREWS_BETA

pytest.importorskip('scipy')


def squeezer():
    machine, spring, torque = andrews()
    return System(machine, ANDREWS_BETA, 0.0, [spring], Drive(ConstantTorque(torque)))


def test_it_starts_as_published():
    """IVP Test Set: beta''(0) = 14222.4439199541, in its printed digits."""
    machine, spring, torque = andrews()
    found = Equation(machine, [spring]).acceleration(ANDREWS_BETA, 0.0, torque)
    assert abs(found - 14222.4439199541) <= 1e-10


@pytest.mark.parametrize('tolerance', [1e-7, 1e-9])
def test_its_angle_after_30_ms(tolerance):
    run = simulate(squeezer(), UNTIL, tolerance)
    assert run.status == REACHED
    assert abs(run.position[-1] - float(ANDREWS_ANGLE)) <= tolerance
    assert abs(run.rate[-1] - float(ANDREWS_RATE)) <= 100.0 * tolerance
    # as published (PSIDE at 1e-14), whose ninth decimal is wrong by one
    assert abs(run.position[-1] - 15.81077119629904) <= 2e-9 + tolerance


def test_its_inertia_is_that_of_the_places_of_its_bodies():
    machine, spring, torque = andrews()
    equation = Equation(machine, [spring])
    with mp.workdps(30):
        for beta in (-2.0, 0.1, 1.7, 3.0):
            inertia, potential = energies(machine, spring, 0.0, beta)
            assert abs(equation.terms(beta).inertia - inertia) <= 1e-14 * inertia
            assert abs(equation.potential(beta) - potential) <= 1e-13 * potential


def test_the_equation_of_motion_gives_the_drive_of_the_loads():
    """J q'' + J' q'^2 / 2 - Q against virtual power with Newton and Euler."""
    for machine, (position, rate, acceleration) in random_machines(701, 10, least_sine=0.05):
        loads = machine.loads(position, rate, acceleration)
        drive = loads.driving_torque + loads.driving_force
        terms = Equation(machine).terms(position)
        parts = terms.inertia * acceleration, terms.half_slope * rate**2, terms.force
        found = Equation(machine).torque(position, rate, acceleration)
        assert abs(found - drive) <= 1e-10 * (np.abs(parts).sum() + abs(drive))
