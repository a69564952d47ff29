"""
Extremes of arbitrary quantities along one input path: interior ones, ends, ranges where they are constant.

Quantities are sampled with their derivatives on the points of :mod:`fourbar_ros.extrema.input_paths`. Sign changes of the
derivative, hidden pairs of them too, are bracketed, and all brackets of all quantities solved at once.
"""
from __future__ import annotations

from math import comb, inf, nan
from typing import NamedTuple

import numpy as np

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.roots import EPS, find_brackets, newton_roots, rises
from fourbar_ros.extrema.sampling import DifferenceSampler
from fourbar_ros.extrema.sensitivity import sampled_conditions

# Power of sin(mu) by which derivatives grow at toggles (that of the acceleration; forces grow faster by
# one, rates more slowly). With it they are smooth, that of a magnitude |F| only when multiplied by |F|: near a
# zero of the force it changes suddenly, F . dF/dtheta1 does not.
POLE = 5
# Samples on either side of an end from which the value there is interpolated.
NEIGHBOURS = 12


def _weights(number, terms):
    """Return weights, of sum one, of Lagrange's formula at 0."""
    weights = np.array([(-1)**j * terms(j) / (j + 0.5) for j in range(number)])
    return weights / weights.sum()


# For samples at +-1/2, 3/2, ... together, and for those on one side.
_THROUGH = 0.5 * _weights(NEIGHBOURS, lambda j: comb(2 * NEIGHBOURS - 1, NEIGHBOURS + j))
_UP_TO = _weights(NEIGHBOURS, lambda j: comb(NEIGHBOURS - 1, j))


class Found(NamedTuple):
    """One extreme of quantity number ``row``, at the input ``place``; other fields as in :class:`~fourbar_ros.extrema.find.Extremum`."""

    row: int
    place: float
    value: float
    sense: int          # +1 maximum, -1 minimum, 0 constant from here on
    side: int = 0
    is_flat: bool = False
    condition: float = nan
    value_condition: float = nan
    noise: float = 0.0  # bound of the rounding error of the value, beside that of its last bits


def search_path(sampler, path, with_conditions=True):
    """Return the list of :class:`Found` of all quantities along one :class:`~fourbar_ros.extrema.four_bar_rates.input_paths.InputPath`."""
    sampler.enter(path)
    with np.errstate(over='ignore', invalid='ignore'):
        values, slopes = sampler.sample(path.x)
    if np.isinf(values).any() or np.isinf(slopes).any():
        raise InvalidParameter('rate, acceleration', sampler.rates, 'too large: quantities overflow')
    middle = np.median(values, axis=1)
    state = sampler.state(path.x)
    noise = np.maximum(sampler.noise(state), 64.0 * EPS * np.abs(middle)[:, None])
    varies = (np.abs(values - middle[:, None]) > noise).any(axis=1)
    for side in sampler.flats:
        varies &= sampler.varies_next_to(side)
        middle = np.where(varies, middle, sampler.limits(side))
    middle[np.abs(middle) <= noise.min(axis=1)] = 0.0
    start = 0.0 if path.is_closed else path.low.x
    found = [Found(row, sampler.fold(start), float(middle[row]), 0, 0 if path.is_closed else 1)
             for row in np.nonzero(~varies)[0].tolist()]
    rows = np.nonzero(varies)[0]
    if rows.size:
        found += _interior(sampler, path, values, slopes, state, rows, with_conditions)
    if not path.is_closed:
        inward = np.arange(path.x.size)
        found += _end(sampler, path.x, path.low, +1, inward, path.first, values, slopes, noise, rows)
        found += _end(sampler, path.x, path.high, -1, inward[::-1], path.last, values, slopes, noise, rows)
    return found


def _interior(sampler, path, values, slopes, state, rows, with_conditions):
    """Return what the quantities ``rows`` do between the ends."""
    sine = np.abs(sampler.linkage.transmission_sine(state[0]))
    values = values[rows]
    scale = np.where((values > 0.0).all(axis=1, keepdims=True), values * sine**(2 * POLE - 1), sine**POLE)
    x, f = path.x, slopes[rows].T * scale.T
    turn = rises(np.unwrap(x)[:, None], False)[:, 0]
    _, row, xa, xb, fa, guess = find_brackets(lambda x, row: sampler.slope(x, rows[row]),
                                              lambda i, row: (x[i], turn[i]),
                                              f, rises(f, path.is_closed), path.is_closed)
    if not row.size:
        return []
    row, spacing = rows[row], xb - xa

    def at(x, which):
        return sampler.newton(x, row[which], spacing[which])

    root = newton_roots(at, np.arange(row.size), xa, xb, fa, guess)
    sense = np.where(fa >= 0.0, 1, -1)
    if isinstance(sampler, DifferenceSampler):
        root = sampler.polish(root, row, sense)
    place = sampler.fold(root)
    value, noise = sampler.values_and_noise(place, row)
    conditions = (sampled_conditions(sampler, root, row, spacing) if with_conditions
                  else np.full((2, row.size), nan))
    return [Found(*fields[:4], 0, False, *fields[4:])
            for fields in zip(*(v.tolist() for v in (row, place, value, sense, *conditions, noise)))]


def _at_stroke(sampler, end, side, slopes, rows):
    """Return what the quantities ``rows`` do at the end of a stroke; ``slopes``: those of the nearest sample."""
    value, place = sampler.values(np.array([end.x]))[:, 0], sampler.fold(end.x)
    return [Found(row, place, float(value[row]), -1 if slopes[row] * side > 0.0 else 1, side) for row in rows.tolist()]


def _end(sampler, x, end, side, inward, first, values, slopes, noise, rows):
    """
    Return what the quantities ``rows`` do at an end.

    ``inward``: the indices of all samples, the nearest to the end first; ``first``: of the sample half a
    step away.
    """
    if end.is_regular:
        return _at_stroke(sampler, end, side, slopes[:, inward[0]], rows)
    if end.is_flat:
        limits = sampler.limits(side)
    else:
        limits = _at_toggle(sampler, x, side, inward, first, values, noise, rows)
    rises = slopes[:, inward[0]] * side > 0.0        # seen from the end
    sense = np.where(np.isinf(limits), np.sign(limits), np.where(rises, -1, 1)).astype(int)
    place = sampler.fold(end.x)
    return [Found(row, place, float(limits[row]), int(sense[row]), side, end.is_flat) for row in rows.tolist()]


def _at_toggle(sampler, x, side, inward, first, values, noise, rows):
    """
    Return the limits of quantities at a toggle.

    Quantities are meromorphic in u: one that grows twofold each time the distance falls to a quarter has a
    pole. The others go on smoothly into the other assembly mode.
    """
    size = np.abs(values[:, inward[:5:2]])
    has_pole = (size[:, 0] > 2.0 * size[:, 1]) & (size[:, 1] > 2.0 * size[:, 2])
    limits = np.where(values[:, inward[0]] > 0.0, inf, -inf)
    if has_pole[rows].all():
        return limits
    near = first + side * np.arange(NEIGHBOURS)
    beyond = sampler.of(sampler.linkage.in_mode(3 - sampler.linkage.mode)).values(x[near])
    bounded = (values[:, near] + beyond) @ _THROUGH
    one_sided = values[:, near] @ _UP_TO
    # Angles are folded there: they do not go on, and are extrapolated, at the loss of three digits.
    folded = np.abs(one_sided - bounded) > 1e-6 * np.ptp(values[:, near], axis=1)
    bounded = np.where(folded, one_sided, bounded)
    bounded[np.abs(bounded) <= noise[:, first]] = 0.0
    return np.where(has_pole, limits, bounded)
