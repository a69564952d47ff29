# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism evaluated: one sample by a straight line of floats, arrays by a program of numpy.

Both are written from one trace of its formulas (:mod:`fourbar_ros.numerics.trace`), which all
mechanisms of a structure share.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cache, lru_cache
from math import isfinite, nan, prod
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.contract import Constants
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.given import array
from fourbar_ros.numerics.laurent import LAURENT, Laurent, limit, many_digits, series
from fourbar_ros.numerics.number_types import (
    COMPLEX,
    COMPLEX_WITH_ANGLES,
    converted,
    Function,
    numbers_of,
    NumberType,
    REAL,
    Scalar,
)
from fourbar_ros.numerics.program import program
from fourbar_ros.numerics.straight_line import lines_of
from fourbar_ros.numerics.trace import flat, Trace
import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Formulas

# An input next to a flat position at 0; loads have terms of its power -3.
NEAR = Laurent([Decimal(1)], 1, 10)
MOST_STRUCTURES = 256      # whose traces and lines are kept


@dataclass(frozen=True)
class Formula:
    """
    Motion, or motion and loads, of a mechanism; equal for all mechanisms of a structure.

    Parameters
    ----------
    structure : tuple
        What formulas differ in, beside numbers.
    with_loads : bool
    mechanism : Mechanism
        Any of the structure.

    """

    structure: tuple[object, ...]
    with_loads: bool
    mechanism: Formulas = field(compare=False, repr=False)

    def make(self, numbers: NumberType, data: Constants) -> Function:
        """Return (position, rate, acceleration) -> motion, or (motion, loads)."""
        motion_of = self.mechanism.motion_formula(numbers, data)
        if not self.with_loads:
            return motion_of
        loads_of = self.mechanism.loads_formula(numbers, data)

        def step(*given: Scalar) -> tuple[Any, Any]:
            motion = motion_of(*given)
            return motion, loads_of(motion)
        return step


def formula_of(mechanism: Formulas, with_loads: bool) -> tuple[Formula, Constants]:
    """Return the formula of a mechanism, and the data it is made for."""
    data = mechanism.constants if with_loads else mechanism.constants._replace(bodies=None)
    # forces of springs act on links, as a driven crank, that are not loaded from outside
    return Formula((*mechanism.structure, type(mechanism.external)), with_loads, mechanism), data


@lru_cache(maxsize=MOST_STRUCTURES)
def trace_of(formula: Formula) -> Trace:
    """Return the trace of a formula: of the formulas of all mechanisms of its structure."""
    return Trace(formula.make, 3, formula_of(formula.mechanism, formula.with_loads)[1])


class Recorded(NamedTuple):
    """The trace of a mechanism's formula, and what that is before there are inputs."""

    trace: Trace
    constants: list[float | None]         # by place
    zeros: frozenset[int]        # places of those that are zero and used together with inputs


def recorded(mechanism: Formulas, with_loads: bool) -> Recorded:
    """Return the trace of a mechanism's motion, or motion and loads, and its own constants."""
    formula, data = formula_of(mechanism, with_loads)
    trace = trace_of(formula)
    constants = trace.constants(numbers_of(data))
    return Recorded(trace, constants, frozenset([
        place for place in trace.used_constants if constants[place] == 0.0]))


@lru_cache(maxsize=MOST_STRUCTURES)
def _lines(formula: Formula, zeros: frozenset[int]) -> Callable[[Sequence[float]], Function]:
    """Return numbers of data -> straight line, for a structure and which of its data are zero."""
    what = 'motion and loads' if formula.with_loads else 'motion'
    return lines_of(trace_of(formula), zeros, f'{formula.mechanism.TITLE}: {what}')


def line_of(mechanism: Formulas, with_loads: bool) -> Function:
    """
    Return (position, rate, acceleration) -> motion, or (motion, loads), of floats, as tuples.

    One straight line for all mechanisms of a structure: the operations of the formulas in their
    order, so their bits, without the calls and choices between them.
    """
    formula, data = formula_of(mechanism, with_loads)
    found = numbers_of(data)
    zeros = frozenset([i for i, value in enumerate(found) if value == 0.0]
                      if mechanism.LEAVES_OUT_ZEROS else ())
    return _lines(formula, zeros)(found)


def limits_at_zero(mechanism: Formulas, rate: float, acceleration: float,
                   with_loads: bool) -> list[float]:
    """
    Return the fields for an input that falls to 0, a flat position, with zeros and infinities.

    By their first terms: in floats what is left of terms that cancel would be divided by what
    vanishes.
    """
    with many_digits():
        constants, x = converted(mechanism.constants, series), series(mechanism.input_unit) * NEAR
        fields = mechanism.motion_formula(LAURENT, constants)(x, series(rate),
                                                              series(acceleration))
        if with_loads:
            fields += mechanism.loads_formula(LAURENT, constants)(fields)
        return list(map(limit, fields))


def with_limits(mechanism: Formulas, line: Function, with_loads: bool) -> Function:
    """
    Return a line of :func:`line_of` with its limits at a flat position at 0.

    ZeroDivisionError where loads are unbounded.
    """
    known: dict[tuple[float, float], Any] = {}
    count = len(mechanism.MOTION._fields)

    def guarded(position: float, rate: float, acceleration: float) -> Any:
        if position:
            return line(position, rate, acceleration)
        if (rate, acceleration) not in known:
            known.clear()
            known[rate, acceleration] = limits_at_zero(mechanism, rate, acceleration, with_loads)
        fields = known[rate, acceleration]
        motion, loads = tuple(fields[:count]), tuple(fields[count:])
        if not all(map(isfinite, loads)):
            raise ZeroDivisionError
        return (motion, loads) if with_loads else motion
    return guarded


def _set_limits(mechanism: Formulas, inputs: list[Array], rows: Sequence[Array],
                wanted: Sequence[int], with_loads: bool) -> None:
    """Put the limits into rows where the input is at a flat position at 0."""
    at = np.flatnonzero(inputs[0] == 0.0)
    rates = np.stack([np.broadcast_to(v, inputs[0].shape)[at] for v in inputs[1:]])
    for rate, acceleration in np.unique(rates[:, np.isfinite(rates).all(axis=0)], axis=1).T:
        fields = limits_at_zero(mechanism, float(rate), float(acceleration), with_loads)
        same = at[(rates[0] == rate) & (rates[1] == acceleration)]
        for row, i in zip(rows, wanted):
            row[same] = fields[i]


def evaluate(mechanism: Formulas, given: tuple[ArrayLike, ...], wanted: tuple[int, ...] | None,
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
    inputs, shape = _inputs(mechanism, given)
    position = inputs[0]
    # outside of it nothing is known, as where the links cannot close
    reaches = mechanism.reaches
    if reaches is not None:
        inputs[0] = np.where(reaches(position), position, np.nan)
    with np.errstate(all='ignore'):
        if any(v.dtype.kind == 'c' for v in inputs):
            rows = _complex_rows(mechanism, inputs, shape, wanted, with_loads)
        else:
            of_program = [float(v) if i and not v.ndim else np.broadcast_to(v, shape).reshape(-1)
                          for i, v in enumerate(inputs)]
            trace, constants, zeros = (mechanism.record_with_loads if with_loads
                                       else mechanism.record_of_motion)
            wanted = range_of(trace) if wanted is None else wanted
            rows = program(trace, wanted, tuple([type(v) is float for v in of_program]),
                           zeros).run(of_program, constants, prod(shape))
            if mechanism.is_flat_at_zero:
                _set_limits(mechanism, inputs, rows, wanted, with_loads)
    if reaches is not None:
        place = mechanism.MOTION._fields.index(mechanism.input_coordinate.position)
        for i, row in zip(range(len(rows)) if wanted is None else wanted, rows):
            if i == place:
                row[...] = np.broadcast_to(position, shape).reshape(-1)
    return [row.reshape(shape) for row in rows]


@cache
def range_of(trace: Trace) -> tuple[int, ...]:
    """Return the numbers of all results of a trace."""
    return tuple(range(len(flat(trace.results))))


def _inputs(mechanism: Formulas, given: tuple[ArrayLike, ...]
            ) -> tuple[list[Array], tuple[int, ...]]:
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


def _complex_rows(mechanism: Formulas, inputs: list[Array], shape: tuple[int, ...],
                  wanted: tuple[int, ...] | None, with_loads: bool) -> list[Array]:
    """Return the rows of a complex step; angles carry their derivatives."""
    inputs = [np.broadcast_to(v.astype(complex), shape).reshape(-1) for v in inputs]
    fields = mechanism.make_motion(COMPLEX_WITH_ANGLES)(*inputs)
    if with_loads:
        fields += mechanism.make_loads(COMPLEX)(fields)
    fields = fields if wanted is None else [fields[i] for i in wanted]
    return [np.array(np.broadcast_to(field, inputs[0].shape), complex) for field in fields]


def motion_within(motion: Function, reaches: Function | None, numbers: NumberType) -> Function:
    """
    Return a function of motion that has no pose where the mechanism does not reach.

    There it gives NaN, or ValueError where numbers are floats. ``reaches``: as
    :attr:`~fourbar_ros.mechanisms.mechanism.Described.reaches`; None: the motion as it is.
    """
    if reaches is None:
        return motion

    def within_one(position: float, rate: float, acceleration: float) -> Sequence[float]:
        if not reaches(position):
            raise ValueError
        fields: Sequence[float] = motion(position, rate, acceleration)
        return fields

    def within(position: Array, rate: Values, acceleration: Values) -> Any:
        fields = motion(position, rate, acceleration)
        outside = ~reaches(position)
        given = position, rate, acceleration
        if not outside.any():
            return fields
        make = getattr(fields, '_make', tuple)
        return make([field if any(field is value for value in given)
                     else np.where(outside, nan, field) for field in fields])
    return within_one if numbers is REAL else within
