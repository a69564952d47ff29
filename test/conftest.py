# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Isolation: every test run has its own ROS domain on this machine only, and its own folders."""
import atexit
import contextlib
import os
import shutil
import socket
import subprocess
import tempfile

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


# Folders with the slowest files. They begin first, so that no long file is left for the end.
_SLOWEST = ('ros', 'live', 'studies', 'docs', 'reproduction', 'bag')


def pytest_collection_modifyitems(items):
    """Put the slowest folders first."""
    def place(item):
        folder = item.path.parent.name
        return _SLOWEST.index(folder) if folder in _SLOWEST else len(_SLOWEST)
    items.sort(key=place)


def pytest_sessionfinish(session, exitstatus):
    """Remove the shared memory that killed nodes leave behind (safe while others run)."""
    if shutil.which('fastdds'):
        subprocess.run(['fastdds', 'shm', 'clean'], stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL,
                       check=False)
