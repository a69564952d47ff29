# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Numbers with units, as 50mm, 60deg, 300rpm: in scene files, on command lines, in ROS parameters.

>>> quantity('300rpm', 'rad/s')
31.41592653589793
>>> quantity('50 mm', 'rad', 'm'), quantity('50 mm', 'rad', 'm').unit
(0.05, 'm')

A number without a unit is in SI; on command lines, :func:`of`, an angle without one is in degrees.
"""
from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal
from fractions import Fraction
from math import inf, isfinite, pi
import re
from typing import TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter, nearest

if TYPE_CHECKING:       # no numpy for a command line
    from fourbar_ros.numerics.arrays import Value

DEGREE = pi / 180.0
# {SI unit: {unit: its size in SI}}; decimal sizes are texts, as a number times one is rounded once
UNITS: dict[str, dict[str, str | float]] = {
    'rad': {'rad': '1', 'deg': DEGREE, 'turn': 2.0 * pi},
    'm': {'m': '1', 'cm': '1e-2', 'mm': '1e-3', 'um': '1e-6', 'in': '0.0254'},
    'rad/s': {'rad/s': '1', 'deg/s': DEGREE, 'rpm': pi / 30.0, 'Hz': 2.0 * pi},
    'm/s': {'m/s': '1', 'cm/s': '1e-2', 'mm/s': '1e-3'},
    'rad/s^2': {'rad/s^2': '1', 'deg/s^2': DEGREE, 'rpm/s': pi / 30.0},
    'm/s^2': {'m/s^2': '1', 'mm/s^2': '1e-3'},
    's': {'s': '1', 'ms': '1e-3', 'min': '60', 'h': '3600'},
    'Hz': {'Hz': '1', 'kHz': '1e3'},
    'kg': {'kg': '1', 'g': '1e-3', 't': '1e3'},
    'kg m^2': {'kg m^2': '1', 'kg cm^2': '1e-4', 'kg mm^2': '1e-6', 'g mm^2': '1e-9'},
    'kg/m^3': {'kg/m^3': '1', 'g/cm^3': '1e3'},
    'N': {'N': '1', 'daN': '10', 'kN': '1e3'},
    'N m': {'N m': '1', 'kN m': '1e3', 'N mm': '1e-3'},
    'W': {'W': '1', 'kW': '1e3'},
    'J': {'J': '1', 'kJ': '1e3'},
    'Pa': {'Pa': '1', 'kPa': '1e3', 'MPa': '1e6', 'bar': '1e5'},
    'N/m': {'N/m': '1', 'N/mm': '1e3', 'kN/m': '1e3'},
    'N s/m': {'N s/m': '1', 'N s/mm': '1e3', 'kN s/m': '1e3'},
    'N m/rad': {'N m/rad': '1', 'N mm/rad': '1e-3', 'N m/deg': 1.0 / DEGREE,
                'N mm/deg': 1e-3 / DEGREE},
    'N m s/rad': {'N m s/rad': '1', 'N mm s/rad': '1e-3', 'N m s/deg': 1.0 / DEGREE},
    'N m/A': {'N m/A': '1', 'mN m/A': '1e-3'},
    'V': {'V': '1', 'mV': '1e-3', 'kV': '1e3'},
    'ohm': {'ohm': '1', 'mohm': '1e-3', 'kohm': '1e3'},
    'H': {'H': '1', 'mH': '1e-3', 'uH': '1e-6'},
    'MB': {'MB': '1', 'kB': '1e-3', 'GB': '1e3'},
}
# kg/m3 and kg/m³ are kg/m^3, Nm is N m, 60° is 60deg
SPELLINGS = str.maketrans({' ': '', '^': '', '*': '', '·': '', '²': '2', '³': '3', 'µ': 'u',
                           '°': 'deg', 'Ω': 'ohm'})
NUMBER = re.compile(r'([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)\s*(.*)')
COMMA = re.compile(r'[-+]?[0-9]*,[0-9]+.*')
THOUSANDS = re.compile(r'[-+]?[1-9][0-9]{0,2}(,[0-9]{3})+([^0-9,][^,]*)?')


class ValueInSI(float):
    """A value in SI and its SI unit, a key of UNITS; empty if the text had no unit."""

    unit = ''


class WrongQuantity(FourBarError, ValueError):
    """A text is no number, or has the unit of something else; the message says what is allowed."""


def units_of(unit: str) -> dict[str, str | float]:
    """Return {unit: its size} of all units that measure the same as an SI unit, that included."""
    return UNITS.get(unit, {unit: '1'})


def spelled(text: str, units: Iterable[str]) -> str:
    """Return which of the units a text spells, as Nm spells N m; empty if none."""
    return next((unit for unit in units
                 if unit.translate(SPELLINGS) == text.translate(SPELLINGS)), '')


def quantity(text: str, *units: str, plain_angle: str = 'rad') -> ValueInSI:
    """
    Return the number of a text such as ``50mm`` in SI, or an angle in ``plain_angle`` (rad, deg).

    ``units``: SI units of what is allowed, 'm' for a length. Raises WrongQuantity if the text is
    no finite number or has a unit of something else.
    """
    sizes = {unit.translate(SPELLINGS): (size, si) for si in units
             for unit, size in units_of(si).items()}
    text = text.strip()
    match = NUMBER.fullmatch(text)
    if COMMA.fullmatch(text):
        raise WrongQuantity(without_comma(text))
    digits, unit = match.groups() if match else ('nan', '')
    size, si = sizes.get(unit.translate(SPELLINGS), ('1', '')) if unit else ('1', '')
    if not match or unit and not si:
        allowed = ', '.join(unit for si in units for unit in units_of(si))
        plain = ' or '.join(plain_angle if si == 'rad' else si for si in units)
        raise WrongQuantity(f'must be a number in {plain}, or with one of the units {allowed}'
                            if units else 'must be a number without a unit')
    if si == 'rad' and plain_angle == 'deg':
        size = float(size) / DEGREE
    value = ValueInSI(Decimal(repr(float(digits))) * Decimal(size))
    if not isfinite(value):
        raise WrongQuantity('must be a finite number')
    value.unit = si
    return value


def without_comma(text: str) -> str:
    """Return how a number with a comma, of decimals or of thousands, must be written."""
    decimal = text.replace(',', '.')
    if not THOUSANDS.fullmatch(text):
        return f'must be written {decimal}: a comma is no decimal point'
    ways = [text.replace(',', ''), *([decimal] if text.count(',') == 1 else [])]
    return f'must be written {" or ".join(ways)}, without a comma'


def of(*units: str, above: float = -inf, least: float = -inf) -> Callable[[str], ValueInSI]:
    """
    Return the ``type=`` of an argument: numbers in one of these SI units, angles in degrees.

    They must be more than ``above`` and at least ``least``.
    """
    def read(text: str) -> ValueInSI:
        try:
            value = quantity(text, *units, plain_angle='deg')
        except WrongQuantity as error:
            raise ArgumentTypeError(f'{text!r} {error}') from None
        if not value > above:
            raise ArgumentTypeError(f'{text!r} must be a positive number')
        if not value >= least:
            raise ArgumentTypeError(f'{text!r} must be a number that is not negative')
        return value
    return read


def require(name: str, value: float, unit: str) -> None:
    """Raise WrongQuantity if a :class:`ValueInSI` has a unit that does not measure the same."""
    si = getattr(value, 'unit', '')
    if si not in ('', unit):
        raise WrongQuantity(f'{name} has a unit of the kind {si}; this mechanism takes '
                            + ', '.join(units_of(unit)))


def wanted_units(text: str) -> dict[str, str]:
    """
    Return {SI unit: unit in which to show what measures the same} of a text as ``mm,deg,N mm``.

    It is the ``type=`` of ``--units``.
    """
    kinds = {unit.translate(SPELLINGS): (si, unit)      # of Hz the first kind counts, a speed
             for si, units in reversed(UNITS.items()) for unit in units}
    wanted: dict[str, str] = {}
    for word in text.split(','):
        si, unit = kinds.get(word.translate(SPELLINGS), ('', ''))
        if not si:
            known = [unit for units in UNITS.values() for unit in units]
            raise ArgumentTypeError(f'{word!r} is no unit'
                                    + (nearest(word, known)
                                       or '; docs/reference_desk.md lists all'))
        if wanted.setdefault(si, unit) != unit:
            raise ArgumentTypeError(f'{wanted[si]} and {unit} measure the same: name one')
    return wanted


def require_columns(wanted: Mapping[str, str], kinds: Iterable[str]) -> None:
    """
    Raise InvalidParameter if no unit is of a column; ``kinds``: SI units of the columns.

    ``wanted``: {SI unit: unit}. One list may serve many tables: 'mm,N' where only forces are.
    """
    kinds = dict.fromkeys(filter(None, kinds))
    if wanted and not wanted.keys() & kinds.keys():
        raise InvalidParameter('units', ','.join(wanted.values()), 'is of no column: they ' + (
            f'are in {", ".join(kinds)}, or in units of these' if kinds else 'have no units'))


def in_unit(values: Value, si: str, unit: str) -> Value:
    """Return values in SI in another unit that measures the same; decimal ones round once."""
    size = '1' if unit == si else UNITS[si][unit]
    if isinstance(size, float):
        return values * (1.0 / size)
    share = Fraction(size)
    return values * share.denominator / share.numerator
