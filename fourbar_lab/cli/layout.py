# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar layout``: what RViz, Foxglove or Lichtblick, and PlotJuggler show of a scene."""
from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from fourbar_ros.cli.common import add_scene, add_verb, Verbs, write_or_print

TOOLS = ('rviz', 'foxglove', 'plotjuggler')
EPILOG = """\
examples:
  fourbar layout slider_crank --for foxglove -o engine.json      Lichtblick reads it too
  fourbar layout paper --for plotjuggler -o paper.xml
  fourbar layout my.yaml --for rviz --node /left/leg -o leg.rviz

A layout shows what the scene names in `outputs`: plots of state, loads and points, and the
machine itself with robot_description, tf, markers or traces.
"""


def add(verbs: Verbs) -> None:
    """Add ``fourbar layout`` with its arguments."""
    verb = add_verb(verbs, 'layout', 'write a layout for RViz, Foxglove, Lichtblick or '
                                     'PlotJuggler',
                    'Write a layout that shows the outputs of a scene, live or from its bag.',
                    EPILOG)
    add_scene(verb)
    verb.add_argument('--for', dest='tool', choices=TOOLS, required=True,
                      help='program; foxglove is for Lichtblick too')
    verb.add_argument('--node', metavar='NAME', default='/fourbar',
                      help='full name of the node; default /fourbar')
    verb.add_argument('-o', '--out', metavar='FILE', type=Path,
                      help='file to write; default: print it')
    verb.set_defaults(run=_layout)


def _layout(arguments: Namespace) -> None:
    """Write or print the layout of a scene for one tool."""
    from fourbar_lab.export import layouts
    from fourbar_ros.errors import InvalidParameter
    from fourbar_ros.scene.scene import load
    scene, node = load(arguments.scene), '/' + arguments.node.strip('/')
    if arguments.tool == 'rviz' and not scene.pictures:
        raise InvalidParameter('outputs', list(scene.outputs),
                               'RViz shows robot_description, tf, markers and traces: name some')
    write_or_print(getattr(layouts, arguments.tool)(scene, node), arguments.out)
