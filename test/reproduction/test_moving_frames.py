# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Moving frames against the derivatives of explicit motions, taken with fifty digits."""
from math import cos, inf, pi, sin

from fourbar_lab.reproduction.moving_frames import (
    apparent_angular_acceleration,
    coincident_acceleration,
    path_acceleration,
    relative_acceleration,
    relative_velocity,
    rolling_contact,
)
from fourbar_ros.mechanics.moving_frames import acceleration_terms, coriolis_acceleration, turned
import mpmath as mp
import numpy as np
import pytest
from support.reference import EPS

ORDERS = (0, 1, 2)


def derivatives(function, t):
    """Return value and two derivatives of a function of time, real or complex."""
    return [complex(mp.diff(function, t, n)) if n else complex(function(t)) for n in ORDERS]


def vector(z):
    return np.array([z.real, z.imag])


def random_motion(rng):
    """Return place of A, turn of the frame and place in the frame as functions of time."""
    c = [mp.mpf(float(v)) for v in rng.uniform(-2.0, 2.0, 12)]

    def origin(t):
        return mp.mpc(c[0] * t + c[1] * mp.sin(t), c[2] * t**2 + c[3] * mp.cos(2 * t))

    def turn(t):
        return c[4] + c[5] * t + c[6] * t**2 + c[7] * mp.sin(t)

    def inside(t):
        return mp.mpc(c[8] + c[9] * t**2, c[10] * t + c[11] * mp.sin(t))

    return origin, turn, inside


def test_velocity_and_acceleration_are_the_derivatives_of_the_place():
    """Tolerance: rounding of each term, a few eps of the sum of their sizes."""
    rng = np.random.default_rng(71)
    for _ in range(100):
        origin, turn, inside = random_motion(rng)
        t = mp.mpf(float(rng.uniform(-2.0, 2.0)))
        _, v, a = derivatives(lambda s: origin(s) + mp.expj(turn(s)) * inside(s), t)
        (_, v_a, a_a), (_, omega,
                        alpha) = derivatives(origin, t), (z.real for z in derivatives(turn, t))
        r, v_rel, a_rel = (z * complex(mp.expj(turn(t))) for z in derivatives(inside, t))
        terms = acceleration_terms(vector(a_a), omega, alpha, vector(r), vector(v_rel),
                                   vector(a_rel))
        size = sum(np.abs(term).max() for term in terms) + abs(v_a) + abs(omega * r) + abs(v_rel)
        velocity = relative_velocity(vector(v_a), omega, vector(r), vector(v_rel))
        acceleration = relative_acceleration(vector(a_a), omega, alpha, vector(r), vector(v_rel),
                                             vector(a_rel))
        np.testing.assert_allclose(velocity, vector(v), rtol=0.0, atol=8 * EPS * size)
        np.testing.assert_allclose(acceleration, vector(a), rtol=0.0, atol=8 * EPS * size)
        # Eq. (11): from the point of the frame that is passed over
        below = relative_acceleration(vector(a_a), omega, alpha, vector(r))
        np.testing.assert_allclose(coincident_acceleration(below, omega, vector(v_rel),
                                                           vector(a_rel)),
                                   acceleration, rtol=0.0, atol=8 * EPS * size)


def test_coriolis_is_turned_in_the_sense_of_omega():
    np.testing.assert_array_equal(coriolis_acceleration(3.0, (2.0, 0.0)), (0.0, 12.0))
    np.testing.assert_array_equal(coriolis_acceleration(-3.0, (2.0, 0.0)), (0.0, -12.0))
    np.testing.assert_array_equal(turned(2.0, (0.0, 1.0)), (-2.0, 0.0))


def test_example_7_4():
    """
    Rod at 45 deg, 50 rad/s ccw, slider 0.5 m out, moving out at 30 m/s.

    3250 m/s^2 at 22.4 deg.
    """
    out = np.array([cos(pi / 4), sin(pi / 4)])
    terms = acceleration_terms((0.0, 0.0), 50.0, 0.0, 0.5 * out, 30.0 * out)
    assert np.hypot(*terms.normal) == pytest.approx(1250.0, rel=4 * EPS)
    assert np.hypot(*terms.coriolis) == pytest.approx(3000.0, rel=4 * EPS)
    total = relative_acceleration((0.0, 0.0), 50.0, 0.0, 0.5 * out, 30.0 * out)
    assert np.hypot(*total) == pytest.approx(3250.0, rel=4 * EPS)
    assert 180.0 - np.degrees(np.arctan2(total[1], total[0])) == pytest.approx(22.38013505195957,
                                                                               rel=16 * EPS)


def test_path_acceleration_is_that_of_a_curve():
    """
    A parabola y = k x^2 run through at any speed.

    Curvature 2k/(1 + 4 k^2 x^2)^(3/2), to the left.
    """
    k = mp.mpf('0.7')
    for t in (mp.mpf('-0.8'), mp.mpf('0.3'), mp.mpf(2)):
        def place(s):
            x = s + mp.sin(s) / 3
            return mp.mpc(x, k * x**2)
        z, v, a = derivatives(place, t)
        speed, growth = abs(v), (v.conjugate() * a).real / abs(v)
        curvature = float(2 * k / (1 + 4 * k**2 * mp.mpf(z.real)**2)**mp.mpf(1.5))
        np.testing.assert_allclose(path_acceleration(vector(v) / speed, speed, growth, curvature),
                                   vector(a),
                                   rtol=0.0, atol=16 * EPS * abs(a))


def test_apparent_angular_acceleration():
    assert apparent_angular_acceleration(5.0, -2.0) == 7.0


@pytest.mark.parametrize('ground', [inf, 1.5, 40.0, -1.5, -7.0])
def test_rolling_contact_is_a_cycloid(ground):
    """Place of the point in contact: cycloid on flat ground, epi- or hypocycloid on a circle."""
    radius, t = mp.mpf('0.4'), mp.mpf('0.6')

    def angle(s):
        return mp.mpf(2) * s - mp.mpf('0.7') * s**2 + mp.sin(s)

    turn, omega, alpha = (z.real for z in derivatives(angle, t))
    if ground == inf:
        normal = 1j

        def centre(s):
            return mp.mpc(-radius * angle(s), radius)
    else:
        reach = ground + radius

        def centre(s):
            return reach * mp.expj(radius * angle(s) / reach)
        normal = complex(centre(t)) / abs(complex(centre(t))) * (1.0 if ground > 0.0 else -1.0)

    def contact(s):
        return centre(s) - radius * normal * mp.expj(angle(s) - mp.mpf(angle(t)))

    _, v, a = derivatives(contact, t)
    _, v_c, a_c = derivatives(centre, t)
    found = rolling_contact(omega, alpha, float(radius), vector(normal), ground)
    size = float(radius) * (omega**2 + abs(alpha))
    assert abs(v) <= 16 * EPS * abs(v_c)
    np.testing.assert_allclose(found.centre_velocity, vector(v_c), rtol=0.0, atol=16 * EPS * size)
    np.testing.assert_allclose(found.centre_acceleration, vector(a_c), rtol=0.0,
                               atol=16 * EPS * size)
    np.testing.assert_allclose(found.contact_acceleration, vector(a), rtol=0.0,
                               atol=32 * EPS * size)
    # Eq. (14): nothing along the contact surface
    assert abs((complex(*found.contact_acceleration) * normal.conjugate()).imag) <= 16 * EPS * size


def test_arrays_are_element_by_element():
    rng = np.random.default_rng(72)
    for shape in ((), (1,), (3, 1, 2)):
        a_a, r, v_rel, a_rel = rng.normal(size=(4, *shape, 2))
        omega, alpha = rng.normal(size=(2, *shape))
        whole = relative_acceleration(a_a, omega, alpha, r, v_rel, a_rel)
        assert whole.shape == (*shape, 2)
        for i in np.ndindex(shape):
            np.testing.assert_array_equal(
                whole[i], relative_acceleration(a_a[i], omega[i], alpha[i], r[i], v_rel[i],
                                                a_rel[i]))
        contact = rolling_contact(omega, alpha, 0.3, r / np.hypot(r[..., 0], r[..., 1])[..., None])
        assert {field.shape for field in contact} == {(*shape, 2)}
    assert relative_velocity((0.0, 0.0), np.ones(4), (1.0, 2.0)).shape == (4, 2)
