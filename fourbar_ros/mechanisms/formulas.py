# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism as it is made: checked, copied, its formulas made once for each type of numbers."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields as fields_of
from dataclasses import replace
from functools import cached_property
from typing import Any, TypeVar

from fourbar_ros.mechanics.bodies import External
from fourbar_ros.mechanisms.checks import checked, checked_stroke
from fourbar_ros.mechanisms.contract import OPEN
from fourbar_ros.mechanisms.described import Described
from fourbar_ros.mechanisms.evaluation import recorded
from fourbar_ros.mechanisms.stroke import motion_within
from fourbar_ros.numerics.number_types import Function, NumberType
from fourbar_ros.numerics.recorded import Constants as ProgramConstants
from fourbar_ros.numerics.recorded import Record

_new = tuple.__new__     # of a NamedTuple from a tuple: four times faster than its own constructor
_Self = TypeVar('_Self', bound='Formulas')


class Formulas(Described):
    """What a mechanism makes of its data: copies, formulas for any numbers, their records."""

    # --- made and copied ------------------------------------------------------------------------

    def _check(self) -> None:
        """Refuse what no mechanism can have, and keep the rest as numbers and records."""
        for name, value in checked(self).items():
            object.__setattr__(self, name, value)

    def _check_stroke(self) -> None:
        """Refuse a wrong stroke, and keep a right one as two floats."""
        object.__setattr__(self, 'stroke', checked_stroke(self))

    def __getstate__(self) -> dict[str, Any]:
        """
        Return what was given.

        Functions made on the way are made again where they are needed.
        """
        return {field.name: getattr(self, field.name) for field in fields_of(self)}

    def in_mode(self: _Self, mode: int) -> _Self:
        """Return the same mechanism in another assembly mode."""
        return self if mode == self.mode else replace(self, mode=mode)

    def without_stroke(self: _Self) -> _Self:
        """Return the same mechanism without a stroke: its poses beyond it, where there are any."""
        return self if self.stroke is None else replace(self, stroke=None)

    def with_lengths(self: _Self, lengths: Sequence[float]) -> _Self:
        """Return the same mechanism with other :attr:`lengths`."""
        return replace(self, **dict(zip(self.length_names, lengths)))

    def with_external(self: _Self, external: External) -> _Self:
        """
        Return the same mechanism with another :class:`~fourbar_ros.mechanics.bodies.External`.

        What does not depend on it is shared.
        """
        other = object.__new__(type(self))
        # what else is in it was checked
        other.__dict__.update(self.__dict__, external=external)
        for name in ('constants', '_of_one', 'record_of_motion', 'record_with_loads'):
            other.__dict__.pop(name, None)
        other.__dict__['_made'] = {key: made for key, made in self._made.items()
                                   if key[0] == 'motion'}
        return other

    # --- its formulas, made once for each type of numbers ----------------------------------------

    @cached_property
    def _made(self) -> dict[tuple[str, NumberType], Function]:
        """Return the formulas made by :meth:`make_motion` and :meth:`make_loads`."""
        return {}

    def make_motion(self, numbers: NumberType) -> Function:
        """
        Return (position, rate, acceleration) -> fields of MOTION for a number type.

        Out of range it gives NaN, or ValueError where numbers are floats.
        """
        if ('motion', numbers) not in self._made:
            formula = self.motion_formula(numbers, self.constants)
            self._made['motion', numbers] = (formula if self.stroke is None
                                             else motion_within(formula, self.stroke, numbers))
        return self._made['motion', numbers]

    def make_loads(self, numbers: NumberType) -> Function:
        """Return the function (fields of MOTION) -> fields of LOADS for a type of numbers."""
        if ('loads', numbers) not in self._made:
            self._made['loads', numbers] = self.loads_formula(numbers, self.constants)
        return self._made['loads', numbers]

    def make_coefficients(self, numbers: NumberType) -> Function:
        """
        Return position -> coefficients of all links for a number type: what dynamics is made of.

        For each of ``LINKS`` (x, y, x', y', x'', y'', cosine, sine, theta', theta''): place of its
        first joint and direction, primes for derivatives with respect to the input, so a
        LinkMotion at unit rate and zero acceleration. Exact, and one call for all links. A stroke
        is no limit here; where the links cannot close: ValueError, or NaN in arrays.
        """
        motion_of, as_motion = self.motion_formula(numbers, self.constants), self.MOTION
        link_motion, links = self.link_motion, [link.name for link in self.LINKS]

        def coefficients(position: Any) -> list[tuple[Any, ...]]:
            motion = _new(as_motion, motion_of(position, 1.0, 0.0))
            return [link_motion(motion, link) for link in links]
        return coefficients

    def read_coordinate(self, numbers: NumberType, curves: Any) -> tuple[Any, Any, Any]:
        """
        Return the input and its two derivatives from coefficients of the links.

        These may be with respect to another coordinate. An angle is in [-pi, pi].
        """
        if self.is_driven_by_slide:
            x, _, d_x, _, dd_x, *_ = curves[-1]
            return x, d_x, dd_x
        *_, cosine, sine, turn, bend = curves[0]
        return numbers.atan2(sine, cosine), turn, bend

    def driven_otherwise(self) -> tuple[Any, ...]:
        """
        Return the same links with another coordinate as the input, one for each assembly mode.

        Where the input turns back at a toggle position, that coordinate goes on. They have
        ``make_coefficients``, of the same links, ``read_coordinate`` and ``in_mode``. Nothing
        where no other coordinate is known.
        """
        for other in self.INPUTS:
            if other != self.input:
                free = replace(self, input=other, mode=OPEN, stroke=None)
                return tuple([free.in_mode(mode) for mode in sorted(free.modes)])
        return ()

    @cached_property
    def record_of_motion(self) -> tuple[Record, ProgramConstants]:
        """Return the record of the motion, and this mechanism's constants in it."""
        return recorded(self, False)

    @cached_property
    def record_with_loads(self) -> tuple[Record, ProgramConstants]:
        """Return the record of motion and loads, and this mechanism's constants in it."""
        return recorded(self, True)
