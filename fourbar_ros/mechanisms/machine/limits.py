# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Where a machine of dyads closes: limits of its input, toggles there, modes beyond them."""
from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from functools import cached_property
from math import pi
from typing import Any, ClassVar

from fourbar_ros.errors import FourBarError, InvalidParameter, Toggle
from fourbar_ros.mechanisms.checks import STROKE, two_numbers
from fourbar_ros.mechanisms.contract import CRANK, CROSSED, OPEN, SLIDE
from fourbar_ros.mechanisms.machine.description import Dyad, OF_ONE_MODE
from fourbar_ros.mechanisms.machine.layout import Layout
from fourbar_ros.mechanisms.machine.loops import SAME
from fourbar_ros.mechanisms.machine.otherwise import can_drive, SeenFromLink
from fourbar_ros.mechanisms.machine.ranges import Closings, find_ranges, Limit
from fourbar_ros.mechanisms.mechanism import Mechanism


class WithLimits(Mechanism):
    """What a machine, by its ``layout``, ``stages`` and their ``signs``, knows of its limits."""

    dyads: tuple[Dyad, ...]
    # set for each one when it is made; no fields
    layout: ClassVar[Layout]
    flats: ClassVar[tuple[float, ...]]

    @property
    @abstractmethod
    def stages(self) -> tuple[Dyad, ...]:
        """Return all dyads; a cylinder is one whose slide is driven, and the first."""

    @property
    @abstractmethod
    def signs(self) -> tuple[float, ...]:
        """Return the assembly modes of all dyads as +-1."""

    def require_closing(self) -> None:
        """Refuse a machine that cannot be assembled at any input."""
        name = self._closings.stopped
        if name:
            others = '' if name == self.dyads[0].name else ' at which those before it do'
            raise InvalidParameter(f'dyads.{name}', None, f'cannot close at any input{others}')

    @cached_property
    def _closings(self) -> Closings:
        numbers = [dyad.numbers for dyad in self.stages]
        size = sum(map(abs, self.lengths))
        stroke = two_numbers('stroke', self.stroke, STROKE) if self.stroke is not None else ()
        far = 2.0 * max([size, *map(abs, stroke)])
        found = find_ranges(self.layout, numbers, self.signs, (-far, far))
        if self.input == SLIDE and self.stroke is None and any(
                bound is not None and far in map(abs, (bound[0].x, bound[1].x))
                for bound in found.limits):
            raise InvalidParameter('stroke', self.stroke, 'must be given: no dyad limits the '
                                                          'slide')
        return found

    @cached_property
    def _near(self) -> tuple[complex, ...]:
        # where slides become parallel |sine| has a minimum too: the limit, which is known
        limits = [end.x for bound in self.limits if bound for end in bound]
        return tuple([z for near in self._closings.near for z in near()
                      if all(abs(z - x) > SAME * self.input_unit for x in limits)])

    @property
    def closing_ranges(self) -> tuple[tuple[float, float], ...]:
        """Return the ranges of the input in which all dyads close [rad or m]."""
        return tuple([(-pi, pi) if bound is None else (bound[0].x, bound[1].x)
                      for bound in self._closings.limits])

    def without_stroke(self) -> Any:
        """Return the same machine without a stroke, or with one ten times as long."""
        try:
            return super().without_stroke()
        except InvalidParameter:        # no dyad limits the slide
            low, high = self.stroke
            reach = 4.5 * (high - low)
            return replace(self, stroke=(low - reach, high + reach))

    @property
    def limits(self) -> tuple[tuple[Limit, Limit] | None, ...]:
        """Return (low, high) of each range, with the dyads at toggles; None: full turns."""
        return self._closings.limits

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the inputs where a dyad is in line: limits, flats, complex ones near ranges."""
        ends = [complex(end.x) for bound in self.limits if bound for end in bound]
        return [*ends, *map(complex, self.flats), *self._near]

    @property
    def margins(self) -> tuple[float, ...]:
        """Return nothing: change points of a machine are not differences of lengths."""
        return ()

    @property
    def change_point_margin(self) -> float:
        """Return the distance of the nearest complex toggle from a range, over its size."""
        if self.flats:
            return 0.0
        return min([abs(z.imag) / self.input_unit for z in self._near], default=1.0)

    @property
    def modes(self) -> dict[int, str]:
        """
        Return {mode: its name}: the modes of the dyads that have two.

        With a change point also the one in which the machine goes on through its flat positions.
        """
        both = [self, self.in_mode(self.mode_beyond(self.flats[0]))] if self.flats else [self]
        return {one.mode: ', '.join(f'{dyad.name} {dyad.mode}' for dyad in one.stages
                                    if dyad.kind not in OF_ONE_MODE) or 'one' for one in both}

    def mode_beyond(self, limit: float) -> int:
        """Return the mode into which quantities go on smoothly at a toggle, a flat position."""
        if any(abs(self.distance(limit, flat)) < SAME for flat in self.flats):
            return 1 + ((self.mode - 1) ^ sum(
                1 << i for i, stage in enumerate(self.layout.stages) if stage.loop))
        place = [dyad.name for dyad in self.stages].index(self._limit_next_to(limit).dyad)
        has_one = self.stages[place].kind in OF_ONE_MODE     # goes on in x, not in its root
        return self.mode if has_one else 1 + ((self.mode - 1) ^ (1 << place))

    @property
    def modes_passed(self) -> tuple[int, ...]:
        """Return the modes between which a motion goes on: at flat positions and toggles."""
        ends = {end.x for bound in self.limits if bound for end in bound if end.dyad}
        return tuple(sorted({*self.modes, *map(self.mode_beyond, ends)}))

    def driven_otherwise(self) -> tuple[SeenFromLink, ...]:
        """Return the machine driven at its link on the ground, if the crank turns back by it."""
        names = {end.dyad for bound in self.limits if bound for end in bound}
        dyads = [i for i, dyad in enumerate(self.stages) if {dyad.name} == names]
        if self.input != CRANK or not dyads or not can_drive(self.stages[dyads[0]],
                                                             self.layout.driven):
            return ()
        numbers = [dyad.numbers for dyad in self.stages]
        return tuple([SeenFromLink(self.layout, numbers, self.signs, dyads[0], mode)
                      for mode in (CROSSED, OPEN)])

    def _limit_next_to(self, position: float) -> Limit:
        ends = [end for bound in self.limits if bound for end in bound]
        return min(ends, key=lambda end: abs(self.distance(position, end.x)))

    def _why_no_motion(self, position: float) -> FourBarError:
        """Return the error for an input at which a dyad does not close, or is at its toggle."""
        error = super()._why_no_motion(position)
        if not isinstance(error, Toggle):
            return error
        return Toggle(error.name, position, self.input_coordinate.unit,
                      self._limit_next_to(position).dyad)
