# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Compare two bags message by message: the same stamp on the same topic is the same message."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
import json
from pathlib import Path
from typing import NamedTuple

from fourbar_ros.bag.comparison.recompute import Difference, distance
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Columns, Progress
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

Block = tuple[Array, Array]              # keys of messages, their records


class TopicDiff(NamedTuple):
    """
    One topic in both bags.

    ``largest`` is {field: largest difference}; of fields that only one of two messages has, and of
    texts, infinite. Of unlike scenes the parameters stand for the field.
    """

    topic: str
    messages: int
    only_first: int
    only_second: int
    largest: dict[str, float]

    @property
    def differences(self) -> list[Difference]:
        """Return a list of :class:`~fourbar_ros.bag.comparison.recompute.Difference`."""
        return [Difference(self.topic, field, self.messages, value)
                for field, value in self.largest.items()]

    def is_same(self, tolerance: float = 0.0) -> bool:
        """Return whether all messages are in both bags and no field differs by more."""
        return (not self.only_first and not self.only_second
                and max(self.largest.values(), default=0.0) <= tolerance)


def diff(first: str | Path, second: str | Path, topics: Sequence[str] | None = None,
         progress: Progress | None = None) -> list[TopicDiff]:
    """
    Return a list of :class:`TopicDiff`, one for every topic in either bag.

    Messages are matched by the stamp of their header, those without or with stamp 0 by their place
    among those of their topic. Memory does not grow with the bags, as long as their stamps go
    forward. ``progress`` is called with the bytes read of the first bag, once more for every
    topic.
    """
    one, other = Bag(first), Bag(second)
    names = sorted(_topics(one) | _topics(other))
    for topic in topics or ():
        if topic not in names:
            raise BagError(f'{topic}: in neither bag; they have {", ".join(names)}')
    return [_Topic(topic).run(one, other, progress) for topic in topics or names]


def _topics(bag: Bag) -> set[str]:
    summaries = [part.summary() for part in bag.parts]
    known = [summary for summary in summaries if summary is not None]
    if len(known) < len(summaries):
        for _ in bag.chunks():
            pass
        return {channel.topic for channel in bag.channels.values()}
    return {channel.topic for summary in known for channel in summary.channels.values()}


class _Topic:
    """Goes through one topic of both bags side by side."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.messages, self.only = 0, [0, 0]
        self.largest: dict[str, float] = {}
        # (keys, records) not yet met in the other bag
        self._pending: tuple[list[Block], list[Block]] = ([], [])

    def run(self, first: Bag, second: Bag, progress: Progress | None) -> TopicDiff:
        sources = [_keyed(first, self.topic, progress), _keyed(second, self.topic, None)]
        newest: list[int | None] = [None, None]
        over = [False, False]
        while not all(over):
            # the bag that is behind goes on
            here, there = newest
            side = 0 if over[1] or (not over[0] and (here is None or (
                there is not None and here <= there))) else 1
            found = next(sources[side], None)
            if found is None:
                over[side] = True
                continue
            newest[side] = max(int(keys.max()) for keys, _ in found)
            for keys, records in found:
                self._meet(side, keys, records)
            known = [key for key in newest if key is not None]
            if len(known) == 2:
                self._forget(min(known))
        for side in (0, 1):
            self.only[side] += sum(len(keys) for keys, _ in self._pending[side])
        return TopicDiff(self.topic, self.messages, self.only[0], self.only[1], self.largest)

    def _meet(self, side: int, keys: Array, records: Array) -> None:
        """Compare new messages with those of the other bag that wait for them."""
        others = self._pending[1 - side]
        for i, (other_keys, other) in enumerate(others):
            _, here, there = np.intersect1d(keys, other_keys, return_indices=True)
            if len(here):
                self._compare(records[here], other[there])
                keys, records = np.delete(keys, here), np.delete(records, here)
                others[i] = np.delete(other_keys, there), np.delete(other, there)
        others[:] = [pair for pair in others if len(pair[0])]
        if len(keys):
            self._pending[side].append((keys, records))

    def _forget(self, until: int) -> None:
        """Count the messages as missing in the other bag that both bags have passed."""
        for side, pending in enumerate(self._pending):
            for keys, _ in pending:
                if keys.max() < until:
                    self.only[side] += len(keys)
            pending[:] = [pair for pair in pending if pair[0].max() >= until]

    def _compare(self, a: Array, b: Array) -> None:
        self.messages += len(a)
        ours, theirs = a.dtype.names or (), b.dtype.names or ()
        for field in dict.fromkeys((*ours, *theirs)):
            is_in_both = field in ours and field in theirs
            apart = {field: _apart(a[field], b[field]) if is_in_both else np.inf}
            if is_in_both and a[field].dtype.kind == 'S' and apart[field]:
                parameters = _by_parameter(a[field], b[field])
                apart = apart if parameters is None else parameters
            for name, found in apart.items():
                self.largest[name] = max(self.largest.get(name, 0.0), found)


def _by_parameter(here: Array, there: Array) -> dict[str, float] | None:
    """Return {parameter: difference} of scenes, texts that hold a JSON object; None of others."""
    found: dict[str, float] = {}
    for pair in zip(here.tolist(), there.tolist()):
        try:
            a, b = map(json.loads, pair)
            for name in a.keys() | b.keys():
                found[name] = max(found.get(name, 0.0), _between(a.get(name), b.get(name)))
        except (ValueError, AttributeError):
            return None
    return {name: value for name, value in sorted(found.items()) if value}


def _between(a: float, b: float) -> float:
    """Return the difference of two parameters; infinite if they differ and are not numbers."""
    numbers = all(isinstance(value, (int, float)) for value in (a, b))
    return (distance(np.array([a], float), np.array([b], float)) if numbers else 0.0 if a == b
            else np.inf)


def _apart(here: Array, there: Array) -> float:
    """
    Return the largest difference of one field in two arrays of messages.

    Infinite if it does not compare numbers.
    """
    if here.shape != there.shape:
        return np.inf
    if here.dtype.kind == 'S':
        return 0.0 if (here == there).all() else np.inf
    # an empty sequence
    return distance(here.astype(float), there.astype(float)) if here.size else 0.0


def _keyed(bag: Bag, topic: str, progress: Progress | None) -> Iterator[list[tuple[Array, Array]]]:
    """
    Yield lists of (keys, records), one a layout in a block.

    The key is the stamp [ns], or the place in the topic.
    """
    for block in bag.blocks([topic], progress=progress):
        yield [(_keys(found), found.records) for found in block]


def _keys(columns: Columns) -> Array:
    stamps = columns.stamps                  # 0: nobody stamped it, as a simple source of inputs
    return columns.places if stamps is None else np.where(stamps == 0, columns.places, stamps)
