# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""An action on one bag, reported in full, or on several, as a table or JSON lines."""
from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros.cli.common import BAD, bar, reading


class Report(NamedTuple):
    """How the result of an action is reported."""

    to_json: Callable[[Any, Any], dict[str, Any]]      # of a bag and its result
    to_text: Callable[[Any, Any], None]      # prints it in full
    columns: Sequence[str]                   # of the table, behind the bag
    to_row: Callable[[Any], Sequence[str]]
    is_good: Callable[[Any], bool]


def add_bags(parser: ArgumentParser) -> None:
    """Add the arguments for several bags."""
    parser.add_argument('bags', metavar='BAG', nargs='+',
                        help='folder of a bag, .mcap file, or folder of bags')
    parser.add_argument('--jobs', type=int, default=0, metavar='N',
                        help='number of bags to process in parallel; default: one per processor')


def run(arguments: Namespace, work: Callable[..., Any], text: str, report: Report) -> int:
    """Run ``work(bag, progress=...)`` on all bags, report, return the exit code."""
    from fourbar_ros.bag.many import bags_below, each
    bags = bags_below(arguments.bags)
    if len(bags) == 1:
        with reading(bags[0], text) as step:
            results = [work(bags[0], progress=step)]
    else:
        with bar(f'{text} {len(bags)} bags', len(bags)) as step:
            results = each(work, bags, arguments.jobs, step)
    if arguments.json:
        _print_json(bags, results, report)
    elif len(bags) == 1:
        report.to_text(bags[0], results[0])
    else:
        _print_table(bags, results, report)
    if any(isinstance(result, Exception) for result in results):
        return 1
    return 0 if all(map(report.is_good, results)) else BAD


def _print_json(bags: Sequence[Path], results: Sequence[Any], report: Report) -> None:
    from fourbar_ros.bag import as_json
    for bag, result in zip(bags, results):
        is_error = isinstance(result, Exception)
        print(as_json.line(as_json.of_error(bag, result) if is_error
                           else report.to_json(bag, result)))


def _print_table(bags: Sequence[Path], results: Sequence[Any], report: Report) -> None:
    from fourbar_ros.report.terminal import make_console, plain_table
    table = plain_table('', ('bag', *report.columns))
    for bag, result in zip(bags, results):
        if isinstance(result, Exception):
            table.add_row(str(bag), *[''] * (len(report.columns) - 1), f'error: {result}')
        else:
            table.add_row(str(bag), *report.to_row(result))
    make_console().print(table)
