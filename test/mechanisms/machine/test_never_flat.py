# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pairs with the lengths of a change point that lie flat nowhere in the range: no branches."""
from fourbar_ros import find_extrema, load_scene
import numpy as np
import pytest
from support import ROOT

EPS = 2.0**-52


@pytest.mark.parametrize('name', ['wiper', 'hart'])
def test_a_small_change_of_a_length_is_a_small_change_of_the_pose(name):
    """Exactly at the change point of its lengths, and a part in 1e7 beside it, in both senses."""
    machine = load_scene(ROOT / 'config/classics' / f'{name}.yaml').linkage
    assert any(stage.pair and not stage.pair.can_lie_flat for stage in machine.layout.stages)
    assert machine.flat_inputs == () and machine.change_point_margin > 0.0
    inputs = [low + part * (high - low) for low, high in machine.input_ranges
              for part in (0.13, 0.5, 0.8)]
    angles = [link.name for link in machine.LINKS]
    for i in range(len(machine.lengths)):
        for way in (-1e-7, 1e-7):
            lengths = list(machine.lengths)
            lengths[i] *= 1.0 + way
            other = machine.with_lengths(lengths)
            for x in inputs:
                one, two = machine.motion(x, 1.0), other.motion(x, 1.0)
                for link in angles:
                    apart = getattr(one, f'theta_{link}') - getattr(two, f'theta_{link}')
                    assert abs(np.remainder(apart + 1.0, 2.0 * np.pi) - 1.0) <= (
                        2.0 * 1e-7 * one.condition)


@pytest.mark.parametrize('quantity', ['omega_right_lever', 'alpha_right_lever'])
def test_conditions_are_those_of_differences(quantity):
    machine = load_scene(ROOT / 'config/classics/wiper.yaml').linkage
    extrema = [one for one in find_extrema(machine, quantity) if one.place == 'interior']
    assert extrema
    for one in extrema:
        change, step = 0.0, 1e-6
        for i in range(len(machine.lengths)):
            both = []
            for way in (-step, step):
                lengths = list(machine.lengths)
                lengths[i] *= 1.0 + way
                near = [other for other in find_extrema(machine.with_lengths(lengths), quantity)
                        if other.kind == one.kind and other.place == 'interior']
                both.append(min(near, key=lambda other: abs(machine.distance(
                    other.theta1, one.theta1))).value)
            change += abs(both[1] - both[0]) / (2.0 * step)
        assert one.value_condition == pytest.approx(change / abs(one.value), rel=1e-4)
