# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Change points by whole numbers: the kinds and the same linkages as machines of dyads."""
from itertools import product
from math import atan2, inf, pi
import pickle
import random

from fourbar_ros import Bodies, Body, FourBar, InvertedSlider, SliderCrank, Toggle
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.machine.describe.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np
import pytest
from support.samples import more, some

EPS = 2.0**-52
# Each is within 5 eps times condition of the exact one; the conditions of accelerations and loads
# are up to 4 times that of the angle.
BOUND = 2 * 5 * 4 * EPS
CRANK, ROD, LAST = (Body(2.0, 0.3, 0.1, 0.5), Body(1.0, 0.2, -0.1, 0.2), Body(3.0, 0.4, 0.05, 0.7))
ACTING = {'gravity': (1.0, -9.0)}
DISTANCES = (1e-3, 1e-6, 1e-9, 1e-12)


def four_bar(a1, a2, a3, a4):
    kind = FourBar(a1, a2, a3, a4, bodies=Bodies(CRANK, ROD, LAST), **ACTING)
    machine = Machine([Dyad('d', 'RRR', Point('crank', a1), Point('ground', a4), ('rod', 'rocker'),
                            length_1=a2, length_2=a3)],
                      bodies={'crank': CRANK, 'rod': ROD, 'rocker': LAST}, **ACTING)
    return kind, machine, {'omega4': 'omega_rocker', 'alpha4': 'alpha_rocker', 'f41': 'base',
                           'f32': 'd_inner', 'f43': 'd_second', 'shaking_force': 'shaking_force',
                           'driving_torque': 'driving_torque', 'shaking_moment': 'shaking_moment'}


def slider_crank(a1, a2, e):
    kind = SliderCrank(a1, a2, e, bodies=SliderCrank.BODIES(CRANK, ROD, LAST), **ACTING)
    machine = Machine([Dyad('d', 'RRP', Point('crank', a1), Point('ground', 0.0, e),
                            ('rod', 'block'), length_1=a2, direction_2=0.0)],
                      bodies={'crank': CRANK, 'rod': ROD, 'block': LAST}, **ACTING)
    return kind, machine, {'omega_beta': 'omega_rod', 'alpha_beta': 'alpha_rod',
                           'slide_velocity': 'slide_block_velocity', 'f41': 'base',
                           'slide_acceleration': 'slide_block_acceleration', 'f32': 'd_inner',
                           'shaking_force': 'shaking_force', 'driving_torque': 'driving_torque'}


def inverted(a1, a4, h):
    kind = InvertedSlider(a1, a4, h)
    machine = Machine([Dyad('d', 'RPR', Point('crank', a1), Point('ground', a4), ('block', 'bar'),
                            offset=h)])
    return kind, machine, {'omega4': 'omega_bar', 'alpha4': 'alpha_bar',
                           'slide_velocity': 'slide_block_velocity',
                           'slide_acceleration': 'slide_block_acceleration'}


def driven_slider(a1, a2, e):
    kind = SliderCrank(a1, a2, e, input='slide')
    machine = Machine([Dyad('d', 'RRR', Point('slider'), Point('ground', 0.0, -e), ('rod', 'arm'),
                            length_1=a2, length_2=a1)], 'slide')
    return kind, machine, {'omega1': 'omega_arm', 'alpha1': 'alpha_arm'}


def whole_numbers(most):
    """Return (maker, lengths) of all change points of some whole numbers."""
    found = []
    for a1, a2, a3 in product(range(1, most + 1), repeat=3):
        found += [(four_bar, (a1, a2, a3, a4)) for a4 in range(1, most + 1)
                  if a1 + a4 == a2 + a3 or abs(a1 - a4) == abs(a2 - a3)]
        e = a3 - 1
        found += [(slider_crank, (a1, a2, e)) for _ in range(a2 in (a1 + e, a1 - e))]
        found += [(inverted, (a1, a2, e)) for _ in range(abs(a1 - a2) == e)]
        found += [(driven_slider, (a1, a2, e)) for _ in range(abs(a1 - a2) == e)]
    return found


def sample(most, count):
    return random.Random(7).sample(whole_numbers(most), count)


def made(maker, lengths):
    """Return the kind, the machine and the names; None where both refuse."""
    try:
        found = maker(*map(float, lengths))
    except InvalidParameter:
        return None
    return found


def poses(kind, rng):
    for low, high in kind.input_ranges:
        yield from (low + (high - low) * rng.random() for _ in range(3))
        for place in {0.0, *(() if kind.is_driven_by_slide else (pi, 0.5 * pi, -0.5 * pi))}:
            yield from (place + side * d for d in DISTANCES for side in (1, -1)
                        if low < place + side * d < high)


def check_poses(maker, lengths):
    found = made(maker, lengths)
    if found is None:
        return
    kind, machine, names = found
    unit = kind.input_unit
    assert len(kind.input_ranges) == len(machine.input_ranges), lengths
    for one, other in zip(kind.input_ranges, machine.input_ranges):
        assert max(abs(a - b) for a, b in zip(one, other)) <= 8 * EPS * unit, lengths
    for x in poses(kind, random.Random(3)):
        left, right = [one.motion_and_loads(x, 1.3, 0.7) for one in (kind, machine)]
        condition = max(1.0, left[0].condition)        # of the angle; rates divide by the sine
        left, right = [part[0]._asdict() | (part[1]._asdict() if part[1] else {})
                       for part in (left, right)]
        for what in ('omega', 'alpha', 'slide', ''):
            group = [name for name in names if name.startswith(what) and (
                what or not name.startswith(('omega', 'alpha', 'slide')))]
            size = max([1.0, *(abs(left[name]) for name in group)])
            for name in group:
                assert abs(left[name] - right[names[name]]) <= (
                    BOUND * condition**2 * size), (lengths, x, name)


@pytest.mark.parametrize('count', [more(60, 400)])
def test_poses_at_change_points(count):
    for maker, lengths in sample(12, count):
        check_poses(maker, lengths)


def check_extrema(maker, lengths):
    found = made(maker, lengths)
    if found is None:
        return
    kind, machine, names = found
    both = []
    for one, wanted in ((kind, list(names)), (machine, list(names.values()))):
        rows = [(wanted.index(e.quantity), e.kind, e.place,
                 e.slide if kind.is_driven_by_slide else e.theta1, e.value)
                for e in find_extrema(one, wanted, 1.3, 0.7)]
        both.append(rows)
    left, right = both
    assert len(left) == len(right), lengths
    for name, sort, place, x, value in left:
        near = [(abs(kind.distance(x, other[3])), other[4]) for other in right
                if other[:3] == (name, sort, place)]
        # an extremum is flat: its place has half of the digits of its value
        assert any(apart <= 1e-5 and (value == its or abs(value - its) <= 1e-9 * max(1, abs(its)))
                   for apart, its in near), (lengths, name, sort, x, value, near)


@some('most, count', [(6, 8), (12, 60)], 1)
def test_extrema_at_change_points(most, count):
    for maker, lengths in sample(most, count):
        check_extrema(maker, lengths)


# --- placed elsewhere ----------------------------------------------------------------------------

P34, Q512, Q34, P43 = (3.0, 4.0), (5.0, 12.0), (3.0, 4.0), (4.0, 3.0)
PLACED = {        # the dyad, and the same as a first dyad at O1 along x, turned by these angles
    'RRR, both turned': (
        Dyad('d', 'RRR', Point('crank', *P34), Point('ground', *Q512), ('a', 'b'), length_1=8.0,
             length_2=10.0), atan2(12, 5) - atan2(4, 3) + pi),
    'RRR, first on the ground': (
        Dyad('d', 'RRR', Point('ground', *Q512), Point('crank', *P34), ('b', 'a'), length_1=10.0,
             length_2=8.0), atan2(12, 5) - atan2(4, 3) + pi),
    'RRP, line on the ground': (
        Dyad('d', 'RRP', Point('crank', *P34), Point('ground', 0.0, 1.0), ('a', 'b'), length_1=5.0,
             direction_2=0.5 * pi), pi - atan2(4, 3)),
    'RRP, line on the crank': (
        Dyad('d', 'RRP', Point('ground', 2.0), Point('crank', 0.0, 1.0), ('a', 'b'), length_1=3.0,
             direction_2=0.0), 0.5 * pi),
    'RPR, bar on the ground': (
        Dyad('d', 'RPR', Point('crank', *P34), Point('ground', *P43), ('a', 'b')),
        atan2(3, 4) - atan2(4, 3)),
    'RPR, bar on the crank': (
        Dyad('d', 'RPR', Point('ground', *P43), Point('crank', *P34), ('a', 'b')),
        atan2(3, 4) - atan2(4, 3)),
}


@pytest.mark.parametrize('name', PLACED)
def test_change_points_anywhere_on_crank_and_ground(name):
    """On both sides of the flat position rates are bounded, smooth, and of power balance."""
    dyad, flat = PLACED[name]
    machine = Machine([dyad], bodies={'crank': CRANK, 'a': ROD, 'b': LAST}, **ACTING)
    assert any(abs(machine.distance(flat, place)) < 4 * EPS * pi for place in machine.flat_inputs)
    assert machine.change_point_margin == 0.0
    for side in (1, -1):
        motions = [machine.motion(flat + side * d, 1.3, 0.7) for d in DISTANCES]
        for field in ('omega_a', 'alpha_a', 'omega_b', 'alpha_b'):
            values = [getattr(motion, field) for motion in motions]
            size = max(map(abs, values)) + 1.0
            # an analytic function: it approaches its limit as the distance
            assert all(abs(value - values[-1]) <= 40.0 * d * size + 1e-12 * size
                       for value, d in zip(values, DISTANCES)), (field, values)
        for d in DISTANCES:
            check_power(machine, flat + side * d)
    assert machine.mode_beyond(flat) != machine.mode


def check_power(machine, x):
    """Drive times rate is what the links gain in a second, by Newton and Euler."""
    rate, acceleration = 1.3, 0.7
    motion, loads = machine.step(x, rate, acceleration)
    power = 0.0
    for link, body in machine.bodies._asdict().items():
        m = machine.link_motion(motion, link)
        gx, gy = (body.cg_along * m.cosine - body.cg_across * m.sine,
                  body.cg_along * m.sine + body.cg_across * m.cosine)
        vx, vy = m.v_x - m.omega * gy, m.v_y + m.omega * gx
        ax = m.a_x - m.alpha * gy - m.omega**2 * gx - machine.gravity[0]
        ay = m.a_y + m.alpha * gx - m.omega**2 * gy - machine.gravity[1]
        power += body.mass * (ax * vx + ay * vy) + body.inertia * m.omega * m.alpha
    size = max(1.0, abs(power), *(abs(v) for v in motion if abs(v) < 1e6))
    assert abs(loads.driving_torque * rate - power) <= 1e3 * EPS * size**2


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

def parallelogram(name, link, at, span, length, links):
    return Dyad(name, 'RRR', Point(link, *at), Point('ground', *span), links, length_1=length,
                length_2=1.0)


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


def test_a_pickled_machine_has_its_change_points():
    machine = peaucellier(*INVERSORS[0])
    again = pickle.loads(pickle.dumps(machine))
    assert again == machine and again.limits == machine.limits


def test_hostile_lengths_end_with_an_error_of_this_library():
    rng = random.Random(5)
    for _ in range(30):
        scale = 10.0**rng.uniform(6, 12)
        with pytest.raises(FourBarError):
            Machine([Dyad('l', 'RRR', Point('rod', 0.1, 0.2), Point('ground', 0.3), ('c', 'r'),
                          length_1=1.2, length_2=0.8)], 'cylinder',
                    cylinder=Cylinder(Point('ground', 0.7, scale), Point('crank', -0.25)))
