# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which forces from outside acted in which step.

The topic of the wrench in effect says so whenever it changes. A bag of ``ros2 bag`` may hold the
wrenches alone that the node received: then they act until the next one, or until they time out.
"""
from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from math import inf

from fourbar_ros.bag.records import Columns
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.in_modes import InModes
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene.topics import ON_LINK, WRENCH
import numpy as np

UNSETTLED = 200_000_000  # [ns] around a change, in which a bag of rosbag2 does not tell the order


class Acting:
    """
    Hands what acts to a stepper, in the order of the bag.

    Parameters
    ----------
    topics : dict
        {short name: topic} of the bag.
    links : sequence of str
        Those that a topic loads.

    """

    def __init__(self, topics: Collection[str], links: Sequence[str]) -> None:
        self.wrenches: dict[str, Wrench] = {}   # by link, as a stepper keeps them
        self._waiting: list[tuple[int, str, Wrench]] = []        # with their places
        self._times = np.zeros(0)            # when one was logged that differs from before [ns]
        self._newest: dict[str, Wrench] = {}     # the last wrench of each link
        loaded = [name.removeprefix(ON_LINK) for name in topics if name.startswith(ON_LINK)]
        self._source = {link: ON_LINK + link for link in (*loaded, *links)}
        # {link: log times [ns]} where only these are known
        self._received: dict[str, Array] = {}
        for link in links:
            if ON_LINK + link not in topics and WRENCH + link in topics:
                self._source[link] = WRENCH + link
                self._received[link] = np.zeros(0)

    def take(self, by_name: Mapping[str | None, Iterable[Columns]], frame_id: str) -> None:
        """Take the messages of a block that say what acts; ``by_name``: lists of Columns."""
        changes = self._times[-1:].tolist()
        for link, name in self._source.items():
            messages = sorted(message for columns in by_name.get(name, ())
                              for message in _messages(columns, link in self._received, frame_id))
            for place, time, wrench in messages:
                self._waiting.append((place, link, wrench))
                if wrench != self._newest.get(link):
                    changes.append(time)
                self._newest[link] = wrench
            if link in self._received:
                times = [time for _, time, _ in messages]
                self._received[link] = np.array([*self._received[link][-1:], *times])
        self._times = np.sort(np.array(changes))
        self._waiting.sort(key=lambda event: event[0])

    def apply(self, stepper: InModes, until: float = inf) -> None:
        """Apply to steppers what acted before a place in the bag."""
        while self._waiting and self._waiting[0][0] < until:
            _, link, wrench = self._waiting.pop(0)
            stepper.act(link, wrench)

    def is_settled(self, times: Array, timeout: float) -> Array:
        """
        Return which motions, by the time they were logged, are not near a change.

        A bag of the received wrenches alone does not show what acts before the first and after
        ``timeout`` [s] without one, 0 for never.
        """
        good = _distance(self._times, times) > UNSETTLED
        longest = timeout * 1e9 - UNSETTLED if timeout else inf
        for received in self._received.values():
            before = np.searchsorted(received, times) - 1
            last = received[np.maximum(before, 0)] if len(received) else np.zeros(len(times))
            good &= (before >= 0) & (times - last < longest)
        return good


def _distance(changes: Array, times: Array) -> Array:
    """Return how far each time is from the nearest change."""
    if not len(changes):
        return np.full(len(times), inf)
    after = np.searchsorted(changes, times)
    before = changes[np.maximum(after - 1, 0)]
    next_one = changes[np.minimum(after, len(changes) - 1)]
    return np.minimum(abs(times - before), abs(times - next_one))


def _messages(columns: Columns, is_received: bool, frame_id: str) -> list[tuple[int, int, Wrench]]:
    """Return [(place, log time, Wrench)] of messages; of received ones those that a node takes."""
    wrench = columns.tree.wrench
    is_ours = np.ones(len(columns.times), bool)
    if is_received and 'header.frame_id' in columns.fields:    # else it is empty
        is_ours = columns.records['header.frame_id'] == frame_id.encode()
    # a couple is the same in all frames
    is_ours |= (wrench.force.x == 0.0) & (wrench.force.y == 0.0)
    parts = (columns.places, columns.times, wrench.force.x, wrench.force.y, wrench.torque.z)
    return [(place, time, Wrench(*each))
            for place, time, *each in zip(*(part[is_ours].tolist() for part in parts))]
