# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A driven joint with a stroke: where it moves, what is extreme in it, what is refused."""
from dataclasses import replace
import math

from fourbar_ros import FourBar, InvalidParameter, MovingJointFourBar, OutOfRange, Toggle
from fourbar_ros.extrema.find import find_extrema, LIMIT
from fourbar_ros.extrema.over_input import dead_points, output_ranges, OverInput
from fourbar_ros.machine import Dyad, Machine, Point
from fourbar_ros.mechanisms.sliders import InvertedSlider, SliderCrank
from fourbar_ros.pipeline.stepper import evaluate, OK, OUT_OF_RANGE, RATES_UNKNOWN, Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support import contract

CYLINDER = {'linkage.kind': 'inverted_slider', 'linkage.input': 'slide', 'linkage.a1': 1.2,
            'linkage.a4': 1.6}
EPS = 2.0**-52
# its second dyad stops the crank
MACHINE = Machine([Dyad('one', 'RRR', Point('crank', 0.4), Point('ground', 1.0),
                        ('coupler', 'rocker'), length_1=1.2, length_2=0.8),
                   Dyad('two', 'RRR', Point('rocker', 0.8), Point('ground', 2.0),
                        ('rod', 'lever'), length_1=0.9, length_2=0.5)])


def mechanisms(seed, count):
    """Yield loaded mechanisms driven at their slide, each with a random stroke."""
    rng = np.random.default_rng(seed)
    for mechanism, _ in contract.ordinary_of(('slider_crank', 'inverted_slider'), seed, count,
                                             driven='slide'):
        low, high = mechanism.input_ranges[rng.integers(len(mechanism.input_ranges))]
        ends = low + (high - low) * np.sort(rng.uniform(0.03, 0.97, 2))
        yield mechanism, replace(mechanism, stroke=tuple(map(float, ends)))


def check_fields(mechanism, *given):
    """Yield (name, values) of all fields, which are the same if asked for by their names."""
    names = mechanism.MOTION._fields + mechanism.LOADS._fields
    for name, values, whole in zip(names, mechanism.step(*given, fields=names),
                                   sum(mechanism.step(*given), ())):
        assert np.array_equal(values, whole, equal_nan=True), name
        yield name, values


def test_outside_of_the_stroke_there_is_no_pose():
    for free, mechanism in mechanisms(401, 10):
        low, high = mechanism.stroke
        assert (mechanism.input_ranges == ((low, high),) and mechanism.closing_ranges
                == free.input_ranges)
        for position in (low, high, 0.5 * (low + high)):
            assert mechanism.motion(position, 1.0, 2.0) == free.motion(position, 1.0, 2.0)
            assert evaluate(mechanism, position, 1.0, 0.0, True)[0] == OK
            assert evaluate(mechanism, position, math.nan, 0.0, True)[0] == RATES_UNKNOWN
        for position in (math.nextafter(low, -math.inf), math.nextafter(high, math.inf),
                         low - 0.01, high + 0.01):
            with pytest.raises(OutOfRange):
                mechanism.motion(position, 1.0)
            for rate in (1.0, math.nan):
                assert evaluate(mechanism, position, rate, 0.0, True)[0] == OUT_OF_RANGE
        x = np.array([low - 0.1 * (high - low), low, 0.5 * (low + high), high,
                      high + 0.1 * (high - low)])
        for name, values in check_fields(mechanism, x, 1.0, 2.0):
            if name in mechanism.input_coordinate:
                assert np.isfinite(values).all(), name
            # one, zero, of a slider by its acceleration
            elif name not in ('slide_ratio', 'driving_torque', 'guide_couple'):
                assert np.isnan(values).tolist() == [True, False, False, False, True], name


@pytest.mark.parametrize('stroke, limits', [((0.0, 1.5), [0.4, 1.5]), ((1.0, 9.0), [1.0, 2.8]),
                                            ((-9.0, 9.0), None)])
def test_a_stroke_beyond_a_toggle_ends_there(stroke, limits):
    free = InvertedSlider(1.2, 1.6, input='slide')
    mechanism = InvertedSlider(1.2, 1.6, input='slide', stroke=stroke)
    expected = free.input_ranges if limits is None else (tuple(limits),)
    assert mechanism.input_ranges == tuple(tuple(pytest.approx(end, rel=4 * EPS) for end in pair)
                                           for pair in expected)
    ends = {e.slide: e.value for e in find_extrema(mechanism, ('omega1',), 1.0)
            if e.place == LIMIT}
    for slide, value in ends.items():
        is_toggle = slide not in stroke
        assert math.isinf(value) == is_toggle
        if is_toggle:
            with pytest.raises((Toggle, OutOfRange)):      # a rounded end may be outside
                mechanism.motion(slide)


def test_a_cylinder_is_never_searched_at_negative_length():
    linkage = scene.load('cylinder').linkage
    found = find_extrema(linkage, (), 0.2)
    assert found and all(1.0 <= e.slide <= 1.8 and math.isfinite(e.value) for e in found)


CRANKS = {
    'turns fully': FourBar(0.4, 1.2, 0.8, 1.0), 'two ranges': FourBar(1.2, 0.5, 0.8, 1.0),
    'through pi': FourBar(1.0, 0.5, 1.2, 0.5), 'at A': MovingJointFourBar(0.4, 1.2, 0.8, 1.0),
    'slider-crank': SliderCrank(0.4, 0.3, 0.05), 'bar': InvertedSlider(0.3, 0.4),
    'kite': FourBar(0.5, 1.0, 1.0, 0.5), 'parallelogram': FourBar(0.5, 1.0, 0.5, 1.0),
    'machine': scene.load('stephenson').linkage, 'machine that swings': MACHINE}
STROKES = ((0.0, 0.85), (-0.5, 0.6), (2.9, 4.1), (-3.3, -2.8), (19.0, 21.0), (-0.2, 6.0),
           (1.0, 9.0), (-9.0, 8.0))


@pytest.mark.parametrize('free', CRANKS.values(), ids=CRANKS)
def test_a_crank_moves_where_the_links_close_and_a_turn_of_the_stroke_is(free):
    """Inputs by brute force: those of the free mechanism whose turn has one in the stroke."""
    x = np.linspace(-16.0, 26.0, 4201) + 1e-4
    output = free.outputs[0].coordinate.position
    closes = np.isfinite(getattr(free.motion(x), output))
    for stroke in STROKES:
        turned = x + free.period * np.arange(-8, 9)[:, None]
        expected = closes & ((stroke[0] <= turned) & (turned <= stroke[1])).any(axis=0)
        if not expected.any():
            with pytest.raises(InvalidParameter, match='cannot close anywhere in it'):
                replace(free, stroke=stroke)
            continue
        mechanism = replace(free, stroke=stroke)
        assert np.array_equal(np.isfinite(getattr(mechanism.motion(x), output)), expected)
        assert all(mechanism.is_in_stroke(z) == any(
            stroke[0] <= z + free.period * turn <= stroke[1] for turn in range(-8, 9))
            for z in x[::97].tolist())
        inside = np.zeros(x.shape, bool)
        for low, high in mechanism.input_ranges:
            inside |= ((low <= turned) & (turned <= high)).any(axis=0)
            assert mechanism.turns_fully or stroke[1] - stroke[0] >= free.period or (
                stroke[0] <= low < high <= stroke[1])
        assert np.array_equal(inside, expected) or mechanism.turns_fully and closes.all()
        # evaluated one by one as in arrays; the same bits as without a stroke
        for z in x[::211].tolist():
            status, motion, _ = evaluate(mechanism, z, 1.0, 2.0, False)
            assert (status == OUT_OF_RANGE) == (not expected[np.searchsorted(x, z)])
            if status == OK:
                assert motion == free.motion(z, 1.0, 2.0)


@pytest.mark.parametrize('free', CRANKS.values(), ids=CRANKS)
def test_extrema_of_a_crank_are_those_within_its_stroke(free):
    """Beside samples of each range: h^2/8 of the second derivative between two samples."""
    quantity, count = free.outputs[0].coordinate.position, 20001
    for stroke in STROKES:
        try:
            mechanism = replace(free, stroke=stroke)
        except InvalidParameter:
            continue
        found = find_extrema(mechanism, (quantity, free.outputs[0].coordinate.rate), 1.0)
        for extremum in found:
            assert mechanism.is_in_stroke(extremum.input + 1e-12 * extremum.side) or any(
                abs(mechanism.distance(extremum.input, end)) < 1e-9 for end in mechanism.toggles)
        if not mechanism.cut:
            continue
        for low, high in mechanism.input_ranges:
            swept = min(output_ranges(mechanism), key=lambda swept: abs(swept.inputs[0] - low))
            assert swept.inputs == (low, high)
            x = low + (high - low) * (0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, count)))
            values = getattr(free.motion(x), quantity)
            values = np.unwrap(values[np.isfinite(values)])
            # at a toggle the root of the distance of the last sample is left out
            assert swept.width == pytest.approx(np.ptp(values),
                                                abs=1e-3 if mechanism.toggles else 1e-6)
        if not mechanism.toggles:
            over = OverInput(mechanism, quantity)
            rms, is_angle = over.rms, free.outputs[0].coordinate.unit == 'rad'
            means = []
            for low, high in mechanism.input_ranges:
                x = low + (high - low) * (np.arange(count) + 0.5) / count
                values = getattr(free.motion(x), quantity)
                if is_angle:        # continuous, as its extrema are
                    values = np.unwrap(values)
                    values += math.tau * np.round((over.least.value - values.min()) / math.tau)
                means.append(np.mean(np.square(values)))
            assert rms == pytest.approx(math.sqrt(np.average(means, weights=np.diff(
                mechanism.input_ranges, axis=1)[:, 0])), rel=1e-6, abs=1e-12)


def test_a_stroke_leaves_flat_positions_and_periods_as_they_are():
    """What lies flat outside the stroke is a branch all the same: the side is that without it."""
    kite = replace(CRANKS['kite'], stroke=(3.0, 4.0))
    assert (kite.flat_inputs, kite.period) == (CRANKS['kite'].flat_inputs, 4.0 * math.pi)
    assert kite.motion(3.5) == CRANKS['kite'].motion(3.5) and not kite.turns_fully
    # a turn before, the links are on the other side: no input of this stroke
    assert evaluate(kite, 3.5 - 2.0 * math.pi, 1.0, 0.0, False)[0] == OUT_OF_RANGE
    assert evaluate(kite, 3.5 - 4.0 * math.pi, 1.0, 0.0, False)[0] == OK
    assert 'flat at' not in replace(kite, stroke=(0.5, 1.0)).branch_in_words
    parallelogram = replace(CRANKS['parallelogram'], stroke=(0.2, 0.9))
    assert parallelogram.motion(0.5) == CRANKS['parallelogram'].motion(0.5)


def test_dead_points_beyond_the_stroke_are_left_out():
    free = CRANKS['turns fully']
    first, second = free.dead_points
    assert replace(free, stroke=(0.0, 0.85)).dead_points == (second,)
    assert replace(free, stroke=(0.5, 0.85)).dead_points == ()
    assert replace(free, stroke=(-3.0, 3.0)).dead_points == (first, second)


@pytest.mark.parametrize('beside', [-1e-5, -1e-12, 0.0, 1e-12, 1e-5])
def test_at_an_end_of_the_stroke_no_output_turns_back_of_kinds_and_machines_alike(beside):
    """It turns back inside alone: that of a kind at the very end was one, of a machine none."""
    free = CRANKS['turns fully']
    a1, a2, a3, a4 = free.lengths
    machine = Machine([Dyad('d', 'RRR', Point('crank', a1), Point('ground', a4),
                            ('coupler', 'output'), length_1=a2, length_2=a3, mode=free.mode)])
    for x, inward in zip((point.theta1 for point in free.dead_points), (1.0, -1.0)):
        end = x - inward * beside
        stroke = tuple(sorted((end, end + inward * 0.3)))
        both = [dead_points(replace(each, stroke=stroke)) for each in (free, machine)]
        assert [len(points) for points in both] == [int(beside > 1e-9)] * 2
        for one, other in zip(*both):
            assert other == pytest.approx(one[:2], abs=1e-7)


def test_clamped_inputs_stay_at_the_end_of_the_stroke():
    its = scene.from_values({**CYLINDER, 'linkage.range': [0.9, 1.5],
                             'drive.out_of_range': 'clamp'})
    place = its.layout.index_of['slide']
    for asked, expected in ((2.0, 1.5), (0.5, 0.9), (-1.0, 0.9)):
        status, values = Stepper(its).step(asked, 0.1, 0.0, Wanted())
        assert status == OUT_OF_RANGE and values[place] == expected
