"""``fourbar record``: start and stop the bag of a running node."""
from __future__ import annotations

import argparse

EPILOG = """\
examples:
  fourbar record start                    a fresh name from the clock
  fourbar record start trial_3
  fourbar record stop --node /cell/fourbar

The node writes the bag into its recording.directory. Needs ROS 2.
"""


def add(verbs):
    """Add the verb."""
    record = verbs.add_parser('record', help='start and stop the bag of a running node', epilog=EPILOG,
                              description='Ask a running node to record.',
                              formatter_class=argparse.RawDescriptionHelpFormatter)
    record.add_argument('what', metavar='start|stop', choices=('start', 'stop'), help='what to do')
    record.add_argument('name', metavar='NAME', nargs='?', default='',
                        help='start: name of the bag; default: a fresh one')
    record.add_argument('--node', default='/fourbar', help='the node, default /fourbar')
    record.set_defaults(run=_record)


def _record(arguments):
    from fourbar_ros.ros.clients.client import record
    print(record(arguments.what, arguments.name, arguments.node))
