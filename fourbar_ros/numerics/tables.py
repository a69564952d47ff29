# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Arithmetics as tables of operations: what evaluates a trace in other numbers than floats.

A table is {name of an operation of :data:`.trace.OPERATIONS`: function}. :func:`run` is all that
evaluates a trace with one.
"""
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from fourbar_ros.numerics import number_types
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.number_types import exact_sum_of_four, Function
from fourbar_ros.numerics.trace import OPERATIONS, Trace
import numpy as np

Table = Mapping[str, Function]


def run(trace: Trace, order: Sequence[int], table: Table, values: list[Any],
        done: Mapping[int, Sequence[int]] = MappingProxyType({})) -> list[Any]:
    """Evaluate the steps of a trace at the indices ``order`` with the operations of a table."""
    # values: by index, those that are known already; the results are written into it. done: by
    # index, those that nobody needs after it: arrays are given back while they are in the cache. A
    # function that is no formula is called, or what the table's 'call' makes of it.
    steps, known, call = trace.steps, values.__getitem__, table.get('call')
    for index in order:
        step = steps[index]
        apply = table[step.operation] if step.operation != 'call' else (
            step.value if call is None else call(step.value))
        values[index] = apply(*map(known, step.arguments))
        for i in done.get(index, ()):
            values[i] = None
    return values


ARRAYS: Table = {
    **OPERATIONS, 'sin': np.sin, 'cos': np.cos, 'sqrt': np.sqrt, 'where': np.where,
    'atan2': number_types.angle_of_complex, 'hypot': number_types.hypot_of_complex,
    'fabs': number_types.size_of_complex,
    'gt': lambda a, b: np.real(a) > np.real(b), 'lt': lambda a, b: np.real(a) < np.real(b),
    'exact_sum': lambda *terms: exact_sum_of_four(terms),
    'power_of_two': number_types.power_of_two_of_arrays}


# {operation: the derivatives of its result w by each argument: numbers, or functions of w and all}
#     (PD1) (u v)' = v u' + u v',   (u/v)' = u'/v - (u/v^2) v',   sqrt(u)' = u' / (2 sqrt(u))
#     (PD2) atan2(y, x)' = (x y' - y x') / (x^2 + y^2),   hypot(x, y)' = (x x' + y y') / hypot
PARTIALS: Mapping[str, Sequence[float | Function]] = {
    'add': (1.0, 1.0), 'sub': (1.0, -1.0), 'neg': (-1.0,), 'exact_sum': (1.0,) * 4,
    'mul': (lambda w, u, v: v, lambda w, u, v: u),                                          # (PD1)
    'truediv': (lambda w, u, v: 1.0 / v, lambda w, u, v: -(w / v)),
    'pow': (lambda w, u, v: v * u**(v - 1.0),),
    'sqrt': (lambda w, u: 0.5 / w,), 'sin': (lambda w, u: np.cos(u),),
    'cos': (lambda w, u: -np.sin(u),),
    'atan2': (lambda w, y, x: x / (x * x + y * y), lambda w, y, x: -(y / (x * x + y * y))),
    'hypot': (lambda w, x, y: x / w, lambda w, x, y: y / w),                               # (PD2)
    'fabs': (lambda w, u: np.where(np.real(u) < 0.0, -1.0, 1.0),),
    'where': (0.0, lambda w, c, u, v: np.where(c, 1.0, 0.0),
              lambda w, c, u, v: np.where(c, 0.0, 1.0))}
# what does not round its arguments; those of a comparison and a unit do not move their result
_EXACT = ('input', 'neg', 'fabs', 'where', 'gt', 'lt', 'power_of_two')
# Step of x for the central difference of a function that is no formula, over 1 + |x|. The cube
# root of eps balances its truncation error against its rounding.
DIFFERENCE = 6e-6


def slope_of(function: Function, x: Any) -> Any:
    """Return the slope of a function that is no formula at real x; of a table as it has it."""
    if hasattr(function, 'slope'):
        return function.slope(np.asarray(x))
    step = DIFFERENCE * (1.0 + np.abs(x))
    return (function(x + step) - function(x - step)) / (2.0 * step)


def rounding_bound(trace: Trace, result: int, x: Array) -> Array:
    """Return a bound of the rounding error of a result of a trace of one input, at inputs x."""
    # Each number that the result is made of, a constant or what an operation gives, may be off by
    # eps times its size; the bound is the sum of these times the derivatives of the result by
    # them, from the result backward (reverse mode). A function that is no formula, as a table, may
    # state the size of its error as ``largest``. The input counts as exact.
    order, steps = trace.needed([result]), trace.steps
    values = [x if step.operation == 'input' else
              np.float64(step.value) if step.operation == 'constant' else None for step in steps]
    with np.errstate(all='ignore'):
        run(trace, [i for i in order if not steps[i].is_given], ARRAYS, values)
        by, bound = {result: np.ones_like(x)}, np.zeros_like(x)     # {index: derivative by it}
        for i in reversed(order):
            slope, (operation, arguments, function) = by.pop(i, None), steps[i]
            if slope is None:
                continue
            if operation not in _EXACT:
                bound = bound + np.abs(slope * getattr(function, 'largest', values[i]))
            known = [values[k] for k in arguments]
            partials = ((slope_of(function, *known),) if operation == 'call'
                        else PARTIALS.get(operation, ()))
            for k, partial in zip(arguments, partials):
                factor = partial(values[i], *known) if callable(partial) else partial
                # a branch not taken has slope 0, and its factor may be infinite
                by[k] = by.get(k, 0.0) + np.where(slope == 0.0, 0.0, slope * factor)
    return EPS * bound
