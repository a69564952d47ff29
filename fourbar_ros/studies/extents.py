# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The largest and the least of the extrema of one quantity of many designs."""
from __future__ import annotations

from fourbar_ros.numerics.arrays import Array
import numpy as np

# Between the mean squares of all samples and of every other one: it falls with its square.
AGREE = 1e-6


class Extent:
    """
    The extrema of one quantity of n designs.

    Parameters
    ----------
    samples : ndarray, shape (n, samples)
        Over a turn, at equal steps.
    counts : ndarray of int, shape (n,)
    places, values : ndarray, shape (n, r)
        NaN beyond the last.

    """

    def __init__(self, samples: Array, counts: Array, places: Array, values: Array) -> None:
        self.samples, self.counts = samples, counts
        if not values.shape[-1]:
            places = values = np.full((len(values), 1), np.nan)
        self.is_there = counts > 0
        rows = np.arange(len(values))
        with np.errstate(all='ignore'):
            most = np.argmax(np.where(np.isnan(values), -np.inf, values), axis=1)
            least = np.argmin(np.where(np.isnan(values), np.inf, values), axis=1)
        self._ends = values[rows, most], values[rows, least]
        self._places = places[rows, most], places[rows, least]

    def of(self, part: str) -> Array:
        """Return a part by name."""
        (most, least), (most_at, least_at) = self._ends, self._places
        if part in ('span', 'peak'):
            with np.errstate(invalid='ignore'):         # from one infinity to the other
                found: Array = (most - least if part == 'span'
                                else np.maximum(np.abs(most), np.abs(least)))
            return found
        return {'max': most, 'min': least, 'max_at': most_at, 'min_at': least_at,
                'extrema': self.counts}[part]

    def rms(self) -> tuple[Array, Array]:
        """Return root mean squares, and where they are right to rounding."""
        squares = self.samples * self.samples
        mean, half = squares.mean(axis=1), squares[:, ::2].mean(axis=1)
        return np.sqrt(mean), np.abs(mean - half) <= AGREE * mean


def extent_of_list(index: Array, places: Array, values: Array, size: int) -> Extent:
    """Return the :class:`Extent` of extrema listed by design; ``index``: of which, in order."""
    counts = np.bincount(index, minlength=size)
    rank = np.arange(index.size) - np.repeat(np.cumsum(counts) - counts, counts)
    shape = size, int(counts.max(initial=0))
    padded = [np.full(shape, np.nan) for _ in range(2)]
    for whole, part in zip(padded, (places, values)):
        whole[index, rank] = part
    return Extent(np.empty((size, 0)), counts, *padded)
