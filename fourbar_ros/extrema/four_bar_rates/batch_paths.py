# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sample points of many linkages at once, and the brackets of the roots between them."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import pi
from typing import Any

from fourbar_ros.extrema.four_bar_rates.input_paths import (
    half_turn,
    phases,
    POINTS_PER_FEATURE,
)
from fourbar_ros.extrema.four_bar_rates.search import make_sines, SAMPLES
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import ARRAY
from fourbar_ros.numerics.roots import find_brackets, first_guesses, turn_after
import numpy as np

# Linkages whose samples are computed together, so that they stay in the cache.
TOGETHER = 256


class Path:
    """
    Samples of linkages ``row`` along one path each.

    ``samples``: sin and cos(theta1/2) and what :func:`.make_sines` gives there, each of shape
    (samples, linkages).

    ``step``: of u between samples, with the sign of X: shape (linkages,).
    """

    def __init__(self, row: Array, samples: Array, step: Array, is_closed: bool,
                 limits: Array) -> None:
        self.row, self.third, self.is_closed = row, step / 3.0, is_closed
        self.sh, self.ch, self.g, self.gu, self.k, self.ku, self.X, self.Y = samples
        self._column = row[:0]      # of each root of k
        self._limits = limits[:, row]

    @property
    def number(self) -> int:
        """Return the number of roots of k."""
        return self._column.size

    def angle(self, i: Any, column: Any) -> Array:
        angles: Array = 2.0 * np.arctan2(self.sh[i, column], self.ch[i, column])
        return angles

    def toggles(self) -> list[tuple[Array, int, Array, Array]]:
        """Return (theta1, side, g, Y) at the ends."""
        return ([] if self.is_closed else [(self._end(i), side, self.g[i], self.Y[i])
                                           for i, side in ((0, 1), (-1, -1))])

    def _end(self, i: int) -> Array:
        """Return theta1 at an end from the lengths, without the roundings of the sample there."""
        x, (near, far) = self.angle(i, slice(None)), self._limits
        is_near = np.isnan(far) | (np.abs(np.abs(x) - near) < np.abs(np.abs(x) - far))
        return np.copysign(np.where(is_near, near, far), x)

    def brackets_of_k(self, k_at: Callable[[Array, Array], Array]) -> tuple[Array, ...]:
        """Return (interval, row, xa, xb, fa, guess) of all roots of k."""
        i, column, *bracket = find_brackets(
            lambda x, column: k_at(x, self.row[column]),
            lambda i, column: (self.angle(i, column), self.third[column] * self.X[i, column]),
            self.k, self.third * self.ku, self.is_closed)
        self._column = column
        return i, self.row[column], *bracket

    def _g(self, i: Array, column: Array) -> tuple[Array, Array, Array]:
        """Return theta1, g and the step of Newton's method at samples."""
        g = self.g[i, column]
        return self.angle(i, column), g, g * self.X[i, column] / self.gu[i, column]

    def brackets_of_g(self, i: Array, root: Array, *g_there: Array) -> tuple[Array, ...]:
        """Return (row, xa, xb, fa, guess) of sign changes of g between samples, roots of k."""
        column, number = self._column, len(self.g)
        positive = self.g >= 0.0
        if self.is_closed:
            positive = np.concatenate((positive, positive[:1]))
        changes = positive[1:] != positive[:-1]
        # Intervals with roots of k are gone through root by root, from sample to sample.
        changes[i, column] = False
        start = self.angle(i, column)
        root = np.maximum(root + 2.0 * pi * np.round((start - root) / (2.0 * pi)), start)
        order = _grouped(column * number + i, root)
        i, column = i[order], column[order]
        roots = [v[order] for v in (root, *g_there)]
        is_positive, is_next = roots[1] >= 0.0, (i[1:] == i[:-1]) & (column[1:] == column[:-1])
        first, last = np.append(True, ~is_next), np.append(~is_next, True)
        j, one = np.nonzero(changes)
        first = np.nonzero(first & (positive[i, column] != is_positive))[0]
        between = np.nonzero(is_next & (is_positive[1:] != is_positive[:-1]))[0]
        last = np.nonzero(last & (is_positive != positive[i + 1, column]))[0]
        columns = np.concatenate((one, column[first], column[between], column[last]))
        xa, ga, step_a = stacked((
            self._g(j, one), self._g(i[first], column[first]),
            [v[between] for v in roots], [v[last] for v in roots]))
        xb, gb, step_b = stacked((
            self._g((j + 1) % number, one), [v[first] for v in roots],
            [v[between + 1] for v in roots], self._g((i[last] + 1) % number, column[last])))
        xb = turn_after(xb, xa)
        return self.row[columns], xa, xb, ga, first_guesses(xa, xb, ga, gb, step_a, step_b)


def paths_of(constants: Array, chosen: Array, limits: Array) -> Iterator[Path]:
    """Yield the :class:`Path` of each group with one kind of input range and sample count."""
    out, inside = constants[0] > 0.0, constants[1] > 0.0
    for crosses in ((False, False), (False, True), (True, False), (True, True)):
        rows = np.nonzero(chosen & (out == crosses[0]) & (inside == crosses[1]))[0]
        if not rows.size:
            continue
        s1, s2, k, *_ = constants[:, rows]
        period = half_turn(s1, s2, k, *crosses).period
        count = (np.maximum(SAMPLES // 2,
                            2.0**(0.5 * np.ceil(2.0 * np.log2(POINTS_PER_FEATURE
                                                              * period)))).astype(int))
        for number in np.unique(count).tolist():
            group = rows[count == number]
            samples, step = _samples(constants[:, group], number, crosses)
            if any(crosses):
                whole = samples.reshape(8, 2 * number, group.size)
                yield Path(group, whole, step, all(crosses), limits)
            else:
                for half in range(2):
                    yield Path(group, samples[:, half], step, False, limits)


def _samples(constants: Array, number: int, crosses: tuple[bool, bool]) -> tuple[Array, Array]:
    """
    Return samples of both halves of the range, shape (8, 2, number, linkages), and their step.

    The half of theta1 < 0 comes first, except where the range is around pi.
    """
    out, inside = crosses
    of_u, cosines, step = phases(number, not inside, not out)
    positive = [True, False] if out and not inside else [False, True]
    is_positive, count = np.array(positive)[:, None, None], constants.shape[1]
    s1, s2, k, *_ = constants
    half = half_turn(s1, s2, k, *crosses)
    samples = np.empty((8, 2, number, count))
    for start in range(0, count, TOGETHER):
        part = slice(start, start + TOGETHER)
        c, (sh, ch, *found) = constants[:, part], samples[..., part]
        up, down = half.part(part)(of_u[:, None], cosines[:, None])
        scale = 1.0 / np.sqrt(up * up + down * down)
        for side, sine, cosine in zip(positive, sh, ch):
            order = slice(None, None, 1 if side else -1)   # theta1 < 0 mirrors the other half
            np.multiply(up if side else -up, scale, out=sine[order])
            np.multiply(down, scale, out=cosine[order])
        sines = make_sines(ARRAY, tuple(c))(sh, ch, is_positive == (c[-1] > 0.0))
        for whole, values in zip(found, sines):
            whole[...] = values
    return samples, constants[-1] * step * half.period * half.unit * 0.5 / constants[-2]


def stacked(tuples: Iterable[Sequence[Array]]) -> list[Array]:
    """Return the arrays of several tuples, each with those of the same place after each other."""
    return [np.concatenate(arrays) for arrays in zip(*tuples)]


def _grouped(key: Array, x: Array) -> Array:
    """Return an order in which equal keys, which are few, come after each other, sorted by x."""
    is_one = np.bincount(key)[key] == 1
    others = np.nonzero(~is_one)[0]
    return np.concatenate((np.nonzero(is_one)[0],
                           others[np.lexsort((x[others], key[others]))]))
