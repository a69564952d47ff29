# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar study tolerances``: how bad the tolerances of a study make its design."""
from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite, isnan
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
    parser = actions.add_parser('tolerances', help='sensitivities, worst case and Monte Carlo of '
                                                   'the tolerances of a study',
                                description=DESCRIPTION,
                                formatter_class=HelpFormatter)
    parser.add_argument('study', metavar='STUDY', help='study (YAML, see docs/studies.md)')
    parser.add_argument('--rows', type=positive_integer, metavar='N',
                        help='designs to draw; default: the rows of the study')
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> None:
    from fourbar_lab.studies.chunks import FEASIBLE
    from fourbar_lab.studies.study import read
    from fourbar_lab.studies.tolerance_analysis import box_of, tolerances
    from fourbar_ros.terminal import make_console, make_table
    study = read(arguments.study)
    if arguments.rows:
        study = replace(study, rows=arguments.rows)
    box, units = box_of(study), {parameter.name: parameter.unit for parameter in study.vary}
    results, corners = tolerances(study)
    drawn, draws = _drawn(study)
    bounds, derivatives = list[tuple[str, ...]](), list[tuple[str, ...]]()
    for result in results:
        measure, value, of_draws = (result.sensitivity.measure, result.sensitivity.value,
                                    drawn[result.sensitivity.measure.name])
        assert not isinstance(value, str)           # tolerances() leaves the class out
        bounds.append((measure.name, measure.unit, *map(_text, (
            value, value - result.first_order, value + result.first_order, result.corners.least,
            result.corners.greatest, of_draws.least, of_draws.greatest, *of_draws.percentiles))))
        derivatives += _derivative_rows(result, box, units)
    console = make_console()
    for title, heads, rows in (
            ('box', ('parameter', 'unit', 'middle>', '+->'),
             [(name, units[name], _text(centre), _text(size))
              for name, (centre, size) in box.items()]),
            (f'least and greatest value, and percentiles of {_known(draws)} designs',
             ('measure', 'unit', 'middle>', *(f'{end} {way}>' for way in
                                              ('first order', 'of corners', 'drawn')
                                              for end in ('least', 'greatest')),
              '5 %>', '50 %>', '95 %>'), bounds),
            ('derivatives, and what each tolerance contributes',
             ('measure', 'parameter', 'derivative>', 'unit', '+->'), derivatives)):
        console.print(make_table(title, heads, rows))
        console.print()
    for line in _left_out(results, corners, drawn, draws):
        console.print(line, soft_wrap=True)
    if study.bounds:
        console.print(f'{100.0 * draws[FEASIBLE] / study.rows:.6g} % of the designs fulfil the '
                      'constraints')


def _drawn(study: Study) -> tuple[dict[str, Summary], Counter[str]]:
    """
    Compute the rows of a study; return {measure: Summary} and {reason: number of designs}.

    All rows that can be built count, feasible or not; objectives are left out.
    """
    from fourbar_lab.studies.chunks import compute
    from fourbar_lab.studies.results import summary
    import numpy as np
    study = replace(study, keeps_all=True, objectives={})
    chunks = [compute(study, index) for index in range(study.chunks)]
    counts = sum((Counter(chunk.counts) for chunk in chunks), Counter[str]())
    return {measure.name: summary(measure.name, measure.unit, np.concatenate(
        [chunk.columns[measure.name] for chunk in chunks]))
        for measure in study.measures if measure.part != 'class'}, counts


def _known(counts: dict[str, int]) -> int:
    from fourbar_lab.studies.chunks import FAILED, NOT_BUILT
    return sum(counts.values()) - counts.get(NOT_BUILT, 0) - counts.get(FAILED, 0)


def _left_out(results: list[Toleranced], corners: dict[str, int], drawn: dict[str, Summary],
              draws: dict[str, int]) -> Iterator[str]:
    """Yield a line for all that the tables leave out: designs, values, first orders."""
    from fourbar_lab.studies.chunks import FAILED, NOT_BUILT

    def counted(of_draws: int, of_corners: int, all_draws: int, all_corners: int) -> str:
        return ' and '.join(f'{count} of {total} {name}' for count, total, name in (
            (of_draws, all_draws, 'draws'), (of_corners, all_corners, 'corners')) if count)

    for reason in (NOT_BUILT, FAILED):
        text = counted(draws.get(reason, 0), corners.get(reason, 0), sum(draws.values()),
                       sum(corners.values()))
        if text:
            yield f'{text} {reason}'
    for result in results:
        measure = result.sensitivity.measure
        text = counted(drawn[measure.name].missing, result.corners.missing, _known(draws),
                       _known(corners))
        if text:
            yield f'{measure.name} has no value in {text}'
        if result.sensitivity.why_unknown:
            yield f'{measure.name} has no first order: {result.sensitivity.why_unknown}'


def _derivative_rows(result: Toleranced, box: dict[str, tuple[float, float]], units: dict[str, str]
                     ) -> list[tuple[str, ...]]:
    measure, by = result.sensitivity.measure, result.sensitivity.by
    if not any(isfinite(value) for value in by.values()):
        return []
    rows = list[tuple[str, ...]]()
    shares = {name: abs(by[name]) * size for name, (_, size) in box.items()}
    for name in sorted(shares, key=lambda name: (isnan(shares[name]), -shares[name])):
        # the derivative of N m by kg/m has the unit (N m)/(kg/m)
        above, below = (f'({unit})' if set(unit) & set(' /') else unit or '1'
                        for unit in (measure.unit, units[name]))
        rows.append((measure.name, name, _text(by[name]),
                     above if below == '1' else f'{above}/{below}', _text(shares[name])))
    return rows


def _text(value: float) -> str:
    return '-' if isnan(value) else f'{value:.6g}'
