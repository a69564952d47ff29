"""``fourbar draw``: a scene in one pose, with forces and polygons."""
from __future__ import annotations

import argparse

TITLE_WIDTH = 48       # letters over one panel
EPILOG = """\
examples:
  fourbar draw config/paper.yaml --at 60 -o pose.pdf
  fourbar draw config/slides_7_6.yaml --at 60 --speed 10 --acceleration 100 -o example_7_6.svg
"""


def add(verbs):
    """Add the verb."""
    draw = verbs.add_parser(
        'draw', help='picture of a scene in one pose: linkage with forces, velocity and acceleration polygons',
        description='Draw the linkage with the forces at its joints, and its velocity and acceleration polygons, '
                    'to scale. Needs matplotlib.',
        epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    draw.add_argument('scene', metavar='SCENE', help='parameter file of the scene (YAML)')
    draw.add_argument('--at', type=float, required=True, metavar='INPUT', help='input angle [degrees], or slide [m]')
    draw.add_argument('--speed', type=float, metavar='SPEED', help='input speed [rad/s], of a slide [m/s]; default: that of the scene')
    draw.add_argument('--acceleration', type=float, default=0.0, metavar='ACCELERATION',
                      help='of the input [rad/s^2], of a slide [m/s^2]; default 0')
    draw.add_argument('--mode', type=int, choices=(1, 2), help='assembly mode; default: that of the scene')
    draw.add_argument('-o', '--out', metavar='FILE', required=True, help='picture: .png, .svg, .pdf')
    draw.set_defaults(run=_draw)


def _draw(arguments):
    from math import radians
    from textwrap import fill

    from .. import scene as scenes
    from ..draw import make_figure, save
    from ..show import class_name, rate_unit
    scene = scenes.load(arguments.scene)
    linkage = scene.linkage.in_mode(arguments.mode or scene.linkage.mode)
    speed = scene.drive.speed if arguments.speed is None else arguments.speed
    at = arguments.at if linkage.is_driven_by_slide else radians(arguments.at)
    given = (at, speed, arguments.acceleration)
    motion, loads = linkage.step(*given) if linkage.bodies else (linkage.motion(*given), None)
    pose = f'{linkage.input_coordinate.position} {arguments.at:.8g} {"m" if linkage.is_driven_by_slide else "deg"}'
    # no line ends inside of these
    pose, rate = (text.replace(' ', '\N{NO-BREAK SPACE}') for text in (pose, f'{speed:g} {rate_unit(linkage)}'))
    title = fill(f'{class_name(linkage)}, {pose}, {rate}', TITLE_WIDTH)
    save(make_figure(linkage, motion, loads, title), arguments.out)
    print(arguments.out)
