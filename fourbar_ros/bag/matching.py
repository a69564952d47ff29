# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Match each output with its motion of the driven joint, and count missing ones."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Window(NamedTuple):
    """
    The newest inputs: places, stamps, statuses, whether their outputs are known, values.

    Outputs seen by name.
    """

    places: np.ndarray
    stamps: np.ndarray
    status: np.ndarray
    known: np.ndarray
    values: np.ndarray
    seen: dict

    def followed_by(self, new):
        """Return both."""
        return Window(*(np.concatenate(pair, axis=-1) for pair in zip(self[:-1], new[:-1])),
                      {name: np.concatenate((seen, new.seen[name]))
                       for name, seen in self.seen.items()})

    def from_(self, begin):
        """Return it without the oldest."""
        return Window(*(part[..., begin:] for part in self[:-1]),
                      {name: seen[begin:] for name, seen in self.seen.items()})

    def source_of(self, places, stamps):
        """
        Return which input each output belongs to, -1 for none.

        The last before it, or any of its stamp.
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
    """Outputs of one name: what is missing between the first and the last, what is doubled."""

    def __init__(self, from_the_start):
        self.missing = self.doubled = self.open = 0
        self._has_begun = from_the_start

    def add(self, seen, due):
        """
        Count the outputs of the next inputs.

        How many were seen of each, and whether one was due.
        """
        self.doubled += int(np.maximum(seen - 1, 0).sum())
        there, gone = np.flatnonzero(seen), due & (seen == 0)
        if len(there):
            first = 0 if self._has_begun else there[0]
            self.missing += self.open + int(np.count_nonzero(gone[first:there[-1]]))
            self.open, self._has_begun = int(np.count_nonzero(gone[there[-1]:])), True
        elif self._has_begun:
            self.open += int(np.count_nonzero(gone))


def in_order(parts):
    """Return arrays of several Columns as one each, by their places, which come first."""
    joined = [np.concatenate(part) for part in zip(*parts)]
    order = np.argsort(joined[0], kind='stable')
    return [part[order] for part in joined]
