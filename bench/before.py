# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""This version beside an earlier one in one run: single steps, batches, extrema."""
from contextlib import contextmanager
import json
from pathlib import Path
import shutil
from statistics import median
import subprocess
import sys
import tempfile

from . import ROOT
from .pages import table
from .speed import clean, PEERS

ROUNDS = 30


def unpack(commit, folder):
    """Write the package of a commit into a folder; SystemExit if git does not have it."""
    archive = folder / 'package.tar'
    done = subprocess.run(['git', '-C', str(ROOT), 'archive', f'--output={archive}', commit,
                           'fourbar_ros'],
                          check=False, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f'bench before: no version {commit!r}: {done.stderr.strip()}')
    shutil.unpack_archive(archive, folder)


@contextmanager
def version(folder):
    """Yield what a version can measure, and the function name -> CPU time [s]."""
    process = subprocess.Popen([sys.executable, str(PEERS / 'version.py'), str(folder)],
                               text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               cwd=folder, env=clean())

    def measure(name):
        process.stdin.write(f'{name}\n')
        process.stdin.flush()
        return float(process.stdout.readline())
    try:
        yield json.loads(process.stdout.readline()), measure
    finally:
        process.stdin.close()
        process.wait(60)


def main(against='HEAD'):
    """Print ratios of both versions; ``against``: the commit of the earlier one."""
    with tempfile.TemporaryDirectory() as folder:
        unpack(against, Path(folder))
        with version(folder) as (names, before), version(ROOT) as (_, now):
            times = {name: [] for name in names}
            for i in range(ROUNDS):
                for name in names:      # one right after the other, the first of them in turn
                    times[name].append((before(name), now(name)) if i % 2
                                       else (now(name), before(name))[::-1])
    print(f'This version beside {against}: CPU time of one, the least of {ROUNDS} rounds of both '
          'in turn; ratios of these, and within the same round.\n')
    rows = []
    for name, found in times.items():
        old, new = map(min, zip(*found))
        rows.append((name, f'{old * 1e6:.3g}', f'{new * 1e6:.3g}', f'{new / old:.2f}',
                     f'{median(after / first for first, after in found):.2f}'))
    table(('what', 'before [us]', 'now [us]', 'now / before', 'median of rounds'), rows)
