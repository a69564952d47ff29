# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar record``: start and stop the bag of a running node."""
from argparse import Namespace

from fourbar_ros.cli.common import add_verb, Verbs
from fourbar_ros.scene.units import of

EPILOG = """\
examples:
  fourbar record start                    with a new name from the clock
  fourbar record start trial_3
  fourbar record stop --node /cell/fourbar

The node writes the bag into its recording.directory. Requires ROS 2.
"""


def add(verbs: Verbs) -> None:
    record = add_verb(verbs, 'record', 'start or stop the bag of a running node',
                      'Start or stop the bag of a running node.', EPILOG)
    record.add_argument('what', metavar='start|stop', choices=('start', 'stop'),
                        help='what the node is to do')
    record.add_argument('name', metavar='NAME', nargs='?', default='',
                        help='name of the new bag; default: a new name from the clock')
    record.add_argument('--node', default='/fourbar', help='name of the node (default /fourbar)')
    record.add_argument('--wait', type=of('s', above=0.0), default=10.0, metavar='S',
                        help='how long to wait for the node, and then for its answer [s] '
                             '(default 10)')
    record.set_defaults(run=_record)


def _record(arguments: Namespace) -> None:
    from fourbar_lab.clients.node_client import record
    print(record(arguments.what, arguments.name, arguments.node, arguments.wait))
