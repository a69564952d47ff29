# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar show --json`` beside what ``fourbar show`` prints."""
import csv
import json
from math import degrees, hypot, inf, pi, tau
import re

from fourbar_ros.cli.main import main
from fourbar_ros.dynamics import Equation, flywheel_for
from fourbar_ros.extrema import find_extrema
from fourbar_ros.scene.files import folder
from fourbar_ros.scene.scene import load
import pytest
from support.samples import more, some

CASES = [('paper', '60'), ('slides_7_6', '60'), ('slider_crank', '40'), ('cylinder', '1.5'),
         ('watt', '20'), ('engine', '30'), ('quick_return', '75')]

SCENES = sorted(file.stem for below in ('.', 'classics')
                for file in (folder() / below).glob('*.yaml'))


def said(capsys, *arguments):
    assert main(list(arguments)) == 0
    return capsys.readouterr().out


def numbers_in(found):
    """Yield all numbers of a record."""
    if isinstance(found, dict):
        found = list(found.values())
    if isinstance(found, list):
        for item in found:
            yield from numbers_in(item)
    elif isinstance(found, (int, float)):
        yield float(found)


@pytest.mark.parametrize('name, at', more(CASES[:2], CASES))
def test_every_number_that_is_printed_is_in_the_record(name, at, capsys):
    """Angles are printed in degrees with four decimals, all else with six digits or more."""
    text = said(capsys, 'show', name, '--at', at)
    line = said(capsys, 'show', name, '--at', at, '--json')
    assert line.count('\n') == 1
    found = json.loads(line)
    there = sorted(numbers_in(found))
    there += [*(degrees(value) for value in there), found['speed'] * 30.0 / pi]
    there += [hypot(*vector) for point in found['pose']['points'].values()
              for vector in point.values()]
    off_square = [abs(degrees(band['worst']) - 90.0)
                  for band in found['transmission_angles'].values()]
    strokes = [high - low for output in found['outputs'] for low, high in output['ranges']]
    places = [degrees(extremum['theta1']) for extremum in found['extrema']]
    tables = text.partition('\n')[2]          # below the path
    for word in re.findall(r'(?<![\w.^])-?\d+\.\d+(?:e[-+]?\d+)?(?![\w^])', tables):
        value, last = float(word), len(word.partition('.')[2].partition('e')[0])
        near = 10.0**-last + 1e-5 * abs(value)
        assert any(abs(value - other) <= near
                   for other in [*there, *off_square, *strokes, *places]), word
    for quantity in {extremum['quantity'] for extremum in found['extrema']}:
        assert quantity in text
    rows = [row.split() for row in text.splitlines()]
    kinds = sum(1 for row in rows if {'minimum', 'maximum', 'constant'} & set(row[:2]))
    assert kinds == len(found['extrema'])


def test_a_record_is_in_si_units_and_says_what_is_missing(capsys):
    found = json.loads(said(capsys, 'show', 'slides_7_6', '--at', '60', '--json'))
    assert found['lengths'] == {'a1': 8.0, 'a2': 14.0, 'a3': 9.0, 'a4': 17.0}
    assert found['pose']['motion']['theta1'] == pytest.approx(1.0471975511965976)
    assert found['bodies'] is None and found['pose']['loads'] is None
    assert 'loads need masses' in found['why_no_loads']
    assert found['input']['ranges'][0][1] == pytest.approx(found['toggles'][1])
    assert 'pose' not in json.loads(said(capsys, 'show', 'slides_7_6', '--json'))


def test_a_record_holds_points_and_proofs(capsys):
    found = json.loads(said(capsys, 'show', 'slider_crank', '--at', '40', '--json', '--certify'))
    assert all(extremum['proof'] for extremum in found['extrema'])
    for point in found['pose']['points'].values():
        assert {len(vector) for vector in point.values()} == {2}


def test_extrema_of_a_part_of_the_input_have_its_ends(capsys):
    found = json.loads(said(capsys, 'show', 'paper', '--from=-30', '--to', '40deg', '--json'))
    assert [degrees(x) for x in found['within']] == pytest.approx([-30.0, 40.0])
    ends = [e for e in found['extrema'] if e['quantity'] == 'omega4' and e['place'] == 'limit']
    assert {round(degrees(e['theta1'])): e['side'] for e in ends} == {330: 1, 40: -1}
    assert 'in [-0.523598776, 0.698131701] rad' in said(capsys, 'show', 'paper', '--from=-30',
                                                        '--to=40')
    for wrong, why in ((['--from', '30'], '--from, --to: one needs the other'),
                       (['--from=3mm', '--to=4'], '--from has a unit of the kind m;'),
                       (['--from=30', '--to=20'], '--from = 30.0: must be below --to')):
        assert main(['show', 'paper', *wrong]) != 0
        assert why in capsys.readouterr().err


@some('name', SCENES, ['paper', 'roberts', 'engine', 'bucket'])
def test_printed_peaks_are_the_extrema(name, tmp_path, capsys):
    """Of the drive in show and table --speeds, and of the inertia."""
    found, linkage = json.loads(said(capsys, 'show', name, '--json')), load(name).linkage
    inertia = found['inertia_at_input']
    if not linkage.has_loads:
        assert list(found['drive']) == ['mechanical_advantage']
        return
    values = [one.value for one in find_extrema(linkage, 'inertia', conditions=False)]
    assert (float(inertia['least']), float(inertia['most'])) == (min(values), max(values))
    assert (float(inertia['mean']) == inf) == (max(values) == inf)
    effort, speed = found['drive']['effort'], found['speed']
    sizes = [abs(float(one['value'])) for one in found['extrema']
             if one['quantity'] == linkage.drive_load]
    peak, rms, power = (float(effort[key]) for key in ('peak', 'root_mean_square', 'peak_power'))
    assert abs(peak) == max(sizes) and (rms == inf) == (abs(peak) == inf)
    peaks = [one for one in found['extrema'] if one['quantity'] == linkage.drive_load
             and float(one['value']) == pytest.approx(peak, rel=1e-12)]
    # the first of equal ones, of angles from 0 on as extrema are listed
    assert effort['peak_at'] == (min(float(one['slide']) for one in peaks)
                                 if linkage.is_driven_by_slide else
                                 min([float(one['theta1']) for one in peaks],
                                     key=lambda theta1: theta1 % tau))
    assert (power, effort['peak_power_at']) == (peak * speed, effort['peak_at'])
    unit, pin = effort['unit'], found['drive']['worst_pin']
    text = said(capsys, 'show', name)
    assert f'drive      peak {peak:.6g} {unit} at ' in text
    assert f', rms {rms:.6g} {unit}, peak power {power:.6g} W at ' in text
    forces = [float(one['value']) for one in found['extrema'] for reaction in linkage.REACTIONS
              if one['quantity'] == reaction.magnitude and not reaction.couple]
    assert float(pin['force']) == max(forces)
    of_load = '' if pin['load'] == pin['joint'] else f' ({pin["load"]})'
    assert f'worst pin  {pin["joint"]}{of_load} {max(forces):.6g} N at ' in text
    file, speeds = tmp_path / 'servo.csv', [f'{speed!r}'] * 2
    said(capsys, 'table', name, '--speeds', *speeds, '-o', str(file))
    _, *rows = csv.reader(file.read_text().splitlines())
    assert [float(cell) for cell in rows[-1]] == pytest.approx(
        [speed, rms, abs(peak), abs(power)], rel=1e-12)


def test_a_flywheel_for_a_fluctuation(capsys):
    asked = 'show', 'paper', '--speed', '25', '--fluctuation'
    wheel = json.loads(said(capsys, *asked, '5%', '--json'))['drive']['flywheel']
    exact = flywheel_for(Equation(load('paper').linkage), 25.0, 0.05)
    assert (wheel['most'], wheel['inertia'], wheel['torque']) == (0.05, *exact[:2])
    assert f'{exact.inertia:.6g} kg m^2 for' in said(capsys, *asked, '0.05')
    for share in ('0', '-5%', 'little', '300%'):
        with pytest.raises(SystemExit):
            main([*asked, share])


def test_a_bar_of_proof_is_there_only_if_one_is_asked_for(capsys, monkeypatch):
    """A notebook keeps what a terminal wipes out."""
    monkeypatch.setenv('FORCE_COLOR', '1')
    for words, is_there in (([], False), (['--certify'], True)):
        assert main(['show', 'motor', *words]) == 0
        assert ('proof' in capsys.readouterr().err) is is_there
