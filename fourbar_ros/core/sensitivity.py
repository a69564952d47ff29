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
LARGEST, PART, SMALLEST = 2.0**-26, 2.0**-10, 2.0**-46
# Step in theta1 for the curvature, in distances of samples.
TURN = 2.0**-12
_MARGIN_SIGNS = ((-1, -1, 1, 1), (-1, 1, -1, 1), (-1, 1, 1, -1))


def perturbed_lengths(linkage):
    """Return four pairs of a relative step and the lengths with one changed by it, away from change points."""
    size = min(LARGEST, max(SMALLEST, PART * linkage.change_point_margin))
    signs, margin = min(zip(_MARGIN_SIGNS, linkage._margins), key=lambda pair: abs(pair[1]))
    d1, d2, d3, d4 = (sign * size if margin >= 0.0 else -sign * size for sign in signs)
    a1, a2, a3, a4 = linkage.lengths
    return ((d1, (a1 * (1.0 + d1), a2, a3, a4)), (d2, (a1, a2 * (1.0 + d2), a3, a4)),
            (d3, (a1, a2, a3 * (1.0 + d3), a4)), (d4, (a1, a2, a3, a4 * (1.0 + d4))))


def sampled_conditions(sampler, x, row, spacing):
    """
    Return the conditions of place [rad] and relative value of the extremes of a sampler's quantities.

    Parameters
    ----------
    sampler : Sampler
    x, row, spacing : ndarray, shape (n,)
        Where the extremes are [rad], of which quantity, and the distance of samples there [rad].

    """
    turn = TURN * spacing
    value, slope = sampler.at(x, row)
    curvature = (sampler.at(x + turn, row)[1] - slope) / turn
    change = np.zeros((2, x.size))
    for step, lengths in perturbed_lengths(sampler.linkage):
        other = replace(sampler.linkage, **dict(zip(('a1', 'a2', 'a3', 'a4'), lengths)))
        other_value, other_slope = sampler.of(other).at(x, row)
        change += np.abs((other_slope - slope, other_value - value)) / abs(step)
    with np.errstate(divide='ignore', invalid='ignore'):
        return change[0] / np.abs(curvature), change[1] / np.abs(value)
