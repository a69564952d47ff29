# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reactions, torque, shaking wrench: the paper's linkage, its Eq. (9), power and momentum."""
from dataclasses import astuple
from math import cos, sin

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    CROSSED,
    External,
    FourBar,
    OPEN,
    round_rod,
)
import mpmath as mp
import numpy as np
import pytest
from support.reference import EPS, free_bodies, nine_by_nine, pose, random_lengths, reactions

PAPER = FourBar(0.4, 1.2, 0.8, 1.0, mode=OPEN,
                bodies=Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8))))


def random_loaded(seed, count):
    """Yield random loaded linkages of all classes and modes, and an input (x, w, a)."""
    rng = np.random.default_rng(seed)
    for i, lengths in enumerate(random_lengths(rng, count)):
        bodies = Bodies(*(Body(rng.uniform(0.1, 10.0), *rng.uniform(-1.0, 1.0, 2),
                               rng.uniform(0.0, 1.0))
                          for _ in range(3)))
        linkage = FourBar(*lengths.tolist(), mode=(CROSSED, OPEN)[i % 2], bodies=bodies,
                          gravity=tuple(rng.uniform(-10.0, 10.0, 2).tolist()),
                          external=External(*(Applied(*rng.uniform(-50.0, 50.0, 2),
                                                      *rng.uniform(-1.0, 1.0, 2),
                                                      rng.uniform(-20.0, 20.0))
                                              for _ in range(2))))
        low, high = linkage.input_ranges[-1]
        theta1 = rng.uniform(low + 0.02 * (high - low), high - 0.02 * (high - low))
        yield linkage, (float(theta1), float(rng.normal(0.0, 5.0)), float(rng.normal(0.0, 20.0)))


def exact_links(linkage, theta1, omega1, alpha1):
    """Return the free bodies of the reference for a linkage and an input."""
    place = pose(linkage.lengths, linkage.sign, mp.mpf(theta1))
    given = [[[mp.mpf(v) for v in astuple(item)] for item in items]
             for items in (linkage.bodies, linkage.external)]
    return free_bodies(linkage.lengths, place, mp.mpf(theta1), mp.mpf(omega1), mp.mpf(alpha1),
                       *given, [mp.mpf(g) for g in linkage.gravity])


@pytest.mark.parametrize('field, theta1, value', [
    ('shaking_force', 0.10962848, 2512.318373), ('shaking_moment', 0.21995444, 2048.609105),
    ('driving_torque', 6.21476980, 720.4715562), ('f41', 0.11551325, 3862.925021),
    ('f21', 0.11396259, 3747.46146), ('f32', 0.13068520, 2788.891825),
    ('f43', 0.15042420, 2655.173464)])
def test_largest_loads_of_the_paper_linkage(field, theta1, value):
    """Six engines agree on these (the paper's Table 3 has momenta in place of forces)."""
    assert abs(getattr(PAPER.loads(theta1, 25.0), field)) == pytest.approx(value, rel=3e-10)
    around = PAPER.loads(theta1 + np.linspace(-0.5, 0.5, 2001), 25.0)
    assert np.abs(getattr(around, field)).max() <= value * (1.0 + 3e-10)


def test_closed_form_is_the_nine_by_nine_system_of_the_paper():
    for linkage, theta1 in random_loaded(11, 40):
        links = exact_links(linkage, *theta1)
        exact = nine_by_nine(links)
        motion, loads = linkage.step(*theta1)
        largest = max(abs(v) for v in exact[:4])
        given = [complex(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
                 for name in ('f41', 'f21', 'f32', 'f43')] + [loads.driving_torque]
        for value, truth in zip(given, exact):
            assert abs(truth - value) <= 1e-14 * motion.condition**2 * largest
        assert all(abs(a - b) <= mp.mpf(10)**-100 * largest
                   for a, b in zip(exact, reactions(links)))


def test_single_body_by_hand():
    """Only the crank has a mass: no force in the dyad, pendulum torque at O1."""
    linkage = FourBar(*PAPER.lengths, bodies=Bodies(Body(2.0, 0.25, 0.1, 0.5), Body(0.0),
                                                    Body(0.0)),
                      gravity=(0.0, -9.81))
    theta1, omega1, alpha1 = 0.7, 3.0, -4.0
    loads = linkage.loads(theta1, omega1, alpha1)
    assert (loads.f21, loads.f32, loads.f43) == (0.0, 0.0, 0.0)
    x = 0.25 * cos(theta1) - 0.1 * sin(theta1)
    inertia = 0.5 + 2.0 * (0.25**2 + 0.1**2)
    assert loads.driving_torque == pytest.approx(inertia * alpha1 + 2.0 * 9.81 * x, rel=16 * EPS)
    assert loads.shaking_moment == pytest.approx(-loads.driving_torque, rel=EPS)


def test_rest_under_gravity_carries_the_weight():
    weight = 9.81 * sum(body.mass for body in PAPER.bodies)
    at_rest = FourBar(*PAPER.lengths, bodies=PAPER.bodies, gravity=(0.0, -9.81)).loads(0.8)
    assert at_rest.shaking_force_y == pytest.approx(-weight, rel=8 * EPS)
    assert at_rest.shaking_force_x == pytest.approx(0.0, abs=8 * EPS * weight * at_rest.f41)
    sideways = FourBar(*PAPER.lengths, bodies=PAPER.bodies, gravity=(9.81, 0.0)).loads(0.8)
    assert sideways.shaking_force_x == pytest.approx(weight, rel=8 * EPS)


def test_external_force_on_the_coupler_by_hand():
    """Massless links at rest, a weight hung at B: statics of the two bars."""
    nothing = Bodies(Body(0.0), Body(0.0), Body(0.0))
    hung = FourBar(*PAPER.lengths, bodies=nothing,
                   external=External(coupler=Applied(force_y=-100.0, along=PAPER.a2)))
    motion, loads = hung.step(0.8)
    # two-force member
    assert abs(loads.f43_x * motion.sin_y - loads.f43_y * motion.cos_y) <= 64 * EPS * loads.f43
    assert loads.shaking_force_y == -100.0 and loads.shaking_force_x == 0.0
    # virtual work: torque + (-100) dy_B/dtheta1 = 0
    assert loads.driving_torque == pytest.approx(100.0 * 0.8 * motion.cos_y
                                                 * motion.velocity_ratio, rel=1e-13)
    same = FourBar(*PAPER.lengths, bodies=nothing,
                   external=External(output=Applied(force_y=-100.0, along=PAPER.a3)))
    assert same.loads(0.8).driving_torque == pytest.approx(loads.driving_torque, rel=1e-13)
    assert (same.loads(0.8).f43_x, same.loads(0.8).f41) == pytest.approx((loads.f43_x, loads.f41),
                                                                         rel=1e-12)


def test_couple_on_the_output_link_is_carried_by_the_crank():
    brake = FourBar(*PAPER.lengths, bodies=Bodies(Body(0.0), Body(0.0), Body(0.0)),
                    external=External(output=Applied(couple=-50.0)))
    motion, loads = brake.step(0.8, 25.0)
    assert loads.driving_torque == pytest.approx(50.0 * motion.velocity_ratio, rel=16 * EPS)
    assert loads.shaking_force == 0.0 and loads.shaking_moment == -50.0
