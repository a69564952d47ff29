# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A trace as the text of a Python function that does only what its results need.

A formula written for any number type computes more than an integrator asks for: angles, products
with masses of zero, rates at the rate one. Its trace becomes a function without calls, tuples and
choices of its own. A form is what an operation looks like, there is a table of them for

- floats (:func:`lines_of`, :func:`straight_line`): expressions. What refuses an argument in the
  formula (a root of a negative number, a division by zero) does so here, even where the result
  does not need it. A traceback shows the line that was written, and names the formula.
- arrays (:func:`program`): calls of numpy's functions that write into buffers, which stay in the
  cache; a buffer is used again when nothing needs its content any more.

Operations, their order and so their results are those of the formula.
"""
from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Collection, Sequence
from functools import cache, lru_cache
import itertools
import linecache
import re
from typing import Any

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function, hypot_of_arrays, NumberType
from fourbar_ros.numerics.trace import flat, NestedPlaces, OPERATIONS, REFUSING, Trace
import numpy as np

DEEPEST = 12      # operations in one expression, one inside the other
CHUNK = 12288     # most samples at a time
KEPT = 64         # texts whose functions, and whose lines for tracebacks, are kept
FLOATS = {'add': '({} + {})', 'sub': '({} - {})', 'mul': '({} * {})', 'truediv': '({} / {})',
          'neg': '(-{})', 'pow': '({} ** {})', 'gt': '({} > {})', 'lt': '({} < {})',
          'where': '({1} if {0} else {2})'}
_CALLED = [name for name in OPERATIONS if name not in FLOATS]
_NAMES = re.compile(r'[a-z]\w*')
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


def lines_of(trace: Trace, zeros: Collection[int], name: str
             ) -> Callable[[Sequence[float]], Function]:
    """
    Return numbers of data -> Python function of floats, for all data of one structure.

    It is written and compiled once. ``zeros``: which numbers of the data are zero in all of them:
    their terms are left out. Without zeros nothing is known of the data, and the line has the bits
    of the formula with floats, the signs of zeros too. ``name``: as for :func:`straight_line`.

    Examples
    --------
    >>> trace = Trace(lambda n, data: lambda r: (data[0] * r + data[1],), 1, (2.0, 1.0))
    >>> lines_of(trace, (), 'an example')((3.0, 0.5))(2.0)
    (6.5,)

    """
    if zeros:
        trace = trace.simplified({**trace.literals(), **{trace.count + i: 0.0 for i in zeros}})
    return _lines(trace, name)


def _lines(trace: Trace, name: str) -> Callable[[Sequence[float]], Function]:
    """Return numbers of data -> compiled function of the inputs of a trace."""
    text, values = _text_of(trace)
    make = _compiled(text, name)
    return lambda data: make(*data, *values)


def _text_of(trace: Trace) -> tuple[str, list[Any]]:
    """
    Return the text of ``make(data, constants, functions)``, and its arguments after the data.

    ``make`` computes what depends on data alone, once, and returns the function ``line``, which
    takes the inputs and gets the results of ``make`` as default arguments: local names are the
    fastest.
    """
    made, lines = list[str](), list[str]()
    texts = dict[int, tuple[str, int]]()          # of each place its expression, its depth
    constants = dict[str, tuple[str, float]]()    # by all bits: 0.0 is not -0.0
    functions = list[Function]()                  # that are no formulas, as a table of forces
    results = flat(trace.results)
    needed = trace.needed(results, with_refusals=True)
    uses, kept = Counter(results), set(results)   # kept: of data alone, what the line uses
    for place in needed:
        uses.update(trace.steps[place].arguments)
        if place in trace.varies:
            kept.update(trace.steps[place].arguments)
    for place in needed:
        operation, arguments, value = trace.steps[place]
        if operation in ('input', 'datum'):
            texts[place] = f'{"x" if operation == "input" else "d"}{place}', 0
            continue
        if operation == 'constant':
            texts[place] = constants.setdefault(
                float(value).hex(), (f'c{len(constants)}', float(value)))[0], 0
            continue
        if operation == 'call':
            functions += [value] * (value not in functions)
            operation = f'f{functions.index(value)}'
        parts = [texts[i] for i in arguments]
        form = FLOATS.get(operation) or f'{operation}({", ".join(["{}"] * len(parts))})'
        whole, depth = form.format(*[part for part, _ in parts]), 1 + max(d for _, d in parts)
        varies = place in trace.varies
        # what is used once stands where it is used, unless it may refuse its arguments: a
        # traceback then shows it on a line of its own
        if (uses[place] == 1 and depth < DEEPEST and operation not in REFUSING
                and (varies or place not in kept)):
            texts[place] = whole, depth
        else:
            (lines if varies else made).append(f'{"    " * (1 + varies)}v{place} = {whole}')
            texts[place] = f'v{place}', 0

    def nested(places: NestedPlaces) -> str:
        """Return the text of results as the formula returns them: '(v5, (v7, x0, ), )'."""
        return (texts[places][0] if isinstance(places, int)
                else f'({"".join([f"{nested(part)}, " for part in places])})')

    answer = nested(trace.results)
    data = [f'd{i}' for i in range(trace.count, trace.count + trace.size)]
    given = [*data, *[name for name, _ in constants.values()], *_CALLED,
             *[f'f{i}' for i in range(len(functions))]]
    inputs = [f'x{i}' for i in range(trace.count)]
    if data:
        used = set(_NAMES.findall(' '.join((*lines, answer))))
        inputs += [f'{name}={name}' for name in (*given, *[one.split()[0] for one in made])
                   if name in used]
    text = [f'def make({", ".join(given)}):', *made, f'    def line({", ".join(inputs)}):', *lines,
            f'        return {answer}', '    return line', '']
    return '\n'.join(text), [*[value for _, value in constants.values()],
                             *[OPERATIONS[name] for name in _CALLED], *functions]


@lru_cache(maxsize=KEPT)
def _compiled(text: str, name: str) -> Function:
    """
    Return the function ``make`` of a text, which comes from this file alone.

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


# --- arrays --------------------------------------------------------------------------------------

_CONDITIONS, _NOT_IN_PLACE = ('gt', 'lt'), ('where', 'hypot')    # which write before they read


def _where(condition: Array, one: Any, other: Any, out: Array) -> None:
    np.copyto(out, other)
    np.copyto(out, one, where=condition)


# The last argument is where the result goes. All other operations are on data alone.
ARRAYS: dict[str, Function] = {
    'add': np.add, 'sub': np.subtract, 'mul': np.multiply, 'truediv': np.true_divide,
    'neg': np.negative, 'gt': np.greater, 'lt': np.less, 'sin': np.sin, 'cos': np.cos,
    'sqrt': np.sqrt, 'atan2': np.arctan2, 'fabs': np.abs, 'hypot': hypot_of_arrays,
    'where': _where, 'copy': np.copyto}


@lru_cache(maxsize=512)
def program(trace: Trace, wanted: tuple[int, ...], single: tuple[bool, ...],
            zeros: frozenset[int]) -> Callable[[Sequence[Any], Sequence[Any], int], list[Array]]:
    """
    Return the function (inputs, constants, size) -> results ``wanted`` of a trace of three inputs.

    Results are arrays of shape (size,) with own memory, computed chunk by chunk; so are inputs, or
    floats if ``single``; constants by place are those of :meth:`.Trace.constants`. ``zeros``:
    places of numbers that do not depend on the inputs and are zero: what only adds zero is left
    out, unless a result would then no longer be NaN where it should.
    """
    simple = trace.simplified(dict.fromkeys(zeros, 0.0))
    full, places = ([flat(one.results)[i] for i in wanted] for one in (trace, simple))
    if _carriers(simple, places) != _carriers(trace, full):
        simple, places = trace, full
    steps = [place for place in simple.needed(places)
             if place in trace.varies and place >= trace.count]
    arrays = {place for place in range(3) if not single[place]}
    for place in steps:
        if not arrays.isdisjoint(simple.steps[place].arguments):
            arrays.add(place)
    once = [place for place in steps if place not in arrays]
    lines, kinds = array_statements(simple, places, [i for i in steps if i in arrays])
    known = sorted({int(name[1:]) for name in re.findall(r'v\d+', ' '.join(lines))})
    names = [*(f'v{i}' for i in known), *(f'b{i}' for i in range(len(kinds))),
             *(f'r{i}' for i in range(len(places)))]
    line = _compiled('\n'.join([f'def make({", ".join(ARRAYS)}):',
                                f'    def line({", ".join(names)}):',
                                *(f'        {one}' for one in lines or ['pass']),
                                '    return line', '']), 'arrays')(*ARRAYS.values())

    def run_on(inputs: Sequence[Any], constants: Sequence[Any], size: int) -> list[Array]:
        """Return the results; single numbers are computed once."""
        keep_memory()
        values = [*inputs, *constants[3:]]
        for place in once:
            step = simple.steps[place]
            values[place] = step.value if step.is_given else step.of(
                *[values[i] for i in step.arguments])
        rows: list[Array] = [np.empty(size) for _ in places]
        count = -(-size // -(-size // CHUNK)) if size else 1     # chunks of equal size
        buffers: list[Any] = [np.empty(count, kind) for kind in kinds]
        for start in range(0, size, count):
            part = slice(start, start + count)
            line(*[values[i][part] if i in arrays else values[i] for i in known],
                 *(buffers if start + count <= size else [b[:size - start] for b in buffers]),
                 *[row[part] for row in rows])
        return rows
    return run_on


def array_statements(trace: Trace, results: Sequence[int],
                     places: Sequence[int]) -> tuple[list[str], list[type]]:
    """
    Return the statements of the steps at ``places``, and the types of their buffers b0, b1, ...

    A result is written to its row r0, r1, ...; another step gets a buffer that no later step reads
    any more, or a new one. What is known is v and its place.
    """
    last_use = {i: place for place in places for i in trace.steps[place].arguments}
    names = {place: f'r{i}' for i, place in reversed([*enumerate(results)]) if place in places}
    buffers, kinds, free, lines = dict[int, str](), list[type](), list[str](), list[str]()
    for place in places:
        operation, arguments, _ = trace.steps[place]
        done = [buffers[i] for i in dict.fromkeys(arguments)
                if i in buffers and last_use[i] == place]
        if operation not in _NOT_IN_PLACE:
            free += done
        if place not in names:
            if operation in _CONDITIONS or not free:
                names[place] = f'b{len(kinds)}'
                kinds.append(bool if operation in _CONDITIONS else float)
            else:
                names[place] = free.pop()
            if operation not in _CONDITIONS:
                buffers[place] = names[place]
        if operation in _NOT_IN_PLACE:
            free += done
        given = ', '.join([names.get(i, f'v{i}') for i in (*arguments, place)])
        lines.append(f'{operation}({given})')
    # an input, one number, or a result twice
    return lines + [f'copy(r{i}, {names.get(place, f"v{place}")})'
                    for i, place in enumerate(results) if names.get(place) != f'r{i}'], kinds


def _carriers(trace: Trace, places: Sequence[int]) -> list[frozenset[int]]:
    """
    Return, for each result, the places of the roots and of the position that it depends on.

    Out of range they are NaN, and so make the result NaN. Rate and acceleration do not count: a
    result may multiply them by zero.
    """
    carried: list[frozenset[int]] = []
    for place, step in enumerate(trace.steps):
        of_arguments = frozenset[int]().union(*[carried[i] for i in step.arguments])
        is_carrier = place == 0 or step.operation == 'sqrt'
        carried.append(of_arguments | {place} if is_carrier else of_arguments)
    return [carried[place] for place in places]


@cache
def keep_memory() -> None:
    """
    Have blocks of up to 31 MB kept by the C library when they are freed, once and for all.

    glibc gives each back to the system until it has seen one of that size freed; getting the pages
    again takes as long as the formulas: motion and loads of 10 000 samples of a four-bar 0.34 us a
    sample, without it 0.6 to 0.8. The block is never touched, so it costs nothing.
    """
    np.empty(31 * 2**17)
