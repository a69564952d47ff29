# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Nothing needs the locks, terminals, signals and folders opened as files that Windows lacks.

The tests hide them from the processes they start, on Linux.
"""
import json
import os
import subprocess
import sys

import pytest

HIDE = """
import os
import signal
import sys

for name in ('fcntl', 'termios', 'tty', 'pty', 'resource', 'pwd', 'grp'):
    sys.modules[name] = None
for name in ('SIGHUP', 'SIGKILL'):
    delattr(signal, name)
for name in ('O_DIRECTORY', 'fork', 'getpgrp', 'tcgetpgrp', 'getloadavg'):
    delattr(os, name)
given = os.open


def open_file(path, flags, *rest, **named):
    if not isinstance(path, int) and os.path.isdir(path):
        raise PermissionError(13, 'a folder', path)
    return given(path, flags, *rest, **named)


os.open = open_file
"""
BAG = """
from pathlib import Path
from support import bags
from support.scenes import PAPER

from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.overview import info

path = bags.run(Path('.'), 'bag', PAPER, [(0.05 * k, 25.0, 0.0) for k in range(100)])
assert info(path, check=True).is_sound
assert not recompute(path).problems()
"""


@pytest.fixture
def run(tmp_path):
    """Return a function that runs Python in a folder without what Windows lacks."""
    (tmp_path / 'sitecustomize.py').write_text(HIDE)
    tests = os.path.dirname(os.path.abspath(__file__))
    paths = [str(tmp_path), tests, *filter(None, [os.environ.get('PYTHONPATH')])]

    def finished(*arguments):
        return subprocess.run([sys.executable, *map(str, arguments)], cwd=tmp_path, text=True,
                              capture_output=True, check=False,
                              env={**os.environ, 'PYTHONPATH': os.pathsep.join(paths)})
    return finished


def test_the_hidden_is_hidden(run):
    assert 'fcntl' in run('-c', 'import fcntl').stderr
    assert 'PermissionError' in run('-c', 'import os; os.open(".", os.O_RDONLY)').stderr


def test_bags_are_written_checked_and_recovered(run):
    done = run('-c', BAG)
    assert done.returncode == 0, done.stderr
    done = run('-m', 'fourbar_ros', 'bag', 'recover', 'bag', '-o', 'again')
    assert done.returncode == 0, done.stderr
    for bag in ('bag', 'again'):
        done = run('-m', 'fourbar_ros', 'bag', 'recompute', bag)
        assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_verbs_run(run):
    for arguments in (('show', 'paper', '--at', '1'), ('describe', 'paper'),
                      ('draw', 'paper', '--at', '60', '-o', 'one.png')):
        done = run('-m', 'fourbar_ros', *arguments)
        assert done.returncode == 0, (arguments, done.stderr)


@pytest.mark.slow
def test_studies_run_in_two_workers(run, tmp_path):
    pytest.importorskip('pyarrow')
    (tmp_path / 's.yaml').write_text(json.dumps({
        'scene': 'paper', 'rows': 40, 'chunk': 10, 'quantities': ['omega4'],
        'vary': {'linkage.a1': {'range': [0.2, 0.4]}}}))
    done = run('-m', 'fourbar_ros', 'study', 's.yaml', '-o', 'out', '--workers', 2)
    assert done.returncode == 0 and 'Traceback' not in done.stderr, done.stderr


def test_the_modules_of_the_node_import(run):
    pytest.importorskip('rclpy')
    done = run('-c', 'import fourbar_ros.ros.node.node')
    assert done.returncode == 0, done.stderr
