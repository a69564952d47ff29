# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar describe``: a scene as URDF or MJCF."""
from argparse import Namespace
import sys

from fourbar_ros.cli.common import add_output, add_scene, add_verb, Verbs, write_or_print
from fourbar_ros.errors import InvalidParameter

SUFFIXES = {'': 'urdf', '.urdf': 'urdf', '.mjcf': 'mjcf', '.xml': 'mjcf'}
EPILOG = """\
examples:
  fourbar describe paper                     URDF on the screen
  fourbar describe cylinder -o boom.urdf
  fourbar describe paper --as mjcf -o paper.xml

URDF cannot close a loop: the tree is cut at one joint of each loop, and two frames there,
closing_NAME_1 and closing_NAME_2, coincide as long as the joint states belong together. Publish
those of the node (output joint_states), which has all joints; never joint_state_publisher's.
docs/robots.md has the rest.
"""


def add(verbs: Verbs) -> None:
    verb = add_verb(verbs, 'describe', 'write a scene as URDF or MJCF',
                    'Write a scene as a robot description: URDF (ROS, RViz, MoveIt, Foxglove) '
                    'or MJCF (MuJoCo),\nwith masses, joint names and senses of the scene, in its '
                    'assembly mode.', EPILOG)
    add_scene(verb)
    verb.add_argument('--as', dest='format', choices=('urdf', 'mjcf'),
                      help='format; default: that of the file name, else urdf')
    add_output(verb, '-o', '--out', metavar='FILE',
               help='file to write (.urdf, .mjcf, .xml); default: print it')
    verb.set_defaults(run=_describe)


def _describe(arguments: Namespace) -> None:
    from fourbar_ros.description.formats import describe
    from fourbar_ros.description.model import left_out, note_of
    from fourbar_ros.scene.scene import load
    suffix = arguments.out.suffix if arguments.out else ''
    format_, scene = arguments.format or SUFFIXES.get(suffix), load(arguments.scene)
    if not format_:
        raise InvalidParameter('--out', str(arguments.out), f'must end in '
                               f'{", ".join(filter(None, SUFFIXES))}, unless --as is given')
    write_or_print(describe(scene, format_), arguments.out)
    if note := note_of(scene):
        print(note, file=sys.stderr)
    if format_ == 'mjcf' and (names := left_out(scene)):        # MuJoCo moves it without them
        print(f'note: not in the file: {", ".join(names)}', file=sys.stderr)
