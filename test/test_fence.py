# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The core needs numpy alone, and nothing is loaded before it is needed."""
import importlib
import inspect
import re
import subprocess
import sys

import pytest
from support import ROOT

HEAVY = ('rclpy', 'scipy', 'mcap', 'matplotlib', 'rich', 'yaml', 'mpmath', 'flint')


def run(code):
    return subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, cwd=ROOT,
                          check=False)


def test_the_core_works_with_everything_but_numpy_blocked():
    done = run(f"""
import sys
for name in {HEAVY!r}:
    sys.modules[name] = None                 # any import of it raises ImportError
from math import isclose
import fourbar_ros
from fourbar_ros.extrema.find import find_extrema
rods = fourbar_ros.Bodies(*(fourbar_ros.round_rod(a, 7750.0, 0.01) for a in (0.4, 1.2, 0.8)))
linkage = fourbar_ros.FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods)
motion, loads = linkage.step(0.10962848, 25.0)
assert isclose(loads.shaking_force, 2512.318373, rel_tol=1e-9)
assert linkage.step([0.1, 0.2], 25.0)[1].f41.shape == (2,)
assert len(find_extrema(linkage, (), 25.0)) > 20
""")
    assert done.returncode == 0, done.stderr


PUBLIC = ('fourbar_ros', 'fourbar_ros.bag', 'fourbar_ros.description', 'fourbar_ros.dynamics',
          'fourbar_ros.extrema', 'fourbar_ros.machine', 'fourbar_ros.scene',
          'fourbar_ros.transmission', 'fourbar_lab.balancing', 'fourbar_lab.drawing',
          'fourbar_lab.reproduction', 'fourbar_lab.studies')

IMPORT = r'^(?:>>> |\.\.\. )?from (fourbar_(?:ros|lab)[\w.]*) import (\([^)]*\)|.*)'


@pytest.mark.parametrize('name', PUBLIC)
def test_every_public_name_exists_and_the_docstring_shows_it_at_work(name):
    package = importlib.import_module(name)
    for public in package.__all__:
        value = getattr(package, public)
        if inspect.isclass(value) or inspect.isroutine(value):
            assert inspect.getdoc(value), public
    assert set(package.__all__) <= set(dir(package))
    assert f'>>> from {name} import ' in package.__doc__


def test_public_faces_and_the_help_of_every_verb_load_nothing_heavy():
    done = run(f"""
import sys
import {', '.join(name for name in PUBLIC if name != 'fourbar_ros.machine')}
import fourbar_ros.pipeline.stepper, fourbar_ros.scene.scene
from fourbar_ros.cli.main import parser
parser()
print([name for name in {HEAVY!r} if name in sys.modules and name not in ('rich', 'yaml')])
""")
    assert done.stdout == '[]\n', done.stdout + done.stderr


def public_names(module):
    """Return the public names of a module; that of clients needs ROS, so its text is read."""
    if module == 'fourbar_ros.clients':
        text = (ROOT / 'fourbar_ros/clients.py').read_text(encoding='utf-8')
        return re.findall(r"'(\w+)'", re.search(r'__all__ = (.*)', text)[1])
    return importlib.import_module(module).__all__ if module in PUBLIC else ()


def test_what_users_read_imports_public_names_alone():
    wrong = []
    for path in [ROOT / 'README.md', *sorted((ROOT / 'docs').rglob('*.md')),
                 *sorted((ROOT / 'launch').glob('*.py')),
                 *sorted((ROOT / 'examples').glob('*.py'))]:
        text = path.read_text(encoding='utf-8')
        for module, names in re.findall(IMPORT, text, re.M):
            words = re.findall(r'\w+', re.sub('#.*', '', names))
            wrong += [f'{path.name}: {module}.{name}' for name in words
                      if name not in public_names(module)]
    assert not wrong, '\n'.join(wrong)


def test_the_node_catches_signals_before_anything_long_is_imported():
    done = run("""
import sys
import fourbar_ros.ros.node.start
print([name for name in ('numpy', 'rclpy', 'yaml') if name in sys.modules])
from fourbar_ros import *
print(FourBar.__name__, set(fourbar_ros.__all__) <= set(dir(fourbar_ros)))
""")
    assert done.stdout.split('\n')[:2] == ['[]', 'FourBar True'], done.stdout + done.stderr
