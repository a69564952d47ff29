# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Numbers with units on command lines: 50mm, 60deg, 300rpm.

>>> measured('300rpm', 'angular speed')
31.41592653589793
>>> measured('50mm', 'angle', 'length'), measured('50mm', 'angle', 'length').dimension
(0.05, 'length')

A number without a unit keeps the meaning that the argument gives it.
"""
from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Callable
from math import isfinite, pi
import re

from fourbar_ros.errors import FourBarError

DEGREE = pi / 180.0
# {dimension: {unit: its size}}; angles in degrees, as they are shown, all else in SI.
UNITS = {
    'angle': {'deg': 1.0, 'rad': 1.0 / DEGREE, 'turn': 360.0},
    'length': {'m': 1.0, 'cm': 1e-2, 'mm': 1e-3, 'um': 1e-6, 'in': 0.0254},
    'angular speed': {'rad/s': 1.0, 'deg/s': DEGREE, 'rpm': pi / 30.0, 'Hz': 2.0 * pi},
    'speed': {'m/s': 1.0, 'cm/s': 1e-2, 'mm/s': 1e-3},
    'angular acceleration': {'rad/s^2': 1.0, 'deg/s^2': DEGREE, 'rpm/s': pi / 30.0},
    'acceleration': {'m/s^2': 1.0, 'mm/s^2': 1e-3},
    'density': {'kg/m^3': 1.0, 'g/cm^3': 1e3},
    'mass': {'kg': 1.0, 'g': 1e-3},
    'time': {'s': 1.0, 'ms': 1e-3, 'min': 60.0, 'h': 3600.0},
}
NUMBER = re.compile(r'([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)')


class Measured(float):
    """A number and its dimension, a key of UNITS; empty if it came without a unit."""

    dimension = ''


class WrongUnit(FourBarError, ValueError):
    """A number has the unit of another dimension; the message says which one fits."""


def measured(text: str, *dimensions: str) -> Measured:
    """
    Return the number of a text such as ``50mm``, angles in degrees, all else in SI.

    Raises ArgumentTypeError if it is no finite number or has a unit of none of the dimensions.
    """
    units = {unit: (size, dimension) for dimension in dimensions
             for unit, size in UNITS[dimension].items()}
    match = NUMBER.fullmatch(text.strip())
    if re.fullmatch(r'[-+\d]*,\d+.*', text.strip()):
        raise ArgumentTypeError(f'{text!r} must be a number with a point: '
                                f'{text.strip().replace(",", ".", 1)}')
    if not match or match[2] and match[2] not in units:
        raise ArgumentTypeError(f'{text!r} must be a number, with or without one of the units '
                                + ', '.join(units))
    size, dimension = units.get(match[2], (1.0, ''))
    value = Measured(float(match[1]) * size)
    if not isfinite(value):
        raise ArgumentTypeError(f'{text!r} must be a finite number')
    value.dimension = dimension
    return value


def of(*dimensions: str) -> Callable[[str], Measured]:
    """Return the ``type=`` of an argument with one of these dimensions."""
    return lambda text: measured(text, *dimensions)


def require(name: str, value: float, dimension: str) -> None:
    """Raise WrongUnit if a :class:`Measured` number has a unit of another dimension."""
    own = getattr(value, 'dimension', '')
    if own not in ('', dimension):
        raise WrongUnit(f'{name} has a unit of {own}; this mechanism takes {dimension}, in '
                        + ', '.join(UNITS[dimension]))
