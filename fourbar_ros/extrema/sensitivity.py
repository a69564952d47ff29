# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
How far link lengths that are a little wrong move an extremum: condition numbers.

With F = dQ/dtheta1 at an extremum, its place moves by -sum (dF/da_i) da_i / F' and its value by
sum (dQ/da_i) da_i. For lengths that are each wrong by a relative eps, eps times the sums of the
absolute terms bounds both.
"""
from __future__ import annotations

from typing import Any

from fourbar_ros.extrema.sampling import Sampler
from fourbar_ros.numerics.arrays import Array
import numpy as np

# Relative steps of a length: at most the first; a part of the distance to the next change point,
# where everything changes; but never lost in rounding.
LARGEST, PART, SMALLEST = 2.0**-26, 2.0**-10, 2.0**-46
# Step in theta1 for the curvature, in distances of samples.
TURN = 2.0**-12


def perturbed_lengths(mechanism: Any) -> tuple[list[float], list[tuple[float, ...]]]:
    """Return a relative step for each length, and the lengths changed by it."""
    size = min(LARGEST, max(SMALLEST, PART * mechanism.change_point_margin))
    signs, margin = min(zip(mechanism.MARGIN_SIGNS, mechanism.margins),
                        key=lambda pair: abs(pair[1]),
                        default=((1,) * len(mechanism.lengths), 0.0))
    away = size if margin >= 0.0 else -size
    steps = [sign * away or size for sign in signs]
    lengths = mechanism.lengths
    return steps, [(*lengths[:i], length * (1.0 + step), *lengths[i + 1:])
                   for i, (step, length) in enumerate(zip(steps, lengths))]


def sampled_conditions(sampler: Sampler, x: Array, row: Array,
                       spacing: Array) -> tuple[Array, Array]:
    """
    Return the conditions of place [rad] and relative value of a sampler's extrema.

    Each of shape (n,).

    Parameters
    ----------
    sampler : Sampler
    x, row, spacing : ndarray, shape (n,)
        Where the extrema are [rad], of which quantity, and the distance of samples there [rad].

    """
    turn = TURN * spacing
    value, slope = sampler.at(np.concatenate((x, x + turn)), np.tile(row, 2))
    curvature = (slope[x.size:] - slope[:x.size]) / turn
    steps, lengths = perturbed_lengths(sampler.linkage)
    value, slope = value[:x.size], slope[:x.size]
    values, slopes = sampler.with_lengths(lengths, x, row)
    values = sampler.next_to(value[:, None], values, row[:, None])
    size, place = ((np.abs(there - here[:, None]) / np.abs(steps)).sum(axis=1)
                   for here, there in ((value, values), (slope, slopes)))
    with np.errstate(divide='ignore', invalid='ignore'):
        return place / np.abs(curvature), size / np.abs(value)
