# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a formula does, written down once.

:class:`Number` is one more kind of number for the formulas: arithmetic with it writes down what is
done. From that record :mod:`fourbar_ros.numerics.program` replays on arrays what is asked for.

A record belongs to a kind of mechanism, not to one: what a formula is made for, lengths and
masses, is recorded too, and what depends on that alone is computed once for each mechanism, as
:class:`Constants`.
"""
from __future__ import annotations

import math
import operator
from typing import Any, NamedTuple

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import (
    choose,
    converted,
    Function,
    hypot_of_arrays,
    NumberType,
    power_of_two,
)
import numpy as np

Step = Any        # (name of the operation, places of its arguments), or None for what is given


def _where(condition: Array, one: Any, other: Any, out: Array) -> None:
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
        self.used = sorted(used - varies - self.known.keys())
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
        zeros = [place for place in self.used if values[place] == 0.0]
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
