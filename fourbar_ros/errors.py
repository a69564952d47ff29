# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of the core: one base class, one class per reason, the values kept as attributes."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any

LINE = 100        # characters of a list of names in a message of one line


def nearest(name: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """
    Return what to add to a message about an unknown name.

    The nearest known one, or all of them, or of many the nearest few.
    """
    from difflib import get_close_matches

    known = list(known)
    close = get_close_matches(name, known, 1, cutoff)
    if close:
        return f'; did you mean {close[0]}?'
    if len(', '.join(known)) <= LINE:
        return f'; known: {", ".join(known)}'
    return f'; nearest: {", ".join(get_close_matches(name, known, 3, 0.0))}'


def one_of(choices: Iterable[str], given: object = '', some: bool = False) -> str:
    """Return what must be given, as text: all choices, of many the nearest to what was given."""
    choices = [choice or "''" for choice in choices]
    text = ', '.join(choices)
    which = 'some' if some else 'one'
    if len(text) <= LINE:
        return f'must be {which} of {text}'
    return f'must be {which} of {len(choices)} words{nearest(str(given), choices)}'


class FourBarError(Exception):
    """Base of every error this package raises on purpose; they pass from process to process."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (type(self), self.args, self.__dict__)


def _unpickled(kind: type[FourBarError], args: tuple[Any, ...], kept: dict[str, Any]
               ) -> FourBarError:
    """
    Return an error that was pickled, without calling ``__init__``.

    Its arguments are other ones than ``args``.
    """
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(kept)
    return error


class InvalidParameter(FourBarError, ValueError):
    """A parameter has a value that is not allowed; ``name``, ``value``, ``allowed`` are kept."""

    def __init__(self, name: str, value: Any, allowed: str):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f'{name}: {allowed}' if value is None
                         else f'{name} = {_short(value)}: {allowed}')


def _short(value: Any) -> str:
    """
    Return a value as text.

    Numbers as they are, long ones (arrays) on one line with their middle left out.
    """
    text = ' '.join(repr(value).split())
    return text if len(text) <= 100 else f'{text[:60]} ... {text[-30:]}'


def in_words(ranges: Iterable[tuple[float, float]], unit: str) -> str:
    """Return the ranges of an input as text."""
    return f'{" or ".join(f"[{low:.9g}, {high:.9g}]" for low, high in ranges)} {unit}'


class OutOfRange(FourBarError, ValueError):
    """
    The mechanism cannot be assembled at the given input.

    Its ``name``, ``value``, ``ranges`` are kept.
    """

    def __init__(self, name: str, value: float, ranges: Iterable[tuple[float, float]], unit: str):
        self.name, self.value, self.ranges = name, value, ranges
        super().__init__(f'{name} = {value!r} {unit} is outside the input range '
                         f'{in_words(ranges, unit)}')


class Toggle(FourBarError, ArithmeticError):
    """
    The dyad is in line, so that rates and loads are unbounded.

    ``name`` and ``value`` of the input are kept, and the name of the ``dyad`` of a machine.
    """

    def __init__(self, name: str, value: float, unit: str, dyad: str = ''):
        self.name, self.value, self.dyad = name, value, dyad
        of = f' of dyad {dyad}' if dyad else ''
        super().__init__(f'{name} = {value!r} {unit} is a toggle position{of}: rates and loads '
                         'are unbounded')


class MissingBodies(FourBarError, ValueError):
    """Loads were requested from a mechanism without masses."""

    def __init__(self) -> None:
        super().__init__('loads require mass properties: construct the mechanism with bodies=...')


class BagError(FourBarError):
    """A bag cannot be written or read; the message says which and why."""
