# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A formula as one function of floats that does only what its results need.

A formula written for any number type computes more than an integrator asks for: angles, products
with masses of zero, rates at the rate one. Here it is run once with numbers that write down what
is done to them (:class:`~fourbar_ros.numerics.recorded.Number`); what nobody needs, products and
sums of zero, factors of one and repeated operations are left out, and the rest becomes a Python
function without calls, tuples and choices of its own. Operations, their order and so their results
are those of the formula with floats; what refuses an argument there (a root of a negative number,
a division by zero) does so here, even where the result does not need it.

:func:`straight_line` is for one mechanism: it knows which of its numbers are zero.
:func:`make_lines` is for all mechanisms of a structure: their numbers are arguments, so that the
function is written and compiled once.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from functools import lru_cache
import itertools
import re
from typing import Any

from fourbar_ros.numerics.number_types import converted, Function
from fourbar_ros.numerics.recorded import Number, OPERATIONS, RECORDED

DEEPEST = 12      # operations in one expression, one inside the other
_TEXTS = {'add': '({} + {})', 'sub': '({} - {})', 'mul': '({} * {})', 'truediv': '({} / {})',
          'neg': '(-{})', 'pow': '({} ** {})', 'gt': '({} > {})', 'lt': '({} < {})',
          'where': '({1} if {0} else {2})'}
_CALLED = ('sin', 'cos', 'sqrt', 'atan2', 'fabs', 'hypot', 'exact_sum', 'power_of_two')
_NAMES = re.compile(r'[a-z]\w*')
_REFUSING = ('sqrt', 'truediv', 'pow', 'exact_sum', 'power_of_two')


class _Notes:
    """
    What was done, each operation once; a value is a float or the Number of an operation.

    ``knows_zeros``: whether products and sums of zero are left out; the sign of a zero may change.
    """

    def __init__(self, count: int, knows_zeros: bool = True) -> None:
        self.steps: list[tuple[str, tuple[Any, ...]]] = []
        self._known: dict[tuple[Any, ...], int] = {}
        self._simplified = _simplified if knows_zeros else _of_floats
        self.given = [self.give() for _ in range(count)]

    def give(self) -> Number:
        """Return one more number that is given."""
        self.steps.append(('given', ()))
        return Number(self, len(self.steps) - 1)

    def add(self, name: str, *values: Any) -> Any:
        """Write down an operation, unless its result is known."""
        simple = self._simplified(name, values)
        if simple is not None:
            return simple
        key = name, tuple([v.place if isinstance(v, Number) else float(v).hex() for v in values])
        if key not in self._known:
            self._known[key] = len(self.steps)
            self.steps.append((name, values))
        return Number(self, self._known[key])


def _of_floats(name: str, values: tuple[Any, ...]) -> Any:
    """Return the result of an operation with floats alone, or None."""
    return None if any(isinstance(v, Number) for v in values) else OPERATIONS[name][0](*values)


def _simplified(name: str, values: tuple[Any, ...]) -> Any:
    """Return the result of an operation that does nothing or is done with floats, or None."""
    if not any(isinstance(v, Number) for v in values):
        return OPERATIONS[name][0](*values)
    is_zero = [not isinstance(v, Number) and v == 0.0 for v in values]
    is_one = [not isinstance(v, Number) and v == 1.0 for v in values]
    if name == 'mul':
        if any(is_zero):
            return 0.0
        if any(is_one):
            return values[is_one.index(False)]
    if name in ('add', 'sub') and is_zero[1] or name == 'truediv' and is_one[1]:
        return values[0]
    if name == 'add' and is_zero[0]:
        return values[1]
    return None


def straight_line(make_formula: Callable[[Any], Function], count: int = 1) -> Function:
    """
    Return a function of ``count`` floats that gives a tuple of floats.

    Parameters
    ----------
    make_formula : callable
        Number type -> formula, a function of ``count`` numbers that gives a
        sequence of numbers.
    count : int

    Raises
    ------
    ValueError, ZeroDivisionError
        By the function, as the formula with floats.

    Examples
    --------
    >>> area = straight_line(lambda n: lambda r: (1.0 * r * r + 0.0 * n.sin(r), 2.0))
    >>> area(3.0)
    (9.0, 2.0)

    """
    notes = _Notes(count)
    results = make_formula(RECORDED)(*notes.given)
    text, constants = _Writer(notes.steps, count).text_of(results)
    line: Function = _compiled(text)(*constants)
    return line


def make_lines(make_formula: Callable[[Any, Any], Function], data: Any, count: int,
               zeros: Collection[int] = ()) -> Function:
    """
    Return numbers of data -> straight line, for all data of one structure.

    Without zeros nothing is known of the data, and the line has the bits of the formula with
    floats, the signs of zeros too.

    Parameters
    ----------
    make_formula : callable
        (Number type, data) -> formula, a function of ``count`` numbers that gives
        a sequence of numbers or of such sequences.
    data
        Nested records of floats: any, as all data have the same record.
    count : int
    zeros : collection of int
        Which numbers of the data are zero in all of them: what they add is left out.

    Examples
    --------
    >>> lines = make_lines(lambda n, data: lambda r: (data[0] * r + data[1],), (2.0, 1.0), 1)
    >>> lines((3.0, 0.5))(2.0)
    (6.5,)

    """
    notes = _Notes(count, knows_zeros=bool(zeros))
    places = itertools.count()
    numbers = converted(data, lambda value: value if next(places) in zeros else notes.give())
    size = len(notes.steps) - count
    results = make_formula(RECORDED, numbers)(*notes.given)
    text, constants = _Writer(notes.steps, count, size).text_of(results)
    make = _compiled(text)

    def line_for(found: Sequence[float]) -> Function:
        given = [value for i, value in enumerate(found) if i not in zeros] if zeros else found
        line: Function = make(*given, *constants)
        return line
    return line_for


class _Writer:
    """
    Writes a Python function that makes the function for given data and constants.

    What depends on data alone is done there, not in the function of the inputs; its default
    arguments are what it uses of that, as local names are the fastest.
    """

    def __init__(self, steps: list[tuple[str, tuple[Any, ...]]], count: int, size: int = 0):
        self._steps, self._count, self._size = steps, count, size
        self._constants: dict[str, tuple[str, float]] = {}     # by all bits: 0.0 is not -0.0
        self._texts = {i: (f'x{i}' if i < count else f'd{i}', 0) for i in range(count + size)}
        self._varies = set(range(count))
        for place, (_, values) in enumerate(steps):
            if any(isinstance(v, Number) and v.place in self._varies for v in values):
                self._varies.add(place)

    def text_of(self, results: Any) -> tuple[str, list[Any]]:
        """Return the text for sequences of numbers, and the last arguments of its function."""
        made, lines = self._statements(_uses(self._steps, _flat(results)), _flat(results))
        answer = self._tuple_of(results)
        names, values = zip(*self._constants.values()) if self._constants else ((), ())
        data = [f'd{i}' for i in range(self._count, self._count + self._size)]
        given = [f'x{i}' for i in range(self._count)]
        if self._size:
            known = set(_NAMES.findall(' '.join((*lines, answer))))
            made_here = [statement.split()[0] for statement in made]
            given += [f'{name}={name}' for name in (*data, *names, *_CALLED, *made_here)
                      if name in known]
        function = (f'def make({", ".join([*data, *names, *_CALLED])}):', *made,
                    f'    def line({", ".join(given)}):', *lines,
                    f'        return {answer}', '    return line')
        return '\n'.join(function), [*values, *[OPERATIONS[name][0] for name in _CALLED]]

    def _statements(self, used: Counter[int], results: list[Any]) -> tuple[list[str], list[str]]:
        """Return the statements of data alone and those of the line."""
        made: list[str] = []
        lines: list[str] = []
        kept = {value.place for value in results if isinstance(value, Number)}
        for place in self._varies:
            kept |= {value.place for value in self._steps[place][1]
                     if isinstance(value, Number) and value.place not in self._varies}
        for place in sorted(used):
            if place < self._count + self._size:
                continue
            name, values = self._steps[place]
            parts = [self._text(value) for value in values]
            form = _TEXTS.get(name) or f'{name}({", ".join(["{}"] * len(values))})'
            whole, depth = form.format(*[part for part, _ in parts]), 1 + max(d for _, d in parts)
            varies = place in self._varies
            if (used[place] == 1 and depth < DEEPEST and name not in _REFUSING
                    and (varies or place not in kept)):
                self._texts[place] = whole, depth
            else:
                (lines if varies else made).append(f'{"    " * (1 + varies)}v{place} = {whole}')
                self._texts[place] = f'v{place}', 0
        return made, lines

    def _text(self, value: Any) -> tuple[str, int]:
        if isinstance(value, Number):
            return self._texts[value.place]
        constants = self._constants
        name, _ = constants.setdefault(float(value).hex(), (f'c{len(constants)}', float(value)))
        return name, 0

    def _tuple_of(self, results: Any) -> str:
        parts = [self._tuple_of(value) if isinstance(value, (tuple, list)) else
                 self._text(value)[0] for value in results]
        return f'({"".join([f"{part}, " for part in parts])})'


def _flat(results: Any) -> list[Any]:
    """Return the numbers of sequences of numbers."""
    return [number for value in results
            for number in (_flat(value) if isinstance(value, (tuple, list)) else [value])]


def _uses(steps: list[tuple[str, tuple[Any, ...]]], results: Any) -> Counter[int]:
    """Return {place: how often it is used} of the operations that are needed."""
    needed = [value.place for value in results if isinstance(value, Number)]
    needed += [place for place, (name, _) in enumerate(steps) if name in _REFUSING]
    used, seen = Counter(needed), set(needed)
    left = list(seen)
    while left:
        for value in steps[left.pop()][1]:
            if isinstance(value, Number):
                used[value.place] += 1
                if value.place not in seen:
                    seen.add(value.place)
                    left.append(value.place)
    return used


@lru_cache(maxsize=64)
def _compiled(text: str) -> Function:
    """Return the function that a text defines: names of places and operations, nothing given."""
    names: dict[str, Any] = {'__builtins__': {}}
    exec(text, names)
    make: Function = names['make']
    return make
