"""
What the mechanisms of one crank and one dyad have in common: evaluation and its errors.

A mechanism says how one sample is computed (functions made by :func:`.dialects.dialects`); here it is
called for floats and arrays, with the same rules for all.
"""
from __future__ import annotations

from dataclasses import replace
from functools import cache, cached_property
from math import frexp, isfinite, ldexp, nan, pi, remainder
from numbers import Real
from typing import NamedTuple

import numpy as np

from .errors import InvalidParameter, MissingBodies, OutOfRange, Toggle, in_words

CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0 of a 4R linkage
CRANK, SLIDE = 'crank', 'slide'     # inputs

CHUNK = 12288            # samples a numpy evaluation takes at once: its temporaries stay in the cache
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
        if not (len(self.stroke) == 2 and all(map(isfinite, self.stroke)) and self.stroke[0] < self.stroke[1]):
            raise InvalidParameter('stroke', self.stroke, 'must be [shortest, longest] of the slide, two finite numbers')
        if not self.input_ranges:
            raise InvalidParameter('stroke', self.stroke, 'the links cannot close anywhere in it: '
                                   f'they do in {in_words(self.input_coordinate.position, self.closing_ranges)}')

    def _within_stroke(self, ranges):
        """Return the parts of ranges of the input that lie in the stroke."""
        if self.stroke is None:
            return ranges
        parts = ((max(low, self.stroke[0]), min(high, self.stroke[1])) for low, high in ranges)
        return tuple((low, high) for low, high in parts if low < high)

    def prepare(self):
        """Make the functions of one sample, as the first would; ArithmeticError or ValueError where numbers overflow."""
        return self._motion[0], self.bodies and self._loads[0]

    def _check(self, lengths, signed=()):
        """Refuse what no mechanism can have: lengths by name positive, signed ones finite."""
        for name in lengths:
            if not (isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise InvalidParameter(name, getattr(self, name), 'a length must be a positive number')
        for name in signed:
            if not isfinite(getattr(self, name)):
                raise InvalidParameter(name, getattr(self, name), 'must be a finite number')
        if self.mode not in (CROSSED, OPEN):
            raise InvalidParameter('mode', self.mode, 'must be 1 (crossed) or 2 (open)')
        if self.input not in self.INPUTS:
            raise InvalidParameter('input', self.input, f'must be one of {", ".join(self.INPUTS)}')
        if not (len(self.gravity) == 2 and all(map(isfinite, self.gravity))):
            raise InvalidParameter('gravity', self.gravity, 'must be two finite numbers')

    @property
    def sign(self):
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
        return 1.0 if self.mode == OPEN else -1.0

    def in_mode(self, mode):
        """Return the same mechanism in another assembly mode."""
        return self if mode == self.mode else replace(self, mode=mode)

    def with_external(self, external):
        """Return the same mechanism with another :class:`.bodies.External`; what does not depend on it is shared."""
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

    def motion(self, position, rate=0.0, acceleration=0.0):
        """
        Return the motion for given input, its rate and acceleration.

        Parameters
        ----------
        position, rate, acceleration : float or array_like
            Crank angle [rad] (any number of turns), [rad/s], [rad/s^2], or slide [m], [m/s], [m/s^2], as
            ``input`` says; arrays are broadcast. Three floats take the fast scalar path.

        Raises
        ------
        InvalidParameter, OutOfRange, Toggle
            For a single value that is not finite, out of range, at a toggle. In arrays such samples
            are NaN in every field that depends on it.

        """
        if not (type(position) is type(rate) is type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                return self.motion(float(position), float(rate), float(acceleration))
            return self._evaluate_arrays(position, rate, acceleration, False)[0]
        if (position + rate + acceleration) * 0.0 != 0.0:
            self._require_finite(position, rate, acceleration)
        try:
            return _new(self.MOTION, self._motion[0](position, rate, acceleration))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def loads(self, position, rate=0.0, acceleration=0.0):
        """Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies."""
        return self.step(position, rate, acceleration)[1]

    def step(self, position, rate=0.0, acceleration=0.0):
        """Return (motion, loads) together, at the cost of one; arguments as in :meth:`motion`."""
        if self.bodies is None:
            raise MissingBodies
        if not (type(position) is type(rate) is type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                return self.step(float(position), float(rate), float(acceleration))
            return self._evaluate_arrays(position, rate, acceleration, True)
        if (position + rate + acceleration) * 0.0 != 0.0:
            self._require_finite(position, rate, acceleration)
        try:
            motion = self._motion[0](position, rate, acceleration)
            return _new(self.MOTION, motion), _new(self.LOADS, self._loads[0](motion))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def _require_finite(self, *values):
        for name, value in zip(self.input_coordinate, values):
            if not isfinite(value):
                raise InvalidParameter(name, value, 'must be a finite number')

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

    def _evaluate_arrays(self, position, rate, acceleration, with_loads):
        kind = 2 if np.iscomplexobj(position) else 1
        dtype = np.complex128 if kind == 2 else np.float64
        inputs = np.broadcast_arrays(*(np.asarray(v, dtype) for v in (position, rate, acceleration)))
        shape, size = inputs[0].shape, inputs[0].size
        inputs = [v.reshape(-1) for v in inputs]
        with np.errstate(invalid='ignore', divide='ignore', over='ignore', under='ignore'):
            _keep_memory()
            if size <= CHUNK:
                rows = _own(self._fields(kind, inputs, with_loads), inputs)
            else:
                rows = [row for kind_of in (self.MOTION, self.LOADS)[:1 + with_loads]
                        for row in np.empty((len(kind_of._fields), size), dtype)]
                for start in range(0, size, CHUNK):
                    part = slice(start, start + CHUNK)
                    for row, values in zip(rows, self._fields(kind, [v[part] for v in inputs], with_loads)):
                        row[part] = values
        rows = [row.reshape(shape) for row in rows]
        count = len(self.MOTION._fields)
        return self.MOTION(*rows[:count]), self.LOADS(*rows[count:]) if with_loads else None

    def _fields(self, kind, inputs, with_loads):
        """Return the fields of motion, or of motion and loads, of arrays."""
        motion = self._motion[kind](*inputs)
        return motion + self._loads[kind](motion) if with_loads else motion


@cache
def _keep_memory():
    """
    Have blocks of up to 31 MB kept by the C library when they are freed, once and for all.

    glibc gives each back to the system until it has seen one of that size freed; getting the pages again
    would take longer than the formulas. The block is never touched, so it costs nothing.
    """
    np.empty(31 * 2**17)


def _own(fields, inputs):
    """Return fields as arrays of full size that share no memory with each other nor with the inputs."""
    taken, rows = set(map(id, inputs)), []
    for field in fields:
        if id(field) in taken or np.shape(field) != inputs[0].shape:
            field = np.array(np.broadcast_to(field, inputs[0].shape), inputs[0].dtype)
        taken.add(id(field))
        rows.append(field)
    return rows


def _are_numbers(*values):
    return all(isinstance(value, Real) for value in values)
