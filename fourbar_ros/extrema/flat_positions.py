# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion and loads next to the flat position of an exact change point, where their formulas are 0/0.

On either side, in one mode, all quantities are Laurent series of the distance t
(:mod:`fourbar_ros.numerics.laurent`). Within a part of their radius of convergence they keep all
digits, however small the real or complex t is.
"""
from __future__ import annotations

from functools import cached_property
from math import frexp, pi
from typing import Any, NamedTuple

from fourbar_ros.extrema.input_paths import InputPath
from fourbar_ros.mechanisms.contract import Constants
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.laurent import (
    LAURENT,
    Length,
    many_digits,
    series,
    T,
    TERMS,
)
from fourbar_ros.numerics.number_types import converted
import numpy as np

# The scale is one to two times the distance of the next singularity. Series are used up to this
# part of it: they leave out 2^-60 of the first term, times a small power of TERMS.
REACH = 2.0**-4


class Fields(NamedTuple):
    """
    Series of the fields of a motion or of loads in t, in units of a scale.

    A field that is a length sqrt(x^2 + y^2) has two series; the series of y come after all fields.
    """

    order: Array            # (series,), the lowest power of t of each
    c: Array                # coefficients, (TERMS, series, 1)
    partner: list[int]      # by series: number of the series of y, or -1
    varies: Array           # (fields,), whether the field is more than a constant

    def at(self, t: Array) -> Array:
        """Return the fields at scaled distances t, shape (fields, t.size), by Horner's rule."""
        values = np.zeros((self.order.size, t.size), t.dtype)
        for c in self.c[::-1]:
            values = values * t + c
        with np.errstate(all='ignore'):
            for order in np.unique(self.order).tolist():
                values[self.order == order] *= t**order if order >= 0 else (1.0 / t)**-order
            return np.stack([row if other < 0
                             else np.sqrt(row * row + values[other] * values[other])
                             for row, other in zip(values, self.partner)])


class FlatSide:
    """
    Series of motion and loads on one side of a flat position, in the mode of a mechanism.

    ``rates``: rate and acceleration of the input. ``place``: the flat position, in the input's
    unit. ``side``: +1 for inputs above it, -1 below.
    """

    def __init__(self, mechanism: Mechanism, rates: tuple[float, float], place: float,
                 side: int) -> None:
        """Scale the distance by the nearest other singularity, within which series converge."""
        self._mechanism, self._rates, self.place, self.side = mechanism, rates, place, side
        self._is_angle = not mechanism.is_driven_by_slide
        others = (self._turned(z / mechanism.input_unit - place)
                  for z in mechanism.singular_inputs)
        self._scale = 2.0**frexp(min([1.0, *filter(None, map(abs, others))]))[1]

    def _turned(self, difference: Any) -> Any:
        """Return a difference of two inputs, of angles the short way round: in [-pi, pi]."""
        return (difference - 2.0 * pi * np.round(difference.real / (2.0 * pi)) if self._is_angle
                else difference)

    def distance(self, x: Array) -> Array:
        """Return the distances of inputs on this side, in units of the scale of the series."""
        return np.asarray(self.side * self._turned(x - self.place) / self._scale)

    @cached_property
    def motion(self) -> Fields:
        """Return the fields of the motion as series of floats, computed with 80 digits."""
        with many_digits():
            return _fields(self._motion)

    @cached_property
    def loads(self) -> Fields:
        """Return the series of the loads, of a mechanism with bodies."""
        motion = self._motion
        with many_digits():
            return _fields(self._mechanism.loads_formula(LAURENT, self._constants)(motion))

    @cached_property
    def _constants(self) -> Constants:
        """Return the data of the mechanism as constant series."""
        found: Constants = converted(self._mechanism.constants, series)
        return found

    @cached_property
    def _motion(self) -> tuple[Any, ...]:
        """Return the fields of the motion as Laurent series of the scaled distance T."""
        with many_digits():
            unit = self._mechanism.input_unit
            x = self._mechanism.flat_place(unit * self.place) + unit * self.side * self._scale * T
            formula = self._mechanism.motion_formula(LAURENT, self._constants)
            fields: tuple[Any, ...] = formula(x, *map(series, self._rates))
            return fields

    def state(self, t: Array, with_loads: bool) -> list[Array]:
        """Return fields of motion and loads at scaled distances, each (fields, t.size)."""
        return [self.motion.at(t), *([self.loads.at(t)] if with_loads else [])]


def flat_sides(mechanism: Mechanism, rates: tuple[float, float],
               path: InputPath) -> dict[int, FlatSide]:
    """Return {side: FlatSide} of the ends of a path that are flat positions, +1 the lower end."""
    return {side: FlatSide(mechanism, rates, end.x, side)
            for side, end in path.ends() if end.is_flat}


def _fields(values: tuple[Any, ...]) -> Fields:
    """
    Return the :class:`Fields` of a motion or of loads, made of series, lengths and numbers.

    The length of a vector is no series next to its zero, so both components are kept.
    """
    rows = [series(v.x if isinstance(v, Length) else v) for v in values]
    partner, varies = [-1] * len(rows), []
    for i, v in enumerate(values):
        size = rows[i] if not isinstance(v, Length) else v.x * v.x + v.y * v.y
        varies.append(bool(size.c) and (size.order != 0 or len(size.c) > 1))
        if isinstance(v, Length):
            partner[i] = len(rows)
            rows.append(series(v.y))
    c = np.zeros((TERMS, len(rows), 1))
    for i, row in enumerate(rows):
        c[:len(row.c), i, 0] = [float(v) for v in row.c]
    return Fields(np.array([row.order if row.c else 0 for row in rows]), c, partner,
                  np.array(varies))
