# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Write the tables of docs/node.md that have a source in the code: ``python docs/tables.py``.

Text between ``<!-- NAME -->`` and ``<!-- end -->`` is replaced; a test checks that nothing is out
of date.
"""
from math import isnan
from pathlib import Path
import re
import sys

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from fourbar_ros.mechanisms.kinds import KINDS  # noqa: E402
from fourbar_ros.mechanisms.quantities import known, QUANTITIES  # noqa: E402
from fourbar_ros.scene.parameters import PARAMETERS, POINT, REQUIRED  # noqa: E402
from fourbar_ros.scene.topics import (  # noqa: E402
    APPLIED,
    DRIVEN,
    FIND_EXTREMA,
    INPUTS,
    OUTPUTS,
    SCENE,
    SERVICES,
    WRENCHES,
)

PAGE = ROOT / 'docs' / 'node.md'


def table(head, rows):
    """Return a Markdown table."""
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join('| ' + ' | '.join(str(cell).replace('|', '\\|') for cell in line) + ' |'
                     for line in lines)


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
        inputs = [driven for driven in kind.INPUTS if quantity in known(kind, driven)]
        if inputs:
            found.append(name if len(inputs) == len(kind.INPUTS)
                         else f'{name} driven at its {inputs[0]}')
    return 'all' if found == list(KINDS) else ', '.join(found)


def tables():
    """Return {name: Markdown table}."""
    return {
        'inputs': table(('`drive.source`', 'topic', 'type', 'what'),
                        [(f'`{t.name}`', f'`{t.topic}`', f'`{t.type}`', t.text)
                         for t in INPUTS.values()]),
        'outputs': table(('name in `outputs`', 'topic', 'type', 'what', 'needs masses'),
                         [(f'`{t.name}`', f'`{t.topic}`', f'`{t.type}`', t.text,
                           'yes' if t.needs_loads else '')
                          for t in OUTPUTS.values()]),
        'wrenches': table(('topic', 'type', 'what'),
                          [(f'`{t.topic}`', f'`{t.type}`', t.text)
                           for topics in (WRENCHES, APPLIED) for t in topics.values()]),
        'always': table(('topic', 'type', 'what'),
                        [(f'`{t.topic}`', f'`{t.type}`', t.text) for t in (DRIVEN, SCENE)]),
        'services': table(('service', 'type', 'what'),
                          [(f'`{s.service}`', f'`{s.type}`', s.text) for s in SERVICES.values()]),
        'actions': table(('action', 'type', 'what'),
                         [(f'`{FIND_EXTREMA.service}`', f'`{FIND_EXTREMA.type}`',
                           FIND_EXTREMA.text)]),
        'parameters': table(('parameter', 'type', 'unit', 'default', 'allowed', 'live', 'what'),
                            [(f'`{p.name}`', p.type, p.unit, default(p), p.allowed, 'yes' if p.live
                              else '', p.text)
                             for p in (*PARAMETERS.values(), *POINT.values())]),
        'quantities': table(('quantity', 'unit', 'what', 'of'),
                            [(f'`{q.name}`', q.unit, q.text, having(q.name))
                             for q in QUANTITIES.values()]),
    }


def filled(text):
    """Return the page with its tables as they should be."""
    for name, content in tables().items():
        text, count = re.subn(rf'(?<=<!-- {name} -->\n).*?(?=<!-- end -->)',
                              (content + '\n').replace('\\', r'\\'), text, flags=re.S)
        if count != 1:
            raise SystemExit(f'{PAGE}: expected one <!-- {name} -->, found {count}')
    return text


if __name__ == '__main__':
    PAGE.write_text(filled(PAGE.read_text()))
