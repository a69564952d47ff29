# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar table`` and ``fourbar plot``: quantities over the input, without ROS or a bag."""
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
import sys

from fourbar_lab.cli import asked
from fourbar_ros.cli import common
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.units import of

SAMPLES = 361
TABLE = """\
examples:
  fourbar table paper f41 shaking_force -o paper.csv     for a spreadsheet
  fourbar table paper -o paper.csv                       all that has a name
  fourbar table paper --speeds 0rpm 600rpm -o servo.csv
  fourbar table paper theta4 --speed 300rpm --samples 73 -o every_5_degrees.csv
  fourbar table slider_crank slide f41 --units mm,deg,kN --digits 6 --excel -o excel.csv
  fourbar table paper theta4 -o - | head
"""
PLOT = """\
examples:
  fourbar plot paper f41 shaking_force -o paper.png
  fourbar plot my.yaml omega4 alpha4 --speed 300rpm -o rates.svg
  fourbar plot slider_crank slide f41 --units mm,kN -o rod.pdf
  fourbar plot paper f41 f21 f32 f43 --width 88mm --title "" -o column.pdf
"""
UNITS_HELP = ('units of the {} that measure the same: mm,deg,rpm,N mm,kW; default: deg for '
              'angles, SI')


def add(verbs: common.Verbs) -> None:
    table = common.add_verb(
        verbs, 'table', 'quantities over the input as CSV',
        'Write quantities over all of the input, a row for each sample. Angles are in degrees,\n'
        'all else is in SI, or in --units.', TABLE)
    _add_arguments(table, 'default all')
    common.add_output(table, '-o', '--out', metavar='FILE', required=True, suffix='.csv',
                      can_print=True, help='table to write: .csv, or - for standard output')
    table.add_argument('--speeds', nargs=2, type=of('rad/s', 'm/s'),
                       metavar=('LOW', 'HIGH'),
                       help='instead, what the drive must give at 25 speeds of the input: root '
                            'mean square and peak of its torque, peak of its power')
    common.add_csv(table, UNITS_HELP.format('columns'))
    table.set_defaults(run=_table)
    plot = common.add_verb(
        verbs, 'plot', 'quantities over the input as a picture',
        'Draw quantities over all of the input, one pair of axes for each unit.\n'
        'Requires matplotlib.', PLOT)
    _add_arguments(plot, 'default: rates, accelerations and loads')
    common.add_picture(plot)
    common.add_units(plot, UNITS_HELP.format('axes'))
    plot.set_defaults(run=_plot)


def _add_arguments(verb: ArgumentParser, default: str) -> None:
    common.add_scene(verb)
    verb.add_argument('names', nargs='*', metavar='QUANTITY',
                      help='e.g. omega4, f41, inertia, bias or mechanical_advantage of the drive, '
                           f'middle.x or middle.speed of a point; {default}')
    common.add_rates(verb)
    verb.add_argument('--samples', type=common.positive_integer, default=SAMPLES, metavar='N',
                      help=f'inputs in each range (default {SAMPLES}: a degree apart in a full '
                           'turn)')


def _table(arguments: Namespace) -> None:
    from fourbar_lab.drawing import curves, views
    from fourbar_ros.spreadsheet import CsvStyle, STDOUT
    scene, linkage, speed = asked(arguments)
    if arguments.speeds and (arguments.speed is not None or arguments.samples != SAMPLES):
        raise InvalidParameter('--speeds', None, 'stands in place of --speed and --samples')
    columns = views.columns(scene, arguments.names, (linkage, speed, arguments.acceleration),
                            arguments.samples, arguments.units, arguments.speeds or ())
    missed = ''
    if not arguments.speeds and (linkage.elements or linkage.friction):
        missed = curves.missed_peaks(columns, curves.curves_of(
            scene, linkage, arguments.names, speed, arguments.acceleration, arguments.samples,
            views.shown_units(arguments.units), with_jumps=True))
    curves.write_table(columns, arguments.out, CsvStyle(arguments.digits, arguments.excel))
    if arguments.out != STDOUT:
        print(arguments.out)
    if missed:
        print(missed, file=sys.stderr)
    _tell_weight(scene, [linkage.drive_load] if arguments.speeds else columns.names)


def _plot(arguments: Namespace) -> None:
    from fourbar_lab.drawing import figure, views
    scene, _, speed = asked(arguments)
    print(figure.save(views.plot(
        scene, *arguments.names, speed=speed, acceleration=arguments.acceleration,
        mode=arguments.mode, samples=arguments.samples, units=arguments.units,
        title=arguments.title, width=arguments.width), arguments.out))
    _tell_weight(scene, arguments.names or scene.linkage.LOADS._fields)


def _tell_weight(scene: Scene, names: Sequence[str]) -> None:
    from fourbar_lab.drawing.tables import NO_WEIGHT
    linkage = scene.linkage
    if not any(linkage.gravity) and any(name in linkage.LOADS._fields for name in names):
        print(': '.join(NO_WEIGHT), file=sys.stderr)
