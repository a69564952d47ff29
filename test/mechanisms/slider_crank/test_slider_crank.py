# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The slider-crank, driven by its crank or its slider."""
from math import inf, nan, nextafter, pi, radians, remainder

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    InvalidParameter,
)
from fourbar_ros.mechanisms.parts import CRANK, SLIDE
from fourbar_ros.mechanisms.sliders import SliderCrank
import mpmath as mp
import numpy as np
import pytest
from support import contract
from support.cartesian import EPS

KINDS = [(SliderCrank, CRANK), (SliderCrank, SLIDE)]
CASE = next(case for case in contract.CASES if case.name == 'slider_crank')
both_inputs = pytest.mark.parametrize('kind', KINDS, ids=lambda kind: kind[1])


# --- what it does --------------------------------------------------------------------------------

def test_example_7_2():
    """
    Crank 2.5 in at 30 deg and 1800 rpm cw, coupler 6 in.

    w3 69.5 rad/s, a3 6538 rad/s^2, slider 8095 ft/s^2.
    """
    motion = SliderCrank(2.5, 6.0).motion(radians(30.0), -60.0 * pi)
    assert (motion.omega_beta, motion.alpha_beta,
            motion.slide_acceleration / 12.0) == pytest.approx(
        (69.54, 6538.1, -8094.5), rel=1e-4)


# --- classes, limits, dead points ----------------------------------------------------------------

@pytest.mark.parametrize('lengths, name', [
    ((2.5, 6.0, 0.0), 'Grashof crank-slider'), ((2.5, 6.0, -3.4), 'Grashof crank-slider'),
    ((2.5, 6.0, 3.5), 'change point'), ((2.5, 6.0, -3.6), 'non-Grashof rocker-slider'),
    ((6.0, 2.5, 3.4), 'Grashof rocker-slider'), ((6.0, 2.5, 3.5), 'change point'),
    ((1.0, 1.0, 0.0), 'change point'),
    ((6.0, 2.5, 8.4), 'non-Grashof rocker-slider')])
def test_classes(lengths, name):
    assert SliderCrank(*lengths).classification == name
    assert (SliderCrank(*lengths).change_point_margin == 0.0) == (name == 'change point')


def test_limits_are_exact_to_the_last_bits():
    rng = np.random.default_rng(95)
    for family in ('random', 'near the limit of the offset', 'near a change point'):
        for _ in range(60):
            a1, a2, e = contract.draw(rng, CASE, family)[0]
            for low, high in SliderCrank(a1, a2, e).input_ranges:
                for end in (low, high) if high - low < 2.0 * pi else ():
                    # of B from A, across the guide
                    side = mp.sign(mp.mpf(e) - a1 * mp.sin(mp.mpf(end)))
                    angle = mp.asin((mp.mpf(e) - side * a2) / a1)
                    distance = min(abs(end - mp.mpf(other) - turn * mp.pi)
                                   for turn in (-2, -1, 0, 1, 2)
                                   for other in (angle, -angle))
                    assert (distance <= 4 * EPS * max(1.0, abs(end)) or distance
                            <= 4 * EPS * abs(end))
            for low, high in SliderCrank(a1, a2, e, input=SLIDE).input_ranges:
                for end in (low, high):
                    squares = [(mp.mpf(a1) + k * mp.mpf(a2))**2 - mp.mpf(e)**2 for k in (-1, 1)]
                    assert min(abs(abs(end) - mp.sqrt(s)) for s in squares
                               if s >= 0) <= 4 * EPS * abs(end)


def test_dead_points():
    """The slider stalls there; they are the limits of the slide as an input."""
    rng = np.random.default_rng(96)
    for _ in range(200):
        lengths, mode = contract.draw(rng, CASE)[0], int(rng.integers(1, 3))
        mechanism = SliderCrank(*lengths, mode=mode)
        if abs(mechanism.a1 - mechanism.a2) < 0.05 or mechanism.change_point_margin < 1e-3:
            continue
        assert len(mechanism.dead_points) == (2 if 'Grashof ' in mechanism.classification[:8]
                                              else 1)
        ends = [end for ends in SliderCrank(*lengths, input=SLIDE).input_ranges for end in ends]
        for theta1, slide, stretched in mechanism.dead_points:
            motion = mechanism.motion(theta1, 1.0)
            assert abs(motion.slide_velocity) <= 64 * EPS * motion.condition / abs(motion.cos_b)
            assert motion.slide == pytest.approx(slide, abs=16 * EPS * motion.condition)
            assert (motion.cos_2 > 0.0) == stretched
            assert min(abs(slide - end) for end in ends) <= 8 * EPS * abs(slide)
    assert SliderCrank(2.5, 6.0, input=SLIDE).dead_points == ()


@both_inputs
def test_offset_at_and_past_its_limit(kind):
    for offset in (8.5, -8.5, 9.0, inf, nan):
        with pytest.raises(InvalidParameter, match='^offset = '):
            SliderCrank(2.5, 6.0, offset, input=kind[1])
    inside = SliderCrank(2.5, 6.0, nextafter(8.5, 0.0), input=kind[1])
    (low, high), = inside.input_ranges
    middle = inside.motion(0.5 * (low + high), 1.0)
    assert 0.0 < high - low < 1e-6
    assert (middle.sin_b, middle.sin_x) == pytest.approx((1.0, 1.0), abs=1e-14)
    # the crank's limit: full turns up to |offset| = a2 - a1, not beyond
    assert (SliderCrank(2.5, 6.0, 3.5).turns_fully
            and not SliderCrank(2.5, 6.0, nextafter(3.5, 4.0)).turns_fully)


# --- loads by hand -------------------------------------------------------------------------------

def test_gas_force_on_the_piston():
    """Massless links: the coupler carries the force, the torque is that of virtual work."""
    nothing = Bodies(Body(0.0), Body(0.0), Body(0.0))
    push = External(output=Applied(force_x=-1000.0, across=0.02))
    for e in (0.0, 0.05):
        m, loads = SliderCrank(0.1, 0.3, e, bodies=nothing, external=push).step(0.8, 30.0)
        assert loads.driving_torque == pytest.approx(1000.0 * m.slide_ratio, rel=1e-14)
        # two-force member
        assert abs(loads.f32_x * m.sin_b - loads.f32_y * m.cos_b) <= 8 * EPS * loads.f32
        assert loads.guide_force == pytest.approx(-1000.0 * m.sin_b / m.cos_b, rel=1e-13)
        # turns the slider back: 0.02 m x 1000 N
        assert loads.guide_couple == pytest.approx(-20.0, rel=4 * EPS)
        assert loads.f43_x == 0.0 and loads.shaking_force_x == -1000.0
        m, loads = SliderCrank(0.1, 0.3, e, mode=1, input=SLIDE, bodies=nothing,
                               external=push).step(0.25)
        assert loads.driving_force == 1000.0 and loads.f21 == loads.f32 == 0.0


def test_a_long_output_link_makes_a_slider_of_the_four_bar():
    """
    The modes are those of a 4R whose output link is very long, below the guide.

    theta4 = pi/2.
    """
    from fourbar_ros import FourBar
    a1, a2, e, far = 0.1, 0.3, 0.02, 1e6
    for mode in (1, 2):
        slider = SliderCrank(a1, a2, e, mode)
        middle = slider.motion(0.8).slide
        # O4 below the middle of the stroke; the 4R's x axis runs from O1 to it
        ground = complex(middle, e - far)
        turn = np.angle(ground)
        four = FourBar(a1, a2, far, abs(ground), mode=mode)
        m, s = four.motion(0.8 - turn, 3.0), slider.motion(0.8, 3.0)
        assert remainder(m.beta + turn - s.beta, 2.0 * pi) == pytest.approx(0.0, abs=1e-6)
        assert m.omega_beta == pytest.approx(s.omega_beta, rel=1e-5)
        assert m.transmission_angle == pytest.approx(s.transmission_angle, abs=1e-6)
        assert -far * m.omega4 == pytest.approx(s.slide_velocity, rel=1e-5)
