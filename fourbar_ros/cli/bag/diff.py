# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag diff``: compare two bags message by message."""
from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fourbar_ros.cli.common import (
    add_json,
    add_tolerance,
    add_topics,
    BAD,
    BAG_HELP,
    reading,
    Verbs,
)

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_ros.bag.diff import TopicDiff
    from fourbar_ros.report.terminal import PlainTable


def add(actions: Verbs) -> None:
    """Add the action."""
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
    from fourbar_ros.bag.diff import diff
    with reading(arguments.first, 'comparing topic by topic') as step:
        found = diff(arguments.first, arguments.second, arguments.topics, step)
    if arguments.json:
        from fourbar_ros.bag import as_json
        print(as_json.line(as_json.of_diff(arguments.first, arguments.second, found,
                                           arguments.tolerance)))
    else:
        from fourbar_ros.report.terminal import make_console
        make_console().print(_table(found, arguments.tolerance))
    return 0 if all(topic.is_same(arguments.tolerance) for topic in found) else BAD


def _table(found: Sequence[TopicDiff], tolerance: float) -> PlainTable:
    from fourbar_ros.report.terminal import plain_table
    table = plain_table('', ('topic', 'in both>', 'only first>', 'only second>', 'field',
                             'largest difference>'))
    for topic in found:
        worst = [difference for difference in topic.differences if difference.largest > tolerance]
        counts = [str(count) for count in (topic.messages, topic.only_first, topic.only_second)]
        table.add_row(topic.topic, *counts, worst[0].field if worst else '',
                      f'{worst[0].largest:g}' if worst else '0')
        for difference in worst[1:]:
            table.add_row('', '', '', '', difference.field, f'{difference.largest:g}')
    return table
