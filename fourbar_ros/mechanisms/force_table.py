# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A force over a position, from the points of a table.

Between two points it is a cubic polynomial with the slopes of Fritsch and Butland (SIAM J. Sci.
Stat. Comput. 5, 1984), which scipy calls PCHIP: it has a continuous derivative, as an integrator
needs it, and never leaves the range of the two values. Or it is a straight line. At a place that
stands twice it jumps, and each side is a curve by itself.

The coefficients are those of scipy's object to the bit, whose import takes longer than all else.
"""
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array
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
        2 to 10 000, increasing; falling ones are turned round. At a place that stands twice the
        force jumps from the first of its two values to the second, which is that at the place.
    values : sequence of float
        As many. Beyond the first and the last place the force is that at the end.
    is_periodic : bool
        It repeats: the last place is the first one again, one period later, with the same value.
        Where the first or the last place stands twice, it jumps there.
    is_linear : bool
        Straight lines between points, not cubic polynomials.

    Raises InvalidParameter, which names the first wrong point, counted from 1.

    Examples
    --------
    >>> stroke = ForceTable([0.0, 0.1, 0.2], [0.0, -500.0, -600.0])
    >>> round(stroke(0.15), 3), stroke(9.0)
    (-570.833, -600.0)
    >>> cut = ForceTable([0.0, 0.1, 0.1, 0.2], [0.0, 0.0, -500.0, -600.0])
    >>> cut(0.0999), cut(0.1)
    (0.0, -500.0)

    """

    places: Sequence[float]
    values: Sequence[float]
    is_periodic: bool = False
    is_linear: bool = False

    def __post_init__(self) -> None:
        for name in ('places', 'values'):
            column = np.ravel(np.asarray(getattr(self, name), dtype=object)).tolist()
            object.__setattr__(self, name, tuple([
                finite(f'{name}[{i}]', value) for i, value in enumerate(column, 1)]))
        places, values, count = self.places, self.values, len(self.places)
        if not 2 <= count <= MOST_POINTS:
            raise InvalidParameter('places', count, f'must be 2 to {MOST_POINTS} points')
        if len(values) != count:
            raise InvalidParameter('values', len(values), f'must be as many as places, {count}')
        falls = all(after <= before for before, after in pairwise(places))
        for i, (before, after) in enumerate(pairwise(places), 2):
            if after < before and not falls:
                raise InvalidParameter(f'places[{i}]', after, 'must be larger than the one '
                                                              f'before, {before!r}')
            if i > 2 and after == places[i - 3]:
                raise InvalidParameter(f'places[{i}]', after, 'stands three times: a jump has one '
                                                              'value before and one after it')
        if not self.span:
            raise InvalidParameter('places[2]', places[1], 'must be larger than the one before, '
                                                           f'{places[0]!r}')
        if falls:
            places, values = places[::-1], values[::-1]
            object.__setattr__(self, 'places', places)
            object.__setattr__(self, 'values', values)
        if self.is_periodic:
            if abs(values[-1] - values[0]) > CLOSES * max(map(abs, values)):
                raise InvalidParameter(
                    f'values[{count}]', values[-1], f'must be the first value again, {values[0]!r}'
                    ': the table is periodic; where it jumps there, a last row '
                    f'{places[-1]!r}, {values[0]!r} says so')
            if places[0] == places[1] and places[-2] == places[-1]:
                raise InvalidParameter(f'places[{count}]', places[-1], 'stands twice, and so does '
                                       'the first, which is the same place: one jump is enough')
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
        Return the value at x, a float or an array; where it jumps, that after the jump.

        Of complex x, those of the polynomial at its real part, for derivatives by a complex step.
        """
        if not isinstance(x, np.ndarray):
            return self._value(x, type(x))
        (a, b, c, d), t = self._piece_at(x)
        return ((a * t + b) * t + c) * t + d

    def slope(self, x: Array) -> Array:
        """Return the derivative at an array x, as its value; 0 beyond the ends."""
        (a, b, c, _), t = self._piece_at(x)
        return np.asarray((3.0 * a * t + 2.0 * b) * t + c)

    def _piece_at(self, x: Array) -> tuple[Sequence[Array], Array]:
        """Return the coefficients of the piece at an array x, and how far x is in it."""
        if self.is_periodic:        # in the first period x stays to the bit, as at a jump
            away = x.real - self.places[0]
            is_inside = (away >= 0.0) & (away < self.span)
            if np.iscomplexobj(x):      # for which there is no %
                x = np.where(is_inside, x, x - self.span * np.floor(away / self.span))
            else:
                x = np.where(is_inside, x, self.places[0] + away % self.span)
        # column k + 1 is that of the piece from starts[k] on, column 0 that before all
        *coefficients, start = self._columns[:, np.searchsorted(self.starts, x.real, side='right')]
        return coefficients, x - start

    def _value(self, x: Any, number: Any) -> Any:
        if self.is_periodic:
            first, span = number(self.places[0]), number(self.span)
            if not 0 <= x - first < span:
                x = first + (x - first) % span
                x = x + span if x < first else x         # % of decimals has the sign of x - first
        piece = self.pieces[bisect_right(self.starts, x)]
        a, b, c, d, start = piece if number is float else map(number, piece)
        t = x - start
        return ((a * t + b) * t + c) * t + d

    @cached_property
    def starts(self) -> list[float]:
        """Return all places, each once: there the pieces begin, but for the one before them."""
        return sorted({*self.places})

    @cached_property
    def pieces(self) -> list[list[float]]:
        """Return the coefficients of the pieces, highest power first, each with its start."""
        # The first piece and the last are the constants beyond the ends.
        pieces: list[list[float]] = self._columns.T.tolist()
        return pieces

    @cached_property
    def _columns(self) -> Array:
        """Return coefficients and start of all pieces as columns, in order."""
        # The first and the last piece are the constants before and after the table.
        places, values = np.array(self.places), np.array(self.values)
        first, last = places[0], places[-1]
        inner = slice(0, places.size - 1)       # the intervals of one cycle
        if self.is_periodic:    # three cycles: the one in the middle has the right slopes
            inner = slice(places.size - 1, 2 * places.size - 2)
            places = np.concatenate([first + (places[:-1] - last), places,
                                     last + (places[1:] - first)])
            values = np.concatenate([values[:-1], values, values[1:]])
        curves = np.zeros((4, places.size - 1))
        jumps = np.flatnonzero(np.diff(places) == 0.0) + 1
        with np.errstate(all='ignore'):
            for begin, end in pairwise([0, *jumps.tolist(), places.size]):
                if end > begin + 1:
                    curves[:, begin:end - 1] = self._curve(places[begin:end], values[begin:end])
        columns = np.vstack([curves, places[:-1]])[:, inner]
        before, after = self.values[0], self.values[-1]
        if self.is_periodic and self.places[-2] == self.places[-1]:
            after = self.values[-2]     # x may be rounded to the last place: the jump is after it
        # an interval of no width is a jump, and no piece
        return np.column_stack([[0.0, 0.0, 0.0, before, first],
                                columns[:, np.diff(self.places) > 0.0],
                                [0.0, 0.0, 0.0, after, last]])

    def _curve(self, places: Array, values: Array) -> Array:
        """Return the coefficients of the pieces between places, without a jump: (4, pieces)."""
        if self.is_linear:
            zero = np.zeros(places.size - 1)
            return np.array([zero, zero, np.diff(values) / np.diff(places), values[:-1]])
        widths = np.diff(places)
        lines = np.diff(values) / widths        # slopes of the straight lines
        if lines.size == 1:
            slopes = np.repeat(lines, 2)
        else:
            # The weighted harmonic mean of the lines before and after a point; level where they
            # turn back or are level, as a division by zero then is not taken.
            weight_before = 2.0 * widths[1:] + widths[:-1]
            weight_after = widths[1:] + 2.0 * widths[:-1]
            inverse = (weight_before / lines[:-1] + weight_after / lines[1:]) / (
                weight_before + weight_after)
            inner = np.where(np.sign(lines[1:]) * np.sign(lines[:-1]) > 0.0, 1.0 / inverse, 0.0)
            first = _end_slope(widths[0], widths[1], lines[0], lines[1])
            last = _end_slope(widths[-1], widths[-2], lines[-1], lines[-2])
            slopes = np.concatenate([[first], inner, [last]])
        bend = (slopes[:-1] + slopes[1:] - 2.0 * lines) / widths
        return np.array([bend / widths, (lines - slopes[:-1]) / widths - bend, slopes[:-1],
                         values[:-1]])


def _end_slope(width: float, next_width: float, line: float, next_line: float) -> float:
    """Return the slope at an end, of a parabola through three points that does not overshoot."""
    slope = ((2.0 * width + next_width) * line - width * next_line) / (width + next_width)
    if np.sign(slope) != np.sign(line):
        return 0.0
    if np.sign(line) != np.sign(next_line) and abs(slope) > 3.0 * abs(line):
        return 3.0 * line
    return slope
