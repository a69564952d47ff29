# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag scene``: print the scene of a bag as a parameter file."""
from __future__ import annotations

from argparse import Namespace

from fourbar_ros.cli.common import add_node, BAG_HELP, Verbs


def add(actions: Verbs) -> None:
    """Add the action."""
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
    from fourbar_ros.bag.info import parameter_file
    print(parameter_file(arguments.bag, arguments.drive, arguments.node), end='')
