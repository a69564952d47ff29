# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The inverted slider-crank.

Rocking block (crank input) and oscillating cylinder (slide input).
"""
from math import inf, nan, nextafter, pi, radians, remainder

from fourbar_ros import (
    Bodies,
    Body,
    InvalidParameter,
)
from fourbar_ros.mechanisms.parts import CRANK, SLIDE
from fourbar_ros.mechanisms.sliders import InvertedSlider, SliderCrank
import mpmath as mp
import numpy as np
import pytest
from support import contract
from support.cartesian import EPS

KINDS = [(InvertedSlider, CRANK), (InvertedSlider, SLIDE)]
NAME = ('inverted_slider',)
CASE = next(case for case in contract.CASES if case.name == 'inverted_slider')
both_inputs = pytest.mark.parametrize('kind', KINDS, ids=lambda kind: kind[1])


# --- what it does --------------------------------------------------------------------------------


def test_example_7_5():
    """
    Crank 3 in at 30 deg to the ground of 14 in, 36 rad/s cw. Of the offset the text says nothing.

    Read off the drawing: w4 7.55 rad/s, V_rel 5.52 ft/s, a4 283 rad/s^2. Without offset we have
    7.45, 5.48 and 291 (1.3, 0.8, 2.9 % off); with the 2 in of AB to either side w4 is 12 to 15 %
    off.
    """
    given, drawn = (radians(30.0), -36.0, 0.0), np.array([7.55, 5.52 * 12.0, 283.0])
    for h, share in ((0.0, (0.0, 0.03)), (2.0, (0.1, 0.2)), (-2.0, (0.1, 0.2))):
        m = InvertedSlider(3.0, 14.0, h).motion(*given)
        values = (m.omega4, -m.slide_velocity, m.alpha4)
        assert share[0] < np.abs(values / drawn - 1.0).max() < share[1]


def test_the_cylinder_is_the_slider_crank_seen_from_its_bar():
    for mechanism, given in contract.ordinary_of(NAME, 110, 30, SLIDE):
        m = mechanism.motion(*given)
        seen = SliderCrank(mechanism.a4, mechanism.a1, mechanism.offset, 3 - mechanism.mode,
                           SLIDE).motion(*given)
        assert remainder(m.theta4 - (pi - seen.theta1),
                         2.0 * pi) == pytest.approx(0.0, abs=4 * EPS)
        assert (m.omega4, m.alpha4, m.omega1) == (-seen.omega1, -seen.alpha1, seen.omega2)


# --- classes, limits, dead points ----------------------------------------------------------------

@pytest.mark.parametrize('lengths, name', [
    ((3.0, 14.0, 0.0), 'Grashof crank-rocker'), ((3.0, 14.0, -10.9), 'Grashof crank-rocker'),
    ((3.0, 14.0, 11.0), 'change point'), ((3.0, 14.0, 11.1), 'non-Grashof double-rocker'),
    ((6.0, 2.5, 3.4), 'Grashof double-crank'), ((6.0, 2.5, -3.5), 'change point'),
    ((1.0, 1.0, 0.0), 'change point'),
    ((6.0, 2.5, 8.4), 'non-Grashof double-rocker')])
def test_classes(lengths, name):
    mechanism = InvertedSlider(*lengths)
    assert mechanism.classification == name
    assert (mechanism.change_point_margin == 0.0) == (name == 'change point')
    if name.startswith('Grashof'):
        assert mechanism.turns_fully
        turns = (np.diff(np.unwrap(mechanism.motion(np.linspace(-pi, pi, 2001)).theta4)).sum()
                 / (2.0 * pi))
        assert turns == pytest.approx(1.0 if name.endswith('double-crank') else 0.0, abs=1e-12)


def test_limits_are_exact_to_the_last_bits():
    rng = np.random.default_rng(114)
    for family in ('random', 'near the limit of the offset', 'near a change point'):
        for _ in range(60):
            a1, a4, h = contract.draw(rng, CASE, family)[0]
            for low, high in (InvertedSlider(a1, a4, h).input_ranges if abs(a1 - a4) < abs(h)
                              else ()):
                limit = mp.acos((mp.mpf(a1)**2 + mp.mpf(a4)**2 - mp.mpf(h)**2)
                                / (2 * mp.mpf(a1) * a4))
                assert (abs(low - limit) <= 4 * EPS * limit and abs(high - (2 * mp.pi - limit))
                        <= 4 * EPS * high)
            for low, high in InvertedSlider(a1, a4, h, input=SLIDE).input_ranges:
                for end in (low, high):
                    squares = [(mp.mpf(a1) + k * mp.mpf(a4))**2 - mp.mpf(h)**2 for k in (-1, 1)]
                    assert min(abs(abs(end) - mp.sqrt(s)) for s in squares
                               if s >= 0) <= 4 * EPS * abs(end)


def test_dead_points_of_the_bar():
    """The crank is square to the bar, which stalls there; an oscillating block has two."""
    rng = np.random.default_rng(115)
    for _ in range(200):
        lengths, mode = contract.draw(rng, CASE)[0], int(rng.integers(1, 3))
        mechanism = InvertedSlider(*lengths, mode=mode)
        counts = {'Grashof crank-rocker': {2}, 'Grashof double-crank': {0},
                  'non-Grashof double-rocker': {0, 1}}
        assert len(mechanism.dead_points) in counts[mechanism.classification]
        for theta1, theta4 in mechanism.dead_points:
            motion = mechanism.motion(theta1, 1.0)
            assert abs(motion.omega4) <= 64 * EPS * (1.0 + motion.condition)**2
            assert abs(remainder(motion.theta4 - theta4,
                                 2.0 * pi)) <= 16 * EPS * (1.0 + motion.condition)
    assert InvertedSlider(2.5, 6.0, input=SLIDE).dead_points == ()


@both_inputs
def test_offset_at_and_past_its_limit(kind):
    for offset in (8.5, -8.5, 9.0, inf, nan):
        with pytest.raises(InvalidParameter, match='^offset = '):
            InvertedSlider(2.5, 6.0, offset, input=kind[1])
    inside = InvertedSlider(2.5, 6.0, nextafter(8.5, 0.0), input=kind[1])
    (low, high), = inside.input_ranges
    middle = inside.motion(low + 0.3 * (high - low), 1.0)
    assert 0.0 < high - low < 1e-6 and middle.cos_x == pytest.approx(-1.0, abs=1e-14)
    # all in one line, the bar square to it
    assert middle.sin_y == pytest.approx(1.0, abs=1e-14)
    assert (InvertedSlider(2.5, 6.0, 3.5).turns_fully
            and not InvertedSlider(2.5, 6.0, nextafter(3.5, 4.0)).turns_fully)


# --- loads by hand -------------------------------------------------------------------------------

def test_an_excavator_at_rest():
    """
    A load on the boom (crank).

    Cylinder force from moments about O1, no offset, so a two-force member.
    """
    weight = Bodies(Body(100.0, 2.0), Body(0.0), Body(0.0))
    cylinder = InvertedSlider(1.0, 2.0, mode=2, input=SLIDE, bodies=weight, gravity=(0.0, -9.81))
    m, loads = cylinder.step(2.1)
    assert abs(loads.guide_force) <= EPS * loads.f41 and loads.guide_couple == 0.0
    arm = m.cos_x * m.sin_y - m.sin_x * m.cos_y
    assert loads.driving_force * arm == pytest.approx(9.81 * 100.0 * 2.0 * m.cos_x, rel=1e-14)
    assert loads.f21 == pytest.approx(abs(loads.driving_force), rel=4 * EPS) == loads.f43
    assert loads.shaking_force_y == pytest.approx(-981.0, rel=4 * EPS)
