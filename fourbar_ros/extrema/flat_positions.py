# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion and loads next to the flat position of an exact change point, where their formulas are 0/0.

On either side, in one mode, what they are made of is a power of the distance t times an analytic
function. From numbers of many digits at some places (:mod:`fourbar_ros.numerics.digits`) follow
the power and a polynomial, which keep all digits, however small the real or complex t is. Sizes of
vectors and angles are no such functions next to a zero: they are taken of their components last.
"""
from __future__ import annotations

from decimal import Decimal, localcontext
from functools import cache, lru_cache
from math import frexp, log10, pi, prod
from typing import Any

from fourbar_ros.mechanisms.evaluation import formula_of, MOST_STRUCTURES, NEAR
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.digits import in_decimals, is_nothing, MANY_DIGITS
from fourbar_ros.numerics.number_types import numbers_of
from fourbar_ros.numerics.tables import ARRAYS, run
from fourbar_ros.numerics.trace import flat, Trace
import numpy as np

# The scale is one to two times the distance of the next singularity. Up to this part of it
# polynomials through NODES places, at equal steps, leave out some 2^-60 of the first term.
REACH, NODES = 2.0**-4, 16
NOT_ANALYTIC = ('hypot', 'atan2')


@cache
def _weights() -> Array:
    """Return coefficients of polynomials that are 1 at one of 1, 2, ... NODES, 0 at the rest."""
    columns = []
    for node in range(1, NODES + 1):
        zeros = [zero for zero in range(1, NODES + 1) if zero != node]
        columns.append([Decimal(c) / prod(node - zero for zero in zeros)
                        for c in np.poly(zeros)[::-1]])
    return np.array(columns).T


@lru_cache(maxsize=MOST_STRUCTURES)
def _cut(trace: Trace) -> tuple[list[int], list[int]]:
    """Return the indices of the analytic numbers that results need, and of steps from these."""
    late = set[int]()
    needed = trace.needed(flat(trace.results))
    for index in needed:
        step = trace.steps[index]
        if index in trace.varies and (step.operation in NOT_ANALYTIC
                                      or not late.isdisjoint(step.arguments)):
            late.add(index)
    taken = {i for index in late for i in trace.steps[index].arguments}.union(flat(trace.results))
    return sorted((taken & trace.varies) - late), sorted(late)


class FlatSide:
    """
    Motion and loads on one side of a flat position, in the mode of a mechanism.

    ``rates``: rate and acceleration of the input. ``flat_x``: the flat position, in the input's
    unit. ``side``: +1 for inputs above it, -1 below. ``with_loads``: of a mechanism with bodies.

    Attributes
    ----------
    varies : dict of str: bool
        By field of motion and loads whether it is more than a constant.

    """

    def __init__(self, mechanism: Mechanism, rates: tuple[float, float], flat_x: float,
                 side: int, with_loads: bool) -> None:
        """Compute with many digits beside the flat position, nearer than the next singularity."""
        unit, names = mechanism.input_unit, mechanism.MOTION._fields
        self._is_angle = not mechanism.is_driven_by_slide
        self.x, self.side = flat_x, side
        singular = (self._turned(z / unit - flat_x) for z in mechanism.singular_inputs)
        self._scale = 2.0**frexp(min([1.0, *filter(None, map(abs, singular))]))[1]
        record = mechanism.record_with_loads if with_loads else mechanism.record_of_motion
        self._trace = record.trace
        self._values: list[Any] = [None, *rates, *record.constants[3:]]
        self._results, (self._analytic, self._late) = flat(self._trace.results), _cut(self._trace)
        count = len(self._analytic)
        with localcontext(MANY_DIGITS):
            values_of = in_decimals(self._trace, numbers_of(formula_of(mechanism, with_loads)[1]),
                                    [*self._analytic, *self._results])
            start, scale = mechanism.flat_place(unit * flat_x), Decimal(unit * side * self._scale)

            def values_beside(distance: Decimal) -> list[Decimal]:
                """Return the analytic numbers at a distance in units of the scale."""
                return values_of(start + scale * distance, *map(Decimal, rates))

            far, near = map(values_beside, NEAR)
            self._powers = np.array([round(log10(abs(a / b)) * 0.5) if a and b else 0
                                     for a, b in zip(far[:count], near)])
            distances = [Decimal(REACH) / NODES * k for k in range(1, NODES + 1)]
            values = np.array([values_beside(distance) for distance in distances])
            names += mechanism.LOADS._fields if with_loads else ()
            self.varies = {name: not is_nothing(max(v) - min(v), *v)
                           for name, v in zip(names, values[:, count:].T)}
            without_powers = values[:, :count] / np.array(distances)[:, None]**self._powers
            self._c = (_weights() @ without_powers).astype(float)[..., None]

    def _turned(self, difference: Any) -> Any:
        """Return a difference of two inputs, of angles the short way round: in [-pi, pi]."""
        return (difference - 2.0 * pi * np.round(difference.real / (2.0 * pi)) if self._is_angle
                else difference)

    def distance(self, x: Array) -> Array:
        """Return the distances of inputs on this side, in units of the scale."""
        return np.asarray(self.side * self._turned(x - self.x) / self._scale)

    def state(self, t: Array) -> Array:
        """Return fields of motion and of loads, if any, at distances t, (fields, t.size)."""
        s = t * (NODES / REACH)
        rows = np.zeros((len(self._analytic), t.size), t.dtype)
        for c in self._c[::-1]:
            rows = rows * s + c
        values = list(self._values)
        with np.errstate(all='ignore'):
            for index, row, power in zip(self._analytic, rows, self._powers.tolist()):
                values[index] = row * t**power if power >= 0 else row * (1.0 / t)**-power
            run(self._trace, self._late, ARRAYS, values)
        return np.stack([np.broadcast_to(values[i], t.shape) for i in self._results])
