# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar show``: class, limits, extrema and loads of a scene, as tables."""
from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.cli.common import (
    add_pose,
    add_scene,
    add_verb,
    bar,
    Json,
    json_line,
    Verbs,
    warn,
)
from fourbar_ros.errors import in_words, InvalidParameter
from fourbar_ros.scene.arguments import positive
from fourbar_ros.scene.units import of, require

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_lab.drawing.curves import Effort
    from fourbar_lab.drawing.poses import Pose
    from fourbar_ros.extrema.find import Extremum
    from fourbar_ros.mechanisms.mechanism import Mechanism
    from fourbar_ros.scene.scene import Scene
    from rich.table import Table

SECONDS = 5.0
EPILOG = """\
examples:
  fourbar show paper
  fourbar show my.yaml --mode 1 --speed 10
  fourbar show slides_7_6 --at 60 --acceleration 100
  fourbar show paper --from -30 --to 40        extrema where a robot moves
  fourbar show jansen --certify
  fourbar show paper --at 60 --json            all of it as one line of JSON, in SI units
"""


def add(verbs: Verbs) -> None:
    """Add ``fourbar show`` with its arguments."""
    show = add_verb(verbs, 'show', 'class, modes, limits, extrema and loads of a scene, as tables',
                    'Show Grashof class, input range, transmission angle, all extrema of motion '
                    'and (with masses) of\nloads over the input at constant speed, and optionally '
                    'the state at one input.', EPILOG)
    add_scene(show)
    add_pose(show, 'also show state and loads at this input angle [degrees], or slide [m]')
    show.add_argument('--from', dest='low', type=of('angle', 'length'), metavar='INPUT',
                      help='with --to: extrema between these inputs alone [degrees or m], whose '
                           'values at both count too')
    show.add_argument('--to', dest='high', type=of('angle', 'length'), metavar='INPUT',
                      help='see --from; an angle at most 360 degrees beyond it')
    show.add_argument('--certify', action='store_true',
                      help='also prove that no extremum inside the input range is missing, and '
                           'say of what that could not be proved')
    show.add_argument('--seconds', type=positive, default=SECONDS, metavar='SECONDS',
                      help='with --certify: processor time for each quantity, after which it is '
                           f'not proved (default {SECONDS:g})')
    show.add_argument('--json', action='store_true',
                      help='print the same as one line of JSON, in SI units, angles in rad')
    show.set_defaults(run=_show)


def _show(arguments: Namespace) -> None:
    """Find the extrema of a scene in a mode, and its pose if asked for; print or dump both."""
    from fourbar_lab.drawing.poses import evaluate_at, position_of, require_units
    from fourbar_ros.scene.files import find
    from fourbar_ros.scene.scene import load
    path = find(arguments.scene)
    scene = load(path)
    linkage = scene.in_mode(arguments.mode)
    require_units(linkage, arguments.at, arguments.speed, arguments.acceleration)
    speed = scene.drive.speed if arguments.speed is None else arguments.speed
    pose = (None if arguments.at is None else evaluate_at(
        scene.linkage_at(position_of(linkage, arguments.at), speed, linkage.mode),
        arguments.at, speed, arguments.acceleration))
    shown = Shown(path, scene, linkage, speed, arguments.acceleration, pose,
                  _within(linkage, arguments.low, arguments.high))
    extrema = _extrema(shown, arguments)
    if arguments.json:
        print(json_line(_record(shown, extrema)))
    else:
        _print(shown, extrema, arguments.certify)
    warn(scene)


class Shown(NamedTuple):
    """A linkage of a scene in one mode, its rates, and one pose if the user asked for it."""

    path: Path
    scene: Scene
    linkage: Mechanism
    speed: float
    acceleration: float
    pose: Pose | None
    within: tuple[float, float] | None      # inputs between which to search [rad or m]

    @property
    def with_masses(self) -> Mechanism:
        """Return the linkage with the masses of the scene, for tables of what it is."""
        return self.scene.bare_linkage.in_mode(self.linkage.mode)

    @property
    def why_no_loads(self) -> str:
        """Return the reason why there are no loads, '' if there are loads."""
        return (self.scene.why_no_loads if self.scene.has_loads else
                'no masses given, so no loads: see bodies.* in docs/reference.md')


def _within(linkage: Mechanism, low: float | None,
            high: float | None) -> tuple[float, float] | None:
    """Return --from and --to [rad or m], None if neither is given."""
    from fourbar_lab.drawing.poses import position_of
    if low is None or high is None:
        if low is not high:
            raise InvalidParameter('--from, --to', None, 'one needs the other')
        return None
    dimension = 'length' if linkage.is_driven_by_slide else 'angle'
    require('--from', low, dimension)
    require('--to', high, dimension)
    return position_of(linkage, low), position_of(linkage, high)


def _record(shown: Shown, extrema: list[Extremum]) -> Json:
    """Return all that ``show`` prints as one record in SI units."""
    from fourbar_lab.drawing.record import record_of
    return {'scene': str(shown.path), 'speed': shown.speed, 'acceleration': shown.acceleration,
            **({'within': list(shown.within)} if shown.within else {}),
            'why_no_loads': shown.why_no_loads,
            **({} if shown.why_no_loads else {'drive_effort': _effort(shown)._asdict()}),
            **record_of(shown.with_masses, extrema, shown.scene.points, shown.pose)}


def _print(shown: Shown, extrema: list[Extremum], with_proofs: bool) -> None:
    """Print the tables: properties, extrema, and with a pose its motion, loads and points."""
    from fourbar_lab.drawing.poses import loads_table, motion_table, points_table
    from fourbar_lab.drawing.tables import (
        extrema_table,
        mode_name,
        proofs_in_words,
        rate_unit,
        what_it_is,
    )
    from fourbar_ros.terminal import make_console
    linkage, pose, points = shown.linkage, shown.pose, shown.scene.points
    rates = f'{shown.speed:g} {rate_unit(linkage)}'
    if shown.acceleration:
        rates += f' and {shown.acceleration:g} {rate_unit(linkage)}^2'
    if shown.within:
        rates += f' in {in_words([shown.within], linkage.input_coordinate.unit)}'
    tables: list[Table | str | None] = [
        what_it_is(shown.with_masses, shown.path),
        extrema_table(linkage, extrema, f'extrema at {rates}, mode {mode_name(linkage)}'),
        proofs_in_words(extrema) if with_proofs else None,
        shown.why_no_loads or _effort_in_words(shown)]
    if pose:
        tables += [motion_table(linkage, pose),
                   loads_table(linkage, pose.loads) if pose.loads else None,
                   points_table(linkage, pose.motion, points) if points else None]
    console = make_console()
    for place, table in enumerate(filter(None, tables)):
        if place and not isinstance(table, str):
            console.print()
        console.print(table)


def _effort(shown: Shown) -> Effort:
    """Return the effort of the drive at the rates of the tables."""
    from fourbar_lab.drawing.curves import effort_of
    return effort_of(shown.scene, shown.linkage, shown.speed, shown.acceleration, shown.within)


def _effort_in_words(shown: Shown) -> str:
    """Return the line about the effort of the drive."""
    effort, unit = _effort(shown), 'N' if shown.linkage.is_driven_by_slide else 'N m'
    return (f'{shown.linkage.drive_load.replace("_", " ")}: root mean square '
            f'{effort.root_mean_square:.6g} {unit}, peak {effort.peak:.6g} {unit} over the input')


def _extrema(shown: Shown, arguments: Namespace) -> list[Extremum]:
    """Return the extrema of all quantities; a proof of them shows its progress."""
    from fourbar_ros.extrema.find import find_extrema
    from fourbar_ros.mechanisms.quantities import select
    with bar('proof', 100) as done:
        return find_extrema(
            shown.linkage, select((), shown.linkage, shown.scene.point_quantities), shown.speed,
            shown.acceleration, arguments.certify, seconds=arguments.seconds,
            progress=lambda share: done(round(100.0 * share)), within=shown.within)
