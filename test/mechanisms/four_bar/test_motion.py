# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Position, velocity and acceleration.

The seeds' numbers, the loop, the number types, the symmetries.
"""
from math import cos, inf, nan, nextafter, pi, radians, sin

from fourbar_ros import CROSSED, FourBar, InvalidParameter, Motion, OPEN, OutOfRange, Toggle
import mpmath as mp
import numpy as np
import pytest
from support.reference import EPS, pose, random_lengths

PAPER = (0.4, 1.2, 0.8, 1.0)         # m
SLIDES_7_6 = (8.0, 14.0, 9.0, 17.0)
SLIDES_7_7 = (2.0, 6.0, 7.0, 5.0)


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

def test_slides_example_7_6():
    open_ = FourBar(*SLIDES_7_6, mode=OPEN).motion(radians(60.0), 10.0, 100.0)
    crossed = FourBar(*SLIDES_7_6, mode=CROSSED).motion(radians(60.0), 10.0, 100.0)
    printed = 0.5e-4     # four decimals
    assert np.degrees(open_.theta4) == pytest.approx(84.5689, abs=printed)
    assert np.degrees(open_.theta2) == pytest.approx(308.3430 - 360.0, abs=printed)
    assert np.degrees(open_.beta) == pytest.approx(8.3430, abs=printed)
    assert open_.omega4 == pytest.approx(7.1781, abs=printed)
    assert open_.omega2 == pytest.approx(-12.4463, abs=printed)
    assert open_.omega_beta == pytest.approx(-2.4463, abs=printed)
    assert open_.alpha4 == pytest.approx(125.5109, abs=printed)
    assert open_.alpha2 == pytest.approx(-103.5916, abs=printed)
    assert open_.alpha_beta == pytest.approx(-3.5916, abs=printed)
    assert np.degrees(crossed.theta4) == pytest.approx(-140.6787, abs=printed)
    assert np.degrees(crossed.theta2) == pytest.approx(-124.4528, abs=printed)


@pytest.mark.parametrize('mode, theta1_deg, alpha4', [
    (CROSSED, 24.6475, 68.7731), (CROSSED, 326.1382, -87.9671),
    (OPEN, 33.8618, 87.9671), (OPEN, 335.3525, -68.7731)])
def test_slides_example_7_7(mode, theta1_deg, alpha4):
    motion = FourBar(*SLIDES_7_7, mode=mode).motion(radians(theta1_deg), 10.0)
    assert motion.alpha4 == pytest.approx(alpha4, abs=0.5e-4)


@pytest.mark.parametrize('theta1_deg, omega4', [(2.6810, -6.6959), (138.9638, 3.2493)])
def test_slides_example_7_7_rates(theta1_deg, omega4):
    linkage = FourBar(*SLIDES_7_7, mode=OPEN)
    assert linkage.motion(radians(theta1_deg), 10.0).omega4 == pytest.approx(omega4, abs=0.5e-4)
    assert linkage.in_mode(CROSSED).motion(radians(-theta1_deg),
                                           10.0).omega4 == pytest.approx(omega4, abs=0.5e-4)


@pytest.mark.parametrize('mode, theta1, field, value', [
    (1, 0.36933536497, 'omega4', -23.95938171814), (1, -1.66716501134, 'omega4', 13.51343678),
    (2, 1.66716501134, 'omega4', 13.51343678), (2, 5.91384994221, 'omega4', -23.95938171814),
    (1, 0.8382412814, 'alpha4', 462.6986573), (1, -0.1482557001, 'alpha4', -1062.775829),
    (2, 0.1482557001, 'alpha4', 1062.775829), (2, 5.444944024, 'alpha4', -462.6986573)])
def test_table_2_of_the_paper_as_corrected(mode, theta1, field, value):
    assert getattr(FourBar(*PAPER, mode=mode).motion(theta1, 25.0),
                   field) == pytest.approx(value, rel=5e-10)


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


# --- one formula, several number types -----------------------------------------------------------


@pytest.mark.parametrize('shape', [(), (1,), (0,), (3, 1, 2)])
def test_shapes_are_those_of_the_broadcast_input(shape):
    motion = FourBar(*PAPER).motion(np.full(shape, 0.3), 2.0, np.zeros(shape))
    assert all(np.shape(field) == shape for field in motion)
    motion = FourBar(*PAPER).motion(np.linspace(0.0, 1.0, 3), np.ones((2, 1)))
    assert all(field.shape == (2, 3) for field in motion)


def test_single_values_are_plain_floats():
    assert {type(value) for value in FourBar(*PAPER).motion(0.3, 25.0, 1.0)} == {float}


def test_numpy_scalars_and_integers_give_the_same_as_floats():
    linkage = FourBar(*PAPER)
    assert linkage.motion(np.float64(1.0), 2) == linkage.motion(1.0, 2.0)
    assert linkage.motion(1, 2, 0) == linkage.motion(1.0, 2.0, 0.0)


# --- where it cannot be --------------------------------------------------------------------------

def test_out_of_range_raises_for_one_value_and_is_nan_in_arrays():
    linkage = FourBar(4.0, 3.0, 2.0, 8.0)
    limit = linkage.input_ranges[0][1]
    with pytest.raises(OutOfRange, match='outside the input range'):
        linkage.motion(1.0)
    theta1 = np.array([0.0, 1.0, -0.5, 3.0, np.nan, np.inf])
    motion = linkage.motion(theta1, 1.0)
    bad = abs(theta1) < limit
    for field in Motion._fields:
        if field not in ('theta1', 'omega1', 'alpha1', 'cos_x', 'sin_x'):
            np.testing.assert_array_equal(np.isfinite(getattr(motion, field)), bad, field)


@pytest.mark.parametrize('theta1, omega1, alpha1', [
    (nan, 1.0, 0.0), (inf, 1.0, 0.0), (1.0, nan, 0.0), (1.0, -inf, 0.0), (1.0, 0.0, nan),
    (1.0, 0.0, inf)])
def test_input_that_is_no_number_is_refused(theta1, omega1, alpha1):
    with pytest.raises(InvalidParameter, match='finite'):
        FourBar(*PAPER).motion(theta1, omega1, alpha1)


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


# --- symmetries ----------------------------------------------------------------------------------


def test_no_angle_is_special():
    """The output at pi, where tan(theta4/2) is infinite, and the crank there, are ordinary."""
    linkage = FourBar(*PAPER)
    for theta1 in (0.0, pi, -pi, nextafter(pi, 0.0), nextafter(pi, 4.0), 1e-300, 3.0 * pi):
        exact = pose(linkage.lengths, 1, mp.mpf(theta1))
        motion = linkage.motion(theta1, 1.0)
        assert motion.theta4 == pytest.approx(float(exact.y), abs=4 * EPS)
        assert motion.alpha4 == pytest.approx(float(exact.ddy), rel=16 * EPS, abs=16 * EPS)
