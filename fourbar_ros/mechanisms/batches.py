# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism evaluated for arrays of inputs, by programs of numpy written from its trace."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache
from math import nan
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.mechanisms.evaluation import Constants, formula_of, MOST_STRUCTURES, trace_of
from fourbar_ros.mechanisms.parts import is_within, NamedFields
from fourbar_ros.numerics.arguments import array, FARTHEST
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.number_types import Function, numbers_of
from fourbar_ros.numerics.tables import ARRAYS, run
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.numerics.write_arrays import keep_memory, program
import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Mechanism


def evaluate(mechanism: Mechanism, inputs: tuple[ArrayLike, ...], wanted: tuple[int, ...] | None,
             with_loads: bool) -> list[Array]:
    """Return fields of motion, or of motion and loads, as arrays of the inputs' common shape."""
    # Samples where the links cannot close, outside the stroke, or at angles so far that floats are
    # 4 rad apart, are NaN but for the position. inputs: position, rate, acceleration; complex for
    # a derivative by a complex step. wanted: indices of the fields; None: all.
    arrays, shape = _inputs(mechanism.input_coordinate, inputs)
    position = arrays[0]
    is_known = _is_known(mechanism, position)
    if is_known is not None:
        arrays[0] = np.where(is_known, position, np.nan)
    with np.errstate(all='ignore'):
        trace, constants, zeros = mechanism.record(with_loads)
        wanted = range_of(trace) if wanted is None else wanted
        is_complex = any(v.dtype.kind == 'c' for v in arrays)
        flattened = [np.broadcast_to(v.astype(complex) if is_complex else v, shape).reshape(-1)
                     for v in arrays]
        if is_complex:              # x + i h: derivatives are imag / h
            fields = step_of_arrays(mechanism, with_loads, wanted=wanted)(*flattened)
            rows = [np.array(np.broadcast_to(fields[i], flattened[0].shape), complex)
                    for i in wanted]
        else:
            rows = program(trace, wanted, zeros)(flattened, constants)
    if is_known is not None:            # the position itself is known out of reach too
        of_input = mechanism.MOTION._fields.index(mechanism.input_coordinate.position)
        for i, row in zip(wanted, rows):
            if i == of_input:
                row[...] = np.broadcast_to(position, shape).reshape(-1)
    return [row.reshape(shape) for row in rows]


def _is_known(mechanism: Mechanism, position: Array) -> Array | None:
    """Return which inputs are in the stroke and no angles too far off; None: all are."""
    # Of several dyads those before the one that does not close would have a pose: where not all
    # close, none has.
    angles: Any = position.real
    reaches = mechanism.reaches
    with np.errstate(invalid='ignore'):         # of inputs that are infinite
        known = [] if reaches is None else [reaches(position)]
        if len(mechanism.layout.stages) > 1 and not mechanism.closes_fully:
            known.append(np.any([is_within(angles, ends, mechanism.period)
                                 for ends in mechanism.closing_ranges], axis=0))
    if not mechanism.is_driven_by_slide and angles.size and not (
            angles.min() > -FARTHEST and angles.max() < FARTHEST):
        known.append(np.abs(angles) < FARTHEST)
    return np.logical_and.reduce(known) if known else None


@cache
def range_of(trace: Trace) -> tuple[int, ...]:
    """Return the indices of all results among each other."""
    return tuple(range(len(flat(trace.results))))


def _inputs(names: Sequence[str], values: Sequence[ArrayLike]
            ) -> tuple[list[Array], tuple[int, ...]]:
    """Return inputs, and the motion of a base, as arrays, and their common shape."""
    inputs = [array(name, value, name == names[0]) for name, value in zip(names, values)]
    try:
        return inputs, np.broadcast_shapes(*(v.shape for v in inputs))
    except ValueError:
        raise InvalidParameter(', '.join(names), ', '.join(str(v.shape) for v in inputs),
                               'must have shapes that broadcast') from None


class Order(NamedTuple):
    """Indices of the operations that some results of a trace need, in order."""

    results: list[int]
    of_data: list[int]                  # operations on data alone
    of_inputs: list[int]
    freed: dict[int, list[int]]         # those whose last use is an operation, by its index


@lru_cache(maxsize=2 * MOST_STRUCTURES)
def order_of(trace: Trace, wanted: tuple[int, ...]) -> Order:
    results = flat(trace.results)
    indices = [results[i] for i in wanted]
    steps = [i for i in trace.needed(indices) if not trace.steps[i].is_given]
    of_data, of_inputs = [[i for i in steps if (i in trace.varies) is varies]
                          for varies in (False, True)]
    last = {i: index for index in of_inputs for i in trace.steps[index].arguments
            if i in trace.varies}
    freed: dict[int, list[int]] = {}
    for i in last.keys() - indices:
        freed.setdefault(last[i], []).append(i)
    return Order(indices, of_data, of_inputs, freed)


def step_of_arrays(mechanism: Mechanism, with_loads: bool, data: Constants | None = None,
                   wanted: Sequence[int] | None = None) -> Function:
    """Return (position, rate, acceleration) -> fields of motion, and of loads, as a list."""
    # Of arrays, real or complex, that broadcast; by the trace, with the operations of numpy. data:
    # columns for the constants of many mechanisms like this. wanted: indices of the fields, by
    # default all; the rest is not computed, it is NaN.
    keep_memory()
    trace, known, _ = mechanism.record(with_loads)
    count = len(range_of(trace))
    wanted = range_of(trace) if wanted is None else tuple(wanted)
    if data is not None:
        columns = numbers_of(data if with_loads else data.of_motion)
        trace = trace_of(formula_of(mechanism, with_loads))
        known = trace.numbers(columns)
        with np.errstate(all='ignore'):
            run(trace, [i for i in trace.makes_switches if known[i] is None], ARRAYS, known)
            # no change point among them: leave out what only change points need
            if not any(np.any(np.asarray(known[i])) for i in trace.switches):
                trace = trace.unswitched
            for index, value in trace.literals().items():       # also new ones, of unswitched
                known[index] = value
            run(trace, [i for i in order_of(trace, wanted).of_data if known[i] is None], ARRAYS,
                known)                                          # written into known
    order = order_of(trace, wanted)

    def step(*inputs: Values) -> list[Values]:
        values = run(trace, order.of_inputs, ARRAYS, [*inputs, *known[trace.count:]], order.freed)
        fields: list[Values] = [nan] * count
        for i, index in zip(wanted, order.results):
            fields[i] = values[index]
        return fields
    return step


def are_switched(mechanism: Mechanism, data: Constants) -> Array:
    """Return which of many mechanisms are change points where it is none, or not as it is."""
    # By their lengths, the columns of data; shape (n, 1), or () if all are alike.
    formula = formula_of(mechanism, False)
    trace = trace_of(formula)
    known = trace.numbers(numbers_of(data.of_motion))
    with np.errstate(all='ignore'):
        run(trace, [i for i in trace.makes_switches if known[i] is None], ARRAYS, known)
    of_this = trace.constants(numbers_of(formula.data), trace.makes_switches)
    return np.asarray(np.any(np.broadcast_arrays(False, *[
        known[i] != of_this[i] for i in trace.switches]), axis=0))


def loads_on_bases(mechanism: Mechanism, inputs: tuple[ArrayLike, ...], base: Base) -> NamedFields:
    """Return the loads for real arrays of inputs and of motions of the base, which broadcast."""
    # The formula of a mechanism on any base, with columns for the numbers of the base.
    values, shape = _inputs([*mechanism.input_coordinate, *base._fields], [*inputs, *base])
    values = [np.array(np.broadcast_to(value, shape), float) for value in values]
    position, on_base = values[0], mechanism.with_base(Base())
    start, is_known = len(mechanism.MOTION._fields), _is_known(mechanism, position)
    if is_known is not None:
        position[~np.asarray(is_known)] = np.nan
    step = step_of_arrays(on_base, True, data=on_base.constants._replace(
        gravity=Base._make(values[3:])), wanted=range(start, start + len(mechanism.LOADS._fields)))
    with np.errstate(all='ignore'):
        rows = [np.array(np.broadcast_to(row, shape)) for row in step(*values[:3])[start:]]
    return mechanism.LOADS._make(rows)
