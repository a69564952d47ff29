"""
How far link lengths that are a little wrong move an extreme: condition numbers.

With F = dQ/dtheta1 at an extreme, its place moves by -sum (dF/da_i) da_i / F' and its value by sum
(dQ/da_i) da_i. For lengths that are each wrong by a relative eps, eps times the sums of the absolute
terms bounds both.
"""
from __future__ import annotations

import numpy as np

# Relative steps of a length: at most the first; a part of the distance to the next change point, where
# everything changes; but never lost in rounding.
LARGEST, PART, SMALLEST = 2.0**-26, 2.0**-10, 2.0**-46
# Step in theta1 for the curvature, in distances of samples.
TURN = 2.0**-12


def rate_changes(lengths, motion, third):
    """
    Return how theta4', theta4'' and theta4''' change with lengths: sum |d/da_i| a_i of each.

    The loop a1 e^ix + a2 e^ib = a4 + a3 e^iy, varied at constant x = theta1 and projected on the coupler, gives

        a3 sin(mu) dy = -cos(x-b) da1 - da2 + cos(mu) da3 + cos(b) da4,      mu = y - b.

    With da_i = a_i for one i, and differentiated three times with respect to x, that is what is wanted. All four
    together change nothing.

    Parameters
    ----------
    lengths : tuple of 4 floats
    motion : tuple
        Fields of Motion at unit input rate.
    third : float
        theta4'''.

    """
    a1, a2, a3, a4 = lengths
    y2, y1, b1, cos_x, sin_x, cos_b, sin_b, _, _, cos_mu, sin_mu = motion[11], *motion[16:18], *motion[19:]
    v = 1.0 / sin_mu
    cot, k = cos_mu * v, a1 / a2 * (a4 / a3)
    # mu', mu'', mu''' from the cosine law, cos(mu) = constant + k cos(x); those of x - b by mu
    m1 = k * sin_x * v
    m2 = k * cos_x * v - cot * m1 * m1
    m3 = m1 * (m1 * m1 - 3.0 * cot * m2) - m1
    w1, w2, w3 = 1.0 - b1, m2 - y2, m3 - third
    # derivatives of 1/sin(mu), cot(mu), cos(x-b)
    v1 = -cot * v * m1
    c1 = -v * v * m1
    v2 = -(c1 * v + cot * v1) * m1 - cot * v * m2
    c2 = -2.0 * v * v1 * m1 - v * v * m2
    v3 = -(c2 * v + 2.0 * c1 * v1 + cot * v2) * m1 - 2.0 * (c1 * v + cot * v1) * m2 - cot * v * m3
    c3 = -2.0 * (v1 * v1 + v * v2) * m1 - 4.0 * v * v1 * m2 - v * v * m3
    p, sine = cos_x * cos_b + sin_x * sin_b, sin_x * cos_b - cos_x * sin_b
    p1 = -sine * w1
    p2 = -p * w1 * w1 - sine * w2
    p3 = sine * (w1 * w1 * w1 - w3) - 3.0 * p * w1 * w2
    r1, r2 = a1 / a3, a2 / a3
    changes = []
    for by_1, by_2, by_3 in ((p1 * v + p * v1, v1, c1),
                             (p2 * v + 2.0 * p1 * v1 + p * v2, v2, c2),
                             (p3 * v + 3.0 * (p2 * v1 + p1 * v2) + p * v3, v3, c3)):
        by_1, by_2 = -r1 * by_1, -r2 * by_2
        changes.append(abs(by_1) + abs(by_2) + abs(by_3) + abs(by_1 + by_2 + by_3))
    return changes


def perturbed_lengths(mechanism):
    """Return a relative step for each length, and the lengths with that one changed by it, away from change points."""
    size = min(LARGEST, max(SMALLEST, PART * mechanism.change_point_margin))
    signs, margin = min(zip(mechanism.MARGIN_SIGNS, mechanism.margins), key=lambda pair: abs(pair[1]))
    steps = [sign * size if margin >= 0.0 else -sign * size for sign in signs]
    lengths = mechanism.lengths
    return steps, [(*lengths[:i], length * (1.0 + step), *lengths[i + 1:])
                   for i, (step, length) in enumerate(zip(steps, lengths))]


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
    value, slope = sampler.at(np.concatenate((x, x + turn)), np.tile(row, 2))
    curvature = (slope[x.size:] - slope[:x.size]) / turn
    steps, lengths = perturbed_lengths(sampler.linkage)
    value, slope = value[:x.size], slope[:x.size]
    size, place = ((np.abs(there - here[:, None]) / np.abs(steps)).sum(axis=1)
                   for here, there in zip((value, slope), sampler.with_lengths(lengths, x, row)))
    with np.errstate(divide='ignore', invalid='ignore'):
        return place / np.abs(curvature), size / np.abs(value)
