# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Read a bag without ROS: a directory or a single .mcap file; finished, cut, or still being written.

>>> for record in records('bags/run', ['/fourbar/state']):
...     print(record.time, record.message.theta4)
"""
from __future__ import annotations

import contextlib
from dataclasses import replace
from pathlib import Path
import time

from fourbar_ros.bag.records import Columns, Raw, Record
from fourbar_ros.errors import BagError
from fourbar_ros.formats import rosbag2
from fourbar_ros.formats.cdr import Decoder
from fourbar_ros.formats.file_metadata import metadata_in, repeats_in
from fourbar_ros.formats.mcap_records import (
    Damaged,
    HEAD,
    IS_MESSAGE,
    MESSAGE,
    message_of,
    parse,
    split,
    unpacked,
)
from fourbar_ros.formats.mcap_scan import chunk_index, ending, is_being_written, MAGIC, Scan
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Schema
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

    def __init__(self, path):
        self.path, self.files = Path(path), rosbag2.files_of(path)
        self.channels, self._schemas, self._decoders = {}, {}, {}
        # definitions of the file that is read by their numbers there, and {(kind, number there):
        # number here}
        self._here, self._numbers, self._is_first, self._read = {}, {}, True, 0
        # channels that were looked at; whose messages are compressed
        self._plain, self._packed = set(), set()
        self.cut, self.damage = None, []

    # --- about it -------------------------------------------------------------------------------

    @property
    def is_being_written(self):
        """Return whether a recorder is at work on it."""
        return any(is_being_written(file) for file in rosbag2.files_of(self.path))

    @property
    def file(self):
        """Return the first .mcap file."""
        return self.files[0]

    @property
    def parts(self):
        """Return a Bag for every file."""
        return [Bag(file) for file in self.files]

    @property
    def size(self):
        """Return the size of all files [bytes]."""
        return sum(file.stat().st_size for file in self.files)

    def summary(self):
        """Return the mcap library's Summary of a finished bag of one file, None for any other."""
        if len(self.files) > 1:
            return None
        # it raises what it likes
        with open(self.files[0], 'rb') as file, contextlib.suppress(Exception):
            end = ending(file)
            file.seek(0)
            return None if end is None or end.damage else make_reader(file).get_summary()
        return None

    def metadata(self):
        """
        Return the rosbag2 metadata kept in the file itself; the last undamaged record wins.

        Of a split bag that of the first part, with what the last one adds to its custom_data.
        """
        told = [found for found in (metadata_in(file)
                                    for file in (self.files[0], *self.files[1:][-1:])) if found]
        if not told:
            raise BagError(f'{self.path}: has no rosbag2 metadata')
        if len(told) > 1:
            told[0]['custom_data'] = rosbag2.joined(*map(rosbag2.about_of, told))
        return told[0]

    def about(self):
        """Return the custom_data of a bag as {str: str}; empty if it has none."""
        try:
            found = rosbag2.about_of(self.metadata())
        except BagError:
            found = {}
        if rosbag2.ENDED not in found:              # there was no room for it in the file
            found |= rosbag2.about_beside(self.files[-1])
        return found

    # --- messages -------------------------------------------------------------------------------

    def records(self, topics=None, start=None, follow=False):
        """Yield every :class:`Record` in the order of writing; arguments as in :meth:`raw`."""
        for raw in self.raw(topics, start, follow):
            yield Record(raw.topic, raw.time, self.decode(raw))

    def decode(self, raw):
        """Return the message of a :class:`Raw` as nested namespaces."""
        return self.decoder_of(raw.channel).message(raw.data)

    def raw(self, topics=None, start=None, follow=False):
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
                yield Raw(self.channels[number].topic, self._schema(number).name, stamp, sequence,
                          data, number)

    def columns(self, topics=None, progress=None):
        """Yield all :class:`Columns`, block by block; arguments as in :meth:`blocks`."""
        for block in self.blocks(topics, progress=progress):
            yield from block

    def blocks(self, topics=None, apart=None, progress=None):
        """
        Yield lists of :class:`Columns`.

        Each of about BLOCK messages that follow each other in the bag.

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
        block, place, size = [], 0, 0
        for item in self.chunks(topics, progress=progress):
            for alone, part in self._parted(item, apart):
                block += part
                size += sum(len(data) for *_, data in part)
                if block and (alone or len(block) >= BLOCK or size >= BLOCK_BYTES):
                    yield self._block(block, place)
                    place, block, size = place + len(block), [], 0
                if alone:
                    yield Record(apart, alone[2], self.decoder_of(alone[0]).message(alone[3]))
        if block:
            yield self._block(block, place)

    def _parted(self, messages, apart):
        """Yield (message apart, messages before it), last (None, messages after it)."""
        numbers = {number for number, channel in self.channels.items() if channel.topic == apart}
        begin = 0
        for i, item in enumerate(messages) if numbers else ():
            if item[0] in numbers:
                yield item, messages[begin:i]
                begin = i + 1
        yield None, messages[begin:] if begin else messages

    def _block(self, block, place):
        by_channel = {}
        for i, (number, _, stamp, data) in enumerate(block, place):
            by_channel.setdefault(number, []).append((i, stamp, data))
        made = []
        for number, found in by_channel.items():
            places, times, data = zip(*found)
            if max(times) >= 1 << 63:
                raise BagError(f'{self.path}: a log time of {max(times)} ns is after the year '
                               '2262')
            places, times = np.array(places), np.array(times, np.int64)
            topic = self.channels[number].topic
            made += [Columns(topic, times[rows], places[rows], records, layout)
                     for layout, rows, records in self.decoder_of(number).arrays(data)]
        return sorted(made, key=lambda columns: columns.places[0])

    def type_of(self, topic):
        """Return the type of a topic met so far."""
        return self._schema_of(topic).name

    def type_of_channel(self, number):
        """Return the type of a channel met so far."""
        return self._schema(number).name

    def qos_of(self, topic):
        """Return the QoS profiles, as dicts, under which a topic met so far was offered."""
        return rosbag2.profiles_of(self._channel_of(topic).metadata.get(rosbag2.QOS, ''))

    def hash_of(self, topic):
        """Return the type hash of a topic met so far, empty if the bag does not say."""
        return self._channel_of(topic).metadata.get(rosbag2.HASH, '')

    def _channel_of(self, topic):
        return next(channel for channel in self.channels.values() if channel.topic == topic)

    def _schema_of(self, topic):
        return self._schema(self._channel_of(topic).id)

    def _schema(self, number):
        channel = self.channels[number]
        schema = self._schemas.get(channel.schema_id)
        if schema is None:
            raise BagError(f'{self.path}: {channel.topic} has no schema')
        return schema

    def decoder(self, topic):
        """Return the Decoder of a topic met so far, of its first channel if it has several."""
        return self.decoder_of(self._channel_of(topic).id)

    def decoder_of(self, number):
        """Return the Decoder of a channel met so far."""
        if number not in self._decoders:
            schema, channel = self._schema(number), self.channels[number]
            if channel.message_encoding != 'cdr' or schema.encoding != 'ros2msg':
                raise BagError(f'{self.path}: {channel.topic} is {channel.message_encoding!r} '
                               f'defined in {schema.encoding!r}; only cdr in ros2msg is decoded: '
                               'rosbags-convert makes that')
            try:
                self._decoders[number] = Decoder(schema.name, schema.data.decode())
            except UnicodeDecodeError:
                raise BagError(f'{self.path}: the schema of {channel.topic} is no text') from None
        return self._decoders[number]

    # --- the file -------------------------------------------------------------------------------

    def chunks(self, topics=None, start=None, follow=False, progress=None):
        """
        Yield lists of (channel, sequence, log time, bytes), one a chunk.

        Of a finished file with an index only the chunks are read that can hold what is asked for.
        """
        wanted = None if topics is None else set(topics)
        self.damage, self.cut, self._read = [], False, 0
        for place, path in enumerate(self._each_file(follow)):
            # its recorder keeps only the newest parts
            with contextlib.suppress(FileNotFoundError):
                for found in self._chunks_of(path, place, wanted, start, follow, progress):
                    chosen = self._chosen(found, wanted, start)
                    if chosen:
                        yield chosen

    def _each_file(self, follow):
        """Yield the files of the bag, of one being written also those to come."""
        done = set()
        while True:
            new = [file for file in rosbag2.files_of(self.path) if file not in done]
            if new:
                done.add(new[0])
                yield new[0]
            elif not follow or not self._wait():
                return

    def _wait(self):
        """Wait a moment if the bag is being written; return whether it is."""
        if not self.is_being_written:
            return False
        time.sleep(POLL)
        return True

    def _chunks_of(self, path, place, wanted, start, follow, progress):
        """Yield the messages of one file, chunk by chunk."""
        with open(path, 'rb') as file:
            begin = file.read(len(MAGIC))
            # longer ones are the scan's to judge
            if len(begin) < len(MAGIC) and not MAGIC.startswith(begin):
                raise BagError(f'{path}: not an MCAP file')
            scan = Scan(file, self._wait if follow else None, self.damage)
            was_cut, self.cut = self.cut, True
            self._here, self._numbers, self._is_first = {}, {}, place == 0
            # The checksum at the end covers these; a topic that was hit is seen before its
            # messages are read.
            for record in scan.ending.of((Schema, Channel)) if scan.ending else ():
                self._learn(record)
            repeats = {} if self._is_first else None
            for offset, opcode, body in self._walk(file, scan, wanted, start):
                try:
                    found = self._item(scan, offset, opcode, body)
                except Damaged as error:
                    if scan.is_followed_by_zeros():
                        break                       # a power cut in the middle of this record
                    if opcode:
                        scan.spoil(offset, error)
                    raise BagError(f'{self.path if len(self.files) == 1 else path}: at byte '
                                   f'{offset}: {error}; fourbar bag recover keeps the '
                                   'rest') from None
                if found:
                    # told before the first message; the file may have been empty
                    if repeats is None:
                        repeats = repeats_in(path)
                    yield self._without(found, repeats) if repeats else found
                if progress:
                    progress(self._read + scan.end)
            self.cut = was_cut or not scan.complete
            self._read += scan.end

    def _walk(self, file, scan, wanted, start):
        """Return an iterator over the records of a file; an index selects those that matter."""
        index = None if wanted is start is None else chunk_index(file, scan.ending)
        if not index or not self._here:
            return scan
        numbers = {number for (kind, number), record in self._here.items()
                   if kind is Channel and (wanted is None or record.topic in wanted)}
        return scan.only([offset for offset, _, last, channels in index
                          if (start is None or last >= start)
                          and (not channels or channels & numbers)])

    def _without(self, found, repeats):
        """
        Return messages without those that a part repeats at its beginning.

        Then ``repeats`` is emptied.
        """
        begins = {number: repeats.get(channel.topic, 0)
                  for number, channel in self.channels.items()}
        kept = [item for item in found if item[1] >= begins[item[0]]]
        if len(kept) == len(found):
            repeats.clear()
        return kept

    def _item(self, scan, offset, opcode, body):
        """Return the messages of a record."""
        if opcode is None:
            raise Damaged(body)
        if opcode == Opcode.CHUNK:
            chunk = parse(opcode, body)
            found = self._messages(unpacked(chunk))
            scan.admit(offset, chunk, [item[2] for item in found])
            return found
        if opcode == Opcode.MESSAGE:
            return self._messages(HEAD.pack(opcode, len(body)) + body)
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            self._learn(parse(opcode, body))
        return None

    def _chosen(self, found, wanted, start):
        if wanted is not None:
            numbers = {number for number, channel in self.channels.items()
                       if channel.topic in wanted}
            found = [item for item in found if item[0] in numbers]
        return found if start is None else [item for item in found if item[2] >= start]

    def _messages(self, content):
        """Return [(channel, sequence, log time, bytes)] of the content of a chunk."""
        found, unpack = [], MESSAGE.unpack_from
        for _, opcode, begin, end in split(content):
            if opcode == IS_MESSAGE:
                channel, sequence, stamp, _ = unpack(content, begin)
                found.append((channel, sequence, stamp, content[begin + 22:end]))
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._learn(parse(opcode, content[begin:end]))
        try:
            numbers = {number: self._numbers[Channel, number]
                       for number in {item[0] for item in found}}
        except KeyError:
            raise Damaged('message of an unknown channel') from None
        if any(number != here for here, number in numbers.items()):
            found = [(numbers[item[0]], *item[1:]) for item in found]
        return self._unpacked(found, set(numbers.values()) - self._plain) if numbers else found

    def _unpacked(self, found, new):
        """
        Return messages as they were sent.

        The first one of a channel tells whether they were compressed.
        """
        if new:
            first = {number: data for number, _, _, data in reversed(found)}
            packed = {number for number in new if self.channels[number].message_encoding == 'cdr'
                      and message_of(first[number]) is not first[number]}
            self._packed |= packed
            self._plain |= new
        if not self._packed:
            return found
        return [(number, sequence, stamp, message_of(data) if number in self._packed else data)
                for number, sequence, stamp, data in found]

    def _learn(self, record):
        """Keep a definition; in the later files of a split bag it may have another number."""
        kind = type(record)
        if self._here.setdefault((kind, record.id), record) != record:
            raise Damaged(f'{kind.__name__.lower()} {record.id} is another one than before')
        if (kind, record.id) in self._numbers:
            return
        known = self.channels if kind is Channel else self._schemas
        if kind is Channel:
            record = replace(record, schema_id=self._numbers.get((Schema, record.schema_id),
                                                                 record.schema_id))
        number = record.id
        if number in known and not _is_same(known[number], record):
            if self._is_first:
                raise Damaged(f'{kind.__name__.lower()} {record.id} is another one than before')
            number = next((n for n, other in known.items() if _is_same(other, record)),
                          max(known) + 1)
        known.setdefault(number, replace(record, id=number))
        self._numbers[kind, record.id] = number


def _is_same(a, b):
    """
    Return whether two definitions are the same, whatever their numbers.

    QoS may differ between parts.
    """
    if isinstance(a, Channel):
        return (a.topic, a.message_encoding, a.schema_id) == (b.topic, b.message_encoding,
                                                              b.schema_id)
    return (a.name, a.encoding, a.data) == (b.name, b.encoding, b.data)


def records(path, topics=None, start=None, follow=False):
    """Yield every :class:`Record` of a bag; see :meth:`Bag.raw`."""
    return Bag(path).records(topics, start, follow)


def metadata(path):
    """Return the rosbag2 metadata of a bag."""
    return Bag(path).metadata()
