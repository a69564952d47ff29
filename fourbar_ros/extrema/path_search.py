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

from collections.abc import Callable, Sequence
from math import comb, inf, nan
from typing import NamedTuple

from fourbar_ros.extrema.difference_sampling import DifferenceSampler
from fourbar_ros.extrema.digit_sampling import DigitSampler
from fourbar_ros.extrema.input_paths import End, InputPath
from fourbar_ros.extrema.sampling import Sampler, Samples
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.newton import newton_roots, SMALL
from fourbar_ros.numerics.roots import find_brackets, rises
import numpy as np

# Power of sin(mu) by which derivatives grow at toggles (for accelerations; forces grow faster by
# one, rates more slowly). Times this power they are smooth. The derivative of a magnitude |F|
# needs the factor |F| too: near a zero of the force it changes suddenly, F . dF/dtheta1 does not.
POLE = 5
# Samples on either side of an end from which the value there is interpolated.
NEIGHBOURS = 12
# A difference of so many errors, measured at some places, is none; the least bound of one.
CLEAR, SMALLEST = 8.0, 2.0**-1000
# Distance from a root at which slopes tell a kink from a smooth minimum, in samples.
KINK = 2.0**-12
# A limit whose error bound exceeds this part of it is computed in many digits.
DOUBTFUL = 1e-9
# The samples from which it is extrapolated, from the end on: some 1e-5 to 1e-4 of the range.
NEAREST = slice(4, 8)
# Step in theta1 for the curvature, in distances of samples, at least.
TURN = 2.0**-12


def _weights(number: int, terms: Callable[[int], int]) -> Array:
    """Return weights, of sum one, that extrapolate samples at 1/2, 3/2, ... to 0 (Lagrange)."""
    weights = np.array([(-1)**j * terms(j) / (j + 0.5) for j in range(number)])
    return np.asarray(weights / weights.sum())


# For samples at +-1/2, 3/2, ... together, and for those on one side.
_THROUGH = 0.5 * _weights(NEIGHBOURS, lambda j: comb(2 * NEIGHBOURS - 1, NEIGHBOURS + j))
_UP_TO = _weights(NEIGHBOURS, lambda j: comb(NEIGHBOURS - 1, j))


class PathExtremum(NamedTuple):
    """One extremum of one quantity, found on a path of the input."""

    row: int                         # number of the quantity in the sampler
    place: float                     # input, in the mechanism's unit
    value: float
    sense: int                       # +1 maximum, -1 minimum, 0 constant from here on
    side: int = 0                    # as in :class:`~fourbar_ros.extrema.find.Extremum`
    is_flat: bool = False            # at the flat position of a change point
    condition: float = nan           # as in Extremum, of the place
    value_condition: float = nan
    noise: float = 0.0               # bound of the error of the value, besides its last bits


def search_path(sampler: Sampler, path: InputPath, with_conditions: bool = True,
                more: Sequence[float] = ()) -> list[PathExtremum]:
    """
    Return the extrema of all quantities of a sampler along one path, its ends among them.

    ``more``: inputs of further samples.
    """
    samples = sampler.along(path)
    constant = _constant_values(sampler, samples)
    start, side = (0.0, 0) if path.low is None else (path.low.x, 1)
    extrema = [PathExtremum(row, sampler.fold(start), value, 0, side)
               for row, value in constant.items()]
    rows = np.array([row for row in range(len(samples.values)) if row not in constant], int)
    if rows.size:
        inside = sampler.along(path.with_points(np.array(more))) if more else samples
        extrema += _interior(sampler, inside, rows, with_conditions)
        for side, end in path.ends():
            extrema += _at_end(sampler, samples, (side, end), rows)
    return extrema


def _constant_values(sampler: Sampler, samples: Samples) -> dict[int, float]:
    """
    Return {row: value} of the quantities that are constant along a path, up to rounding.

    Next to flat positions series tell; where a variation is within the bound of rounding errors,
    many digits.
    """
    middle = np.median(samples.values, axis=1)
    away = np.abs(samples.values - middle[:, None])
    varies = (away > 64.0 * EPS * np.abs(middle)[:, None]).any(axis=1)
    in_doubt = varies & (away <= samples.noise).all(axis=1)
    for side in sampler.flats:
        limits = sampler.same_turn(middle, sampler.limits(side), np.arange(middle.size))
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

    It is computed in many digits where it seems least, middle and largest. It is constant if it
    varies by less than a rounding of the data moves it, and zero if it is itself less than that.
    """
    values, exact = samples.values[row], _in_digits(sampler)
    places = samples.path.x[[values.argmin(), values.size // 2, values.argmax()]]
    least, middle, largest = three = exact.values_at(places, np.full(3, row))
    if not np.isfinite(three).all():
        return None
    size, span = np.abs(three).max(), np.ptp(three)
    if span <= 64.0 * EPS * size:
        return float(middle)
    rounding = exact.rounding_of_data(places[1], row)
    if min(span, abs(middle)) > rounding:
        return None
    if all(abs(value) <= exact.rounding_of_data(x, row) for x, value in zip(places, three)):
        return 0.0
    return float(middle) if max(middle - least, largest - middle) <= rounding else None


def _in_digits(sampler: Sampler) -> DigitSampler:
    """Return the sampler of the same quantities in many digits, made once."""
    if not isinstance(sampler.exact, DigitSampler):
        sampler.exact = DigitSampler(sampler)
    return sampler.exact


class Roots(NamedTuple):
    """Where the slopes of quantities change their sign, arrays of shape (n,)."""

    row: Array          # number of the quantity
    before: Array       # number of the sample before the root
    sense: Array        # +1 a maximum, -1 a minimum
    x: Array            # the input there
    spacing: Array      # distance of the samples there


def _roots(sampler: Sampler, samples: Samples, rows: Array) -> Roots:
    """Return where the slopes of the quantities ``rows`` change sign, hidden pairs too."""
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
        """Return the slopes (or those of squares) and Newton steps for some of the brackets."""
        return sampler.newton(x, row[which], spacing[which], is_positive[which])

    root = newton_roots(at, np.arange(row.size), xa, xb, fa, guess) if row.size else xa
    which = np.flatnonzero(is_positive)
    if which.size:      # one that dips below zero between samples is no magnitude
        before, after = _beside(sampler, root[which], KINK * spacing[which], row[which])
        which = which[before * after > 0.0]
    if which.size:
        is_positive[which] = False
        root[which] = newton_roots(at, which, *(v[which] for v in (xa, xb, fa, guess)))
    sense = np.where(fa >= 0.0, 1, -1)
    if isinstance(sampler, DifferenceSampler) and row.size:
        root = sampler.polish(root, row, sense)
    return Roots(row, i, sense, root, spacing)


def _interior(sampler: Sampler, samples: Samples, rows: Array,
              with_conditions: bool) -> list[PathExtremum]:
    """
    Return the extrema of the quantities ``rows`` between the samples.

    Example: |F32| of the paper's linkage at 25 rad/s, at 256 samples of a turn. Its slope is -3769
    N/rad at sample 105, theta1 = -0.3396, and +5327 at sample 106, -0.3236; so the root between
    them, -0.3338, is a minimum. Its value, 46.3 N, is 34 N below sample 106 and 12 below 105, and
    rounding errors are at most 7e-11: it is accepted. Were the difference within them, or the
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
    value = sampler.same_turn(samples.values[roots.row, roots.before], value, roots.row)
    conditions = (sampled_conditions(sampler, roots.x, roots.row, roots.spacing)
                  if with_conditions else np.full((2, roots.row.size), nan))
    return [PathExtremum._make((*fields[:4], 0, False, *fields[4:]))
            for fields in zip(*(v.tolist() for v in (roots.row, sampler.fold(roots.x), value,
                                                     roots.sense, *conditions, noise)))]


def _is_kink(sampler: Sampler, roots: Roots, value: Array, noise: Array, which: Array) -> Array:
    """
    Return which magnitudes |F| at roots are small because F changes its sign: they are kinks.

    |F| is zero there. Either the rounding of x explains the value, or slopes on both sides, in
    many digits, are opposite and alike in size.
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
    """Return the slopes of quantities ``row`` at x - turn and at x + turn."""
    before, after = np.split(sampler.slope(np.concatenate((x - turn, x + turn)),
                                           np.tile(row, 2)), 2)
    return before, after


def _kink_slope(before: Array, after: Array, unlike: float) -> Array:
    """
    Return the size of the slope beside a kink of |F|, or 0 where there is no kink.

    At a kink slopes are opposite, and alike up to the part ``unlike`` of their size.
    """
    size = np.maximum(np.abs(before), np.abs(after))
    return np.where((before * after < 0.0) & (np.abs(before + after) <= unlike * size), size, 0.0)


def _drop(samples: Samples, roots: Roots, value: Array) -> Array:
    """
    Return by how much the values at roots differ from the samples around them, shape (n,).

    On each side the larger difference of two samples counts, of both sides the smaller one. An
    extremum whose drop is within rounding errors may be none.
    """
    count = samples.path.x.size
    i = roots.before + np.array((-1, 0, 1, 2))[:, None]
    i = i % count if samples.path.is_closed else np.clip(i, 0, count - 1)
    away = np.abs(samples.values[roots.row, i] - value)
    return np.asarray(np.minimum(np.maximum(*away[:2]), np.maximum(*away[2:])))


def _decided(sampler: Sampler, samples: Samples, roots: Roots, value: Array, noise: Array,
             in_doubt: Array) -> tuple[Roots, Array, Array]:
    """
    Return roots, values and bounds of their errors, those in doubt computed in many digits.

    The errors are measured at the root and the samples next to it. A root that differs from its
    neighbours by more stays where it is. Otherwise all slopes of its quantity that errors may hide
    are computed in many digits, and its roots are searched again.
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
    Return (roots, values, bounds of errors) with those of one quantity searched in many digits.

    ``found``: the same, before. Slopes are computed anew where neighbouring samples differ by less
    than ``part`` of the bound of their errors.
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
    """
    Return derivatives at the samples, shape (n, rows), times a power of sin(mu).

    At a toggle derivatives have poles of that power; without them sign changes show between
    samples. A positive factor moves no root.
    """
    sine = np.abs(sampler.linkage.transmission_sine(samples.state[0]))
    values = samples.values[rows]
    scale = np.where((values > 0.0).all(axis=1, keepdims=True), values * sine**(2 * POLE - 1),
                     sine**POLE)
    return np.asarray(samples.slopes[rows].T * scale.T)


def _at_end(sampler: Sampler, samples: Samples, where: tuple[int, End],
            rows: Array) -> list[PathExtremum]:
    """
    Return the limits of the quantities ``rows`` at one end of a path as extrema.

    ``where``: (side, end), side +1 if the path lies above the end. A limit is infinite, or it is
    one-sided: a minimum if the quantity rises inward, else a maximum.
    """
    side, end = where
    if end.is_regular:
        limits = sampler.values(np.array([end.x]))[:, 0]
    elif end.is_flat:
        limits = sampler.limits(side)
    else:
        limits = _limits_at_toggle(sampler, samples, where, rows)
    nearest = samples.path.inward(side)[0]
    limits = sampler.same_turn(samples.values[:, nearest], limits, np.arange(limits.size))
    slopes, next_one = samples.slopes[:, nearest], samples.path.inward(side)[1]
    step = np.abs(samples.values[:, nearest] - samples.values[:, next_one])
    for row in rows[(step <= samples.noise[:, nearest])[rows] & ~np.isinf(limits)[rows]].tolist():
        # the step is within rounding: many digits tell the slope
        true = _in_digits(sampler).slope(samples.path.x[nearest:][:1], np.array([row]))[0]
        slopes[row] = slopes[row] if np.isnan(true) else true
    falls = slopes * side > 0.0        # seen from inside
    sense = np.where(np.isinf(limits), np.sign(limits), np.where(falls, -1, 1)).astype(int)
    place = sampler.fold(end.x)
    return [PathExtremum(row, place, float(limits[row]), int(sense[row]), side, end.is_flat)
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
    """
    Return the weights with which values at u extrapolate to 0, by the polynomial through them.

    For u = (1, 2): 2 and -1, so that values 3 and 4 give 2.
    """
    parts = u / (u - u[:, None] + np.diag(u))       # of number j in the weight of number i
    return np.asarray(np.prod(parts, axis=1))


def _continued(sampler: Sampler, here: Array, beyond: Array) -> tuple[Array, Array]:
    """
    Return the limits of quantities at a toggle, and which quantities go on smoothly there.

    ``here``, ``beyond``: samples on the path and on that of the other assembly mode, each from the
    toggle on, shape (quantities, 12). One polynomial through both sides is three digits better
    than an extrapolation from one.
    """
    every = np.arange(len(beyond))[:, None]
    one_sided = here @ _UP_TO
    # An angle in [0, pi] goes on as its negative.
    both = [(here + sampler.same_turn(here, sign * beyond, every)) @ _THROUGH
            for sign in (1.0, -1.0)]
    mirrored = sampler.is_angle & (np.abs(both[1] - one_sided) < np.abs(both[0] - one_sided))
    bounded = np.where(mirrored, both[1], both[0])
    # Quantities that do not go on, such as some angles in functions, are extrapolated, at the loss
    # of three digits.
    goes_on = np.abs(one_sided - bounded) <= 1e-6 * np.ptp(here, axis=1)
    return np.where(goes_on, bounded, one_sided), goes_on


def sampled_conditions(sampler: Sampler, x: Array, row: Array,
                       spacing: Array) -> tuple[Array, Array]:
    """
    Return the conditions of the place and of the relative value of n extrema, each (n,).

    They come from derivatives by the lengths beside each: see the top of this file. ``x``: places
    of the extrema; ``row``: their quantities; ``spacing``: distance of samples there.
    """
    turn = max(TURN, 4.0 * sampler.TURN) * spacing    # differences reach half as far
    around, rows = np.concatenate((x - turn, x, x + turn)), np.tile(row, 3)
    (_, value, _), (before, _, after) = (np.split(part, 3) for part in sampler.at(around, rows))
    by = np.split(sampler.by_lengths(around, rows), 3)
    with np.errstate(divide='ignore', invalid='ignore'):
        return (np.abs(by[2] - by[0]).sum(axis=1) / np.abs(after - before),
                np.abs(by[1]).sum(axis=1) / np.abs(value))
