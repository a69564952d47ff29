# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar show``: class, limits, extrema and loads of a scene, as tables."""
from argparse import ArgumentTypeError, Namespace

from fourbar_lab.cli import asked
from fourbar_ros.cli.common import add_pose, add_scene, add_verb, bar, json_line, Verbs
from fourbar_ros.errors import in_words, InvalidParameter
from fourbar_ros.scene.units import of, quantity, require, WrongQuantity

SECONDS = 5.0
EPILOG = """\
examples:
  fourbar show paper
  fourbar show my.yaml --mode 1 --speed 10
  fourbar show slides_7_6 --at 60 --acceleration 100
  fourbar show paper --from -30 --to 40        extrema where a robot moves
  fourbar show jansen --certify
  fourbar show press --fluctuation 5%          the flywheel for that
  fourbar show paper --at 60 --json            all of it as one line of JSON, in SI units
"""


def add(verbs: Verbs) -> None:
    show = add_verb(verbs, 'show', 'class, modes, limits, extrema and loads of a scene, as tables',
                    'Show Grashof class, input range, transmission angle, all extrema of motion '
                    'and (with masses) of\nloads over the input at constant speed, and optionally '
                    'the state at one input.', EPILOG)
    add_scene(show)
    add_pose(show, 'also show state and loads at this input angle [degrees], or slide [m]')
    show.add_argument('--hold', type=of('rad', 'm'), metavar='INPUT',
                      help='also show between which drives it stays at rest at this input: with '
                           'friction a range')
    show.add_argument('--fluctuation', type=_share, metavar='F',
                      help='also show the smallest flywheel with which largest less least speed '
                           'of the crank is at most F of its mean, as 5%% or 0.05')
    show.add_argument('--from', dest='low', type=of('rad', 'm'), metavar='INPUT',
                      help='with --to: extrema between these inputs alone [degrees or m], whose '
                           'values at both count too')
    show.add_argument('--to', dest='high', type=of('rad', 'm'), metavar='INPUT',
                      help='see --from; an angle at most 360 degrees beyond it')
    show.add_argument('--certify', action='store_true',
                      help='also prove that no extremum inside the input range is missing, and '
                           'say of what that could not be proved')
    show.add_argument('--seconds', type=of('s', above=0.0), default=SECONDS, metavar='SECONDS',
                      help='with --certify: processor time for each quantity, after which it is '
                           f'not proved (default {SECONDS:g})')
    show.add_argument('--json', action='store_true',
                      help='print the same as one line of JSON, in SI units, angles in rad')
    show.set_defaults(run=_show)


def _share(text: str) -> float:
    try:
        share = quantity(text.removesuffix('%')) * (0.01 if text.endswith('%') else 1.0)
    except WrongQuantity as error:
        raise ArgumentTypeError(f'{text!r} {error}') from None
    if not 0.0 < share < 2.0:
        raise ArgumentTypeError(f'{text} must be a positive share below 2, as 5% or 0.05')
    return share


def _show(arguments: Namespace) -> None:
    from fourbar_lab.drawing import poses, record, tables
    from fourbar_ros import find_extrema
    from fourbar_ros.mechanisms.quantities import select
    from fourbar_ros.scene.elements import element_names
    from fourbar_ros.scene.files import find
    path, acceleration = find(arguments.scene), arguments.acceleration
    scene, linkage, speed = asked(arguments)
    by, driven = scene.drive, linkage.input_coordinate
    for option, value in (('--from', arguments.low), ('--to', arguments.high),
                          ('--hold', arguments.hold)):
        if value is not None:
            require(option, value, driven.unit)
    within: tuple[float, float] | None = None
    if arguments.low is not None and arguments.high is not None:
        within = (poses.position_of(linkage, arguments.low),
                  poses.position_of(linkage, arguments.high))
        if not within[0] < within[1]:
            raise InvalidParameter('--from', arguments.low, 'must be below --to' + (
                '' if linkage.is_driven_by_slide else '; across 0 degrees: --from -10 --to 10'))
    elif arguments.low is not arguments.high:
        raise InvalidParameter('--from, --to', None, 'one needs the other')
    counted = (f'; joint {by.joint} = {by.joint_ratio:g} * {driven.position} + '
               f'({poses.shown(driven, by.joint_offset)})' if by.joint else '')
    pose = (None if arguments.at is None else poses.evaluate_at(
        linkage, arguments.at, speed, acceleration, counted))
    hold = None if arguments.hold is None else poses.position_of(linkage, arguments.hold)
    quantities = select((), linkage, scene.point_quantities)
    if linkage.locked_ranges(speed, acceleration, within):      # there are no loads in them
        quantities = [quantity for quantity in quantities if not quantity.is_load]
    with bar('proof', 100, arguments.certify) as done:
        extrema = find_extrema(
            linkage, quantities, speed, acceleration, arguments.certify, seconds=arguments.seconds,
            progress=lambda share: done(round(100.0 * share)), within=within)
    drive = record.drive_of(linkage, speed, acceleration, within, extrema, hold)
    if arguments.fluctuation is not None:
        drive['flywheel'] = record.flywheel_of(linkage, speed, arguments.fluctuation)
    if arguments.json:
        print(json_line({
            'scene': str(path), 'speed': speed, 'acceleration': acceleration,
            **({'within': list(within)} if within else {}), 'why_no_loads': linkage.why_no_loads,
            'drive': drive, **record.record_of(linkage, extrema, scene.points, pose)}))
    else:
        from fourbar_ros.terminal import make_console, make_table
        rates = tables.rates_in_words(linkage, speed, acceleration)
        if within:
            rates += f' in {in_words([within], linkage.input_coordinate.unit)}'
        loads = {quantity.name for quantity in quantities if quantity.is_load}
        of_motion, of_loads = ([extremum for extremum in extrema
                                if (extremum.quantity in loads) is of_load]
                               for of_load in (False, True))
        title = f'at {rates}, mode {linkage.modes[linkage.mode]}'
        console = make_console()
        blocks = [
            tables.linkage_table(linkage, path),
            tables.extrema_table(linkage, of_motion, f'extrema of motion {title}'),
            linkage.why_no_loads or None,
            make_table('', ('', ''), tables.drive_in_words(linkage, drive, speed, acceleration)),
            tables.extrema_table(linkage, of_loads, f'extrema of loads {title}')
            if of_loads else None,
            tables.jumps_in_words(linkage, element_names(scene.values), of_loads,
                                  (speed, acceleration)) or None,
            tables.proofs_in_words(extrema) or None]
        if pose:
            blocks += [poses.motion_table(linkage, pose),
                       poses.loads_table(linkage, pose.loads) if pose.loads else None,
                       poses.points_table(linkage, pose.motion, scene.points)
                       if scene.points else None]
        for index, block in enumerate(filter(None, blocks)):
            if index and not isinstance(block, str):
                console.print()             # between tables; lines of text follow their table
            console.print(block)
