# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors in eps times condition over ordinary and extreme cases, of naive formulas too."""
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from math import nan

import numpy as np
from rich.console import Console
from rich.progress import track
from support.cartesian import EPS

from .errors import (
    COLORS,
    errors,
    FAMILIES,
    FORMULAS,
    MARKERS,
    ORDINARY,
    OURS,
    SYSTEM,
    WAYS,
)
from .near_toggle import draw_toggles, MARGINS, print_toggles, toggle_errors
from .pages import figure, save, table

# poses a family; random: 4 times
SAMPLES, RANDOM_TIMES, WORKERS = 600, 4, 2
LARGEST_DRAWN = 1e20
PROGRESS = Console(stderr=True)


def family_errors(family, samples):
    """Return the errors of :func:`errors` by their ways: arrays (poses, 4) and (poses,)."""
    rng = np.random.default_rng(FAMILIES.index(family))
    samples *= RANDOM_TIMES if family == 'random' else 1
    motion, loads = zip(*(errors(rng, family) for _ in range(samples)))
    return ({way: np.array([row[way] for row in motion]) for way in WAYS},
            {way: np.array([row[way] for row in loads]) for way in (OURS, SYSTEM)})


def largest(errors):
    """Return the largest error among the finite ones."""
    finite = errors[np.isfinite(errors)]
    return finite.max() if finite.size else nan


def digits(error):
    """Return an error in eps cond as text."""
    return f'{error:.2g}' if not error < 0.01 else '< 0.01'


def both(errors):
    """Return the largest error and the 99th percentile as text."""
    return f'{digits(largest(errors))} ({digits(np.nanquantile(errors, 0.99))})'


def print_ours(found):
    """Print errors and failures of the package by family."""
    print('Errors of fourbar_ros in eps times condition: largest (99th percentile). First column '
          f'in rad, where the condition of theta4 is at most {ORDINARY:g}.\n')
    rows = []
    for family, (motion, loads) in found.items():
        errors = motion[OURS]
        rows.append((family, len(errors), f'{largest(errors[:, 3]):.1e}' if errors[:, 3].any()
                     else '-',
                     *(both(errors[:, i]) for i in range(3)), both(loads[OURS]),
                     np.isnan(errors).any(axis=1).sum() + np.isnan(loads[OURS]).sum()))
    table(('family', 'poses', 'theta4 [rad]', 'theta4', "theta4'", "theta4''", 'worst reaction',
           'not finite'), rows)


def print_others(found):
    """Print largest errors and failures of the naive formulas by family."""
    print('The same poses by naive formulas: largest error in eps times condition; in brackets '
          'how many poses in 1000 have no finite result.\n')
    head = ['family'] + [f'{what}: {name}' for what in ('theta4', "theta4''") for name in FORMULAS]
    rows = []
    for family, (motion, loads) in found.items():
        cells = [failing(motion[name][:, i]) for i in (0, 2) for name in FORMULAS]
        rows.append((family, *cells, failing(loads[SYSTEM])))
    table((*head, 'worst reaction: 9x9'), rows)


def failing(errors):
    """Return the largest error and the share of failures as text."""
    share = np.isnan(errors).mean()
    text = digits(largest(errors)) if share < 1.0 else '-'
    return f'{text} ({1000.0 * share:.0f})' if share else text


def draw_families(found):
    """Draw the largest errors by family."""
    drawing, axes = figure(1, 3, figsize=(12.0, 6.6), sharey=True, sharex=True)
    names, rows = list(found), range(len(found))
    panels = (('θ4', 0), ("θ4''", 2), ('worst reaction', None))
    for axis, (title, i) in zip(axes, panels):
        for way in WAYS if i is not None else (OURS, SYSTEM):
            errors = [largest(motion[way][:, i] if i is not None else loads[way])
                      for motion, loads in found.values()]
            axis.plot(np.clip(errors, 0.1, LARGEST_DRAWN), rows, linestyle='none',
                      marker=MARKERS[way], color=COLORS[way],
                      markersize=11 if way == OURS else 6, label=way, alpha=0.9,
                      zorder=3 if way == OURS else 2)
        axis.axvline(5.0, color='0.6', linewidth=0.8, linestyle='--')
        axis.axvline(1.0 / EPS, color='0.8', linewidth=0.8)
        axis.set(xscale='log', xlim=(0.03, 20.0 * LARGEST_DRAWN), title=title,
                 xlabel='largest error [eps × condition]')
        axis.set_xticks([10.0**k for k in (0, 5, 10, 15)] + [LARGEST_DRAWN],
                        ['1', '$10^5$', '$10^{10}$', '$10^{15}$', r'$\geq10^{20}$'])
        axis.grid(True, axis='y', color='0.93')
    axes[0].set_yticks(list(rows), names)
    axes[0].set_ylim(len(found) - 0.4, -1.3)
    axes[0].text(7.0, -0.8, 'promised: 5', fontsize=8, color='0.4')
    axes[0].text(0.7 / EPS, -0.8, 'no digit left', fontsize=8, color='0.4', ha='right')
    lines = [*axes[0].get_lines()[:len(WAYS)], axes[2].get_lines()[1]]
    drawing.legend(handles=lines, loc='outside lower center', ncols=5, frameon=False)
    save(drawing, 'accuracy')
    print('![Largest errors by family; where a mark is missing, no result was finite]'
          '(accuracy.svg)\n')


def main(samples=SAMPLES):
    """Print all tables and draw; ``samples``: poses a family."""
    with ProcessPoolExecutor(WORKERS) as pool:
        families = pool.map(partial(family_errors, samples=samples), FAMILIES)
        toggles = pool.map(toggle_errors, MARGINS)
        found = dict(zip(FAMILIES, track(families, 'families', len(FAMILIES), console=PROGRESS,
                                         transient=True)))
        near = dict(zip(MARGINS, toggles))
    print_ours(found)
    draw_families(found)
    print_others(found)
    print_toggles(near)
    draw_toggles(near)
