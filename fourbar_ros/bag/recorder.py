"""
Write a rosbag2 bag while it happens: directory NAME with NAME_0.mcap and metadata.yaml.

The caller hands over serialised messages and is never held up by the disk: they wait in a bounded
queue, a thread takes them to the file and flushes it every ``flush_period``. After a crash of the
process the file holds everything older than that, after a power cut everything older than
``sync_period``.
"""
from __future__ import annotations

from collections import deque
import contextlib
import json
import os
import shutil
import threading
import time

from fourbar_ros import __version__
from fourbar_ros.bag.splitting import Split, Splitter
from fourbar_ros.errors import BagError
from fourbar_ros.formats import rosbag2
from fourbar_ros.formats.mcap_records import OURS
from fourbar_ros.formats.mcap_scan import mark_as_being_written
from fourbar_ros.formats.mcap_writer import Container
from fourbar_ros.formats.rosbag2 import Channel
from mcap import __version__ as mcap_version

__all__ = ['BagError', 'BagWriter', 'Channel', 'Split', 'SteadyClock']

# [s] A kill costs what was recorded since the last flush, so this bounds it; half of it is the
# mean.
FLUSH_PERIOD = 0.1
# [s] A robot's off switch is a power cut, and the kernel may keep data for 30 s. The sync has a
# thread of
# its own, so a slow disk delays neither the flush nor the caller. 0: never.
SYNC_PERIOD = 1.0
# The thread takes so many messages at a time: a bite holds the interpreter, and with it the thread
# that drives
# the crank, for less than a microsecond a message.
BITE = 50
SPACE_PERIOD = 1.0          # [s] between two looks at the free space
SPACE_LEFT = 32 * 2**20     # [bytes] a bag is closed while its end still fits on the disk
# more than that, or more bytes, waits for no disk: the newest are dropped
QUEUE_MESSAGES = 100_000
QUEUE_BYTES = 128 * 2**20
SPLIT = 'split'             # why a part ended that another one follows
CDR_HEADER = 4              # [bytes] the shortest message


class SteadyClock:
    """
    Nanoseconds of the wall clock that never step back: its time at the start plus a monotonic
    one.
    """

    def __init__(self):
        self._offset = time.time_ns() - time.monotonic_ns()

    def now(self):
        """Return the time [ns]."""
        return self._offset + time.monotonic_ns()


class BagWriter:
    """
    One bag being written; :meth:`write` from any thread, :meth:`close` when done.

    Parameters
    ----------
    directory, name : str
        The bag is directory/name; an empty name takes a fresh one from the clock. An existing bag
        is
        never touched.
    channels : list of Channel
    about : dict of str
        Kept with the bag (custom_data), so that it explains itself.
    flush_period, sync_period : float
        What a crash and what a power cut may cost at most [s].
    split : Split, optional
        When the bag goes on in a new file, and whether old ones are removed.
    tell : callable, optional
        Called with one line of text when recording stops by itself and when messages are first
        dropped.

    Attributes
    ----------
    path : Path
        The folder of the bag.
    accepted, dropped : int
        Messages that are or will be in the bag, and those that found the queue full or the disk
        refused.
        Each dropped one leaves a gap in the sequence numbers of its channel; the bag tells how
        many numbers
        were given, so that a gap at its end is seen too.
    error : str or None
        Why recording has stopped by itself; later messages are not accepted.

    Raises
    ------
    BagError
        The name is taken or leaves the directory, the directory cannot be written, or an argument
        is bad.

    """

    def __init__(
    self,
    directory,
    name,
    channels,
    about,
    flush_period=FLUSH_PERIOD,
    sync_period=SYNC_PERIOD,
    tell=None,
     split=Split()):
        rosbag2.check_channels(channels)
        if not flush_period > 0.0 or not sync_period >= 0.0:
            raise BagError(f'flush_period = {flush_period!r}, sync_period = {sync_period!r}: '
                           'must be positive, and not negative')
        self.clock = SteadyClock()
        self.accepted, self.dropped, self.error = 0, 0, None
        self.flush_period, self.sync_period, self._tell = flush_period, sync_period, tell or (
            lambda text: None)
        self._about = {str(key): str(value) for key, value in about.items()}
        self._channels, self._topics = channels, [channel.topic for channel in channels]
        self._sequences = [0] * len(channels)          # next number of every channel
        self._splitter = Splitter(split, {i for i, channel in enumerate(
            channels) if channel.latched}) if split.is_wanted else None
        # Of the part that is written: first numbers, messages that it repeats;
        # metadata of those before; files to sync.
        self._firsts, self._repeats, self._done, self._unsynced = [
            0] * len(channels), [], [], deque()
        # messages in the parts before; dropped ones by topic
        self._recorded, self._lost = 0, {}
        self._ended = ''
        self._queue, self._lock = deque(), threading.Lock()
        self._bytes_in = self._bytes_out = 0           # each changed by one side of the queue only
        self._taken_in = self._taken_out = 0           # messages, likewise
        self._closed, self._sync_error, self._stop = False, None, threading.Event()
        self.path, self._file = rosbag2.create(directory, name)
        self._file_path = self.path / f'{self.path.name}_0.mcap'
        try:
            if shutil.disk_usage(self.path).free < SPACE_LEFT:
                raise BagError(f'less than {SPACE_LEFT >> 20} MiB free')
            self._container = self._new_container(self._file)
            self._describe()
            self._write_metadata_file()
        except (OSError, BagError) as error:
            self._file.close()
            shutil.rmtree(self.path)
            raise BagError(f'{self.path}: {getattr(error, "strerror", None) or error}') from None
        self._threads = [threading.Thread(target=self._run, name='bag', daemon=True)]
        if sync_period > 0.0:
            self._threads.append(
    threading.Thread(
        target=self._keep_synced,
        name='bag sync',
         daemon=True))
        for thread in self._threads:
            thread.start()

    def write(self, channel, data):
        """
        Take the bytes of one serialised message of the channel of this number; returns at once.

        Returns
        -------
        accepted : bool
            False if the queue is full, recording has stopped by an error, or the bag is closed.

        Raises
        ------
        BagError
            For an argument that would spoil the file; the bag is not touched by it.

        """
        if type(channel) is not int or not 0 <= channel < len(self._sequences):
            raise BagError(
                f'channel {channel!r}: must be a number from 0 to {len(self._sequences) - 1}')
        if type(data) is not bytes:
            if not isinstance(data, (bytearray, memoryview)):
                raise BagError(
                    f'data of type {type(data).__name__}: must be the bytes of a message')
            data = bytes(data)                          # its owner may change it
        if len(data) < CDR_HEADER:
            raise BagError(f'data of {len(data)} bytes: a message has at least {CDR_HEADER}')
        return self.write_all([(channel, data)])

    def write_all(self, messages):
        """
        Take messages, (channel, bytes), of one step, or drop them all; arguments are trusted,
        else as write.
        """
        count, size, sequences = len(messages), 0, self._sequences
        with self._lock:
            if self._closed or self.error:
                return False
            numbered = []
            for channel, data in messages:
                sequence = sequences[channel]
                sequences[channel] = sequence + 1
                numbered.append((channel + 1, sequence & 0xFFFFFFFF, data))
                size += len(data)
            full = (self._taken_in - self._taken_out >= QUEUE_MESSAGES
                    or self._bytes_in - self._bytes_out + size > QUEUE_BYTES)
            is_first = full and not self.dropped
            if full:
                self.dropped += count
            else:
                self._bytes_in += size
                self._taken_in += count
                self.accepted += count
                self._queue.append((self.clock.now(), size, numbered))
        if is_first:
            self._tell(f'{self.path}: the disk is too slow, messages are dropped')
        return not full

    @property
    def waiting(self):
        """Return how many messages wait for the disk."""
        return self._taken_in - self._taken_out

    def close(self, why='stopped'):
        """
        Write what waits, finish the file and its metadata, which say why; returns the path of
        the bag.
        """
        with self._lock:
            first, self._closed = not self._closed, True
        self._stop.set()
        for thread in self._threads:
            thread.join()
        if first:
            self._guard(self._sync_parts)
            self._guard(lambda: self._finish(why))
            for file in (*self._unsynced, self._file):
                file.close()
        if self.error:
            raise BagError(f'{self.path}: {self.error}')
        return self.path

    # --- in the thread --------------------------------------------------------------------------

    def _run(self):
        now = flushed = looked = time.monotonic()
        period = min(FLUSH_PERIOD, self.flush_period)
        while not self._stop.wait(max(0.0, now + period - time.monotonic())) and not self.error:
            now = time.monotonic()
            self._guard(self._drain)
            if now - flushed >= self.flush_period - 0.5 * period:
                flushed = now
                self._guard(self._flush)
            if now - looked >= SPACE_PERIOD:
                looked = now
                self._guard(self._look_at_the_disk)

    def _guard(self, action):
        """Run an action; after a first error nothing more goes into the file than its end."""
        if self.error:
            return
        try:
            action()
        except Exception as error:      # of any kind: the stream must go on
            self._give_up(self._gone() or getattr(error, 'strerror', None) or str(error))

    def _give_up(self, why):
        # a write that is under way still counts; later ones see the error
        with self._lock:
            self.error, self._ended = f'recording stopped: {why}', why
        self._queue.clear()
        try:
            with contextlib.suppress(OSError):         # what it does not take is gone
                self._container.flush()
            self._count()
            self._end()
            if self._has_a_name():
                self.error += f'; the bag is whole, {self.accepted} messages'
        except Exception:               # the disk takes nothing more
            self._count()
            if self._has_a_name():
                self.error += '; what was flushed is in the file: fourbar bag recover'
            with contextlib.suppress(OSError):         # there may be room for the reason
                self._write_metadata_file()
        self._tell(f'{self.path}: {self.error}')

    def _has_a_name(self):
        return os.fstat(self._file.fileno()).st_nlink > 0

    def _count(self):
        """Take for recorded what is in the file, for dropped all others."""
        self.accepted = self._recorded + sum(self._container.counts.values()) - len(self._repeats)
        self.dropped = sum(self._sequences) - self.accepted

    def _drain(self):
        queue, bite = self._queue, 0
        add = self._add_and_split if self._splitter else self._container.add_messages
        for _ in range(len(queue)):          # messages that come meanwhile wait for the next flush
            stamp, size, messages = queue.popleft()
            add(stamp, messages)
            self._bytes_out += size
            self._taken_out += len(messages)
            bite += len(messages)
            if bite >= BITE:
                bite = 0
                time.sleep(0.0)                        # whoever waits for the interpreter gets it

    def _add_and_split(self, stamp, messages):
        """Add messages of a step, in a new part if one is due."""
        for message in messages:
            number, sequence, data = message
            if self._splitter.is_due(number - 1, stamp, self._container.size):
                self._next_part(stamp)
            self._splitter.note(number - 1, sequence, stamp, data)
            self._container.add_messages(stamp, (message,))

    def _next_part(self, stamp):
        """
        End this file and go on in a new one, which begins with what is needed to read it
        alone.
        """
        self._container.flush()
        path, file = rosbag2.create_part(self.path, self._splitter.number + 1)
        try:
            container = self._new_container(file)
            self._ended = SPLIT
            self._describe()
            told, nexts = self._metadata(), self._nexts()
            self._container.finish()
        except Exception:
            file.close()
            path.unlink()
            raise
        finally:
            self._ended = ''
        self._lost = self._dropped(nexts)
        self._recorded += sum(self._container.counts.values()) - len(self._repeats)
        self._unsynced.append(self._file)
        self._done.append(told)
        self._container, self._file, self._file_path, self._firsts = container, file, path, nexts
        self._splitter.begin(stamp)
        self._repeats = self._splitter.repeats()
        self._describe()
        for channel, sequence, first_time, data in self._repeats:
            container.add_message(channel + 1, sequence, stamp, data, first_time)
        if self.sync_period == 0.0:
            self._sync_parts()
        self._forget_outdated(stamp)

    def _forget_outdated(self, stamp):
        """Write metadata.yaml; remove the parts that are not needed any more."""
        starts = [told['starting_time']['nanoseconds_since_epoch'] for told in self._done]
        old = self._splitter.outdated([*starts, stamp])
        gone, self._done = self._done[:old], self._done[old:]
        self._write_metadata_file()
        for told in gone:
            with contextlib.suppress(FileNotFoundError):
                (self.path / told['relative_file_paths'][0]).unlink()

    def _sync_parts(self):
        """Bring finished parts to the disk and close them."""
        while self._unsynced:
            if self.sync_period > 0.0:
                os.fsync(self._unsynced[0].fileno())
                sync_folders(self.path)
            self._unsynced.popleft().close()

    def _flush(self):
        before = self._container.start
        self._container.flush()
        # rosbag2 plays from the start that stands there
        if before != self._container.start:
            self._write_metadata_file()

    def _look_at_the_disk(self):
        if self._sync_error:
            raise self._sync_error
        why = self._gone()
        if not why and shutil.disk_usage(self.path).free < SPACE_LEFT:
            why = f'less than {SPACE_LEFT >> 20} MiB free'
        if why:
            self._drain()
            self._container.flush()
            raise BagError(why)

    def _gone(self):
        """Return what became of the file, empty if it is where it was made."""
        with contextlib.suppress(OSError):
            if os.path.samestat(os.stat(self._file_path), os.fstat(self._file.fileno())):
                return ''
        return f'{self._file_path.name} was moved, replaced or removed'

    def _finish(self, why):
        self._drain()
        self._container.flush()
        self._ended = why
        self._end()

    def _end(self):
        """Write the last metadata, the end of the file, metadata.yaml."""
        self._describe()
        self._container.finish()
        if self.sync_period > 0.0:
            os.fsync(self._file.fileno())
        self._write_metadata_file()

    def _keep_synced(self):
        synced = 0
        try:
            sync_folders(self.path)
            while not self._stop.wait(self.sync_period) and not self.error:
                self._sync_parts()
                if synced != self._container.size:
                    synced = self._container.size
                    os.fdatasync(self._file.fileno())
        except OSError as error:
            self._sync_error = error                   # the other thread acts on it

    def _metadata(self):
        return rosbag2.describe(
    self._file_path.name, self._container, {
        **self._about, **self._numbers()})

    def _write_metadata_file(self):
        rosbag2.write_metadata_file(self.path, rosbag2.merged([*self._done, self._metadata()]))

    def _numbers(self):
        """Return the entries of custom_data about sequence numbers and the end, if any."""
        told = {}
        if self._done:
            told[rosbag2.REPEATS] = json.dumps([self._topics[channel]
                                               for channel, *_ in self._repeats])
        if not self._ended:
            return {**told,
    rosbag2.NUMBERS: json.dumps({topic: (first,
    None) for topic,
    first in zip( self._topics,
     self._firsts)})}
        given = self._nexts()
        told |= {rosbag2.ENDED: self._ended,
                 rosbag2.NUMBERS: json.dumps(dict(zip(self._topics, zip(self._firsts, given))))}
        dropped = self._dropped(given)
        return {**told, rosbag2.DROPPED: json.dumps(dropped)} if dropped else told

    def _nexts(self):
        """Return the next number of every channel: behind this part, or behind the whole bag."""
        if self._ended != SPLIT:
            return list(self._sequences)
        last = self._container.last
        return [last.get(i, first - 1) + 1 for i, first in enumerate(self._firsts, 1)]

    def _dropped(self, nexts):
        """
        Return {topic: how many messages were dropped} up to these numbers, in the parts before
        as well.
        """
        counts, repeated = self._container.counts, {channel for channel, *_ in self._repeats}
        found = {topic: self._lost.get(topic,
    0) + after - first - counts.get(i + 1,
    0) + (i in repeated) for i,
    (topic,
    first,
    after) in enumerate(zip(self._topics,
    self._firsts,
     nexts))}
        return {topic: count for topic, count in found.items() if count}

    def _describe(self):
        self._container.add_metadata(
    rosbag2.RECORD, {
        rosbag2.KEY: rosbag2.dumped(
            self._metadata())})

    def _new_container(self, file):
        mark_as_being_written(file)
        container = Container(file, 'ros2', f'{OURS}{__version__}, mcap {mcap_version}')
        numbers = {}
        for channel in self._channels:
            if channel.type not in numbers:
                numbers[channel.type] = container.add_schema(channel.type, channel.schema)
            container.add_channel(channel.topic, numbers[channel.type], channel.metadata)
        return container


def sync_folders(path):
    """
    Bring the entries of a new folder and its parent to the disk: a file without a name is
    lost.
    """
    for folder in (path, path.parent):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
