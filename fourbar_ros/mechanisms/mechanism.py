# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The contract of a mechanism: what it states about itself, and what it can then do.

A mechanism gives its formulas for any :class:`~fourbar_ros.numerics.number_types.NumberType`; here
they are called for floats and arrays, with the same rules for all.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import fields as fields_of
from dataclasses import replace
from functools import cache, cached_property
from math import fsum, isfinite, nan, pi, remainder
from numbers import Real
from typing import Any, ClassVar, NamedTuple

from fourbar_ros.errors import in_words, InvalidParameter, MissingBodies, OutOfRange, Toggle
from fourbar_ros.mechanics.bodies import Applied, Bodies, Body, External, NOT_APPLIED
from fourbar_ros.mechanisms.evaluation import evaluate, recorded
from fourbar_ros.mechanisms.parts import (  # noqa: F401
    Arrow,
    BETA,
    Connection,
    Coordinate,
    Diagram,
    Joint,
    Length,
    Link,
    Output,
    Quantity,
    SLOT,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
    TRAVEL,
)
from fourbar_ros.numerics.given import number, records
from fourbar_ros.numerics.number_types import Function, NumberType, power_of_two, REAL
from fourbar_ros.numerics.recorded import Constants as ProgramConstants
from fourbar_ros.numerics.recorded import Record
import numpy as np

CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0 of a 4R linkage
CRANK, SLIDE = 'crank', 'slide'     # inputs

LONGEST = 2.0**1000     # [m]
EPS = 2.0**-52
_new = tuple.__new__     # of a NamedTuple from a tuple: four times faster than its own constructor


class Constants(NamedTuple):
    """
    What the formulas of a mechanism are made for: floats, or numbers of any type.

    Other numbers take their places by :func:`~fourbar_ros.numerics.number_types.converted`.
    """

    lengths: tuple[Any, ...]
    sign: Any
    bodies: Bodies | None
    gravity: tuple[Any, Any]
    external: External


class Mechanism(ABC):
    """
    Base of a frozen dataclass with its lengths.

    Also ``mode``, ``input``, ``bodies``, ``gravity``, ``external``.

    Everything outside of a mechanism's own folder asks these names, of an instance: a kind has
    them as attributes of its class, a mechanism put together at run time as attributes of its own.
    How many links, joints, loads and outputs there are is known nowhere else.

    Attributes
    ----------
    TITLE : str
        What the kind is called in texts.
    TEXT : str
        What it is, for the manual.
    LENGTHS : tuple of Length
        In the order of :attr:`lengths`.
    LINKS : tuple of Link
        The moving links, in the order of the fields of ``BODIES``.
    JOINTS : tuple of Joint
        As ``joint_states`` shows them, from O1 on.
    PARTS : mapping
        {Coordinate: what moves, as text}: the table of a pose.
    DRAWN : tuple of Coordinate
        Those that are written below a picture.
    INPUTS : mapping
        {name of the input: its Coordinate}.
    OUTPUTS : mapping
        {name of the input: tuple of :class:`Output`, the one that is published as ``output``
        first}.
    MOTION, LOADS : NamedTuple types
        Of the results. A motion has ``transmission_angle`` and ``condition``, loads have
        ``shaking_force_x``, ``_y``, ``shaking_force``, ``shaking_moment``.
    WATCHED : tuple of str
        Two loads or more, of which one is not finite if any load is not.
    BODIES, EXTERNAL : NamedTuple types
        Of ``bodies`` and ``external``: a field for each link, and for each link that can be
        loaded.
    MARGIN_SIGNS : tuple of tuple
        How the sizes of the lengths enter each of :attr:`margins`.
    MODES : mapping
        {assembly mode: its name as text}; see :attr:`modes`.
    QUANTITIES : tuple of Quantity
        Fields of motion and loads that can be asked for by name, and that no other kind has.
    SLIDE_DIRECTION : tuple of 2 str, optional
        Fields of the motion: cosine and sine of the direction of a driven slide; None: it is x.

    """

    TITLE: ClassVar[str]
    TEXT: ClassVar[str]
    LENGTHS: ClassVar[tuple[Length, ...]]
    LINKS: ClassVar[tuple[Link, ...]]
    JOINTS: ClassVar[tuple[Joint, ...]]
    PARTS: ClassVar[Mapping[Coordinate, str]]
    DRAWN: ClassVar[tuple[Coordinate, ...]]
    INPUTS: ClassVar[Mapping[str, Coordinate]]
    OUTPUTS: ClassVar[Mapping[str, tuple[Output, ...]]]
    MOTION: ClassVar[type[Any]]
    LOADS: ClassVar[type[Any]]
    WATCHED: ClassVar[tuple[str, ...]] = ('f41', 'shaking_moment')
    BODIES: ClassVar[type[Any]] = Bodies
    EXTERNAL: ClassVar[type[Any]] = External
    QUANTITIES: ClassVar[tuple[Quantity, ...]] = ()
    MARGIN_SIGNS: ClassVar[tuple[tuple[int, ...], ...]]
    MODES: ClassVar[Mapping[int, str]] = {CROSSED: '1', OPEN: '2'}
    SLIDE_DIRECTION: ClassVar[tuple[str, str] | None] = None

    # --- what a kind must give ------------------------------------------------------------------

    @abstractmethod
    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""

    @abstractmethod
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""

    @property
    @abstractmethod
    def closing_ranges(self):
        """Return the ranges (low, high) of the input in which the links close [rad or m]."""

    @property
    @abstractmethod
    def singular_inputs(self):
        """
        Return the complex inputs where the dyad is in line, or quantities have a pole, as a list.

        As far as their real part and the size of their imaginary part go: toggles (real), flat
        positions of change points (real) and others. Extrema are searched for with samples that
        crowd there.
        """

    @property
    @abstractmethod
    def margins(self):
        """Return the differences of sums of lengths [m] that are zero at change points."""

    @property
    @abstractmethod
    def classification(self):
        """Return the type by name: which links turn fully."""

    @abstractmethod
    def link_motion(self, motion, link):
        """
        Return the :class:`~fourbar_ros.mechanisms.points.LinkMotion` of a link by name.

        Plain arithmetic with fields of the motion, whatever numbers these are.
        """

    @abstractmethod
    def transmission_sine(self, motion):
        """Return a number that is zero where the dyad is in line, at most one."""

    @abstractmethod
    def diagram(self, motion) -> Diagram:
        """Return what a picture shows in one pose."""

    @abstractmethod
    def velocity_polygon(self, motion) -> list[Arrow]:
        """Return the arrows of the velocities [m/s]; the pole is the origin."""

    @abstractmethod
    def acceleration_polygon(self, motion) -> list[Arrow]:
        """Return the arrows of the accelerations [m/s^2]; the pole is the origin."""

    # --- what follows from it -------------------------------------------------------------------

    @property
    def lengths(self):
        """Return the lengths [m]."""
        return tuple([getattr(self, length.name) for length in self.LENGTHS])

    @property
    def length_names(self):
        """Return the names of the lengths."""
        return tuple([length.name for length in self.LENGTHS])

    @property
    def change_point_margin(self):
        """
        Return the least size of :attr:`margins` over the sum of all lengths.

        Zero: a change point, where both assembly modes meet and the linkage can leave its mode.
        """
        return min(map(abs, self.margins)) / fsum(map(abs, self.lengths))

    @property
    def description(self):
        """Return what it is as text: kind, type, input."""
        return f'{self.TITLE}, {self.classification}, driven at its {self.input}'

    @cached_property
    def input_ranges(self):
        """
        Return the ranges of the input, from low to high.

        :attr:`closing_ranges`, as far as they lie in the stroke.
        """
        return self._within_stroke(self.closing_ranges)

    @property
    def dead_points(self):
        """
        Return where the output turns back at any speed of the input.

        NamedTuples, the input first.
        """
        return ()

    @property
    def ranges_of_both_modes(self):
        """Return {position of an output: its ranges over both modes}, if known in closed form."""
        return {}

    @property
    def modes(self):
        """Return {assembly mode: its name}; one input may have fewer than another."""
        return self.MODES

    @property
    def connections(self) -> tuple[Connection, ...]:
        """
        Return which links each of ``JOINTS`` connects, in the same order.

        Descriptions for other programs are made of it; a kind without has none.
        """
        return ()

    @property
    def outputs(self):
        """Return the tuple of :class:`Output` for what is driven."""
        return self.OUTPUTS[self.input]

    def link(self, name):
        """Return the :class:`Link` of this name."""
        return find_link(self.LINKS, name)

    def loads_of_links(self):
        """
        Return {name of a link: (Body, Applied)}: what is given for each.

        Nothing without masses.
        """
        given = self.external._asdict()
        return {name: (body, given.get(name, NOT_APPLIED))
                for name, body in (self.bodies._asdict().items() if self.bodies else ())}

    stroke: Any = None       # of mechanisms that have none

    @property
    def structure(self) -> tuple[Any, ...]:
        """Return what mechanisms have in common whose formulas do the same with other numbers."""
        return type(self), self.input

    @cached_property
    def constants(self) -> Constants:
        """Return the :class:`Constants` of this mechanism."""
        return Constants(self.lengths, self.sign, self.bodies, self.gravity, self.external)

    @cached_property
    def _made(self) -> dict:
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
                                             else self._within(formula, numbers))
        return self._made['motion', numbers]

    def make_loads(self, numbers: NumberType) -> Function:
        """Return the function (fields of MOTION) -> fields of LOADS for a type of numbers."""
        if ('loads', numbers) not in self._made:
            self._made['loads', numbers] = self.loads_formula(numbers, self.constants)
        return self._made['loads', numbers]

    def make_coefficients(self, numbers: NumberType) -> Function:
        """
        Return position -> coefficients of all links for a number type: what dynamics is made of.

        Of each of ``LINKS`` (x, y, x', y', x'', y'', cosine, sine, theta', theta''): place of its
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

    def _within(self, motion: Function, numbers: NumberType) -> Function:
        """Return the function of motion that has no pose outside of the stroke."""
        low, high = self.stroke

        def within_one(position, rate, acceleration):
            if not low <= position <= high:
                raise ValueError
            return motion(position, rate, acceleration)

        def within(position, rate, acceleration):
            fields = motion(position, rate, acceleration)
            outside = (position.real < low) | (position.real > high)
            given = position, rate, acceleration
            return tuple(field if any(field is value for value in given)
                         else np.where(outside, nan, field)
                         for field in fields) if outside.any() else fields
        return within_one if numbers is REAL else within

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
                                   'they do in '
                                   f'{in_words(self.closing_ranges, self.input_coordinate.unit)}')

    def _within_stroke(self, ranges):
        """Return the parts of ranges of the input that lie in the stroke."""
        if self.stroke is None:
            return ranges
        parts = ((max(low, self.stroke[0]), min(high, self.stroke[1])) for low, high in ranges)
        return tuple((low, high) for low, high in parts if low < high)

    @cached_property
    def _motion_of_one(self) -> Function:
        return self.make_motion(REAL)

    @cached_property
    def _of_one(self) -> tuple[Any, ...]:
        """
        Return what a single step needs: functions of motion and loads, places watched, types.

        Or MissingBodies.
        """
        if self.bodies is None:
            raise MissingBodies
        one, other, *rest = map(self.LOADS._fields.index, self.WATCHED)
        return (self._motion_of_one, self.make_loads(REAL), one, other, rest, self.MOTION,
                self.LOADS)

    @cached_property
    def record_of_motion(self) -> tuple[Record, ProgramConstants]:
        """Return the record of the motion, and this mechanism's constants in it."""
        return recorded(self, False)

    @cached_property
    def record_with_loads(self) -> tuple[Record, ProgramConstants]:
        """Return the record of motion and loads, and this mechanism's constants in it."""
        return recorded(self, True)

    def prepare(self):
        """
        Make the functions of one sample, as the first would.

        ArithmeticError or ValueError where numbers overflow.
        """
        return self._motion_of_one, self.bodies and self.make_loads(REAL)

    def _check(self):
        """
        Refuse what no mechanism can have.

        Lengths that are not positive, or if signed not finite, and so on.
        """
        given = {name: number(name, getattr(self, name), 'a length must be a positive number',
                              above=0.0)
                 for name, _, signed in self.LENGTHS if not signed}
        given.update((name, number(name, getattr(self, name))) for name, _, signed in self.LENGTHS
                     if signed)
        for name, value in given.items():
            if abs(value) >= LONGEST:
                raise InvalidParameter(name, value, f'must be shorter than {LONGEST:.3g} m: sums '
                                                    'of lengths overflow')
        if self.input not in self.INPUTS:
            raise InvalidParameter('input', self.input, f'must be one of {", ".join(self.INPUTS)}')
        if isinstance(self.mode, bool) or self.mode not in self.modes:
            raise InvalidParameter('mode', self.mode, 'must be 1 (crossed) or 2 (open)'
                                   if len(self.modes) > 1 else
                                   f'must be {min(self.modes)}: driven at its {self.input} it has '
                                   'one assembly mode')
        given.update(mode=int(self.mode), gravity=_two_numbers('gravity', self.gravity),
                     external=records('external', self.external, Applied, self.EXTERNAL))
        if self.bodies is not None:
            given['bodies'] = records('bodies', self.bodies, Body, self.BODIES)
        for name, value in given.items():
            object.__setattr__(self, name, value)

    def __getstate__(self):
        """
        Return what was given.

        Functions made on the way are made again where they are needed.
        """
        return {field.name: getattr(self, field.name) for field in fields_of(self)}

    @property
    def sign(self):
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
        return 1.0 if self.mode == OPEN else -1.0

    def in_mode(self, mode):
        """Return the same mechanism in another assembly mode."""
        return self if mode == self.mode else replace(self, mode=mode)

    def with_external(self, external):
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
        return power_of_two(*self.lengths) if self.is_driven_by_slide else 1.0

    @property
    def turns_fully(self):
        """Return whether the input is a crank that makes full turns."""
        return self.input == CRANK and self.input_ranges == ((-pi, pi),)

    def is_in_stroke(self, position):
        """Return whether an input is in the stroke, if there is one."""
        return self.stroke is None or self.stroke[0] <= position <= self.stroke[1]

    def distance(self, one, other):
        """
        Return the signed distance of two inputs.

        The short way round of angles [rad], or [m].
        """
        return one - other if self.is_driven_by_slide else remainder(one - other, 2.0 * pi)

    def term_sizes(self, motion, rate, acceleration):
        """Return {unit: size} of the terms of rates and accelerations, for noise bounds."""
        angles = [joint.coordinate for joint in self.JOINTS if joint.coordinate.unit == 'rad']
        omega = sum(abs(getattr(motion, joint.rate).real) for joint in angles)
        alpha = omega * omega + sum(abs(getattr(motion, joint.acceleration).real)
                                    for joint in angles)
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

    def loads(self, position, rate=0.0, acceleration=0.0):
        """Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies."""
        return self.step(position, rate, acceleration)[1]

    def step(self, position, rate=0.0, acceleration=0.0, fields=None):
        """
        Return (motion, loads) together, at the cost of one.

        Arguments and errors as in :meth:`motion`.

        ``fields``: names of fields of motion and loads, which alone are then computed and
        returned. MissingBodies where loads are wanted of a mechanism without masses.
        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), True)
        motion_of, loads_of, one, other, rest, as_motion, as_loads = self._of_one
        if not (type(position) is type(rate) is type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                return self.step(*self._numbers(position, rate, acceleration))
            rows, count = evaluate(self, (position, rate, acceleration), None,
                                   True), len(self.MOTION._fields)
            return _new(self.MOTION, rows[:count]), _new(self.LOADS, rows[count:])
        if (position + rate * rate + acceleration) * 0.0 != 0.0:
            self._require_finite(position, rate, acceleration)
        try:
            motion = motion_of(position, rate, acceleration)
            loads = loads_of(motion)
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None
        if ((loads[one] + loads[other]) * 0.0 != 0.0 or rest and sum([loads[i] for i in rest])
                * 0.0 != 0.0):
            raise InvalidParameter(self.input_coordinate.rate, rate,
                                   'so fast, or with such masses, that loads overflow')
        return _new(as_motion, motion), _new(as_loads, loads)

    def _require_finite(self, *values):
        for name, value in zip(self.input_coordinate, values):
            if not isfinite(value):
                raise InvalidParameter(name, value, 'must be a finite number')
        raise InvalidParameter(self.input_coordinate.rate, values[1],
                               'so fast that its square overflows')

    def _numbers(self, *values):
        return [number(name, value) for name, value in zip(self.input_coordinate, values)]

    def _why_no_motion(self, position):
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

    def _only(self, fields, given, with_loads):
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


def find_link(links, name):
    """Return the :class:`Link` of a name; InvalidParameter if there is none."""
    for link in links:
        if link.name == name:
            return link
    raise InvalidParameter('link', name, 'must be one of '
                                         f'{", ".join(link.name for link in links)}')


@cache
def _places(motion, loads, fields):
    """Return the places of fields among those of motion and loads, and if any is a load."""
    known = motion._fields + (loads._fields if loads else ())
    for name in fields if isinstance(fields, tuple) else (fields,):
        if name not in known or not isinstance(fields, tuple):
            raise InvalidParameter('fields', name, f'must be some of {", ".join(known)}')
    wanted = tuple(map(known.index, fields))
    return wanted, any(i >= len(motion._fields) for i in wanted)


def _are_numbers(*values):
    return all(isinstance(value, Real) for value in values)


def _two_numbers(name, given, allowed='must be two finite numbers (x, y)'):
    """Return two numbers as a tuple of floats."""
    try:
        x, y = given
    except (TypeError, ValueError):
        raise InvalidParameter(name, given, allowed) from None
    return number(name, x, allowed), number(name, y, allowed)
