# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""All extrema of theta4' and theta4'' beside other ways to them: run time, misses, errors."""
from functools import partial
import gc
from math import inf, pi
from statistics import median
import time

from fourbar_lab.studies.many import find_extrema_many, RATES
from fourbar_ros import Bodies, find_extrema, FourBar, round_rod
import mpmath
import numpy as np
from scipy.optimize import brentq
from support.extrema_reference import exact_roots

from .naive import ARRAY, coordinates, SCALAR
from .pages import table

# the paper's linkage; the slides' Example 7.7
SEEDS = ((0.4, 1.2, 0.8, 1.0), (2.0, 6.0, 7.0, 5.0))
LOADS = ('shaking_force', 'shaking_moment', 'driving_torque', 'f41', 'f21', 'f32', 'f43')
ROUNDS, PER_FAMILY, MANY = 5, 20, 10_000
LEAST = 0.1              # [s] of CPU time for one figure


# --- linkages ------------------------------------------------------------------------------------

def crank_rockers(count, rng):
    """Return lengths, shape (count, 4): uniform in [0.1, 1] m, kept if a Grashof crank-rocker."""
    kept = []
    while sum(map(len, kept)) < count:
        a = rng.uniform(0.1, 1.0, (4 * count, 4))
        a1, a2, a3, a4 = a.T
        margins = np.array([a4 - a1 + a3 - a2, a4 - a1 - a3 + a2, a2 + a3 - a4 - a1])
        kept.append(a[(margins > 0.0).all(axis=0)])
    return np.concatenate(kept)[:count]


def near_change_point(rng, gap):
    """
    Return lengths with the crank the shortest.

    ``gap``: how far from a change point, relative.
    """
    while True:
        a = np.sort(rng.uniform(0.1, 1.0, 4))
        a[3] = (a[1] + a[2] - a[0]) * (1.0 - gap)
        if a[0] + max(a[1:]) < sum(a[1:]) - max(a[1:]):
            return (a[0], *rng.permutation(a[1:]))


def near_kite(rng):
    """Return lengths with a1 near a4 and a2 near a3, the crank turning fully."""
    while True:
        short, long = np.sort(rng.uniform(0.1, 1.0, 2))
        a1, a2, a3, a4 = np.array((short, long, long, short)) * (1.0 + 1e-6 * rng.normal(size=4))
        if abs(a1 - a4) > abs(a2 - a3):
            return a1, a2, a3, a4


def families(rng):
    """Return {name: lengths of linkages}."""
    draws = {**{f'gap {gap:.0e}': partial(near_change_point, gap=gap)
                for gap in (1e-3, 1e-6, 1e-10)},
             'near kite 1e-06': near_kite}
    return {'seeds': SEEDS, 'random': crank_rockers(PER_FAMILY, rng).tolist(),
            **{name: [tuple(map(float, draw(rng))) for _ in range(PER_FAMILY)]
               for name, draw in draws.items()}}


# --- ways: lengths -> theta1 of the extrema of theta4', of those of theta4'' ---------------------

def ours(lengths):
    found = [], []
    for extremum in find_extrema(FourBar(*lengths), RATES, conditions=False):
        found[RATES.index(extremum.quantity)].append(extremum.theta1)
    return found


def ours_proved(lengths):
    return find_extrema(FourBar(*lengths), RATES, certify=True)


def ours_with_loads(lengths):
    bodies = Bodies(*(round_rod(length, 7750.0, 0.01) for length in lengths[:3]))
    return find_extrema(FourBar(*lengths, bodies=bodies), (*RATES, *LOADS))


def slopes(lengths, x, m=ARRAY):
    """Return theta4'' and theta4''', from the loop differentiated three times."""
    a1, a2, a3, _ = lengths
    y, b, dy, db, ddy, ddb = coordinates(lengths, 1.0, x, m)
    sine, cosine = m.sin(y - b), m.cos(y - b)
    return (ddy, ((3.0 * a2 * db * ddb - a1 * m.sin(x - b)) / a3 - 3.0 * dy * ddy * cosine) / sine
            + dy * dy * dy)


def by_grid(lengths, shift=0.0):
    """Refine between neighbours of different sign among 720 samples of a turn."""
    grid = 2.0 * pi * np.arange(721) / 720 + shift
    found = []
    for order, samples in enumerate(slopes(lengths, grid)):
        def slope(x, order=order):
            return slopes(lengths, x, SCALAR)[order]
        before = np.flatnonzero((samples[1:] >= 0.0) != (samples[:-1] >= 0.0)).tolist()
        found.append([brentq(slope, float(grid[k]), float(grid[k + 1])) for k in before])
    return found


OURS = 'find_extrema'
FINDERS = {OURS: ours, '720 points + brentq': by_grid,
           'the same, half a step on': partial(by_grid, shift=pi / 720)}
WAYS = {**FINDERS, 'find_extrema, certify': ours_proved,
        'find_extrema, and seven loads': ours_with_loads}


# --- time ----------------------------------------------------------------------------------------

def time_of(function, *arguments):
    """
    Return the CPU time of a call [s], without what others left to be collected.

    Short ones are called again until they have taken LEAST together: the caches are theirs then.
    """
    gc.collect()
    start, count, spent = time.process_time(), 0, 0.0
    while spent < LEAST:
        function(*arguments)
        count += 1
        spent = time.process_time() - start
    return spent / count


def each(way, linkages):
    for lengths in linkages:
        way(lengths)


def measure(linkages, many):
    """Return {name: CPU times per linkage [s], one a round}."""
    times = {name: [] for name in (*WAYS, 'batch')}
    each(ours, linkages)
    for _ in range(ROUNDS):
        for name, way in WAYS.items():
            times[name].append(time_of(each, way, linkages) / len(linkages))
        times['batch'].append(time_of(find_extrema_many, *many) / many.shape[1])
    return times


def table_of_times(times):
    """Print CPU times and their ratios to ours, each the median over the rounds."""
    table(("theta4' and theta4'' of one linkage", 'CPU time [ms]', f'over {OURS}'),
          [(name, f'{1e3 * median(times[name]):.3g}',
            f'{median(a / b for a, b in zip(times[name], times[OURS])):.3g}') for name in WAYS])
    print(f'A batch of {MANY} linkages (`find_extrema_many`): '
          f'{1.0 / median(times["batch"]):.3g} linkages per second of CPU time.\n')


# --- misses and errors ---------------------------------------------------------------------------

def judge(found, exact):
    """Return (missed, spurious, largest error of theta1 [rad]) of one quantity of one linkage."""
    found, missed, error = list(found), 0, 0.0
    for root in exact:
        near = min((distance(root, other) for other in exact if other is not root), default=inf)
        closest = min(found, key=partial(distance, root), default=None)
        if closest is None or distance(root, closest) > min(0.01, 0.25 * near):
            missed += 1
        else:
            error = max(error, distance(root, closest))
            found.remove(closest)
    return missed, len(found), error


def distance(one, other):
    """Return the distance of two angles [rad], rounded once."""
    return abs(float((mpmath.mpf(one) - other + mpmath.pi) % (2 * mpmath.pi) - mpmath.pi))


def cell(results, number):
    """Return the text of the results of :func:`judge` about ``number`` exact extrema."""
    missed, spurious, errors = zip(*results)
    extra = f', {sum(spurious)} spurious' if sum(spurious) else ''
    return f'{sum(missed)} of {number}{extra}; {max(errors):.0e}'


def table_of_misses(families):
    """Print how many of the exact extrema each way misses, and how wrong the others are."""
    with mpmath.workdps(40):
        columns = [column(linkages) for linkages in families.values()]
    table(('missed, spurious; largest error of theta1 [rad]', *families),
          [(name, *(texts[name] for texts in columns)) for name in FINDERS])


def column(linkages):
    """Return {way: text} about the linkages of one family."""
    exact = [[[x for x, _ in exact_roots(lengths, order)] for order in (0, 1)]
             for lengths in linkages]
    results = {name: [] for name in FINDERS}
    for lengths, truth in zip(linkages, exact):
        for name, way in FINDERS.items():
            results[name] += map(judge, way(lengths), truth)
    number = sum(len(roots) for truth in exact for roots in truth)
    return {name: cell(rows, number) for name, rows in results.items()}


def main():
    """Print run times, misses and errors."""
    rng = np.random.default_rng(1)
    known = families(rng)
    print(f'CPU time of the process; {PER_FAMILY} random crank-rockers, {ROUNDS} rounds, in each '
          'all ways in turn; medians.\n')
    table_of_times(measure(known['random'], crank_rockers(MANY, rng).T))
    print("Crank-rockers; seeds: the paper's linkage and the slides' Example 7.7; "
          f'others: {PER_FAMILY} linkages each. Exact: polynomials of degree 6 and 11 with '
          'rational coefficients, their roots isolated in integers. A root counts as found if '
          'nearer than a quarter of the distance to the next one, and than 0.01 rad; what is '
          'found beside is spurious. The grids have 0 and pi among their points, where near '
          'change points all happens; one is without.\n')
    table_of_misses(known)
