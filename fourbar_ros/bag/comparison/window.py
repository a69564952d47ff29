# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Match each output of a bag with its driven motion; count missing outputs."""
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
    The newest n driven motions of a bag, whose outputs may still come.

    Attributes
    ----------
    places : array, shape (n,)
        Where their messages stand in the bag, ascending.
    stamps, modes, status : array, shape (n,)
        Stamps [ns], assembly modes, statuses of the evaluation.
    is_certain : array of bool, shape (n,)
        The bag tells all that their outputs depend on: scene, wrenches, held values.
    values : array, shape (values, n)
        The numbers expected in outputs, in the order of the scene's FieldMap.
    sources : array, shape (3, n)
        Position, velocity and acceleration behind ``values``. They belong to an earlier motion
        where the last good values are held.
    counts : array of int, shape (outputs, n)
        How many messages of each output were found for each motion.

    """

    places: Array
    stamps: Array
    modes: Array
    status: Array
    is_certain: Array
    values: Array
    sources: Array
    counts: Array

    def followed_by(self, newer: Window) -> Window:
        """Return both windows as one."""
        return Window(*(np.concatenate(pair, axis=-1) for pair in zip(self, newer)))

    def newest(self, number: int) -> Window:
        """Return the window of its newest motions."""
        begin = len(self.places) - number
        return Window(*(array[..., begin:] for array in self))

    def motions_of(self, places: Array, stamps: Array) -> Array:
        """
        Return the index of each output's driven motion in the window, -1 for none.

        That is the last motion before the output. If it has another stamp, as in a bag of
        ``ros2 bag``, which mixes topics, it is the last motion of the output's stamp.
        """
        before = np.searchsorted(self.places, places, side='right') - 1
        good = (before >= 0) & (self.stamps[before] == stamps)
        if good.all():
            return before
        order = np.argsort(self.stamps, kind='stable')
        last = np.searchsorted(self.stamps, stamps, side='right', sorter=order) - 1
        same_stamp = np.where((last >= 0) & (self.stamps[order[last]] == stamps), order[last], -1)
        return np.where(good, before, same_stamp)


class Tally:
    """
    Counts the missing and the doubled messages of one output, motion by motion.

    Gaps count between two messages, since recording may begin and end anywhere; a recording of
    our node is complete from the first motion (``from_the_start``). ``open`` counts the gaps
    behind the newest message.
    """

    def __init__(self, from_the_start: bool) -> None:
        self.missing = self.doubled = self.open = 0
        self._has_begun = from_the_start

    def add(self, counts: Array, due: Array) -> None:
        """Take the messages found for each of the next motions, and whether one was due."""
        self.doubled += int(np.maximum(counts - 1, 0).sum())
        found, gaps = np.flatnonzero(counts), due & (counts == 0)
        if len(found):
            first, last = 0 if self._has_begun else found[0], found[-1]
            self.missing += self.open + int(np.count_nonzero(gaps[first:last]))
            self.open, self._has_begun = int(np.count_nonzero(gaps[last:])), True
        elif self._has_begun:
            self.open += int(np.count_nonzero(gaps))


def joined_by_place(blocks: Iterable[Sequence[Array]]) -> list[Array]:
    """
    Return the arrays (places, ...) of several blocks of messages, each joined to one.

    They are sorted by place: blocks of one topic, apart by the layout of their messages, lie
    between each other in the bag.
    """
    joined = [np.concatenate(arrays) for arrays in zip(*blocks)]
    order = np.argsort(joined[0], kind='stable')
    return [array[order] for array in joined]


def tells_timeout(columns: Columns, output: str, layout: FieldMap) -> Array:
    """
    Return a mask of the messages of an output that the node sent because its input had stopped.

    Their status says so; messages without a status are all NaN then. joint_states may hold
    positions meanwhile, so its velocities alone are asked.
    """
    if 'status' in columns.fields:
        return np.asarray(columns.records['status'] == INPUT_TIMEOUT)
    mask = np.ones(len(columns.times), bool)
    for field in ('velocity',) if output == 'joint_states' else layout.fields[output]:
        is_unknown = np.isnan(attrgetter(field)(columns.tree))
        mask &= is_unknown.all(axis=0) if is_unknown.ndim == 2 else is_unknown
    return mask
