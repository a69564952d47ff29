# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sample points of many linkages at once, and the brackets of the roots between them."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product
from math import pi

from fourbar_ros.extrema.four_bar_rates.input_paths import (
    half_turn,
    phases,
    POINTS_PER_FEATURE,
)
from fourbar_ros.extrema.four_bar_rates.sines import make_sines
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import ARRAY
from fourbar_ros.numerics.roots import find_brackets, first_guesses, order_in_rows, turn_after
import numpy as np

# At least so many for a full turn. Half as many have missed nothing in 280 000 linkages.
SAMPLES = 24
# Linkages whose samples are computed together, so that they stay in the cache.
TOGETHER = 1024
# Kept for each sample: products of s, c = sin, cos(theta1/2), and the results of make_sines.
NAMES = 'sc', 'cc', 'g', 'gu', 'k', 'ku', 'X', 'Y'


class Path:
    """
    Samples of linkages ``row``, along one path of each.

    ``samples``: :data:`NAMES`, each of shape (samples, linkages); Y only where the path has ends.
    ``step``: of u between samples, with the sign of X: shape (linkages,).
    """

    def __init__(self, row: Array, samples: Array, step: Array, is_closed: bool) -> None:
        """Keep a third of the step: root brackets take slopes in thirds of an interval."""
        self.row, self.third, self.is_closed = row, step / 3.0, is_closed
        self._samples = dict(zip(NAMES, samples))
        self._column = row[:0]      # column of the samples of each root of k; none is known yet

    @property
    def number(self) -> int:
        """Return the number of roots of k."""
        return self._column.size

    def _at(self, i: Array, column: Array, *names: str) -> list[Array]:
        """Return theta1 and values of :data:`NAMES`: sample i[j] of linkage column[j], each j."""
        place = i * self.row.size + column
        sc, cc, *others = (self._samples[name].take(place) for name in ('sc', 'cc', *names))
        return [2.0 * np.arctan2(sc, cc), *others]

    def ends(self) -> list[Array]:
        """Return (row, side, theta1, g, Y) at the toggles where a path that is not closed ends."""
        number, count = self._samples['g'].shape
        return [np.tile(self.row, 2), np.repeat((1, -1), count),
                *self._at(np.repeat((0, number - 1), count), np.tile(np.arange(count), 2),
                          'g', 'Y')]

    def brackets_of_k(self, k_at: Callable[[Array, Array], Array]) -> tuple[Array, ...]:
        """
        Return brackets (interval, row, xa, xb, fa, guess) of all roots of k on the path.

        interval: sample before the root; xa, xb: theta1 at both ends; fa: k at xa.
        ``k_at``: (theta1, row) -> k, to look closely where a pair of roots may hide.
        """
        def at(i: Array, column: Array) -> tuple[Array, Array]:
            """Return theta1 at a sample, and a third of its rise in a step."""
            x, X = self._at(i, column, 'X')
            return x, self.third[column] * X
        i, column, *bracket = find_brackets(lambda x, column: k_at(x, self.row[column]), at,
                                            self._samples['k'],
                                            self.third * self._samples['ku'], self.is_closed)
        self._column = column
        return i, self.row[column], *bracket

    def _g(self, i: Array, column: Array) -> tuple[Array, Array, Array]:
        """Return theta1, g and Newton's step to its root at samples i of linkages ``column``."""
        x, g, gu, X = self._at(i, column, 'g', 'gu', 'X')
        return x, g, g * X / gu

    def brackets_of_g(self, i: Array, root: Array, *g_there: Array) -> tuple[Array, ...]:
        """
        Return brackets (row, xa, xb, fa, guess) of all roots of g on the path.

        xa, xb: theta1 at both ends of a bracket; fa: g at xa; guess: theta1 near the root.
        Between two roots of g lies one of k: so samples and the roots of k (in intervals i, with g
        and its Newton step ``g_there``) split the path into parts with one root of g at most.
        """
        column, number = self._column, len(self._samples['g'])
        positive = self._samples['g'] >= 0.0
        if self.is_closed:
            positive = np.concatenate((positive, positive[:1]))
        changes = positive[1:] != positive[:-1]
        # Intervals with roots of k are gone through root by root, from sample to sample.
        changes[i, column] = False
        start, = self._at(i, column)
        root = np.maximum(root + 2.0 * pi * np.round((start - root) / (2.0 * pi)), start)
        order = order_in_rows(column * number + i, root)
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


def paths_of(constants: Array, chosen: Array, is_unequal: Array,
             samples: int) -> Iterator[Path]:
    """
    Yield a :class:`Path` for each group of linkages that are sampled alike.

    They have the same kind of input range (does theta1 reach pi, 0?) and number of samples. Very
    unequal links are in groups of their own: :func:`.make_sines` does without the loop for them.
    """
    crosses_out, crosses_in = constants[:2] > 0.0
    for out, inside, unequal in product((False, True), repeat=3):
        rows = np.nonzero(chosen & (crosses_out == out) & (crosses_in == inside)
                          & (is_unequal == unequal))[0]
        if not rows.size:
            continue
        s1, s2, k = constants[:3, rows]
        period = half_turn(s1, s2, k, out, inside).period
        count = (np.maximum(samples // 2,
                            2.0**(0.5 * np.ceil(2.0 * np.log2(POINTS_PER_FEATURE
                                                              * period)))).astype(int))
        for number in np.unique(count).tolist():
            group = rows[count == number]
            found, step = _samples(constants[:, group], number, out, inside, not unequal)
            if out or inside:
                whole = found.reshape(-1, 2 * number, group.size)
                yield Path(group, whole, step, out and inside)
            else:
                for half in range(2):
                    yield Path(group, found[:, half], step, False)


def _samples(constants: Array, number: int, out: bool, inside: bool,
             by_loop: bool) -> tuple[Array, Array]:
    """
    Return samples of both halves of the range, (8, 2, number, linkages), and their step.

    As :class:`Path` takes them; 7 values where the range has no ends. ``out``, ``inside``: whether
    theta1 reaches pi, and 0. Samples are computed for 0 < theta1 < pi and mirrored; the half of
    theta1 < 0 comes first, except where the range is around pi.
    """
    of_u, cosines, step = phases(number, not inside, not out)
    sides = (1, -1) if out and not inside else (-1, 1)
    signs, count = np.array(sides)[:, None, None], constants.shape[1]
    s1, s2, k, *_ = constants
    half = half_turn(s1, s2, k, out, inside)
    samples = np.empty((7 if out and inside else 8, 2, number, count))
    for start in range(0, count, TOGETHER):
        part = slice(start, start + TOGETHER)
        c = constants[:, part]
        up, down = half.part(part)(of_u[:, None], cosines[:, None])
        scale = 1.0 / (up * up + down * down)
        ss, cc, sc = up * up * scale, down * down * scale, signs * (up * down * scale)
        sines = make_sines(ARRAY, tuple(c), by_loop)(ss, cc, sc, signs * c[-1] > 0.0)
        for whole, values in zip(samples[..., part], (sc, cc, *sines)):
            # theta1 < 0 mirrors the other half; what has no axis for them is the same in both
            for i, side in enumerate(sides):
                whole[i, ::side] = values[i] if values.ndim == 3 else values
    return samples, constants[-1] * step * half.period * half.unit * 0.5 / constants[-2]


def stacked(tuples: Iterable[Sequence[Array]]) -> list[Array]:
    """Return the columns of several tuples, each joined: ((a, b), (c, d)) gives [ac, bd]."""
    return [np.concatenate(arrays) for arrays in zip(*tuples)]
