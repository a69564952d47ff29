"""The ``fourbar`` command: what can be known of a scene without ROS."""
from __future__ import annotations

import argparse
import sys

from . import __version__
from .core import FourBarError

DESCRIPTION = """\
Planar four-bar linkages: motion, loads and extremes of a scene. Needs no ROS.

A scene is a ROS 2 parameter file (see config/): the same file runs the node,
  fourbar_node --ros-args --params-file SCENE
"""
EPILOG = """\
examples:
  fourbar show config/paper.yaml               class, limits, extremes, loads
  fourbar show config/paper.yaml --mode 1      of the other assembly mode
  fourbar show config/slides_7_7.yaml --speed 10 --at 24.6475
"""


def parser():
    """Return the argument parser; every verb sets ``run``."""
    top = argparse.ArgumentParser(prog='fourbar', description=DESCRIPTION, epilog=EPILOG,
                                  formatter_class=argparse.RawDescriptionHelpFormatter)
    top.add_argument('--version', action='version', version=f'fourbar {__version__}')
    verbs = top.add_subparsers(dest='verb', required=True, metavar='VERB')

    show = verbs.add_parser(
        'show', help='class, modes, limits, extremes and loads of a scene, as tables',
        description='Show what a scene is: Grashof class, input range, transmission angle, all extremes of '
                    'motion and (with masses) of loads at constant input speed, and the state at one angle.')
    show.add_argument('scene', metavar='SCENE', help='parameter file of the scene (YAML)')
    show.add_argument('--mode', type=int, choices=(1, 2), help='assembly mode; default: that of the scene')
    show.add_argument('--speed', type=float, metavar='RAD_S',
                      help='constant input speed [rad/s]; default: drive.speed of the scene')
    show.add_argument('--at', type=float, metavar='DEG',
                      help='also state and loads at this input angle [degrees]')
    show.set_defaults(run=_show)
    return top


def _show(arguments):
    from .show import show
    show(arguments.scene, arguments.mode, arguments.speed, arguments.at)


def main(args=None):
    """Run one verb; exit code 0, 1 for an error of the verb (one line on stderr), 2 for bad arguments."""
    arguments = parser().parse_args(args)
    try:
        arguments.run(arguments)
    except FourBarError as error:
        print(f'fourbar: {error}', file=sys.stderr)
        return 1
    except BrokenPipeError:                 # the reader of our output has gone: head, less
        sys.stderr.close()
    return 0


if __name__ == '__main__':
    sys.exit(main())
