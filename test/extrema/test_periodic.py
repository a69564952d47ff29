# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Slopes, resolution and roots of sampled periodic functions beside exact ones."""
from fourbar_ros.extrema.periodic import FINE, is_coarse, PLAIN, roots_between, slopes_of
import numpy as np
import pytest

COUNT = 96
STEP = 2.0 * np.pi / COUNT
X = STEP * (np.arange(COUNT) + 0.5)[:, None]
ORDERS = np.arange(1, 9)


def remainder(weights):
    """Return what a stencil makes of harmonics, less their slopes: its symbol, less i k h."""
    angles = ORDERS * STEP
    symbol = sum(2.0 * weight * np.sin(k * angles) for k, weight in enumerate(weights, 1))
    return np.abs(symbol - angles)


@pytest.mark.parametrize('weights, order', [(FINE, 12), (PLAIN, 4)])
def test_slopes_are_exact_but_for_the_order_of_their_stencil(weights, order):
    found = slopes_of(np.sin(ORDERS * X + 0.3), weights)
    error = np.abs(found - ORDERS * STEP * np.cos(ORDERS * X + 0.3)).max(axis=0)
    expected = remainder(weights)
    assert (np.abs(error - expected) <= 1e-2 * expected + 1e-14).all()
    growth = np.log2(expected[7] / expected[3])         # twice the harmonic
    assert abs(growth - (order + 1)) < 0.3


def test_what_half_the_samples_do_not_tell_is_coarse():
    waves = np.sin(np.array([3.0, 8.0, 16.0, 24.0, 40.0]) * X + 0.2)
    assert is_coarse(waves, np.ptp(waves, axis=0)).tolist() == [False, False, True, True, True]
    spike = 1.0 / (1.0 + 4e-3 - np.cos(X - 1.0))
    assert is_coarse(spike, np.ptp(spike, axis=0)).all()


def test_roots_between_samples_are_those_of_the_function():
    rng = np.random.default_rng(0)
    shift = rng.uniform(0.0, 2.0 * np.pi, 40)
    f = np.sin(X + shift) * np.exp(0.3 * np.cos(X))     # roots where x + shift = 0
    i = np.floor((-shift / STEP - 0.5) % COUNT).astype(int)
    exact = (-shift / STEP - 0.5) % COUNT - i
    after, slope = roots_between(f, i, np.arange(40), exact + 0.01)
    assert np.abs(after - exact).max() < 1e-11
    there = STEP * np.exp(0.3 * np.cos(shift))
    assert np.abs(slope - there).max() < 1e-6 * there.max()
