# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Classes, limits of the input, dead points of every kind: in closed form with many digits."""
from dataclasses import replace
from functools import partial
from math import inf, nan, nextafter, pi, remainder

from fourbar_ros import (
    FourBar,
    InvalidParameter,
    InvertedSlider,
    load_scene,
    ScotchYoke,
    SliderCrank,
    Toggle,
)
from fourbar_ros.extrema.over_input import dead_points, output_ranges, turning_points
from fourbar_ros.mechanisms.four_bars import MovingJointFourBar
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np
import pytest
from support import contract
from support.cartesian import EPS, values
from support.contract import random_lengths

# --- classes -------------------------------------------------------------------------------------


def reachable(lengths, angles):
    """Return whether the diagonal is between |a2 - a3| and a2 + a3 at these input angles."""
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


def test_eight_classes_of_four_bars_by_brute_force():
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


@pytest.mark.parametrize('mechanism, name', [
    (SliderCrank(2.5, 6.0), 'Grashof crank-slider'),
    (SliderCrank(2.5, 6.0, -3.4), 'Grashof crank-slider'),
    (SliderCrank(2.5, 6.0, -3.6), 'non-Grashof rocker-slider'),
    (SliderCrank(6.0, 2.5, 3.4), 'Grashof rocker-slider'),
    (SliderCrank(6.0, 2.5, 8.4), 'non-Grashof rocker-slider'),
    (InvertedSlider(3.0, 14.0), 'Grashof crank-rocker'),
    (InvertedSlider(3.0, 14.0, -10.9), 'Grashof crank-rocker'),
    (InvertedSlider(3.0, 14.0, 11.1), 'non-Grashof double-rocker'),
    (InvertedSlider(6.0, 2.5, 3.4), 'Grashof double-crank'),
    (InvertedSlider(6.0, 2.5, 8.4), 'non-Grashof double-rocker')])
def test_classes_of_sliders(mechanism, name):
    assert mechanism.classification == name and mechanism.change_point_margin > 0.0
    is_crank = name.startswith(('Grashof crank', 'Grashof double-crank'))
    assert mechanism.turns_fully == is_crank
    if is_crank and isinstance(mechanism, InvertedSlider):
        theta4 = mechanism.motion(np.linspace(-pi, pi, 2001)).theta4
        turns = np.diff(np.unwrap(theta4)).sum() / (2.0 * pi)
        assert turns == pytest.approx(1.0 if name.endswith('double-crank') else 0.0, abs=1e-12)


@pytest.mark.parametrize('kind, lengths', [
    *((FourBar, lengths) for lengths in (
        (2.0, 4.0, 3.0, 5.0), (2.0, 3.0, 2.0, 3.0), (2.0, 2.0, 3.0, 3.0), (2.0, 3.0, 3.0, 2.0),
        (1.0, 1.0, 1.0, 1.0))),
    (SliderCrank, (2.5, 6.0, 3.5)), (SliderCrank, (6.0, 2.5, -3.5)),
    (SliderCrank, (1.0, 1.0, 0.0)),
    (InvertedSlider, (3.0, 14.0, 11.0)), (InvertedSlider, (6.0, 2.5, -3.5)),
    (InvertedSlider, (1.0, 1.0, 0.0))])
def test_change_points_are_exact(kind, lengths):
    mechanism = kind(*lengths)
    assert mechanism.classification == 'change point' and mechanism.change_point_margin == 0.0
    rounded = kind(lengths[0] * (1.0 + 2.0 * EPS), *lengths[1:])
    assert rounded.classification == 'change point' and rounded.change_point_margin == 0.0
    size = sum(map(abs, lengths))
    off = kind(lengths[0] + 6.0 * EPS * size, *lengths[1:])
    assert off.classification != 'change point'
    assert 4.0 * EPS < off.change_point_margin < 8.0 * EPS


# --- limits of the input -------------------------------------------------------------------------

def exact_ends(mechanism):
    """Return where the input of a linkage can end, positive ones, by the law of cosines."""
    one, other, *_, e = lengths = [mp.mpf(length) for length in mechanism.lengths]
    if isinstance(mechanism, FourBar):
        cosines = [(one**2 + e**2 - (other + k * lengths[2])**2) / (2 * one * e) for k in (-1, 1)]
    elif mechanism.is_driven_by_slide:
        squares = [(one + k * other)**2 - e**2 for k in (-1, 1)]
        return [mp.sqrt(square) for square in squares if square >= 0]
    elif isinstance(mechanism, SliderCrank):
        return [abs(end) for k in (-1, 1) if abs(e + k * other) <= one
                for angle in [mp.asin((e + k * other) / one)] for turn in (-2, -1, 0, 1, 2)
                for end in (turn * mp.pi + angle, turn * mp.pi - angle)]
    else:
        cosines = [(one**2 + other**2 - e**2) / (2 * one * other)]
    return [end for cosine in cosines if abs(cosine) <= 1 for angle in [mp.acos(cosine)]
            for end in (angle, 2 * mp.pi - angle)]


@pytest.mark.parametrize('case', [case for case in contract.CASES if case.mode == 2
                                  and case.name != 'scotch_yoke' and case.driven not in 'AB'],
                         ids=contract.name_of)
def test_limits_are_exact_to_the_last_bits(case):
    rng = np.random.default_rng(95)
    families = {'random', 'near a change point', 'near the limit of the offset'}
    for family in families & contract.families_of(case).keys():
        for _ in range(60):
            mechanism = case.make(contract.draw(rng, case, family)[0])
            for end in () if mechanism.turns_fully else np.ravel(mechanism.input_ranges).tolist():
                assert min(abs(abs(end) - exact) for exact in exact_ends(mechanism)) <= (
                    4 * EPS * abs(end))


def test_toggle_raises_for_one_value_and_is_nan_in_arrays():
    """A limit is rounded: a toggle from at least one side, and nothing there is finite."""
    for lengths in ((4.0, 3.0, 2.0, 8.0), (3.0, 2.0, 4.0, 3.5), (1.0, 0.5, 0.25, 0.5)):
        linkage = FourBar(*lengths)
        for end in (end for bounds in linkage.input_ranges for end in bounds):
            outcomes = set()
            for theta1 in (nextafter(end, -9.0), end, nextafter(end, 9.0)):
                try:
                    motion = linkage.motion(theta1, 1.0)
                    assert abs(motion.sine) < 1e-7 and abs(motion.omega4) > 1e5
                    outcomes.add('finite')
                except Toggle:
                    assert not np.isfinite(linkage.motion([theta1], 1.0).omega4[0])
                    outcomes.add('toggle')
            assert 'toggle' in outcomes


@pytest.mark.parametrize('driven', ['crank', 'slide'])
@pytest.mark.parametrize('kind', [SliderCrank, InvertedSlider])
def test_offset_at_and_past_its_limit(kind, driven):
    for offset in (8.5, -8.5, 9.0, inf, nan):
        with pytest.raises(InvalidParameter, match='^offset = '):
            kind(2.5, 6.0, offset, input=driven)
    # what is less than 4 eps of the lengths is none
    with pytest.raises(InvalidParameter, match='^offset = '):
        kind(2.5, 6.0, nextafter(8.5, 0.0), input=driven)
    (low, high), = kind(2.5, 6.0, 8.5 - 6.0 * EPS * 17.0, input=driven).input_ranges
    assert 0.0 < high - low < 2e-6
    # the crank's limit: full turns up to |offset| = a2 - a1, not beyond
    assert kind(2.5, 6.0, 3.5).turns_fully and kind(2.5, 6.0, nextafter(3.5, 4.0)).turns_fully
    assert not kind(2.5, 6.0, 3.5 + 6.0 * EPS * 12.0).turns_fully


# --- dead points ---------------------------------------------------------------------------------

COUNTS = {'Grashof crank-rocker': {2}, 'Grashof double-crank': {0}, 'Grashof rocker-crank': {0},
          'Grashof double-rocker': {2}, 'Grashof crank-slider': {2}, 'Grashof rocker-slider': {2},
          'non-Grashof rocker-slider': {1}}


CRANKS = [case for case in contract.CASES if case.driven == 'crank' and case.name != 'scotch_yoke']


@pytest.mark.parametrize('case', CRANKS, ids=contract.name_of)
def test_the_output_stalls_at_dead_points(case):
    """Its angle or way is extreme there, an end of its range."""
    rng = np.random.default_rng(96)
    for _ in range(60):
        mechanism = case.make(contract.draw(rng, case)[0])
        if mechanism.change_point_margin < 1e-3 or abs(np.subtract(*mechanism.lengths[:2])) < 0.05:
            continue
        output = mechanism.outputs[0].coordinate
        ends = np.ravel(mechanism.output_ranges if case.name == 'four_bar' else
                        replace(mechanism, input='slide').input_ranges
                        if case.name == 'slider_crank' else [])
        points = mechanism.dead_points
        assert len(points) in COUNTS.get(mechanism.classification, {0, 1, 2})
        for theta1, place, *stretched in points:
            exact, motion = values(mechanism, theta1), mechanism.motion(theta1, 1.0)
            bound = 64 * EPS * (1.0 + motion.condition)
            assert abs(exact[output.rate]) <= bound * (1.0 + motion.condition)
            assert is_near(place, float(exact[output.position]), output, bound)
            assert not ends.size or any(is_near(place, end, output, bound) for end in ends)
            for is_stretched in stretched:
                assert (mp.cos(exact['theta2']) > 0) == is_stretched


@pytest.mark.parametrize('mechanism', [
    FourBar(0.1, 0.5, 0.2, 0.4), FourBar(0.2, 0.5, 0.5, 0.2), FourBar(0.2, 0.5, 0.2, 0.5),
    FourBar(0.25, 0.25, 0.4, 0.4), FourBar(0.5, 0.2, 0.2, 0.5), FourBar(0.4, 0.4, 0.4, 0.4),
    SliderCrank(0.1, 0.1), SliderCrank(0.1, 0.3, 0.2), SliderCrank(0.1, 0.3, -0.2),
    SliderCrank(0.3, 0.1, 0.2), InvertedSlider(0.3, 0.5, 0.2), InvertedSlider(0.3, 0.3),
    InvertedSlider(0.3, 0.1, 0.2), InvertedSlider(0.3, 0.5, -0.2)],
    ids=lambda mechanism: f'{mechanism.TITLE} {mechanism.lengths}')
@pytest.mark.parametrize('mode', [1, 2])
def test_dead_points_of_a_change_point_are_all_sign_changes_of_the_rate_in_its_branch(
        mechanism, mode):
    mechanism = mechanism.in_mode(mode)
    assert mechanism.flat_inputs
    output = mechanism.outputs[0].coordinate
    low, high = ((0.0, mechanism.period) if mechanism.turns_fully else mechanism.input_ranges[0])
    x = np.linspace(low, high, 20002)[1:-1] + 0.1 * mechanism.turns_fully
    rates = getattr(mechanism.motion(x, 1.0), output.rate)
    if np.nanmax(np.abs(rates)) < 1e-9:                  # it stands still
        assert mechanism.dead_points == ()
        return
    changes = np.sign(rates[:-1]) * np.sign(rates[1:]) < 0.0
    period, half = mechanism.period, 0.5 * (x[1] - x[0])
    found = sorted((x[:-1][changes] + half + 0.01) % period - 0.01)     # one may lie at 0
    points = sorted((point[0] + 0.01) % period - 0.01 for point in mechanism.dead_points)
    assert found == pytest.approx(points, abs=1.01 * half)
    for theta1, place, *_ in mechanism.dead_points:
        motion = mechanism.motion(theta1, 1.0)
        assert is_near(place, getattr(motion, output.position), output, 1e-14)
        assert abs(getattr(motion, output.rate)) < 1e-14


def is_near(one, other, coordinate, bound):
    """Return whether two values of a coordinate are as near as this, angles modulo a turn."""
    apart = one - other
    if coordinate.position.startswith('theta'):
        apart = remainder(apart, 2.0 * pi)
    return abs(apart) <= bound


@pytest.mark.parametrize('kind', [SliderCrank, InvertedSlider])
def test_a_driven_slide_has_no_dead_points_of_a_crank_that_turns_fully(kind):
    assert kind(2.5, 6.0, input='slide').dead_points == ()


KINDS = {'slider-crank by its slide': partial(SliderCrank, input='slide'),
         'inverted one by its slide': partial(InvertedSlider, input='slide'),
         'yoke by its slide': lambda a1, *_, mode: ScotchYoke(a1, mode=mode, input='slide'),
         'four-bar at A': partial(MovingJointFourBar, input='A'),
         'four-bar at B': partial(MovingJointFourBar, input='B'),
         'four-bar': FourBar, 'slider-crank': SliderCrank, 'inverted': InvertedSlider}


@pytest.mark.parametrize('name', KINDS)
def test_dead_points_of_every_drive_are_the_extrema_of_its_output(name):
    """Without the drives at a slide, at A and at B there were none in Python."""
    rng, count = np.random.default_rng(3), 0
    for _ in range(16):
        lengths, mode = rng.uniform(0.2, 1.2, 4), int(rng.integers(1, 3))
        if name in ('four-bar', 'four-bar at A', 'four-bar at B'):
            numbers = lengths
        else:
            numbers = *lengths[:2], lengths[2] - 0.6
        try:
            mechanism = KINDS[name](*numbers, mode=mode)
        except InvalidParameter:
            continue
        output = mechanism.outputs[0].coordinate
        extrema = sorted((point.input, point.value) for point in turning_points(mechanism))
        assert dead_points(mechanism) == mechanism.dead_points
        assert len(extrema) == len(mechanism.dead_points)
        count += len(extrema)
        for x, place, *_ in mechanism.dead_points:
            assert any(abs(mechanism.distance(x, at)) < 1e-7
                       and is_near(place, value, output, 1e-12) for at, value in extrema)
            rate = getattr(mechanism.motion(x, 1.0), output.rate)
            assert abs(rate) <= 64 * EPS * (1.0 + mechanism.motion(x).condition)**2
    assert count > 4 or name == 'yoke by its slide'


@pytest.mark.parametrize('kind', [
    ScotchYoke(0.3), SliderCrank(0.1, 0.3), MovingJointFourBar(0.3, 1.0, 0.9, 0.8, input='A'),
    FourBar(0.1, 0.5, 0.2, 0.4)], ids=lambda kind: kind.TITLE)
def test_dead_points_lie_within_the_period_from_minus_pi_on(kind):
    at = [point[0] for point in kind.dead_points]
    assert at == sorted(at) and all(-pi <= x < kind.period - pi for x in at)


def test_a_yoke_and_its_machine_have_dead_points_at_the_same_inputs():
    yoke = Machine([Dyad('d', 'RPP', Point('crank', 0.3), Point('ground'), ('block', 'yoke'),
                         direction_2=0.0, slot=pi / 2)], output='yoke')
    for of_kind, of_machine in zip(ScotchYoke(0.3).dead_points, dead_points(yoke), strict=True):
        assert of_machine[0] == pytest.approx(of_kind[0], abs=1e-9)


def test_a_machine_has_its_dead_points_from_the_search():
    with pytest.raises(AttributeError):         # () would say that there are none
        load_scene('watt').linkage.dead_points
    assert dead_points(load_scene('watt').linkage)


@pytest.mark.parametrize('scale', [2.0**-560, 2.0**-400, 2.0**520, 2.0**900])
@pytest.mark.parametrize('mode', [1, 2])
def test_dead_points_and_swept_ranges_do_not_depend_on_the_unit(scale, mode):
    """Products of lengths overflowed or were 0: other dead points, none, or a bare error."""
    for kind, lengths in ((FourBar, (0.4, 1.2, 0.8, 1.0)), (SliderCrank, (0.3, 1.0, 0.1)),
                          (InvertedSlider, (0.3, 1.0, 0.1))):
        plain, other = (kind(*[length * by for length in lengths], mode=mode)
                        for by in (1.0, scale))
        per = 1.0 / scale if kind is SliderCrank else 1.0
        assert [(theta1, place * per, *rest) for theta1, place, *rest in other.dead_points] == [
            tuple(point) for point in plain.dead_points] != []
        (one,), (two,) = output_ranges(plain), output_ranges(other)
        assert (two.low * per, two.high * per) == pytest.approx((one.low, one.high), rel=64 * EPS)
