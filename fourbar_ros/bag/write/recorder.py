# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Write a rosbag2 bag live: directory NAME with NAME_0.mcap and metadata.yaml.

The caller hands over serialised messages and is never held up by the disk: they wait in a bounded
queue, a thread takes them to the file and flushes it every ``flush_period``. After a crash of the
process the file holds everything older than that, after a power cut everything older than
``sync_period``.
"""
from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
import contextlib
import os
from pathlib import Path
import shutil
import threading
import time

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.file_system import sync_folders
from fourbar_ros.bag.rosbag2 import Channel
from fourbar_ros.bag.write.parts import Parts, Split
from fourbar_ros.errors import BagError

__all__ = ['BagError', 'BagWriter', 'Channel', 'Split']

# [s] A kill costs the messages since the last flush: at most this, half of it on average.
FLUSH_PERIOD = 0.1
# [s] A robot's off switch is a power cut, and the kernel may keep data for 30 s. The sync has a
# thread of its own, so a slow disk delays neither the flush nor the caller. 0: never.
SYNC_PERIOD = 1.0
SPACE_PERIOD = 1.0          # [s] between two looks at the free space
SPACE_LEFT = 32 * 2**20     # [bytes] a bag is closed while its end still fits on the disk
CDR_HEADER = 4              # [bytes] the shortest message
WHY = 'stopped'             # why recording ended, where nobody says more
NO_SPLIT = Split()
# A queue of more messages or bytes than these takes no more: the newest are dropped.
QUEUE_MESSAGES = 100_000
QUEUE_BYTES = 128 * 2**20
# The thread of the file takes so many messages, then lets other threads run: it holds the
# interpreter, and with it the thread that drives the crank, for less than 1 us a message.
BITE = 50


class BagWriter:
    """
    One bag being written; :meth:`write` from any thread, :meth:`close` when done.

    Parameters
    ----------
    directory, name : str
        The bag is directory/name; an empty name takes a fresh one from the clock. An existing bag
        is never touched.
    channels : list of Channel
    about : dict of str
        Kept with the bag (custom_data), so that it explains itself.
    flush_period, sync_period : float
        The most that a crash and a power cut may cost [s].
    split : Split, optional
        When the bag goes on in a new file, and whether old ones are removed.
    tell : callable, optional
        Called with one line of text when recording stops by itself and when messages are first
        dropped.

    Attributes
    ----------
    path : Path
        The folder of the bag.

    Raises
    ------
    BagError
        The name is taken or leaves the directory, the directory cannot be written, or an argument
        is bad.

    """

    def __init__(self, directory: str | os.PathLike[str], name: str, channels: list[Channel],
                 about: Mapping[str, object], flush_period: float = FLUSH_PERIOD,
                 sync_period: float = SYNC_PERIOD, tell: Callable[[str], object] | None = None,
                 split: Split = NO_SPLIT):
        """Create the folder and its first file; start the threads that write and sync it."""
        rosbag2.check_channels(channels)
        if not flush_period > 0.0 or not sync_period >= 0.0:
            raise BagError(f'flush_period = {flush_period!r}, sync_period = {sync_period!r}: '
                           'must be positive, and not negative')
        self.flush_period, self.sync_period = flush_period, sync_period
        self._tell = tell or (lambda text: None)
        self._intake = Intake(len(channels), lambda: self._tell(
            f'{self.path}: the disk is too slow, messages are dropped'))
        self._stop = threading.Event()
        self._sync_error: OSError | None = None
        self.path, file = rosbag2.create(Path(directory), name)
        try:
            if shutil.disk_usage(self.path).free < SPACE_LEFT:
                raise BagError(f'less than {SPACE_LEFT >> 20} MiB free')
            self._parts = Parts(self.path, file, channels,
                                {str(key): str(value) for key, value in about.items()},
                                self._intake.given, split, sync_period > 0.0)
        except (OSError, BagError) as error:
            file.close()
            shutil.rmtree(self.path)
            raise BagError(f'{self.path}: {getattr(error, "strerror", None) or error}') from None
        jobs = [('bag', self._run)] + [('bag sync', self._keep_synced)] * (sync_period > 0.0)
        self._threads = [threading.Thread(target=job, name=title, daemon=True)
                         for title, job in jobs]
        for thread in self._threads:
            thread.start()

    @property
    def clock(self) -> SteadyClock:
        """Return the clock of the log times."""
        return self._intake.clock

    @clock.setter
    def clock(self, clock: SteadyClock) -> None:
        """Take another clock, as in a simulated run; before the first message."""
        self._intake.clock = clock

    @property
    def accepted(self) -> int:
        """Return how many messages are or will be in the bag."""
        return self._intake.accepted

    @property
    def dropped(self) -> int:
        """
        Return how many messages found the queue full or were refused by the disk.

        Each leaves a gap in the sequence numbers of its channel. The bag notes how many numbers
        were given, which shows a gap at its end too.
        """
        return self._intake.dropped

    @property
    def error(self) -> str | None:
        """Return why recording has stopped by itself; later messages are not accepted."""
        return self._intake.error

    @property
    def waiting(self) -> int:
        """Return how many messages wait for the disk."""
        return self._intake.waiting

    def write(self, channel: int, data: bytes | bytearray | memoryview) -> bool:
        """
        Take the bytes of one serialised message of a channel, by its number; returns at once.

        Return False if the queue is full, recording has stopped by an error, or the bag is closed.
        Raises BagError for an argument that would spoil the file, and leaves the bag as it was.
        """
        count = len(self._intake.given)
        if type(channel) is not int or not 0 <= channel < count:
            raise BagError(f'channel {channel!r}: must be a number from 0 to {count - 1}')
        if type(data) is not bytes:
            if not isinstance(data, (bytearray, memoryview)):
                raise BagError(f'data of type {type(data).__name__}: must be the bytes of a '
                               'message')
            data = bytes(data)                          # its owner may change it
        if len(data) < CDR_HEADER:
            raise BagError(f'data of {len(data)} bytes: a message has at least {CDR_HEADER}')
        return self.write_all([(channel, data)])

    def write_all(self, messages: Sequence[tuple[int, bytes]]) -> bool:
        """
        Take messages, (channel, bytes), of one step, or drop them all; as :meth:`write`.

        The arguments are not checked: a node calls this at every step.
        """
        return self._intake.put(messages)

    def close(self, why: str = WHY) -> Path:
        """
        Write the waiting messages and finish the file; its metadata say why recording ended.

        Return the path of the bag; raises BagError if recording had stopped by an error.
        """
        is_first = self._intake.close()
        self._stop.set()
        for thread in self._threads:
            thread.join()
        if is_first:
            self._guard(self._parts.sync_finished)
            self._guard(lambda: self._finish(why))
            self._parts.close()
        if self.error:
            raise BagError(f'{self.path}: {self.error}')
        return self.path

    # --- in the threads -------------------------------------------------------------------------

    def _run(self) -> None:
        """
        Take messages from the queue to the file, flush it, look at the free space, until stopped.

        A half period of tolerance keeps a flush that comes a little early from waiting for the
        next round.
        """
        now = flushed = looked = time.monotonic()
        period = min(FLUSH_PERIOD, self.flush_period)
        while not self._stop.wait(max(0.0, now + period - time.monotonic())) and not self.error:
            now = time.monotonic()
            self._guard(self._drain)
            if now - flushed >= self.flush_period - 0.5 * period:
                flushed = now
                self._guard(self._parts.flush)
            if now - looked >= SPACE_PERIOD:
                looked = now
                self._guard(self._look_at_the_disk)

    def _drain(self) -> None:
        self._intake.drain(self._parts.add)

    def _finish(self, why: str) -> None:
        """Write the waiting messages and the end of the bag."""
        self._drain()
        self._parts.container.flush()
        self._parts.end(why)

    def _guard(self, action: Callable[[], object]) -> None:
        """Run an action on the file; its first error ends the recording, later ones do nothing."""
        if self.error:
            return
        try:
            action()
        except Exception as error:      # of any kind: the stream must go on
            self._give_up(self._parts.missing() or getattr(error, 'strerror', None) or str(error))

    def _give_up(self, why: str) -> None:
        """End the recording by an error: finish the file if the disk allows it, report."""
        parts, intake = self._parts, self._intake
        intake.refuse(f'recording stopped: {why}')
        parts.ended = why
        try:
            with contextlib.suppress(OSError):         # what it does not take is gone
                parts.container.flush()
            intake.count(parts.recorded)
            parts.end(why)
            if parts.has_a_name:
                intake.add(f'; the bag is whole, {intake.accepted} messages')
        except Exception:               # the disk takes nothing more
            intake.count(parts.recorded)
            if parts.has_a_name:
                intake.add('; what was flushed is in the file: fourbar bag recover')
            with contextlib.suppress(OSError):         # there may be room for the reason
                parts.write_metadata_file()
        self._tell(f'{self.path}: {self.error}')

    def _look_at_the_disk(self) -> None:
        """Raise the error that ends the bag: a failed sync, a lost file, too little space."""
        if self._sync_error:
            raise self._sync_error
        why = self._parts.missing()
        if not why and shutil.disk_usage(self.path).free < SPACE_LEFT:
            why = f'less than {SPACE_LEFT >> 20} MiB free'
        if why:
            self._drain()
            self._parts.container.flush()
            raise BagError(why)

    def _keep_synced(self) -> None:
        """Bring finished parts and new data to the disk every sync period, until stopped."""
        synced, parts = 0, self._parts
        try:
            sync_folders(self.path)
            while not self._stop.wait(self.sync_period) and not self.error:
                parts.sync_finished()
                if synced != parts.container.size:
                    synced = parts.container.size
                    os.fdatasync(parts.file.fileno())
        except OSError as error:
            self._sync_error = error                   # the other thread acts on it


class SteadyClock:
    """Nanoseconds of the wall clock at the start, then of a monotonic one: they never go back."""

    def __init__(self) -> None:
        self._offset = time.time_ns() - time.monotonic_ns()

    def now(self) -> int:
        """Return the time [ns]."""
        return self._offset + time.monotonic_ns()


class Intake:
    """
    The queue between the threads that record messages and the one that writes the file.

    ``on_first_drop`` is called once, when the queue is full for the first time. ``accepted``,
    ``dropped``: messages that are or will be in the bag; messages that the queue or the disk
    refused. ``given``: the next sequence number of every channel; dropped messages have numbers
    too. ``error``: why no more are taken, or None.
    """

    def __init__(self, channels: int, on_first_drop: Callable[[], object]) -> None:
        """Begin with an empty queue; ``channels`` is their number."""
        self.accepted = self.dropped = 0
        self.given = [0] * channels
        self.error: str | None = None
        self.clock, self._on_first_drop = SteadyClock(), on_first_drop
        # (log time [ns], bytes, [(channel from 1, sequence number, message), ...])
        self._queue: deque[tuple[int, int, list[tuple[int, int, bytes]]]] = deque()
        self._lock, self._is_closed = threading.Lock(), False
        # Counters of messages and bytes in and out: each is changed by one side only, so that
        # the side of the file needs no lock.
        self._taken_in = self._taken_out = self._bytes_in = self._bytes_out = 0

    @property
    def waiting(self) -> int:
        """Return how many messages wait for the file."""
        return self._taken_in - self._taken_out

    def put(self, messages: Sequence[tuple[int, bytes]]) -> bool:
        """
        Take messages, (channel from 0, bytes), of one time, or drop them all.

        Return whether they were taken. They wait as (channel from 1, sequence number, bytes), as
        MCAP numbers them; dropped ones get a number too.
        """
        count, size, given = len(messages), 0, self.given
        with self._lock:
            if self._is_closed or self.error:
                return False
            numbered = []
            for channel, data in messages:
                sequence = given[channel]
                given[channel] = sequence + 1
                numbered.append((channel + 1, sequence & 0xFFFFFFFF, data))     # 32 bits in MCAP
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
        """Hand the messages that wait now to ``add(log time, messages)``, a few at a time."""
        queue, bite = self._queue, 0
        for _ in range(len(queue)):
            log_time, size, messages = queue.popleft()
            add(log_time, messages)
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
        """Append to the text of the error."""
        self.error = (self.error or '') + text

    def refuse(self, error: str) -> None:
        """Take no more because of an error, and forget the waiting messages."""
        with self._lock:                 # a call under way still counts; later ones see the error
            self.error = error
        self._queue.clear()

    def count(self, recorded: int) -> None:
        """Correct the counts: so many messages are in the file, the rest were dropped."""
        self.accepted = recorded
        self.dropped = sum(self.given) - recorded
