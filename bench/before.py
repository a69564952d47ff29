# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Where time goes, before and after: this version beside an earlier one, in one run."""
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

ROUNDS, FIRST = 3, '59bf0811'       # the version before the work on where time goes
UNITS = {'ms': 1e3, 'us': 1e6}
NODE, RUN = 'the same 1 s in steps of the node', 'simulate engine, 1 s at 1e-6'
SHORT, LONG = 'a sample of motion and loads, arrays of 1e4', '... of 1e6'


def unpack(commit, folder):
    """Write the files of a commit into a folder, and its verbs; SystemExit if git has none."""
    archive = folder / 'commit.tar'
    done = subprocess.run(['git', '-C', str(ROOT), 'archive', f'--output={archive}', commit],
                          check=False, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f'bench before: no version {commit!r}: {done.stderr.strip()}')
    shutil.unpack_archive(archive, folder)
    subprocess.run([sys.executable, 'setup.py', '-q', 'egg_info'], cwd=folder, check=True,
                   capture_output=True, env=clean())


def ask(folder, *work):
    """Return what bench/peers/version.py says of a work, in a new process."""
    done = subprocess.run([sys.executable, str(PEERS / 'version.py'), str(folder), *work],
                          check=False, capture_output=True, text=True, env=clean())
    if done.returncode:
        raise SystemExit(f'bench before: {work}: {done.stderr.strip().splitlines()[-1]}')
    return json.loads(done.stdout)


def main(against=FIRST, samples=ROUNDS):
    """Print times of both versions; ``against``: the commit of the earlier one."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        unpack(against, folder)
        units, times = ask(ROOT), {}
        for i in range(samples):
            for work in units:      # one right after the other, the first in turn
                order = slice(None, None, 1 - 2 * (i % 2))
                times.setdefault(work, []).append(
                    [ask(place, work) for place in (folder, ROOT)[order]][order])
    print(f'Commit {against} and this one, each time in a new process: CPU time, {samples} rounds '
          'of both in turn. Medians; ratios within a round, the lowest and the highest.\n')
    rows = []
    for work, pairs in times.items():
        ratios = [before / now for before, now in pairs]
        before, now = [median(column) * UNITS[units[work]] for column in zip(*pairs)]
        rows.append((work, f'{before:.3g} {units[work]}', f'{now:.3g} {units[work]}',
                     f'{median(ratios):.3g}', f'{min(ratios):.3g} to {max(ratios):.3g}'))
    table(('work', 'before', 'now', 'before / now', '(lowest to highest)'), rows)
    over = [(name, *[f'{median(a[k] / b[k] for a, b in zip(times[work], times[other])):.3g}'
                     for k in (0, 1)], asked)
            for name, work, other, asked in (
                ('simulate over steps of the node', RUN, NODE, '5'),
                ('a sample of 1e6 over one of 1e4', LONG, SHORT, '1.3'))]
    table(('ratio in a version', 'before', 'now', 'asked, at most'), over)
