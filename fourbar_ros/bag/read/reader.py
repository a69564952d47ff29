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
from fourbar_ros.bag.read.records import add_progress, Columns, Message, Progress, Raw, Record
from fourbar_ros.bag.yaml_text import YamlMap
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
        The .mcap files; one for each part of a split bag.
    cut : bool or None
        Whether the last reading met the end of the data without the end of the file: a crash, or a
        bag still being written. None before.
    damage : list of str
        The faults that the last reading found in the file: where and why. In a finished bag it
        misses nothing. Damage that leaves all messages intact, as in an index, does not stop the
        reading.

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
        # the library raises errors of any kind for a file that it cannot read
        with open(self.files[0], 'rb') as file, contextlib.suppress(Exception):
            end = ending(file)
            file.seek(0)
            return None if end is None or end.damage else make_reader(file).get_summary()
        return None

    def metadata(self) -> YamlMap:
        """
        Return the rosbag2 metadata kept in the file itself; the last undamaged record wins.

        For a split bag: the first part's metadata, with the custom_data that the last part adds.
        """
        first = metadata_in(self.files[0])
        last = metadata_in(self.files[-1]) if len(self.files) > 1 else None
        metadata = first or last
        if not metadata:
            raise BagError(f'{self.path}: has no rosbag2 metadata')
        if first and last:
            metadata['custom_data'] = rosbag2.joined(rosbag2.about_of(first),
                                                     rosbag2.about_of(last))
        return metadata

    def about(self) -> dict[str, str]:
        """Return the custom_data of a bag as {str: str}; empty if it has none."""
        try:
            about = rosbag2.about_of(self.metadata())
        except BagError:
            about = {}
        if rosbag2.ENDED not in about:              # there was no room for it in the file
            about |= rosbag2.about_beside(self.files[-1])
        return about

    # --- messages -------------------------------------------------------------------------------

    def records(self, topics: Iterable[str] | None = None, start: int | None = None,
                follow: bool = False) -> Iterator[Record]:
        """Yield every :class:`Record` in the order of writing; arguments as in :meth:`raw`."""
        for raw in self.raw(topics, start, follow):
            yield Record(raw.topic, raw.time, self.decode(raw))

    def decode(self, raw: Raw) -> SimpleNamespace:
        """Return the message of a :class:`Raw` as nested namespaces."""
        return self.decoder_of(raw.channel).message(raw.data)

    def raw(self, topics: Iterable[str] | None = None, start: int | None = None,
            follow: bool = False) -> Iterator[Raw]:
        """
        Yield every :class:`Raw` message in the order of writing.

        ``topics``: only these; ``start``: only messages at or after this log time [ns];
        ``follow``: at the end of a bag that is being written, wait for more until it is finished.
        """
        for chunk in self.chunks(topics, start, follow):
            for number, sequence, log_time, data in chunk:
                yield Raw(self.channels[number].topic, self.type_of_channel(number), log_time,
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

        A topic whose messages change between layouts (lengths of texts and sequences) has several
        Columns in a list; ``places`` tell the order of their messages. The messages of the topic
        ``apart`` end a block and are yielded as :class:`Record`, in their places. ``topics``: only
        these; ``progress`` is called with the number of bytes read so far.
        """
        block: list[Message] = []
        place = size = 0                    # of the block: messages before it, bytes
        for chunk in self.chunks(topics, progress=progress):
            for messages, single in self._parted(chunk, apart):
                block += messages
                size += sum(len(data) for *_, data in messages)
                if block and (single or len(block) >= BLOCK or size >= BLOCK_BYTES):
                    yield self._as_columns(block, place)
                    place, block, size = place + len(block), [], 0
                if single and apart:
                    channel, _, log_time, data = single
                    yield Record(apart, log_time, self.decoder_of(channel).message(data))
        if block:
            yield self._as_columns(block, place)

    def _parted(self, messages: Sequence[Message], apart: str | None
                ) -> Iterator[tuple[Sequence[Message], Message | None]]:
        """Yield (messages before, message of the topic ``apart``); last (the rest, None)."""
        numbers = {number for number, channel in self.channels.items() if channel.topic == apart}
        begin = 0
        for i, message in enumerate(messages) if numbers else ():
            if message[0] in numbers:
                yield messages[begin:i], message
                begin = i + 1
        yield messages[begin:] if begin else messages, None

    def _as_columns(self, block: Sequence[Message], place: int) -> list[Columns]:
        """Return the Columns of messages that begin at a place in the bag."""
        by_channel: dict[int, list[tuple[int, int, bytes]]] = {}
        for i, (number, _, log_time, data) in enumerate(block, place):
            by_channel.setdefault(number, []).append((i, log_time, data))
        made = []
        for number, messages in by_channel.items():
            places, times, datas = zip(*messages)
            if max(times) >= 1 << 63:
                raise BagError(f'{self.path}: a log time of {max(times)} ns is after the year '
                               '2262')
            topic, place_array, time_array = (self.channels[number].topic, np.array(places),
                                              np.array(times, np.int64))
            made += [Columns(topic, time_array[rows], place_array[rows], records, layout)
                     for layout, rows, records in self.decoder_of(number).arrays(datas)]
        return sorted(made, key=lambda columns: columns.places[0])

    # --- topics met so far ----------------------------------------------------------------------

    def type_of(self, topic: str) -> str:
        """Return the type of a topic."""
        return self.type_of_channel(self._channels.of(topic).id)

    def type_of_channel(self, number: int) -> str:
        """Return the type of a channel."""
        return str(self._channels.schema(number).name)

    def type_if_known(self, number: int) -> str:
        """Return the type of a channel; empty if its schema is missing or damaged."""
        try:
            return self.type_of_channel(number)
        except BagError:
            return ''

    def qos_of(self, topic: str) -> list[YamlMap]:
        """Return the QoS profiles, as dicts, under which a topic was offered."""
        return rosbag2.profiles_of(self._channels.of(topic).metadata.get(rosbag2.QOS, ''))

    def hash_of(self, topic: str) -> str:
        """Return the type hash of a topic, empty if the bag does not say."""
        return str(self._channels.of(topic).metadata.get(rosbag2.HASH, ''))

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

        A finished file has an index: only chunks that can hold the requested messages are read.
        """
        wanted = None if topics is None else set(topics)
        self.damage, self.cut, read = [], False, 0
        wait = self._wait if follow else None
        for place, path in enumerate(self._each_file(follow)):
            name = self.path if len(self.files) == 1 else path
            part = PartReader(path, name, self._channels, place == 0, wait, self.damage)
            was_cut, self.cut = self.cut, True      # until the file was read to its end
            # a recorder that keeps only the newest parts may remove this one meanwhile
            with contextlib.suppress(FileNotFoundError):
                progress_here = partial(add_progress, progress, read) if progress else None
                for messages in part.chunks(wanted, start, progress_here):
                    if wanted is not None:
                        numbers = self._channels.of_topics(wanted)
                        messages = [message for message in messages if message[0] in numbers]
                    if start is not None:
                        messages = [message for message in messages if message[2] >= start]
                    if messages:
                        yield messages
                self.cut = was_cut or not part.is_complete
                read += part.size

    def _each_file(self, follow: bool) -> Iterator[Path]:
        """Yield the files of a bag; ``follow``: wait for new ones as long as it is written."""
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


def records(path: str | Path, topics: Iterable[str] | None = None, start: int | None = None,
            follow: bool = False) -> Iterator[Record]:
    """Yield every :class:`Record` of a bag; see :meth:`Bag.raw`."""
    return Bag(path).records(topics, start, follow)
