# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration of many linkages at once.

:mod:`fourbar_ros.extrema.four_bar_rates.search` on arrays.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.extrema.four_bar_rates.batch_search import Rows, search_chunk
from fourbar_ros.extrema.methods import RATES
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.given import array
from fourbar_ros.numerics.roots import EPS
import numpy as np

# Linkages taken at a time: their samples stay in the cache.
CHUNK = 4096
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
    if not np.isin(mode, (CROSSED, OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    lengths = np.array((a1, a2, a3, a4), dtype=float)
    sign = np.where(mode == OPEN, 1.0, -1.0)
    parts: tuple[Rows, Rows] = [], []
    for start in range(0, sign.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        found_here = search_chunk(lengths[:, chunk], sign[chunk], rate[chunk])
        for quantity, rows in zip(parts, found_here):
            quantity += [(index + start, *others) for index, *others in rows]
        if progress is not None:
            progress(min(start + CHUNK, sign.size) / sign.size)
    found = {name: _collect(rows) for name, rows in zip(RATES, parts)}
    for name, part in found.items():
        _decide_ties(name, part, lengths, mode, rate)
    return found


def _decide_ties(name: str, part: Extrema, lengths: Array, mode: Array, rate: Array) -> None:
    """Mark as global, where conditions decide, the extrema that a single linkage has."""
    low, high = _of_each(np.minimum, part), _of_each(np.maximum, part)
    with np.errstate(invalid='ignore'):
        best = np.where(part.is_maximum, high, low)
        near = ~part.is_global & np.isfinite(best) & (np.abs(part.value - best)
                                                      <= NEARLY * np.abs(best))
    for j in np.unique(part.index[near]).tolist():
        a1, a2, a3, a4 = lengths[:, j].tolist()
        alone = find_extrema(FourBar(a1, a2, a3, a4, int(mode[j])), name, float(rate[j]))
        rows = np.nonzero(part.index == j)[0]
        if rows.size == len(alone):
            part.is_global[rows] = [extremum.is_global for extremum in alone]


def _of_each(extreme: Any, part: Extrema) -> Array:
    """Return the extreme value of the linkage of each row."""
    if not part.index.size:
        return part.value
    first = np.nonzero(np.concatenate(([True], part.index[1:] != part.index[:-1])))[0]
    return np.repeat(extreme.reduceat(part.value, first),
                     np.diff(np.append(first, part.index.size)))


def _collect(rows: Rows) -> Extrema:
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
