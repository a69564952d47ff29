# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar study``: compute many designs of a scene."""
from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
import sys
import time

from fourbar_ros.cli.common import add_verb, BAD
from fourbar_ros.scene.arguments import positive_integer

ACTIONS = ('run', 'show', 'plot', 'pick')
EVERY = 30.0        # [s] between two lines about progress where there is no terminal
DESCRIPTION = """\
Compute many designs of one scene: draw them, search all their extrema, keep those that fulfil the
constraints as Parquet files, show which are best. docs/studies.md describes the file STUDY.yaml:

  scene: paper
  method: sobol                     # or latin_hypercube, random, grid
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
  fourbar study plot DIR page.html             the same with figures
  fourbar study pick DIR best -o best.yaml     one design as a scene for the node
"""


def add(verbs):
    """Add the verb and its actions."""
    verb = add_verb(verbs, 'study', 'compute many designs of a scene; show, plot, pick the best',
                    DESCRIPTION, EPILOG)
    parse = verb.parse_known_args

    def with_run_implied(args=None, namespace=None):
        if args and args[0] not in (*ACTIONS, '-h', '--help'):
            args = ['run', *args]
        return parse(args, namespace)

    verb.parse_known_args = with_run_implied
    actions = verb.add_subparsers(dest='action', required=True, metavar='ACTION')
    _add_run(actions)


def _add_run(actions):
    run = actions.add_parser('run', help='compute the designs of a study; "run" may be left out',
                             description=DESCRIPTION, epilog=EPILOG,
                             formatter_class=argparse.RawDescriptionHelpFormatter)
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
                            'pip install fourbar_ros[study], no ROS')
    run.set_defaults(run=_run)


def _run(arguments):
    from fourbar_ros.studies.engine import run
    from fourbar_ros.studies.executors import Cluster, Local
    from fourbar_ros.studies.parts import Folder
    from fourbar_ros.studies.study import read
    study, folder = read(arguments.study), Folder(arguments.out)
    folder.begin(study, arguments.resume)
    executor = Cluster(arguments.cluster) if arguments.cluster else Local(arguments.workers)
    try:
        with shown() as report:
            done = run(study, folder, executor, report)
    except KeyboardInterrupt:
        print(f'interrupted: {len(folder.parts())} of {study.chunks} chunks are done; --resume '
              'goes on', file=sys.stderr)
        raise
    finally:
        executor.close()
    counts, failures = folder.totals()
    print(f'{done.in_this_run} designs in {done.seconds:.1f} s ({done.rate:.0f}/s) with '
          f'{executor.workers} workers: {arguments.out}')
    print(', '.join(f'{reason}: {number}' for reason, number in counts.items()), flush=True)
    for row, text in failures[:5]:
        print(f'row {row} failed: {text}', file=sys.stderr)
    return BAD if failures else 0


@contextmanager
def shown() -> Iterator[Callable]:
    """Give a function that shows the progress of a run: a bar, or a line now and then."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn
    console = Console(stderr=True)
    text = '{task.fields[text]}'
    with Progress(BarColumn(), TextColumn(text), console=console, transient=True,
                  disable=not console.is_terminal) as bar:
        task = bar.add_task('designs', text='', total=None)
        last = time.monotonic()

        def report(progress):
            nonlocal last
            line = in_words(progress)
            bar.update(task, total=progress.total, completed=progress.done, text=line)
            if not console.is_terminal and time.monotonic() - last > EVERY:
                last = time.monotonic()
                print(line, file=sys.stderr, flush=True)
        yield report


def in_words(progress):
    """Return done, rate and remaining time as text."""
    text = f'{progress.done} of {progress.total} designs'
    if not progress.in_this_run:
        return text
    minutes, seconds = divmod(round(progress.remaining), 60)
    hours, minutes = divmod(minutes, 60)
    return f'{text}, {progress.rate:.0f}/s, {hours}:{minutes:02d}:{seconds:02d} remain'
