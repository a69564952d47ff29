# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar scene``: what the node of a scene does and costs; the file of a scene."""
from argparse import Namespace
from timeit import repeat

from fourbar_ros.cli.common import add_output, add_scene, Verbs, write_or_print
from fourbar_ros.scene.linkage import leaves_range, links_without_mass
from fourbar_ros.scene.parameters import of_name, shown_unit
from fourbar_ros.scene.scene import load, Scene
from fourbar_ros.scene.topics import OUTPUTS, PICTURES
from fourbar_ros.terminal import make_console, make_table

STEPS, ROUNDS = 2000, 5        # of the measured computing time: some 50 ms in all
INPUTS_OF_ERROR, INPUTS_OF_ARRAYS = 64, 100_000
LONG = 20                      # numbers above which a table is shown by its ends


def add(verbs: Verbs) -> None:
    verb = verbs.add_parser('scene', help='check a scene file; explain what its node does and '
                                          'costs; print a shipped one',
                            description='Check or print a scene file without starting anything.')
    actions = verb.add_subparsers(dest='action', required=True, metavar='ACTION')
    check = actions.add_parser(
        'check', help='explain a scene, or report in one line what is wrong with it',
        description='Show what a node with this scene receives, publishes and computes, and what '
                    'a step costs on this machine. For an invalid scene: one line that names the '
                    'parameter, exit code 1.')
    add_scene(check)
    check.add_argument('--error', action='store_true',
                       help='also measure rounding errors, beside the same formulas in 160 digits')
    check.set_defaults(run=_check)
    show = actions.add_parser(
        'print', help='print the file of a scene, to make your own of it',
        description='Print the file of a scene, or write it: fourbar scene print stephenson -o '
                    'my.yaml')
    add_scene(show)
    add_output(show, '-o', '--out', metavar='FILE', suffix='.yaml',
               help='file to write; default: standard output')
    show.set_defaults(run=_print)


def _print(arguments: Namespace) -> None:
    from fourbar_ros.scene.files import loadable_text
    write_or_print(loadable_text(arguments.scene), arguments.out)


def _check(arguments: Namespace) -> None:
    scene, console = load(arguments.scene), make_console()
    linkage, drive = scene.linkage, scene.drive
    if scene.pictures:
        from fourbar_ros.description.formats import check_pictures
        check_pictures(scene)
    console.print(f'{arguments.scene}: valid. {linkage.description}, mode {linkage.mode}.')
    if linkage.branch_in_words:
        console.print(f'Change point: {linkage.branch_in_words}.')
    if massless := links_without_mass(linkage):
        console.print(f'Links without mass: {", ".join(link.name for link in massless)}.')
    line = leaves_range(scene)
    if line and line not in scene.warnings:
        console.print(f'note: {line}')
    left_out = [name for name in (*OUTPUTS, *PICTURES) if name not in scene.outputs]
    not_created = [f'not created: {", ".join(left_out)}'] if left_out else []
    sent = [*scene.topics.values(), *scene.pictures.values()]
    received, outputs = [make_table(title, ('name', 'topic', 'type', ''), [
        (topic.name, topic.topic, topic.type, 'loads' if topic.needs_loads else '')
        for topic in topics]) for title, topics in (('inputs', scene.received), ('outputs', sent))]
    cost = step_cost(scene)
    computed = ('motion and loads' if scene.needs_loads else 'motion alone: no output needs loads'
                if linkage.has_loads else 'motion alone')
    rate = (f', {100.0 * cost * drive.rate:.2g} % of a core at {drive.rate:g} Hz'
            if drive.source == 'timer' or scene.dynamics else '')
    cost_in_words = (
        f'A step computes {computed}: {cost * 1e6:.1f} us on this machine{rate}. Each topic '
        'with a subscriber or a recorder costs more than that (see docs/bench/node.md), each '
        'one without costs nothing.')
    changed = make_table('parameters that differ from their default',
                         ('parameter', 'value', 'unit'))
    for name, value in scene.values.items():
        parameter = of_name(name)
        if value != parameter.default and value == value:       # NaN: not given
            text = str(value)
            if isinstance(value, list) and len(value) > LONG:
                text = f'{len(value)} numbers: {value[0]}, {value[1]}, ... {value[-1]}'
            changed.add_row(name, text, shown_unit(name, scene.values))
    for paragraph in (*([received] if scene.received else []), outputs, *not_created, changed,
                      cost_in_words):
        console.print()
        console.print(paragraph)
    if arguments.error:
        console.print('\n'.join(errors_and_times(scene)))


def errors_and_times(scene: Scene) -> list[str]:
    """Return two lines: rounding errors and computing time of a step, and of arrays."""
    from fourbar_ros.mechanisms.quantities import known_quantities
    from fourbar_ros.mechanisms.rounding import rounding_errors
    import numpy as np
    linkage, speed = scene.linkage, scene.drive.speed
    low, high = linkage.input_ranges[0]
    positions = low + (high - low) * (np.arange(INPUTS_OF_ERROR) + 0.5) / INPUTS_OF_ERROR
    errors = rounding_errors(linkage, positions.tolist(), speed, 0.0, linkage.has_loads)
    worst = []
    for sort, is_load in (('rates and accelerations', False), ('loads', True)):
        names = [name for name, quantity in known_quantities(linkage, linkage.input).items()
                 if quantity.is_load == is_load and name in errors]
        if names:
            name = max(names, key=errors.__getitem__)
            worst.append(f'of {sort} {errors[name]:.1g} ({name})')
    evaluated = linkage.step if linkage.has_loads else linkage.motion
    inputs = np.resize(positions, INPUTS_OF_ARRAYS)
    seconds = min(repeat(lambda: evaluated(inputs, speed), number=1, repeat=ROUNDS))
    return [f'A step: {1e6 * step_cost(scene):.1f} us. Largest rounding errors at '
            f'{INPUTS_OF_ERROR} inputs and {speed:g} {linkage.input_coordinate.unit}/s, over the '
            f'largest value of their sort: {", ".join(worst)}.',
            f'An array of {INPUTS_OF_ARRAYS}: {1e6 * seconds / INPUTS_OF_ARRAYS:.3f} us a sample, '
            'by the same formulas.']


def step_cost(scene: Scene) -> float:
    """Return the computing time of one step on this machine [s]: the least mean of 5 rounds."""
    from fourbar_ros.pipeline.stepper import evaluate  # not to print a scene
    linkage = scene.linkage
    low, high = linkage.input_ranges[0]
    position, speed = 0.5 * (low + high) + 0.1 * (high - low), scene.drive.speed
    return min(repeat(lambda: evaluate(linkage, position, speed, 0.0, scene.needs_loads),
                      number=STEPS, repeat=ROUNDS)) / STEPS
