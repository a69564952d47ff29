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
root that does not converge. It is 30 to 40 times as fast as that search.

Sampled functions are arrays of shape (samples, m), a column for each; the first sample follows
the last.
"""
from collections.abc import Callable, Sequence
from math import pi
from typing import NamedTuple

from fourbar_ros.extrema.sampling import whole_turns
from fourbar_ros.numerics.arrays import Array, as_grid, EPS, rank_of, Values
from fourbar_ros.numerics.roots import changes_and_doubts, first_guesses
import numpy as np

STEP = 2.0**-200        # of derivatives by a complex step: its square is nothing
# Steps towards a root at most; product of the last two, over the spacing squared, that ends them.
STEPS, CLOSE = 5, 2.0**-48
# A span below this part of a quantity's size is rounding: the quantity is constant.
CONSTANT = 2.0**12 * EPS
# Weights of f(x + k h) - f(x - k h), k from 1, in h times the slope of f: orders twelve and four.
FINE = (6.0 / 7.0, -15.0 / 56.0, 5.0 / 63.0, -1.0 / 56.0, 1.0 / 385.0, -1.0 / 5544.0)
PLAIN = (2.0 / 3.0, -1.0 / 12.0)
# Weights of the two samples at half a step from a place, of those at one and a half, ..., in the
# value there: interpolation of order twelve.
BETWEEN = tuple([part / 2.0**19 for part in (320166, -76230, 22869, -5445, 847, -63)])
# A function is resolved if interpolation gives every other sample to this part of its span.
RESOLVED = 2.0**-9
# A sine squared that its samples do not resolve to this part of its least value may have a zero.
SURE = 0.25
# Mean squares of all samples and of every second differ by less, as a part of them: the error of
# the former is the square of that. Means by less, as a part of the root mean square: that of a
# magnitude, which changes suddenly near zero, settles slowly.
AGREE, AGREE_MEAN = 1e-6, 1e-10
# Samples around an interval through which a polynomial is laid; steps of Newton's method on it.
AROUND, NEWTON_STEPS = 12, 2

# Inputs of shape (m, any), real or complex, and which mechanisms they are of, shape (m,) -> their
# q quantities, shape (q, m, any).
ColumnFunction = Callable[[Array, Array], Array]


class Turns(NamedTuple):
    """Extrema of q quantities of n mechanisms, at most r each, by input; NaN beyond the last."""

    inputs: Array           # (q, n, r) [rad]
    values: Array           # (q, n, r)
    counts: Array           # (q, n)
    means: Array            # (q, n), over the input
    mean_squares: Array     # (q, n)
    are_means: Array        # (q, n): whether the means are right
    are_squares: Array      # (q, n): whether the mean squares are
    are_turning: Array      # (q, n): angles that a turn of the input turns on
    is_doubtful: Array      # (n,): whose extrema must be found in another way


def inputs(count: int) -> Array:
    """Return the inputs of the samples of a turn [rad], in the middle of equal intervals."""
    return 2.0 * pi * (np.arange(count) + 0.5) / count


def turn_fully(sines: Array) -> Array:
    """
    Return which mechanisms turn fully, (n,), by the sines of their dyads, (dyads, n, samples).

    A sine squared is analytic where the dyads before close, also where its own is in line, and
    falls below zero where that cannot close. Between two samples a cubic through both ends falls
    below the lower one by 4/27 of both slopes at most.
    """
    dyads, mechanisms, count = sines.shape
    f = np.square(sines).reshape(-1, count).T
    slopes = np.abs(slopes_of(f))
    least = (np.minimum(f, np.roll(f, -1, axis=0))
             - 4.0 / 27.0 * (slopes + np.roll(slopes, -1, axis=0))).min(axis=0)
    with np.errstate(invalid='ignore'):
        is_sure = (least > 0.0) & ~is_coarse(f, least * (SURE / RESOLVED))
    return np.asarray(is_sure.reshape(dyads, mechanisms).all(axis=0))


def search_turns(evaluate: ColumnFunction, mechanisms: int, count: int, is_angle: Array) -> Turns:
    """Return the extrema of q quantities of n mechanisms whose cranks turn fully."""
    # Samples of a turn, count of them, give slopes; sign changes of these bracket extrema, which
    # are then refined. is_angle, shape (q,): which quantities may jump by 2 pi.
    spacing = 2.0 * pi / count
    x = np.broadcast_to(inputs(count), (mechanisms, count))
    samples = evaluate(x, np.arange(mechanisms))
    shape = samples.shape[:2]
    periodic, turns, is_positive = _periodic(samples, is_angle)
    with np.errstate(invalid='ignore'):
        low, high = periodic.min(axis=0), periodic.max(axis=0)
    size = np.maximum(-low, high)
    # three kinds of functions are taken out before the search: infinite, constant, not resolved
    is_doubtful = ~np.isfinite(size)
    low[is_doubtful] = high[is_doubtful] = periodic[:, is_doubtful] = 0.0
    is_constant = (high - low <= CONSTANT * size) & (turns == 0.0)
    is_doubtful |= is_coarse(periodic, high - low) & ~is_constant
    is_constant, is_positive = is_constant.reshape(shape), is_positive.reshape(shape)
    is_doubtful = is_doubtful.reshape(shape).any(axis=0)
    slopes = slopes_of(periodic)
    slopes += spacing * turns
    slopes[:, (is_constant | is_doubtful).ravel()] = 1.0        # they get no brackets
    roots, has_hidden = _bracketed(slopes, spacing, mechanisms)
    x, value, strays = refined(evaluate, roots, is_positive, spacing)
    is_doubtful |= has_hidden | strays
    at_inputs, values = by_input(roots.quantity, roots.mechanism, x, value, 2.0 * pi, shape)
    if is_constant.any():       # as find_extrema lists a constant: once, where the range begins
        if not at_inputs.shape[-1]:
            at_inputs, values = (np.full((*shape, 1), np.nan) for _ in range(2))
        at_inputs[is_constant, 0], values[is_constant, 0] = 0.0, samples[is_constant, 0]
    turns_on = turns.reshape(shape) != 0.0
    for i in np.nonzero(is_angle)[0] if values.shape[-1] else ():
        # in the turn of the samples, which are continuous, then of find_extrema
        near = np.clip(np.nan_to_num(at_inputs[i] / spacing).astype(int), 0, count - 1)
        reference = np.take_along_axis(samples[i], near, axis=-1)
        values[i] += 2.0 * pi * np.round((reference - values[i]) / (2.0 * pi))
        least, most = (pick.reduce(values[i], axis=1) for pick in (np.fmin, np.fmax))
        turns_on[i] |= most - least >= 2.0 * pi
        off = np.nan_to_num(whole_turns(least, most))[:, None]
        values[i] -= off
        samples[i] -= off
    with np.errstate(all='ignore'):
        squares = samples * samples
        mean, mean_square = samples.mean(axis=-1), squares.mean(axis=-1)
        half, half_square = samples[..., ::2].mean(axis=-1), squares[..., ::2].mean(axis=-1)
        are_squares = np.abs(mean_square - half_square) <= AGREE * mean_square
        are_means = are_squares & (np.abs(mean - half) <= AGREE_MEAN * np.sqrt(mean_square))
    # of an angle that turns on they depend on where that begins: there is none
    for means, are_right in ((mean, are_means), (mean_square, are_squares)):
        means[turns_on], are_right[turns_on] = np.nan, True
    return Turns(at_inputs, values, np.isfinite(at_inputs).sum(axis=-1), mean, mean_square,
                 are_means, are_squares, turns.reshape(shape) != 0.0, is_doubtful)


def _periodic(samples: Array, is_angle: Array) -> tuple[Array, Array, Array]:
    """Return smooth periodic functions with extrema at the inputs of (q, n, samples)."""
    # Returned are their samples, shape (samples, q * n); whole turns of each angle in a cycle,
    # which are taken off; and which quantities are positive: of them it is half the square, since
    # a magnitude |F| changes suddenly near a zero of the force and its square does not. Angles in
    # samples are made continuous.
    quantities, mechanisms, count = samples.shape
    turns: Array = np.zeros((quantities, mechanisms))
    for i in np.nonzero(is_angle)[0]:
        samples[i] = np.unwrap(samples[i], axis=-1)
        turns[i] = np.round((samples[i, :, -1] - samples[i, :, 0]) / (2.0 * pi))
    turns = turns.ravel()
    flat = np.ascontiguousarray(samples.reshape(-1, count).T)
    with np.errstate(all='ignore'):
        is_positive = (flat.min(axis=0) > 0.0) & ~np.repeat(is_angle, mechanisms)
        flat *= np.where(is_positive, 0.5 * flat, 1.0)
    if turns.any():
        flat -= turns * inputs(count)[:, None]
    return flat, turns, is_positive


class Roots(NamedTuple):
    """Extrema of all mechanisms, arrays (roots,), sorted by mechanism, quantity, input."""

    x: Array            # first guesses [rad]
    bend: Array         # how the slope rises there: the second derivative
    mechanism: Array    # of which it is an extremum, as an index
    quantity: Array


def _bracketed(slopes: Array, spacing: float, mechanisms: int) -> tuple[Roots, Array]:
    """Return the roots of slopes, and which mechanisms may have more, shape (n,)."""
    # slopes has shape (samples, q * n), times the spacing of the samples. Where a slope changes
    # its sign between two samples lies a root; its first guess is that of a cubic through values
    # and bends there, then of a polynomial through the samples around, unless that leads away.
    bends = slopes_of(slopes, PLAIN)
    changes, doubtful = changes_and_doubts(slopes, bends * (1.0 / 3.0), True)
    i, column = np.nonzero(changes)
    quantity, mechanism = np.divmod(column, mechanisms)
    order = np.lexsort((quantity, mechanism))
    i, column, quantity, mechanism = (v[order] for v in (i, column, quantity, mechanism))
    # slope and bend at the samples a and b, before and after the root
    after = (i + 1) % len(slopes)
    fa, fb, bend_a, bend_b = (f[k, column] for f in (slopes, bends) for k in (i, after))
    with np.errstate(all='ignore'):
        guess = first_guesses(np.zeros(fa.shape), np.ones(fa.shape), fa, fb, fa / bend_a,
                              fb / bend_b)
        share, bend = roots_between(slopes, i, column, guess)
        is_near = (share > -0.5) & (share < 1.5) & (bend * (fb - fa) > 0.0)
    share, bend = np.where(is_near, share, guess), np.where(is_near, bend, fb - fa)
    has_hidden: Array = np.logical_or.reduce(doubtful.reshape(-1, mechanisms))
    x = (i + share + 0.5) * spacing
    return Roots(x, bend / spacing**2, mechanism, quantity), has_hidden


def by_input(quantity: Array, mechanism: Array, x: Array, values: Array, cycle: float,
             shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Return inputs and values of extrema, (extrema,), by input as tables (q, n, r), else NaN."""
    # x: in any turn of the cycle [rad]; shape: (q, n). Of two at one input the order stays.
    x = np.mod(x, cycle)
    order = np.lexsort((x, quantity, mechanism))
    quantity, mechanism = quantity[order], mechanism[order]
    rank = rank_of(mechanism * shape[0] + quantity)
    tables = np.full((2, *shape, int(rank.max(initial=-1)) + 1), np.nan)
    tables[:, quantity, mechanism, rank] = x[order], values[order]
    return tables[0], tables[1]


def refined(evaluate: ColumnFunction, roots: Roots, is_positive: Array,
            spacing: Values) -> tuple[Array, Array, Array]:
    """
    Return inputs and values of roots, (roots,), and which mechanisms have one that strays, (n,).

    ``is_positive``, shape (q, n): of these quantities, roots of the slope of half the square are
    sought; ``spacing``: of the samples, of all or at each root. The first step divides the slope
    by the bend of the samples, the others by that of a secant through the last two inputs. The
    error after a step is about its product with the step before over the spacing, after the first
    the part by which bends of samples may be wrong: where that is small, a root is found. One that
    moves by more than the spacing, or is not found in :data:`STEPS`, strays.
    """
    x, strays = roots.x.copy(), np.zeros(is_positive.shape[1], bool)
    spacings = np.broadcast_to(spacing, x.shape)
    values, left = np.empty(x.shape), np.arange(x.size)         # left: roots that still move
    start, bend = roots.x, roots.bend
    last_step = last_slope = np.full(x.shape, np.nan)
    for _ in range(STEPS):
        i, quantity = roots.mechanism[left], roots.quantity[left]
        # one row for each mechanism that has some left, one column for each of its roots
        mechanisms, row = np.unique(i, return_inverse=True)
        row, column, grid = as_grid(x[left], row, mechanisms.size)
        result = evaluate(grid + 1j * STEP, mechanisms)[quantity, row, column]
        squared, value, slope = is_positive[quantity, i], result.real, result.imag / STEP
        with np.errstate(all='ignore'):
            slope = np.where(squared, value * slope, slope)
            secant = (slope - last_slope) / last_step
            bend = np.where(np.isfinite(secant) & (secant * bend > 0.0), secant, bend)
            step = -slope / bend
            rise = slope * step         # twice what the function changes in the step
            values[left] = np.where(squared, np.sqrt(np.maximum(value * value + rise, 0.0)),
                                    value + 0.5 * rise)
            x[left] += step
            near = spacings[left]
            is_far = ~(np.abs(x[left] - start[left]) <= near)
            last_step = np.where(np.isnan(last_step), RESOLVED * near, last_step)
            moves = ~(np.abs(step * last_step) <= CLOSE * near * near)
        strays[i[is_far]] = True
        moves &= ~strays[i]
        left, bend, last_step, last_slope = (v[moves] for v in (left, bend, step, slope))
        if not left.size:
            break
    strays[roots.mechanism[left]] = True
    return x, values, strays


def _wrapped(f: Array, width: int) -> Array:
    """Return samples of a turn with ``width`` more before and after, from its other end."""
    return np.concatenate((f[-width:], f, f[:width]))


def slopes_of(f: Array, weights: Sequence[float] = FINE) -> Array:
    """Return the slopes at samples f, (samples, m), times the step, by central differences."""
    width, count = len(weights), len(f)
    wrapped, slopes, term = _wrapped(f, width), np.zeros(f.shape), np.empty(f.shape)
    for k, weight in enumerate(weights, 1):
        np.subtract(wrapped[width + k:width + k + count], wrapped[width - k:width - k + count],
                    out=term)
        term *= weight
        slopes += term
    return slopes


def is_coarse(f: Array, span: Array) -> Array:
    """Return which functions the samples f, shape (samples, m), do not resolve, shape (m,)."""
    # Every other sample is compared with what the ones between say there; span, shape (m,): the
    # largest less the least sample.
    width, count = len(BETWEEN), len(f) // 2
    even, error, term = _wrapped(f[::2], width), f[1::2].copy(), np.empty((count, *f.shape[1:]))
    for k, weight in enumerate(BETWEEN):
        np.add(even[width - k:width - k + count], even[width + 1 + k:width + 1 + k + count],
               out=term)
        term *= weight
        error -= term
    far: Array = np.maximum(error.max(axis=0), -error.min(axis=0)) > RESOLVED * span
    return far


def roots_between(f: Array, i: Array, column: Array, guess: Array) -> tuple[Array, Array]:
    """Return where functions have roots, in steps after sample ``i``, and their slopes there."""
    # By Newton's method on the polynomials through the nearest samples of f, shape (samples, m).
    # All else has shape (roots,): the sample before the root and the column of its function, both
    # as indices, and a guess from 0 to 1.
    middle = AROUND // 2 - 1
    near = (np.arange(AROUND)[:, None] - middle + i) % len(f)
    table = f.ravel().take(near * f.shape[1] + column)
    differences = [table[0]]        # Newton's divided differences: the polynomial's coefficients
    for k in range(1, AROUND):
        table = table[1:] - table[:-1]
        table *= 1.0 / k
        differences.append(table[0])
    t = guess + middle
    slope = np.zeros(t.shape)
    for _ in range(NEWTON_STEPS):
        value, slope = differences[-1], np.zeros(t.shape)
        for k in range(AROUND - 2, -1, -1):         # Horner's scheme, for value and slope
            away = t - k
            slope = slope * away + value
            value = value * away + differences[k]
        with np.errstate(all='ignore'):
            t = t - value / slope
    return t - middle, slope
