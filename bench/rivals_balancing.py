# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Balancing fronts beside pymoo's NSGA-II, given 60 s: who is better, and how far from proven."""
from __future__ import annotations

import time

from fourbar_lab.balancing.loads import Loads, NUMBERS
from fourbar_lab.balancing.rms import front, Places
from fourbar_ros import load_scene
import numpy as np

RADIUS, MOST, POPULATION = 0.6, 10.0, 100
CASES = ('force',), ('moment',), ('force', 'moment', 'torque')


def problem_of(places, names):
    """Return the same problem for pymoo: one point mass a link, RMS beside added mass."""
    from pymoo.core.problem import Problem
    root, given, links = places.loads.root(names), places.loads.given, places.loads.links

    class Counterweights(Problem):

        def __init__(self):
            count = len(places.radii)
            super().__init__(n_var=3 * count, n_obj=2, xl=np.tile((0.0, 0.0, -np.pi), count),
                             xu=np.tile((MOST, RADIUS, np.pi), count))

        def _evaluate(self, x, out, *args, **kwargs):
            numbers = np.tile(given, (len(x), 1))
            for link, (m, r, f) in zip(places.radii, x.T.reshape(-1, 3, len(x))):
                first = NUMBERS * links.index(link)
                numbers[:, first:first + NUMBERS] += np.stack(
                    (m, m * r * np.cos(f), m * r * np.sin(f), m * r * r), axis=1)
            out['F'] = np.stack((np.linalg.norm(numbers @ root.T, axis=1), x[:, ::3].sum(axis=1)),
                                axis=1)
    return Counterweights()


def main(samples=60):
    """Print the table; ``samples``: seconds that NSGA-II is given for each front."""
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.optimize import minimize
    except ImportError as error:
        print(f'pymoo is not installed here ({error}): pip install pymoo')
        return
    scene = load_scene('paper')
    loads = Loads(scene.linkage, scene.drive.speed)
    places = Places(loads, dict.fromkeys(loads.links, RADIUS))
    print(f'NSGA-II is given {samples} s for each front and a population of {POPULATION}; each of '
          'its designs is compared with ours of the same mass.\n')
    print('| minimized | our 100 masses [s] | its designs | of them better than ours | median '
          'over ours | least over ours | greatest gap of ours to the bound |')
    print('| --- | --- | --- | --- | --- | --- | --- |')
    for names in CASES:
        begun = time.process_time()
        front(places, names, np.linspace(0.0, MOST, 100))
        taken = time.process_time() - begun
        found = minimize(problem_of(places, names), NSGA2(pop_size=POPULATION),
                         ('time', samples), seed=1)
        found = found.F[np.argsort(found.F[:, 1])]
        ours = front(places, names, found[:, 1])
        values = np.array([one.value for one in ours])
        gap = max(one.value - one.bound for one in ours) / values[0]
        floor = 1e-9 * values[0]        # where nothing remains
        ratio = (found[:, 0] + floor) / (values + floor)
        better = int((found[:, 0] < values - floor).sum())
        print(f'| {", ".join(names)} | {taken:.2f} | {len(found)} | {better} | '
              f'{np.median(ratio):.3f} | {ratio.min():.4f} | {gap:.0e} |')


if __name__ == '__main__':
    main()
