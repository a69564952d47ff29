# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Units beside their definitions, fractions of SI units and of turns; commas are no points."""
from argparse import ArgumentTypeError
from fractions import Fraction
import json
from math import pi, radians, ulp
import re

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene import from_values, load
from fourbar_ros.scene.files import SceneError
from fourbar_ros.scene.parameters import check_value, of_name, shown_unit
from fourbar_ros.scene.units import (
    in_unit,
    of,
    quantity,
    require,
    UNITS,
    wanted_units,
    WrongQuantity,
)
from hypothesis import given
from hypothesis import strategies as st
import mpmath
import pytest
from support.scenes import PAPER, PUSH, RODS

# {SI unit: {unit: (its size, power of 2 pi)}}; all other sizes are decimal
SIZES = {
    'rad': {'deg': (Fraction(1, 360), 1), 'turn': (1, 1)},
    'm': {'cm': (Fraction(1, 100), 0), 'mm': (Fraction(1, 1000), 0),
          'um': (Fraction(1, 10**6), 0), 'in': (Fraction(254, 10**4), 0)},
    'rad/s': {'deg/s': (Fraction(1, 360), 1), 'rpm': (Fraction(1, 60), 1), 'Hz': (1, 1)},
    'm/s': {'cm/s': (Fraction(1, 100), 0), 'mm/s': (Fraction(1, 1000), 0)},
    'rad/s^2': {'deg/s^2': (Fraction(1, 360), 1), 'rpm/s': (Fraction(1, 60), 1)},
    'm/s^2': {'mm/s^2': (Fraction(1, 1000), 0)},
    's': {'ms': (Fraction(1, 1000), 0), 'min': (60, 0), 'h': (3600, 0)},
    'Hz': {'kHz': (1000, 0)},
    'kg': {'g': (Fraction(1, 1000), 0), 't': (1000, 0)},
    'kg m^2': {'kg cm^2': (Fraction(1, 10**4), 0), 'kg mm^2': (Fraction(1, 10**6), 0),
               'g mm^2': (Fraction(1, 10**9), 0)},
    'kg/m^3': {'g/cm^3': (1000, 0)},
    'N': {'daN': (10, 0), 'kN': (1000, 0)},
    'N m': {'kN m': (1000, 0), 'N mm': (Fraction(1, 1000), 0)},
    'Pa': {'kPa': (1000, 0), 'MPa': (10**6, 0), 'bar': (10**5, 0)},
    'N/m': {'N/mm': (1000, 0), 'kN/m': (1000, 0)},
    'W': {'kW': (1000, 0)}, 'J': {'kJ': (1000, 0)},
    'N s/m': {'N s/mm': (1000, 0), 'kN s/m': (1000, 0)},
    'N m/rad': {'N mm/rad': (Fraction(1, 1000), 0), 'N m/deg': (360, -1),
                'N mm/deg': (Fraction(360, 1000), -1)},
    'N m s/rad': {'N mm s/rad': (Fraction(1, 1000), 0), 'N m s/deg': (360, -1)},
    'N m/A': {'mN m/A': (Fraction(1, 1000), 0)}, 'V': {'mV': (Fraction(1, 1000), 0),
                                                       'kV': (1000, 0)},
    'ohm': {'mohm': (Fraction(1, 1000), 0), 'kohm': (1000, 0)},
    'H': {'mH': (Fraction(1, 1000), 0), 'uH': (Fraction(1, 10**6), 0)},
    'MB': {'kB': (Fraction(1, 1000), 0), 'GB': (1000, 0)},
}
PUSHED = {**PAPER, **RODS, **PUSH}
CASES = [(si, unit) for si, units in UNITS.items() for unit in units]


@pytest.mark.parametrize(('si', 'unit'), CASES)
def test_a_unit_has_the_size_of_its_definition(si, unit):
    size, power = SIZES[si].get(unit, (1, 0))
    size = Fraction(size)
    with mpmath.workdps(30):
        expected = mpmath.mpf(3.7) * mpmath.mpf(size.numerator) / size.denominator
        expected = expected * (2 * mpmath.pi)**power
    value = quantity(f'3.7{unit}', si)
    # two roundings of pi and the size, one of the product, one of 3.7 here
    assert value == pytest.approx(float(expected), rel=4 * 2.0**-53, abs=0.0)
    assert value.unit == si


@given(st.sampled_from(CASES), st.floats(1e-6, 1e6))
def test_a_number_in_another_unit_is_read_as_itself(case, number):
    si, unit = case
    value = quantity(f'{number!r}{unit}', si)
    # a rounding of pi and the size each way, and of each product
    assert abs(in_unit(value, si, unit) - number) <= 6 * ulp(number)
    assert in_unit(value, si, si) == value


def test_units_to_show_are_one_for_each_kind():
    assert wanted_units('mm, °,rpm,Nmm,kg mm²') == {
        'm': 'mm', 'rad': 'deg', 'rad/s': 'rpm', 'N m': 'N mm', 'kg m^2': 'kg mm^2'}
    assert wanted_units('Hz') == {'rad/s': 'Hz'}
    for text, why in (('rpmm', 'did you mean rpm'), ('', 'no unit'), ('mm,cm', 'measure the same'),
                      ('mm;deg', 'no unit')):
        with pytest.raises(ArgumentTypeError, match=why):
            wanted_units(text)


def test_decimal_units_round_once_and_angles_of_command_lines_are_in_degrees():
    for text in ('35.35533906', '-0.1', '1e-3', '29.9', '.7', '5.'):
        assert quantity(f'{text}mm', 'm') == float(Fraction(text) / 1000)
        assert quantity(text, 'm') == float(text)
    assert [of('rad', 'm')(text) for text in ('60deg', '60', '0.5turn', '50mm')] == [
        60.0, 60.0, 180.0, 0.05]
    assert quantity('60deg', 'rad') == radians(60.0)


@pytest.mark.parametrize('text', ['', 'mm', '3 N', '1,5mm', 'nan', 'inf', '1e999', '3 mm mm',
                                  '1_0', '0x10', '\u0663', '-1e999mm'])
def test_what_is_no_number_with_a_unit_is_refused(text):
    with pytest.raises(WrongQuantity):
        quantity(text, 'm')
    with pytest.raises(ArgumentTypeError, match='must be'):
        of('m')(text)


def test_an_exponent_without_end_is_zero_at_once():
    assert quantity('1e-99999999999999999999mm', 'm') == 0.0


def test_a_unit_of_another_kind_is_named():
    require('rate', quantity('3', 'm/s', 'rad/s'), 'm/s')
    with pytest.raises(WrongQuantity, match='rate has a unit of the kind rad/s.*takes m/s'):
        require('rate', quantity('3rpm', 'm/s', 'rad/s'), 'm/s')


# --- in scenes -----------------------------------------------------------------------------------

SLIDE = {'linkage.kind': 'slider_crank', 'linkage.a1': '40mm', 'linkage.a2': '15 cm',
         'linkage.input': 'slide'}


@pytest.mark.parametrize(('values', 'name', 'expected'), [
    (PAPER, 'linkage.a1', ('400mm', 0.4)), (PAPER, 'linkage.a1', ('0.4', 0.4)),
    (PAPER, 'drive.speed', ('300rpm', 10.0 * pi)), (PAPER, 'drive.start', ('90°', 0.5 * pi)),
    (SLIDE, 'drive.speed', ('30 mm/s', 0.03)), (PAPER, 'drive.timeout', ('200ms', 0.2)),
    (SLIDE, 'linkage.range', (['12cm', '150mm'], [0.12, 0.15])),
    (PAPER, 'linkage.range', (['-90deg', 1.5], [-0.5 * pi, 1.5])),
    ({**PAPER, **RODS}, 'bodies.rods.density', ('7.85 g/cm3', 7850.0))])
def test_a_scene_takes_units_and_holds_numbers(values, name, expected):
    text, number = expected
    before = from_values(values)
    scenes = [from_values({**before.values, name: text})]
    if of_name(name).live:
        scenes.append(before.with_values({name: text}))
    for scene in scenes:
        assert scene.values[name] == json.loads(scene.as_json)[name] == number
        assert type(scene.values[name]) is type(number)


@pytest.mark.parametrize(('values', 'name', 'text', 'why'), [
    (PAPER, 'linkage.a1', '0,4', 'must be written 0.4: a comma is no decimal point'),
    (PAPER, 'linkage.a1', '4kg', 'units m, cm, mm'),
    (PAPER, 'bodies.crank.mass', '40mm', 'units kg, g, t'),
    (PAPER, 'drive.speed', '30mm/s', 'units rad/s'), (SLIDE, 'drive.speed', '60rpm', 'units m/s'),
    (PAPER, 'drive.joint_ratio', '3mm', 'without a unit'),
    (PAPER, 'joint_states.offsets', ['1deg', '2deg', '3deg', '4mm'], 'units rad, deg, turn'),
    (SLIDE, 'joint_states.offsets', ['1deg', '2mm', '3deg', '4deg'], 'in rad, or'),
    (PAPER, 'joint_states.offsets', ['1deg', '2deg', '3deg', '4kg'], 'in rad or m, or'),
    (PAPER, 'joint_states.offsets', ['1deg'], 'must be 4 numbers'),
    (PUSHED, 'forces.push.places', ['0', '9mm', '1', '2'],
     "places = '9mm': must have a unit of an angle: over is input"),
    (PUSHED, 'forces.push.places', ['0deg', '1kg', '1', '2'], 'must be a number in rad or m, or'),
    (PUSHED, 'forces.push.places', ['0deg', '0,5', '1', '2'], 'must be written 0.5: a comma'),
    (PUSHED, 'forces.push.values', ['5N', '1bar', '4', '5N'],
     "values = '1bar': the unit of the rest is N"),
    (PUSHED, 'forces.push.values', ['5N', '1N m', '4', '5N'],
     "values = '1N m': must have a unit of a force or pressure"),
    (PAPER, 'linkage.mode', '2', 'must be one of'), (PAPER, 'frame_id', 3, 'must be a text')])
def test_a_scene_refuses_units_of_other_kinds(values, name, text, why):
    with pytest.raises(InvalidParameter, match=re.escape(why)):
        from_values({**values, name: text})


@pytest.mark.parametrize(('changes', 'units'), [
    ({}, ('rad', 'N')), ({'place_unit': 'deg', 'value_unit': 'kN'}, ('deg', 'kN')),
    ({'value_unit': 'bar', 'factor': 1e-4}, ('rad', 'bar')), ({'acts': 'couple'}, ('rad', 'N m')),
    ({'over': 'theta4', 'acts': 'couple'}, ('rad', 'N m')), ({'over': 'p.x'}, ('m', 'N')),
    ({'places': ['0deg', '1deg', '2deg', '3deg']}, ('', 'N'))])
def test_a_table_is_shown_in_its_units(changes, units):
    changes = {f'forces.push.{name}': value for name, value in changes.items()}
    values = from_values({**PUSHED, 'forces.push.periodic': False, 'points.p.along': 0.1,
                          'joint_states.offsets': [0.0] * 4, **changes}).values
    assert tuple(shown_unit(f'forces.push.{column}', values)
                 for column in ('places', 'values')) == units
    assert shown_unit('joint_states.offsets', values) == 'rad or m'
    assert shown_unit('linkage.a1', values) == 'm'


@pytest.mark.parametrize(('name', 'text', 'number'), [
    ('motor.proportional', '5 kN s/m', 5000.0), ('motor.integral', '2 N/mm', 2000.0),
    ('motor.torque_constant', '3 N/A', 3.0), ('motor.stall_torque', '1 kN', 1000.0),
    ('shaft.stiffness', '2 N/mm', 2000.0)])
def test_a_motor_of_a_slide_pushes(name, text, number):
    parameter, of_slide = of_name(name), {'linkage.input': 'slide'}
    assert check_value(parameter, text, of_slide) == number
    with pytest.raises(InvalidParameter):
        check_value(parameter, text, {'linkage.input': 'crank'})


def test_offsets_of_joints_are_angles_or_lengths_by_joint():
    scene = from_values({**SLIDE, 'joint_states.offsets': ['90deg', '0', 0.25, '5mm']})
    units = [joint.coordinate.unit for joint in scene.linkage.JOINTS]
    assert units == ['rad', 'rad', 'rad', 'm']
    assert scene.joint_states.offsets == [0.5 * pi, 0.0, 0.25, 0.005]
    assert scene.values['joint_states.offsets'] == scene.joint_states.offsets


def test_a_file_with_units_is_written_in_numbers(tmp_path):
    file = tmp_path / 'scene.yaml'
    file.write_text("""/**:
  ros__parameters:
    linkage: {a1: 40mm, a2: 210 mm, a3: 7.5cm, a4: 205mm}
    bodies: {rods: {density: 7.85 g/cm³, width: 20mm, thickness: 5 mm}}
    drive: {source: torque, speed: 45rpm}
    springs:
      back: {first: {link: ground, along: 205mm}, second: {link: output, along: 60mm},
             stiffness: 5 N/mm, free_length: 60mm, damping: 0.1 N s/mm}
    torsion_springs: {t: {second: output, stiffness: 1 N·m/°}}
    external: {output: {force_x: 2 kN, couple: 5 Nm}}
    joint_states: {offsets: [90deg, 0deg, 0deg, 0deg]}
""")
    scene = load(file)
    for name, number in {'linkage.a2': 0.21, 'springs.back.stiffness': 5000.0,
                         'springs.back.damping': 100.0, 'external.output.force_x': 2000.0,
                         'bodies.rods.width': 0.02, 'drive.speed': 1.5 * pi,
                         'torsion_springs.t.stiffness': 180.0 / pi}.items():
        assert scene.values[name] == number
    file.write_text(scene.as_text)
    assert 'mm' not in scene.as_text and load(file).values == scene.values


def test_a_list_with_units_has_them_everywhere(tmp_path):
    file = tmp_path / 'scene.yaml'
    file.write_text('/**:\n  ros__parameters:\n    linkage: {range: [0, 150mm]}\n')
    with pytest.raises(SceneError, match='give all its numbers a unit, or none'):
        load(file)
