# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A recorded formula replayed on arrays: only what was asked for, in buffers that stay in the cache.

A :class:`Program` takes from a record the operations that some results need, does those of single
numbers once, gives each of the others numpy's function and a buffer, and uses a buffer again when
nothing needs its content any more. Operations, their order and so their results are those of the
formula on arrays.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cache
import operator
from typing import Any

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.recorded import Constants, OPERATIONS, Record, Step
import numpy as np

CHUNK = 12288     # most samples at a time
CONDITIONS = ('gt', 'lt')
NOT_IN_PLACE = ('where', 'hypot')     # they read their arguments after they began to write


def _without_zeros(record: Record, zeros: frozenset[int]) -> tuple[list[Step], list[int]]:
    """Return the steps without products and sums of zero, and the new place of each number."""
    steps, same = list(record.steps), list(range(len(record.steps)))
    for place, step in enumerate(record.steps):
        if step is None or place in record.is_constant:
            continue
        name, arguments = step[0], tuple([same[i] for i in step[1]])
        steps[place] = name, arguments
        is_zero = [i in zeros for i in arguments]
        if name == 'mul' and any(is_zero) or name in ('add', 'sub', 'neg') and all(is_zero):
            same[place] = arguments[is_zero.index(True)]
        elif name in ('add', 'sub') and is_zero[1]:
            same[place] = arguments[0]
        elif name == 'add' and is_zero[0]:
            same[place] = arguments[1]
    return steps, same


def _carriers(steps: list[Step], places: Sequence[int]) -> list[frozenset[int]]:
    """
    Return for each result the inputs and roots it depends on.

    What makes it NaN out of range.
    """
    found: list[frozenset[int]] = []
    for place, step in enumerate(steps):
        if step is None:
            found.append(frozenset((place,)) if place < 3 else frozenset())
        else:
            carried = frozenset[int]().union(*[found[i] for i in step[1]])
            found.append(carried | {place} if step[0] == 'sqrt' else carried)
    return [found[place] & _pose(steps) for place in places]


def _pose(steps: list[Step]) -> frozenset[int]:
    """
    Return the places of the position and of all roots.

    Not of rate and acceleration, which may be multiplied by zero.
    """
    return frozenset((0, *(place for place, step in enumerate(steps) if step is not None
                           and step[0] == 'sqrt')))


class Program:
    """
    The operations of a record that some results need.

    Parameters
    ----------
    record : Record
    wanted : sequence of int
        Which results.
    single : sequence of 3 bools
        Which inputs are one number for all samples.
    zeros : frozenset of int
        Which constants are zero: what only adds zero is left out, unless a result would then no
        longer be NaN where it should.

    """

    def __init__(self, record: Record, wanted: Sequence[int], single: Sequence[bool],
                 zeros: frozenset[int] = frozenset()):
        self._record, results = record, [record.results[i] for i in wanted]
        self._is_single = [True] * len(record.steps)
        self._is_single[:3] = single
        self._steps, same = _without_zeros(record, zeros)
        self._places = [same[place] for place in results]
        if _carriers(self._steps, self._places) != _carriers(record.steps, results):
            self._steps, self._places = record.steps, results
        steps = self._needed()
        for place in steps:
            self._is_single[place] = all(self._is_single[i] for i in self._steps[place][1])
        self._once = [self._once_step(place) for place in steps if self._is_single[place]]
        self._buffers: list[type] = []
        self.steps = self._allocate([place for place in steps if not self._is_single[place]])

    def _needed(self) -> list[int]:
        """Return the places of the operations that the results need, in order."""
        steps, needed, left = self._steps, set(), list(self._places)
        while left:
            place = left.pop()
            if (place not in needed and steps[place] is not None
                    and place not in self._record.is_constant):
                needed.add(place)
                left += steps[place][1]
        return sorted(needed)

    def _once_step(self, place: int) -> tuple[int, Function, tuple[int, ...]]:
        name, arguments = self._steps[place]
        return place, OPERATIONS[name][0], arguments

    def _allocate(self, places: list[int]) -> list[tuple[Any, Function]]:
        """
        Return (numpy's function, what takes its arguments from the values) of all steps.

        Results own their places.
        """
        size = len(self._record.steps)
        last = {i: place for place in places for i in self._steps[place][1]}
        results: set[int] = set(self._places)
        free: list[int] = []
        where: dict[int, int] = {}
        found: list[tuple[Any, Function]] = []
        for place in places:
            name, arguments = self._steps[place]
            done = [where[i] for i in dict.fromkeys(arguments) if i in where and last[i] == place]
            done = [buffer for buffer in done if self._buffers[buffer] is float]
            if name not in NOT_IN_PLACE:
                free += done
            if place not in results:
                if free and name not in CONDITIONS:
                    where[place] = free.pop()
                else:
                    where[place] = len(self._buffers)
                    self._buffers.append(bool if name in CONDITIONS else float)
            if name in NOT_IN_PLACE:
                free += done
            taken = [size + where[i] if i in where else i for i in (*arguments, place)]
            found.append((OPERATIONS[name][1], operator.itemgetter(*taken)))
        return found

    def run(self, inputs: Sequence[Any], constants: Constants, size: int) -> list[Array]:
        """Return the results for inputs, each (size,) or a float, as arrays with own memory."""
        values = [*inputs, *constants.values[3:]]
        for place, function, arguments in self._once:
            values[place] = function(*[values[i] for i in arguments])
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
        own: dict[int, Array] = {}
        for place, row in zip(self._places, rows):
            if self._steps[place] is not None and not self._is_single[place]:
                own.setdefault(place, row)
        for place, row in own.items():
            values[place] = row
        for function, arguments in self.steps:
            function(*arguments(values))
        for place, row in zip(self._places, rows):
            if own.get(place) is not row:     # an input, one number, or a result twice
                row[...] = values[place]


@cache
def program(record: Record, wanted: tuple[int, ...], single: tuple[bool, ...],
            zeros: frozenset[int]) -> Program:
    """Return the :class:`Program` of a record, made once."""
    return Program(record, wanted, single, zeros)
