"""
Compute every recorded output again from the recorded motion of the driven joint and the scene; compare.

Both are in the bag: the motion as messages, the scene as its first message and again after every change.
"""
from __future__ import annotations

import json
from math import inf
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from .. import scene as scenes
from ..records import driven_of
from ..stepper import Stepper
from . import BagError
from .reader import Bag, Record


class Difference(NamedTuple):
    """Largest difference of one field of one topic over all its messages."""

    topic: str
    field: str
    messages: int
    largest: float


class Recomputed(NamedTuple):
    """
    What became of a bag.

    ``unmatched`` outputs belong to no motion of the driven joint in the bag: it was dropped, or the input had
    stopped and the output says so; ``cut``: the bag ends without an end.
    """

    differences: list
    inputs: int
    unmatched: int
    cut: bool


def scene_of(path):
    """Return (Scene, topics) of a bag: what was run at its start, and {output name: topic}."""
    about = Bag(path).metadata().get('custom_data') or {}
    if 'scene' not in about or 'driven' not in (topics := json.loads(about.get('topics', '{}'))):
        raise BagError(f'{path}: was not recorded by fourbar_ros: its metadata hold no scene')
    return scenes.from_values(json.loads(about['scene'])), topics


def recompute(path):
    """Return the list of :class:`Difference` of a bag, by topic and field; see :func:`compare`."""
    return compare(path).differences


def compare(path, progress=None):
    """
    Return the :class:`Recomputed` of a bag.

    Each output is compared with what the driven joint's motion gives, the last one before it in the file; both
    carry the same stamp. Differences are absolute; NaN against NaN is none, NaN against a number infinite.
    ``progress`` is called with the number of bytes read.
    """
    bag = Bag(path)
    scene, topics = scene_of(path)
    work = _Comparison(scene, topics)
    for block in bag.blocks(apart=topics.get('scene'), progress=progress):
        if isinstance(block, Record):
            work.change(scenes.from_values(json.loads(block.message.data)))
        else:
            work.block(block)
    differences = [Difference(work.topics[name], field, work.counts[name], value)
                   for (name, field), value in work.largest.items()]
    return Recomputed(differences, work.inputs, work.unmatched, bag.cut)


class _Comparison:
    """Goes through a bag block by block."""

    def __init__(self, scene, topics):
        self.counts, self.largest, self.inputs, self.unmatched = {}, {}, 0, 0
        self.topics, self._name_of = topics, {topic: name for name, topic in topics.items()}
        self.change(scene)

    def change(self, scene):
        """Take another scene; it holds from the next input on."""
        self._stepper, self._layout = Stepper(scene), scene.layout
        self._wanted = scene.needs_loads, 'points' in scene.outputs
        self._constant = {'mode': scene.linkage.mode, 'change_point_margin': scene.linkage.change_point_margin}
        self._outputs = scene.topics.keys()
        self._last = None

    def block(self, columns):
        """Compare all messages of a block."""
        inputs = [self._input(c) for c in columns if self._name_of.get(c.topic) == 'driven']
        outputs = [c for c in columns if self._name_of.get(c.topic) in self._outputs]
        if not inputs and self._last is None:
            self.unmatched += sum(len(c.places) for c in outputs)
            return
        results = [self._last] if self._last is not None else []
        if inputs:
            results.append(self._evaluated(*(np.concatenate(parts) for parts in zip(*inputs))))
        everything = [np.concatenate(parts, axis=-1) for parts in zip(*results)]
        self._last = [part[..., -1:] for part in everything]
        for found in outputs:
            self._output(found, *everything)

    @staticmethod
    def _input(columns):
        return columns.places, columns.stamps, np.stack(driven_of(columns.tree), axis=1)

    def _evaluated(self, places, stamps, motions):
        """Return places, stamps, statuses and values; one by one, as the node does: not one bit differs."""
        order = np.argsort(places)
        self.inputs += len(order)
        found = [self._stepper.step(*motion, *self._wanted) for motion in motions[order].tolist()]
        return (places[order], stamps[order], np.array([status for status, _ in found], float),
                np.array([values for _, values in found]).T)

    def _output(self, columns, places, stamps, status, values):
        name, tree = self._name_of[columns.topic], columns.tree
        source = np.searchsorted(places, columns.places, side='right') - 1
        good = (source >= 0) & (stamps[source] == columns.stamps)
        self.unmatched += np.count_nonzero(~good)
        if not good.any():
            return
        source = source[good]
        self.counts[name] = self.counts.get(name, 0) + len(source)
        there = columns.records.dtype.names                  # a bag of an older version may have less
        expected = self._layout.expected(name, values[:, source]) | {'status': status[source]} | self._constant
        for field in (field for field in expected if field in there):
            want, have = _rows(expected[field], len(source)), attrgetter(field)(tree)
            same = want.shape[:-1] == have.shape[:-1]        # as many joints
            found = distance(want, have[..., good]) if same else inf
            key = (name, field)
            self.largest[key] = max(self.largest.get(key, 0.0), found)


def _rows(value, count):
    """Return a value of ``count`` messages, or a tuple of them, as an array (..., count)."""
    parts = [np.broadcast_to(part, count) for part in (value if isinstance(value, tuple) else (value,))]
    return np.stack(parts) if isinstance(value, tuple) else parts[0]


def distance(a, b):
    """Return the largest difference of two arrays; NaN against NaN is none, against a number infinite."""
    with np.errstate(invalid='ignore'):
        distance = np.abs(a - b)
    unknown = np.isnan(distance)
    if unknown.any():           # inf - inf, or NaN on one side or both
        distance = np.where(unknown, np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, inf), distance)
    return float(distance.max())
