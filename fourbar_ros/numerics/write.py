# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A trace as the text of a Python function that does only what its results need.

A formula written for any number type computes more than an integrator asks for: angles, products
with masses of zero, rates at the rate one. Its trace becomes a function without calls, tuples and
choices. What refuses an argument in the formula (a root of a negative number, a
division by zero) does so here, even where the result does not need it. A traceback shows the line
that was written, and names the formula. Operations, their order and so their results are those of
the formula. :mod:`.write_arrays` does the same for arrays.
"""
from collections import Counter, deque
from collections.abc import Callable, Collection, Sequence
from functools import lru_cache
import itertools
import linecache
from math import inf, nan
import re
from typing import Any

from fourbar_ros.numerics.number_types import Function, NumberType
from fourbar_ros.numerics.trace import flat, OPERATIONS, REFUSING, Trace

DEEPEST = 12      # operations in one expression, one inside the other
KEPT = 64         # texts whose functions, and whose lines for tracebacks, are kept
FLOATS = {'add': '({} + {})', 'sub': '({} - {})', 'mul': '({} * {})', 'truediv': '({} / {})',
          'neg': '(-{})', 'pow': '({} ** {})', 'gt': '({} > {})', 'lt': '({} < {})',
          'where': '({1} if {0} else {2})'}
_CALLED = [name for name in OPERATIONS if name not in FLOATS]
_NAMES = re.compile(r'[a-z]\w*')
_files: deque[str] = deque()
_line_numbers = itertools.count(1)


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
    trace = Trace(lambda n, _: make_formula(n), count)
    return lines_of(trace.simplified(trace.literals()), (), name)(())       # it has no data


def lines_of(trace: Trace, zeros: Collection[int], name: str
             ) -> Callable[[Sequence[float]], Function]:
    """Return data -> Python function of floats, for all data of one structure."""
    # It is written and compiled once. zeros: indices of steps of data alone that are zero, or
    # false, for all of them: what they only add is left out. Without zeros nothing is known of the
    # data, and the line has the bits of the formula with floats, the signs of zeros too. name: as
    # for straight_line().
    if zeros:
        trace = trace.simplified({**trace.literals(), **dict.fromkeys(zeros, 0.0)})
    # Text of a function ``make``, which computes what depends on data alone, once, and returns the
    # function ``line``. That takes the inputs and gets the results of ``make`` as default
    # arguments: local names are the fastest.
    made, lines = list[str](), list[str]()
    texts = dict[int, tuple[str, int]]()          # of each index its expression, its depth
    functions = list[Function]()                  # that are no formulas, as a table of forces
    results = flat(trace.results)
    needed = trace.needed(results, with_refusals=True)
    # how often each is used, and whether by a step that changes with the inputs, or as a result
    uses, kept = Counter(results), set(results)
    for index in needed:
        uses.update(trace.steps[index].arguments)
        if index in trace.varies:
            kept.update(trace.steps[index].arguments)
    for index in needed:
        operation, arguments, value = trace.steps[index]
        if trace.steps[index].is_given:
            letter = {'input': 'x', 'datum': 'd'}.get(operation)
            texts[index] = f'{letter}{index}' if letter else f'({float(value)!r})', 0
            continue
        if operation == 'call':
            functions += [value] * (value not in functions)
            operation = f'f{functions.index(value)}'
        operands = [texts[i] for i in arguments]
        form = FLOATS.get(operation) or f'{operation}({", ".join(["{}"] * len(operands))})'
        whole = form.format(*[text for text, _ in operands])
        depth = 1 + max(depth for _, depth in operands)
        varies = index in trace.varies
        # what is used once stands where it is used, unless it may refuse its arguments: a
        # traceback then shows it on a line of its own
        if (uses[index] == 1 and depth < DEEPEST and operation not in REFUSING
                and (varies or index not in kept)):
            texts[index] = whole, depth
        else:
            (lines if varies else made).append(f'{"    " * (1 + varies)}v{index} = {whole}')
            texts[index] = f'v{index}', 0

    def nested(indices: Any) -> str:      # '(v5, (v7, x0, ), )', as the formula has them
        return (texts[indices][0] if isinstance(indices, int)
                else f'({"".join([f"{nested(part)}, " for part in indices])})')

    answer = nested(trace.results)
    data = [f'd{i}' for i in range(trace.count, trace.count + trace.size)]
    names = [*data, 'inf', 'nan', *_CALLED, *[f'f{i}' for i in range(len(functions))]]
    inputs = [f'x{i}' for i in range(trace.count)]
    if data:
        used = set(_NAMES.findall(' '.join((*lines, answer))))
        inputs += [f'{name}={name}' for name in (*names, *[line.split()[0] for line in made])
                   if name in used]
    text = [f'def make({", ".join(names)}):', *made, f'    def line({", ".join(inputs)}):', *lines,
            f'        return {answer}', '    return line', '']
    make = compiled('\n'.join(text), name)
    return lambda data: make(*data, inf, nan, *[OPERATIONS[name] for name in _CALLED], *functions)


@lru_cache(maxsize=KEPT)
def compiled(text: str, name: str) -> Function:
    """Return the function ``make`` of a text, which comes from this file alone."""
    # The last 64 texts are kept, compiled, and as files for tracebacks, which name the formula.
    file, names = f'<{name}, line {next(_line_numbers)}>', {'__builtins__': dict[str, Any]()}
    exec(compile(text, file, 'exec'), names)
    if len(_files) == KEPT:
        linecache.cache.pop(_files.popleft(), None)
    _files.append(file)
    linecache.cache[file] = len(text), None, text.splitlines(True), file     # for tracebacks
    make: Function = names['make']      # type: ignore[assignment]  # exec has put it there
    return make
