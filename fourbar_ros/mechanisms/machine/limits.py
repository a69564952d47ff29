# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Where a machine closes: the limits of its input, toggles there, the modes beyond them."""
from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from decimal import Decimal
from math import pi, remainder
from typing import ClassVar, NamedTuple, TYPE_CHECKING, TypeVar

from fourbar_ros.errors import FourBarError, InvalidParameter, Toggle
from fourbar_ros.mechanisms.checks import STROKE, two_numbers
from fourbar_ros.mechanisms.contract import cached_by_lengths, CRANK, CROSSED, OPEN, SLIDE
from fourbar_ros.mechanisms.machine.describe.description import (
    Dyad,
    Numbers,
    OF_ONE_MODE,
    RRR,
)
from fourbar_ros.mechanisms.machine.describe.layout import Layout
from fourbar_ros.mechanisms.machine.margins import make_assembly_margins
from fourbar_ros.mechanisms.machine.ranges import (
    DOUBLE,
    DyadRanges,
    find_ranges,
    flat_place,
    Limit,
    RangeEnds,
    SAME,
)
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.number_types import REAL

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink

LIMIT, FLAT_LIMIT, FLAT, TOGGLE, POLE = 'limit', 'flat limit', 'flat', 'toggle', 'pole'
# How near another one is the same: a double root is found beside it as far as the root of its
# rounding error.
SAME_AS = {LIMIT: SAME, FLAT_LIMIT: DOUBLE, FLAT: DOUBLE}


class Singularity(NamedTuple):
    """
    An input at which a dyad of a machine is in line [rad or m].

    ``kind``: 'limit', an end of a range, or 'flat limit', one that is a change point; 'flat', a
    change point through which the motion goes on; off the real inputs 'toggle', or 'pole' where
    the ends of a dyad meet.
    """

    input: complex
    kind: str


_Self = TypeVar('_Self', bound='WithLimits')


class WithLimits(Mechanism):
    """The limits of a machine, from its ``layout``, ``stages`` and their ``signs``."""

    dyads: tuple[Dyad, ...]
    # set for each one when it is made; no fields
    layout: ClassVar[Layout]
    numbers: tuple[Numbers, ...]

    @property
    @abstractmethod
    def stages(self) -> tuple[Dyad, ...]:
        """Return all dyads; a cylinder is one whose slide is driven, and the first."""

    @property
    @abstractmethod
    def signs(self) -> tuple[float, ...]:
        """Return the assembly modes of all dyads as +-1."""

    def require_closing(self) -> None:
        """Raise InvalidParameter for the dyad that cannot be assembled at any input."""
        name = self._ranges.stopped
        if name:
            one, other = next((dyad.first.link, dyad.second.link) for dyad in self.stages
                              if dyad.name == name)
            why = (f': it hangs on {one} alone, so no input moves its ends' if one == other else
                   '' if name == self.dyads[0].name else ' at which those before it do')
            raise InvalidParameter(f'dyads.{name}', None, f'cannot close at any input{why}')

    @cached_by_lengths
    def _ranges(self) -> DyadRanges:
        """Return where all dyads close; of a slide searched twice as far as lengths and stroke."""
        size = sum(map(abs, self.lengths))
        stroke = two_numbers('stroke', self.stroke, STROKE) if self.stroke is not None else ()
        far = 2.0 * max([size, *map(abs, stroke)])
        found = find_ranges(self.layout, self.numbers, self.signs, (-far, far), self.input_unit)
        if self.input == SLIDE and self.stroke is None and any(
                bound is not None and far in map(abs, (bound[0].x, bound[1].x))
                for bound in found.limits):
            raise InvalidParameter('stroke', self.stroke, 'must be given: no dyad limits the '
                                                          'slide')
        return found

    @cached_by_lengths
    def singularities(self) -> tuple[Singularity, ...]:
        """Return where a dyad is in line: real inputs, then complex ones near ranges."""
        real = [Singularity(complex(end.x), FLAT_LIMIT if end.is_flat else LIMIT)
                for end in self._ends]
        real += [Singularity(complex(x), FLAT) for x in self.flat_inputs]

        def is_new(z: complex) -> bool:
            """Return whether z is none of the real ones, which searches find too, a bit beside."""
            return all(abs(self.distance(z.real, one.input.real) + 1j * z.imag)
                       > SAME_AS[one.kind] * self.input_unit for one in real)
        return (*real,
                *[Singularity(z, TOGGLE) for search in self._ranges.near for z in search()
                  if is_new(z)],
                *[Singularity(z, POLE) for search in self._ranges.poles for z in search()
                  if is_new(z)])

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the inputs of :attr:`singularities`."""
        return [one.input for one in self.singularities]

    @property
    def flat_inputs(self) -> tuple[float, ...]:
        """Return the inputs of change points through which the motion goes on [rad or m]."""
        return tuple(self._ranges.flats)

    @property
    def flat_limits(self) -> tuple[float, ...]:
        """Return the ends of :attr:`closing_ranges` that are change points [rad or m]."""
        return tuple([end.x for end in self._ends if end.is_flat])

    def flat_place(self, place: float) -> Decimal:
        """Return the input of a flat position [rad or m] in many digits."""
        pairs = self._flat_pairs_at(place)
        return flat_place(self.layout, self.numbers, self.signs,
                          min(pairs) if pairs else self._stage_at(place), place)

    @property
    def closing_ranges(self) -> tuple[tuple[float, float], ...]:
        """Return the ranges of the input in which all dyads close [rad or m]."""
        return tuple([(-pi, pi) if bound is None else (bound[0].x, bound[1].x)
                      for bound in self._ranges.limits])

    def without_stroke(self: _Self) -> _Self:
        """Return the same machine without a stroke, or with one ten times as long."""
        try:
            return super().without_stroke()
        except InvalidParameter:        # no dyad limits the slide
            assert self.stroke is not None
            low, high = self.stroke
            reach = 4.5 * (high - low)
            return replace(self, stroke=(low - reach, high + reach))

    @property
    def limits(self) -> tuple[RangeEnds, ...]:
        """Return (low, high) of each range, with the dyads at toggles; None: full turns."""
        return self._ranges.limits

    @property
    def margins(self) -> tuple[float, ...]:
        """Return nothing: change points of a machine are not differences of lengths."""
        return ()

    @property
    def change_point_margin(self) -> float:
        """Return the distance of the nearest complex toggle from a range, over its size."""
        if self.flat_inputs or self.flat_limits:
            return 0.0
        return min([abs(one.input.imag) / self.input_unit for one in self.singularities
                    if one.kind == TOGGLE], default=1.0)

    @property
    def is_flat_at_zero(self) -> bool:
        """Return whether input 0 is a flat position."""
        return 0.0 in self.flat_inputs

    @property
    def modes(self) -> dict[int, str]:
        """Return {mode: 'DYAD MODE, ...'}: its own, and those into which flat positions lead."""
        modes = dict.fromkeys([self.mode, *map(self.mode_beyond, self.flat_inputs)])
        return {one.mode: ', '.join(f'{dyad.name} {dyad.mode}' for dyad in one.stages
                                    if dyad.kind not in OF_ONE_MODE) or 'one'
                for one in map(self.in_mode, modes)}

    def mode_beyond(self, limit: float) -> int:
        """Return the mode in which a motion goes on smoothly beyond a limit or a flat position."""
        passed = self._flat_pairs_at(limit)
        if not passed:
            number = self._stage_at(limit)
            if self.stages[number].kind in OF_ONE_MODE:     # goes on in x, not in its root
                return self.mode
            passed = frozenset({number})
        return 1 + ((self.mode - 1) ^ sum(1 << number for number in passed))

    @property
    def modes_passed(self) -> tuple[int, ...]:
        """Return the modes between which a motion goes on: at flat positions and toggles."""
        ends = [end.x for end in self._ends if end.dyad]
        return tuple(sorted({*self.modes, *map(self.mode_beyond, ends)}))

    def driven_otherwise(self) -> tuple[SeenFromLink, ...]:
        """Return the machine driven at a link on the ground, if its dyad alone stops the crank."""
        names = {end.dyad for end in self._ends}
        dyads = [i for i, dyad in enumerate(self.stages) if {dyad.name} == names]
        if self.input != CRANK or not dyads or not can_drive(self.stages[dyads[0]],
                                                             self.layout.driven):
            return ()
        from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink  # torque alone
        return tuple([SeenFromLink(self.layout, self.numbers, self.signs, dyads[0], mode)
                      for mode in (CROSSED, OPEN)])

    @property
    def _ends(self) -> list[Limit]:
        return [end for bound in self.limits if bound for end in bound]

    def _flat_pairs_at(self, place: float) -> frozenset[int]:
        """Return the numbers of the pairs that lie flat at an input without stopping motion."""
        return next((pairs for flat, pairs in self._ranges.flats.items()
                     if abs(self.distance(place, flat)) < SAME * self.input_unit), frozenset())

    def _stage_at(self, place: float) -> int:
        """Return the number of the dyad at the limit next to an input."""
        end = min(self._ends, key=lambda end: abs(self.distance(place, end.x)))
        return [dyad.name for dyad in self.stages].index(end.dyad)

    def _why_no_motion(self, position: float) -> FourBarError:
        """Return OutOfRange, or Toggle with its dyad, for an input at which there is no motion."""
        error = super()._why_no_motion(position)
        unit = self.input_coordinate.unit
        if isinstance(error, Toggle):
            pairs = self._ranges.flats.get(position)
            return Toggle(error.name, position, unit, self.stages[
                min(pairs) if pairs else self._stage_at(position)].name)
        place, turns = position, [0.0]
        if not self.is_driven_by_slide:
            place, turns = remainder(position, 2.0 * pi), [-2.0 * pi, 0.0, 2.0 * pi]
        # within a range all dyads close, so that one of them is at a toggle
        if self.is_in_stroke(position) and any(
                low <= place + turn <= high for low, high in self.closing_ranges
                for turn in turns):
            return Toggle(self.input_coordinate.position, position, unit, self._dyad_at(place))
        return error

    def _dyad_at(self, position: float) -> str:
        """Return the name of the first dyad that cannot be solved at an input; one cannot."""
        for number, dyad in enumerate(self.stages[:-1]):
            try:       # the margins of k dyads solve all but the last of these
                make_assembly_margins(REAL, self.layout, self.numbers, self.signs,
                                      number + 2)(position)
            except (ValueError, ZeroDivisionError):
                return dyad.name
        return self.stages[-1].name         # all others can be solved


def can_drive(dyad: Dyad, driven: str) -> bool:
    """Return whether a dyad is RRR between crank and ground, so that it can turn the crank."""
    ends = {dyad.first.link: dyad.first, dyad.second.link: dyad.second}
    return (dyad.kind == RRR and set(ends) == {driven, GROUND}
            and any(ends[driven][1:]) and any(ends[GROUND][1:]))
