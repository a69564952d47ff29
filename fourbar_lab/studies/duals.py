# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of arrays with their exact derivatives by any number of parameters."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.tables import ARRAYS, PARTIALS, Table


class Dual(NamedTuple):
    """A number, and its derivatives ``by`` = {parameter: derivative}; none is listed that is 0."""

    value: Any
    by: Mapping[str, Any]


def value_of(number: Any) -> Any:
    """Return the value of a dual, and any other number as it is."""
    return number.value if isinstance(number, Dual) else number


def derivatives_of(number: Any) -> Mapping[str, Any]:
    """Return {parameter: derivative} of a dual, nothing of any other number."""
    return number.by if isinstance(number, Dual) else {}


def _by_partials(name: str) -> Function:
    """Return an operation on duals, from its derivatives by each argument."""
    def call(*numbers: Any) -> Any:
        """Return the dual; of numbers without derivatives, a number."""
        values = [value_of(number) for number in numbers]
        value, by = ARRAYS[name](*values), dict[str, Any]()
        for rule, number in zip(PARTIALS[name], numbers):
            changes = derivatives_of(number)
            slope = rule(value, *values) if callable(rule) and changes else rule
            for parameter, change in changes.items():
                term = change if slope is rule == 1.0 else slope * change
                by[parameter] = by[parameter] + term if parameter in by else term
        return Dual(value, by) if by else value
    return call


def _of_values(name: str) -> Function:
    """Return a function of the values alone: a comparison, a unit."""
    return lambda *numbers: ARRAYS[name](*map(value_of, numbers))


def _choice(condition: Any, one: Any, other: Any) -> Any:
    """Return one or the other, with its derivatives."""
    where, by, others = ARRAYS['where'], derivatives_of(one), derivatives_of(other)
    value = where(condition, value_of(one), value_of(other))
    return Dual(value, {name: where(condition, by.get(name, 0.0), others.get(name, 0.0))
                        for name in by.keys() | others.keys()}) if by or others else value


DUALS: Table = {
    **{name: _by_partials(name) for name in PARTIALS}, 'where': _choice,
    **{name: _of_values(name) for name in ('gt', 'lt', 'power_of_two')}}
