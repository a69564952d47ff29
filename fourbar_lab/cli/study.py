# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar study``: compute many designs of a scene."""
from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from math import isfinite, isnan
import sys
import time
from typing import TYPE_CHECKING

from fourbar_ros.cli import common
from fourbar_ros.terminal import make_console, make_table

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_lab.studies import Toleranced

ACTIONS = ('run', 'show', 'pick', 'tolerances')
LISTED = 20         # designs of a front that are shown, evenly spread ones of more
DESCRIPTION = """\
Compute many designs of one scene: draw them, search all their extrema, keep those that fulfil the
constraints as Parquet files, show which are best. docs/studies.md describes the file STUDY.yaml:

  scene: paper
  method: sobol                     # or random, grid
  rows: 65536
  vary:
    linkage.a1: {range: [0.2, 0.6]}
    linkage.a3: {normal: 0.001}     # around the scene's value
  constraints:
    class: [crank-rocker]
    least_transmission_angle: {least: 0.5}
  quantities: [shaking_force, omega4.peak]
  objectives: {shaking_force.max: minimize, swing: maximize}
"""
EPILOG = """\
examples:
  fourbar study STUDY.yaml -o DIR              on all processors of this machine; "run" is implied
  fourbar study STUDY.yaml -o DIR --resume     go on after Ctrl-C, a crash or a power cut
  fourbar study STUDY.yaml -o DIR --cluster tcp://host:8786       on a Dask cluster
  fourbar study show DIR                       counts, ranges, the best designs
  fourbar study pick DIR best -o best.yaml     one design as a scene for the node
  fourbar study tolerances STUDY.yaml          sensitivities, worst case, Monte Carlo
"""

TOLERANCES = """\
Show how the measures of a study change with the parameters that vary in it, around the middle of
their tolerances (uniform, normal: three deviations, range): exact derivatives; the worst case by
the first order and in the corners of the box; and what the rows of the study, drawn at random,
give.
"""


def add(verbs: common.Verbs) -> None:
    verb = common.add_verb(verbs, 'study', 'compute many designs of a scene; show and pick the '
                                           'best', DESCRIPTION, EPILOG)
    parse = verb.parse_known_args

    def with_run_implied(args: Sequence[str], namespace: argparse.Namespace | None
                         ) -> tuple[argparse.Namespace, list[str]]:
        if args and args[0] not in (*ACTIONS, '-h', '--help'):
            args = ['run', *args]
        return parse(args, namespace)

    verb.parse_known_args = with_run_implied        # type: ignore[method-assign, assignment]
    actions = verb.add_subparsers(dest='action', required=True, metavar='ACTION')
    run = actions.add_parser('run', help='compute the designs of a study; "run" may be left out',
                             description=DESCRIPTION, epilog=EPILOG,
                             formatter_class=common.HelpFormatter)
    run.add_argument('study', metavar='STUDY', help='study to run (YAML, see docs/studies.md)')
    run.add_argument('-o', '--out', metavar='DIR', required=True,
                     help='folder for the results; must not exist, or hold this study (--resume)')
    run.add_argument('--resume', action='store_true',
                     help='go on with a study that was interrupted')
    where = run.add_mutually_exclusive_group()
    where.add_argument('--workers', type=common.positive_integer, metavar='N',
                       help='processes on this machine; default: one for each processor')
    where.add_argument('--cluster', metavar='ADDRESS',
                       help='address of a Dask scheduler, tcp://host:8786; its workers need '
                            'pip install ".[study]", no ROS')
    run.set_defaults(run=_run)
    show = actions.add_parser('show', help='show counts, ranges and the best designs of a study',
                              description='Show how many designs were left out by what, the '
                                          'range of each column, and the best designs.')
    pick = actions.add_parser('pick', help='write one design as a scene file for the node',
                              description='Write one design as a scene file, which starts the '
                                          'node and every other command.')
    for parser in (show, pick):
        parser.add_argument('study', metavar='DIR', help='folder of a study, also while it runs')
    pick.add_argument('which', metavar='WHICH', help='best, worst, or the number of a row')
    pick.add_argument('--by', metavar='OBJECTIVE', help='objective to rank by; default: the first')
    common.add_output(pick, '-o', '--out', metavar='SCENE', suffix='.yaml',
                      help='file to write; default: print it')
    show.set_defaults(run=_show)
    pick.set_defaults(run=_pick)
    parser = actions.add_parser('tolerances', help='sensitivities, worst case and Monte Carlo of '
                                                   'the tolerances of a study',
                                description=TOLERANCES, formatter_class=common.HelpFormatter)
    parser.add_argument('study', metavar='STUDY', help='study (YAML, see docs/studies.md)')
    parser.add_argument('--rows', type=common.positive_integer, metavar='N',
                        help='designs to draw; default: the rows of the study')
    parser.set_defaults(run=_tolerances)


def _show(arguments: argparse.Namespace) -> None:
    from fourbar_lab.studies.results import PERCENTILES, Results
    results, console = Results(arguments.study), make_console()

    def show(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        console.print()
        console.print(make_table(title, heads, rows))

    def show_designs(title: str, rows: Sequence[int]) -> None:
        names = [*results.objectives, *results.varied]
        show(title, ('row>', *(f'{name}>' for name in names)),
             [(str(row), *(f'{design[name]:.6g}' for name in names))
              for row, design in ((row, results.design(row)) for row in rows)])

    study, missing = results.study, results.study['rows'] - results.designs
    text = (f'{results.designs} of {study["rows"]} designs ({study["method"]}, seed '
            f'{study["seed"]}), {results.kept} kept')
    console.print(f'{text}; {missing} are not computed yet: --resume' if missing else text)
    show('designs', ('', '>'), [(reason, str(count))
                                for reason, count in results.counts.items()])
    if results.kept:
        show('ranges', ('column', 'unit', 'least>', *(f'{p} %>' for p in PERCENTILES),
                        'greatest>', 'mean>', 'without>'),
             [(column.name, column.unit, *(f'{value:.6g}' for value in (
                 column.least, *column.percentiles, column.greatest, column.mean, column.missing)))
              for column in results.summaries()])
        for name, sense in results.objectives.items():
            show_designs(f'best designs: {sense} {name}', results.best(name))
        if len(results.objectives) > 1:
            front = results.front()
            first, second = list(results.objectives)[:2]
            rows = front['row'][front[first].argsort()].tolist()
            step = -(-len(rows) // LISTED)
            show_designs(f'front: {len(rows)} designs that none beats in {first} without being '
                         f'worse in {second}', rows[::step])
    for row, text in results.failures[:5]:
        console.print(f'row {row} failed: {text}')


def _pick(arguments: argparse.Namespace) -> None:
    from fourbar_lab.studies import StudyError
    from fourbar_lab.studies.results import Results
    results, which = Results(arguments.study), arguments.which
    if which in ('best', 'worst'):
        rows = results.best(arguments.by, 1, which == 'worst')
        if not rows:
            raise StudyError(f'{arguments.study}: no design fulfils the constraints')
        row = rows[0]
    elif which.isdecimal():
        row = int(which)
    else:
        raise StudyError(f'{which}: must be best, worst or the number of a row')
    common.write_or_print(results.scene_text(row), arguments.out)
    if arguments.out:
        print(f'row {row}')


def _run(arguments: argparse.Namespace) -> int:
    from fourbar_lab.studies.chunks import FEASIBLE
    from fourbar_lab.studies.engine import cluster, KEPT, processes, run
    from fourbar_lab.studies.results import Results
    from fourbar_lab.studies.study import read
    study, begun = read(arguments.study), time.monotonic()
    pool = (partial(cluster, arguments.cluster) if arguments.cluster
            else partial(processes, arguments.workers))
    try:
        with common.bar('designs', study.rows) as report:
            done = run(study, arguments.out, pool, resume=arguments.resume, report=report)
    except KeyboardInterrupt:
        print(f'interrupted: {KEPT}', file=sys.stderr)
        raise
    seconds, results = time.monotonic() - begun, Results(arguments.out)
    print(f'{done} designs in {seconds:.1f} s ({done / seconds:.0f}/s): {arguments.out}')
    print(', '.join(f'{reason}: {count}' for reason, count in results.counts.items()),
          flush=True)
    for row, text in results.failures[:5]:
        print(f'row {row} failed: {text}', file=sys.stderr)
    if FEASIBLE not in results.counts:
        print('fourbar: no design fulfils the constraints, so there is none to show: most fail '
              f'{next(iter(results.counts))}', file=sys.stderr)
    return common.BAD if results.failures else 0


# --- tolerances ----------------------------------------------------------------------------------

def _tolerances(arguments: argparse.Namespace) -> None:
    from fourbar_lab.studies.chunks import compute, FAILED, FEASIBLE, NOT_BUILT
    from fourbar_lab.studies.results import summary
    from fourbar_lab.studies.study import read
    from fourbar_lab.studies.tolerance_analysis import box_of, tolerances
    import numpy as np
    study = read(arguments.study)
    if arguments.rows:
        study = replace(study, rows=arguments.rows)
    box, units = box_of(study), {parameter.name: parameter.unit for parameter in study.vary}
    results, corners = tolerances(study)
    # all rows that can be built are drawn, feasible or not; objectives are left out
    to_draw = replace(study, keeps_all=True, objectives={})
    chunks = [compute(to_draw, index) for index in range(to_draw.chunks)]
    draws = sum((Counter(chunk.counts) for chunk in chunks), Counter[str]())    # {reason: designs}
    drawn = {measure.name: summary(measure.name, measure.unit, np.concatenate(
        [chunk.columns[measure.name] for chunk in chunks]))
        for measure in study.measures if measure.part != 'class'}
    known_draws, known_corners = (sum(counts.values()) - counts.get(NOT_BUILT, 0)
                                  - counts.get(FAILED, 0) for counts in (draws, corners))
    bounds = list[tuple[str, ...]]()
    for result in results:
        measure, value = result.sensitivity.measure, result.sensitivity.value
        assert not isinstance(value, str)           # tolerances() leaves the class out
        of_draws = drawn[measure.name]
        bounds.append((measure.name, measure.unit, *map(_text, (
            value, value - result.first_order, value + result.first_order, result.corners.least,
            result.corners.greatest, of_draws.least, of_draws.greatest, *of_draws.percentiles))))
    console = make_console()
    for title, heads, rows in (
            ('box', ('parameter', 'unit', 'middle>', '+->'),
             [(name, units[name], _text(centre), _text(size))
              for name, (centre, size) in box.items()]),
            (f'least and greatest value, and percentiles of {known_draws} designs',
             ('measure', 'unit', 'middle>', *(f'{end} {way}>' for way in
                                              ('first order', 'of corners', 'drawn')
                                              for end in ('least', 'greatest')),
              '5 %>', '50 %>', '95 %>'), bounds),
            ('derivatives, and what each tolerance contributes',
             ('measure', 'parameter', 'derivative>', 'unit', '+->'),
             [row for result in results for row in _derivative_rows(result, box, units)])):
        console.print(make_table(title, heads, rows))
        console.print()

    def counted(missing_draws: int, missing_corners: int, draws: int, corners: int) -> str:
        """Return how many of the draws and of the corners lack something; '' if none does."""
        return ' and '.join(f'{missing} of {count} {name}' for missing, count, name in (
            (missing_draws, draws, 'draws'), (missing_corners, corners, 'corners')) if missing)

    left_out = [(counted(draws.get(reason, 0), corners.get(reason, 0), sum(draws.values()),
                         sum(corners.values())), reason) for reason in (NOT_BUILT, FAILED)]
    lines = [f'{count} {reason}' for count, reason in left_out if count]
    for result in results:
        name = result.sensitivity.measure.name
        if missing := counted(drawn[name].missing, result.corners.missing, known_draws,
                              known_corners):
            lines.append(f'{name} has no value in {missing}')
        if result.sensitivity.why_unknown:
            lines.append(f'{name} has no first order: {result.sensitivity.why_unknown}')
    for line in lines:
        console.print(line, soft_wrap=True)
    if study.bounds:
        console.print(f'{100.0 * draws[FEASIBLE] / study.rows:.6g} % of the designs fulfil the '
                      'constraints')


def _derivative_rows(result: Toleranced, box: dict[str, tuple[float, float]], units: dict[str, str]
                     ) -> list[tuple[str, ...]]:
    """
    Return the rows of a measure, those that contribute most first; none if no derivative is known.

    ``box``: {parameter: (middle, tolerance)}. A row has measure, parameter, derivative, its unit,
    and |derivative| times tolerance.
    """
    measure, by = result.sensitivity.measure, result.sensitivity.by
    if not any(map(isfinite, by.values())):
        return []
    rows = list[tuple[str, ...]]()
    shares = {name: abs(by[name]) * size for name, (_, size) in box.items()}
    for name in sorted(shares, key=lambda name: (isnan(shares[name]), -shares[name])):
        # the derivative of N m by kg/m has the unit (N m)/(kg/m)
        above, below = (f'({unit})' if set(unit) & set(' /') else unit or '1'
                        for unit in (measure.unit, units[name]))
        rows.append((measure.name, name, _text(by[name]),
                     above if below == '1' else f'{above}/{below}', _text(shares[name])))
    return rows


def _text(value: float) -> str:
    return '-' if isnan(value) else f'{value:.6g}'
