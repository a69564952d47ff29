# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A trace replayed on arrays: only what was asked for, in buffers that stay in the cache.

A :class:`Program` takes from a trace the steps that some results need, does those of single
numbers once, gives each of the others numpy's function and a buffer, and uses a buffer again when
nothing needs its content any more. Operations, their order and so their results are those of the
formula on arrays.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache
import operator
from typing import Any

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function, hypot_of_arrays
from fourbar_ros.numerics.trace import flat, Trace
import numpy as np

CHUNK = 12288     # most samples at a time
CONDITIONS = ('gt', 'lt')
NOT_IN_PLACE = ('where', 'hypot')     # they read their arguments after they began to write


def _where(condition: Array, one: Any, other: Any, out: Array) -> None:
    np.copyto(out, other)
    np.copyto(out, one, where=condition)


# Of arrays; the last argument is where the result goes. All other operations are on data alone.
_FUNCTIONS: dict[str, Function] = {
    'add': np.add, 'sub': np.subtract, 'mul': np.multiply, 'truediv': np.true_divide,
    'neg': np.negative, 'gt': np.greater, 'lt': np.less, 'sin': np.sin, 'cos': np.cos,
    'sqrt': np.sqrt, 'atan2': np.arctan2, 'fabs': np.abs, 'hypot': hypot_of_arrays,
    'where': _where}


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


class Program:
    """
    The operations of a trace of three inputs that the results ``wanted`` need.

    ``single``: which inputs are one number, not arrays. ``zeros``: places of numbers that do not
    depend on the inputs and are zero: what only adds zero is left out, unless a result would then
    no longer be NaN where it should.
    """

    def __init__(self, trace: Trace, wanted: Sequence[int], single: Sequence[bool],
                 zeros: frozenset[int]) -> None:
        """Leave out what zeros make needless, and give each other step a buffer."""
        simple = trace.simplified(dict.fromkeys(zeros, 0.0))
        full, less = ([flat(one.results)[i] for i in wanted] for one in (trace, simple))
        if _carriers(simple, less) != _carriers(trace, full):
            simple, less = trace, full
        self._steps, self._places = simple.steps, less
        steps = [place for place in simple.needed(less)
                 if place in trace.varies and place >= trace.count]
        self._is_single = [place not in trace.varies for place in range(len(trace.steps))]
        self._is_single[:3] = single
        for place in steps:
            self._is_single[place] = all(self._is_single[i]
                                         for i in simple.steps[place].arguments)
        self._once = [place for place in steps if self._is_single[place]]
        self._buffers: list[type] = []
        self.steps = self._allocate([place for place in steps if not self._is_single[place]])

    def _allocate(self, places: list[int]) -> list[tuple[Function, Function]]:
        """
        Return, for each step, numpy's function and the getter of its arguments from the values.

        The values are those of all places, then the buffers. A result is written to its own place;
        another step gets a buffer that no later step reads any more, or a new one.
        """
        size = len(self._steps)
        last_use = {i: place for place in places for i in self._steps[place].arguments}
        results: set[int] = set(self._places)
        free: list[int] = []
        buffer_of: dict[int, int] = {}
        steps: list[tuple[Function, Function]] = []
        for place in places:
            name, arguments, _ = self._steps[place]
            done = [buffer_of[i] for i in dict.fromkeys(arguments)
                    if i in buffer_of and last_use[i] == place]
            done = [buffer for buffer in done if self._buffers[buffer] is float]
            if name not in NOT_IN_PLACE:
                free += done
            if place not in results:
                if free and name not in CONDITIONS:
                    buffer_of[place] = free.pop()
                else:
                    buffer_of[place] = len(self._buffers)
                    self._buffers.append(bool if name in CONDITIONS else float)
            if name in NOT_IN_PLACE:
                free += done
            taken = [size + buffer_of[i] if i in buffer_of else i for i in (*arguments, place)]
            steps.append((_FUNCTIONS[name], operator.itemgetter(*taken)))
        return steps

    def run(self, inputs: Sequence[Any], constants: Sequence[Any], size: int) -> list[Array]:
        """
        Return the results as arrays of shape (size,) with own memory, computed chunk by chunk.

        ``inputs``: three, each of shape (size,) or a float. ``constants``: by place, as
        :meth:`.Trace.constants` returns them.
        """
        keep_memory()
        values = [*inputs, *constants[3:]]
        for place in self._once:
            step = self._steps[place]
            values[place] = step.value if step.is_given else step.of(
                *[values[i] for i in step.arguments])
        rows: list[Array] = [np.empty(size) for _ in self._places]
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

    def _replay(self, values: list[Any], rows: list[Array]) -> None:
        """Do all steps on one chunk: ``values`` by place, then buffers; results go into rows."""
        own: dict[int, Array] = {}
        for place, row in zip(self._places, rows):
            if not self._steps[place].is_given and not self._is_single[place]:
                own.setdefault(place, row)
        for place, row in own.items():
            values[place] = row
        for function, arguments in self.steps:
            function(*arguments(values))
        for place, row in zip(self._places, rows):
            if own.get(place) is not row:     # an input, one number, or a result twice
                row[...] = values[place]


@cache
def keep_memory() -> None:
    """
    Have blocks of up to 31 MB kept by the C library when they are freed, once and for all.

    glibc gives each back to the system until it has seen one of that size freed; getting the pages
    again takes as long as the formulas: motion and loads of 10 000 samples of a four-bar 0.34 us a
    sample, without it 0.6 to 0.8. The block is never touched, so it costs nothing.
    """
    np.empty(31 * 2**17)


@lru_cache(maxsize=512)
def program(trace: Trace, wanted: tuple[int, ...], single: tuple[bool, ...],
            zeros: frozenset[int]) -> Program:
    """Return the :class:`Program` of a trace, made once."""
    return Program(trace, wanted, single, zeros)
