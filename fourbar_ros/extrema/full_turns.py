# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of several quantities of many mechanisms at once, over full turns of their cranks.

Quantities are sampled at equal steps, brackets come from their slopes there (with the search for
hidden pairs of :mod:`fourbar_ros.numerics.roots`), and all extrema of all quantities of all
mechanisms are refined together, with exact derivatives by a complex step. What this cannot do
safely is reported as doubtful, to be searched by :func:`.find_extrema` one by one: a mechanism
that does not turn fully, samples that do not resolve it (near a change point), a pair of extrema
between two samples, a root that does not converge.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi
from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.roots import EPS, first_guesses, intervals_with_roots, rises
import numpy as np

# Complex step; steps of a root; largest product of the last two of them, over the spacing squared.
STEP, STEPS, CLOSE = 2.0**-200, 5, 2.0**-34
# Between every other sample and what the others say there, over the span: what is resolved.
RESOLVED = 2.0**-9
# Spans below this part of a quantity's size are rounding.
CONSTANT = 2.0**12 * EPS

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
    samples = rows(np.broadcast_to(inputs(count), (mechanisms, count)))
    turns = np.zeros(samples.shape[:2])
    for i in np.nonzero(is_angle)[0]:
        samples[i] = np.unwrap(samples[i], axis=-1)
        turns[i] = np.round((samples[i, :, -1] - samples[i, :, 0]) / (2.0 * pi))
    is_doubtful = ~np.isfinite(samples).all(axis=(0, 2))
    samples[:, is_doubtful] = 0.0
    # What is left of an angle without its turns is periodic. A magnitude |F| changes suddenly
    # near a zero of the force, its square does not.
    is_positive = (samples > 0.0).all(axis=-1) & ~is_angle[:, None]
    periodic = np.where(is_positive[..., None], 0.5 * samples * samples,
                        samples - turns[..., None] * inputs(count))
    span = np.ptp(periodic, axis=-1)
    size = np.abs(periodic).max(axis=-1)
    is_constant = (span <= CONSTANT * size) & (turns == 0.0)
    is_doubtful |= (_is_coarse(periodic, span) & ~is_constant).any(axis=0)
    flat = np.moveaxis(periodic, -1, 0).reshape(count, -1)
    slopes = 3.0 * rises(flat, True) + turns.ravel() * (2.0 * pi / count)
    slopes[:, (is_doubtful | is_constant).ravel()] = 1.0
    bends = rises(slopes, True)
    i, column, is_plain = intervals_with_roots(slopes, bends, True)
    quantity, row = np.divmod(column, mechanisms)
    is_doubtful[row[~is_plain]] = True
    guesses = (_guesses(slopes, bends, i, column) + 0.5) * (2.0 * pi / count)
    j = (i + 1) % count
    rise = (slopes[j, column] - slopes[i, column]) * (count / (2.0 * pi))**2
    roots = _packed(row, quantity, guesses, rise, mechanisms)
    found = _refined(rows, roots, 2.0 * pi / count, is_positive)
    is_doubtful |= found[2]
    places, values = _by_quantity(roots, found[:2], samples.shape[:2])
    # as find_extrema lists a constant: once, where the range begins
    if is_constant.any():
        if not places.shape[-1]:
            places, values = (np.full((*samples.shape[:2], 1), np.nan) for _ in range(2))
        places[is_constant, 0], values[is_constant, 0] = 0.0, samples[is_constant, 0]
    near = np.clip(np.nan_to_num(places * (count / (2.0 * pi))).astype(int), 0, count - 1)
    reference = np.take_along_axis(samples, near, axis=-1)
    values = np.where(is_angle[:, None, None],
                      values + 2.0 * pi * np.round((reference - values) / (2.0 * pi)), values)
    counts = np.isfinite(places).sum(axis=-1)
    return Turns(places, values, counts, samples, is_doubtful)


def _by_quantity(roots: _Roots, found: Sequence[Array], shape: tuple[int, ...]) -> list[Array]:
    """Return arrays of shape (n, r) as (q, n, roots of a quantity), NaN where there are fewer."""
    most = int(roots.rank.max(initial=-1, where=roots.is_there)) + 1
    mechanism = np.broadcast_to(np.arange(shape[1])[:, None], roots.x.shape)[roots.is_there]
    out = []
    for part in found:
        whole = np.full((*shape, most), np.nan)
        there = roots.is_there
        whole[roots.quantity[there], mechanism, roots.rank[there]] = part[there]
        out.append(whole)
    return out


def _is_coarse(samples: Array, span: Array) -> Array:
    """Return whether every other sample does not follow from its eight neighbours, (q, n)."""
    weights = np.array((1225.0, -245.0, 49.0, -5.0)) / 2048.0
    even, odd = samples[..., ::2], samples[..., 1::2]
    expected = sum(weight * (np.roll(even, k, -1) + np.roll(even, -1 - k, -1))
                   for k, weight in enumerate(weights))
    error: Array = np.abs(odd - expected).max(axis=-1)
    return error > RESOLVED * span


def _guesses(slopes: Array, bends: Array, i: Array, column: Array) -> Array:
    """Return where slopes have roots, in samples from 0."""
    j = (i + 1) % len(slopes)
    fa, fb = slopes[i, column], slopes[j, column]
    with np.errstate(all='ignore'):
        return i + first_guesses(0.0 * fa, 0.0 * fa + 1.0, fa, fb,
                                 fa / (3.0 * bends[i, column]), fb / (3.0 * bends[j, column]))


class _Roots(NamedTuple):
    """
    Roots of n mechanisms, r at most each, those of all quantities beside each other.

    Parameters
    ----------
    x, bend : ndarray, shape (n, r)
        First guesses, 1 where there is none, and how the slope rises there.
    quantity, rank : ndarray of int, shape (n, r)
        Which quantity it is an extremum of, and its number among them.
    is_there : ndarray of bool, shape (n, r)

    """

    x: Array
    bend: Array
    quantity: Array
    rank: Array
    is_there: Array


def _packed(row: Array, quantity: Array, x: Array, bend: Array, mechanisms: int) -> _Roots:
    """Return roots given one by one, packed by mechanism, quantity and place."""
    order = np.lexsort((x, quantity, row))
    row, quantity, x, bend = row[order], quantity[order], x[order], bend[order]
    place = np.arange(row.size) - np.searchsorted(row, row)
    key = row * (quantity.max(initial=0) + 1) + quantity
    rank = np.arange(row.size) - np.searchsorted(key, key)
    shape = mechanisms, int(place.max(initial=-1)) + 1
    packed = _Roots(np.ones(shape), np.ones(shape), np.zeros(shape, int), np.zeros(shape, int),
                    np.zeros(shape, bool))
    for part, values in zip(packed, (x, bend, quantity, rank, np.ones(row.size, bool))):
        part[row, place] = values
    return packed


def _refined(rows: Rows, roots: _Roots, spacing: float,
             is_positive: Array) -> tuple[Array, Array, Array]:
    """
    Return places and values of roots, shape (n, r), and which mechanisms have one that strays.

    For positive quantities, roots of the slope of half the square are sought. The first step is
    that of the bend of the samples, the others are the secant's.
    """
    mechanism = np.arange(len(roots.x))[:, None]
    column = np.arange(roots.x.shape[1])
    squared = is_positive[roots.quantity, mechanism]
    x, bend = roots.x, roots.bend
    step, slope = np.full(x.shape, np.inf), np.full(x.shape, np.nan)
    for _ in range(STEPS):
        found = rows(x + 1j * STEP)[roots.quantity, mechanism, column]
        value, before, slope = found.real, slope, found.imag / STEP
        slope = np.where(squared, value * slope, slope)
        with np.errstate(all='ignore'):
            secant = (slope - before) / step
            bend = np.where(np.isfinite(secant) & (secant * bend > 0.0), secant, bend)
            last, step = step, -slope / bend
            value = np.where(squared, np.sqrt(np.maximum(value * value + slope * step, 0.0)),
                             value + 0.5 * slope * step)
            # a step of the secant errs by its product with the one before, over the spacing
            is_close = np.abs(step * last) <= CLOSE * spacing * spacing
        x = x + step
        is_far = ~(np.abs(x - roots.x) <= spacing) & roots.is_there
        strays = ((~is_close & roots.is_there) | is_far).any(axis=1)
        if not (strays & ~is_far.any(axis=1)).any():
            break
    return np.mod(x, 2.0 * pi), value, strays
