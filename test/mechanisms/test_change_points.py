# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact change points and their neighbours.

Values at flat positions against limits in many digits from both sides, extrema next to the flat.
"""
from dataclasses import replace
from itertools import permutations
from math import gcd, inf, isnan, pi, remainder

from flint import arb, ctx
from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    FourBar,
    InvalidParameter,
    InvertedSlider,
    SliderCrank,
)
from fourbar_ros.errors import OutOfRange, Toggle
from fourbar_ros.extrema.find import find_extrema
import mpmath as mp
import numpy as np
import pytest
from support import contract
from support.cartesian import ANGLES, beside, BITS, EPS, MANY_BITS, values, values_of
from support.extrema_reference import exact_roots
from support.samples import more, record, some

# Where limits are read off: a pole grows by 1e5 from one to the other, a zero falls.
NEAR, NEARER = '1e-40', '1e-45'
# kinds that have change points, and their inputs, in both modes
CASES = [case for case in contract.CASES if case.name != 'scotch_yoke' and case.mode == 2]
every_input = pytest.mark.parametrize('case', CASES, ids=contract.name_of)


# --- the reference -------------------------------------------------------------------------------

def flat_near(mechanism, place):
    """Return the flat position near a place: a multiple of pi/2, or 0 m."""
    return (arb(0) if mechanism.is_driven_by_slide else
            arb.pi() * round(place / (0.5 * pi)) / 2)


def exact_limits(mechanism, place, side, rates):
    """Return {quantity: (limit, sense)}: +1 a maximum, -1 a minimum, 0 constant."""
    with ctx.workprec(MANY_BITS):
        unit = arb(mechanism.input_unit)
        ways = [side * way * unit for way in (2 * arb(NEAR), arb(NEAR), arb(NEARER))]
        farther, near, nearer = map(values_of, beside(
            mechanism, flat_near(mechanism, place), ways, tuple(map(arb, rates))))
    limits = {}
    for name, value in nearer.items():
        growth = abs(value / near[name]) if near[name] else mp.mpf(0)
        change = farther[name] - near[name]
        sense = (-int(mp.sign(change)) if abs(change) > mp.mpf(10)**-120
                 * (1 + abs(near[name])) else 0)
        is_nothing = growth < 1e-3 or abs(value) < mp.mpf(10)**-100
        limits[name] = (0.0 if is_nothing else (inf if value > 0 else -inf) if growth > 1e3
                        else float(value), sense)
    return limits


def check_that_kinds_alternate(mechanism, found):
    """Minima and maxima alternate along each path, from end to end."""
    found = [e for e in found if e.kind != 'constant']
    found.sort(key=lambda e: (e.input, e.side))
    start = next((i for i, e in enumerate(found) if e.side == 1), 0)
    found = found[start:] + found[:start]
    for one, other in zip(found, found[1:] + found[:1]):
        if one.side != -1 and other.side != 1:
            assert one.kind != other.kind, (mechanism, one, other)


# --- change points -------------------------------------------------------------------------------

def whole_change_points(most):
    """Yield change-point lengths: different whole numbers without a common factor."""
    for lengths in permutations(range(1, most + 1), 4):
        a = sorted(lengths)
        if a[0] + a[3] == a[1] + a[2] and gcd(*lengths) == 1:
            yield tuple(map(float, lengths))


def random_loads(rng):
    """Return bodies, sometimes gravity and loads; and rates, sometimes an acceleration."""
    bodies = contract.random_bodies(rng)
    applied = (External(*(record(Applied, *rng.normal(size=5).tolist()) for _ in range(2)))
               if rng.random() < 0.3 else External())
    gravity = tuple(rng.normal(0.0, 5.0, 2).tolist()) if rng.random() < 0.5 else (0.0, 0.0)
    rates = float(rng.normal(0.0, 3.0)), float(rng.normal(0.0, 3.0)) if rng.random() < 0.3 else 0.0
    return {'bodies': bodies, 'external': applied, 'gravity': gravity}, rates


def loaded(rng, case):
    """Return a mechanism at an exact change point in one of its modes, and rates."""
    others, rates = random_loads(rng)
    case = case._replace(mode=int(rng.integers(1, 3)))
    return case.make(contract.at_change_point(rng, case), **others), rates


def test_whole_change_points(step=more(261, 29)):
    """As many extrema as roots, and by symmetry one of the rate in each pose in line."""
    every = list(whole_change_points(12))
    assert len(every) == 2088
    for lengths in every[::step]:
        both = [FourBar(*lengths, mode=mode) for mode in (1, 2)]
        turns = round(both[0].period / (2.0 * pi))
        for order, name in enumerate(('omega4', 'alpha4')):
            count = sum(e.place == 'interior' and e.kind != 'constant' for linkage in both
                        for e in find_extrema(linkage, name, conditions=False))
            flats = len(both[0].flat_inputs) * (order == 0)
            assert count == 2 * turns * (len(exact_roots(lengths, order)) + flats), (
                lengths, name, count)


# --- at the flat position, which is a float where it is 0 ----------------------------------------

def flat_at_zero(rng, case, count):
    """Yield mechanisms that lie flat at input 0, and rates."""
    while count:
        mechanism, rates = loaded(rng, case)
        if 0.0 in mechanism.singular_inputs and any(
                low < 0.0 < high for low, high in mechanism.closing_ranges):
            count -= 1
            yield mechanism, rates


def check_at_zero(mechanism, rates):
    """
    Compare with the limits from both sides; return whether loads are unbounded.

    The poses on both sides, in the reference, are of one branch if their motion, drive and shaking
    loads have one limit.
    """
    above, below = (exact_limits(mechanism, 0.0, side, rates) for side in (1, -1))
    motion, loads = mechanism.step(np.zeros(2), *rates)
    for name, (value, _) in above.items():
        here = getattr(motion if name in motion._fields else loads, name)[0]
        if abs(value) == inf or abs(below[name][0]) == inf:
            assert name.removesuffix('_x').removesuffix('_y') in FORCES
            assert not np.isfinite(here), (mechanism, rates, name)
            continue
        size = max(1.0, *(abs(above[other][0]) for other in above
                          if other in motion._fields and abs(above[other][0]) < inf))
        if name in motion._fields or name.startswith(('driving', 'shaking')):
            apart = below[name][0] - value
            apart = 1.0 - np.cos(apart) if name.startswith(ANGLES) else abs(apart)
            assert apart <= 1e-14 * size**2, (mechanism, rates, name)
        if not np.isfinite(here):       # a force on rods in line, of any size
            assert name.removesuffix('_x').removesuffix('_y') in FORCES
            continue
        if name.startswith(ANGLES):
            here, value = np.cos(here - value), 1.0     # pi is -pi
        assert here == pytest.approx(value, rel=64 * EPS, abs=64 * EPS * size**2), (
            mechanism, rates, name, value)
    for place in (0.0, -0.0):
        for name, value in mechanism.motion(place, *rates)._asdict().items():
            here = getattr(motion, name)[0]
            if name.startswith(ANGLES):
                here, value = np.cos(here - value), 1.0
            assert here == pytest.approx(value, rel=8 * EPS, abs=8 * EPS), name
        if np.isfinite(loads).all():
            assert mechanism.loads(place, *rates) == pytest.approx(np.array(loads)[:, 0],
                                                                   rel=64 * EPS)
        else:
            with pytest.raises(Toggle):
                mechanism.step(place, *rates)
    return not np.isfinite(loads).all()


FORCES = ('f41', 'f21', 'f32', 'f43', 'guide_force', 'guide_couple')


@pytest.mark.parametrize('case', [case for case in CASES if case[::2] != ('slider_crank', 'crank')
                                  ], ids=contract.name_of)
def test_motion_goes_through_a_flat_position_and_unbounded_loads_are_a_toggle(case,
                                                                              count=more(5, 30)):
    rng = np.random.default_rng(77)
    unbounded = [check_at_zero(*each) for each in flat_at_zero(rng, case, count)]
    assert any(unbounded)


@every_input
def test_no_dust_at_0_and_small_values_stay(case):
    """What vanishes at input 0 is 0 there, and next to it as small as it is."""
    rng, count = np.random.default_rng(4), 0
    while count < 30:
        lengths = rng.uniform(0.1, 1.0, len(case.kind.LENGTHS)).tolist()
        try:
            mechanism = case._replace(mode=int(rng.integers(1, 3))).make(lengths)
            here = mechanism.motion(0.0, 2.0, 0.5)
        except InvalidParameter:
            continue
        except OutOfRange:
            count += 1
            continue
        count += 1
        assert not any(0.0 < abs(v) < 1e-60 for v in here), (mechanism, here)
        near, many = mechanism.motion(1e-60, 2.0, 0.5), mechanism.motion([1e-60, 0.0], 2.0, 0.5)
        for name, value in values(mechanism, 1e-60, 2.0, 0.5).items():
            if not 1e-50 < abs(value) < 1e50:
                assert getattr(near, name) == pytest.approx(float(value), rel=1e-13, abs=1e-70)
        assert not any(0.0 < abs(v[1]) < 1e-60 for v in many)


# --- next to the flat position -------------------------------------------------------------------

FAST = [(FourBar(2.0, 4.0, 3.0, 5.0), pi), (FourBar(4.0, 2.0, 3.0, 5.0), 0.0),
        (FourBar(1.0, 1.001, 1.0, 1.001), 0.0), (SliderCrank(2.0, 3.0, 1.0), 1.5 * pi),
        (SliderCrank(3.0, 2.0, 1.0, input='slide'), 0.0), (InvertedSlider(0.2, 0.2, 0.0), 0.0)]


@some('mechanism, place', FAST, 4)
@some('rate', [1e5, 1e4], 1)
def test_extrema_next_to_the_flat_are_found(mechanism, place, rate):
    """Small weights make weak poles, with extrema 1e-9 to 1e-3 from the flat position."""
    rng = np.random.default_rng(3)
    least, most = (0.1, 0.2, 0.0, 0.01), (2.0, 1.0, 0.0, 0.2)
    bodies = Bodies(*(record(Body, *rng.uniform(least, most).tolist())
                      for _ in range(3)))
    mechanism = replace(mechanism, bodies=bodies, gravity=(3.0, -9.81))
    names = ['shaking_moment', 'f41', 'f32', 'f43']
    found = find_extrema(mechanism, names, rate, conditions=False)
    unit, number = mechanism.input_unit, 0
    t = 1e-10 * 10.0**(np.arange(29) / 4)
    for side in (1, -1):
        with ctx.workprec(BITS):
            ways = [side * v * arb(unit) for v in t[::-1].tolist()]
            rows = list(map(values_of, beside(mechanism, flat_near(mechanism, place), ways,
                                              (rate, 0.0))))[::-1]
        for name in names:
            rise = [other[name] > one[name] for one, other in zip(rows, rows[1:])]
            turns = [(t[i], t[i + 2]) for i in range(len(rise) - 1) if rise[i] != rise[i + 1]]
            near = [side * remainder(e.input - place, mechanism.period) / unit
                    for e in found if (e.quantity, e.place) == (name, 'interior') and e.kind
                    != 'constant']
            assert len([v for v in near if t[1] < v < t[-2]]) == len(turns), (name, side, near,
                                                                              turns)
            for low, high in turns:
                assert sum(low <= v <= high for v in near) == 1
            number += len(turns)
    assert number > 0


def with_rods(lengths, mode):
    return FourBar(*lengths, mode=mode,
                   bodies=Bodies(*(Body(1.0, cg_along=0.5 * a,
                                        inertia=a * a / 12.0) for a in lengths[:3])))


@some('order', [(0, 1, 0, 1), (0, 0, 1, 1), (0, 1, 1, 0)], 1)
@some('gap', [0.5, 1e-2, 1e-4, 1e-6], 2)
def test_nearly_equal_links_have_as_few_extrema_as_others(order, gap):
    """Parallelograms and kites: what is constant in them has no extrema of noise."""
    for mode in (1, 2):
        linkage = with_rods([(1.0, 1.0 + gap)[i] for i in order], mode)
        found = find_extrema(linkage, (), 3.0, conditions=False)
        for quantity in {e.quantity for e in found}:
            assert sum(e.quantity == quantity for e in found) <= 12, (linkage, quantity)


def test_functions_have_extrema_at_a_flat_position_too():
    """Functions of plain arithmetic, with abs, and plain numbers: the rate is even about it."""
    import math

    linkage = FourBar(2.0, 4.0, 3.0, 5.0)
    value = abs(exact_limits(linkage, pi, 1, (2.0, 0.0))['omega4'][0])
    for function, expected in ((lambda motion, loads: motion.omega4 * motion.omega4, value**2),
                               (lambda motion, loads: abs(motion.omega4), value),
                               (lambda motion, loads: math.fabs(motion.omega4), value)):
        at_flat = [e for e in find_extrema(linkage, function, 2.0)
                   if abs(e.theta1 - pi) < 1e-6]
        assert [e.place for e in at_flat] == ['interior']
        assert at_flat[0].value == pytest.approx(expected, rel=8 * EPS)


# --- near change points --------------------------------------------------------------------------

@some('gap', [1e-6, 1e-7, 1e-9, 1e-12], 2)
def test_rockers_next_to_a_change_point(gap, count=more(6, 30)):
    """A sum of lengths is too short: no NaN, infinite at toggles, minima and maxima in turn."""
    rng = np.random.default_rng(17)
    while count:
        lengths = [*contract.at_change_point(rng, CASES[0])]
        lengths[rng.integers(4)] *= 1.0 + gap * float(rng.choice((-2.0, 2.0)))
        others, _ = random_loads(rng)
        linkage = FourBar(*lengths, mode=int(rng.integers(1, 3)), **others)
        if linkage.turns_fully or linkage.change_point_margin == 0.0 or len(set(lengths)) < 4:
            continue
        count -= 1
        check_rocker(linkage)


def check_rocker(linkage):
    for rates, names in (((3.0, 0.0), ('omega4', 'alpha4')),
                         ((10.0, 3.0), ('omega4', 'alpha4', 'omega_beta', 'f41',
                                        'driving_torque'))):
        found = find_extrema(linkage, names, *rates, conditions=False)
        for name in names:
            part = [e for e in found if e.quantity == name]
            assert not any(isnan(e.value) for e in part), linkage
            limits = [e for e in part if e.place == 'limit']
            assert (len(limits) == 2 * len(linkage.input_ranges)
                    and all(abs(e.value) == inf for e in limits)), (linkage, limits)
            check_that_kinds_alternate(linkage, part)


@pytest.mark.parametrize('lengths, mode, rates', [((1.0, 0.8, 2.6, 2.8), 1, (10.0, 3.0)),
                                                  ((1.5, 1.4, 2.3, 2.2), 2, (10.0, 0.0)),
                                                  ((0.2, 0.6, 0.9, 0.5), 2, (10.0, 0.0))])
def test_decimal_lengths_that_are_one_rounding_off_a_change_point(lengths, mode, rates):
    linkage = with_rods(lengths, mode)
    found = find_extrema(linkage, (), *rates)
    assert not any(isnan(e.value) for e in found)
    if linkage.change_point_margin:
        assert all(abs(e.value) == inf for e in found if e.place == 'limit')


@pytest.mark.parametrize('position, rate', [
    ([[0.0, 0.5], [1.0, 0.0]], 1.0), (0.0, [1.0, 2.0]), ([[0.0], [0.5]], [1.0, 2.0])])
def test_limits_at_the_flat_position_in_arrays_of_any_shape(position, rate):
    linkage = FourBar(1.0, 2.0, 1.0, 2.0, 2)
    given = np.broadcast_arrays(position, rate)
    found = linkage.motion(position, rate)
    each = [linkage.motion(*one) for one in zip(*(np.ravel(v).tolist() for v in given))]
    assert all(np.shape(field) == given[0].shape for field in found)
    assert np.allclose([np.ravel(field) for field in found], np.array(each).T, rtol=1e-14,
                       atol=0.0, equal_nan=True)
