# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The examples run as they are, each in a process and a folder of its own."""
from contextlib import contextmanager, nullcontext
import importlib.util
import json
import os
import re
import signal
import subprocess
import sys

from fourbar_ros.cli.main import main
import pytest
from support import bags, ROOT
from support.scenes import PAPER, RODS

EXAMPLES = ROOT / 'examples'
NEEDS = {'loads_plot': ['matplotlib'], 'balancing': ['scipy'], 'study': ['scipy', 'pyarrow'],
         'motor_start': ['scipy'], 'proof': ['scipy'], 'live_page': ['starlette', 'uvicorn'],
         'bag_to_dataframe': ['mcap'], 'mujoco_chassis': ['mujoco', 'rclpy'],
         'mujoco_motor': ['mujoco', 'rclpy'], 'mujoco_without_ros': ['mujoco']}
OVER_ROS = 'mujoco_chassis', 'mujoco_motor'
FIRST = {'extrema', 'six_bar', 'batch', 'bag_to_dataframe'}         # the others are slow
# a line of each, of the documents or of another way to the same
SAID = {
    'extrema': r'alpha4 +maximum +1062\.775829 rad/s\^2',           # Hayes, Hninn and Irani
    'loads_plot': r'loads\.png',
    'six_bar': r'swings through \d+\.\d+ deg',
    'motor_start': r'reached the end',
    'balancing': r'force +rms +\S+ -> +0\.000',
    'study': r'row \d+: linkage\.a1',
    'bag_to_dataframe': r'shaking_force',
    'batch': r'largest rate of 1000000 samples 13\.51343',
    'mujoco_chassis': r'third second: 2\d\.\d\d mm, 1\d\.\d\d mm',
    'mujoco_motor': r'at the end 1\d\.\d\d to 3\d\.\d\d rad/s',
    'mujoco_without_ros': r'0\.25 ms: at the end 1\d\.\d\d to 3\d\.\d\d rad/s',
    'live_page': r'http://127\.0\.0\.1:\d+.*\nended with',
    'proof': r'interval bounds\n(.*\n)+period 1\.64314493083',
}
PANDAS = """
class DataFrame:
    def __init__(self, columns):
        self.columns = columns
    def head(self):
        return {name: values[:5] for name, values in self.columns.items()}
    def to_csv(self, path, index):
        rows = zip(*self.columns.values(), strict=True)
        lines = [','.join(self.columns), *(','.join(map(str, row)) for row in rows)]
        open(path, 'w').write('\\n'.join(lines))
"""


def run(name, folder, *arguments, code=0):
    """Return what an example prints, or why it ends with another exit code."""
    ours = {name: value for name, value in os.environ.items()
            if not name.startswith('PYTEST')}        # no process is a test of ours
    environment = {**ours, 'PYTHONPATH': os.pathsep.join(
        [str(folder), str(ROOT), os.environ.get('PYTHONPATH', '')])}
    done = subprocess.run([sys.executable, str(EXAMPLES / f'{name}.py'), *arguments], cwd=folder,
                          env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=300, check=False)
    assert done.returncode == code, done.stderr
    return done.stderr if code else done.stdout


@contextmanager
def node(scene):
    """Run a node of examples/nodes in a process."""
    process = subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', '--ros-args',
                                '--params-file', str(EXAMPLES / 'nodes' / scene)])
    try:
        yield
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0


def test_every_example_is_run_and_listed():
    assert {file.stem for file in EXAMPLES.glob('*.py')} == set(SAID)
    readme = (EXAMPLES / 'README.md').read_text(encoding='utf-8')
    assert all(f'({name}.py)' in readme for name in SAID)


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=[pytest.mark.slow] * (name not in FIRST)) for name in SAID])
def test_an_example_runs(name, tmp_path):
    for module in NEEDS.get(name, ()):
        pytest.importorskip(module)
    arguments = []
    if name == 'bag_to_dataframe':
        bags.run(tmp_path / 'bags', 'run', {**PAPER, **RODS, 'outputs': ['state', 'loads']},
                 [(0.01 * k, 25.0, 0.0) for k in range(1, 30)])
        arguments = [str(tmp_path / 'bags' / 'run')]
        if importlib.util.find_spec('pandas') is None:       # no package of ours needs it
            (tmp_path / 'pandas.py').write_text(PANDAS)
    with node(f'{name}.yaml') if name in OVER_ROS else nullcontext():
        assert re.search(SAID[name], run(name, tmp_path, *arguments))
    written = {'loads_plot': 'loads.png', 'bag_to_dataframe': 'loads.csv'}.get(name)
    if written:
        assert (tmp_path / written).stat().st_size > 1000
    if name == 'bag_to_dataframe':
        assert len((tmp_path / written).read_text().splitlines()) == 30


@pytest.mark.parametrize(('name', 'package'), [
    ('bag_to_dataframe', 'pandas'), ('loads_plot', 'matplotlib'), ('mujoco_chassis', 'mujoco'),
    ('mujoco_motor', 'mujoco'), ('mujoco_without_ros', 'mujoco')])
def test_an_example_without_its_package_says_what_to_install(name, package, tmp_path):
    (tmp_path / f'{package}.py').write_text('raise ModuleNotFoundError')
    said = run(name, tmp_path, code=1)
    assert said.endswith(f': pip install {package}\n') and said.count('\n') == 1, said


def test_the_press_of_the_manual_is_sized_as_it_says(capsys):
    """Work without friction is that of the cut, 2 kN over 8 mm, exactly."""
    main(['show', 'press', '--json'])
    drive = json.loads(capsys.readouterr().out)['drive']
    assert drive['cycle']['without_friction'] == pytest.approx(16.0, rel=1e-12)
    text = (ROOT / 'docs/dynamics.md').read_text(encoding='utf-8')
    assert f'peak {drive["effort"]["peak"]:.6g} N m' in text
    assert f'{drive["cycle"]["work"]:.6g} J = 16 J without friction' in text
    assert f'B (f32) {drive["worst_pin"]["force"]:.6g} N' in text
