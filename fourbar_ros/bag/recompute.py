"""Compute every recorded output again from the recorded input and scene; compare."""
from __future__ import annotations

import json
from math import inf, isnan
from typing import NamedTuple

from .. import records as fields
from .. import scene as scenes
from ..core.status import evaluate
from .reader import metadata, records
from .writer import BagError


class Difference(NamedTuple):
    """Largest difference of one field of one topic over all its messages."""

    topic: str
    field: str
    messages: int
    largest: float


def scene_of(path):
    """Return (Scene, topics) of a bag: what was run, and {output name: topic}; from its custom_data."""
    about = metadata(path).get('custom_data') or {}
    if 'scene' not in about or 'topics' not in about:
        raise BagError(f'{path}: was not recorded by fourbar_ros: its metadata hold no scene')
    return scenes.from_values(json.loads(about['scene'])), json.loads(about['topics'])


def recompute(path):
    """
    Return the list of :class:`Difference` of a bag, by topic and field.

    Each output is compared with what its input, the message before it in the file, gives. Differences
    are absolute; NaN against NaN is none, NaN against a number infinite.
    """
    scene, topics = scene_of(path)
    name_of = {topic: name for name, topic in topics.items()}
    counts, largest = {}, {}
    status = values = None
    for record in records(path, list(name_of)):
        name = name_of[record.topic]
        if name == 'input':
            crank = fields.crank_of(record.message, scene.drive)
            if crank is None:
                continue
            status, motion, loads = evaluate(scene.linkage, *crank, scene.needs_loads)
            values = (*motion, *loads)
            continue
        if values is None:
            continue                                   # an output whose input came before the bag
        counts[name] = counts.get(name, 0) + 1
        want, have = fields.expected(name, values), fields.found(name, record.message)
        if name in ('state', 'loads'):
            want, have = {**want, 'status': status}, {**have, 'status': record.message.status}
        for field in want:
            key = (name, field)
            largest[key] = max(largest.get(key, 0.0), _distance(want[field], have[field]))
    return [Difference(topics[name], field, counts[name], value)
            for (name, field), value in largest.items()]


def _distance(a, b):
    if isinstance(a, tuple):
        return inf if len(a) != len(b) else max(map(_distance, a, b))
    if isnan(a) or isnan(b):
        return 0.0 if isnan(a) and isnan(b) else inf
    return 0.0 if a == b else abs(a - b)
