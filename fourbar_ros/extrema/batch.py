# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration of many linkages at once.

Cranks that turn fully are searched together (:mod:`fourbar_ros.extrema.full_turns`); other
linkages and those in doubt one by one, as those with ties that only conditions decide.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import CONSTANT, Extremum, find_extrema, MAXIMUM
from fourbar_ros.extrema.full_turns import Phase, search_turns
from fourbar_ros.mechanisms.batches import order_of, range_of
from fourbar_ros.mechanisms.four_bars import FourBar
from fourbar_ros.mechanisms.loop import bilinear_factors, loop
from fourbar_ros.mechanisms.parts import CROSSED, OPEN
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.given import array, FASTEST
from fourbar_ros.numerics.number_types import NumberType
from fourbar_ros.numerics.tables import ARRAYS, run
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.numerics.write_arrays import keep_memory
import numpy as np
from numpy.typing import ArrayLike

RATES = 'omega4', 'alpha4'
# Linkages searched together: their samples stay in the cache. Samples of a turn; a larger number
# is for linkages that the smaller one does not resolve.
TOGETHER, SAMPLES = 1024, (48, 96, 192, 384)
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

    index: Array        # type: ignore[assignment]     # hides the method of tuples
    theta1: Array
    value: Array
    is_maximum: Array
    is_global: Array
    side: Array


def find_extrema_many(a1: ArrayLike, a2: ArrayLike, a3: ArrayLike, a4: ArrayLike,
                      mode: ArrayLike = OPEN, rate: ArrayLike = 1.0) -> dict[str, Extrema]:
    """
    Return all extrema of omega4 and alpha4 of many linkages at constant input rate.

    Those whose cranks turn fully take a hundredth of a millisecond, others milliseconds each.

    Parameters
    ----------
    a1, a2, a3, a4 : array_like
        Lengths [m]; broadcast. Linkages that cannot be assembled have no extrema.
    mode, rate : array_like
        Assembly mode (1 or 2) and input rate [rad/s], not zero.

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
    if not ((np.abs(rate) <= FASTEST) & (rate != 0.0)).all():
        raise InvalidParameter('rate', rate, f'must be at most {FASTEST:g} in size, not zero')
    if not ((mode == CROSSED) | (mode == OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    lengths = np.array((a1, a2, a3, a4), dtype=float)
    keep_memory()
    closes, turns = _closing(lengths)
    left = np.flatnonzero(turns)
    found: dict[str, list[Extrema]] = {name: [_columns(0, [])] for name in RATES}
    for count in SAMPLES:
        doubtful = [left[:0]]
        for start in range(0, left.size, TOGETHER):
            which = left[start:start + TOGETHER]
            is_doubtful, *both = _together(lengths[:, which], mode[which], rate[which], count)
            doubtful.append(which[is_doubtful])
            for name, part in zip(RATES, both):
                found[name].append(part._replace(index=which[part.index]))
        left = np.concatenate(doubtful)
    for index in np.concatenate((left, np.flatnonzero(closes & ~turns))).tolist():
        linkage = FourBar(*lengths[:, index].tolist()).in_mode(int(mode[index]))
        alone = find_extrema(linkage, RATES, float(rate[index]))
        for name in RATES:
            found[name].append(_columns(index, [one for one in alone if one.quantity == name]))
    return {name: _sorted(parts) for name, parts in found.items()}


def _sorted(parts: Sequence[Extrema]) -> Extrema:
    """Return extrema of one quantity, given in parts, by linkage and theta1."""
    whole = Extrema(*map(np.concatenate, zip(*parts)))
    order = np.argsort(8.0 * whole.index + whole.theta1, kind='stable')      # theta1 < 2 pi < 8
    return Extrema(*(column[order] for column in whole))


def _columns(index: int, extrema: list[Extremum]) -> Extrema:
    """Return the extrema of one quantity of one linkage as arrays."""
    largest = max([one.value for one in extrema], default=0.0)
    return Extrema(np.full(len(extrema), index), np.array([one.theta1 for one in extrema]),
                   np.array([one.value for one in extrema]),
                   np.array([one.kind == MAXIMUM or one.kind == CONSTANT and one.value == largest
                             for one in extrema], bool),
                   np.array([one.is_global for one in extrema], bool),
                   np.array([one.side for one in extrema], int))


def _closing(lengths: Array) -> tuple[Array, Array]:
    """Return which linkages can be assembled, and whose cranks turn fully, each of shape (n,)."""
    with np.errstate(all='ignore'):
        a1, a2, a3, a4 = lengths
        f = bilinear_factors(a1, a2, a3, a4, exact_sum_of_four)
        # each link shorter than the other three together
        closes = np.asarray((f.A2 > 0.0) & (f.B1 > 0.0) & (f.C2 > 0.0) & (f.D2 < 0.0)
                            & np.isfinite(lengths).all(axis=0) & (lengths > 0.0).all(axis=0))
        # neither stretched at theta1 = pi nor folded at 0
        return closes, np.asarray(closes & (f.A1 * f.B2 < 0.0) & (f.C1 * f.D1 > 0.0))


@cache
def _trace() -> Trace:
    """Return the trace of theta4' and theta4'', of lengths and of powers of the half angle."""
    def make_rates(n: NumberType, data: Sequence[Any]) -> Callable[..., Any]:
        def rates(*half_angle: Any) -> tuple[Any, Any]:
            at = loop(n, data[:4], data[4], *half_angle)
            return at.d_y, at.dd_y
        return rates

    return Trace(make_rates, 3, (1.0,) * 5)


def _together(lengths: Array, mode: Array, rate: Array,
              count: int) -> tuple[Array, Extrema, Extrema]:
    """
    Return which linkages are in doubt, and the extrema of both quantities of the others.

    The search is at 1 rad/s; values are then scaled by the rate (omega4) or its square (alpha4).
    """
    trace = _trace()
    _, once, each, done = order_of(trace, range_of(trace))
    # values by place in the trace; what needs no input is computed here, once
    known: list[Any] = [step.value for step in trace.steps]
    known[trace.count:trace.count + trace.size] = (
        *lengths[..., None], np.where(mode == OPEN, 1.0, -1.0)[:, None])
    with np.errstate(all='ignore'):
        run(trace, once, ARRAYS, known)
    per_linkage = [i for i in trace.used_constants if isinstance(known[i], np.ndarray)]

    def evaluate(x: Array, which: Array) -> Array:
        """Return both quantities at inputs of shape (m, any), real or complex, of some."""
        own = list(known)
        if which.size < mode.size:
            for i in per_linkage:
                own[i] = known[i][which]
        with np.errstate(all='ignore'):
            half = 0.5 * x
            sine, cosine = np.sin(half.real), np.cos(half.real)
            if np.iscomplexobj(half):       # a step so small that it is as a derivative
                tiny = 1j * half.imag
                sine, cosine = sine + tiny * cosine, cosine - tiny * sine
            own[:trace.count] = sine * sine, cosine * cosine, sine * cosine
            run(trace, each, ARRAYS, own, done)
        return np.stack([own[i] for i in flat(trace.results)])

    turns = search_turns(evaluate, mode.size, count, np.zeros(2, bool), _phase(lengths))
    is_doubtful, found = turns.is_doubtful, list[Extrema]()
    for order, (places, values) in enumerate(zip(turns.places, turns.values)):
        # a negative rate turns maxima of omega4 into minima, not those of alpha4
        with np.errstate(under='ignore'):
            values = values * (rate**(order + 1))[:, None]
        is_maximum, is_global, has_ties = _compared(values, turns.counts[order])
        is_doubtful = is_doubtful | has_ties
        row, k = np.nonzero(np.isfinite(places))
        inside = np.zeros(row.size, int)         # as ``side``: a full turn has no ends
        found.append(Extrema(row, places[row, k], values[row, k], is_maximum[row, k],
                             is_global[row, k], inside))
    omega, alpha = (Extrema(*(column[~is_doubtful[each.index]] for column in each))
                    for each in found)
    return is_doubtful, omega, alpha


def _phase(lengths: Array) -> Phase:
    """Return the phase for the complex inputs of both toggles, by the law of cosines."""
    a1, a2, a3, a4 = lengths
    inner, outer, low, high = (a2 - a3)**2, (a2 + a3)**2, (a1 - a4)**2, (a1 + a4)**2
    with np.errstate(all='ignore'):     # tanh of half the imaginary parts
        return Phase.of_toggles(np.sqrt((low - inner) / (high - inner)),
                                np.sqrt((outer - high) / (outer - low)))


def _compared(values: Array, counts: Array) -> tuple[Array, Array, Array]:
    """
    Return which extrema, in rows, are maxima, which are global, and which rows have ties.

    A tie is a value so near to the best one that conditions must tell whether it is global.
    """
    # maxima and minima alternate: a maximum is not below the next one
    after = (np.arange(values.shape[1]) + 1) % np.maximum(counts, 1)[:, None]
    is_maximum = values >= np.take_along_axis(values, after, axis=1)
    best = np.where(is_maximum, np.fmax.reduce(values, axis=1)[:, None],
                    np.fmin.reduce(values, axis=1)[:, None])
    beyond, size = np.abs(best - values), np.abs(best)
    is_global = beyond <= 64 * EPS * size
    return is_maximum, is_global, ((beyond <= NEARLY * size) & ~is_global).any(axis=1)
