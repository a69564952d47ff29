# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of arrays with their exact derivatives by any number of parameters."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.tables import ARRAYS, Table
import numpy as np


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


def _by_rule(name: str, *rules: Callable[..., Any]) -> Function:
    """
    Return a function of duals, from its derivatives by each argument.

    A rule: (derivative u' of the argument, result, values of all arguments) -> its term.
    """
    def call(*numbers: Any) -> Any:
        """Return the dual; of numbers without derivatives, a number."""
        values = [value_of(number) for number in numbers]
        value, by = ARRAYS[name](*values), dict[str, Any]()
        for rule, number in zip(rules, numbers):
            for parameter, change in derivatives_of(number).items():
                term = rule(change, value, *values)
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


# The table of duals of arrays. By the chain rule,
#     (D1)  (u v)' = v u' + u v',   (u/v)' = u'/v - (u/v^2) v',   sqrt(u)' = u' / (2 sqrt(u))
#     (D2)  atan2(y, x)' = (x y' - y x') / (x^2 + y^2),   hypot(x, y)' = (x x' + y y') / hypot
DUALS: Table = {
    'add': _by_rule('add', lambda du, w, u, v: du, lambda dv, w, u, v: dv),
    'sub': _by_rule('sub', lambda du, w, u, v: du, lambda dv, w, u, v: -dv),
    'neg': _by_rule('neg', lambda du, w, u: -du),
    'mul': _by_rule('mul', lambda du, w, u, v: v * du, lambda dv, w, u, v: u * dv),         # (D1)
    'truediv': _by_rule('truediv', lambda du, w, u, v: du / v, lambda dv, w, u, v: -(w / v * dv)),
    'pow': _by_rule('pow', lambda du, w, u, v: v * u**(v - 1.0) * du),
    'sqrt': _by_rule('sqrt', lambda du, w, u: 0.5 / w * du),
    'sin': _by_rule('sin', lambda du, w, u: np.cos(u) * du),
    'cos': _by_rule('cos', lambda du, w, u: -(np.sin(u) * du)),
    'atan2': _by_rule('atan2', lambda dy, w, y, x: x / (x * x + y * y) * dy,                # (D2)
                      lambda dx, w, y, x: -(y / (x * x + y * y) * dx)),
    'hypot': _by_rule('hypot', lambda dx, w, x, y: x / w * dx, lambda dy, w, x, y: y / w * dy),
    'fabs': _by_rule('fabs', lambda du, w, u: ARRAYS['where'](ARRAYS['lt'](u, 0.0), -du, du)),
    'exact_sum': lambda *terms: _by_rule('exact_sum', *[lambda du, *_: du] * len(terms))(*terms),
    'where': _choice, **{name: _of_values(name) for name in ('gt', 'lt', 'power_of_two')}}
