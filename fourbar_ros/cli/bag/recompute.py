# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag recompute``: recompute every recorded output and compare."""
from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from fourbar_ros.cli.bag.many import add_bags, Report, run
from fourbar_ros.cli.common import add_json, add_node, add_tolerance, Verbs

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_ros.bag.difference import Recomputed
    from fourbar_ros.report.terminal import PlainTable

COLUMNS = ('inputs>', 'outputs compared>', 'largest difference>', 'verdict')


def add(actions: Verbs) -> None:
    """Add the action."""
    recompute = actions.add_parser(
        'recompute', help='recompute every recorded output and compare',
        description='Recompute every recorded output from the driven motion and the scene, both '
                    'of which are in the bag, and compare. Bags of this version of the software '
                    'differ by exactly 0. Those of another version may differ by rounding: the '
                    'last line says whether that explains all differences, by a bound computed '
                    'for each value.',
        epilog='Exit code 3 if anything differs by more than the tolerance, is missing, doubled '
               'or without its input, or if nothing can be compared; 1 if a bag cannot be read.')
    add_bags(recompute)
    add_json(recompute)
    add_tolerance(recompute)
    recompute.add_argument('--rounding', action='store_true',
                           help='accept differences that rounding explains (exit code 0)')
    add_node(recompute)
    recompute.set_defaults(run=_recompute)


def _recompute(arguments: Namespace) -> int:
    from fourbar_ros.bag import as_json
    from fourbar_ros.bag.recompute import compare
    tolerance = arguments.tolerance

    def problems(found: Recomputed) -> list[str]:
        return found.problems(tolerance, arguments.rounding)

    def row(found: Recomputed) -> tuple[str, ...]:
        verdict = '; '.join(problems(found)) or ('good, cut' if found.cut else 'good')
        return (str(found.inputs), str(found.compared), f'{found.largest:g}',
                verdict + (', by rounding only' if found.is_rounding else ''))
    return run(arguments, partial(compare, node=arguments.node), 'recomputing', Report(
        to_json=lambda bag, found: as_json.of_recomputed(bag, found, tolerance,
                                                         arguments.rounding),
        to_text=lambda bag, found: print_recomputed(found, tolerance, problems(found)),
        columns=COLUMNS, to_row=row,
        is_good=lambda found: not problems(found)))


def print_recomputed(found: Recomputed, tolerance: float, problems: Sequence[str]) -> None:
    """Print the Recomputed of one bag."""
    from fourbar_ros.report.terminal import make_console
    if found.differences:
        make_console().print(_differences(found, tolerance))
    print(f'{found.inputs} driven motions, {found.compared} outputs compared; largest difference '
          f'{found.largest:g}' + ('; the bag is cut' if found.cut else ''))
    print(f'driven motion: {found.driven}')
    for count, text in ((found.silent, 'outputs report that the input had stopped'),
                        (found.uncertain, 'outputs not compared: the bag does not show what they '
                                          'depend on')):
        if count:
            print(f'{count} {text}')
    if found.largest:
        print(found.verdict())
    for problem in problems:
        print(f'bad: {problem}')


def _differences(found: Recomputed, tolerance: float) -> PlainTable:
    from fourbar_ros.report.terminal import plain_table
    table = plain_table('', ('topic', 'field', 'messages>', 'largest difference>'))
    for topic in dict.fromkeys(difference.topic for difference in found.differences):
        of_topic = [difference for difference in found.differences if difference.topic == topic]
        shown = [difference for difference in of_topic if difference.largest > tolerance]
        for difference in shown:
            table.add_row(topic, difference.field, str(difference.messages),
                          f'{difference.largest:g}')
        if not shown:
            table.add_row(topic, f'all {len(of_topic)}', str(of_topic[0].messages),
                          f'{max(difference.largest for difference in of_topic):g}')
    return table
