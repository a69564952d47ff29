# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""This version beside an earlier one in one run: single steps, batches, extrema."""
from pathlib import Path
import shutil
from statistics import median
import subprocess
import tempfile

from . import ROOT
from .pages import table
from .speed import Runner

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


def main(against='HEAD'):
    """Print ratios of both versions; ``against``: the commit of the earlier one."""
    with tempfile.TemporaryDirectory() as folder:
        unpack(against, Path(folder))
        pair = [Runner('version', str(place)) for place in (folder, ROOT)]
        times = {name: [] for name in pair[0].about['names']}
        for i in range(ROUNDS):
            for name, found in times.items():   # one right after the other, the first in turn
                order = slice(None, None, 1 - 2 * (i % 2))
                found.append([runner.ask(name)[name] for runner in pair[order]][order])
        for runner in pair:
            runner.close()
    print(f'This version beside {against}: CPU time of one, the least of {ROUNDS} rounds of both '
          'in turn; ratios of these, and within the same round.\n')
    rows = []
    for name, found in times.items():
        old, new = map(min, zip(*found))
        rows.append((name, f'{old * 1e6:.3g}', f'{new * 1e6:.3g}', f'{new / old:.2f}',
                     f'{median(after / first for first, after in found):.2f}'))
    table(('what', 'before [us]', 'now [us]', 'now / before', 'median of rounds'), rows)
