# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Change points by whole numbers: the kinds and the same linkages as machines of dyads."""
from math import inf, pi
import random

from fourbar_ros import Toggle
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.machine.describe.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np
import pytest

EPS = 2.0**-52
DISTANCES = (1e-3, 1e-6, 1e-9, 1e-12)


# --- of other dyads than pairs -------------------------------------------------------------------

def peaucellier(l_long, l_short, r):
    """Return an inversor whose rhombus lies flat where O P = sqrt(L^2 - l^2), if it gets there."""
    arms = {'first': Point('ground', -r), 'second': Point('crank', r), 'length_1': l_long,
            'length_2': l_short}
    return Machine([Dyad('p', 'RRR', links=('o_1', 'p_1'), **arms),
                    Dyad('q', 'RRR', links=('o_2', 'p_2'), mode=1, **arms),
                    Dyad('e', 'RRR', Point('o_1', l_long), Point('o_2', l_long), ('x_1', 'x_2'),
                         length_1=l_short, length_2=l_short)])


INVERSORS = [(4.0, 1.5, 2.0), (0.4, 0.15, 0.2), (4.1, 1.37, 2.03)]


@pytest.mark.parametrize('lengths', INVERSORS)
def test_a_flat_rhombus_is_a_limit_with_its_dyad(lengths):
    """A circle through O meets O P = sqrt(L^2 - l^2) twice, if its diameter is longer."""
    l_long, l_short, r = lengths
    machine = peaucellier(*lengths)
    with mp.workdps(40):
        flat = mp.sqrt(mp.mpf(l_long)**2 - mp.mpf(l_short)**2)      # 2 r cos(theta/2)
        is_met = flat < 2 * r
        place = float(2 * mp.acos(flat / (2 * r))) if is_met else inf
    assert is_met == bool(machine.flat_limits) == (machine.change_point_margin == 0.0)
    if not is_met:
        return
    limits = [end for bound in machine.limits for end in bound if end.is_flat]
    assert {end.dyad for end in limits} == {'e'}
    assert {abs(end.x) for end in limits} == {min((abs(end.x) for end in limits),
                                                  key=lambda x: abs(x - place))}
    assert abs(limits[0].x) == pytest.approx(place, abs=4 * EPS)
    for x in {end.x for end in limits}:
        with pytest.raises(Toggle, match='dyad e'):
            machine.motion(x, 1.0)
        assert machine.mode_beyond(x) == machine.mode ^ 4 or machine.mode_beyond(x) - 1 == (
            machine.mode - 1) ^ 4


def test_extrema_beside_a_flat_rhombus_are_few_and_right():
    machine = peaucellier(*INVERSORS[1])
    found = find_extrema(machine, ('omega_x_1', 'alpha_x_1'), 1.0)
    at_flat = [e for e in found if e.place == 'one-sided']
    assert len(found) < 40 and len(at_flat) == 8
    # where the rhombus lies flat its rods turn as those of the arms, or stand, to 16 digits
    assert {round(e.value, 9) for e in at_flat if e.quantity == 'omega_x_1'} == {0.0, 1.0}


@pytest.mark.parametrize('bits', range(46, 53))
def test_margins_of_last_bits_decide_whether_a_rhombus_closes_through(bits):
    """Rods longer than those of a flat rhombus never lie flat, shorter ones end the range."""
    l_long, l_short, r = INVERSORS[1]

    def with_rods(change):
        arms = peaucellier(l_long, l_short, r).dyads[:2]
        rods = l_short * (1.0 + change)
        return Machine([*arms, Dyad('e', 'RRR', Point('o_1', l_long), Point('o_2', l_long),
                                    ('x_1', 'x_2'), length_1=rods, length_2=rods)])
    longer, shorter = with_rods(2.0**-bits), with_rods(-2.0**-bits)
    inner = [end for bound in longer.limits for end in bound if end.dyad == 'e']
    assert not inner and len(longer.closing_ranges) == 1
    gaps = [end.x for bound in shorter.limits for end in bound if end.dyad == 'e']
    assert len(shorter.closing_ranges) == 3 and len(set(gaps)) == 4


# --- chains --------------------------------------------------------------------------------------


def test_an_inner_pair_passes_its_flat_position_where_the_first_has_none():
    """A parallelogram on a general rocker: equal to the rocker, through its own flat position."""
    machine = Machine([
        Dyad('d', 'RRR', Point('crank', 1.0), Point('ground', 4.0), ('rod', 'rocker'),
             length_1=4.0, length_2=2.5),
        Dyad('p', 'RRR', Point('rocker', 1.0), Point('ground', 4.0, 2.0), ('bar', 'follower'),
             length_1=2.0, length_2=1.0)])
    for x in machine.flat_inputs:
        rocker = machine.motion(x).theta_rocker
        assert abs(abs(rocker) - 0.5 * pi) < 1e-12
        for side in (1, -1):
            for d in DISTANCES:
                motion = machine.motion(x + side * d, 1.3, 0.7)
                assert abs(motion.alpha_follower) < 20.0
                same = abs(motion.omega_follower - motion.omega_rocker) < 1e-9
                crossed = abs(motion.omega_follower - motion.omega_rocker) > 0.05
                assert same or crossed
                if same:
                    assert abs(motion.alpha_follower - motion.alpha_rocker) <= 1e-12
    assert machine.flat_inputs


def test_a_scissor_of_four_stages_keeps_its_digits_near_flat():
    """All rods of a stage turn alike, so the last link moves along the slide without a rate."""
    dyads = [Dyad('s1', 'RRR', Point('slider'), Point('ground'), ('a1', 'b1'), length_1=1.0,
                  length_2=1.0)]
    for i in range(2, 5):
        dyads.append(Dyad(f's{i}', 'RRR', Point(f'b{i - 1}', 2.0), Point(f'a{i - 1}', 2.0),
                          (f'a{i}', f'b{i}'), length_1=1.0, length_2=1.0, mode=1))
    machine = Machine(dyads, 'slide')
    low, high = machine.closing_ranges[0]
    assert high == pytest.approx(2.0, abs=4 * EPS) and low == -high
    for x in (1.98, 1.998, 1.9998, 1.999998, 1e-9):
        motion = machine.motion(x, 1.0)
        with mp.workdps(40):      # cos of a rod is x / 2
            rate = -1 / mp.sqrt(4 - mp.mpf(x)**2)
        for i in range(1, 5):
            for link in (f'a{i}', f'b{i}'):
                found = abs(getattr(motion, f'omega_{link}'))
                # x itself is a datum: its eps moves the rate by x rate^2 more
                bound = 5 * EPS * float(abs(rate)) * (1.0 + float(x * rate)**2)
                assert abs(found - float(abs(rate))) <= bound, (x, link)


def test_every_number_type_has_the_same_change_point():
    """The distance of O from a point is rounded once: no type has another change point."""
    a, b = (0.3, 0.7), (0.1, 0.2)
    length = float(np.hypot(*b))
    machine = Machine([Dyad('d', 'RRR', Point('crank', *b), Point('ground', *a), ('c', 'r'),
                            length_1=float(np.hypot(*a)), length_2=length)])
    assert len(machine.flat_inputs) == 2
    x = np.array([flat + side * d for flat in machine.flat_inputs for d in DISTANCES
                  for side in (1.0, -1.0)])
    many = machine.motion(np.repeat(x, 20), 1.3, 0.7).alpha_r[::20]
    one = [machine.motion(float(at), 1.3, 0.7).alpha_r for at in x]
    assert np.abs(many - one).max() <= 1e-12 * (1.0 + np.abs(one).max())
    assert find_extrema(machine, ('omega_r', 'alpha_r'), 1.3)


def test_hostile_lengths_end_with_an_error_of_this_library():
    rng = random.Random(5)
    for _ in range(30):
        scale = 10.0**rng.uniform(6, 12)
        with pytest.raises(FourBarError):
            Machine([Dyad('l', 'RRR', Point('rod', 0.1, 0.2), Point('ground', 0.3), ('c', 'r'),
                          length_1=1.2, length_2=0.8)], 'cylinder',
                    cylinder=Cylinder(Point('ground', 0.7, scale), Point('crank', -0.25)))
