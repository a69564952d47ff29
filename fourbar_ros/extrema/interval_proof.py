# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Proof that quantities have no other extrema than those found: branch and bound with Taylor models.

The formulas of motion and loads are evaluated once more, on
:mod:`~fourbar_ros.numerics.taylor_models`, for all pieces between samples at once. For each
quantity they give a polynomial and a bound of its error over a piece, and so of its derivatives.
Where the first derivative cannot vanish there is no extremum. Where the second cannot vanish there
is one if the first changes sign from end to end, else none. Other parts are halved, which needs
the polynomial alone. Pieces whose error leaves parts open are cut and evaluated again.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import comb, perm, pi
from time import thread_time
from typing import NamedTuple

from fourbar_ros.extrema.input_paths import InputPath
from fourbar_ros.extrema.sampling import Sampler, State
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import converted
from fourbar_ros.numerics.taylor_models import (
    constant,
    inputs,
    model,
    ORDER,
    REACH,
    Root,
    TAYLOR_MODELS,
    UNIT,
)
import numpy as np

SECONDS, MOST_PIECES = 5.0, 100_000    # [s] of a processor, for each quantity; for all together
BATCH, HALVINGS = 256, 8               # pieces at a time; of a piece, by its polynomial
# Where pieces are cut, and halved: at odd places, as extrema like the middle.
CUTS, CUT = np.array((0.0, 0.24, 0.51, 0.77, 1.0)), -0.125
NARROWEST = 2.0**-44
WIDEST = 2.0**-20                      # how well places are known at least, in the input's unit
# By how much pieces overlap, in their half widths and over x: more than by rounding.
SLACK, SLACK_OF_X = 2.0**-38, 2.0**-46
# Bounds of the derivatives of the error by (x - middle) / half the width, over the error.
_FIRST, _SECOND = [max(perm(k, order) * REACH**-k for k in range(40)) for order in (1, 2)]
DIGITS = 4 * HALVINGS * (ORDER + 4) * UNIT     # more than all substitutions round
_K = np.arange(1.0, ORDER + 1)


class Part(NamedTuple):
    """
    A part of the input range with exactly one extremum of a quantity.

    The quantity (of a root its square) is a Taylor model of t = (x - middle) / radius.
    """

    low: float           # inputs, in the mechanism's unit
    high: float
    sense: int           # +1 maximum, -1 minimum
    middle: float        # of the piece in which the part lies
    radius: float
    c: Array             # coefficients of the Taylor model
    error: float         # and its error
    is_square: bool

    @property
    def slope_error(self) -> float:
        """Return a bound of the error of the derivative by t."""
        return REACH * _FIRST * self.error + DIGITS * float(np.abs(self.c) @ np.arange(ORDER + 1))


class Parts(NamedTuple):
    """All extrema of a quantity on a path."""

    parts: list[Part]
    why_not: str         # why they may not be all; empty if they are
    largest: float       # size of the values, of a root of its squares


class Enclosure(NamedTuple):
    """Quantities (of roots their squares) over pieces: (quantities, n, ORDER + 1), and errors."""

    c: Array
    error: Array
    middle: Array
    radius: Array


class Evaluator:
    """
    Computes enclosures of some quantities of a sampler over pieces of the input.

    ``why_not``: {row: why a function cannot be enclosed}. ``squares``: rows of roots, such as
    magnitudes of forces: their squares are enclosed.
    """

    def __init__(self, sampler: Sampler) -> None:
        """Make the formulas of the mechanism for Taylor models."""
        linkage = sampler.linkage
        constants = converted(linkage.constants, constant)
        self._motion = linkage.motion_formula(TAYLOR_MODELS, constants)
        self._loads = linkage.bodies and linkage.loads_formula(TAYLOR_MODELS, constants)
        self._sampler, self._rates = sampler, [constant(rate) for rate in sampler.rates]
        self.why_not: dict[int, str] = {}
        self.squares: set[int] = set()

    def __call__(self, low: Array, high: Array, rows: Sequence[int]) -> Enclosure:
        """Return the enclosures over pieces [low, high]; not finite where nothing is known."""
        linkage = self._sampler.linkage
        with np.errstate(all='ignore'):
            x, radius = inputs(low, high)
            fields = self._motion(self._sampler.unit * x, *self._rates)
            state = (linkage.MOTION(*fields),
                     linkage.LOADS(*self._loads(fields)) if self._loads else NoLoads())
            enclosure = Enclosure(np.full((len(rows), low.size, ORDER + 1), np.nan),
                                  np.full((len(rows), low.size), np.inf), x.c[0], radius)
            for i, row in enumerate(rows):
                self._fill(enclosure, i, row, state)
        return enclosure

    def _fill(self, enclosure: Enclosure, i: int, row: int, state: State) -> None:
        """Write quantity ``row`` as number i into an enclosure, or note why it cannot be."""
        try:
            value = model(self._sampler.quantities[row].of(*state))
        except (TypeError, AttributeError) as error:
            self.why_not[row] = f'the function does not work on enclosures ({error})'
            return
        if isinstance(value, Root):
            value = value.square
            self.squares.add(row)
        enclosure.c[i] = 0.0
        enclosure.c[i, :, :len(value.c)] = value.c.T
        enclosure.error[i] = value.error


def find_parts(sampler: Sampler, rows: Sequence[int], path: InputPath,
               check: Callable[[float], None] = lambda share: None,
               seconds: float = SECONDS) -> list[Parts]:
    """
    Return where the quantities ``rows`` of a sampler have their extrema on a path, with proof.

    ``check``: called every 0.1 s or so with the share of the path that is decided; an exception
    from it ends the search. ``seconds``: of a processor, for each quantity; parts still open then
    are not proved.
    """
    return _Search(sampler, rows, path).run(check, seconds * len(rows))


class _Pieces(NamedTuple):
    """n pieces of a path not yet evaluated."""

    low: Array          # (n,)
    high: Array
    is_open: Array      # (quantities, n): which quantities are to be decided
    error: Array        # (quantities, n): error over the piece that this one was cut from

    def of(self, which: Array | np.bool_ | slice) -> _Pieces:
        """Return some of the pieces, by mask or slice."""
        return _Pieces(*(part[..., which] for part in self))

    def cut(self) -> _Pieces:
        """Return the pieces, each cut in four at :data:`CUTS`."""
        edges = self.low + CUTS[:, None] * (self.high - self.low)
        edges[-1] = self.high
        count = len(CUTS) - 1
        return _Pieces(edges[:-1].ravel(), edges[1:].ravel(), np.tile(self.is_open, count),
                       np.tile(self.error, count))


class _Search:
    """Branch and bound for some quantities of a sampler on one path."""

    def __init__(self, sampler: Sampler, rows: Sequence[int], path: InputPath) -> None:
        """Begin with the pieces between samples, all quantities open on each."""
        self._evaluate, self._rows = Evaluator(sampler), list(rows)
        self._name, self._unit = sampler.linkage.input_coordinate.position, sampler.unit
        # of each quantity: its extrema, its largest size, why it is given up ('': it is not)
        self._found: list[list[Part]] = [[] for _ in rows]
        self._largest, self._why_not = np.zeros(len(rows)), [''] * len(rows)
        low, high = _ends(path)
        self._pieces = _Pieces(low, high, np.ones((len(rows), low.size), bool),
                               np.full((len(rows), low.size), np.inf))

    def run(self, check: Callable[[float], None], seconds: float) -> list[Parts]:
        """
        Return the extrema of each quantity: evaluate and cut until all pieces are decided.

        ``check`` is told which part of the path is decided, 0 to 1. After ``seconds`` of
        computing, pieces that are left are given up with the reason.
        """
        total, begin, count = self._width(), thread_time(), 0
        while self._pieces.low.size:
            check(1.0 - self._width() / total)
            if count > MOST_PIECES or thread_time() - begin > seconds:
                why = (f'more than {MOST_PIECES} pieces' if count > MOST_PIECES
                       else f'not decided in {seconds:g} s')
                self._leave(self._pieces, why)
                break
            count += min(BATCH, self._pieces.low.size)
            self._evaluate_some()
        check(1.0)
        return [Parts(*of_one) for of_one in zip(self._found, self._why_not,
                                                 self._largest.tolist())]

    def _width(self) -> float:
        return float((self._pieces.high - self._pieces.low).sum())

    def _evaluate_some(self) -> None:
        """
        Evaluate the next 256 pieces, keep their extrema, and cut the parts left open.

        A quantity is given up, with the reason, where cutting does not make its error smaller.
        """
        some, later = self._pieces.of(slice(BATCH)), self._pieces.of(slice(BATCH, None))
        which = np.nonzero(some.is_open.any(axis=1))[0]
        over = self._evaluate(some.low, some.high, [self._rows[i] for i in which])
        self._largest[which] = np.fmax(self._largest[which], np.abs(over.c[..., 0]).max(axis=1))
        i, j = np.nonzero(some.is_open[which])      # quantity and piece of each function to decide
        c, error, half = over.c[i, j], over.error[i, j], over.radius / REACH
        stays, extrema = _parts_of(c, error, (SLACK + SLACK_OF_X * np.abs(over.middle) / half)[j],
                                   (WIDEST / half)[j])
        for k, a, b, sense in zip(*(column.tolist() for column in extrema)):
            middle, width = float(over.middle[j[k]]), float(half[j[k]])
            self._found[which[i[k]]].append(Part(
                middle + a * width, middle + b * width, sense, middle, width * REACH, c[k],
                float(error[k]), self._rows[which[i[k]]] in self._evaluate.squares))
        left = some._replace(is_open=np.zeros_like(some.is_open),
                             error=np.full(some.error.shape, np.inf))
        left.is_open[which[i], j], left.error[which[i], j] = stays, error
        # cuts do not help where it is rounding that leaves parts open
        is_refused = np.array([row in self._evaluate.why_not for row in self._rows])
        is_hopeless = left.is_open & (
            (left.error > 0.5 * some.error) | is_refused[:, None]
            | (some.high - some.low < NARROWEST * np.maximum(np.abs(some.low), 1.0)))
        left = left.of(left.is_open.any(axis=0)).cut()
        self._pieces = _Pieces(*(np.concatenate(parts, axis=-1) for parts in zip(left, later)))
        self._leave(some._replace(is_open=is_hopeless),
                    'a kink, or nearly two extrema at one place')

    def _leave(self, pieces: _Pieces, why_not: str) -> None:
        """Give up the quantities that are open on these pieces, and note why and at what input."""
        rows = pieces.is_open.any(axis=1)
        for i in np.nonzero(rows)[0].tolist():
            at = float(self._unit * pieces.low[np.argmax(pieces.is_open[i])])
            self._why_not[i] = self._evaluate.why_not.get(
                self._rows[i], f'{why_not}, at {self._name} = {at:.6g}')
        if rows.any():
            self._pieces.is_open[rows] = False
            self._pieces = self._pieces.of(self._pieces.is_open.any(axis=0))


def _ends(path: InputPath) -> tuple[Array, Array]:
    """Return the ends of the pieces between the samples of a path."""
    x = path.x + 2.0 * pi * (path.x < path.x[0])
    if path.is_closed:
        x = np.append(x, x[0] + 2.0 * pi)
    return x[:-1], x[1:]


def _parts_of(c: Array, error: Array, slack: Array,
              widest: Array) -> tuple[Array, tuple[Array, ...]]:
    """
    Return which of m functions leave parts of their piece open, and the extrema of the others.

    ``c``, ``error``: Taylor models, (m, ORDER + 1) and (m,). Lengths are in half widths of the
    piece. ``slack``: overlap of pieces, which keeps extrema away from ends; ``widest``: largest
    uncertainty of a place. The extrema are (function, low, high, sense). Parts of the piece are
    decided by their derivatives or halved, 8 times.
    """
    slope = c[:, 1:] * (_K / REACH**_K)          # in s = (x - middle) / half the width
    size = np.abs(slope).sum(axis=1)
    first, second, rounded = _FIRST * error + DIGITS * size, _SECOND * error, DIGITS * size
    k, a, b = np.arange(len(c)), np.full(len(c), -1.0), np.ones(len(c))
    is_open, hits = np.zeros(len(c), bool), []
    for _ in range(HALVINGS):
        size = np.abs(slope)
        weighted, width = size[:, 1:] @ _K[:-1], 0.5 * (b - a)
        has_none = size[:, 0] > size[:, 1:].sum(axis=1) + first[k]
        bend = 2.0 * size[:, 1] - weighted - second[k] * width - ORDER * rounded[k]
        is_monotone = bend > 0.0
        left, right = slope @ _ALTERNATING, slope.sum(axis=1)
        is_known = is_monotone & (np.minimum(np.abs(left), np.abs(right))
                                  > first[k] + slack[k] / width * weighted)
        hit = is_known & ~has_none & ((left > 0.0) != (right > 0.0))
        hits.append((k[hit], a[hit], b[hit], np.where(left[hit] > 0.0, 1, -1)))
        is_open[k[hit & ~(bend * widest[k] > first[k] * width)]] = True
        goes_on = ~(has_none | is_known)
        is_open[k[goes_on & ~(first[k] < size.sum(axis=1))]] = True
        goes_on &= ~is_open[k]
        k, a, b, slope = k[goes_on], a[goes_on], b[goes_on], slope[goes_on]
        middle = a + 0.5 * (1.0 + CUT) * (b - a)
        k, a, b = np.tile(k, 2), np.concatenate((a, middle)), np.concatenate((middle, b))
        slope = np.concatenate((slope @ _BEFORE, slope @ _AFTER))
    is_open[k] = True
    parts = [np.concatenate(column) for column in zip(*hits)]
    inside = ~is_open[parts[0]]
    return is_open, tuple([part[inside] for part in parts])


def _substitution(low: float, high: float) -> Array:
    """Return the matrix from coefficients in s to those in a variable -1 at low, +1 at high."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return np.array([[comb(k, j) * middle**(k - j) * half**j if j <= k else 0.0
                      for j in range(ORDER)] for k in range(ORDER)])


_ALTERNATING = (-1.0)**np.arange(ORDER)
_BEFORE, _AFTER = _substitution(-1.0, CUT), _substitution(CUT, 1.0)
