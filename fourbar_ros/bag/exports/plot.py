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
# stretches of a curve that are drawn by their extrema: two a pixel
POINTS = int(2 * WIDTH * DPI)
Curves = dict[str, tuple[Array, Array, str]]    # {name: (times or x, values, unit)}
_ELEMENT = re.compile(r'(.+)\[(.+)\]')


def series(path: str | Path, names: Iterable[str], progress: Progress | None = None,
           stretches: int | None = None) -> Curves:
    """
    Return {name: (times [s] since the start, values, unit)} for fields of a bag.

    Times are the stamps of the messages, or their log times where they have none. Only the fields
    named are decoded.

    Parameters
    ----------
    path : str or Path
        Bag.
    names : list of str
        ``TOPIC.FIELD``; the topic in full or its last part: ``state.theta4``,
        ``/joint_states.position[crank]`` or ``[0]``.
    progress : callable, optional
        Called with the number of bytes read.
    stretches : int, optional
        Thin each curve to about so many stretches, of which the smallest and the largest value and
        any NaN stay.
        Memory does not grow with the bag then.

    """
    bag = Bag(path)
    known = sorted(topic_types(bag))
    topics = {name: _topic(name, known, bag) for name in names}
    curves = {name: _Curve(stretches) for name in names}
    start = _starts(bag)
    for columns in bag.columns(sorted(set(topics.values())), progress):
        seconds = None
        for name, curve in curves.items():
            if topics[name] != columns.topic:
                continue
            field = name.partition('.')[2]
            drawn = _column(columns, field)
            if drawn is not None:
                seconds = _seconds(columns, *start) if seconds is None else seconds
                curve.unit = next((leaf.unit for leaf in columns.layout.leaves
                                   if leaf.name == field.split('[')[0]), '')
                curve.add(columns.places, seconds, drawn)
    for name, curve in curves.items():
        if not curve.parts:
            raise BagError(f'{name}: no such field; {_advice(name, _fields_of(bag))}')
    found = {}
    for name, curve in curves.items():
        _, times, values = curve.joined()
        found[name] = times, values, curve.unit
    return found


class _Curve:
    """One field over time, thinned as it grows if it is to be."""

    def __init__(self, stretches: int | None) -> None:
        self.unit = ''
        self.parts: list[Sequence[Array]] = []           # of (places, times, values)
        self._stretches, self._size = stretches, 0

    def add(self, *part: Array) -> None:
        self.parts.append(part)
        self._size += len(part[0])
        if self._stretches and self._size > 8 * self._stretches:
            self.parts = [self._thin()]
            self._size = len(self.parts[0][0])

    def _thin(self) -> Sequence[Array]:
        places, times, values = self._sorted()
        keep = thinned(places, values, self._stretches or len(values))
        return places[keep], times[keep], values[keep]

    def _sorted(self) -> Sequence[Array]:
        """Return all parts as one in order: messages of several layouts lie between each other."""
        joined = [np.concatenate(column) for column in zip(*self.parts)]
        order = np.argsort(joined[0], kind='stable')
        return [column[order] for column in joined]

    def joined(self) -> Sequence[Array]:
        """Return (places, times, values)."""
        return self._thin() if self._stretches else self._sorted()


def thinned(places: Array, values: Array, stretches: int) -> Array:
    """
    Return which points of a curve to keep.

    The smallest and the largest value of each stretch, NaN, both ends.

    Stretches are equally long in ``places``, which ascend, so that a curve can be thinned again
    when it has grown.
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
    found: Array = np.unique(np.concatenate((low, high, gaps[unknown[gaps]], [0, count - 1])))
    return found


def _starts(bag: Bag) -> tuple[int, int | None]:
    """Return the first log time and the first stamp of a bag [ns], None without one."""
    found: list[Columns] = next(bag.blocks(), [])
    begin = min((columns.times.min() for columns in found), default=0)
    headed = [(columns.places, stamps, columns.times) for columns in found
              if (stamps := columns.stamps) is not None]
    if not any((stamps > 0).any() for _, stamps, _ in headed):
        return begin, None
    places, stamps, logged = (np.concatenate(parts) for parts in zip(*headed))
    first = np.flatnonzero(stamps > 0)[places[stamps > 0].argmin()]
    # the first are unstamped: log times show how much later this is
    if (places[stamps == 0] < places[first]).any():
        return begin, stamps[first] - (logged[first] - begin)
    return begin, stamps[stamps > 0].min()


def _seconds(columns: Columns, log_start: int, stamp_start: int | None) -> Array:
    """
    Return the times of messages since the start [s].

    By stamp, by log time where nobody stamped them.
    """
    logged, stamps = columns.times - log_start, columns.stamps
    if stamps is None or stamp_start is None:
        return logged * 1e-9
    return np.where(stamps == 0, logged, stamps - stamp_start) * 1e-9


def _topic(name: str, known: Sequence[str], bag: Bag) -> str:
    """Return the topic of TOPIC.FIELD, given in full or by its last part."""
    wanted = name.partition('.')[0]
    found = [topic for topic in known if wanted in (topic, topic.rsplit('/', 1)[-1])]
    if wanted in found:
        return wanted
    if len(found) > 1:
        raise BagError(f'{name}: which of {", ".join(found)}? write the topic in full')
    if not found:
        raise BagError(f'{name}: no such field; {_advice(name, _fields_of(bag))}')
    return found[0]


def _fields_of(bag: Bag) -> dict[str, list[str]]:
    """Return {last part of the topic: its fields} of the beginning of a bag."""
    return {columns.topic.rsplit('/', 1)[-1]: list(table(columns))
            for columns in next(bag.blocks(), [])}


def _column(columns: Columns, field: str) -> Array | None:
    """
    Return the numbers of a field, an element by its joint or its index.

    None if there are none.
    """
    records = columns.records
    if field == 'log_time':
        return columns.times
    element = _ELEMENT.fullmatch(field)
    if field in columns.fields:
        return (records[field] if records[field].ndim == 1 and records[field].dtype.kind in 'iufb'
                else None)
    if not element or element[1] not in columns.fields or records[element[1]].ndim != 2:
        return None
    elements, joints = records[element[1]].T, columns.layout.texts.get('name', [])
    if len(joints) == len(elements) and element[2] in joints:
        found: Array | None = elements[joints.index(element[2])]
        return found
    index = int(element[2]) if element[2].isdecimal() else len(elements)
    return elements[index] if index < len(elements) else None


def _advice(name: str, known: Mapping[str, Sequence[str]]) -> str:
    """Return what there is instead of a field that is not there."""
    topic, dot, field = name.partition('.')
    topic = topic.rsplit('/', 1)[-1]
    names = known if topic not in known else [f'{topic}.{field}' for field in known[topic]]
    close = (get_close_matches(topic if topic not in known else f'{topic}.{field}', names, 1)
             if dot else [])
    guess = f'did you mean {close[0]}{"" if topic in known else "." + field}? ' if close else ''
    if topic in known:
        return f'{guess}{topic} has {", ".join(known[topic])}'
    of = next((topic for topic, fields in known.items() if name in fields), None)
    hint = '' if dot else f'write TOPIC.FIELD, as {f"{of}.{name}" if of else "state.theta4"}; '
    return f'{guess}{hint}topics are {", ".join(known)}'


def over(path: str | Path, names: Sequence[str], x: str, progress: Progress | None = None
         ) -> tuple[Curves, str]:
    """
    Return {name: (x, values, unit)} and the unit of x, for fields over another field of the bag.

    A value belongs to the x of the same stamp; stamps without x are left out. An angle x of more
    than a turn is taken modulo 2 pi, and a NaN interrupts the curve where that jumps.

    Parameters
    ----------
    path, names, progress
        As for :func:`series`.
    x : str
        ``TOPIC.FIELD``.

    """
    found = series(path, dict.fromkeys([x, *names]), progress)
    at, places, unit = found[x]
    order = np.argsort(at, kind='stable')
    at, places = at[order], places[order]
    curves = {}
    for name in names:
        times, values, own = found[name]
        index = np.minimum(np.searchsorted(at, times), len(at) - 1)
        known = at[index] == times
        if not known.any():
            raise BagError(f'{name}: no message has the stamp of one with {x}')
        curves[name] = (*_turns(places[index[known]], values[known], unit), own)
    return curves, unit


def _turns(x: Array, values: Array, unit: str) -> tuple[Array, Array]:
    """Return a curve over an angle x of more than a turn, turn by turn; others as they are."""
    if unit != 'rad' or not np.nanmax(x) - np.nanmin(x) > 2.0 * np.pi:
        return x, values
    x = np.mod(x, 2.0 * np.pi)
    jumps = np.flatnonzero(abs(np.diff(x)) > np.pi) + 1
    return np.insert(x, jumps, np.nan), np.insert(values.astype(float), jumps, np.nan)


def make_figure(path: str | Path, names: Sequence[str], progress: Progress | None = None,
                x: str | None = None) -> Figure:
    """
    Return a figure of fields; those of one unit share an axis.

    They are drawn over time or, if ``x`` is given, over that field.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise BagError('plot requires matplotlib: pip install matplotlib') from None
    if x is None:
        found, label = series(path, names, progress, POINTS), 'time since the first message [s]'
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
    """Draw curves of one unit."""
    for name, (x, values, unit) in curves.items():
        axis.plot(x, values, label=name, linewidth=1.0)
        axis.set_ylabel(f'[{unit}]' if unit else '')
    axis.legend(loc='lower left', bbox_to_anchor=(0.0, 0.98), ncols=4, frameon=False,
                fontsize='small')
    axis.grid(True, alpha=0.3)
