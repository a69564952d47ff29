# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar live``: a page in the browser that shows a mechanism moving."""
from __future__ import annotations

from argparse import Namespace

from fourbar_ros.cli.common import add_scene, add_verb, Verbs

EPILOG = """\
examples:
  fourbar live paper                        move the sliders, drag a joint, see at once
  fourbar live my.yaml --port 8100 --no-browser

The address of the page holds what you changed: a link to it shows the same to others who have
started the same scene. The page is served to browsers of this machine only.
"""


def add(verbs: Verbs) -> None:
    live = add_verb(verbs, 'live', 'a page in the browser: the mechanism moving, curves, forces, '
                                   'extrema',
                    'Show a mechanism moving in the browser, with its curves, forces, polygons '
                    'and extrema, and a slider\nfor every parameter.\n'
                    'Requires nicegui: pip install nicegui.', EPILOG)
    add_scene(live)
    live.add_argument('--port', type=int, metavar='PORT',
                      help='port of 127.0.0.1 (default 8420, or any free one if that is in use)')
    live.add_argument('--no-browser', action='store_true', help='print the address, open nothing')
    live.set_defaults(run=_live)


def _live(arguments: Namespace) -> None:
    from fourbar_lab.live.server import free_port, serve
    from fourbar_ros.scene.scene import load
    scene = load(arguments.scene)
    serve(str(arguments.scene), scene.values, free_port(arguments.port), not arguments.no_browser)
