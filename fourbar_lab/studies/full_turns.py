# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of several quantities of many mechanisms at once, over full turns of their cranks.

Quantities are sampled at equal steps. Slopes at the samples give brackets (with the search for
hidden pairs of :mod:`fourbar_ros.numerics.roots`), polynomials through the samples give first
guesses, and all extrema of all quantities of all mechanisms are refined together with exact
derivatives by a complex step: most need one step. What this cannot do safely is reported as
doubtful, for :func:`.find_extrema` to search one by one: a mechanism that does not turn fully,
samples that do not resolve it (near a change point), a pair of extrema between two samples, a
root that does not converge. It is 30 to 40 times as fast as that search
(docs/bench/studies.md).

Sampled functions are arrays of shape (samples, m), a column for each; the first sample follows
the last.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi
from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.roots import changes_and_doubts, first_guesses
import numpy as np

# Complex step; steps of a root; largest product of the last two of them, over the spacing squared.
STEP, STEPS, CLOSE = 2.0**-200, 5, 2.0**-40
# Spans below this part of a quantity's size are rounding.
CONSTANT = 2.0**12 * EPS
# Weights of f(x + k h) - f(x - k h), k from 1, in h times the slope of f: orders twelve and four.
FINE = (6.0 / 7.0, -15.0 / 56.0, 5.0 / 63.0, -1.0 / 56.0, 1.0 / 385.0, -1.0 / 5544.0)
PLAIN = (2.0 / 3.0, -1.0 / 12.0)
# Weights of the neighbours at half a step on either side, of the next ones, ..., in the value
# between them.
BETWEEN = tuple([part / 2.0**19 for part in (320166, -76230, 22869, -5445, 847, -63)])
# Between every other sample and what the others say there, over the span: what is resolved.
RESOLVED = 2.0**-9
# Samples around an interval through which a polynomial is laid; its steps of Newton's method.
AROUND, NEWTON_STEPS = 12, 2

Rows = Callable[[Array], Array]


class Turns(NamedTuple):
    """
    Extrema of q quantities of n mechanisms, at most r each.

    Parameters
    ----------
    places, values : ndarray, shape (q, n, r)
        In the order of the input from 0 to 2 pi; NaN beyond the last.
    counts : ndarray of int, shape (q, n)
    samples : ndarray, shape (q, n, samples)
        At inputs 2 pi (k + 1/2)/samples; angles continuous.
    is_doubtful : ndarray of bool, shape (n,)
        What is given of these is to be computed in another way.

    """

    places: Array
    values: Array
    counts: Array
    samples: Array
    is_doubtful: Array


def inputs(count: int) -> Array:
    """Return the inputs of the samples [rad]."""
    return 2.0 * pi * (np.arange(count) + 0.5) / count


def search_turns(rows: Rows, mechanisms: int, count: int, is_angle: Array) -> Turns:
    """
    Return the extrema of some quantities of mechanisms whose cranks turn fully.

    Parameters
    ----------
    rows : callable
        Inputs of shape (n, any), real or complex -> quantities, shape (q, n, any).
    mechanisms : int
        n.
    count : int
        Samples of a turn.
    is_angle : ndarray of bool, shape (q,)
        Which are angles, that may jump by 2 pi.

    """
    spacing = 2.0 * pi / count
    samples = rows(np.broadcast_to(inputs(count), (mechanisms, count)))
    periodic, turns, is_positive = _periodic(samples, is_angle)
    with np.errstate(invalid='ignore'):
        low, high = periodic.min(axis=0), periodic.max(axis=0)
    size = np.maximum(-low, high)
    is_doubtful = ~np.isfinite(size)
    low[is_doubtful] = high[is_doubtful] = periodic[:, is_doubtful] = 0.0
    is_constant = (high - low <= CONSTANT * size) & (turns == 0.0)
    is_doubtful |= is_coarse(periodic, high - low) & ~is_constant
    slopes = slopes_of(periodic)
    slopes += spacing * turns
    is_doubtful, is_constant, is_positive = (
        v.reshape(-1, mechanisms) for v in (is_doubtful, is_constant, is_positive))
    is_doubtful = is_doubtful.any(axis=0)
    slopes[:, (is_constant | is_doubtful).ravel()] = 1.0
    roots, is_hidden = _bracketed(slopes, spacing, mechanisms)
    x, value, strays = _refined(rows, roots, spacing, is_positive)
    is_doubtful |= is_hidden | strays
    places, values = (_by_quantity(roots, part, is_constant.shape) for part in (x, value))
    # as find_extrema lists a constant: once, where the range begins
    if is_constant.any():
        if not places.shape[-1]:
            places, values = (np.full((*is_constant.shape, 1), np.nan) for _ in range(2))
        places[is_constant, 0], values[is_constant, 0] = 0.0, samples[is_constant, 0]
    for i in np.nonzero(is_angle)[0]:
        near = np.clip(np.nan_to_num(places[i] / spacing).astype(int), 0, count - 1)
        reference = np.take_along_axis(samples[i], near, axis=-1)
        values[i] += 2.0 * pi * np.round((reference - values[i]) / (2.0 * pi))
    counts = np.isfinite(places).sum(axis=-1)
    return Turns(places, values, counts, samples, is_doubtful)


def _periodic(samples: Array, is_angle: Array) -> tuple[Array, Array, Array]:
    """
    Return what extrema are sought of, shape (samples, q * n), turns, and which are all positive.

    Half the square of what is positive, and angles without their turns; in ``samples`` angles are
    made continuous.
    """
    quantities, mechanisms, count = samples.shape
    turns: Array = np.zeros((quantities, mechanisms))
    for i in np.nonzero(is_angle)[0]:
        samples[i] = np.unwrap(samples[i], axis=-1)
        turns[i] = np.round((samples[i, :, -1] - samples[i, :, 0]) / (2.0 * pi))
    turns = turns.ravel()
    flat = np.ascontiguousarray(samples.reshape(-1, count).T)
    # A magnitude |F| changes suddenly near a zero of the force, its square does not.
    with np.errstate(all='ignore'):
        is_positive = (flat.min(axis=0) > 0.0) & ~np.repeat(is_angle, mechanisms)
        flat *= np.where(is_positive, 0.5 * flat, 1.0)
    if turns.any():
        flat -= turns * inputs(count)[:, None]
    return flat, turns, is_positive


class _Roots(NamedTuple):
    """
    Extrema of all quantities of all mechanisms, each an element; by mechanism, quantity, place.

    Parameters
    ----------
    x, bend : ndarray
        First guesses, and how the slope rises there.
    mechanism, quantity, rank : ndarray of int
        Of which it is an extremum, and its number among those of the quantity.

    """

    x: Array
    bend: Array
    mechanism: Array
    quantity: Array
    rank: Array


def _bracketed(slopes: Array, spacing: float, mechanisms: int) -> tuple[_Roots, Array]:
    """
    Return the roots of slopes, shape (samples, q * n), and which mechanisms may have more.

    Slopes are those of a step.
    """
    bends = slopes_of(slopes, PLAIN)
    changes, doubtful = changes_and_doubts(slopes, bends * (1.0 / 3.0), True)
    i, column = np.nonzero(changes)
    quantity, mechanism = np.divmod(column, mechanisms)
    key = mechanism * (slopes.shape[1] // mechanisms) + quantity
    order = np.argsort(key.astype(np.min_scalar_type(slopes.shape[1])), kind='stable')
    i, column, quantity, mechanism, key = (v[order] for v in (i, column, quantity, mechanism, key))
    here, there = i * slopes.shape[1] + column, (i + 1) % len(slopes) * slopes.shape[1] + column
    fa, fb, bend_a, bend_b = (f.ravel().take(k) for f in (slopes, bends) for k in (here, there))
    with np.errstate(all='ignore'):
        guess = first_guesses(np.zeros(fa.shape), np.ones(fa.shape), fa, fb, fa / bend_a,
                              fb / bend_b)
        after, bend = roots_between(slopes, i, column, guess)
        is_near = (after > -0.5) & (after < 1.5) & (bend * (fb - fa) > 0.0)
    after, bend = np.where(is_near, after, guess), np.where(is_near, bend, fb - fa)
    is_hidden: Array = np.logical_or.reduce(doubtful.reshape(-1, mechanisms))
    return _Roots((i + after + 0.5) * spacing, bend / spacing**2, mechanism, quantity,
                  rank_of(key)), is_hidden


def rank_of(key: Array) -> Array:
    """Return how many equal keys stand before each; equal keys stand together."""
    counts = np.bincount(key)
    first = np.cumsum(counts) - counts
    return np.arange(key.size) - first[key]


def _by_quantity(roots: _Roots, found: Array, shape: tuple[int, ...]) -> Array:
    """Return a number of each root as (q, n, roots of a quantity), NaN where there are fewer."""
    whole = np.full((*shape, int(roots.rank.max(initial=-1)) + 1), np.nan)
    whole[roots.quantity, roots.mechanism, roots.rank] = found
    return whole


def _refined(rows: Rows, roots: _Roots, spacing: float,
             is_positive: Array) -> tuple[Array, Array, Array]:
    """
    Return places and values of roots, and which mechanisms have one that strays.

    For positive quantities, roots of the slope of half the square are sought. The first step is
    that of the bend of the samples, the others are the secant's. A step errs by its product with
    the one before, over the spacing; the first one by its square, as the bend does by the step.
    """
    x, strays = roots.x.copy(), np.zeros(is_positive.shape[1], bool)
    values, left = np.empty(x.shape), np.arange(x.size)
    start, bend = roots.x, roots.bend
    last = before = np.full(x.shape, np.nan)
    for _ in range(STEPS):
        i, quantity = roots.mechanism[left], roots.quantity[left]
        k = rank_of(i)
        grid = np.ones((strays.size, int(k.max(initial=0)) + 1))
        grid[i, k] = x[left]
        found = rows(grid + 1j * STEP)[quantity, i, k]
        squared, value, slope = is_positive[quantity, i], found.real, found.imag / STEP
        with np.errstate(all='ignore'):
            slope = np.where(squared, value * slope, slope)
            secant = (slope - before) / last
            bend = np.where(np.isfinite(secant) & (secant * bend > 0.0), secant, bend)
            step = -slope / bend
            rise = slope * step
            values[left] = np.where(squared, np.sqrt(np.maximum(value * value + rise, 0.0)),
                                    value + 0.5 * rise)
            x[left] += step
            is_far = ~(np.abs(x[left] - start[left]) <= spacing)
            last = np.where(np.isnan(last), step, last)
            going = ~(np.abs(step * last) <= CLOSE * spacing * spacing)
        strays[i[is_far]] = True
        going &= ~strays[i]
        left, bend, last, before = (v[going] for v in (left, bend, step, slope))
        if not left.size:
            break
    strays[roots.mechanism[left]] = True
    return np.mod(x, 2.0 * pi), values, strays


def _wrapped(f: Array, width: int) -> Array:
    return np.concatenate((f[-width:], f, f[:width]))


def slopes_of(f: Array, weights: Sequence[float] = FINE) -> Array:
    """Return the slopes at the samples, times the step."""
    width, count = len(weights), len(f)
    wrapped, found, part = _wrapped(f, width), np.zeros(f.shape), np.empty(f.shape)
    for k, weight in enumerate(weights, 1):
        np.subtract(wrapped[width + k:width + k + count], wrapped[width - k:width - k + count],
                    out=part)
        part *= weight
        found += part
    return found


def is_coarse(f: Array, span: Array) -> Array:
    """Return whether every other sample does not follow from the others beside it, (m,)."""
    width, count = len(BETWEEN), len(f) // 2
    even, error, part = _wrapped(f[::2], width), f[1::2].copy(), np.empty((count, *f.shape[1:]))
    for k, weight in enumerate(BETWEEN):
        np.add(even[width - k:width - k + count], even[width + 1 + k:width + 1 + k + count],
               out=part)
        part *= weight
        error -= part
    far: Array = np.maximum(error.max(axis=0), -error.min(axis=0)) > RESOLVED * span
    return far


def roots_between(f: Array, i: Array, column: Array, guess: Array) -> tuple[Array, Array]:
    """
    Return where functions have roots, in steps after sample ``i``, and their slopes there.

    By Newton's method on the polynomials through the nearest samples.

    Parameters
    ----------
    f : ndarray, shape (samples, m)
    i, column : ndarray of int, shape (roots,)
        The sample before the root, and of which function.
    guess : ndarray, shape (roots,)
        From 0 to 1.

    """
    middle = AROUND // 2 - 1
    near = (np.arange(AROUND)[:, None] - middle + i) % len(f)
    table = f.ravel().take(near * f.shape[1] + column)
    falling = [table[0]]        # Newton's differences, over factorials
    for k in range(1, AROUND):
        table = table[1:] - table[:-1]
        table *= 1.0 / k
        falling.append(table[0])
    t = guess + middle
    slope = np.zeros(t.shape)
    for _ in range(NEWTON_STEPS):
        value, slope = falling[-1], np.zeros(t.shape)
        for k in range(AROUND - 2, -1, -1):
            at = t - k
            slope = slope * at + value
            value = value * at + falling[k]
        with np.errstate(all='ignore'):
            t = t - value / slope
    return t - middle, slope
