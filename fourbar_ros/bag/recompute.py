"""Compute every recorded output again from the recorded input and scene; compare."""
from __future__ import annotations

import json
from math import inf
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from .. import records as fields
from .. import scene as scenes
from ..core.status import evaluate
from . import BagError
from .reader import Bag, Note


class Difference(NamedTuple):
    """Largest difference of one field of one topic over all its messages."""

    topic: str
    field: str
    messages: int
    largest: float


class Recomputed(NamedTuple):
    """
    What became of a bag.

    ``unmatched`` outputs could not be compared: their input is not in the bag (dropped, or before its
    start); ``cut``: the bag ends without an end.
    """

    differences: list
    inputs: int
    unmatched: int
    cut: bool


def scene_of(path):
    """Return (Scene, topics) of a bag: what was run, and {output name: topic}; from its custom_data."""
    about = Bag(path).metadata().get('custom_data') or {}
    return _scene(path, about)


def _scene(path, about):
    if 'scene' not in about or 'topics' not in about:
        raise BagError(f'{path}: was not recorded by fourbar_ros: its metadata hold no scene')
    return scenes.from_values(json.loads(about['scene'])), json.loads(about['topics'])


def recompute(path):
    """Return the list of :class:`Difference` of a bag, by topic and field; see :func:`compare`."""
    return compare(path).differences


def compare(path, progress=None):
    """
    Return the :class:`Recomputed` of a bag.

    Each output is compared with what its input, the last one before it in the file, gives; both carry the
    same stamp. Differences are absolute; NaN against NaN is none, NaN against a number infinite.
    ``progress`` is called with the number of bytes read.
    """
    bag = Bag(path)
    about = bag.metadata().get('custom_data') or {}
    scene, topics = _scene(path, about)
    work = _Comparison(scene, topics)
    for block in bag.blocks(progress=progress):
        if isinstance(block, Note):
            about = {**about, **block.values}
            work.change(*_scene(path, about))
        else:
            work.block(block)
    differences = [Difference(work.topics[name], field, work.counts[name], value)
                   for (name, field), value in work.largest.items()]
    return Recomputed(differences, work.inputs, work.unmatched, bag.cut)


class _Comparison:
    """Goes through a bag block by block."""

    def __init__(self, scene, topics):
        self.counts, self.largest, self.inputs, self.unmatched, self.topics = {}, {}, 0, 0, {}
        self.change(scene, topics)

    def change(self, scene, topics):
        """Take another scene; it holds from the next input on."""
        self._scene = scene
        self.topics.update(topics)
        self._name_of = {topic: name for name, topic in self.topics.items()}
        self._last = None

    def block(self, columns):
        """Compare all messages of a block."""
        inputs = [self._input(c) for c in columns if self._name_of.get(c.topic) == 'input']
        inputs = [found for found in inputs if found is not None]
        if self._last is not None:
            inputs.insert(0, self._last)
        outputs = [c for c in columns if self._name_of.get(c.topic, 'input') != 'input']
        if not inputs:
            self.unmatched += sum(len(c.places) for c in outputs)
            return
        places, stamps, cranks = (np.concatenate(parts) for parts in zip(*inputs))
        order = np.argsort(places)
        places, stamps, cranks = places[order], stamps[order], cranks[order]
        self.inputs += len(places) - (self._last is not None)
        self._last = places[-1:], stamps[-1:], cranks[-1:]
        status, values = self._evaluate(cranks)
        for found in outputs:
            self._output(found, places, stamps, status, values)

    def _input(self, columns):
        """Return (places, stamps, cranks of shape (n, 3)), None if the crank is not in these messages."""
        crank = fields.crank_of(columns.tree, self._scene.drive)
        if crank is None:
            return None
        shape = columns.places.shape
        return columns.places, _stamps(columns), np.stack([np.broadcast_to(v, shape) for v in crank], axis=1)

    def _evaluate(self, cranks):
        """Return statuses and values; one by one, as the node does, so that not one bit differs."""
        linkage, with_loads = self._scene.linkage, self._scene.needs_loads
        found = [evaluate(linkage, *crank, with_loads) for crank in cranks.tolist()]
        return (np.array([status for status, _, _ in found], float),
                np.array([(*motion, *loads) for _, motion, loads in found]).T)

    def _output(self, columns, places, stamps, status, values):
        name, tree = self._name_of[columns.topic], columns.tree
        source = np.searchsorted(places, columns.places, side='right') - 1
        good = (source >= 0) & (stamps[source] == _stamps(columns))
        self.unmatched += np.count_nonzero(~good)
        if not good.any():
            return
        source = source[good]
        self.counts[name] = self.counts.get(name, 0) + len(source)
        pairs = [(field, self._expected(places_in, source, values), attrgetter(field)(tree))
                 for field, places_in in fields.FIELDS[name].items()]
        if name in ('state', 'loads'):
            pairs.append(('status', status[source], tree.status))
        for field, want, have in pairs:
            same = want.shape[:-1] == have.shape[:-1]        # as many joints
            found = _distance(want, have[..., good]) if same else inf
            key = (name, field)
            self.largest[key] = max(self.largest.get(key, 0.0), found)

    @staticmethod
    def _expected(source_field, rows, values):
        if isinstance(source_field, str):
            return values[fields.PLACE[source_field]][rows]
        return np.stack([np.full(len(rows), fields.PASSIVE_EFFORT) if part is None
                         else values[fields.PLACE[part]][rows] for part in source_field])


def _stamps(columns):
    records = columns.records
    return records['header.stamp.sec'].astype(np.int64) * 10**9 + records['header.stamp.nanosec']


def _distance(a, b):
    """Return the largest difference of two arrays."""
    with np.errstate(invalid='ignore'):
        distance = np.abs(a - b)
    unknown = np.isnan(distance)
    if unknown.any():           # inf - inf, or NaN on one side or both
        distance = np.where(unknown, np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, inf), distance)
    return float(distance.max())
