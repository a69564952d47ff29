# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Position, velocity and acceleration.

The seeds' numbers, the loop, the number types, the symmetries.
"""
from math import cos, nextafter, pi, sin

from fourbar_ros import CROSSED, FourBar, OPEN, Toggle
import numpy as np
import pytest
from support.cartesian import EPS
from support.contract import random_lengths


def angle_difference(one, other):
    """Return one - other modulo 2 pi, in [-pi, pi]; NaN stays NaN."""
    return np.remainder(np.asarray(one) - other + pi, 2.0 * pi) - pi


def random_motions(seed, count=200):
    """Yield linkages of all classes in both modes with a theta1 they can reach."""
    rng = np.random.default_rng(seed)
    for i, lengths in enumerate(random_lengths(rng, count)):
        linkage = FourBar(*lengths.tolist(), mode=(CROSSED, OPEN)[i % 2])
        low, high = linkage.input_ranges[-1]
        yield linkage, float(rng.uniform(low + 0.01 * (high - low), high - 0.01 * (high - low)))


# --- the seeds' numbers --------------------------------------------------------------------------


# --- against the reference -----------------------------------------------------------------------


def test_fields_are_consistent():
    for linkage, theta1 in random_motions(3, 50):
        m = linkage.motion(theta1, 2.0, 5.0)
        assert angle_difference(m.theta1 + m.theta2 + m.theta3,
                                m.theta4 + pi) == pytest.approx(0.0, abs=16 * EPS)
        assert angle_difference(m.beta, theta1 + m.theta2) == pytest.approx(0.0, abs=16 * EPS)
        assert m.omega1 + m.omega2 + m.omega3 == pytest.approx(m.omega4, rel=1e-12, abs=1e-12)
        assert m.alpha1 + m.alpha2 + m.alpha3 == pytest.approx(m.alpha4, rel=1e-11, abs=1e-11)
        assert m.omega4 == pytest.approx(2.0 * m.velocity_ratio, rel=4 * EPS)
        assert m.transmission_angle == pytest.approx(abs(angle_difference(m.theta4, m.beta)),
                                                     abs=16 * EPS)
        for c, s, angle in ((m.cos_x, m.sin_x, theta1), (m.cos_b, m.sin_b, m.beta),
                            (m.cos_y, m.sin_y, m.theta4), (m.cos_mu, m.sin_mu, m.theta4 - m.beta)):
            assert (c, s) == pytest.approx((cos(angle), sin(angle)), abs=16 * EPS)


def test_toggle_raises_for_one_value_and_is_nan_in_arrays():
    """
    At a limit the angle is rounded.

    It is called a toggle from both sides, and nothing is finite.
    """
    for lengths in ((4.0, 3.0, 2.0, 8.0), (3.0, 2.0, 4.0, 3.5), (1.0, 0.5, 0.25, 0.5)):
        linkage = FourBar(*lengths)
        for end in (end for bounds in linkage.input_ranges for end in bounds):
            outcomes = set()
            for theta1 in (nextafter(end, -9.0), end, nextafter(end, 9.0)):
                try:
                    motion = linkage.motion(theta1, 1.0)
                    assert abs(motion.sin_mu) < 1e-7 and abs(motion.omega4) > 1e5
                    outcomes.add('finite')
                except Toggle:
                    assert not np.isfinite(linkage.motion([theta1], 1.0).omega4[0])
                    outcomes.add('toggle')
            assert 'toggle' in outcomes
