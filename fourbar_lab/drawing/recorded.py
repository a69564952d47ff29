# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fields of a bag over time or over a field, as a picture; requires matplotlib when used."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fourbar_lab.drawing.figure import make_panels, Paper, paper_of, save
from fourbar_lab.drawing.labels import without_math
from fourbar_ros.bag.reader import Bag, Progress
from fourbar_ros.bag.tables import table_of, unit_of, units_in
from fourbar_ros.errors import BagError, nearest
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from fourbar_lab.drawing.paper import PaperFigure as Figure


def make_figure(path: str | Path, names: Sequence[str], progress: Progress | None = None,
                x: str | None = None, paper: Paper = Paper()) -> Figure:
    """
    Return a figure of fields over time [s] or over the field ``x``; one unit is one axis.

    ``names`` are ``TOPIC.FIELD``, the topic in full or its last part: ``state.theta4``,
    ``/joint_states.position[crank]``. A value belongs to the x of the same stamp; an angle x of
    more than a turn is taken modulo 2 pi. ``progress`` is called with the number of bytes read.
    """
    bag = Bag(path, progress)
    topics = {name: _topic(name.partition('.')[0], bag) for name in (*names, *([x] if x else []))}
    pieces: dict[str, list[tuple[Array, Array, Array]]] = {name: [] for name in topics}
    fields: set[str] = set()
    for columns in bag.columns(sorted(set(topics.values()))):
        table, stamps = table_of(columns), columns.stamps
        short = columns.topic.rsplit('/', 1)[-1]
        fields |= {f'{short}.{field}' for field, values in table.items()
                   if values.dtype.kind in 'iufb'}
        for name in (name for name in topics if topics[name] == columns.topic):
            values = table.get(name.partition('.')[2])
            if values is not None and values.dtype.kind in 'iufb':
                # those that nobody stamped are where they were recorded
                pieces[name].append((columns.indices, columns.times if stamps is None else
                                     np.where(stamps == 0, columns.times, stamps), values))
    bag.refuse_damage()
    curves: dict[str, RecordedCurve] = {}
    for name, of_name in pieces.items():
        if not of_name:
            raise BagError(f'{name}: no such field{nearest(name, sorted(fields))}')
        indices, stamps, values = map(np.concatenate, zip(*of_name))
        order = np.lexsort((indices, stamps))
        curves[name] = (stamps[order], values[order],
                        unit_of(name, units_in(bag, topics[name])))
    start = min(stamps[0] for stamps, _, _ in curves.values())
    label = 'time since the first message [s]' if x is None else f'{x} [{curves[x][2]}]'
    panels: dict[str, list[tuple[str, Array, Array]]] = {}
    for name in names:
        stamps, values, unit = curves[name]
        line = (((stamps - start) * 1e-9, values) if x is None
                else _over(curves[x], stamps, values))
        panels.setdefault(f'[{unit}]' if unit else '', []).append(
            (without_math(name), *line))
    return make_panels(panels, without_math(label), str(path), paper)


def plot(path: str | Path, names: Sequence[str], out: str | Path, progress: Progress | None = None,
         x: str | None = None, width: float | None = None, title: str | None = None) -> None:
    """Draw fields into a file (.png, .svg, .pdf), as :func:`make_figure`; ``width`` in [m]."""
    save(make_figure(path, names, progress, x, paper_of(width, title)), out)


RecordedCurve = tuple[Array, Array, str]        # stamps [ns], values, unit


def _topic(name: str, bag: Bag) -> str:
    fitting = [topic for topic in bag.types if name in (topic, topic.rsplit('/', 1)[-1])]
    if len(fitting) > 1 and name not in fitting:
        raise BagError(f'{name}: which of {", ".join(fitting)}? write the topic in full')
    if not fitting:
        known = sorted(topic.rsplit('/', 1)[-1] for topic in bag.types)
        raise BagError(f'{name}: no such topic{nearest(name, known)}')
    return name if name in fitting else fitting[0]


def _over(x: RecordedCurve, stamps: Array, values: Array) -> tuple[Array, Array]:
    """Return (x, values) of equal stamps; a NaN interrupts the curve where an angle jumps."""
    common, rows, value_rows = np.intersect1d(x[0], stamps, return_indices=True)
    if not len(common):
        raise BagError('no message has the stamp of one with x')
    x_values, values = x[1][rows], values[value_rows].astype(float)
    if x[2] != 'rad' or not np.nanmax(x_values) - np.nanmin(x_values) > 2.0 * np.pi:
        return x_values, values
    x_values = np.mod(x_values, 2.0 * np.pi)
    jumps = np.flatnonzero(abs(np.diff(x_values)) > np.pi) + 1
    return np.insert(x_values, jumps, np.nan), np.insert(values, jumps, np.nan)
