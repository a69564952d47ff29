# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fields of a bag over time or over a field, as a picture; requires matplotlib when used."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
import re
from typing import TYPE_CHECKING

from fourbar_ros.bag.exports.export import table
from fourbar_ros.bag.read.origin import topic_types
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Columns, Progress
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT, DPI = 9.0, 2.4, 100      # [in] a picture, and each of its axes; pixels an inch
STRETCHES = int(2 * WIDTH * DPI)        # of a curve, each drawn by its extrema: two a pixel
Curves = dict[str, tuple[Array, Array, str]]    # {name: (times or x, values, unit)}
_ELEMENT = re.compile(r'(.+)\[(.+)\]')


def series(path: str | Path, names: Iterable[str], progress: Progress | None = None,
           stretches: int | None = None) -> Curves:
    """
    Return {name: (times [s] since the start, values, unit)} for fields of a bag.

    Times are the stamps of the messages; log times for messages without one. ``names`` are
    ``TOPIC.FIELD``, the topic in full or its last part: ``state.theta4``,
    ``/joint_states.position[crank]`` or ``[0]``; only these fields are decoded. With ``stretches``
    each curve keeps about so many, by their smallest and largest value and any NaN, and memory
    does not grow with the bag. ``progress`` is called with the number of bytes read.
    """
    bag = Bag(path)
    known = sorted(topic_types(bag))
    topics = {name: _topic(name, known, bag) for name in names}
    curves = {name: _Curve(stretches) for name in names}
    log_start, stamp_start = _starts(bag)
    for columns in bag.columns(sorted(set(topics.values())), progress):
        times = None
        for name, curve in curves.items():
            field = name.partition('.')[2]
            values = _column(columns, field) if topics[name] == columns.topic else None
            if values is None:
                continue
            if times is None:
                times = _times(columns, log_start, stamp_start)
            curve.unit = next((leaf.unit for leaf in columns.layout.leaves
                               if leaf.name == field.split('[')[0]), '')
            curve.add(columns.places, times, values)
    for name, curve in curves.items():
        if not curve.parts:
            raise BagError(f'{name}: no such field; {_advice(name, _fields_of(bag))}')
    return {name: (*curve.joined()[1:], curve.unit) for name, curve in curves.items()}


class _Curve:
    """One field over time, thinned to some stretches (None: not at all) as it grows."""

    def __init__(self, stretches: int | None) -> None:
        self.unit = ''
        self.parts: list[tuple[Array, Array, Array]] = []  # places, times, values
        self._stretches, self._size = stretches, 0

    def add(self, places: Array, times: Array, values: Array) -> None:
        """Append points."""
        self.parts.append((places, times, values))
        self._size += len(places)
        if self._stretches and self._size > 8 * self._stretches:
            self.parts = [self.joined()]
            self._size = len(self.parts[0][0])

    def joined(self) -> tuple[Array, Array, Array]:
        """Return (places, times, values) in the order of the bag, thinned."""
        places, times, values = map(np.concatenate, zip(*self.parts))
        # messages of several layouts lie between each other
        keep = np.argsort(places, kind='stable')
        if self._stretches:
            keep = keep[thinned(places[keep], values[keep], self._stretches)]
        return places[keep], times[keep], values[keep]


def thinned(places: Array, values: Array, stretches: int) -> Array:
    """
    Return the indices of the points of a curve to keep, ascending.

    A curve over n pixels looks the same if each of 2 n equally long stretches keeps its smallest
    and largest value and a NaN, which interrupts the line. Stretches are equally long in
    ``places``, which ascend, so that a curve can be thinned again when it has grown.
    """
    count = len(values)
    if count <= 2 * stretches:
        return np.arange(count)
    stretch = ((places - places[0]) * (stretches / (places[-1] - places[0] + 1))).astype(np.int64)
    begins = np.flatnonzero(np.diff(stretch, prepend=-1))
    unknown = np.isnan(values)
    low = np.lexsort((np.where(unknown, np.inf, values), stretch))[begins]
    high = np.lexsort((-np.where(unknown, -np.inf, values), stretch))[begins]
    gaps = np.lexsort((~unknown, stretch))[begins]       # a gap in the curve stays one
    return np.asarray(np.unique(np.concatenate((low, high, gaps[unknown[gaps]],
                                                [0, count - 1]))))


def _starts(bag: Bag) -> tuple[int, int | None]:
    """
    Return the log time and the stamp [ns] that are time 0 of a bag; the stamp None without any.

    If the first message has stamp 0, log times show how much later the first stamped one came.
    """
    block: list[Columns] = next(bag.blocks(), [])
    log_start = min((columns.times.min() for columns in block), default=0)
    headed = [(columns.places, stamps, columns.times) for columns in block
              if (stamps := columns.stamps) is not None]
    if not any((stamps > 0).any() for _, stamps, _ in headed):
        return log_start, None
    places, stamps, log_times = map(np.concatenate, zip(*headed))
    first = np.flatnonzero(stamps > 0)[places[stamps > 0].argmin()]
    if (places[stamps == 0] < places[first]).any():
        return log_start, stamps[first] - (log_times[first] - log_start)
    return log_start, stamps[stamps > 0].min()


def _times(columns: Columns, log_start: int, stamp_start: int | None) -> Array:
    """Return the times of messages since the start [s]: by stamp, by log time where it is 0."""
    since_start, stamps = columns.times - log_start, columns.stamps
    if stamps is None or stamp_start is None:
        return since_start * 1e-9
    return np.where(stamps == 0, since_start, stamps - stamp_start) * 1e-9


def _topic(name: str, known: Sequence[str], bag: Bag) -> str:
    """Return the topic of TOPIC.FIELD, given in full or by its last part."""
    wanted = name.partition('.')[0]
    fitting = [topic for topic in known if wanted in (topic, topic.rsplit('/', 1)[-1])]
    if wanted in fitting:
        return wanted
    if len(fitting) > 1:
        raise BagError(f'{name}: which of {", ".join(fitting)}? write the topic in full')
    if not fitting:
        raise BagError(f'{name}: no such field; {_advice(name, _fields_of(bag))}')
    return fitting[0]


def _fields_of(bag: Bag) -> dict[str, list[str]]:
    """Return {last part of a topic: its fields} for topics in the first block of a bag."""
    return {columns.topic.rsplit('/', 1)[-1]: list(table(columns))
            for columns in next(bag.blocks(), [])}


def _column(columns: Columns, field: str) -> Array | None:
    """
    Return the numbers of a field, shape (n,); None if the messages do not have it.

    An element of an array is named by its index or, in a JointState, by its joint:
    ``position[0]``, ``position[crank]``.
    """
    if field == 'log_time':
        return columns.times
    if field in columns.fields:
        values = columns.records[field]
        return values if values.ndim == 1 and values.dtype.kind in 'iufb' else None
    match = _ELEMENT.fullmatch(field)
    if not match or match[1] not in columns.fields or columns.records[match[1]].ndim != 2:
        return None
    elements, joints = columns.records[match[1]].T, columns.layout.texts.get('name', [])
    if len(joints) == len(elements) and match[2] in joints:
        return np.asarray(elements[joints.index(match[2])])
    index = int(match[2]) if match[2].isdecimal() else len(elements)
    return elements[index] if index < len(elements) else None


def _advice(name: str, known: Mapping[str, Sequence[str]]) -> str:
    """
    Return a hint for TOPIC.FIELD, a name that a bag does not have: the closest name, or all.

    ``known``: {last part of a topic: its fields}.
    """
    topic, dot, field = name.partition('.')
    topic = topic.rsplit('/', 1)[-1]
    if topic in known:
        names = [f'{topic}.{other}' for other in known[topic]]
        close = get_close_matches(f'{topic}.{field}', names, 1) if dot else []
        guess = f'did you mean {close[0]}? ' if close else ''
        return f'{guess}{topic} has {", ".join(known[topic])}'
    hint = ''
    if dot:
        if close := get_close_matches(topic, known, 1):
            hint = f'did you mean {close[0]}.{field}? '
    else:                           # a field without its topic
        of = next((topic for topic, fields in known.items() if name in fields), None)
        hint = f'write TOPIC.FIELD, as {f"{of}.{name}" if of else "state.theta4"}; '
    return f'{hint}topics are {", ".join(known)}'


def over(path: str | Path, names: Sequence[str], x: str, progress: Progress | None = None
         ) -> tuple[Curves, str]:
    """
    Return {name: (x, values, unit)} and the unit of x, for fields over another field of the bag.

    A value belongs to the x (``TOPIC.FIELD``) of the same stamp; stamps without x are left out. An
    angle x of more than a turn is taken modulo 2 pi, and a NaN interrupts the curve where that
    jumps. Other arguments as for :func:`series`.
    """
    found = series(path, dict.fromkeys([x, *names]), progress)
    x_times, x_values, unit = found[x]
    order = np.argsort(x_times, kind='stable')
    x_times, x_values = x_times[order], x_values[order]
    curves = {}
    for name in names:
        times, values, own_unit = found[name]
        index = np.minimum(np.searchsorted(x_times, times), len(x_times) - 1)
        has_x = x_times[index] == times
        if not has_x.any():
            raise BagError(f'{name}: no message has the stamp of one with {x}')
        curves[name] = (*_turn_by_turn(x_values[index[has_x]], values[has_x], unit), own_unit)
    return curves, unit


def _turn_by_turn(x: Array, values: Array, unit: str) -> tuple[Array, Array]:
    """Return a curve over an angle x of more than a turn within 0 ... 2 pi, others as they are."""
    if unit != 'rad' or not np.nanmax(x) - np.nanmin(x) > 2.0 * np.pi:
        return x, values
    x = np.mod(x, 2.0 * np.pi)
    jumps = np.flatnonzero(abs(np.diff(x)) > np.pi) + 1
    return np.insert(x, jumps, np.nan), np.insert(values.astype(float), jumps, np.nan)


def make_figure(path: str | Path, names: Sequence[str], progress: Progress | None = None,
                x: str | None = None) -> Figure:
    """Return a figure of fields over time or over the field ``x``; one unit is one axis."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise BagError('plot requires matplotlib: pip install matplotlib') from None
    if x is None:
        found, label = series(path, names, progress, STRETCHES), 'time since the first message [s]'
    else:
        found, unit = over(path, names, x, progress)
        label = f'{x} [{unit}]' if unit else x
    units = list(dict.fromkeys(unit or name for name, (_, _, unit) in found.items()))
    figure = Figure(figsize=(WIDTH, HEIGHT * len(units) + 0.6), dpi=DPI, layout='constrained')
    axes = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
    for axis, unit in zip(axes, units):
        _draw(axis, {name: curve for name, curve in found.items() if (curve[2] or name) == unit})
    axes[-1].set_xlabel(label)
    figure.suptitle(str(path), fontsize='medium')
    return figure


def plot(path: str | Path, names: Sequence[str], out: str | Path, progress: Progress | None = None,
         x: str | None = None) -> None:
    """Draw fields into a file (.png, .svg, .pdf), as :func:`make_figure`."""
    figure = make_figure(path, names, progress, x)
    try:
        figure.savefig(out)
    except (OSError, ValueError) as error:
        raise BagError(f'{out}: {error}') from None


def _draw(axis: Axes, curves: Curves) -> None:
    """Draw curves, all of one unit, with a legend above the axis."""
    for name, (x, values, unit) in curves.items():
        axis.plot(x, values, label=name, linewidth=1.0)
        axis.set_ylabel(f'[{unit}]' if unit else '')
    axis.legend(loc='lower left', bbox_to_anchor=(0.0, 0.98), ncols=4, frameon=False,
                fontsize='small')
    axis.grid(True, alpha=0.3)
