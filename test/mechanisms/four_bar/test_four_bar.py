# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The linkage: what is refused, its class, its limits, its dead points, its mode."""
from fractions import Fraction
from math import inf, nan, pi, remainder

from fourbar_ros import (
    Body,
    CROSSED,
    FourBar,
    InvalidParameter,
    OPEN,
    OutOfRange,
    round_rod,
)
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import EPS, values
from support.contract import random_lengths


@pytest.mark.parametrize('arguments, name', [
    ((-1.0,), 'mass'), ((nan,), 'mass'), ((1.0, inf), 'cg_along'), ((1.0, 0.0, nan), 'cg_across'),
    ((1.0, 0.0, 0.0, -1.0), 'inertia')])
def test_bad_bodies_are_refused_by_name(arguments, name):
    with pytest.raises(InvalidParameter, match=f'^{name} = '):
        Body(*arguments)


def test_round_rod_is_table_1_of_the_paper():
    assert [round_rod(length, 7750.0, 0.01).mass for length in (0.4, 1.2, 0.8)] == pytest.approx(
        [31.0 * pi / 100.0, 93.0 * pi / 100.0, 31.0 * pi / 50.0], rel=1e-15)
    rod = round_rod(1.2, 7750.0, 0.01)
    assert (rod.cg_along, rod.cg_across) == (0.6, 0.0)
    assert rod.inertia == pytest.approx(rod.mass * (3.0 * 0.01**2 + 1.2**2) / 12.0, rel=1e-15)
    for bad in ((0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, nan)):
        with pytest.raises(InvalidParameter):
            round_rod(*bad)


# --- classes -------------------------------------------------------------------------------------

def reachable(lengths, angles):
    """
    Return at which input angles the linkage closes.

    The diagonal fits between a2 + a3 and |a2 - a3|.
    """
    a1, a2, a3, a4 = lengths
    q = a1**2 + a4**2 - 2.0 * a1 * a4 * np.cos(angles)
    return ((a2 - a3)**2 < q) & (q < (a2 + a3)**2)


AROUND = np.linspace(-pi, pi, 720, endpoint=False) + pi / 720.0
# whether input, output, coupler turn fully; whether the input ranges hold 0 and pi, the output's
CLASSES = {
    'Grashof crank-rocker': (True, False, False),
    'Grashof double-crank': (True, True, True),
    'Grashof rocker-crank': (False, True, False),
    'Grashof double-rocker': (False, False, True)}


def test_eight_classes_by_brute_force():
    """Try all angles for which links turn fully and where the two ranges lie."""
    seen = set()
    for lengths in random_lengths(np.random.default_rng(41), 1500).tolist():
        linkage = FourBar(*lengths)
        if linkage.change_point_margin < 1e-3:
            continue    # ends closer to 0 or pi than the samples
        seen.add(linkage.classification)
        a1, a2, a3, a4 = lengths
        from_input = reachable(lengths, AROUND)
        from_output = reachable((a3, a2, a1, a4), pi - AROUND)        # the linkage seen from O4
        # crank and coupler at A: link a1 held
        relative = reachable((a1, a4, a3, a2), AROUND)
        if linkage.classification.startswith('Grashof'):
            expected = CLASSES[linkage.classification]
            assert (from_input.all(), from_output.all()) == expected[:2], lengths
            coupler_turns = from_input.all() and from_output.all() or (
                relative.all() and reachable((a2, a1, a4, a3), AROUND).all())
            assert coupler_turns == expected[2], lengths
        else:
            passes = {True: '0', False: 'pi'}
            zero, half = len(AROUND) // 2, 0
            name = f'{passes[bool(from_input[zero])]}-{passes[bool(from_output[zero])]}'
            assert linkage.classification == f'non-Grashof {name} double-rocker', lengths
            assert from_input[zero] != from_input[half] and from_output[zero] != from_output[half]
    assert len(seen) == 8


@pytest.mark.parametrize('lengths', [(2.0, 4.0, 3.0, 5.0), (2.0, 3.0, 2.0, 3.0),
                                     (2.0, 2.0, 3.0, 3.0),
                                     (2.0, 3.0, 3.0, 2.0), (1.0, 1.0, 1.0, 1.0)])
def test_change_points_are_exact(lengths):
    linkage = FourBar(*lengths)
    assert linkage.classification == 'change point' and linkage.change_point_margin == 0.0
    off = FourBar(*lengths[:3], lengths[3] * (1.0 + EPS))
    assert off.classification != 'change point' and 0.0 < off.change_point_margin < EPS


# --- input and output limits ---------------------------------------------------------------------


def exact_limits(lengths):
    """Return the positive limits of theta1 from the law of cosines with exact numbers."""
    a1, a2, a3, a4 = map(Fraction, lengths)
    cosines = [(a1**2 + a4**2 - r**2) / (2 * a1 * a4) for r in (a2 - a3, a2 + a3)]
    return [mp.acos(mp.mpf(c.numerator) / c.denominator) for c in cosines if -1 < c < 1]


def test_ranges_hold_the_exact_limits_to_the_last_bits():
    rng = np.random.default_rng(42)
    shapes = set()
    for lengths in random_lengths(rng, 400).tolist():
        if rng.random() < 0.3:      # a limit close to 0 or to pi
            lengths[3] = abs(sum(lengths[1:3]) - lengths[0]) + 10.0**rng.uniform(-15, -6)
        linkage = FourBar(*lengths)
        ranges, limits = linkage.input_ranges, exact_limits(lengths)
        shapes.add((len(ranges), linkage.turns_fully, ranges[-1][1] > pi))
        found = [] if linkage.turns_fully else sorted(end for end in ranges[-1] if 0.0 < end < pi)
        assert len(found) == len(limits)
        for value, exact in zip(found, sorted(limits)):
            assert abs(value - exact) <= 4 * EPS * exact
    assert shapes == {(1, True, False), (1, False, False), (1, False, True), (2, False, False)}


def test_full_turns_of_the_input_angle_change_nothing_but_rounding():
    linkage = FourBar(4.0, 3.0, 2.0, 8.0)
    assert linkage.motion(0.1 + 20.0 * pi).theta4 == pytest.approx(linkage.motion(0.1).theta4,
                                                                   abs=1e-13)
    with pytest.raises(OutOfRange):
        linkage.motion(pi + 20.0 * pi)


def test_dead_points_and_output_ranges():
    counts = {}
    for lengths in random_lengths(np.random.default_rng(43), 300).tolist():
        for mode in (CROSSED, OPEN):
            linkage = FourBar(*lengths, mode=mode)
            points = linkage.dead_points
            counts.setdefault(linkage.classification, set()).add(len(points))
            for theta1, theta4, stretched in points:
                exact = {name: float(value) for name, value in values(linkage, theta1).items()}
                condition = linkage.motion(theta1).condition
                assert abs(remainder(theta4 - exact['theta4'], 2 * pi)) <= 16 * EPS * condition
                assert abs(exact['omega4']) <= 32 * EPS * condition**2
                assert (np.cos(exact['beta'] - theta1) > 0.0) == stretched
                ends = [end for ends in linkage.output_ranges for end in ends]
                assert min(abs(remainder(theta4 - end, 2 * pi)) for end in ends) <= 16 * EPS
    assert counts['Grashof crank-rocker'] == {2}
    assert counts['Grashof double-crank'] == counts['Grashof rocker-crank'] == {0}


# --- the mode holds ------------------------------------------------------------------------------


def test_tab_completion_shows_what_a_user_asks_for():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    motion = linkage.motion(1.0, 25.0)
    assert len(dir(linkage)) <= 30 and {'a1', 'motion', 'dead_points'} <= set(dir(linkage))
    assert 'cos_x' not in dir(motion) and 'cos_x' not in repr(motion)
    assert all(hasattr(linkage, name) for name in dir(linkage))
