# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A fuzz of change points: all extrema of all quantities against dense scans in 60 digits.

Exact change points, of lengths whose sums floats make exactly, over their one or two turns, and
linkages beside them, at margins from 1e-14 to 1e-3. The reference is that of Cartesian
coordinates, which shares no formula with the library.
"""
from math import inf, isfinite, isnan, pi

from flint import ctx
from fourbar_ros import Bodies, Body, find_extrema, FourBar, InvertedSlider, SliderCrank
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.input_paths import TooNarrow
from fourbar_ros.mechanisms.four_bars import MovingJointFourBar
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.quantities import known_quantities
import numpy as np
import pytest
from support import cartesian

EPS = 2.0**-52
BITS = 216                      # 65 digits
RATE = 10.0
KINDS = ('FourBar', 'A', 'B', 'crank', 'slide', 'inverted crank', 'inverted slide', 'one dyad',
         'two dyads')


def body(rng):
    return Body(rng.uniform(0.5, 3.0), cg_along=rng.uniform(-0.5, 0.5),
                cg_across=rng.uniform(-0.5, 0.5), inertia=rng.uniform(0.1, 1.0))


def lengths_near_a_change_point(rng, count):
    """Return lengths with a signed sum that is exactly zero, or off by a margin."""
    while True:
        sides = rng.integers(1, 100, count).tolist()
        signs = rng.permutation(([1, 1, -1, -1], [1, 1, 1, -1])[int(rng.integers(2))])
        sides[-1] = abs(int((signs[:count - 1] * sides[:-1]).sum()))
        if rng.random() < 0.15:             # rhombus, parallelogram or kite
            sides = ([sides[0]] * 4 if rng.random() < 0.3 else sides[:2] * 2)[:count]
        if all(sides[:2]) and (count == 3 or all(sides)):
            break
    if rng.random() < 0.4:
        return [side / 64 for side in sides]
    scale, margin = rng.uniform(0.01, 0.04), 10.0**rng.uniform(-14.0, -3.0)
    sides = [scale * side for side in sides]
    sides[int(rng.integers(count))] += margin * sum(sides) * rng.choice((-1.0, 1.0))
    return sides


def linkage_near_a_change_point(rng):
    """Return a loaded linkage or machine of any kind, in any mode."""
    while True:
        kind, mode = rng.choice(KINDS), int(rng.integers(1, 3))
        sides = lengths_near_a_change_point(rng, 3 if kind in KINDS[3:7] else 4)
        a1, a2, *others = sides
        common = {'mode': mode, 'bodies': Bodies(body(rng), body(rng), body(rng)),
                  'gravity': (0.0, -9.81 * int(rng.integers(2)))}
        try:
            if kind == 'FourBar':
                linkage = FourBar(*sides, **common)
            elif kind in ('A', 'B'):
                linkage = MovingJointFourBar(*sides, input=str(kind), **common)
            elif kind in KINDS[3:7]:
                make = InvertedSlider if 'inverted' in kind else SliderCrank
                linkage = make(a1, a2, offset=others[0], input=kind.split()[-1], **common)
            else:
                dyads = [Dyad('one', 'RRR', Point('crank', a1), Point('ground', others[1]),
                              ('rod', 'rocker'), length_1=a2, length_2=others[0], mode=mode)]
                if kind == 'two dyads':
                    dyads.append(Dyad('two', 'RRP', Point('rocker', 0.5 * others[0], 0.1),
                                      Point('ground', 0.0, 0.6), ('link', 'block'),
                                      length_1=2.0 * sum(sides), direction_2=0.1))
                linkage = Machine(dyads, gravity=common['gravity'], bodies={
                    name: body(rng) for dyad in dyads for name in dyad.links})
            if min(high - low for low, high in linkage.input_ranges) > 1e-6 * linkage.input_unit:
                return linkage
        except FourBarError:
            continue


def scan(linkage, per_decade, points):
    """Return inputs of a dense scan: equal steps, and steps that crowd to singular inputs."""
    unit, turn = linkage.input_unit, 0.0 if linkage.is_driven_by_slide else 2.0 * pi
    away = unit * 10.0**-np.arange(0.5, 11.0, 1.0 / per_decade)
    ranges = linkage.input_ranges
    if linkage.turns_fully:
        ranges = [(-0.5 * linkage.period, 0.5 * linkage.period)]
    x = [low + (high - low) * (np.arange(points) + 0.5) / points for low, high in ranges]
    centres = {complex(z).real + around for z in linkage.singular_inputs
               for around in (-turn, 0.0, turn)}
    x += [centre + side * away for centre in sorted(centres) for side in (-1.0, 1.0)]
    found = np.unique(np.concatenate(x))
    return [at for at in found.tolist() if any(
        low + 1e-11 * unit < at < high - 1e-11 * unit for low, high in ranges)]


def exact(linkage, x):
    """Return {field: value} in 60 digits; {} where the reference finds no pose of the mode."""
    with ctx.workprec(BITS):
        try:
            given = tuple(map(cartesian.number, (x, RATE, 0.0)))
            if linkage.change_point_margin == 0.0:      # on which side depends on the branch
                return cartesian.values_of(cartesian.Cartesian(
                    cartesian.reference_of(linkage), given, cartesian.pose_of(linkage, x)))
            return cartesian.values_of(cartesian.exact(linkage, given))
        except (ArithmeticError, ZeroDivisionError):
            return {}


def size_of_rounding(quantity, linkage, one):
    """Return what the rounding of the input changes in a value, of a kink that of its place."""
    way = 4.0 * np.spacing(abs(one.input)) + EPS * one.condition * (not one.value)
    inputs = one.input + way * np.array((-1.0, 0.0, 1.0))
    with np.errstate(all='ignore'):
        around = np.broadcast_to(quantity.of(*linkage.step(inputs, RATE)), (3,))
    return float(np.abs(around[[0, 2]] - around[1]).max())


def check(linkage, per_decade, points, certify):
    """Check all quantities of a linkage; return how many were."""
    quantities = {name: quantity for name, quantity in known_quantities(
        linkage, linkage.input).items() if quantity.unit != 'rad'}
    try:
        found = find_extrema(linkage, list(quantities.values()), RATE, certify=certify)
    except TooNarrow:       # a range of some 1e-12: refused in a line
        return 0
    truth = [exact(linkage, x) for x in scan(linkage, per_decade, points)]
    number = 0
    for name, quantity in quantities.items():
        own = [one for one in found if one.quantity == name]
        values = [float(each[name]) for each in truth if name in each]
        if not own or not values or any(one.kind == 'constant' for one in own):
            continue
        number += 1
        for one in own:
            if one.place == 'interior':
                rounding = size_of_rounding(quantity, linkage, one)
                if not isfinite(rounding):
                    continue
                known = quantity.of(*linkage.step(one.input, RATE))
                value = exact(linkage, one.input).get(name)
                if not one.value and value is not None:     # a kink: a machine's step may be worse
                    known = float(value)
                condition = min(one.value_condition, 1e13)
                tolerance = EPS * (64 + 10 * condition) * abs(known) + rounding
                assert abs(one.value - known) <= tolerance, (linkage, one, known)
                if value is not None and 'interval bounds' in one.proof:
                    assert abs(one.value - value) <= (2.0**-30 * abs(value) + 2.0 * rounding
                                                      + EPS * one.value_condition * abs(value)), (
                        linkage, one, value)
        for sign, kind in ((1.0, 'maximum'), (-1.0, 'minimum')):
            best = max(sign * value for value in values)
            claimed = [one for one in own if one.kind == kind and one.is_global]
            if not claimed:
                assert all(one.proof for one in own), (linkage, name, kind)
            for one in claimed:
                assert not isnan(one.value)
                slack = 1e-9 * abs(best) + 1e-13 * max(map(abs, values))
                assert sign * one.value >= best - slack or one.proof.startswith(
                    'not certain'), (linkage, one, best)
                same = max(sign * each.value for each in claimed)
                assert sign * one.value in (same, inf) or abs(
                    sign * one.value - same) <= 1e-12 * abs(same), (linkage, one, same)
    return number


@pytest.mark.parametrize('seed', range(4))
def test_a_few_linkages_beside_change_points(seed):
    assert check(linkage_near_a_change_point(np.random.default_rng(seed)), 2, 12, seed == 0)


@pytest.mark.slow
@pytest.mark.parametrize('thousand', range(10))
def test_10_000_quantities_beside_change_points(thousand):
    rng, number = np.random.default_rng((20261128, thousand)), 0
    while number < 1_000:
        number += check(linkage_near_a_change_point(rng), 3, 30, number % 5 == 0)
