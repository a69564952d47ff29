# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A force over a position, from the points of a table.

Between two points it is a cubic polynomial with the slopes of Fritsch and Butland (SIAM J. Sci.
Stat. Comput. 5, 1984), which scipy calls PCHIP: it has a continuous derivative, as an integrator
needs it, and never leaves the range of the two values. Or it is a straight line.

The coefficients are scipy's; a single value from them takes a tenth of a call of scipy's object.
"""
from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.optional import MissingPackage
import numpy as np

MOST_POINTS = 10_000   # a scene lists them as text
CLOSES = 1e-9          # largest difference of both ends of a cycle, over the largest value


@dataclass(frozen=True)
class ForceTable:
    """
    A force [N] or couple [N m] over an angle [rad] or a length [m].

    Calling it with a float or an array gives the value there.

    Parameters
    ----------
    places : sequence of float
        Increasing, 2 to 10 000.
    values : sequence of float
        As many. Beyond the first and the last place the force is that at the end.
    is_periodic : bool
        It repeats: the last place is the first one again, one period later, with the same value.
    is_linear : bool
        Straight lines between points, not cubic polynomials.

    Raises InvalidParameter, which names the first wrong point, counted from 1, and MissingPackage
    without scipy.

    Examples
    --------
    >>> stroke = ForceTable([0.0, 0.1, 0.2], [0.0, -500.0, -600.0])
    >>> round(stroke(0.15), 3), stroke(9.0)
    (-570.833, -600.0)

    """

    places: Sequence[float]
    values: Sequence[float]
    is_periodic: bool = False
    is_linear: bool = False

    def __post_init__(self) -> None:
        """Convert both columns to floats, and refuse a table that is no function."""
        for name in ('places', 'values'):
            column = np.ravel(np.asarray(getattr(self, name), dtype=object)).tolist()
            object.__setattr__(self, name, tuple([
                finite(f'{name}[{i}]', value) for i, value in enumerate(column, 1)]))
        places, values, count = self.places, self.values, len(self.places)
        if not 2 <= count <= MOST_POINTS:
            raise InvalidParameter('places', count, f'must be 2 to {MOST_POINTS} points')
        if len(values) != count:
            raise InvalidParameter('values', len(values), f'must be as many as places, {count}')
        for i, (before, after) in enumerate(zip(places, places[1:]), 2):
            if not after > before:
                raise InvalidParameter(f'places[{i}]', after, 'must be larger than the one '
                                                              f'before, {before!r}')
        if self.is_periodic:
            if abs(values[-1] - values[0]) > CLOSES * max(map(abs, values)):
                raise InvalidParameter(f'values[{count}]', values[-1], 'must be the first value '
                                       f'again, {values[0]!r}: the table is periodic')
            object.__setattr__(self, 'values', (*values[:-1], values[0]))
        try:
            is_finite = bool(np.all(np.isfinite(self._columns)))
        except ValueError:     # from scipy: slopes that are not finite
            is_finite = False
        if not is_finite:
            raise InvalidParameter('values', None, 'so large, or places so close, that slopes '
                                   'overflow')

    @property
    def span(self) -> float:
        """Return the length from the first to the last place: the period, if it repeats."""
        return self.places[-1] - self.places[0]

    @property
    def middle(self) -> float:
        return 0.5 * (self.places[0] + self.places[-1])

    def __call__(self, x: Any) -> Any:
        """
        Return the value at x, a float or an array.

        Of complex x, those of the polynomial at its real part, for derivatives by a complex step.
        """
        if not isinstance(x, np.ndarray):
            return self._value(x, type(x))
        (a, b, c, d), t = self._at(x)
        return ((a * t + b) * t + c) * t + d

    def slope(self, x: Array) -> Array:
        """Return the derivative at an array x, as its value; 0 beyond the ends."""
        (a, b, c, _), t = self._at(x)
        is_beyond = (x.real < self.places[0]) | (x.real > self.places[-1])
        return np.asarray(np.where(is_beyond & (not self.is_periodic), 0.0,
                                   (3.0 * a * t + 2.0 * b) * t + c))

    def _at(self, x: Array) -> tuple[Sequence[Array], Array]:
        """Return the coefficients of the piece at an array x, and how far x is in it."""
        first, last = self.places[0], self.places[-1]
        if np.iscomplexobj(x):
            x = (x - self.span * np.floor((x.real - first) / self.span) if self.is_periodic else
                 np.where(x.real < first, first, np.where(x.real > last, last, x)))
        else:
            x = first + (x - first) % self.span if self.is_periodic else np.clip(x, first, last)
        *coefficients, start = self._columns[:, np.searchsorted(self.places[1:-1], x.real,
                                                                side='right')]
        return coefficients, x - start

    def _value(self, x: Any, number: Any) -> Any:
        """Return the value at x, a ``number``: a float or a Decimal."""
        first, last = map(number, (self.places[0], self.places[-1]))
        if self.is_periodic:
            x = first + (x - first) % number(self.span)
        else:
            x = min(max(x, first), last)
        piece = self.pieces[bisect_right(self.places, x, 1, len(self.places) - 1) - 1]
        a, b, c, d, start = piece if number is float else map(number, piece)
        t = x - start
        return ((a * t + b) * t + c) * t + d

    @cached_property
    def pieces(self) -> list[list[float]]:
        """Return the coefficients of the pieces, highest power first, each with its start."""
        pieces: list[list[float]] = self._columns.T.tolist()
        return pieces

    @cached_property
    def _columns(self) -> Array:
        """Return coefficients and start of each piece, of shape (5, pieces)."""
        places, values = np.array(self.places), np.array(self.values)
        count = places.size - 1
        with np.errstate(all='ignore'):
            if self.is_linear:
                zero = np.zeros(count)
                return np.array([zero, zero, np.diff(values) / np.diff(places), values[:-1],
                                 places[:-1]])
            try:
                from scipy.interpolate import PchipInterpolator
            except ModuleNotFoundError as error:
                raise MissingPackage('a table of forces', error) from error
            if not self.is_periodic:
                return np.vstack([PchipInterpolator(places, values).c, places[:-1]])
            # repeated three times: the middle cycle has the right slopes at its ends
            cycles = np.concatenate([places[:-1] - self.span, places, places[1:] + self.span])
            values = np.concatenate([values[:-1], values, values[1:]])
            of_middle = PchipInterpolator(cycles, values).c[:, count:2 * count]
            return np.vstack([of_middle, places[:-1]])
