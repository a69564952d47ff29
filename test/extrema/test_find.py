# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema: published values, completeness, ends, change points, user quantities."""
from itertools import pairwise
from math import inf, isinf, pi

from fourbar_ros import FourBar, InvalidParameter, InvertedSlider, MissingBodies, SliderCrank
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.extrema.input_paths import TooNarrow
from fourbar_ros.mechanisms.quantities import known_quantities, Quantity, select, UnknownQuantity
import mpmath
import numpy as np
import pytest
from support import contract
from support.contract import with_rods
from support.extrema_reference import exact_roots
from support.samples import more

EPS = 2.0**-52
PAPER = (0.4, 1.2, 0.8, 1.0)
RATES = ('omega4', 'alpha4')
QUANTITIES = known_quantities(FourBar)


def angle_between(a, b):
    """Return the distance of two angles, floats or mpmath numbers, without loss [rad]."""
    return abs(float((mpmath.mpf(a) - b + mpmath.pi) % (2 * mpmath.pi) - mpmath.pi))


def of(extrema, quantity, place='interior'):
    return [e for e in extrema if e.quantity == quantity and e.place == place]


# --- published values ----------------------------------------------------------------------------

@pytest.mark.parametrize('quantity, theta1, value', [
    ('shaking_force', 0.10962848, 2512.318373), ('shaking_moment', 0.21995444, 2048.609105),
    ('driving_torque', 6.21476980, 720.4715562), ('f41', 0.11551325, 3862.925021),
    ('f21', 0.11396259, 3747.46146),
    ('f32', 0.13068520, 2788.891825), ('f43', 0.15042420, 2655.173464),
    ('omega4', 5.91384994, 23.95938172), ('alpha4', 0.14825570, 1062.775829),
    ('omega4', 1.66716501, 13.51343678), ('alpha4', 5.44494403, 462.6986573)])
def test_papers_linkage_as_found_by_eight_multibody_engines(quantity, theta1, value):
    extremum = min(find_extrema(with_rods(PAPER), (quantity,), 25.0),
                   key=lambda e: angle_between(e.theta1, theta1))
    assert extremum.theta1 == pytest.approx(theta1, abs=1e-8)
    assert abs(extremum.value) == pytest.approx(value, rel=3e-10)
    assert extremum.is_global


# --- complete and accurate: exact roots ----------------------------------------------------------

def slope_of_slope(linkage, quantity, theta1):
    """Return the second derivative of a quantity by theta1, a difference of complex steps."""
    h = 1e-5
    at = np.array([theta1 - h, theta1 + h]) + 1e-200j
    before, after = linkage.motion(at, 1.0, 0.0, fields=(quantity,))[0].imag / 1e-200
    return (after - before) / (2.0 * h)


def counts(lengths):
    return [len(exact_roots(lengths, order)) for order in (0, 1)]


def check_against_exact_roots(lengths):
    """
    Compare both modes with the exact extrema: number, place and value.

    An error of eps in each length moves them by eps times their condition, and one of eps in the
    slope, whose terms are of size one, by eps over its own slope: that is the tolerance, with a
    factor 5 and the rounding of theta1 itself.
    """
    linkage = FourBar(*lengths)
    found = find_extrema(linkage, RATES)
    mirrored = find_extrema(linkage.in_mode(1), RATES)
    exact = [exact_roots(lengths, order) for order in (0, 1)]
    for order, (quantity, roots) in enumerate(zip(RATES, exact)):
        for extrema, sense in ((found, 1), (mirrored, -1)):
            extrema = of(extrema, quantity)
            assert len(extrema) == len(roots), (lengths, quantity)
            for theta1, value in roots:
                extremum = min(extrema, key=lambda e: angle_between(e.theta1, sense * theta1))
                bend = abs(slope_of_slope(linkage, quantity, float(theta1)))
                assert angle_between(extremum.theta1, sense * theta1) <= 5 * EPS * (
                    extremum.condition + 2 * pi + 1.0 / bend)
                value *= sense if order else 1
                assert abs(extremum.value
                           - value) <= 5 * EPS * (1 + extremum.value_condition) * abs(value)


CRANK = next(case for case in contract.CASES if case.kind is FourBar)
FAMILIES = ('random', 'near a change point', 'link ratios 1e8', 'ground like the crank',
            'crank clears a toggle', 'near a parallelogram or kite')


@pytest.mark.parametrize('family', FAMILIES)
def test_rates_complete_and_accurate(family, count=more(6, 80)):
    rng = np.random.default_rng(20240607)
    while count:
        lengths, _ = contract.draw(rng, CRANK, family)
        if FourBar(*lengths).change_point_margin > 1e-12 and lengths[0] != lengths[3]:
            try:
                check_against_exact_roots(lengths)
            except TooNarrow:           # a crank that hardly moves
                continue
            count -= 1


# Pairs of extrema that lie between two samples: found by a closer look (theta4''), or as
# neighbours of one of theta4'' (theta4').
PAIRS = ((0.35082668713088083, 0.8833869937245226, 0.830033957902283, 0.9114534728718168),
         (0.9901282012759378, 0.20704846913484642, 0.5637244933385037, 0.5631644614516844),
         (0.4051177427743674, 0.9265869837965962, 0.7664512540213785, 0.4051175759722894),
         (0.3787188125609142, 0.6804980652079842, 0.9270018374007172, 0.13355054582644563),
         (0.24574758184156711, 0.6043064948019666, 0.3698000551027406, 0.4802515640649747),
         (0.22851565188429057, 0.5763949780865559, 0.3458702482096835, 0.45904038153264737),
         (0.8663781758205888, 0.919809284743642, 0.8662075087468867, 0.919704112350192),
         (0.9304064393739676, 0.24801284354697234, 0.24801280681643997, 0.9304064759114511),
         (0.01338704064945158, 0.0041935225790094505, 0.004091334475588157, 0.00852234879367406),
         (0.47900834998424047, 0.40130252953068113, 0.9959129707501232, 0.4338823980363524),
         (0.25736556082896844, 0.7081712112052203, 0.24281566405515323, 0.865200245113719),
         (0.7727648313589902, 0.8968974919029313, 0.1295008885091064, 1.5414564436379061))
# 4e-6 rad apart: their values differ by less than rounding
NO_PAIR = (0.33347728175225105, 0.6969206825479008, 0.18767077702167043, 0.38067765105762674)


# a few roundings away from a change point, more than those of decimals
NEAR_CHANGE_POINTS = [
    tuple(length + way * 8.0 * EPS * sum(lengths) if k == i else length
          for k, length in enumerate(lengths))
    for lengths in ((1.0, 2.0, 2.5, 3.5), (2.0, 4.0, 3.0, 5.0), (3.0, 2.0, 5.0, 4.0),
                    (5.0, 2.0, 4.0, 3.0)) for i in range(4) for way in (-1.0, 1.0)]


@pytest.mark.parametrize('lengths', NEAR_CHANGE_POINTS)
def test_all_are_found_next_to_change_points(lengths):
    found = find_extrema(FourBar(*lengths), RATES)
    assert [len(of(found, quantity)) for quantity in RATES] == counts(lengths)


@pytest.mark.parametrize('lengths', PAIRS)
def test_close_pairs_are_found(lengths):
    found = find_extrema(FourBar(*lengths), RATES)
    assert [len(of(found, quantity)) for quantity in RATES] == counts(lengths)


def test_a_pair_whose_values_rounding_cannot_tell_apart_is_none():
    values = sorted(value for _, value in exact_roots(NO_PAIR, 1))
    assert len(values) == 3
    assert min(high - low for low, high in pairwise(values)) < EPS * abs(values[0])
    assert len(of(find_extrema(FourBar(*NO_PAIR), 'alpha4'), 'alpha4')) == 1


@pytest.mark.parametrize('unit', [1e-200, 1e-9, 1e9, 1e100])
@pytest.mark.parametrize('one', [
    FourBar(*PAPER), *(kind(0.3, 0.8, 0.1, input=driven) for kind in (SliderCrank, InvertedSlider)
                       for driven in ('crank', 'slide'))])
def test_unit_of_length_does_not_matter(one, unit):
    quantities = [q.name for q in select((), one) if q.unit.startswith('rad')]
    other = one.with_lengths([length * unit for length in one.lengths])
    scale = unit if one.is_driven_by_slide else 1.0
    pairs = zip(find_extrema(one, quantities, 1.0), find_extrema(other, quantities, scale),
                strict=True)
    for a, b in pairs:
        assert (a.quantity, a.kind, a.place) == (b.quantity, b.kind, b.place)
        assert a.value == pytest.approx(b.value, rel=256 * EPS)
        assert abs(one.distance(a.input, b.input / scale)) <= 256 * EPS


# --- ends of the input range, change points ------------------------------------------------------

@pytest.mark.parametrize('mechanism', [
    *(with_rods(lengths) for lengths in ((4.0, 2.0, 3.0, 5.5), (1.2, 0.5, 0.8, 1.0),
                                         (3.0, 2.0, 4.0, 3.5), (1.0, 0.8, 0.9, 2.2),
                                         (2.0, 0.6, 1.7, 2.1))),
    SliderCrank(0.1, 0.3, 0.05, input='slide'), SliderCrank(0.1, 0.3, 0.25),
    SliderCrank(0.3, 0.1, 0.05), InvertedSlider(0.3, 0.35, 0.1, input='slide'),
    InvertedSlider(0.3, 0.35, 0.1)])
@pytest.mark.parametrize('mode', [1, 2])
@pytest.mark.parametrize('rate', [3.0, -3.0])
def test_ends_of_the_input_range_are_unbounded_with_their_sign(mechanism, mode, rate):
    mechanism = mechanism.in_mode(mode)
    found = find_extrema(mechanism, (), rate)
    ends = [(low, high, side) for low, high in mechanism.input_ranges for side in (1, -1)]
    for quantity in [q for q in select((), mechanism) if mechanism.bodies
                     or not q.is_load]:
        limits = of(found, quantity.name, 'limit')
        assert len(limits) == len(ends)
        for low, high, side in ends:
            end = low if side == 1 else high
            limit = min((e for e in limits if e.side == side),
                        key=lambda e: abs(mechanism.distance(e.input, end)))
            assert abs(mechanism.distance(limit.input, end)) < 64 * EPS
            near = end + side * 1e-9 * (high - low)
            near = quantity.of(*(mechanism.step(near, rate) if mechanism.bodies else
                                 (mechanism.motion(near, rate), None)))
            if isinf(limit.value):
                assert limit.value == (inf if near > 0.0 else -inf) and abs(near) > 1e3
                assert limit.kind == ('maximum' if near > 0.0 else 'minimum')
            else:
                assert type(mechanism) is not FourBar
                assert near == pytest.approx(limit.value, rel=1e-3, abs=1e-3)
        for kind, infinite in (('maximum', inf), ('minimum', -inf)):
            if any(e.value == infinite for e in limits):
                assert all(isinf(e.value) for e in found
                           if e.quantity == quantity.name and e.kind == kind and e.is_global)


def test_nothing_moves_nothing_varies():
    found = find_extrema(with_rods(PAPER), (), 0.0)
    assert all(e.kind == 'constant' and e.value == 0.0 and e.is_global for e in found)
    assert len(found) == len(QUANTITIES)


# --- user quantities, wrong input ----------------------------------------------------------------

def test_function_with_abs_has_its_kinks_as_minima():
    linkage = with_rods(PAPER)
    torque = find_extrema(linkage, ('driving_torque',), 25.0)
    found = find_extrema(linkage, lambda motion, loads: abs(loads.driving_torque), 25.0)
    kinks = [e for e in found if e.kind == 'minimum']
    assert len(kinks) == len(torque) == 4
    assert max(e.value for e in kinks) < 1e-9 * max(e.value for e in found)
    for extremum in torque:
        assert min(angle_between(extremum.theta1, e.theta1) for e in found) < 1e-9


@pytest.mark.parametrize('lengths', [(1.2, 0.5, 0.8, 1.0), (4.0, 2.0, 3.0, 5.5),
                                     (0.8, 0.5, 1.2, 1.4)])
def test_function_with_abs_of_a_rocker_has_an_extremum_between_its_unbounded_ends(lengths):
    """Huge derivatives next to toggles do not hide that abs has no complex step."""
    linkage = with_rods(lengths)
    found = find_extrema(linkage, lambda motion, loads: abs(loads.f41 - 1.0) + motion.omega_beta,
                         2.0, 0.5)
    ends = [e for e in found if e.place == 'limit']
    assert ends and all(e.value == inf for e in ends)
    for low, high in linkage.input_ranges:
        inside = [e.kind for e in found if e.place == 'interior'
                  and 0.0 < (e.theta1 - low) % (2.0 * np.pi) < high - low]
        assert inside.count('minimum') == inside.count('maximum') + 1, found


def test_function_of_plain_numbers():
    import math

    def height(motion, loads):
        return math.sin(motion.theta4) if motion.theta4 > 0 else 0.0

    found = find_extrema(FourBar(*PAPER), height)
    exact = find_extrema(FourBar(*PAPER), lambda motion, loads: motion.sin_y)
    assert [e.kind for e in found] == [e.kind for e in exact]
    for one, other in zip(found, exact):
        assert angle_between(one.theta1, other.theta1) < 1e-8
        assert one.value == pytest.approx(other.value, rel=16 * EPS)


def test_function_that_is_constant():
    extremum, = find_extrema(FourBar(*PAPER), lambda motion, loads: 3.0)
    assert (extremum.kind, extremum.value, extremum.is_global) == ('constant', 3.0, True)
    # one in each range of the input: the least and the greatest
    linkage = FourBar(1.2, 0.4, 0.8, 1.0)
    assert len(linkage.input_ranges) == 2
    for sign in (1.0, -1.0):
        found = find_extrema(linkage, lambda motion, loads: sign * np.sign(motion.theta1))
        assert [(e.kind, e.value, e.is_global) for e in found] == [
            ('constant', sign, True), ('constant', -sign, True)]


def degrees_of_output(motion, loads):
    return motion.theta4 * 180.0 / pi


@pytest.mark.parametrize('within', [None, (3.0, 5.0)])
@pytest.mark.parametrize('certify', [False, True])
def test_function_that_jumps_counts_on_both_sides(within, certify):
    """Values are those at 2^-46 of the largest input beside the jump, twice that by rounding."""
    linkage = FourBar(1.0, 0.9, 0.8, 0.4)
    assert linkage.turns_fully and not find_extrema(linkage, 'theta4')      # it turns on
    found = find_extrema(linkage, degrees_of_output, within=within, certify=certify)
    most, least = [e for e in found if e.is_global]
    assert (most.kind, most.side, least.kind, least.side) == ('maximum', -1, 'minimum', 1)
    assert most.theta1 == least.theta1
    off = 180.0 / pi * 2.0**-45 * 2.0 * pi * abs(linkage.motion(most.theta1, 1.0).omega4)
    assert most.value == pytest.approx(180.0, abs=off)
    assert least.value == pytest.approx(-180.0, abs=off)
    assert len(found) == (2 if within is None else 4)
    assert all(each.proof.startswith('interval bounds') == certify for each in (most, least))


def test_function_that_begins_on_a_plateau_has_no_extremum_at_its_corner():
    rate = find_extrema(FourBar(*PAPER), 'omega4')
    most, least = find_extrema(FourBar(*PAPER), lambda motion, loads: np.maximum(
        motion.omega4, 0.0))
    assert most.value == pytest.approx(max(e.value for e in rate), rel=16 * EPS)
    assert least.value == 0.0 and most.is_global and least.is_global and not most.proof


@pytest.mark.parametrize('power', [1, 2])
def test_function_with_poles_is_refused(power):
    with pytest.raises(InvalidParameter, match='without bound beside the input [04]'):
        find_extrema(FourBar(*PAPER), lambda motion, loads: 1.0 / motion.omega4**power)


def test_function_whose_samples_no_extremum_reaches_is_not_certain():
    """It turns on plateaus, where no slope changes its sign."""
    most, least = find_extrema(FourBar(*PAPER), lambda motion, loads: np.tanh(
        1e6 * (motion.theta4 - 1.5)))
    assert (most.value, least.value) == (1.0, -1.0)
    for extremum in most, least:
        assert extremum.proof == 'not certain: extrema are missing' and not extremum.is_global


@pytest.mark.parametrize('asked, said', [
    (('f99',), UnknownQuantity), (('slide_velocity',), UnknownQuantity),
    (Quantity('omega9', 'rad/s', '', False), UnknownQuantity), (('f41',), MissingBodies),
    (lambda motion, loads: loads.f41, MissingBodies),
    (lambda motion, loads: loads[2], MissingBodies)])
def test_what_there_is_not_is_refused(asked, said):
    with pytest.raises(said, match='unknown quantity|mass|omega9'):
        find_extrema(FourBar(*PAPER), asked)


# --- sorting, many at once ----------------------------------------------------------------------

def test_sorted_by_quantity_and_angle_and_reproducible():
    linkage = with_rods(PAPER, gravity=(0.0, -9.81))
    names = ['f32', 'omega4', 'driving_torque']
    found = find_extrema(linkage, names, 7.0)
    assert [e.quantity for e in found] == sorted((e.quantity for e in found), key=names.index)
    for name in names:
        angles = [e.theta1 for e in of(found, name)]
        assert angles == sorted(angles) and all(0.0 <= angle < 2.0 * pi for angle in angles)
        kinds = [e.kind for e in of(found, name)]
        assert all(one != other for one, other in zip(kinds, kinds[1:] + kinds[:1]))
        values = QUANTITIES[name].of(*linkage.step(np.array(angles), 7.0))
        assert values == pytest.approx([e.value for e in of(found, name)], rel=64 * EPS)
