# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What follows from the contract of a mechanism before anything moves."""
from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from math import fsum, nan, pi, remainder
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Applied, Body, NOT_APPLIED
from fourbar_ros.mechanisms.contract import Constants, Contract, CRANK, OPEN, Ranges, SLIDE
from fourbar_ros.mechanisms.parts import Coordinate, Link, Output
from fourbar_ros.mechanisms.stroke import within_stroke
from fourbar_ros.numerics.number_types import power_of_two


class Described(Contract):
    """A mechanism by what it states: lengths, ranges, units, sizes of what will be computed."""

    @cached_property
    def lengths(self) -> tuple[float, ...]:
        """Return the lengths [m]."""
        return tuple([getattr(self, length.name) for length in self.LENGTHS])

    @property
    def length_names(self) -> tuple[str, ...]:
        """Return the names of the lengths."""
        return tuple([length.name for length in self.LENGTHS])

    @property
    def change_point_margin(self) -> float:
        """
        Return the least size of :attr:`margins` over the sum of all lengths.

        Zero: a change point, where both assembly modes meet and the linkage can leave its mode.
        """
        return min(map(abs, self.margins)) / fsum(map(abs, self.lengths))

    @property
    def description(self) -> str:
        """Return what it is as text: kind, type, input."""
        return f'{self.TITLE}, {self.classification}, driven at its {self.input}'

    @cached_property
    def input_ranges(self) -> Ranges:
        """
        Return the ranges of the input, from low to high.

        :attr:`closing_ranges`, as far as they lie in the stroke.
        """
        return within_stroke(self.closing_ranges, self.stroke)

    @property
    def outputs(self) -> tuple[Output, ...]:
        """Return the tuple of :class:`Output` for what is driven."""
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
        """
        Return {name of a link: (Body, Applied)}: what is given for each.

        Nothing without masses.
        """
        given = self.external._asdict()
        return {name: (body, given.get(name, NOT_APPLIED))
                for name, body in (self.bodies._asdict().items() if self.bodies else ())}

    @property
    def structure(self) -> tuple[Any, ...]:
        """Return what mechanisms have in common whose formulas do the same with other numbers."""
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

    def distance(self, one: float, other: float) -> float:
        """
        Return the signed distance of two inputs.

        The short way round of angles [rad], or [m].
        """
        return one - other if self.is_driven_by_slide else remainder(one - other, 2.0 * pi)

    def term_sizes(self, motion: Any, rate: float, acceleration: float) -> dict[str, Any]:
        """Return {unit: size} of the terms of rates and accelerations, for noise bounds."""
        angles = [joint.coordinate for joint in self.JOINTS if joint.coordinate.unit == 'rad']
        omega = sum(abs(getattr(motion, joint.rate).real) for joint in angles)
        alpha = omega * omega + sum(abs(getattr(motion, joint.acceleration).real)
                                    for joint in angles)
        size = max(map(abs, self.lengths))
        return {'rad/s': omega, 'rad/s^2': alpha, 'm/s': size * omega, 'm/s^2': size * alpha}

    def crank_angle(self, motion: Any) -> Any:
        """Return the angle of the crank in a motion [rad]."""
        return motion.theta1

    @property
    def modes_passed(self) -> tuple[int, ...]:
        """Return the modes between which a motion goes on at toggles and flat positions."""
        return tuple(sorted(self.modes))

    def mode_beyond(self, _limit: float) -> int:
        """Return the mode into which quantities go on smoothly at a toggle at a limit."""
        return 3 - int(self.mode)

    def unknown(self, position: float, rate: float, acceleration: float) -> Any:
        """Return the motion of which only the input is known; the rest is NaN."""
        fields = dict.fromkeys(self.MOTION._fields, nan)
        fields.update(zip(self.input_coordinate, (position, rate, acceleration)))
        return self.MOTION(**fields)


def find_link(links: Iterable[Link], name: str) -> Link:
    """Return the :class:`Link` of a name; InvalidParameter if there is none."""
    links = tuple(links)
    for link in links:
        if link.name == name:
            return link
    raise InvalidParameter('link', name, 'must be one of '
                                         f'{", ".join(link.name for link in links)}')
