# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag recover``: make a whole bag of a cut or damaged one."""
from __future__ import annotations

from argparse import Namespace

from fourbar_ros.cli.common import BAD, BAG_HELP, reading, Verbs

PLACES = 50     # damaged places that are printed one by one


def add(actions: Verbs) -> None:
    """Add the action."""
    recover = actions.add_parser('recover', help='make a whole bag of a cut or damaged one',
                                 description='Make a whole bag of a cut or damaged one. Every '
                                             'intact record is copied, verified by its checksum; '
                                             'the old bag is only read.')
    recover.add_argument('bag', metavar='BAG', help=BAG_HELP)
    recover.add_argument('-o', '--out', metavar='DIR', help='folder of the new bag; default '
                                                            'NAME_recovered')
    recover.set_defaults(run=_recover)


def _recover(arguments: Namespace) -> int:
    from fourbar_ros.bag.recover import recover
    with reading(arguments.bag, 'recovering') as step:
        found = recover(arguments.bag, arguments.out, step)
    print(f'{found.path}: {found.messages} messages, '
          + (f'{found.lost} bytes lost' if found.lost else 'nothing lost'))
    for damage in found.damaged[:PLACES]:
        print(f'damaged: {damage}')
    if len(found.damaged) > PLACES:
        print(f'damaged: and {len(found.damaged) - PLACES} more places')
    for topic, count in found.missing.items():
        print(f'missing: {count} messages of {topic}')
    return BAD if found.lost or found.damaged or found.missing else 0
