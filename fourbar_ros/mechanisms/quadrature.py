# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Means over the input of a mechanism: inputs and weights of sum one, and a mean that settles.

Over a full period the trapezoidal rule, which is spectral there. Else Gauss's rule in the angle
phi of x = middle + half sin(phi): roots of the distance to a toggle at an end, as angles have, are
smooth in phi. Ranges are cut at the flat positions of a change point, where reactions have poles.
"""
from collections.abc import Callable, Sequence
from functools import lru_cache
from math import pi, sqrt

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Ranges
from fourbar_ros.numerics.arrays import Array, sine_between
import numpy as np

MOST_OF_RANGE = 1024        # points of a range: they are eigenvalues, more would take seconds
# Points of a mean: doubled from, at most to, until two means agree to this part of the mean size.
POINTS, MOST, AGREE = 128, 512, 1e-12
# A mean that has not settled by then is made of parts of so many points, which are halved until
# both halves together agree with the whole: at most so many times, so many parts at once.
POINTS_OF_PART, HALVINGS, PARTS = 16, 60, 4096

gauss = lru_cache(maxsize=8)(np.polynomial.legendre.leggauss)      # points -> roots, weights


def smooth_ranges(mechanism: Mechanism, ends: Sequence[float] = (), ranges: Ranges = ()) -> Ranges:
    """Return the ranges of the input [rad or m], cut at flat positions and ends of pieces."""
    # ends: those of friction, within a cycle; ranges: others than those of the mechanism, at most
    # a cycle before or after it.
    parts = list[tuple[float, float]]()
    cuts = {*mechanism.flat_inputs}
    ends = [*ends, *(mechanism.pieces.ends if mechanism.pieces else ())]
    if ranges and not mechanism.is_driven_by_slide:
        ends = [x + turn * mechanism.cycle for x in ends for turn in (-1, 0, 1)]
    if not ranges and mechanism.turns_fully:
        ranges = ((-0.5 * mechanism.cycle, 0.5 * mechanism.cycle),)
    ranges = ranges or mechanism.input_ranges
    if not mechanism.is_driven_by_slide:        # flat in each turn; a cycle is one, or a few
        first, last = (round(end / (2.0 * pi)) for end in (ranges[0][0], ranges[-1][1]))
        cuts |= {x + 2.0 * pi * turn for x in cuts for turn in range(first - 1, last + 2)}
    cuts |= {*ends}
    for low, high in ranges:
        inner = sorted({x for x in cuts if low < x < high})
        parts += zip([low, *inner], [*inner, high])
    return tuple(parts)


def nodes(mechanism: Mechanism, points: int, ranges: Ranges = ()) -> tuple[Array, Array]:
    """Return inputs and weights of a mean over the input, ``points`` in each of its ranges."""
    # At most MOST_OF_RANGE, and fewer in each of many pieces between ends of forces. ranges: parts
    # of the input [rad or m] instead, each without a toggle inside.
    if mechanism.turns_fully and not ranges and not (mechanism.pieces and mechanism.pieces.ends):
        start = 0.5 if mechanism.flat_inputs else 0.0       # beside their poles
        return (mechanism.cycle * (np.arange(points) + start) / points,
                np.full(points, 1.0 / points))
    ranges = ranges or smooth_ranges(mechanism)
    if mechanism.pieces:        # there may be hundreds, and more points are more in each
        points = max(points // len(ranges), round(POINTS_OF_PART * sqrt(points / POINTS)))
    roots, weights = gauss(min(points, MOST_OF_RANGE))
    phi = 0.5 * pi * roots
    whole = sum(high - low for low, high in ranges)
    x = [0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi) for low, high in ranges]
    parts = [0.25 * pi * weights * np.cos(phi) * ((high - low) / whole) for low, high in ranges]
    return np.concatenate(x), np.concatenate(parts)


def mean_over_input(mechanism: Mechanism, values_at: Callable[[Array], Array],
                    ranges: Ranges = (), least_size: Sequence[float] | float = 0.0) -> Array:
    """Return the means of k functions over the input, shape (k,); NaN if they do not settle."""
    # values_at: inputs [rad or m], shape (n,) -> values, shape (k, n); ranges: as of nodes().
    # Means settle to 1e-12 of the mean size of each function, or of least_size where it is
    # smaller, jumps and narrow peaks included, by _mean_by_parts(); those of functions that grow
    # as one over the distance from a toggle, or faster, and those of rounding noise do not.
    points, mean = POINTS, np.array(np.nan)     # which agrees with no first mean
    while points <= MOST:
        x, weights = nodes(mechanism, points, ranges)
        values = values_at(x)
        before, mean = mean, values @ weights
        size = np.maximum(np.abs(values) @ weights, least_size)
        if (np.abs(mean - before) <= AGREE * size).all():
            return mean
        points *= 2
    return _mean_by_parts(values_at, ranges or smooth_ranges(mechanism), np.array(least_size))


def _mean_by_parts(values_at: Callable[[Array], Array], ranges: Ranges, least_size: Array
                   ) -> Array:
    """Return the means of functions as :func:`mean_over_input`, from parts that are halved."""
    roots, weights = gauss(POINTS_OF_PART)
    low, high = np.repeat(np.array(ranges).T, 4, axis=1)
    first = np.tile(0.25 * pi * np.arange(-2, 2), len(ranges))
    last = first + 0.25 * pi

    def integrals(low: Array, high: Array, first: Array, last: Array) -> tuple[Array, Array]:
        """Return the integrals of functions and of their sizes, (k, parts), between two phi."""
        phi = 0.5 * (first + last) + 0.5 * (last - first) * roots[:, None]
        values = values_at(sine_between(low, high, phi).ravel())
        values = values.reshape(-1, *phi.shape) * (0.5 * (high - low) * np.cos(phi))
        width = 0.5 * (last - first)
        return (width * np.tensordot(values, weights, (1, 0)),
                width * np.tensordot(np.abs(values), weights, (1, 0)))

    whole, size = integrals(low, high, first, last)
    width = sum(end - begin for begin, end in ranges)
    least = AGREE * np.maximum(size.sum(axis=1), width * least_size)[:, None]
    total = np.zeros(len(whole))
    for _ in range(HALVINGS):
        middle = 0.5 * (first + last)
        left, right = integrals(low, high, first, middle), integrals(low, high, middle, last)
        halves = left[0] + right[0]
        is_open = ~(np.abs(halves - whole) <= least).all(axis=0)
        total += halves[:, ~is_open].sum(axis=1)
        low, high = (np.tile(end[is_open], 2) for end in (low, high))
        first, last = (np.concatenate((of_left[is_open], of_right[is_open]))
                       for of_left, of_right in ((first, middle), (middle, last)))
        whole = np.concatenate((left[0][:, is_open], right[0][:, is_open]), axis=1)
        if not first.size:
            return np.asarray(total / width)
        if first.size > PARTS:
            break
    return np.full(len(total), np.nan)
