# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The files of a bag being written, one after the other.

A bag may go on in a new file (a part). Each part can be read alone, so it begins with the newest
scene and other earlier messages. Old parts may be removed.
"""
from __future__ import annotations

from collections import deque
from collections.abc import Collection, Sequence
import contextlib
import json
import os
from pathlib import Path
from typing import BinaryIO, NamedTuple

from fourbar_ros import __version__
from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.file_system import mark_as_being_written, sync_folders
from fourbar_ros.bag.mcap.records import OURS
from fourbar_ros.bag.mcap.writer import Container
from fourbar_ros.bag.rosbag2 import Channel, SPLIT
from fourbar_ros.bag.yaml_text import dumped, YamlMap
from mcap import __version__ as mcap_version

SHARE = 10      # a bag that keeps the newest seconds has so many parts, unless split otherwise


class Parts:
    """
    The open file of a bag and the files before it; a bag that is not split has one.

    ``file`` is the first one, new and unbuffered; ``about``: custom_data of every part;
    ``given``: the next sequence number of every channel, which its owner changes;
    ``is_synced``: finished parts are synced to the disk before they are closed.

    Attributes
    ----------
    file, container : binary file, Container
        The newest part.
    ended : str
        Why the newest part ended; empty while it is open.

    """

    def __init__(self, folder: Path, file: BinaryIO, channels: list[Channel],
                 about: dict[str, str], given: Sequence[int], split: Split, is_synced: bool):
        """Begin the first part: its definitions, its metadata and metadata.yaml."""
        self.folder, self.file, self.ended = folder, file, ''
        self._path = folder / f'{folder.name}_0.mcap'
        self._channels, self._topics = channels, [channel.topic for channel in channels]
        self._about, self._given, self._syncs = about, given, is_synced
        latched = {i for i, channel in enumerate(channels) if channel.latched}
        self._splitter = Splitter(split, latched) if split.is_wanted else None
        # of this part: the first sequence number of each channel, messages that it repeats
        self._firsts = [0] * len(channels)
        self._repeats: list[Message] = []
        # of the parts before: metadata, files to sync, counts of messages
        self._metadata_before: list[YamlMap] = []
        self._unsynced: deque[BinaryIO] = deque()
        self._recorded_before = 0
        self._dropped_before: dict[str, int] = {}          # by topic
        self.container = self._new_container(file)
        self._describe()
        self.write_metadata_file()

    @property
    def recorded(self) -> int:
        """Return how many messages are in the files, repeated ones counted once."""
        return self._recorded_before + sum(self.container.counts.values()) - len(self._repeats)

    def add(self, time: int, messages: list[tuple[int, int, bytes]]) -> None:
        """
        Add messages of one log time [ns], in a new part if one is due.

        A message is (number of the channel in the file, from 1, sequence number, bytes).
        """
        if self._splitter is None:
            self.container.add_messages(time, messages)
            return
        for number, sequence, data in messages:
            if self._splitter.is_due(number - 1, time, self.container.size):
                self._next_part(time, self._splitter)
            self._splitter.note(Message(number - 1, sequence, time, data))
            self.container.add_message(number, sequence, time, data)

    def flush(self) -> None:
        """Write the added messages; metadata.yaml gets a new start, from which rosbag2 plays."""
        before = self.container.start
        self.container.flush()
        if before != self.container.start:
            self.write_metadata_file()

    def end(self, why: str) -> None:
        """Finish the newest file and metadata.yaml; both say why recording ended."""
        self.ended = why
        self._describe()
        self.container.finish()
        if self._syncs:
            os.fsync(self.file.fileno())
        self.write_metadata_file()

    def sync_finished(self) -> None:
        """Bring finished parts to the disk and close them."""
        while self._unsynced:
            if self._syncs:
                os.fsync(self._unsynced[0].fileno())
                sync_folders(self.folder)
            self._unsynced.popleft().close()

    def close(self) -> None:
        """Close all files."""
        for file in (*self._unsynced, self.file):
            file.close()

    def write_metadata_file(self) -> None:
        """Write metadata.yaml, which describes all parts together."""
        parts = [*self._metadata_before, self._metadata()]
        rosbag2.write_metadata_file(self.folder, rosbag2.merged(parts))

    @property
    def has_a_name(self) -> bool:
        """Return whether the newest file is still in some folder: it may have been deleted."""
        return os.fstat(self.file.fileno()).st_nlink > 0

    def missing(self) -> str:
        """Return the fate of the newest file as text; empty if it is still in its place."""
        with contextlib.suppress(OSError):
            if os.path.samestat(os.stat(self._path), os.fstat(self.file.fileno())):
                return ''
        return f'{self._path.name} was moved, replaced or removed'

    # --- the next part --------------------------------------------------------------------------

    def _next_part(self, time: int, splitter: Splitter) -> None:
        """
        End this file and open the next, from a log time [ns] on.

        The new file is made first: if the disk refuses it, the old one goes on.
        """
        self.container.flush()
        path, file = rosbag2.create_part(self.folder, splitter.number + 1)
        try:
            container = self._new_container(file)
            self.ended = SPLIT
            self._describe()
            metadata, nexts = self._metadata(), self._next_numbers()
            self.container.finish()
        except Exception:
            file.close()
            path.unlink()
            raise
        finally:
            self.ended = ''
        self._dropped_before = self._dropped(nexts)
        self._recorded_before = self.recorded
        self._unsynced.append(self.file)
        self._metadata_before.append(metadata)
        self.container, self.file, self._path, self._firsts = container, file, path, nexts
        splitter.begin(time)
        self._repeats = splitter.repeats()
        self._describe()
        for message in self._repeats:
            container.add_message(message.channel + 1, message.sequence, time, message.data,
                                  published=message.time)
        if not self._syncs:
            self.sync_finished()
        self._remove_outdated(time, splitter)

    def _remove_outdated(self, time: int, splitter: Splitter) -> None:
        """Remove the parts that are older than the time to keep, metadata.yaml first."""
        starts = [part['starting_time']['nanoseconds_since_epoch']
                  for part in self._metadata_before]
        number = splitter.outdated([*starts, time])
        old, self._metadata_before = (self._metadata_before[:number],
                                      self._metadata_before[number:])
        self.write_metadata_file()
        for part in old:
            with contextlib.suppress(FileNotFoundError):
                (self.folder / part['relative_file_paths'][0]).unlink()

    # --- what a part says of itself -------------------------------------------------------------

    def _new_container(self, file: BinaryIO) -> Container:
        """Return a Container for a new file, with all channels; the file gets locked."""
        mark_as_being_written(file)
        container = Container(file, 'ros2', f'{OURS}{__version__}, mcap {mcap_version}')
        schemas: dict[str, int] = {}             # {type: number}
        for channel in self._channels:
            if channel.type not in schemas:
                schemas[channel.type] = container.add_schema(channel.type, channel.schema)
            container.add_channel(channel.topic, schemas[channel.type], channel.metadata)
        return container

    def _describe(self) -> None:
        """Write the metadata so far into the file; a reader takes the last ones."""
        self.container.add_metadata(rosbag2.RECORD, {rosbag2.KEY: dumped(self._metadata())})

    def _metadata(self) -> YamlMap:
        """
        Return the rosbag2 metadata of this part, with its custom_data.

        This has {topic: (first sequence number, next one or None)} and the topics with a repeated
        message. Once recording has ended, it also has the reason and {topic: messages dropped}.
        """
        entries = {}
        if self._metadata_before:
            repeated = [self._topics[message.channel] for message in self._repeats]
            entries[rosbag2.REPEATS] = json.dumps(repeated)
        nexts = self._next_numbers() if self.ended else []
        ends: Sequence[int | None] = nexts or [None] * len(self._topics)
        entries[rosbag2.NUMBERS] = json.dumps(dict(zip(self._topics, zip(self._firsts, ends))))
        if self.ended:
            entries[rosbag2.ENDED] = self.ended
            if dropped := self._dropped(nexts):
                entries[rosbag2.DROPPED] = json.dumps(dropped)
        return rosbag2.describe(self._path.name, self.container, {**self._about, **entries})

    def _next_numbers(self) -> list[int]:
        """Return the number after the last one of every channel: of this part, or of the bag."""
        if self.ended != SPLIT:
            return list(self._given)
        last = self.container.last
        return [last.get(i, first - 1) + 1 for i, first in enumerate(self._firsts, 1)]

    def _dropped(self, nexts: list[int]) -> dict[str, int]:
        """
        Return {topic: messages dropped so far}, of this part up to the numbers ``nexts``.

        Numbers 5 to 14 given, 8 messages in the file: 2 dropped.
        """
        repeated = {message.channel for message in self._repeats}
        dropped = {}
        for i, (topic, first, after) in enumerate(zip(self._topics, self._firsts, nexts)):
            in_part = self.container.counts.get(i + 1, 0) - (i in repeated)
            dropped[topic] = self._dropped_before.get(topic, 0) + after - first - in_part
        return {topic: count for topic, count in dropped.items() if count}


class Message(NamedTuple):
    """A message in the file: place of its channel, sequence number, log time [ns], bytes."""

    channel: int
    sequence: int
    time: int
    data: bytes


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
    Decides when a bag continues in a new file, from the messages that go into it.

    ``latched``: channels where only the newest message counts.
    """

    def __init__(self, split: Split, latched: Collection[int]) -> None:
        self._split, self._latched = split, latched
        self._newest: dict[int, Message] = {}    # by channel, in the order of arrival
        self._begun: int | None = None           # [ns] when the part began
        self.number = 0                          # of the part

    def is_due(self, channel: int, time: int, size: int) -> bool:
        """
        Return whether a new part begins with a message at a log time [ns].

        ``size``: the size of the part so far [bytes].
        """
        if self._begun is None:
            self._begun = time
        split = self._split
        is_full = split.size > 0 and size >= split.size
        is_long = split.seconds > 0.0 and time - self._begun >= split.seconds * 1e9
        return (is_full or is_long) and split.head in (None, channel)

    def note(self, message: Message) -> None:
        """Remember a message, which went into the part."""
        self._newest.pop(message.channel, None)        # so that the new one comes last
        self._newest[message.channel] = message

    def repeats(self) -> list[Message]:
        """
        Return the messages that a new part begins with, so that it can be read alone.

        These are the newest latched messages, as the scene, and the newest message of each other
        channel if it came after these: earlier messages belong to another scene.
        """
        newest = list(self._newest.values())
        latched = [message for message in newest if message.channel in self._latched]
        begin = newest.index(latched[-1]) + 1 if latched else 0
        return latched + newest[begin:]

    def begin(self, time: int) -> None:
        """Begin the next part."""
        self._begun, self.number = time, self.number + 1

    def outdated(self, starts: Sequence[int]) -> int:
        """
        Return how many of the oldest parts may be removed.

        ``starts``: when each part began [ns]. A part that ended before the time to keep is not
        needed. With starts 0, 10, 20, 30 s and 15 s to keep, only the first part may go.
        """
        keep = self._split.keep * 1e9
        return sum(start <= starts[-1] - keep for start in starts[1:]) if keep else 0
