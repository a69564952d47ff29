# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The messages of a bag at their original pace, without ROS: for notebooks, and for the replay node.

>>> for raw in play('bags/run', rate=10.0):
...     print(raw.topic, raw.time)
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import inf
from pathlib import Path
import time

from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Raw
from fourbar_ros.errors import BagError

LONGEST = 9e9       # [s] nanoseconds in 64 bits hold no more
TICK = 0.05         # [s] longest sleep
SLOWEST = 1e-6      # rate: 1 s of a bag in 12 days
FASTER = 1.1        # one press of a key, as of ros2 bag play
Tick = Callable[[int], object]           # with the time of the bag [ns]; False ends playing


class Pace:
    """
    The time of a bag as it passes: at a rate, which can change, not at all, or message by message.

    ``rate``: times as fast, ``inf`` does not wait at all; ``clock`` returns the time [s].
    """

    def __init__(self, rate: float = 1.0, clock: Callable[[], float] = time.monotonic) -> None:
        if not rate >= SLOWEST:
            raise BagError(f'rate = {rate!r}: must be at least {SLOWEST:g}')
        self.rate, self._clock = rate, clock
        self.is_paused, self._steps = False, 0
        self.begin()

    def begin(self) -> None:
        """Start again at 0."""
        self._passed, self._since = 0.0, self._clock()

    def passed(self) -> float:
        """Return the time of the bag since its beginning [s]."""
        running = 0.0 if self.is_paused else (self._clock() - self._since) * self.rate
        return self._passed + running

    def _hold(self) -> None:
        """Begin to count anew from now, before the rate changes."""
        self._passed, self._since = self.passed(), self._clock()

    def pause(self, paused: bool = True) -> None:
        """Stop the time, or let it go on."""
        if self.rate != inf:
            self._hold()
        self.is_paused = paused
        self._since = self._clock()

    def change(self, factor: float) -> None:
        """Change the rate by a factor from now on."""
        self._hold()
        self.rate *= factor

    def step(self) -> None:
        """Let the next message out while the time is paused."""
        self._steps += self.is_paused

    def is_due(self, due: float) -> bool:
        """Return whether a message that is due after so many seconds goes out now."""
        if not self.is_paused:
            return self.rate == inf or self.passed() >= due
        if not self._steps:
            return False
        self._steps, self._passed = self._steps - 1, max(self._passed, due)
        return True


def span(path: str | Path | Bag) -> tuple[int | None, int | None]:
    """Return (first, last) log time of a finished bag [ns], None where it is not known."""
    bag = path if isinstance(path, Bag) else Bag(path)
    every = [summary and summary.statistics for summary in (part.summary() for part in bag.parts)]
    begun = [statistics for statistics in every if statistics and statistics.message_count]
    if None in every or not begun:
        return None, None
    return (min(statistics.message_start_time for statistics in begun),
            max(statistics.message_end_time for statistics in begun))


def play(path: str | Path | Bag, topics: Sequence[str] | None = None, rate: float = 1.0,
         start: float = 0.0, loop: bool = False, follow: bool = False, tick: Tick | None = None,
         period: float = TICK, pace: Pace | None = None) -> Iterator[Raw]:
    """
    Yield every :class:`~fourbar_ros.bag.read.records.Raw` message of a bag when it is due.

    Due is the time since the first message over ``rate``, on a monotonic clock: a late message
    does not make the next one late. A finished bag is read only as far as it is played.

    Parameters
    ----------
    topics : list of str, optional
        Only these.
    rate : float
        Times as fast; ``inf`` does not wait at all.
    start : float
        Leave out so many seconds at the beginning of the bag.
    loop, follow : bool
        Begin again at the end; at the end of a bag that is being written, wait for more.
    tick : callable, optional
        Called with the time of the bag [ns] at least every ``period`` seconds, and before each
        message. Playing ends when it returns False.
    pace : Pace, optional
        To pause, step and change the rate meanwhile; ``rate`` is then its own.

    """
    bag = path if isinstance(path, Bag) else Bag(path)
    tick = tick or (lambda now: True)
    if not 0.0 <= start <= LONGEST:
        raise BagError(f'start = {start!r}: must be from 0 to {LONGEST:g} s')
    pace = pace or Pace(rate)
    origin = next((raw.time for raw in bag.raw()), None)
    if origin is None:
        return
    origin += round(start * 1e9)
    while True:
        pace.begin()
        count = 0
        for raw in bag.raw(topics, origin if start else None, follow):
            if not _wait(pace, raw.time - origin, origin, tick, period):
                return
            yield raw
            count += 1
        if not loop or not count:
            return


def _wait(pace: Pace, due: int, origin: int, tick: Tick, period: float) -> bool:
    """
    Wait until a message is due, ``due`` [ns] after the beginning of the bag at ``origin`` [ns].

    Calls ``tick`` at least every ``period`` [s]; returns False as soon as a tick does.
    """
    while True:
        if pace.is_due(due * 1e-9):
            return tick(origin + due) is not False
        passed = pace.passed()
        if tick(origin + int(passed * 1e9)) is False:
            return False
        time.sleep(period if pace.is_paused
                   else max(min((due * 1e-9 - passed) / pace.rate, period), 0.0))
