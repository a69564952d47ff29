# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The contract of a mechanism: its facts and its formulas.

Also all that follows from these before anything moves: ranges, units, sizes.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from decimal import Decimal
from functools import cached_property
from math import fsum, inf, nan, pi, remainder
from typing import Any, ClassVar, NamedTuple, TypeVar

from fourbar_ros.errors import InvalidParameter, one_of
from fourbar_ros.mechanics.bodies import Applied, applied_to, Body, Gravity
from fourbar_ros.mechanisms.parts import (
    Connection,
    Coordinate,
    Diagram,
    Joint,
    Length,
    Link,
    NamedFields,
    Output,
    Quantity,
    Ranges,
    Reaction,
    within_stroke,
)
from fourbar_ros.mechanisms.points import LinkMotion
from fourbar_ros.numerics.number_types import Function, NumberType, power_of_two, Scalar
import numpy as np

CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0 of a 4R linkage
CRANK, SLIDE = 'crank', 'slide'     # inputs
JOINT_A, JOINT_B = 'A', 'B'         # ... between two moving links
_T = TypeVar('_T')


class cached_by_lengths(cached_property[_T]):     # noqa: N801  (used as cached_property is)
    """
    A cached property of lengths, assembly mode, input and stroke alone.

    Copies with other loads share its value, see :meth:`.Mechanism.with_external`; every other
    cached property they compute again.
    """


class Constants(NamedTuple):
    """
    The data of a mechanism that its formulas are made for, as floats.

    :func:`~fourbar_ros.numerics.number_types.converted` puts other numbers in their places.
    """

    lengths: Any
    sign: Any
    bodies: Any
    gravity: Gravity
    external: Any


# Nearer to a limit that is a change point than this, in units of the input, accelerations are
# noise: their error is some eps over the third power of the distance.
BESIDE_FLAT_LIMITS = 2.0**-17


class Contract(ABC):
    """
    Facts and formulas that each mechanism must give; everything else follows from them.

    Code outside a mechanism's own folder reads these names, from an instance. A kind has them as
    attributes of its class, a mechanism put together at run time as its own attributes. The
    numbers of links, joints, loads and outputs are known nowhere else.
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
    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""

    @abstractmethod
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
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
    def margins(self) -> tuple[float, ...]:
        """Return the differences of sums of lengths [m] that are zero at change points."""

    @property
    @abstractmethod
    def classification(self) -> str:
        """Return the type by name: which links turn fully."""

    @abstractmethod
    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of a link by name, from fields of a motion of any number type."""

    @abstractmethod
    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """
        Return a number of at most one in size that is zero where the dyad is in line.

        Errors of rates and loads grow as one over it: the search for extrema bounds noise by it.
        """

    # --- its pictures ----------------------------------------------------------------------------

    @abstractmethod
    def diagram(self, motion: NamedFields) -> Diagram:
        """Return the contents of a picture in one pose."""

    # --- some kinds give these ------------------------------------------------------------------

    @property
    def dead_points(self) -> tuple[Any, ...]:
        """Return records of where the output turns back; their first field is the input."""
        return ()

    @property
    def ranges_of_both_modes(self) -> Mapping[str, Ranges]:
        """Return {position of an output: its ranges over both modes}, if known in closed form."""
        return {}

    @property
    def modes(self) -> Mapping[int, str]:
        """Return {assembly mode: its name}; one input may have fewer than another."""
        return self.MODES

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Return which links each of ``JOINTS`` connects; URDF, SDF and MJCF are made of it."""
        return ()

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
        """Return whether the input is a crank that makes full turns."""
        return self.input == CRANK and self.input_ranges == ((-pi, pi),)

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
            """Return whether an input is in the stroke and away from flat limits."""
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

    def term_sizes(self, motion: NamedFields) -> dict[str, Scalar]:
        """
        Return {unit: size of the terms that add up to rates and accelerations in that unit}.

        A result is uncertain by rounding of its terms, so the search for extrema takes differences
        below some eps times these sizes for noise.
        """
        size, omega, alpha = max(map(abs, self.lengths)), 0.0, 0.0
        for joint in [joint.coordinate for joint in self.JOINTS]:
            # a bar that reaches as far as a slide turns by what it moves, over the distance
            reach = (1.0 if joint.unit == 'rad'
                     else np.maximum(abs(getattr(motion, joint.position).real), size))
            omega = omega + abs(getattr(motion, joint.rate).real) / reach
            alpha = alpha + abs(getattr(motion, joint.acceleration).real) / reach
        alpha = alpha + omega * omega
        return {'rad/s': omega, 'rad/s^2': alpha, 'm/s': size * omega, 'm/s^2': size * alpha}

    def crank_angle(self, motion: NamedFields) -> Scalar:
        """Return the angle of the crank in a motion [rad]."""
        found: Scalar = motion.theta1
        return found

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
        found: NamedFields = self.MOTION(**fields)
        return found


def find_link(links: Iterable[Link], name: str) -> Link:
    """Return the :class:`Link` of a name; InvalidParameter if there is none."""
    links = tuple(links)
    for link in links:
        if link.name == name:
            return link
    raise InvalidParameter('link', name, one_of((link.name for link in links), name))
