# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag recompute``: recompute every recorded output and compare."""
from __future__ import annotations

from functools import partial

from fourbar_ros.cli.bag.many import add_bags, Report, run
from fourbar_ros.cli.common import add_json, add_node, add_tolerance

COLUMNS = ('inputs>', 'outputs compared>', 'largest difference>', 'verdict')


def add(actions):
    """Add the action."""
    recompute = actions.add_parser(
        'recompute', help='recompute every recorded output and compare',
        description='Recompute every recorded output from the driven motion and the scene, both '
                    'of which are in the bag, and compare. Bags of this version of the software '
                    'differ by exactly 0.')
    add_bags(recompute)
    add_json(recompute)
    add_tolerance(recompute)
    add_node(recompute)
    recompute.set_defaults(run=_recompute)


def _recompute(arguments):
    from fourbar_ros.bag import as_json
    from fourbar_ros.bag.recompute import compare
    tolerance = arguments.tolerance

    def row(found):
        return (str(found.inputs), str(found.compared), f'{found.largest:g}',
                '; '.join(found.problems(tolerance)) or ('good, cut' if found.cut else 'good'))
    return run(arguments, partial(compare, node=arguments.node), 'recomputing', Report(
        to_json=lambda bag, found: as_json.of_recomputed(bag, found, tolerance),
        to_text=lambda bag, found: print_recomputed(found, tolerance), columns=COLUMNS, to_row=row,
        is_good=lambda found: not found.problems(tolerance)))


def print_recomputed(found, tolerance):
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
    for problem in found.problems(tolerance):
        print(f'bad: {problem}')


def _differences(found, tolerance):
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
