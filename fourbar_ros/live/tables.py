# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows of the tables of a page; numbers have the digits of the command line."""
from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live.model import Shown
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.report.poses import number


def _column(name: str, label: str, align: str = 'left') -> dict[str, str]:
    return {'name': name, 'label': label, 'field': name, 'align': align}


EXTREMA_COLUMNS = [_column('quantity', 'quantity'), _column('kind', 'kind'),
                   _column('value', 'value', 'right'), _column('unit', 'unit'),
                   _column('at', 'input', 'right'), _column('note', '')]
NOW_COLUMNS = [_column('name', 'now'), _column('value', 'value', 'right'),
               _column('unit', 'unit')]


def extrema_rows(shown: Shown, extrema: Sequence[Extremum]) -> list[dict[str, Any]]:
    """Return the rows of the extrema; ``input`` is where a click goes, in the page's unit."""
    rows = []
    for i, extremum in enumerate(extrema):
        at = shown.shown_input(shown.place_of(extremum))
        rows.append({'key': i, 'quantity': extremum.quantity, 'kind': extremum.kind,
                     'value': number(extremum.value), 'unit': extremum.unit,
                     'at': f'{at:.4f} {shown.input_unit}', 'input': at,
                     'note': ' '.join(filter(None, ('global' if extremum.is_global else '',
                                                    extremum.place
                                                    if extremum.place != 'interior' else '')))})
    return rows


def now_rows(shown: Shown, motion: Any, loads: Any) -> list[dict[str, str]]:
    """Return the rows of the present pose: every joint, the transmission angle, every load."""
    rows = []
    for coordinate in shown.linkage.PARTS:
        angle = coordinate.unit == 'rad'
        for name, factor, unit in zip(coordinate, (degrees(1.0) if angle else 1.0, 1.0, 1.0),
                                      (('deg', 'rad/s', 'rad/s²') if angle
                                       else ('m', 'm/s', 'm/s²'))):
            rows.append({'name': name, 'value': number(factor * getattr(motion, name)),
                         'unit': unit})
    rows.append({'name': 'transmission_angle', 'unit': 'deg',
                 'value': number(degrees(motion.transmission_angle))})
    if loads is not None:
        rows += [{'name': quantity.name, 'unit': quantity.unit,
                  'value': number(quantity.of(motion, loads))}
                 for quantity in select((), shown.linkage) if quantity.is_load]
    return rows
