# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Change points by whole numbers: the kinds and the same linkages as machines of dyads."""
from dataclasses import replace
from math import cos, inf, pi, sin
import random

from fourbar_ros import InvalidParameter, Toggle
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad, Point
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
    at_flat = [e for e in found if e.place == 'limit' and abs(e.value) < inf]
    assert len(found) < 40 and len(at_flat) == 8
    # where the rhombus lies flat, 2^-16 beyond, its rods turn as those of the arms, or stand
    assert {round(e.value, 4) for e in at_flat if e.quantity == 'omega_x_1'} == {0.0, 1.0}


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


# --- pairs ---------------------------------------------------------------------------------------

def closed(dyad, poses, side):
    """Return the poses of both links of a dyad as circles and lines meet, on a side."""
    def at(end):
        place, direction = poses[end.link]
        return place + direction * mp.mpc(end.along, end.across)
    p, q = at(dyad.first), at(dyad.second)
    way = q - p
    if dyad.kind == 'RRR':
        r1, r2, square = dyad.length_1, dyad.length_2, abs(way)**2
        along = (square + mp.mpf(r1)**2 - mp.mpf(r2)**2) / 2
        across = mp.sqrt(max(square * r1**2 - along**2, 0))
        pin = p + way * mp.mpc(along, side * across) / square
        return (p, (pin - p) / r1), (q, (pin - q) / r2)
    if dyad.kind == 'RRP':
        line = poses[dyad.second.link][1] * mp.expj(dyad.direction_2)
        place = way / line                  # Q seen from P along the line
        root = side * mp.sqrt(max(mp.mpf(dyad.length_1)**2 - place.imag**2, 0))
        pin = p + line * mp.mpc(root, place.imag)
        return (p, (pin - p) / dyad.length_1), (pin, line)
    bar = -way / mp.mpc(side * mp.sqrt(max(abs(way)**2 - mp.mpf(dyad.offset)**2, 0)), dyad.offset)
    return (p, bar), (q, bar)


def followed(machine, inputs, first):
    """
    Yield the poses of all links at inputs, {link: (place, direction)}.

    ``first``: directions at the first input; each dyad goes on to the side to which it leads.
    """
    before = []
    for x in inputs:
        poses = {'ground': (mp.mpc(0), mp.mpc(1)), 'crank': (mp.mpc(0), mp.expj(x))}
        for dyad in machine.dyads:
            ahead = [first[link] if not before else before[-1][link][1] if len(before) == 1 else
                     2 * before[-1][link][1] - before[-2][link][1] for link in dyad.links]
            poses.update(zip(dyad.links, min(
                (closed(dyad, poses, side) for side in (1, -1)), key=lambda both: sum(
                    abs(direction - guess) for (_, direction), guess in zip(both, ahead)))))
        before = [*before[-1:], poses]
        yield poses


def pinned(name, kind, first, second, mode=2, **sizes):
    links = f'{name}1', f'{name}2'
    if kind == 'RRP':
        sizes.setdefault('direction_2', 0.0)
    if kind == 'RPR':
        sizes.setdefault('offset', 0.0)
    return Dyad(name, kind, Point(*first), Point(*second), links, mode=mode, **sizes)


def rods(name, first, second, length_1, length_2, mode=2):
    return pinned(name, 'RRR', first, second, mode, length_1=length_1, length_2=length_2)


def beside_o4(size, angle=0.0, at=4.0):
    """Return a point of the ground, from the pivot of a follower."""
    return 'ground', at + size * np.cos(angle), size * np.sin(angle)


# a crank-rocker, whose rocker r2 swings from -1.6 to 0.8 or so about O4, and a parallelogram
ROCKER = rods('r', ('crank', 1.0), ('ground', 4.0), 4.0, 2.5)
FOLLOWER = rods('r', ('crank', 1.0), ('ground', 4.0), 4.0, 1.0)
MID = 1.9
CHAINS = {
    'parallelograms': [FOLLOWER, rods('s', ('r2', 1.0), beside_o4(3.0, 0.6), 3.0, 1.0),
                       rods('t', ('s2', 1.0), ('ground', 4.0, 3.0 * np.sin(0.6)),
                            3.0 * np.cos(0.6), 1.0)],
    'crossed ones': [FOLLOWER, rods('s', ('r2', 1.0), beside_o4(3.0, 0.6), 3.0, 1.0, mode=1)],
    'a crossed one on ground and crank': [rods('r', ('ground', 4.0), ('crank', 1.0), 1.0, 4.0, 1),
                                          rods('s', ('r1', 0.5), ('ground', 2.0), 4.0, 3.9)],
    'a kite on a rocker': [ROCKER, rods('s', ('r2', 1.5), beside_o4(1.5, MID), 2.0, 2.0)],
    'a kite on ground and rocker': [ROCKER, rods('s', beside_o4(1.5, MID), ('r2', 1.5), 2.0, 2.0,
                                                 1)],
    '1:5:2:4 on a rocker': [ROCKER, rods('s', ('r2', 1.0), beside_o4(4.0, MID), 5.0, 2.0)],
    'a rhombus on a rocker': [ROCKER, rods('s', ('r2', 1.5), beside_o4(1.5, MID), 1.5, 1.5)],
    'a block that passes the pivot of its bar': [
        ROCKER, pinned('s', 'RPR', ('r2', 1.5), beside_o4(1.5, MID))],
    'a bar that passes the pivot of its block': [
        ROCKER, pinned('s', 'RPR', beside_o4(1.5, MID), ('r2', 1.5), mode=1)],
    'a block beside the pivot of its bar': [
        ROCKER, pinned('s', 'RPR', ('r2', 1.5), beside_o4(2.0, MID), offset=0.5)],
    'a rod that passes its slide': [ROCKER, pinned(
        's', 'RRP', ('r2', 1.5), ('ground', 4.0 + np.sin(MID - 0.5 * pi), -np.cos(MID - 0.5 * pi)),
        length_1=2.5, direction_2=MID - 0.5 * pi, mode=1)],
    'two turns': [rods('k', ('crank', 1.0), ('ground', 1.0), 3.0, 3.0),
                  rods('s', ('k2', 0.5), ('ground', 3.0, 2.0), 5.0, 4.9)],
    'two turns of a bar': [pinned('k', 'RPR', ('crank', 1.0), ('ground', 1.0)),
                           rods('s', ('k2', 0.5), ('ground', 3.0, 2.0), 5.0, 4.9)],
}


@pytest.mark.parametrize('name', CHAINS)
def test_chains_of_pairs_go_on_in_their_branch(name):
    """Over four turns, all links as a continuation in 40 digits, and where pairs lie flat."""
    machine = Machine(CHAINS[name])
    assert machine.turns_fully and list(machine.modes) == [machine.mode]
    assert machine.flat_inputs and machine.modes_passed == (machine.mode,)
    assert machine.period == (4.0 * pi if name.startswith('two') else 2.0 * pi)
    flats = np.add.outer(2.0 * pi * np.arange(5.0), machine.flat_inputs).ravel()
    inputs = np.linspace(0.3, 8.0 * pi + 0.31, 1501)
    motion, links = machine.motion(inputs), machine.layout.moving
    found = {link: np.exp(1j * getattr(motion, f'theta_{link}')) for link in links}
    with mp.workdps(40):
        truth = list(followed(machine, inputs.tolist(), {link: found[link][0] for link in links}))
    # so near a flat position the continuation does not tell one branch from the other
    is_known = np.abs(inputs[:, None] - flats).min(axis=1) > 1e-3
    assert is_known.mean() > 0.95
    for link in links:
        wanted = np.array([complex(poses[link][1]) for poses in truth])
        assert np.abs(found[link] - wanted)[is_known].max() < 1e-11, link
    for x in flats.tolist():
        before, there, beyond = (machine.motion(x + d, 1.3, 0.7) for d in (-1e-5, 0.0, 1e-5))
        for link in links:
            z = [np.exp(1j * getattr(pose, f'theta_{link}')) for pose in (before, there, beyond)]
            turn = 1.3 * np.angle(z[2] / z[0]) / 2e-5
            assert abs(z[1] * z[1] / (z[0] * z[2]) - 1.0) < 1e-8
            assert abs(getattr(there, f'omega_{link}') - turn) < 1e-8
            rates = [getattr(pose, f'omega_{link}') for pose in (before, there, beyond)]
            bend = 1.3 * (rates[2] - rates[0]) / 2e-5 + 0.7 / 1.3 * rates[1]
            assert abs(getattr(there, f'alpha_{link}') - bend) < 1e-6


ONE_DIRECTION = {
    'a kite': rods('s', ('r2', 1.0), beside_o4(1.0), 3.0, 3.0),
    '1:5:2:4': rods('s', ('r2', 1.0), beside_o4(4.0), 5.0, 2.0),
    'on the ground first': rods('s', beside_o4(4.0), ('r2', 1.0), 2.0, 5.0, 1),
    'a block that passes the pivot of its bar': pinned('s', 'RPR', ('r2', 1.0), beside_o4(1.0)),
    'a rod that passes its slide': pinned('s', 'RRP', ('r2', 1.0), ('ground', 0.0, 1.5),
                                          length_1=2.5)}


@pytest.mark.parametrize('name', ONE_DIRECTION)
def test_a_kite_on_links_that_turn_fully_is_refused_where_turns_are_not_counted(name):
    """A follower turns as the crank does; on the crank itself the same repeats after two turns."""
    dyad = ONE_DIRECTION[name]
    with pytest.raises(InvalidParameter, match='^dyads.s: is a kite on links that turn fully '
                                               'against each other, at input [-0-9.]+: ') as error:
        Machine([FOLLOWER, dyad])
    assert '\n' not in str(error.value)
    at_o1 = [point._replace(link='crank') if point.link == 'r2' else
             point._replace(along=point.along - 4.0 * (name[:5] != 'a rod'))
             for point in (dyad.first, dyad.second)]
    machine = Machine([replace(dyad, first=at_o1[0], second=at_o1[1])])
    assert machine.turns_fully and machine.period == 4.0 * pi and len(machine.flat_inputs) == 1
    first, second, third = (machine.motion(0.3 + turn) for turn in (0.0, 2.0 * pi, 4.0 * pi))
    assert abs(first.x_s2 - second.x_s2) + abs(first.theta_s1 - second.theta_s1) > 0.1
    np.testing.assert_allclose(first[3:], third[3:], 1e-12, 1e-12)


def test_what_differs_from_turn_to_turn_is_refused():
    """The kite is in the second turn on its other side, where the parallelogram lies otherwise."""
    kite = rods('k', ('crank', 1.0), ('ground', 1.0), 3.0, 3.0)
    for dyad in (rods('s', ('k2', 1.0), ('ground', 3.0, 2.0), 8.0**0.5, 1.0),
                 rods('s', ('k2', 0.5), ('ground', 3.0, 2.0), 2.0, 1.2)):
        with pytest.raises(InvalidParameter, match='^dyads.s: ends the range or lies flat in one '
                                                   'turn of the crank, not in the next: dyad k '):
            Machine([kite, dyad])
    # a kite that swings does not repeat, and a second one counts the same turns
    swings = rods('k', ('crank', 4.0), ('ground', 4.0), 3.0, 3.0)
    machine = Machine([swings])
    assert machine.period == 2.0 * pi and machine.flat_inputs == (0.0,)
    assert len(machine.driven_otherwise()) == 2
    assert Machine([swings, replace(kite, name='m', links=('m1', 'm2'))]).driven_otherwise() == ()
    both = Machine([kite, replace(kite, name='m', links=('m1', 'm2'), mode=1)])
    assert both.period == 4.0 * pi and both.flat_inputs == (0.0,)


@pytest.mark.parametrize('is_first', [True, False])
@pytest.mark.parametrize('about', [0.0, 1.9, pi])
def test_a_kite_in_a_range_of_another_dyad_is_the_same_in_each_turn(is_first, about):
    """Its side is that of half the angle: a turn later it was its other one, or a toggle."""
    kite = rods('k', ('crank', 1.0), ('ground', 1.0), 3.0, 3.0)
    # the crank swings by less than half a turn about an angle
    limit = rods('s', ('crank', 1.0), ('ground', 2.0 * cos(about), 2.0 * sin(about)), 1.0, 1.0)
    follower = rods('f', ('k2', 0.5), ('s2', 0.5), 3.0, 3.1)
    machine = Machine([*[kite, limit][::1 if is_first else -1], follower])
    assert not machine.turns_fully and machine.period == 2.0 * pi
    for low, high in machine.input_ranges:
        x = np.linspace(low, high, 22)[1:-1]
        first = machine.motion(x, 1.3, -0.7)
        for turn in (-2.0 * pi, 2.0 * pi, 4.0 * pi):
            again = machine.motion(x + turn, 1.3, -0.7)
            np.testing.assert_allclose(again[3:], first[3:], 1e-9, 1e-9)
    assert all(extremum.proof == '' for extremum in find_extrema(machine, conditions=False))


@pytest.mark.parametrize('mode', [1, 2])
def test_a_cylinder_knows_the_half_turns_of_its_crank(mode):
    """A block that passes the pivot of its bar, through both directions of the crank."""
    machine = Machine([pinned('s', 'RPR', ('crank', 0.6), ('ground', 0.6))], 'cylinder',
                      cylinder=Cylinder(Point('ground', -0.2, -0.4), Point('crank', 0.4, -0.1),
                                        mode=mode))
    low, high = machine.closing_ranges[0]
    x = np.linspace(low + 0.01 * (high - low), high - 0.01 * (high - low), 1001)
    motion = machine.motion(x)
    theta = np.unwrap(motion.theta_crank)
    assert machine.flat_inputs or np.abs(np.abs(theta) - pi).min() < 0.01
    found = {link: np.exp(1j * getattr(motion, f'theta_{link}')) for link in ('s1', 's2')}
    with mp.workdps(40):
        truth = list(followed(machine, theta.tolist(), {link: found[link][0] for link in found}))
    for link in found:
        wanted = np.array([complex(poses[link][1]) for poses in truth])
        assert np.abs(found[link] - wanted)[np.abs(theta) > 1e-2].max() < 1e-9, link


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
