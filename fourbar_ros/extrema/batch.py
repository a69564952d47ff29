# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration of many linkages at once.

The search of :mod:`fourbar_ros.extrema.four_bar_rates.search`, in chunks; exact change points and
ties that only conditions decide are searched one by one.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import CONSTANT, find_extrema, MAXIMUM
from fourbar_ros.extrema.four_bar_rates.search import at_rate, Linkages, search
from fourbar_ros.extrema.methods import RATES
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.given import array, FASTEST
from fourbar_ros.numerics.roots import fold, order_in_rows
import numpy as np
from numpy.typing import ArrayLike

# Linkages searched at a time: bounds the memory; progress is told between chunks.
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


def find_extrema_many(a1: ArrayLike, a2: ArrayLike, a3: ArrayLike, a4: ArrayLike,
                      mode: ArrayLike = OPEN, rate: ArrayLike = 1.0,
                      progress: Callable[[float], object] | None = None
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
    if not ((np.abs(rate) <= FASTEST) & (rate != 0.0)).all():
        raise InvalidParameter('rate', rate, f'must be at most {FASTEST:g} in size, not zero')
    if not ((mode == CROSSED) | (mode == OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    lengths = np.array((a1, a2, a3, a4), dtype=float)
    sign = np.where(mode == OPEN, 1.0, -1.0)
    parts = {name: [NOTHING] for name in RATES}
    for start in range(0, sign.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        of_chunk = lengths[:, chunk], mode[chunk], rate[chunk]
        linkages = Linkages.of(lengths[:, chunk], sign[chunk])
        flat = _at_change_points(np.nonzero(linkages.is_flat)[0].tolist(), *of_chunk)
        for order, (name, unit) in enumerate(zip(RATES, search(linkages))):
            scaled = (unit.row, unit.theta1, *at_rate(unit, rate[chunk][unit.row], order),
                      unit.side)
            part, in_doubt = _collected(scaled, flat[name])
            _decide_ties(name, part, in_doubt, *of_chunk)
            parts[name].append(part._replace(index=part.index + start))
        if progress is not None:
            progress(min(start + CHUNK, sign.size) / sign.size)
    return {name: Extrema(*map(np.concatenate, zip(*chunks))) for name, chunks in parts.items()}


Columns = tuple[Array, ...]     # index, theta1, value, is_maximum, side


def _at_change_points(indices: list[int], lengths: Array, mode: Array,
                      rate: Array) -> dict[str, list[Columns]]:
    """
    Return {quantity: columns of each linkage} of the linkages at exact change points.

    One by one by :func:`find_extrema`, as they are few: one-sided values need series.
    """
    rows: dict[str, list[Columns]] = {name: [] for name in RATES}
    for index in indices:
        a1, a2, a3, a4 = lengths[:, index].tolist()
        linkage = FourBar(a1, a2, a3, a4, int(mode[index]))
        found = find_extrema(linkage, RATES, float(rate[index]))
        for name in RATES:
            extrema = [e for e in found if e.quantity == name]
            largest = max([e.value for e in extrema], default=0.0)
            rows[name].append((
                np.full(len(extrema), index), np.array([e.theta1 for e in extrema]),
                np.array([e.value for e in extrema]),
                np.array([e.kind == MAXIMUM or e.kind == CONSTANT and e.value == largest
                          for e in extrema], bool),
                np.array([e.side for e in extrema], int)))
    return rows


def _collected(found: Columns, others: list[Columns]) -> tuple[Extrema, Array]:
    """
    Return :class:`Extrema` of columns, sorted by linkage and theta1, the global ones marked.

    Also the linkages with a nearly global extremum, which may be global within its condition.
    """
    index, theta1, *rest = (np.concatenate(arrays) for arrays in zip(found, *others))
    theta1 = fold(theta1)
    order = order_in_rows(index, theta1)
    index, theta1, value, is_maximum, side = (v[order] for v in (index, theta1, *rest))
    best = _best(index, value, is_maximum)
    with np.errstate(invalid='ignore'):
        beyond, size = np.abs(best - value), np.where(np.isfinite(best), np.abs(best), np.nan)
        is_global = (value == best) | (beyond <= 64 * EPS * size)
        is_near = ~is_global & (beyond <= NEARLY * size)
    return (Extrema(index, theta1, value, is_maximum, is_global, side), np.unique(index[is_near]))


def _best(index: Array, value: Array, is_maximum: Array) -> Array:
    """
    Return, for each maximum, the largest value of its linkage; for each minimum the least.

    ``index`` is sorted. For a maximum 3, a minimum 1 and a maximum 2 of one linkage: 3, 1 and 3.
    """
    if not index.size:
        return value
    is_first = np.append(True, index[1:] != index[:-1])
    first, linkage = np.nonzero(is_first)[0], np.cumsum(is_first) - 1
    low, high = (extreme.reduceat(value, first) for extreme in (np.minimum, np.maximum))
    return np.where(is_maximum, high[linkage], low[linkage])


def _decide_ties(name: str, part: Extrema, in_doubt: Array, lengths: Array, mode: Array,
                 rate: Array) -> None:
    """Mark in ``part`` the global extrema of linkages in doubt, as a single search finds them."""
    for j in in_doubt.tolist():
        a1, a2, a3, a4 = lengths[:, j].tolist()
        alone = find_extrema(FourBar(a1, a2, a3, a4, int(mode[j])), name, float(rate[j]))
        rows = np.nonzero(part.index == j)[0]
        if rows.size == len(alone):
            part.is_global[rows] = [extremum.is_global for extremum in alone]
