# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Quantities hidden by rounding, computed in many digits: some milliseconds a sample.

Near toggles, and behind links near their toggles, a value may be all rounding; or the slope is,
while the value keeps most of its digits. Here both are computed for the data of the mechanism,
taken to the last bit. One rounding of each datum moves a value: digits below that mean nothing.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal

from fourbar_ros.extrema.sampling import Sampler, State
from fourbar_ros.mechanisms.contract import Constants
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.mechanisms.quantities import Asked
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.laurent import Laurent, MANY_DIGITS, many_digits, series
from fourbar_ros.numerics.number_types import converted, Function
import numpy as np

# Steps of the input, and of a datum as a part of it: their squares vanish in 80 digits.
STEP, PART = Decimal('1e-30'), Decimal('1e-30')
# Roundings of each datum: values that differ by less than their effect are the same.
ROUNDINGS = 4.0
Formulas = tuple[Function, Function | None]     # of motion and loads
WITHOUT_ANGLES = replace(MANY_DIGITS, name='many digits without angles',
                         atan2=lambda y, x: series(0.0))


class DigitSampler(Sampler):
    """The same in many digits, then rounded; NaN where a link is in line, of array functions."""

    def __init__(self, plain: Sampler) -> None:
        """Take all from a sampler of floats, and make the formulas for many digits."""
        self.__dict__.update(plain.__dict__)
        self._known: dict[tuple[float, bool], list[Decimal | None]] = {}
        self._numbers = MANY_DIGITS if self.with_angles else WITHOUT_ANGLES
        with many_digits():
            self._formulas = self._made_for(converted(self.linkage.constants, series))

    def _made_for(self, constants: Constants) -> Formulas:
        loads = self._functions[1][0] and self.linkage.loads_formula(self._numbers, constants)
        return self.linkage.motion_formula(self._numbers, constants), loads

    def _evaluated(self, formulas: Formulas, x: Decimal) -> list[Decimal | None]:
        """Return the quantities at an input; None where a formula fails, as in line."""
        motion, loads = formulas
        try:
            fields = motion(series(Decimal(self.unit) * x), *map(series, self.rates))
            state = (self.linkage.MOTION(*fields),
                     self.linkage.LOADS(*loads(fields)) if loads else NoLoads())
        except (ArithmeticError, ValueError):
            return [None] * len(self.quantities)
        return [_value_of(quantity, state) for quantity in self.quantities]

    def _decimals(self, x: float, is_beside: bool = False) -> list[Decimal | None]:
        """Return the quantities at x, or at x + 1e-30 for slopes; computed once."""
        if (x, is_beside) not in self._known:
            with many_digits():
                at = Decimal(x) + STEP if is_beside else Decimal(x)
                self._known[x, is_beside] = self._evaluated(self._formulas, at)
        return self._known[x, is_beside]

    def values_at(self, x: Array, row: Array) -> Array:
        """Return quantity ``row[i]`` at x[i] as floats, NaN where it cannot be computed."""
        return np.array([np.nan if value is None else float(value) for value in (
            self._decimals(v)[i] for v, i in zip(x.tolist(), row.tolist()))])

    def at(self, x: Array, row: Array) -> tuple[Array, Array]:
        """Return value and derivative of quantity ``row[i]`` at x[i]; NaN where there is none."""
        values, slopes = np.full((2, row.size), np.nan)
        for k, (v, i) in enumerate(zip(x.tolist(), row.tolist())):
            value, beside = self._decimals(v)[i], self._decimals(v, True)[i]
            if value is not None and beside is not None:
                with many_digits():
                    values[k], slopes[k] = float(value), float((beside - value) / STEP)
        return values, slopes

    def rounding_of_data(self, x: float, row: int) -> float:
        """
        Return by how much four roundings of each datum may move quantity ``row`` at x.

        Anything smaller depends on bits of the data that nobody meant. The derivatives by the data
        are differences in many digits.
        """
        own, size = self._decimals(x)[row], 0.0
        assert own is not None
        with many_digits():
            for constants in self._each_datum_moved():
                value = self._evaluated(self._made_for(constants), Decimal(x))[row]
                size += np.inf if value is None else abs(float((value - own) / PART))
        return ROUNDINGS * EPS * (abs(float(own)) + size)

    def _each_datum_moved(self) -> Iterator[Constants]:
        """Yield the constants of the mechanism with one datum after the other 1e-30 larger."""
        given, signs = self.linkage.constants, converted(self.linkage.constants.sign, series)
        values: list[float] = []
        converted(given._replace(sign=None), values.append)
        for k in np.flatnonzero(values).tolist():
            count = iter(range(len(values)))

            def moved(value: float, k: int = k, count: Iterator[int] = count) -> Laurent:
                """Return a datum in many digits, the k-th request a bit larger."""
                number = Decimal(value)
                return series(number * (1 + PART) if next(count) == k else number)
            yield converted(given._replace(sign=None), moved)._replace(sign=signs)


def _value_of(quantity: Asked, state: State) -> Decimal | None:
    """Return a quantity in many digits; None of a function that takes no such numbers."""
    try:
        value = quantity.of(*state)
    except (TypeError, AttributeError):
        return None
    return value.coefficient(0) if isinstance(value, Laurent) else None
