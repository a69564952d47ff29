# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of slider-cranks and inverted slider-cranks, driven at crank or slide, against scans.

Limits, change points.
"""
from dataclasses import replace
from math import isfinite, isnan, pi

from fourbar_ros import Bodies, Body, FourBar, InvalidParameter, InvertedSlider, SliderCrank
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.extrema.input_paths import TooNarrow
from fourbar_ros.mechanisms.quantities import select
import numpy as np
import pytest
from support import contract
from support.scans import tops

EPS = 2.0**-52
KINDS = [(SliderCrank, 'crank'), (SliderCrank, 'slide'), (InvertedSlider, 'crank'),
         (InvertedSlider, 'slide')]


@pytest.mark.parametrize('kind, driven', KINDS)
@pytest.mark.parametrize('gap', [1e-3, 1e-6, 1e-9])
def test_near_change_points_against_a_scan_that_looks_there(kind, driven, gap):
    """The scan's steps shrink towards every place where the motion changes within sqrt(gap)."""
    rng = np.random.default_rng(9)
    for sign in (1.0, -1.0):
        mechanism = kind(0.3, 0.3 + 0.1 + sign * gap, 0.1, mode=2, input=driven,
                         bodies=contract.random_bodies(rng))
        quantities = [q for q in select((), mechanism) if not q.is_load]
        found = find_extrema(mechanism, quantities, 3.0)
        near = np.array([z.real for z in mechanism.singular_inputs])
        distances = 10.0**np.linspace(-9.0, 0.0, 6000)
        x = np.unique(np.concatenate([near[:, None] + s * distances for s in (-1.0, 1.0)],
                                     axis=None))
        for low, high in mechanism.input_ranges:
            inside = x[(x > low) & (x < high)]
            state = mechanism.motion(inside, 3.0), None
            for quantity in quantities:
                values = quantity.of(*state)
                for kind_of, i in tops(values, 1e-7 * np.abs(values[1:-1])):
                    away = [abs(mechanism.distance(inside[i], e.input)) for e in found
                            if (e.quantity, e.kind) == (quantity.name, kind_of)]
                    assert away and min(away) <= inside[i + 1] - inside[i - 1], (
                        mechanism, quantity.name, inside[i])


def test_piston_of_a_centric_slider_crank():
    """Its largest speeds are alike both ways; the largest acceleration: crank and rod in line."""
    mechanism = SliderCrank(0.06, 0.2)
    found = find_extrema(mechanism, ('slide_velocity', 'slide_acceleration'), 314.0)
    speeds = [e for e in found if e.quantity == 'slide_velocity']
    assert [e.kind for e in speeds] == ['minimum', 'maximum'] and isnan(speeds[0].slide)
    assert speeds[0].value == pytest.approx(-speeds[1].value, rel=16 * EPS)
    assert speeds[0].theta1 + speeds[1].theta1 == pytest.approx(2.0 * pi, rel=4 * EPS)
    outer = next(e for e in found if e.quantity == 'slide_acceleration' and e.kind == 'minimum'
                 and e.is_global)
    assert (outer.theta1, outer.value) == (0.0, pytest.approx(-0.06 * 314.0**2
                                                              * (1.0 + 0.06 / 0.2), rel=8 * EPS))


def test_a_slide_that_is_driven_has_a_place_and_a_crank_angle():
    mechanism = InvertedSlider(1.2, 1.6, 0.1, input='slide', mode=1)
    for extremum in find_extrema(mechanism, ('omega4', 'alpha1'), 0.2):
        assert mechanism.input_ranges[0][0] <= extremum.slide <= mechanism.input_ranges[-1][1]
        if extremum.place == 'interior':
            assert extremum.theta1 == mechanism.motion(extremum.slide).theta1 % (2.0 * pi)
        else:
            assert abs(np.sin(extremum.theta1)) < 1e-7


def test_near_a_change_point_the_ends_of_an_inverted_slider_are_unbounded():
    """Short ranges beside long inputs: samples are placed from the nearer end."""
    rng = np.random.default_rng(1)
    for gap in (1e-3, 1e-5, 1e-7, 1e-9):
        for h in 10.0**rng.uniform(-3.5, -2.0, 20):
            found = find_extrema(InvertedSlider(0.5 + h - gap * h, 0.5, h),
                                 ('slide_velocity', 'alpha4'), 2.0, -60.0)
            assert not any(isnan(e.value) or e.place == 'limit' and isfinite(e.value)
                           for e in found)


def test_what_floats_cannot_hold_is_refused():
    with pytest.raises(InvalidParameter, match='overflow'):
        find_extrema(InvertedSlider(0.2, 0.5, 0.04, input='slide'), (), 1.0, 1e300)
    with pytest.raises(TooNarrow):
        find_extrema(SliderCrank(1.0, 1e-10), (), 1.0)


@pytest.mark.parametrize('mechanism, rate, count', [
    (SliderCrank(0.9, 2.1, 0.2, mode=1, input='slide'), 4.5e-4, 6),
    (SliderCrank(0.1, 0.3, 0.25), 1e-4, 3),
    (FourBar(4.0, 3.0, 2.0, 8.0), 10.0**-4.4, 3), (FourBar(4.0, 3.0, 2.0, 8.0), 1e-5, 3)])
def test_pairs_next_to_a_toggle_are_found(mechanism, rate, count):
    """Velocity and acceleration terms of a reaction cancel there; counts are proved."""
    bodies = Bodies(Body(1.0, cg_along=0.05, inertia=0.01), Body(1.0, cg_along=0.15, inertia=0.01),
                    Body(1.0, inertia=0.01))
    found = find_extrema(replace(mechanism, bodies=bodies), ('f41',), rate, 1.3 if count == 6
                         else 1.0)
    assert sum(e.place == 'interior' for e in found) == count


def test_the_condition_of_a_place_is_in_metres_where_a_slide_is_driven():
    """Lengths a thousandfold, by a power of two: places and their conditions are so too."""
    small = SliderCrank(0.5, 1.3, 0.1, input='slide')
    large = small.with_lengths([1024.0 * length for length in small.lengths])
    quantities = ('omega1', 'alpha1', 'omega_beta')
    found, scaled = (find_extrema(linkage, quantities, rate)
                     for linkage, rate in ((small, 1.0), (large, 1024.0)))
    inside = [(one, other) for one, other in zip(found, scaled) if one.place == 'interior']
    assert len(found) == len(scaled) and len(inside) > 1
    for one, other in inside:
        assert other.slide == pytest.approx(1024.0 * one.slide, rel=1e-9)
        assert other.value == pytest.approx(one.value, rel=1e-9)
        assert other.condition == pytest.approx(1024.0 * one.condition, rel=1e-3)
        assert other.value_condition == pytest.approx(one.value_condition, rel=1e-3)
