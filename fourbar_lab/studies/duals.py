# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of arrays with their exact derivatives by any number of parameters."""
from collections.abc import Mapping
from typing import Any, NamedTuple

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.tables import ARRAYS, PARTIALS, slope_of, Table


class Dual(NamedTuple):
    """A number, and its derivatives ``by`` = {parameter: derivative}; none is listed that is 0."""

    value: Any
    by: Mapping[str, Any]


def value_of(dual: Any) -> Any:
    """Return the value of a dual, and anything else as it is."""
    return dual.value if isinstance(dual, Dual) else dual


def derivatives_of(dual: Any) -> Mapping[str, Any]:
    """Return {parameter: derivative} of a dual, nothing of anything else."""
    return dual.by if isinstance(dual, Dual) else {}


def _by_partials(name: str) -> Function:
    def call(*arguments: Any) -> Any:
        values = [*map(value_of, arguments)]
        value, by = ARRAYS[name](*values), dict[str, Any]()
        # a rule is the partial derivative, as a number or a function of the result and all
        # arguments; the exponent of pow, always a number, has none
        for rule, argument in zip(PARTIALS[name], arguments):
            if changes := derivatives_of(argument):
                slope = rule(value, *values) if callable(rule) else rule
                for parameter, change in changes.items():
                    term = change if rule == 1.0 else slope * change
                    by[parameter] = by[parameter] + term if parameter in by else term
        return Dual(value, by) if by else value
    return call


def _of_values(name: str) -> Function:
    return lambda *arguments: ARRAYS[name](*map(value_of, arguments))


def _choice(condition: Any, first: Any, second: Any) -> Any:
    where, by_first, by_second = ARRAYS['where'], derivatives_of(first), derivatives_of(second)
    value = where(condition, value_of(first), value_of(second))
    by = {name: where(condition, by_first.get(name, 0.0), by_second.get(name, 0.0))
          for name in by_first.keys() | by_second.keys()}
    return Dual(value, by) if by else value


def _of_function(function: Function) -> Function:
    """Return a function that is no formula, as a table of forces, for duals."""
    def call(argument: Any) -> Any:
        x = value_of(argument)
        value, changes = function(x), derivatives_of(argument)
        slope = slope_of(function, x) if changes else 0.0
        return Dual(value, {name: slope * change for name, change in changes.items()})
    return call


DUALS: Table = {
    **{name: _by_partials(name) for name in PARTIALS}, 'where': _choice, 'call': _of_function,
    **{name: _of_values(name) for name in ('gt', 'lt', 'power_of_two')}}
