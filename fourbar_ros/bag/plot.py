"""Fields of a bag over time, as a picture. Needs matplotlib, imported when it is used."""
from __future__ import annotations

import re

import numpy as np

from . import BagError
from .export import table
from .reader import Bag

WIDTH, HEIGHT = 9.0, 2.4        # [in] a picture, and each of its axes
_ELEMENT = re.compile(r'(.+)\[(\d+)\]')


def series(path, names, progress=None):
    """
    Return {name: (times [s] since the start, values, unit)} for fields of a bag.

    Times are the stamps of the messages, or their log times where they have no header.

    Parameters
    ----------
    path : str or Path
        Bag.
    names : list of str
        ``TOPIC.FIELD``; the topic in full or its last part: ``state.theta4``,
        ``/joint_states.position[crank]`` or ``[0]``.

    """
    bag = Bag(path)
    found = {name: ([], [], [], '') for name in names}
    known, starts = {}, {}
    for columns in bag.columns(progress=progress):
        values, stamps = table(columns), columns.stamps
        clock = 'log' if stamps is None else 'header'
        moments = columns.times if stamps is None else stamps
        starts[clock] = min(starts.get(clock, moments[0]), moments.min())
        units = {leaf.name: leaf.unit for leaf in columns.layout.leaves}
        short = columns.topic.rsplit('/', 1)[-1]
        known[short] = list(values)
        for name in names:
            topic, _, field = name.partition('.')
            drawn = _column(values, columns.records, field) if topic in (columns.topic, short) else None
            if drawn is not None:
                times, numbers, places, _ = found[name]
                times.append((clock, moments))
                numbers.append(drawn)
                places.append(columns.places)
                found[name] = times, numbers, places, units.get(field.split('[')[0], '')
    for name, (times, *_) in found.items():
        if not times:
            raise BagError(f'{name}: no such field; {_advice(name, known)}')
    made = {}
    for name, (times, numbers, places, unit) in found.items():
        order = np.argsort(np.concatenate(places))          # messages of several layouts lie between each other
        seconds = np.concatenate([(part - starts[clock]) * 1e-9 for clock, part in times])
        made[name] = seconds[order], np.concatenate(numbers)[order], unit
    return made


def _column(values, records, field):
    """Return the numbers of a field, an element by its joint or its index; None if there are none."""
    element = _ELEMENT.fullmatch(field)
    if field not in values and element and element[1] in records.dtype.names and records[element[1]].ndim == 2:
        elements, index = records[element[1]].T, int(element[2])
        return elements[index] if index < len(elements) else None
    return values[field] if field in values and values[field].dtype.kind in 'iufb' else None


def _advice(name, known):
    """Return what there is instead of a field that is not there."""
    topic, dot, _ = name.partition('.')
    topic = topic.rsplit('/', 1)[-1]
    if topic in known:
        return f'{topic} has {", ".join(known[topic])}'
    of = next((topic for topic, fields in known.items() if name in fields), None)
    hint = '' if dot else f'write TOPIC.FIELD, as {f"{of}.{name}" if of else "state.theta4"}; '
    return f'{hint}topics are {", ".join(known)}'


def plot(path, names, out, progress=None):
    """Draw fields over time into a file (.png, .svg, .pdf); those of one unit share an axis."""
    found = series(path, names, progress)
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise BagError('plot needs matplotlib: pip install matplotlib') from None
    units = list(dict.fromkeys(unit or name for name, (_, _, unit) in found.items()))
    figure = Figure(figsize=(WIDTH, HEIGHT * len(units) + 0.6), layout='constrained')
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
    for axis, unit in zip(axes, units):
        for name, (times, values, own) in found.items():
            if (own or name) == unit:
                axis.plot(times, values, label=name, linewidth=1.0)
                axis.set_ylabel(f'[{own}]' if own else '')
        axis.legend(loc='lower left', bbox_to_anchor=(0.0, 0.98), ncols=4, frameon=False, fontsize='small')
        axis.grid(True, alpha=0.3)
    axes[-1].set_xlabel('time since the first message [s]')
    figure.suptitle(str(path), fontsize='medium')
    try:
        figure.savefig(out)
    except (OSError, ValueError) as error:
        raise BagError(f'{out}: {error}') from None
