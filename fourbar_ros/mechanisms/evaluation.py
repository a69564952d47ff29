# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism evaluated for one input, by generated Python code: floats, without a call or loop.

The code is written from the trace of the formulas (:mod:`fourbar_ros.numerics.trace`), which all
mechanisms of a structure share. A debugger stops in formulas while they are traced only; to step
through them in floats, call them by another arithmetic:
``linkage.motion_in(REAL, linkage.constants, theta1, omega1, alpha1)``, with REAL of
:mod:`fourbar_ros.numerics.number_types`.
"""
from __future__ import annotations

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
    """The data of a mechanism that its formulas are made for, as floats."""

    # converted() puts other kinds of numbers there.
    lengths: Any
    sign: Any
    bodies: Any
    gravity: Gravity
    external: Any
    elements: tuple[Any, ...] = ()
    friction: Any = ()      # of joints and drive, in the order of the mechanism's

    @property
    def of_motion(self) -> Constants:
        return self._replace(bodies=None, elements=(), friction=())


@dataclass(frozen=True)
class Formula:
    """The formula of motion, or of motion and loads, of all mechanisms of a structure."""

    structure: tuple[object, ...]       # all in which formulas differ besides their data
    with_loads: bool
    mechanism: Mechanism = field(compare=False, repr=False)      # any of the structure
    data: Constants = field(compare=False, repr=False)      # of that mechanism

    def make(self, n: NumberType, data: Constants) -> Function:
        mechanism = self.mechanism

        def formula(*inputs: Scalar) -> Any:
            motion = mechanism.motion_in(n, data, *inputs)
            return (motion, mechanism.loads_in(n, data, motion)) if self.with_loads else motion
        return formula


def formula_of(mechanism: Mechanism, with_loads: bool) -> Formula:
    structure, data = mechanism.structure, mechanism.constants
    if not with_loads:
        data = data.of_motion
    elif mechanism.elements:
        from fourbar_ros.mechanisms.elements import structure_of  # few mechanisms have any
        structure += (structure_of(mechanism.elements),)
    if with_loads:
        structure += tuple([(name, friction.structure) for name, friction in mechanism.friction])
    return Formula((*structure, type(mechanism.gravity)), with_loads, mechanism, data)


@lru_cache(maxsize=MOST_STRUCTURES)
def trace_of(formula: Formula) -> Trace:
    return Trace(formula.make, 3, formula.data)


class Recorded(NamedTuple):
    """The trace of a mechanism's formula with its constants."""

    # constants: by index in the trace its value, None if it needs the input; zeros: the indices of
    # constants that are zero and used together with inputs, so that a program can leave out
    # products with them.
    trace: Trace
    constants: list[float | None]
    zeros: frozenset[int]


def trace_for(mechanism: Mechanism, with_loads: bool) -> tuple[Trace, list[float]]:
    """Return the trace of a mechanism's motion, or motion and loads, and its data."""
    # A switch of a trace chooses between two formulas by lengths alone and is on at change points
    # only. Other mechanisms take the trace without: it is shorter, and refuses no pose for a step
    # that only the other formula needs. Kinds know the sums of lengths that are 0 at change points
    # (margins, with MARGIN_SIGNS); of a machine the switches themselves are computed.
    formula = formula_of(mechanism, with_loads)
    trace, values = trace_of(formula), numbers_of(formula.data)
    is_change_point = (0.0 in mechanism.margins if mechanism.MARGIN_SIGNS
                       else trace.is_switched(values))
    return trace if is_change_point else trace.unswitched, values


def recorded(mechanism: Mechanism, with_loads: bool) -> Recorded:
    trace, values = trace_for(mechanism, with_loads)
    constants = trace.constants(values)
    return Recorded(trace, constants, frozenset([
        i for i in trace.used_constants if constants[i] == 0.0]))


_lines = lru_cache(maxsize=MOST_STRUCTURES)(lines_of)


def generated(mechanism: Mechanism, with_loads: bool) -> Function:
    """Return (position, rate, acceleration) -> motion, or (motion, loads), tuples of floats."""
    # The operations of the formulas in their order, so with their bits, compiled once for a
    # structure. Out of reach it raises ValueError; no other checks.
    trace, values = trace_for(mechanism, with_loads)
    zeros = frozenset[int]() if not mechanism.LEAVES_OUT_ZEROS else (
        recorded(mechanism, with_loads).zeros
        | {trace.count + i for i, value in enumerate(values) if value == 0.0})
    name = f'{mechanism.TITLE}: motion' + with_loads * ' and loads'
    compute, reaches = _lines(trace, zeros, name)(values), mechanism.reaches
    if reaches is None:
        return compute

    def within(position: float, rate: float, acceleration: float) -> Any:
        if not reaches(position):
            raise ValueError
        return compute(position, rate, acceleration)
    return within
