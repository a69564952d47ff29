# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Charts of a page as ECharts options: curves over the input with extrema, polar force plots."""
from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from fourbar_ros.extrema.find import CONSTANT, Extremum, MAXIMUM
from fourbar_ros.live.model import LIMIT, Shown
from fourbar_ros.report.cycles import ground_forces
from fourbar_ros.report.mechanism_panel import significant
import numpy as np

COLOURS = ('#2463a8', '#a3501c', '#1e6b37', '#7b3294', '#8a1538', '#4d5b00')
CURVE_HEIGHT, GAP, TOP, LEFT, RIGHT = 130, 46, 34, 78, 24      # [px]
CURSOR = '#c0392b'


def height(count: int) -> int:
    """Return the height [px] of a chart of so many curves."""
    return TOP + max(1, count) * (CURVE_HEIGHT + GAP)


def over_input(shown: Shown, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> dict[str, Any]:
    """Return the options of one panel for each quantity, over one input axis, extrema marked."""
    series = [_curve(shown, name, i, extrema) for i, name in enumerate(names)]
    ends = shown.shown_input(shown.ranges[0][0]), shown.shown_input(shown.ranges[-1][1])
    label = f'{shown.linkage.input_coordinate.position} [{shown.input_unit}]'
    return _panels(shown, names, series, (*ends, label), is_dark)


def over_time(shown: Shown, names: Sequence[str],
              lines: Sequence[Sequence[tuple[str, np.ndarray, np.ndarray]]], end: float,
              is_dark: bool) -> dict[str, Any]:
    """
    Return the options of one panel for each quantity over time.

    ``lines``: for each quantity (title of a run, times [s], values) of every run.
    """
    series = [{'type': 'line', 'name': ' '.join(filter(None, (name, title))), 'showSymbol': False,
               'id': f'run{place}_{which}', 'xAxisIndex': place, 'yAxisIndex': place,
               'color': COLOURS[which % len(COLOURS)],
               'lineStyle': {'width': 2, 'type': 'dashed' if which else 'solid'},
               'data': [[float(x), float(y)] if isfinite(y) else [float(x), None]
                        for x, y in zip(times, values)]}
              for place, name in enumerate(names)
              for which, (title, times, values) in enumerate(lines[place])]
    return _panels(shown, names, series, (0.0, end, 'time [s]'), is_dark)


def _panels(shown: Shown, names: Sequence[str], series: list[dict[str, Any]],
            axis: tuple[float, float, str], is_dark: bool) -> dict[str, Any]:
    """Return the options of stacked panels over one axis (low, high, label)."""
    panels, (low, high, label) = range(len(names)), axis
    ink = {'color': _ink(is_dark)}
    return {
        'animation': False, 'backgroundColor': 'transparent',
        'darkMode': is_dark,
        'grid': [{'left': LEFT, 'right': RIGHT, 'height': CURVE_HEIGHT,
                  'top': TOP + i * (CURVE_HEIGHT + GAP)} for i in panels],
        'title': [{'text': f'{name} [{shown.quantities[name].unit}]', 'left': LEFT - 4,
                   'top': TOP + i * (CURVE_HEIGHT + GAP) - 24,
                   'textStyle': {'fontSize': 13, 'fontWeight': 'normal', **ink}}
                  for i, name in enumerate(names)],
        'xAxis': [{'type': 'value', 'gridIndex': i, 'min': low, 'max': high, 'axisLabel': ink,
                   'name': label if i == panels[-1] else '', 'nameLocation': 'middle',
                   'nameGap': 26, 'nameTextStyle': ink, 'splitLine': _grid(is_dark)}
                  for i in panels],
        'yAxis': [{'type': 'value', 'gridIndex': i, 'scale': True, 'splitNumber': 4,
                   'axisLabel': ink, 'splitLine': _grid(is_dark)} for i in panels],
        'tooltip': {'trigger': 'axis'},
        'axisPointer': {'link': [{'xAxisIndex': 'all'}]},
        'series': series + [cursor_series(i, None) for i in panels],
    }


def _ink(is_dark: bool) -> str:
    return '#e4e4e4' if is_dark else '#222222'


def _grid(is_dark: bool) -> dict[str, Any]:
    return {'lineStyle': {'color': '#3a3f45' if is_dark else '#dddddd'}}


def _curve(shown: Shown, name: str, place: int, extrema: Sequence[Extremum]) -> dict[str, Any]:
    """Return the series of one quantity; a gap separates the ranges of the input."""
    data: list[Any] = []
    for inputs, values in shown.curves(name):
        with np.errstate(invalid='ignore'):
            bound = LIMIT * float(np.nanmedian(np.abs(values))) or np.inf
        data += [[shown.shown_input(float(x)), float(y)]
                 for x, y in zip(inputs, values) if abs(y) <= bound] + [[None, None]]
    marks = [{'coord': [shown.shown_input(shown.place_of(extremum)), extremum.value],
              'value': significant(extremum.value), 'symbol': 'circle',
              'symbolSize': 9 if extremum.is_global else 5,
              'label': {'show': extremum.is_global, 'fontSize': 11,
                        'position': 'bottom' if extremum.kind == MAXIMUM else 'top'}}
             for extremum in extrema if extremum.quantity == name and extremum.kind != CONSTANT
             and isfinite(extremum.value)]
    return {'type': 'line', 'name': name, 'id': f'curve{place}', 'showSymbol': False,
            'xAxisIndex': place, 'yAxisIndex': place, 'data': data,
            'lineStyle': {'width': 2}, 'color': COLOURS[place % len(COLOURS)],
            'markPoint': {'data': marks, 'silent': False}}


def cursor_series(place: int, at: float | None) -> dict[str, Any]:
    """Return the series with the line at the present input, of panel number ``place``."""
    marks = [] if at is None else [{'xAxis': at}]
    return {'type': 'line', 'id': f'cursor{place}', 'xAxisIndex': place, 'yAxisIndex': place,
            'data': [], 'silent': True, 'tooltip': {'show': False},
            'markLine': {'symbol': 'none', 'animation': False, 'label': {'show': False},
                         'lineStyle': {'color': CURSOR, 'type': 'solid', 'width': 1.5},
                         'data': marks}}


def cursors(count: int, at: float) -> dict[str, Any]:
    """Return what moves the cursors of a chart of so many panels to an input."""
    return {'series': [cursor_series(i, at) for i in range(count)]}


def polar(shown: Shown, is_dark: bool) -> dict[str, Any]:
    """
    Return the options of the polar diagram: each force as a vector from the origin [N].

    The shaking force, and the reaction of the ground at each of its joints.
    """
    names = {'shaking_force': 'shaking force'} | ground_forces(shown.linkage)
    series, largest = [], 0.0
    for name, text in names.items():
        data: list[Any] = []
        for cycle in shown.cycles:
            x, y = (getattr(cycle.loads, f'{name}_{axis}') for axis in 'xy')
            size = np.hypot(x, y)
            bound = LIMIT * float(np.nanmedian(size)) or np.inf
            data += [[float(a), float(b)] for a, b, c in zip(x, y, size) if c <= bound]
            data.append([None, None])
            largest = max(largest, float(np.nanquantile(size[np.isfinite(size)], 0.99)))
        series.append({'type': 'line', 'name': text, 'showSymbol': False, 'data': data,
                       'lineStyle': {'width': 2}, 'color': COLOURS[len(series) % len(COLOURS)]})
    series.append({'type': 'scatter', 'id': 'now', 'name': 'now', 'data': [], 'symbolSize': 10,
                   'color': CURSOR})
    bound = float(f'{1.08 * largest:.2g}') or 1.0
    axis = {'type': 'value', 'min': -bound, 'max': bound, 'splitLine': _grid(is_dark),
            'axisLabel': {'color': _ink(is_dark), 'showMinLabel': False, 'showMaxLabel': False},
            'nameTextStyle': {'color': _ink(is_dark)}}
    return {'animation': False, 'backgroundColor': 'transparent',
            'darkMode': is_dark,
            'legend': {'top': 0, 'textStyle': {'color': _ink(is_dark)}},
            'grid': {'left': 70, 'right': 30, 'top': 40, 'bottom': 40},
            'xAxis': axis | {'name': 'x [N]', 'nameLocation': 'middle', 'nameGap': 24},
            'yAxis': axis | {'name': 'y [N]'}, 'tooltip': {}, 'series': series}


def polar_now(shown: Shown, loads: Any) -> dict[str, Any]:
    """Return what moves the dots of the polar diagram to the present loads."""
    names = ['shaking_force', *ground_forces(shown.linkage)]
    return {'series': [{'id': 'now', 'data': [[getattr(loads, f'{name}_x'),
                                               getattr(loads, f'{name}_y')] for name in names]}]}
