# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A trace as one Python function of floats that does only what its results need.

A formula written for any number type computes more than an integrator asks for: angles, products
with masses of zero, rates at the rate one. Here its trace becomes a Python function without calls,
tuples and choices of its own. Operations, their order and so their results are those of the
formula with floats; what refuses an argument there (a root of a negative number, a division by
zero) does so here, even where the result does not need it. A traceback shows the line that was
written, and names the formula.

:func:`straight_line` is for one mechanism: it knows which of its numbers are zero.
:func:`make_lines` is for all mechanisms of a structure: their numbers are arguments, so that the
function is written and compiled once.
"""
from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Collection, Sequence
from functools import lru_cache
import itertools
import linecache
import re
from typing import Any

from fourbar_ros.numerics.number_types import Function, NumberType
from fourbar_ros.numerics.trace import flat, OPERATIONS, Places, REFUSING, Trace

DEEPEST = 12      # operations in one expression, one inside the other
_TEXTS = {'add': '({} + {})', 'sub': '({} - {})', 'mul': '({} * {})', 'truediv': '({} / {})',
          'neg': '(-{})', 'pow': '({} ** {})', 'gt': '({} > {})', 'lt': '({} < {})',
          'where': '({1} if {0} else {2})'}
_CALLED = [name for name in OPERATIONS if name not in _TEXTS]
_NAMES = re.compile(r'[a-z]\w*')
KEPT = 64         # texts whose functions, and whose lines for tracebacks, are kept
_files: deque[str] = deque()
_numbers = itertools.count(1)


def straight_line(make_formula: Callable[[NumberType], Function], count: int = 1,
                  name: str = 'formula') -> Function:
    """
    Return a function of ``count`` floats that gives a tuple of floats, as a formula does.

    ``make_formula``: number type -> formula, a function of ``count`` numbers that gives a sequence
    of numbers or of such sequences. ``name``: what tracebacks call the function, which raises
    ValueError and ZeroDivisionError as the formula with floats does.

    Examples
    --------
    >>> area = straight_line(lambda n: lambda r: (1.0 * r * r + 0.0 * n.sin(r), 2.0))
    >>> area(3.0)
    (9.0, 2.0)

    """
    trace = Trace(lambda numbers, _: make_formula(numbers), count)
    return _lines(trace.simplified(trace.literals()), name)(())


def make_lines(make_formula: Callable[[NumberType, Any], Function], data: Any, count: int,
               zeros: Collection[int] = (), name: str = 'formula'
               ) -> Callable[[Sequence[float]], Function]:
    """
    Return numbers of data -> straight line, for all data of one structure.

    ``make_formula``: (number type, data) -> formula, as for :func:`straight_line`; ``data``:
    nested records of floats, any, as all data have the same record. ``zeros``: which numbers of
    the data are zero in all of them: their terms are left out. Without zeros nothing is known of
    the data, and the line has the bits of the formula with floats, the signs of zeros too.

    Examples
    --------
    >>> lines = make_lines(lambda n, data: lambda r: (data[0] * r + data[1],), (2.0, 1.0), 1)
    >>> lines((3.0, 0.5))(2.0)
    (6.5,)

    """
    return lines_of(Trace(make_formula, count, data), zeros, name)


def lines_of(trace: Trace, zeros: Collection[int], name: str
             ) -> Callable[[Sequence[float]], Function]:
    """Return data -> Python function of floats, as :func:`make_lines`, of a trace made already."""
    if zeros:
        trace = trace.simplified({**trace.literals(), **{trace.count + i: 0.0 for i in zeros}})
    return _lines(trace, name)


def _lines(trace: Trace, name: str) -> Callable[[Sequence[float]], Function]:
    """Return numbers of data -> compiled function of the inputs of a trace."""
    text, values = _Writer(trace).text()
    make = _compiled(text, name)
    return lambda data: make(*data, *values)


class _Writer:
    """
    Writes the text of ``make(data, constants, functions)``, which returns the function ``line``.

    ``make`` computes what depends on data alone, once; ``line`` takes the inputs, and gets the
    results of ``make`` as default arguments, as local names are the fastest.
    """

    def __init__(self, trace: Trace) -> None:
        """Begin with no text: each place gets its expression and the depth of that."""
        self._trace, self._texts = trace, dict[int, tuple[str, int]]()     # text, depth
        self._constants: dict[str, tuple[str, float]] = {}     # by all bits: 0.0 is not -0.0
        self._functions: list[Function] = []

    def text(self) -> tuple[str, list[Any]]:
        """Return the text of ``make``, and the values of its arguments after the data."""
        trace = self._trace
        made, lines = self._statements()
        answer = self._tuple_of(trace.results)
        names, values = zip(*self._constants.values()) if self._constants else ((), ())
        data = [f'd{i}' for i in range(trace.count, trace.count + trace.size)]
        given = [f'x{i}' for i in range(trace.count)]
        called = [*_CALLED, *(f'f{i}' for i in range(len(self._functions)))]
        if data:
            known = set(_NAMES.findall(' '.join((*lines, answer))))
            made_here = [statement.split()[0] for statement in made]
            given += [f'{name}={name}' for name in (*data, *names, *called, *made_here)
                      if name in known]
        function = (f'def make({", ".join([*data, *names, *called])}):', *made,
                    f'    def line({", ".join(given)}):', *lines,
                    f'        return {answer}', '    return line', '')
        return '\n'.join(function), [*values, *[OPERATIONS[name] for name in _CALLED],
                                     *self._functions]

    def _statements(self) -> tuple[list[str], list[str]]:
        """
        Return the statements of ``make`` and those of ``line``.

        A result that is used once stands inside the expression that uses it, unless it may refuse
        its arguments: a traceback then shows it on a line of its own.
        """
        trace, made, lines = self._trace, list[str](), list[str]()
        results = flat(trace.results)
        needed = trace.needed(results, with_refusals=True)
        uses = Counter(results)
        kept = set(results)                   # of data alone: what the line uses
        for place in needed:
            uses.update(trace.steps[place].arguments)
            if place in trace.varies:
                kept.update(trace.steps[place].arguments)
        for place in needed:
            step = trace.steps[place]
            if step.is_given:
                self._texts[place] = self._name_of(place), 0
                continue
            name = (step.operation if step.operation != 'call'
                    else self._name_of_function(step.value))
            parts = [self._texts[i] for i in step.arguments]
            form = _TEXTS.get(name) or f'{name}({", ".join(["{}"] * len(parts))})'
            whole, depth = form.format(*[part for part, _ in parts]), 1 + max(d for _, d in parts)
            varies = place in trace.varies
            if (uses[place] == 1 and depth < DEEPEST and name not in REFUSING
                    and (varies or place not in kept)):
                self._texts[place] = whole, depth
            else:
                (lines if varies else made).append(f'{"    " * (1 + varies)}v{place} = {whole}')
                self._texts[place] = f'v{place}', 0
        return made, lines

    def _name_of(self, place: int) -> str:
        """Return the name of an input (x0), a datum (d3) or a constant (c1)."""
        step, constants = self._trace.steps[place], self._constants
        if step.operation != 'constant':
            return f'{"x" if step.operation == "input" else "d"}{place}'
        value = float(step.value)
        return constants.setdefault(value.hex(), (f'c{len(constants)}', value))[0]

    def _name_of_function(self, function: Function) -> str:
        """Return the name (f0) of a function that is no formula, as a table of forces."""
        if function not in self._functions:
            self._functions.append(function)
        return f'f{self._functions.index(function)}'

    def _tuple_of(self, results: Places) -> str:
        """Return the text of results, nested as the formula returns them: '(v5, (v7, x0, ), )'."""
        if isinstance(results, int):
            return self._texts[results][0]
        return f'({"".join([f"{self._tuple_of(part)}, " for part in results])})'


@lru_cache(maxsize=KEPT)
def _compiled(text: str, name: str) -> Function:
    """
    Return the function ``make`` of a text, which comes from :class:`_Writer` alone.

    The last 64 texts are kept, compiled, and as files for tracebacks, which name the formula.
    """
    file, names = f'<{name}, line {next(_numbers)}>', {'__builtins__': dict[str, Any]()}
    exec(compile(text, file, 'exec'), names)
    if len(_files) == KEPT:
        linecache.cache.pop(_files.popleft(), None)
    _files.append(file)
    linecache.cache[file] = len(text), None, text.splitlines(True), file     # for tracebacks
    make: Any = names['make']
    return make  # type: ignore[no-any-return]  # of text
