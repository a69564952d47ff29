"""Exact change points and their neighbours: one-sided values against limits in 300 digits, extremes next to the flat."""
from fractions import Fraction
from itertools import permutations
from math import gcd, inf, isnan, pi

import mpmath as mp
import numpy as np
import pytest
import reference
import slider_reference

from fourbar_ros.core import Applied, Bodies, Body, External, FourBar, InvertedSlider, SliderCrank
from fourbar_ros.core.extrema import find_extrema
from fourbar_ros.core.mechanism import CRANK, SLIDE
from fourbar_ros.core.sturm import count_extrema

EPS = 2.0**-52
KINDS = [(FourBar, CRANK), (SliderCrank, CRANK), (SliderCrank, SLIDE), (InvertedSlider, CRANK), (InvertedSlider, SLIDE)]
# Where limits are read off, in 300 digits: a pole grows by 1e5 from one to the other, a zero falls.
NEAR, NEARER, REFERENCE_DIGITS = mp.mpf(10)**-40, mp.mpf(10)**-45, 300


# --- the reference --------------------------------------------------------------------------------------------

def numbers(record):
    """Return the floats of a nested record as they are in the references."""
    return [[getattr(part, name) for name in names] for part, names in record]


def data_of(mechanism):
    bodies = numbers((body, ('mass', 'cg_along', 'cg_across', 'inertia')) for body in mechanism.bodies)
    applied = numbers((part, ('force_x', 'force_y', 'along', 'across', 'couple')) for part in mechanism.external)
    return [[[mp.mpf(v) for v in row] for row in rows] for rows in (bodies, applied)] + [list(map(mp.mpf, mechanism.gravity))]


def exact_values(mechanism, x, rates):
    """Return {quantity: value} at an input, all numbers of mpmath."""
    sign, lengths = int(mechanism.sign), [mp.mpf(length) for length in mechanism.lengths]
    if isinstance(mechanism, FourBar):
        values = dict(zip(reference.MOTION_FIELDS, reference.motion_of(lengths, sign, x, *rates)))
        loads = dict(zip(reference.LOAD_NAMES, reference.loads_of(lengths, sign, x, *rates, *data_of(mechanism))))
    else:
        kind = type(mechanism), mechanism.input
        values = dict(zip(slider_reference.FIELDS[kind[0]], slider_reference.fields_of(kind, lengths, sign, (x, *rates))))
        loads = dict(zip(slider_reference.LOADS, slider_reference.loads_of(kind, lengths, sign, (x, *rates), *data_of(mechanism))))
        loads['driving_force' if mechanism.input == SLIDE else 'driving_torque'] = loads.pop('drive')
    return values | {name: abs(v) if isinstance(v, mp.mpc) or name in ('f43',) else v for name, v in loads.items()}


def exact_limits(mechanism, place, side, rates):
    """Return {quantity: (limit, sense)}: +1 a maximum, -1 a minimum, 0 constant; towards a multiple of pi/2, or 0 m."""
    with mp.workdps(REFERENCE_DIGITS):
        place = 0 if mechanism.input == SLIDE else round(place / (0.5 * pi)) * mp.pi / 2
        unit = mp.mpf(mechanism.input_unit)
        near, nearer, farther = (exact_values(mechanism, place + side * t * unit, [mp.mpf(rate) for rate in rates])
                                 for t in (NEAR, NEARER, 2 * NEAR))
        limits = {}
        for name, value in nearer.items():
            growth = abs(value / near[name]) if near[name] else mp.mpf(0)
            change = farther[name] - near[name]
            sense = -int(mp.sign(change)) if abs(change) > mp.mpf(10)**-120 * (1 + abs(near[name])) else 0
            is_nothing = growth < 1e-3 or abs(value) < mp.mpf(10)**-100
            limits[name] = 0.0 if is_nothing else (inf if value > 0 else -inf) if growth > 1e3 else float(value), sense
        return limits


def check(mechanism, rates):
    """Compare every one-sided value and its kind with the reference; kinds alternate. Return how many there are."""
    found = [e for e in find_extrema(mechanism, (), *rates, conditions=False)]
    assert not any(isnan(e.value) for e in found), mechanism
    limits, number = {}, 0
    for e in found:
        if e.place == 'one-sided':
            place = 0.0 if mechanism.input == SLIDE else e.theta1
            if (place, e.side) not in limits:
                limits[place, e.side] = exact_limits(mechanism, place, e.side, rates)
            value, sense = limits[place, e.side][e.quantity]
            assert e.value == pytest.approx(value, rel=16 * EPS, abs=0.0), (mechanism, rates, e, value)
            assert e.kind == ('minimum', 'constant', 'maximum')[sense + 1], (mechanism, rates, e)
            number += 1
    assert limits, mechanism
    for quantity in {e.quantity for e in found}:
        check_that_kinds_alternate(mechanism, [e for e in found if e.quantity == quantity])
        for (place, side), values in limits.items():
            if values[quantity][1]:
                assert any((e.side, e.place) == (side, 'one-sided') for e in found if e.quantity == quantity), (
                        mechanism, rates, quantity, place, side)
            else:
                constant = [e for e in found if e.quantity == quantity and e.kind == 'constant']
                assert any(e.value == pytest.approx(values[quantity][0], rel=16 * EPS) for e in constant), (mechanism, quantity)
    return number


def check_that_kinds_alternate(mechanism, found):
    """Along each path between two ends minima and maxima take turns, beginning and ending with the ends."""
    found = [e for e in found if e.kind != 'constant']
    key = (lambda e: e.slide) if mechanism.input == SLIDE else lambda e: e.theta1
    found.sort(key=lambda e: (key(e), e.side))
    start = next((i for i, e in enumerate(found) if e.side == 1), 0)
    found = found[start:] + found[:start]
    for one, other in zip(found, found[1:] + found[:1]):
        if one.side != -1 and other.side != 1:
            assert one.kind != other.kind, (mechanism, one, other)


# --- change points --------------------------------------------------------------------------------------------------

def whole_change_points(most):
    """Yield the lengths of all four-bars at a change point with different whole lengths without a common factor."""
    for lengths in permutations(range(1, most + 1), 4):
        a = sorted(lengths)
        if a[0] + a[3] == a[1] + a[2] and gcd(*lengths) == 1:
            yield tuple(map(float, lengths))


def random_loads(rng):
    """Return what makes the loads: sometimes gravity and external loads, sometimes an acceleration."""
    bodies = Bodies(*(Body(*rng.uniform((0.1, 0.0, -0.2, 0.01), (2.0, 1.0, 0.2, 0.2)).tolist()) for _ in range(3)))
    applied = External(*(Applied(*rng.normal(size=5).tolist()) for _ in range(2))) if rng.random() < 0.3 else External()
    gravity = tuple(rng.normal(0.0, 5.0, 2).tolist()) if rng.random() < 0.5 else (0.0, 0.0)
    rates = float(rng.normal(0.0, 3.0)), float(rng.normal(0.0, 3.0)) if rng.random() < 0.3 else 0.0
    return dict(bodies=bodies, external=applied, gravity=gravity, mode=int(rng.integers(1, 3))), rates


def tenths(rng):
    """Return a random length of one decimal."""
    return int(rng.integers(1, 40))


def draw_decimal(rng, kind, driven):
    """
    Return lengths of one decimal, as floats: an exact change point of floats too.

    Every tenth is a special one: parallelogram, kite, rhombus, or equal lengths.
    """
    while True:
        if kind is FourBar:
            a = [tenths(rng), tenths(rng), tenths(rng), 0]
            special = rng.integers(40)
            if special < 4:
                a = [(a[0], a[1], a[0], a[1]), (a[0], a[0], a[1], a[1]), (a[0], a[1], a[1], a[0]), (a[0],) * 4][special]
            else:
                a[3] = (a[0] + a[1] - a[2], a[0] + a[2] - a[1], a[1] + a[2] - a[0])[rng.integers(3)]
            lengths = [v / 10 for v in a]
            sums = [Fraction(0)] * 3
            exact = list(map(Fraction, lengths))
            for i in range(3):
                sums[i] = sum(exact) - 2 * (exact[i] + exact[3])
            if min(a) > 0 and 0 in sums:
                return lengths
        else:
            e = 0 if rng.random() < 0.1 else tenths(rng)
            one = tenths(rng)
            lengths = [one / 10, (one + e) / 10]
            if Fraction(lengths[1]) - Fraction(lengths[0]) == Fraction(e / 10):
                return [*(lengths[::-1] if rng.random() < 0.5 else lengths), float(rng.choice((-1, 1))) * e / 10]


def build(kind, driven, lengths, others):
    return kind(*lengths, **others) if kind is FourBar else kind(*lengths, input=driven, **others)


@pytest.mark.parametrize('kind, driven', KINDS)
def test_one_sided_values_of_decimal_change_points(kind, driven):
    rng = np.random.default_rng(31)
    assert sum(check(build(kind, driven, draw_decimal(rng, kind, driven), others), rates)
               for others, rates in (random_loads(rng) for _ in range(6))) > 50


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(10))
@pytest.mark.parametrize('kind, driven', KINDS)
def test_one_sided_values_of_1000_decimal_change_points(kind, driven, seed):
    rng = np.random.default_rng(1000 + seed)
    for _ in range(100):
        others, rates = random_loads(rng)
        check(build(kind, driven, draw_decimal(rng, kind, driven), others), rates)


def check_whole(lengths, rng):
    others, rates = random_loads(rng)
    linkage = FourBar(*lengths, **others)
    check(linkage, rates)
    found = find_extrema(FourBar(*lengths, mode=others['mode']), ('omega4', 'alpha4'))
    assert [sum(e.quantity == name and e.place == 'interior' for e in found)
            for name in ('omega4', 'alpha4')] == count_extrema(lengths), lengths


def test_whole_change_points():
    rng = np.random.default_rng(5)
    every = list(whole_change_points(12))
    assert len(every) == 2088
    for lengths in every[::261]:
        check_whole(lengths, rng)


@pytest.mark.slow
@pytest.mark.parametrize('part', range(8))
def test_all_2088_whole_change_points(part):
    rng = np.random.default_rng(part)
    for lengths in list(whole_change_points(12))[part::8]:
        check_whole(lengths, rng)
