# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Isolation: every test run has its own ROS domain on this machine only, and its own folders."""
import atexit
import contextlib
from functools import cache
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

from hypothesis import HealthCheck, settings

# Nothing of a test depends on chance or on the clock: the same examples each time.
_DRAWN = {'deadline': None, 'derandomize': True, 'database': None, 'print_blob': False,
          'suppress_health_check': list(HealthCheck)}
settings.register_profile('quick', max_examples=10, stateful_step_count=8, **_DRAWN)
settings.register_profile('long', max_examples=100, stateful_step_count=30, **_DRAWN)
settings.load_profile('quick')              # make test-all: --hypothesis-profile=long

_held = []      # a socket that is bound for as long as this run has its domain


def _own_domain():
    """Return a ROS domain, 1 to 101, that nothing else on this machine uses."""
    for i in range(101):
        domain, held = 1 + (os.getpid() + i) % 101, socket.socket()
        with contextlib.suppress(OSError), socket.socket(type=socket.SOCK_DGRAM) as probe:
            held.bind(('127.0.0.1', 17000 + domain))
            probe.bind(('', 7410 + 250 * domain))        # DDS: where the first participant listens
            _held.append(held)
            return domain
        held.close()
    raise RuntimeError('101 test runs at once: no ROS domain is left')


_scratch = tempfile.mkdtemp(prefix='fourbar_test_')
atexit.register(shutil.rmtree, _scratch, ignore_errors=True)
os.environ['ROS_LOG_DIR'] = _scratch
# Test processes share the processors already. Threads of OpenBLAS in numpy 1.26 wait for each
# other on a busy machine: 277 s instead of 0.8 s for 20 001 systems of nine equations.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
os.environ['ROS_PYTHON_CHECK_FIELDS'] = '1'
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
os.environ['ROS_DOMAIN_ID'] = str(_own_domain())
os.environ['PYTHONFAULTHANDLER'] = '1'
# Without bytecode every worker, node and command of a run would compile all that it imports.
os.environ.pop('PYTHONDONTWRITEBYTECODE', None)
sys.dont_write_bytecode = False


def _let_children_have_signals():
    """
    Give children the default actions of signals that this run ignores, as under nohup.

    What is ignored is inherited, what is handled is not: this run goes on ignoring them.
    """
    for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


_let_children_have_signals()


# Folders of tests that wait for processes, browsers and clocks, and of those that compute longest.
_WAIT = ('live', 'ros', 'studies', 'bag', 'cli')
_COMPUTE = ('docs', 'machine', 'extrema', 'dynamics')
# Files that start processes, by their text, and those that compute for seconds, are not `unit`.
_STARTS = re.compile('subprocess|Popen|run_node|get_context|COMPILERS')
_LONG = {'test_golden', 'test_every_run_ends', 'test_stepper', 'test_steps', 'test_toggles',
         'test_machines', 'test_induction_motor', 'test_long_and_extreme_runs',
         'test_position_forces', 'test_find', 'test_proof', 'test_collineation',
         'test_against_cartesian', 'test_change_points', 'test_drive_states', 'test_any_recording',
         'test_simulate', 'test_reproduce', 'test_accuracy', 'test_connections', 'test_fields',
         'test_between_moving_links', 'test_load_sources', 'test_ranges_and_extrema',
         'test_moving_joint', 'test_classics', 'test_cost'}


@cache
def _is_unit(path):
    return (path.parent.name not in ('live', 'ros', 'docs', 'contract') and path.stem not in _LONG
            and not _STARTS.search(path.read_text(encoding='utf-8')))


def pytest_collection_modifyitems(items):
    """Mix files that wait with files that compute, the long first: both cores have work always."""
    files = {}
    for item in items:
        files.setdefault(item.path, []).append(item)
        if _is_unit(item.path) and 'slow' not in item.keywords:
            item.add_marker('unit')

    def rank(path, folders):
        name = path.parent.name
        return folders.index(name) if name in folders else len(folders)
    waiting = sorted((path for path in files if path.parent.name in _WAIT),
                     key=lambda path: rank(path, _WAIT))
    computing = sorted(files.keys() - set(waiting), key=lambda path: (rank(path, _COMPUTE), path))
    order = sorted((k / len(kind), path) for kind in (waiting, computing)
                   for k, path in enumerate(kind))
    items[:] = [item for _, path in order for item in files[path]]


def pytest_sessionfinish(session, exitstatus):
    """Remove the shared memory that killed nodes leave behind (safe while others run)."""
    if shutil.which('fastdds'):
        subprocess.run(['fastdds', 'shm', 'clean'], stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL,
                       check=False)
