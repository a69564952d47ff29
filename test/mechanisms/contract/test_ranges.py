# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ranges of the input and their limits."""
from math import pi

from fourbar_ros import OutOfRange, Toggle
import numpy as np
import pytest
from support import contract
from support.contract import every_mechanism
from support.samples import more


def in_any_turn(mechanism, ranges):
    """Return ranges of the input, those of angles also a turn before and after."""
    turns = (0.0,) if mechanism.is_driven_by_slide else (-2.0 * pi, 0.0, 2.0 * pi)
    return [(low + turn, high + turn) for low, high in ranges for turn in turns]


@every_mechanism
def test_ranges_are_where_it_closes(case, points=more(2000, 20000)):
    """Inside of the ranges arrays have numbers, outside NaN; single values are refused."""
    rng, seen = np.random.default_rng(218), 0
    for mechanism in contract.drawn(case, 218, more(20, 60)):
        is_slide = mechanism.is_driven_by_slide
        low, high = mechanism.closing_ranges[0][0], mechanism.closing_ranges[-1][1]
        x = (rng.uniform(1.5 * low - 0.5 * high, 1.5 * high - 0.5 * low, points) if is_slide
             else rng.uniform(-pi, pi, points))
        ranges = in_any_turn(mechanism, mechanism.input_ranges)
        if not mechanism.turns_fully:
            x = x[np.abs(x[:, None] - np.ravel(ranges)).min(axis=1) > 1e-9 * np.ptp(x)]
        inside = np.any([(low <= x) & (x <= high) for low, high in ranges], axis=0)
        motion, loads = mechanism.step(x, 0.1)
        names = {name for c in contract.coordinates(mechanism) for name in c} - set(
            mechanism.input_coordinate)
        known = np.isfinite([*(getattr(motion, name) for name in names), loads.shaking_moment,
                             motion.condition])
        np.testing.assert_array_equal(known.all(axis=0), inside)
        if case != contract.MACHINES:       # else those before the one that does not close
            np.testing.assert_array_equal(known.any(axis=0), inside)
        for value in x[~inside][:5].tolist():
            seen += 1
            with pytest.raises(OutOfRange) as caught:
                mechanism.motion(value)
            assert caught.value.ranges == mechanism.input_ranges and caught.value.value == value
        low, high = mechanism.input_ranges[0]
        assert low < high and mechanism.turns_fully == (not is_slide and (low, high) == (-pi, pi))
    assert seen > 20 or case != contract.MACHINES and case.turns


@every_mechanism
def test_limits_are_singular(case):
    """Next to the ends of a range the sine falls as the root of the distance."""
    ends = 0
    for mechanism in contract.drawn(case, 219, 60):
        if mechanism.turns_fully or mechanism.change_point_margin < 1e-3:
            continue
        singular = np.array(mechanism.singular_inputs)
        span = min(high - low for low, high in mechanism.closing_ranges)
        limits = [(end, side) for bounds in mechanism.closing_ranges
                  for end, side in zip(bounds, (1.0, -1.0)) if mechanism.is_in_stroke(end)]
        ends += len(limits)
        for end, inward in limits:
            for share in (1e-4, 1e-8, 1e-12):
                motion = mechanism.motion(end + inward * share * span)
                assert abs(mechanism.transmission_sine(motion)) <= 100.0 * share**0.5
                outside = end - inward * share * span
                # at a pole the next range begins
                if not any(low < outside < high for low, high in
                           in_any_turn(mechanism, mechanism.closing_ranges)):
                    with pytest.raises((OutOfRange, Toggle)):
                        mechanism.motion(outside)
            assert min(abs(mechanism.distance(z.real, end)) + abs(z.imag)
                       for z in singular) <= 1e-7 * span
    assert ends >= 30 or case != contract.MACHINES and case.turns
