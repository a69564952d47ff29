# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Units beside their definitions, exact fractions of SI units and of turns."""
from argparse import ArgumentTypeError
from fractions import Fraction

from fourbar_ros.scene.units import measured, require, UNITS, WrongUnit
import mpmath
import pytest

# {dimension: {unit: (its size, whether times 2 pi)}}; of angles the size in degrees
SIZES = {
    'angle': {'deg': (1, 0), 'turn': (360, 0)},
    'length': {'m': (1, 0), 'cm': (Fraction(1, 100), 0), 'mm': (Fraction(1, 1000), 0),
               'um': (Fraction(1, 10**6), 0), 'in': (Fraction(254, 10**4), 0)},
    'angular speed': {'rad/s': (1, 0), 'deg/s': (Fraction(1, 360), 1),
                      'rpm': (Fraction(1, 60), 1), 'Hz': (1, 1)},
    'speed': {'m/s': (1, 0), 'cm/s': (Fraction(1, 100), 0), 'mm/s': (Fraction(1, 1000), 0)},
    'angular acceleration': {'rad/s^2': (1, 0), 'deg/s^2': (Fraction(1, 360), 1),
                             'rpm/s': (Fraction(1, 60), 1)},
    'acceleration': {'m/s^2': (1, 0), 'mm/s^2': (Fraction(1, 1000), 0)},
    'density': {'kg/m^3': (1, 0), 'g/cm^3': (1000, 0)},
    'mass': {'kg': (1, 0), 'g': (Fraction(1, 1000), 0)},
    'time': {'s': (1, 0), 'ms': (Fraction(1, 1000), 0), 'min': (60, 0), 'h': (3600, 0)},
}
CASES = [(dimension, unit) for dimension, units in UNITS.items() for unit in units]


@pytest.mark.parametrize(('dimension', 'unit'), CASES)
def test_a_unit_has_the_size_of_its_definition(dimension, unit):
    if (dimension, unit) == ('angle', 'rad'):
        expected = 180 / mpmath.pi
    else:
        size, times_turn = SIZES[dimension][unit]
        with mpmath.workdps(30):
            expected = mpmath.mpf(size.numerator) / size.denominator
            expected = expected * 2 * mpmath.pi if times_turn else expected
    value = measured(f'3{unit}', dimension)
    # two roundings of the size, one of the product
    assert value == pytest.approx(float(3 * expected), rel=3 * 2.0**-53, abs=0.0)
    assert value.dimension == dimension


@pytest.mark.parametrize('text', ['', 'mm', '3 N', '1,5mm', 'nan', '1e999', '3 mm mm'])
def test_what_is_no_number_with_a_unit_is_refused(text):
    with pytest.raises(ArgumentTypeError):
        measured(text, 'length')


def test_a_unit_of_another_dimension_is_named():
    require('rate', measured('3', 'speed', 'angular speed'), 'speed')
    with pytest.raises(WrongUnit, match='rate has a unit of angular speed.*takes speed'):
        require('rate', measured('3rpm', 'speed', 'angular speed'), 'speed')
