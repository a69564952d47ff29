# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Moving frames against the derivatives of explicit motions, taken with fifty digits."""
from fourbar_lab.drawing.polygons import acceleration_terms, turned
import mpmath as mp
import numpy as np
from support.cartesian import EPS

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


def test_the_sum_of_the_terms_is_the_second_derivative_of_the_place():
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
        velocity = vector(v_a) + turned(omega, vector(r)) + vector(v_rel)
        np.testing.assert_allclose(velocity, vector(v), rtol=0.0, atol=8 * EPS * size)
        np.testing.assert_allclose(sum(terms), vector(a), rtol=0.0, atol=8 * EPS * size)


def test_a_vector_is_turned_in_the_sense_of_the_rate():
    np.testing.assert_array_equal(turned(2.0, np.array([0.0, 1.0])), (-2.0, 0.0))
    np.testing.assert_array_equal(turned(-3.0, np.array([2.0, 0.0])), (0.0, -6.0))
