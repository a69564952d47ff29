# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The page of a study: one HTML file with its tables and figures, which needs nothing else."""
from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from html import escape
import io
from pathlib import Path
from typing import Any

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.studies.answers import Answers, PERCENTILES, rank_correlations
import numpy as np

MOST_PAIRS, DOTS, BINS = 6, 4000, 60
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em;
       color: #222 }
table { border-collapse: collapse; margin: 1em 0; display: block; overflow-x: auto }
td, th { padding: .2em .8em; border-bottom: 1px solid #ddd; text-align: right;
         white-space: nowrap }
td:first-child, th:first-child { text-align: left }
img { max-width: 100% }
"""


def write_page(answers: Answers, path: str | Path) -> None:
    """Write the page of a study to a file."""
    # as for all output, under its name only when whole
    path = Path(path)
    hidden = path.with_name(f'.{path.name}.new')
    hidden.write_text(page(answers), encoding='utf-8')
    hidden.replace(path)


def page(answers: Answers) -> str:
    """Return the page of a study as HTML."""
    title = f'Study {answers.folder.path.resolve().name}'
    parts = [f'<h1>{escape(title)}</h1>', f'<p>{escape(about(answers))}</p>',
             table(('designs', ''), [(reason, str(number))
                                     for reason, number in answers.counts.items()])]
    if answers.kept:
        parts += ['<h2>Ranges</h2>', table(RANGE_HEADS, range_rows(answers))]
        if answers.objectives:
            parts += ['<h2>Best designs</h2>', table(*best_rows(answers))]
        for heading, text, figure in figures(answers):
            parts += [f'<h2>{escape(heading)}</h2>', f'<p>{escape(text)}</p>',
                      f'<img alt="{escape(heading)}" src="data:image/png;base64,{figure}">']
    body = '\n'.join(parts)
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<title>{escape(title)}</title><style>{STYLE}</style></head>\n<body>\n{body}\n'
            '</body></html>\n')


def about(answers: Answers) -> str:
    """Return what a study is as one line."""
    study = answers.study
    missing = '' if answers.is_whole else (f'; {study["rows"] - answers.designs} are not computed '
                                           'yet: --resume')
    return (f'{answers.designs} of {study["rows"]} designs ({study["method"]}, seed '
            f'{study["seed"]}), {answers.kept} kept{missing}.')


RANGE_HEADS = ('column', 'unit', 'least', *(f'{p} %' for p in PERCENTILES), 'greatest', 'mean')


def range_rows(answers: Answers) -> list[tuple[str, ...]]:
    """Return the rows of the table of ranges, under :data:`RANGE_HEADS`."""
    return [(one.name, one.unit, *(f'{value:.6g}' for value in
                                   (one.least, *one.percentiles, one.greatest, one.mean)))
            for one in answers.summaries()]


def best_rows(answers: Answers) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return heads and rows of the table of the best designs in each objective."""
    names = [*(name for name, _ in answers.objectives), *answers.varied]
    rows = []
    for objective, sense in answers.objectives:
        for row in answers.best(objective):
            design = answers.design(row)
            rows.append((f'{sense} {objective}', str(row),
                         *(f'{design[name]:.6g}' for name in names)))
    return ('', 'row', *names), rows


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table as HTML."""
    def line(cells: Sequence[str], tag: str) -> str:
        return '<tr>' + ''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells) + '</tr>'

    return '<table>' + line(heads, 'th') + ''.join(line(row, 'td') for row in rows) + '</table>'


def figures(answers: Answers) -> Iterator[tuple[str, str, str]]:
    """Yield (heading, text, PNG as base64) of each figure."""
    import matplotlib
    matplotlib.use('Agg')
    outputs = [name for name, _ in answers.objectives] or answers.measures[:3]
    columns = answers.sample([*answers.varied, *answers.measures])
    if len(answers.objectives) > 1:
        text = ('Every dot is a design; the line joins those that no other beats in both'
                + ('.' if len(answers.objectives) == 2 else ' or in another objective.'))
        yield 'Pareto front', text, _png(_front(answers, columns))
    yield ('Distributions', 'Lines: percentiles 5, 50 and 95. Infinite values are left out.',
           _png(_histograms(answers, columns, outputs)))
    numbers = [name for name in answers.varied if np.ptp(columns[name])]
    if numbers and outputs:
        yield ('Sensitivities', "Spearman's rank correlation of each parameter with each measure: "
               '1 rises with it, -1 falls.', _png(_sensitivities(columns, numbers, outputs)))
        yield ('Pairs', 'Parameters beside measures; colour: '
               f'{outputs[0]}.', _png(_pairs(columns, numbers[:MOST_PAIRS], outputs[:3])))


def _png(figure: Any) -> str:
    from matplotlib import pyplot
    file = io.BytesIO()
    figure.savefig(file, format='png', dpi=110, metadata={'Software': None})
    pyplot.close(figure)
    return base64.b64encode(file.getvalue()).decode()


def _labelled(answers: Answers, name: str) -> str:
    unit = answers.units.get(name)
    return f'{name} [{unit}]' if unit else name


def _dots(columns: dict[str, Array], names: list[str]) -> list[Array]:
    """Return finite values of some columns, at most :data:`DOTS` evenly spread ones."""
    fine = np.all([np.isfinite(columns[name]) for name in names], axis=0)
    step = max(1, int(fine.sum()) // DOTS)
    return [columns[name][fine][::step] for name in names]


def _front(answers: Answers, columns: dict[str, Array]) -> Any:
    from matplotlib import pyplot
    one, other = (name for name, _ in answers.objectives[:2])
    figure, axes = pyplot.subplots(figsize=(7, 5), layout='constrained')
    axes.plot(*_dots(columns, [one, other]), '.', markersize=3, color='0.7')
    front = answers.front()
    order = np.argsort(front[one])
    axes.plot(front[one][order], front[other][order], '.-', color='C3', markersize=6)
    axes.set(xlabel=_labelled(answers, one), ylabel=_labelled(answers, other))
    axes.grid(alpha=0.3)
    return figure


def _histograms(answers: Answers, columns: dict[str, Array], names: list[str]) -> Any:
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(1, len(names), figsize=(4 * len(names), 3.2), squeeze=False,
                                   layout='constrained')
    for axis, name in zip(axes[0], names):
        values = columns[name][np.isfinite(columns[name])]
        axis.hist(values, BINS, color='0.6')
        for percentile in np.percentile(values, PERCENTILES) if values.size else ():
            axis.axvline(percentile, color='C3', linewidth=1.0)
        axis.set(xlabel=_labelled(answers, name), yticks=[])
    return figure


def _sensitivities(columns: dict[str, Array], inputs: list[str], outputs: list[str]) -> Any:
    from matplotlib import pyplot
    found = rank_correlations(columns, inputs, outputs)
    figure, axes = pyplot.subplots(1, len(outputs), squeeze=False, sharey=True,
                                   layout='constrained',
                                   figsize=(4 * len(outputs) + 1, 0.4 * len(inputs) + 1.2))
    for axis, (name, by_input) in zip(axes[0], found.items()):
        axis.barh(list(by_input), list(by_input.values()), color='C0')
        axis.set(title=name, xlim=(-1.0, 1.0))
        axis.title.set_fontsize(10)
        axis.axvline(0.0, color='black', linewidth=0.8)
        axis.grid(alpha=0.3)
    axes[0][0].invert_yaxis()
    return figure


def _pairs(columns: dict[str, Array], inputs: list[str], outputs: list[str]) -> Any:
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(len(outputs), len(inputs), squeeze=False, sharex='col',
                                   sharey='row', layout='constrained',
                                   figsize=(2.4 * len(inputs) + 1, 2.2 * len(outputs)))
    for row, output in zip(axes, outputs):
        for axis, name in zip(row, inputs):
            x, y, colour = _dots(columns, [name, output, outputs[0]])
            axis.scatter(x, y, c=colour, s=3, cmap='viridis', rasterized=True)
            axis.tick_params(labelsize=7)
    for axis, name in zip(axes[-1], inputs):
        axis.set_xlabel(name, fontsize=8)
    for row, output in zip(axes, outputs):
        row[0].set_ylabel(output, fontsize=8)
    return figure
