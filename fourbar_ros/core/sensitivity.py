"""
How far link lengths that are a little wrong move an extreme: condition numbers by differences.

With F = dQ/dtheta1 at an extreme, its place moves by -sum (dF/da_i) da_i / F' and its value by sum
(dQ/da_i) da_i. For lengths that are each wrong by a relative eps, eps times the sums of the absolute
terms bounds both.
"""
from __future__ import annotations

from dataclasses import replace

import numpy as np

# Relative steps of a length: at most the first; a part of the distance to the next change point, where
# everything changes; but never lost in rounding.
LARGEST, PART, SMALLEST = 2.0**-26, 2.0**-6, 2.0**-46
# Step in theta1 for the curvature, in distances of samples.
TURN = 2.0**-12
_MARGIN_SIGNS = ((-1, -1, 1, 1), (-1, 1, -1, 1), (-1, 1, 1, -1))


def perturbed_lengths(linkage):
    """Return the step and four sets of lengths, each with one changed by it, away from the change point."""
    step = min(LARGEST, max(SMALLEST, PART * linkage.change_point_margin))
    signs, margin = min(zip(_MARGIN_SIGNS, linkage._margins), key=lambda pair: abs(pair[1]))
    away = 1.0 if margin >= 0.0 else -1.0
    return step, [tuple(length * (1.0 + away * sign * step) if i == j else length
                        for j, length in enumerate(linkage.lengths))
                  for i, sign in enumerate(signs)]


def sampled_conditions(sampler, x, row, spacing):
    """
    Return the conditions of place [rad] and relative value of the extremes of a sampler's quantities.

    Parameters
    ----------
    sampler : Sampler
    x, row, spacing : ndarray, shape (n,)
        Where the extremes are [rad], of which quantity, and the distance of samples there [rad].

    """
    step, others = perturbed_lengths(sampler.linkage)
    turn = TURN * spacing
    value, slope = sampler.at(x, row)
    curvature = (sampler.at(x + turn, row)[1] - slope) / turn
    shift = np.zeros((2, x.size))
    for lengths in others:
        other = replace(sampler.linkage, **dict(zip(('a1', 'a2', 'a3', 'a4'), lengths)))
        other_value, other_slope = sampler.of(other).at(x, row)
        shift += np.abs((other_slope - slope, other_value - value))
    with np.errstate(divide='ignore', invalid='ignore'):
        return shift[0] / step / np.abs(curvature), shift[1] / step / np.abs(value)
