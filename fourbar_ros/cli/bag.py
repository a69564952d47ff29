# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag``: inspect, repair, check and convert a recorded run."""
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from datetime import datetime
import sys

from fourbar_ros import optional, spreadsheet, terminal
from fourbar_ros.cli import common

MOST_DAMAGE = 50        # lines on damage that are printed one by one
DESCRIPTION = """\
Inspect, repair, check and convert a recorded run. BAG is the folder of a bag or its .mcap file:
finished, cut off by a crash, or still being written. No action changes a bag, or overwrites a
file without --force.
"""
EPILOG = """\
examples:
  fourbar bag info bags/run --check
  fourbar bag recover bags/run                        writes bags/run_recovered
  fourbar bag recompute bags/run
  fourbar bag export bags/run -o run.npz
  fourbar bag plot bags/run state.theta4 loads.f41 -o run.png
  fourbar bag diff bags/run bags/other --tolerance 1e-12
  ls -d bags/* | xargs -n1 -P2 fourbar bag recompute --json      many bags, one line each

exit codes: 0 good; 1 an error, reported in one line; 2 bad arguments; 130, 143 interrupted by
Ctrl-C or SIGTERM, with no partial output left; 3 done, but
  info       the bag is unfinished or damaged, or messages are missing or misfits
  recover    something could not be read
  recompute  a value differs by more than the tolerance, an output is missing,
             duplicated or without its input, or nothing could be compared
  export     a topic was left out: its messages are not known here
  diff       the bags differ
"""


def add(verbs: common.Verbs) -> None:
    bag = common.add_verb(verbs, 'bag', 'info, recover, recompute, export, plot, diff, scene: '
                          'work with a recorded run', DESCRIPTION, EPILOG)
    actions = bag.add_subparsers(dest='action', required=True, metavar='ACTION')
    info = _action(actions, 'info', _info, 'show what a bag contains and whether it is sound')
    common.add_json(info)
    info.add_argument('--check', action='store_true',
                      help='read every message: verify checksums, sequence numbers to find '
                           'missing messages, and that each fits its definition (misfits)')

    recover = _action(actions, 'recover', _recover, 'make a whole bag of a cut or damaged one',
                      '. Every readable message is copied, verified by its checksum; the old bag '
                      'is only read.')
    recover.add_argument('-o', '--out', metavar='DIR',
                         help='folder of the new bag; default NAME_recovered')

    recompute = _action(
        actions, 'recompute', _recompute, 'recompute every recorded output and compare',
        '. Outputs follow from the driven motion and the scene, both of which are in the bag. '
        'Bags of this version of the software differ by exactly 0; those of another version may '
        'differ by rounding: accept that with --tolerance.')
    common.add_json(recompute)
    common.add_tolerance(recompute)
    common.add_node(recompute)

    export = _action(actions, 'export', _export, 'write the numbers in a bag as tables',
                     ': CSV, NumPy (.npz) or Parquet.')
    export.add_argument('-o', '--out', metavar='PATH', required=True,
                        help='new folder for the tables, new .npz file, or new .csv or .parquet '
                             'file for one topic, which - prints as CSV')
    export.add_argument('--format', choices=('csv', 'npz', 'parquet'),
                        help='default: by the ending of PATH, csv for a folder; parquet requires '
                             'pyarrow')
    common.add_topics(export, 'export only these topics')
    common.add_csv(export, 'units of the columns that measure the same: mm,deg,rpm; columns whose '
                   'unit is known then have it in their head, others are as recorded')

    plot = _action(actions, 'plot', _plot, 'plot fields over time or over another field',
                   '; fields of the same unit share an axis. Requires matplotlib.')
    plot.add_argument('fields', metavar='TOPIC.FIELD', nargs='+',
                      help='e.g. state.theta4 or /joint_states.position[crank]')
    plot.add_argument('--x', metavar='TOPIC.FIELD',
                      help='field of the horizontal axis, e.g. state.theta1; values of the same '
                           'stamp belong together (default: time)')
    common.add_picture(plot)

    diff = _action(actions, 'diff', _diff, 'compare two bags message by message',
                   ': those with the same stamp, field by field.')
    diff.add_argument('second', metavar='OTHER', help=common.BAG_HELP)
    common.add_tolerance(diff)
    common.add_topics(diff, 'compare only these topics')
    common.add_json(diff)

    scene = _action(
        actions, 'scene', _scene, 'print the scene of a bag as a parameter file',
        ', for a node that the bag is to drive (drive.source: motion): see fourbar replay '
        '--inputs-only.')
    scene.add_argument('--drive', choices=('motion', 'timer'), default='motion',
                       help='drive.source in the parameter file (default motion)')
    common.add_node(scene)


def _action(actions: common.Verbs, name: str, run: Callable[[Namespace], int | None], text: str,
            more: str = '.') -> ArgumentParser:
    """Add an action on one bag; return its parser. It is described by its help and ``more``."""
    description = text[0].upper() + text[1:] + more
    parser: ArgumentParser = actions.add_parser(name, help=text, description=description)
    parser.add_argument('bag', metavar='BAG', help=common.BAG_HELP)
    parser.set_defaults(run=run)
    return parser


def _info(arguments: Namespace) -> int:
    from fourbar_ros.bag.overview import info
    from fourbar_ros.bag.reader import software_of
    with common.reading(arguments.bag, 'reading') as step:
        bag = info(arguments.bag, arguments.check, step)
    if arguments.json:
        print(common.json_line({
            'bag': str(arguments.bag), 'sound': bag.is_sound, 'finished': bag.is_finished,
            'size': bag.size, 'files': bag.files, 'start': bag.start, 'end': bag.end,
            'messages': sum(topic.messages for topic in bag.topics), 'missing': bag.missing,
            'misfits': bag.misfits, 'dropped': bag.dropped, 'ended': bag.ended,
            'damage': bag.damage, 'about': bag.about,
            'topics': [topic._asdict() for topic in bag.topics]}))
        return 0 if bag.is_sound else common.BAD
    seconds, begin = 0.0, ''
    if bag.start is not None and bag.end is not None:
        seconds = (bag.end - bag.start) * 1e-9
        begin = datetime.fromtimestamp(bag.start * 1e-9).astimezone().isoformat(
            ' ', 'milliseconds')
    rows = (('bag', str(bag.path)),
            ('state', 'finished' if bag.is_finished else
             'unfinished: being written, or cut off by a crash or a full disk'),
            ('size', f'{bag.size / 1e6:.3f} MB'
             + (f' in {bag.files} files' if bag.files > 1 else '')),
            ('start', begin), ('duration', f'{seconds:.3f} s'),
            ('made by', ', '.join(map(' '.join, software_of(bag.about).items()))),
            ('node', bag.about.get('node', '')), ('ended', bag.ended),
            ('dropped', f'{bag.dropped} messages' if bag.dropped else ''), ('lost', bag.lost),
            ('damage', bag.damage))
    console = terminal.make_console()
    console.print(terminal.make_table('', ('', ''), [row for row in rows if row[1]]))
    console.print(terminal.make_table(
        '', ('topic', 'type', 'messages>', 'Hz>', 'missing>', 'misfits>'),
        [(topic.topic, topic.type, str(topic.messages),
          f'{(topic.messages - 1) / seconds:.2f}' if seconds and topic.messages > 1 else '',
          *('' if count is None else str(count) for count in (topic.missing, topic.misfits)))
         for topic in bag.topics]))
    if not bag.is_finished or bag.damage:
        print('fourbar bag recover makes a whole bag of what can be read')
    return 0 if bag.is_sound else common.BAD


def _recover(arguments: Namespace) -> int:
    from fourbar_ros.bag.recovery import recover
    with common.reading(arguments.bag, 'recovering') as step:
        recovered = recover(arguments.bag, arguments.out, step)
    print(f'{recovered.path}: {recovered.messages} messages'
          + ('' if recovered.damage else ', nothing lost' if recovered.was_whole else
             ', all that can be read; the bag is without its end or a file'))
    for damage in recovered.damage[:MOST_DAMAGE]:
        print(f'damaged: {damage}')
    if len(recovered.damage) > MOST_DAMAGE:
        print(f'damaged: and {len(recovered.damage) - MOST_DAMAGE} more places')
    return common.BAD if recovered.damage else 0


def _recompute(arguments: Namespace) -> int:
    from fourbar_ros.bag.recomputation import recompute
    with common.reading(arguments.bag, 'recomputing') as step:
        result = recompute(arguments.bag, arguments.node, step)
    problems = result.problems(arguments.tolerance)
    if arguments.json:
        print(common.json_line({
            'bag': str(arguments.bag), 'good': not problems, 'problems': problems,
            'largest': result.largest, 'tolerance': arguments.tolerance, 'cut': result.is_cut,
            'inputs': result.inputs, 'compared': result.compared, 'unmatched': result.unmatched,
            'missing': result.missing, 'doubled': result.doubled, 'skipped': result.skipped,
            'stepped': result.stepped, 'other_branch': result.other_branch,
            'differences': [difference._asdict() for difference in result.differences]}))
    else:
        table = terminal.make_table('', ('topic', 'field', 'messages>', 'largest difference>'))
        for topic in dict.fromkeys(difference.topic for difference in result.differences):
            of_topic = [each for each in result.differences if each.topic == topic]
            shown = [each for each in of_topic if each.largest > arguments.tolerance]
            for difference in shown:
                table.add_row(topic, difference.field, str(difference.messages),
                              f'{difference.largest:g}')
            if not shown:       # a row for all
                table.add_row(topic, f'all {len(of_topic)}', str(of_topic[0].messages),
                              f'{max(each.largest for each in of_topic):g}')
        if result.differences:
            terminal.make_console().print(table)
        print(f'{result.inputs} driven motions, {result.compared} outputs compared; largest '
              f'difference {result.largest:g}' + ('; the bag is cut' if result.is_cut else ''))
        if result.stepped:
            print(f'{result.stepped} states of the drive stepped again from the one before')
        if result.other_branch:
            print(f'{result.other_branch} driven motions are on the other branch of a change '
                  'point: the bag is from before 2.0, when a mode was a side')
        for why, count in result.skipped.items():
            print(f'not compared: {count} outputs {why}')
        for problem in problems:
            print(f'bad: {problem}')
    return common.BAD if problems else 0


def _export(arguments: Namespace) -> int:
    from fourbar_ros.bag.tables import export
    left_out: list[str] = []
    style = spreadsheet.CsvStyle(arguments.digits, arguments.excel)
    with common.reading(arguments.bag, 'exporting') as step:
        written = export(arguments.bag, arguments.out, arguments.format, arguments.topics, step,
                         left_out.append, style, arguments.units or None)
    told = sys.stderr if arguments.out == str(spreadsheet.STDOUT) else sys.stdout
    for name, rows in written.items():
        print(f'{arguments.out}: {name}, {rows} rows', file=told)
    for text in left_out:
        print(text, file=told)
    return common.BAD if left_out else 0


def _plot(arguments: Namespace) -> None:
    with common.reading(arguments.bag, 'reading') as step:
        optional.lab('plot')(arguments.bag, arguments.fields, arguments.out, step, arguments.x,
                             arguments.width, arguments.title)
    print(arguments.out)


def _diff(arguments: Namespace) -> int:
    from fourbar_ros.bag.comparison import diff
    first, second, tolerance = arguments.bag, arguments.second, arguments.tolerance
    with common.reading(first, 'comparing topic by topic') as step:
        topics = diff(first, second, arguments.topics, step)
    is_same = all(topic.is_same(tolerance) for topic in topics)
    if arguments.json:
        print(common.json_line({
            'first': first, 'second': second, 'tolerance': tolerance, 'same': is_same,
            'topics': [{**topic._asdict(), 'same': topic.is_same(tolerance)}
                       for topic in topics]}))
        return 0 if is_same else common.BAD
    table = terminal.make_table('', ('topic', 'in both>', 'only first>', 'only second>', 'field',
                                     'largest difference>'))
    for topic in topics:
        worst = [(field, apart) for field, apart in topic.largest.items() if apart > tolerance]
        field, apart = worst[0] if worst else ('', 0.0)
        table.add_row(topic.topic, str(topic.messages), str(topic.only_first),
                      str(topic.only_second), field, f'{apart:g}')
        for field, apart in worst[1:]:
            table.add_row('', '', '', '', field, f'{apart:g}')
    terminal.make_console().print(table)
    return 0 if is_same else common.BAD


def _scene(arguments: Namespace) -> None:
    from fourbar_ros.bag.overview import parameter_file
    print(parameter_file(arguments.bag, arguments.drive, arguments.node), end='')
