# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Charts of a page as ECharts options: curves over the input with their extrema."""
from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, radians
from typing import Any

from fourbar_lab.drawing.labels import significant
from fourbar_lab.drawing.record import counted
from fourbar_lab.live.model import LIMIT, Shown, written
from fourbar_ros.extrema.find import CONSTANT, Extremum, INTERIOR, MAXIMUM
import numpy as np

# to be seen on light and on dark paper
COLOURS = ('#3b82c4', '#c8702a', '#2e9a56', '#a060c0', '#d0507a', '#8a961c')
INK = {'color': '#7a7a7a'}
GRID = {'lineStyle': {'color': 'rgba(128,128,128,.3)'}}
CURVE_HEIGHT, GAP, TOP, LEFT, RIGHT = 130, 46, 34, 78, 24      # [px]
CURSOR = '#c0392b'
NEAR, FAR = 10.0, 30.0      # a curve beyond FAR times its median size is shown up to NEAR times
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
    inputs: list[float | None] = []
    for cycle in shown.cycles:              # a gap separates the ranges of the input
        inputs += [*map(shown.shown_input, cycle.inputs.tolist()), None]
    columns = {'x': inputs} | {name: _column(shown, name) for name in names}
    low, high = shown.shown_input(shown.ranges[0][0]), shown.shown_input(shown.ranges[-1][1])
    label = f'{shown.linkage.input_coordinate.position} [{shown.input_unit}]'
    tops = [TOP + i * (CURVE_HEIGHT + GAP) for i in range(len(names))]
    return {
        'animation': False, 'backgroundColor': 'transparent',
        'grid': [{'left': LEFT, 'right': RIGHT, 'height': CURVE_HEIGHT, 'top': top}
                 for top in tops],
        'title': [{'text': f'{name} [{written(shown.quantities[name].unit)}]', 'left': LEFT - 4,
                   'top': top - 24, 'textStyle': {'fontSize': 13, 'fontWeight': 'normal', **INK}}
                  for name, top in zip(names, tops)],
        'xAxis': [{'type': 'value', 'gridIndex': i, 'min': low, 'max': high, 'axisLabel': INK,
                   'name': label if i == len(names) - 1 else '', 'nameLocation': 'middle',
                   'nameGap': 26, 'nameTextStyle': INK, 'splitLine': GRID}
                  for i in range(len(names))],
        'yAxis': [{'type': 'value', 'gridIndex': i, 'scale': True, 'splitNumber': 4,
                   'axisLabel': INK, 'splitLine': GRID,
                   **_bounds(columns[name], [extremum.value for extremum in extrema
                                             if extremum.quantity == name
                                             and extremum.place == INTERIOR])}
                  for i, name in enumerate(names)],
        'tooltip': {'trigger': 'axis'},
        'axisPointer': {'link': [{'xAxisIndex': 'all'}]},
        # a browser copies a few long columns in a fraction of the time of many pairs
        'dataset': [{'source': columns}],
        'series': [{'type': 'line', 'id': f'line{i}', 'name': name, 'showSymbol': False,
                    'xAxisIndex': i, 'yAxisIndex': i, 'lineStyle': {'width': 2},
                    'encode': {'x': 'x', 'y': name}, 'color': COLOURS[i % len(COLOURS)],
                    'markPoint': {'data': _marks(shown, name, extrema), 'silent': False},
                    'markArea': {'silent': True, 'itemStyle': {'color': BAND},
                                 'data': [[{'yAxis': radians(90.0 - GOOD)},
                                           {'yAxis': radians(90.0 + GOOD)}]]
                                 if name.startswith('transmission_angle') else []}}
                   for i, name in enumerate(names)],
    }


def _bounds(values: Sequence[float | None], extrema: Sequence[float]) -> dict[str, float | None]:
    """
    Return {'min', 'max'} of a value axis; None leaves the choice to the chart.

    A curve that grows without bound at toggles is cut off above its usual values and its extrema.
    """
    sizes = np.abs([value for value in values if value is not None])
    typical = float(np.median(sizes)) if len(sizes) else 0.0
    bound = max([NEAR * typical, *(1.2 * abs(value) for value in extrema)])
    if not typical or sizes.max() <= max(FAR * typical, bound):
        return {'min': None, 'max': None}
    kept = [value for value in values if value is not None and abs(value) <= bound]
    return {'min': float(f'{min(kept):.2g}'), 'max': float(f'{max(kept):.2g}')}


def _column(shown: Shown, name: str) -> list[float | None]:
    """
    Return the values of a quantity over all ranges of the input, with a gap (None) after each.

    Values that are huge beside the others, at toggles, are gaps too.
    """
    data: list[float | None] = []
    for _, values in shown.curves(name):
        with np.errstate(invalid='ignore'):
            bound = LIMIT * float(np.nanmedian(np.abs(values))) or np.inf
            data += [value if abs(value) < bound else None for value in values.tolist()]
        data.append(None)
    return data


def _marks(shown: Shown, name: str, extrema: Sequence[Extremum]) -> list[Options]:
    """Return the marks of the extrema of a quantity, the global ones with their value."""
    return [{'coord': [shown.shown_input(counted(shown.linkage, extremum.input)), extremum.value],
             'value': significant(extremum.value), 'symbol': 'circle',
             'symbolSize': 9 if extremum.is_global else 5,
             'label': {'show': extremum.is_global, 'fontSize': 11, **INK,
                       'position': 'bottom' if extremum.kind == MAXIMUM else 'top'}}
            for extremum in extrema if extremum.quantity == name and extremum.kind != CONSTANT
            and isfinite(extremum.value)]


def cursor_html(value: float, low: float, high: float) -> str:
    """Return the cursor, a line over all panels at a value of their axis."""
    share = (value - low) / (high - low) if high > low else 0.0
    return ('<div class="fb-cursor" style="left:'
            f'calc({LEFT}px + {share:.6f} * (100% - {LEFT + RIGHT}px))"></div>')
