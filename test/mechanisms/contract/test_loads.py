# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads in balance with the motion of all links."""

from math import isfinite

from fourbar_ros import InvalidParameter
import numpy as np
from support import contract
from support.cartesian import EPS
from support.contract import every_mechanism
from support.power import needed
from support.samples import more


@every_mechanism
def test_magnitudes_are_those_of_their_components(case):
    for mechanism, given in contract.ordinary(case, 205, 20):
        loads = mechanism.loads(*given)
        pairs = [name[:-2] for name in loads._fields if name.endswith('_x')]
        assert len(pairs) >= 3
        for name in pairs:
            size = np.hypot(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
            assert abs(getattr(loads, name) - size) <= 2 * EPS * size, name


@every_mechanism
def test_power_and_momentum_balance(case, count=more(15, 60)):
    """Shaking = -dP/dt, -dH/dt + loads; power of the drive = dE/dt: 1e-13 of the summed sizes."""
    for mechanism, given in contract.ordinary(case, 210, count):
        motion, loads = mechanism.step(*given)
        force, moment, power, (size_force, size_moment, size_power) = needed(mechanism, motion)
        assert (
            abs(complex(loads.shaking_force_x, loads.shaking_force_y) + force)
            <= 1e-13 * size_force
        )
        assert abs(loads.shaking_moment + moment) <= 1e-13 * size_moment
        drives = [getattr(loads, name, 0.0) for name in ('driving_torque', 'driving_force')]
        assert loads.driving_power == sum(drives) * given[1]
        assert abs(loads.driving_power - power) <= 1e-13 * size_power
        assert drives[not mechanism.is_driven_by_slide] == 0.0
        assert drives[mechanism.is_driven_by_slide] != 0.0


@every_mechanism
def test_loads_that_overflow_are_refused(case, count=more(2, 10)):
    """At rising speeds each load is a number, or all are refused: power overflows first."""
    refused = given = 0
    for mechanism, (position, rate, acceleration) in contract.ordinary(case, 216, count):
        for power in np.linspace(333.0, 345.0, 97).tolist():
            try:
                loads = mechanism.step(position, rate * 2.0**power, acceleration)[1]
                given += 1
                assert all(map(isfinite, loads)), (power, loads)
            except InvalidParameter as error:
                refused += 1
                assert 'overflow' in str(error)
    assert refused and given
