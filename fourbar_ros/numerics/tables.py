# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Arithmetics as tables of operations: what evaluates a trace in other numbers than floats.

A table is {name of an operation of :data:`.trace.OPERATIONS`: function}. :func:`run` is all that
evaluates a trace with one.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

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
    Evaluate the steps of a trace at the indices ``order`` with the operations of a table.

    ``values``: by index, those that are known already; the results are written into it. ``done``:
    by index, those that nobody needs after it: arrays are given back while they are in the cache.
    """
    steps, known = trace.steps, values.__getitem__
    for index in order:
        step = steps[index]
        values[index] = table[step.operation](*map(known, step.arguments))
        for i in done.get(index, ()):
            values[i] = None
    return values


# --- arrays: real ones, complex ones for derivatives by a complex step, columns of data ----------

ARRAYS: Table = {
    **OPERATIONS, 'sin': np.sin, 'cos': np.cos, 'sqrt': np.sqrt, 'atan2': angle_of_complex,
    'hypot': hypot_of_complex, 'fabs': size_of_complex, 'where': np.where,
    'gt': lambda a, b: np.real(a) > np.real(b), 'lt': lambda a, b: np.real(a) < np.real(b),
    'exact_sum': lambda *terms: exact_sum_of_four(terms), 'power_of_two': power_of_two_of_arrays}


# --- balls, by python-flint (Arb) ----------------------------------------------------------------
