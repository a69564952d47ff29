# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Modes of bags in which they are sides: the sides are those of the tables in conventions.md."""
from math import cos, pi, prod, sin

from fourbar_ros.bag.sides import branch_at, modes_of
from fourbar_ros.errors import FourBarError
import numpy as np
import pytest
from support.contract import at_change_point, CASES, name_of, ordinary

SIDES = {('four_bar', 'crank'): lambda m: sin(m.theta4 - m.beta),
         ('four_bar', 'A'): lambda m: sin(m.theta4), ('four_bar', 'B'): lambda m: sin(m.theta1),
         ('slider_crank', 'crank'): lambda m: cos(m.beta),
         ('slider_crank', 'slide'): lambda m: sin(m.theta2),
         ('inverted_slider', 'crank'): lambda m: m.slide,
         ('inverted_slider', 'slide'): lambda m: sin(m.theta1)}
with_sides = pytest.mark.parametrize('case', [case for case in CASES
                                              if (case.name, case.driven) in SIDES], ids=name_of)


@with_sides
def test_the_branch_at_an_input_is_on_the_side_that_the_mode_says(case):
    rng, side = np.random.default_rng(5), SIDES[case.name, case.driven]
    seen = {True: 0, False: 0}
    for _ in range(40):
        linkage = case.make(at_change_point(rng, case))
        assert linkage.change_point_margin == 0.0 and list(modes_of(linkage)) == [1, 2]
        low, high = linkage.input_ranges[0]
        low, high = (-10.0, 10.0) if linkage.turns_fully else (low, high)
        for x in rng.uniform(low, high, 20).tolist():
            branch = branch_at(linkage, case.mode, x)
            there = side(linkage.in_mode(branch).motion(x))
            assert (there > 0.0) == (case.mode == 2) or abs(there) < 1e-9
            seen[branch == case.mode] += 1
    assert min(seen.values()) > 100         # the other branch is met too


# {kind and input: (linkage, input) -> k}, as conventions.md has it
FACTORS = {
    ('four_bar', 'crank'): lambda flats, x: of_angle(flats, x, sin(0.5 * x)),
    ('four_bar', 'A'): lambda flats, x: of_angle(flats, x, -sin(0.5 * x)),
    ('four_bar', 'B'): lambda flats, x: of_angle(flats, x, -sin(0.5 * x)),
    ('slider_crank', 'crank'): lambda flats, x: prod(
        sin(0.5 * x + 0.25 * pi) if flat < 0.0 else cos(0.5 * x + 0.25 * pi) for flat in flats),
    ('slider_crank', 'slide'): lambda flats, x: x,
    ('inverted_slider', 'crank'): lambda flats, x: sin(0.5 * x),
    ('inverted_slider', 'slide'): lambda flats, x: x}


def of_angle(flats, x, at_zero):
    """Return k of a four-bar, with a factor at flat position 0 and one at pi."""
    return prod(at_zero if abs(flat) < 1.0 else cos(0.5 * x) for flat in flats)


@with_sides
def test_the_side_of_a_mode_is_that_of_the_table_times_k(case):
    rng, side, factor = np.random.default_rng(7), *(table[case.name, case.driven]
                                                    for table in (SIDES, FACTORS))
    for _ in range(40):
        linkage = case.make(at_change_point(rng, case))
        if not linkage.turns_fully and not linkage.is_driven_by_slide:
            continue        # beyond its limits it may lie flat too
        low, high = (-20.0, 20.0) if linkage.turns_fully else linkage.input_ranges[0]
        for x in rng.uniform(low, high, 10).tolist():
            k = factor(linkage.flat_inputs, x)
            there = linkage.sign * k * side(linkage.motion(x))
            assert there > 0.0 or abs(k) < 1e-6 or abs(there) < 1e-12


@with_sides
def test_away_from_change_points_a_mode_is_itself(case):
    for linkage, given in ordinary(case, 6, 20):
        x = float(np.ravel(given[0])[0]) if np.ndim(given) else float(given)
        assert modes_of(linkage) is None and branch_at(linkage, case.mode, x) == case.mode


def test_out_of_range_the_mode_is_as_it_is():
    linkage = next(ordinary(CASES[0], 6, 1))[0]
    with pytest.raises(FourBarError):
        linkage.motion(1e300)
    assert branch_at(linkage, 2, 1e300) == 2 and branch_at(linkage, 1, 1e300) == 1
