"""What ``fourbar scene check`` prints: what a node with a scene does, and what a step costs."""
from __future__ import annotations

from timeit import repeat

from . import interfaces
from . import scene as scenes
from .core.status import evaluate
from .parameters import REQUIRED, find
from .show import make_console, plain_table, rate_unit

STEPS, ROUNDS = 2000, 5        # of the measurement: some 50 ms


def explain(path, console=None):
    """Print what a scene does; raises what :func:`fourbar_ros.scene.load` raises."""
    scene = scenes.load(path)
    console = console or make_console()
    linkage, drive = scene.linkage, scene.drive
    console.print(f'{path}: good. {linkage.classification}, mode {linkage.mode}.')
    console.print(_drive_in_words(scene))
    if not linkage.turns_fully and drive.source == 'timer':
        console.print('note: this input does not turn fully: the timer will drive it out of its range '
                      f'(drive.out_of_range: {drive.out_of_range})')
    console.print()
    console.print(_outputs_table(scene))
    console.print()
    changed = {name: value for name, value in scene.values.items()
               if find(name).default is not REQUIRED and value != find(name).default and value == value}
    table = plain_table('parameters that are not the default', ('parameter', 'value', 'unit'))
    for name, value in changed.items():
        table.add_row(name, str(value), find(name).unit)
    console.print(table)
    console.print()
    console.print(_cost_in_words(scene))


def _drive_in_words(scene):
    drive = scene.drive
    if drive.source == 'timer':
        return (f'The clock drives it: {drive.speed:g} {rate_unit(scene.linkage)} from {drive.start:g} '
                f'{rate_unit(scene.linkage)[:-2]}, {drive.rate:g} samples a second.')
    topic = interfaces.INPUTS[drive.source]
    of = f', joint {drive.joint}' if drive.joint else ''
    return f'Each {topic.type} on {topic.topic}{of} makes one step; missing rates are estimated from {drive.window} samples.'


def _outputs_table(scene):
    table = plain_table('outputs', ('name', 'topic', 'type', ''))
    for topic in scene.topics.values():
        table.add_row(topic.name, topic.topic, topic.type, 'loads' if topic.needs_loads else '')
    for name in interfaces.OUTPUTS.keys() - set(scene.outputs):
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
