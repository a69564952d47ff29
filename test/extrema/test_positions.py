# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema of positions against dead points and limits in closed form."""
from math import pi

from fourbar_ros import find_extrema, FourBar, InvertedSlider, SliderCrank
from fourbar_ros.mechanisms.quantities import positions, select
import numpy as np
import pytest

EPS = 2.0**-52
CRANK_ROCKERS = ((0.4, 1.2, 0.8, 1.0), (2.0, 6.0, 7.0, 5.0), (0.2, 0.5, 1.4, 1.2))


def values(extrema, *kinds):
    return [e.value for e in extrema if e.kind in kinds]


def interior(extrema):
    return [e for e in extrema if e.place == 'interior']


@pytest.mark.parametrize('mode', [1, 2])
@pytest.mark.parametrize('lengths', CRANK_ROCKERS)
def test_theta4_of_a_crank_rocker_turns_back_at_its_dead_points(lengths, mode):
    linkage = FourBar(*lengths, mode=mode)
    found = find_extrema(linkage, 'theta4')
    assert [e.unit for e in found] == ['rad', 'rad'] and all(e.is_global for e in found)
    expected = sorted(point.theta4 for point in linkage.dead_points)
    for extremum, theta4 in zip(sorted(found, key=lambda e: e.value), expected):
        tolerance = 8 * EPS * (1 + extremum.value_condition) * abs(theta4)
        assert abs(np.angle(np.exp(1j * (extremum.value - theta4)))) <= tolerance


def test_an_angle_that_swings_through_180_degrees_has_no_jump():
    """The least value is in [-pi, pi), the largest may be beyond, as for ranges."""
    linkage = FourBar(4.0, 2.0, 3.0, 5.5, mode=1)
    (low, high), = linkage.output_ranges
    assert high > pi
    found = find_extrema(linkage, 'theta4', certify=True)
    largest = max(values(found, 'maximum'))
    # the middle of what it sweeps in this mode is beyond half a turn: it counts below zero
    assert largest == pytest.approx(high - 2.0 * pi, rel=1e-14)
    assert min(values(found, 'minimum')) > low - 2.0 * pi
    inverted = find_extrema(InvertedSlider(0.3, 1.0, 0.1), 'theta4')
    points = InvertedSlider(0.3, 1.0, 0.1).dead_points
    assert sorted(values(inverted, 'minimum', 'maximum')) == pytest.approx(
        sorted(point.theta4 % (2.0 * pi) for point in points), rel=1e-14)


@pytest.mark.parametrize('mode', [1, 2])
def test_the_output_of_a_double_crank_has_no_extremum_where_its_angle_is_folded(mode):
    assert find_extrema(FourBar(1.0, 0.9, 1.1, 0.4, mode=mode), 'theta4', certify=True) == []


@pytest.mark.parametrize('lengths', [*CRANK_ROCKERS, (1.2, 0.5, 0.8, 1.0), (4.0, 2.0, 3.0, 5.5)])
def test_the_transmission_angle_is_extreme_in_line_with_the_ground_or_at_toggles(lengths):
    a1, a2, a3, a4 = lengths
    linkage = FourBar(*lengths)
    for extremum in find_extrema(linkage, 'transmission_angle'):
        if extremum.place == 'limit':
            assert min(abs(extremum.value), abs(extremum.value - pi)) <= 64 * EPS
        else:
            diagonal = abs(a1 - a4) if abs(extremum.theta1) < 1.0 else a1 + a4
            cosine = (a2 * a2 + a3 * a3 - diagonal**2) / (2.0 * a2 * a3)
            assert np.cos(extremum.value) == pytest.approx(cosine, abs=1e-14)


@pytest.mark.parametrize('offset', [0.0, 0.1, -0.1])
@pytest.mark.parametrize('mode', [1, 2])
def test_the_slide_turns_back_at_its_dead_points(offset, mode):
    mechanism = SliderCrank(0.3, 1.0, offset, mode=mode)
    found = find_extrema(mechanism, 'slide')
    assert (sorted(e.value for e in found)
            == pytest.approx(sorted(p.slide for p in mechanism.dead_points), rel=1e-14))
    assert {e.unit for e in found} == {'m'}


@pytest.mark.parametrize('kind', [SliderCrank, InvertedSlider])
def test_the_crank_of_a_driven_slide_reaches_its_ends(kind):
    mechanism = kind(0.3, 1.0, 0.1, input='slide')
    found = find_extrema(mechanism, 'theta1')
    for extremum in found:
        inside = extremum.slide - extremum.side * -1e-9
        assert np.isfinite(extremum.value)
        turn = extremum.value - mechanism.motion(inside).theta1
        assert abs(turn - 2.0 * pi * round(turn / (2.0 * pi))) < 1e-3
    assert sum(e.place == 'limit' for e in found) == 2 * len(mechanism.input_ranges)


def test_a_link_that_stands_still_is_constant_on_the_branch_of_its_motion():
    """B stays in O1, all the turn; in the other mode it goes once round a circle."""
    still, = find_extrema(FourBar(1.0, 1.0, 2.0, 2.0, mode=1), 'theta4')
    assert (still.kind, still.value) == ('constant', pi)
    assert [e.kind for e in find_extrema(FourBar(1.0, 1.0, 2.0, 2.0), 'theta4')] == [
        'minimum', 'maximum']


@pytest.mark.parametrize('mechanism', [FourBar(*CRANK_ROCKERS[0]), SliderCrank(0.3, 1.0, 0.1),
                                       SliderCrank(0.3, 1.0, 0.1, input='slide')])
def test_positions_are_asked_for_by_name_alone(mechanism):
    known = positions(mechanism, mechanism.input)
    assert known and not known.keys() & {q.name for q in select((), mechanism)}
    assert mechanism.input_coordinate.position not in known
    assert {e.quantity for e in find_extrema(mechanism, list(known))} <= set(known)
