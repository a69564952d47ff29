# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar list``: the scenes that come with the package."""
from argparse import Namespace
import re

from fourbar_ros.cli.common import add_verb, Verbs

EPILOG = """\
examples:
  fourbar list
  fourbar list robots
  fourbar show peaucellier
"""

# {title: folder below config}
SHELVES = {'scenes': '', 'classics': 'classics', 'robots': 'robots', 'studies': 'studies'}


def add(verbs: Verbs) -> None:
    every = add_verb(verbs, 'list', 'the scenes that come with the package',
                     'List the scenes that every verb takes by name, and the studies.', EPILOG)
    every.add_argument('shelf', metavar='SHELF', nargs='?', choices=SHELVES,
                       help=f'one of {", ".join(SHELVES)} (default: all)')
    every.set_defaults(run=_list)


def _list(arguments: Namespace) -> None:
    from fourbar_ros.scene.files import folder
    from fourbar_ros.terminal import make_console, make_table
    console = make_console()
    for title in [arguments.shelf] if arguments.shelf else SHELVES:
        console.print(make_table(title, ['name', 'text'], (
            (path.stem, about(path.read_text(encoding='utf-8')))
            for path in sorted((folder() / SHELVES[title]).glob('*.yaml')))))
        console.print()


def about(text: str) -> str:
    """Return the first sentence of the comment at the top of a scene file."""
    words = []
    for line in text.splitlines():
        if not line.startswith('#'):
            break
        words.append(line.lstrip('# '))
    return re.split(r'(?<=\S)\. ', ' '.join(words))[0].rstrip('.')      # not the dot of a product
