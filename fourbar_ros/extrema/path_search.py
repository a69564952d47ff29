# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of arbitrary quantities along one input path.

Interior ones, ends, ranges where they are constant.

Quantities are sampled with their derivatives on the points of
:mod:`fourbar_ros.extrema.input_paths`. Sign changes of the derivative, hidden pairs of them too,
are bracketed, and all brackets of all quantities solved at once.
"""
from __future__ import annotations

from collections.abc import Callable
from math import comb, inf, nan
from typing import NamedTuple

from fourbar_ros.extrema.difference_sampling import DifferenceSampler
from fourbar_ros.extrema.input_paths import End, InputPath
from fourbar_ros.extrema.sampling import Sampler, Samples
from fourbar_ros.extrema.sensitivity import sampled_conditions
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.newton import newton_roots
from fourbar_ros.numerics.roots import EPS, find_brackets, rises
import numpy as np

# Power of sin(mu) by which derivatives grow at toggles (that of the acceleration; forces grow
# faster by one, rates more slowly). With it they are smooth, that of a magnitude |F| only when
# multiplied by |F|: near a zero of the force it changes suddenly, F . dF/dtheta1 does not.
POLE = 5
# Samples on either side of an end from which the value there is interpolated.
NEIGHBOURS = 12


def _weights(number: int, terms: Callable[[int], int]) -> Array:
    """Return weights, of sum one, of Lagrange's formula at 0."""
    weights = np.array([(-1)**j * terms(j) / (j + 0.5) for j in range(number)])
    return weights / weights.sum()


# For samples at +-1/2, 3/2, ... together, and for those on one side.
_THROUGH = 0.5 * _weights(NEIGHBOURS, lambda j: comb(2 * NEIGHBOURS - 1, NEIGHBOURS + j))
_UP_TO = _weights(NEIGHBOURS, lambda j: comb(NEIGHBOURS - 1, j))


class Found(NamedTuple):
    """
    One extremum of quantity number ``row``, as it was found.

    Parameters
    ----------
    row : int
    place : float
        Input, in the mechanism's unit.
    value : float
    sense : int
        +1 maximum, -1 minimum, 0 constant from here on.
    side, condition, value_condition
        As in :class:`~fourbar_ros.extrema.find.Extremum`.
    is_flat : bool
        At the flat position of a change point.
    noise : float
        Bound of the rounding error of the value, beside that of its last bits.

    """

    row: int
    place: float
    value: float
    sense: int
    side: int = 0
    is_flat: bool = False
    condition: float = nan
    value_condition: float = nan
    noise: float = 0.0


def search_path(sampler: Sampler, path: InputPath, with_conditions: bool = True) -> list[Found]:
    """Return the extrema of all quantities of a sampler along one path."""
    samples = sampler.along(path)
    constant, noise = _constant_values(sampler, samples)
    start, side = (0.0, 0) if path.low is None else (path.low.x, 1)
    found = [Found(row, sampler.fold(start), value, 0, side) for row, value in constant.items()]
    rows = np.array([row for row in range(len(samples.values)) if row not in constant], int)
    if rows.size:
        found += _interior(sampler, samples, rows, with_conditions)
        samples = samples._replace(noise=noise)
        for side, end in path.ends():
            found += _at_end(sampler, samples, (side, end), rows)
    return found


def _constant_values(sampler: Sampler, samples: Samples) -> tuple[dict[int, float], Array]:
    """Return {row: value} of quantities constant along a path, and the noise of each sample."""
    middle = np.median(samples.values, axis=1)
    noise = np.maximum(samples.noise, 64.0 * EPS * np.abs(middle)[:, None])
    varies = (np.abs(samples.values - middle[:, None]) > noise).any(axis=1)
    for side in sampler.flats:
        varies &= sampler.varies_next_to(side)
        limits = sampler.next_to(middle, sampler.limits(side), np.arange(middle.size))
        middle = np.where(varies, middle, limits)
    middle[np.abs(middle) <= noise.min(axis=1)] = 0.0
    return {row: float(middle[row]) for row in np.nonzero(~varies)[0].tolist()}, noise


def _interior(sampler: Sampler, samples: Samples, rows: Array,
              with_conditions: bool) -> list[Found]:
    """Return the extrema of the quantities ``rows`` between the samples."""
    x, is_closed = samples.path.x, samples.path.is_closed
    f = _smooth_slopes(sampler, samples, rows)
    turn = rises(np.unwrap(x)[:, None], False)[:, 0]
    i, row, xa, xb, fa, guess = find_brackets(lambda x, row: sampler.slope(x, rows[row]),
                                              lambda i, row: (x[i], turn[i]), f,
                                              rises(f, is_closed), is_closed)
    if not row.size:
        return []
    row, spacing = rows[row], xb - xa
    # where a force changes its sign the slope of its magnitude |F| jumps, that of F^2/2 does not
    is_positive = ((samples.values > 0.0).all(axis=1) & ~sampler.is_angle)[row]

    def at(x: Array, which: Array) -> tuple[Array, Array]:
        return sampler.newton(x, row[which], spacing[which], is_positive[which])

    root = newton_roots(at, np.arange(row.size), xa, xb, fa, guess)
    sense = np.where(fa >= 0.0, 1, -1)
    if isinstance(sampler, DifferenceSampler):
        root = sampler.polish(root, row, sense)
    place = sampler.fold(root)
    value, noise = sampler.values_and_noise(place, row)
    value = sampler.next_to(samples.values[row, i], value, row)
    conditions = (sampled_conditions(sampler, root, row, spacing) if with_conditions
                  else np.full((2, row.size), nan))
    return [Found._make((*fields[:4], 0, False, *fields[4:]))
            for fields in zip(*(v.tolist() for v in (row, place, value, sense, *conditions,
                                                     noise)))]


def _smooth_slopes(sampler: Sampler, samples: Samples, rows: Array) -> Array:
    """Return derivatives at the samples, (n, rows), times a power of the sine without poles."""
    sine = np.abs(sampler.linkage.transmission_sine(samples.state[0]))
    values = samples.values[rows]
    scale = np.where((values > 0.0).all(axis=1, keepdims=True), values * sine**(2 * POLE - 1),
                     sine**POLE)
    return samples.slopes[rows].T * scale.T


def _at_end(sampler: Sampler, samples: Samples, where: tuple[int, End],
            rows: Array) -> list[Found]:
    """Return what the quantities ``rows`` do at one end of a path: (side, end)."""
    side, end = where
    if end.is_regular:
        limits = sampler.values(np.array([end.x]))[:, 0]
    elif end.is_flat:
        limits = sampler.limits(side)
    else:
        limits = _limits_at_toggle(sampler, samples, where, rows)
    nearest = samples.path.inward(side)[0]
    limits = sampler.next_to(samples.values[:, nearest], limits, np.arange(limits.size))
    falls = samples.slopes[:, nearest] * side > 0.0        # seen from inside
    sense = np.where(np.isinf(limits), np.sign(limits), np.where(falls, -1, 1)).astype(int)
    place = sampler.fold(end.x)
    return [Found(row, place, float(limits[row]), int(sense[row]), side, end.is_flat)
            for row in rows.tolist()]


def _limits_at_toggle(sampler: Sampler, samples: Samples, where: tuple[int, End],
                      rows: Array) -> Array:
    """
    Return the limits of all quantities at a toggle; right for ``rows``.

    Quantities are meromorphic in the path's parameter: one that grows twofold each time the
    distance falls to a quarter has a pole. The others go on smoothly into the other assembly mode.
    """
    values, path, (side, end) = samples.values, samples.path, where
    inward = path.inward(side)
    size = np.abs(values[:, inward[:5:2]])
    has_pole = (size[:, 0] > 2.0 * size[:, 1]) & (size[:, 1] > 2.0 * size[:, 2])
    limits = np.where(values[:, inward[0]] > 0.0, inf, -inf)
    if has_pole[rows].all():
        return limits
    first = path.half_a_step_from(side)
    near = first + side * np.arange(NEIGHBOURS)
    mode = sampler.linkage.mode_beyond(sampler.unit * end.x)
    beyond = sampler.of(sampler.linkage.in_mode(mode)).values(path.x[near])
    every = np.arange(len(beyond))[:, None]
    one_sided = values[:, near] @ _UP_TO
    # An angle in [0, pi] goes on as its negative.
    both = [(values[:, near] + sampler.next_to(values[:, near], sign * beyond, every)) @ _THROUGH
            for sign in (1.0, -1.0)]
    mirrored = sampler.is_angle & (np.abs(both[1] - one_sided) < np.abs(both[0] - one_sided))
    bounded = np.where(mirrored, both[1], both[0])
    # What does not go on, as angles in functions may not, is extrapolated, at the loss of three
    # digits.
    folded = np.abs(one_sided - bounded) > 1e-6 * np.ptp(values[:, near], axis=1)
    bounded = np.where(folded, one_sided, bounded)
    bounded[np.abs(bounded) <= samples.noise[:, first]] = 0.0
    return np.where(has_pole, limits, bounded)
