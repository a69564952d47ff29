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
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.recorded import Number, OPERATIONS, RECORDED

DEEPEST = 12      # operations in one expression, one inside the other
_TEXTS = {'add': '({} + {})', 'sub': '({} - {})', 'mul': '({} * {})', 'truediv': '({} / {})',
          'neg': '(-{})', 'pow': '({} ** {})', 'gt': '({} > {})', 'lt': '({} < {})',
          'where': '({1} if {0} else {2})'}
_CALLED = ('sin', 'cos', 'sqrt', 'atan2', 'fabs', 'hypot')
_REFUSING = ('sqrt', 'truediv')


class _Notes:
    """What was done, each operation once; a value is a float or the Number of an operation."""

    def __init__(self, count: int) -> None:
        self.steps: list[tuple[str, tuple[Any, ...]]] = [('given', (i,)) for i in range(count)]
        self._known: dict[tuple[Any, ...], int] = {}

    def add(self, name: str, *values: Any) -> Any:
        """Write down an operation, unless its result is known."""
        simple = _simplified(name, values)
        if simple is not None:
            return simple
        key = name, tuple([v.place if isinstance(v, Number) else float(v).hex() for v in values])
        if key not in self._known:
            self._known[key] = len(self.steps)
            self.steps.append((name, values))
        return Number(self, self._known[key])


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
    given = [Number(notes, i) for i in range(count)]
    results = make_formula(RECORDED)(*given)
    text, constants = _text_of(notes.steps, results, count)
    line: Function = _compiled(text)(*constants)
    return line


def _text_of(steps: list[tuple[str, tuple[Any, ...]]], results: Any,
             count: int) -> tuple[str, list[Any]]:
    """Return a Python function that makes the function for given constants, and these."""
    used = _uses(steps, results)
    constants: dict[str, tuple[str, float]] = {}       # by all bits: 0.0 is not -0.0
    texts: dict[int, tuple[str, int]] = {i: (f'x{i}', 0) for i in range(count)}
    lines = []

    def text(value: Any) -> tuple[str, int]:
        if isinstance(value, Number):
            return texts[value.place]
        name, _ = constants.setdefault(float(value).hex(), (f'c{len(constants)}', float(value)))
        return name, 0

    for place in sorted(used):
        if place < count:
            continue
        name, values = steps[place]
        parts = [text(value) for value in values]
        form = _TEXTS.get(name) or f'{name}({", ".join(["{}"] * len(values))})'
        whole, depth = form.format(*[part for part, _ in parts]), 1 + max(d for _, d in parts)
        if used[place] == 1 and depth < DEEPEST and name not in _REFUSING:
            texts[place] = whole, depth
        else:
            lines.append(f'        v{place} = {whole}')
            texts[place] = f'v{place}', 0
    answer = ''.join([f'{text(value)[0]}, ' for value in results])
    names, values = zip(*constants.values()) if constants else ((), ())
    function = (f'def make({", ".join([*names, *_CALLED])}):',
                f'    def line({", ".join([f"x{i}" for i in range(count)])}):', *lines,
                f'        return {answer}', '    return line')
    return '\n'.join(function), [*values, *[OPERATIONS[name][0] for name in _CALLED]]


def _uses(steps: list[tuple[str, tuple[Any, ...]]], results: Any) -> Counter[int]:
    """Return {place: how often it is used} of the operations that are needed."""
    needed = [value.place for value in results if isinstance(value, Number)]
    needed += [place for place, (name, _) in enumerate(steps) if name in _REFUSING]
    used, seen = Counter(needed), set(needed)
    left = list(seen)
    while left:
        name, values = steps[left.pop()]
        for value in values if name != 'given' else ():
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
