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
import itertools
import math
import operator
from typing import Any, NamedTuple, Union

from fourbar_ros.numerics.number_types import (
    choose,
    converted,
    Function,
    numbers_of,
    NumberType,
    power_of_two,
)

OPERATIONS: dict[str, Function] = {
    'add': operator.add, 'sub': operator.sub, 'mul': operator.mul, 'truediv': operator.truediv,
    'neg': operator.neg, 'pow': operator.pow, 'gt': operator.gt, 'lt': operator.lt,
    'sin': math.sin, 'cos': math.cos, 'sqrt': math.sqrt, 'atan2': math.atan2, 'fabs': math.fabs,
    'hypot': math.hypot, 'where': choose, 'exact_sum': lambda *terms: math.fsum(terms),
    'power_of_two': power_of_two}
COMMUTES = ('add', 'mul')
# operations that raise for some floats: a root of a negative number, a division by zero
REFUSING = ('sqrt', 'truediv', 'pow', 'exact_sum', 'power_of_two')

# Places of results as a formula returned them: numbers, or sequences of such.
NestedPlaces = Union[int, Sequence['NestedPlaces']]
MakeFormula = Callable[[NumberType, Any], Function]


class Step(NamedTuple):
    """
    One operation of a trace.

    It is one of :data:`OPERATIONS`; 'call' of a function that is no formula; 'input', 'datum' or
    'constant' of a number that is given; 'nothing' where a step was left out.
    """

    operation: str
    arguments: tuple[int, ...] = ()      # places of the steps whose results it takes
    value: Any = None                    # of a constant its number, of a call its function

    @property
    def is_given(self) -> bool:
        """Return whether nothing is computed."""
        return self.operation in ('input', 'datum', 'constant', 'nothing')

    def of(self, *values: float) -> Any:
        """Return the result of the operation for floats."""
        return (OPERATIONS.get(self.operation) or self.value)(*values)


NOTHING = Step('nothing')


class Number:
    """A number that is not known yet: its place in a trace."""

    __slots__ = ('place', 'trace')

    def __init__(self, trace: Trace, place: int) -> None:
        self.trace, self.place = trace, place

    @property
    def real(self) -> Number:
        """Return itself: recorded numbers are real."""
        return self

    def __bool__(self) -> bool:
        raise TypeError('formulas choose with where(), not with if')


# What an operation of a trace is written down for.
Recordable = Union[Number, float]


def _method(name: str, is_reflected: bool) -> Function:
    """Return the method of Number that records an operator; reflected: 2.0 - x, of x."""
    def method(self: Number, *others: Recordable) -> Recordable:
        if not all(isinstance(other, (Number, float, int)) for other in others):
            return NotImplemented       # type: ignore[no-any-return]  # a sign for Python
        return self.trace.add(name, *(others + (self,) if is_reflected else (self, *others)))
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


def _choice(condition: Any, one: Any, other: Any) -> Any:
    """Record ``where(condition, one, other)``, of tuples number by number; a bool decides."""
    if isinstance(condition, bool):
        return one if condition else other
    if isinstance(one, tuple):
        return tuple(_choice(condition, a, b) for a, b in zip(one, other))
    return condition.trace.add('where', condition, one, other)


def _call(function: Function, x: Recordable) -> Any:
    return x.trace.add('call', x, value=function) if isinstance(x, Number) else function(x)


# The table that writes a trace while another one is run.
RECORDING: dict[str, Function] = {**{name: _function(name) for name in OPERATIONS},
                                  'where': _choice}
_exact_sum = RECORDING['exact_sum']
RECORDED = NumberType(_function('sin'), _function('cos'), _function('sqrt'),
                      _function('atan2'), _function('hypot'), _function('fabs'), _choice,
                      lambda terms: _exact_sum(*terms), _function('power_of_two'), call=_call)


class Trace:
    """
    What a formula does.

    ``make_formula``: (number type, data) -> formula, a function of ``count`` numbers that gives a
    sequence of numbers or of such sequences. ``data``: nested records of floats, any, as all data
    of a structure have the same record.

    Attributes
    ----------
    steps : list of Step
        First the inputs, then the data, then all others, each after its arguments.
    count, size : int
        Number of inputs and of data.
    results : nested tuples of int
        Places of the formula's results.
    varies : set of int
        Places of all that depends on an input.

    """

    def __init__(self, make_formula: MakeFormula, count: int, data: Any = ()) -> None:
        """Run the formula once on numbers that record their operations."""
        self.steps: list[Step] = []
        self._places: dict[Hashable, int] = {}
        self.count, self.size = count, len(numbers_of(data))
        numbers = iter([Number(self, self._append(Step('input' if i < count else 'datum')))
                        for i in range(count + self.size)])
        self.varies = set(range(count))
        inputs = list(itertools.islice(numbers, count))
        formula = make_formula(RECORDED, converted(data, lambda _: next(numbers)))
        self.results: NestedPlaces = self._places_of(formula(*inputs))

    def add(self, operation: str, *values: Recordable, value: Any = None) -> Recordable:
        """
        Write down an operation on numbers of this trace and floats; return its result.

        Nothing is written for factors and terms 0.0 and 1.0 that stand in the formula; what must
        be NaN where a number is not real adds the difference of that number and itself.
        """
        known = _without(operation, values)
        if known is not None:
            return known
        return Number(self, self._add(operation, tuple([self._place(v) for v in values]), value))

    def _add(self, operation: str, places: tuple[int, ...], value: Any = None) -> int:
        """
        Append an operation on the results at some places, and return its place.

        Minus signs move outwards, so that equal terms meet: x + (-y) becomes x - y, (-x) y becomes
        -(x y). No bit changes.
        """
        without = [self._without_minus(place) for place in places]
        if operation == 'neg' and without[0] is not None:
            return without[0]
        if operation == 'add' and without[1] is not None:
            return self._add('sub', (places[0], without[1]))
        if operation == 'add' and without[0] is not None:
            return self._add('sub', (places[1], without[0]))
        if operation == 'sub' and without[1] is not None:
            return self._add('add', (places[0], without[1]))
        if operation in ('mul', 'truediv'):
            for i, place in enumerate(without):
                if place is not None and places[i] in self.varies:
                    positive = self._add(operation, (*places[:i], place, *places[i + 1:]))
                    return self._add('neg', (positive,))
        return self._append(Step(operation, places, value))

    def _without_minus(self, place: int) -> int | None:
        """Return the place of x if -x is at a place, else None."""
        step = self.steps[place]
        return step.arguments[0] if step.operation == 'neg' else None

    def _place(self, value: Recordable) -> int:
        return (value.place if isinstance(value, Number)
                else self._append(Step('constant', (), float(value))))

    def _append(self, step: Step) -> int:
        """Return the place of a step: that of the same step before, else a new one at the end."""
        key = len(self.steps) if step.operation in ('input', 'datum') else _key(step)
        place = self._places.setdefault(key, len(self.steps))
        if place == len(self.steps):
            self.steps.append(step)
            if step.arguments and not self.varies.isdisjoint(step.arguments):
                self.varies.add(place)
        return place

    def _places_of(self, results: Any) -> NestedPlaces:
        """Return the places of results, nested as the formula returns them."""
        if isinstance(results, (tuple, list)):
            return tuple([self._places_of(value) for value in results])
        return self._place(results)

    def begin_apart(self) -> int:
        """Return the number of steps so far; from here on none of them is used again."""
        self._places.clear()
        return len(self.steps)

    # --- known facts about it -------------------------------------------------------------------

    def part(self, number: int) -> NestedPlaces:
        """Return the places of result ``number`` of a formula with several: motion, loads."""
        assert not isinstance(self.results, int), 'the formula returns one number'
        return self.results[number]

    @cached_property
    def used_constants(self) -> list[int]:
        """Return the places of results of data alone that are used with inputs or as results."""
        used = {i for place in self.varies for i in self.steps[place].arguments}
        return [i for i in sorted(used.union(flat(self.results)) - self.varies)
                if self.steps[i].operation != 'constant']

    def constants(self, data: Sequence[float]) -> list[float | None]:
        """Return, by place, the values that depend on data alone, for some data; else None."""
        values: list[Any] = [None] * len(self.steps)
        values[self.count:self.count + self.size] = data
        for place in range(self.count + self.size, len(values)):
            if place not in self.varies:
                step = self.steps[place]
                values[place] = step.value if step.is_given else step.of(
                    *[values[i] for i in step.arguments])
        return values

    def needed(self, places: Iterable[int], with_refusals: bool = False) -> list[int]:
        """
        Return the places of all steps that some results need, in order.

        ``with_refusals``: and of those that refuse some arguments, as the formula with floats
        does even where no result needs them.
        """
        found: set[int] = set()
        left = list(places)
        if with_refusals:
            left += [i for i, step in enumerate(self.steps) if step.operation in REFUSING]
        while left:
            place = left.pop()
            if place not in found:
                found.add(place)
                left += self.steps[place].arguments
        return sorted(found)

    def literals(self) -> dict[int, float]:
        """Return the constants that stand in the text of the formula, by place."""
        return {place: step.value for place, step in enumerate(self.steps)
                if step.operation == 'constant'}

    def simplified(self, known: Mapping[int, float], end: int | None = None) -> Trace:
        """
        Return the same trace, with the same places, without what some known numbers make needless.

        ``known``: {place: value}. Operations on known numbers become constants; products and sums
        with zero, factors of one and choices with a known condition are replaced by an argument.
        An operation that refuses its arguments stays, and so do all from place ``end`` on.
        """
        other = object.__new__(Trace)
        other.steps, other.count, other.size = list(self.steps), self.count, self.size
        other._places = {}
        values, same = dict(known), list(range(len(self.steps)))
        for place, value in known.items():
            other.steps[place] = Step('constant', (), value)
        for place, step in enumerate(self.steps):
            if step.is_given:
                continue
            step = step._replace(arguments=tuple([same[i] for i in step.arguments]))
            if end is not None and place >= end:
                other.steps[place] = step
                continue
            same_as = _passed(step, values)
            if step.operation == 'sub' and len({*step.arguments}) == 1:     # NaN or nothing
                values[place], step = 0.0, Step('constant', (), 0.0)
                same_as = other._places.setdefault(_key(step), place)
            if same_as is None:
                try:
                    values[place] = step.of(*[values[i] for i in step.arguments])
                    step = Step('constant', (), values[place])
                except (KeyError, ArithmeticError, ValueError):       # not known, or refused
                    pass
                same_as = other._places.setdefault(_key(step), place)
            same[place] = same_as
            other.steps[place] = step if same_as == place else NOTHING
        other.results = _renamed(self.results, same)
        other.varies = set(range(self.count))
        for place, step in enumerate(other.steps):
            if not other.varies.isdisjoint(step.arguments):
                other.varies.add(place)
        return other


def _key(step: Step) -> Hashable:
    """Return a key that is equal for two steps of the same result; 0.0 is not -0.0."""
    if step.operation == 'constant':
        return step.operation, float(step.value).hex()
    arguments = sorted(step.arguments) if step.operation in COMMUTES else step.arguments
    return step.operation, tuple(arguments), step.value


def _without(operation: str, values: Sequence[Recordable]) -> Recordable | None:
    """Return the result of a sum or product with a float 0.0 or 1.0, None if that is no other."""
    if len(values) != 2 or isinstance(values[0], Number) and isinstance(values[1], Number):
        return None
    one, other = values
    if operation in COMMUTES:
        known, number = (other, one) if isinstance(one, Number) else (one, other)
        if operation == 'mul' and known == 0.0:
            return 0.0
        return number if known == (1.0 if operation == 'mul' else 0.0) else None
    if operation == 'sub' and one == 0.0 and isinstance(other, Number):
        negative: Number = -other       # type: ignore[operator]  # as is set above
        return negative
    if isinstance(one, Number) and other == {'sub': 0.0, 'truediv': 1.0}.get(operation):
        return one
    return None


def _passed(step: Step, values: Mapping[int, float]) -> int | None:
    """
    Return the argument that is the result of an operation which does nothing, or None.

    With the known ``values`` by place: x + 0 is x, 1 x is x, 0 x is that 0, x - 0 and x / 1 are x.
    """
    operation, arguments = step.operation, step.arguments
    known = [values.get(i) for i in arguments]
    if operation == 'where' and known[0] is not None:
        return arguments[1] if known[0] else arguments[2]
    if all(value is not None for value in known):
        return None
    for value, own, other in zip(known, arguments, reversed(arguments)):
        if operation == 'mul' and value == 0.0:
            return own
        if operation == 'mul' and value == 1.0 or operation == 'add' and value == 0.0:
            return other
    does_nothing = {'sub': 0.0, 'truediv': 1.0}.get(operation)
    return arguments[0] if does_nothing is not None and known[1] == does_nothing else None


def _renamed(places: NestedPlaces, same: Sequence[int]) -> NestedPlaces:
    return same[places] if isinstance(places, int) else tuple([_renamed(part, same)
                                                               for part in places])


def flat(places: NestedPlaces) -> list[int]:
    """Return the places of nested results in order: ((3, 5), 8) gives [3, 5, 8]."""
    return [places] if isinstance(places, int) else [place for part in places
                                                     for place in flat(part)]
