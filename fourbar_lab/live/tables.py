# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows of the tables of a page; numbers have the digits of the command line."""
from __future__ import annotations

from collections.abc import Sequence

from fourbar_lab.drawing.poses import DrawnPose, ten_digits
from fourbar_lab.drawing.record import counted
from fourbar_lab.drawing.tables import SIDES
from fourbar_lab.live.model import Shown, written
from fourbar_lab.live.svg import plain
from fourbar_ros.extrema.find import Extremum


def column(name: str, label: str = '', align: str = 'left') -> dict[str, str]:
    """Return a column of a table as Quasar has it."""
    return {'name': name, 'label': label, 'field': name, 'align': align}


EXTREMA_COLUMNS = [column('quantity', 'quantity'), column('kind', 'kind'),
                   column('value', 'value', 'right'), column('unit', 'unit'),
                   column('at', 'input', 'right'), column('note')]


def extrema_rows(shown: Shown, extrema: Sequence[Extremum]) -> list[dict[str, str | float]]:
    """Return the rows of the table of extrema; a click goes to ``input``, in the page's unit."""
    rows: list[dict[str, str | float]] = []
    for i, extremum in enumerate(extrema):
        shown_input = shown.shown_input(counted(shown.linkage, extremum.input))
        rows.append({'key': i, 'quantity': extremum.quantity, 'kind': extremum.kind,
                     'value': ten_digits(extremum.value), 'unit': written(extremum.unit),
                     'at': f'{shown_input:.4f} {shown.input_unit}', 'input': shown_input,
                     'note': ' '.join(filter(None, ('global' if extremum.is_global else '',
                                                    extremum.place
                                                    if extremum.place != 'interior' else '',
                                                    SIDES[extremum.side],
                                                    'not certain' if extremum.proof else '')))})
    return rows


def joint_rows(shown: Shown) -> list[tuple[str, str]]:
    """Return (letter, names of the joints there) where pictures have letters for words."""
    joints: dict[str, list[str]] = {}
    for name, letter in shown.labels.letters.items():
        joints.setdefault(f'joint {plain(letter)}', []).append(name)
    return [(letter, ', '.join(names)) for letter, names in joints.items()]


def now_rows(shown: Shown, pose: DrawnPose) -> list[tuple[str, str, str]]:
    """Return (name, value, unit) of all values of a pose; forces with their letters."""
    symbols = shown.labels.forces if shown.labels.words else {}
    return [(f'{name} = {plain(symbols[name])}' if name in symbols else name, ten_digits(value),
             unit)
            for name, (value, unit) in shown.values(pose).items()]


def now_html(shown: Shown, pose: DrawnPose) -> str:
    """Return the table of :func:`now_rows` as HTML."""
    rows = ''.join(f'<tr><td>{name}</td><td class="text-right">{value}</td><td>{unit}</td></tr>'
                   for name, value, unit in now_rows(shown, pose))
    return ('<div class="q-table__container q-table--dense q-table--flat">'
            '<table class="q-table fb-table"><thead><tr><th class="text-left">now</th>'
            '<th class="text-right">value</th><th class="text-left">unit</th></tr></thead>'
            f'<tbody>{rows}</tbody></table></div>')
