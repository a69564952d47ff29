# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A trace as the text of calls of numpy that write into buffers, which stay in the cache.

A buffer is used again when nothing needs its content any more. Operations, their order and so
their results are those of the formula.
"""
from collections.abc import Callable, Mapping, Sequence
from functools import cache, lru_cache
import re
from typing import Any

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function, hypot_of_arrays
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.numerics.write import compiled
import numpy as np

CHUNK = 12288     # most samples at a time
_CONDITIONS, _NOT_IN_PLACE = ('gt', 'lt'), ('where', 'hypot')    # which write before they read


def _where(condition: Array, if_true: Any, if_false: Any, out: Array) -> None:
    np.copyto(out, if_false)
    np.copyto(out, if_true, where=condition)


# The last argument is where the result goes. All other operations are on data alone.
ARRAYS: dict[str, Function] = {
    'add': np.add, 'sub': np.subtract, 'mul': np.multiply, 'truediv': np.true_divide,
    'neg': np.negative, 'gt': np.greater, 'lt': np.less, 'sin': np.sin, 'cos': np.cos,
    'sqrt': np.sqrt, 'atan2': np.arctan2, 'fabs': np.abs, 'hypot': hypot_of_arrays,
    'where': _where, 'copy': np.copyto}


@lru_cache(maxsize=512)
def program(trace: Trace, wanted: tuple[int, ...], zeros: frozenset[int]
            ) -> Callable[[Sequence[Array], Sequence[Any]], list[Array]]:
    """Return the function (inputs, constants) -> results ``wanted`` of a trace of three inputs."""
    # Inputs and results are arrays of shape (n,), computed chunk by chunk; results have memory of
    # their own. constants: by index, from constants(). zeros: indices of what does not depend on
    # the inputs and is zero.
    simple = trace.simplified(dict.fromkeys(zeros, 0.0))
    full, indices = [[results[i] for i in wanted]
                     for results in (flat(trace.results), flat(simple.results))]
    # without what only adds zero, unless a result would then no longer be NaN where it should
    bits = {index: 1 << i for i, index in enumerate(
        [0, *[index for index, step in enumerate(trace.steps) if step.operation == 'sqrt']])}
    if _carriers(simple, indices, bits) != _carriers(trace, full, bits):
        simple, indices = trace, full
    steps = [index for index in simple.needed(indices)
             if index in trace.varies and index >= trace.count]
    # differences of equal numbers, which do not depend on the inputs any more
    fixed = {i: simple.steps[i].value for i in steps if simple.steps[i].is_given}
    lines, kinds, functions = array_statements(simple, indices,
                                               [i for i in steps if i not in fixed])
    known = sorted({int(name[1:]) for name in re.findall(r'v\d+', ' '.join(lines))})
    names = [*(f'v{i}' for i in known), *(f'b{i}' for i in range(len(kinds))),
             *(f'r{i}' for i in range(len(indices)))]
    calls = [f'f{i}' for i in range(len(functions))]
    line = compiled('\n'.join([f'def make({", ".join([*ARRAYS, *calls])}):',
                               f'    def line({", ".join(names)}):',
                               *(f'        {text}' for text in lines or ['pass']),
                               '    return line', '']), 'arrays')(*ARRAYS.values(), *functions)

    def run_on(inputs: Sequence[Array], constants: Sequence[Any]) -> list[Array]:
        keep_memory()
        size, values = inputs[0].size, [*inputs, *constants[3:]]
        for index, value in fixed.items():
            values[index] = value
        rows: list[Array] = [np.empty(size) for _ in indices]
        count = -(-size // -(-size // CHUNK)) if size else 1     # chunks of equal size
        buffers: list[Any] = [np.empty(count, kind) for kind in kinds]
        for start in range(0, size, count):
            chunk = slice(start, start + count)
            line(*[values[i][chunk] if i < trace.count else values[i] for i in known],
                 *(buffers if start + count <= size else [b[:size - start] for b in buffers]),
                 *[row[chunk] for row in rows])
        return rows
    return run_on


def array_statements(trace: Trace, results: Sequence[int],
                     indices: Sequence[int]) -> tuple[list[str], list[type], list[Function]]:
    """Return the statements of the steps at ``indices``, the types of their buffers b0, b1, ..."""
    # And the functions f0, f1, ... that are no formulas, as a table of forces.
    # A result is written to its row r0, r1, ...; another step gets a buffer that no later step
    # reads any more, or a new one. A known value is v and its index.
    last_use = {i: index for index in indices for i in trace.steps[index].arguments}
    names = {index: f'r{i}' for i, index in reversed([*enumerate(results)]) if index in indices}
    buffers, kinds, free, lines = dict[int, str](), list[type](), list[str](), list[str]()
    functions = list[Function]()
    for index in indices:
        operation, arguments, value = trace.steps[index]
        done = [buffers[i] for i in dict.fromkeys(arguments)
                if i in buffers and last_use[i] == index]
        if operation not in _NOT_IN_PLACE:
            free += done
        if index not in names:
            if operation in _CONDITIONS or not free:
                names[index] = f'b{len(kinds)}'
                kinds.append(bool if operation in _CONDITIONS else float)
            else:
                names[index] = free.pop()
            if operation not in _CONDITIONS:
                buffers[index] = names[index]
        if operation in _NOT_IN_PLACE:
            free += done
        operands = [names.get(i, f'v{i}') for i in (*arguments, index)]
        if operation == 'call':
            functions.append(value)
            lines.append(f'copy({operands[1]}, f{len(functions) - 1}({operands[0]}))')
        else:
            lines.append(f'{operation}({", ".join(operands)})')
    # an input, one number, or a result twice
    return lines + [f'copy(r{i}, {names.get(index, f"v{index}")})'
                    for i, index in enumerate(results)
                    if names.get(index) != f'r{i}'], kinds, functions


def _carriers(trace: Trace, indices: Sequence[int], bits: Mapping[int, int]) -> list[int]:
    """Return, for each result, the ``bits`` of the roots and the position it depends on."""
    # Out of range they are NaN, and so make the result NaN. Rate and acceleration do not count: a
    # result may multiply them by zero.
    carried = list[int]()
    for index, step in enumerate(trace.steps):
        bit = bits[index] if index == 0 or step.operation == 'sqrt' else 0
        for i in step.arguments:
            bit |= carried[i]
        carried.append(bit)
    return [carried[index] for index in indices]


@cache
def keep_memory() -> None:
    """Have blocks of up to 31 MB kept by the C library when they are freed, once and for all."""
    # glibc gives each back to the system until it has seen one of that size freed; getting the
    # pages again takes as long as the formulas: motion and loads of 10 000 samples of a four-bar
    # 0.34 us a sample, without it 0.6 to 0.8. The block is never touched, so it costs nothing.
    np.empty(31 * 2**17)
