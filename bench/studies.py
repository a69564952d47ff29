# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Studies and balancing: designs a second a core, two workers beside one, memory, fronts."""
from __future__ import annotations

import json
from pathlib import Path
import resource
import subprocess
import sys
import tempfile

from fourbar_lab.balancing.loads import Loads
from fourbar_lab.balancing.rms import front, Places
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.derivatives import Derivatives
from fourbar_lab.studies.study import from_document
from fourbar_ros import find_extrema, find_extrema_many, load_scene
from fourbar_ros.scene.scene import from_values
import numpy as np

from .pages import best_time

NINE = ['omega4', 'alpha4', 'shaking_force', 'shaking_moment', 'driving_torque', 'f41', 'f21',
        'f32', 'f43']
VARY = {'linkage.a1': {'range': [0.2, 0.4]}, 'linkage.a2': {'range': [1.0, 1.2]},
        'linkage.a3': {'range': [0.7, 0.9]}}
CURVES, OF_A_CURVE = 7300, 36       # as many as in the atlas of Hrones and Nelson
ONE_BY_ONE = 40


def study_of(rows, quantities, **more):
    """Return a study of crank-rockers like the paper's, in one chunk."""
    return from_document({'scene': 'paper', 'rows': rows, 'chunk': rows, 'vary': VARY,
                          'quantities': quantities, **more})


def sine():
    """Return the CPU time of numpy.sin for one number of a long array [s]."""
    x = np.linspace(0.0, 6.0, 10_000)
    return best_time(lambda: [np.sin(x) for _ in range(100)]) / 1e6


def one_by_one(study):
    """Return the CPU time a design of the search without blocks [s]."""
    scenes = [from_values(study.scene_values(row)) for row in range(ONE_BY_ONE)]
    names = list(dict.fromkeys(measure.quantity for measure in study.measures))

    def search():
        for scene in scenes:
            find_extrema(scene.linkage, names, scene.drive.speed, conditions=False)
    return best_time(search) / ONE_BY_ONE


def rates(samples):
    """Print designs a second, together and one by one."""
    unit = sine()
    print('CPU time of one core; "sines": over numpy.sin of one number of a long array.\n')
    print('| per design | designs a second | sines | one by one takes |')
    print('| --- | --- | --- | --- |')
    for text, quantities in (('all extrema of all nine quantities', NINE),
                             ('of omega4 and alpha4', NINE[:2]),
                             ('of the shaking force', NINE[2:3])):
        study = study_of(samples, quantities)
        each = best_time(lambda: compute(study, 0)) / samples
        print(f'| {text} | {1.0 / each:.0f} | {each / unit:.0f} | '
              f'{one_by_one(study) / each:.0f} times as long |')
    rng = np.random.default_rng(0)
    lengths = [rng.uniform(*VARY[f'linkage.a{i}']['range'], samples * 8) for i in (1, 2, 3)]
    each = best_time(lambda: find_extrema_many(*lengths, 1.0, rate=25.0), 10) / (samples * 8)
    print(f'| `find_extrema_many`: omega4 and alpha4 | {1.0 / each:.0f} | {each / unit:.0f} | |')


def atlas():
    """Print the time of 7300 coupler curves with all loads at their points."""
    from fourbar_lab.studies.block import Designs
    study = study_of(CURVES, ['omega4.max'])
    scene = load_scene('paper')
    x = 2.0 * np.pi * np.arange(OF_A_CURVE) / OF_A_CURVE

    def run():
        drawn = study.drawn(0, CURVES)
        for start in range(0, CURVES, 64):
            part = {name: column[start:start + 64] for name, column in drawn.items()}
            designs = Designs(scene, study.values, part)
            motion, loads = designs.state(np.broadcast_to(x, (designs.size, x.size)), 0.0, True)
            designs.many.link_motion(motion, 'coupler'), loads.f43
    print(f'\n{CURVES} coupler curves of {OF_A_CURVE} points with motion and all loads: '
          f'{best_time(run):.2f} s.')


def derivatives():
    """Print what exact derivatives cost beside the samples themselves."""
    scene = load_scene('paper')
    lengths = [f'linkage.{name}' for name in scene.linkage.length_names]
    print('\n| samples | derivatives of motion and all loads by | one parameter takes, over the '
          'sample |\n| --- | --- | --- |')
    for count in (20, 300, 4096):
        x = np.linspace(0.1, 6.1, count)
        one = best_time(lambda: [scene.linkage.step(x, scene.drive.speed) for _ in range(20)])
        for text, names in (('the four lengths', lengths), ('every number of the scene', ())):
            found = Derivatives(scene, names)
            taken = best_time(lambda: [found.state(x) for _ in range(20)])
            print(f'| {count} | {text} ({len(found.names)}) | '
                  f'{taken / one / len(found.names):.2f} |')


def workers():
    """Print the time of one and of two workers, and the memory of each, by the command."""
    text = json.dumps({'scene': 'paper', 'rows': 32768, 'chunk': 2048,
                       'quantities': ['shaking_force'], 'vary': VARY})
    taken = {}
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / 's.yaml').write_text(text)
        for number in (1, 2):
            done = subprocess.run([sys.executable, '-m', 'fourbar_ros', 'study',
                                   f'{folder}/s.yaml', '-o', f'{folder}/{number}',
                                   '--workers', str(number)],
                                  capture_output=True, text=True, check=True)
            taken[number] = float(done.stdout.split(' in ')[1].split(' s ')[0])
        same = all(path.read_bytes() == (Path(folder) / '2' / path.name).read_bytes()
                   for path in (Path(folder) / '1').glob('part-*.parquet'))
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
    print(f'\n32 768 designs by the command: one worker {taken[1]:.1f} s, two '
          f'{taken[2]:.1f} s ({taken[1] / taken[2]:.2f} times as fast), the same bytes: {same}. '
          f'Largest process: {most:.0f} MB.')


def fronts():
    """Print the time of fronts of 100 points and their certificates."""
    scene = load_scene('paper')
    loads = Loads(scene.linkage, scene.drive.speed)
    places = Places(loads, dict.fromkeys(loads.links, 0.6))
    masses = np.linspace(0.0, 20.0, 100)
    print('\n| front of 100 added masses | CPU time [s] | largest gap to the proven bound, over '
          'the unbalanced |\n| --- | --- | --- |')
    for names in (('force',), ('moment',), ('force', 'moment', 'torque')):
        found = front(places, names, masses)
        gap = max(one.value - one.bound for one in found) / found[0].value
        print(f'| {", ".join(names)} | {best_time(lambda: front(places, names, masses)):.2f} | '
              f'{gap:.0e} |')


def main(samples=4096):
    """Print all tables."""
    rates(samples)
    atlas()
    derivatives()
    workers()
    fronts()


if __name__ == '__main__':
    main()
