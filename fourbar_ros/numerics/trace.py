# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The operations of a formula, written down once; all fast code is written from them.

:class:`Number` is one more type of number for formulas: arithmetic with it is written down as a
:class:`Trace`, a list of steps, each one operation on the results of earlier steps. A trace
belongs to a structure, not to one mechanism: lengths and masses are *data*, as the inputs are
inputs, and what depends on data alone is computed once for each mechanism.

Functions of a trace are made by :mod:`fourbar_ros.numerics.write`: Python of floats, calls of
numpy for arrays. One for another language has to walk
:attr:`Trace.steps`, and needs nothing else.

A step is there once, however often the formula asks for it, and a minus sign is moved into the
sum that takes it: neither changes a bit of a result. :meth:`Trace.simplified` leaves out what
known zeros and ones do; the sign of a zero may change there.
"""
from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import cached_property
import math
import operator
from typing import Any, NamedTuple

from fourbar_ros.numerics import number_types
from fourbar_ros.numerics.number_types import converted, Function, numbers_of, NumberType

OPERATIONS: dict[str, Function] = {
    'add': operator.add, 'sub': operator.sub, 'mul': operator.mul, 'truediv': operator.truediv,
    'neg': operator.neg, 'pow': operator.pow, 'gt': operator.gt, 'lt': operator.lt,
    'sin': math.sin, 'cos': math.cos, 'sqrt': math.sqrt, 'atan2': math.atan2, 'fabs': math.fabs,
    'hypot': math.hypot, 'where': number_types.choose,
    'exact_sum': lambda *terms: number_types.exact_sum(terms),
    'power_of_two': number_types.power_of_two}
COMMUTES = ('add', 'mul')
NEUTRAL = {'add': 0.0, 'sub': 0.0, 'mul': 1.0, 'truediv': 1.0}     # x + 0, x - 0, 1 x, x / 1
# operations that raise for some floats: a root of a negative number, a division by zero
REFUSING = ('sqrt', 'truediv', 'pow', 'exact_sum', 'power_of_two')

MakeFormula = Callable[[NumberType, Any], Function]      # (number type, data) -> formula


class Step(NamedTuple):
    """One operation of a trace."""

    # It is one of OPERATIONS; 'call' of a function that is no formula; 'input', 'datum' or
    # 'constant' of a number that is given; 'nothing' where a step was left out.
    operation: str
    arguments: tuple[int, ...] = ()      # indices of the steps whose results it takes
    value: Any = None                    # of a constant its number, of a call its function

    @property
    def is_given(self) -> bool:
        return self.operation in ('input', 'datum', 'constant', 'nothing')

    def of(self, *values: float) -> Any:
        return (OPERATIONS.get(self.operation) or self.value)(*values)


NOTHING = Step('nothing')


class Number:
    """A number that is not known yet: its index in a trace."""

    __slots__ = ('index', 'trace')

    def __init__(self, trace: Trace, index: int) -> None:
        self.trace, self.index = trace, index

    @property
    def real(self) -> Number:
        return self

    def __bool__(self) -> bool:
        raise TypeError('formulas choose with where(), not with if')


# What an operation of a trace is written down for.
Recordable = Number | float


def _method(name: str, is_reflected: bool) -> Function:
    """Return the method of Number that records an operator; reflected: 2.0 - x, of x."""
    def method(self: Number, *operands: Recordable) -> Recordable:
        if not all(isinstance(operand, (Number, float, int)) for operand in operands):
            return NotImplemented       # type: ignore[no-any-return]  # a sign for Python
        return self.trace.add(name, *(operands + (self,) if is_reflected else (self, *operands)))
    return method


for _name in ('add', 'sub', 'mul', 'truediv', 'neg', 'pow', 'gt', 'lt'):
    setattr(Number, f'__{_name}__', _method(_name, False))
    if _name in ('add', 'sub', 'mul', 'truediv'):
        setattr(Number, f'__r{_name}__', _method(_name, True))
# what np.sqrt(number) and the like ask for, in functions of users
for _name, _of_numpy in (('sin', 'sin'), ('cos', 'cos'), ('sqrt', 'sqrt'), ('hypot', 'hypot'),
                         ('atan2', 'arctan2')):
    setattr(Number, _of_numpy, _method(_name, False))


def _function(name: str) -> Function:
    """Return a function that is recorded if one of its arguments is, else computed at once."""
    def call(*values: Recordable) -> Recordable:
        recorded = [value for value in values if isinstance(value, Number)]
        return recorded[0].trace.add(name, *values) if recorded else OPERATIONS[name](*values)
    return call


def _choice(condition: Any, if_true: Any, if_false: Any) -> Any:
    """Record ``where(condition, if_true, if_false)``, of tuples item by item; a bool decides."""
    if isinstance(condition, bool):
        return if_true if condition else if_false
    if isinstance(if_true, tuple):
        return tuple(_choice(condition, a, b) for a, b in zip(if_true, if_false))
    return condition.trace.add('where', condition, if_true, if_false)


# The table that writes a trace while another one is run.
RECORDING: dict[str, Function] = {**{name: _function(name) for name in OPERATIONS},
                                  'where': _choice}
RECORDED = NumberType(
    **{name: RECORDING[name] for name in ('sin', 'cos', 'sqrt', 'atan2', 'hypot', 'fabs', 'where',
                                          'power_of_two')},
    exact_sum=lambda terms: RECORDING['exact_sum'](*terms),
    call=lambda function, x: (x.trace.add('call', x, value=function) if isinstance(x, Number)
                              else function(x)))


class Trace:
    """
    What a formula does.

    ``make_formula``: (number type, data) -> formula, a function of ``count`` numbers that gives a
    sequence of numbers or of such sequences. ``data``: nested records of floats, any, as all data
    of a structure have the same record; ``size`` counts these. ``steps``: first the inputs, then
    the data, then all others, each after its arguments. ``results``, nested, and ``varies``, a
    set: the indices of the results of the formula, and of all that depends on an input.
    """

    def __init__(self, make_formula: MakeFormula, count: int, data: Any = ()) -> None:
        """Run the formula once on numbers that record their operations."""
        self.steps: list[Step] = []
        self._index_of: dict[Hashable, int] = {}
        self.count, self.size = count, len(numbers_of(data))
        self.varies = set(range(count))
        inputs = [Number(self, self._append(Step('input'))) for _ in range(count)]
        of_data = iter([Number(self, self._append(Step('datum'))) for _ in range(self.size)])
        # converted() takes them one by one, in the order of numbers_of()
        formula = make_formula(RECORDED, converted(data, lambda _: next(of_data)))
        self.results: Any = converted(formula(*inputs), self._index)

    def add(self, operation: str, *values: Recordable, value: Any = None) -> Recordable:
        """Write down an operation on numbers of this trace and floats; return its result."""
        # Nothing is written for factors and terms 0.0 and 1.0 that stand in the formula; what must
        # be NaN where a number is not real adds the difference of that number and itself.
        if len(values) == 2:
            i = int(isinstance(values[0], Number))
            literal = values[i]
            if not isinstance(literal, Number) and literal in (0.0, 1.0):
                index = _passed(operation, (0, 1), {i: literal})
                if index is not None:
                    return 0.0 if index == i else values[index]
                if operation == 'sub' and i == 0 and literal == 0.0:
                    operation, values = 'neg', values[1:]
        return Number(self, self._add(operation, tuple([self._index(v) for v in values]), value))

    def _add(self, operation: str, indices: tuple[int, ...], value: Any = None) -> int:
        """Append an operation on the results at some indices, and return its index."""
        # Minus signs move outwards, so that equal terms meet: x + (-y) becomes x - y, (-x) y
        # becomes -(x y). Those of data stay, as data are computed once, and so does (-x) - y,
        # whose zero would change its sign: no bit changes.
        without = [step.arguments[0] if (step := self.steps[index]).operation == 'neg' else None
                   for index in indices]
        if operation == 'neg' and without[0] is not None:
            return without[0]
        if operation == 'add' and without[1] is not None:
            return self._add('sub', (indices[0], without[1]))
        if operation == 'add' and without[0] is not None:
            return self._add('sub', (indices[1], without[0]))
        if operation == 'sub' and without[1] is not None:
            return self._add('add', (indices[0], without[1]))
        if operation in ('mul', 'truediv'):
            for i, index in enumerate(without):
                if index is not None and indices[i] in self.varies:
                    positive = self._add(operation, (*indices[:i], index, *indices[i + 1:]))
                    return self._add('neg', (positive,))
        return self._append(Step(operation, indices, value))

    def _index(self, value: Recordable) -> int:
        return (value.index if isinstance(value, Number)
                else self._append(Step('constant', (), float(value))))

    def _append(self, step: Step) -> int:
        """Return the index of a step: that of the same step before, else a new one at the end."""
        key = len(self.steps) if step.operation in ('input', 'datum') else _key(step)
        index = self._index_of.setdefault(key, len(self.steps))
        if index == len(self.steps):
            self.steps.append(step)
            if step.arguments and not self.varies.isdisjoint(step.arguments):
                self.varies.add(index)
        return index

    def begin_apart(self) -> int:
        """Return the number of steps so far; from here on none of them is used again."""
        self._index_of.clear()
        return len(self.steps)

    @cached_property
    def used_constants(self) -> list[int]:
        """Return the indices of results of data alone that are used with inputs or as results."""
        used = {i for index in self.varies for i in self.steps[index].arguments}
        return [i for i in sorted(used.union(flat(self.results)) - self.varies)
                if self.steps[i].operation != 'constant']

    @cached_property
    def switches(self) -> frozenset[int]:
        """Return the indices of conditions of data alone that choose between numbers of inputs."""
        # In formulas of linkages each is true for change points only.
        return frozenset([step.arguments[0] for index, step in enumerate(self.steps)
                          if step.operation == 'where' and index in self.varies
                          and step.arguments[0] not in self.varies])

    def is_switched(self, data: Sequence[float]) -> bool:
        values = self.constants(data, self.makes_switches)
        return any(values[index] for index in self.switches)

    @cached_property
    def makes_switches(self) -> list[int]:
        """Return the indices of the steps that data take to the switches, in order."""
        return self.needed(self.switches)

    @cached_property
    def unswitched(self) -> Trace:
        """Return the trace for data by which all switches are false, of the same indices."""
        # Without the numbers that a true switch would choose: most mechanisms are no change
        # points, and their code is as if these had no formulas of their own.
        # x - x stays, which arrays need to be NaN out of reach
        simple = self.simplified({**self.literals(), **dict.fromkeys(self.switches, 0.0)},
                                 keeps_nan=True)
        # simplified() keeps steps that may refuse their arguments, as a division does. Those that
        # only a true switch needed go too: with them a pose could be refused that is regular.
        needed = set(simple.needed(flat(simple.results)))
        left_out = set(self.needed(flat(self.results))) - needed
        for index, step in enumerate(simple.steps):         # arguments stand before their step
            if not step.is_given and (index in left_out
                                      or not left_out.isdisjoint(step.arguments)):
                left_out.add(index)
                simple.steps[index] = NOTHING
        return simple

    def constants(self, data: Sequence[float],
                  indices: Iterable[int] | None = None) -> list[float | None]:
        """Return, by index, the values of what depends on data alone; None of all others."""
        # indices: of those that are computed, in order; by default all. Before them are the inputs
        # and the data.
        values = self.numbers(data)
        for index in range(len(values)) if indices is None else indices:
            if index >= self.count + self.size and index not in self.varies:
                step = self.steps[index]
                if not step.is_given:
                    values[index] = step.of(*[values[i] for i in step.arguments])
        return values

    def needed(self, indices: Iterable[int], with_refusals: bool = False) -> list[int]:
        """Return the indices of all steps that some results need, in order."""
        # with_refusals: and of those that refuse some arguments, as the formula with floats does
        # even where no result needs them.
        needed: set[int] = set()
        left = list(indices)
        if with_refusals:
            left += [i for i, step in enumerate(self.steps) if step.operation in REFUSING]
        while left:
            index = left.pop()
            if index not in needed:
                needed.add(index)
                left += self.steps[index].arguments
        return sorted(needed)

    def numbers(self, data: Sequence[Any]) -> list[Any]:
        """Return, by index, the data and the constants that stand in the formula; else None."""
        values: list[Any] = [None] * len(self.steps)
        values[self.count:self.count + self.size] = data
        for index, value in self.literals().items():
            values[index] = value
        return values

    def literals(self) -> dict[int, float]:
        """Return the constants that stand in the text of the formula, by index."""
        return {index: step.value for index, step in enumerate(self.steps)
                if step.operation == 'constant'}

    def simplified(self, known: Mapping[int, float], end: int | None = None,
                   keeps_nan: bool = False) -> Trace:
        """Return the trace, with the same indices, without what known numbers make needless."""
        # known: {index: value}. Operations on known numbers become constants; products and sums
        # with zero, factors of one and choices with a known condition are replaced by an argument.
        # An operation that refuses its arguments stays, and so do all from index end on; with
        # keeps_nan also x - x, which is NaN where x is.
        simple = object.__new__(Trace)
        simple.steps, simple.count, simple.size = list(self.steps), self.count, self.size
        simple._index_of = {}
        values, same = dict(known), list(range(len(self.steps)))
        for index, value in known.items():
            simple.steps[index] = Step('constant', (), value)
        for index, step in enumerate(self.steps):
            if step.is_given:
                continue
            step = step._replace(arguments=tuple([same[i] for i in step.arguments]))
            if end is not None and index >= end:
                simple.steps[index] = step
                continue
            same_as = _passed(step.operation, step.arguments, values)
            if step.operation == 'sub' and len({*step.arguments}) == 1 and not keeps_nan:
                values[index], step = 0.0, Step('constant', (), 0.0)
                same_as = simple._index_of.setdefault(_key(step), index)
            if same_as is None:
                try:
                    values[index] = step.of(*[values[i] for i in step.arguments])
                    step = Step('constant', (), values[index])
                except (KeyError, ArithmeticError, ValueError):       # not known, or refused
                    pass
                same_as = simple._index_of.setdefault(_key(step), index)
            same[index] = same_as
            simple.steps[index] = step if same_as == index else NOTHING

        simple.results = converted(self.results, same.__getitem__)
        simple.varies = set(range(self.count))
        for index, step in enumerate(simple.steps):
            if not simple.varies.isdisjoint(step.arguments):
                simple.varies.add(index)
        return simple


def _key(step: Step) -> Hashable:
    if step.operation == 'constant':
        return step.operation, float(step.value).hex()
    arguments = sorted(step.arguments) if step.operation in COMMUTES else step.arguments
    return step.operation, tuple(arguments), step.value


def _passed(operation: str, arguments: Sequence[int], values: Mapping[int, float]) -> int | None:
    """Return the index of the argument that is the result of an operation which does nothing."""
    # With the known values by index: x + 0 is x, 1 x is x, 0 x is that 0, x - 0 and x / 1 are x,
    # and a choice is what its known condition takes, or what it gives either way. None if it is
    # none of these, and where all is known: then it is computed.
    if operation == 'where':
        condition, if_true, if_false = arguments
        if if_true == if_false or values.get(condition):
            return if_true
        return if_false if condition in values else None
    if operation not in NEUTRAL:
        return None
    left, right = arguments
    if (left in values) == (right in values):
        return None
    known, unknown = (left, right) if left in values else (right, left)
    if operation == 'mul' and values[known] == 0.0:
        return known
    if known == left and operation not in COMMUTES:         # 0 - x, 1 / x
        return None
    return unknown if values[known] == NEUTRAL[operation] else None


def flat(indices: Any) -> list[int]:
    """Return the indices of nested results in order: ((3, 5), 8) gives [3, 5, 8]."""
    return [indices] if isinstance(indices, int) else [index for part in indices
                                                       for index in flat(part)]
