# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag export``: write the numbers in a bag as tables."""
from __future__ import annotations

from argparse import Namespace

from fourbar_ros.cli.common import add_topics, BAG_HELP, reading, Verbs


def add(actions: Verbs) -> None:
    """Add the action."""
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
    from fourbar_ros.bag.export import export
    with reading(arguments.bag, 'exporting') as step:
        written = export(arguments.bag, arguments.out, arguments.format, arguments.topics, step)
    for name, rows in written.items():
        print(f'{arguments.out}: {name}, {rows} rows')
