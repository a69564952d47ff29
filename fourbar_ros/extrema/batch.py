# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration of many linkages at once.

:mod:`fourbar_ros.extrema.four_bar_rates.search` on arrays.
"""
from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import CONSTANT, find_extrema, MAXIMUM
from fourbar_ros.extrema.four_bar_rates.input_paths import half_turn, phases, POINTS_PER_FEATURE
from fourbar_ros.extrema.four_bar_rates.search import (
    POLISH,
    SAMPLES,
    sine_constants,
    sines_of_arrays,
)
from fourbar_ros.extrema.methods import RATES
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.four_bar.motion import make_motion
from fourbar_ros.mechanisms.mechanism import CROSSED, OPEN
from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.given import array
from fourbar_ros.numerics.number_types import ARRAY, power_of_two_of_arrays
from fourbar_ros.numerics.roots import (
    EPS,
    find_brackets,
    first_guesses,
    fold,
    newton_roots,
    turn_after,
)
import numpy as np

# Linkages taken at a time: their samples stay in the cache.
CHUNK = 4096
# Of the longest link to the shortest, from where on values are computed again by the more accurate
# formulas.
UNEQUAL = 10.0
# Values nearer to each other than this part of them may be equal, as far as their conditions tell.
NEARLY = 1e-8


class Extrema(NamedTuple):
    """
    Extrema of one quantity of many linkages, by linkage, then theta1; arrays of shape (extrema,).

    Where a quantity is constant over a range (a parallelogram), the beginning of the range is
    listed, as a maximum if no value is larger, else as a minimum.

    Parameters
    ----------
    index : ndarray of int
        Which linkage, in arrays of more dimensions counted as by ``ndarray.ravel``.
    theta1, value : ndarray
        Input angle [rad], in [0, 2 pi), and the quantity there; +-inf at toggles.
    is_maximum, is_global : ndarray of bool
    side : ndarray of int
        0 inside the input range; at an end of it +1 (-1): approached from above (below).

    """

    index: np.ndarray
    theta1: np.ndarray
    value: np.ndarray
    is_maximum: np.ndarray
    is_global: np.ndarray
    side: np.ndarray


def _exact_sum(terms):
    """
    Return the sum of four arrays as math.fsum would.

    Two exact pairs, their exact sum, the errors.
    """
    a, b, c, d = terms
    (one, e1), (other, e2) = _two_sum(a, b), _two_sum(c, d)
    total, e3 = _two_sum(one, other)
    return total + (e3 + (e1 + e2))


def _two_sum(a, b):
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


# Lengths are arrays too: one linkage an element.
_MANY = replace(ARRAY, name='arrays of linkages', exact_sum=_exact_sum,
                power_of_two=power_of_two_of_arrays)


def find_extrema_many(a1, a2, a3, a4, mode=OPEN, rate=1.0, progress=None):
    """
    Return all extrema of omega4 and alpha4 of many linkages at constant input rate.

    Parameters
    ----------
    a1, a2, a3, a4 : array_like
        Lengths [m]; broadcast. Linkages that cannot be assembled have no extrema.
    mode, rate : array_like
        Assembly mode (1 or 2) and input rate [rad/s], not zero.
    progress : callable, optional
        Called with the part done so far, from 0 to 1, some ten times a second.

    Returns
    -------
    dict of str to Extrema
        For 'omega4' and 'alpha4'.

    """
    given = {'a1': a1, 'a2': a2, 'a3': a3, 'a4': a4, 'mode': mode, 'rate': rate}
    columns = [array(name, value) for name, value in given.items()]
    try:
        a1, a2, a3, a4, mode, rate = (v.ravel() for v in np.broadcast_arrays(*columns))
    except ValueError:
        raise InvalidParameter(', '.join(given), [column.shape for column in columns],
                               'must have shapes that broadcast') from None
    if not (np.isfinite(rate) & (rate != 0.0)).all():
        raise InvalidParameter('rate', rate, 'must be finite, not zero')
    if not np.isin(mode, (CROSSED, OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    lengths = np.array((a1, a2, a3, a4), dtype=float)
    sign = np.where(mode == OPEN, 1.0, -1.0)
    parts = ([], [])
    for start in range(0, sign.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        for quantity, rows in zip(parts, _search(lengths[:, chunk], sign[chunk], rate[chunk])):
            quantity += [(index + start, *others) for index, *others in rows]
        if progress is not None:
            progress(min(start + CHUNK, sign.size) / sign.size)
    found = {name: _collect(rows) for name, rows in zip(RATES, parts)}
    for name, part in found.items():
        _decide_ties(name, part, lengths, mode, rate)
    return found


def _decide_ties(name, part, lengths, mode, rate):
    """Mark as global, where conditions decide, the extrema that a single linkage has."""
    low, high = _of_each(np.minimum, part), _of_each(np.maximum, part)
    with np.errstate(invalid='ignore'):
        best = np.where(part.is_maximum, high, low)
        near = ~part.is_global & np.isfinite(best) & (np.abs(part.value - best)
                                                      <= NEARLY * np.abs(best))
    for j in np.unique(part.index[near]).tolist():
        alone = find_extrema(FourBar(*lengths[:, j].tolist(), mode=int(mode[j])), name,
                             float(rate[j]))
        rows = np.nonzero(part.index == j)[0]
        if rows.size == len(alone):
            part.is_global[rows] = [extremum.is_global for extremum in alone]


def _of_each(extreme, part):
    """Return the extreme value of the linkage of each row."""
    if not part.index.size:
        return part.value
    first = np.nonzero(np.concatenate(([True], part.index[1:] != part.index[:-1])))[0]
    return np.repeat(extreme.reduceat(part.value, first),
                     np.diff(np.append(first, part.index.size)))


def _search(lengths, sign, rate):
    """Return lists of arrays (index, theta1, value, is_maximum, side), one a quantity."""
    scaled, closes, constants, limits = _prepared(lengths, sign)
    unequal = scaled.max(axis=0) > UNEQUAL * scaled.min(axis=0)
    is_flat = closes & ((constants[0] == 0.0) | (constants[1] == 0.0))
    upward, forward = sign > 0.0, rate > 0.0

    def at(x, row):
        return sines_of_arrays(np.sin(0.5 * x), np.cos(0.5 * x), constants[:, row])

    def g_at(x, row):
        g, gu, _, _, X, _ = at(x, row)
        return g, g * X / gu

    def k_at(x, row):
        _, _, k, ku, X, _ = at(x, row)
        return k, k * X / ku

    found = _at_change_points(np.nonzero(is_flat)[0].tolist(), lengths, sign, rate)
    paths = list(_paths(constants, closes & ~is_flat, limits))
    _add_toggles(found, paths, upward, forward)

    # All roots of k at once; then those of g between them and the samples.
    if paths:
        with np.errstate(all='ignore'):
            cells, *brackets = _stack(path.brackets_of_k(lambda x, row: k_at(x, row)[0])
                                      for path in paths)
            rows, falls, x = brackets[0], brackets[3] >= 0.0, newton_roots(k_at, *brackets)
            g, gu, _, _, X, _ = at(x, rows)
            value = g / X**3
            _improve(scaled, sign, unequal, rows, x.copy(), value)
            found[1].append((rows, fold(x), rate[rows]**2 * value, falls == upward[rows],
                             np.zeros(x.size, int)))
            ends = np.cumsum([path.number for path in paths])
            parts = (np.split(v, ends[:-1]) for v in (cells, rows, x, g, g * X / gu))
            brackets = _stack(path.brackets_of_g(*part) for path, *part in zip(paths, *parts))
            rows, falls, x = brackets[0], brackets[3] >= 0.0, newton_roots(g_at, *brackets)
            _, _, k, _, X, Y = at(x, rows)
            value = Y / X
            _improve(scaled, sign, unequal, rows, x, value, k / X**5)
            found[0].append((rows, fold(x), rate[rows] * value,
                             (falls == upward[rows]) == forward[rows],
                             np.zeros(x.size, int)))
    return found


def _prepared(lengths, sign):
    """Return lengths of about one, which linkages close, constants of the sines, toggles."""
    with np.errstate(all='ignore'):
        scaled = np.ldexp(lengths, -np.frexp(lengths.max(axis=0))[1])
        closes = _closes(scaled) & (lengths > 0.0).all(axis=0)
        constants = np.array(np.broadcast_arrays(*sine_constants(*scaled, sign, _exact_sum)))
        return scaled, closes, constants, _limits(scaled, *constants[:2])


def _at_change_points(indices, lengths, sign, rate):
    """Return the rows of both quantities of the linkages at exact change points, one by one."""
    found = ([], [])
    for index in indices:
        for quantity, rows in zip(found, _at_change_point(index, lengths[:, index], sign[index],
                                                          rate[index])):
            quantity += rows
    return found


def _add_toggles(found, paths, upward, forward):
    """Add the infinite ends of all paths to the rows of both quantities."""
    for path in paths:
        for x, side, g, Y in path.toggles():
            for quantity, up in zip(found, ((Y > 0.0) == (upward == forward)[path.row],
                                            (g > 0.0) == upward[path.row])):
                quantity.append((path.row, fold(x), np.where(up, np.inf, -np.inf), up,
                                 np.full(x.size, side)))


def _closes(scaled):
    """
    Return whether each linkage can be assembled.

    Each link shorter than the other three together.
    """
    signs = (-1.0, 1.0, 1.0, 1.0), (1.0, -1.0, 1.0, 1.0), (1.0, 1.0, -1.0, 1.0), (1.0, 1.0, 1.0,
                                                                                  -1.0)
    slack = [_exact_sum([s * a for s, a in zip(row, scaled)]) for row in signs]
    return np.all(np.array(slack) > 0.0, axis=0) & np.isfinite(scaled).all(axis=0)


def _limits(lengths, s1, s2):
    """
    Return theta1 of the toggles of each linkage, shape (2, n): near 0 and near pi.

    NaN where there is none.
    """
    a1, a2, a3, a4 = lengths
    return np.array((2.0 * np.arctan2(np.sqrt(-s2),
                                      np.sqrt(difference_of_squares(a1, a4, a2, -a3, _exact_sum))),
                     2.0 * np.arctan2(np.sqrt(difference_of_squares(a2, a3, a1, -a4, _exact_sum)),
                                      np.sqrt(-s1))))


def _improve(lengths, sign, unequal, rows, x, value, third=None):
    """
    Where links are unequal, put more accurate values of an extremum in place of others.

    Of the second derivative of theta4, or, with the ``third`` one, of the first, whose place is
    corrected too: as it is done for one linkage.
    """
    i = np.nonzero(unequal[rows])[0]
    if not i.size:
        return
    motion = make_motion(_MANY, *lengths[:, rows[i]], sign[rows[i]])
    fields = motion(x[i], 1.0, 0.0)
    if third is not None:
        correction = fields[11] / third[i]
        x[i] -= np.where(np.abs(correction) < POLISH, correction, 0.0)
        fields = motion(x[i], 1.0, 0.0)
    value[i] = fields[11 if third is None else 10]


def _stack(tuples):
    return [np.concatenate(arrays) for arrays in zip(*tuples)]


def _paths(constants, chosen, limits):
    """Yield the :class:`_Path` of each group with one kind of input range and sample count."""
    out, inside = constants[0] > 0.0, constants[1] > 0.0
    for crosses_out, crosses_in in ((False, False), (False, True), (True, False), (True, True)):
        rows = np.nonzero(chosen & (out == crosses_out) & (inside == crosses_in))[0]
        if not rows.size:
            continue
        period, _, _ = half_turn(*constants[:3, rows], crosses_out, crosses_in)
        count = (np.maximum(SAMPLES // 2,
                            2.0**(0.5 * np.ceil(2.0 * np.log2(POINTS_PER_FEATURE
                                                              * period)))).astype(int))
        for number in np.unique(count).tolist():
            group = rows[count == number]
            c = constants[:, group]
            period, unit, half = half_turn(*c[:3], crosses_out, crosses_in)
            sines_of, cosines_of, step = phases(number, not crosses_in, not crosses_out)
            up, down = half(sines_of[:, None], cosines_of[:, None])
            scale = 1.0 / np.sqrt(up * up + down * down)
            sh, ch = up * scale, down * scale
            step = c[-1] * step * period * unit * 0.5 / c[-2]
            one, other = (-sh[::-1], ch[::-1]), (sh, ch)
            if not crosses_in and not crosses_out:
                yield _Path(group, c, *one, step, False, limits)
                yield _Path(group, c, *other, step, False, limits)
            else:
                both = (one, other) if crosses_in else (other, one)
                yield _Path(group, c, *(np.concatenate(pair) for pair in zip(*both)), step,
                            crosses_in and crosses_out,
                            limits)


class _Path:
    """
    Samples of linkages ``row`` along one path each.

    Sh, ch = sin, cos(theta1/2): shape (samples, linkages).

    ``step``: of u between samples, with the sign of X: shape (linkages,).
    """

    def __init__(self, row, constants, sh, ch, step, is_closed, limits):
        self.row, self.sh, self.ch, self.third, self.is_closed = row, sh, ch, step / 3.0, is_closed
        self.g, self.gu, self.k, self.ku, self.X, self.Y = sines_of_arrays(sh, ch, constants)
        self.number = 0       # of roots of k
        self._limits = limits[:, row]

    def angle(self, i, column):
        return 2.0 * np.arctan2(self.sh[i, column], self.ch[i, column])

    def toggles(self):
        """Return (theta1, side, g, Y) at the ends."""
        return ([] if self.is_closed else [(self._end(i), side, self.g[i], self.Y[i])
                                           for i, side in ((0, 1), (-1, -1))])

    def _end(self, i):
        """Return theta1 at an end from the lengths, without the roundings of the sample there."""
        x, (near, far) = self.angle(i, slice(None)), self._limits
        is_near = np.isnan(far) | (np.abs(np.abs(x) - near) < np.abs(np.abs(x) - far))
        return np.copysign(np.where(is_near, near, far), x)

    def brackets_of_k(self, k_at):
        """Return (interval, row, xa, xb, fa, guess) of all roots of k."""
        i, column, *bracket = find_brackets(
            lambda x, column: k_at(x, self.row[column]),
            lambda i, column: (self.angle(i, column), self.third[column] * self.X[i, column]),
            self.k, self.third * self.ku, self.is_closed)
        self.number = i.size
        return i, self.row[column], *bracket

    def _g(self, i, column):
        """Return theta1, g and the step of Newton's method at samples."""
        g = self.g[i, column]
        return self.angle(i, column), g, g * self.X[i, column] / self.gu[i, column]

    def brackets_of_g(self, i, row, root, *g_there):
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
        x, g, step = _stack((before, (root, *g_there), after))
        order = np.lexsort((x, key))
        key, x, g, step = key[order], x[order], g[order], step[order]
        n = np.nonzero((key[1:] == key[:-1]) & ((g[1:] >= 0.0) != (g[:-1] >= 0.0)))[0]
        guess = first_guesses(x[n], x[n + 1], g[n], g[n + 1], step[n], step[n + 1])
        return self.row[key[n] // number], x[n], x[n + 1], g[n], guess


def _at_change_point(index, lengths, sign, rate):
    """Return the same for a linkage at an exact change point, one by one."""
    linkage = FourBar(*lengths.tolist(), mode=OPEN if sign > 0.0 else CROSSED)
    found = {name: [] for name in RATES}
    for extremum in find_extrema(linkage, RATES, float(rate)):
        found[extremum.quantity].append((extremum.theta1, extremum.value, extremum.kind,
                                         extremum.side))
    for rows in found.values():
        largest = max(value for _, value, _, _ in rows)
        rows = [(theta1, value, kind == MAXIMUM or kind == CONSTANT and value == largest, side)
                for theta1, value, kind, side in rows]
        yield ([(np.full(len(rows), index), *(np.array(column) for column in zip(*rows)))] if rows
               else [])


def _collect(rows):
    """Return :class:`Extrema` of lists of arrays, sorted, the global ones marked."""
    empty = np.zeros(0)
    index, theta1, value, is_maximum, side = (
        np.concatenate([row[i] for row in rows]) if rows else empty for i in range(5))
    index, is_maximum, side = index.astype(int), is_maximum.astype(bool), side.astype(int)
    order = np.lexsort((theta1, index))
    index, theta1, value, is_maximum, side = (v[order] for v in (index, theta1, value, is_maximum,
                                                                 side))
    part = Extrema(index, theta1, value, is_maximum, np.zeros(index.size, bool), side)
    low, high = _of_each(np.minimum, part), _of_each(np.maximum, part)
    with np.errstate(invalid='ignore'):
        is_global = np.where(is_maximum, value >= high - np.where(np.isinf(high), 0.0,
                                                                  64 * EPS * np.abs(high)),
                             value <= low + np.where(np.isinf(low), 0.0, 64 * EPS * np.abs(low)))
    return part._replace(is_global=is_global)
