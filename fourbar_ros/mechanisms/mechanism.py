"""
What the mechanisms of one crank and one dyad have in common: evaluation and its errors.

A mechanism says how one sample is computed (functions made by :func:`~fourbar_ros.numerics.dialects.dialects`); here it is
called for floats and arrays, with the same rules for all.
"""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields as fields_of
from dataclasses import replace
from functools import cache, cached_property
from math import frexp, isfinite, ldexp, nan, pi, remainder
from numbers import Real
from typing import NamedTuple

import numpy as np

from fourbar_ros.mechanisms.evaluation import evaluate, recorded
from fourbar_ros.mechanics.bodies import Applied, Bodies, Body, External
from fourbar_ros.numerics.dialects import with_angles
from fourbar_ros.errors import InvalidParameter, MissingBodies, OutOfRange, Toggle, in_words
from fourbar_ros.numerics.given import number, records

CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0 of a 4R linkage
CRANK, SLIDE = 'crank', 'slide'     # inputs

LONGEST = 2.0**1000     # [m]
EPS = 2.0**-52
_new = tuple.__new__     # of a NamedTuple from a tuple: four times faster than its own constructor


class Coordinate(NamedTuple):
    """Names of a joint's position, rate and acceleration among the fields of a motion."""

    position: str
    rate: str
    acceleration: str


THETA1, THETA2, THETA3, THETA4 = (Coordinate(f'theta{i}', f'omega{i}', f'alpha{i}') for i in (1, 2, 3, 4))
TRAVEL = Coordinate('slide', 'slide_velocity', 'slide_acceleration')


class ByDialect(dict):
    """The function of each dialect, by its index, made when it is used first."""

    def __init__(self, make):
        super().__init__()
        self._make = make

    def __missing__(self, dialect):
        made = self[dialect] = self._make(dialect)
        return made


class Mechanism:
    """
    Base of a frozen dataclass with ``mode``, ``input``, ``bodies``, ``gravity``.

    A subclass has

    * ``LENGTHS``: names of its lengths and offsets, in the order of ``lengths``;
    * ``LINK_LENGTHS``: which of them is the length of a link, for the links that have one;
    * ``INPUTS``: the :class:`Coordinate` of each kind of input;
    * ``OUTPUTS``: for each kind of input the coordinate it is used for, and the field d output / d input;
    * ``JOINTS``: the coordinates of all joints, from O1 on;
    * ``MOTION`` and ``LOADS``: types of the results;
    * ``input_ranges``, and but for the 4R ``singular_inputs`` and ``closing_ranges``: those without a stroke;
    * ``MARGIN_SIGNS``: how the lengths enter each of ``_margins``;
    * ``_make_motion(dialect, change)`` and ``_make_loads(dialect, change)``: they return the functions that
      compute them, from factories that ``change`` may have rebound.
    """

    stroke = None            # of mechanisms that have none

    @cached_property
    def _motion(self):
        return ByDialect(self._make_motion if self.stroke is None else self._make_motion_within)

    @cached_property
    def _loads(self):
        return ByDialect(self._make_loads)

    def _make_motion_within(self, dialect):
        """Return the function of motion that answers outside of the stroke as where the links cannot close."""
        motion, (low, high) = self._make_motion(dialect), self.stroke

        def within(position, rate, acceleration):
            if dialect == 0:
                if not low <= position <= high:
                    raise ValueError
                return motion(position, rate, acceleration)
            fields = motion(position, rate, acceleration)
            outside = (position.real < low) | (position.real > high)
            given = position, rate, acceleration
            return tuple(field if any(field is value for value in given) else np.where(outside, nan, field)
                         for field in fields) if outside.any() else fields
        return within

    def _check_stroke(self):
        """Refuse a stroke that is none, or in which the links cannot close anywhere."""
        if self.stroke is None:
            return
        if not self.is_driven_by_slide:
            raise InvalidParameter('stroke', self.stroke, 'only a driven slide has one')
        allowed = 'must be [shortest, longest] of the slide, two finite numbers'
        low, high = _two_numbers('stroke', self.stroke, allowed)
        if not low < high:
            raise InvalidParameter('stroke', self.stroke, allowed)
        object.__setattr__(self, 'stroke', (low, high))
        if not self.input_ranges:
            raise InvalidParameter('stroke', self.stroke, 'the links cannot close anywhere in it: '
                                   f'they do in {in_words(self.input_coordinate.position, self.closing_ranges)}')

    def _within_stroke(self, ranges):
        """Return the parts of ranges of the input that lie in the stroke."""
        if self.stroke is None:
            return ranges
        parts = ((max(low, self.stroke[0]), min(high, self.stroke[1])) for low, high in ranges)
        return tuple((low, high) for low, high in parts if low < high)

    @cached_property
    def _of_one(self):
        """Return the functions of one sample: motion and loads; MissingBodies without masses."""
        if self.bodies is None:
            raise MissingBodies
        return self._motion[0], self._loads[0]

    @cached_property
    def _recorded(self):
        return ByDialect(lambda with_loads: recorded(self, with_loads))

    @cached_property
    def _analytic_motion(self):
        return self._make_motion(2, with_angles)

    def prepare(self):
        """Make the functions of one sample, as the first would; ArithmeticError or ValueError where numbers overflow."""
        return self._motion[0], self.bodies and self._loads[0]

    def _check(self, lengths, signed=()):
        """Refuse what no mechanism can have: lengths by name positive, signed ones finite."""
        given = {name: number(name, getattr(self, name), 'a length must be a positive number', above=0.0)
                 for name in lengths}
        given.update((name, number(name, getattr(self, name))) for name in signed)
        for name, value in given.items():
            if abs(value) >= LONGEST:
                raise InvalidParameter(name, value, f'must be shorter than {LONGEST:.3g} m: sums of lengths overflow')
        if isinstance(self.mode, bool) or self.mode not in (CROSSED, OPEN):
            raise InvalidParameter('mode', self.mode, 'must be 1 (crossed) or 2 (open)')
        if self.input not in self.INPUTS:
            raise InvalidParameter('input', self.input, f'must be one of {", ".join(self.INPUTS)}')
        given.update(mode=int(self.mode), gravity=_two_numbers('gravity', self.gravity),
                     external=records('external', self.external, Applied, External))
        if self.bodies is not None:
            given['bodies'] = records('bodies', self.bodies, Body, Bodies)
        for name, value in given.items():
            object.__setattr__(self, name, value)

    def __getstate__(self):
        """Return what was given: functions made on the way are made again where they are needed."""
        return {field.name: getattr(self, field.name) for field in fields_of(self)}

    @property
    def sign(self):
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
        return 1.0 if self.mode == OPEN else -1.0

    def in_mode(self, mode):
        """Return the same mechanism in another assembly mode."""
        return self if mode == self.mode else replace(self, mode=mode)

    def with_external(self, external):
        """Return the same mechanism with another :class:`~fourbar_ros.mechanics.bodies.External`; what does not depend on it is shared."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__, external=external)      # what else is in it was checked
        other.__dict__.pop('_loads', None)
        return other

    @property
    def input_coordinate(self):
        """Return the :class:`Coordinate` that is driven."""
        return self.INPUTS[self.input]

    @property
    def is_driven_by_slide(self):
        """Return whether the input is a length, not an angle."""
        return self.input == SLIDE

    @property
    def input_unit(self):
        """Return the unit in which inputs are of the size of one: 1 rad, or a power of two [m]."""
        return ldexp(1.0, frexp(max(map(abs, self.lengths)))[1]) if self.is_driven_by_slide else 1.0

    @property
    def turns_fully(self):
        """Return whether the input is a crank that makes full turns."""
        return self.input == CRANK and self.input_ranges == ((-pi, pi),)

    def is_in_stroke(self, position):
        """Return whether an input is in the stroke, if there is one."""
        return self.stroke is None or self.stroke[0] <= position <= self.stroke[1]

    def distance(self, one, other):
        """Return the signed distance of two inputs: the short way round of angles [rad], or [m]."""
        return one - other if self.is_driven_by_slide else remainder(one - other, 2.0 * pi)

    def term_sizes(self, motion, rate, acceleration):
        """Return {unit: size} of the terms that rates and accelerations are sums of, for noise bounds."""
        angles = [joint for joint in self.JOINTS if joint is not TRAVEL]
        omega = sum(abs(getattr(motion, joint.rate).real) for joint in angles)
        alpha = omega * omega + sum(abs(getattr(motion, joint.acceleration).real) for joint in angles)
        size = max(map(abs, self.lengths))
        return {'rad/s': omega, 'rad/s^2': alpha, 'm/s': size * omega, 'm/s^2': size * alpha}

    def unknown(self, position, rate, acceleration):
        """Return the motion of which only the input is known; the rest is NaN."""
        fields = dict.fromkeys(self.MOTION._fields, nan)
        fields.update(zip(self.input_coordinate, (position, rate, acceleration)))
        return self.MOTION(**fields)

    def motion(self, position, rate=0.0, acceleration=0.0, fields=None):
        """
        Return the motion for given input, its rate and acceleration.

        Parameters
        ----------
        position, rate, acceleration : float or array_like
            Crank angle [rad] (any number of turns), [rad/s], [rad/s^2], or slide [m], [m/s], [m/s^2], as
            ``input`` says; arrays are broadcast. Three floats take the fast scalar path; so do the samples of
            short arrays (some twenty), those of longer ones may differ from it in their last bits.
        fields : sequence of str, optional
            Names of fields of the result: these alone, computed with no more than they need, as a tuple in
            this order.

        Raises
        ------
        InvalidParameter, OutOfRange, Toggle
            For a single value that is not finite, out of range, at a toggle. In arrays such samples
            are NaN in every field that depends on it.

        Examples
        --------
        >>> from fourbar_ros import FourBar
        >>> theta4, alpha4 = FourBar(0.4, 1.2, 0.8, 1.0).motion([0.5, 1.0], 25.0, fields=('theta4', 'alpha4'))
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
            return _new(self.MOTION, self._motion[0](position, rate, acceleration))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def loads(self, position, rate=0.0, acceleration=0.0):
        """Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies."""
        return self.step(position, rate, acceleration)[1]

    def step(self, position, rate=0.0, acceleration=0.0, fields=None):
        """
        Return (motion, loads) together, at the cost of one; arguments and errors as in :meth:`motion`.

        ``fields``: names of fields of motion and loads, which alone are then computed and returned. MissingBodies
        where loads are wanted of a mechanism without masses.
        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), True)
        motion_of, loads_of = self._of_one
        if not (type(position) is type(rate) is type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                return self.step(*self._numbers(position, rate, acceleration))
            rows, count = evaluate(self, (position, rate, acceleration), None, True), len(self.MOTION._fields)
            return _new(self.MOTION, rows[:count]), _new(self.LOADS, rows[count:])
        if (position + rate * rate + acceleration) * 0.0 != 0.0:
            self._require_finite(position, rate, acceleration)
        try:
            motion = motion_of(position, rate, acceleration)
            loads = loads_of(motion)
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None
        if (loads[8] + loads[-1]) * 0.0 != 0.0:     # |F41| and the shaking moment: overflow reaches one of them
            raise InvalidParameter(self.input_coordinate.rate, rate, 'so fast, or with such masses, that loads overflow')
        return _new(self.MOTION, motion), _new(self.LOADS, loads)

    def _require_finite(self, *values):
        for name, value in zip(self.input_coordinate, values):
            if not isfinite(value):
                raise InvalidParameter(name, value, 'must be a finite number')
        raise InvalidParameter(self.input_coordinate.rate, values[1], 'so fast that its square overflows')

    def _numbers(self, *values):
        return [number(name, value) for name, value in zip(self.input_coordinate, values)]

    def _why_no_motion(self, position):
        """Return the error for an input at which a square root was not real or a sine zero."""
        name = self.input_coordinate.position
        # A limit and the input compared with it are each rounded, and so is their distance.
        tolerance = 4.0 * EPS * abs(position)
        toggles = self.input_ranges if self.stroke is None else self.closing_ranges
        if self.is_in_stroke(position) and any(
                abs(self.distance(position, end)) <= tolerance for bounds in toggles for end in bounds):
            return Toggle(name, position)
        return OutOfRange(name, position, self.input_ranges)

    def _only(self, fields, given, with_loads):
        """Return the fields of these names alone, as a tuple in their order."""
        if isinstance(fields, Iterable) and not isinstance(fields, str):
            fields = tuple(fields)
        wanted, needs_loads = _places(type(self), fields, with_loads)
        if needs_loads and self.bodies is None:
            raise MissingBodies
        if not _are_numbers(*given):
            return tuple(evaluate(self, given, wanted, needs_loads))
        motion, *loads = self.step(*given) if needs_loads else (self.motion(*given),)
        values = sum(loads, tuple(motion))
        return tuple([values[i] for i in wanted])


@cache
def _places(kind, fields, with_loads):
    """Return the places of fields among those of motion and loads, and whether any is a load."""
    known = kind.MOTION._fields + (kind.LOADS._fields if with_loads else ())
    for name in fields if isinstance(fields, tuple) else (fields,):
        if name not in known or not isinstance(fields, tuple):
            raise InvalidParameter('fields', name, f'must be some of {", ".join(known)}')
    wanted = tuple(map(known.index, fields))
    return wanted, any(i >= len(kind.MOTION._fields) for i in wanted)


def _are_numbers(*values):
    return all(isinstance(value, Real) for value in values)


def _two_numbers(name, given, allowed='must be two finite numbers (x, y)'):
    """Return two numbers as a tuple of floats."""
    try:
        x, y = given
    except (TypeError, ValueError):
        raise InvalidParameter(name, given, allowed) from None
    return number(name, x, allowed), number(name, y, allowed)
