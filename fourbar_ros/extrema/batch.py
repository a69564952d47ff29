# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration of many linkages at once.

:mod:`fourbar_ros.extrema.four_bar_rates.search` on arrays.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.extrema.four_bar_rates.batch_search import Rows, search_chunk
from fourbar_ros.extrema.methods import RATES
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.given import array
from fourbar_ros.numerics.roots import EPS, fold
import numpy as np

# Linkages searched at a time, at most 2^16.
CHUNK = 16384
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


NOTHING = Extrema(np.zeros(0, int), np.zeros(0), np.zeros(0), np.zeros(0, bool),
                  np.zeros(0, bool), np.zeros(0, int))


def find_extrema_many(a1: Values, a2: Values, a3: Values, a4: Values, mode: Values = OPEN,
                      rate: Values = 1.0, progress: Callable[[float], object] | None = None
                      ) -> dict[str, Extrema]:
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
    if not ((mode == CROSSED) | (mode == OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    lengths = np.array((a1, a2, a3, a4), dtype=float)
    sign = np.where(mode == OPEN, 1.0, -1.0)
    parts = {name: [NOTHING] for name in RATES}
    for start in range(0, sign.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        found = search_chunk(lengths[:, chunk], sign[chunk], rate[chunk])
        for name, rows in zip(RATES, found):
            part, in_doubt = _collected(rows)
            _decide_ties(name, part, in_doubt, lengths[:, chunk], mode[chunk], rate[chunk])
            parts[name].append(part._replace(index=part.index + start))
        if progress is not None:
            progress(min(start + CHUNK, sign.size) / sign.size)
    return {name: Extrema(*map(np.concatenate, zip(*found_there)))
            for name, found_there in parts.items()}


def _collected(rows: Rows) -> tuple[Extrema, Array]:
    """
    Return :class:`Extrema` of lists of arrays, sorted, the global ones marked.

    Also return the linkages of which others may be global too, as far as their conditions tell.
    """
    if not rows:
        return NOTHING, NOTHING.index
    index, theta1, *others = (np.concatenate(arrays) for arrays in zip(*rows))
    theta1 = fold(theta1)
    order = _order(index, theta1)
    index, theta1, value, is_maximum, side = (v[order] for v in (index, theta1, *others))
    best = _best(index, value, is_maximum)
    with np.errstate(invalid='ignore'):
        beyond, size = np.abs(best - value), np.where(np.isfinite(best), np.abs(best), np.nan)
        is_global = (value == best) | (beyond <= 64 * EPS * size)
        is_near = ~is_global & (beyond <= NEARLY * size)
    return (Extrema(index, theta1, value, is_maximum, is_global, side), np.unique(index[is_near]))


def _order(index: Array, theta1: Array) -> Array:
    """
    Return the order by index, then theta1.

    Two stable sorts of 16 bits, which numpy does digit by digit, leave only neighbours in theta1
    to be sorted by comparison.
    """
    steps = (theta1 * (2**16 / 6.5)).astype(np.uint16)
    order = np.argsort(steps, kind='stable')
    order = order[np.argsort(index[order].astype(np.uint16), kind='stable')]
    i, x = index[order], theta1[order]
    if ((i[1:] == i[:-1]) & (x[1:] < x[:-1])).any():
        return np.lexsort((theta1, index))
    return order


def _best(index: Array, value: Array, is_maximum: Array) -> Array:
    """Return for each row the largest value of its linkage if it is a maximum, else the least."""
    if not index.size:
        return value
    is_first = np.append(True, index[1:] != index[:-1])
    first, linkage = np.nonzero(is_first)[0], np.cumsum(is_first) - 1
    low, high = (extreme.reduceat(value, first) for extreme in (np.minimum, np.maximum))
    return np.where(is_maximum, high[linkage], low[linkage])


def _decide_ties(name: str, part: Extrema, in_doubt: Array, lengths: Array, mode: Array,
                 rate: Array) -> None:
    """Mark as global, where conditions decide, the extrema that a single linkage has."""
    for j in in_doubt.tolist():
        a1, a2, a3, a4 = lengths[:, j].tolist()
        alone = find_extrema(FourBar(a1, a2, a3, a4, int(mode[j])), name, float(rate[j]))
        rows = np.nonzero(part.index == j)[0]
        if rows.size == len(alone):
            part.is_global[rows] = [extremum.is_global for extremum in alone]
