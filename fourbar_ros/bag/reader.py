# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Read a bag without ROS: finished, cut by a crash, still being written, or damaged.

The mcap library reads, chunk by chunk; a chunk that is damaged costs its own messages alone.

>>> for record in records('bags/run', ['/fourbar/state']):
...     print(record.time, record.message.theta4)
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, lru_cache
from io import BytesIO
import json
from os import SEEK_END
from pathlib import Path
import re
from struct import Struct, unpack
from typing import Any, BinaryIO, NamedTuple
from zlib import crc32

from fourbar_ros.bag import metadata
from fourbar_ros.bag.layout import arrays, MessageLayout
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import get_chunk_data_stream, StreamReader
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC
import numpy as np
from rosbags.serde.errors import SerdeError
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
from rosbags.typesys.store import Typestore
import zstandard

BLOCK = 20_000              # messages that are decoded together
LARGEST = 2**28             # [bytes] of a chunk, packed and unpacked
HEAD = Struct('<BQ')        # of a record: opcode, length
MESSAGE = Struct('<HIQQ')   # channel, sequence number, log time, publish time
# the records that are read; others are indexes and statistics
KINDS: dict[int, Any] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel, Opcode.MESSAGE: Message,
                         Opcode.CHUNK: Chunk, Opcode.METADATA: Metadata}
Progress = Callable[[int], object]      # called with the number of bytes read


class Raw(NamedTuple):
    """One recorded message as it was sent; log time in ns."""

    topic: str
    type: str
    time: int
    sequence: int
    data: bytes


class Record(NamedTuple):
    """One recorded message, decoded; log time in ns."""

    topic: str
    time: int
    message: Any


class Columns(NamedTuple):
    """
    Messages of one topic, in order: n log times [ns] and a structured array of shape (n,).

    The fields of ``records`` are named by their paths: ``records['header.stamp.sec']``.
    """

    topic: str
    times: Array
    records: Array

    @property
    def stamps(self) -> Array | None:
        """Return header.stamp of each message [ns], None for a type without a header."""
        return stamps_of(self.records)


def stamps_of(records: Array) -> Array | None:
    """Return header.stamp [ns] of records of messages, None for a type without a header."""
    if 'header.stamp.sec' not in (records.dtype.names or ()):
        return None
    return np.asarray(records['header.stamp.sec'].astype(np.int64) * 10**9
                      + records['header.stamp.nanosec'])


class Bag:
    """
    A bag to be read, any number of times.

    Parameters
    ----------
    path : str or Path
        Folder of a bag, split or not, or an .mcap file.
    progress : callable, optional
        Called with the number of bytes read so far.

    Attributes
    ----------
    files : list of Path
        The .mcap files; one for each part of a split bag.
    is_finished : bool
        Whether every file has its end: no crash, and no recorder at work.
    damage : list of str
        What the last reading could not read: where and why.

    """

    def __init__(self, path: str | Path, progress: Progress | None = None) -> None:
        self.path, self._progress = Path(path), progress or (lambda size: None)
        self.files = metadata.files_of(self.path)
        if not any(map(_may_be_mcap, self.files)):
            raise BagError(f'{self.files[0]}: is no MCAP file')
        self.damage: list[str] = []
        self._topics: dict[str, tuple[Channel, Schema]] = {}        # the newest of each
        # met so far, by type and definition
        self._layouts: dict[tuple[str, bytes], list[MessageLayout]] = {}

    @property
    def size(self) -> int:
        """Return the size of all files [bytes]."""
        return sum(file.stat().st_size for file in self.files)

    @property
    def is_finished(self) -> bool:
        """Return whether every file has its end."""
        return None not in self.summaries

    @cached_property
    def summaries(self) -> list[Summary | None]:
        """Return the Summary of each file; None without an end, or with a damaged one."""
        return [_summary(file) for file in self.files]

    @cached_property
    def about(self) -> dict[str, str]:
        """
        Return the custom_data of the bag: scene, node, versions; empty if it has none.

        Of a split bag they are those of the first file; the last one says why recording ended.
        """
        first = self.about_of(0)
        last = self.about_of(-1) if len(self.files) > 1 else first
        of_the_end = 'ended', 'dropped'
        return {**last, **{key: text for key, text in first.items() if key not in of_the_end}}

    def about_of(self, place: int) -> dict[str, str]:
        """Return the custom_data in a file's last metadata, in its first ones if it was cut."""
        summary = self.summaries[place]
        with open(self.files[place], 'rb') as stream:
            places = (each for each in _places(stream, summary) if each[1] == Opcode.METADATA)
            for each in reversed([*places]) if summary else places:
                with suppress(Exception):       # of any kind, for wrong bytes
                    record: Any = _record_at(stream, *each)
                    if record.name == metadata.RECORD:
                        custom = metadata.loaded(record.metadata[metadata.KEY]).get('custom_data')
                        return {str(key): str(text) for key, text in (custom or {}).items()}
        return {}

    @cached_property
    def types(self) -> dict[str, str]:
        """Return {topic: type} of all topics."""
        found = {}
        for summary in self.summaries:
            if summary is None:
                for _ in self.raw():
                    pass
                return {topic: schema.name for topic, (_, schema) in self._topics.items()}
            for channel in summary.channels.values():
                schema = summary.schemas.get(channel.schema_id)
                found[channel.topic] = schema.name if schema else ''
        return found

    # --- messages -------------------------------------------------------------------------------

    def raw(self, topics: Collection[str] | None = None, start: int = 0) -> Iterator[Raw]:
        """
        Yield every message in the order of writing.

        ``topics``: only these; ``start``: only from this log time [ns] on.
        """
        self.damage = []
        for place, file in enumerate(self.files):
            repeated = _repeated(self.about_of(place)) if place else {}
            schemas: dict[int, Schema] = {}
            channels: dict[int, tuple[Channel, Schema]] = {}
            for record in self.contents(place):
                if isinstance(record, Message):         # most are
                    if record.channel_id not in channels:
                        self.note_unknown(place, record.channel_id)
                        continue
                    channel, schema = channels[record.channel_id]
                    topic = channel.topic
                    if ((topics is None or topic in topics) and record.log_time >= start
                            and record.sequence >= repeated.get(topic, 0)):
                        yield Raw(topic, schema.name, record.log_time, record.sequence,
                                  record.data)
                elif isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel):
                    schema = schemas.get(record.schema_id) or Schema(0, b'', 'none', '')
                    _, before = self._topics.get(record.topic, (record, schema))
                    if before.name != schema.name:
                        raise BagError(f'{file}: {record.topic} has two types, {schema.name} and '
                                       f'{before.name}')
                    channels[record.id] = self._topics[record.topic] = record, schema

    def records(self, topics: Collection[str] | None = None, start: int = 0) -> Iterator[Record]:
        """Yield every :class:`Record` in the order of writing; arguments as of :meth:`raw`."""
        for raw in self.raw(topics, start):
            yield Record(raw.topic, raw.time, self.decode(raw))

    def columns(self, topics: Collection[str] | None = None) -> Iterator[Columns]:
        """
        Yield :class:`Columns`: the messages of each topic, many at once.

        Messages with texts or sequences of other lengths come in Columns of their own.
        """
        waiting: dict[str, list[Raw]] = {}
        for raw in self.raw(topics):
            of_topic = waiting.setdefault(raw.topic, [])
            of_topic.append(raw)
            if len(of_topic) >= BLOCK:
                yield from self._columns(waiting.pop(raw.topic))
        for of_topic in waiting.values():
            yield from self._columns(of_topic)

    def _columns(self, messages: list[Raw]) -> Iterator[Columns]:
        times = np.array([raw.time for raw in messages], np.int64)
        for rows, records in self.arrays(messages[0].topic, [raw.data for raw in messages]):
            yield Columns(messages[0].topic, times[rows], records)

    def arrays(self, topic: str, messages: list[bytes]) -> Iterator[tuple[Array, Array]]:
        """Yield (rows, records) of messages of a topic, see :func:`.layout.arrays`."""
        _, schema = self._topics[topic]
        known = self._layouts.setdefault((schema.name, schema.data), [])
        return arrays(self._store(schema), schema.name, messages, known)

    def decode(self, raw: Raw) -> Any:
        """Return a message as an object of its fields; raises BagError."""
        _, schema = self._topics[raw.topic]
        try:
            with suppress(SerdeError):
                return self._store(schema).deserialize_cdr(raw.data, schema.name)
            # behind an empty sequence of doubles at its end Fast CDR aligns: 4 bytes too many
            return self._store(schema).deserialize_cdr(raw.data[:-4], schema.name)
        except (SerdeError, ValueError, IndexError, AssertionError, KeyError) as error:
            raise BagError(f'{self.path}: {raw.topic}: a message does not fit its '
                           f'definition: {error}') from None

    def _store(self, schema: Schema) -> Typestore:
        """Return the types that a schema defines; raises BagError."""
        if schema.encoding != 'ros2msg':
            raise BagError(f'{self.path}: {schema.name} is defined in {schema.encoding!r}; '
                           'only ros2msg is decoded: rosbags-convert makes that')
        try:
            return _types(schema.name, schema.data)
        except Exception as error:      # the library has no class of its own for bad texts
            raise BagError(f'{self.path}: the definition of {schema.name} cannot be read: '
                           + ' '.join(str(error).split())) from None

    def definition_of(self, topic: str) -> str:
        """Return the text that defines the type of a topic met so far."""
        return str(self._topics[topic][1].data.decode(errors='replace'))

    def channel_of(self, topic: str) -> dict[str, str]:
        """Return the metadata of a topic's channel: QoS profiles (YAML), type hash; {} without."""
        if topic not in self._topics:
            next(self.raw([topic]), None)
        return self._topics[topic][0].metadata if topic in self._topics else {}

    def check(self) -> None:
        """Compare all bytes of each finished file with its checksum; add to ``damage``."""
        for file, summary in zip(self.files, self.summaries):
            with open(file, 'rb') as stream:
                try:
                    for _ in StreamReader(stream, emit_chunks=True,
                                          validate_crcs=True).records if summary else ():
                        pass
                except Exception as error:      # of any kind, for wrong bytes
                    self.damage.append(f'{file.name}: {error}')

    # --- a file ---------------------------------------------------------------------------------

    @cached_property
    def _is_packed(self) -> bool:
        """Return whether rosbag2 compressed each message, as metadata.yaml says."""
        with suppress(OSError, ValueError):
            text = (self.files[0].parent / 'metadata.yaml').read_text(encoding='utf-8')
            return bool(re.search(r'^\s+compression_mode: ["\']?message', text, re.M | re.I))
        return False

    def note_unknown(self, place: int, channel: int) -> None:
        """Note once as damage that a channel is not described: its messages have no topic."""
        text = f'{self.files[place].name}: messages of channel {channel}, which is not described'
        if text not in self.damage:
            self.damage.append(text)

    def contents(self, place: int) -> Iterator[McapRecord]:
        """Yield the records of a file, those of a chunk in its place; note damage and go on."""
        file, summary = self.files[place], self.summaries[place]
        before = sum(other.stat().st_size for other in self.files[:place])
        with open(file, 'rb') as stream:
            if summary:
                yield from (*summary.schemas.values(), *summary.channels.values())
            for begin, opcode, size in _places(stream, summary):
                try:
                    record = _record_at(stream, begin, opcode, size)
                    content = _unpacked(record) if isinstance(record, Chunk) else [record]
                    if self._is_packed:
                        content = [replace(each, data=zstandard.decompress(each.data))
                                   if isinstance(each, Message) else each for each in content]
                except Exception as error:      # whatever a library makes of wrong bytes
                    self.damage.append(f'{file.name}, at byte {begin}: {error!r}')
                    continue
                self._progress(before + stream.tell())
                yield from content


def records(path: str | Path, topics: Collection[str] | None = None, start: int = 0
            ) -> Iterator[Record]:
    """Yield every :class:`Record` of a bag; arguments as of :meth:`Bag.raw`."""
    return Bag(path).records(topics, start)


@lru_cache
def _types(name: str, definition: bytes) -> Typestore:
    """Return the types that a definition gives; to read it takes 10 ms and more."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(definition.decode(), name))
    return store


def _places(stream: BinaryIO, summary: Summary | None) -> Iterator[tuple[int, int, int]]:
    """
    Yield (first byte, kind, size [bytes]) of the records of a file that are read.

    The summary of a finished file knows where they are, whatever happened to others. Without it,
    each head tells where the next record begins; behind a senseless one nothing can be found.
    """
    if summary:
        yield from sorted([(index.chunk_start_offset, Opcode.CHUNK, index.chunk_length)
                           for index in summary.chunk_indexes]
                          + [(index.offset, Opcode.METADATA, index.length)
                             for index in summary.metadata_indexes])
        return
    kinds: Collection[int] = KINDS
    begin, end = len(MCAP0_MAGIC), stream.seek(0, SEEK_END)
    while begin + HEAD.size <= end:
        stream.seek(begin)
        opcode, length = HEAD.unpack(stream.read(HEAD.size))
        if opcode == Opcode.DATA_END:       # a damaged summary follows, unless this is the damage
            kinds = [Opcode.CHUNK]
        size = HEAD.size + length
        if length > LARGEST or opcode in kinds and begin + size <= end:     # else it was cut
            yield begin, opcode, size
        begin += size


def _record_at(stream: BinaryIO, begin: int, opcode: int, size: int) -> McapRecord:
    """Return the record of a kind that begins at a byte of a file."""
    if size > LARGEST:
        raise ValueError(f'a record of {size} bytes')
    stream.seek(begin + HEAD.size)
    return _parsed(opcode, stream.read(size - HEAD.size), 0, size)


def _unpacked(chunk: Chunk) -> list[McapRecord]:
    """Return the records in a chunk, checked by its CRC."""
    if chunk.uncompressed_size > LARGEST:
        raise ValueError(f'a chunk of {chunk.uncompressed_size} bytes')
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)
    content, found, begin = stream.read(size), [], 0
    while begin < size:
        opcode, length = HEAD.unpack_from(content, begin)
        begin, end = begin + HEAD.size, begin + HEAD.size + length
        if opcode in KINDS:
            found.append(_parsed(opcode, content, begin, end))
        begin = end
    return found


def _parsed(opcode: int, content: bytes, begin: int, end: int) -> McapRecord:
    """Return the record of a kind that stands between two bytes, behind its head."""
    if opcode == Opcode.MESSAGE:        # most are
        channel, sequence, time, published = MESSAGE.unpack_from(content, begin)
        return Message(channel, time, content[begin + MESSAGE.size:end], published, sequence)
    record: McapRecord = KINDS[opcode].read(ReadDataStream(BytesIO(content[begin:end])))
    return record


def _may_be_mcap(file: Path) -> bool:
    """Return whether a file begins as one of MCAP does, or was cut in its first bytes."""
    with open(file, 'rb') as stream:
        return bytes(MCAP0_MAGIC).startswith(stream.read(len(MCAP0_MAGIC)))


def _summary(file: Path) -> Summary | None:
    """Return the end of a finished file if its checksum is right, else None."""
    with open(file, 'rb') as stream, suppress(Exception):       # of any kind, for wrong bytes
        stream.seek(-37, SEEK_END)      # opcode and length, footer, magic
        start, _, stated = unpack('<QQI', stream.read(29)[HEAD.size:])
        stream.seek(start)
        if not stated or crc32(stream.read()[:-12]) == stated:
            stream.seek(0)
            return make_reader(stream).get_summary()
    return None


def software_of(about: Mapping[str, str]) -> dict[str, str]:
    """Return {name: version} of what recorded a bag, from its custom_data; {} if not known."""
    with suppress(ValueError):
        found = json.loads(about.get('software', ''))
        if isinstance(found, dict):
            return {name: str(version) for name, version in found.items()}
    return {}


def _repeated(about: Mapping[str, str]) -> dict[str, int]:
    """
    Return {topic: number of its first new message} of a later file of a split bag.

    Version 1 began each file with the newest message of every topic, under its old number.
    """
    try:
        numbers = json.loads(about['numbers'])
        return {topic: int(numbers[topic][0]) for topic in json.loads(about['repeats'])}
    except (KeyError, TypeError, ValueError, IndexError):
        return {}
