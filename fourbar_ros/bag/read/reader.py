# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Read a bag without ROS: a directory or a single .mcap file; finished, cut, or still being written.

>>> for record in records('bags/run', ['/fourbar/state']):
...     print(record.time, record.message.theta4)
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
import contextlib
from functools import partial
from pathlib import Path
import time
from types import SimpleNamespace
from typing import Any

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.cdr import Decoder
from fourbar_ros.bag.file_system import is_being_written
from fourbar_ros.bag.mcap.scan import ending
from fourbar_ros.bag.read.part import Channels, metadata_in, PartReader
from fourbar_ros.bag.read.records import behind, Columns, Message, Progress, Raw, Record
from fourbar_ros.bag.yaml_text import Told
from fourbar_ros.errors import BagError
from mcap.reader import make_reader, Summary
import numpy as np

BLOCK = 20_000          # messages that are decoded together: large for numpy, small for the memory
BLOCK_BYTES = 1 << 24   # and no more bytes than these, but for one chunk: pictures are large
POLL = 0.02             # [s] between two looks at a bag that grows


class Bag:
    """
    A bag to be read, any number of times.

    Parameters
    ----------
    path : str or Path
        Folder of a bag, split or not, or an .mcap file.

    Attributes
    ----------
    files : list of Path
        The .mcap files, of a split bag one a part.
    cut : bool or None
        Whether the last reading met the end of the data without the end of the file: a crash, or a
        bag still being written. None before.
    damage : list of str
        What the last reading found wrong with the file: where and why. Of a finished bag it misses
        nothing; what leaves all messages as they were, as in an index, does not stop the reading.

    """

    def __init__(self, path: str | Path) -> None:
        self.path, self.files = Path(path), rosbag2.files_of(path)
        self._channels = Channels(self.path)
        self.channels = self._channels.by_number
        self.cut: bool | None = None
        self.damage: list[str] = []

    # --- about it -------------------------------------------------------------------------------

    @property
    def is_being_written(self) -> bool:
        """Return whether a recorder is at work on it."""
        return any(is_being_written(file) for file in rosbag2.files_of(self.path))

    @property
    def file(self) -> Path:
        """Return the first .mcap file."""
        return self.files[0]

    @property
    def parts(self) -> list[Bag]:
        """Return a Bag for every file."""
        return [Bag(file) for file in self.files]

    @property
    def size(self) -> int:
        """Return the size of all files [bytes]."""
        return sum(file.stat().st_size for file in self.files)

    def summary(self) -> Summary | None:
        """Return the mcap library's Summary of a finished bag of one file, None for any other."""
        if len(self.files) > 1:
            return None
        # it raises what it likes
        with open(self.files[0], 'rb') as file, contextlib.suppress(Exception):
            end = ending(file)
            file.seek(0)
            return None if end is None or end.damage else make_reader(file).get_summary()
        return None

    def metadata(self) -> Told:
        """
        Return the rosbag2 metadata kept in the file itself; the last undamaged record wins.

        For a split bag, that of the first part with what the last one adds to its custom_data.
        """
        first = metadata_in(self.files[0])
        last = metadata_in(self.files[-1]) if len(self.files) > 1 else None
        found = first or last
        if not found:
            raise BagError(f'{self.path}: has no rosbag2 metadata')
        if first and last:
            found['custom_data'] = rosbag2.joined(rosbag2.about_of(first), rosbag2.about_of(last))
        return found

    def about(self) -> dict[str, str]:
        """Return the custom_data of a bag as {str: str}; empty if it has none."""
        try:
            found = rosbag2.about_of(self.metadata())
        except BagError:
            found = {}
        if rosbag2.ENDED not in found:              # there was no room for it in the file
            found |= rosbag2.about_beside(self.files[-1])
        return found

    # --- messages -------------------------------------------------------------------------------

    def records(self, topics: Iterable[str] | None = None, start: int | None = None,
                follow: bool = False) -> Iterator[Record]:
        """Yield every :class:`Record` in the order of writing; arguments as in :meth:`raw`."""
        for raw in self.raw(topics, start, follow):
            yield Record(raw.topic, raw.time, self.decode(raw))

    def decode(self, raw: Raw) -> SimpleNamespace:
        """Return the message of a :class:`Raw` as nested namespaces."""
        found: SimpleNamespace = self.decoder_of(raw.channel).message(raw.data)
        return found

    def raw(self, topics: Iterable[str] | None = None, start: int | None = None,
            follow: bool = False) -> Iterator[Raw]:
        """
        Yield every :class:`Raw` message in the order of writing.

        Parameters
        ----------
        topics : list of str, optional
            Only these.
        start : int, optional
            Only messages at or after this log time [ns].
        follow : bool
            At the end of a bag that is being written, wait for more until it is finished.

        """
        for item in self.chunks(topics, start, follow):
            for number, sequence, stamp, data in item:
                yield Raw(self.channels[number].topic, self.type_of_channel(number), stamp,
                          sequence, data, number)

    def columns(self, topics: Iterable[str] | None = None, progress: Progress | None = None
                ) -> Iterator[Columns]:
        """Yield all :class:`Columns`, block by block; arguments as in :meth:`blocks`."""
        for block in self.blocks(topics, progress=progress):
            yield from block

    def blocks(self, topics: Iterable[str] | None = None, apart: str | None = None,
               progress: Progress | None = None) -> Iterator[Any]:
        """
        Yield lists of :class:`Columns`, of about BLOCK messages that follow each other in the bag.

        Within a list those of one topic may lie between each other, where its messages change to
        and fro between layouts (lengths of texts and sequences): ``places`` tell the order.

        Parameters
        ----------
        topics : list of str, optional
            Only these.
        apart : str, optional
            The messages of this topic end a block and are yielded as :class:`Record`, where they
            stand.
        progress : callable, optional
            Called with the number of bytes read so far.

        """
        block: list[Message] = []
        place = size = 0
        for item in self.chunks(topics, progress=progress):
            for alone, part in self._parted(item, apart):
                block += part
                size += sum(len(data) for *_, data in part)
                if block and (alone or len(block) >= BLOCK or size >= BLOCK_BYTES):
                    yield self._block(block, place)
                    place, block, size = place + len(block), [], 0
                if alone and apart:
                    yield Record(apart, alone[2], self.decoder_of(alone[0]).message(alone[3]))
        if block:
            yield self._block(block, place)

    def _parted(self, messages: Sequence[Message], apart: str | None
                ) -> Iterator[tuple[Message | None, Sequence[Message]]]:
        """Yield (message apart, messages before it), last (None, messages after it)."""
        numbers = {number for number, channel in self.channels.items() if channel.topic == apart}
        begin = 0
        for i, item in enumerate(messages) if numbers else ():
            if item[0] in numbers:
                yield item, messages[begin:i]
                begin = i + 1
        yield None, messages[begin:] if begin else messages

    def _block(self, block: Sequence[Message], place: int) -> list[Columns]:
        by_channel: dict[int, list[tuple[int, int, bytes]]] = {}
        for i, (number, _, stamp, data) in enumerate(block, place):
            by_channel.setdefault(number, []).append((i, stamp, data))
        made = []
        for number, found in by_channel.items():
            latest = max(time for _, time, _ in found)
            if latest >= 1 << 63:
                raise BagError(f'{self.path}: a log time of {latest} ns is after the year 2262')
            places = np.array([place for place, _, _ in found])
            times = np.array([time for _, time, _ in found], np.int64)
            topic = self.channels[number].topic
            parts = self.decoder_of(number).arrays([data for _, _, data in found])
            made += [Columns(topic, times[rows], places[rows], records, layout)
                     for layout, rows, records in parts]
        return sorted(made, key=lambda columns: columns.places[0])

    # --- topics met so far ----------------------------------------------------------------------

    def type_of(self, topic: str) -> str:
        """Return the type of a topic."""
        return self.type_of_channel(self._channels.of(topic).id)

    def type_of_channel(self, number: int) -> str:
        """Return the type of a channel."""
        found: str = self._channels.schema(number).name
        return found

    def qos_of(self, topic: str) -> list[Told]:
        """Return the QoS profiles, as dicts, under which a topic was offered."""
        return self._channels.qos(topic)

    def hash_of(self, topic: str) -> str:
        """Return the type hash of a topic, empty if the bag does not say."""
        found: str = self._channels.of(topic).metadata.get(rosbag2.HASH, '')
        return found

    def decoder(self, topic: str) -> Decoder:
        """Return the Decoder of a topic, of its first channel if it has several."""
        return self.decoder_of(self._channels.of(topic).id)

    def decoder_of(self, number: int) -> Decoder:
        """Return the Decoder of a channel."""
        return self._channels.decoder(number)

    # --- the files ------------------------------------------------------------------------------

    def chunks(self, topics: Iterable[str] | None = None, start: int | None = None,
               follow: bool = False, progress: Progress | None = None
               ) -> Iterator[Sequence[Message]]:
        """
        Yield lists of (channel, sequence, log time, bytes), one a chunk.

        A finished file has an index: only chunks that can hold what is asked for are read.
        """
        wanted = None if topics is None else set(topics)
        self.damage, self.cut, read = [], False, 0
        wait = self._wait if follow else None
        for place, path in enumerate(self._each_file(follow)):
            name = self.path if len(self.files) == 1 else path
            part = PartReader(path, name, self._channels, place == 0, wait, self.damage)
            was_cut, self.cut = self.cut, True
            # its recorder keeps only the newest parts
            with contextlib.suppress(FileNotFoundError):
                done = partial(behind, progress, read) if progress else None
                for found in part.chunks(wanted, start, done):
                    chosen = self._chosen(found, wanted, start)
                    if chosen:
                        yield chosen
                self.cut = was_cut or not part.is_complete
                read += part.size

    def _each_file(self, follow: bool) -> Iterator[Path]:
        """Yield the files of the bag, of one being written also those to come."""
        done = set()
        while True:
            new = [file for file in rosbag2.files_of(self.path) if file not in done]
            if new:
                done.add(new[0])
                yield new[0]
            elif not follow or not self._wait():
                return

    def _wait(self) -> bool:
        """Wait a moment if the bag is being written; return whether it is."""
        if not self.is_being_written:
            return False
        time.sleep(POLL)
        return True

    def _chosen(self, found: Sequence[Message], wanted: set[str] | None, start: int | None
                ) -> Sequence[Message]:
        if wanted is not None:
            numbers = self._channels.of_topics(wanted)
            found = [item for item in found if item[0] in numbers]
        return found if start is None else [item for item in found if item[2] >= start]


def records(path: str | Path, topics: Iterable[str] | None = None, start: int | None = None,
            follow: bool = False) -> Iterator[Record]:
    """Yield every :class:`Record` of a bag; see :meth:`Bag.raw`."""
    return Bag(path).records(topics, start, follow)
