# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A formula recorded once and replayed on arrays.

Only what was asked for, in buffers that stay in the cache.

:class:`Number` is one more kind of number for the formulas: arithmetic with it writes down what is
done. From that record a :class:`Program` takes the operations that some results need, does those
of single numbers once, gives each of the others numpy's function and a buffer, and uses a buffer
again when nothing needs its content any more. Operations, their order and so their results are
those of the formula on arrays.

A record belongs to a kind of mechanism, not to one: what a formula is made for, lengths and
masses, is recorded too, and what depends on that alone is computed once for each mechanism, as
:class:`Constants`.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cache
import math
import operator
from typing import Any, NamedTuple

from fourbar_ros.numerics.number_types import (
    choose,
    converted,
    Function,
    hypot_of_arrays,
    NumberType,
    power_of_two,
)
import numpy as np

CHUNK = 12288     # most samples at a time
Step = Any        # (name of the operation, places of its arguments), or None for what is given



def _where(condition: np.ndarray, one: Any, other: Any, out: np.ndarray) -> None:
    np.copyto(out, other)
    np.copyto(out, one, where=condition)


# For each operation the function of floats and that of arrays, whose last argument is where the
# result goes; lengths are no arrays.
OPERATIONS: dict[str, tuple[Function, Function | None]] = {
    'add': (operator.add, np.add), 'sub': (operator.sub, np.subtract),
    'mul': (operator.mul, np.multiply),
    'truediv': (operator.truediv, np.true_divide), 'neg': (operator.neg, np.negative),
    'pow': (operator.pow, None),
    'gt': (operator.gt, np.greater), 'lt': (operator.lt, np.less), 'sin': (math.sin, np.sin),
    'cos': (math.cos, np.cos),
    'sqrt': (math.sqrt, np.sqrt), 'atan2': (math.atan2, np.arctan2), 'fabs': (math.fabs, np.abs),
    'hypot': (math.hypot, hypot_of_arrays), 'where': (choose, _where),
    'exact_sum': (lambda *terms: math.fsum(terms), None), 'power_of_two': (power_of_two, None)}
_CONDITIONS = ('gt', 'lt')
_NOT_IN_PLACE = ('where', 'hypot')     # they read their arguments after they began to write


class Number:
    """A number that is not known yet: its place in a record."""

    __slots__ = ('place', 'record')

    def __init__(self, record: Any, place: int):
        self.record, self.place = record, place

    @property
    def real(self) -> Number:
        """Return itself: recorded numbers are real."""
        return self

    def __bool__(self) -> bool:
        raise TypeError('formulas choose with where(), not with if')


def _method(name: str, is_reflected: bool) -> Function:
    if is_reflected:
        return lambda self, other: self.record.add(name, other, self)
    return lambda self, *others: self.record.add(name, self, *others)


for _name in ('add', 'sub', 'mul', 'truediv', 'neg', 'pow', 'gt', 'lt'):
    setattr(Number, f'__{_name}__', _method(_name, False))
    if _name in ('add', 'sub', 'mul', 'truediv'):
        setattr(Number, f'__r{_name}__', _method(_name, True))


def _function(name: str) -> Function:
    def call(*values: Any) -> Any:
        known = [value for value in values if isinstance(value, Number)]
        return known[0].record.add(name, *values) if known else OPERATIONS[name][0](*values)
    return call


def _choice(condition: Any, one: Any, other: Any) -> Any:
    if isinstance(condition, bool):
        return one if condition else other
    if isinstance(one, tuple):
        return tuple(_choice(condition, a, b) for a, b in zip(one, other))
    return condition.record.add('where', condition, one, other)


_exact_sum = _function('exact_sum')
RECORDED = NumberType('recorded', _function('sin'), _function('cos'), _function('sqrt'),
                      _function('atan2'), _function('hypot'), _function('fabs'), _choice,
                      lambda terms: _exact_sum(*terms), _function('power_of_two'))


class Record:
    """
    What formulas do to three inputs: motion(x, rate, acceleration), then, if given, loads(motion).

    ``steps``: for each place (operation, places of its arguments), or None for what is given: the
    inputs, the data that the formulas are made for, numbers in their text (``known``: {place:
    value}). ``results``: places.
    ``is_constant``: the places of what depends on the data alone. ``operations``: number of the
    other steps.

    Parameters
    ----------
    make_formulas : callable
        (RECORDED, data) -> the formulas.
    data
        Nested records of floats: any, as all data have the same record.

    """

    def __init__(self, make_formulas: Function, data: Any):
        self.steps: list[Step] = []
        self.known: dict[int, float] = {}
        given: Any = [self._given() for _ in range(3)]
        data = converted(data, lambda value: self._given())
        self.end_of_data = len(self.steps)
        self.results: list[int] = []
        for formula in make_formulas(RECORDED, data):
            given = formula(*given)
            self.results += [self._place(value) for value in given]
            given = (given,)
        self._find_constants()

    def _find_constants(self) -> None:
        varies, used = {0, 1, 2}, set(self.results)
        for place, step in enumerate(self.steps):
            if step is not None and not varies.isdisjoint(step[1]):
                varies.add(place)
                used.update(step[1])
        self.is_constant = frozenset([place for place, step in enumerate(self.steps)
                                      if step is not None and place not in varies])
        self._used = sorted(used - varies - self.known.keys())
        self.operations = len(varies) - 3

    def constants_for(self, data: Any) -> Constants:
        """Return the :class:`Constants` of data like those it was made with."""
        values: list[Any] = [None] * len(self.steps)
        for place, value in self.known.items():
            values[place] = value
        found: list[float] = []
        converted(data, found.append)
        values[3:self.end_of_data] = found
        for place in sorted(self.is_constant):
            name, arguments = self.steps[place]
            values[place] = OPERATIONS[name][0](*[values[i] for i in arguments])
        zeros = [place for place in self._used if values[place] == 0.0]
        return Constants(values, frozenset(zeros))

    def add(self, name: str, *values: Any) -> Number:
        """Write down an operation and return its result."""
        self.steps.append((name, tuple([self._place(value) for value in values])))
        return Number(self, len(self.steps) - 1)

    def _given(self) -> Number:
        self.steps.append(None)
        return Number(self, len(self.steps) - 1)

    def _place(self, value: Any) -> int:
        if not isinstance(value, Number):
            place = self._given().place
            self.known[place] = value
            return place
        return value.place


class Constants(NamedTuple):
    """
    What a record knows of one mechanism before there are inputs.

    Parameters
    ----------
    values : list
        By place; None for what depends on the inputs.
    zeros : frozenset of int
        The places of those that are zero and used together with inputs.

    """

    values: list[Any]
    zeros: frozenset[int]


def _without_zeros(record: Record, zeros: frozenset[int]) -> tuple[list[Step], list[int]]:
    """Return the steps without products and sums of zero, and the new place of each number."""
    steps, same = list(record.steps), list(range(len(record.steps)))
    for place, step in enumerate(record.steps):
        if step is None or place in record.is_constant:
            continue
        name, arguments = step[0], tuple([same[i] for i in step[1]])
        steps[place] = name, arguments
        is_zero = [i in zeros for i in arguments]
        if name == 'mul' and any(is_zero) or name in ('add', 'sub', 'neg') and all(is_zero):
            same[place] = arguments[is_zero.index(True)]
        elif name in ('add', 'sub') and is_zero[1]:
            same[place] = arguments[0]
        elif name == 'add' and is_zero[0]:
            same[place] = arguments[1]
    return steps, same


def _carriers(steps: list[Step], places: Sequence[int]) -> list[frozenset[int]]:
    """
    Return for each result the inputs and roots it depends on.

    What makes it NaN out of range.
    """
    found: list[frozenset[int]] = []
    for place, step in enumerate(steps):
        if step is None:
            found.append(frozenset((place,)) if place < 3 else frozenset())
        else:
            carried = frozenset[int]().union(*[found[i] for i in step[1]])
            found.append(carried | {place} if step[0] == 'sqrt' else carried)
    return [found[place] & _pose(steps) for place in places]


def _pose(steps: list[Step]) -> frozenset[int]:
    """
    Return the places of the position and of all roots.

    Not of rate and acceleration, which may be multiplied by zero.
    """
    return frozenset((0, *(place for place, step in enumerate(steps) if step is not None
                           and step[0] == 'sqrt')))


class Program:
    """
    The operations of a record that some results need.

    Parameters
    ----------
    record : Record
    wanted : sequence of int
        Which results.
    single : sequence of 3 bools
        Which inputs are one number for all samples.
    zeros : frozenset of int
        Which constants are zero: what only adds zero is left out, unless a result would then no
        longer be NaN where it should.

    """

    def __init__(self, record: Record, wanted: Sequence[int], single: Sequence[bool],
                 zeros: frozenset[int] = frozenset()):
        self._record, results = record, [record.results[i] for i in wanted]
        self._is_single = [True] * len(record.steps)
        self._is_single[:3] = single
        self._steps, same = _without_zeros(record, zeros)
        self._places = [same[place] for place in results]
        if _carriers(self._steps, self._places) != _carriers(record.steps, results):
            self._steps, self._places = record.steps, results
        steps = self._needed()
        for place in steps:
            self._is_single[place] = all(self._is_single[i] for i in self._steps[place][1])
        self._once = [self._once_step(place) for place in steps if self._is_single[place]]
        self._buffers: list[type] = []
        self.steps = self._allocate([place for place in steps if not self._is_single[place]])

    def _needed(self) -> list[int]:
        """Return the places of the operations that the results need, in order."""
        steps, needed, left = self._steps, set(), list(self._places)
        while left:
            place = left.pop()
            if (place not in needed and steps[place] is not None
                    and place not in self._record.is_constant):
                needed.add(place)
                left += steps[place][1]
        return sorted(needed)

    def _once_step(self, place: int) -> tuple[int, Function, tuple[int, ...]]:
        name, arguments = self._steps[place]
        return place, OPERATIONS[name][0], arguments

    def _allocate(self, places: list[int]) -> list[tuple[Any, Function]]:
        """
        Return (numpy's function, what takes its arguments from the values) of all steps.

        Results own their places.
        """
        size = len(self._record.steps)
        last = {i: place for place in places for i in self._steps[place][1]}
        results: set[int] = set(self._places)
        free: list[int] = []
        where: dict[int, int] = {}
        found: list[tuple[Any, Function]] = []
        for place in places:
            name, arguments = self._steps[place]
            done = [where[i] for i in dict.fromkeys(arguments) if i in where and last[i] == place]
            done = [buffer for buffer in done if self._buffers[buffer] is float]
            if name not in _NOT_IN_PLACE:
                free += done
            if place not in results:
                if free and name not in _CONDITIONS:
                    where[place] = free.pop()
                else:
                    where[place] = len(self._buffers)
                    self._buffers.append(bool if name in _CONDITIONS else float)
            if name in _NOT_IN_PLACE:
                free += done
            taken = [size + where[i] if i in where else i for i in (*arguments, place)]
            found.append((OPERATIONS[name][1], operator.itemgetter(*taken)))
        return found

    def run(self, inputs: Sequence[Any], constants: Constants, size: int) -> list[np.ndarray]:
        """Return the results for inputs, each (size,) or a float, as arrays with own memory."""
        values = [*inputs, *constants.values[3:]]
        for place, function, arguments in self._once:
            values[place] = function(*[values[i] for i in arguments])
        rows = [np.empty(size) for _ in self._places]
        count = -(-size // -(-size // CHUNK)) if size else 1     # chunks of equal size
        buffers: list[Any] = [np.empty(count, kind) for kind in self._buffers]
        many = [i for i in range(3) if not self._is_single[i]]
        for start in range(0, size, count):
            part = slice(start, start + count)
            work = values + (buffers if start + count <= size
                             else [b[:size - start] for b in buffers])
            for i in many:
                work[i] = inputs[i][part]
            self._replay(work, [row[part] for row in rows])
        return rows

    def _replay(self, values: list[Any], rows: list[np.ndarray]) -> None:
        own: dict[int, np.ndarray] = {}
        for place, row in zip(self._places, rows):
            if self._steps[place] is not None and not self._is_single[place]:
                own.setdefault(place, row)
        for place, row in own.items():
            values[place] = row
        for function, arguments in self.steps:
            function(*arguments(values))
        for place, row in zip(self._places, rows):
            if own.get(place) is not row:     # an input, one number, or a result twice
                row[...] = values[place]


@cache
def program(record: Record, wanted: tuple[int, ...], single: tuple[bool, ...],
            zeros: frozenset[int]) -> Program:
    """Return the :class:`Program` of a record, made once."""
    return Program(record, wanted, single, zeros)
