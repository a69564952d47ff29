# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism evaluated for one input, by a straight line of floats.

It is written from the trace of its formulas (:mod:`fourbar_ros.numerics.trace`), which all
mechanisms of a structure share.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.mechanics.bodies import Gravity
from fourbar_ros.numerics.number_types import Function, numbers_of, NumberType, Scalar
from fourbar_ros.numerics.trace import Trace
from fourbar_ros.numerics.write import lines_of

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Mechanism

MOST_STRUCTURES = 256      # whose traces and lines are kept


class Constants(NamedTuple):
    """
    The data of a mechanism that its formulas are made for, as floats.

    :func:`~fourbar_ros.numerics.number_types.converted` puts other kinds of numbers there.
    """

    lengths: Any
    sign: Any
    bodies: Any
    gravity: Gravity
    external: Any
    elements: tuple[Any, ...] = ()
    friction: Any = ()      # of joints and drive, in the order of the mechanism's

    @property
    def of_motion(self) -> Constants:
        """Return those of the motion alone."""
        return self._replace(bodies=None, elements=(), friction=())


@dataclass(frozen=True)
class Formula:
    """The formula of motion, or of motion and loads, of all mechanisms of a structure."""

    structure: tuple[object, ...]       # all in which formulas differ besides their data
    with_loads: bool
    mechanism: Mechanism = field(compare=False, repr=False)      # any of the structure

    def make(self, n: NumberType, data: Constants) -> Function:
        """Return (position, rate, acceleration) -> motion, or (motion, loads)."""
        motion_of = self.mechanism.motion_formula(n, data)
        if not self.with_loads:
            return motion_of
        loads_of = self.mechanism.loads_formula(n, data)

        def step(*inputs: Scalar) -> tuple[Any, Any]:
            motion = motion_of(*inputs)
            return motion, loads_of(motion)
        return step


def formula_of(mechanism: Mechanism, with_loads: bool) -> tuple[Formula, Constants]:
    """Return the formula of a mechanism, and the data it is made for."""
    structure, data = mechanism.structure, mechanism.constants
    if not with_loads:
        data = data.of_motion
    elif mechanism.elements:
        structure += mechanism.structure_of_elements
    if with_loads:
        structure += tuple([(name, friction.structure) for name, friction in mechanism.friction])
    return Formula((*structure, type(mechanism.gravity)), with_loads, mechanism), data


@lru_cache(maxsize=MOST_STRUCTURES)
def trace_of(formula: Formula) -> Trace:
    """Return the trace of a formula, which serves all mechanisms of its structure."""
    return Trace(formula.make, 3, formula_of(formula.mechanism, formula.with_loads)[1])


class Recorded(NamedTuple):
    """
    The trace of a mechanism's formula with its constants.

    ``constants``: by index in the trace its value, None if it needs the input; ``zeros``: the
    indices of constants that are zero and used together with inputs, so that a
    program can leave out products with them.
    """

    trace: Trace
    constants: list[float | None]
    zeros: frozenset[int]


def recorded(mechanism: Mechanism, with_loads: bool) -> Recorded:
    """Return the trace of a mechanism's motion, or motion and loads, and its own constants."""
    formula, data = formula_of(mechanism, with_loads)
    trace, values = trace_of(formula), numbers_of(data)
    if not _is_switched(mechanism, trace, values):
        trace = trace.unswitched
    constants = trace.constants(values)
    return Recorded(trace, constants, frozenset([
        i for i in trace.used_constants if constants[i] == 0.0]))


def _is_switched(mechanism: Mechanism, trace: Trace, values: Sequence[float]) -> bool:
    """Return whether formulas of a mechanism take what they have for change points."""
    return (mechanism.change_point_margin == 0.0 if mechanism.MARGIN_SIGNS
            else trace.is_switched(values))


@lru_cache(maxsize=MOST_STRUCTURES)
def _lines(formula: Formula, is_switched: bool,
           zeros: frozenset[int]) -> Callable[[Sequence[float]], Function]:
    """Return data -> straight line, for a formula with steps, by index, that are zero or false."""
    name = 'motion and loads' if formula.with_loads else 'motion'
    trace = trace_of(formula)
    return lines_of(trace if is_switched else trace.unswitched, zeros,
                    f'{formula.mechanism.TITLE}: {name}')


def line_of(mechanism: Mechanism, with_loads: bool) -> Function:
    """
    Return (position, rate, acceleration) -> motion, or (motion, loads), of floats, as tuples.

    A Python function written from the trace: the operations of the formulas in their order, so
    with their bits, but without the calls between them. It is compiled once for a structure.
    Out of reach it raises ValueError; no other checks.
    """
    formula, data = formula_of(mechanism, with_loads)
    trace, values = trace_of(formula), numbers_of(data)
    is_switched, zeros = _is_switched(mechanism, trace, values), frozenset[int]()
    if mechanism.LEAVES_OUT_ZEROS:
        zeros = recorded(mechanism, with_loads).zeros | {
            trace.count + i for i, value in enumerate(values) if value == 0.0}
    line, reaches = _lines(formula, is_switched, zeros)(values), mechanism.reaches
    return line if reaches is None else _within(line, reaches)


def _within(line: Function, reaches: Function) -> Function:
    """Return a line that raises ValueError for a position out of reach."""
    def within(position: float, rate: float, acceleration: float) -> Any:
        if not reaches(position):
            raise ValueError
        return line(position, rate, acceleration)
    return within
