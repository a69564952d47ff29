"""What ``fourbar scene check`` prints: what a node with a scene does, and what a step costs."""
from __future__ import annotations

from timeit import repeat

from fourbar_ros.scene.topics import INPUTS, OUTPUTS
from fourbar_ros.scene.scene import load
from fourbar_ros.errors import UNITS, in_words
from fourbar_ros.pipeline.status import OUT_OF_RANGE, evaluate
from fourbar_ros.scene.parameters import find
from fourbar_ros.report.tables import class_name, make_console, plain_table, rate_unit

STEPS, ROUNDS = 2000, 5        # of the measurement: some 50 ms


def explain(path, console=None):
    """Print what a scene does; raises what :func:`fourbar_ros.scene.scene.load` raises."""
    scene = load(path)
    console = console or make_console()
    linkage, drive = scene.linkage, scene.drive
    console.print(f'{path}: good. {class_name(linkage)}, mode {linkage.mode}.')
    console.print(_drive_in_words(scene))
    if drive.source == 'timer' and not linkage.turns_fully:
        console.print(_leaves_the_range(linkage, drive))
    console.print()
    console.print(_outputs_table(scene))
    console.print()
    changed = {name: value for name, value in scene.values.items()
               if value != find(name).default and value == value}
    table = plain_table('parameters that are not the default', ('parameter', 'value', 'unit'))
    for name, value in changed.items():
        table.add_row(name, str(value), _unit(find(name), linkage))
    console.print(table)
    console.print()
    console.print(_cost_in_words(scene))


def _unit(parameter, linkage):
    """Return the unit of a parameter; of one "rad or m" that of what is driven."""
    return parameter.unit.split(' or ')[-1 if linkage.is_driven_by_slide else 0]


def _leaves_the_range(linkage, drive):
    name = linkage.input_coordinate.position
    allowed = in_words(name, linkage.input_ranges)
    policy = f'(drive.out_of_range: {drive.out_of_range})'
    if evaluate(linkage, drive.start, 0.0, 0.0, False)[0] == OUT_OF_RANGE:
        return f'note: drive.start = {drive.start:g} {UNITS[name]} is outside {allowed} {policy}'
    return f'note: this input does not turn fully: the clock will drive it out of {allowed} {policy}'


def _drive_in_words(scene):
    drive = scene.drive
    if drive.source == 'timer':
        return (f'The clock drives it: {drive.speed:g} {rate_unit(scene.linkage)} from {drive.start:g} '
                f'{rate_unit(scene.linkage)[:-2]}, {drive.rate:g} samples a second.')
    topic = INPUTS[drive.source]
    of = f', joint {drive.joint}' if drive.joint else ''
    return f'Each {topic.type} on {topic.topic}{of} makes one step; missing rates are estimated from {drive.window} samples.'


def _outputs_table(scene):
    table = plain_table('outputs', ('name', 'topic', 'type', ''))
    for topic in scene.topics.values():
        table.add_row(topic.name, topic.topic, topic.type, 'loads' if topic.needs_loads else '')
    for name in OUTPUTS:
        if name not in scene.outputs:
            table.add_row(f'({name})', '', '', 'not named: not created')
    return table


def step_cost(scene):
    """Return the time of computing one step of a scene on this machine [s]: the best of some rounds."""
    low, high = scene.linkage.input_ranges[0]
    angle, speed = 0.5 * (low + high) + 0.1 * (high - low), scene.drive.speed
    return min(repeat(lambda: evaluate(scene.linkage, angle, speed, 0.0, scene.needs_loads),
                      number=STEPS, repeat=ROUNDS)) / STEPS


def _cost_in_words(scene):
    cost = step_cost(scene)
    computed = 'motion and loads' if scene.needs_loads else 'motion only, no load'
    rate = f', {100.0 * cost * scene.drive.rate:.2g} % of a core at {scene.drive.rate:g} Hz' \
        if scene.drive.source == 'timer' else ''
    return (f'A step computes {computed}: {cost * 1e6:.1f} us on this machine{rate}. Each topic that is heard or '
            'recorded costs more than that (see docs/bench/node.md); one that is neither costs nothing.')
