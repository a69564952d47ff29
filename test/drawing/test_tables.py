# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""No number is cropped, whatever the width: rows are wrapped or stacked instead."""
import io
import random
import subprocess

from fourbar_ros.terminal import PlainTable
import pytest
from rich.console import Console
from support import bags, ROOT
from support.samples import some
from support.scenes import PAPER, RODS
from support.terminals import numbers, python, shown

VERBS = {
    'show': ['show', 'config/paper.yaml', '--at', '60'],
    'show of a slide': ['show', 'config/cylinder.yaml', '--at', '1.5'],
    'scene check': ['scene', 'check', 'config/slider_crank.yaml'],
    'reproduce': ['reproduce'],
    'bag info': ['bag', 'info', '{bag}', '--check'],
    'bag recompute': ['bag', 'recompute', '{bag}'],
    'bag diff': ['bag', 'diff', '{bag}', '{other}'],
    'bag scene': ['bag', 'scene', '{bag}'],
}
RUN = ('import sys; from fourbar_ros.cli import main, scene; scene.step_cost = lambda scene: '
       '1e-5; sys.exit(main.main({}))')


@pytest.fixture(scope='module')
def files(tmp_path_factory):
    """Two bags: what differs between them has digits."""
    folder = tmp_path_factory.mktemp('bags')
    values = {**PAPER, **RODS, 'outputs': ['state', 'loads', 'joint_states']}
    return {name: str(bags.run(folder, name, values, [(0.1 * k + e, 25.0, 0.0) for k in range(5)],
                               paced=True))
            for name, e in (('bag', 0.0), ('other', 1e-9))}


@some('name', VERBS, 1)
def test_numbers_are_whole_in_every_width(name, files):
    command = python(RUN.format([word.format(**files) for word in VERBS[name]]))
    wide = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert 'Traceback' not in wide.stderr, wide.stderr
    assert numbers(wide.stdout)
    assert not [line for line in wide.stdout.splitlines() if line.endswith(' ')]
    for width in (80, 60):
        text, code = shown(command, width)
        assert code == wide.returncode and '…' not in text
        # prose of these is left to the terminal to wrap
        if not name.startswith('bag'):
            assert max(map(len, text.splitlines())) <= width
        assert numbers(text) == numbers(wide.stdout), width


def printed(table, width):
    """Return the lines of a table on a terminal of this width."""
    console = Console(file=io.StringIO(), width=width, force_terminal=True, color_system=None)
    console.print(table)
    return console.file.getvalue().splitlines()


@pytest.mark.parametrize('seed', range(5))
def test_random_tables_keep_every_word(seed):
    rng = random.Random(seed)
    heads = ['', *(f'head{i}' + '>' * rng.randint(0, 1) for i in range(rng.randint(1, 6)))]
    rows = [[' '.join(f'{rng.uniform(-1e3, 1e3):.{rng.randint(0, 9)}f}'
                      for _ in range(rng.randint(0, 3)))
             if not head.endswith('>') else f'{rng.gauss(0.0, 1e6):.12g}' for head in heads]
            for _ in range(6)]
    words = sorted(word for row in rows for cell in row for word in cell.split())
    for width in (200, 80, 60, 40, 30):
        table = PlainTable('', heads)
        for row in rows:
            table.add_row(*row)
            if rng.random() < 0.3:
                table.add_section()
        lines = printed(table, width)
        assert sorted(word for line in lines for word in line.split()
                      if not word.startswith('head')) == words
        assert max(map(len, lines)) <= width and not any(line.endswith(' ') for line in lines)


def test_a_stacked_row_names_its_cells():
    table = PlainTable('title', ('', 'printed>', 'unit', 'kind'))
    table.add_row('crank speed', '188.495559215387', 'rad/s', 'minimum')
    assert printed(table, 30) == ['title', 'crank speed', '  printed 188.495559215387',
                                  '  rad/s  kind minimum']
