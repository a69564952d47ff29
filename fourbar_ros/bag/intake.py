# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages on their way to the file: numbered, stamped, bounded; no caller waits for the disk."""
from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
import threading
import time

# A queue of more messages or bytes than these takes no more: the newest are dropped.
QUEUE_MESSAGES = 100_000
QUEUE_BYTES = 128 * 2**20
# The thread takes so many messages at a time: a bite holds the interpreter, and with it the thread
# that drives the crank, for less than a microsecond a message.
BITE = 50


class SteadyClock:
    """Nanoseconds of the wall clock at the start, then of a monotonic one: they never go back."""

    def __init__(self) -> None:
        self._offset = time.time_ns() - time.monotonic_ns()

    def now(self) -> int:
        """Return the time [ns]."""
        return self._offset + time.monotonic_ns()


class Intake:
    """
    A queue between the threads that write and the one that serves the file.

    Parameters
    ----------
    channels : int
    on_first_drop : callable
        Called once, without arguments, when the queue is full for the first time.

    Attributes
    ----------
    accepted, dropped : int
        Messages that are or will be in the bag; messages that the queue or the disk refused.
    given : list of int
        The next sequence number of every channel; dropped messages have numbers too.
    error : str or None
        Why no more are taken.

    """

    def __init__(self, channels: int, on_first_drop: Callable[[], object]) -> None:
        self.accepted = self.dropped = 0
        self.given = [0] * channels
        self.error: str | None = None
        self.clock, self._on_first_drop = SteadyClock(), on_first_drop
        self._queue: deque[tuple[int, int, list[tuple[int, int, bytes]]]] = deque()
        self._lock, self._is_closed = threading.Lock(), False
        # Each pair: messages and bytes that came in or went out, changed by one side only.
        self._taken_in = self._taken_out = self._bytes_in = self._bytes_out = 0

    @property
    def waiting(self) -> int:
        """Return how many messages wait for the file."""
        return self._taken_in - self._taken_out

    def put(self, messages: Sequence[tuple[int, bytes]]) -> bool:
        """
        Take messages, (channel, bytes), of one step and time, or drop them all.

        Return whether they were taken.
        """
        count, size, given = len(messages), 0, self.given
        with self._lock:
            if self._is_closed or self.error:
                return False
            numbered = []
            for channel, data in messages:
                sequence = given[channel]
                given[channel] = sequence + 1
                numbered.append((channel + 1, sequence & 0xFFFFFFFF, data))
                size += len(data)
            is_full = (self._taken_in - self._taken_out >= QUEUE_MESSAGES
                       or self._bytes_in - self._bytes_out + size > QUEUE_BYTES)
            is_first = is_full and not self.dropped
            if is_full:
                self.dropped += count
            else:
                self._bytes_in += size
                self._taken_in += count
                self.accepted += count
                self._queue.append((self.clock.now(), size, numbered))
        if is_first:
            self._on_first_drop()
        return not is_full

    def drain(self, add: Callable[[int, list[tuple[int, int, bytes]]], None]) -> None:
        """
        Hand what waits to ``add(log time, messages)``.

        Messages that come meanwhile wait for the next time.
        """
        queue, bite = self._queue, 0
        for _ in range(len(queue)):
            stamp, size, messages = queue.popleft()
            add(stamp, messages)
            self._bytes_out += size
            self._taken_out += len(messages)
            bite += len(messages)
            if bite >= BITE:
                bite = 0
                time.sleep(0.0)                        # whoever waits for the interpreter gets it

    def close(self) -> bool:
        """Take no more; return whether it was open."""
        with self._lock:
            was_open, self._is_closed = not self._is_closed, True
        return was_open

    def add(self, text: str) -> None:
        """Say more of the error."""
        self.error = (self.error or '') + text

    def refuse(self, error: str) -> None:
        """Take no more because of an error, and forget what waits."""
        with self._lock:                 # a call under way still counts; later ones see the error
            self.error = error
        self._queue.clear()

    def count(self, recorded: int) -> None:
        """Correct the counts: so many messages are in the file, all others were dropped."""
        self.accepted = recorded
        self.dropped = sum(self.given) - recorded
