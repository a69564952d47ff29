# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A driven slide with a stroke: where it moves, what is extreme in it, what is refused."""
from dataclasses import replace
import math

from fourbar_ros import InvalidParameter, OutOfRange, Toggle
from fourbar_ros.extrema.find import find_extrema, LIMIT
from fourbar_ros.mechanisms.sliders import InvertedSlider, SliderCrank
from fourbar_ros.pipeline.stepper import evaluate, OK, OUT_OF_RANGE, RATES_UNKNOWN, Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support import contract

CYLINDER = {'linkage.kind': 'inverted_slider', 'linkage.input': 'slide', 'linkage.a1': 1.2,
            'linkage.a4': 1.6}
EPS = 2.0**-52


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


def test_only_a_driven_slide_has_a_stroke():
    with pytest.raises(InvalidParameter, match='only a driven slide'):
        SliderCrank(0.1, 0.3, stroke=(0.2, 0.4))


def test_clamped_inputs_stay_at_the_end_of_the_stroke():
    its = scene.from_values({**CYLINDER, 'linkage.range': [0.9, 1.5],
                             'drive.out_of_range': 'clamp'})
    place = its.layout.index_of['slide']
    for asked, expected in ((2.0, 1.5), (0.5, 0.9), (-1.0, 0.9)):
        status, values = Stepper(its).step(asked, 0.1, 0.0, Wanted())
        assert status == OUT_OF_RANGE and values[place] == expected
