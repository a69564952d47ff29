# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Points fixed to links: what splits and draws their motion, and points that stand still."""
from math import nan, pi

from fourbar_ros import FourBar, InvalidParameter
from fourbar_ros.mechanisms.curves import vector
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.sliders import SliderCrank
import numpy as np
import pytest
from support.cartesian import EPS


def test_the_split_is_the_acceleration():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    x = np.linspace(-pi, pi, 50).reshape(5, 10)
    point = point_motion(linkage, linkage.motion(x, 25.0), 'coupler', 0.5, 0.3)
    assert point.place.shape == (5, 10, 2) and point.curvature.shape == (5, 10)
    np.testing.assert_allclose(np.hypot(point.tangential_acceleration, point.normal_acceleration),
                               np.hypot(*np.moveaxis(point.acceleration, -1, 0)),
                               rtol=8 * EPS)
    circle = point_motion(linkage, linkage.motion(x, 25.0), 'crank', 0.4)
    np.testing.assert_allclose(circle.curvature, 2.5, rtol=16 * EPS)
    np.testing.assert_allclose(circle.normal_acceleration, 25.0**2 * 0.4, rtol=8 * EPS)
    np.testing.assert_allclose(circle.tangential_acceleration, 0.0, atol=8 * EPS * 250.0)
    # turns right
    assert (point_motion(linkage, linkage.motion(x, -25.0), 'crank', 0.4).curvature < 0.0).all()


def test_a_point_at_rest_has_no_tangent():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    point = point_motion(linkage, linkage.motion(0.3, 25.0), 'crank', 0.0)
    assert (point.speed == 0.0 and np.isnan(point.tangential_acceleration)
            and np.isnan(point.curvature))


def test_a_point_that_hardly_moves_has_no_curvature():
    mechanism = SliderCrank(0.1, 0.3, 0.05)
    point = point_motion(mechanism, mechanism.motion(0.5, 1e-170, 1.0), 'crank', 0.1)
    assert point.speed > 0.0 and np.isnan(point.curvature)


def test_bad_points_are_refused():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    motion = linkage.motion(0.3)
    with pytest.raises(InvalidParameter, match="^link = 'rocker': must be one of crank, coupler, "
                                               'output'):
        point_motion(linkage, motion, 'rocker', 0.1)
    with pytest.raises(InvalidParameter, match='^across = nan'):
        point_motion(linkage, motion, 'crank', 0.1, nan)
    assert vector(1.0, np.zeros(3)).shape == (3, 2)
