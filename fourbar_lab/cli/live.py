# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar live``: a page in the browser that shows a mechanism moving."""
from __future__ import annotations

from argparse import Namespace
import gc
from pathlib import Path

from fourbar_ros.cli.common import add_verb, SCENE_HELP, Verbs
from fourbar_ros.scene.arguments import not_negative

EPILOG = """\
examples:
  fourbar live paper                        move the sliders, drag a joint, see at once
  fourbar live my.yaml --port 8100 --no-browser
  fourbar live bags/run                     scrub along a recorded run
  fourbar live bags/run bags/other          compare two
  fourbar live --node /fourbar              a running node; the sliders set its parameters

The address of the page holds what you changed: a link to it shows the same to others who have
started the same scene. The page is served to browsers of this machine only.
"""


def add(verbs: Verbs) -> None:
    """Add the verb."""
    live = add_verb(verbs, 'live', 'a page in the browser: the mechanism moving, curves, forces, '
                                   'extrema',
                    'Show a mechanism moving in the browser, with its curves, forces, polygons '
                    'and extrema, and a slider\nfor every parameter: of a scene, of recorded '
                    'runs, or of a running node.\n'
                    'Requires nicegui: pip install nicegui.', EPILOG)
    live.add_argument('what', metavar='SCENE | BAG', nargs='*',
                      help=f'{SCENE_HELP}; or bags to look at')
    live.add_argument('--node', metavar='NAME', help='a running node, or which node of a bag')
    live.add_argument('--wait', type=not_negative, default=10.0, metavar='SECONDS',
                      help='for the node to be found, and for each of its answers (default 10)')
    live.add_argument('--port', type=int, metavar='PORT',
                      help='port of 127.0.0.1 (default 8420, or any free one if that is in use)')
    live.add_argument('--no-browser', action='store_true', help='print the address, open nothing')
    live.set_defaults(run=_live)


def _is_bag(name: str) -> bool:
    """Return whether an argument names a bag: a folder, or an .mcap file."""
    path = Path(name)
    return path.suffix == '.mcap' or path.is_dir()


def _live(arguments: Namespace) -> None:
    """Serve the page of a scene, of bags or of a node until it is interrupted."""
    from fourbar_ros.errors import InvalidParameter
    from fourbar_ros.scene.files import find
    from fourbar_ros.scene.scene import load
    what, bags = arguments.what, [name for name in arguments.what if _is_bag(name)]
    if not what and not arguments.node:
        raise InvalidParameter('SCENE', None, 'must be given: a scene, bags or --node NAME')
    if len(what) > 1 and bags != what:
        raise InvalidParameter('SCENE', next(name for name in what if name not in bags),
                               'must be the only one, or all must be bags')
    scene = load(find(what[0])) if what and not bags else None
    # collections find nothing in what imports make, and take a tenth of the start
    gc.disable()
    from fourbar_lab.live.server import free_port, serve_node, serve_run, serve_scene
    gc.freeze()
    gc.enable()
    how = free_port(arguments.port), not arguments.no_browser
    if bags:
        serve_run(bags, arguments.node, *how)
    elif scene is None:
        serve_node(arguments.node, arguments.wait, *how)
    else:
        serve_scene(what[0], scene.values, *how)
