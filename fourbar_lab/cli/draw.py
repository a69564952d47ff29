# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar draw``: a scene in one pose, with forces and polygons."""
from argparse import Namespace

from fourbar_lab.cli import asked
from fourbar_ros.cli.common import add_picture, add_pose, add_scene, add_verb, Verbs
from fourbar_ros.errors import InvalidParameter

EPILOG = """\
examples:
  fourbar draw paper --at 60 -o pose.pdf
  fourbar draw slides_7_6 --at 60 --speed 10 --acceleration 100 -o example_7_6.svg
  fourbar draw paper --animate -o paper.gif          the linkage moving through a cycle
  fourbar draw paper --at 60 --over linkage -o linkage.svg     without forces and polygons
  fourbar draw paper --over paths -o paths.pdf       coupler curves of the points
  fourbar draw paper --over forces -o polar.svg      shaking force and bearing loads as vectors
  fourbar draw paper --at 60 --width 88mm -o column.pdf     for a column of a journal
  fourbar draw slides_7_7 --over axis -o axis.svg    why omega4 is extreme: the collineation axis
"""


def add(verbs: Verbs) -> None:
    draw = add_verb(verbs, 'draw', 'draw a scene in one pose: linkage with forces, velocity and '
                                   'acceleration polygons',
                    'Draw the linkage with its joint forces and its velocity and acceleration '
                    'polygons, to scale.\nRequires matplotlib.', EPILOG)
    add_scene(draw)
    add_pose(draw, 'input angle [degrees], or slide [m]')
    draw.add_argument('--animate', action='store_true',
                      help='instead of one pose: a cycle, as .gif')
    draw.add_argument('--over', choices=('linkage', 'paths', 'forces', 'axis'),
                      help='linkage: without forces and polygons; paths of the points over a '
                           'cycle, or the forces on the ground as vectors; axis: the '
                           'collineation axis with its poles, at --at or where the output is '
                           'fastest, and its angle to the coupler over a cycle')
    add_picture(draw)
    draw.set_defaults(run=_draw)


def _draw(arguments: Namespace) -> None:
    from fourbar_lab.drawing import animation, figure, views
    scene, linkage, speed = asked(arguments)
    if arguments.animate:
        for option in ('at', 'over', 'acceleration', 'width', 'title'):
            if getattr(arguments, option) not in (None, 0.0):
                raise InvalidParameter('--animate', None, f'has no --{option}')
        print(animation.animate(linkage, speed, scene.points, arguments.out))
    elif arguments.at is None and not arguments.over:
        raise InvalidParameter('--at', None, 'must be given, or --animate, or --over')
    else:
        print(figure.save(views.draw(
            scene, arguments.at, arguments.over or '', arguments.speed, arguments.acceleration,
            arguments.mode, arguments.title, arguments.width), arguments.out))
