# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a person reads in tables, plots, show and new: units, whole degrees, left-out weight."""
import csv
from math import radians

from fourbar_lab.drawing.curves import (
    csv_of,
    curves_of,
    effort_of,
    extrema_of,
    make_figure,
    marks_of,
)
from fourbar_lab.drawing.tables import facts
from fourbar_lab.live.downloads import cycle_csv
from fourbar_lab.live.model import shown
from fourbar_ros import load_scene
from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.machine.describe.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np
import pytest

NEW = ['--a1', '60mm', '--a2', '200mm', '--a3', '15cm', '--bar', '20x5mm']


def test_a_table_has_whole_degrees_and_units_and_so_has_the_page():
    paper = load_scene('paper')
    text = csv_of(curves_of(paper, paper.linkage, (), paper.drive.speed))
    head, *rows = csv.reader(text.splitlines())
    assert [row[0] for row in rows] == [f'{degrees}.0' for degrees in range(361)]
    assert all(name.endswith(']') for name in head) and head[0] == 'theta1 [deg]'
    assert cycle_csv(shown(paper.values)) == text


def test_a_table_over_speeds_sizes_a_servo(tmp_path, capsys):
    file = tmp_path / 'servo.csv'
    assert not main(['table', 'paper', '--speeds', '0', '600rpm', '-o', str(file)])
    head, *rows = csv.reader(file.read_text().splitlines())
    assert head == ['speed [rad/s]', 'root_mean_square [N m]', 'peak [N m]', 'peak_power [W]']
    speed, mean, peak, power = map(float, rows[-1])
    assert len(rows) == 25 and speed == pytest.approx(radians(3600.0))
    torques = load_scene('paper').loads(np.radians(np.arange(0.25, 360.0, 0.5)),
                                        speed).driving_torque
    # 4550.89 N m by attack from outside: half a degree's samples give 4550.43
    assert (mean, peak) == pytest.approx((np.sqrt(np.mean(torques**2)), 4550.892314569))
    assert 0.9998 * peak < np.abs(torques).max() < peak
    assert power == pytest.approx(speed * peak)
    assert 'weight: left out' in capsys.readouterr().err
    for given, why in ((['f41', '--speeds', '0', '1'], 'not with --speeds'),
                       (['--speeds', '0', '1e200'], 'overflow'),
                       (['--speeds', '0', '1m/s'], '--speeds has a unit of the kind m/s')):
        assert main(['table', 'paper', *given, '--force', '-o', str(file)])
        assert why in capsys.readouterr().err


def test_the_drive_of_a_four_stroke_is_that_of_both_turns_and_says_that_it_is_sampled(
        tmp_path, capsys):
    engine = load_scene('engine')
    assert engine.turns == 2
    inputs = np.radians(np.arange(0.25, 720.0, 0.5))
    torques = engine.loads(inputs, 100.0).driving_torque
    found = effort_of(engine, engine.linkage, 100.0)
    assert found.samples == inputs.size
    assert found.root_mean_square == pytest.approx(np.sqrt(np.mean(torques**2)))
    assert found.peak == pytest.approx(np.abs(torques).max())
    file = tmp_path / 'servo.csv'
    assert not main(['table', 'engine', '--speeds', '0', '1', '-o', str(file)])
    assert 'peak of 1440 samples [N m]' in file.read_text()
    assert not main(['show', 'engine'])
    assert 'over the input of 1440 samples' in capsys.readouterr().out


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
    assert [axis.get_legend().get_texts()[0].get_text() for axis in figure.axes] == [
        '$F_{41}$', r'$\omega_4$', r'$\theta_4$']
    assert all(len(points.get_xdata()) >= 2 for _, points in (axis.lines for axis in figure.axes))


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
