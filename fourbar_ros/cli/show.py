"""``fourbar show``: class, limits, extrema and loads of a scene, as tables."""
from __future__ import annotations

from fourbar_ros.cli.common import SCENE_HELP, add_pose, add_verb

EPILOG = """\
examples:
  fourbar show paper
  fourbar show my.yaml --mode 1 --speed 10
  fourbar show slides_7_6 --at 60 --acceleration 100
"""


def add(verbs):
    """Add the verb."""
    show = add_verb(verbs, 'show', 'class, modes, limits, extrema and loads of a scene, as tables',
                    'Show Grashof class, input range, transmission angle, all extrema of motion and (with masses) of\n'
                    'loads over the input at constant speed, and optionally the state at one input.', EPILOG)
    show.add_argument('scene', metavar='SCENE', help=SCENE_HELP)
    add_pose(show, 'also show state and loads at this input angle [degrees], or slide [m]')
    show.set_defaults(run=_show)


def _show(arguments):
    from fourbar_ros.report.tables import show
    show(arguments.scene, arguments.mode, arguments.speed, arguments.at, arguments.acceleration)
