# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The pieces of the force tables of an equation of motion: between their ends it is smooth.

In a piece each table is one polynomial, and with it in place of the table the equation is smooth
beyond the ends of the piece too. An integrator that takes a step to about the end sees nothing of
the kink there, and needs no search for it.
"""
from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import chain, pairwise
from math import copysign, floor, inf, pi, tau
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.elements import LinkAngle
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.write import straight_line

if TYPE_CHECKING:
    from fourbar_ros.dynamics.equation import Equation

AT_END = 1e-9          # distance in the unit of the input within which it is at an end


class Polynomial(NamedTuple):
    """A table about one s: ((a t + b) t + c) t + d, t = s - start."""

    a: Scalar
    b: Scalar
    c: Scalar
    d: Scalar
    start: Scalar
    about: Scalar      # that s: an angle counts within half a turn of it

    def at(self, n: NumberType, s: Scalar, is_angle: bool) -> Scalar:
        """Return the value at s."""
        if is_angle:
            apart = s - self.about
            s = n.where(apart > pi, s - tau, n.where(apart < -pi, s + tau, s))
        t = s - self.start
        value: Scalar = ((self.a * t + self.b) * t + self.c) * t + self.d
        return value


COUNT = len(Polynomial._fields)


class TablePieces:
    """The pieces of all tables over the input, which the equation must be in."""

    def __init__(self, equation: Equation) -> None:
        self._equation, mechanism = equation, equation.mechanism
        # after which all tables are the same again [rad]
        self._cycle = inf if mechanism.is_driven_by_slide else tau * mechanism.turns

    @cached_property
    def _ends(self) -> list[float]:
        """Return the inputs of a cycle at which a polynomial ends, in order."""
        pieces = self._equation.mechanism.pieces
        ends = list(pieces.ends) if pieces else []
        if not ends:
            return ends
        beside = 0.5 * (ends[0] + self._cycle - ends[-1]) if self._cycle < inf else AT_END
        inside = [ends[0] - beside, *[0.5 * (a + b) for a, b in pairwise(ends)], ends[-1] + beside]
        constants = [self._constants(position) for position in inside]
        return [end for end, (before, after) in zip(ends, pairwise(constants))
                if not before or before != after]

    def _constants(self, position: float) -> list[float] | None:
        """Return the values of all tables about an input if they are constant there, else None."""
        try:
            polynomials = self._polynomials(position)
        except FourBarError:            # where the links do not close
            return None
        is_constant = not any(each.a or each.b or each.c for each in polynomials)
        return [each.d for each in polynomials] if is_constant else None

    def end_ahead(self, position: float, rate: float) -> float:
        """Return the input at which the next piece ends, in the direction of its rate."""
        ends, cycle, turn = self._ends, self._cycle, 0.0
        if not ends:
            return copysign(inf, rate)
        if cycle < inf:
            turn = cycle * floor((position - ends[0]) / cycle)
        if rate > 0.0:
            i = bisect_right(ends, position - turn + AT_END)
            return turn + (ends[i] if i < len(ends) else ends[0] + cycle)
        i = bisect_left(ends, position - turn - AT_END) - 1
        return turn + (ends[i] if i >= 0 else ends[-1] - cycle)

    def _polynomials(self, position: float) -> list[Polynomial]:
        """Return the polynomials that the tables are about an input."""
        polynomials = []
        for force, s in zip(self._equation.tables, self._equation.table_positions(position)):
            (a, b, c, d), start, _, _ = force.value.polynomial(s)
            polynomials.append(Polynomial(a, b, c, d, start, s))
        return polynomials

    @cached_property
    def _line(self) -> Function:
        """Return (input, *numbers of all polynomials) -> fields of Terms."""
        equation = self._equation
        # each force has a table of its own
        forces = {id(force.value): (i, isinstance(force.over, LinkAngle))
                  for i, force in enumerate(equation.tables)}

        def make(n: NumberType) -> Function:
            def terms(position: Scalar, *numbers: Scalar) -> Sequence[Scalar]:
                def call(function: Any, s: Any) -> Any:
                    if id(function) not in forces:
                        return n.call(function, s)
                    i, is_angle = forces[id(function)]
                    return Polynomial(*numbers[COUNT * i:COUNT * (i + 1)]).at(n, s, is_angle)
                of_pieces = equation.make_terms(equation.coordinate, replace(n, call=call))
                fields: Sequence[Scalar] = of_pieces(position)
                return fields
            return terms
        return straight_line(make, 1 + COUNT * len(equation.tables))

    def terms_about(self, inside: float) -> Function:
        """
        Return input -> fields of Terms, in the piece that has an input inside, and beyond.

        Raises FourBarError where the links do not close there; the function ArithmeticError.
        """
        line, numbers = self._line, tuple(chain.from_iterable(self._polynomials(inside)))

        def terms(position: float) -> Sequence[float]:
            try:
                fields: Sequence[float] = line(position, *numbers)
                return fields
            except ValueError:
                raise ArithmeticError('the links do not close') from None
        return terms
