# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The search of :mod:`fourbar_ros.extrema.batch` for one chunk of linkages.

Rows of what is found are tuples of arrays (index, theta1, value, is_maximum, side).
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from fourbar_ros.extrema.find import CONSTANT, find_extrema, MAXIMUM
from fourbar_ros.extrema.four_bar_rates.batch_paths import Path, paths_of, stacked
from fourbar_ros.extrema.four_bar_rates.search import make_sines, POLISH, sine_constants
from fourbar_ros.extrema.methods import RATES
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.four_bar.motion import make_motion
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.exact_sums import difference_of_squares, exact_sum_of_four
from fourbar_ros.numerics.newton import newton_roots
from fourbar_ros.numerics.number_types import ARRAY, power_of_two_of_arrays
from fourbar_ros.numerics.roots import fold
import numpy as np

# Ratio of the longest link to the shortest from which values are computed again by the more
# accurate formulas.
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

    def at(x: Array, row: Array) -> tuple[Array, ...]:
        return make_sines(ARRAY, tuple(constants[:, row]))(np.sin(0.5 * x), np.cos(0.5 * x))

    def g_at(x: Array, row: Array) -> tuple[Array, Array]:
        g, gu, _, _, X, _ = at(x, row)
        return g, g * X / gu

    def k_at(x: Array, row: Array) -> tuple[Array, Array]:
        _, _, k, ku, X, _ = at(x, row)
        return k, k * X / ku

    found = _at_change_points(np.nonzero(is_flat)[0].tolist(), lengths, sign, rate)
    paths = list(paths_of(constants, closes & ~is_flat, limits))
    _add_toggles(found, paths, upward, forward)

    # All roots of k at once; then those of g between them and the samples.
    if paths:
        with np.errstate(all='ignore'):
            cells, *brackets = stacked(path.brackets_of_k(lambda x, row: k_at(x, row)[0])
                                       for path in paths)
            rows, falls, x = brackets[0], brackets[3] >= 0.0, newton_roots(k_at, *brackets)
            g, gu, _, _, X, _ = at(x, rows)
            value = g / X**3
            _improve(scaled, sign, unequal, (rows, x.copy()), value)
            found[1].append((rows, fold(x), rate[rows]**2 * value, falls == upward[rows],
                             np.zeros(x.size, int)))
            ends = np.cumsum([path.number for path in paths])
            parts = (np.split(v, ends[:-1]) for v in (cells, rows, x, g, g * X / gu))
            brackets = stacked(path.brackets_of_g(*part) for path, *part in zip(paths, *parts))
            rows, falls, x = brackets[0], brackets[3] >= 0.0, newton_roots(g_at, *brackets)
            _, _, k, _, X, Y = at(x, rows)
            value = Y / X
            _improve(scaled, sign, unequal, (rows, x), value, k / X**5)
            found[0].append((rows, fold(x), rate[rows] * value,
                             (falls == upward[rows]) == forward[rows],
                             np.zeros(x.size, int)))
    return found


def _prepared(lengths: Array, sign: Array) -> tuple[Array, Array, Array, Array]:
    """Return lengths of about one, which linkages close, constants of the sines, toggles."""
    with np.errstate(all='ignore'):
        scaled = np.ldexp(lengths, -np.frexp(lengths.max(axis=0))[1])
        closes = _closes(scaled) & (lengths > 0.0).all(axis=0)
        a1, a2, a3, a4 = scaled
        constants = np.array(np.broadcast_arrays(
            *sine_constants(a1, a2, a3, a4, sign, exact_sum_of_four)))
        return scaled, closes, constants, _limits(scaled, *constants[:2])


def _at_change_points(indices: list[int], lengths: Array, sign: Array,
                      rate: Array) -> tuple[Rows, Rows]:
    """Return the rows of both quantities of the linkages at exact change points, one by one."""
    found: tuple[Rows, Rows] = [], []
    for index in indices:
        for quantity, rows in zip(found, _at_change_point(index, lengths[:, index], sign[index],
                                                          rate[index])):
            quantity += rows
    return found


def _add_toggles(found: tuple[Rows, Rows], paths: list[Path], upward: Array,
                 forward: Array) -> None:
    """Add the infinite ends of all paths to the rows of both quantities."""
    for path in paths:
        for x, side, g, Y in path.toggles():
            for quantity, up in zip(found, ((Y > 0.0) == (upward == forward)[path.row],
                                            (g > 0.0) == upward[path.row])):
                quantity.append((path.row, fold(x), np.where(up, np.inf, -np.inf), up,
                                 np.full(x.size, side)))


def _closes(scaled: Array) -> Array:
    """
    Return whether each linkage can be assembled.

    Each link shorter than the other three together.
    """
    signs = (-1.0, 1.0, 1.0, 1.0), (1.0, -1.0, 1.0, 1.0), (1.0, 1.0, -1.0, 1.0), (1.0, 1.0, 1.0,
                                                                                  -1.0)
    slack = [exact_sum_of_four([s * a for s, a in zip(row, scaled)]) for row in signs]
    return np.all(np.array(slack) > 0.0, axis=0) & np.isfinite(scaled).all(axis=0)


def _limits(lengths: Array, s1: Array, s2: Array) -> Array:
    """
    Return theta1 of the toggles of each linkage, shape (2, n): near 0 and near pi.

    NaN where there is none.
    """
    a1, a2, a3, a4 = lengths
    inner = difference_of_squares(a1, a4, a2, -a3, exact_sum_of_four)
    outer = difference_of_squares(a2, a3, a1, -a4, exact_sum_of_four)
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
