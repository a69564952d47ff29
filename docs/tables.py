# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Write the tables of the docs that have a source in the code: ``python docs/tables.py``.

Text between ``<!-- NAME -->`` and ``<!-- end -->`` is replaced; a test checks that nothing is out
of date.
"""
import argparse
from collections import Counter
from math import isnan
from pathlib import Path
import re
import sys

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / 'docs')]

import formulas  # noqa: E402
from fourbar_lab.studies.measures import INPUT, OF_MECHANISM, PARTS, QUANTITY  # noqa: E402
from fourbar_ros import load_scene  # noqa: E402, I100
from fourbar_ros.cli import main  # noqa: E402
from fourbar_ros.mechanisms.kinds import KINDS  # noqa: E402
from fourbar_ros.mechanisms.load_table import LOADS  # noqa: E402
from fourbar_ros.mechanisms.quantities import (  # noqa: E402
    known_quantities,
    of_drive,
    POSITIONS,
    positions,
    QUANTITIES,
)
from fourbar_ros.scene.settings import (  # noqa: E402
    FAMILIES,
    PARAMETERS,
    REQUIRED,
)
from fourbar_ros.scene.topics import (  # noqa: E402
    applied_topic,
    DRIVE_STATE,
    DRIVEN,
    FRAME,
    INPUTS,
    OUTPUTS,
    PICTURES,
    SCENE,
    SERVICES,
    TORQUE,
    TRAJECTORIES,
    wrench_topic,
)
from fourbar_ros.scene.units import UNITS  # noqa: E402

DOCS, MESSAGE = ROOT / 'docs', ROOT / 'msg_defs/msg/LinkageLoads.msg'
# how the names of parameters begin that a node has, and no desk needs
OF_NODE = (
    'outputs', 'pictures', 'services', 'frame', 'joint_', 'trajector', 'recording', 'base.',
    'external.timeout', 'external.when', 'external.extra', 'external.NAME.from_topic',
    'drive.rate', 'drive.when', 'drive.joint', 'drive.window', 'drive.jump', 'drive.top_speed',
    'drive.timeout', 'drive.out_of_range', 'drive.budget'
)
COMMON = 3              # so many verbs share an argument that is listed once


def default(parameter):
    """Return the default of a parameter as text."""
    if parameter.default is REQUIRED:
        return 'required'
    if isinstance(parameter.default, float) and isnan(parameter.default):
        return 'not given'
    if parameter.default in ('', []):
        return 'empty'
    return f'`{parameter.default}`'.replace("'", '')


def having(quantity):
    """Return which mechanisms have a quantity, as text."""
    found = []
    for name, kind in KINDS.items():
        inputs = [driven for driven in kind.INPUTS if quantity in known_quantities(kind, driven)
                  | positions(kind, driven) | of_drive(kind, driven)]
        if inputs:
            found.append(name if len(inputs) == len(kind.INPUTS)
                         else f'{name} driven at its {inputs[0]}')
    return 'all kinds' if found == list(KINDS) else ', '.join(found)


def drive_quantities():
    """Return rows of the quantities of the drive, with the units that kinds and inputs have."""
    every = [quantity for kind in KINDS.values() for driven in kind.INPUTS
             for quantity in of_drive(kind, driven).values()]
    return [(f'`{name}`', ' or '.join(dict.fromkeys(
        quantity.unit or '1' for quantity in every if quantity.name == name)),
             next(quantity.text for quantity in every if quantity.name == name), having(name))
            for name in dict.fromkeys(quantity.name for quantity in every)]


def messages():
    """Return Markdown: each message and service as its definition has it."""
    files = [file for part in ('msg', 'srv')
             for file in sorted((ROOT / 'msg_defs' / part).iterdir())]
    return '\n\n'.join(f'### {file.parent.name}/{file.stem}\n\n```text\n'
                       f'{file.read_text(encoding="utf-8").strip()}\n```' for file in files)


def parameters(of_node):
    """Return the table of the parameters of a node, or of what a desk needs of its scene."""
    return formulas.table(
        ('parameter', 'type', 'unit', 'default', 'allowed', 'live', 'what'),
        [(f'`{p.name}`', p.type, p.unit, default(p), p.allowed, 'yes' if p.live else '', p.text)
         for table_of in (PARAMETERS, *FAMILIES.values()) for p in table_of.values()
         if p.name.startswith(OF_NODE) == of_node])


def fields():
    """Return the table of the fields of motion and loads, and which kinds have them."""
    known = {}          # {(name, unit, meaning): kinds}
    for kind_name, kind in KINDS.items():
        for name in (*kind.MOTION._shown, *kind.LOADS._shown):
            record = kind.MOTION if name in kind.MOTION._shown else kind.LOADS
            unit, _, text = getattr(record, name).__doc__.removeprefix('[').partition('] ')
            known.setdefault((name, unit, text), []).append(kind_name)
    return formulas.table(
        ('field', 'unit', 'what', 'of'),
        [(f'`{name}`', unit, text, 'all kinds' if kinds == list(KINDS) else ', '.join(kinds))
         for (name, unit, text), kinds in known.items()])


def robot_tables():
    """Return {name: Markdown} of reference_robot.md."""
    table = formulas.table
    return {
        'inputs': table(('`drive.source`', 'topic', 'type', 'what'),
                        [(f'`{t.name}`', f'`{t.topic}`', f'`{t.type}`', t.text)
                         for t in (*INPUTS.values(), TORQUE)]),
        'outputs': table(('name in `outputs`', 'topic', 'type', 'what', 'needs masses'),
                         [(f'`{t.name}`', f'`{t.topic}`', f'`{t.type}`', t.text,
                           'yes' if t.needs_loads else '')
                          for t in OUTPUTS.values()]),
        'pictures': table(('name in `outputs`', 'topic', 'type', 'what'),
                          [(f'`{t.name}`', f'`{t.topic}`', f'`{t.type}`', t.text)
                           for t in PICTURES.values()]),
        'wrenches': table(('topic', 'type', 'what'),
                          [(f'`{t.topic}`', f'`{t.type}`', t.text)
                           for topic in (wrench_topic, applied_topic)
                           for t in [topic('NAME')]]),
        'always': table(('topic', 'type', 'what'),
                        [(f'`{t.topic}`', f'`{t.type}`', t.text)
                         for t in (DRIVEN, SCENE, DRIVE_STATE, FRAME)]),
        'trajectories': table(('topic', 'type', 'what'),
                              [(f'`{t.topic}`', f'`{t.type}`', t.text)
                               for t in TRAJECTORIES.values()]),
        'services': table(('service', 'type', 'what'),
                          [(f'`{s.service}`', f'`{s.type}`', s.text) for s in SERVICES.values()]),
        'node_parameters': parameters(of_node=True),
        'joints': table(('`linkage.kind`', 'joints in this order: place, coordinate'),
                        [(f'`{name}`', '; '.join(f'{joint.place} `{joint.coordinate.position}`'
                                                 for joint in kind.JOINTS))
                         for name, kind in KINDS.items()]),
        'machine_joints': table(('scene', 'joints in this order: name `coordinate`'),
                                [(f'`{name}`', '; '.join(
                                    f'{joint.name or joint.place} `{joint.coordinate.position}`'
                                    for joint in load_scene(name).linkage.JOINTS))
                                 for name in ('jansen', 'v_engine')]),
        'messages': messages(),
    }


def desk_tables():
    """Return {name: Markdown} of reference_desk.md."""
    return {'scene_parameters': parameters(of_node=False),
            'units': formulas.table(('SI', 'units'),
                                    [(si, ', '.join(units)) for si, units in UNITS.items()])}


def python_tables():
    """Return {name: Markdown} of reference_python.md."""
    return {'quantities': formulas.table(
                ('quantity', 'unit', 'what', 'of'),
                [(f'`{q.name}`', q.unit, q.text, having(q.name))
                 for q in (*QUANTITIES.values(), *POSITIONS.values())] + drive_quantities()),
            'fields': fields()}


def _verbs():
    """Yield (name, help, parser) of every command that takes arguments of its own."""
    def below(name, parser):
        for action in parser._actions:
            if isinstance(action, argparse._SubParsersAction):
                texts = {choice.dest: choice.help for choice in action._choices_actions}
                for verb, sub in action.choices.items():
                    if not any(isinstance(a, argparse._SubParsersAction) for a in sub._actions):
                        yield f'{name} {verb}', texts[verb], sub
                    yield from below(f'{name} {verb}', sub)

    yield from below('fourbar', main.parser())


def _option(action):
    """Return an argument as it is typed, and its help."""
    choices = '{' + ','.join(map(str, action.choices)) + '}' if action.choices else None
    value = action.metavar or choices or action.dest.upper()
    if isinstance(value, tuple):
        value = ' '.join(value)
    typed = [f'{name} {value}' if action.nargs != 0 else name for name in action.option_strings]
    text = (action.help or '').replace('%(default)s', str(action.default)).replace('%%', '%')
    return f'`{", ".join(typed) or value}`', text


def command_tables():
    """Return {name: Markdown} of command_line.md."""
    overview = formulas.table(('command', 'what it does'),
                              [(f'`{name}`', text) for name, text, _ in _verbs()])
    rows = {name: [_option(action) for action in sub._actions if action.dest != 'help']
            for name, _, sub in _verbs()}
    times = Counter(row for found in rows.values() for row in found)
    common = [row for row, count in times.items() if count >= COMMON]
    arguments = [f'### {name}\n\n' + formulas.table(('argument', 'meaning'), own)
                 for name, found in rows.items()
                 if (own := [row for row in found if row not in common])]
    return {'verbs': overview, 'common': formulas.table(('argument', 'meaning'), common),
            'arguments': '\n\n'.join(arguments)}


def study_tables():
    """Return {name: Markdown table} of studies.md."""
    units = {QUANTITY: 'of the quantity', INPUT: 'rad, or m of a slide'}
    return {
        'parts': formulas.table(('part', 'unit', 'what'),
                                [(f'`.{name}`', units.get(unit, unit), text)
                                 for name, (text, unit) in PARTS.items()]),
        'of_mechanism': formulas.table(('measure', 'unit', 'what'),
                                       [(f'`{name}`', units.get(unit, unit), text)
                                        for name, (text, unit) in OF_MECHANISM.items()])}


def with_loads(text):
    """Return the text of LinkageLoads.msg with a field for each load."""
    return text + ''.join(f'float64 {load.name:<21} # [{load.unit}] {load.text}\n'
                          for load in LOADS.values() if f'float64 {load.name} ' not in text)


def pages():
    """Return {path: text as it should be} of the pages with tables, and of LinkageLoads.msg."""
    return {MESSAGE: with_loads(MESSAGE.read_text(encoding='utf-8'))} | {
            DOCS / name: filled(DOCS / name, tables)
            for name, tables in (('reference_robot.md', robot_tables()),
                                 ('reference_desk.md', desk_tables()),
                                 ('reference_python.md', python_tables()),
                                 ('formulas.md', formulas.tables()),
                                 ('command_line.md', command_tables()),
                                 ('studies.md', study_tables()))}


def filled(page, tables):
    """Return the text of a page with these tables in it."""
    text = page.read_text(encoding='utf-8')
    for name, content in tables.items():
        whole = f'<!-- {name} -->\n{content}\n<!-- end -->'.replace('\\', r'\\')
        text, count = re.subn(rf'<!-- {name} -->\n.*?<!-- end -->', whole, text, flags=re.S)
        if count != 1:
            raise SystemExit(f'{page}: expected one <!-- {name} -->, found {count}')
    return text


if __name__ == '__main__':
    # the message first, as the manual shows it
    MESSAGE.write_text(with_loads(MESSAGE.read_text(encoding='utf-8')), encoding='utf-8')
    for path, text in pages().items():
        path.write_text(text, encoding='utf-8')
