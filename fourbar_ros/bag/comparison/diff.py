# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Compare two bags message by message: the same stamp on the same topic is the same message."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
import json
from math import inf
from pathlib import Path
from typing import NamedTuple

from fourbar_ros.bag.comparison.difference import Difference, distance, distance_of_two
from fourbar_ros.bag.read.origin import topic_types
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Progress
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np


class TopicDiff(NamedTuple):
    """
    One topic in both bags.

    ``messages`` are in both; ``largest`` is {field: largest difference}, infinite for texts and
    for fields that only one of two messages has. If scenes differ, their parameters stand in place
    of the field.
    """

    topic: str
    messages: int
    only_first: int
    only_second: int
    largest: dict[str, float]

    @property
    def differences(self) -> list[Difference]:
        """Return the differences of all fields."""
        return [Difference(self.topic, field, self.messages, value)
                for field, value in self.largest.items()]

    def is_same(self, tolerance: float = 0.0) -> bool:
        """Return whether all messages are in both bags and no field differs by more."""
        return (not self.only_first and not self.only_second
                and max(self.largest.values(), default=0.0) <= tolerance)


def diff(first: str | Path, second: str | Path, topics: Sequence[str] | None = None,
         progress: Progress | None = None) -> list[TopicDiff]:
    """
    Return a :class:`TopicDiff` for every topic in either bag, or only for ``topics``.

    Messages are matched by the stamp of their header. Messages without a stamp, or with stamp 0,
    are matched by their place in the topic. Memory does not grow with the bags, as long as their
    stamps go forward. ``progress`` is called with the bytes read of the first bag, once more for
    every topic.
    """
    bags = Bag(first), Bag(second)
    names = sorted({topic for bag in bags for topic in topic_types(bag)})
    for topic in topics or ():
        if topic not in names:
            raise BagError(f'{topic}: in neither bag; they have {", ".join(names)}')
    return [_TopicComparison(topic).run(*bags, progress) for topic in topics or names]


class _KeyedRecords(NamedTuple):
    """Messages of one layout, and their keys in the other bag: shape (n,) each."""

    keys: Array
    records: Array

    def without(self, rows: Array) -> _KeyedRecords:
        """Return the messages but for some rows."""
        return _KeyedRecords(np.delete(self.keys, rows), np.delete(self.records, rows))


class _TopicComparison:
    """Reads one topic of two bags side by side and compares the messages of equal keys."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.messages, self.only = 0, [0, 0]
        self.largest: dict[str, float] = {}
        # messages of each bag that were not found in the other one yet
        self._pending: tuple[list[_KeyedRecords], list[_KeyedRecords]] = ([], [])

    def run(self, first: Bag, second: Bag, progress: Progress | None) -> TopicDiff:
        """Read both bags, always from the one with the smaller key, so that few messages wait."""
        blocks = [_keyed_blocks(first, self.topic, progress),
                  _keyed_blocks(second, self.topic, None)]
        newest: dict[int, float] = {0: -inf, 1: -inf}      # key read from each bag; inf at its end
        while min(newest.values()) < inf:
            side = 0 if newest[0] <= newest[1] else 1
            block = next(blocks[side], None)
            if block is None:
                newest[side] = inf
                continue
            newest[side] = max(int(part.keys.max()) for part in block)
            for part in block:
                self._match(side, part)
            if max(newest.values()) < inf:
                self._give_up(min(newest.values()))
        for side in (0, 1):
            self.only[side] += sum(len(part.keys) for part in self._pending[side])
        return TopicDiff(self.topic, self.messages, self.only[0], self.only[1], self.largest)

    def _match(self, side: int, new: _KeyedRecords) -> None:
        """Compare new messages of one bag with the waiting messages of the other bag."""
        waiting = self._pending[1 - side]
        for i, other in enumerate(waiting):
            _, rows, other_rows = np.intersect1d(new.keys, other.keys, return_indices=True)
            if len(rows):
                self._compare(new.records[rows], other.records[other_rows])
                new, waiting[i] = new.without(rows), other.without(other_rows)
        waiting[:] = [other for other in waiting if len(other.keys)]
        if len(new.keys):
            self._pending[side].append(new)

    def _give_up(self, until: float) -> None:
        """Count waiting messages before a key that both bags have passed as missing in one."""
        for side, pending in enumerate(self._pending):
            old = [part for part in pending if part.keys.max() < until]
            self.only[side] += sum(len(part.keys) for part in old)
            pending[:] = [part for part in pending if part.keys.max() >= until]

    def _compare(self, a: Array, b: Array) -> None:
        """
        Note the largest differences of matched messages, row i of ``a`` with row i of ``b``.

        A field that one bag alone has differs by inf; text of parameters, parameter by parameter.
        """
        self.messages += len(a)
        fields_a, fields_b = a.dtype.names or (), b.dtype.names or ()
        for field in dict.fromkeys((*fields_a, *fields_b)):
            is_in_both = field in fields_a and field in fields_b
            apart = {field: _field_distance(a[field], b[field]) if is_in_both else inf}
            if is_in_both and a[field].dtype.kind == 'S' and apart[field]:
                parameters = _parameter_distances(a[field], b[field])
                apart = apart if parameters is None else parameters
            for name, value in apart.items():
                self.largest[name] = max(self.largest.get(name, 0.0), value)


def _parameter_distances(texts_a: Array, texts_b: Array) -> dict[str, float] | None:
    """Return {parameter: largest difference} of scenes, which are JSON; None of other texts."""
    largest: dict[str, float] = {}
    for pair in zip(texts_a.tolist(), texts_b.tolist()):
        try:
            a, b = map(json.loads, pair)
            for name in a.keys() | b.keys():
                values = a.get(name), b.get(name)
                are_numbers = all(isinstance(value, (int, float)) for value in values)
                apart = (distance_of_two(*map(float, values)) if are_numbers
                         else 0.0 if values[0] == values[1] else inf)
                largest[name] = max(largest.get(name, 0.0), apart)
        except (ValueError, AttributeError):
            return None
    return {name: value for name, value in sorted(largest.items()) if value}


def _field_distance(a: Array, b: Array) -> float:
    """Return the largest difference of a field in two arrays of messages; of texts infinite."""
    if a.shape != b.shape:
        return inf
    if a.dtype.kind == 'S':
        return 0.0 if (a == b).all() else inf
    return distance(a.astype(float), b.astype(float)) if a.size else 0.0    # empty sequences


def _keyed_blocks(bag: Bag, topic: str, progress: Progress | None
                  ) -> Iterator[list[_KeyedRecords]]:
    """Yield the messages of a topic, a list for each block: one entry for each layout."""
    for block in bag.blocks([topic], progress=progress):
        records = []
        for columns in block:
            # the stamp [ns]; where nobody stamped a message, its place in the topic
            places, stamps = columns.places, columns.stamps
            keys = places if stamps is None else np.where(stamps == 0, places, stamps)
            records.append(_KeyedRecords(keys, columns.records))
        yield records
