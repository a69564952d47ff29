# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""When a bag continues in a new file, what that file repeats, which old files may be removed."""
from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

# a bag that keeps the newest seconds has so many parts, unless split otherwise
SHARE = 10


class Split(NamedTuple):
    """
    How a bag is split; 0 stands for never.

    ``size`` [bytes] and ``duration`` [s] end a part, whichever comes first; ``keep`` [s]: parts
    that the newest seconds do not need are removed. ``head``: the channel whose messages begin a
    part, None for any: a step that sends several messages is not torn apart.
    """

    size: int = 0
    duration: float = 0.0
    keep: float = 0.0
    head: int | None = None

    @property
    def seconds(self) -> float:
        """Return the longest duration of a part [s], 0 for endless."""
        return self.duration or (0.0 if self.size else self.keep / SHARE)

    @property
    def is_wanted(self) -> bool:
        """Return whether the bag is split at all."""
        return self.size > 0 or self.seconds > 0.0


class Splitter:
    """
    Follows what goes into a bag.

    Parameters
    ----------
    split : Split
    latched : set of int
        Channels of which only the newest message holds.

    """

    def __init__(self, split: Split, latched: Collection[int]) -> None:
        self._split, self._latched = split, latched
        # {channel: (sequence, time, data)}, the newest of each, oldest first
        self._last: dict[int, tuple[int, int, bytes]] = {}
        self._begun: int | None = None   # [ns] when the part began
        self.number = 0                  # of the part

    def is_due(self, channel: int, time: int, size: int) -> bool:
        """
        Return whether a new part begins with this message.

        ``size`` is that of the part so far [bytes].
        """
        if self._begun is None:
            self._begun = time
        split = self._split
        is_full = (split.size and size >= split.size or split.seconds and time - self._begun
                   >= split.seconds * 1e9)
        return bool(is_full) and split.head in (None, channel)

    def note(self, channel: int, sequence: int, time: int, data: bytes) -> None:
        """Remember a message."""
        self._last.pop(channel, None)
        self._last[channel] = sequence, time, data

    def repeats(self) -> list[tuple[int, int, int, bytes]]:
        """
        Return [(channel, sequence, time, data)] that a new part begins with.

        The newest latched messages, as the scene, and of all others the newest that came after
        these.
        """
        items = [(channel, *item) for channel, item in self._last.items()]
        newest = max((i for i, item in enumerate(items) if item[0] in self._latched), default=-1)
        return [item for item in items if item[0] in self._latched] + items[newest + 1:]

    def begin(self, time: int) -> None:
        """Begin the next part."""
        self._begun, self.number = time, self.number + 1

    def outdated(self, starts: Sequence[int]) -> int:
        """
        Return how many of the oldest parts may be removed.

        ``starts``: when the parts began [ns]; the remaining ones cover the time to keep.
        """
        keep = self._split.keep * 1e9
        return sum(start <= starts[-1] - keep for start in starts[1:]) if keep else 0
