# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Large studies by the command: memory of the largest process whatever the size, two workers."""
from __future__ import annotations

import json
import os
from pathlib import Path
import subprocess
import sys
import tempfile

from fourbar_lab.studies.results import Results

SMALL = 100_000
# Runs a command and prints the memory of the largest process that it or its workers were [KiB].
MEASURED = """
import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], capture_output=True, text=True)
print(done.stdout, done.stderr)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(done.returncode)
"""


def run_study(folder, rows, quantities, workers, chunk=8192):
    """Run a study of random crank-rockers; return its folder, seconds and MB of a process."""
    document = {'scene': 'paper', 'method': 'random', 'rows': rows, 'chunk': chunk,
                'vary': {'linkage.a1': {'range': [0.2, 0.4]}, 'linkage.a2': {'range': [1.0, 1.2]},
                         'linkage.a3': {'range': [0.7, 0.9]}},
                'quantities': quantities}
    file, out = Path(folder) / f'{rows}.yaml', Path(folder) / f'{rows}-{workers}'
    file.write_text(json.dumps(document))
    done = subprocess.run([sys.executable, '-c', MEASURED, sys.executable, '-m', 'fourbar_ros',
                           'study', str(file), '-o', str(out), '--workers', str(workers)],
                          capture_output=True, text=True, check=True)
    seconds = float(done.stdout.split(' in ')[1].split(' s ')[0])
    return out, seconds, int(done.stdout.split()[-1]) / 1024.0


def sizes(largest):
    """Print memory and time of studies of the two rates, from small to large."""
    print('| designs | workers | time [s] | designs a second | largest process [MB] | on disk '
          '[MB] |\n| --- | --- | --- | --- | --- | --- |')
    rows = SMALL
    while rows <= largest:
        with tempfile.TemporaryDirectory() as folder:
            out, seconds, memory = run_study(folder, rows, ['omega4', 'alpha4'], 2)
            assert Results(out).designs == rows
            disk = sum(path.stat().st_size for path in out.iterdir()) / 1e6
        print(f'| {rows} | 2 | {seconds:.1f} | {rows / seconds:.0f} | {memory:.0f} | {disk:.0f} |')
        rows *= 10


def workers():
    """Print the times of one worker and of two."""
    print(f'\nOn {os.cpu_count()} processors:\n')
    print('| study | designs | one worker [s] | two [s] | times as fast | the same bytes |\n'
          '| --- | --- | --- | --- | --- | --- |')
    for text, quantities, rows in (('omega4 and alpha4', ['omega4', 'alpha4'], 1_600_000),
                                   ('shaking force', ['shaking_force'], 131_072)):
        with tempfile.TemporaryDirectory() as folder:
            (one, slow, _), (other, fast, _) = (run_study(folder, rows, quantities, number, 2048)
                                                for number in (1, 2))
            same = all(path.read_bytes() == (other / path.name).read_bytes()
                       for path in one.glob('part-*.parquet'))
        print(f'| {text} | {rows} | {slow:.1f} | {fast:.1f} | {slow / fast:.2f} | {same} |')


def main(samples=1_000_000):
    """Print both tables."""
    sizes(samples)
    workers()


if __name__ == '__main__':
    main()
