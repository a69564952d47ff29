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
from decimal import Decimal, localcontext
from functools import cache, lru_cache, partial
from math import copysign, inf, isfinite, nan, prod
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanics.bodies import Base, Gravity
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.given import array
from fourbar_ros.numerics.number_types import (
    Function,
    numbers_of,
    NumberType,
    Scalar,
)
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.numerics.write import lines_of, program
import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Mechanism

# Inputs beside a flat position, in its unit, so near that the first term of a result is all of it.
NEAR = Decimal('1e-22'), Decimal('1e-24')
MOST_STRUCTURES = 256      # whose traces and lines are kept


class Constants(NamedTuple):
    """
    The data of a mechanism that its formulas are made for, as floats.

    :func:`~fourbar_ros.numerics.number_types.converted` puts other numbers in their places.
    """

    lengths: Any
    sign: Any
    bodies: Any
    gravity: Gravity
    external: Any


@dataclass(frozen=True)
class Formula:
    """The formula of motion, or of motion and loads, of all mechanisms of a structure."""

    structure: tuple[object, ...]       # all in which formulas differ besides numbers
    with_loads: bool
    mechanism: Mechanism = field(compare=False, repr=False)      # any of the structure

    def make(self, numbers: NumberType, data: Constants) -> Function:
        """Return (position, rate, acceleration) -> motion, or (motion, loads)."""
        motion_of = self.mechanism.motion_formula(numbers, data)
        if not self.with_loads:
            return motion_of
        loads_of = self.mechanism.loads_formula(numbers, data)

        def step(*inputs: Scalar) -> tuple[Any, Any]:
            motion = motion_of(*inputs)
            return motion, loads_of(motion)
        return step


def formula_of(mechanism: Mechanism, with_loads: bool) -> tuple[Formula, Constants]:
    """Return the formula of a mechanism, and the data it is made for."""
    data = mechanism.constants if with_loads else mechanism.constants._replace(bodies=None)
    # springs load links, as a driven crank, for which ``external`` has no field else
    return Formula((*mechanism.structure, type(mechanism.external), type(mechanism.gravity)),
                   with_loads, mechanism), data


@lru_cache(maxsize=MOST_STRUCTURES)
def trace_of(formula: Formula) -> Trace:
    """Return the trace of a formula, which serves all mechanisms of its structure."""
    return Trace(formula.make, 3, formula_of(formula.mechanism, formula.with_loads)[1])


class Recorded(NamedTuple):
    """
    The trace of a mechanism's formula with its own numbers.

    ``constants``: at the place of each step of the trace its value, None if it needs the input;
    ``zeros``: the places of constants that are zero and used together with inputs, so that a
    program can leave out products with them.
    """

    trace: Trace
    constants: list[float | None]
    zeros: frozenset[int]


def recorded(mechanism: Mechanism, with_loads: bool) -> Recorded:
    """Return the trace of a mechanism's motion, or motion and loads, and its own constants."""
    formula, data = formula_of(mechanism, with_loads)
    trace = trace_of(formula)
    constants = trace.constants(numbers_of(data))
    return Recorded(trace, constants, frozenset([
        place for place in trace.used_constants if constants[place] == 0.0]))


@lru_cache(maxsize=MOST_STRUCTURES)
def _lines(formula: Formula, zeros: frozenset[int]) -> Callable[[Sequence[float]], Function]:
    """Return data -> straight line, for a formula whose data at some places are zero."""
    name = 'motion and loads' if formula.with_loads else 'motion'
    return lines_of(trace_of(formula), zeros, f'{formula.mechanism.TITLE}: {name}')


def line_of(mechanism: Mechanism, with_loads: bool) -> Function:
    """
    Return (position, rate, acceleration) -> motion, or (motion, loads), of floats, as tuples.

    A Python function written from the trace: the operations of the formulas in their order, so
    with their bits, but without the calls between them. It is compiled once for a structure.
    """
    formula, data = formula_of(mechanism, with_loads)
    numbers = numbers_of(data)
    zeros = frozenset([i for i, value in enumerate(numbers) if value == 0.0]
                      if mechanism.LEAVES_OUT_ZEROS else ())
    return _lines(formula, zeros)(numbers)


def limits_at_zero(mechanism: Mechanism, rate: float, acceleration: float,
                   with_loads: bool) -> list[float]:
    """
    Return the limits of all fields for an input that falls to 0, a flat position.

    Both parts of a quotient vanish there, so they are computed with many digits at two places
    beside it. What grows from one to the other is a pole, what falls is zero.
    """
    formula, data = formula_of(mechanism, with_loads)
    trace, unit = trace_of(formula), Decimal(mechanism.input_unit)
    from fourbar_ros.numerics.digits import in_decimals, MANY_DIGITS  # flat positions alone
    with localcontext(MANY_DIGITS):
        fields = in_decimals(trace, numbers_of(data), flat(trace.results))
        far, near = [fields(unit * t, Decimal(rate), Decimal(acceleration)) for t in NEAR]
        return [copysign(inf, b) if abs(b) > 8 * abs(a) else
                float(b) if 8 * abs(b) > abs(a) else 0.0 for a, b in zip(far, near)]


def with_limits(mechanism: Mechanism, line: Function, with_loads: bool) -> Function:
    """
    Return a line of :func:`line_of` that gives the limits at a flat position at 0.

    It raises ZeroDivisionError where loads are unbounded.
    """
    limits_of = lru_cache(maxsize=1)(partial(limits_at_zero, mechanism, with_loads=with_loads))
    count = len(mechanism.MOTION._fields)

    def line_with_limits(position: float, rate: float, acceleration: float) -> Any:
        """Return motion, or (motion, loads); at 0 the limits, elsewhere from the line."""
        if position:
            return line(position, rate, acceleration)
        fields = limits_of(rate, acceleration)
        motion, loads = tuple(fields[:count]), tuple(fields[count:])
        if not all(map(isfinite, loads)):
            raise ZeroDivisionError
        return (motion, loads) if with_loads else motion
    return line_with_limits


def _set_limits(mechanism: Mechanism, inputs: Sequence[Any], rows: Sequence[Array],
                wanted: Sequence[int], with_loads: bool) -> None:
    """
    Overwrite samples at input 0, a flat position (0/0 in the formulas), by the limits there.

    ``inputs``: position of shape (n,), rate and acceleration of shape (n,) or one number each;
    ``rows``: of shape (n,), of the fields ``wanted``. Limits are computed once for each pair of
    finite rates.
    """
    at_zero = np.flatnonzero(inputs[0] == 0.0)
    rates = np.stack([np.broadcast_to(v, inputs[0].shape)[at_zero] for v in inputs[1:]])
    for rate, acceleration in np.unique(rates[:, np.isfinite(rates).all(axis=0)], axis=1).T:
        fields = limits_at_zero(mechanism, float(rate), float(acceleration), with_loads)
        samples = at_zero[(rates[0] == rate) & (rates[1] == acceleration)]
        for row, i in zip(rows, wanted):
            row[samples] = fields[i]


def evaluate(mechanism: Mechanism, given: tuple[ArrayLike, ...], wanted: tuple[int, ...] | None,
             with_loads: bool) -> list[Array]:
    """
    Return fields of motion, or of motion and loads, as arrays of the inputs' common shape.

    Samples where the links cannot close, or outside the stroke, are NaN but for the position.

    Parameters
    ----------
    mechanism : Mechanism
    given : tuple of 3
        Position, rate, acceleration; array_like. Complex for a derivative by a complex step.
    wanted : tuple of int, optional
        Numbers of the fields; None: all.
    with_loads : bool
        Whether the fields are those of motion and loads together.

    """
    inputs, shape = _inputs(mechanism, given)
    position, reaches = inputs[0], mechanism.reaches
    if reaches is not None:
        inputs[0] = np.where(reaches(position), position, np.nan)
    with np.errstate(all='ignore'):
        if any(v.dtype.kind == 'c' for v in inputs):
            rows = _complex_rows(mechanism, inputs, shape, wanted, with_loads)
        else:
            # a rate that is one number stays one: all that follows from it is computed once
            flattened = [float(v) if i and not v.ndim else np.broadcast_to(v, shape).reshape(-1)
                         for i, v in enumerate(inputs)]
            trace, constants, zeros = (mechanism.record_with_loads if with_loads
                                       else mechanism.record_of_motion)
            wanted = range_of(trace) if wanted is None else wanted
            rows = program(trace, wanted, tuple([type(v) is float for v in flattened]),
                           zeros)(flattened, constants, prod(shape))
            if mechanism.is_flat_at_zero:
                _set_limits(mechanism, flattened, rows, wanted, with_loads)
    if reaches is not None:             # the position itself is known out of reach too
        place = mechanism.MOTION._fields.index(mechanism.input_coordinate.position)
        for i, row in zip(range(len(rows)) if wanted is None else wanted, rows):
            if i == place:
                row[...] = np.broadcast_to(position, shape).reshape(-1)
    return [row.reshape(shape) for row in rows]


@cache
def range_of(trace: Trace) -> tuple[int, ...]:
    """Return the numbers of all results of a trace."""
    return tuple(range(len(flat(trace.results))))


def _inputs(mechanism: Mechanism, given: tuple[ArrayLike, ...]
            ) -> tuple[list[Array], tuple[int, ...]]:
    """Return position, rate and acceleration as arrays (complex if given so), and their shape."""
    names = mechanism.input_coordinate
    inputs = [array(name, value, name == names.position) for name, value in zip(names, given)]
    if not any(v.ndim for v in inputs[1:]):
        return inputs, inputs[0].shape
    try:
        return inputs, np.broadcast_shapes(*(v.shape for v in inputs))
    except ValueError:
        raise InvalidParameter(', '.join(names), ', '.join(str(v.shape) for v in inputs),
                               'must have shapes that broadcast') from None


@lru_cache(maxsize=2 * MOST_STRUCTURES)
def order_of(trace: Trace, wanted: tuple[int, ...]
             ) -> tuple[list[int], list[int], dict[int, list[int]]]:
    """
    Return the steps that some results need, of data alone and of inputs, and what is done with.

    {place of a step: places that it is the last one to need}, of inputs.
    """
    results = flat(trace.results)
    places = [results[i] for i in wanted]
    steps = [i for i in trace.needed(places) if not trace.steps[i].is_given]
    once, varying = [[i for i in steps if (i in trace.varies) is varies]
                     for varies in (False, True)]
    last = {i: place for place in varying for i in trace.steps[place].arguments
            if i in trace.varies}
    done: dict[int, list[int]] = {}
    for i in last.keys() - places:
        done.setdefault(last[i], []).append(i)
    return once, varying, done


def step_of_arrays(mechanism: Mechanism, with_loads: bool, data: Constants | None = None,
                   wanted: Sequence[int] | None = None) -> Function:
    """
    Return (position, rate, acceleration) -> fields of motion, and of loads, as a list.

    Of arrays, real or complex, that broadcast; by the trace, with the operations of numpy.
    ``data``: columns in place of the mechanism's own :attr:`constants`, of many like it.
    ``wanted``: numbers of the fields, by default all; no others are computed, they are NaN.
    """
    from fourbar_ros.numerics.tables import ARRAYS, run  # nodes take one sample at a time
    trace, known, _ = (mechanism.record_with_loads if with_loads else mechanism.record_of_motion)
    places = flat(trace.results)
    wanted = range_of(trace) if wanted is None else wanted
    once, steps, done = order_of(trace, tuple(wanted))
    if data is not None:
        known = [trace.steps[i].value for i in range(len(known))]
        known[trace.count:trace.count + trace.size] = numbers_of(
            data if with_loads else data._replace(bodies=None))
        with np.errstate(all='ignore'):
            run(trace, once, ARRAYS, known)

    def step(*inputs: Values) -> list[Values]:
        """Return the fields, arrays or single numbers."""
        values = run(trace, steps, ARRAYS, [*inputs, *known[trace.count:]], done)
        fields: list[Values] = [nan] * len(places)
        for i in wanted:
            fields[i] = values[places[i]]
        return fields
    return step


def loads_on_bases(mechanism: Mechanism, given: tuple[ArrayLike, ...], base: Base) -> NamedFields:
    """Return the loads for arrays of inputs and of motions of the base that broadcast, real."""
    names = [*mechanism.input_coordinate, *base._fields]
    values = [array(name, value, not i) for i, (name, value) in enumerate(
        zip(names, (*given, *base)))]
    try:
        values = [np.array(value, float) for value in np.broadcast_arrays(*values)]
    except ValueError:
        raise InvalidParameter(', '.join(names), ', '.join(str(v.shape) for v in values),
                               'must have shapes that broadcast') from None
    position, reaches, on_base = values[0], mechanism.reaches, mechanism.with_base(Base())
    shape, start = position.shape, len(mechanism.MOTION._fields)
    if reaches is not None:
        position[~np.asarray(reaches(position))] = np.nan
    step = step_of_arrays(on_base, True, data=on_base.constants._replace(
        gravity=Base._make(values[3:])), wanted=range(start, start + len(mechanism.LOADS._fields)))
    with np.errstate(all='ignore'):
        rows = [np.array(np.broadcast_to(row, shape)) for row in step(*values[:3])[start:]]
    if mechanism.is_flat_at_zero:
        for place in zip(*np.nonzero(position == 0.0)):
            x, rate, acceleration, *of_base = [float(value[place]) for value in values]
            try:
                limits = [*mechanism.with_base(Base(*of_base)).loads(x, rate, acceleration)]
            except FourBarError:
                limits = [nan] * len(rows)
            for row, limit in zip(rows, limits):
                row[place] = limit
    found: NamedFields = mechanism.LOADS._make(rows)
    return found


def _complex_rows(mechanism: Mechanism, inputs: list[Array], shape: tuple[int, ...],
                  wanted: tuple[int, ...] | None, with_loads: bool) -> list[Array]:
    """Return the wanted fields for complex inputs x + i h: derivatives are imag / h."""
    inputs = [np.broadcast_to(v.astype(complex), shape).reshape(-1) for v in inputs]
    fields = step_of_arrays(mechanism, with_loads, wanted=wanted)(*inputs)
    return [np.array(np.broadcast_to(field, inputs[0].shape), complex)
            for field in (fields if wanted is None else [fields[i] for i in wanted])]


def line_within(motion: Function, reaches: Function | None) -> Function:
    """
    Return a line of motion limited to the inputs that ``reaches`` allows, all if it is None.

    Elsewhere it raises ValueError. ``reaches``: see
    :attr:`~fourbar_ros.mechanisms.mechanism.Mechanism.reaches`.
    """
    if reaches is None:
        return motion

    def within(position: float, rate: float, acceleration: float) -> Any:
        """Return the motion of one sample; ValueError if its position is out of reach."""
        if not reaches(position):
            raise ValueError
        return motion(position, rate, acceleration)
    return within
