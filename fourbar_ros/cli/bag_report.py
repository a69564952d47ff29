# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Results of ``fourbar bag`` as tables for the terminal, and as one line of JSON a bag.

Scripts read the JSON: docs/recording.md lists its keys, which must not change.
"""
from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from fourbar_ros.bag.comparison.diff import TopicDiff
from fourbar_ros.bag.comparison.difference import Recomputed
from fourbar_ros.bag.read.info import Info, software_of
from fourbar_ros.cli.common import Json
from fourbar_ros.report.terminal import make_console, PlainTable

INFO_COLUMNS = ('state', 's>', 'MB>', 'parts>', 'messages>', 'missing>', 'damage, end')
RECOMPUTED_COLUMNS = ('inputs>', 'outputs compared>', 'largest difference>', 'verdict')


# --- info ----------------------------------------------------------------------------------------

def _seconds(info: Info) -> float:
    return 0.0 if info.start is None or info.end is None else (info.end - info.start) * 1e-9


def info_row(info: Info) -> tuple[str, ...]:
    """Return an Info as a row of INFO_COLUMNS."""
    return (info.state, f'{_seconds(info):.3f}', f'{info.size / 1e6:.3f}', str(info.parts),
            str(sum(topic.messages for topic in info.topics)), str(info.missing),
            info.damage or info.ended)


def print_info(info: Info, was_checked: bool) -> None:
    """Print the Info of one bag."""
    console = make_console()
    console.print(_about(info, was_checked))
    console.print(_topics(info))
    if info.state == 'cut' and not info.topics:
        console.print('the bag was cut off before its first topic: there is nothing to recover')
    elif info.state == 'cut':
        console.print('the bag was cut off by a crash or a full disk: fourbar bag recover makes '
                      'it whole')
    elif info.damage:
        console.print('fourbar bag recover makes a whole bag of the undamaged messages')


def _about(info: Info, was_checked: bool) -> PlainTable:
    """Return the table of a bag's own properties: state, size, start, software, damage."""
    table = PlainTable(str(info.file), ('', ''))
    table.show_header = False
    extent = 'read up to the damage' if info.damage else 'every message read'
    table.add_row('state', info.state + (f', {extent}' if was_checked else ''))
    table.add_row('size', f'{info.size / 1e6:.3f} MB'
                  + (f' in {info.parts} parts' if info.parts > 1 else ''))
    if info.start is not None:
        start = datetime.fromtimestamp(info.start * 1e-9).astimezone()
        table.add_row('start', start.isoformat(' ', 'milliseconds'))
    table.add_row('duration', f'{_seconds(info):.3f} s')
    for label, text in (('made by', software_of(info.about)), ('node', info.about.get('node')),
                        ('ended', info.ended),
                        ('dropped', info.dropped and f'{info.dropped} messages'),
                        ('recovered without', info.lost), ('damage', info.damage)):
        if text:
            table.add_row(label, text)
    return table


def _topics(info: Info) -> PlainTable:
    """Return the table of the topics of a bag; empty cells where nothing is known."""
    table = PlainTable('', ('topic', 'type', 'messages>', 'Hz>', 'missing>'))
    seconds = _seconds(info)
    for topic in info.topics:
        rate = f'{(topic.messages - 1) / seconds:.2f}' if seconds and topic.messages > 1 else ''
        table.add_row(topic.topic, topic.type, str(topic.messages), rate,
                      '' if topic.missing is None else str(topic.missing))
    return table


# --- recompute -----------------------------------------------------------------------------------

def recomputed_row(result: Recomputed, problems: Sequence[str]) -> tuple[str, ...]:
    """Return a Recomputed as a row of RECOMPUTED_COLUMNS."""
    verdict = '; '.join(problems) or ('good, cut' if result.cut else 'good')
    return (str(result.inputs), str(result.compared), f'{result.largest:g}',
            verdict + (', by rounding only' if result.is_rounding else ''))


def print_recomputed(result: Recomputed, tolerance: float, problems: Sequence[str]) -> None:
    """Print how the outputs of one bag compare: differing fields, counts, and each problem."""
    if result.differences:
        make_console().print(_differences(result, tolerance))
    print(f'{result.inputs} driven motions, {result.compared} outputs compared; largest '
          f'difference {result.largest:g}' + ('; the bag is cut' if result.cut else ''))
    print(f'driven motion: {result.driven}')
    for count, text in ((result.silent, 'outputs report that the input had stopped'),
                        (result.uncertain, 'outputs not compared: the bag does not show what they '
                                           'depend on')):
        if count:
            print(f'{count} {text}')
    if result.largest:
        print(result.verdict())
    for problem in problems:
        print(f'bad: {problem}')


def _differences(result: Recomputed, tolerance: float) -> PlainTable:
    """Return a table of the fields beyond the tolerance; of other topics, one row for all."""
    table = PlainTable('', ('topic', 'field', 'messages>', 'largest difference>'))
    for topic in dict.fromkeys(difference.topic for difference in result.differences):
        of_topic = [difference for difference in result.differences if difference.topic == topic]
        shown = [difference for difference in of_topic if difference.largest > tolerance]
        for difference in shown:
            table.add_row(topic, difference.field, str(difference.messages),
                          f'{difference.largest:g}')
        if not shown:
            table.add_row(topic, f'all {len(of_topic)}', str(of_topic[0].messages),
                          f'{max(difference.largest for difference in of_topic):g}')
    return table


# --- diff ----------------------------------------------------------------------------------------

def diff_table(topics: Sequence[TopicDiff], tolerance: float) -> PlainTable:
    """Return the table of all topics, with the fields that differ by more than the tolerance."""
    table = PlainTable('', ('topic', 'in both>', 'only first>', 'only second>', 'field',
                            'largest difference>'))
    for topic in topics:
        worst = [difference for difference in topic.differences if difference.largest > tolerance]
        counts = [str(count) for count in (topic.messages, topic.only_first, topic.only_second)]
        table.add_row(topic.topic, *counts, worst[0].field if worst else '',
                      f'{worst[0].largest:g}' if worst else '0')
        for difference in worst[1:]:
            table.add_row('', '', '', '', difference.field, f'{difference.largest:g}')
    return table


# --- JSON ----------------------------------------------------------------------------------------

def json_of_error(bag: str | Path, error: BaseException) -> Json:
    """Return the dict of a bag that could not be read."""
    return {'bag': str(bag), 'error': str(error)}


def json_of_info(bag: str | Path, info: Info) -> Json:
    """Return the dict of an Info."""
    return {'bag': str(bag), 'sound': info.is_sound, 'state': info.state, 'size': info.size,
            'parts': info.parts, 'start': info.start, 'end': info.end,
            'messages': sum(topic.messages for topic in info.topics),
            'missing': info.missing, 'dropped': info.dropped, 'ended': info.ended,
            'lost': info.lost, 'damage': info.damage, 'about': info.about,
            'topics': [{'topic': topic.topic, 'type': topic.type, 'messages': topic.messages,
                        'missing': topic.missing} for topic in info.topics]}


def json_of_recomputed(bag: str | Path, result: Recomputed, tolerance: float,
                       accept_rounding: bool = False) -> Json:
    """Return the dict of a Recomputed."""
    problems = result.problems(tolerance, accept_rounding)
    return {'bag': str(bag), 'good': not problems, 'problems': problems,
            'by_rounding': result.is_rounding, 'verdict': result.verdict(),
            'largest': result.largest, 'tolerance': tolerance, 'cut': result.cut,
            'inputs': result.inputs, 'compared': result.compared, 'unmatched': result.unmatched,
            'missing': result.missing, 'doubled': result.doubled, 'silent': result.silent,
            'uncertain': result.uncertain, 'driven': result.driven,
            'differences': [difference._asdict() for difference in result.differences]}


def json_of_diff(first: str | Path, second: str | Path, topics: Sequence[TopicDiff],
                 tolerance: float) -> Json:
    """Return the dict of a list of TopicDiff."""
    return {'first': str(first), 'second': str(second), 'tolerance': tolerance,
            'same': all(topic.is_same(tolerance) for topic in topics),
            'topics': [{'topic': topic.topic, 'same': topic.is_same(tolerance),
                        'messages': topic.messages, 'only_first': topic.only_first,
                        'only_second': topic.only_second, 'largest': topic.largest}
                       for topic in topics]}
