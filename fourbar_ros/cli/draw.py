# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar draw``: a scene in one pose, with forces and polygons."""
from __future__ import annotations

from fourbar_ros.cli.common import add_pose, add_verb, PICTURE_HELP, SCENE_HELP

EPILOG = """\
examples:
  fourbar draw paper --at 60 -o pose.pdf
  fourbar draw slides_7_6 --at 60 --speed 10 --acceleration 100 -o example_7_6.svg
"""


def add(verbs):
    """Add the verb."""
    draw = add_verb(verbs, 'draw', 'draw a scene in one pose: linkage with forces, velocity and '
                                   'acceleration polygons',
                    'Draw the linkage with its joint forces and its velocity and acceleration '
                    'polygons, to scale.\nRequires matplotlib.', EPILOG)
    draw.add_argument('scene', metavar='SCENE', help=SCENE_HELP)
    add_pose(draw, 'input angle [degrees], or slide [m]', is_required=True)
    draw.add_argument('-o', '--out', metavar='FILE', required=True, help=PICTURE_HELP)
    draw.set_defaults(run=_draw)


def _draw(arguments):
    from fourbar_ros.report.drawing import make_figure, save
    from fourbar_ros.report.poses import step_at
    from fourbar_ros.report.tables import class_name, mode_name, rate_unit
    from fourbar_ros.scene.scene import load
    scene = load(arguments.scene)
    linkage = scene.linkage.in_mode(arguments.mode or scene.linkage.mode)
    speed = scene.drive.speed if arguments.speed is None else arguments.speed
    _, motion, loads = step_at(linkage, arguments.at, speed, arguments.acceleration)
    pose = (f'{linkage.input_coordinate.position} {arguments.at:.8g} '
            f'{"m" if linkage.is_driven_by_slide else "deg"}')
    unit = rate_unit(linkage)
    title = ', '.join([class_name(linkage), pose, f'{speed:g} {unit}',
                       *([f'{arguments.acceleration:g} {unit}^2']
                         if arguments.acceleration else []),
                       f'assembly mode {mode_name(linkage)}'])
    points = {name: tuple(point) for name, point in scene.points.items()}
    print(save(make_figure(linkage, motion, loads, title, points), arguments.out))
