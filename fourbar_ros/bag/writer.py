"""
Write a rosbag2 bag: directory NAME with NAME_0.mcap and metadata.yaml (version 9, as Jazzy writes it).

The caller hands over serialised messages and is never held up by the disk: they wait in a bounded
queue, a thread takes them to the file and flushes it every ``flush_period``. After a crash the file
holds everything older than that.
"""
from __future__ import annotations

import os
import threading
import time
from collections import deque
from pathlib import Path
from typing import NamedTuple

import yaml
from mcap import __version__ as mcap_version
from mcap.writer import CompressionType, Writer

from .. import __version__
from ..core import FourBarError

FLUSH_PERIOD = 0.1          # [s]
QUEUE_LIMIT = 100_000       # messages; more than that and the newest are dropped and counted
METADATA_VERSION = 9
NOT_STARTED = 2**63 - 1     # rosbag2's starting time of a bag without messages


class BagError(FourBarError):
    """A bag cannot be written or read; the message says which and why."""


class Channel(NamedTuple):
    """A recorded topic: absolute name, type, schema text, type hash and (depth, reliability, durability)."""

    topic: str
    type: str
    schema: str
    hash: str
    depth: int
    reliable: bool = True

    @property
    def qos(self):
        """Return the QoS profile in rosbag2's words."""
        endless = {'sec': 9223372036, 'nsec': 854775807}
        return {'history': 'keep_last', 'depth': self.depth,
                'reliability': 'reliable' if self.reliable else 'best_effort', 'durability': 'volatile',
                'deadline': endless, 'lifespan': endless, 'liveliness': 'automatic',
                'liveliness_lease_duration': endless, 'avoid_ros_namespace_conventions': False}


class SteadyClock:
    """Nanoseconds of the wall clock that never step back: its time at the start plus a monotonic one."""

    def __init__(self):
        self._offset = time.time_ns() - time.monotonic_ns()

    def now(self):
        """Return the time [ns]."""
        return self._offset + time.monotonic_ns()


class BagWriter:
    """
    One bag being written; :meth:`write` from any one thread, :meth:`close` when done.

    Parameters
    ----------
    directory, name : str
        The bag is directory/name; an empty name takes a fresh one from the clock. An existing bag is
        never touched.
    channels : list of Channel
    about : dict of str
        Kept with the bag (custom_data), so that it explains itself.

    Raises
    ------
    BagError
        The name is taken or leaves the directory, or the directory cannot be written.

    """

    def __init__(self, directory, name, channels, about):
        self.clock = SteadyClock()
        self.path, self._file = _create(Path(directory), name)
        self._channels, self._about = channels, {str(k): str(v) for k, v in about.items()}
        self._counts = [0] * len(channels)
        self._start, self._end = NOT_STARTED, 0
        self._queue = deque()
        self.dropped = 0
        self.error = None
        self._stop = threading.Event()
        self._writer = Writer(self._file, compression=CompressionType.ZSTD, enable_data_crcs=True)
        self._writer.start('ros2', f'fourbar_ros {__version__}, mcap {mcap_version}')
        self._ids = [self._register(channel) for channel in channels]
        self._write_metadata_record()
        self._writer.flush()
        self._write_metadata_file()
        self._thread = threading.Thread(target=self._run, name='bag', daemon=True)
        self._thread.start()

    def write(self, channel, data):
        """Take the bytes of one message of the channel of this number; returns at once."""
        if len(self._queue) >= QUEUE_LIMIT or self.error:
            self.dropped += 1
            return
        self._queue.append((channel, self.clock.now(), data))

    def close(self):
        """Write what waits, finish the file and its metadata; returns the path of the bag."""
        self._stop.set()
        self._thread.join()
        self._guard(self._finish)
        self._file.close()
        if self.error:
            raise BagError(f'{self.path}: {self.error}')
        return self.path

    # --- in the thread --------------------------------------------------------------------------

    def _run(self):
        while not self._stop.wait(FLUSH_PERIOD):
            self._guard(self._drain)

    def _guard(self, action):
        """Run an action; after a first error (disk full, ...) the file is left as it is."""
        if not self.error:
            try:
                action()
            except Exception as error:      # of any kind: the stream must go on, the file must not
                self.error = f'recording stopped: {error}'

    def _drain(self):
        while self._queue:
            channel, stamp, data = self._queue.popleft()
            self._writer.add_message(self._ids[channel], stamp, data, stamp, self._counts[channel])
            self._counts[channel] += 1
            self._start, self._end = min(self._start, stamp), max(self._end, stamp)
        self._writer.flush()

    def _finish(self):
        self._drain()
        self._write_metadata_record()
        self._writer.finish()
        self._file.flush()
        self._write_metadata_file()

    # --- what rosbag2 wants to know -------------------------------------------------------------

    def _register(self, channel):
        schema = self._writer.register_schema(channel.type, 'ros2msg', channel.schema.encode())
        return self._writer.register_channel(channel.topic, 'cdr', schema, {
            'offered_qos_profiles': yaml.safe_dump([channel.qos], sort_keys=False),
            'topic_type_hash': channel.hash})

    def metadata(self):
        """Return the metadata as rosbag2 of Jazzy writes it."""
        started = self._start != NOT_STARTED
        duration = {'nanoseconds': self._end - self._start if started else 0}
        begin = {'nanoseconds_since_epoch': self._start}
        count, name = sum(self._counts), f'{self.path.name}_0.mcap'
        return {
            'version': METADATA_VERSION, 'storage_identifier': 'mcap', 'duration': duration,
            'starting_time': begin, 'message_count': count,
            'topics_with_message_count': [
                {'topic_metadata': {'name': channel.topic, 'type': channel.type,
                                    'serialization_format': 'cdr', 'offered_qos_profiles': [channel.qos],
                                    'type_description_hash': channel.hash},
                 'message_count': number} for channel, number in zip(self._channels, self._counts)],
            'compression_format': '', 'compression_mode': '',
            'relative_file_paths': [name],
            'files': [{'path': name, 'starting_time': begin, 'duration': duration,
                       'message_count': count}],
            'custom_data': self._about, 'ros_distro': os.environ.get('ROS_DISTRO', 'jazzy'),
        }

    def _write_metadata_record(self):
        text = yaml.dump(self.metadata(), Dumper=_NoAliases, sort_keys=False)
        self._writer.add_metadata('rosbag2', {'serialized_metadata': text})

    def _write_metadata_file(self):
        text = yaml.dump({'rosbag2_bagfile_information': self.metadata()}, Dumper=_NoAliases, sort_keys=False)
        part = self.path / 'metadata.yaml.part'
        part.write_text(text)
        part.replace(self.path / 'metadata.yaml')


class _NoAliases(yaml.SafeDumper):
    def ignore_aliases(self, data):
        return True


def _create(directory, name):
    """Make the bag's folder and file, both new; returns (path, open file)."""
    name = name or time.strftime('fourbar_%Y_%m_%d-%H_%M_%S') + f'_{time.time_ns() % 10**9 // 10**6:03d}'
    if name in ('.', '..') or '/' in name or '\0' in name:
        raise BagError(f'bag name {name!r}: must be a plain name inside the recording directory')
    path = directory / name
    try:
        directory.mkdir(parents=True, exist_ok=True)
        path.mkdir()
        return path, open(path / f'{name}_0.mcap', 'xb')
    except FileExistsError:
        raise BagError(f'{path}: exists already; recordings never overwrite') from None
    except OSError as error:
        raise BagError(f'{path}: {error.strerror}') from None
