# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism evaluated for arrays of inputs.

Few samples one by one, many by a recorded program.
"""
from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import chain, repeat
from math import prod
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.given import array
from fourbar_ros.numerics.number_types import (
    COMPLEX,
    COMPLEX_WITH_ANGLES,
    Function,
    numbers_of,
    NumberType,
    REAL,
)
from fourbar_ros.numerics.program import program
from fourbar_ros.numerics.recorded import Constants, Record
from fourbar_ros.numerics.straight_line import make_lines
import numpy as np

# Samples for which numpy's calls of all operations of a formula take as long as the formula with
# floats does:
# of fewer, or where fewer operations are needed, as many fewer, each sample is computed by itself.
ONE_BY_ONE = 30


_records: dict[tuple[Any, ...], Record] = {}


def recorded(mechanism: Any, with_loads: bool) -> tuple[Record, Constants]:
    """Return the record of a mechanism's motion, or motion and loads, and its own constants."""
    data = mechanism.constants if with_loads else mechanism.constants._replace(bodies=None)
    # forces of springs act on links, as a driven crank, that are not loaded from outside
    key = *mechanism.structure, type(mechanism.external), with_loads

    def formulas(numbers: NumberType, data: Any) -> Iterator[Function]:
        yield mechanism.motion_formula(numbers, data)
        if with_loads:
            yield mechanism.loads_formula(numbers, data)

    if key not in _records:
        _records[key] = Record(formulas, data)
    return _records[key], _records[key].constants_for(data)


MOST_LINES = 256      # structures whose lines are kept
_lines: dict[tuple[Any, ...], Function] = {}


def line_of(mechanism: Any, with_loads: bool) -> Function:
    """
    Return (position, rate, acceleration) -> motion, or (motion, loads), of floats, as tuples.

    One straight line for all mechanisms of a structure: the operations of the formulas in their
    order, so their bits, without the calls and choices between them.
    """
    data = mechanism.constants if with_loads else mechanism.constants._replace(bodies=None)
    found = numbers_of(data)
    zeros = frozenset([i for i, value in enumerate(found) if value == 0.0]
                      if mechanism.LEAVES_OUT_ZEROS else ())
    key = *mechanism.structure, type(mechanism.external), with_loads, zeros

    def formula(numbers: NumberType, data: Any) -> Function:
        motion_of = mechanism.motion_formula(numbers, data)
        if not with_loads:
            return motion_of
        loads_of = mechanism.loads_formula(numbers, data)

        def step(*given: Any) -> Any:
            motion = motion_of(*given)
            return motion, loads_of(motion)
        return step

    lines = _lines.get(key)
    if lines is None:
        if len(_lines) >= MOST_LINES:
            _lines.clear()
        lines = _lines[key] = make_lines(formula, data, 3, zeros)
    line: Function = lines(found)
    return line


def evaluate(mechanism: Any, given: tuple[Any, ...], wanted: tuple[int, ...] | None,
             with_loads: bool) -> list[Array]:
    """
    Return fields of motion, or of motion and loads, as arrays of the inputs' common shape.

    Parameters
    ----------
    mechanism : Mechanism
    given : tuple of 3
        Position, rate, acceleration; array_like.
    wanted : tuple of int, optional
        Which of the fields; None: all.

    """
    rows: Any
    inputs, shape = _inputs(mechanism, given)
    position, size = inputs[0], prod(shape)
    # outside of it nothing is known, as where the links cannot close
    if mechanism.stroke is not None:
        low, high = mechanism.stroke
        inputs[0] = np.where((position.real >= low) & (position.real <= high), position, np.nan)
    with np.errstate(all='ignore'):
        _keep_memory()
        if any(v.dtype.kind == 'c' for v in inputs):
            rows = _complex_rows(mechanism, inputs, shape, wanted, with_loads)
        else:
            inputs = [float(v) if i and not v.ndim else np.broadcast_to(v, shape).reshape(-1)
                      for i, v in enumerate(inputs)]
            record, constants = (mechanism.record_with_loads if with_loads
                                 else mechanism.record_of_motion)
            single = tuple([type(v) is float for v in inputs])
            chosen = program(record, range_of(record) if wanted is None else wanted, single,
                             constants.zeros)
            rows = _one_by_one(mechanism, inputs, wanted, with_loads) if (
                0 < size * record.operations <= ONE_BY_ONE * len(chosen.steps)) else None
            if rows is None:
                rows = chosen.run(inputs, constants, size)
    if mechanism.stroke is not None:
        place = mechanism.MOTION._fields.index(mechanism.input_coordinate.position)
        for i, row in zip(range(len(rows)) if wanted is None else wanted, rows):
            if i == place:
                row[...] = np.broadcast_to(position, shape).reshape(-1)
    return [row.reshape(shape) for row in rows]


@cache
def range_of(record: Any) -> tuple[int, ...]:
    """Return the places of all results of a record."""
    return tuple(range(len(record.results)))


def _inputs(mechanism: Any, given: tuple[Any, ...]) -> tuple[list[Any], tuple[int, ...]]:
    """Return the inputs as arrays of (for a complex step, complex) doubles, and their shape."""
    names = mechanism.input_coordinate
    inputs = [array(name, value, name == names.position) for name, value in zip(names, given)]
    if not any(v.ndim for v in inputs[1:]):
        return inputs, inputs[0].shape
    try:
        return inputs, np.broadcast_shapes(*(v.shape for v in inputs))
    except ValueError:
        raise InvalidParameter(', '.join(names), ', '.join(str(v.shape) for v in inputs),
                               'must have shapes that broadcast') from None


def _one_by_one(mechanism: Any, inputs: list[Any], wanted: tuple[int, ...] | None,
                with_loads: bool) -> Any:
    """
    Return the rows computed with floats, or None if any sample has no finite result.

    Numpy knows infinities.
    """
    motion, loads = mechanism.make_motion(REAL), mechanism.make_loads(REAL) if with_loads else None
    columns = [repeat(v) if type(v) is float else v.tolist() for v in inputs]
    try:
        found = [motion(*sample) for sample in zip(*columns)]
        if loads:
            found = [fields + loads(fields) for fields in found]
    except (ValueError, ZeroDivisionError):
        return None
    if wanted is not None:
        found = [[fields[i] for i in wanted] for fields in found]
    rows = np.fromiter(chain.from_iterable(found), float).reshape(len(found), -1).T.copy()
    return list(rows) if np.isfinite(rows).all() else None


def _complex_rows(mechanism: Any, inputs: list[Any], shape: tuple[int, ...],
                  wanted: tuple[int, ...] | None, with_loads: bool) -> list[Array]:
    """Return the rows of a complex step; angles carry their derivatives."""
    inputs = [np.broadcast_to(v.astype(complex), shape).reshape(-1) for v in inputs]
    fields = mechanism.make_motion(COMPLEX_WITH_ANGLES)(*inputs)
    if with_loads:
        fields += mechanism.make_loads(COMPLEX)(fields)
    fields = fields if wanted is None else [fields[i] for i in wanted]
    return [np.array(np.broadcast_to(field, inputs[0].shape), complex) for field in fields]


@cache
def _keep_memory() -> None:
    """
    Have blocks of up to 31 MB kept by the C library when they are freed, once and for all.

    glibc gives each back to the system until it has seen one of that size freed; getting the pages
    again would take longer than the formulas. The block is never touched, so it costs nothing.
    """
    np.empty(31 * 2**17)
