"""``fourbar show``."""
from __future__ import annotations

from fourbar_ros.scene.arguments import finite

EPILOG = """\
examples:
  fourbar show paper
  fourbar show my.yaml --mode 1 --speed 10
  fourbar show slides_7_6 --at 60 --acceleration 100
"""


def add(verbs):
    """Add the verb."""
    from argparse import RawDescriptionHelpFormatter
    show = verbs.add_parser(
        'show', help='class, modes, limits, extrema and loads of a scene, as tables',
        description='Show what a scene is: Grashof class, input range, transmission angle, all extrema of motion '
                    'and (with masses) of loads over the input at constant speed, and the state at one input.',
        epilog=EPILOG, formatter_class=RawDescriptionHelpFormatter)
    show.add_argument('scene', metavar='SCENE', help='parameter file (YAML), or name of a shipped scene, as paper')
    pose(show, 'also state and loads at this input angle [degrees], or slide [m]')
    show.set_defaults(run=_show)


def pose(verb, what_at, is_required=False):
    """Add the arguments that say how a scene moves: shared by show and draw."""
    verb.add_argument('--at', type=finite, required=is_required, metavar='INPUT', help=what_at)
    verb.add_argument('--speed', type=finite, metavar='SPEED',
                      help='input speed [rad/s], of a slide [m/s]; default: drive.speed of the scene')
    verb.add_argument('--acceleration', type=finite, default=0.0, metavar='ACCELERATION',
                      help='of the input [rad/s^2], of a slide [m/s^2]; default 0')
    verb.add_argument('--mode', type=int, choices=(1, 2), help='assembly mode; default: that of the scene')


def _show(arguments):
    from fourbar_ros.report.tables import show
    show(arguments.scene, arguments.mode, arguments.speed, arguments.at, arguments.acceleration)
