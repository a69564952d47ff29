# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Arithmetics as tables of operations: what evaluates a trace in other numbers than floats.

A table is {name of an operation of :data:`.trace.OPERATIONS`: function}. :func:`run` is all that
evaluates a trace with one.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
import operator
from threading import RLock
from types import MappingProxyType
from typing import Any, NamedTuple

from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.number_types import (
    angle_of_complex,
    Function,
    hypot_of_complex,
    power_of_two_of_arrays,
    size_of_complex,
)
from fourbar_ros.numerics.trace import OPERATIONS, Trace
import numpy as np

Table = Mapping[str, Function]


def run(trace: Trace, order: Sequence[int], table: Table, values: list[Any],
        done: Mapping[int, Sequence[int]] = MappingProxyType({})) -> list[Any]:
    """
    Evaluate the steps of a trace at the places ``order`` with the operations of a table.

    ``values``: by place, those that are known already; the results are written into it. ``done``:
    by place, those that nobody needs after it: arrays are given back while they are in the cache.
    """
    steps, known = trace.steps, values.__getitem__
    for place in order:
        step = steps[place]
        values[place] = table[step.operation](*map(known, step.arguments))
        for i in done.get(place, ()):
            values[i] = None
    return values


# --- arrays: real ones, complex ones for derivatives by a complex step, columns of data ----------

ARRAYS: Table = {
    **OPERATIONS, 'sin': np.sin, 'cos': np.cos, 'sqrt': np.sqrt, 'atan2': angle_of_complex,
    'hypot': hypot_of_complex, 'fabs': size_of_complex, 'where': np.where,
    'gt': lambda a, b: np.real(a) > np.real(b), 'lt': lambda a, b: np.real(a) < np.real(b),
    'exact_sum': lambda *terms: exact_sum_of_four(terms), 'power_of_two': power_of_two_of_arrays}


# --- duals of another table ----------------------------------------------------------------------

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


def duals_of(table: Table) -> dict[str, Function]:
    """
    Return the table of numbers with their exact derivatives by any number of parameters.

    Numbers and derivatives are those of another table. By the chain rule,

        (D1)  (u v)' = v u' + u v',   (u/v)' = u'/v - (u/v^2) v',   sqrt(u)' = u' / (2 sqrt(u))
        (D2)  atan2(y, x)' = (x y' - y x') / (x^2 + y^2),   hypot(x, y)' = (x x' + y y') / hypot
    """
    def by_rule(name: str, *rules: Callable[..., Any]) -> Function:
        """
        Return a function of duals, from its derivatives by each argument.

        A rule: (derivative u' of the argument, result, values of all arguments) -> its term.
        """
        def call(*numbers: Any) -> Any:
            """Return the dual; of numbers without derivatives, a number."""
            values = [value_of(number) for number in numbers]
            value, by = table[name](*values), dict[str, Any]()
            for rule, number in zip(rules, numbers):
                for parameter, change in derivatives_of(number).items():
                    term = rule(change, value, *values)
                    by[parameter] = by[parameter] + term if parameter in by else term
            return Dual(value, by) if by else value
        return call

    def of_values(name: str) -> Function:
        """Return a function of the values alone: a comparison, a unit."""
        return lambda *numbers: table[name](*map(value_of, numbers))

    def choice(condition: Any, one: Any, other: Any) -> Any:
        """Return one or the other, with its derivatives."""
        where, by, others = table['where'], derivatives_of(one), derivatives_of(other)
        value = where(condition, value_of(one), value_of(other))
        return Dual(value, {name: where(condition, by.get(name, 0.0), others.get(name, 0.0))
                            for name in by.keys() | others.keys()}) if by or others else value

    return {'add': by_rule('add', lambda du, w, u, v: du, lambda dv, w, u, v: dv),
            'sub': by_rule('sub', lambda du, w, u, v: du, lambda dv, w, u, v: -dv),
            'neg': by_rule('neg', lambda du, w, u: -du),
            'mul': by_rule('mul', lambda du, w, u, v: v * du, lambda dv, w, u, v: u * dv),  # (D1)
            'truediv': by_rule('truediv', lambda du, w, u, v: du / v,
                               lambda dv, w, u, v: -(w / v * dv)),
            'pow': by_rule('pow', lambda du, w, u, v: v * u**(v - 1.0) * du),
            'sqrt': by_rule('sqrt', lambda du, w, u: 0.5 / w * du),
            'sin': by_rule('sin', lambda du, w, u: table['cos'](u) * du),
            'cos': by_rule('cos', lambda du, w, u: -(table['sin'](u) * du)),
            'atan2': by_rule('atan2', lambda dy, w, y, x: x / (x * x + y * y) * dy,         # (D2)
                             lambda dx, w, y, x: -(y / (x * x + y * y) * dx)),
            'hypot': by_rule('hypot', lambda dx, w, x, y: x / w * dx,
                             lambda dy, w, x, y: y / w * dy),
            'fabs': by_rule('fabs', lambda du, w, u: table['where'](
                table['lt'](u, 0.0), -du, du)),
            'exact_sum': lambda *terms: by_rule(
                'exact_sum', *[lambda du, *_: du] * len(terms))(*terms),
            'where': choice, **{name: of_values(name) for name in ('gt', 'lt', 'power_of_two')}}


# --- balls, by python-flint (Arb) ----------------------------------------------------------------

# Precision and the number of terms of series are the same for all threads.
_SETTINGS = RLock()


@contextmanager
def arb_settings(bits: int, terms: int) -> Iterator[None]:
    """Compute with balls of so many bits, and series of so many terms; other threads wait."""
    from flint import ctx

    with _SETTINGS:
        before = ctx.prec, ctx.cap
        ctx.prec, ctx.cap = bits, terms
        try:
            yield
        finally:
            ctx.prec, ctx.cap = before


def taylor_pairs() -> dict[str, Function]:
    """
    Return the table of pairs of ``flint.arb_series``: a Taylor series, and one over a whole piece.

    The first is about the middle of a piece of the input; coefficient k of the second holds
    f^(k)/k! on all of the piece, so its last one is Lagrange's bound of what the first leaves out.
    Constants are pairs of balls. A comparison gives whether it holds in the middle, by which
    formulas choose between forms that are both right, as they take |x| where the sign changes
    nothing; and whether it does on all of the piece.
    """
    from flint import arb, arb_series

    nan = arb.nan()

    def first(v: Any) -> Any:
        """Return the value: the first coefficient of a series."""
        return v[0] if isinstance(v, arb_series) else v

    def of_one(function: Function) -> Function:
        """Return a function of a pair, from that of its numbers."""
        return lambda a: (function(a[0]), function(a[1]))

    def of_two(function: Function) -> Function:
        return lambda a, b: (function(a[0], b[0]), function(a[1], b[1]))

    def power(base: Any, exponent: Any) -> Any:
        whole = exponent.unique_fmpz()
        return base**exponent if whole is None else base**int(whole)

    def angle(y: Any, x: Any) -> Any:
        """Return the angle of (x, y): that in the middle, and the rest by an arc tangent."""
        if not isinstance(x, arb_series) and not isinstance(y, arb_series):
            return arb.atan2(y, x)
        turn = arb.atan2(first(y).mid(), first(x).mid())
        cosine, sine = turn.cos(), turn.sin()
        along, across = x * cosine + y * sine, y * cosine - x * sine
        return turn + (across / along).atan() if first(along) > 0 else nan * x

    def is_greater(a: Any, b: Any) -> tuple[bool, bool]:
        """Return whether a > b in the middle, and whether the same holds on all of the piece."""
        low, high = first(a[1]), first(b[1])
        return first(a[0]).mid() > first(b[0]).mid(), bool(low > high or low <= high)

    def size(v: Any) -> Any:
        """Return v or -v, by its sign in the middle."""
        return v if first(v[0]).mid() >= 0 else (-v[0], -v[1])

    return {'add': of_two(operator.add), 'sub': of_two(operator.sub),
            'mul': of_two(operator.mul), 'truediv': of_two(operator.truediv),
            'neg': of_one(operator.neg), 'pow': of_two(power),
            'sin': of_one(lambda v: v.sin()), 'cos': of_one(lambda v: v.cos()),
            'sqrt': of_one(lambda v: v.sqrt()), 'atan2': of_two(angle), 'fabs': size,
            'hypot': of_two(lambda x, y: (x * x + y * y).sqrt()),
            'exact_sum': lambda *terms: tuple([sum(part, arb(0)) for part in zip(*terms)]),
            'where': lambda condition, one, other: one if condition[0] else other,
            'gt': is_greater, 'lt': lambda a, b: is_greater(b, a),
            'power_of_two': lambda *lengths: (arb(1), arb(1))}     # balls need no scaling
