# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Record serialised messages to a rosbag2 bag: the mcap library writes, a thread waits for the disk.

A message waits in a bounded queue until the thread takes it. Every ``FLUSH`` seconds the thread
ends the chunk and hands it to the kernel, so a killed process loses no more than that; every
``SYNC`` seconds the file is synced, so a power cut loses no more than that.
"""
from collections import deque
from collections.abc import Callable, Mapping, Sequence
import contextlib
import os
from pathlib import Path
import shutil
import threading
import time
from typing import NamedTuple

from fourbar_ros.bag import metadata
from fourbar_ros.bag.metadata import Channel, FileContent, TopicCount
from fourbar_ros.errors import BagError, NameTaken
from mcap.writer import Writer
import zstandard  # noqa: F401    chunks need it, and mcap hides that it is missing

FLUSH, SYNC, LOOK = 0.1, 1.0, 1.0       # [s]; LOOK: at the free space and at the file
ROOM = 32 * 2**20                       # [bytes] of free disk below which a bag is finished
NO_ROOM = f'less than {ROOM >> 20} MiB free'
LEFT = 'what was flushed is in the file: fourbar bag recover'
MOST_MESSAGES, MOST_BYTES = 100_000, 128 * 2**20    # that may wait; then the newest are dropped
MOST_FILES = 100    # that may wait for the disk, open, after a split
BITE = 50           # messages after which the thread lets others run
SPLIT = 'split'     # why a file ended: another one follows


class _Waiting(NamedTuple):
    """A message in the queue: channel (from 0), sequence number, log time [ns], bytes."""

    channel: int
    sequence: int
    time: int
    data: bytes


class BagWriter:
    """
    One bag being written; :meth:`write` from any thread, :meth:`close` when done.

    The bag is directory/name; an empty name takes a fresh one from the clock. Raises BagError if
    the name is taken or leaves the directory, or if that cannot be written: an existing bag is
    never touched. ``about`` is kept as custom_data. Beyond ``split_size`` bytes or
    ``split_duration`` seconds (0: never) the bag goes on in a new file. ``tell`` gets a line of
    text when recording stops by itself and when messages are first dropped; ``clock`` returns the
    log time [ns], by default one that never goes back.

    ``path``: the folder of the bag. ``accepted``, ``dropped``: messages that are or will be in the
    bag, and that found the queue full, which leaves gaps in the sequence numbers of channels.
    ``error``: why recording stopped by itself; empty while it goes on.
    """

    def __init__(self, directory: str | os.PathLike[str], name: str, channels: Sequence[Channel],
                 about: Mapping[str, object], split_size: float = 0.0,
                 split_duration: float = 0.0, tell: Callable[[str], object] | None = None,
                 clock: Callable[[], int] | None = None) -> None:
        """Make the folder of a bag, its first file, and the threads that write and sync it."""
        offset = time.time_ns() - time.monotonic_ns()
        self.clock = clock or (lambda: offset + time.monotonic_ns())
        self.path = Path(directory) / (metadata.checked_name(name) or metadata.fresh_name())
        self.accepted = self.dropped = 0
        self.error = ''
        self._channels, self._tell = channels, tell or (lambda text: None)
        self._about = {str(key): str(value) for key, value in about.items()}
        self._split_size, self._split_duration = split_size, split_duration
        self._sequence = [0] * len(channels)        # next sequence numbers; dropped messages count
        self._queue: deque[_Waiting | tuple[str, str]] = deque()    # the tuples: of note()
        self._bytes_in = self._bytes_out = 0        # each is changed by one thread alone
        self._lock, self._is_closed = threading.Lock(), threading.Event()
        self._is_taking = True
        self._before: list[FileContent] = []        # the files that are finished
        self._ended: deque[BagFile] = deque()       # finished files that are not synced yet
        self._syncing = threading.Lock()
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self.path.mkdir()
        except FileExistsError as error:
            kind = NameTaken if os.path.lexists(self.path) else BagError    # or its folder is none
            raise kind(f'{error.filename}: exists already; recordings never overwrite') from None
        except OSError as error:
            raise BagError(f'{self.path}: {error.strerror}') from None
        try:
            if shutil.disk_usage(self.path).free < ROOM:
                raise BagError(NO_ROOM)
            self._file = BagFile(self.path, 0, self._channels, self._about)
            self._write_metadata()
        except (OSError, BagError) as error:        # then nothing is left behind
            shutil.rmtree(self.path)
            raise BagError(f'{self.path}: {getattr(error, "strerror", None) or error}') from None
        self._threads = [threading.Thread(target=job, name=title, daemon=True)
                         for title, job in (('bag', self._run), ('bag sync', self._keep_synced))]
        for thread in self._threads:
            thread.start()

    @property
    def waiting(self) -> int:
        return len(self._queue)

    def write(self, channel: int, data: bytes | bytearray | memoryview) -> bool:
        """Take one serialised message of a channel (an index), as :meth:`write_all`."""
        return self.write_all([(channel, bytes(data))])     # a copy: the caller may reuse it

    def write_all(self, messages: Sequence[tuple[int, bytes]]) -> bool:
        """
        Take the messages (index of the channel, bytes) of one step, or drop them all.

        The call never waits and checks no argument: a node calls it at every step. Return whether
        the messages were taken: not if the queue is full, recording has stopped by an error, or
        the bag is closed.
        """
        with self._lock:
            if not self._is_taking:
                return False
            now = self.clock()
            waiting = []
            for channel, data in messages:
                waiting.append(_Waiting(channel, self._sequence[channel], now, data))
                self._sequence[channel] = (self._sequence[channel] + 1) & 0xFFFFFFFF    # 32 bits
            size = sum(len(data) for _, data in messages)
            is_full = (len(self._queue) + len(messages) > MOST_MESSAGES
                       or self._bytes_in - self._bytes_out + size > MOST_BYTES)
            is_first = is_full and not self.dropped
            if is_full:
                self.dropped += len(messages)
            else:
                self.accepted += len(messages)
                self._bytes_in += size
                self._queue.extend(waiting)
        if is_first:
            self._tell(f'{self.path}: the disk is too slow, messages are dropped')
        return not is_full

    def note(self, key: str, text: str) -> None:
        """Let the files that follow keep another text under a key of ``about``."""
        self._queue.append((key, text))

    def close(self, why: str = 'stopped') -> Path:
        """Write what waits, finish the file with ``why`` in it; return the path, or BagError."""
        with self._lock:
            is_first = not self._is_closed.is_set()
            self._is_taking = False
            self._is_closed.set()
        for thread in self._threads:
            thread.join()
        if is_first and not self.error:
            self._guarded(lambda: self._finish(why))
        for file in (*self._ended, self._file):
            file.stream.close()
        if self.error:
            raise BagError(f'{self.path}: {self.error}')
        return self.path

    # --- in the threads -------------------------------------------------------------------------

    def _run(self) -> None:
        looked = time.monotonic()
        while not self._is_closed.wait(FLUSH) and not self.error:
            self._guarded(self._flush)
            if time.monotonic() - looked >= LOOK and not self.error:
                looked = time.monotonic()
                self._guarded(self._look)

    def _keep_synced(self) -> None:
        while not self._is_closed.wait(SYNC) and not self.error:
            try:
                self._sync()
            except OSError as error:
                self._give_up(f'{error}; {LEFT}')

    def _sync(self) -> None:
        """Wait until the disk has all that was flushed; close the files that a split has ended."""
        with self._syncing:
            while self._ended:
                file = self._ended[0]
                os.fsync(file.stream.fileno())
                file.stream.close()
                self._ended.popleft()
            os.fsync(self._file.stream.fileno())

    def _flush(self) -> None:
        """Write what waits in the queue as a chunk; go on in a new file where one is due."""
        is_first = self._file.span is None
        for index in range(len(self._queue)):
            item = self._queue.popleft()
            if not isinstance(item, _Waiting):
                self._about[item[0]] = item[1]
                continue
            file, now = self._file, item.time       # a step is not torn, and close() waits
            if file.span and file.span[1] != now and not self._is_closed.is_set() and (
                    self._split_size and file.size > self._split_size
                    or self._split_duration and now - file.span[0] >= self._split_duration * 1e9):
                file.about['dropped'] = str(self.dropped)
                file.finish(SPLIT)
                self._before.append(file.content())
                self._file = BagFile(self.path, len(self._before), self._channels, self._about)
                self._ended.append(file)            # the thread that syncs waits for the disk
                self._write_metadata()
                if len(self._ended) > MOST_FILES:   # the disk is slower than the splits
                    self._sync()
            self._file.add(item)
            self._bytes_out += len(item.data)
            if index % BITE == 0:
                time.sleep(0.0)
        self._file.flush()
        if is_first and self._file.span:        # rosbag2 plays from the start in metadata.yaml
            self._write_metadata()

    def _finish(self, why: str) -> None:
        self._flush()
        self._file.about['dropped'] = str(self.dropped)
        self._file.finish(why)
        self._sync()
        self._write_metadata()

    def _write_metadata(self) -> None:
        metadata.write(self.path, metadata.of_files([*self._before, self._file.content()]))

    def _look(self) -> None:
        """Give up if the file is gone; finish the bag if the disk is nearly full."""
        try:
            there = os.stat(self._file.path)
        except FileNotFoundError:
            there = None
        if not there or not os.path.samestat(there, os.fstat(self._file.stream.fileno())):
            self._give_up('its file was removed or replaced')
        elif shutil.disk_usage(self.path).free < ROOM:
            with self._lock:
                self._is_taking = False
            self._finish(NO_ROOM)
            self._give_up(f'{NO_ROOM}; the bag is whole, {self.accepted} messages')

    def _guarded(self, action: Callable[[], object]) -> None:
        """Run an action on the file; after an error the file ends with the last whole chunk."""
        try:
            action()
        except Exception as error:      # of any kind: the thread must not end without a word
            self._file.cut()
            self._give_up(f'{getattr(error, "strerror", None) or repr(error)}; {LEFT}')

    def _give_up(self, why: str) -> None:
        with self._lock:
            is_first, self.error = not self.error, self.error or f'recording stopped: {why}'
            self._is_taking = False
        if is_first:
            self._tell(f'{self.path}: {self.error}')


class _Unbuffered:
    """A stream without a buffer: after a failed write no rest waits to be written later."""

    def __init__(self, path: Path) -> None:
        self._file = open(path, 'xb', buffering=0)
        self.tell, self.fileno, self.close = self._file.tell, self._file.fileno, self._file.close

    def write(self, data: bytes) -> None:
        """Write all bytes or raise OSError."""
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest):]

    def flush(self) -> None:
        """Do nothing: all is written."""


class BagFile:
    """One file of a bag being written: ``size`` [bytes], ``span`` of log times [ns], or None."""

    def __init__(self, folder: Path, index: int, channels: Sequence[Channel],
                 about: Mapping[str, str]) -> None:
        """Begin NAME_INDEX.mcap in the folder NAME, with all channels and no message yet."""
        self.path = folder / f'{folder.name}_{index}.mcap'
        self.stream = _Unbuffered(self.path)
        self.about, self._channels = dict(about), channels
        self._counts, self._pending = [0] * len(channels), 0
        self.span: tuple[int, int] | None = None
        self._writer = Writer(self.stream, enable_data_crcs=True)
        self._writer.start('ros2', 'fourbar_ros')
        self._ids = [self._writer.register_channel(
            channel.topic, 'cdr', self._writer.register_schema(
                channel.type, 'ros2msg', channel.schema.encode()), channel.metadata)
            for channel in channels]
        self._describe()

    @property
    def size(self) -> int:
        """Return the size of the file with what is not flushed yet, uncompressed [bytes]."""
        return self._whole + self._pending

    def add(self, message: _Waiting) -> None:
        """Add a message to the chunk that the next :meth:`flush` writes."""
        time = message.time
        self._writer.add_message(self._ids[message.channel], time, message.data, time,
                                 message.sequence)
        self._counts[message.channel] += 1
        self._pending += len(message.data)
        self.span = (self.span or (time, time))[0], time

    def flush(self) -> None:
        self._writer.flush()
        self._whole, self._pending = self.stream.tell(), 0

    def finish(self, why: str) -> None:
        """Write the end of the file, which says why the file ended."""
        self.about['ended'] = why
        self._describe()
        self._writer.finish()
        self._whole = self.stream.tell()

    def cut(self) -> None:
        with contextlib.suppress(OSError):
            os.ftruncate(self.stream.fileno(), self._whole)

    def content(self) -> FileContent:
        return FileContent(self.path.name, [
            TopicCount(channel.topic, channel.type, 'cdr', channel.metadata, count)
            for channel, count in zip(self._channels, self._counts)], self.span, self.about)

    def _describe(self) -> None:
        text = metadata.dumped(metadata.of_files([self.content()]))
        self._writer.add_metadata(metadata.RECORD, {metadata.KEY: text})
        self._whole = self.stream.tell()
