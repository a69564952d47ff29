# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Proven bounds of the extreme values of quantities over a box of parameters: interval arithmetic.

With Q(x, p), x in a piece X of the input about c, and p in the box P about p0 with half-widths t,
Taylor's formula gives

    (B1)  Q(X, P) in Q(c, p0) + Q_x(X, P) (X - c) + sum Q_pi(X, P) [-t_i, t_i]
    (B2)  max over x of Q(x, p) >= Q(c, p0) - sum |Q_pi(c, P)| t_i      for any c, any p in P

in balls (Arb, by the optional package python-flint) that contain every rounding. Pieces are
halved where their bound is largest, until a piece adds little beside the box.

Numbers are duals of balls: the value q(p0) in the middle of the box, and enclosures of the
derivatives over the box; over the box

    (C1)  q(p) in q(p0) + sum q_i(P) [-t_i, t_i]

(the mean value form). Taken at every operation, it keeps what two operands have in common, which
ball arithmetic on the box itself would count twice (E. R. Hansen, A generalized interval
arithmetic, 1975).
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
import heapq
from math import inf, isfinite, isinf, nextafter, pi
from typing import Any, NamedTuple, TYPE_CHECKING, Union

from fourbar_ros.numerics.duals import Derivatives, derivatives_of, Dual, duals_of, value_of
from fourbar_ros.numerics.number_types import choose, Function, INFINITESIMAL, NumberType, Scalar
from fourbar_ros.numerics.tables import arb_settings
from fourbar_ros.scene.settings import ParameterValues

if TYPE_CHECKING:      # an optional package
    from flint import arb

PRECISION, INPUT = 80, 'input'      # [bit]; the input as a parameter
# A piece is small enough if it adds less than this, over what the box adds, and over the value.
SMALL, NOTHING = 0.02, 2.0**-40
# Halvings of pieces altogether, and of one.
MOST_PIECES, DEEPEST = 3000, 40
# Halvings of a piece about which nothing is known: the box reaches a toggle there.
HOPELESS = 8


class Enclosed(NamedTuple):
    """A quantity over a piece X of the input and the box P, as balls: the terms of (B1)."""

    middle: arb         # Q(c, p0)
    by_piece: arb       # |Q_x(X, P)| times half the width of X
    by_box: arb         # sum |Q_pi(X, P)| t_i


# (low, high) of a piece of the input -> for each quantity an Enclosed, or None: nothing is known
Evaluate = Callable[[float, float], Sequence[Union[Enclosed, None]]]
# (number type, {parameter: number}) -> function of the input that returns the quantities
Make = Callable[[NumberType, dict[str, Any]], Callable[[Dual], Sequence[Dual]]]
Reference = Union[Callable[[float], float], None]


class Bounds(NamedTuple):
    """Bounds of an extreme value over the box; infinite where nothing is known."""

    low: float
    high: float


def enclosing(make: Make, values: ParameterValues, widths: dict[str, float],
              references: Sequence[Reference]) -> Evaluate:
    """
    Return the function that encloses quantities over pieces of the input and a box.

    ``values`` is the middle of the box, {parameter: float or what else a scene has}; ``widths``
    {parameter: half the width of the box}. ``references`` has, for each quantity that is an angle,
    a function of the input, else None: the angle is taken within half a turn of that. ImportError
    if python-flint is not installed.
    """
    from flint import arb

    exact = {name: arb(value) if isinstance(value, float) and isfinite(value) else value
             for name, value in values.items()}
    radii = {name: arb(0, width) for name, width in widths.items()}

    def enclosed(quantity: Dual, x: float, reference: Reference) -> Enclosed | None:
        """Return the terms of (B1) of a quantity computed on a piece about x; None: infinite."""
        middle, by = value_of(quantity), dict(derivatives_of(quantity))
        by_piece = abs(by.pop(INPUT, arb(0)) * radii[INPUT])
        by_box = sum((abs(part * radii[name]) for name, part in by.items()), start=arb(0))
        if not (middle.is_finite() and by_piece.is_finite() and by_box.is_finite()):
            return None
        if reference is not None:
            middle += 2 * round((reference(x) - float(middle)) / (2.0 * pi)) * arb.pi()
        return Enclosed(middle, by_piece, by_box)

    def evaluate(low: float, high: float) -> Sequence[Enclosed | None]:
        """Return all quantities on a piece: the input is one more parameter of the box there."""
        try:
            with arb_settings(PRECISION, 1):
                ball = arb(low).union(arb(high))
                x = ball.mid()
                radii[INPUT] = ball - x
                centred, numbers = centred_on(radii)
                rows = make(numbers, exact | {name: centred(exact[name], {name: arb(1)})
                                              for name in widths})
                return [enclosed(quantity, float(x), reference) for quantity, reference
                        in zip(rows(centred(x, {INPUT: arb(1)})), references)]
        except (ValueError, ZeroDivisionError):     # a divisor may vanish
            return [None] * len(references)
    return evaluate


class Box:
    """
    Bounds of the extreme values of quantities of all mechanisms in a box.

    ``evaluate``: see :func:`enclosing`; ``pieces``: (low, high), which cover the input range.
    """

    def __init__(self, evaluate: Evaluate, pieces: Sequence[tuple[float, float]]) -> None:
        self._evaluate, self._pieces = evaluate, pieces
        self._known: dict[tuple[float, float], Sequence[Enclosed | None]] = {}

    def _enclosed(self, low: float, high: float, row: int) -> Enclosed | None:
        """Return quantity number ``row`` over a piece; all are computed at once, and kept."""
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
        """Return a lower bound, (B2), of the largest ``sign`` Q: the best bound at places."""
        known = [self._enclosed(x, x, row) for x in places]
        return max((nextafter(float((sign * one.middle - one.by_box).lower()), -inf)
                    for one in known if one is not None), default=-inf)

    def _largest(self, row: int, sign: int) -> float:
        """
        Return an upper bound of the largest ``sign`` Q, (B1); ``sign``: 1, or -1 for the least Q.

        Each piece of the input has a bound, and the largest of these holds for all. The piece that
        has it is halved until the input adds little to it beside the box, or halvings run out.
        """
        heap = [self._piece(low, high, row, sign) for low, high in self._pieces]
        heapq.heapify(heap)
        for _ in range(MOST_PIECES):
            worst = heap[0]
            if worst.is_fine or -worst.minus_depth > (HOPELESS if isinf(worst.minus_bound)
                                                      else DEEPEST):
                break
            middle, depth = 0.5 * (worst.low + worst.high), worst.minus_depth - 1
            heapq.heapreplace(heap, self._piece(worst.low, middle, row, sign, depth))
            heapq.heappush(heap, self._piece(middle, worst.high, row, sign, depth))
        return -heap[0].minus_bound

    def _piece(self, low: float, high: float, row: int, sign: int, minus_depth: int = 0) -> _Piece:
        """Return a piece with its bound of sign Q, infinite where nothing is known."""
        one = self._enclosed(low, high, row)
        if one is None:
            return _Piece(-inf, False, minus_depth, low, high)
        bound = nextafter(float((sign * one.middle + one.by_piece + one.by_box).upper()), inf)
        small = SMALL * float(one.by_box.upper()) + NOTHING * abs(float(one.middle))
        return _Piece(-bound, float(one.by_piece.upper()) <= small, minus_depth, low, high)


class _Piece(NamedTuple):
    """A piece of the input in a heap: largest bound first, then the most often halved."""

    minus_bound: float
    is_fine: bool       # it adds little beside the box
    minus_depth: int
    low: float
    high: float


def _ball(value: arb | float) -> arb:
    """Return a number as a ball: a formula may be asked of a constant of its own."""
    if not isinstance(value, (float, int)):
        return value
    from flint import arb

    return arb(value)


def _atan2(y: arb | float, x: arb | float) -> arb:
    from flint import arb

    return arb.atan2(_ball(y), _ball(x))


def _sqrt(value: arb | float) -> arb:
    return _ball(value).sqrt()


# Balls need no scaling. Choices are made in the middle of the box, between forms that are right.
BALLS = NumberType('balls', lambda v: _ball(v).sin(), lambda v: _ball(v).cos(), _sqrt, _atan2,
                   lambda x, y: _sqrt(x * x + y * y), abs, choose, sum, lambda *lengths: 1.0,
                   INFINITESIMAL)


class Centred(Dual):
    """
    A number over a box: its value in the middle, and balls that hold its derivatives everywhere.

    :func:`centred_on` gives subclasses their ``radii``.
    """

    __slots__ = ('_whole',)
    radii: dict[str, arb]

    def __init__(self, value: arb, by: Derivatives) -> None:
        super().__init__(value, by)
        self._whole: arb | None = None

    @property
    def whole(self) -> arb:
        """Return the ball of the values in the box, (C1)."""
        if self._whole is None:
            self._whole = self.value + sum((part * self.radii[name]
                                            for name, part in self.by.items()))
        return self._whole


def centred_on(radii: dict[str, arb]) -> tuple[type[Centred], NumberType]:
    """
    Return the class of numbers over a box, and their number type.

    ``radii``: {parameter: half the width of the box, as the ball 0 +- that}.
    """
    centred: type[Centred] = type('Centred', (Centred,), {'__slots__': (), 'radii': radii})
    numbers = duals_of(BALLS, centred)
    return centred, replace(numbers, hypot=_lipschitz(numbers.hypot, centred))


def _lipschitz(hypot: Function, centred: type[Centred]) -> Function:
    """
    Return ``hypot`` over a box in which x and y may vanish, as those of a force that reverses.

    At zero it has no derivative, but changes by no more than (x, y) does: its derivative by p is
    taken as [-1, 1] |(x_p, y_p)|.
    """
    def call(x: Scalar, y: Scalar) -> Centred:
        """Return sqrt(x^2 + y^2); only where a derivative is infinite, by the bound above."""
        size: Centred = hypot(x, y)
        if all(part.is_finite() for part in size.by.values()):
            return size
        by_x, by_y = derivatives_of(x), derivatives_of(y)
        minus_one_to_one = _ball(0.0).union(_ball(1.0)) * 2.0 - 1.0
        return centred(size.value, {name: minus_one_to_one * BALLS.hypot(*[
            abs(_ball(by.get(name, 0.0))).upper() for by in (by_x, by_y)]) for name in size.by})
    return call
