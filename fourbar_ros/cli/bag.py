# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag``: inspect, repair, check and convert recorded runs."""
from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Generic, TYPE_CHECKING, TypeVar

from fourbar_ros.cli.common import (
    add_json,
    add_node,
    add_tolerance,
    add_topics,
    add_verb,
    BAD,
    BAG_HELP,
    bar,
    Json,
    json_line,
    PICTURE_HELP,
    reading,
    Verbs,
)

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_ros.bag.comparison.difference import Recomputed

Result = TypeVar('Result')
PLACES = 50     # damaged places that are printed one by one
DESCRIPTION = """\
Inspect, repair, check and convert recorded runs. BAG is the folder of a bag or its .mcap file:
finished, cut off by a crash, or still being written. No action changes a bag or overwrites a
file. info and recompute accept several bags and folders of bags, and process them in parallel.
"""
EPILOG = """\
examples:
  fourbar bag info bags/run --check
  fourbar bag recover bags/run                        writes bags/run_recovered
  fourbar bag recompute bags/run
  fourbar bag info bags --check                       all bags below a folder
  fourbar bag recompute bags --json                   one line of JSON per bag
  fourbar bag export bags/run -o run.npz
  fourbar bag plot bags/run state.theta4 loads.f41 -o run.png
  fourbar bag diff bags/run bags/other --tolerance 1e-12

exit codes: 0 good; 1 an error, reported in one line; 2 bad arguments; 130, 143 interrupted by
Ctrl-C or SIGTERM, with no partial output left; 3 done, but
  info       the bag is unfinished or damaged, or messages are missing
  recover    data were lost or damaged
  recompute  a value differs by more than the tolerance, an output is missing,
             duplicated or without its input, or nothing could be compared
  diff       the bags differ
"""


def add(verbs: Verbs) -> None:
    """Add the verb and its actions."""
    bag = add_verb(verbs, 'bag', 'info, recover, recompute, export, plot, diff, scene: work with '
                                 'recorded runs',
                   DESCRIPTION, EPILOG)
    actions = bag.add_subparsers(dest='action', required=True, metavar='ACTION')
    for add_action in (_add_info, _add_recover, _add_recompute, _add_export, _add_plot, _add_diff,
                       _add_scene):
        add_action(actions)


# --- several bags at once ------------------------------------------------------------------------

@dataclass(frozen=True)
class Report(Generic[Result]):
    """How results of an action on bags are printed: one in full, several as rows of a table."""

    to_json: Callable[[Path, Result], Json]
    print_in_full: Callable[[Result], None]
    columns: Sequence[str]                   # of the table, behind the bag
    to_row: Callable[[Result], Sequence[str]]
    is_good: Callable[[Result], bool]


def _add_bags(parser: ArgumentParser) -> None:
    """Add the arguments BAG ..., one or several, and ``--jobs``."""
    parser.add_argument('bags', metavar='BAG', nargs='+',
                        help='folder of a bag, .mcap file, or folder of bags')
    parser.add_argument('--jobs', type=int, default=0, metavar='N',
                        help='number of bags to process in parallel; default: one per processor')


def _run(arguments: Namespace, work: Callable[..., Result], text: str, report: Report[Result]
         ) -> int:
    """
    Run ``work(bag, progress=...)`` on all bags of the command line, print the results.

    ``text`` stands at the progress bar. Returns the exit code: 1 if a bag cannot be read, BAD if
    a result is not good, else 0.
    """
    from fourbar_ros.bag.read.collection import bags_below, each
    from fourbar_ros.errors import BagError
    bags = bags_below(arguments.bags)
    results: list[Result | BagError]
    if len(bags) == 1:
        with reading(bags[0], text) as step:
            results = [work(bags[0], progress=step)]
    else:
        with bar(f'{text} {len(bags)} bags', len(bags)) as step:
            results = each(work, bags, arguments.jobs, step)
    good = [result for result in results if not isinstance(result, BagError)]
    if arguments.json:
        from fourbar_ros.cli.bag_report import json_of_error
        for bag, result in zip(bags, results):
            print(json_line(json_of_error(bag, result) if isinstance(result, BagError)
                            else report.to_json(bag, result)))
    elif len(bags) == 1:
        report.print_in_full(good[0])
    else:
        _print_table(bags, results, report)
    if len(good) < len(results):
        return 1
    return 0 if all(map(report.is_good, good)) else BAD


def _print_table(bags: Sequence[Path], results: Sequence[Result | Exception],
                 report: Report[Result]) -> None:
    """Print a row for each bag, with its result or why it could not be read."""
    from fourbar_ros.report.terminal import make_console, PlainTable
    table = PlainTable('', ('bag', *report.columns))
    for bag, result in zip(bags, results):
        if isinstance(result, Exception):
            table.add_row(str(bag), *[''] * (len(report.columns) - 1), f'error: {result}')
        else:
            table.add_row(str(bag), *report.to_row(result))
    make_console().print(table)


# --- the actions ---------------------------------------------------------------------------------

def _add_info(actions: Verbs) -> None:
    """Add ``fourbar bag info`` with its arguments."""
    info = actions.add_parser('info', help='show what a bag contains and whether it is sound',
                              description='Show what a bag contains and whether it is sound.')
    _add_bags(info)
    add_json(info)
    info.add_argument('--check', action='store_true',
                      help='read every message: verify checksums, and sequence numbers to find '
                           'missing messages')
    info.set_defaults(run=_info)


def _info(arguments: Namespace) -> int:
    """Print what bags contain; return BAD if one is not sound."""
    from fourbar_ros.bag.read.info import info
    from fourbar_ros.cli.bag_report import INFO_COLUMNS, info_row, json_of_info, print_info
    return _run(arguments, partial(info, check=arguments.check), 'reading', Report(
        json_of_info, partial(print_info, was_checked=arguments.check), INFO_COLUMNS, info_row,
        lambda info: info.is_sound))


def _add_recover(actions: Verbs) -> None:
    """Add ``fourbar bag recover`` with its arguments."""
    recover = actions.add_parser('recover', help='make a whole bag of a cut or damaged one',
                                 description='Make a whole bag of a cut or damaged one. Every '
                                             'intact record is copied, verified by its checksum; '
                                             'the old bag is only read.')
    recover.add_argument('bag', metavar='BAG', help=BAG_HELP)
    recover.add_argument('-o', '--out', metavar='DIR',
                         help='folder of the new bag; default NAME_recovered')
    recover.set_defaults(run=_recover)


def _recover(arguments: Namespace) -> int:
    """Copy the intact messages of a bag; print what is lost. Return BAD if anything is."""
    from fourbar_ros.bag.repair import recover
    with reading(arguments.bag, 'recovering') as step:
        recovered = recover(arguments.bag, arguments.out, step)
    print(f'{recovered.path}: {recovered.messages} messages, '
          + (f'{recovered.lost} bytes lost' if recovered.lost else 'nothing lost'))
    for damage in recovered.damaged[:PLACES]:
        print(f'damaged: {damage}')
    if len(recovered.damaged) > PLACES:
        print(f'damaged: and {len(recovered.damaged) - PLACES} more places')
    for topic, count in recovered.missing.items():
        print(f'missing: {count} messages of {topic}')
    return BAD if recovered.lost or recovered.damaged or recovered.missing else 0


def _add_recompute(actions: Verbs) -> None:
    """Add ``fourbar bag recompute`` with its arguments."""
    recompute = actions.add_parser(
        'recompute', help='recompute every recorded output and compare',
        description='Recompute every recorded output from the driven motion and the scene, both '
                    'of which are in the bag, and compare. Bags of this version of the software '
                    'differ by exactly 0. Those of another version may differ by rounding: the '
                    'last line says whether that explains all differences, by a bound computed '
                    'for each value.',
        epilog='Exit code 3 if anything differs by more than the tolerance, is missing, doubled '
               'or without its input, or if nothing can be compared; 1 if a bag cannot be read.')
    _add_bags(recompute)
    add_json(recompute)
    add_tolerance(recompute)
    recompute.add_argument('--rounding', action='store_true',
                           help='accept differences that rounding explains (exit code 0)')
    add_node(recompute)
    recompute.add_argument('--with', dest='by', metavar='DIR',
                           help='compute motion, loads and steps with the C code of this folder, '
                                'as fourbar generate wrote it')
    recompute.set_defaults(run=_recompute)


def _recompute(arguments: Namespace) -> int:
    """Recompute the outputs of bags, by the library or by generated C code (``--with``)."""
    from fourbar_ros.bag.comparison.recompute import compare
    from fourbar_ros.cli.bag_report import (
        json_of_recomputed,
        print_recomputed,
        RECOMPUTED_COLUMNS,
        recomputed_row,
    )
    tolerance, accept_rounding = arguments.tolerance, arguments.rounding
    work = partial(compare, node=arguments.node)
    if arguments.by:
        from fourbar_ros.generated import Compiled
        code = Compiled(arguments.by)
        work = partial(work, by=code.evaluate, moved_by=code.mover)

    def problems(result: Recomputed) -> list[str]:
        return result.problems(tolerance, accept_rounding)
    return _run(arguments, work, 'recomputing', Report(
        lambda bag, result: json_of_recomputed(bag, result, tolerance, accept_rounding),
        lambda result: print_recomputed(result, tolerance, problems(result)), RECOMPUTED_COLUMNS,
        lambda result: recomputed_row(result, problems(result)),
        lambda result: not problems(result)))


def _add_export(actions: Verbs) -> None:
    """Add ``fourbar bag export`` with its arguments."""
    export = actions.add_parser('export', help='write the numbers in a bag as tables',
                                description='Write the numbers in a bag as tables: CSV, NumPy '
                                            '(.npz) or Parquet.')
    export.add_argument('bag', metavar='BAG', help=BAG_HELP)
    export.add_argument('-o', '--out', metavar='PATH', required=True,
                        help='new folder for the tables, new .npz file, or new .csv or .parquet '
                             'file for one topic')
    export.add_argument('--format', choices=('csv', 'npz', 'parquet'),
                        help='default: by the ending of PATH, csv for a folder; parquet requires '
                             'pyarrow')
    add_topics(export, 'export only these topics')
    export.set_defaults(run=_export)


def _export(arguments: Namespace) -> None:
    """Write the topics of a bag as tables; print the number of rows in each."""
    from fourbar_ros.bag.exports.export import export
    with reading(arguments.bag, 'exporting') as step:
        written = export(arguments.bag, arguments.out, arguments.format, arguments.topics, step)
    for name, rows in written.items():
        print(f'{arguments.out}: {name}, {rows} rows')


def _add_plot(actions: Verbs) -> None:
    """Add ``fourbar bag plot`` with its arguments."""
    plot = actions.add_parser('plot', help='plot fields over time or over another field',
                              description='Plot fields over time, or over the field --x; fields '
                                          'of the same unit share an axis. Requires matplotlib.')
    plot.add_argument('bag', metavar='BAG', help=BAG_HELP)
    plot.add_argument('fields', metavar='TOPIC.FIELD', nargs='+',
                      help='e.g. state.theta4, /joint_states.position[crank] or '
                           'joint_states.position[0]')
    plot.add_argument('--x', metavar='TOPIC.FIELD',
                      help='field of the horizontal axis, e.g. state.theta1; values of the same '
                           'stamp belong together (default: time)')
    plot.add_argument('-o', '--out', metavar='FILE', required=True, help=PICTURE_HELP)
    plot.set_defaults(run=_plot)


def _plot(arguments: Namespace) -> None:
    """Plot fields of a bag into a picture; print its path."""
    from fourbar_ros.bag.exports.plot import plot
    with reading(arguments.bag, 'reading') as step:
        plot(arguments.bag, arguments.fields, arguments.out, step, arguments.x)
    print(arguments.out)


def _add_diff(actions: Verbs) -> None:
    """Add ``fourbar bag diff`` with its arguments."""
    diff = actions.add_parser('diff', help='compare two bags message by message',
                              description='Compare two bags: messages with the same stamp, field '
                                          'by field.')
    diff.add_argument('first', metavar='FIRST', help=BAG_HELP)
    diff.add_argument('second', metavar='SECOND', help=BAG_HELP)
    add_tolerance(diff)
    add_topics(diff, 'compare only these topics')
    add_json(diff)
    diff.set_defaults(run=_diff)


def _diff(arguments: Namespace) -> int:
    """Compare two bags topic by topic; return BAD if they differ by more than the tolerance."""
    from fourbar_ros.bag.comparison.diff import diff
    from fourbar_ros.cli.bag_report import diff_table, json_of_diff
    first, second, tolerance = arguments.first, arguments.second, arguments.tolerance
    with reading(first, 'comparing topic by topic') as step:
        topics = diff(first, second, arguments.topics, step)
    if arguments.json:
        print(json_line(json_of_diff(first, second, topics, tolerance)))
    else:
        from fourbar_ros.report.terminal import make_console
        make_console().print(diff_table(topics, tolerance))
    return 0 if all(topic.is_same(tolerance) for topic in topics) else BAD


def _add_scene(actions: Verbs) -> None:
    """Add ``fourbar bag scene`` with its arguments."""
    scene = actions.add_parser(
        'scene', help='print the scene of a bag as a parameter file',
        description='Print the scene of a bag as a parameter file, for a node that the bag is to '
                    'drive (drive.source: motion): see fourbar replay --inputs-only.')
    scene.add_argument('bag', metavar='BAG', help=BAG_HELP)
    scene.add_argument('--drive', choices=('motion', 'timer'), default='motion',
                       help='drive.source in the parameter file (default motion)')
    add_node(scene)
    scene.set_defaults(run=_scene)


def _scene(arguments: Namespace) -> None:
    """Print the scene of a bag as a parameter file."""
    from fourbar_ros.bag.read.info import parameter_file
    print(parameter_file(arguments.bag, arguments.drive, arguments.node), end='')
