# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The files of a bag being written, one after the other.

What each says of itself, when a bag continues in a new file, what that file repeats, which old
files may be removed.
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
from fourbar_ros.bag.rosbag2 import Channel
from fourbar_ros.bag.yaml_text import dumped, Told
from mcap import __version__ as mcap_version

SPLIT = 'split'             # why a part ended that another one follows
SHARE = 10      # a bag that keeps the newest seconds has so many parts, unless split otherwise


class Parts:
    """
    The open file of a bag and those before it; a bag that is not split has one.

    Parameters
    ----------
    folder : Path
    file : binary file
        The first one, new and unbuffered.
    channels : list of Channel
    about : dict
        custom_data of every part.
    given : list of int
        The next sequence number of every channel; its owner changes it.
    split : Split
    is_synced : bool
        Finished parts are synced before they are closed.

    """

    def __init__(self, folder: Path, file: BinaryIO, channels: list[Channel],
                 about: dict[str, str], given: Sequence[int], split: Split, is_synced: bool):
        self.folder, self.file, self.ended = folder, file, ''
        self._path = folder / f'{folder.name}_0.mcap'
        self._channels, self._topics = channels, [channel.topic for channel in channels]
        self._about, self._given, self._is_synced = about, given, is_synced
        latched = {i for i, channel in enumerate(channels) if channel.latched}
        self._splitter = Splitter(split, latched) if split.is_wanted else None
        # This part: its first numbers, messages that it repeats. Those before: metadata,
        # files to sync, recorded messages, dropped ones by topic.
        self._firsts = [0] * len(channels)
        self._repeats: list[tuple[int, int, int, bytes]] = []
        self._done: list[Told] = []
        self._unsynced: deque[BinaryIO] = deque()
        self._recorded = 0
        self._lost: dict[str, int] = {}
        self.container = self._new_container(file)
        self._describe()
        self.write_metadata_file()

    @property
    def recorded(self) -> int:
        """Return how many messages are in the files, repeated ones counted once."""
        return self._recorded + sum(self.container.counts.values()) - len(self._repeats)

    def add(self, stamp: int, messages: list[tuple[int, int, bytes]]) -> None:
        """Add the messages of a step, (channel, sequence, data), in a new part if one is due."""
        if self._splitter is None:
            self.container.add_messages(stamp, messages)
            return
        for message in messages:
            number, sequence, data = message
            if self._splitter.is_due(number - 1, stamp, self.container.size):
                self._next_part(stamp, self._splitter)
            self._splitter.note(number - 1, sequence, stamp, data)
            self.container.add_messages(stamp, (message,))

    def flush(self) -> None:
        """Write what was added; rosbag2 plays from the start that stands in metadata.yaml."""
        before = self.container.start
        self.container.flush()
        if before != self.container.start:
            self.write_metadata_file()

    def end(self, why: str) -> None:
        """Write the last metadata, which say why it ended, the end of the file, metadata.yaml."""
        self.ended = why
        self._describe()
        self.container.finish()
        if self._is_synced:
            os.fsync(self.file.fileno())
        self.write_metadata_file()

    def sync_finished(self) -> None:
        """Bring finished parts to the disk and close them."""
        while self._unsynced:
            if self._is_synced:
                os.fsync(self._unsynced[0].fileno())
                sync_folders(self.folder)
            self._unsynced.popleft().close()

    def close(self) -> None:
        """Close all files."""
        for file in (*self._unsynced, self.file):
            file.close()

    def write_metadata_file(self) -> None:
        """Write metadata.yaml, of all parts."""
        rosbag2.write_metadata_file(self.folder,
                                    rosbag2.merged([*self._done, self._metadata()]))

    @property
    def has_a_name(self) -> bool:
        """Return whether the file is still in some folder."""
        return os.fstat(self.file.fileno()).st_nlink > 0

    def missing(self) -> str:
        """Return what became of the file; empty if it is where it was made."""
        with contextlib.suppress(OSError):
            if os.path.samestat(os.stat(self._path), os.fstat(self.file.fileno())):
                return ''
        return f'{self._path.name} was moved, replaced or removed'

    # --- the next part --------------------------------------------------------------------------

    def _next_part(self, stamp: int, splitter: Splitter) -> None:
        """End this file and open the next, which begins with what is needed to read it alone."""
        self.container.flush()
        path, file = rosbag2.create_part(self.folder, splitter.number + 1)
        try:
            container = self._new_container(file)
            self.ended = SPLIT
            self._describe()
            told, nexts = self._metadata(), self._nexts()
            self.container.finish()
        except Exception:
            file.close()
            path.unlink()
            raise
        finally:
            self.ended = ''
        self._lost = self._dropped(nexts)
        self._recorded = self.recorded
        self._unsynced.append(self.file)
        self._done.append(told)
        self.container, self.file, self._path, self._firsts = container, file, path, nexts
        splitter.begin(stamp)
        self._repeats = splitter.repeats()
        self._describe()
        for channel, sequence, first_time, data in self._repeats:
            container.add_message(channel + 1, sequence, stamp, data, first_time)
        if not self._is_synced:
            self.sync_finished()
        self._forget_outdated(stamp, splitter)

    def _forget_outdated(self, stamp: int, splitter: Splitter) -> None:
        """Write metadata.yaml; remove the parts that are not needed any more."""
        starts = [told['starting_time']['nanoseconds_since_epoch'] for told in self._done]
        old = splitter.outdated([*starts, stamp])
        gone, self._done = self._done[:old], self._done[old:]
        self.write_metadata_file()
        for told in gone:
            with contextlib.suppress(FileNotFoundError):
                (self.folder / told['relative_file_paths'][0]).unlink()

    # --- what a part says of itself -------------------------------------------------------------

    def _new_container(self, file: BinaryIO) -> Container:
        mark_as_being_written(file)
        container = Container(file, 'ros2', f'{OURS}{__version__}, mcap {mcap_version}')
        numbers: dict[str, int] = {}
        for channel in self._channels:
            if channel.type not in numbers:
                numbers[channel.type] = container.add_schema(channel.type, channel.schema)
            container.add_channel(channel.topic, numbers[channel.type], channel.metadata)
        return container

    def _describe(self) -> None:
        self.container.add_metadata(rosbag2.RECORD, {rosbag2.KEY: dumped(self._metadata())})

    def _metadata(self) -> Told:
        return rosbag2.describe(self._path.name, self.container,
                                {**self._about, **self._numbers()})

    def _numbers(self) -> dict[str, str]:
        """Return the entries of custom_data about sequence numbers and the end, if any."""
        told = {}
        if self._done:
            repeated = [self._topics[channel] for channel, *_ in self._repeats]
            told[rosbag2.REPEATS] = json.dumps(repeated)
        nexts = self._nexts() if self.ended else []
        ends: Sequence[int | None] = nexts or [None] * len(self._topics)
        told[rosbag2.NUMBERS] = json.dumps(dict(zip(self._topics, zip(self._firsts, ends))))
        if self.ended:
            told[rosbag2.ENDED] = self.ended
            if dropped := self._dropped(nexts):
                told[rosbag2.DROPPED] = json.dumps(dropped)
        return told

    def _nexts(self) -> list[int]:
        """Return the next number of every channel: behind this part, or behind the whole bag."""
        if self.ended != SPLIT:
            return list(self._given)
        last = self.container.last
        return [last.get(i, first - 1) + 1 for i, first in enumerate(self._firsts, 1)]

    def _dropped(self, nexts: list[int]) -> dict[str, int]:
        """Return {topic: messages dropped before these numbers}, in the parts before as well."""
        repeated = {channel for channel, *_ in self._repeats}
        found = {}
        for i, (topic, first, after) in enumerate(zip(self._topics, self._firsts, nexts)):
            in_part = self.container.counts.get(i + 1, 0) - (i in repeated)
            found[topic] = self._lost.get(topic, 0) + after - first - in_part
        return {topic: count for topic, count in found.items() if count}


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
