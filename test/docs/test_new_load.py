# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A new load is one row of one table: the example of CONTRIBUTING, in a copy of the tree."""
import json
import re
import shutil
import subprocess
import sys

import pytest
from support import ROOT

GUIDE = (ROOT / '.github/CONTRIBUTING.md').read_text()
EXAMPLE = re.search(r'```python\n(def winding_loss.*?)\n\n\n(Load\(.*?)\n```', GUIDE,
                    re.DOTALL).groups()
LINTERS = ROOT / '.venv-lint/bin'
TREES = ('fourbar_ros', 'fourbar_lab', 'docs', 'examples', 'msg_defs', 'config')
OF_MASSES = """Load(
        'per_mass', 'N/kg', 'shaking force over the mass of the second link',
        of=lambda mechanism, constants, motion, loads:
            loads.shaking_force / (constants.bodies[1].mass + 1e-9)),"""
SCRIPT = """
from dataclasses import replace
import json
from fourbar_lab.drawing.poses import loads_table
from fourbar_lab.export.model import GeneratedModel
from fourbar_lab.live.answers import structure_of
from fourbar_ros import Bodies, find_extrema, FourBar, load_scene, round_rod
from fourbar_ros.mechanisms.quantities import fields_of
import fourbar_ros
from rich.console import Console

found = {'home': fourbar_ros.__file__}
for name in ('paper', 'cylinder', 'jansen'):
    scene = load_scene(name)
    linkage = scene.linkage
    low, high = linkage.input_ranges[0]
    motion, loads = linkage.step(0.3 * low + 0.7 * high, 2.0)
    root = (loads.driving_force if linkage.is_driven_by_slide else loads.driving_torque) / 0.5
    found[name] = {'loss': loads.winding_loss, 'expected': root * root,
                   'unit': fields_of(linkage)['winding_loss'].unit,
                   'field': replace(scene, outputs=('loads',)).layout.fields['loads'].get(
                       'winding_loss'),
                   'extrema': len(find_extrema(linkage, ('winding_loss',), 2.0))}
scene = load_scene('paper')
page = structure_of(scene)
found['page'] = [page['quantities']['winding_loss']['unit'], 'winding_loss' in page['shown']]
found['per_mass'] = []
for density in (2700.0, 7750.0):      # two linkages that share a trace
    rods = Bodies(*(round_rod(length, density, 0.01) for length in (0.4, 1.2, 0.8)))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods)
    found['per_mass'].append(linkage.step(1.0, 25.0)[1].per_mass)
console = Console(width=100, record=True, file=open('/dev/null', 'w'))
console.print(loads_table(scene.linkage, scene.linkage.loads(1.0, 25.0)))
found['show'] = 'winding loss' in console.export_text()
model = GeneratedModel(scene, 'paper', outputs=('winding_loss',))
found['texts'] = model.units_and_texts['winding_loss']
print(json.dumps(found))
"""


def run(tree, *words, code=0):
    """Return what Python prints in a copy of the tree, or says when it ends with a code."""
    done = subprocess.run([sys.executable, *words], cwd=tree, text=True, check=False,
                          capture_output=True)
    assert done.returncode == code, done.stderr
    return done.stderr if code else done.stdout


@pytest.fixture
def tree(tmp_path):
    """Return a copy of the tree."""
    for name in TREES:
        shutil.copytree(ROOT / name, tmp_path / name,
                        ignore=shutil.ignore_patterns('__pycache__', '*.png', '*.svg', '*.gif'))
    return tmp_path


def add(tree, formula, *rows):
    """Add a formula and rows of loads; return the file."""
    file = tree / 'fourbar_ros/mechanisms/load_table.py'
    file.write_text(file.read_text().replace('LOADS = {', f'{formula}\n\n\nLOADS = {{').replace(
        '\n)}\nDERIVED', ''.join(f'\n    {row}' for row in rows) + '\n)}\nDERIVED'))
    return file


@pytest.mark.skipif(not LINTERS.is_dir(), reason='no linters: make lint installs them')
def test_the_example_passes_the_linters_as_it_is_typed(tree):
    file = add(tree, *EXAMPLE)
    shutil.copy(ROOT / 'pyproject.toml', tree)
    for linter in (('ruff', 'check', '--quiet'), ('mypy', '--follow-imports=silent')):
        done = subprocess.run([LINTERS / linter[0], *linter[1:], file], cwd=tree, text=True,
                              check=False, capture_output=True)
        assert not done.returncode, done.stdout


def test_a_load_of_what_a_kind_does_not_have_is_refused_in_a_line(tree):
    add(tree, '', """Load('advantage', '1', 'mechanical advantage', '',
         lambda mechanism, constants, motion, loads: motion.omega1 / motion.omega4),""")
    assert 'advantage' in run(tree, '-m', 'fourbar_ros', 'show', 'paper')
    assert run(tree, '-m', 'fourbar_ros', 'show', 'slider_crank', code=1) == (
        "fourbar: load advantage of slider-crank: 'SliderCrankMotion' object has no attribute "
        "'omega4'; a row of LOADS holds for every kind of mechanism\n")


def test_a_row_makes_a_load_of_table_message_manual_page_and_fmu(tree):
    add(tree, *EXAMPLE, OF_MASSES)
    run(tree, 'docs/tables.py')
    assert '| `winding_loss` | W | heat in the winding | all kinds |' in (
        tree / 'docs/reference_python.md').read_text()
    assert 'float64 winding_loss' in (tree / 'docs/reference_robot.md').read_text()
    assert '# [W] heat in the winding' in (tree / 'msg_defs/msg/LinkageLoads.msg').read_text()
    found = json.loads(run(tree, '-c', SCRIPT).splitlines()[-1])
    assert found['home'].startswith(str(tree))
    for name in ('paper', 'cylinder', 'jansen'):
        own = found[name]
        assert own['loss'] == own['expected'] != 0.0
        assert own['unit'] == 'W' and own['field'] == 'winding_loss' and own['extrema']
    assert found['page'][0] == 'W' and found['page'][1]
    assert found['per_mass'][0] == pytest.approx(found['per_mass'][1], rel=1e-7)
    assert found['show'] and found['texts'] == ['W', 'heat in the winding']
