# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag plot``: plot fields over time or over another field."""
from __future__ import annotations

from argparse import Namespace

from fourbar_ros.cli.common import BAG_HELP, PICTURE_HELP, reading, Verbs


def add(actions: Verbs) -> None:
    """Add the action."""
    plot = actions.add_parser('plot', help='plot fields over time or over another field',
                              description='Plot fields over time, or over the field --x; fields '
                                          'of the same unit share an axis. Requires matplotlib.')
    plot.add_argument('bag', metavar='BAG', help=BAG_HELP)
    plot.add_argument('fields', metavar='TOPIC.FIELD', nargs='+',
                      help='e.g. state.theta4, /joint_states.position[crank] or '
                           'joint_states.position[0]')
    plot.add_argument('--x', metavar='TOPIC.FIELD',
                      help='field of the horizontal axis, e.g. state.theta1; values of the same '
                           'stamp belong together (default: time)')
    plot.add_argument('-o', '--out', metavar='FILE', required=True, help=PICTURE_HELP)
    plot.set_defaults(run=_plot)


def _plot(arguments: Namespace) -> None:
    from fourbar_ros.bag.plot import plot
    with reading(arguments.bag, 'reading') as step:
        plot(arguments.bag, arguments.fields, arguments.out, step, arguments.x)
    print(arguments.out)
