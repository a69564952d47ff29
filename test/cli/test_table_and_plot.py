# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a person reads in tables, plots, show and new: units, whole degrees, left-out weight."""
import csv
from fractions import Fraction
import io
import json
from math import isnan, radians, tau
import subprocess
import sys

from fourbar_lab.drawing.curves import (
    curves_of,
    extrema_of,
    make_figure,
    marks_of,
    rows_of,
)
from fourbar_lab.drawing.record import drive_of
from fourbar_lab.drawing.tables import facts
from fourbar_ros import find_extrema, load_scene, point_motion
from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.spreadsheet import CsvStyle
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

NEW = ['--a1', '60mm', '--a2', '200mm', '--a3', '15cm', '--bar', '20x5mm']


def test_a_table_has_whole_degrees_and_units():
    paper = load_scene('paper')
    text = CsvStyle().text(*rows_of(curves_of(paper, paper.linkage, (), paper.drive.speed)))
    head, *rows = csv.reader(text.splitlines())
    assert [row[0] for row in rows] == [f'{degrees}.0' for degrees in range(361)]
    assert all(name.endswith(']') for name in head) and head[0] == 'theta1 [deg]'


# {unit: (column of `slider_crank` in SI, size of the unit)}
SHOWN = {'mm': ('slide [m]', Fraction(1, 1000)),
         'cm/s': ('slide_velocity [m/s]', Fraction(1, 100)),
         'kN': ('f41 [N]', Fraction(1000)), 'N mm': ('driving_torque [N m]', Fraction(1, 1000)),
         'm/s^2': ('slide_acceleration [m/s^2]', Fraction(1))}
NAMES = [column.partition(' ')[0] for column, _ in SHOWN.values()]


@pytest.fixture
def printed(capfdbinary):
    """Return a function: options of `fourbar table slider_crank` -> what it prints."""
    def printed(*options):
        assert main(['table', 'slider_crank', *NAMES, *options, '-o', '-']) == 0
        return capfdbinary.readouterr().out.decode()
    return printed


@pytest.mark.parametrize('words', [
    'theta4 f41 -o - --samples 3', '-o - theta4 f41 --samples 3', '-o - --samples 3 theta4 f41',
    'theta4 -o - --samples 3 f41', '--samples 3 -o - theta4 f41'])
def test_quantities_stand_before_and_behind_options(words, capfdbinary):
    assert main(['table', 'paper', *words.split()]) == 0
    head, *rows = capfdbinary.readouterr().out.decode().splitlines()
    assert (head, len(rows)) == ('theta1 [deg],theta4 [deg],f41 [N]', 3)


def test_a_table_in_other_units_holds_the_same_quantities(printed):
    si = list(csv.DictReader(io.StringIO(printed())))
    rows = list(csv.DictReader(io.StringIO(printed('--units', f'{",".join(SHOWN)},turn'))))
    assert len(si) == len(rows) == 361
    assert [*rows[0]] == ['theta1 [turn]', *(f'{column.partition(" ")[0]} [{unit}]'
                                             for unit, (column, _) in SHOWN.items())]
    for before, row in zip(si, rows):
        for unit, (column, size) in SHOWN.items():
            number = float(row[f'{column.partition(" ")[0]} [{unit}]'])
            assert number == float(Fraction(float(before[column])) / size)
        turn = float(row['theta1 [turn]'])
        assert abs(turn - float(before['theta1 [deg]']) / 360.0) <= 4 * 2.0**-53


@pytest.mark.parametrize('digits', [1, 6, 17])
def test_digits_are_significant_ones_and_excel_has_decimal_commas(printed, digits):
    every = list(csv.reader(io.StringIO(printed())))
    some = printed('--digits', str(digits))
    excel = printed('--digits', str(digits), '--excel')
    assert excel[0] == '\ufeff' and '\ufeff' not in some and '\r' not in some
    assert ',' in excel and ';' not in some and '.' not in excel.partition('\n')[2]
    rows = list(csv.reader(io.StringIO(some)))
    assert list(csv.reader(io.StringIO(excel[1:].replace(',', '.')), delimiter=';')) == rows
    for whole, row in zip(every[1:], rows[1:]):
        for number, text in zip(map(float, whole), row):
            assert len(text.lstrip('-').partition('e')[0].replace('.', '').lstrip('0')) <= digits
            # half a unit of the last digit
            assert abs(float(text) - number) <= 0.5 * 10.0**(1 - digits) * abs(number)


def test_of_what_is_not_known_excel_has_an_empty_cell():
    rows = [[1.5, float('nan'), float('inf'), 12345678901234567, 'a;b']]
    assert CsvStyle(3, True).text('vwxyz', rows).splitlines() == [
        '\ufeffv;w;x;y;z', '1,5;;inf;12345678901234567;"a;b"']
    assert CsvStyle().text('vwxyz', rows).splitlines()[1] == '1.5,nan,inf,12345678901234567,a;b'
    assert isnan(rows[0][1])


def test_a_file_for_excel_is_what_is_printed(printed, tmp_path):
    file, options = tmp_path / 'it.csv', ['--units', 'mm', '--digits', '5', '--excel']
    text = printed(*options)
    assert main(['table', 'slider_crank', *NAMES, *options, '-o', str(file)]) == 0
    assert file.read_bytes() == text.replace('\n', '\r\n').encode()


def test_a_reader_that_ends_early_is_no_error():
    """More than a pipe holds."""
    verb = subprocess.Popen([sys.executable, '-m', 'fourbar_ros', 'table', 'paper', '-o', '-'],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert verb.stdout.readline().startswith(b'theta1 [deg],')
    verb.stdout.close()
    assert verb.stderr.read() in (b'', b'weight: left out (gravity 0)\n')
    assert verb.wait() == 0


def test_a_table_over_speeds_sizes_a_servo(tmp_path, capsys):
    file = tmp_path / 'servo.csv'
    assert not main(['table', 'paper', '--speeds', '0', '600rpm', '-o', str(file)])
    head, *rows = csv.reader(file.read_text().splitlines())
    assert head == ['speed [rad/s]', 'root_mean_square [N m]', 'peak [N m]', 'peak_power [W]']
    speed, mean, peak, power = map(float, rows[-1])
    assert len(rows) == 25 and speed == pytest.approx(radians(3600.0))
    torques = load_scene('paper').linkage.loads(np.radians(np.arange(0.25, 360.0, 0.5)),
                                                speed).driving_torque
    # 4550.89 N m by attack from outside: half a degree's samples give 4550.43
    assert (mean, peak) == pytest.approx((np.sqrt(np.mean(torques**2)), 4550.892314569))
    assert 0.9998 * peak < np.abs(torques).max() < peak
    assert power == pytest.approx(speed * peak)
    assert 'weight: left out' in capsys.readouterr().err
    for given, why in ((['f41', 'f21', '--speeds', '0', '1'], 'with quantities (f41, f21)'),
                       (['--speeds', '0', '1e200'], 'overflow'),
                       (['--speeds', '0', '1m/s'], 'speeds has a unit of the kind m/s')):
        assert main(['table', 'paper', *given, '--force', '-o', str(file)])
        assert why in capsys.readouterr().err
    assert not main(['table', 'paper', '--speeds', '0', '600rpm', '--units', 'rpm,N mm,kW',
                     '--digits', '6', '-o', '-'])
    head, *_, last = csv.reader(capsys.readouterr().out.splitlines())
    assert head == ['speed [rpm]', 'root_mean_square [N mm]', 'peak [N mm]', 'peak_power [kW]']
    assert last == ['600', f'{1e3 * mean:.6g}', f'{1e3 * peak:.6g}', f'{1e-3 * power:.6g}']


def test_a_picture_has_the_units_asked_for(tmp_path):
    """Curves, marks of extrema and the turns of the input; its title has both speeds."""
    scene = load_scene('slider_crank')
    linkage, speed, units = scene.linkage, scene.drive.speed, {'rad': 'turn', 'm': 'mm', 'N': 'kN'}
    names = ['slide', 'f41']
    in_si, curves = (curves_of(scene, linkage, names, speed, shown_units=shown)
                     for shown in ({}, units))
    assert curves.units == ('turn', 'mm', 'kN') and curves.period == pytest.approx(1.0)
    assert curves.values == pytest.approx(
        in_si.values * [[0.5 / np.pi], [1e3], [1e-3]], rel=1e-15)
    assert curves.title.endswith(f'{speed:g} rad/s ({speed * 30.0 / np.pi:.6g} rpm)')
    marks = marks_of(linkage, extrema_of(scene, linkage, names, speed), units)
    figure = make_figure(curves, marks)
    assert [axis.get_ylabel() for axis in figure.axes] == ['position [mm]', 'force [kN]']
    for axis in figure.axes:
        line, dots = axis.lines
        assert dots.get_ydata().max() == pytest.approx(line.get_ydata().max(), rel=1e-4)
    file = tmp_path / 'it.svg'
    assert not main(['plot', 'slider_crank', *names, '--units', 'mm,kN', '-o', str(file)])
    assert file.exists()


def test_the_drive_of_a_four_stroke_is_that_of_both_turns(tmp_path, capsys):
    """By quadrature of Gauss and a bounded search in each piece of its table of gas forces."""
    linkage, speed = load_scene('engine').linkage, 100.0
    gas, = linkage.elements
    assert linkage.turns == 2

    def torque(x):
        return linkage.loads(x, speed).driving_torque
    ends = np.array(gas.value.table.places)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(ends)[:, None]
    inputs = ends[:-1, None] + half * (1.0 + nodes)
    square = np.sum(half * weights * torque(inputs)**2)
    piece = np.argmax(np.abs(torque(inputs)).max(axis=1))
    peak = max(-minimize_scalar(lambda x: -abs(torque(float(x))), method='bounded',
                                bounds=(ends[i], ends[i + 1]), options={'xatol': 1e-10}).fun
               for i in range(piece - 1, piece + 2))
    found = drive_of(linkage, speed)['effort']
    assert found['root_mean_square'] == pytest.approx(np.sqrt(square / (ends[-1] - ends[0])),
                                                      rel=1e-9)
    assert abs(found['peak']) == pytest.approx(peak, rel=1e-12)
    assert torque(found['peak_at']) == pytest.approx(found['peak'], rel=1e-9)
    file = tmp_path / 'servo.csv'
    assert not main(['table', 'engine', '--speeds', '0', '1', '-o', str(file)])
    assert 'samples' not in file.read_text()
    capsys.readouterr()
    assert not main(['show', 'engine', '--speed', '100', '--json'])
    record = json.loads(capsys.readouterr().out)
    work = np.sum(half * weights * torque(inputs))
    assert record['drive']['cycle']['work'] == pytest.approx(work, rel=1e-9)
    assert record['drive']['cycle']['mean_power'] == pytest.approx(
        work / (ends[-1] - ends[0]) * speed, rel=1e-9)
    for one in record['extrema']:           # in which of both turns it is
        if one['quantity'] == 'driving_torque':
            assert torque(one['theta1']) == pytest.approx(one['value'], rel=1e-9)


def test_dots_of_a_four_stroke_lie_on_its_curves():
    engine = load_scene('engine')
    given = engine, engine.linkage, ['f41', 'driving_torque'], 100.0
    curves, marks = curves_of(*given), marks_of(engine.linkage, extrema_of(*given))
    assert max(x for _, x, _ in marks) > 360.0
    figure = make_figure(curves, marks)
    for axis in figure.axes:
        line, *dots = axis.lines
        height = np.ptp(line.get_ydata())
        for x, y in [point for dot in dots for point in zip(dot.get_xdata(), dot.get_ydata())]:
            assert abs(np.interp(x, line.get_xdata(), line.get_ydata()) - y) <= 0.02 * height


def test_a_table_names_peaks_between_its_rows(tmp_path, capsys):
    """Of the press: its cut begins between two rows, which stay a degree apart."""
    file = tmp_path / 'press.csv'
    given = ['--force', '-o', str(file)]
    effort = drive_of(load_scene('press').linkage, 3.0 * np.pi)['effort']
    peak, at = f'{effort["peak"]:.6g}', f'{np.degrees(effort["peak_at"]):.6g}'
    assert not main(['table', 'press', 'driving_torque', 'slide', *given])
    assert capsys.readouterr().err.splitlines() == [
        'larger than in any row, beside a jump of the loads (see fourbar show): '
        f'driving_torque {peak} N m at {at} deg']
    _, *rows = csv.reader(file.read_text().splitlines())
    assert [float(row[0]) for row in rows] == list(range(361))
    assert max(float(row[1]) for row in rows) < 0.999 * effort['peak']
    assert not main(['table', 'press', *given])
    assert capsys.readouterr().err.endswith(' more\n')
    for quiet in (['slide'], ['--speeds', '1', '2']):
        assert not main(['table', 'press', *quiet, *given])
        assert capsys.readouterr().err == ''


def test_a_picture_draws_jumps_upright_and_names_scene_and_torque(tmp_path, capsys, monkeypatch):
    """Each mark lies on the curve, those on both sides of a jump too; the slope is vertical."""
    drawn = []
    monkeypatch.setattr('fourbar_lab.drawing.figure.save',
                        lambda figure, path: drawn.append(figure) or path)
    assert not main(['plot', 'press', 'driving_torque', '-o', str(tmp_path / 'press.png')])
    axis, = drawn[0].axes
    line, dots = axis.lines
    assert line.get_label() == 'driving torque $T_{41}$'
    assert any('press: slider-crank' in text.get_text()
               for text in (axis.title, *drawn[0].texts, *filter(None, [drawn[0]._suptitle])))
    x, y = line.get_data()
    steps = np.abs(np.diff(y))
    assert np.diff(x)[steps.argmax()] < 1e-6 and steps.max() > 50.0
    for at, value in zip(*dots.get_data()):
        near = np.abs(x - at) <= 1.0        # a row, and both values beside a jump
        assert np.abs(y[near] - value).min() <= 1e-3 * np.ptp(y)


def test_a_machine_names_the_dyad_that_stops_it():
    rocker = Dyad('second', 'RRR', Point('crank', 1.2), Point('ground', 1.0), ('rod', 'rocker'),
                  length_1=0.4, length_2=0.8)
    after = Dyad('third', 'RRR', Point('rocker', 0.8), Point('ground', 3.0), ('link', 'arm'),
                 length_1=2.0, length_2=2.0)
    toggles = dict(facts(Machine([rocker, after])))['toggle']
    assert toggles.count('(dyad second)') == toggles.count('deg') > 0


def test_a_plot_has_ticks_each_90_degrees_symbols_and_extrema():
    paper = load_scene('paper')
    given = paper, paper.linkage, ['f41', 'omega4', 'theta4'], paper.drive.speed
    marks = marks_of(paper.linkage, extrema_of(*given))
    figure = make_figure(curves_of(*given), marks)
    force, rate, angle = figure.axes
    ticks = [tick for tick in force.get_xticks() if 0.0 <= tick <= 360.0]
    assert ticks == [0.0, 90.0, 180.0, 270.0, 360.0]
    assert [axis.get_ylabel() for axis in figure.axes] == [
        'force [N]', 'angular velocity [rad/s]', 'angle [deg]']
    assert [axis.texts[0].get_text() for axis in figure.axes] == [
        '$F_{41}$', r'$\omega_4$', r'$\theta_4$']
    assert all(len(points.get_xdata()) >= 2 for _, points in (axis.lines for axis in figure.axes))


def test_coordinates_of_points_are_columns_and_curves_by_name(capsys):
    scene = load_scene('jansen')
    assert main(['table', 'jansen', 'foot.x', 'foot.y', '--samples', '9', '--units', 'rad',
                 '-o', '-']) == 0
    head, *rows = csv.reader(io.StringIO(capsys.readouterr().out))
    assert head == ['theta_crank [rad]', 'foot.x [m]', 'foot.y [m]']
    for x, *place in np.array(rows, float):
        point = point_motion(scene.linkage, scene.linkage.motion(x), *scene.points['foot'])
        assert place == pytest.approx(point.place, rel=1e-8, abs=1e-9)    # nine digits and more
    names = [quantity.name for quantity in select((), scene.linkage, scene.point_quantities)]
    assert 'foot.speed' in names and 'foot.x' not in names      # show has what it had
    quantities = select(['foot.y'], scene.linkage, scene.point_quantities)
    found = find_extrema(scene.linkage, quantities)
    scan = point_motion(scene.linkage, scene.linkage.motion(np.linspace(0.0, tau, 2000)),
                        *scene.points['foot']).place[..., 1]
    # between two inputs of a scan a curve is off by an eighth of curvature times squared step
    near = max(abs(np.diff(scan, 2))) / 8.0
    for best, scanned in ((max, scan.max()), (min, scan.min())):
        assert abs(best(extremum.value for extremum in found) - scanned) <= near


def test_weight_that_is_left_out_is_told(tmp_path, capsys):
    line = 'left out (gravity 0)'
    file = tmp_path / 'my.yaml'
    main(['new', str(file), *NEW, '--a4', '180mm'])
    for verb in (['show', str(file)], ['table', str(file), 'f41', '-o', str(tmp_path / 'a.csv')]):
        capsys.readouterr()
        main(verb)
        assert line in ''.join(capsys.readouterr())
    main(['table', str(file), 'omega4', '-o', str(tmp_path / 'b.csv')])
    assert line not in capsys.readouterr().err
    text = file.read_text()
    file.write_text(text.replace('    # gravity:', '    gravity:'))
    assert load_scene(file).linkage.gravity == (0.0, -9.81)
    main(['show', str(file)])
    assert line not in ''.join(capsys.readouterr())


def test_a_margin_of_a_machine_is_no_share_of_its_perimeter():
    rows = {name: dict(facts(load_scene(name).linkage))['change-point margin']
            for name in ('paper', 'watt', 'bucket')}
    assert rows['paper'].endswith(' of the perimeter')
    assert ' rad; the nearer to 0' in rows['watt'] and 'perimeter' not in rows['watt']
    assert ' m; the nearer to 0' in rows['bucket'] or ' rad; ' in rows['bucket']
