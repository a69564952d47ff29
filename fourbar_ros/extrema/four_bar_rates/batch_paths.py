# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sample points of many linkages at once, and the brackets of the roots between them."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import pi
from typing import Any

from fourbar_ros.extrema.four_bar_rates.input_paths import (
    half_turn,
    HalfTurn,
    phases,
    POINTS_PER_FEATURE,
)
from fourbar_ros.extrema.four_bar_rates.search import make_sines, SAMPLES
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.number_types import ARRAY
from fourbar_ros.numerics.roots import find_brackets, first_guesses, turn_after
import numpy as np


class Path:
    """
    Samples of linkages ``row`` along one path each.

    Sh, ch = sin, cos(theta1/2): shape (samples, linkages).

    ``step``: of u between samples, with the sign of X: shape (linkages,).
    """

    def __init__(self, row: Array, constants: Array, halves: tuple[Array, Array], step: Array,
                 is_closed: bool, limits: Array) -> None:
        sh, ch = halves
        self.row, self.sh, self.ch, self.third, self.is_closed = row, sh, ch, step / 3.0, is_closed
        self.g, self.gu, self.k, self.ku, self.X, self.Y = make_sines(
            ARRAY, tuple(constants))(sh, ch)
        self.number = 0       # of roots of k
        self._limits = limits[:, row]

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
        self.number = i.size
        return i, self.row[column], *bracket

    def _g(self, i: Array, column: Array) -> tuple[Array, Array, Array]:
        """Return theta1, g and the step of Newton's method at samples."""
        g = self.g[i, column]
        return self.angle(i, column), g, g * self.X[i, column] / self.gu[i, column]

    def brackets_of_g(self, i: Array, row: Array, root: Array,
                      *g_there: Array) -> tuple[Array, ...]:
        """Return (row, xa, xb, fa, guess) of sign changes of g between samples, roots of k."""
        column, number = np.searchsorted(self.row, row), len(self.g)
        positive = self.g >= 0.0
        if self.is_closed:
            positive = np.concatenate((positive, positive[:1]))
        changes = positive[1:] != positive[:-1]
        # Chains sample, roots of k, sample of the intervals with such roots; the others whole.
        divided = np.zeros(changes.shape, bool)
        divided[i, column] = True
        j, one = np.nonzero(changes | divided)
        before, after = self._g(j, one), self._g((j + 1) % number, one)
        after = turn_after(after[0], before[0]), *after[1:]
        start = self.angle(i, column)
        # in its turn
        root = np.maximum(root + 2.0 * pi * np.round((start - root) / (2.0 * pi)), start)
        key = np.concatenate((one * number + j, column * number + i, one * number + j))
        x, g, step = stacked((before, (root, *g_there), after))
        order = np.lexsort((x, key))
        key, x, g, step = key[order], x[order], g[order], step[order]
        n = np.nonzero((key[1:] == key[:-1]) & ((g[1:] >= 0.0) != (g[:-1] >= 0.0)))[0]
        guess = first_guesses(x[n], x[n + 1], g[n], g[n + 1], step[n], step[n + 1])
        return self.row[key[n] // number], x[n], x[n + 1], g[n], guess


def _half_turn(constants: Array, crosses_out: bool,
               crosses_in: bool) -> tuple[Values, Values, HalfTurn]:
    s1, s2, k, *_ = constants
    return half_turn(s1, s2, k, crosses_out, crosses_in)


def paths_of(constants: Array, chosen: Array, limits: Array) -> Iterator[Path]:
    """Yield the :class:`Path` of each group with one kind of input range and sample count."""
    out, inside = constants[0] > 0.0, constants[1] > 0.0
    for crosses_out, crosses_in in ((False, False), (False, True), (True, False), (True, True)):
        rows = np.nonzero(chosen & (out == crosses_out) & (inside == crosses_in))[0]
        if not rows.size:
            continue
        period, _, _ = _half_turn(constants[:, rows], crosses_out, crosses_in)
        count = (np.maximum(SAMPLES // 2,
                            2.0**(0.5 * np.ceil(2.0 * np.log2(POINTS_PER_FEATURE
                                                              * period)))).astype(int))
        for number in np.unique(count).tolist():
            group = rows[count == number]
            c = constants[:, group]
            period, unit, half = _half_turn(c, crosses_out, crosses_in)
            sines_of, cosines_of, step = phases(number, not crosses_in, not crosses_out)
            up, down = half(sines_of[:, None], cosines_of[:, None])
            scale = 1.0 / np.sqrt(up * up + down * down)
            sh, ch = up * scale, down * scale
            step = c[-1] * step * period * unit * 0.5 / c[-2]
            one, other = (-sh[::-1], ch[::-1]), (sh, ch)
            if not crosses_in and not crosses_out:
                yield Path(group, c, one, step, False, limits)
                yield Path(group, c, other, step, False, limits)
            else:
                both = (one, other) if crosses_in else (other, one)
                sh, ch = (np.concatenate(pair) for pair in zip(*both))
                yield Path(group, c, (sh, ch), step, crosses_in and crosses_out, limits)


def stacked(tuples: Iterable[Sequence[Array]]) -> list[Array]:
    """Return the arrays of several tuples, each with those of the same place after each other."""
    return [np.concatenate(arrays) for arrays in zip(*tuples)]
