# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema of many functions at once: what is found is right, the rest is called doubtful."""
from fourbar_ros.extrema.full_turns import search_turns
import numpy as np


def test_a_spike_is_doubtful_and_a_constant_is_one_extremum():
    def rows(x, which):
        spike = 1.0 / (1.0 - np.cos(x - 1.0) + 1e-6)
        return np.choose(which[:, None], (spike, np.sin(x), 0.0 * x + 2.0))[None]

    found = search_turns(rows, 3, 128, np.zeros(1, bool))
    assert found.is_doubtful.tolist() == [True, False, False]
    assert found.counts[0, 1:].tolist() == [2, 1] and found.values[0, 2, 0] == 2.0


def test_two_extrema_between_two_samples_are_found_or_doubtful_never_lost():
    gaps = np.logspace(-6, -1, 60)[:, None]

    def rows(x, which):         # slope 1 - cos(x - 1)/cos(gap): an angle, extrema at 1 +- gap
        return (x - np.sin(x - 1.0) / np.cos(gaps[which]))[None]

    found = search_turns(rows, 60, 128, np.ones(1, bool))
    safe = ~found.is_doubtful
    assert safe.any() and not safe.all()
    assert (found.counts[0, safe] == 2).all()
    places = np.sort(found.inputs[0, safe][:, :2], axis=1)
    exact = gaps[safe, 0]
    assert np.abs(places - 1.0 - np.stack((-exact, exact), axis=1)).max() < 1e-9


def test_an_angle_that_turns_on_is_followed():
    def rows(x, which):
        angle = x + 0.3 * np.sin(2.0 * x + 0.3)
        return np.where(x.dtype.kind == 'c', angle,
                        np.mod(angle.real + np.pi, 2.0 * np.pi) - np.pi)[None]

    found = search_turns(rows, 3, 128, np.ones(1, bool))
    assert (found.counts == 0).all() and not found.is_doubtful.any()      # 1 + 0.6 cos > 0
    assert found.are_turning.all() and np.isnan(found.means).all() and found.are_means.all()
