# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Compare two bags message by message: the same stamp on the same topic is the same message.

Joint states of equal stamp, as a robot and a relay send them, are the same if their joints are.
"""
from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Sequence
from itertools import count, repeat
import json
from math import inf
from pathlib import Path
from typing import NamedTuple

from fourbar_ros.bag import outputs, reader
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

Position = tuple[int, int]      # of a message: index of the Columns, row


class TopicDiff(NamedTuple):
    """One topic in both bags."""

    topic: str
    messages: int               # in both
    only_first: int
    only_second: int
    # {field, or parameter of scenes that differ: largest difference}; infinite of texts and of
    # fields that one message alone has
    largest: dict[str, float]

    def is_same(self, tolerance: float = 0.0) -> bool:
        """Return whether all messages are in both bags and no field differs by more."""
        return (not self.only_first and not self.only_second
                and max(self.largest.values(), default=0.0) <= tolerance)


def diff(first: str | Path, second: str | Path, topics: Sequence[str] | None = None,
         progress: reader.Progress | None = None) -> list[TopicDiff]:
    """
    Return a :class:`TopicDiff` for every topic in either bag, or only for ``topics``.

    Messages are matched by the stamp of the header; messages of equal stamp by the names of their
    joints, if they have any, then in order. Messages without a stamp, or with stamp 0, are matched
    in the order of the topic.
    ``progress`` is called with the count of bytes read of the first bag, from 0 for every topic.
    """
    bags = reader.Bag(first, progress), reader.Bag(second)
    names = sorted({topic for bag in bags for topic in bag.types})
    for topic in topics or ():
        if topic not in names:
            raise BagError(f'{topic}: in neither bag; they have {", ".join(names)}')
    diffs = []
    for topic in topics or names:
        columns = [list(bag.columns([topic])) for bag in bags]
        for bag in bags:
            bag.refuse_damage()
        of_first, of_second = map(_positions, columns)
        pairs = [(of_first.pop(key), of_second.pop(key))
                 for key in of_first.keys() & of_second.keys()]
        waiting: defaultdict[int, deque[Position]] = defaultdict(deque)
        for (stamp, _, _), position in of_second.items():  # the first bag names joints differently
            waiting[stamp].append(position)
        pairs += [(position, waiting[stamp].popleft())
                  for (stamp, _, _), position in of_first.items() if waiting[stamp]]
        # numpy compares all rows that are in the same columns on both sides at once
        rows: defaultdict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
        for (i, first_row), (j, second_row) in pairs:
            rows[i, j].append((first_row, second_row))
        largest: dict[str, float] = {}
        for (i, j), rows_of_both in rows.items():
            first_rows, second_rows = np.array(rows_of_both).T
            for field, apart in _differences(columns[0][i].records[first_rows],
                                             columns[1][j].records[second_rows]).items():
                largest[field] = max(largest.get(field, 0.0), apart)
        only_first, only_second = (sum(len(each.times) for each in of_bag) - len(pairs)
                                   for of_bag in columns)
        diffs.append(TopicDiff(topic, len(pairs), only_first, only_second, largest))
    return diffs


def _positions(topic: Sequence[reader.Columns]) -> dict[tuple[int, bytes, int], Position]:
    """
    Return the position of each message by its key, which is equal for equal messages of two bags.

    The key is the stamp [ns] (0 without a stamp), the names of the joints (b'' without joints),
    and how many messages before had both.
    """
    messages = list[tuple[int, Position, tuple[int, bytes]]]()
    for index, columns in enumerate(topic):
        stamps = columns.stamps
        if stamps is None:
            stamps = np.zeros(len(columns.times), np.int64)
        fields = outputs.names_in(columns.records)
        names: Iterable[bytes] = repeat(b'')
        if fields:
            names = [b'\0'.join(row) for row in columns.records[fields].tolist()]
        messages += zip(columns.indices.tolist(), zip(repeat(index), count()),
                        zip(stamps.tolist(), names))
    positions: dict[tuple[int, bytes, int], Position] = {}
    times_met: Counter[tuple[int, bytes]] = Counter()
    for _, position, stamp_and_name in sorted(messages):
        positions[*stamp_and_name, times_met[stamp_and_name]] = position
        times_met[stamp_and_name] += 1
    return positions


def _differences(first: Array, second: Array) -> dict[str, float]:
    """Return {field, or parameter of scenes: largest difference} of rows of two bags in pairs."""
    of_first, of_second = first.dtype.names or (), second.dtype.names or ()
    largest: dict[str, float] = {}
    for field in dict.fromkeys((*of_first, *of_second)):
        if field not in of_first or field not in of_second:
            largest[field] = inf
            continue
        apart = outputs.largest_difference(first[field], second[field])
        parameters = _parameters_apart(first[field], second[field]) if apart else {}
        largest |= parameters or {field: apart}
    return largest


def _parameters_apart(first: Array, second: Array) -> dict[str, float]:
    """Return {parameter: largest difference} of texts that are scenes as JSON; {} of others."""
    largest: dict[str, float] = {}
    try:
        for texts in zip(first.tolist(), second.tolist()):
            a, b = map(json.loads, texts)
            for name in sorted(a.keys() | b.keys()):
                x, y = a.get(name), b.get(name)
                are_numbers = isinstance(x, (int, float)) and isinstance(y, (int, float))
                apart = (outputs.distance(float(x), float(y)) if are_numbers else
                         inf if x != y else 0.0)
                if apart > 0.0:
                    largest[name] = max(largest.get(name, 0.0), apart)
    except (ValueError, TypeError, AttributeError, OverflowError):
        return {}
    return largest
