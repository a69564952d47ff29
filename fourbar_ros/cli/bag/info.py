# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag info``: what a bag contains and whether it is sound."""
from __future__ import annotations

from argparse import Namespace
from functools import partial
from typing import TYPE_CHECKING

from fourbar_ros.cli.bag.many import add_bags, Report, run
from fourbar_ros.cli.common import add_json, Verbs

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_ros.bag.info import Info
    from fourbar_ros.report.terminal import PlainTable

COLUMNS = ('state', 's>', 'MB>', 'parts>', 'messages>', 'missing>', 'damage, end')


def add(actions: Verbs) -> None:
    """Add the action."""
    info = actions.add_parser('info', help='show what a bag contains and whether it is sound',
                              description='Show what a bag contains and whether it is sound.')
    add_bags(info)
    add_json(info)
    info.add_argument('--check', action='store_true',
                      help='read every message: verify checksums, and sequence numbers to find '
                           'missing messages')
    info.set_defaults(run=_info)


def _info(arguments: Namespace) -> int:
    from fourbar_ros.bag import as_json
    from fourbar_ros.bag.info import info
    return run(arguments, partial(info, check=arguments.check), 'reading', Report(
        to_json=as_json.of_info, to_text=lambda bag, found: print_info(found, arguments.check),
        columns=COLUMNS,
        to_row=_row, is_good=lambda found: found.is_sound))


def _seconds(found: Info) -> float:
    return 0.0 if found.start is None or found.end is None else (found.end - found.start) * 1e-9


def _row(found: Info) -> tuple[str, ...]:
    return (found.state, f'{_seconds(found):.3f}', f'{found.size / 1e6:.3f}', str(found.parts),
            str(sum(topic.messages for topic in found.topics)), str(found.missing),
            found.damage or found.ended)


def print_info(found: Info, was_checked: bool) -> None:
    """Print the Info of one bag."""
    from fourbar_ros.report.terminal import make_console
    console = make_console()
    console.print(_about(found, was_checked))
    console.print(_topics(found))
    if found.state == 'cut':
        console.print('the bag was cut off by a crash or a full disk: fourbar bag recover makes '
                      'it whole')
    elif found.damage:
        console.print('fourbar bag recover makes a whole bag of the undamaged messages')


def _about(found: Info, was_checked: bool) -> PlainTable:
    from datetime import datetime

    from fourbar_ros.bag.info import software_of
    from fourbar_ros.report.terminal import plain_table
    table = plain_table(str(found.file), ('', ''))
    table.show_header = False
    extent = 'read up to the damage' if found.damage else 'every message read'
    table.add_row('state', found.state + (f', {extent}' if was_checked else ''))
    table.add_row('size', f'{found.size / 1e6:.3f} MB'
                  + (f' in {found.parts} parts' if found.parts > 1 else ''))
    if found.start is not None:
        start = datetime.fromtimestamp(found.start * 1e-9).astimezone()
        table.add_row('start', start.isoformat(' ', 'milliseconds'))
    table.add_row('duration', f'{_seconds(found):.3f} s')
    for label, text in (('made by', software_of(found.about)), ('node', found.about.get('node')),
                        ('ended', found.ended),
                        ('dropped', found.dropped and f'{found.dropped} messages'),
                        ('recovered without', found.lost), ('damage', found.damage)):
        if text:
            table.add_row(label, text)
    return table


def _topics(found: Info) -> PlainTable:
    from fourbar_ros.report.terminal import plain_table
    table, seconds = plain_table('', ('topic', 'type', 'messages>', 'Hz>',
                                      'missing>')), _seconds(found)
    for topic in found.topics:
        rate = f'{(topic.messages - 1) / seconds:.2f}' if seconds and topic.messages > 1 else ''
        table.add_row(topic.topic, topic.type, str(topic.messages), rate,
                      '' if topic.missing is None else str(topic.missing))
    return table
