# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism: what it states, what follows from that, and its evaluation.

A kind, or a machine of dyads, gives facts and formulas for any
:class:`~fourbar_ros.numerics.number_types.NumberType`. Here a mechanism is checked as it is made,
and its formulas are called for one input or for arrays by the same rules for all.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields as fields_of
from dataclasses import replace
from decimal import Decimal
from functools import cache, cached_property
from math import fsum, inf, isfinite, nan, pi, remainder
from numbers import Real
from typing import Any, ClassVar, NoReturn, TYPE_CHECKING, TypeVar, Union

from fourbar_ros.errors import FourBarError, InvalidParameter, MissingBodies, OutOfRange, Toggle
from fourbar_ros.mechanics.bodies import (
    Applied,
    applied_to,
    Base,
    Body,
    External,
    Gravity,
    NOT_APPLIED,
)
from fourbar_ros.mechanisms.checks import checked, checked_gravity, checked_stroke
from fourbar_ros.mechanisms.curves import Coefficients, LinkMotion
from fourbar_ros.mechanisms.evaluation import Constants, line_of, Recorded, recorded
from fourbar_ros.mechanisms.parts import (
    Coordinate,
    CROSSED,
    find_link,
    Joint,
    Length,
    Link,
    NamedFields,
    OPEN,
    Output,
    Quantity,
    Ranges,
    Reaction,
    SLIDE,
    within_stroke,
)
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.given import number
from fourbar_ros.numerics.number_types import Function, NumberType, power_of_two, Scalar
import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink

# Links and the coordinate that drives them: a mechanism, or one of its others.
DrivenLinks = Union['Mechanism', 'SeenFromLink']
_Self = TypeVar('_Self', bound='Mechanism')
_T = TypeVar('_T')
# Nearer to a limit that is a change point than this, in units of the input, accelerations are
# noise: their error is some eps over the third power of the distance.
BESIDE_FLAT_LIMITS = 2.0**-17
# what tab completion shows besides the fields
SHOWN = ('bias', 'change_point_margin', 'classification', 'dead_points', 'description', 'in_mode',
         'inertia', 'input', 'input_ranges', 'lengths', 'loads', 'margins', 'modes', 'motion',
         'output_ranges', 'outputs', 'reactions', 'step', 'turns_fully', 'with_base',
         'with_external', 'with_lengths')


class cached_by_lengths(cached_property[_T]):     # noqa: N801  (used as cached_property is)
    """
    A cached property of lengths, assembly mode, input and stroke alone.

    Copies with other loads share its value, see :meth:`.Mechanism.with_external`; every other
    cached property they compute again.
    """


class Mechanism(ABC):
    """
    Base of the mechanisms: frozen dataclasses of lengths and what else they are made with.

    The fields besides lengths: ``mode``, ``input``, ``bodies``, ``gravity``, ``external``; where a
    slide can be driven, ``stroke``. A kind has its facts as attributes of its class, a machine put
    together at run time as its own attributes. The numbers of links, joints, loads and outputs
    are known nowhere else.
    """

    TITLE: str                      # name of the kind in texts
    TEXT: str                       # description, for the manual
    LENGTHS: tuple[Length, ...]     # in the order of ``lengths``
    LINKS: tuple[Link, ...]         # the moving links, in the order of the fields of BODIES
    JOINTS: tuple[Joint, ...]       # as ``joint_states`` shows them, from O1 on
    REACTIONS: tuple[Reaction, ...]     # forces and couples at each joint
    PARTS: Mapping[Coordinate, str]     # moving coordinates as text: the table of a pose
    DRAWN: tuple[Coordinate, ...]       # coordinates written below a picture
    INPUTS: Mapping[str, Coordinate]    # {name of the input: its coordinate}
    OUTPUTS: Mapping[str, tuple[Output, ...]]   # {name of the input: the published one first}
    # Types of the results, NamedTuples. A motion has ``transmission_angle`` and ``condition``,
    # loads have ``shaking_force_x``, ``_y``, ``shaking_force`` and ``shaking_moment``.
    MOTION: Any
    LOADS: Any
    # Types of ``bodies`` and ``external``, NamedTuples: a field for each link, and for each link
    # that can be loaded.
    BODIES: Any
    EXTERNAL: Any
    QUANTITIES: tuple[Quantity, ...] = ()       # quantities that no other kind has
    # How the size of each length enters each of ``margins``: 1, -1 or, not at all, 0.
    MARGIN_SIGNS: tuple[tuple[int, ...], ...]
    MODES: Mapping[int, str] = {CROSSED: '1', OPEN: '2'}    # {assembly mode: its name}, see modes
    # Fields of the motion: cosine and sine of the direction of a driven slide; None: it is x.
    SLIDE_DIRECTION: tuple[str, str] | None = None
    # Whether a single step leaves out products with masses and lengths of zero. A zero in its
    # results may then have the other sign.
    LEAVES_OUT_ZEROS: bool = False
    TORQUE: str = 'T_{41}'          # symbol of the driving torque: of which link on which

    # --- parameters besides lengths --------------------------------------------------------------

    __dataclass_fields__: ClassVar[dict[str, Any]]
    mode: int
    input: str
    bodies: Any
    gravity: Gravity
    external: Any
    stroke: tuple[float, float] | None = None       # of mechanisms that have none

    # --- each kind must give these --------------------------------------------------------------

    @abstractmethod
    def motion_formula(self, n: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""

    @abstractmethod
    def loads_formula(self, n: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""

    @property
    @abstractmethod
    def closing_ranges(self) -> Ranges:
        """Return the ranges (low, high) of the input in which the links close [rad or m]."""

    @property
    @abstractmethod
    def singular_inputs(self) -> list[complex]:
        """
        Return the complex inputs where the dyad is in line, or quantities have a pole.

        Toggles and flat positions of change points are real. One of each conjugate pair is enough.
        The search for extrema puts more samples near them, where quantities change fast.
        """

    @property
    @abstractmethod
    def classification(self) -> str:
        """Return the type by name: which links turn fully."""

    @abstractmethod
    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """
        Return the motion of one of its ``LINKS`` by name, from one of its motions.

        The 'coupler' of an inverted slider-crank is its block; 'output' is the slider of a
        slider-crank, the bar of an inverted one. Fields are numbers of any type.
        """

    @abstractmethod
    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """
        Return a number of at most one in size that is zero where the dyad is in line.

        Errors of rates and loads grow as one over it: the search for extrema bounds noise by it.
        """

    # --- some kinds give these ------------------------------------------------------------------

    @property
    def dead_points(self) -> tuple[Any, ...]:
        """Return records of where the output turns back; their first field is the input."""
        return ()

    @property
    def modes(self) -> Mapping[int, str]:
        """Return {assembly mode: its name}; one input may have fewer than another."""
        return self.MODES

    # --- all that follows -----------------------------------------------------------------------

    @cached_by_lengths
    def lengths(self) -> tuple[float, ...]:
        """Return the lengths [m]."""
        return tuple([getattr(self, length.name) for length in self.LENGTHS])

    @property
    def length_names(self) -> tuple[str, ...]:
        """Return the names of the lengths."""
        return tuple([length.name for length in self.LENGTHS])

    @property
    def numbers_of_lengths(self) -> tuple[str | tuple[int, int], ...]:
        """
        Return the meaning of each number of ``constants.lengths``.

        The name of a length, (i, j) for the size of the vector of numbers i and j, or '' for
        anything else. Generated code can change those lengths at run time.
        """
        return self.length_names

    @cached_by_lengths
    def margins(self) -> tuple[float, ...]:
        """Return the differences of sums of lengths [m] that are zero at change points."""
        return tuple([fsum([sign * abs(length) for sign, length in zip(signs, self.lengths)])
                      for signs in self.MARGIN_SIGNS])

    @property
    def change_point_margin(self) -> float:
        """
        Return the least size of :attr:`margins` over the sum of all lengths.

        Zero is a change point: both assembly modes meet, and the linkage can leave its mode.
        """
        return min(map(abs, self.margins)) / fsum(map(abs, self.lengths))

    @property
    def is_flat_at_zero(self) -> bool:
        """Return whether input 0 is a flat position of a change point: 0/0 in the formulas."""
        return (self.change_point_margin == 0.0 and 0.0 in self.singular_inputs
                and any(low < 0.0 < high for low, high in self.closing_ranges))

    @property
    def description(self) -> str:
        """Return a short text: kind, type, input."""
        return f'{self.TITLE}, {self.classification}, driven at its {self.input}'

    @cached_by_lengths
    def input_ranges(self) -> Ranges:
        """Return the parts of :attr:`closing_ranges` that lie in the stroke, from low to high."""
        return within_stroke(self.closing_ranges, self.stroke)

    def range_around(self, position: float) -> tuple[float, float]:
        """
        Return the range of the input with a position, shifted by whole turns so that it holds it.

        Of an input that turns fully, half a turn to both sides. OutOfRange outside all ranges.
        """
        if self.turns_fully:
            return position - pi, position + pi
        rounding = 4.0 * EPS * abs(position)
        for low, high in self.input_ranges:
            turns = (0.0 if self.is_driven_by_slide
                     else 2.0 * pi * round((position - 0.5 * (low + high)) / (2.0 * pi)))
            low, high = low + turns, high + turns
            if low - rounding <= position <= high + rounding:
                return min(low, position), max(high, position)
        raise OutOfRange(self.input_coordinate.position, position, self.input_ranges,
                         self.input_coordinate.unit)

    @property
    def outputs(self) -> tuple[Output, ...]:
        """Return the outputs for the driven input; the first is published as ``output``."""
        return self.OUTPUTS[self.input]

    def link(self, name: str) -> Link:
        """Return the :class:`Link` of this name."""
        return find_link(self.LINKS, name)

    @property
    def reactions(self) -> tuple[str, ...]:
        """Return the loads that are sizes of joint reactions: those with components _x, _y."""
        fields = self.LOADS._fields
        return tuple([name for name in fields if f'{name}_x' in fields and f'{name}_y' in fields
                      and name != 'shaking_force'])

    def loads_of_links(self) -> dict[str, tuple[Body, Applied]]:
        """Return {name of a link: (its Body, its applied load)}; {} without masses."""
        if not self.bodies:
            return {}
        return {name: (body, applied_to(self.external, name))
                for name, body in self.bodies._asdict().items()}

    @property
    def structure(self) -> tuple[object, ...]:
        """Return the cache key of traced formulas: equal if mechanisms differ in numbers only."""
        return type(self), self.input

    @cached_property
    def constants(self) -> Constants:
        """Return the :class:`Constants` of this mechanism."""
        return Constants(self.lengths, self.sign, self.bodies, self.gravity, self.external)

    @property
    def sign(self) -> float:
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
        return 1.0 if self.mode == OPEN else -1.0

    @property
    def input_coordinate(self) -> Coordinate:
        """Return the :class:`Coordinate` that is driven."""
        return self.INPUTS[self.input]

    @property
    def is_driven_by_slide(self) -> bool:
        """Return whether the input is a length, not an angle."""
        return bool(self.input == SLIDE)

    @property
    def input_unit(self) -> float:
        """Return the unit in which inputs are of the size of one: 1 rad, or a power of two [m]."""
        return power_of_two(*self.lengths) if self.is_driven_by_slide else 1.0

    @property
    def turns_fully(self) -> bool:
        """Return whether the input is an angle that makes full turns."""
        return not self.is_driven_by_slide and self.input_ranges == ((-pi, pi),)

    def is_in_stroke(self, position: float) -> bool:
        """Return whether an input is in the stroke, if there is one."""
        return self.stroke is None or self.stroke[0] <= position <= self.stroke[1]

    @property
    def reaches(self) -> Function | None:
        """
        Return a function input -> whether results may be given there; None if they always may.

        They may not outside the stroke, nor so near to a limit that is a change point that
        accelerations are noise. Inputs are floats or arrays, real or complex.
        """
        stroke, flats = self.stroke, set(self.flat_limits)
        if stroke is None and not flats:
            return None
        low, high = (-inf, inf) if stroke is None else stroke
        turn = inf if self.is_driven_by_slide else 2.0 * pi
        near = BESIDE_FLAT_LIMITS * self.input_unit

        def reaches(position: Scalar) -> bool:
            x = position.real
            inside = (low <= x) & (x <= high)
            for flat in flats:
                distance = x - flat
                if turn < inf:
                    distance = distance - turn * np.round(distance / turn)
                inside = inside & (abs(distance) > near)
            return inside
        return reaches

    def distance(self, one: float, other: float) -> float:
        """Return one input less another: of angles the short way round [rad], else [m]."""
        return one - other if self.is_driven_by_slide else remainder(one - other, 2.0 * pi)

    def crank_angle(self, motion: NamedFields) -> Scalar:
        """Return the angle of the crank in a motion [rad]."""
        angle: Scalar = motion.theta1
        return angle

    @property
    def modes_passed(self) -> tuple[int, ...]:
        """Return the modes between which a motion goes on at toggles and flat positions."""
        return tuple(sorted(self.modes))

    def mode_beyond(self, _limit: float) -> int:
        """Return the mode into which quantities go on smoothly at a toggle at a limit."""
        return 3 - int(self.mode)

    @property
    def flat_limits(self) -> tuple[float, ...]:
        """Return the ends of :attr:`closing_ranges` that are change points [rad or m]."""
        return ()

    @property
    def flat_inputs(self) -> tuple[float, ...]:
        """Return the flat positions inside the ranges, and limits of the ranges [rad or m]."""
        return tuple([z.real for z in self.singular_inputs if z.imag == 0.0])

    def flat_place(self, place: float) -> Decimal:
        """Return the input of a flat position [rad or m] in many digits."""
        from fourbar_ros.numerics.digits import MANY_DIGITS, quarter_turn  # searches alone
        quarters = 0 if self.is_driven_by_slide else round(place / (0.5 * pi))
        return MANY_DIGITS.multiply(quarter_turn(), quarters)

    def unknown(self, position: float, rate: float, acceleration: float) -> NamedFields:
        """Return a motion with the input alone and NaN else: a sample that cannot be computed."""
        fields = dict.fromkeys(self.MOTION._fields, nan)
        fields.update(zip(self.input_coordinate, (position, rate, acceleration)))
        return self.MOTION(**fields)

    # --- made and copied ------------------------------------------------------------------------

    def _check(self) -> None:
        """Refuse impossible values, and keep the others as numbers and records."""
        for name, value in checked(self).items():
            object.__setattr__(self, name, value)

    def _check_stroke(self) -> None:
        """Refuse a wrong stroke, and keep a right one as two floats."""
        object.__setattr__(self, 'stroke', checked_stroke(self))

    def __getstate__(self) -> dict[str, object]:
        """Return the fields to be pickled: functions made of them can be neither sent nor kept."""
        return {field.name: getattr(self, field.name) for field in fields_of(self)}

    def in_mode(self: _Self, mode: int) -> _Self:
        """Return the same mechanism in another assembly mode."""
        return self if mode == self.mode else replace(self, mode=mode)

    def without_stroke(self: _Self) -> _Self:
        """Return the same mechanism without a stroke, so that poses beyond it are computed."""
        return self if self.stroke is None else replace(self, stroke=None)

    def with_lengths(self: _Self, lengths: Sequence[float]) -> _Self:
        """Return the same mechanism with other :attr:`lengths`."""
        return replace(self, **dict(zip(self.length_names, lengths)))

    def constants_of(self, lengths: Sequence[Scalar], _hypot: Function) -> Constants:
        """Return its :attr:`constants` with other lengths, of any numbers."""
        return self.constants._replace(lengths=tuple(lengths))

    def with_external(self: _Self, external: External) -> _Self:
        """
        Return the same mechanism with other external loads, sharing what follows from geometry.

        A node does this for each wrench message, so ranges and traces are not made again.
        """
        return self._copy(**self._geometry, external=external)

    def with_base(self: _Self, base: Base) -> _Self:
        """Return the same mechanism on a body that moves, which takes the place of gravity."""
        return self._copy(**self._geometry, gravity=checked_gravity(base))

    @property
    def _geometry(self) -> dict[str, object]:
        """Return what is known and follows from geometry alone."""
        return {name: value for name, value in list(self.__dict__.items())
                if isinstance(getattr(type(self), name, None), cached_by_lengths)}

    def _copy(self: _Self, **changed: object) -> _Self:
        """Return a copy with other fields, unchecked and without any cached property."""
        other = object.__new__(type(self))
        fields = {name: value for name, value in self.__dict__.items()
                  if not isinstance(getattr(type(self), name, None), cached_property)}
        other.__dict__.update(fields, **changed)
        return other

    # --- its formulas ----------------------------------------------------------------------------

    @cached_by_lengths
    def _motion_line(self) -> Function:
        return line_of(self, with_loads=False)

    def make_coefficients(self, n: NumberType) -> Coefficients:
        """
        Return position -> coefficients of all links for a number type: what dynamics is made of.

        For each of ``LINKS`` (x, y, x', y', x'', y'', cosine, sine, theta', theta''): place of its
        first joint and direction, primes for derivatives with respect to the input. That is its
        LinkMotion at unit rate and zero acceleration, and exact. A stroke is no limit here; where
        the links cannot close it raises ValueError, or gives NaN in arrays.
        """
        motion_of, as_motion = self.motion_formula(n, self.constants), self.MOTION
        link_motion, links = self.link_motion, [link.name for link in self.LINKS]

        def coefficients(position: Scalar) -> list[LinkMotion]:
            motion = as_motion._make(motion_of(position, 1.0, 0.0))
            return [link_motion(motion, link) for link in links]
        return coefficients

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """
        Return the input and its two derivatives from coefficients of the links.

        Inverse of :meth:`make_coefficients`: where the derivatives are with respect to another
        coordinate, as of :meth:`.Mechanism.driven_otherwise`, so are those returned. An angle is
        in [-pi, pi].
        """
        if self.is_driven_by_slide:
            return curves[-1].x, curves[-1].v_x, curves[-1].a_x
        crank = curves[0]
        return n.atan2(crank.sine, crank.cosine), crank.omega, crank.alpha

    @cached_by_lengths
    def record_of_motion(self) -> Recorded:
        """Return the trace of the motion, and this mechanism's constants in it."""
        return recorded(self, False)

    @cached_property
    def record_with_loads(self) -> Recorded:
        """Return the trace of motion and loads, and this mechanism's constants in it."""
        return recorded(self, True)

    def __dir__(self) -> list[str]:
        """Return what tab completion shows: what a user asks of a mechanism."""
        shown = {field.name for field in fields_of(self)}.union(SHOWN)
        return sorted(name for name in shown if hasattr(type(self), name) or name in self.__dict__)

    @cached_property
    def _step_line(self) -> tuple[Function, Function, Function]:
        """Return the line of motion and loads, and the functions that make records of both."""
        if self.bodies is None:
            raise MissingBodies
        return line_of(self, with_loads=True), self.MOTION._make, self.LOADS._make

    @cached_by_lengths
    def _as_motion(self) -> Callable[[Iterable[Any]], NamedFields]:
        make: Callable[[Iterable[Any]], NamedFields] = self.MOTION._make
        return make

    def prepare(self) -> Function:
        """
        Return the function of one sample; called early, the first sample need not wait for it.

        Tracing and compiling the first mechanism of a structure takes some 10 ms. ArithmeticError
        or ValueError where numbers overflow.
        """
        return self._step_line[0] if self.bodies else self._motion_line

    def driven_otherwise(self) -> tuple[DrivenLinks, ...]:
        """
        Return the same links with another coordinate as the input, one for each assembly mode.

        Where the input turns back at a toggle that coordinate goes on, so simulation changes to it
        there. Nothing if no other coordinate is known.
        """
        for other in self.INPUTS:
            if other != self.input:
                free = replace(self, input=other, mode=OPEN, stroke=None)
                return tuple([free.in_mode(mode) for mode in sorted(free.modes)])
        return ()

    # --- evaluated ------------------------------------------------------------------------------

    def motion(self, position: ArrayLike, rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0,
               fields: Iterable[str] | None = None) -> Any:
        """
        Return the motion for given input, its rate and acceleration.

        Parameters
        ----------
        position, rate, acceleration : float or array_like
            Crank angle [rad] (any number of turns), [rad/s], [rad/s^2], or slide [m], [m/s],
            [m/s^2], as ``input`` says; arrays are broadcast. Three floats take the fast scalar
            path; samples of arrays may differ from it in their last bits.
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
        if not (type(position) is float and type(rate) is float and type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                position, rate, acceleration = map(number, self.input_coordinate,
                                                   (position, rate, acceleration))
                return self.motion(position, rate, acceleration)
            from fourbar_ros.mechanisms.batches import evaluate  # nodes take one sample at a time
            return self._as_motion(evaluate(self, (position, rate, acceleration), None, False))
        if (position + rate * rate + acceleration) * 0.0 != 0.0:    # one comparison for all
            self._refuse(position, rate, acceleration)
        try:
            return self._as_motion(self._motion_line(position, rate, acceleration))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def loads(self, position: ArrayLike, rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0,
              base: Base | None = None) -> NamedFields:
        """
        Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies.

        On a body that moves as ``base`` says, numbers or arrays that broadcast with the input,
        they are those along the axes of that body; it takes the place of gravity.
        """
        if base is None:
            return self.step(position, rate, acceleration)[1]
        if _are_numbers(position, rate, acceleration, *base):
            return self.with_base(base).step(position, rate, acceleration)[1]
        if self.bodies is None:
            raise MissingBodies
        from fourbar_ros.mechanisms.batches import loads_on_bases
        return loads_on_bases(self, (position, rate, acceleration), base)

    @cached_property
    def weightless(self: _Self) -> _Self:
        """Return the same mechanism without gravity, base and external loads."""
        external = self.EXTERNAL._make([NOT_APPLIED] * len(self.EXTERNAL._fields))
        return self._copy(**self._geometry, gravity=(0.0, 0.0), external=external)

    @property
    def drive_load(self) -> str:
        """Return the name of the load that is the drive's torque or force."""
        return 'driving_force' if self.is_driven_by_slide else 'driving_torque'

    def inertia(self, position: ArrayLike) -> Any:
        """
        Return the inertia at the input, J of T = J alpha + b [kg m^2], of a driven slide [kg].

        Arguments and errors as in :meth:`loads`. At another joint that turns ``ratio`` times as
        fast as the input it is J / ratio^2.
        """
        return getattr(self.weightless.loads(position, 0.0, 1.0), self.drive_load)

    def bias(self, position: ArrayLike, rate: ArrayLike = 0.0) -> Any:
        """Return b of T = J alpha + b [N m], [N]: the drive without acceleration."""
        return getattr(self.loads(position, rate, 0.0), self.drive_load)

    def step(self, position: ArrayLike, rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0,
             fields: Iterable[str] | None = None) -> Any:
        """
        Return (motion, loads) together, at the cost of the loads alone.

        Arguments and errors as in :meth:`motion`; ``fields`` may name fields of both. A mechanism
        without masses has no loads: MissingBodies.
        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), True)
        line, as_motion, as_loads = self._step_line
        if not (type(position) is float and type(rate) is float and type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                position, rate, acceleration = map(number, self.input_coordinate,
                                                   (position, rate, acceleration))
                return self.step(position, rate, acceleration)
            from fourbar_ros.mechanisms.batches import evaluate  # nodes take one sample at a time
            rows = evaluate(self, (position, rate, acceleration), None, True)
            count = len(self.MOTION._fields)
            return as_motion(rows[:count]), as_loads(rows[count:])
        if (position + rate * rate + acceleration) * 0.0 != 0.0:
            self._refuse(position, rate, acceleration)
        try:
            motion, loads = line(position, rate, acceleration)
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None
        if sum(loads) * 0.0 != 0.0:          # one is not finite, or nearly so
            raise InvalidParameter(self.input_coordinate.rate, rate,
                                   'so fast, or with such masses, that loads overflow')
        return as_motion(motion), as_loads(loads)

    def motion_and_loads(self, position: ArrayLike, rate: ArrayLike = 0.0,
                         acceleration: ArrayLike = 0.0) -> tuple[NamedFields, NamedFields | None]:
        """Return (motion, loads) as :meth:`step` does; without masses the loads are None."""
        if self.bodies is None:
            return self.motion(position, rate, acceleration), None
        both: tuple[NamedFields, NamedFields] = self.step(position, rate, acceleration)
        return both

    def _refuse(self, *values: float) -> NoReturn:
        """Raise the error for the first of position, rate and acceleration that is not finite."""
        for name, value in zip(self.input_coordinate, values):
            if not isfinite(value):
                raise InvalidParameter(name, value, 'must be a finite number')
        raise InvalidParameter(self.input_coordinate.rate, values[1],
                               'so fast that its square overflows')

    def _why_no_motion(self, position: float) -> FourBarError:
        """Return the error for an input at which a square root was not real or a sine zero."""
        name, unit = self.input_coordinate.position, self.input_coordinate.unit
        # A limit and the input compared with it are each rounded, and so is their distance.
        tolerance = 4.0 * EPS * abs(position)
        is_flat = position == 0.0 and self.is_flat_at_zero
        is_at_limit = any(abs(self.distance(position, end)) <= tolerance
                          for ends in self.closing_ranges for end in ends)
        if self.is_in_stroke(position) and (is_flat or is_at_limit):
            return Toggle(name, position, unit)
        return OutOfRange(name, position, self.input_ranges, unit)

    def _only(self, fields: Iterable[str], inputs: tuple[ArrayLike, ArrayLike, ArrayLike],
              with_loads: bool) -> tuple[Any, ...]:
        """Return the fields of these names alone, as a tuple in their order."""
        if isinstance(fields, Iterable) and not isinstance(fields, str):
            fields = tuple(fields)
        wanted, needs_loads = _places(self.MOTION, self.LOADS if with_loads else None, fields)
        if needs_loads and self.bodies is None:
            raise MissingBodies
        if not _are_numbers(*inputs):
            from fourbar_ros.mechanisms.batches import evaluate  # nodes take one sample at a time
            return tuple(evaluate(self, inputs, wanted, needs_loads))
        if needs_loads:
            motion, loads = self.step(*inputs)
            values = [*motion, *loads]
        else:
            values = [*self.motion(*inputs)]
        return tuple([values[i] for i in wanted])


@cache
def _places(motion: NamedFields, loads: NamedFields, fields: Any) -> tuple[tuple[int, ...], bool]:
    """Return the places of fields among those of motion and loads, and if any is a load."""
    known = motion._fields + (loads._fields if loads else ())
    for name in fields if isinstance(fields, tuple) else (fields,):
        if name not in known or not isinstance(fields, tuple):
            raise InvalidParameter('fields', name, f'must be some of {", ".join(known)}')
    wanted = tuple(map(known.index, fields))
    return wanted, any(i >= len(motion._fields) for i in wanted)


def _are_numbers(*values: ArrayLike) -> bool:
    return all(isinstance(value, Real) for value in values)
