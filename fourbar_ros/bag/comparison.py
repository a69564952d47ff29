# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Compare two bags message by message: the same stamp on the same topic is the same message.

Of joint states with one stamp, as a robot and a relay send them, those of the same joints are.
"""
from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Sequence
from itertools import repeat
import json
from math import inf
from pathlib import Path
from typing import NamedTuple

from fourbar_ros.bag.reader import Bag, Columns, Progress
from fourbar_ros.bag.recomputation import largest_difference, names_in
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

Place = tuple[int, int]     # of a message: number of its columns, row there


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

    def is_same(self, tolerance: float = 0.0) -> bool:
        """Return whether all messages are in both bags and no field differs by more."""
        return (not self.only_first and not self.only_second
                and max(self.largest.values(), default=0.0) <= tolerance)


def diff(first: str | Path, second: str | Path, topics: Sequence[str] | None = None,
         progress: Progress | None = None) -> list[TopicDiff]:
    """
    Return a :class:`TopicDiff` for every topic in either bag, or only for ``topics``.

    Messages are matched by the stamp of their header, those of equal stamp by their joints, if
    they have any, and then in their order.
    Messages without a stamp, or with stamp 0, are matched by their place in the topic.
    ``progress`` is called with the bytes read of the first bag, once more for every topic.
    """
    bags = Bag(first, progress), Bag(second)
    names = sorted({topic for bag in bags for topic in bag.types})
    for topic in topics or ():
        if topic not in names:
            raise BagError(f'{topic}: in neither bag; they have {", ".join(names)}')
    found = []
    for topic in topics or names:
        parts = [list(bag.columns([topic])) for bag in bags]
        for bag in bags:
            bag.refuse_damage()
        found.append(_of_topic(topic, *parts))
    return found


def _of_topic(topic: str, first: Sequence[Columns], second: Sequence[Columns]) -> TopicDiff:
    of_first, of_second = _places(first), _places(second)
    pairs = [(of_first.pop(key), of_second.pop(key)) for key in of_first.keys() & of_second.keys()]
    waiting: defaultdict[int, deque[Place]] = defaultdict(deque)
    for (stamp, _, _), place in of_second.items():      # joints have other names in the first bag
        waiting[stamp].append(place)
    pairs += [(place, waiting[stamp].popleft()) for (stamp, _, _), place in of_first.items()
              if waiting[stamp]]
    # numpy compares all rows that are in the same columns on both sides at once
    rows: defaultdict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for (i, row), (j, other) in pairs:
        rows[i, j].append((row, other))
    largest: dict[str, float] = {}
    for (i, j), rows_of_both in rows.items():
        one, two = np.array(rows_of_both).T
        for field, apart in _differences(first[i].records[one], second[j].records[two]).items():
            largest[field] = max(largest.get(field, 0.0), apart)
    only_first, only_second = (sum(len(part.times) for part in parts) - len(pairs)
                               for parts in (first, second))
    return TopicDiff(topic, len(pairs), only_first, only_second, largest)


def _places(parts: Sequence[Columns]) -> dict[tuple[int, bytes, int], Place]:
    """
    Return {which message: where it is}.

    Messages of two bags are the same if they have one stamp [ns], or none (0), the same names of
    joints, if any, and as many before them had both.
    """
    places: dict[tuple[int, bytes, int], Place] = {}
    times_met: Counter[tuple[int, bytes]] = Counter()
    for number, columns in enumerate(parts):
        stamps = columns.stamps
        if stamps is None:
            stamps = np.zeros(len(columns.times), np.int64)
        fields = names_in(columns.records)
        names: Iterable[bytes] = repeat(b'')
        if fields:
            names = [b'\0'.join(row) for row in columns.records[fields].tolist()]
        for row, (stamp, name) in enumerate(zip(stamps.tolist(), names)):
            places[stamp, name, times_met[stamp, name]] = number, row
            times_met[stamp, name] += 1
    return places


def _differences(one: Array, two: Array) -> dict[str, float]:
    """Return the largest difference of each field of matched messages, row by row."""
    fields, others = one.dtype.names or (), two.dtype.names or ()
    largest: dict[str, float] = {}
    for field in dict.fromkeys((*fields, *others)):
        if field not in fields or field not in others:
            largest[field] = inf
            continue
        apart = largest_difference(one[field], two[field])
        largest |= (_parameters_apart(one[field], two[field]) if apart else {}) or {field: apart}
    return largest


def _parameters_apart(one: Array, two: Array) -> dict[str, float]:
    """Return {parameter: largest difference} of scenes, which are JSON; {} of other texts."""
    largest: dict[str, float] = {}
    try:
        for first, second in zip(one.tolist(), two.tolist()):
            a, b = json.loads(first), json.loads(second)
            for name in sorted(a.keys() | b.keys()):
                x, y = a.get(name), b.get(name)
                if x != y and not (x != x and y != y):      # NaN: not given
                    are_numbers = isinstance(x, (int, float)) and isinstance(y, (int, float))
                    largest[name] = max(largest.get(name, 0.0), abs(x - y) if are_numbers else inf)
    except (ValueError, TypeError, AttributeError):
        return {}
    return largest
