# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Charts of a page as ECharts options: curves over the input with their extrema."""
from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from fourbar_lab.drawing.curves import marks_of, readable
from fourbar_lab.drawing.labels import significant
from fourbar_lab.live.model import Shown, written
from fourbar_ros.extrema.find import Extremum, MAXIMUM

# to be seen on light and on dark paper
COLOURS = ('#3b82c4', '#c8702a', '#2e9a56', '#a060c0', '#d0507a', '#8a961c')
INK = {'color': '#7a7a7a'}
GRID = {'lineStyle': {'color': 'rgba(128,128,128,.3)'}}
CURVE_HEIGHT, GAP, TOP, LEFT, RIGHT = 130, 46, 34, 78, 24      # [px]
CURSOR = '#c0392b'
GOOD = 50.0                 # [deg] a transmission angle is called good within this of 90 deg
BAND = 'rgba(60,160,80,.16)'

Options = dict[str, Any]        # a tree, as ECharts documents it


def height(count: int) -> int:
    """Return the height [px] of a chart of so many curves."""
    return TOP + max(1, count) * (CURVE_HEIGHT + GAP)


def over_input(shown: Shown, names: Sequence[str], extrema: Sequence[Extremum]) -> Options:
    """
    Return the options of a panel for each quantity by name, over the input, extrema marked.

    All ranges of the input share one axis, with gaps between; a band marks where a transmission
    angle is good.
    """
    curves = shown.curves(names)
    marks: dict[str, list[tuple[Extremum, float, float]]] = {name: [] for name in names}
    for mark in marks_of(shown.linkage, extrema):
        marks[mark[0].quantity].append(mark)
    inputs, *columns = curves.values
    columns = [readable(values, [value for *_, value in marks[name]])
               for name, values in zip(names, columns)]
    low, high = shown.bounds
    label = f'{curves.names[0]} [{curves.units[0]}]'
    tops = [TOP + i * (CURVE_HEIGHT + GAP) for i in range(len(names))]
    return {
        'animation': False, 'backgroundColor': 'transparent',
        'grid': [{'left': LEFT, 'right': RIGHT, 'height': CURVE_HEIGHT, 'top': top}
                 for top in tops],
        'title': [{'text': f'{name} [{written(unit)}]', 'left': LEFT - 4, 'top': top - 24,
                   'textStyle': {'fontSize': 13, 'fontWeight': 'normal', **INK}}
                  for name, unit, top in zip(names, curves.units[1:], tops)],
        'xAxis': [{'type': 'value', 'gridIndex': i, 'min': low, 'max': high, 'axisLabel': INK,
                   'name': label if i == len(names) - 1 else '', 'nameLocation': 'middle',
                   'nameGap': 26, 'nameTextStyle': INK, 'splitLine': GRID}
                  for i in range(len(names))],
        'yAxis': [{'type': 'value', 'gridIndex': i, 'scale': True, 'splitNumber': 4,
                   'axisLabel': INK, 'splitLine': GRID} for i in range(len(names))],
        'tooltip': {'trigger': 'axis'},
        'axisPointer': {'link': [{'xAxisIndex': 'all'}]},
        # a browser copies a few long columns in a fraction of the time of many pairs; NaN: a gap
        'dataset': [{'source': {name: [value if isfinite(value) else None for value in column]
                                for name, column in zip(('x', *names), (inputs, *columns))}}],
        'series': [{'type': 'line', 'id': f'line{i}', 'name': name, 'showSymbol': False,
                    'xAxisIndex': i, 'yAxisIndex': i, 'lineStyle': {'width': 2},
                    'encode': {'x': 'x', 'y': name}, 'color': COLOURS[i % len(COLOURS)],
                    'markPoint': {'data': [_mark(*mark) for mark in marks[name]],
                                  'silent': False},
                    'markArea': {'silent': True, 'itemStyle': {'color': BAND},
                                 'data': [[{'yAxis': 90.0 - GOOD}, {'yAxis': 90.0 + GOOD}]]
                                 if name.startswith('transmission_angle') else []}}
                   for i, name in enumerate(names)],
    }


def _mark(extremum: Extremum, x: float, value: float) -> Options:
    """Return the mark of an extremum, a global one with its value."""
    return {'coord': [x, value], 'value': significant(value), 'symbol': 'circle',
            'symbolSize': 9 if extremum.is_global else 5,
            'label': {'show': extremum.is_global, 'fontSize': 11, **INK,
                      'position': 'bottom' if extremum.kind == MAXIMUM else 'top'}}


def cursor_html(value: float, low: float, high: float) -> str:
    """Return the cursor, a line over all panels at a value of their axis."""
    share = (value - low) / (high - low) if high > low else 0.0
    return ('<div class="fb-cursor" style="left:'
            f'calc({LEFT}px + {share:.6f} * (100% - {LEFT + RIGHT}px))"></div>')
