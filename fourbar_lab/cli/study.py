# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar study``: compute many designs of a scene."""
from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from functools import partial
import sys
import time

from fourbar_lab.cli import tolerances
from fourbar_ros.cli import common
from fourbar_ros.scene.arguments import positive_integer

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
    where.add_argument('--workers', type=positive_integer, metavar='N',
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
    tolerances.add(actions)


def _show(arguments: argparse.Namespace) -> None:
    from fourbar_lab.studies.results import PERCENTILES, Results
    from fourbar_ros.terminal import make_console, make_table
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
