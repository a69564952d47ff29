# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Which forces from outside acted in which step: the bag says so whenever they change."""
from __future__ import annotations

from math import inf

from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene.topics import APPLIED
import numpy as np

APPLIED_ON = {topic.name: link for link, topic in APPLIED.items()}
UNSETTLED = 200_000_000  # [ns] around a change, in which a bag of rosbag2 does not tell the order


class Acting:
    """Hands what acts to a stepper, in the order of the bag."""

    def __init__(self):
        self.wrenches = {}                               # by link, as a stepper keeps them
        self._waiting = []                   # (place, link, Wrench)
        self._times = np.zeros(0)            # when they were logged [ns]

    def take(self, by_name: dict) -> None:
        """Take the messages of a block that say what acts; ``by_name``: lists of Columns."""
        self._times = self._times[-1:]
        for name, link in APPLIED_ON.items():
            for columns in by_name.get(name, ()):
                wrench = columns.tree.wrench
                numbers = (part.tolist()
                           for part in (wrench.force.x, wrench.force.y, wrench.torque.z))
                self._waiting += [(place, link, Wrench(*each))
                                  for place, *each in zip(columns.places.tolist(), *numbers)]
                self._times = np.concatenate((self._times, columns.times))
        self._waiting.sort(key=lambda event: event[0])
        self._times.sort()

    def apply(self, stepper, until: float = inf) -> None:
        """Have a stepper feel what came before a place in the bag."""
        while self._waiting and self._waiting[0][0] < until:
            _, link, wrench = self._waiting.pop(0)
            stepper.act(link, wrench)

    def is_settled(self, times: np.ndarray) -> np.ndarray:
        """Return which motions, by the time they were logged, are not near a change."""
        if not len(self._times):
            return np.ones(len(times), bool)
        after = np.searchsorted(self._times, times)
        before = self._times[np.maximum(after - 1, 0)]
        next_one = self._times[np.minimum(after, len(self._times) - 1)]
        return np.minimum(abs(times - before), abs(times - next_one)) > UNSETTLED
