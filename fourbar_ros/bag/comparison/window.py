# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Match each output with its driven motion; count missing and doubled ones."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from operator import attrgetter
from typing import NamedTuple

from fourbar_ros.bag.read.records import Columns
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.status import INPUT_TIMEOUT
from fourbar_ros.scene.message_fields import FieldMap
import numpy as np


class Window(NamedTuple):
    """
    The newest inputs: places, stamps, modes, statuses, whether outputs are known, values.

    ``motions``: those that the values are of, shape (3, n); ``seen``: outputs by name.
    """

    places: Array
    stamps: Array
    modes: Array
    status: Array
    known: Array
    values: Array
    motions: Array
    seen: dict[str, Array]

    def followed_by(self, new: Window) -> Window:
        """Return this window and a newer one as one."""
        # the last field is no array
        places, stamps, modes, status, known, values, motions = (
            np.concatenate(pair, axis=-1) for pair in zip(self[:-1], new[:-1]))
        return Window(places, stamps, modes, status, known, values, motions,
                      {name: np.concatenate((seen, new.seen[name]))
                       for name, seen in self.seen.items()})

    def from_(self, begin: int) -> Window:
        """Return the window without the inputs before a place in it."""
        places, stamps, modes, status, known, values, motions = (
            part[..., begin:] for part in self[:-1])
        return Window(places, stamps, modes, status, known, values, motions,
                      {name: seen[begin:] for name, seen in self.seen.items()})

    def source_of(self, places: Array, stamps: Array) -> Array:
        """
        Return the input that each output belongs to, -1 for none.

        That is the last input before it or, if its stamp differs, any input of the same stamp.
        """
        source = np.searchsorted(self.places, places, side='right') - 1
        good = (source >= 0) & (self.stamps[source] == stamps)
        if not good.all():
            order = np.argsort(self.stamps, kind='stable')
            at = np.searchsorted(self.stamps, stamps, side='right', sorter=order) - 1
            other = order[at]
            is_same = (at >= 0) & (self.stamps[other] == stamps)
            source = np.where(good, source, np.where(is_same, other, -1))
        return source


class Tally:
    """Counts the missing and doubled outputs of one name, between its first and last message."""

    def __init__(self, from_the_start: bool) -> None:
        self.missing = self.doubled = self.open = 0
        self._has_begun = from_the_start

    def add(self, seen: Array, due: Array) -> None:
        """
        Count the outputs of the next inputs.

        ``seen``: how many there are for each input; ``due``: whether there should be one.
        """
        self.doubled += int(np.maximum(seen - 1, 0).sum())
        there, gone = np.flatnonzero(seen), due & (seen == 0)
        if len(there):
            first = 0 if self._has_begun else there[0]
            self.missing += self.open + int(np.count_nonzero(gone[first:there[-1]]))
            self.open, self._has_begun = int(np.count_nonzero(gone[there[-1]:])), True
        elif self._has_begun:
            self.open += int(np.count_nonzero(gone))


def in_order(parts: Iterable[Sequence[Array]]) -> list[Array]:
    """Return the arrays of several Columns joined and sorted by their places, which come first."""
    joined = [np.concatenate(part) for part in zip(*parts)]
    order = np.argsort(joined[0], kind='stable')
    return [part[order] for part in joined]


def says_silence(columns: Columns, name: str, layout: FieldMap) -> Array:
    """
    Return a mask of the messages of an output that say that the input has stopped.

    joint_states may hold positions meanwhile.
    """
    if 'status' in columns.fields:
        found: Array = columns.records['status'] == INPUT_TIMEOUT
        return found
    fields = ('velocity',) if name == 'joint_states' else layout.fields[name]
    silent = np.ones(len(columns.times), bool)
    for field in fields:
        values = np.isnan(attrgetter(field)(columns.tree))
        silent &= values.all(axis=0) if values.ndim == 2 else values
    return silent
