# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism as users see it: evaluated for one input or arrays of inputs.

It gives its formulas for any :class:`~fourbar_ros.numerics.number_types.NumberType`
(:mod:`fourbar_ros.mechanisms.formulas`); here they are called for floats and arrays, with the same
rules for all. What a kind states about itself: :mod:`fourbar_ros.mechanisms.contract`.
"""
from __future__ import annotations

from collections.abc import Iterable
from functools import cache, cached_property
from math import isfinite
from numbers import Real
from typing import Any, NoReturn

from fourbar_ros.errors import FourBarError, InvalidParameter, MissingBodies, OutOfRange, Toggle
from fourbar_ros.mechanisms.contract import CRANK, CROSSED, OPEN, SLIDE  # noqa: F401
from fourbar_ros.mechanisms.evaluation import evaluate, line_of
from fourbar_ros.mechanisms.formulas import Formulas
from fourbar_ros.mechanisms.stroke import motion_within
from fourbar_ros.numerics.arrays import Values
from fourbar_ros.numerics.given import number
from fourbar_ros.numerics.number_types import Function, REAL

EPS = 2.0**-52
_new = tuple.__new__     # of a NamedTuple from a tuple: four times faster than its own constructor


class Mechanism(Formulas):
    """
    Base of the mechanisms: frozen dataclasses of lengths and what else they are made with.

    The fields beside lengths: ``mode``, ``input``, ``bodies``, ``gravity``, ``external``; where a
    slide can be driven, ``stroke``.
    """

    @cached_property
    def _motion_of_one(self) -> Function:
        return self._within_stroke(line_of(self, with_loads=False))

    @cached_property
    def _of_one(self) -> tuple[Any, ...]:
        """
        Return what a single step needs: the function of motion and loads, their types.

        Or MissingBodies.
        """
        if self.bodies is None:
            raise MissingBodies
        return self._within_stroke(line_of(self, with_loads=True)), self.MOTION, self.LOADS

    def _within_stroke(self, line: Function) -> Function:
        return line if self.stroke is None else motion_within(line, self.stroke, REAL)

    def prepare(self) -> Function:
        """
        Make the function of one sample, as the first would; the first of a structure is compiled.

        ArithmeticError or ValueError where numbers overflow.
        """
        made: Function = self._of_one[0] if self.bodies else self._motion_of_one
        return made

    # --- evaluated ------------------------------------------------------------------------------

    def motion(self, position: Values, rate: Values = 0.0, acceleration: Values = 0.0,
               fields: Iterable[str] | None = None) -> Any:
        """
        Return the motion for given input, its rate and acceleration.

        Parameters
        ----------
        position, rate, acceleration : float or array_like
            Crank angle [rad] (any number of turns), [rad/s], [rad/s^2], or slide [m], [m/s],
            [m/s^2], as ``input`` says; arrays are broadcast. Three floats take the fast scalar
            path; so do the samples of short arrays (some twenty), those of longer ones may differ
            from it in their last bits.
        fields : sequence of str, optional
            Names of fields of the result: these alone, computed with no more than they need, as a
            tuple in this order.

        Raises
        ------
        InvalidParameter, OutOfRange, Toggle
            For a single value that is not finite, out of range, at a toggle. In arrays such
            samples are NaN in every field that depends on it.

        Examples
        --------
        >>> from fourbar_ros import FourBar
        >>> linkage = FourBar(0.4, 1.2, 0.8, 1.0)
        >>> theta4, alpha4 = linkage.motion([0.5, 1.0], 25.0, fields=('theta4', 'alpha4'))
        >>> alpha4.shape
        (2,)

        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), False)
        if not (type(position) is type(rate) is type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                return self.motion(*self._numbers(position, rate, acceleration))
            return _new(self.MOTION, evaluate(self, (position, rate, acceleration), None, False))
        if (position + rate * rate + acceleration) * 0.0 != 0.0:
            self._require_finite(position, rate, acceleration)
        try:
            return _new(self.MOTION, self._motion_of_one(position, rate, acceleration))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def loads(self, position: Values, rate: Values = 0.0, acceleration: Values = 0.0) -> Any:
        """Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies."""
        return self.step(position, rate, acceleration)[1]

    def step(self, position: Values, rate: Values = 0.0, acceleration: Values = 0.0,
             fields: Iterable[str] | None = None) -> Any:
        """
        Return (motion, loads) together, at the cost of one.

        Arguments and errors as in :meth:`motion`.

        ``fields``: names of fields of motion and loads, which alone are then computed and
        returned. MissingBodies where loads are wanted of a mechanism without masses.
        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), True)
        line, as_motion, as_loads = self._of_one
        if not (type(position) is type(rate) is type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                return self.step(*self._numbers(position, rate, acceleration))
            rows, count = evaluate(self, (position, rate, acceleration), None,
                                   True), len(self.MOTION._fields)
            return _new(self.MOTION, rows[:count]), _new(self.LOADS, rows[count:])
        if (position + rate * rate + acceleration) * 0.0 != 0.0:
            self._require_finite(position, rate, acceleration)
        try:
            motion, loads = line(position, rate, acceleration)
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None
        if sum(loads) * 0.0 != 0.0:          # one is not finite, or nearly so
            raise InvalidParameter(self.input_coordinate.rate, rate,
                                   'so fast, or with such masses, that loads overflow')
        return _new(as_motion, motion), _new(as_loads, loads)

    def motion_and_loads(self, position: Values, rate: Values = 0.0, acceleration: Values = 0.0
                         ) -> tuple[Any, Any]:
        """Return (motion, loads) as :meth:`step` does; without masses the loads are None."""
        if self.bodies is None:
            return self.motion(position, rate, acceleration), None
        return tuple(self.step(position, rate, acceleration))

    def _require_finite(self, *values: float) -> NoReturn:
        for name, value in zip(self.input_coordinate, values):
            if not isfinite(value):
                raise InvalidParameter(name, value, 'must be a finite number')
        raise InvalidParameter(self.input_coordinate.rate, values[1],
                               'so fast that its square overflows')

    def _numbers(self, *values: Any) -> tuple[float, float, float]:
        position, rate, acceleration = map(number, self.input_coordinate, values)
        return position, rate, acceleration

    def _why_no_motion(self, position: float) -> FourBarError:
        """Return the error for an input at which a square root was not real or a sine zero."""
        name, unit = self.input_coordinate.position, self.input_coordinate.unit
        # A limit and the input compared with it are each rounded, and so is their distance.
        tolerance = 4.0 * EPS * abs(position)
        toggles = self.input_ranges if self.stroke is None else self.closing_ranges
        if self.is_in_stroke(position) and any(
                abs(self.distance(position, end)) <= tolerance for bounds in toggles
                for end in bounds):
            return Toggle(name, position, unit)
        return OutOfRange(name, position, self.input_ranges, unit)

    def _only(self, fields: Any, given: tuple[Values, ...], with_loads: bool) -> tuple[Any, ...]:
        """Return the fields of these names alone, as a tuple in their order."""
        if isinstance(fields, Iterable) and not isinstance(fields, str):
            fields = tuple(fields)
        wanted, needs_loads = _places(self.MOTION, self.LOADS if with_loads else None, fields)
        if needs_loads and self.bodies is None:
            raise MissingBodies
        if not _are_numbers(*given):
            return tuple(evaluate(self, given, wanted, needs_loads))
        motion, *loads = self.step(*given) if needs_loads else (self.motion(*given),)
        values = sum(loads, tuple(motion))
        return tuple([values[i] for i in wanted])


@cache
def _places(motion: Any, loads: Any, fields: Any) -> tuple[tuple[int, ...], bool]:
    """Return the places of fields among those of motion and loads, and if any is a load."""
    known = motion._fields + (loads._fields if loads else ())
    for name in fields if isinstance(fields, tuple) else (fields,):
        if name not in known or not isinstance(fields, tuple):
            raise InvalidParameter('fields', name, f'must be some of {", ".join(known)}')
    wanted = tuple(map(known.index, fields))
    return wanted, any(i >= len(motion._fields) for i in wanted)


def _are_numbers(*values: Any) -> bool:
    return all(isinstance(value, Real) for value in values)
