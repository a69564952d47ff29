# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema over a part of the input, as that of a robot's joint: against dense samples of it."""
from dataclasses import replace
from math import inf, pi

from fourbar_ros import find_extrema, FourBar, InvalidParameter, load_scene, SliderCrank
import numpy as np
import pytest

EPS = 2.0**-52
POINTS = 4001


def extremes(linkage, name, low, high, rate):
    """Return least and largest of samples of a part of the input."""
    state = [*linkage.motion_and_loads(np.linspace(low, high, POINTS), rate)]
    values = np.asarray(getattr(state[0], name, None) if hasattr(state[0], name)
                        else getattr(state[1], name))
    values = values[~np.isnan(values)]
    return values.min(), values.max()


@pytest.mark.parametrize('scene, low, high', [
    ('bucket', 0.9, 1.5), ('paper', -0.5, 0.7), ('paper', 5.5, 6.8), ('paper', 1.0, 1.2),
    ('quick_return', 3.0, 3.0 + 2.0 * pi), ('slider_crank', -7.0, -5.0), ('engine', 0.2, 4.0)])
def test_extrema_of_a_part_of_the_input_are_those_of_its_samples(scene, low, high):
    linkage = load_scene(scene).linkage
    unit = linkage.input_unit
    low, high = low * unit, high * unit
    if linkage.is_driven_by_slide:
        (begin, end), = linkage.input_ranges
        low, high = begin + 0.2 * (end - begin), begin + 0.6 * (end - begin)
    found = find_extrema(linkage, (), 3.0, within=(low, high), conditions=False)
    step = (high - low) / (POINTS - 1)
    for name in {e.quantity for e in found}:
        mine = [e for e in found if e.quantity == name]
        least, largest = extremes(linkage, name, low, high, 3.0)
        size = max(abs(least), abs(largest))
        slack = 64.0 * step**2 / unit**2 * size + 1e-9 * size      # between two samples
        if any(e.kind == 'constant' for e in mine):
            assert len(mine) == 1 and largest - least <= 1e-9 * size
            continue
        bottom, top = min(e.value for e in mine), max(e.value for e in mine)
        kink = 8.0 * step / unit * size      # of the size of a force, near zero
        kink = kink if bottom <= kink else 0.0
        assert bottom - 1e-9 * size <= least <= bottom + slack + kink, name
        assert top - slack <= largest <= top + 1e-9 * size, name
        assert {e.value for e in mine if e.is_global} >= {bottom, top}
        ends = sorted((e.side for e in mine if e.place == 'limit'), reverse=True)
        assert ends == [1, -1], name
        # maxima and minima take turns from end to end
        way = sorted(mine, key=lambda e: ((e.input - low + 1e-9) % (2.0 * pi)
                                          if not linkage.is_driven_by_slide else e.input))
        assert all(a.kind != b.kind for a, b in zip(way, way[1:])), name


def test_the_largest_torque_of_a_part_is_at_its_end_and_no_toggle_is_met():
    rocker = FourBar(4.0, 2.0, 3.0, 5.5)
    (low, high), = rocker.input_ranges
    assert inf in [e.value for e in find_extrema(rocker, 'alpha4', 1.0)]
    found = find_extrema(rocker, 'alpha4', 1.0, within=(low + 0.1, high + 1.0))
    ends = {e.side: e for e in found if e.place == 'limit'}
    assert abs(ends[-1].value) == inf and ends[-1].theta1 == pytest.approx(high % (2.0 * pi))
    assert ends[1].value == pytest.approx(rocker.motion(low + 0.1, 1.0).alpha4, rel=64.0 * EPS)
    turned = find_extrema(rocker, 'alpha4', 1.0, within=(low + 0.1 + 2.0 * pi,
                                                         low + 0.2 + 2.0 * pi))
    assert [e.place for e in turned] == ['limit', 'limit'] and max(
        e.value for e in turned) < inf


def test_angles_at_ends_are_in_the_turn_of_the_others():
    crank = FourBar(2.0, 4.0, 3.5, 1.0)       # both turn: theta4 goes through pi
    found = find_extrema(crank, 'theta4', within=(-3.0, 3.0))
    assert [e.place for e in found] == ['limit', 'limit']
    assert max(e.value for e in found) - min(e.value for e in found) == pytest.approx(
        np.ptp(np.unwrap(crank.motion(np.linspace(-3.0, 3.0, POINTS)).theta4)), rel=1e-9)


def test_a_proof_holds_for_a_part_of_the_input():
    found = find_extrema(load_scene('paper').linkage, ('omega4', 'f32'), 3.0, certify=True,
                         within=(-0.5, 0.7))
    assert {e.proof.split(',')[0] for e in found} == {'interval bounds'}


@pytest.mark.parametrize('within, said', [
    ((1.0, 1.0), 'lower one first'), ((2.0, 1.0), 'lower one first'), (3.0, 'two finite inputs'),
    ((0.0, float('nan')), 'two finite inputs'), ((1.0, 2.0, 3.0), 'two finite inputs'),
    ((0.0, 7.0), 'a turn at most')])
def test_no_such_part_is_refused(within, said):
    with pytest.raises(InvalidParameter, match=f'^within = .*{said}'):
        find_extrema(FourBar(0.4, 1.2, 0.8, 1.0), within=within)


def test_a_part_in_which_nothing_closes_is_refused_with_the_ranges():
    with pytest.raises(InvalidParameter, match=r'^within = \(3.0, 3.2\): .*none of these .* rad'):
        find_extrema(FourBar(4.0, 2.0, 3.0, 5.5), within=(3.0, 3.2))
    with pytest.raises(InvalidParameter, match=r'^within = .*none of these .* m$'):
        find_extrema(SliderCrank(0.05, 0.2, input='slide'), within=(0.3, 0.4))
    with pytest.raises(InvalidParameter, match=r'^within = .*none of these .* m$'):
        find_extrema(SliderCrank(0.05, 0.2, input='slide', stroke=(0.16, 0.18)),
                     within=(0.19, 0.2))


@pytest.mark.parametrize('scene, stroke', [
    ('paper', (0.0, 0.85)), ('paper', (5.5, 6.8)), ('pumpjack', (0.2, 4.0)),
    ('stephenson', (-0.5, 0.7)), ('quick_return', (20.0, 21.0)), ('slider_crank', (-7.0, -5.0)),
    ('parallelogram', (-0.5, 0.6))])
def test_a_range_of_the_crank_has_the_extrema_of_that_part_and_their_proofs(scene, stroke):
    free = load_scene(scene).linkage
    linkage = replace(free, stroke=stroke)
    names = (free.outputs[0].coordinate.acceleration, 'shaking_force')
    expected = repr(find_extrema(free, names, 3.0, within=stroke))       # NaN is NaN
    assert repr(find_extrema(linkage, names, 3.0)) == expected
    assert repr(find_extrema(linkage, names, 3.0, within=stroke)) == expected
    low, high = stroke
    part = low + 0.3 * (high - low), high + 0.7      # beyond its end
    assert repr(find_extrema(linkage, names, 3.0, within=part)) == repr(find_extrema(
        free, names, 3.0, within=(part[0], high)))
    if scene == 'paper':
        proved = find_extrema(linkage, names, 3.0, certify=True, conditions=False)
        assert all(e.proof.startswith('interval') for e in proved)
