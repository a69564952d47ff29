# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ranges, a published machine, errors."""
from math import pi
import pickle

from fourbar_ros import Body, MissingBodies, OutOfRange, Toggle
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np
import pytest
from support.machines import andrews, ANDREWS_BETA, ANDREWS_POSE

# --- ranges --------------------------------------------------------------------------------------


def test_a_cylinder_has_no_length_below_zero():
    """Its square is that of a length in the range; the pose would be a plausible one."""
    machine = Machine([], input='cylinder', output='crank', cylinder=Cylinder(
        Point('ground', 1.0), Point('crank', 0.4), ('block', 'bar')))
    with pytest.raises(OutOfRange):
        machine.motion(-1.0)
    found = machine.motion(np.array([-1.0, -0.1, 1.0])).theta_crank
    assert np.isnan(found).tolist() == [True, True, False]


# --- a published machine -------------------------------------------------------------------------

def test_andrews_squeezer_starts_as_published():
    """IVP Test Set, andrews.f: the initial values to their last printed digit."""
    machine, _, _ = andrews()
    motion = machine.motion(ANDREWS_BETA)
    for name, (quarters, printed) in ANDREWS_POSE.items():
        difference = getattr(motion, f'theta_{name}') - sum(printed) - 0.5 * pi * quarters
        assert abs(np.remainder(difference + pi, 2.0 * pi) - pi) <= 2e-15, name


# --- errors --------------------------------------------------------------------------------------

def six_bar():
    return Machine([Dyad('lower', 'RRR', Point('crank', 0.4), Point('ground', 1.0),
                         ('coupler', 'rocker'), length_1=1.2, length_2=0.8),
                    Dyad('upper', 'RRR', Point('rocker', 0.9, 0.2), Point('ground', 2.0),
                         ('rod', 'arm'), length_1=0.9, length_2=0.75)],
                   bodies={'arm': Body(1.0, cg_along=0.3, inertia=0.1),
                           'rod': Body(0.5, cg_along=0.2)})


def test_a_toggle_names_its_dyad():
    machine = six_bar()
    (low, high), = machine.input_ranges
    assert {end.dyad for end in machine.limits[0]} == {'upper'}
    outside = np.nextafter(high, 10.0)
    with pytest.raises(Toggle, match='toggle position of dyad upper') as caught:
        for _ in range(4):
            machine.motion(float(outside))
            outside = np.nextafter(outside, 10.0)
    assert caught.value.dyad == 'upper'
    assert pickle.loads(pickle.dumps(caught.value)).dyad == 'upper'
    with pytest.raises(OutOfRange, match='theta_crank = .* outside the input range'):
        machine.motion(high + 0.1)
    values = machine.motion([0.5 * (low + high), high + 0.1]).theta_arm
    assert np.isfinite(values[0])
    assert np.isnan(values[1])


def test_without_bodies_there_are_no_loads():
    machine = Machine(six_bar().dyads)
    with pytest.raises(MissingBodies):
        machine.loads(1.5)


def test_modes_of_all_dyads_are_one_number():
    machine = six_bar()
    assert machine.mode == 4
    other = machine.in_mode(2)
    assert [dyad.mode for dyad in other.dyads] == [2, 1]
    assert other.mode == 2
    assert machine.in_mode(4) is machine
    assert machine.modes == {4: 'lower 2, upper 2'}
