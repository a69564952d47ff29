# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Proof that a quantity has no other extrema than those found: interval branch and bound.

The formulas of motion and loads are evaluated once more, in ball arithmetic (Arb, by the optional
package python-flint) on power series in theta1. Taylor's formula, with coefficients at the middle
of a piece of the input range and the last one over the whole piece, then encloses dQ/dtheta1 and
d2Q/dtheta1^2. A piece over which the first cannot vanish has no extremum; one over which the
second cannot vanish has one if the first changes sign from end to end, and none otherwise; others
are halved.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fourbar_ros.extrema.input_paths import InputPath
from fourbar_ros.extrema.sampling import NoLoads
from fourbar_ros.numerics.enclosures import (
    ENCLOSURE,
    ENCLOSURE_WITH_ANGLES,
    Series,
    squared_or_plain,
)
from fourbar_ros.numerics.number_types import converted, Function

PRECISION = 80        # [bit]
ORDER = 6             # of Taylor's formula
MOST_PIECES = 10000   # then it gives up: some seconds


def count_extrema(sampler: Any, path: InputPath, check: Callable[[], None] = lambda: None) -> Any:
    """
    Return how many extrema each quantity of a sampler certainly has between the samples of a path.

    Parameters
    ----------
    sampler : .sampling.Sampler
    path : .input_paths.InputPath
    check : callable
        Called before every piece; what it raises ends the count.

    Returns
    -------
    list of (int or None)
        None: not decided within the number of pieces allowed.

    Raises
    ------
    ImportError
        python-flint is not installed.
    TypeError, AttributeError
        A user's function cannot be evaluated on enclosures.

    """
    import flint

    precision, cap = flint.ctx.prec, flint.ctx.cap
    flint.ctx.prec, flint.ctx.cap = PRECISION, ORDER + 1
    try:
        return _count(_evaluator(sampler, flint), _pieces(path, flint.arb),
                      len(sampler.quantities),
                      check)
    finally:
        flint.ctx.prec, flint.ctx.cap = precision, cap


def _evaluator(sampler: Any, flint: Any) -> Function:
    """Return (ball of theta1, rows) -> enclosures of dQ/dtheta1 and half d2Q/dtheta1^2."""
    linkage = sampler.linkage
    numbers = ENCLOSURE_WITH_ANGLES if sampler.with_angles else ENCLOSURE
    constants = converted(linkage.constants, flint.arb)
    motion = linkage.motion_formula(numbers, constants)
    loads = linkage.bodies and linkage.loads_formula(numbers, constants)
    unit = flint.arb(sampler.unit)
    rates = [flint.arb(rate) for rate in sampler.rates]
    unknown = [flint.arb('nan')] * (ORDER + 1)

    def coefficients(ball: Any, rows: Any) -> Any:
        """Return the Taylor coefficients of quantities ``rows`` about any point of the ball."""
        try:
            fields = motion(Series(flint.arb_series([unit * ball, unit])), *rates)
            state = linkage.MOTION(*fields), linkage.LOADS(*loads(fields)) if loads else NoLoads()
            values = [squared_or_plain(sampler.quantities[row].of(*state)) for row in rows]
        except ValueError:                   # a divisor may vanish: nothing is known
            return [unknown] * len(rows)
        return [[value[i] for i in range(ORDER + 1)] for value in values]
    return coefficients


def _pieces(path: InputPath, arb: Any) -> Any:
    """Return the pieces (low, high) between samples as balls of little or no width."""
    x = path.x.tolist()
    points = [arb(v) if v >= x[0] else arb(v) + 2 * arb.pi() for v in x]
    if path.is_closed:
        points.append(points[0] + 2 * arb.pi())
    return list(zip(points, points[1:]))


def _slopes(at_middle: Any, over_piece: Any, offset: Any) -> Any:
    """Return enclosures of the first and second derivative from Taylor coefficients."""
    slope = curvature = 0
    for i in range(ORDER, 0, -1):
        coefficient = over_piece[i] if i == ORDER else at_middle[i]
        slope = slope * offset + i * coefficient
        if i > 1:
            curvature = curvature * offset + i * (i - 1) * coefficient
    return slope, curvature


def _count(coefficients: Function, pieces: Any, size: int, check: Callable[[], None]) -> Any:
    """
    Return the number of sign changes of dQ/dtheta1 in all pieces, for each row.

    None if not decided.
    """
    counts, work, done = [0] * size, [(*piece, tuple(range(size)))
                                      for piece in reversed(pieces)], 0
    while work:
        check()
        low, high, rows = work.pop()
        whole = low.union(high)
        middle = whole.mid()
        undecided: list[int] = []
        monotone: list[int] = []
        for row, one, all_of_it in zip(rows, coefficients(middle, rows),
                                       coefficients(whole, rows)):
            slope, curvature = _slopes(one, all_of_it, whole - middle)
            if slope.contains(0):
                (undecided if curvature.contains(0) else monotone).append(row)
        if monotone:
            for row, before, after in zip(monotone, coefficients(low, monotone),
                                          coefficients(high, monotone)):
                if before[1].contains(0) or after[1].contains(0):
                    undecided.append(row)
                elif (before[1] > 0) is not (after[1] > 0):
                    counts[row] += 1
        done += 1
        if undecided:
            work += [(middle, high, undecided), (low, middle, undecided)]
        if done > MOST_PIECES:
            break
    open_rows = {row for *_, rows in work for row in rows}
    return [None if row in open_rows else count for row, count in enumerate(counts)]
