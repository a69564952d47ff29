# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of loads of many mechanisms at once that are smooth between the ends of pieces alone.

As :mod:`.full_turns` for springs and forces over a position. The turns of each mechanism are cut
at its ends of pieces and these pieces into intervals: in each a polynomial goes through the points
of Gauss's rule, and one that its last coefficients do not resolve is halved. An interval in which
the coefficients of the slope leave it no zero has no extremum; in the others the slope gives
brackets. The rule gives means. At ends where loads may jump or slopes change their sign, slopes
and values of both sides are exact: where slopes change it the end is an extremum, where values
differ both are.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.extrema import full_turns
from fourbar_ros.mechanisms.pieces import PieceEnds
from fourbar_ros.numerics.arrays import Array, as_grid, EPS, rank_of
from fourbar_ros.numerics.roots import CAUTION, changes_and_doubts, first_guesses
import numpy as np
from numpy.polynomial import legendre

# Points of an interval at which a load is computed, fewer where mechanisms have so many ends on an
# average, and at which its slope is looked at.
POINTS, FEWER, MANY_ENDS, FINE = 8, 6, 48, 13
HALVINGS = 10               # of an interval that its polynomial does not resolve
# The last coefficients of a polynomial that resolves a load are less than this part of its span.
RESOLVED = 2.0**-13
# Error of a slope at an end of an interval, over the last coefficients, at most.
SLOPE_ERROR = 64.0
# Where values beside an end are taken, as a part of a cycle. Jumps and slopes that are larger than
# rounding by less than this factor are in doubt, and ends at which polynomials differ from the
# load by more than this part of its span: they are elsewhere.
BESIDE, DOUBT, APART = 2.0**-46, 2.0**10, 2.0**-8
# Error of a mean, as a part of the root mean square.
SETTLED = 2.0**-40
FLAT = 2.0**8 * EPS         # of the size of a load: smaller slopes all over an interval are noise
NEWTON_STEPS = 2
_T = np.linspace(-1.0, 1.0, FINE)


class _Rule:
    """Gauss's rule on [-1, 1], and the polynomials through values at its points."""

    def __init__(self, points: int) -> None:
        self.points, degrees = points, np.arange(points)
        self.roots, self.weights = legendre.leggauss(points)
        self.at_begin = (-1.0)**degrees         # P_n(-1); P_n(1) = 1
        # from values to Legendre coefficients, from these to those of the slope
        self.to_modes = (legendre.legvander(self.roots, points - 1) * self.weights[:, None]
                         * (degrees + 0.5)).T
        self.to_slopes = legendre.legder(np.eye(points))

    def tails(self, samples: Array) -> tuple[Array, Array]:
        """Return the larger of the last two coefficients of intervals, the error of the mean."""
        # Coefficients fall as powers, two by two by a factor that is taken from the last two pairs
        # and from all: Gauss's rule is exact up to twice the degree.
        modes = np.abs(self.to_modes @ samples)
        pairs = np.maximum(modes[:, ::2], modes[:, 1::2])
        last, before, first = pairs[:, -1], pairs[:, -2], pairs.max(axis=1)
        with np.errstate(all='ignore'):
            factor = np.fmax(last / before, (last / first)**(2.0 / (self.points - 2)))
        return last, last * np.fmin(factor, 1.0)**(self.points // 2)


_RULES = {points: _Rule(points) for points in (POINTS, FEWER)}


class _Intervals(NamedTuple):
    """Intervals of the cycles of mechanisms, in order, arrays of shape (m,)."""

    row: Array          # of which mechanism, as an index
    low: Array          # where it begins [rad]
    half: Array         # half its width
    is_end: Array       # whether a piece begins there
    may_jump: Array     # whether loads may jump there

    def pick(self, which: Array) -> _Intervals:
        return _Intervals(*[values[which] for values in self])


def search_pieces(evaluate: full_turns.ColumnFunction, ends: PieceEnds, count: int, cycle: float
                  ) -> full_turns.Turns:
    """Return the extrema of q loads of n mechanisms whose cranks turn fully."""
    # count: of samples of a cycle at least; cycle: after which all repeats [rad].
    mechanisms = len(ends.inputs)
    rule = _RULES[FEWER if np.isfinite(ends.inputs).sum() > MANY_ENDS * mechanisms else POINTS]
    of, samples = _resolved(evaluate, rule, _intervals(ends, FEWER * cycle / count, cycle),
                            mechanisms)
    row, half, first = of.row, of.half, _firsts(of.row)
    shape, previous = (len(samples), mechanisms), np.arange(row.size) - 1
    previous[first] = np.append(first[1:], row.size) - 1
    size = np.maximum.reduceat(np.abs(samples).max(axis=1), first, axis=1)
    is_doubtful = ~np.isfinite(size)
    if is_doubtful.any():
        samples = np.where(is_doubtful[:, None, row], 0.0, samples)
        size[is_doubtful] = 0.0
    f, is_positive, span = _smooth(samples, row, first)
    sizes = np.maximum.reduceat(np.abs(f).max(axis=1), first, axis=1)
    is_constant = span <= full_turns.CONSTANT * sizes
    modes = rule.to_modes @ f
    last = np.abs(modes[:, -2:]).max(axis=1)
    is_doubtful |= (np.maximum.reduceat(last, first, axis=1) > RESOLVED * span) & ~is_constant
    slopes = rule.to_slopes @ modes         # coefficients, of the slope times half a width
    middle, around = np.abs(slopes[:, 0]), np.abs(slopes[:, 1:]).sum(axis=1)
    rises, is_plain = slopes[:, 0] >= 0.0, middle > (1.0 + CAUTION) * around
    begin, end = rule.at_begin[:-1] @ slopes, slopes.sum(axis=1)    # at both ends of intervals
    # Where none of them is the end of a piece, neighbours agree: slopes of two signs there, be it
    # by rounding, would make three extrema of one.
    within = np.flatnonzero(~of.is_end)
    left = previous[within]
    at_bound = 0.5 * (end[:, left] / half[left] + begin[:, within] / half[within])
    end[:, left], begin[:, within] = at_bound * half[left], at_bound * half[within]
    is_noise = middle + around <= FLAT * sizes[:, row]
    is_doubtful |= np.logical_or.reduceat(is_noise, first, axis=1) & ~is_constant

    # at the ends, exactly where it matters
    k = np.flatnonzero(of.is_end)
    doubt = SLOPE_ERROR * last + DOUBT * EPS * sizes[:, row]
    is_even = (np.abs(begin) > doubt)[:, k] & (np.abs(end) > doubt)[:, previous[k]]
    is_even &= (begin[:, k] >= 0.0) == (end[:, previous[k]] >= 0.0)
    is_even &= (np.abs((rule.at_begin @ modes)[:, k] - modes.sum(axis=1)[:, previous[k]])
                <= APART * span[:, row[k]])
    k = k[of.may_jump[k] | ~(is_even | is_constant[:, row[k]]).all(axis=0)]
    before, of_end, tiny = previous[k], row[k], BESIDE * cycle
    x_ends = of.low[k]
    line, column, sides = as_grid(np.add.outer(x_ends, (-tiny, tiny)).ravel(),
                                  np.repeat(of_end, 2), mechanisms)
    result = evaluate(sides + 1j * full_turns.STEP, np.arange(mechanisms))
    result = result[:, line, column].reshape(len(samples), -1, 2).transpose(0, 2, 1)
    value, slope = result.real, result.imag / full_turns.STEP       # (q, 2, ends)
    noise = full_turns.CONSTANT * size[:, of_end] + 4.0 * tiny * np.abs(slope).sum(axis=1)
    away = np.abs(value[:, 1] - value[:, 0])
    is_jump = ~(away <= noise)
    unsure = is_jump & ~(away > DOUBT * noise)
    positive, least = is_positive[:, None, of_end], APART * span[:, of_end]
    slope = np.where(positive, value, 1.0) * slope
    inner = np.where(positive, 0.5 * value, 1.0) * value
    for side, interval, signs, of_interval in ((0, before, np.ones(rule.points), end),
                                               (1, k, rule.at_begin, begin)):
        here = slope[:, side] * half[interval]
        of_piece = signs @ modes[..., interval]
        unsure |= ~(np.abs(of_piece - inner[:, side]) <= least)
        unsure |= ~(np.abs(of_interval[:, interval] - here) <= least)
        of_interval[:, interval] = here
    is_kink = ((slope[:, 0] >= 0.0) != (slope[:, 1] >= 0.0)) & ~is_jump
    unsure |= is_kink & ~(np.abs(slope).min(axis=1) * half[k] > DOUBT * EPS * sizes[:, of_end])
    for quantity, i in zip(*np.nonzero(unsure)):
        is_doubtful[quantity, of_end[i]] |= not is_constant[quantity, of_end[i]]
    is_known = ~(is_doubtful.any(axis=0) | is_constant)
    is_kink &= is_known[:, of_end]
    is_jump &= is_known[:, of_end]

    # between them
    is_plain &= ((begin >= 0.0) == rises) & ((end >= 0.0) == rises)
    quantity, interval = np.nonzero(~is_plain & is_known[:, row])
    columns = legendre.legval(_T, slopes[quantity, :, interval].T).T
    columns[0], columns[-1] = begin[quantity, interval], end[quantity, interval]
    step = 2.0 / (FINE - 1)
    rise = legendre.legval(_T, legendre.legder(slopes[quantity, :, interval].T)).T * step
    changes, doubts = changes_and_doubts(columns, rise * (1.0 / 3.0), False)
    has_hidden = np.zeros(mechanisms, bool)
    has_hidden[row[interval[doubts.any(axis=0)]]] = True
    i, column = np.nonzero(changes)
    fa, fb = columns[i, column], columns[i + 1, column]
    with np.errstate(all='ignore'):
        guess = first_guesses(np.zeros(i.size), np.ones(i.size), fa, fb, fa / rise[i, column],
                              fb / rise[i + 1, column])
    t, quantity, interval = _T[i] + step * guess, quantity[column], interval[column]
    coefficients = slopes[quantity, :, interval].T
    curvature = legendre.legder(coefficients)
    for _ in range(NEWTON_STEPS):
        bend = legendre.legval(t, curvature, tensor=False)
        with np.errstate(all='ignore'):
            better = t - legendre.legval(t, coefficients, tensor=False) / bend
        t = np.where(np.abs(better - t) <= step, better, t)
    bend = legendre.legval(t, curvature, tensor=False) / half[interval]**2
    order = np.lexsort((quantity, row[interval]))
    quantity, interval, t, bend = (v[order] for v in (quantity, interval, t, bend))
    roots = full_turns.Roots(of.low[interval] + half[interval] * (1.0 + t), bend, row[interval],
                             quantity)
    root, value_of_root, strays = full_turns.refined(
        evaluate, roots, is_positive, step * half[interval])
    of_ends = ends.inputs[roots.mechanism]
    pieces = [(of_ends <= np.mod(x, cycle)[:, None]).sum(axis=1)
              % np.maximum(np.isfinite(of_ends).sum(axis=1), 1)
              for x in (of.low[interval] + half[interval], root)]
    strays[roots.mechanism[pieces[0] != pieces[1]]] = True      # over an end, where others hold

    # all in one list
    of_kink, of_jump = np.nonzero(is_kink), np.nonzero(is_jump)
    of_constant = np.nonzero(is_constant & ~is_doubtful)
    quantity, mechanism, x, values = (np.concatenate(parts) for parts in zip(
        (roots.quantity, roots.mechanism, root, value_of_root),
        (of_kink[0], of_end[of_kink[1]], x_ends[of_kink[1]], value[:, 0][of_kink]),
        *((of_jump[0], of_end[of_jump[1]], x_ends[of_jump[1]], value[:, side][of_jump])
          for side in (0, 1)),
        (*of_constant, np.zeros(of_constant[0].size), samples[:, 0, first][of_constant])))
    inputs, values = full_turns.by_input(quantity, mechanism, x, values, cycle, shape)
    mean, mean_square = (np.add.reduceat((rule.weights @ g) * (half / cycle), first, axis=1)
                         for g in (samples, samples * samples))
    error = np.add.reduceat(rule.tails(samples)[1] * (2.0 * half / cycle), first, axis=1)
    is_settled = error <= SETTLED * np.sqrt(mean_square)
    return full_turns.Turns(
        inputs, values, np.isfinite(inputs).sum(axis=-1), mean, mean_square, is_settled,
        is_settled, np.zeros(shape, bool), is_doubtful.any(axis=0) | has_hidden | strays)


def _intervals(ends: PieceEnds, widest: float, cycle: float) -> _Intervals:
    """Return the pieces, cut in equal intervals that are no wider; without an end, from zero."""
    row, column = np.nonzero(np.isfinite(ends.inputs))
    without = np.setdiff1d(np.arange(len(ends.inputs)), row)
    begin, jumps = (np.concatenate((table[row, column], np.zeros(without.size, table.dtype)))
                    for table in ends)
    has_end = np.arange(begin.size) < row.size
    row = np.concatenate((row, without))
    order = np.argsort(row, kind='stable')
    row, begin, jumps, has_end = row[order], begin[order], jumps[order], has_end[order]
    first = _firsts(row)
    until = np.append(begin[1:], 0.0)
    until[np.append(first[1:], row.size) - 1] = begin[first] + cycle
    parts = np.maximum(np.ceil((until - begin) / widest - EPS), 1.0).astype(int)
    piece = np.repeat(np.arange(row.size), parts)
    rank, half = rank_of(piece), (0.5 * (until - begin) / parts)[piece]
    return _Intervals(row[piece], begin[piece] + 2.0 * half * rank, half,
                      (rank == 0) & has_end[piece], (rank == 0) & jumps[piece])


def _resolved(evaluate: full_turns.ColumnFunction, rule: _Rule, of: _Intervals, mechanisms: int
              ) -> tuple[_Intervals, Array]:
    """Return intervals, halved where they do not resolve loads, and samples, (q, points, m)."""
    kept, limits = list[tuple[_Intervals, Array]](), None
    for left in range(HALVINGS, -1, -1):
        rank = rank_of(of.row)
        x = np.ones((mechanisms, rank.max() + 1, rule.points))      # 1 where a mechanism has less
        x[of.row, rank] = (of.low + of.half)[:, None] + of.half[:, None] * rule.roots
        samples = evaluate(x.reshape(mechanisms, -1), np.arange(mechanisms))
        samples = np.ascontiguousarray(samples.reshape(-1, *x.shape)[:, of.row, rank].transpose(
            0, 2, 1))
        if limits is None:      # of last coefficients, and of errors over the width
            first = _firsts(of.row)
            _, is_positive, span = _smooth(samples, of.row, first)
            mean_square = np.add.reduceat((rule.weights @ np.square(samples)) * of.half, first,
                                          axis=1) / (2.0 * np.add.reduceat(of.half, first))
            limits = is_positive, RESOLVED * span, 0.5 * SETTLED * np.sqrt(mean_square)
        is_positive, of_last, of_error = (limit[:, of.row] for limit in limits)
        last, error = rule.tails(samples)
        if is_positive.any():
            last, _ = rule.tails(np.where(is_positive[:, None], 0.5 * samples, 1.0) * samples)
        is_coarse: Array = np.any((last > of_last) | (error > of_error), axis=0)
        is_coarse &= left > 0
        kept.append((of.pick(~is_coarse), samples[..., ~is_coarse]))
        of = of.pick(is_coarse)
        if not of.row.size:
            break
        of = _Intervals(*[np.repeat(values, 2) for values in of])
        second, half = np.arange(of.row.size) % 2 == 1, 0.5 * of.half
        of = _Intervals(of.row, of.low + np.where(second, of.half, 0.0), half,
                        of.is_end & ~second, of.may_jump & ~second)
    of = _Intervals(*map(np.concatenate, zip(*[intervals for intervals, _ in kept])))
    order = np.lexsort((of.low, of.row))
    return of.pick(order), np.concatenate([samples for _, samples in kept], axis=2)[..., order]


def _smooth(samples: Array, row: Array, first: Array) -> tuple[Array, Array, Array]:
    """Return smooth functions with extrema at the inputs of loads, and their spans, (q, n)."""
    # And which loads are positive, (q, n): of them it is half the square, since a magnitude
    # changes suddenly near a zero of the force and its square does not.
    is_positive = np.minimum.reduceat(samples.min(axis=1), first, axis=1) > 0.0
    f = samples
    if is_positive.any():
        f = np.where(is_positive[:, None, row], 0.5 * samples, 1.0) * samples
    return f, is_positive, (np.maximum.reduceat(f.max(axis=1), first, axis=1)
                            - np.minimum.reduceat(f.min(axis=1), first, axis=1))


def _firsts(row: Array) -> Array:
    return np.flatnonzero(np.diff(row, prepend=-1))
