# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Answers of a live node meet the messages that a bag has of them, by their stamps."""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.bag.difference import distance
from fourbar_ros.formats.cdr import Decoder
import numpy as np

BLOCK = 2000            # pairs of messages that are compared at once
LATE = 10_000           # messages of a topic that wait for their partner; older ones have none


class Answer(NamedTuple):
    """What a live node said on one topic, beside what was recorded; ``field`` differs most."""

    topic: str
    messages: int
    missing: int
    largest: float
    field: str


class Meeting:
    """Recorded messages of one topic and the answers of the live node, until they meet."""

    def __init__(self, decoder: Decoder) -> None:
        self._decoder = decoder
        self._expected: dict[bytes, bytes] = {}          # by stamp, as the answers
        self._answers: dict[bytes, bytes] = {}
        self._pairs: list[tuple[bytes, bytes]] = []
        self.messages = self.missing = 0
        self.largest, self.field = 0.0, ''

    def expect(self, stamp: bytes, data: bytes) -> None:
        """Keep what was recorded."""
        self._meet(stamp, data, self._expected, self._answers, False)

    def answer(self, stamp: bytes, data: bytes) -> None:
        """Keep what the live node says."""
        self._meet(stamp, data, self._answers, self._expected, True)

    @property
    def waiting(self) -> int:
        """Return how many answers are still to come."""
        return len(self._expected)

    def is_waiting_for(self, stamp: bytes) -> bool:
        """Return whether the answer of this stamp is still to come."""
        return stamp in self._expected

    def _meet(self, stamp: bytes, data: bytes, own: dict[bytes, bytes], others: dict[bytes, bytes],
              is_answer: bool) -> None:
        other = others.pop(stamp, None)
        if other is None:
            own[stamp] = data
            if len(own) > LATE:
                del own[next(iter(own))]
                self.missing += not is_answer
            return
        self._pairs.append((other, data) if is_answer else (data, other))
        if len(self._pairs) >= BLOCK:
            self.compare()

    def compare(self) -> None:
        """Compare the messages that have met."""
        here, there = [pair[0] for pair in self._pairs], [pair[1] for pair in self._pairs]
        self.messages += len(self._pairs)
        self._pairs = []
        for layout, rows, records in self._decoder.arrays(here):
            answers = [there[row] for row in rows]
            if not all(map(layout.matches, answers)):
                self.largest, self.field = np.inf, '(lengths)'
                continue
            others = np.frombuffer(b''.join(answers), layout.dtype)
            for leaf in layout.leaves:
                if leaf.format[0] != 'S':
                    value = distance(records[leaf.name].astype(float),
                                     others[leaf.name].astype(float))
                    if value > self.largest:
                        self.largest, self.field = value, leaf.name

    def finished(self, topic: str) -> Answer:
        """Return the Answer."""
        if self._pairs:
            self.compare()
        return Answer(topic, self.messages, self.missing + len(self._expected), self.largest,
                      self.field)


def stamp_of(data: bytes) -> bytes:
    """Return the stamp of a message that begins with a header, as the bytes it has on the wire."""
    return bytes(data[4:12])
