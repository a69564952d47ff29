# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ranges of the input and their limits."""

from math import pi

from fourbar_ros import OutOfRange, Toggle
import numpy as np
import pytest
from support import contract
from support.contract import every_case


@every_case
def test_ranges_are_where_it_closes(case):
    """Inside of the ranges arrays have numbers, outside NaN; single values are refused."""
    rng, seen = np.random.default_rng(218), 0
    for _ in range(20):
        lengths, _ = contract.draw(rng, case)
        mechanism = case.make(lengths, contract.random_masses(rng, case, 1.0, 1.0))
        reach = pi if case.turns else 1.5 * sum(map(abs, lengths))
        x = rng.uniform(-reach, reach, 400)
        turns = (-2.0 * pi, 0.0, 2.0 * pi) if case.turns else (0.0,)
        ends = np.array(
            [end + turn for bounds in mechanism.input_ranges for end in bounds for turn in turns]
        )
        if not mechanism.turns_fully:
            x = x[np.abs(x[:, None] - ends).min(axis=1) > 1e-9 * reach]
        inside = np.zeros(x.shape, bool)
        for low, high in mechanism.input_ranges:
            assert low < high
            for turn in turns:
                inside |= (low + turn <= x) & (x <= high + turn)
        motion, loads = mechanism.step(x, 0.1)
        coordinates = {name for c in contract.coordinates(case.kind) for name in c} - set(
            mechanism.input_coordinate
        )
        for field in (
            *(getattr(motion, name) for name in coordinates),
            loads.shaking_moment,
            motion.condition,
        ):
            np.testing.assert_array_equal(np.isfinite(field), inside)
        for value in x[~inside][:5].tolist():
            seen += 1
            with pytest.raises(OutOfRange) as caught:
                mechanism.motion(value)
            assert caught.value.ranges == mechanism.input_ranges and caught.value.value == value
        low, high = mechanism.input_ranges[0]
        assert mechanism.turns_fully == (case.turns and (low, high) == (-pi, pi))
    if not case.turns:
        assert seen > 50


@every_case
def test_limits_are_singular(case):
    """Next to the ends of a range the sine falls as the root of the distance."""
    rng, ends = np.random.default_rng(219), 0
    for _ in range(40):
        lengths, _ = contract.draw(rng, case)
        mechanism = case.make(lengths)
        if mechanism.turns_fully or mechanism.change_point_margin < 1e-3:
            continue
        singular = np.array(mechanism.singular_inputs)
        for low, high in mechanism.input_ranges:
            for end, inward in ((low, 1.0), (high, -1.0)):
                ends += 1
                for share in (1e-4, 1e-8, 1e-12):
                    distance = share * (high - low)
                    motion = mechanism.motion(end + inward * distance)
                    assert np.sin(motion.transmission_angle) <= 100.0 * share**0.5
                    with pytest.raises((OutOfRange, Toggle)):
                        mechanism.motion(end - inward * distance)
                assert min(
                    abs(mechanism.distance(z.real, end)) + abs(z.imag) for z in singular
                ) <= 1e-7 * (high - low)
    if not case.turns:
        assert ends > 40
