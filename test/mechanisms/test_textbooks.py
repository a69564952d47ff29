# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Harmonic motion and loads by hand; examples of a lecture are in ``fourbar reproduce``."""
from math import cos, pi, remainder, sin

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    FourBar,
    InvalidParameter,
    InvertedSlider,
    ScotchYoke,
    SliderCrank,
    Toggle,
)
import pytest
from support import contract
from support.cartesian import EPS

MASSES = Bodies(Body(2.0, inertia=0.1), Body(0.3), Body(4.0))


def test_harmonic_motion_of_a_textbook():
    """Any textbook: s = r cos wt, v = -r w sin wt, a = -r w^2 cos wt; shaking of yoke, block."""
    r, w = 0.1, 30.0
    yoke = ScotchYoke(r, bodies=MASSES)
    for t in (0.0, 0.01, 0.04, 0.07):
        motion, loads = yoke.step(w * t, w)
        assert motion.slide == pytest.approx(r * cos(w * t), abs=1e-16)
        assert motion.slide_velocity == pytest.approx(-r * w * sin(w * t), abs=1e-14)
        assert motion.slide_acceleration == pytest.approx(-r * w**2 * cos(w * t), abs=1e-12)
        assert loads.shaking_force_x == pytest.approx((4.0 + 0.3) * r * w**2 * cos(w * t),
                                                      abs=1e-11)
        assert loads.shaking_force_y == pytest.approx(0.3 * r * w**2 * sin(w * t), abs=1e-11)
        assert (loads.f32_x == pytest.approx(4.0 * r * w**2 * cos(w * t), abs=1e-11)
                and loads.f32_y == 0.0)
        assert loads.driving_torque == pytest.approx(0.5 * 4.0 * r**2 * w**2 * sin(2.0 * w * t),
                                                     abs=1e-11)


def test_a_yoke_has_one_mode_and_stalls_at_both_ends():
    with pytest.raises(InvalidParameter, match='one assembly mode'):
        ScotchYoke(0.1, mode=1)
    assert [tuple(point) for point in ScotchYoke(0.1).dead_points] == [(-pi, -0.1), (0.0, 0.1)]
    with pytest.raises(Toggle):
        ScotchYoke(0.1, input='slide').motion(0.1, 1.0)


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
        m, loads = SliderCrank(0.1, 0.3, e, mode=1, input='slide', bodies=nothing,
                               external=push).step(0.25)
        assert loads.driving_force == 1000.0 and loads.f21 == loads.f32 == 0.0


def test_an_excavator_at_rest():
    """A load on the boom (crank): the cylinder is a two-force member, from moments about O1."""
    weight = Bodies(Body(100.0, cg_along=2.0), Body(0.0), Body(0.0))
    cylinder = InvertedSlider(1.0, 2.0, mode=2, input='slide', bodies=weight, gravity=(0.0, -9.81))
    m, loads = cylinder.step(2.1)
    assert abs(loads.guide_force) <= EPS * loads.f41 and loads.guide_couple == 0.0
    arm = m.cos_x * m.sin_y - m.sin_x * m.cos_y
    assert loads.driving_force * arm == pytest.approx(9.81 * 100.0 * 2.0 * m.cos_x, rel=1e-14)
    assert loads.f21 == pytest.approx(abs(loads.driving_force), rel=4 * EPS) == loads.f43
    assert loads.shaking_force_y == pytest.approx(-981.0, rel=4 * EPS)


# --- what a user sees ----------------------------------------------------------------------------

def test_what_a_four_bar_says_twice_is_the_same():
    for mechanism, given in contract.ordinary_of(('four_bar',), 3, 20, 'crank'):
        m = mechanism.motion(*given)
        assert m.omega4 == pytest.approx(m.omega1 * m.velocity_ratio, rel=8 * EPS)
        mu = remainder(m.theta4 - m.beta, 2.0 * pi)
        assert m.transmission_angle == pytest.approx(abs(mu), abs=16 * EPS)
        for c, s, angle in ((m.cos_x, m.sin_x, m.theta1), (m.cos_b, m.sin_b, m.beta),
                            (m.cos_y, m.sin_y, m.theta4)):
            assert (c, s) == pytest.approx((cos(angle), sin(angle)), abs=16 * EPS)
        assert m.sine == pytest.approx(sin(mu), abs=16 * EPS)


def test_tab_completion_shows_what_a_user_asks_for():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    motion = linkage.motion(1.0, 25.0)
    assert len(dir(linkage)) <= 36 and {'a1', 'motion', 'dead_points'} <= set(dir(linkage))
    assert 'cos_x' not in dir(motion) and 'cos_x' not in repr(motion)
    assert all(hasattr(linkage, name) for name in dir(linkage))
