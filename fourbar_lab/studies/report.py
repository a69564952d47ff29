# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The page of a study: one HTML file with its tables and figures, which needs nothing else."""
from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from html import escape
import io
from pathlib import Path
from typing import TYPE_CHECKING

from fourbar_lab.studies.results import PERCENTILES, rank_correlations, Results
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.figure import Figure

MOST_PAIRS = 6          # parameters in the figure of pairs
DOTS, BINS = 4000, 60   # of scatter plots, of histograms
FRONT, LISTED = 'Pareto front', 20      # heading, and how many designs of it are listed
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em;
       color: #222 }
table { border-collapse: collapse; margin: 1em 0; display: block; overflow-x: auto }
td, th { padding: .2em .8em; border-bottom: 1px solid #ddd; text-align: right;
         white-space: nowrap }
td:first-child, th:first-child { text-align: left }
img { max-width: 100% }
"""


def write_page(results: Results, path: str | Path) -> None:
    """Write the page of a study to a file."""
    # as for all output, under its name only when whole
    path = Path(path)
    hidden = path.with_name(f'.{path.name}.new')
    hidden.write_text(page(results), encoding='utf-8')
    hidden.replace(path)


def page(results: Results) -> str:
    """Return the page of a study as HTML."""
    title = f'Study {results.folder.path.resolve().name}'
    parts = [f'<h1>{escape(title)}</h1>', f'<p>{escape(about(results))}</p>',
             table(('designs', ''), [(reason, str(number))
                                     for reason, number in results.counts.items()])]
    if results.kept:
        parts += ['<h2>Ranges</h2>', table(RANGE_HEADS, range_rows(results))]
        if results.objectives:
            parts += ['<h2>Best designs</h2>', table(*best_rows(results))]
        for heading, text, figure in figures(results):
            parts += [f'<h2>{escape(heading)}</h2>', f'<p>{escape(text)}</p>',
                      f'<img alt="{escape(heading)}" src="data:image/png;base64,{figure}">']
            if heading == FRONT:
                parts.append(table(*front_rows(results)))
    body = '\n'.join(parts)
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<title>{escape(title)}</title><style>{STYLE}</style></head>\n<body>\n{body}\n'
            '</body></html>\n')


def about(results: Results) -> str:
    """Return how many designs a study has computed and kept, and how they were drawn, as text."""
    study = results.study
    missing = '' if results.is_whole else (f'; {study["rows"] - results.designs} are not computed '
                                           'yet: --resume')
    return (f'{results.designs} of {study["rows"]} designs ({study["method"]}, seed '
            f'{study["seed"]}), {results.kept} kept{missing}.')


RANGE_HEADS = ('column', 'unit', 'least', *(f'{p} %' for p in PERCENTILES), 'greatest', 'mean')


def range_rows(results: Results) -> list[tuple[str, ...]]:
    """Return the rows of the table of ranges, under :data:`RANGE_HEADS`."""
    return [(one.name, one.unit, *(f'{value:.6g}' for value in
                                   (one.least, *one.percentiles, one.greatest, one.mean)))
            for one in results.summaries()]


def best_rows(results: Results) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return heads and rows of the table of the best designs in each objective."""
    names = [*(name for name, _ in results.objectives), *results.varied]
    rows = []
    for objective, sense in results.objectives:
        for row in results.best(objective):
            design = results.design(row)
            rows.append((f'{sense} {objective}', str(row),
                         *(f'{design[name]:.6g}' for name in names)))
    return ('', 'row', *names), rows


def front_rows(results: Results) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return heads and rows of the table of the Pareto front, :data:`LISTED` of it at most."""
    names = [*(name for name, _ in results.objectives), *results.varied]
    designs = [results.design(row) for row in _listed(results.front(), names[0])]
    return ('row', *names), [(str(design['row']), *(f'{design[name]:.6g}' for name in names))
                             for design in designs]


def _listed(front: dict[str, Array], name: str) -> list[int]:
    """Return the rows of a front that are listed, by an objective; of many, evenly spread ones."""
    rows = front['row'][np.argsort(front[name], kind='stable')]
    places = np.unique(np.linspace(0, len(rows) - 1, min(len(rows), LISTED)).round().astype(int))
    return [int(row) for row in rows[places]]


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of texts as HTML."""
    def line(cells: Sequence[str], tag: str) -> str:
        return '<tr>' + ''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells) + '</tr>'

    return '<table>' + line(heads, 'th') + ''.join(line(row, 'td') for row in rows) + '</table>'


def figures(results: Results) -> Iterator[tuple[str, str, str]]:
    """Yield (heading, text, PNG as base64) of each figure."""
    outputs = [name for name, _ in results.objectives] or results.measures[:3]
    columns = results.sample([*results.varied, *results.measures])
    if len(results.objectives) > 1:
        yield FRONT, front_words(results), _png(_front(results, columns))
    yield ('Distributions', 'Lines: percentiles 5, 50 and 95. Infinite values are left out.',
           _png(_histograms(results, columns, outputs)))
    numbers = [name for name in results.varied if np.ptp(columns[name])]
    if numbers and outputs:
        yield ('Sensitivities', "Spearman's rank correlation of each parameter with each measure: "
               '1 rises with it, -1 falls.', _png(_sensitivities(columns, numbers, outputs)))
        yield ('Pairs', 'Parameters beside measures; colour: '
               f'{outputs[0]}.', _png(_pairs(columns, numbers[:MOST_PAIRS], outputs[:3])))


def front_words(results: Results) -> str:
    """Return the meaning of a Pareto front, and how much of it is listed, as text."""
    count = len(results.front()['row'])
    listed = '' if count <= LISTED else f' {LISTED} of them, evenly spread, have their number.'
    return (f'The {count} designs that no other beats in one of the {len(results.objectives)} '
            f'objectives without being worse in another.{listed} fourbar study pick takes the '
            'number of a row.')


def _png(figure: Figure) -> str:
    """Return a figure as PNG in base64, the same bytes every time."""
    file = io.BytesIO()
    figure.savefig(file, format='png', dpi=110, metadata={'Software': None})
    return base64.b64encode(file.getvalue()).decode()


def _labelled(results: Results, name: str) -> str:
    """Return the name of a column with its unit."""
    unit = results.units.get(name)
    return f'{name} [{unit}]' if unit else name


def _dots(columns: dict[str, Array], names: list[str]) -> list[Array]:
    """Return columns at rows where all are finite, at most :data:`DOTS` evenly spread ones."""
    fine = np.all([np.isfinite(columns[name]) for name in names], axis=0)
    step = max(1, int(fine.sum()) // DOTS)
    return [columns[name][fine][::step] for name in names]


def _front(results: Results, columns: dict[str, Array]) -> Figure:
    """Draw the front over the first objective, a panel for each other one."""
    from matplotlib.figure import Figure
    one, *others = (name for name, _ in results.objectives)
    figure = Figure(figsize=(7 * min(len(others), 2), 5), layout='constrained')
    panels, = figure.subplots(1, len(others), squeeze=False)
    front = results.front()
    order = np.argsort(front[one])
    listed = np.isin(front['row'], _listed(front, one))
    for axes, other in zip(panels, others):
        axes.plot(*_dots(columns, [one, other]), '.', markersize=3, color='0.7')
        # of more than two objectives each panel is a projection: a line would be a zigzag
        axes.plot(front[one][order], front[other][order], '.-' if len(others) == 1 else '.',
                  color='C3', markersize=6)
        for row, x, y in zip(*(front[name][listed] for name in ('row', one, other))):
            axes.annotate(str(row), (x, y), (3, 3), textcoords='offset points', fontsize=7)
        axes.set(xlabel=_labelled(results, one), ylabel=_labelled(results, other))
        axes.grid(alpha=0.3)
    return figure


def _histograms(results: Results, columns: dict[str, Array], names: list[str]) -> Figure:
    """Draw a histogram of each of some columns, with its percentiles."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(4 * len(names), 3.2), layout='constrained')
    panels, = figure.subplots(1, len(names), squeeze=False)
    for axes, name in zip(panels, names):
        values = columns[name][np.isfinite(columns[name])]
        axes.hist(values, BINS, color='0.6')
        for percentile in np.percentile(values, PERCENTILES) if values.size else ():
            axes.axvline(percentile, color='C3', linewidth=1.0)
        axes.set(xlabel=_labelled(results, name), yticks=[])
    return figure


def _sensitivities(columns: dict[str, Array], inputs: list[str], outputs: list[str]) -> Figure:
    """Draw rank correlations as bars, a panel for each output."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(4 * len(outputs) + 1, 0.4 * len(inputs) + 1.2), layout='constrained')
    panels, = figure.subplots(1, len(outputs), squeeze=False, sharey=True)
    for axes, (output, by_input) in zip(panels,
                                        rank_correlations(columns, inputs, outputs).items()):
        axes.barh(list(by_input), list(by_input.values()), color='C0')
        axes.set_title(output, fontsize=10)
        axes.set(xlim=(-1.0, 1.0))
        axes.axvline(0.0, color='black', linewidth=0.8)
        axes.grid(alpha=0.3)
    panels[0].invert_yaxis()
    return figure


def _pairs(columns: dict[str, Array], inputs: list[str], outputs: list[str]) -> Figure:
    """Draw each output over each input; colours are values of the first output."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(2.4 * len(inputs) + 1, 2.2 * len(outputs)), layout='constrained')
    grid = figure.subplots(len(outputs), len(inputs), squeeze=False, sharex='col', sharey='row')
    for row, output in zip(grid, outputs):
        row[0].set_ylabel(output, fontsize=8)
        for axes, name in zip(row, inputs):
            x, y, colour = _dots(columns, [name, output, outputs[0]])
            axes.scatter(x, y, c=colour, s=3, cmap='viridis', rasterized=True)
            axes.tick_params(labelsize=7)
    for axes, name in zip(grid[-1], inputs):
        axes.set_xlabel(name, fontsize=8)
    return figure
