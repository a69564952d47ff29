# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quantities without a complex step (abs, max, a table): derivatives by differences."""
from __future__ import annotations

from collections.abc import Sequence
from itertools import repeat
from math import sqrt
from numbers import Real

from fourbar_ros.extrema.sampling import not_real, Sampler, State
from fourbar_ros.mechanisms.quantities import Asked
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np

# Relative steps of a length, for conditions: at most the first; a part of the distance to the next
# change point, where everything changes; but never lost in rounding.
MOST_CHANGE, PART, LEAST_CHANGE = 2.0**-26, 2.0**-10, 2.0**-46
# Step of real differences of fourth order, in samples: their error is about as large as rounding.
DIFFERENCE = 2.0**-6


class DifferenceSampler(Sampler):
    """The same for functions without a complex step: derivatives by differences."""

    TURN = DIFFERENCE

    _x: Array                # samples of the path in rising order

    def _rows(self, state: State, x: Array) -> Array:
        try:
            return super()._rows(state, x)
        except (TypeError, ValueError):       # a function of plain numbers: one sample at a time
            motions, loads = (zip(*(np.broadcast_to(f, x.shape).ravel().tolist() for f in part))
                              if isinstance(part, tuple) else repeat(part) for part in state)
            states = [(self.linkage.MOTION(*v), self.linkage.LOADS(*w) if isinstance(w, tuple)
                       else w)
                      for v, w in zip(motions, loads)]
            rows = [self._one_by_one(q, states) for q in self.quantities]
            return np.reshape(rows, (-1, *x.shape))

    @staticmethod
    def _one_by_one(quantity: Asked, states: Sequence[State]) -> list[float]:
        """Return the values of a function at single samples; refuse one that is no real number."""
        values = [quantity.of(*state) for state in states]
        for value in values:
            if not isinstance(value, Real) and np.ndim(value) + np.iscomplexobj(value):
                raise not_real(quantity, 'complex' if np.iscomplexobj(value) else repr(value))
        try:
            return [float(value) for value in values]
        except (TypeError, ValueError):
            raise not_real(quantity, repr(values[0])) from None

    def sample(self, x: Array) -> tuple[Array, Array, State]:
        """Return values and slopes at the samples of a path, whose distances give the steps."""
        self._x, state = x[np.argsort(x)], self.state(x)
        return self._rows(state, x), np.stack([self.slope(x, np.full(x.size, row))
                                               for row in range(len(self.quantities))]), state

    def step(self, x: Array) -> Array:
        """Return the step of differences at x: a part of the distance of the samples there."""
        i = np.clip(np.searchsorted(self._x, x), 1, self._x.size - 1)
        return DIFFERENCE * (self._x[i] - self._x[i - 1])

    def value_and_slope(self, x: Array, row: Array) -> tuple[Array, Array]:
        """Return value and derivative by the five-point formula, of error step^4."""
        h = self.step(x)
        points = np.concatenate((x, x + h, x - h, x + 2.0 * h, x - 2.0 * h), axis=-1)
        value, *around = np.split(self.values(points)[np.tile(row, 5), ...,
                                                      np.arange(5 * row.size)], 5)
        return value, (8.0 * (around[0] - around[1]) - (around[2] - around[3])) / (12.0 * h.T)

    def by_lengths(self, x: Array, row: Array) -> Array:
        """Return the derivatives by the logarithms of lengths, (n, lengths), by differences."""
        # Their steps are parts of the distances to a change point and to lengths that cannot
        # close, which a range of the input narrows as the root of; NaN where even so nothing
        # closes.
        linkage, count = self.linkage, len(self.linkage.lengths)
        width = min([1.0, *((high - low) / self.unit for low, high in linkage.closing_ranges)])
        step = max(LEAST_CHANGE, min(MOST_CHANGE, PART * linkage.change_point_margin,
                                     PART * width * width))
        around = np.array(linkage.lengths)[:, None] * (
            1.0 + step * np.eye(count)[:, [*range(count)] * 2] * np.repeat((1.0, -1.0), count))
        values = self._with(around[..., None]).values(np.tile(x, (2 * count, 1)))
        up, down = np.split(values[row, ..., np.arange(row.size)], 2, axis=1)
        return np.asarray(self.same_turn(0.0 * up, up - down, row[:, None]) / (2.0 * step))

    def polish(self, x: Array, row: Array, sense: Array) -> Array:
        """Return x; at a kink of the quantity, where the extremum is, by golden section."""
        low, high = x - 4.0 * self.step(x), x + 4.0 * self.step(x)
        part, i = 0.5 * (sqrt(5.0) - 1.0), np.arange(x.size)
        for _ in range(56):     # for all brackets at once, unlike scipy's minimize_scalar
            left, right = high - part * (high - low), low + part * (high - low)
            keeps_low = sense * self.values(left)[row, i] > sense * self.values(right)[row, i]
            low, high = np.where(keeps_low, low, left), np.where(keeps_low, right, high)
        better = 0.5 * (low + high)
        gain = sense * (self.values(better)[row, i] - self.values(x)[row, i])
        return np.where(gain > 64.0 * EPS * np.abs(self.values(x)[row, i]), better, x)
