# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records that describe mechanisms: coordinates, lengths, links, joints, pictures."""
from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping
from functools import cache
from math import ceil, floor, inf
from typing import Any, NamedTuple, NoReturn

from fourbar_ros.errors import MissingBodies
from fourbar_ros.notebook import record_as_html, short_repr
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.number_types import Scalar
import numpy as np

Ranges = tuple[tuple[float, float], ...]        # (low, high) of an input [rad or m]
CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0 of a 4R linkage
CRANK, SLIDE = 'crank', 'slide'     # inputs
JOINT_A, JOINT_B = 'A', 'B'         # ... between two moving links
LARGEST_MODE = 255       # in a message


def mode_number(mode: int) -> int:
    """Return an assembly mode as messages have it, in a byte; 0 for larger ones of machines."""
    return mode if mode <= LARGEST_MODE else 0


def clipped(ranges: Ranges, bounds: tuple[float, float], turn: float) -> Ranges:
    """Return the parts of ranges of the input that lie between two bounds, from low to high."""
    # turn: by which ranges are moved to come there [rad]; inf of a slide.
    parts, (begin, end) = list[tuple[float, float]](), bounds
    for low, high in ranges:
        for count in ((0,) if turn == inf else
                      range(ceil((begin - high) / turn), floor((end - low) / turn) + 1)):
            away = turn * count if count else 0.0
            first, last = max(low + away, begin), min(high + away, end)
            if last - first > 4.0 * EPS * abs(away):        # no sliver of rounding
                parts.append((first, last))
    return tuple(sorted(parts))


def is_within(position: Scalar, bounds: tuple[float, float], turn: float) -> Scalar:
    """Return which inputs, floats or arrays, lie between two bounds, angles in any turn."""
    (low, high), slack = bounds, 0.0
    if turn < inf:
        away = turn * np.rint((position - 0.5 * (low + high)) / turn)
        position, slack = position - away, 2.0 * EPS * abs(away)
    return (low - slack <= position) & (position <= high + slack)


class Coordinate(NamedTuple):
    """Names of a joint's position, rate and acceleration among the fields of a motion."""

    position: str
    rate: str
    acceleration: str

    @property
    def unit(self) -> str:
        """Return the unit of the position: m if the rate is called ..._velocity, else rad."""
        return 'm' if self.rate.endswith('_velocity') else 'rad'

    @property
    def units(self) -> tuple[str, str, str]:
        return self.unit, f'{self.unit}/s', f'{self.unit}/s^2'


# A motion, or loads: a NamedTuple of one of the types that mechanisms state as MOTION and LOADS.
# Its fields are floats, arrays, or numbers of any other type that it was computed with.
NamedFields = Any


@cache
def record_type(name: str, fields: tuple[str, ...], shown: int | None = None,
                texts: tuple[str, ...] = ()) -> Any:
    """Return the type of this name with these fields, the same one each time."""
    # shown: how many of them, from the first on, text and tab completion show; None: all.
    # texts: unit and meaning of each field, for help().
    base: Any = namedtuple(name, fields)       # type: ignore[misc]  # noqa: PYI024
    for field, text in zip(fields, texts):
        getattr(base, field).__doc__ = text

    def reduce(self: Any) -> tuple[Any, ...]:
        """Return how to unpickle a record: its type is none of this module's names."""
        return restored, (name, fields, shown, texts, tuple(self))

    return type(name, (base,), {
        '__slots__': (), '__reduce__': reduce, '__module__': __name__, '_shown': fields[:shown],
        '__repr__': lambda self: short_repr(name, dict(zip(fields[:shown], self))),
        '_repr_html_': record_as_html,
        '__dir__': lambda _: ['_asdict', '_fields', '_replace', *fields[:shown]]})


def documented(record: Any, meanings: Mapping[str, Quantity], shown: int | None = None) -> Any:
    """Return a type of motions or loads whose fields say unit and meaning in ``help``."""
    known = [meanings.get(name, Quantity(name, '', '', False)) for name in record._fields]
    return record_type(record.__name__, record._fields, shown,
                       tuple([f'[{each.unit or "1"}] {each.text}' for each in known]))


def restored(name: str, fields: tuple[str, ...], shown: int | None, texts: tuple[str, ...],
             values: tuple[Any, ...]) -> Any:
    return record_type(name, fields, shown, texts)._make(values)


class NoLoads:
    """Stands for the loads of a linkage without masses."""

    def __getattr__(self, name: str) -> NoReturn:
        raise MissingBodies

    def __getitem__(self, index: object) -> NoReturn:
        raise MissingBodies


class Output(NamedTuple):
    """A coordinate that a mechanism is used for; ``ratio``: the field d output / d input."""

    coordinate: Coordinate
    ratio: str


THETA1, THETA2, THETA3, THETA4 = (Coordinate(f'theta{i}', f'omega{i}', f'alpha{i}')
                                  for i in (1, 2, 3, 4))
BETA = Coordinate('beta', 'omega_beta', 'alpha_beta')
TRAVEL = Coordinate('slide', 'slide_velocity', 'slide_acceleration')
SLOT = Coordinate('slot', 'slot_velocity', 'slot_acceleration')


class Quantity(NamedTuple):
    """A field of the motion or, if ``is_load``, of the loads, which can be asked for by name."""

    name: str
    unit: str
    text: str
    is_load: bool

    def of(self, motion: NamedFields, loads: NamedFields | NoLoads | None) -> Scalar:
        value: Scalar = getattr(loads if self.is_load else motion, self.name)
        return value


class Length(NamedTuple):
    """A length that a mechanism is given by: positive, or ``signed`` and 0 if not given."""

    name: str
    text: str
    signed: bool = False


class Link(NamedTuple):
    """A moving link."""

    name: str               # in scenes: ``bodies.NAME``
    text: str               # what it is in this mechanism: coupler, block, slider
    first_joint: str        # from which points and centres of gravity are measured: 'O1'
    length: str = ''        # name of its length, if it has two joints that turn
    turns: bool = True      # whether it needs a moment of inertia


class Joint(NamedTuple):
    """A joint as ``joint_states`` shows it."""

    # place: 'A', 'guide'; name: its default name in that message, its place if empty.
    place: str
    coordinate: Coordinate
    name: str = ''


GROUND = 'ground'      # as a link: it does not move
DRIVE = 'drive'        # of which there may be friction, besides that of joints


class Reaction(NamedTuple):
    """Action of one body on another at a joint: force along the ground axes, and couple."""

    # magnitude, x, y and couple are names of fields of the loads: f41, f41_x, f41_y.
    joint: str          # its name: letters, digits and _. A topic is named after it
    text: str           # acting and loaded body: 'ground on crank'
    magnitude: str      # [N]
    couple: str = ''    # [N m]; empty of a pin, which transmits none

    @property
    def x(self) -> str:
        return f'{self.magnitude}_x'

    @property
    def y(self) -> str:
        return f'{self.magnitude}_y'

    @property
    def symbol(self) -> str:
        """Return the symbol of the force: F41 of f41, else the name of the joint."""
        return self.magnitude.upper() if self.magnitude[1:].isdigit() else self.joint
