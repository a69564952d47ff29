# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar show``: class, limits, extrema and loads of a scene, as tables."""
from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from fourbar_ros.cli.common import add_pose, add_verb, bar, SCENE_HELP, Verbs
from fourbar_ros.scene.arguments import positive

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_ros.mechanisms.mechanism import Mechanism
    from fourbar_ros.report.terminal import PlainTable
    from fourbar_ros.scene.scene import Scene

SECONDS = 5.0
EPILOG = """\
examples:
  fourbar show paper
  fourbar show my.yaml --mode 1 --speed 10
  fourbar show slides_7_6 --at 60 --acceleration 100
  fourbar show jansen --certify
"""


def add(verbs: Verbs) -> None:
    """Add the verb."""
    show = add_verb(verbs, 'show', 'class, modes, limits, extrema and loads of a scene, as tables',
                    'Show Grashof class, input range, transmission angle, all extrema of motion '
                    'and (with masses) of\nloads over the input at constant speed, and optionally '
                    'the state at one input.', EPILOG)
    show.add_argument('scene', metavar='SCENE', help=SCENE_HELP)
    add_pose(show, 'also show state and loads at this input angle [degrees], or slide [m]')
    show.add_argument('--certify', action='store_true',
                      help='also prove that no extremum inside the input range is missing, and '
                           'say of what that could not be proved')
    show.add_argument('--seconds', type=positive, default=SECONDS, metavar='SECONDS',
                      help='with --certify: processor time for each quantity, after which it is '
                           f'not proved (default {SECONDS:g})')
    show.set_defaults(run=_show)


def _show(arguments: Namespace) -> None:
    from fourbar_ros.report.poses import (
        evaluate_at,
        loads_table,
        motion_table,
        points_table,
        position_of,
    )
    from fourbar_ros.report.tables import what_it_is
    from fourbar_ros.report.terminal import make_console
    from fourbar_ros.scene.files import find
    from fourbar_ros.scene.scene import load
    path = find(arguments.scene)
    scene = load(path)
    mode = scene.in_mode(arguments.mode).mode
    linkage = scene.known_linkage.in_mode(mode)
    speed = scene.drive.speed if arguments.speed is None else arguments.speed
    pose = (None if arguments.at is None else evaluate_at(
        scene.linkage_at(scene.in_mode(mode), position_of(linkage, arguments.at), speed),
        arguments.at, speed, arguments.acceleration))
    tables: list[PlainTable | str | None] = [
        what_it_is(linkage, path), *_extrema_tables(scene, linkage, speed, arguments)]
    if scene.known_linkage is not scene.linkage:
        tables.append(scene.why_no_loads)
    elif linkage.bodies is None:
        tables.append('no masses given, so no loads: see bodies.* in docs/reference.md')
    if pose:
        tables += [motion_table(linkage, pose),
                   loads_table(linkage, pose.loads) if pose.loads else None,
                   points_table(linkage, pose.motion, scene.points) if scene.points else None]
    console = make_console()
    for place, table in enumerate(filter(None, tables)):
        if place and not isinstance(table, str):
            console.print()
        console.print(table)


def _extrema_tables(scene: Scene, linkage: Mechanism, speed: float, arguments: Namespace
                    ) -> list[PlainTable | str]:
    """Return the table of extrema and, if it was asked for, what is proved of them."""
    from fourbar_ros.extrema.find import find_extrema
    from fourbar_ros.mechanisms.quantities import select
    from fourbar_ros.report.tables import extrema_table, mode_name, proofs_in_words, rate_unit
    unit, acceleration = rate_unit(linkage), arguments.acceleration
    driven = f'{speed:g} {unit}' + (f' and {acceleration:g} {unit}^2' if acceleration else '')
    with bar('proof', 100) as done:
        found = find_extrema(linkage, select((), linkage, scene.point_quantities), speed,
                             acceleration, arguments.certify, seconds=arguments.seconds,
                             progress=lambda share: done(round(100.0 * share)))
    table = extrema_table(found, f'extrema at {driven}, mode {mode_name(linkage)}')
    return [table, proofs_in_words(found)] if arguments.certify else [table]
