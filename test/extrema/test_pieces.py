# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema of loads with springs and force tables against dense scans of the loads themselves."""
from dataclasses import replace
from math import pi

from fourbar_ros import (
    Bodies,
    Body,
    FourBar,
    InvalidParameter,
    InvertedSlider,
    JointFriction,
    round_rod,
    SliderCrank,
)
from fourbar_ros.dynamics import Equation, flywheel_for
from fourbar_ros.errors import UnknownForce
from fourbar_ros.extrema import find_extrema, OverInput
from fourbar_ros.mechanisms.elements import (
    Attachment,
    LinkAngle,
    PositionForce,
    Spring,
    TorsionSpring,
    Way,
)
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.quantities import Function
from fourbar_ros.scene.scene import load
import numpy as np
import pytest
from support.samples import more

EPS = 2.0**-52
TURN = 2.0 * pi
MACHINES = 'watt', 'quick_return', 'bucket'
SCAN = 24001            # samples of a scan, per turn or range
LOST = 1e-9             # of the span of a quantity: what a scan cannot tell from rounding


def mechanism_of(rng):
    """Return a random mechanism: all kinds, cranks and slides, machines of several dyads."""
    choice = rng.integers(6)
    if choice == 5:
        return load(MACHINES[rng.integers(len(MACHINES))]).linkage
    a1, a2, a3 = rng.uniform(0.2, 0.4), rng.uniform(0.9, 1.3), rng.uniform(0.7, 1.1)
    bodies = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (a1, a2, a3)))
    gravity = (0.0, -9.81)
    if choice < 2:
        return FourBar(a1, a2, a3, 1.0, mode=1 + choice, bodies=bodies, gravity=gravity)
    if choice == 2:
        return SliderCrank(a1, a2, rng.uniform(-0.1, 0.1), bodies=bodies, gravity=gravity)
    if choice == 3:
        return SliderCrank(a1, a2, 0.05, input='slide', bodies=bodies, gravity=gravity)
    return InvertedSlider(a1, a2, 0.1, bodies=bodies, gravity=gravity)


def table_of(rng, low, high, is_periodic=False):
    """Return a random table, cubic or of straight lines, in every other one a jump."""
    count = int(rng.integers(3, 12))
    places = np.concatenate(([low], np.sort(rng.uniform(low, high, count - 2)), [high]))
    values = rng.normal(size=count) * 200.0
    if rng.integers(2):
        jump = rng.integers(1, count)
        places[jump - 1] = places[jump]
        places[0] = low
    if is_periodic:
        values[-1] = values[0]
    return ForceTable(places, values, is_periodic, bool(rng.integers(2)))


def elements_of(rng, mechanism):
    """Return one to three random elements on a mechanism."""
    links = [link.name for link in mechanism.LINKS]
    turning = [link.name for link in mechanism.LINKS if link.turns]
    elements = []
    for _ in range(rng.integers(1, 4)):
        link, kind = str(rng.choice(links)), rng.integers(6)
        point = Attachment(link, *rng.uniform(-0.3, 0.3, 2))
        if kind == 0:
            elements.append(Spring(Attachment('ground', *rng.uniform(-0.5, 1.5, 2)), point,
                                   rng.uniform(100.0, 2000.0), damping=rng.uniform(0.0, 20.0),
                                   free_length=rng.choice([0.0, 0.3]),
                                   preload=rng.choice([0.0, 40.0])))
        elif kind == 1:
            elements.append(TorsionSpring('ground', str(rng.choice(turning)), 60.0,
                                          free_angle=rng.uniform(-3.0, 3.0)))
        elif kind == 2 and not mechanism.is_driven_by_slide and mechanism.turns_fully:
            turns = int(rng.integers(1, 3))
            elements.append(PositionForce(point, table_of(rng, 0.0, turns * TURN, True)))
        elif kind == 3:
            elements.append(PositionForce(point, table_of(rng, -0.2, 1.2), Way(point),
                                          rng.uniform(-3.0, 3.0)))
        elif kind == 4:
            elements.append(PositionForce(point, table_of(rng, -1.5, 1.4), LinkAngle(
                str(rng.choice(turning))), None))
        else:
            elements.append(PositionForce(point, table_of(rng, 0.0, TURN, True),
                                          LinkAngle(str(rng.choice(turning))), 0.3, link))
    return elements


def scan_of(mechanism, name, rate):
    """Return inputs and a load at them: dense, denser about the ends of pieces."""
    ranges = (((0.0, mechanism.cycle),) if mechanism.turns_fully else mechanism.input_ranges)
    parts = []
    for low, high in ranges:
        x = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(
            np.linspace(0.0, pi, mechanism.turns * SCAN)[1:-1])
        if mechanism.turns_fully:
            x = np.linspace(low, high, mechanism.turns * SCAN)
        parts.append((x, getattr(mechanism.loads(x, rate), name)))
    return parts


def turning_points(x, values):
    """Return (input before, after, sense, depth) of all turning points of a scan."""
    step = np.sign(np.diff(values))
    inner = np.flatnonzero(step[1:] * step[:-1] < 0.0) + 1
    return [(x[i - 1], x[i + 1], int(step[i - 1]), i) for i in inner]


@pytest.mark.parametrize('after', [5.0, 9.0])
def test_a_plateau_may_lie_between_a_jump_and_an_end(after):
    """And at an end where a load jumps its value is that inside: a least -7 was lost."""
    crank = SliderCrank(0.05, 0.2, bodies=Bodies(*[Body(0.0)] * 3)).with_elements(PositionForce(
        Attachment('crank'), ForceTable((0.0, 1.0, 2.0, 2.0, TURN), (3.0, 7.0, 7.0, after, 3.0),
                                        True, True), direction=None))
    falls = after - 3.0
    for within, expected in (
            ((0.3, 2.0), [(-4.2, 1), (-7.0, -1)]),
            ((0.3 + TURN, 2.0 + TURN), [(-4.2, 1), (-7.0, -1)]),
            ((2.0, 4.0), [(-after, 1), (2.0 * falls / (TURN - 2.0) - after, -1)]),
            ((1.5, 4.0), [(-7.0, 1), (-7.0, -1), (-after, 1),
                          (2.0 * falls / (TURN - 2.0) - after, -1)])):
        extrema = find_extrema(crank, 'driving_torque', 0.0, conditions=False, within=within)
        assert {extremum.proof for extremum in extrema} == {''}
        assert [extremum.side for extremum in extrema] == [side for _, side in expected]
        assert [extremum.value for extremum in extrema] == pytest.approx(
            [value for value, _ in expected], rel=1e-12)


# 258: a plateau of a load lies between its jump and the end of the range
@pytest.mark.parametrize('seed', sorted({*range(more(12, 500)), 258}))
def test_no_extremum_of_a_load_is_lost(seed):
    rng = np.random.default_rng(seed)
    mechanism = mechanism_of(rng)
    mechanism = mechanism.with_elements(*elements_of(rng, mechanism))
    names, rate = ('shaking_force', 'shaking_moment', mechanism.drive_load,
                   mechanism.reactions[0]), float(rng.choice([0.0, 3.0]))
    extrema = find_extrema(mechanism, names, rate, conditions=False)
    for name in names:
        found = [extremum for extremum in extrema if extremum.quantity == name]
        assert all(extremum.proof == '' for extremum in found), (name, found[0].proof)
        inputs = np.array([extremum.input for extremum in found])
        lowest = min(extremum.value for extremum in found)
        highest = max(extremum.value for extremum in found)
        for x, values in scan_of(mechanism, name, rate):
            span = np.ptp(values)
            if span <= 1e-9 * np.abs(values).max():     # a constant
                continue
            if np.isfinite([lowest, highest]).all():
                assert values.min() >= lowest - LOST * (span + abs(lowest)), name
                assert values.max() <= highest + LOST * (span + abs(highest)), name
            for low, high, _, i in turning_points(x, values):
                depth = min(abs(values[i] - values[max(i - 40, 0)]),
                            abs(values[i] - values[min(i + 40, x.size - 1)]))
                if depth <= LOST * span:
                    continue
                near = 2.0 * (high - low)
                away = np.abs(inputs - 0.5 * (low + high))
                if not mechanism.is_driven_by_slide:
                    cycle = mechanism.cycle
                    away = np.minimum(away, np.abs(away - cycle))
                    if not mechanism.turns_fully:
                        away = np.abs((inputs - 0.5 * (low + high) + pi) % TURN - pi)
                assert away.min() <= near, (name, low, values[i])


@pytest.mark.parametrize('is_function', [False, True])
def test_the_rounding_of_a_table_is_no_jump(is_function):
    """Links without mass under a couple on the crank transmit no force that would tell a size."""
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=Bodies(*[Body(0.0)] * 3), elements=(PositionForce(
        Attachment('crank'), ForceTable([0.0, 1.0, 1.5, 2.0, TURN], [0.0, 0.0, 5.0, 5.0, 0.0],
                                        is_periodic=True), 'input', None),))
    top, bottom = find_extrema(linkage, beside('driving_torque') if is_function
                               else 'driving_torque')
    assert (top.kind, top.place, top.value) == ('maximum', 'interior', 0.0)
    assert (bottom.kind, bottom.place, bottom.value) == ('minimum', 'interior', -5.0)
    assert (top.theta1, bottom.theta1) == (1.0, 1.5) and top.is_global and bottom.is_global


def beside(name):
    """Return a function that is a load but for its last bits, and has no complex step."""
    return lambda motion, loads: np.abs(getattr(loads, name)) * np.sign(getattr(loads, name))


@pytest.mark.parametrize('seed', range(more(8, 200)))
def test_a_function_of_loads_is_searched_as_a_load(seed):
    rng = np.random.default_rng(seed)
    mechanism = mechanism_of(rng)
    mechanism = mechanism.with_elements(*elements_of(rng, mechanism))
    name = mechanism.drive_load
    loads, functions = (find_extrema(mechanism, asked, 2.0)
                        for asked in (name, beside(name)))
    assert ([(each.kind, each.place, each.side) for each in loads]
            == [(each.kind, each.place, each.side) for each in functions])
    span = max([abs(each.value) for each in loads if np.isfinite(each.value)], default=0.0)
    for load_, function in zip(loads, functions):
        assert function.value == pytest.approx(load_.value, abs=LOST * span)


@pytest.mark.parametrize('is_smooth', [False, True])
def test_a_function_of_the_loads_of_a_four_stroke_is_searched_over_two_turns(is_smooth):
    engine = load('engine').linkage
    torque = find_extrema(engine, 'driving_torque', 10.0)
    doubled = find_extrema(engine, Function(
        'doubled', 'N m', '', lambda motion, loads: 2.0 * loads.driving_torque,
        is_smooth=is_smooth), 10.0, certify=True)
    assert [(each.kind, each.is_global) for each in doubled] == [
        (each.kind, each.is_global) for each in torque]
    for each, once in zip(doubled, torque):
        assert each.value == pytest.approx(2.0 * once.value, rel=LOST)
        assert each.theta1 == pytest.approx(once.theta1, abs=1e-8)
        assert each.proof.startswith('interval bounds')


def test_the_mean_of_a_four_stroke_is_over_two_turns():
    engine = load('engine').linkage
    over = OverInput(engine, 'driving_torque', 20.0)
    x = engine.cycle * (np.arange(400_000) + 0.5) / 400_000
    torque = engine.loads(x, 20.0).driving_torque
    assert engine.cycle == 2.0 * TURN
    assert over.mean == pytest.approx(torque.mean(), rel=1e-7)
    assert over.rms == pytest.approx(np.sqrt(np.mean(torque**2)), rel=1e-7)
    assert over.peak >= np.abs(torque).max()


def test_a_kink_of_straight_lines_is_an_extremum_at_its_point():
    """A triangle of couples on a massless crank: the torque is minus it, least at its tip."""
    bodies = Bodies(*(round_rod(length, 1e-9, 0.01) for length in (0.3, 1.0, 0.9)))
    tip = ForceTable([0.0, 2.0, TURN], [0.0, 50.0, 0.0], True, True)
    mechanism = FourBar(0.3, 1.0, 0.9, 1.0, bodies=bodies).with_elements(
        PositionForce(Attachment('crank'), tip, direction=None))
    least, most = sorted(find_extrema(mechanism, 'driving_torque', 1.0),
                         key=lambda extremum: extremum.value)
    assert (least.kind, least.place, most.place) == ('minimum', 'interior', 'interior')
    assert least.theta1 == pytest.approx(2.0, abs=1e-15)
    assert least.value == pytest.approx(-50.0, rel=1e-9)
    assert most.theta1 == pytest.approx(0.0, abs=1e-15)


def massless_with(table):
    """Return a crank-rocker whose driving torque is minus a table over its crank, to 1e-9."""
    bodies = Bodies(*(round_rod(length, 1e-9, 0.01) for length in (0.3, 1.0, 0.9)))
    return FourBar(0.3, 1.0, 0.9, 1.0, bodies=bodies).with_elements(
        PositionForce(Attachment('crank'), table, direction=None))


def test_a_function_over_two_turns_is_searched_over_both():
    """A couple F = 30 sin s + 40 sin(s/2): with u = cos(s/2), F' = 60 u^2 + 20 u - 30."""
    mechanism = massless_with(lambda s: 30.0 * np.sin(s) + 40.0 * np.sin(0.5 * s))
    expected = []
    for u in np.roots([60.0, 20.0, -30.0]):
        for s in (2.0 * np.arccos(u), 2.0 * TURN - 2.0 * np.arccos(u)):
            expected.append((s, -30.0 * np.sin(s) - 40.0 * np.sin(0.5 * s)))
    error = 1e-6        # the masses are not zero, the slopes are differences
    assert mechanism.cycle == 2.0 * TURN
    found = [(extremum.theta1, extremum.value) for extremum in find_extrema(
        mechanism, 'driving_torque', 1.0)]
    assert np.array(found) == pytest.approx(np.array(sorted(expected)), abs=50.0 * error)
    assert OverInput(mechanism, 'driving_torque').rms == pytest.approx(
        np.sqrt((30.0**2 + 40.0**2) / 2.0), rel=error)


@pytest.mark.parametrize('turns', [1, 3, 4])
def test_every_flat_position_of_some_turns_is_a_pole(turns):
    """A parallelogram lies flat twice in each turn: of the third on poles were left out."""
    table = ForceTable([0.0, 2.0, turns * TURN], [20.0, 50.0, 20.0], True)
    bodies = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.3, 1.0, 0.3)))
    linkage = FourBar(0.3, 1.0, 0.3, 1.0, bodies=bodies).with_elements(
        PositionForce(Attachment('output', 0.1), table, direction=0.3))
    poles = [extremum for extremum in find_extrema(linkage, 'f32', 3.0)
             if extremum.place == 'limit']
    assert [pole.value for pole in poles] == [np.inf] * 4 * turns
    assert [pole.theta1 for pole in poles] == pytest.approx(
        np.repeat(np.arange(2 * turns) * pi, 2))


def test_functions_of_loads_are_searched_over_both_turns():
    table = ForceTable([0.0, 3.0, 8.0, 2.0 * TURN], [0.0, 20.0, 70.0, 0.0], True)
    mechanism = massless_with(table)

    def heat(motion, loads):
        return loads.driving_torque**2

    def rate(motion, loads):        # of the motion alone: one turn
        return motion.omega4
    peaks = [each.theta1 for each in find_extrema(mechanism, heat, 1.0) if each.kind == 'maximum']
    assert peaks == [pytest.approx(8.0, abs=1e-6)]
    assert OverInput(mechanism, heat).peak == pytest.approx(70.0**2, rel=1e-6)
    assert len(find_extrema(mechanism, rate)) == len(find_extrema(mechanism, 'omega4'))


@pytest.mark.parametrize('never', [
    lambda s: 0.1 * s, lambda s: np.sin(0.3 * s),
    lambda s: np.interp(s, [0.0, 3.0, TURN], [0.0, 1.0, 0.0]) + (s > TURN)])
def test_a_function_that_never_repeats_has_no_cycle(never):
    mechanism = massless_with(never)
    for ask in (lambda: find_extrema(mechanism, 'driving_torque', 1.0),
                lambda: OverInput(mechanism, 'driving_torque', 1.0).rms,
                lambda: flywheel_for(Equation(mechanism), 1.0, 0.1)):
        with pytest.raises(InvalidParameter, match='must repeat after a turn, or up to 4'):
            ask()
    assert len(find_extrema(mechanism, 'driving_torque', 1.0, within=(0.5, 1.0))) == 2
    assert find_extrema(mechanism, 'omega4')


@pytest.mark.parametrize('is_linear', [True, False])
@pytest.mark.parametrize(('places', 'values', 'limits'), [
    # a cut from 2 to 3 rad, held between: written as a designer does
    ([0.0, 2.0, 2.0, 3.0, 3.0, TURN], [0.0, 0.0, 50.0, 40.0, 0.0, 0.0],
     [(2.0, -1, 0.0), (2.0, 1, -50.0), (3.0, -1, -40.0), (3.0, 1, 0.0)]),
    # where the table comes round, as a row more at its end, or at its begin
    ([0.0, 2.0, TURN, TURN], [10.0, 20.0, 50.0, 10.0], [(0.0, -1, -50.0), (0.0, 1, -10.0)]),
    ([0.0, 0.0, 2.0, TURN], [50.0, 10.0, 20.0, 50.0], [(0.0, -1, -50.0), (0.0, 1, -10.0)])])
def test_a_jump_of_a_table_counts_on_both_sides(places, values, limits, is_linear):
    extrema = find_extrema(massless_with(ForceTable(places, values, True, is_linear)),
                           'driving_torque', 1.0)
    jumps = [(extremum.theta1 % TURN, extremum.side, extremum.value) for extremum in extrema
             if extremum.place == 'limit']
    assert len(jumps) == len(limits) and not any(extremum.proof for extremum in extrema)
    for place, side, value in limits:
        values_there = [jump[2] for jump in jumps if jump[1] == side
                        and abs((jump[0] - place + pi) % TURN - pi) < 1e-9]
        assert values_there == [pytest.approx(value, abs=1e-7)], (place, side)
    assert min(extremum.value for extremum in extrema) == pytest.approx(-max(values), abs=1e-7)


@pytest.mark.parametrize('share', [0.25, 0.5, 0.75])
@pytest.mark.parametrize('over', ['input', 'crank', Way(Attachment('output'))], ids=str)
@pytest.mark.parametrize('mode', [1, 2])
def test_a_jump_at_a_sample_of_the_search_is_found(share, over, mode):
    """A slide of a round range, whose middle and quarters are samples: 0 below, 1000 N above."""
    # theta1 rises in mode 2 and falls in mode 1; the table's places are its values to the bit
    slide = SliderCrank(0.1, 0.3, mode=mode, input='slide', stroke=(0.25, 0.35),
                        bodies=Bodies(Body(0.0), Body(0.0), Body(0.0)))
    middle, link = 0.25 + 0.1 * share, Attachment('output')
    of_angle = over == 'crank'
    if of_angle:
        middle_of_table = slide.motion(middle).theta1
        over, places = LinkAngle('crank'), middle_of_table + np.array([-1.0, 0.0, 0.0, 1.0])
    else:
        places = [0.2, middle, middle, 0.4]
    values = np.array([0.0, 0.0, -1000.0, -1000.0])
    if of_angle and mode == 1:
        values = values[::-1]
    pushed = slide.with_elements(PositionForce(
        link, ForceTable(places, values.tolist(), is_linear=True), over, 0.0))
    load = OverInput(pushed, 'driving_force', 1.0)
    assert [abs(end - middle) < 1e-12 for end in pushed.pieces.ends] == [True]
    assert load.peak == pytest.approx(1000.0, rel=1e-9)
    assert load.rms**2 == pytest.approx(1e6 * (1.0 - share), rel=1e-9)
    limits = [(extremum.side, extremum.value) for extremum in find_extrema(
        pushed, 'driving_force', 1.0) if abs(extremum.input - middle) < 1e-9]
    assert sorted(limits) == [(-1, pytest.approx(0.0, abs=1e-6)), (1, pytest.approx(1000.0))]


def test_a_force_that_is_on_between_two_places_alone_has_proven_peaks():
    """At rest without weight: nothing but a step up and one down, over the input and a way."""
    linkage = SliderCrank(0.3, 1.0, bodies=Bodies(*(round_rod(0.5, 7750.0, 0.01),) * 3))
    tip = Attachment('output')
    for over, places in (('input', [0.0, 2.0, 2.0, 3.0, 3.0, TURN]),
                         (Way(tip), [0.0, 0.9, 0.9, 1.1, 1.1, 2.0])):
        table = ForceTable(places, [0.0, 0.0, -2000.0, -2000.0, 0.0, 0.0], over == 'input', True)
        extrema = find_extrema(linkage.with_elements(PositionForce(tip, table, over, 0.0)),
                               'shaking_force', 0.0)
        assert {round(extremum.value, 6) for extremum in extrema} == {0.0, 2000.0}
        assert {extremum.place for extremum in extrema} == {'limit'}
        assert not any(extremum.proof for extremum in extrema)


def test_the_mean_over_a_jump_is_that_of_both_pieces():
    """Straight lines: mean and square mean of each piece by hand."""
    table = ForceTable([0.0, 2.0, 2.0, 3.0, 3.0, TURN], [0.0, 0.0, 50.0, 40.0, 0.0, 0.0], True,
                       True)
    over = OverInput(massless_with(table), 'driving_torque', 1.0)
    assert over.mean == pytest.approx(-45.0 / TURN, rel=1e-9)
    assert over.rms == pytest.approx(np.sqrt((50.0**2 + 50.0 * 40.0 + 40.0**2) / 3.0 / TURN),
                                     rel=1e-9)
    assert over.peak == pytest.approx(50.0, rel=1e-9)


def test_a_jump_counts_on_both_sides():
    """A torsion spring of the crank comes round half a turn from its free angle."""
    bodies = Bodies(*(round_rod(length, 1e-9, 0.01) for length in (0.3, 1.0, 0.9)))
    mechanism = FourBar(0.3, 1.0, 0.9, 1.0, bodies=bodies).with_elements(
        TorsionSpring('ground', 'crank', 10.0, free_angle=0.5))
    extrema = find_extrema(mechanism, 'driving_torque', 1.0)
    ends = {(extremum.side, round(extremum.value, 6)): extremum for extremum in extrema
            if extremum.place == 'limit'}
    assert set(ends) == {(-1, round(10.0 * pi, 6)), (1, round(-10.0 * pi, 6))}
    assert all(abs(extremum.theta1 - 0.5 - pi) < 1e-9 for extremum in ends.values())


def press(**changes):
    """Return a press: weight, a spring, a cut on the way down alone, friction everywhere."""
    rods = Bodies(Body(1.5, inertia=0.002, cg_along=0.01), Body(2.0, inertia=0.006, cg_along=0.08),
                  Body(6.0))
    cut = ForceTable([0.0, 0.1919, 0.192, 0.2], [0.0, 0.0, -2000.0, -2000.0], is_linear=True)
    ram = Attachment('output')
    pin = JointFriction(0.1, radius=0.01)
    return replace(SliderCrank(
        0.04, 0.16, bodies=rods, gravity=(9.81, 0.0),
        elements=(Spring(Attachment(), ram, 4000.0, free_length=0.06),
                  PositionForce(ram, cut, Way(ram), when='forward')),
        friction={'O1': pin, 'A': pin, 'B': pin, 'guide': JointFriction(0.1)}), **changes)


def test_a_force_of_a_function_has_its_peak_at_a_corner_and_counts_on_both_sides_of_a_step():
    """Light links: the load without it, at that input, differs in its last bits alone."""
    free = FourBar(0.4, 1.2, 0.8, 1.0, bodies=Bodies(*[round_rod(length, 7.0, 0.01)
                                                       for length in (0.4, 1.2, 0.8)]))

    def torque_of(force):
        linkage = free.with_elements(PositionForce(Attachment('crank'), force, 'input', None))
        return find_extrema(linkage, 'driving_torque')
    peak = min(torque_of(lambda s: 1e3 * max(0.0, min((s % TURN - 1.0) / 0.5,
                                                      (1.7 - s % TURN) / 0.2))),
               key=lambda each: each.value)
    assert peak.theta1 == pytest.approx(1.5, abs=4.0 * EPS) and peak.is_global and not peak.proof
    assert peak.value - free.loads(1.5, 1.0).driving_torque == pytest.approx(-1e3, rel=LOST)
    least, most = torque_of(lambda s: 50.0 * ((s - 1.0) % TURN) / TURN)
    rest = free.loads(1.0, 1.0).driving_torque
    for each, side, torque in ((least, -1, -50.0), (most, 1, 0.0)):
        assert (each.place, each.side) == ('limit', side) and each.is_global and not each.proof
        assert each.value - rest == pytest.approx(torque, abs=LOST)


@pytest.mark.parametrize('place', [0.0, 0.7, 1.0, 2.0])
def test_a_spring_whose_ends_meet_jumps_there(place):
    """It pulls the crank forward, then back: values at 2^-18 rad, extrapolated with slopes."""
    pull, a1 = 100.0, 0.4
    free = FourBar(a1, 1.2, 0.8, 1.0, bodies=Bodies(*[round_rod(length, 7750.0, 0.01)
                                                      for length in (a1, 1.2, 0.8)]))
    linkage = free.with_elements(Spring(
        Attachment('ground', a1 * np.cos(place), a1 * np.sin(place)), Attachment('crank', a1),
        preload=pull))
    rest = free.loads(place, 1.0).driving_torque
    for asked in ('driving_torque', beside('driving_torque')):
        found = find_extrema(linkage, asked)
        below, above = sorted([each for each in found if each.place == 'limit'],
                              key=lambda each: each.side)
        for each, torque in ((below, -pull * a1), (above, pull * a1)):
            assert each.theta1 == pytest.approx(place, abs=1e-12)
            assert each.value - rest == pytest.approx(torque, rel=2.0**-36)
        values = linkage.loads(np.linspace(-pi, pi, SCAN)[1:-1], 1.0).driving_torque
        assert min(each.value for each in found) <= np.nanmin(values)
        assert max(each.value for each in found) >= np.nanmax(values)
        assert len(found) <= 6 and not any(each.proof for each in found)


def test_no_equation_of_motion_holds_where_the_ends_of_a_spring_meet():
    bodies = Bodies(*[round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)])
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, elements=(Spring(
        Attachment('ground', 0.4 * np.cos(1.0), 0.4 * np.sin(1.0)), Attachment('crank', 0.4),
        preload=1.0),))
    with pytest.raises(UnknownForce, match='the ends of a spring meet there'):
        Equation(linkage).terms(1.0)


def test_a_cut_acts_on_the_way_down_alone():
    """Work of a cycle: the area of the cut; at rest and on the way back it is not there."""
    free = press(friction=())
    both = free.with_elements(*(replace(element, when='both') if hasattr(element, 'when')
                                else element for element in free.elements))
    rate = 9.42477796
    for linkage, area in ((free, 2000.0 * 0.008 + 0.5 * 2000.0 * 1e-4), (both, 0.0)):
        assert OverInput(linkage, 'driving_torque', rate).of_cycle == pytest.approx(
            area, abs=1e-9)
    for angle, acts in ((-0.3, True), (0.3, False)):
        here, there = free.loads(angle, rate), both.loads(angle, rate)
        assert (here.driving_torque == there.driving_torque) is acts
        back = free.loads(-angle, -rate)            # the other way round it is as the mirror
        assert back.driving_torque == pytest.approx(-here.driving_torque, rel=1e-12)
        assert free.loads(angle, 0.0) == free.with_elements(free.elements[0]).loads(angle, 0.0)
    with pytest.raises(InvalidParameter, match='must be both, forward or backward'):
        replace(free.elements[1], when='down')


@pytest.mark.parametrize('gravity', [(9.81, 0.0), (0.0, -9.81)])
@pytest.mark.parametrize('length', [float('inf'), 0.06, 0.01])
def test_one_sided_extrema_of_a_press_have_the_kind_of_their_side(gravity, length):
    """A minimum 0.003 rad beyond a jump was taken for a rise at the jump."""
    linkage = press(gravity=gravity)
    linkage = linkage.with_friction({**dict(linkage.friction),
                                     'guide': JointFriction(0.1, length=length)})
    rate = 9.42477796
    for extremum in find_extrema(linkage, (), rate, conditions=False):
        assert extremum.proof == '', extremum
        if extremum.place != 'limit' or extremum.quantity not in linkage.LOADS._fields:
            continue
        x = extremum.theta1 + extremum.side * np.array([1e-8, 1e-6])
        near, far = getattr(linkage.loads(x, rate), extremum.quantity)
        assert near == pytest.approx(extremum.value, rel=1e-6, abs=1e-6)
        if abs(near - far) > 1e-9 * abs(near):
            assert bool(far < near) is (extremum.kind == 'maximum'), extremum


def test_a_mean_over_many_pieces_settles():
    """Of a magnitude near zero, between 60 points: 6e-5 off where each piece had 16 inputs."""
    rng = np.random.default_rng(3)
    values = rng.normal(size=60) * 100.0
    table = ForceTable([0.0, *np.sort(rng.uniform(0.1, 6.0, 58)), TURN],
                       [*values[:-1], values[0]], True)
    bodies = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.3, 1.0, 0.9)))
    mechanism = FourBar(0.3, 1.0, 0.9, 1.0, bodies=bodies).with_elements(
        PositionForce(Attachment('output', 0.2), table))
    ends = np.array([*mechanism.pieces.ends, mechanism.pieces.ends[0] + TURN])
    edges = np.unique(np.concatenate((ends, np.linspace(ends[0], ends[-1], 2000))))
    roots, weights = np.polynomial.legendre.leggauss(16)
    half = 0.5 * np.diff(edges)[:, None]
    x = edges[:-1, None] + half * (1.0 + roots)
    for name in ('f32', 'driving_torque'):
        load, over = getattr(mechanism.loads(x, 6.0), name), OverInput(mechanism, name, 6.0)
        assert over.mean == pytest.approx(np.sum(load * half * weights) / TURN, rel=1e-9,
                                          abs=1e-9 * over.rms)
        assert over.rms == pytest.approx(np.sqrt(np.sum(load**2 * half * weights) / TURN),
                                         rel=1e-10)
