# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The search of :mod:`fourbar_ros.extrema.batch` for one chunk of linkages.

Rows of what is found are tuples of arrays (index, theta1, value, is_maximum, side);
theta1 may be a turn away from [0, 2 pi).
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from fourbar_ros.extrema.find import CONSTANT, find_extrema, MAXIMUM
from fourbar_ros.extrema.four_bar_rates.batch_paths import Path, paths_of, stacked
from fourbar_ros.extrema.four_bar_rates.search import (
    make_sines,
    POLISH,
    sine_constants,
    Sines,
)
from fourbar_ros.extrema.methods import RATES
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.four_bar.motion import make_motion
from fourbar_ros.mechanisms.half_angle import bilinear_factors, Factors
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.newton import newton_roots_and_states
from fourbar_ros.numerics.number_types import ARRAY, power_of_two_of_arrays
import numpy as np

# Above this ratio of the longest link to the shortest, samples do without the loop and values are
# computed again by the more accurate formulas.
UNEQUAL = 10.0
Rows = list[tuple[Array, ...]]


# Lengths are arrays too: one linkage an element.
_MANY = replace(ARRAY, name='arrays of linkages', exact_sum=exact_sum_of_four,
                power_of_two=power_of_two_of_arrays)


def search_chunk(lengths: Array, sign: Array, rate: Array) -> tuple[Rows, Rows]:
    """Return lists of arrays (index, theta1, value, is_maximum, side), one a quantity."""
    scaled, closes, constants, limits = _prepared(lengths, sign)
    unequal = scaled.max(axis=0) > UNEQUAL * scaled.min(axis=0)
    is_flat = closes & ((constants[0] == 0.0) | (constants[1] == 0.0))
    upward, forward = sign > 0.0, rate > 0.0
    found = _at_change_points(np.nonzero(is_flat)[0].tolist(), lengths, sign, rate)
    paths = list(paths_of(constants, closes & ~is_flat, unequal))
    if not paths:
        return found
    _add_toggles(found, paths, limits, upward, forward)
    sines = _Sines(constants)

    # All roots of k at once; then those of g between them and the samples.
    with np.errstate(all='ignore'):
        cells, *brackets = stacked(path.brackets_of_k(sines.k) for path in paths)
        rows, falls = brackets[0], brackets[3] >= 0.0
        x, step, g, gu, k, X = newton_roots_and_states(sines.k_and_step, *brackets)
        square = X * X
        # g/X^3 at the root; its slope is k/X^5
        value = (g - 0.5 * step * k / square) / (X * square)
        _improve(scaled, sign, unequal, (rows, x.copy()), value)
        found[1].append((rows, x, rate[rows]**2 * value, falls == upward[rows],
                         np.zeros(x.size, int)))
        ends = np.cumsum([path.number for path in paths])
        g -= gu / X * step
        parts = (np.split(v, ends[:-1]) for v in (cells, x, g, g * X / gu))
        brackets = stacked(path.brackets_of_g(*part) for path, *part in zip(paths, *parts))
        rows, falls = brackets[0], brackets[3] >= 0.0
        x, step, g, k, X, Y = newton_roots_and_states(sines.g_and_step, *brackets)
        square = X * X
        value = (Y - 0.5 * step * g / square) / X
        _improve(scaled, sign, unequal, (rows, x), value, k / (X * square * square))
        found[0].append((rows, x, rate[rows] * value, (falls == upward[rows]) == forward[rows],
                         np.zeros(x.size, int)))
    return found


class _Sines:
    """The functions of :func:`.make_sines` for some of many linkages, theta1 by theta1."""

    def __init__(self, constants: Array) -> None:
        self._constants = constants
        self._row: Array | None = None
        self._at: Sines

    def _of(self, x: Array, row: Array) -> tuple[Array, ...]:
        if row is not self._row:
            self._row, self._at = row, make_sines(
                ARRAY, tuple(self._constants.take(row, axis=1)))
        x = 0.5 * x
        s, c = np.sin(x), np.cos(x)
        return self._at(s * s, c * c, s * c)

    def k(self, x: Array, row: Array) -> Array:
        return self._of(x, row)[2]

    def k_and_step(self, x: Array, row: Array) -> tuple[Array, ...]:
        """Return k, the step of Newton's method, g, g_u, k, X."""
        g, gu, k, ku, X, _ = self._of(x, row)
        return k, k * X / ku, g, gu, k, X

    def g_and_step(self, x: Array, row: Array) -> tuple[Array, ...]:
        """Return g, the step of Newton's method, g, k, X, Y."""
        g, gu, k, _, X, Y = self._of(x, row)
        return g, g * X / gu, g, k, X, Y


def _prepared(lengths: Array, sign: Array) -> tuple[Array, Array, Array, Array]:
    """Return lengths of about one, which linkages close, constants of the sines, toggles."""
    with np.errstate(all='ignore'):
        scaled = np.ldexp(lengths, -np.frexp(lengths.max(axis=0))[1])
        a1, a2, a3, a4 = scaled
        factors = bilinear_factors(a1, a2, a3, a4, exact_sum_of_four)
        constants = np.array(sine_constants(scaled, factors, sign))
        # each link shorter than the other three together
        closes = ((factors.A2 > 0.0) & (factors.B1 > 0.0) & (factors.C2 > 0.0)
                  & (factors.D2 < 0.0) & np.isfinite(scaled).all(axis=0)
                  & (lengths > 0.0).all(axis=0))
        return scaled, closes, constants, _limits(factors, *constants[:2])


def _at_change_points(indices: list[int], lengths: Array, sign: Array,
                      rate: Array) -> tuple[Rows, Rows]:
    """Return the rows of both quantities of the linkages at exact change points, one by one."""
    found: tuple[Rows, Rows] = [], []
    for index in indices:
        for quantity, rows in zip(found, _at_change_point(index, lengths[:, index], sign[index],
                                                          rate[index])):
            quantity += rows
    return found


def _add_toggles(found: tuple[Rows, Rows], paths: list[Path], limits: Array, upward: Array,
                 forward: Array) -> None:
    """Add the infinite ends of all paths to the rows of both quantities."""
    ends = [path.ends() for path in paths if not path.is_closed]
    if not ends:
        return
    rows, side, x, g, Y = stacked(ends)
    # theta1 from the lengths, without the roundings of the sample there
    near, far = limits.take(rows, axis=1)
    is_near = np.isnan(far) | (np.abs(np.abs(x) - near) < np.abs(np.abs(x) - far))
    x = np.copysign(np.where(is_near, near, far), x)
    for quantity, up in zip(found, ((Y > 0.0) == (upward == forward)[rows],
                                    (g > 0.0) == upward[rows])):
        quantity.append((rows, x, np.where(up, np.inf, -np.inf), up, side))


def _limits(f: Factors, s1: Array, s2: Array) -> Array:
    """
    Return theta1 of the toggles of each linkage, shape (2, n): near 0 and near pi.

    NaN where there is none.
    """
    inner, outer = f.A2 * f.B1, -f.C2 * f.D2     # s2b, s1b of input_paths, without their sums
    return np.array((2.0 * np.arctan2(np.sqrt(-s2), np.sqrt(inner)),
                     2.0 * np.arctan2(np.sqrt(outer), np.sqrt(-s1))))


def _improve(scaled: Array, sign: Array, unequal: Array, where: tuple[Array, Array], value: Array,
             third: Array | None = None) -> None:
    """
    Where links are unequal, put more accurate values of an extremum in place of others.

    They are extrema of the second derivative of theta4 or, with the ``third`` one, of the first,
    whose place is corrected too: as for one linkage.
    """
    rows, x = where
    i = np.nonzero(unequal[rows])[0]
    if not i.size:
        return
    a1, a2, a3, a4 = scaled[:, rows[i]]
    motion = make_motion(_MANY, a1, a2, a3, a4, sign[rows[i]])
    fields = motion(x[i], 1.0, 0.0)
    if third is not None:
        correction = fields[11] / third[i]
        x[i] -= np.where(np.abs(correction) < POLISH, correction, 0.0)
        fields = motion(x[i], 1.0, 0.0)
    value[i] = fields[11 if third is None else 10]


def _at_change_point(index: int, lengths: Array, sign: float,
                     rate: float) -> Iterator[Rows]:
    """Return the same for a linkage at an exact change point, one by one."""
    a1, a2, a3, a4 = lengths.tolist()
    linkage = FourBar(a1, a2, a3, a4, OPEN if sign > 0.0 else CROSSED)
    found: dict[str, list[tuple[float, float, str, int]]] = {name: [] for name in RATES}
    for extremum in find_extrema(linkage, RATES, float(rate)):
        found[extremum.quantity].append((extremum.theta1, extremum.value, extremum.kind,
                                         extremum.side))
    for extrema in found.values():
        largest = max(value for _, value, _, _ in extrema)
        rows = [(theta1, value, kind == MAXIMUM or kind == CONSTANT and value == largest, side)
                for theta1, value, kind, side in extrema]
        yield ([(np.full(len(rows), index), *(np.array(column) for column in zip(*rows)))] if rows
               else [])
