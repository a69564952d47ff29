# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar study tolerances``: how bad the tolerances of a study make its design."""
from __future__ import annotations

import argparse
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING

from fourbar_ros.cli.common import HelpFormatter, Verbs
from fourbar_ros.scene.arguments import positive_integer

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_lab.studies import Study, Summary, Toleranced

DESCRIPTION = """\
Show how the measures of a study change with the parameters that vary in it, around the middle of
their tolerances (uniform, normal: three deviations, range): exact derivatives; the worst case by
the first order and in the corners of the box; and what the rows of the study, drawn at random,
give.
"""


def add(actions: Verbs) -> None:
    """Add the action."""
    parser = actions.add_parser('tolerances', help='sensitivities, worst case and Monte Carlo of '
                                                   'the tolerances of a study',
                                description=DESCRIPTION,
                                formatter_class=HelpFormatter)
    parser.add_argument('study', metavar='STUDY', help='study (YAML, see docs/studies.md)')
    parser.add_argument('--rows', type=positive_integer, metavar='N',
                        help='designs to draw; default: the rows of the study')
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> None:
    """Print three tables: the box, the bounds of each measure, its derivatives."""
    from fourbar_lab.studies.study import read
    from fourbar_lab.studies.tolerance_analysis import box_of, tolerances
    from fourbar_ros.terminal import make_console, make_table
    study = read(arguments.study)
    if arguments.rows:
        study = replace(study, rows=arguments.rows)
    box, units = box_of(study), {one.name: one.unit for one in study.vary}
    results = tolerances(study)
    drawn, share = _drawn(study)
    console = make_console()
    for title, heads, rows in (
            ('box', ('parameter', 'unit', 'middle>', '+->'),
             [(name, units[name], _text(centre), _text(size))
              for name, (centre, size) in box.items()]),
            (f'least and greatest value, and percentiles of {study.rows} designs',
             ('measure', 'unit', 'middle>', *(f'{end} {way}>' for way in
                                              ('first order', 'of corners', 'drawn')
                                              for end in ('least', 'greatest')),
              '5 %>', '50 %>', '95 %>'), [_bounds_row(one, drawn) for one in results]),
            ('derivatives, and what each tolerance contributes',
             ('measure', 'parameter', 'derivative>', 'unit', '+->'),
             [row for one in results for row in _derivative_rows(one, box, units)])):
        console.print(make_table(title, heads, rows))
        console.print()
    if study.bounds:
        console.print(f'{100.0 * share:.6g} % of the designs fulfil the constraints')


def _drawn(study: Study) -> tuple[dict[str, Summary], float]:
    """
    Compute the rows of a study; return {measure: its Summary} and the share that is feasible.

    All rows count, feasible or not, and nobody wants objectives here.
    """
    from fourbar_lab.studies.chunks import compute
    from fourbar_lab.studies.results import summary
    import numpy as np
    study = replace(study, keeps_all=True, objectives={})
    chunks = [compute(study, number) for number in range(study.chunks)]
    columns = {name: np.concatenate([chunk.columns[name] for chunk in chunks])
               for name in ('feasible', *(one.name for one in study.measures
                                          if one.part != 'class'))}
    share = np.count_nonzero(columns.pop('feasible')) / study.rows
    return {name: summary(name, '', column) for name, column in columns.items()}, share


def _bounds_row(one: Toleranced, drawn: dict[str, Summary]) -> tuple[str, ...]:
    """Return a row: a measure in the middle, (least, greatest) by each way, drawn percentiles."""
    measure, value = one.sensitivity.measure, one.sensitivity.value
    of_drawn = drawn[measure.name]
    assert not isinstance(value, str)           # tolerances() leaves the class out
    numbers = (value, value - one.first_order, value + one.first_order, *one.corners,
               of_drawn.least, of_drawn.greatest, *of_drawn.percentiles)
    return (measure.name, measure.unit, *map(_text, numbers))


def _derivative_rows(one: Toleranced, box: dict[str, tuple[float, float]], units: dict[str, str]
                     ) -> list[tuple[str, ...]]:
    """Return the rows of a measure's derivatives, first the tolerance that contributes most."""
    measure, by = one.sensitivity.measure, one.sensitivity.by
    if not any(isfinite(value) for value in by.values()):
        return []
    shares = {name: abs(by[name]) * size for name, (_, size) in box.items()}
    return [(measure.name, name, _text(by[name]), _unit(measure.unit, units[name]),
             _text(shares[name])) for name in sorted(shares, key=lambda name: -shares[name])]


def _unit(of: str, by: str) -> str:
    """Return the unit of a derivative: of N m by kg/m it is (N m)/(kg/m)."""
    of, by = (f'({unit})' if set(unit) & set(' /') else unit or '1' for unit in (of, by))
    return of if by == '1' else f'{of}/{by}'


def _text(value: float) -> str:
    """Return a number as text; a dash for an unknown one."""
    return f'{value:.6g}' if isfinite(value) else '-'
