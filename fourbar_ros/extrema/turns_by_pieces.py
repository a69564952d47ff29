# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of loads of many mechanisms at once that are smooth between the ends of pieces alone.

As :mod:`.full_turns` for springs and forces over a position. The turns of each mechanism are cut
at its ends of pieces and then into so many intervals for all: in each a polynomial goes through
the points of Gauss's rule. Its slope gives brackets, its last coefficients tell whether it
resolves the load, the rule gives means. At the ends slopes and values of both sides are exact:
where slopes change their sign the end is an extremum, where values differ both are.
"""
from __future__ import annotations

from fourbar_ros.extrema import full_turns
from fourbar_ros.numerics.arrays import Array, EPS, rank_of
from fourbar_ros.numerics.roots import changes_and_doubts, first_guesses
import numpy as np
from numpy.polynomial import legendre

POINTS, FINE = 12, 17       # of an interval: at which a load is computed, its slope looked at
# The last coefficients of a polynomial that resolves a load are less than this part of its span.
RESOLVED = 2.0**-16
# Where values beside an end are taken, as a part of a cycle. Jumps and slopes that are larger than
# rounding by less than this factor are in doubt, and ends at which polynomials differ from the
# load by more than this part of its span: they are elsewhere.
BESIDE, DOUBT, APART = 2.0**-46, 2.0**10, 2.0**-8
# Last coefficients of a load whose mean is right, as a part of the root mean square.
SETTLED = 1e-8
FLAT = 2.0**8 * EPS         # of the size of a load: smaller slopes all over an interval are noise
NEWTON_STEPS = 2

_ROOTS, _WEIGHTS = legendre.leggauss(POINTS)        # on [-1, 1]
_DEGREES = np.arange(POINTS)
# from values at the points to Legendre coefficients, from these to slopes and bends at FINE points
_TO_MODES = (legendre.legvander(_ROOTS, POINTS - 1) * _WEIGHTS[:, None]) * (_DEGREES + 0.5)
_T = np.linspace(-1.0, 1.0, FINE)
_TO_SLOPES, _TO_BENDS = (
    _TO_MODES @ legendre.legval(_T, legendre.legder(np.eye(POINTS), order))
    for order in (1, 2))


def search_pieces(evaluate: full_turns.ColumnFunction, ends: Array, count: int, cycle: float
                  ) -> full_turns.Turns:
    """
    Return the extrema of q loads of n mechanisms whose cranks turn fully.

    ``ends``: of pieces, as :func:`.ends_of_turns`; ``count``: of samples, besides those that the
    ends ask for; ``cycle``: after which all repeats [rad].
    """
    mechanisms, every = len(ends), np.arange(len(ends))
    low, half, is_end = _intervals(ends, ends.shape[1] + count // POINTS, cycle)
    x = (low + half)[..., None] + half[..., None] * _ROOTS
    samples = evaluate(x.reshape(mechanisms, -1), every)
    shape = samples.shape[:2]
    samples = samples.reshape(*shape, -1, POINTS)
    size = np.abs(samples).max(axis=(2, 3))
    is_doubtful = ~np.isfinite(size)
    samples[is_doubtful] = size[is_doubtful] = 0.0
    # a magnitude changes suddenly near a zero of the force, its square does not
    is_positive = samples.min(axis=(2, 3)) > 0.0
    f = np.where(is_positive[..., None, None], 0.5 * samples, 1.0) * samples
    span, sizes = np.ptp(f, axis=(2, 3)), np.abs(f).max(axis=(2, 3))
    is_constant = span <= full_turns.CONSTANT * sizes
    modes = f @ _TO_MODES
    is_doubtful |= (np.abs(modes[..., -2:]).max(axis=(2, 3)) > RESOLVED * span) & ~is_constant
    slopes, bends = f @ _TO_SLOPES, f @ _TO_BENDS

    # at the ends
    row, k = np.nonzero(is_end)
    before = (k - 1) % is_end.shape[1]
    x_ends = low[row, k]
    tiny = BESIDE * cycle
    sides = np.ones((mechanisms, 2, ends.shape[1]))
    column = rank_of(row)
    sides[row, 0, column], sides[row, 1, column] = x_ends - tiny, x_ends + tiny
    result = evaluate(sides.reshape(mechanisms, -1) + 1j * full_turns.STEP, every)
    result = result.reshape(*shape, 2, -1)[:, row, :, column].transpose(1, 2, 0)   # (q, 2, ends)
    value, slope = result.real, result.imag / full_turns.STEP
    noise = full_turns.CONSTANT * size[:, row] + 4.0 * tiny * np.abs(slope).sum(axis=1)
    away = np.abs(value[:, 1] - value[:, 0])
    is_jump = ~(away <= noise)
    unsure = is_jump & ~(away > DOUBT * noise)
    positive, least = is_positive[:, None, row], APART * span[:, row]
    slope = np.where(positive, value, 1.0) * slope
    inner = np.where(positive, 0.5 * value, 1.0) * value
    for side, interval, end in ((0, before, -1), (1, k, 0)):     # P_n(1) = 1, P_n(-1) = (-1)^n
        here = slope[:, side] * half[row, interval]
        of_piece = modes[:, row, interval] @ _T[end]**_DEGREES
        unsure |= ~(np.abs(of_piece - inner[:, side]) <= least)
        unsure |= ~(np.abs(slopes[:, row, interval, end] - here) <= least)
        slopes[:, row, interval, end] = here
    steepest = np.abs(slopes).max(axis=3)
    is_kink = ((slope[:, 0] >= 0.0) != (slope[:, 1] >= 0.0)) & ~is_jump
    unsure |= is_kink & ~(np.abs(slope).min(axis=1) * half[row, k]
                          > DOUBT * EPS * sizes[:, row])
    is_doubtful |= (steepest <= FLAT * sizes[..., None]).any(axis=2) & ~is_constant
    for quantity, end in zip(*np.nonzero(unsure)):
        is_doubtful[quantity, row[end]] |= not is_constant[quantity, row[end]]
    is_known = ~(is_doubtful.any(axis=0) | is_constant)
    is_kink &= is_known[:, row]
    is_jump &= is_known[:, row]

    # between them
    slopes[~is_known], bends[~is_known] = 1.0, 0.0
    step = 2.0 / (FINE - 1)
    columns = slopes.reshape(-1, FINE).T
    rise = bends.reshape(-1, FINE).T * step
    changes, doubts = changes_and_doubts(columns, rise * (1.0 / 3.0), False)
    has_hidden = doubts.any(axis=0).reshape(*shape, -1).any(axis=(0, 2))
    crosses = ((np.roll(slopes[..., -1], 1, axis=2) >= 0.0) != (slopes[..., 0] >= 0.0)) & ~is_end
    i, of_change = np.nonzero(changes)
    fa, fb = columns[i, of_change], columns[i + 1, of_change]
    with np.errstate(all='ignore'):
        guess = first_guesses(np.zeros(i.size), np.ones(i.size), fa, fb, fa / rise[i, of_change],
                              fb / rise[i + 1, of_change])
    of_cross = np.flatnonzero(crosses)          # at a bound that is no end: where it begins
    t = np.concatenate((_T[i] + step * guess, np.full(of_cross.size, -1.0)))
    of_root = np.concatenate((of_change, of_cross))
    coefficients = legendre.legder(modes.reshape(-1, POINTS)[of_root].T)
    curvature = legendre.legder(coefficients)
    for _ in range(NEWTON_STEPS):
        bend = legendre.legval(t, curvature, tensor=False)
        with np.errstate(all='ignore'):
            better = t - legendre.legval(t, coefficients, tensor=False) / bend
        t = np.where(np.abs(better - t) <= step, better, t)
    quantity, mechanism, interval = np.unravel_index(of_root, (*shape, half.shape[1]))
    half_there = half[mechanism, interval]
    first = low[mechanism, interval] + half_there * (1.0 + t)
    bend = legendre.legval(t, curvature, tensor=False) / half_there**2
    order = np.lexsort((quantity, mechanism))
    roots = full_turns.Roots(first[order], bend[order], mechanism[order], quantity[order], order)
    root, value_of_root, strays = full_turns.refined(
        evaluate, roots, is_positive, step * half_there[order])
    of_ends = ends[roots.mechanism]
    pieces = [(of_ends <= np.mod(x, cycle)[:, None]).sum(axis=1)
              % np.maximum(np.isfinite(of_ends).sum(axis=1), 1)
              for x in (low[mechanism, interval][order] + half_there[order], root)]
    strays[roots.mechanism[pieces[0] != pieces[1]]] = True      # over an end, where others hold

    # all in one list
    of_kink, of_jump = np.nonzero(is_kink), np.nonzero(is_jump)
    of_constant = np.nonzero(is_constant & ~is_doubtful)
    quantity, mechanism, x, values = (np.concatenate(parts) for parts in zip(
        (roots.quantity, roots.mechanism, root, value_of_root),
        (of_kink[0], row[of_kink[1]], x_ends[of_kink[1]], value[:, 0][of_kink]),
        *((of_jump[0], row[of_jump[1]], x_ends[of_jump[1]], value[:, side][of_jump])
          for side in (0, 1)),
        (*of_constant, np.zeros(of_constant[0].size), samples[..., 0, 0][of_constant])))
    x = np.mod(x, cycle)
    order = np.lexsort((x, quantity, mechanism))
    quantity, mechanism, x, values = (v[order] for v in (quantity, mechanism, x, values))
    listed = full_turns.Roots(x, x, mechanism, quantity, rank_of(mechanism * shape[0] + quantity))
    inputs = full_turns.by_quantity(listed, x, shape)
    weights = _WEIGHTS * (half[..., None] / cycle)
    mean, mean_square = ((g * weights).sum(axis=(2, 3)) for g in (samples, samples * samples))
    tail = np.abs(samples @ _TO_MODES[:, -2:]).max(axis=3)
    error = np.sqrt((tail * tail * half).sum(axis=2) * (2.0 / cycle))
    rms = np.sqrt(mean_square)
    return full_turns.Turns(
        inputs, full_turns.by_quantity(listed, values, shape), np.isfinite(inputs).sum(axis=-1),
        mean, mean_square, error <= SETTLED * rms, error <= full_turns.AGREE * rms,
        np.zeros(shape, bool), is_doubtful.any(axis=0) | has_hidden | strays)


def _intervals(ends: Array, count: int, cycle: float) -> tuple[Array, Array, Array]:
    """
    Return where ``count`` intervals of each cycle begin, half their widths, whether at an end.

    Each of shape (n, count). The widest are halved, cut in three and so on; a mechanism without
    an end begins at zero.
    """
    known, first = np.isfinite(ends), np.nan_to_num(ends[:, :1])
    begin = np.where(known, ends, first + cycle)
    width = np.diff(np.concatenate((begin, first + cycle), axis=1))
    begin[:, :1], has_end, known[:, 0] = first, known[:, 0].copy(), True
    width[:, 0] = np.where(has_end, width[:, 0], cycle)
    parts, every = known.astype(int), np.arange(len(ends))
    left = count - parts.sum(axis=1)
    while left.any():
        widest = np.argmax(width / np.maximum(parts, 1), axis=1)
        parts[every, widest] += left > 0
        left -= left > 0
    piece = np.repeat(np.arange(parts.size), parts.ravel())
    rank = rank_of(piece)
    half = 0.5 * (width.ravel() / np.maximum(parts.ravel(), 1))[piece]
    low = begin.ravel()[piece] + 2.0 * half * rank
    shape = len(ends), count
    return (low.reshape(shape), half.reshape(shape),
            (rank == 0).reshape(shape) & has_end[:, None])
