# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Nothing needs the locks, terminals, signals and folders opened as files that Windows lacks.

The test hides them from a process on Linux.
"""
import os
import subprocess
import sys

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
ALL = """
from pathlib import Path
from support import bags
from support.scenes import PAPER

from fourbar_ros.bag import info, recompute, recover
from fourbar_ros.cli.main import main

for call in ('import fcntl', 'os.open(".", os.O_RDONLY)'):
    try:
        exec(call)
    except (ImportError, PermissionError):
        continue
    raise AssertionError(call)
path = bags.run(Path('.'), 'bag', PAPER, [(0.05 * k, 25.0, 0.0) for k in range(100)])
for bag in (path, recover(path, 'again').path):
    assert info(bag, check=True).is_sound and not recompute(bag).problems()
for words in ('show paper --at 1', 'describe paper', 'draw paper --at 60 -o one.png'):
    assert not main(words.split()), words
try:
    import rclpy
except ImportError:
    sys.exit()
import fourbar_ros.ros.node.node
"""


def test_bags_verbs_and_the_modules_of_the_node(tmp_path):
    tests = os.path.dirname(os.path.abspath(__file__))
    paths = [tests, *filter(None, [os.environ.get('PYTHONPATH')])]
    done = subprocess.run([sys.executable, '-c', HIDE + ALL], cwd=tmp_path, text=True,
                          capture_output=True, check=False,
                          env={**os.environ, 'PYTHONPATH': os.pathsep.join(paths)})
    assert done.returncode == 0, done.stderr
