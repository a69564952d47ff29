# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar replay``: publish a recorded run again, or drive a live node with it."""
import argparse

from fourbar_ros.cli.common import add_node, add_topics, add_verb, BAG_HELP, Verbs
from fourbar_ros.scene.units import of

DESCRIPTION = """\
Publish the messages of a bag again, with their original timing, topics and quality of service.
Requires ROS 2 and the packages of the message types; topics whose type is not installed are left
out with a warning. ros2 bag play does more: it pauses, remaps and takes keys.
"""
EPILOG = """\
examples:
  fourbar replay bags/run                              at the original speed
  fourbar replay bags/run --rate 0.1 --start 12        slowly, from second 12 on
  fourbar replay bags/run --clock --loop               for nodes with use_sim_time
  fourbar replay bags/run --topics /joint_states

  fourbar bag scene bags/run > again.yaml              repeat the run with a live node that
  fourbar_node --ros-args --params-file again.yaml -p recording.start:=true \\
      -p recording.name:=again &                       records its answers,
  fourbar replay bags/run --inputs-only                then compare them:
  fourbar bag diff bags/run bags/again
"""


def add(verbs: Verbs) -> None:
    replay = add_verb(verbs, 'replay', 'publish a recorded run again, or drive a live node with '
                                       'it', DESCRIPTION, EPILOG)
    replay.add_argument('bag', metavar='BAG', help=BAG_HELP)
    replay.add_argument('--rate', type=of(above=0.0), default=1.0, metavar='X',
                        help='play X times as fast (default 1)')
    replay.add_argument('--start', type=of('s', least=0.0), default=0.0, metavar='S',
                        help='skip the first S seconds, but of latched topics')
    replay.add_argument('--loop', action='store_true', help='repeat until stopped')
    replay.add_argument('--clock', nargs='?', type=of('Hz', above=0.0), default=0.0, const=100.0,
                        metavar='HZ', help='publish the time of the bag on /clock, HZ times a '
                                           'second (default 100), instead of a recorded /clock')
    replay.add_argument('--delay', type=of('s', least=0.0), default=1.0, metavar='S',
                        help='give subscribers S seconds to find the topics (default 1)')
    which = replay.add_mutually_exclusive_group()
    add_topics(which, 'publish only these topics')
    which.add_argument('--inputs-only', action='store_true',
                       help="send only the driven motion, to a live node's ~/input")
    add_node(replay)
    replay.add_argument('--ros-args', nargs=argparse.REMAINDER, default=[],
                        help='arguments for ROS, e.g. remappings')
    replay.set_defaults(run=_replay)


def _replay(arguments: argparse.Namespace) -> int:
    from fourbar_ros.errors import BagError
    from fourbar_ros.ros.replay import replay
    topics = {topic: topic for topic in arguments.topics} if arguments.topics else None
    if arguments.inputs_only:
        from fourbar_ros.bag.origin import origin_of
        from fourbar_ros.scene.topics import DRIVEN
        origin = origin_of(arguments.bag, arguments.node)
        topics = {origin.topics[DRIVEN.name]: f'{origin.node}/input'}
    count, stopped_by = replay(
        arguments.bag, topics, arguments.rate, arguments.start, arguments.loop, arguments.clock,
        arguments.delay, ['--ros-args', *arguments.ros_args] if arguments.ros_args else [],
        waits_for_node=arguments.inputs_only)
    if not count and not stopped_by:
        raise BagError(f'{arguments.bag}: no message after {arguments.start:g} s')
    print(f'{count} messages published')
    return 128 + stopped_by if stopped_by else 0
