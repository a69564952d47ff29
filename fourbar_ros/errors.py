# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of the core: one base class, one class per reason, the values kept as attributes."""
from collections.abc import Iterable
from typing import Any

LINE = 100        # longest list of names or value [characters] that a one-line message quotes


def nearest(name: str, known: Iterable[str]) -> str:
    """
    Return a hint that ends a message about an unknown name, as '; did you mean omega4?'.

    It gives the known name that differs by small and capital letters alone or is at most two edits
    away, fewer than half of its letters; if there is none, all known names if they fill no more
    than a line, or up to three that have the name in them or are in it.
    """
    known = list(known)
    distance, close = min(((0 if each.lower() == name.lower() else edits(name, each), each)
                           for each in known), default=(0, ''))
    if close and 2 * distance < len(close) and distance <= 2:
        return f'; did you mean {close}?'
    if len(', '.join(known)) <= LINE:
        return f'; known: {", ".join(known)}'
    alike = [each for each in known if len(name) >= 4 and name in each
             or len(each) >= 4 and each in name]
    return f'; there is {", ".join(alike[:3])}' if alike else ''


def edits(first: str, second: str) -> int:
    """
    Return how many letters must be put in, left out, changed or swapped with the next.

    It is the optimal string alignment distance: rows[i][j] is that of first[:i] and second[:j].
    """
    rows = [list(range(len(second) + 1))]
    for i, letter in enumerate(first, 1):
        row = [i]
        for j, wanted in enumerate(second, 1):
            row.append(min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (letter != wanted)))
            if i > 1 < j and letter == second[j - 2] and first[i - 2] == wanted:
                row[j] = min(row[j], rows[-2][j - 2] + 1)
        rows.append(row)
    return rows[-1][-1]


def one_of(choices: Iterable[str], value: object = '', some: bool = False) -> str:
    """
    Return the end of an error message, as 'must be one of timer, motion, torque'.

    Of choices that would fill more than a line it names only those spelt most like ``value``.
    ``some``: the parameter is a list of choices.
    """
    choices = [choice or "''" for choice in choices]
    text, which = ', '.join(choices), 'some' if some else 'one'
    if len(text) <= LINE:
        return f'must be {which} of {text}'
    return f'must be {which} of {len(choices)} words{nearest(str(value), choices)}'


class FourBarError(Exception):
    """Base of every error this package raises on purpose."""

    def __reduce__(self) -> tuple[Any, ...]:
        """
        Pickle an error, which a worker process sends to its parent.

        The default would call ``__init__`` with ``args``, the message; subclasses take others.
        """
        return type(self).__new__, (type(self), *self.args), self.__dict__


class InvalidParameter(FourBarError, ValueError):
    """A parameter has a value that is not allowed; ``name``, ``value``, ``allowed`` are kept."""

    def __init__(self, name: str, value: Any, allowed: str):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f'{name}: {allowed}' if value is None
                         else f'{name} = {_short(value)}: {allowed}')


SPRING_ENDS_MEET = 'the ends of a spring meet there: it has no direction'


class UnknownForce(InvalidParameter):
    """A spring or a user's force has no value at an input, so there are no loads there."""


def _short(value: Any) -> str:
    """Return a value as text of one line; long text, as of an array, loses its middle."""
    text = ' '.join(repr(value).split())
    return text if len(text) <= LINE else f'{text[:60]} ... {text[-30:]}'


def in_words(ranges: Iterable[tuple[float, float]], unit: str) -> str:
    """Return the ranges of an input as text, '[0.5, 1.2] or [2, 3] rad'."""
    return f'{" or ".join(f"[{low:.9g}, {high:.9g}]" for low, high in ranges)} {unit}'


class OutOfRange(FourBarError, ValueError):
    """The mechanism cannot be assembled at an input; keeps its ``name``, ``value``, ``ranges``."""

    def __init__(self, name: str, value: float, ranges: Iterable[tuple[float, float]], unit: str):
        self.name, self.value, self.ranges = name, value, ranges
        super().__init__(f'{name} = {value!r} {unit} is outside the input range '
                         f'{in_words(ranges, unit)}')


class Toggle(FourBarError, ArithmeticError):
    """
    The links of a dyad are in line, so rates and loads are unbounded.

    It keeps ``name`` and ``value`` of the input, and which ``dyad`` of a machine it is.
    """

    def __init__(self, name: str, value: float, unit: str, dyad: str = ''):
        self.name, self.value, self.dyad = name, value, dyad
        of = f' of dyad {dyad}' if dyad else ''
        super().__init__(f'{name} = {value!r} {unit} is a toggle position{of}: rates and loads '
                         'are unbounded')


class Locked(FourBarError, ArithmeticError):
    """
    The mechanism locks itself by friction: no drive moves it, whatever its torque.

    It keeps ``name`` and ``value`` of the input, and the ``joints`` that lock together.
    """

    def __init__(self, name: str, value: float, unit: str, joints: Iterable[str]):
        self.name, self.value, self.joints = name, value, tuple(joints)
        super().__init__(f'{name} = {value!r} {unit}: the mechanism locks itself by friction at '
                         f'{", ".join(self.joints)}: no drive moves it, so it has no loads')


class MissingBodies(FourBarError, ValueError):
    """Loads were requested from a mechanism without masses."""

    def __init__(self) -> None:
        super().__init__('loads need masses: of a scene bodies.* or bodies.rods, in Python '
                         'bodies=...; without them ask for the motion alone')


class UnknownBaseMotion(FourBarError, ValueError):
    """Loads were requested from a mechanism on a base whose motion comes from a topic."""

    def __init__(self) -> None:
        super().__init__('the motion of the base comes from a topic (base.topic): no loads but '
                         'those that the node publishes, or of loads(..., base=Base(...)) in '
                         'Python')


class SceneWarning(UserWarning):
    """A scene has a value that is allowed but probably not meant, as a crank of 50 m."""


class BagError(FourBarError):
    """A bag cannot be written or read; the message says which and why."""


class NameTaken(BagError):
    """A new bag has the name of what is there already."""
