"""``fourbar bag``: look at, repair, check, convert recorded runs."""
from __future__ import annotations

import argparse
from contextlib import contextmanager

from fourbar_ros.scene.arguments import not_negative
from fourbar_ros.cli import several

BAD = 3         # exit code: done, but what was asked about is not as it should be
MANY = object()
PLACES = 50     # of damage that are printed one by one
DESCRIPTION = """\
Recorded runs. BAG is the folder of a bag or its .mcap file: finished, cut by a crash, or still being
written. Nothing here changes a bag or overwrites a file. info and recompute take several bags, and folders
of bags, each bag in a process of its own.
"""
EPILOG = """\
examples:
  fourbar bag info bags/run --check
  fourbar bag recover bags/run                        makes bags/run_recovered
  fourbar bag recompute bags/run
  fourbar bag info bags --check                       all bags below a folder
  fourbar bag recompute bags --json                   a line of JSON for every bag
  fourbar bag export bags/run -o run.npz
  fourbar bag plot bags/run state.theta4 loads.f41 -o run.png
  fourbar bag diff bags/run bags/other --tolerance 1e-12

exit codes: 0 good; 1 an error, said in one line; 2 bad arguments; 130, 143 ended by Ctrl-C, SIGTERM, with
nothing half-made left; 3 done, but
  info       the bag is not finished, damaged, or messages are missing
  recover    something was lost or damaged
  recompute  a value differs by more than the tolerance, a message is missing, doubled or without its input, or
             nothing could be compared
  diff       the bags differ
"""


def add(verbs):
    """Add the verb."""
    raw = argparse.RawDescriptionHelpFormatter
    bag = verbs.add_parser('bag', help='info, recover, recompute, export, plot, diff, scene of recorded runs',
                           description=DESCRIPTION, epilog=EPILOG, formatter_class=raw)
    actions = bag.add_subparsers(dest='action', required=True, metavar='ACTION')

    def action(name, run, text, more='', bags=1):
        made = actions.add_parser(name, help=text, description=f'{text[0].upper()}{text[1:]}. {more}')
        if bags is MANY:
            made.add_argument('bags', metavar='BAG', nargs='+', help='folder of a bag, .mcap file, or folder of bags')
            made.add_argument('--jobs', type=int, default=0, metavar='N',
                              help='so many bags at a time, default: one for each processor')
        for metavar in () if bags is MANY else ('BAG',) if bags == 1 else ('FIRST', 'SECOND'):
            made.add_argument(metavar.lower(), metavar=metavar, help='folder of a bag or .mcap file')
        made.set_defaults(run=run)
        return made

    info = action('info', several.info, 'what is in a bag and whether it is sound', bags=MANY)
    _json(info)
    info.add_argument('--check', action='store_true',
                      help='read every message: checksums, and numbers that show a missing one')

    recover = action('recover', _recover, 'make a whole bag of a cut or damaged one',
                     'Every whole record is copied, checked against its checksum; the old bag is only read.')
    recover.add_argument('-o', '--out', metavar='DIR', help='folder of the new bag; default NAME_recovered')

    recompute = action('recompute', several.recompute, 'compute every recorded output again and compare',
                       'The motion of the input and the scene are in the bag. A bag of this version of the '
                       'software differs by exactly 0.', bags=MANY)
    _json(recompute)
    _tolerance(recompute)
    _node(recompute)

    export = action('export', _export, 'write the numbers of a bag as tables')
    export.add_argument('-o', '--out', metavar='PATH', required=True,
                        help='new folder for the tables, or new .npz file')
    export.add_argument('--format', choices=('csv', 'npz', 'parquet'),
                        help='default: npz if PATH ends so, else csv; parquet needs pyarrow')
    _topics(export)

    plot = action('plot', _plot, 'draw fields over time',
                  'Fields of one unit share an axis. Needs matplotlib.')
    plot.add_argument('fields', metavar='TOPIC.FIELD', nargs='+',
                      help='as state.theta4, /joint_states.position[crank] or joint_states.position[0]')
    plot.add_argument('-o', '--out', metavar='FILE', required=True, help='picture: .png, .svg, .pdf')

    diff = action('diff', _diff, 'compare two bags message by message',
                  'Messages with the same stamp are compared field by field.', bags=2)
    _tolerance(diff)
    _topics(diff)
    _json(diff)

    scene = action('scene', _scene, 'print the scene of a bag as a parameter file',
                   'For a node that is to be driven by the bag (drive.source: motion): see fourbar replay '
                   '--inputs-only.')
    scene.add_argument('--drive', choices=('motion', 'timer'), default='motion',
                       help='what moves the input of that node (default motion)')
    _node(scene)


def _json(parser):
    parser.add_argument('--json', action='store_true', help='a line of JSON for every bag; keys: docs/recording.md')


def _node(parser):
    parser.add_argument('--node', metavar='NAME', help='which node, of a bag of ros2 bag record with several')


def _tolerance(parser):
    parser.add_argument('--tolerance', type=not_negative, default=0.0, metavar='X',
                        help='largest absolute difference that is none, default 0')


def _topics(parser):
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help='only these')


def print_info(bag, found, arguments):
    """Print the Info of one bag."""
    from datetime import datetime

    from fourbar_ros.bag.info import software_of
    from fourbar_ros.report.tables import make_console, plain_table
    console = make_console()
    about = plain_table(str(found.file), ('', ''))
    about.show_header = False
    seconds = (found.end - found.start) * 1e-9 if found.start is not None else 0.0
    read = 'read up to the damage' if found.damage else 'every message read'
    about.add_row('state', found.state + (f', {read}' if arguments.check else ''))
    about.add_row('size', f'{found.size / 1e6:.3f} MB' + (f' in {found.parts} parts' if found.parts > 1 else ''))
    if found.start is not None:
        about.add_row('start', datetime.fromtimestamp(found.start * 1e-9).astimezone().isoformat(' ', 'milliseconds'))
    about.add_row('duration', f'{seconds:.3f} s')
    for label, text in (('made by', software_of(found.about)), ('node', found.about.get('node')),
                        ('ended', found.ended), ('dropped', found.dropped and f'{found.dropped} messages'),
                        ('recovered without', found.lost), ('damage', found.damage)):
        if text:
            about.add_row(label, text)
    console.print(about)
    table = plain_table('', ('topic', 'type', 'messages>', 'Hz>', 'missing>'))
    for topic in found.topics:
        rate = f'{(topic.messages - 1) / seconds:.2f}' if seconds and topic.messages > 1 else ''
        table.add_row(topic.topic, topic.type, str(topic.messages), rate,
                      '' if topic.missing is None else str(topic.missing))
    console.print(table)
    if found.state == 'cut':
        console.print('it was cut, by a crash or a full disk: fourbar bag recover makes it whole')
    elif found.damage:
        console.print('fourbar bag recover makes a whole bag of the rest')


def _recover(arguments):
    from fourbar_ros.bag.recover import recover
    with progress(arguments.bag, 'recovering') as step:
        found = recover(arguments.bag, arguments.out, step)
    print(f'{found.path}: {found.messages} messages, '
          + (f'{found.lost} bytes lost' if found.lost else 'nothing lost'))
    for damage in found.damaged[:PLACES]:
        print(f'damaged: {damage}')
    if len(found.damaged) > PLACES:
        print(f'damaged: and at {len(found.damaged) - PLACES} more places')
    for topic, count in found.missing.items():
        print(f'missing: {count} messages of {topic}')
    return BAD if found.lost or found.damaged or found.missing else 0


def print_recomputed(bag, found, arguments):
    """Print the Recomputed of one bag."""
    from fourbar_ros.report.tables import make_console, plain_table
    console = make_console()
    table = plain_table('', ('topic', 'field', 'messages>', 'largest difference>'))
    for topic in dict.fromkeys(difference.topic for difference in found.differences):
        of_topic = [d for d in found.differences if d.topic == topic]
        shown = [d for d in of_topic if d.largest > arguments.tolerance]
        for difference in shown:
            table.add_row(topic, difference.field, str(difference.messages), f'{difference.largest:g}')
        if not shown:
            table.add_row(topic, f'all {len(of_topic)}', str(of_topic[0].messages),
                          f'{max(d.largest for d in of_topic):g}')
    if found.differences:
        console.print(table)
    print(f'{found.inputs} motions of the input, {found.compared} outputs compared; largest difference '
          f'{found.largest:g}' + ('; the bag is cut' if found.cut else ''))
    print(f'motion of the input: {found.driven}')
    for count, text in ((found.silent, 'outputs say that the input had stopped'),
                        (found.uncertain, 'outputs not compared: the bag does not tell what they follow from')):
        if count:
            print(f'{count} {text}')
    for problem in found.problems(arguments.tolerance):
        print(f'bad: {problem}')


def _export(arguments):
    from fourbar_ros.bag.export import export
    format_ = arguments.format or ('npz' if arguments.out.endswith('.npz') else 'csv')
    with progress(arguments.bag, 'exporting') as step:
        written = export(arguments.bag, arguments.out, format_, arguments.topics, step)
    for name, rows in written.items():
        print(f'{arguments.out}: {name}, {rows} rows')


def _plot(arguments):
    from fourbar_ros.bag.plot import plot
    with progress(arguments.bag, 'reading') as step:
        plot(arguments.bag, arguments.fields, arguments.out, step)
    print(arguments.out)


def _diff(arguments):
    from fourbar_ros.bag.diff import diff
    from fourbar_ros.report.tables import make_console, plain_table
    with progress(arguments.first, 'comparing topic by topic') as step:
        found = diff(arguments.first, arguments.second, arguments.topics, step)
    same = all(topic.is_same(arguments.tolerance) for topic in found)
    if arguments.json:
        from fourbar_ros.bag import as_json
        print(as_json.line(as_json.of_diff(arguments.first, arguments.second, found, arguments.tolerance)))
        return 0 if same else BAD
    table = plain_table('', ('topic', 'in both>', 'only first>', 'only second>', 'field', 'largest difference>'))
    for topic in found:
        worst = [d for d in topic.differences if d.largest > arguments.tolerance]
        counts = [str(n) for n in (topic.messages, topic.only_first, topic.only_second)]
        table.add_row(topic.topic, *counts, worst[0].field if worst else '', f'{worst[0].largest:g}' if worst else '0')
        for difference in worst[1:]:
            table.add_row('', '', '', '', difference.field, f'{difference.largest:g}')
    make_console().print(table)
    return 0 if same else BAD


def _scene(arguments):
    from fourbar_ros.bag.info import parameter_file
    print(parameter_file(arguments.bag, arguments.drive, arguments.node), end='')


@contextmanager
def progress(path, text):
    """Show a bar on the terminal while a bag is read; gives the function to call with the bytes read."""
    from rich.console import Console
    from rich.progress import Progress

    from fourbar_ros.bag.rosbag2 import files_of
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(text, total=sum(file.stat().st_size for file in files_of(path)))
        yield lambda read: bar.update(task, completed=read)
