# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The Scotch yoke against the harmonic motion of a textbook."""
from math import cos, pi, sin

from fourbar_ros import (
    Bodies,
    Body,
    find_extrema,
    InvalidParameter,
    OutOfRange,
    ScotchYoke,
    Toggle,
)
import numpy as np
import pytest

MASSES = Bodies(Body(2.0, 0.0, 0.0, 0.1), Body(0.3), Body(4.0))


def test_harmonic_motion_of_a_textbook():
    """
    Any textbook: s = r cos wt, v = -r w sin wt, a = -r w^2 cos wt.

    The frame takes m a of yoke and block.
    """
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


def test_extrema_of_harmonic_motion():
    """
    Two of the velocity and two of the acceleration, at quarters of a turn.

    Torque at odd eighths.
    """
    yoke = ScotchYoke(0.1, 0.02, bodies=MASSES)
    found = find_extrema(yoke, ('slide_velocity', 'slide_acceleration', 'driving_torque'), 30.0)
    places = {name: sorted(e.theta1 for e in found if e.quantity == name)
              for name in {e.quantity for e in found}}
    assert places['slide_velocity'] == pytest.approx([0.5 * pi, 1.5 * pi], abs=1e-12)
    assert places['slide_acceleration'] == pytest.approx([0.0, pi], abs=1e-12)
    assert places['driving_torque'] == pytest.approx([(k + 0.5) * 0.5 * pi for k in range(4)],
                                                     abs=1e-12)
    largest = {'slide_velocity': 3.0, 'slide_acceleration': 90.0, 'driving_torque': 18.0}
    for extremum in found:
        assert abs(extremum.value) == pytest.approx(largest[extremum.quantity], rel=1e-14)


def test_toggles_modes_and_ranges():
    yoke = ScotchYoke(0.1, input='slide')
    assert yoke.input_ranges == ((-0.1, 0.1),) and set(yoke.modes) == {1, 2}
    with pytest.raises(Toggle):
        yoke.motion(0.1, 1.0)
    with pytest.raises(OutOfRange):
        yoke.motion(0.1000001, 1.0)
    assert yoke.in_mode(1).motion(0.05).theta1 == -yoke.motion(0.05).theta1
    assert np.isnan(yoke.motion(np.array([0.2])).theta1[0])
    with pytest.raises(InvalidParameter, match='one assembly mode'):
        ScotchYoke(0.1, mode=1)
    assert [tuple(point) for point in ScotchYoke(0.1).dead_points] == [(0.0, 0.1), (pi, -0.1)]
    assert ScotchYoke(0.1, input='slide', stroke=(0.0, 0.05)).input_ranges == ((0.0, 0.05),)
