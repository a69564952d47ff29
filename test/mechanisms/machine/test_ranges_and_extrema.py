# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Where machines can be assembled, and all extrema there: against dense scans of their motion."""
from math import isinf, pi

from fourbar_ros import Base, find_extrema, FourBarError, InvalidParameter
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.quantities import positions
import numpy as np
import pytest
from support.random_machines import random_machines

EPS = 2.0**-52


@pytest.mark.parametrize('rod, share', [(5456.6, 0.0), (5456.7, 0.21), (5456.71, 0.25)])
def test_ranges_where_one_rod_is_a_million_times_as_long(rod, share):
    """Against the distance of the pins; its roots may lie where the bar before does not close."""
    bar = Dyad('a', 'RPR', Point('ground', 0.0022, -0.005), Point('crank', 0.003, -0.005),
               ('block', 'bar'), offset=0.01)
    (low, high), = Machine([bar]).closing_ranges
    x = np.linspace(low, high, 1003)[1:-1]
    block, turned = Machine([bar]).motion(x), np.exp(1j * x)
    apart = (block.x_block + 1j * block.y_block - (-0.03 + 0.01j) * turned
             + (-5374.8 + 942.0j) * (block.cos_block + 1j * block.sin_block))
    closes = abs(np.abs(apart) - rod) < 0.004
    assert closes.mean() == pytest.approx(share, abs=0.01)
    dyads = [bar, Dyad('b', 'RRR', Point('crank', -0.03, 0.01), Point('block', -5374.8, 942.0),
                       ('rod', 'arm'), length_1=rod, length_2=0.004, mode=1)]
    if not share:
        with pytest.raises(InvalidParameter, match=r'dyads\.b: cannot close at any input'):
            Machine(dyads)
        return
    (low, high), = Machine(dyads).closing_ranges
    assert (closes == (x > low) & (x < high)).all()


def test_a_range_narrower_than_any_grid():
    """Rods that just reach, over some 2e-6 rad: found from the derivative, not from a sample."""
    reach = 0.6 + 1e-13
    machine = Machine([Dyad('d', 'RRR', Point('crank', 0.4), Point('ground', 1.0), ('a', 'b'),
                            length_1=0.5 * reach, length_2=0.5 * reach)])
    (low, high), = machine.input_ranges
    half = np.arccos((0.4**2 + 1.0 - reach**2) / 0.8)
    assert 1e-7 < half < 1e-5
    assert abs(high - half) < 1e-2 * half
    assert abs(low + half) < 1e-2 * half


def test_a_magnitude_that_turns_close_to_a_limit_has_the_same_value_from_both_sides():
    """By samples farther off than its least value, 0.02 rad from the limit, it was negative."""
    machine = [machine for machine, _ in random_machines(611, 29, dyads=(1, 5))][28]
    below, above = [e for e in find_extrema(machine, ('d3_second',), 1.3, -0.7)
                    if e.place == 'limit' and abs(e.theta1 - 2.2645) < 1e-3]
    assert below.value == pytest.approx(above.value, rel=1e-9)


def test_where_slides_become_parallel_is_no_complex_toggle():
    """On some grids it was both, 1e-93 apart: a margin of that size, paths too narrow."""
    for turned in (1.0205267416665662, 1.02, 1.5):
        machine = Machine([Dyad('d', 'PRP', Point('ground', -0.0027, -0.251),
                                Point('crank', 0.747, -0.324), ('a', 'b'),
                                direction_1=-0.13033057419438454, direction_2=turned)])
        poles = {end.x for bound in machine.limits for end in bound}
        assert {z.real for z in machine.singular_inputs} == poles
        assert machine.change_point_margin == 1.0


def test_rates_are_unbounded_at_the_toggle_of_a_dyad_and_positions_are_not():
    machine = Machine([Dyad('d', 'RRR', Point('crank', 0.4), Point('ground', 1.0), ('a', 'b'),
                            length_1=0.5, length_2=0.4)])
    ends = [e for e in find_extrema(machine, ('omega_b', 'theta_b', 'transmission_angle_d'))
            if e.place == 'limit']
    assert len(ends) == 6
    for end in ends:
        assert isinf(end.value) is (end.quantity == 'omega_b')
        if end.quantity == 'transmission_angle_d':
            assert min(abs(end.value), abs(end.value - pi)) < 1e-6
    assert set(positions(machine)) == {'theta_a', 'theta_b', 'transmission_angle_d',
                                       'transmission_angle'}


@pytest.mark.parametrize('carried', [False, True], ids=['fixed', 'on_bases'])
def test_arrays_have_no_pose_of_some_dyads_where_not_all_of_them_close(carried):
    """Dyads before the one that cannot close had a pose, and points on them a path, in arrays."""
    positions_ = np.linspace(-4.0, 4.0, 33)
    left_out = 0
    for machine, _ in random_machines(43, 12, dyads=(2, 5)):
        of_input = set(machine.input_coordinate)
        has_pose = []
        for position in positions_.tolist():
            try:
                machine.motion(position, 1.0)
                has_pose.append(True)
            except FourBarError:
                has_pose.append(False)
        motion, loads = machine.step(positions_, 1.0)
        if carried:
            loads = machine.loads(positions_, 1.0, base=Base(force_y=9.81))
        for fields in (motion, loads):
            for name, values in zip(type(fields)._fields, fields):
                if name not in of_input and len(set(values[has_pose])) > 1:     # no constant
                    assert (np.isfinite(values) == has_pose).all(), name
        assert (machine.motion(positions_, fields=machine.input_coordinate[:1])[0]
                == positions_).all()
        left_out += has_pose.count(False)
    assert left_out > 100
