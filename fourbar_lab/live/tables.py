# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows of the tables of a page; numbers have the digits of the command line."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from fourbar_lab.drawing.poses import number
from fourbar_lab.live.model import Shown, written
from fourbar_lab.live.svg import plain
from fourbar_ros.extrema.find import Extremum


def _column(name: str, label: str, align: str = 'left') -> dict[str, str]:
    """Return a column of a table as Quasar has it."""
    return {'name': name, 'label': label, 'field': name, 'align': align}


EXTREMA_COLUMNS = [_column('quantity', 'quantity'), _column('kind', 'kind'),
                   _column('value', 'value', 'right'), _column('unit', 'unit'),
                   _column('at', 'input', 'right'), _column('note', '')]
NOW_COLUMNS = [_column('name', 'now'), _column('value', 'value', 'right'),
               _column('unit', 'unit')]


def extrema_rows(shown: Shown, extrema: Sequence[Extremum]) -> list[dict[str, str | float]]:
    """Return the rows of the table of extrema; a click goes to ``input``, in the page's unit."""
    rows: list[dict[str, str | float]] = []
    for i, extremum in enumerate(extrema):
        at = shown.shown_input(shown.place_of(extremum))
        rows.append({'key': i, 'quantity': extremum.quantity, 'kind': extremum.kind,
                     'value': number(extremum.value), 'unit': written(extremum.unit),
                     'at': f'{at:.4f} {shown.input_unit}', 'input': at,
                     'note': ' '.join(filter(None, ('global' if extremum.is_global else '',
                                                    extremum.place
                                                    if extremum.place != 'interior' else '')))})
    return rows


def joint_rows(shown: Shown) -> list[tuple[str, str]]:
    """Return (letter, names of the joints there) where pictures have letters for words."""
    joints: dict[str, list[str]] = {}
    for name, letter in shown.labels.letters.items():
        joints.setdefault(f'joint {plain(letter)}', []).append(name)
    return [(letter, ', '.join(names)) for letter, names in joints.items()]


def now_columns(title: str, others: Sequence[str]) -> list[dict[str, str]]:
    """Return the columns of the present pose, and of the same moment of other runs."""
    first = _column('value', title.partition(' and ')[0], 'right') if others else NOW_COLUMNS[1]
    columns = [NOW_COLUMNS[0], first]
    columns += [_column(f'other{i}', title, 'right') for i, title in enumerate(others)]
    columns += [_column('difference', 'difference', 'right')] if len(others) == 1 else []
    return [*columns, NOW_COLUMNS[2]]


def now_rows(pose: Mapping[str, tuple[float, str]],
             others: Sequence[Mapping[str, tuple[float, str]]] = (),
             symbols: Mapping[str, str] = MappingProxyType({})) -> list[dict[str, str]]:
    """
    Return the rows of the table of a pose, {name: (value, unit)}, with those of other runs beside.

    ``symbols``: {name of a force: its letter in the picture}. A cell is '' where a run has no such
    value; with one other run, the last column is how much its value is larger.
    """
    rows = []
    for name, (value, unit) in pose.items():
        symbol = f' = {plain(symbols[name])}' if name in symbols else ''
        row = {'name': name + symbol, 'value': number(value), 'unit': unit}
        for i, other in enumerate(others):
            row[f'other{i}'] = number(other[name][0]) if name in other else ''
        if len(others) == 1 and name in others[0]:
            row['difference'] = number(others[0][name][0] - value)
        rows.append(row)
    return rows
