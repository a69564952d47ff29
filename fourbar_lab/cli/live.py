# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar live``: a page in the browser that shows a mechanism moving."""
from argparse import Namespace

from fourbar_ros.cli.common import add_output, add_scene, add_verb, Verbs
from fourbar_ros.errors import InvalidParameter

EPILOG = """\
examples:
  fourbar live paper                        drag a joint, type a length, see at once
  fourbar live                              draw a machine on an empty page
  fourbar live my.yaml paper                mine, and behind it the paper's in pale
  fourbar live my.yaml --port 8100 --no-browser
  fourbar live jansen -o jansen.html        one file that needs no server

The address of the page holds what you changed: a link to it shows the same to others who have
started the same scene, or have the file. The page is served to browsers of this machine only.
"""


def add(verbs: Verbs) -> None:
    live = add_verb(verbs, 'live', 'a page in the browser: the mechanism moving, curves, forces, '
                                   'extrema',
                    'Show a mechanism moving in the browser, with its curves, forces and extrema, '
                    'and a field\nfor every length, mass, spring and force.\n'
                    'Requires starlette and uvicorn: pip install starlette uvicorn; with -o '
                    'nothing.', EPILOG)
    add_scene(live, nargs='?')
    live.add_argument('second', metavar='SECOND', nargs='?',
                      help='a scene that is drawn in pale behind the first, with its curves')
    add_output(live, '-o', '--out', metavar='FILE.html', suffix='.html',
               help='write the page as one file, and serve nothing')
    live.add_argument('--port', type=int, metavar='PORT',
                      help='port of 127.0.0.1 (default 8420, or any free one if that is in use)')
    live.add_argument('--no-browser', action='store_true', help='print the address, open nothing')
    live.set_defaults(run=_live)


def _live(arguments: Namespace) -> None:
    from fourbar_ros.scene.scene import load
    scene, second = (name and load(name) for name in (arguments.scene, arguments.second))
    if scene and second:
        one, two = (each.linkage.input_coordinate.unit for each in (scene, second))
        if one != two:
            raise InvalidParameter('SECOND', arguments.second, f'has an input in {two}, and SCENE '
                                   f'in {one}: one input moves both')
    if arguments.out is None:
        from fourbar_lab.live.server import free_port, serve
        serve(arguments.scene, scene, free_port(arguments.port), not arguments.no_browser,
              second)
        return
    from fourbar_lab.live.page import page
    arguments.out.write_text(page(scene.name if scene else None, scene, second=second),
                             encoding='utf-8')
    print(arguments.out)
