# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of arbitrary quantities along one input path: interior ones, ends, constant ranges.

Quantities are sampled with their derivatives on the points of
:mod:`fourbar_ros.extrema.input_paths`. Sign changes of the derivative, hidden pairs of them too,
are bracketed, and all brackets of all quantities solved at once.

Conditions. With F = dQ/dtheta1 at an extremum, its place moves by -sum (dF/da_i) da_i / F' and its
value by sum (dQ/da_i) da_i. For lengths that are each wrong by a relative eps, eps times the sums
of the absolute terms bounds both.
"""
from __future__ import annotations

from collections.abc import Callable
from math import comb, inf, nan
from typing import NamedTuple

from fourbar_ros.extrema.difference_sampling import DifferenceSampler
from fourbar_ros.extrema.digit_sampling import DigitSampler
from fourbar_ros.extrema.input_paths import End, InputPath
from fourbar_ros.extrema.sampling import Sampler, Samples
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.newton import newton_roots, SMALL
from fourbar_ros.numerics.roots import find_brackets, rises
import numpy as np

# Power of sin(mu) by which derivatives grow at toggles (that of the acceleration; forces grow
# faster by one, rates more slowly). With it they are smooth, that of a magnitude |F| only when
# multiplied by |F|: near a zero of the force it changes suddenly, F . dF/dtheta1 does not.
POLE = 5
# Samples on either side of an end from which the value there is interpolated.
NEIGHBOURS = 12
# A difference of so many errors, measured at some places, is none; the least bound of one.
CLEAR, SMALLEST = 8.0, 2.0**-1000
# How far beside a root slopes tell a kink from a smooth minimum, in samples.
KINK = 2.0**-12
# A bound of errors, as a part of a limit, from which on that is computed in many digits.
DOUBTFUL = 1e-9
# The samples from which it is extrapolated, from the end on: some 1e-5 to 1e-4 of the range.
NEAREST = slice(4, 8)
# Relative steps of a length, for conditions: at most the first; a part of the distance to the next
# change point, where everything changes; but never lost in rounding.
MOST_CHANGE, PART, LEAST_CHANGE = 2.0**-26, 2.0**-10, 2.0**-46
# Step in theta1 for the curvature, in distances of samples.
TURN = 2.0**-12


def _weights(number: int, terms: Callable[[int], int]) -> Array:
    """Return weights, of sum one, of Lagrange's formula at 0."""
    weights = np.array([(-1)**j * terms(j) / (j + 0.5) for j in range(number)])
    found: Array = weights / weights.sum()
    return found


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
    constant = _constant_values(sampler, samples)
    start, side = (0.0, 0) if path.low is None else (path.low.x, 1)
    found = [Found(row, sampler.fold(start), value, 0, side) for row, value in constant.items()]
    rows = np.array([row for row in range(len(samples.values)) if row not in constant], int)
    if rows.size:
        found += _interior(sampler, samples, rows, with_conditions)
        for side, end in path.ends():
            found += _at_end(sampler, samples, (side, end), rows)
    return found


def _constant_values(sampler: Sampler, samples: Samples) -> dict[int, float]:
    """Return {row: value} of quantities constant along a path."""
    middle = np.median(samples.values, axis=1)
    away = np.abs(samples.values - middle[:, None])
    varies = (away > 64.0 * EPS * np.abs(middle)[:, None]).any(axis=1)
    in_doubt = varies & (away <= samples.noise).all(axis=1)
    for side in sampler.flats:
        limits = sampler.next_to(middle, sampler.limits(side), np.arange(middle.size))
        is_fixed = ~sampler.varies_next_to(side)
        middle, varies = np.where(is_fixed, limits, middle), varies & ~is_fixed
    for row in np.flatnonzero(varies & in_doubt).tolist():
        value = _constant_in_digits(sampler, samples, row)
        if value is not None:
            varies[row], middle[row] = False, value
    return {row: float(middle[row]) for row in np.flatnonzero(~varies).tolist()}


def _constant_in_digits(sampler: Sampler, samples: Samples, row: int) -> float | None:
    """
    Return the value of a quantity that may be all rounding, None if it varies.

    Where it is least, largest and in the middle: it is constant if what it varies by is less than
    what a rounding of the data moves it by, and zero if it is less itself.
    """
    values, exact = samples.values[row], _in_digits(sampler)
    places = samples.path.x[[values.argmin(), values.size // 2, values.argmax()]]
    least, middle, largest = found = exact.values_at(places, np.full(3, row))
    if not np.isfinite(found).all():
        return None
    size, span = np.abs(found).max(), np.ptp(found)
    if span <= 64.0 * EPS * size:
        return float(middle)
    unmeant = exact.unmeant(places[1], row)
    if min(span, abs(middle)) > unmeant:
        return None
    is_same = max(middle - least, largest - middle) <= unmeant
    is_zero = all(abs(value) <= exact.unmeant(x, row) for x, value in zip(places, found))
    return 0.0 if is_zero else float(middle) if is_same else None


def _in_digits(sampler: Sampler) -> DigitSampler:
    """Return the same sampler in many digits, made once."""
    if not isinstance(sampler.exact, DigitSampler):
        sampler.exact = DigitSampler(sampler)
    return sampler.exact


class Roots(NamedTuple):
    """
    Where the slopes of quantities change their sign, arrays of shape (n,).

    Parameters
    ----------
    row, before, sense : ndarray of int
        Of which quantity, after which sample, +1 a maximum, -1 a minimum.
    x, spacing : ndarray
        Where, and the distance of the samples there.

    """

    row: Array
    before: Array
    sense: Array
    x: Array
    spacing: Array


def _roots(sampler: Sampler, samples: Samples, rows: Array) -> Roots:
    """Return the :class:`Roots` of the quantities ``rows`` between the samples."""
    x, is_closed = samples.path.x, samples.path.is_closed
    f = _smooth_slopes(sampler, samples, rows)
    turn = rises(np.unwrap(x)[:, None], False)[:, 0]
    i, row, xa, xb, fa, guess = find_brackets(lambda x, row: sampler.slope(x, rows[row]),
                                              lambda i, row: (x[i], turn[i]), f,
                                              rises(f, is_closed), is_closed)
    row, spacing = rows[row], xb - xa
    # where a force changes its sign the slope of its magnitude |F| jumps, that of F^2/2 does not
    is_positive = ((samples.values > 0.0).all(axis=1) & ~sampler.is_angle)[row]

    def at(x: Array, which: Array) -> tuple[Array, Array]:
        return sampler.newton(x, row[which], spacing[which], is_positive[which])

    root = newton_roots(at, np.arange(row.size), xa, xb, fa, guess) if row.size else xa
    sense = np.where(fa >= 0.0, 1, -1)
    if isinstance(sampler, DifferenceSampler) and row.size:
        root = sampler.polish(root, row, sense)
    return Roots(row, i, sense, root, spacing)


def _interior(sampler: Sampler, samples: Samples, rows: Array,
              with_conditions: bool) -> list[Found]:
    """
    Return the extrema of the quantities ``rows`` between the samples.

    Example: |F32| of the paper's linkage at 25 rad/s, at 128 samples of a turn. Its slope is -5246
    N/rad at sample 52, theta1 = -0.3477, and +6227 at sample 53, -0.3156; so the root between
    them, -0.3338, is a minimum. Its value, 46.3 N, is 80 N below sample 53 and 50 below 52, and
    rounding errors are at most 6e-11: it is accepted. Were the difference within them, or the
    value itself, many digits would decide.
    """
    roots = _roots(sampler, samples, rows)
    if not roots.row.size:
        return []
    value, noise = sampler.values_and_noise(roots.x, roots.row)
    is_small = np.flatnonzero((noise > 0.0) & (np.abs(value) <= noise))
    if is_small.size:
        value[is_small[_is_kink(sampler, roots, value, noise, is_small)]] = 0.0
    in_doubt = ((_drop(samples, roots, value) <= noise) | (value != 0.0) & (np.abs(value) <= noise)
                | samples.path.is_next_to_toggle(roots.before)) & (noise > 0.0)
    if in_doubt.any():
        roots, value, noise = _decided(sampler, samples, roots, value, noise, in_doubt)
    if not roots.row.size:
        return []
    value = sampler.next_to(samples.values[roots.row, roots.before], value, roots.row)
    conditions = (sampled_conditions(sampler, roots.x, roots.row, roots.spacing)
                  if with_conditions else np.full((2, roots.row.size), nan))
    return [Found._make((*fields[:4], 0, False, *fields[4:]))
            for fields in zip(*(v.tolist() for v in (roots.row, sampler.fold(roots.x), value,
                                                     roots.sense, *conditions, noise)))]


def _is_kink(sampler: Sampler, roots: Roots, value: Array, noise: Array, which: Array) -> Array:
    """
    Return where |F| is small because F changes its sign: where it has a kink, and is zero.

    The rounding of x explains what it is, or slopes in many digits beside x are alike in size.
    """
    x, turn, row = roots.x[which], KINK * roots.spacing[which], roots.row[which]
    slope = _kink_slope(*_beside(sampler, x, turn, row), 2.0**-2)
    ulps = 4.0 * EPS * np.maximum(np.abs(x), SMALL)
    is_kink: Array = np.abs(value[which]) <= ulps * slope
    for k in np.flatnonzero(~is_kink & (slope > 0.0)).tolist():
        turn = ulps[k:k + 1] + 2.0 * noise[which[k]] / slope[k]
        slopes = _beside(_in_digits(sampler), x[k:k + 1], turn, row[k:k + 1])
        is_kink[k] = _kink_slope(*slopes, 2.0**-20)[0] > 0.0
    return is_kink


def _beside(sampler: Sampler, x: Array, turn: Array, row: Array) -> tuple[Array, Array]:
    """Return the slopes of quantities before and after x."""
    before, after = np.split(sampler.slope(np.concatenate((x - turn, x + turn)),
                                           np.tile(row, 2)), 2)
    return before, after


def _kink_slope(before: Array, after: Array, unlike: float) -> Array:
    """Return the slope beside a kink of |F|, 0 where slopes are no opposites, up to a part."""
    size = np.maximum(np.abs(before), np.abs(after))
    return np.where((before * after < 0.0) & (np.abs(before + after) <= unlike * size), size, 0.0)


def _drop(samples: Samples, roots: Roots, value: Array) -> Array:
    """Return by how much values differ from the samples on both sides, of two the farther."""
    count = samples.path.x.size
    i = roots.before + np.array((-1, 0, 1, 2))[:, None]
    i = i % count if samples.path.is_closed else np.clip(i, 0, count - 1)
    away = np.abs(samples.values[roots.row, i] - value)
    drop: Array = np.minimum(np.maximum(*away[:2]), np.maximum(*away[2:]))
    return drop


def _decided(sampler: Sampler, samples: Samples, roots: Roots, value: Array, noise: Array,
             in_doubt: Array) -> tuple[Roots, Array, Array]:
    """
    Return roots, values and bounds of their errors, those in doubt computed in many digits.

    One that differs from its neighbours by more than the errors, measured there, stays where it
    is. Of a quantity that has another, slopes at all samples that errors may hide come from many
    digits too, and so do its roots.
    """
    exact, x = _in_digits(sampler), samples.path.x
    which = np.flatnonzero(in_doubt)
    row, before = roots.row[which], roots.before[which]
    values = exact.values_at(roots.x[which], row)
    beside = [np.abs(exact.values_at(x[i], row) - samples.values[row, i])
              for i in (before, (before + 1) % x.size)]
    error = np.maximum(np.abs(values - value[which]), np.maximum(*beside))
    which, row, error, values = (v[np.isfinite(error)] for v in (which, row, error, values))
    bound = np.maximum(noise[which], SMALLEST)
    value[which], noise[which] = values, 0.0
    is_lost = _drop(samples, roots, value)[which] <= CLEAR * error
    for lost in np.unique(row[is_lost]).tolist():
        part = (error / bound)[is_lost & (row == lost)].max()
        roots, value, noise = _searched_again(exact, samples, lost, CLEAR**2 * part,
                                              (roots, value, noise))
    return roots, value, noise


def _searched_again(exact: DigitSampler, samples: Samples, row: int, part: float,
                    found: tuple[Roots, Array, Array]) -> tuple[Roots, Array, Array]:
    """
    Return what was found, of one quantity in many digits.

    ``part``: of the bounds of errors that may hide a slope.
    """
    values, slopes, x = samples.values.copy(), samples.slopes.copy(), samples.path.x
    is_hidden = np.abs(np.diff(values[row])) <= part * np.minimum(samples.noise[row, 1:],
                                                                  samples.noise[row, :-1])
    here = np.flatnonzero(np.append(is_hidden, False) | np.append(False, is_hidden))
    true = exact.at(x[here], np.full(here.size, row))
    is_known = np.isfinite(true).all(axis=0)
    values[row, here[is_known]], slopes[row, here[is_known]] = (v[is_known] for v in true)
    again = _roots(exact, samples._replace(values=values, slopes=slopes), np.array([row]))
    others, (roots, *before) = found[0].row != row, found
    added = *again, exact.values_at(again.x, again.row), np.zeros(again.x.size)
    *fields, value, noise = [np.concatenate((old[others], new))
                             for old, new in zip((*roots, *before), added)]
    return Roots(*fields), value, noise


def _smooth_slopes(sampler: Sampler, samples: Samples, rows: Array) -> Array:
    """Return derivatives at the samples, (n, rows), times a power of the sine without poles."""
    sine = np.abs(sampler.linkage.transmission_sine(samples.state[0]))
    values = samples.values[rows]
    scale = np.where((values > 0.0).all(axis=1, keepdims=True), values * sine**(2 * POLE - 1),
                     sine**POLE)
    found: Array = samples.slopes[rows].T * scale.T
    return found


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
    slopes, next_one = samples.slopes[:, nearest], samples.path.inward(side)[1]
    step = np.abs(samples.values[:, nearest] - samples.values[:, next_one])
    for row in rows[(step <= samples.noise[:, nearest])[rows] & ~np.isinf(limits)[rows]].tolist():
        here = samples.path.x[nearest:][:1]
        true = _in_digits(sampler).slope(here, np.array([row]))[0]
        slopes[row] = slopes[row] if np.isnan(true) else true
    falls = slopes * side > 0.0        # seen from inside
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
    near = path.half_a_step_from(side) + side * np.arange(NEIGHBOURS)
    mode = sampler.linkage.mode_beyond(sampler.unit * end.x)
    other = sampler.of(sampler.linkage.in_mode(mode))
    here = values[:, near]
    bounded, goes_on = _continued(sampler, here, other.values(path.x[near]))
    in_doubt = ~has_pole & ~sampler.is_angle & (
        ~goes_on | (samples.noise[:, near[0]] > DOUBTFUL * np.abs(bounded)))
    for row in rows[in_doubt[rows]].tolist():
        i = inward[NEAREST]
        true = _in_digits(sampler).values_at(path.x[i], np.full(i.size, row))
        if np.isfinite(true).all():
            bounded[row] = _weights_at_zero(np.sqrt(np.abs(path.x[i] - end.x))) @ true
    bounded[np.abs(bounded) <= 64.0 * EPS * np.abs(here).max(axis=1)] = 0.0
    return np.where(has_pole, limits, bounded)


def _weights_at_zero(u: Array) -> Array:
    """Return weights, of values at u, of the polynomial through them at 0."""
    parts = u / (u - u[:, None] + np.diag(u))       # of number j in the weight of number i
    found: Array = np.prod(parts, axis=1)
    return found


def _continued(sampler: Sampler, here: Array, beyond: Array) -> tuple[Array, Array]:
    """Return limits from the samples on both sides of a toggle, and which go on smoothly there."""
    every = np.arange(len(beyond))[:, None]
    one_sided = here @ _UP_TO
    # An angle in [0, pi] goes on as its negative.
    both = [(here + sampler.next_to(here, sign * beyond, every)) @ _THROUGH
            for sign in (1.0, -1.0)]
    mirrored = sampler.is_angle & (np.abs(both[1] - one_sided) < np.abs(both[0] - one_sided))
    bounded = np.where(mirrored, both[1], both[0])
    # What does not go on, as angles in functions may not, is extrapolated, at the loss of three
    # digits.
    goes_on = np.abs(one_sided - bounded) <= 1e-6 * np.ptp(here, axis=1)
    return np.where(goes_on, bounded, one_sided), goes_on


def perturbed_lengths(mechanism: Mechanism) -> tuple[list[float], list[tuple[float, ...]]]:
    """Return a relative step for each length, and the lengths changed by it."""
    size = min(MOST_CHANGE, max(LEAST_CHANGE, PART * mechanism.change_point_margin))
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
    Return the conditions of place [rad] and relative value of a sampler's extrema, shape (n,).

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
