# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Numbers in frozen dataclasses: their meaning and allowed values, checked as they are made."""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field, fields, MISSING
from math import inf
from numbers import Real
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arguments import finite


class NumberField(NamedTuple):
    """A number in a frozen dataclass: its meaning and allowed values."""

    # least and above: it must be at least, and more than that. instead: a value that counts as no
    # number, as None. parameter: its name in scenes, if another one.
    unit: str = ''
    text: str = ''
    least: float = -inf
    above: float = -inf
    is_not_zero: bool = False
    is_whole: bool = False
    instead: Any = MISSING
    parameter: str = ''

    def check(self, name: str, value: Any) -> Any:
        """Return a value as a float, a whole number as an int; raises InvalidParameter."""
        if self.instead is not MISSING and (value is None or isinstance(value, Real)) and (
                value == self.instead):
            return value
        allowed = 'must be a finite number'
        if self.above == 0.0:
            allowed = 'must be a positive number'
        elif self.least > -inf:
            allowed += f', {"zero" if self.least == 0.0 else f"{self.least:g}"} or more'
        result = finite(name, value, allowed, self.least, self.above)
        if self.is_not_zero and result == 0.0:
            raise InvalidParameter(name, result, 'must not be zero')
        if self.is_whole and result != int(result):
            raise InvalidParameter(name, value, 'must be a whole number')
        return int(result) if self.is_whole else result


def quantity(default: Any = MISSING, **properties: Any) -> Any:
    return field(default=default, metadata={NumberField: NumberField(**properties)})


def quantities_of(record: Any) -> Iterator[tuple[str, Any, NumberField]]:
    """Yield (name, default, Quantity) of each quantity of a dataclass or one of its records."""
    for item in fields(record):
        if NumberField in item.metadata:
            yield item.name, item.default, item.metadata[NumberField]


def check_quantities(record: Any) -> None:
    for name, _, quantity_field in quantities_of(record):
        object.__setattr__(record, name, quantity_field.check(name, getattr(record, name)))
