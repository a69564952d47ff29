# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The two published studies: an atlas of 4R linkages with loads; the paper's question again."""
from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path
import tempfile

from fourbar_lab.studies.engine import Local, run
from fourbar_lab.studies.folder import Folder
from fourbar_lab.studies.results import Results
from fourbar_lab.studies.study import read
import numpy as np

from . import pages, ROOT
from .shaking import CLOSE

CONFIG, PICTURES = ROOT / 'config' / 'studies', ROOT / 'docs' / 'bench'
DOTS, GOOD = 6000, pi / 6.0


def answers_of(name, rows, folder):
    """Run a study with a number of rows; return its results."""
    study, path = replace(read(CONFIG / f'{name}.yaml'), rows=rows), Folder(Path(folder) / name)
    path.begin(study, False)
    executor = Local(None)
    try:
        run(study, path, executor)
    finally:
        executor.close()
    return Results(path.path)


def columns_of(results):
    """Return all columns of the designs that were kept."""
    from pyarrow import parquet
    names = ['class', *results.varied, *results.measures]
    tables = [parquet.read_table(path) for path in results.parts.values()]
    return {name: np.concatenate([np.asarray(table[name]) for table in tables])
            for name in names if name in tables[0].column_names}


def print_counts(results):
    """Print how many designs were drawn and kept."""
    counts = ', '.join(f'{reason} {number}' for reason, number in results.counts.items())
    print(f'{results.designs} designs: {counts}.\n')


def atlas(rows, folder):
    """Print and draw the atlas."""
    results = answers_of('atlas', rows, folder)
    columns = columns_of(results)
    print('## Atlas (config/studies/atlas.yaml)\n')
    print_counts(results)
    columns['peak of omega4'] = np.maximum(abs(columns['omega4.max']), abs(columns['omega4.min']))
    columns['peak of alpha4'] = np.maximum(abs(columns['alpha4.max']), abs(columns['alpha4.min']))
    print('| class | designs | measure | unit | 5 % | 50 % | 95 % |')
    print('| --- | --- | --- | --- | --- | --- | --- |')
    kinds = np.unique(columns['class']).tolist()
    for kind in kinds:
        here = columns['class'] == kind
        for name, unit in (('peak of omega4', 'rad/s'), ('peak of alpha4', 'rad/s²'),
                           ('shaking_force.max', 'N'), ('least_transmission_angle', 'rad'),
                           ('swing', 'rad'), ('time_ratio', '')):
            values = columns[name][here & np.isfinite(columns[name])]
            if values.size:
                shown = ' | '.join(f'{v:.4g}' for v in np.percentile(values, (5, 50, 95)))
                print(f'| {kind} | {here.sum()} | {name} | {unit} | {shown} |')
    draw_atlas(columns, kinds)
    print('\n![Peaks of rate, acceleration and shaking force beside the least transmission angle]'
          '(atlas.svg)\n')


def draw_atlas(columns, kinds):
    """Write the figure of the atlas."""
    pyplot = plotting()
    figure, axes = pyplot.subplots(1, 3, figsize=(12, 4), sharex=True, layout='constrained')
    step = max(1, len(columns['class']) // DOTS)
    for axis, (name, text) in zip(axes, (('peak of omega4', 'peak of ω4 [rad/s]'),
                                         ('peak of alpha4', 'peak of α4 [rad/s²]'),
                                         ('shaking_force.max', 'largest shaking force [N]'))):
        for kind, colour in zip(kinds, ('C0', 'C3', 'C2')):
            here = np.nonzero(columns['class'] == kind)[0][::step]
            axis.plot(np.degrees(columns['least_transmission_angle'][here]), columns[name][here],
                      '.', markersize=2, color=colour, label=kind, rasterized=True)
        axis.set(yscale='log', xlabel='least transmission angle [deg]', title=text)
        axis.grid(alpha=0.3)
    axes[0].legend(markerscale=5)
    save(figure, 'atlas')


def distances(columns):
    """Return {load: {quantity: distance [deg] of its peak from the nearest global extreme}}."""
    moment = np.where(abs(columns['shaking_moment.max']) >= abs(columns['shaking_moment.min']),
                      columns['shaking_moment.max_at'], columns['shaking_moment.min_at'])
    peaks = {'force': columns['shaking_force.max_at'], 'moment': moment}
    return {load: {name: np.degrees(np.minimum(*(
        abs((at - columns[f'{name}.{end}_at'] + pi) % (2.0 * pi) - pi) for end in ('max', 'min'))))
        for name in ('omega4', 'alpha4')} for load, at in peaks.items()}


def shaking(rows, folder):
    """Print and draw how far the peaks of the shaking loads are from extreme rates."""
    results = answers_of('shaking', rows, folder)
    columns = columns_of(results)
    print('## Shaking (config/studies/shaking.yaml)\n')
    print_counts(results)
    found = distances(columns)
    good = columns['least_transmission_angle'] > GOOD
    print('| peak of the shaking | to the nearer of largest and least | transmission angle | '
          'linkages | median [deg] | 90 % | 99 % | within 10.5 deg |')
    print('| --- | --- | --- | --- | --- | --- | --- | --- |')
    for load, by in found.items():
        for name, values in by.items():
            for text, mask in (('any', good | True), ('in [30, 150] deg', good)):
                shown = ' | '.join(f'{v:.1f}' for v in np.percentile(values[mask], (50, 90, 99)))
                print(f'| {load} | {name} | {text} | {mask.sum()} | {shown} | '
                      f'{100.0 * (values[mask] <= CLOSE).mean():.1f} % |')
    draw_shaking(found)
    print('\n![How far the shaking peaks are from the largest and least rates and accelerations]'
          '(shaking_many.svg)')


def draw_shaking(found):
    """Write the figure of the distances."""
    pyplot = plotting()
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4), sharey=True, layout='constrained')
    shares = np.linspace(0.0, 100.0, 1001)
    for axis, (load, by) in zip(axes, found.items()):
        for (name, values), style in zip(by.items(), ('--', '-')):
            axis.plot(np.percentile(values, shares), shares, style, color='black',
                      label={'omega4': 'extreme velocity', 'alpha4': 'extreme acceleration'}[name])
        axis.axvline(CLOSE, color='grey', linewidth=0.8)
        axis.set(title=f'peak of the shaking {load}', xlim=(0.0, 90.0), ylim=(0.0, 100.0),
                 xlabel='distance in θ1 to the nearer of largest and least [deg]')
        axis.grid(alpha=0.3)
    axes[0].set_ylabel('linkages [%]')
    axes[1].legend(loc='lower right')
    save(figure, 'shaking_many')


def plotting():
    """Return pyplot, whose files are the same each time."""
    import matplotlib
    matplotlib.use('Agg')
    matplotlib.rcParams['svg.hashsalt'] = 'fourbar'
    from matplotlib import pyplot
    return pyplot


def save(figure, name):
    """Write a figure as SVG."""
    if pages.is_written:
        figure.savefig(PICTURES / f'{name}.svg', metadata={'Date': None}, dpi=130)


def main(samples=65_536):
    """Run both studies with this many designs."""
    with tempfile.TemporaryDirectory() as folder:
        atlas(samples, folder)
        shaking(4 * samples, folder)


if __name__ == '__main__':
    main()
