# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Integrals over a panel: of polynomials exactly, of smooth functions geometrically."""
from fourbar_ros.dynamics.solve.by_energy import at, panel
import numpy as np
import pytest

EPS = 2.0**-52


@pytest.mark.parametrize('degree', [4, 16, 32])
def test_polynomials_up_to_the_degree_are_exact(degree):
    rule = panel(degree)
    assert rule.points[0] == 0.0 and rule.points[-1] == 1.0
    for power in range(degree + 1):
        found = rule.integral @ rule.points**power
        assert np.abs(found - rule.points**(power + 1) / (power + 1)).max() <= 8 * EPS
    places = np.linspace(0.0, 1.0, 7)
    values = at(places, degree) @ rule.coefficients @ rule.points**degree
    assert np.abs(values - places**degree).max() <= 32 * EPS


def test_every_second_point_is_one_of_half_the_degree():
    assert np.abs(panel(32).points[::2] - panel(16).points).max() <= EPS


def test_smooth_functions_converge_geometrically():
    """Errors for exp x fall faster than 4^-n with weights of degree n."""
    for degree in (4, 6, 8, 10):
        rule = panel(degree)
        assert abs(rule.integral[-1] @ np.exp(rule.points) - (np.e - 1.0)) <= 0.1 * 4.0**-degree
    assert panel(10).weights.sum() == pytest.approx(1.0, abs=4 * EPS)
