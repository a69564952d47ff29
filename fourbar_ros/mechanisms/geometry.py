# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What follows from the statement of a mechanism without a pose: ranges, modes, copies."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields as fields_of
from dataclasses import replace
from functools import cached_property
from math import degrees, fsum, inf, lcm, nan, pi, remainder
from typing import Any, Self, TYPE_CHECKING, TypeVar

from fourbar_ros.errors import InvalidParameter, one_of, OutOfRange
from fourbar_ros.mechanics.bodies import Applied, Base, Body, External, NOT_APPLIED
from fourbar_ros.mechanisms import checks, parts
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.statement import StatedMechanism
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.number_types import exact_sum, Function, power_of_two, Scalar
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.elements import Element

_T = TypeVar('_T')
# Nearer to a limit that is a change point than this, in units of the input, accelerations are
# noise: their error is some eps over the third power of the distance.
BESIDE_FLAT_LIMITS = 2.0**-17
# A singular input so near to the end of a range is this end [in the unit of the input].
AT_END = 1e-12


class cached_by_lengths(cached_property[_T]):     # noqa: N801  (used as cached_property is)
    """A cached property of geometry alone, which copies with other loads share."""


class MechanismGeometry(StatedMechanism):
    """Where a mechanism closes, which modes it has, and how it is checked and copied."""

    @cached_by_lengths
    def lengths(self) -> tuple[float, ...]:
        return tuple([getattr(self, length.name) for length in self.LENGTHS])

    @property
    def length_names(self) -> tuple[str, ...]:
        return tuple([length.name for length in self.LENGTHS])

    @property
    def numbers_of_lengths(self) -> tuple[str, ...]:
        """Return the name of each number of ``constants.lengths``, '' for what is no length."""
        # Generated code can change those lengths at run time.
        return self.length_names

    @cached_by_lengths
    def margins(self) -> tuple[float, ...]:
        """Return the differences of sums of lengths [m] that are zero at change points."""
        return tuple([exact_sum([sign * abs(length) for sign, length in zip(signs, self.lengths)])
                      for signs in self.MARGIN_SIGNS])

    @property
    def change_point_margin(self) -> float:
        """Return the least size of :attr:`margins` over all lengths; zero: a change point."""
        return min(map(abs, self.margins)) / fsum(map(abs, self.lengths))

    @property
    def description(self) -> str:
        return f'{self.TITLE}, {self.classification}, driven at its {self.input}'

    @property
    def branch_in_words(self) -> str:
        """Return what a change point does where it lies flat, as text; '' if it never does."""
        unit = self.input_coordinate.unit
        flats = [f'{degrees(x):g}' if unit == 'rad' else f'{x:g}'
                 for x in self.flat_inputs if self.is_in_stroke(x)]
        if not flats:
            return ''
        words = (f'flat at {self.input_coordinate.position} {", ".join(flats)} '
                 f'{"deg" if unit == "rad" else unit}, where the motion stays in mode {self.mode}')
        return words + ('; repeats after two turns' if 2.0 * pi < self.period < inf else '')

    @cached_by_lengths
    def cut(self) -> tuple[float, float] | None:
        """Return the stroke where it leaves inputs out: of angles, if it is less than a period."""
        stroke = self.stroke
        return stroke if stroke and stroke[1] - stroke[0] < self.period else None

    @cached_by_lengths
    def input_ranges(self) -> parts.Ranges:
        """Return what of :attr:`closing_ranges` is in the stroke; of angles in its turn."""
        if not self.cut:
            return self.closing_ranges
        return (self.cut,) if self.closes_fully else parts.clipped(
            self.closing_ranges, self.cut, self.period)

    @property
    def toggles(self) -> tuple[float, ...]:
        """Return the ends of :attr:`input_ranges` that are no ends of the stroke [rad or m]."""
        if self.closes_fully:
            return ()
        ends = [end for bounds in self.closing_ranges for end in bounds]
        return tuple([x for bounds in self.input_ranges for x in bounds if any(
            abs(self.distance(x, end)) <= AT_END * self.input_unit for end in ends)])

    def stroke_around(self, position: float) -> tuple[float, float]:
        """Return the stroke, of angles in the turn of a position; without one (-inf, inf)."""
        low, high = self.stroke or (-inf, inf)
        away = (0.0 if self.is_driven_by_slide or low <= position <= high
                else self.period * round((position - 0.5 * (low + high)) / self.period))
        return low + away, high + away

    def range_around(self, position: float) -> tuple[float, float]:
        """Return the range of the input that holds a position, moved there by whole turns."""
        # Of an input that turns fully the stroke, which may be infinite, or else half a period to
        # both sides. OutOfRange outside all ranges.
        if self.turns_fully:
            low, high = self.stroke_around(position)
            reach = 0.5 * self.period if self.stroke is None else inf
            return max(low, position - reach), min(high, position + reach)
        rounding = 4.0 * EPS * abs(position)
        for low, high in self.input_ranges:
            turns = (0.0 if self.is_driven_by_slide
                     else self.period * round((position - 0.5 * (low + high)) / self.period))
            low, high = low + turns, high + turns
            if low - rounding <= position <= high + rounding:
                return min(low, position), max(high, position)
        raise OutOfRange(self.input_coordinate.position, position, self.input_ranges,
                         self.input_coordinate.unit)

    @property
    def outputs(self) -> tuple[parts.Output, ...]:
        """Return the outputs for the driven input; the first is published as ``output``."""
        return self.OUTPUTS[self.input]

    def link(self, name: str) -> parts.Link:
        for link in self.LINKS:
            if link.name == name:
                return link
        raise InvalidParameter('link', name, one_of((link.name for link in self.LINKS), name))

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
        return {name: (body, getattr(self.external, name, NOT_APPLIED))
                for name, body in self.bodies._asdict().items()}

    @property
    def structure(self) -> tuple[object, ...]:
        """Return the cache key of traced formulas: equal if mechanisms differ in numbers only."""
        return type(self), self.input

    @cached_property
    def constants(self) -> Constants:
        return Constants(self.lengths, self.sign, self.bodies, self.gravity, self.external,
                         self.elements, tuple([friction for _, friction in self.friction]))

    @property
    def sign(self) -> float:
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
        return 1.0 if self.mode == parts.OPEN else -1.0

    @property
    def input_coordinate(self) -> parts.Coordinate:
        return self.INPUTS[self.input]

    @property
    def is_driven_by_slide(self) -> bool:
        """Return whether the input is a length, not an angle."""
        return bool(self.input == parts.SLIDE)

    @property
    def input_unit(self) -> float:
        """Return the unit in which inputs are of the size of one: 1 rad, or a power of two [m]."""
        return power_of_two(*self.lengths) if self.is_driven_by_slide else 1.0

    @property
    def closes_fully(self) -> bool:
        """Return whether the input is an angle at all values of which the links close."""
        return not self.is_driven_by_slide and self.closing_ranges == ((-pi, pi),)

    @property
    def turns_fully(self) -> bool:
        """Return whether the input is an angle that makes full turns: no stroke forbids it."""
        return self.closes_fully and not self.cut

    @cached_by_lengths
    def period(self) -> float:
        """Return after how much of the input everything repeats [rad]; inf of a slide."""
        # A turn; two of a change point that passes an odd number of flat positions in one, as the
        # branch is then on its other side.
        if self.is_driven_by_slide:
            return inf
        return 4.0 * pi if self.closes_fully and self._has_odd_turns else 2.0 * pi

    @property
    def turns(self) -> int:
        """Return after how many turns all repeats, the forces on it too: two of a four-stroke."""
        turns = 1 if self.is_driven_by_slide else round(self.period / (2.0 * pi))
        if not self.elements:
            return turns
        from fourbar_ros.mechanisms.elements import turns_of  # few mechanisms have any
        return lcm(turns, turns_of(self.elements))

    @property
    def cycle(self) -> float:
        """Return after how much of the input all repeats, forces too [rad]; inf of a slide."""
        return self.period if self.is_driven_by_slide else 2.0 * pi * self.turns

    @property
    def _has_odd_turns(self) -> bool:
        return len(self.flat_inputs) % 2 == 1

    def is_in_stroke(self, position: float) -> bool:
        """Return whether an input is in the stroke, if there is one; angles in any turn."""
        return not self.cut or bool(parts.is_within(position, self.cut, self.period))

    @property
    def reaches(self) -> Function | None:
        """Return input -> whether results may be given there; None if they always may."""
        # They may not outside the stroke, nor so near to a flat limit that accelerations are
        # noise. Inputs are floats or arrays, real or complex.
        stroke, flats = self.cut, set(self.flat_limits)
        if not stroke and not flats:
            return None
        period = self.period        # of a stroke, two turns if the branch repeats after two
        turn = inf if self.is_driven_by_slide else 2.0 * pi     # of a limit, in each turn
        near = BESIDE_FLAT_LIMITS * self.input_unit

        def may_be_given(position: Scalar) -> Any:
            x = position.real
            is_given: Any = parts.is_within(x, stroke, period) if stroke else ~np.isnan(x)
            for flat in flats:
                distance = x - flat
                if turn < inf:
                    distance = distance - turn * np.round(distance / turn)
                is_given = is_given & (abs(distance) > near)
            return is_given
        return may_be_given

    def from_minus_pi_on(self, x: float) -> float:
        """Return an input of -pi to a period; angles in the period from -pi on [rad or m]."""
        return x - self.period if x >= self.period - pi else x

    def distance(self, first: float, second: float) -> float:
        """Return the first input less the second, of angles the short way round [rad or m]."""
        difference = first - second
        return difference if self.is_driven_by_slide else remainder(difference, 2.0 * pi)

    def crank_angle(self, motion: parts.NamedFields) -> Scalar:
        """Return the angle of the crank in a motion [rad]."""
        angle: Scalar = motion.theta1
        return angle

    @property
    def modes_passed(self) -> tuple[int, ...]:
        """Return the modes between which a motion goes on at toggles."""
        return (self.mode,) if self.closes_fully else tuple(sorted(self.modes))

    def mode_beyond(self, _limit: float) -> int:
        """Return the mode into which quantities go on smoothly at a toggle, a limit."""
        return 3 - int(self.mode)

    @property
    def flat_limits(self) -> tuple[float, ...]:
        """Return the ends of :attr:`closing_ranges` that are change points [rad or m]."""
        return ()

    @cached_by_lengths
    def flat_inputs(self) -> tuple[float, ...]:
        """
        Return the inputs inside the ranges at which a change point lies flat [rad or m], in order.

        Both assembly modes meet there; the motion goes on in its own, and joints may bear any
        load. Angles are in (-pi, pi].
        """
        if self.change_point_margin:
            return ()
        ends = [] if self.closes_fully else [end for ends in self.closing_ranges for end in ends]
        flats = {pi if z.real == -pi else z.real for z in self.singular_inputs if z.imag == 0.0}
        return tuple(sorted(x for x in flats if all(
            abs(self.distance(x, end)) > AT_END * self.input_unit for end in ends)))

    def unknown(self, position: float, rate: float, acceleration: float) -> parts.NamedFields:
        """Return a motion with the input alone and NaN else: a sample that cannot be computed."""
        fields = dict.fromkeys(self.MOTION._fields, nan)
        fields.update(zip(self.input_coordinate, (position, rate, acceleration)))
        return self.MOTION(**fields)

    def _set(self, **values: Any) -> None:      # past the frozen dataclass
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check_fit(self) -> None:
        checks.check_stroke(self)
        if self.elements != ():
            from fourbar_ros.mechanisms.elements import fitted  # few mechanisms have any
            self._set(elements=fitted(self.elements, self))

    def __getstate__(self) -> dict[str, object]:
        """Return the fields to be pickled: functions made of them can be neither sent nor kept."""
        return {field.name: getattr(self, field.name) for field in fields_of(self)}

    def in_mode(self, mode: int) -> Self:
        return self if mode == self.mode else replace(self, mode=mode)

    def without_stroke(self) -> Self:
        """Return the same mechanism without a stroke, so that poses beyond it are computed."""
        return self if self.stroke is None else self._copy(stroke=None)

    def with_lengths(self, lengths: Sequence[float]) -> Self:
        """Return the same mechanism with other ``lengths`` [m], in the order of its own."""
        return replace(self, **self.lengths_by_name(lengths))

    def lengths_by_name(self, lengths: Sequence[Scalar]) -> dict[str, Scalar]:
        """Return {name of a length: one of ``lengths``}, as many as the mechanism has."""
        if len(lengths) != len(self.length_names):
            raise InvalidParameter('lengths', tuple(lengths),
                                   f'must be as many as {", ".join(self.length_names)}')
        return dict(zip(self.length_names, lengths))

    def constants_of(self, lengths: Sequence[Scalar]) -> Constants:
        return self.constants._replace(lengths=tuple(lengths))

    def with_loads(self, **loads: Any) -> Self:
        """Return the same with other bodies, gravity and external loads, sharing geometry."""
        copied: Any = self._with(**loads)
        copied.__post_init__()          # which checks them
        return copied       # type: ignore[no-any-return]

    def with_external(self, external: External) -> Self:
        """Return the same mechanism with other external loads, sharing ranges and traces."""
        # a record of its own has been checked as it was made, and a node gives one each sample
        return (self._with(external=external) if type(external) is self.EXTERNAL
                else self.with_loads(external=external))

    def with_elements(self, *elements: Element) -> Self:
        """Return the same mechanism with these springs, dampers and forces over a position."""
        copied = self._with(elements=elements)
        copied._check_fit()
        return copied

    def with_friction(self, friction: Any) -> Self:
        """Return the same mechanism with friction of joints and drive, {name: its friction}."""
        copied = self._with(friction=friction)
        return copied._with(friction=checks.friction_of(copied))

    def with_base(self, base: Base) -> Self:
        """Return the same mechanism on a body that moves, which takes the place of gravity."""
        return self._with(gravity=checks.checked_gravity(checks.required_base(base)))

    def _with(self, **loads: object) -> Self:
        """Return an unchecked copy with other loads, and with what follows from geometry alone."""
        return self._copy(**{
            name: value for name, value in list(self.__dict__.items())
            if isinstance(getattr(type(self), name, None), cached_by_lengths)}, **loads)

    def _copy(self, **changed: object) -> Self:
        """Return a copy with other fields, unchecked and without any cached property."""
        copied = object.__new__(type(self))
        fields = {name: value for name, value in self.__dict__.items()
                  if not isinstance(getattr(type(self), name, None), cached_property)}
        copied.__dict__.update(fields, **changed)
        return copied
