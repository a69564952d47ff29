# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Proven bounds of the extreme values of quantities over a box of parameters: interval arithmetic.

With Q(x, p), x in a piece X of the input about c, and p in the box P about p0 with half-widths t,
Taylor's formula gives

    (B1)  Q(X, P) in Q(c, p0) + Q_x(X, P) (X - c) + sum Q_pi(X, P) [-t_i, t_i]
    (B2)  max over x of Q(x, p) >= Q(c, p0) - sum |Q_pi(c, P)| t_i      for any c, any p in P

in balls (Arb, by python-flint) that contain every rounding. Pieces are halved where their bound is
largest, until what the piece adds is small beside what the box adds.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
import heapq
from math import inf, isfinite, isinf, nextafter, pi
from typing import Any, NamedTuple, Union

from fourbar_ros.numerics.centred import centred_on
from fourbar_ros.numerics.duals import derivatives_of, value_of
from fourbar_ros.numerics.number_types import NumberType

PRECISION, INPUT = 80, 'input'      # [bit]; the input as a parameter
# What a piece may add, over what the box adds and over the value; how often pieces are halved.
SMALL, NOTHING, MOST_PIECES, DEEPEST = 0.02, 2.0**-40, 3000, 40
# Halvings of a piece of which nothing is known: the box reaches a toggle there.
HOPELESS = 8


class Enclosed(NamedTuple):
    """
    A quantity over a piece of the input and the box, as balls.

    Parameters
    ----------
    middle
        Q(c, p0).
    by_piece, by_box
        |Q_x(X, P)| times half the width of X; the sum of |Q_pi(X, P)| t_i.

    """

    middle: Any
    by_piece: Any
    by_box: Any


# (low, high) of a piece of the input -> for each quantity an Enclosed, or None: nothing is known
Evaluate = Callable[[float, float], Sequence[Union[Enclosed, None]]]
# (number type, {parameter: number}) -> function of the input that returns the quantities
Make = Callable[[NumberType, dict[str, Any]], Callable[[Any], Sequence[Any]]]
Reference = Union[Callable[[float], float], None]


class Bounds(NamedTuple):
    """Bounds of an extreme value over the box; infinite where nothing is known."""

    low: float
    high: float


def enclosing(make: Make, values: dict[str, Any], widths: dict[str, float],
              references: Sequence[Reference]) -> Evaluate:
    """
    Return the function that encloses quantities over pieces of the input and a box.

    Parameters
    ----------
    make : callable
    values : dict
        {parameter: float}, others may be anything: the middle of the box.
    widths : dict
        {parameter: half the width of the box}.
    references : sequence
        For each quantity None, or of an angle a function of the input: it is taken within half a
        turn of that.

    Raises
    ------
    ImportError
        python-flint is not installed.

    """
    import flint

    arb, context = flint.arb, flint.ctx
    exact = {name: arb(value) if isinstance(value, float) and isfinite(value) else value
             for name, value in values.items()}
    radii = {name: arb(0, width) for name, width in widths.items()}

    def enclosed(whole: Any, x: float, reference: Reference) -> Enclosed | None:
        middle, by = value_of(whole), dict(derivatives_of(whole))
        by_piece = abs(by.pop(INPUT, arb(0)) * radii[INPUT])
        by_box = sum((abs(part * radii[name]) for name, part in by.items()), start=arb(0))
        if not (middle.is_finite() and by_piece.is_finite() and by_box.is_finite()):
            return None
        if reference is not None:
            middle += 2 * round((reference(x) - float(middle)) / (2.0 * pi)) * arb.pi()
        return Enclosed(middle, by_piece, by_box)

    def evaluate(low: float, high: float) -> Sequence[Enclosed | None]:
        precision, context.prec = context.prec, PRECISION
        try:
            ball = arb(low).union(arb(high))
            x = ball.mid()
            radii[INPUT] = ball - x
            centred, numbers = centred_on(radii)
            rows = make(numbers, exact | {name: centred(exact[name], {name: arb(1)})
                                          for name in widths})
            return [enclosed(whole, float(x), reference) for whole, reference
                    in zip(rows(centred(x, {INPUT: arb(1)})), references)]
        except (ValueError, ZeroDivisionError):     # a divisor may vanish
            return [None] * len(references)
        finally:
            context.prec = precision
    return evaluate


class Box:
    """
    Bounds of the extreme values of quantities of all mechanisms in a box.

    Parameters
    ----------
    evaluate : callable
        See :func:`enclosing`.
    pieces : sequence of (low, high)
        That cover the input range.

    """

    def __init__(self, evaluate: Evaluate, pieces: Sequence[tuple[float, float]]) -> None:
        self._evaluate, self._pieces = evaluate, pieces
        self._known: dict[tuple[float, float], Sequence[Enclosed | None]] = {}

    def _at(self, low: float, high: float, row: int) -> Enclosed | None:
        if (low, high) not in self._known:
            self._known[low, high] = self._evaluate(low, high)
        return self._known[low, high][row]

    def most(self, row: int, places: Sequence[float]) -> Bounds:
        """Return bounds of the largest value of quantity ``row``; ``places``: where to look."""
        return Bounds(self._least_maximum(row, places, 1), self._largest(row, 1))

    def least(self, row: int, places: Sequence[float]) -> Bounds:
        """Return bounds of the least value of quantity ``row``."""
        return Bounds(-self._largest(row, -1), -self._least_maximum(row, places, -1))

    def _least_maximum(self, row: int, places: Sequence[float], sign: int) -> float:
        """Return a lower bound of the largest sign Q, (B2)."""
        known = [self._at(x, x, row) for x in places]
        return max((nextafter(float((sign * one.middle - one.by_box).lower()), -inf)
                    for one in known if one is not None), default=-inf)

    def _largest(self, row: int, sign: int) -> float:
        """Return an upper bound of the largest sign Q, (B1)."""
        work = [self._bounded(low, high, row, sign) for low, high in self._pieces]
        heapq.heapify(work)
        for _ in range(MOST_PIECES):
            bound, is_fine, depth, low, high = work[0]
            if is_fine or -depth > (HOPELESS if isinf(bound) else DEEPEST):
                break
            middle = 0.5 * (low + high)
            heapq.heapreplace(work, self._bounded(low, middle, row, sign, depth - 1))
            heapq.heappush(work, self._bounded(middle, high, row, sign, depth - 1))
        return -work[0][0]

    def _bounded(self, low: float, high: float, row: int, sign: int,
                 depth: int = 0) -> tuple[float, bool, int, float, float]:
        """
        Return minus the bound of a piece, whether it is good enough, minus its depth, its ends.

        In this order: of pieces of which nothing is known the smallest comes first.
        """
        one = self._at(low, high, row)
        if one is None:
            return -inf, False, depth, low, high
        bound = nextafter(float((sign * one.middle + one.by_piece + one.by_box).upper()), inf)
        small = SMALL * float(one.by_box.upper()) + NOTHING * abs(float(one.middle))
        return -bound, float(one.by_piece.upper()) <= small, depth, low, high
