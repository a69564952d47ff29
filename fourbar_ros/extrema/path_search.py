# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of arbitrary quantities along one input path: interior ones, ends, constant ranges.

:mod:`.find` calls it for each path. Quantities are sampled with their derivatives on the points of
:mod:`.input_paths`. Sign changes of the derivative, hidden pairs of them too, are bracketed, and
all brackets of all quantities solved at once. For omega4 and alpha4 this does the work of both
documents' algorithms of extreme values. At a *cut* of the path, where pieces of a load meet, a
load may jump, so that both of its values are extrema, or have a kink, which is one if the slope
changes its sign there.

Conditions. With F = dQ/dtheta1 at an extremum, its input moves by -sum (dF/da_i) da_i / F' and its
value by sum (dQ/da_i) da_i. For lengths that are each wrong by a relative eps, eps times the sums
of the absolute terms bounds both.
"""
from collections.abc import Callable, Sequence
from functools import cache
from math import comb, inf, isfinite, isnan, nan, pi
from typing import NamedTuple

from fourbar_ros.extrema.input_paths import End, InputPath, PIECE, REGULAR
from fourbar_ros.extrema.sampling import (
    DifferenceSampler,
    exactly_scaled,
    POLE,
    Sampler,
    Samples,
    SMALLEST,
    whole_turns,
)
from fourbar_ros.numerics.arrays import Array, EPS, Values
from fourbar_ros.numerics.roots import find_brackets, newton_roots, rises, SMALL, turn_after
import numpy as np

# Power of sin(mu) by which derivatives grow at toggles (for accelerations; forces grow faster by
# one, rates more slowly). Times this power they are smooth. The derivative of a magnitude |F|
# needs the factor |F| too: near a zero of the force it changes suddenly, F . dF/dtheta1 does not.
AT_TOGGLE = 5
# Samples on either side of an end from which the value there is interpolated.
NEIGHBOURS = 12
# Distance from a toggle at which a quantity is sampled again, over that of the samples: by the
# path's parameter a 64th.
NEARER = 2.0**-12
# Growth of differences towards a pole, and their least share of the values: less may be rounding.
GROWTH, SHARE = 1.5, 2.0**-10
# Part of the bound of rounding errors that counts for an extremum.
PART_OF_NOISE = 0.25
# Distance from a root at which slopes tell a kink from a smooth minimum, in samples; how small the
# value is then beside that of a sample.
KINK, DEEP = 2.0**-12, 2.0**-12
# How far from an extremum a quantity is evaluated with many digits to confirm it, in samples.
BESIDE = 2.0**-6
# Where values beside the end of a piece are taken, as a part of the input.
BESIDE_CUT = 2.0**-46
# The same where friction jumps: nearer to it the relative rate of a joint may be rounding.
BESIDE_JUMP = 2.0**-34
# The same where the ends of a spring meet: its direction is rounding over its length.
BESIDE_MEETING = 2.0**-18
# Values that differ by less, as a part of them, are a constant at the end of a path.
FLAT = 2.0**-40
# Jumps of functions that are smaller, as a part of their values, are not looked for. Halvings of
# the distance of the samples between which one lies.
SMALL_JUMP, HALVINGS = 2.0**-20, 50
# Step in theta1 for the curvature, in distances of samples, at least.
TURN = 2.0**-12


def _weights(count: int, terms: Callable[[int], int]) -> Array:
    """Return weights, of sum one, that extrapolate samples at 1/2, 3/2, ... to 0 (Lagrange)."""
    weights = np.array([(-1)**j * terms(j) / (j + 0.5) for j in range(count)])
    return np.asarray(weights / weights.sum())


# For samples at +-1/2, 3/2, ... together, and for those on one side.
_THROUGH = 0.5 * _weights(NEIGHBOURS, lambda j: comb(2 * NEIGHBOURS - 1, NEIGHBOURS + j))
_UP_TO = _weights(NEIGHBOURS, lambda j: comb(NEIGHBOURS - 1, j))


class PathExtremum(NamedTuple):
    """An extremum of a quantity on a path of the input."""

    quantity: int                    # its index in the sampler
    x: float                         # input, in the mechanism's unit
    value: float
    sense: int                       # +1 maximum, -1 minimum, 0 constant from here on
    side: int = 0                    # as in :class:`~fourbar_ros.extrema.find.Extremum`
    condition: float = nan           # as in Extremum, of the input
    value_condition: float = nan
    noise: float = 0.0               # least error of the value, of a constant a bound
    spread: float = 0.0              # of a constant: its samples about the value, at most
    misses: bool = False             # another of its quantity is missing: they do not take turns
    is_jump: bool = False            # a value on one side of the end of a piece


def search_path(sampler: Sampler, path: InputPath, with_conditions: bool = True,
                more: Sequence[float] = ()) -> list[PathExtremum]:
    """Return all extrema along a path, its ends among them; ``more``: further inputs to sample."""
    samples = sampler.along(path)
    # constant are quantities whose samples differ by no more than their last bits, with the error
    # 0, or than their rounding errors may: then the error is the bound of these, and the value is
    # zero if all samples are within it
    value = np.median(samples.values, axis=1)
    away = np.abs(samples.values - value[:, None])
    is_exact = ~(away > 64.0 * EPS * np.abs(value)[:, None]).any(axis=1)
    is_noise = ~is_exact & (away <= samples.noise).all(axis=1)
    is_zero = is_noise & (np.abs(samples.values) <= samples.noise).all(axis=1)
    value = np.where(is_zero, 0.0, value)
    error = np.where(is_exact, 0.0, samples.noise.max(axis=1))
    start, side = (0.0, 0) if path.low is None else (path.low.x, 1)
    spread = np.abs(samples.values - value[:, None]).max(axis=1)
    extrema = [PathExtremum(row, sampler.fold(start), float(value[row]), 0, side,
                            noise=float(error[row]), spread=float(spread[row]))
               for row in np.flatnonzero(is_exact | is_noise).tolist()]
    rows = np.flatnonzero(~(is_exact | is_noise))
    if rows.size:
        inside = sampler.along(path.with_points(np.array(more))) if more else samples
        brackets, at_cuts = _at_cuts(sampler, samples, rows) if path.cuts.size else ((), [])
        extrema += [PathExtremum(each.quantity, sampler.fold(float(path.cuts[each.cut])), value,
                                 sense, side, is_jump=True)
                    for each in at_cuts if each.is_jump
                    for side, value, sense in zip((-1, 1), each.values, each.senses)]
        extrema += _interior(sampler, inside, rows, with_conditions, brackets, at_cuts)
        for side, end in path.ends():
            extrema += _at_end(sampler, samples, side, end, rows)
        extrema += _missed(sampler, samples, rows, extrema)

    begin = float(path.x[0]) if path.low is None else path.low.x

    def beyond(x: Values) -> Values:
        """Return how far inputs lie along the path, in each turn the same."""
        return x - begin if sampler.period == inf else np.mod(x - begin, sampler.period)

    def along(extremum: PathExtremum) -> tuple[float, int]:
        if extremum.side and not extremum.is_jump:
            return -extremum.side * inf, 0
        return float(beyond(extremum.x)), extremum.side

    def may_follow(a: PathExtremum, b: PathExtremum) -> bool:
        """Return whether two of one sense follow each other: over a jump, or a plateau."""
        if a.is_jump and b.is_jump and a.x == b.x:
            return True
        low, x, high = along(a)[0], beyond(path.x), along(b)[0]
        between = samples.values[a.quantity, (x > low) & (x < high) if low < high
                                 else (x > low) | (x < high)]
        return isfinite(a.value) and bool(
            between.size and (np.abs(between - a.value) <= FLAT * abs(a.value)).all())

    # maxima and minima of a quantity take turns
    by_quantity: dict[int, list[PathExtremum]] = {}
    for extremum in sorted(extrema, key=along):
        by_quantity.setdefault(extremum.quantity, []).append(extremum)
    wrong = {quantity for quantity, inorder in by_quantity.items() if len(inorder) > 1 and any(
        a.sense == b.sense and not may_follow(a, b)
        for a, b in zip(inorder, inorder[1:] + inorder[:path.is_closed])) or any(
        isnan(extremum.value) or extremum.misses for extremum in inorder)}
    turns = dict.fromkeys(by_quantity, 0.0)
    for quantity, inorder in by_quantity.items():
        if sampler.is_angle[quantity]:
            values = [extremum.value for extremum in inorder]
            turns[quantity] = float(whole_turns(min(values), max(values)))
    return [extremum._replace(value=extremum.value - turns[extremum.quantity],
                              misses=extremum.quantity in wrong)
            for extremum in extrema if not isnan(extremum.value)]


def jumps_along(sampler: DifferenceSampler, path: InputPath) -> list[float]:
    """Return where functions jump between samples of a path [rad or m]; refuse poles."""
    # There values rise by more than the slopes at both samples say, however near these are.
    sampler.along(path)
    tiny = _beside_cut(sampler, path)
    x = np.sort(np.concatenate((path.x, path.cuts - tiny, path.cuts + tiny,
                                [path.x[0] + path.period] if path.is_closed else [])))
    values, slopes, _ = sampler.sample(x)
    width, line = np.diff(x), 0.5 * (slopes[:, 1:] + slopes[:, :-1])
    rise, size = np.diff(values), np.maximum(np.abs(values[:, 1:]), np.abs(values[:, :-1]))
    off = np.abs(rise - line * width)
    row, i = np.nonzero((off > 0.25 * np.abs(rise)) & (off > SMALL_JUMP * size)
                        & (np.diff(np.searchsorted(path.cuts, x)) == 0))
    low, high, before, after = x[i], x[i + 1], values[row, i], values[row, i + 1]
    line, least, pole = line[row, i], 0.25 * off[row, i], (off + size)[row, i] / POLE
    for _ in range(HALVINGS):
        if not row.size:
            return []
        middle = 0.5 * (low + high)
        value = sampler.values(middle)[row, np.arange(row.size)]
        is_first = (np.abs(value - before - line * (middle - low))
                    >= np.abs(after - value - line * (high - middle)))
        high, after = np.where(is_first, middle, high), np.where(is_first, value, after)
        low, before = np.where(is_first, low, middle), np.where(is_first, before, value)
        is_open = np.abs(after - before) > least
        row, low, high, before, after, line, least, pole = (
            each[is_open] for each in (row, low, high, before, after, line, least, pole))
    for k in np.flatnonzero(~(np.abs(after - before) < pole)).tolist():
        sampler.refuse_pole(int(row[k]), float(high[k]))
    inputs = high - path.period * np.round(high / path.period) if path.is_closed else high
    return [sampler.unit * x for x in np.unique(inputs).tolist()]


def _rounding(values: Array) -> Array:
    """Return what roundings that tables and functions bring may be, (rows,), of samples."""
    # of the size of most samples, not of those beside a toggle
    return FLAT * np.asarray(np.nanquantile(np.abs(values), 0.9, axis=1))


def _missed(sampler: Sampler, samples: Samples, rows: Array, extrema: Sequence[PathExtremum]
            ) -> list[PathExtremum]:
    """Return the largest and the least sample of those of ``rows`` that no extremum reaches."""
    # but of angles, that may turn on
    missed, rounding = list[PathExtremum](), _rounding(samples.values)
    for row in rows[~sampler.is_angle[rows]].tolist():
        for sense in (-1, 1):
            values = sense * samples.values[row]
            i = int(values.argmax())
            most = max([sense * extremum.value for extremum in extrema
                        if extremum.quantity == row and extremum.sense == sense], default=-inf)
            if values[i] > most + samples.noise[row, i] + max(rounding[row],
                                                              FLAT * abs(values[i])):
                missed.append(PathExtremum(row, sampler.fold(float(samples.path.x[i])),
                                           sense * float(values[i]), sense, misses=True))
    return missed


class AtCut(NamedTuple):
    """A quantity at the end of a piece, where it jumps, or where its slope changes its sign."""

    is_jump: bool
    quantity: int                   # its index
    cut: int                        # index of the end of a piece along the path
    values: tuple[float, float]     # of the quantity before and after it
    senses: tuple[int, int]         # +1: it is a maximum on this side, -1: a minimum


def _at_cuts(sampler: Sampler, samples: Samples, rows: Array
             ) -> tuple[Sequence[Array], list[AtCut]]:
    """Return brackets, as :func:`.find_brackets`, of roots beside cuts, and extrema at them."""
    # The brackets reach from a cut to the sample next to it: within BESIDE_CUT of it lies none.
    cuts, before, x = samples.path.cuts, samples.path.before_cuts, samples.path.x
    after = (before + 1) % x.size
    tiny = _beside_cut(sampler, samples.path)
    x_after = turn_after(x[after], cuts, sampler.period) if samples.path.is_closed else x[after]
    values, slopes, _ = sampler.sample(np.concatenate((cuts - tiny, cuts + tiny)))
    (v_before, v_after), (s_before, s_after) = (np.split(part[rows], 2, axis=1)
                                                for part in (values, slopes))
    if tiny >= BESIDE_JUMP:
        v_before, v_after = v_before + tiny * s_before, v_after - tiny * s_after
    noise = (samples.noise[rows][:, before] + samples.noise[rows][:, after]
             + np.maximum(FLAT * np.abs(v_before), _rounding(samples.values[rows])[:, None]))
    away = v_after - v_before
    away = away - 2.0 * pi * np.round(away / (2.0 * pi)) * sampler.is_angle[rows, None]
    jumps = np.abs(away) > noise + 4.0 * tiny * (np.abs(s_before) + np.abs(s_after))
    kinks = ((s_before >= 0.0) != (s_after >= 0.0)) & ~jumps

    def sense(row: int, cut: int, side: int) -> int:
        """Return +1 where a quantity grows towards a cut from this side, -1 where it falls."""
        index, value, slope = (
            (before[cut], v_before[row, cut], s_before[row, cut]) if side < 0 else
            (after[cut], v_after[row, cut], s_after[row, cut]))
        rises = slope >= 0.0
        if jumps[row, cut]:     # a plateau may lie beside it: what the quantity does at its end
            away = np.roll(samples.values[rows[row]], -index)[::side]
            away = (np.roll(away, 1) if side < 0 else away) - value
            differs = np.flatnonzero(np.abs(away) > FLAT * abs(value))
            if differs.size and differs[0] > 0:
                rises = side * away[differs[0]] > 0.0
        return 1 if rises == (side < 0) else -1

    at_cuts = [AtCut(bool(jumps[row, cut]), int(rows[row]), int(cut),
                     (float(v_before[row, cut]), float(v_after[row, cut])),
                     (sense(row, cut, -1), sense(row, cut, 1)))
               for row, cut in zip(*np.nonzero(jumps | kinks))]
    brackets = []
    for index, near, there, begin in ((before, s_before, cuts - tiny, True),
                                      (after, s_after, cuts + tiny, False)):
        sampled = samples.slopes[rows][:, index]
        row, cut = np.nonzero((sampled >= 0.0) != (near >= 0.0))
        sample = x[index] if begin else x_after
        low, high = (sample, there) if begin else (there, sample)
        first = sampled if begin else near
        brackets.append((index[cut] if begin else before[cut], rows[row], low[cut], high[cut],
                         first[row, cut], 0.5 * (low + high)[cut]))
    return tuple(map(np.concatenate, zip(*brackets))), at_cuts


def _beside_cut(sampler: Sampler, path: InputPath) -> float:
    """Return how far beside the ends of pieces values are taken, in the unit of the input."""
    tiny = BESIDE_CUT * float(np.abs(path.x).max())         # ends are found at any turn
    if sampler.linkage.pieces and sampler.linkage.pieces.meetings:
        return BESIDE_MEETING
    return max(tiny, BESIDE_JUMP) if sampler.linkage.friction else tiny


class TurningPoints(NamedTuple):
    """Where the slopes of quantities change their sign, arrays of shape (n,)."""

    quantity: Array     # its index
    before: Array       # index of the sample before the root
    sense: Array        # +1 a maximum, -1 a minimum
    x: Array            # the input there
    spacing: Array      # distance of the samples there
    value: Array        # of the quantity at the input as it is reported
    rounding: Array     # its least rounding error
    noise: Array        # a bound of that


def _roots(sampler: Sampler, samples: Samples, rows: Array, brackets: Sequence[Array],
           kinks: Sequence[AtCut]) -> TurningPoints:
    """Return where slopes of the quantities ``rows`` are zero, or change their sign at a kink."""
    x, is_closed, before_cuts = samples.path.x, samples.path.is_closed, samples.path.before_cuts
    # at a toggle derivatives have poles of a power of sin(mu): without them sign changes show
    # between samples, and a positive factor moves no root
    values = samples.values[rows]
    scale = np.where((values > 0.0).all(axis=1, keepdims=True), exactly_scaled(
        values, np.abs(values).max(axis=1, keepdims=True)) * samples.sine**(2 * AT_TOGGLE - 1),
        samples.sine**AT_TOGGLE)
    f = np.asarray(samples.slopes[rows].T * scale.T)
    turn = rises(np.unwrap(x)[:, None], False, before_cuts)[:, 0]
    i, row, xa, xb, fa, guess = find_brackets(lambda x, row: sampler.slope(x, rows[row]),
                                              lambda i, row: (x[i], turn[i]), f,
                                              rises(f, is_closed, before_cuts), is_closed,
                                              sampler.period, before_cuts)
    row = rows[row]
    if brackets:
        i, row, xa, xb, fa, guess = (np.concatenate(both) for both in zip(
            (i, row, xa, xb, fa, guess), brackets))
    spacing = xb - xa
    # where a force changes its sign the slope of its magnitude |F| jumps, that of F^2/2 does not
    is_positive = ((samples.values > 0.0).all(axis=1) & ~sampler.is_angle)[row]

    def newton(x: Array, which: Array) -> tuple[Array, ...]:
        return sampler.newton(x, row[which], spacing[which], is_positive[which])

    def solved(which: Array) -> Array:
        return newton_roots(newton, which, *(v[which] for v in (xa, xb, fa, guess)))

    root = solved(np.arange(row.size)) if row.size else xa
    which = np.flatnonzero(is_positive)
    if which.size:      # one that dips below zero between samples is no magnitude
        before, after = _beside(sampler, root[which], KINK * spacing[which], row[which])
        which = which[np.sign(before) * after > 0.0]
    if which.size:
        is_positive[which] = False
        root[which] = solved(which)
    sense = np.where(fa >= 0.0, 1, -1)
    if isinstance(sampler, DifferenceSampler) and row.size:
        root = sampler.polish(root, row, sense)
    if kinks:
        cuts = [kink.cut for kink in kinks]
        i, root = np.append(i, before_cuts[cuts]), np.append(root, samples.path.cuts[cuts])
        row = np.append(row, [kink.quantity for kink in kinks])
        sense = np.append(sense, [kink.senses[0] for kink in kinks])
        spacing = np.append(spacing, np.full(len(kinks), nan))
    # of the input as it is reported, where ``step`` has the same value
    value = sampler.values(sampler.fold(root))[row, np.arange(row.size)]
    if kinks and _beside_cut(sampler, samples.path) >= BESIDE_JUMP:
        # at the end itself a joint is at rest, or a spring has no direction
        value[-len(kinks):] = [kink.values[0] for kink in kinks]
    rounding, noise = (PART_OF_NOISE * np.maximum(errors[row, i], errors[row, (i + 1) % x.size])
                       for errors in (samples.rounding, samples.noise))
    return TurningPoints(row, i, sense, root, spacing, value, rounding, noise)


def _interior(sampler: Sampler, samples: Samples, rows: Array, with_conditions: bool,
              brackets: Sequence[Array], at_cuts: Sequence[AtCut]) -> list[PathExtremum]:
    """Return the extrema of the quantities ``rows`` between the samples."""
    # Example: |F32| of the paper's linkage at 25 rad/s, at 256 samples of a turn. Its slope is
    # -3769 N/rad at sample 105, theta1 = -0.3396, and +5327 at sample 106, -0.3236; so the root
    # between them, -0.3338, is a minimum. Its value, 46.3 N, is 34 N below sample 106 and 12 below
    # 105, and rounding errors are at most 7e-11: it is accepted. Were the difference within them,
    # it would be none.
    roots = _roots(sampler, samples, rows, brackets,
                   [each for each in at_cuts if not each.is_jump])
    is_magnitude = np.asarray((samples.values >= 0.0).all(axis=1))[roots.quantity]
    near = samples.values[roots.quantity, roots.before]
    is_small = np.flatnonzero((roots.sense < 0) & is_magnitude & (
        np.abs(roots.value) <= np.maximum(roots.noise, DEEP * near)))
    if is_small.size:
        # between pieces there is no slope to ask
        is_end = np.isnan(roots.spacing[is_small]) & (
            np.abs(roots.value[is_small]) <= roots.rounding[is_small])
        roots.value[is_small[_is_kink(sampler, roots, is_small) | is_end]] = 0.0
    kept = _beyond_noise(sampler, samples, roots, [each for each in at_cuts if each.is_jump])
    roots = TurningPoints(*(v[kept] for v in roots))
    if not roots.quantity.size:
        return []
    condition, value_condition = np.full((2, roots.quantity.size), nan)
    if with_conditions and sampler.linkage.change_point_margin:
        condition, value_condition = sampled_conditions(sampler, roots.x, roots.quantity,
                                                        roots.spacing)
    value = sampler.same_turn(samples.values[roots.quantity, roots.before], roots.value,
                              roots.quantity)
    columns = {'quantity': roots.quantity, 'x': sampler.fold(roots.x), 'value': value,
               'sense': roots.sense, 'condition': condition,
               'value_condition': value_condition, 'noise': roots.rounding}
    return [PathExtremum(**dict(zip(columns, fields)))
            for fields in zip(*(column.tolist() for column in columns.values()))]


def _is_kink(sampler: Sampler, roots: TurningPoints, which: Array) -> Array:
    """Return which magnitudes |F| are least because F changes its sign: they are kinks."""
    # |F| is zero there: the rounding of the input explains its value, or the parabola through
    # three values of F^2 from many digits comes down to zero; of functions that have none, the
    # rounding of the terms of F explains it.
    x, turn, row = roots.x[which], KINK * roots.spacing[which], roots.quantity[which]
    before, after = _beside(sampler, x, turn, row)
    size = np.maximum(np.abs(before), np.abs(after))
    is_kink = (np.sign(before) * after < 0.0) & (np.abs(before + after) <= 0.25 * size)
    by_input = 4.0 * np.spacing(np.maximum(np.abs(sampler.fold(x)), SMALL)) * size
    value = np.abs(roots.value[which])
    is_zero = is_kink & (value <= by_input)
    left = np.flatnonzero(is_kink & ~is_zero)
    if left.size:
        turn = 64.0 * np.spacing(np.maximum(np.abs(x[left]), SMALL))     # exact in x + turn
        before, here, after = sampler.exact(
            np.concatenate([x[left] - turn, x[left], x[left] + turn]),
            np.tile(row[left], 3)).reshape(3, -1)**2
        slope, bend = 0.5 * (after - before), after + before - 2.0 * here
        is_zero[left] = np.where(
            np.isnan(here), value[left] <= by_input[left] + roots.rounding[which][left],
            (bend > 0.0) & (np.abs(here * bend - 0.5 * slope**2) <= bend * by_input[left]**2))
    return np.asarray(is_zero)


def _beside(sampler: Sampler, x: Array, turn: Array, row: Array) -> tuple[Array, Array]:
    """Return the slopes of quantities ``row`` at x - turn and at x + turn."""
    before, after = sampler.slope(np.concatenate((x - turn, x + turn)),
                                  np.concatenate((row, row))).reshape(2, -1)
    return before, after


class _Turn(NamedTuple):
    """An extremum of a quantity, or an end of a path (root -1)."""

    value: float
    error: float
    before: int         # index of the sample before it
    root: int           # its index among the roots


def _beyond_noise(sampler: Sampler, samples: Samples, roots: TurningPoints,
                  jumps: Sequence[AtCut]) -> Array:
    """Return the indices of the roots that rounding errors cannot have made."""
    # Maxima and minima take turns along a path. Two neighbours between which no fall is larger
    # than rounding errors are taken out together, the most alike first; so is one beside an end to
    # which there is none. Values 3, 1, 2, 0 with an error of 1.5 each leave 3 and 0. Where the
    # bound of the errors may be far too large, many digits confirm extrema.
    @cache
    def is_confirmed(k: int) -> bool:
        if isnan(roots.spacing[k]):
            return False
        beside = BESIDE * roots.spacing[k]
        before, here, after = roots.sense[k] * sampler.exact(
            roots.x[k] + np.array((-beside, 0.0, beside)), np.full(3, roots.quantity[k]))
        return bool(before < here > after)

    order = np.lexsort((roots.x, roots.before, roots.quantity))
    kept = list[int]()
    for of_quantity in np.split(order, np.flatnonzero(np.diff(roots.quantity[order])) + 1):
        if not of_quantity.size:
            break
        quantity = roots.quantity[of_quantity[0]]
        values, errors = samples.values[quantity], PART_OF_NOISE * samples.noise[quantity]
        turns = [_Turn(float(roots.value[k]), float(roots.noise[k]), int(roots.before[k]), k)
                 for k in of_quantity.tolist()]
        if not samples.path.is_closed:
            turns = [_Turn(float(values[0]), float(errors[0]), -1, -1), *turns,
                     _Turn(float(values[-1]), float(errors[-1]), values.size - 1, -1)]
        # in stretches between jumps, whose values on both sides are ends of them
        stretches, start, path = list[list[_Turn]](), list[_Turn](), samples.path
        for jump in [jump for jump in jumps if jump.quantity == quantity]:
            before = int(path.before_cuts[jump.cut])
            ends = [_Turn(value, float(errors[before]), before, -1) for value in jump.values]
            inner = [turn for turn in turns if turn.before <= before]
            turns = turns[len(inner):]
            stretches.append([*start, *inner, ends[0]])
            start = [ends[1]]
        if path.is_closed and stretches:        # the first goes on from the last
            turns = [*turns, *stretches.pop(0)]
        stretches.append([*start, *turns])

        def is_certain(turn: _Turn, following: _Turn) -> bool:
            """Return whether two neighbours that differ by less than the bound are extrema."""
            inner = [end.root for end in (turn, following) if end.root >= 0]
            return (bool(inner) and abs(turn.value - following.value) > roots.rounding[inner].max()
                    and all(map(is_confirmed, inner)))
        kept += [turn.root for stretch in stretches
                 for turn in _with_falls(stretch, values, errors, is_certain) if turn.root >= 0]
    return np.array(kept, int)


def _with_falls(turns: list[_Turn], values: Array, errors: Array,
                is_certain: Callable[[_Turn, _Turn], bool]) -> list[_Turn]:
    """Return those of the extrema of a quantity, with any ends, that its rounding leaves."""
    @cache
    def fall(turn: _Turn, following: _Turn) -> float:
        least = abs(turn.value - following.value) / max(turn.error, following.error, SMALLEST)
        between = (following.before - turn.before) % values.size
        if least > 1.0 or not between:
            return least
        i = (turn.before + 1 + np.arange(between)) % values.size
        with np.errstate(over='ignore'):
            return float(max(least, *((np.abs(values[i] - end.value) / np.maximum(
                errors[i], max(end.error, SMALLEST))).max() for end in (turn, following))))

    is_closed = turns[0].root >= 0
    while len(turns) > (0 if is_closed else 2):
        falls = [fall(*pair) for pair in zip(turns, turns[1:] + turns[:is_closed])]
        least = min(falls)
        if least > 1.0:
            break
        k = falls.index(least)
        pair = k, (k + 1) % len(turns)
        certain = is_certain(*(turns[i] for i in pair))
        turns = [turn._replace(error=0.0) if certain and i in pair else turn
                 for i, turn in enumerate(turns) if certain or i not in pair or turn.root < 0]
    return turns


def _at_end(sampler: Sampler, samples: Samples, side: int, end: End,
            rows: Array) -> list[PathExtremum]:
    """Return the limits of the quantities ``rows`` at one end of a path as extrema."""
    # side: +1 if the path lies above the end. A limit is infinite, or a minimum if the quantity
    # rises inward, else a maximum.
    if end.kind == REGULAR:
        limits = sampler.values(np.array([end.x]))[:, 0]
    elif end.kind == PIECE:         # a load may jump there: its value inside
        tiny = side * _beside_cut(sampler, samples.path)
        values, slopes, _ = sampler.sample(np.array([end.x + tiny]))
        limits = (values - tiny * slopes)[:, 0]
    elif end.is_pole:
        limits = np.copysign(inf, samples.values[:, samples.path.inward(side)[0]])
    else:
        limits = _limits_at_toggle(sampler, samples, side, end, rows)
    inward = samples.path.inward(side)
    limits = sampler.same_turn(samples.values[:, inward[0]], limits, np.arange(limits.size))
    # seen from inside it falls by its slope, or by the first sample that rounding errors, or a
    # constant last piece, do not make
    away = samples.values[:, inward] - limits[:, None]
    differs = np.abs(away) > np.maximum(FLAT * np.abs(limits)[:, None], samples.noise[:, inward])
    first = differs.argmax(axis=1)
    falls = np.where(first > 0, away[np.arange(first.size), first],
                     samples.slopes[:, inward[0]] * side) > 0.0
    sense = np.where(np.isinf(limits), np.sign(limits), np.where(falls, -1, 1)).astype(int)
    x = sampler.fold(end.x)
    return [PathExtremum(row, x, float(limits[row]), int(sense[row]), side)
            for row in rows.tolist()]


def _limits_at_toggle(sampler: Sampler, samples: Samples, side: int, end: End,
                      rows: Array) -> Array:
    """Return the limits of all quantities at a toggle; right for ``rows``."""
    # Quantities are meromorphic in the path's parameter: one whose differences grow about twofold
    # each time the distance falls to a quarter has a pole. The others go on smoothly into the
    # other assembly mode. Many digits tell where rounding errors may look like a pole, or hide it.
    path, inward = samples.path, samples.path.inward(side)[:4]
    nearest = samples.values[:, inward]
    is_doubtful = ~sampler.is_angle & (samples.noise[:, inward[0]] > np.maximum(
        np.abs(nearest[:, 0] - nearest[:, 1]), SHARE * np.abs(nearest).max(axis=1)))
    doubtful = rows[is_doubtful[rows]]

    def with_digits(of: Sampler, x: Array, values: Array) -> Array:
        """Return values at x, the doubtful ones from many digits."""
        if doubtful.size:
            values[doubtful] = of.exact(np.tile(x, doubtful.size), np.repeat(doubtful, x.size)
                                        ).reshape(doubtful.size, x.size)
        return values

    nearest = with_digits(sampler, path.x[inward], nearest)
    fall = np.abs(np.diff(nearest))
    has_pole = ((fall[:, 0] > GROWTH * fall[:, 1]) & (fall[:, 1] > GROWTH * fall[:, 2])
                & (fall[:, 0] > SHARE * np.abs(nearest).max(axis=1)))
    limits = np.where(nearest[:, 0] > nearest[:, 1], inf, -inf)
    if has_pole[rows].all():
        return limits
    doubtful = doubtful[~has_pole[doubtful]]
    near = (path.first if side > 0 else path.last) + side * np.arange(NEIGHBOURS)
    mode = sampler.linkage.mode_beyond(sampler.unit * end.x)
    other_mode = type(sampler)(sampler.linkage.in_mode(mode), sampler.quantities, sampler.rates)
    x = path.x[near]
    if path.cuts.size:              # all in the last piece, in the other mode too
        ends = np.array([*path.cuts, *np.array(
            other_mode.linkage.pieces.ends if other_mode.linkage.pieces else ()) / sampler.unit])
        away = np.abs(ends - end.x)
        farthest = np.abs(x - end.x).max()
        width = min(farthest, 0.5 * away[away > 0.0].min()) if away.any() else farthest
        # quantities are smooth in the root of the distance, of which these are equal steps
        x = end.x + side * width * ((np.arange(NEIGHBOURS) + 0.5) / NEIGHBOURS)**2
    here, beyond = (with_digits(of, x, of.values(x)) for of in (sampler, other_mode))
    bounded, is_coarse = _continued(sampler, here, beyond)
    if is_coarse[rows].any():       # what turns between samples and toggle shows nearer to it
        x = end.x + NEARER * (x - end.x)
        nearer, _ = _continued(sampler, *(with_digits(of, x, of.values(x))
                                          for of in (sampler, other_mode)))
        bounded = np.where(is_coarse, sampler.same_turn(bounded, nearer, np.arange(nearer.size)),
                           bounded)
    bounded[np.abs(bounded) <= 64.0 * EPS * np.abs(here).max(axis=1)] = 0.0
    return np.where(has_pole, limits, bounded)


def _continued(sampler: Sampler, here: Array, beyond: Array) -> tuple[Array, Array]:
    """Return the limits of quantities at a toggle, and which were extrapolated from one side."""
    # here, beyond: samples on the path and on that of the other assembly mode, each from the
    # toggle on, shape (quantities, 12). One polynomial through both sides is three digits better
    # than an extrapolation from one.
    every = np.arange(len(beyond))[:, None]
    one_sided = here @ _UP_TO
    # An angle in [0, pi] goes on as its negative.
    both = [(here + sampler.same_turn(here, sign * beyond, every)) @ _THROUGH
            for sign in (1.0, -1.0)]
    mirrored = sampler.is_angle & (np.abs(both[1] - one_sided) < np.abs(both[0] - one_sided))
    bounded = np.where(mirrored, both[1], both[0])
    # Quantities that do not go on, such as some angles in functions, are extrapolated, at the loss
    # of three digits.
    goes_on = np.abs(one_sided - bounded) <= 1e-6 * np.ptp(here, axis=1)
    return np.where(goes_on, bounded, one_sided), ~goes_on


def sampled_conditions(sampler: Sampler, x: Array, row: Array,
                       spacing: Array) -> tuple[Array, Array]:
    """Return the conditions of the input and of the relative value of n extrema, (n,)."""
    # They come from derivatives by the lengths beside each: see the top of this file. x: inputs of
    # the extrema; row: their quantities; spacing: distance of samples there. A change point has
    # none, as linkages of other lengths are none.
    turn = max(TURN, 4.0 * sampler.TURN) * spacing    # differences reach half as far
    around, rows = np.concatenate((x - turn, x, x + turn)), np.concatenate((row, row, row))
    (_, value, _), (before, _, after) = (
        part.reshape(3, -1) for part in sampler.value_and_slope(around, rows))
    by = sampler.by_lengths(around, rows).reshape(3, row.size, -1)
    with np.errstate(divide='ignore', invalid='ignore'):
        return (np.abs(by[2] - by[0]).sum(axis=1) / np.abs(after - before),
                np.abs(by[1]).sum(axis=1) / np.abs(value))
