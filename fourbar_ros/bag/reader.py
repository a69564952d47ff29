# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Read a bag without ROS: finished, cut by a crash, still being written, or damaged.

A file is walked from record to record, so messages outside chunks and chunks without an index are
read too; where damage hides the next record, the index at the end of the file leads on. The mcap
library reads each record; a damaged chunk costs the messages in that chunk alone. The counts in
statistics and metadata.yaml are compared with the count of messages read.

>>> for record in records('bags/run', ['/fourbar/state']):
...     print(record.time, record.message.theta4)
"""
from bisect import bisect
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, lru_cache
from io import BytesIO
from itertools import chain
import json
from os import SEEK_END
from pathlib import Path
from struct import Struct, unpack
from typing import Any, BinaryIO, NamedTuple
from zlib import crc32

from fourbar_ros.bag import layout, metadata
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Attachment, Channel, Chunk, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream, StreamReader
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC
import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.serde.errors import SerdeError
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
from rosbags.typesys.store import Typestore
import zstandard

BLOCK = 20_000              # messages that are decoded together
ROOM = 2**24                # [bytes] of messages that wait to be checked together
LARGEST = 2**28             # [bytes] of a chunk, packed and unpacked
LINE = 160                  # longest reason [characters] that is quoted of a library
HEAD = Struct('<BQ')        # of a record: opcode, length
MESSAGE = Struct('<HIQQ')   # channel, sequence number, log time, publish time
CRC = Struct('<I')
# the records that hold something; the rest are indexes and statistics
CONTENT: dict[int, Any] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel, Opcode.CHUNK: Chunk,
                           Opcode.MESSAGE: Message, Opcode.METADATA: Metadata,
                           Opcode.ATTACHMENT: Attachment}
KINDS = CONTENT.keys() - {Opcode.ATTACHMENT}        # those that messages need
Progress = Callable[[int], object]      # called with the count of bytes read


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
    """Messages of one topic that are laid out alike, in order."""

    topic: str
    times: Array        # (n,) log times [ns]
    records: Array      # (n,), fields are named by their paths: records['header.stamp.sec']
    indices: Array      # (n,) in the order of writing, from 0, among all messages of the topic

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

    ``path``: folder of a bag, split or not, or an .mcap file; ``progress`` is called with the
    count of bytes read so far. ``files``: the .mcap files, several in a split bag; ``damage``:
    what the last reading could not read, with file, byte and reason, and counts that disagree.
    """

    def __init__(self, path: str | Path, progress: Progress | None = None) -> None:
        """Find the files of a bag; raise BagError if there are none of MCAP."""
        self.path, self._progress = Path(path), progress or (lambda size: None)
        self.files = metadata.files_of(self.path)
        if not any(map(_may_be_mcap, self.files)):
            raise BagError(f'{self.files[0]}: is no MCAP file')
        self.damage: list[str] = []
        self._messages: dict[int, int] = {}     # {index of a file read whole: messages}
        self._topics: dict[str, tuple[Channel, Schema]] = {}        # the newest of a topic
        # {(type, definition): layouts met so far}
        self._layouts: dict[tuple[str, bytes], list[layout.MessageLayout]] = {}

    @property
    def size(self) -> int:
        """Return the size of all files [bytes]."""
        return sum(file.stat().st_size for file in self.files)

    @property
    def is_finished(self) -> bool:
        """Return whether every file has an end: no crash, and no recorder at work."""
        return None not in self.summaries

    @cached_property
    def summaries(self) -> list[Summary | None]:
        """Return the Summary of each file; None if the end is missing or damaged."""
        return [_summary(file) for file in self.files]

    @property
    def has_all_files(self) -> bool:
        """Return whether the names of the files leave out no number between first and last."""
        first, last = (metadata.number_of(self.files[index]) for index in (0, -1))
        return last - first < len(self.files)

    @cached_property
    def is_consistent(self) -> bool:
        """
        Return whether the summaries of all files can be believed without reading the messages.

        They cannot where a file was cut off, grows, or holds messages outside chunks, which have
        no index, or where a file is missing, by its number or by the messages in metadata.yaml.
        """
        if not self.has_all_files:
            return False
        counted = 0
        for summary in self.summaries:
            statistics = summary.statistics if summary else None
            if (summary is None or statistics is None
                    or statistics.chunk_count != len(summary.chunk_indexes)
                    or (statistics.message_count and not statistics.chunk_count)
                    or statistics.channel_count != len(_described_in(summary))
                    or statistics.message_count != sum(
                        statistics.channel_message_counts.values())):
                return False
            counted += statistics.message_count
        return self._count_in_metadata <= counted

    @cached_property
    def about(self) -> dict[str, str]:
        """Return the custom_data of the first file, with why the last one ended; or {}."""
        first = self.about_of(0)
        last = self.about_of(-1) if len(self.files) > 1 else first
        of_the_end = 'ended', 'dropped', metadata.LOST
        return {**last, **{key: text for key, text in first.items() if key not in of_the_end}}

    def about_of(self, index: int) -> dict[str, str]:
        """Return the custom_data in the last metadata of a file, in the first of a cut file."""
        summary = self.summaries[index]
        with open(self.files[index], 'rb') as stream:
            spans = (span for span in _record_spans(stream, summary) if span[1] == Opcode.METADATA)
            for begin, opcode, size in reversed([*spans]) if summary else spans:
                try:
                    record: Any = _record_at(stream, begin, opcode, size)
                    if record.name == metadata.RECORD:
                        custom = metadata.loaded(record.metadata[metadata.KEY]).get('custom_data')
                        return {str(key): str(text) for key, text in (custom or {}).items()}
                except Exception as error:      # of any kind, for wrong bytes
                    self._note(index, f', at byte {begin}: {_reason(error)}')
        return {}

    @cached_property
    def types(self) -> dict[str, str]:
        """Return {topic: type} of all topics; '' for a topic without a schema."""
        if self.is_consistent:
            return {channel.topic: summary.schemas[channel.schema_id].name
                    if channel.schema_id else ''
                    for summary in self.summaries if summary
                    for channel in summary.channels.values()}
        if len(self._messages) < len(self.files):       # not all files are read to their ends yet
            for _ in self.raw():        # which notes topics as it goes
                pass
        return {topic: schema.name for topic, (_, schema) in self._topics.items()}

    # --- messages -------------------------------------------------------------------------------

    def raw(self, topics: Collection[str] | None = None, start: int = 0) -> Iterator[Raw]:
        """Yield every message in the order of writing, of some topics, from a log time [ns] on."""
        self.damage, self._messages = [], {}
        for index, file in enumerate(self.files):
            repeated = _repeated(self.about_of(index)) if index else {}
            schemas: dict[int, Schema] = {}
            channels: dict[int, tuple[Channel, Schema]] = {}
            for record in chain.from_iterable(self.contents(index)):
                if isinstance(record, Message):         # most are
                    if record.channel_id not in channels:
                        self.note_unknown(index, record.channel_id)
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
                    schema = schemas.get(record.schema_id) or Schema(0, b'', '', '')
                    _, before = self._topics.get(record.topic, (record, schema))
                    if before.name != schema.name:
                        raise BagError(f'{file}: {record.topic} has two types, {schema.name} and '
                                       f'{before.name}')
                    if before.data != schema.data and not _are_alike(before, schema):
                        raise BagError(f'{file}: {record.topic} has two definitions of '
                                       f'{schema.name}')
                    channels[record.id] = self._topics[record.topic] = record, schema

    def records(self, topics: Collection[str] | None = None, start: int = 0) -> Iterator[Record]:
        """Yield every :class:`Record` in the order of writing; arguments as of :meth:`raw`."""
        for raw in self.raw(topics, start):
            yield Record(raw.topic, raw.time, self.decode(raw))

    def columns(self, topics: Collection[str] | None = None) -> Iterator[Columns]:
        """Yield the messages of each topic, those whose texts are of equal length together."""
        waiting: dict[str, list[Raw]] = {}
        before: Counter[str] = Counter()        # messages that were yielded, by topic
        for raw in self.raw(topics):
            of_topic = waiting.setdefault(raw.topic, [])
            of_topic.append(raw)
            if len(of_topic) >= BLOCK:
                yield from self._columns(waiting.pop(raw.topic), before[raw.topic])
                before[raw.topic] += BLOCK
        for topic, of_topic in waiting.items():
            yield from self._columns(of_topic, before[topic])

    def _columns(self, messages: list[Raw], first: int) -> Iterator[Columns]:
        if (latest := max(raw.time for raw in messages)) >= 2**63:
            raise BagError(f'{self.path}: {messages[0].topic}: a log time of {latest} ns is none '
                           'of ROS')
        times = np.array([raw.time for raw in messages], np.int64)
        for rows, records in self.arrays(messages[0].topic, [raw.data for raw in messages]):
            yield Columns(messages[0].topic, times[rows], records, first + rows)

    def arrays(self, topic: str, messages: list[bytes]) -> Iterator[tuple[Array, Array]]:
        """Yield (rows, records) of messages of a topic, see :func:`.layout.arrays`."""
        _, schema = self._topics[topic]
        types = self.types_of(topic)
        known = self._layouts.setdefault((schema.name, schema.data), [])
        try:
            yield from layout.arrays(types, schema.name, messages, known)
        except BagError as error:       # of the type alone
            raise BagError(f'{self.path}: {topic}: {error}') from None

    def misfits(self, topic: str, messages: list[bytes]) -> int:
        """Return how many messages of a topic do not fit their definition, 0 if none is known."""
        try:
            types = self.types_of(topic)
        except BagError:
            return 0
        return layout.misfits(types, self._topics[topic][1].name, messages)

    def decode(self, raw: Raw) -> Any:
        """Return a message as an object of its fields; raises BagError."""
        store = self.types_of(raw.topic)
        try:
            with suppress(SerdeError):
                return store.deserialize_cdr(raw.data, raw.type)
            # behind an empty sequence of doubles at its end Fast CDR aligns: 4 bytes too many
            return store.deserialize_cdr(raw.data[:-4], raw.type)
        except (SerdeError, ValueError, IndexError, AssertionError, KeyError) as error:
            raise BagError(f'{self.path}: {raw.topic}: a message does not fit its '
                           f'definition: {_reason(error)}') from None

    def types_of(self, topic: str) -> Typestore:
        """Return the types that define the messages of a topic; BagError if they are not known."""
        if topic not in self._topics:
            next(self.raw([topic]), None)
        channel, schema = self._topics[topic]
        if channel.message_encoding != 'cdr' or schema.encoding != 'ros2msg':
            raise BagError(f'{self.path}: {topic}: {channel.message_encoding or "no"} messages '
                           f'defined in {schema.encoding or "nothing"}; only cdr messages defined '
                           'in ros2msg are decoded')
        try:
            return _types(schema.name, schema.data)
        except Exception as error:      # the library has no class for errors in texts
            raise BagError(f'{self.path}: {topic}: the definition of {schema.name} cannot be '
                           f'read: {_reason(error)}') from None

    def definition_of(self, topic: str) -> str:
        return str(self._topics[topic][1].data.decode(errors='replace'))

    def channel_of(self, topic: str) -> dict[str, str]:
        """Return the metadata of a topic's channel: QoS profiles (YAML), type hash; {} without."""
        if topic not in self._topics:
            next(self.raw([topic]), None)
        return self._topics[topic][0].metadata if topic in self._topics else {}

    def check(self, index: int) -> None:
        """Compare all bytes of a finished file with the checksum; add to ``damage``."""
        if self.summaries[index] is None:
            return
        with open(self.files[index], 'rb') as stream:
            try:
                for _ in StreamReader(stream, emit_chunks=True, validate_crcs=True).records:
                    pass
            except Exception as error:      # of any kind, for wrong bytes
                self._note(index, f': {_reason(error)}')

    # --- a file ---------------------------------------------------------------------------------

    @cached_property
    def _described(self) -> Mapping[str, Any]:
        with suppress(Exception):       # of any kind, for wrong bytes
            text = (self.files[0].parent / 'metadata.yaml').read_text(encoding='utf-8')
            described = metadata.loaded(text)['rosbag2_bagfile_information']
            return described if isinstance(described, dict) else {}
        return {}

    @property
    def _count_in_metadata(self) -> int:
        """Return how many messages metadata.yaml counts in all files; 0 without a count."""
        stated = self._described.get('message_count') if self.path.is_dir() else 0
        return stated if isinstance(stated, int) else 0

    @property
    def damage_in_short(self) -> str:
        """Return the first damage and the count of the rest; '' without damage."""
        more = f' (and {len(self.damage) - 1} more)' if len(self.damage) > 1 else ''
        return self.damage[0] + more if self.damage else ''

    def refuse_damage(self) -> None:
        """Raise BagError if the last reading could not read all."""
        if self.damage:
            raise BagError(f'{self.path}: {self.damage_in_short}; fourbar bag recover keeps the '
                           'rest')

    def _note(self, index: int, text: str) -> None:
        if (text := self.files[index].name + text) not in self.damage:
            self.damage.append(text)

    def note_unknown(self, index: int, channel: int) -> None:
        """Note once as damage that a channel is not described: its messages have no topic."""
        self._note(index, f': messages of channel {channel}, which is not described')

    def contents(self, index: int, kinds: Collection[int] = KINDS
                 ) -> Iterator[list[McapRecord]]:
        """Yield the records of a file, those of a chunk together; note damage and go on."""
        file, summary = self.files[index], self.summaries[index]
        before = sum(earlier.stat().st_size for earlier in self.files[:index])
        mode = self._described.get('compression_mode')
        counts: Counter[int] = Counter()        # messages of each channel
        with open(file, 'rb') as stream:
            if summary:
                yield [*summary.schemas.values(), *_described_in(summary)]
            for begin, opcode, size in _record_spans(stream, summary, kinds):
                try:
                    record = _record_at(stream, begin, opcode, size)
                    content = _unpacked(record) if isinstance(record, Chunk) else [record]
                    if isinstance(record, Metadata) and record.name == metadata.RECORD:
                        # rosbag2 writes metadata.yaml at the end alone, this before all messages
                        with suppress(Exception):       # of any kind, for wrong bytes
                            mode = mode or metadata.loaded(record.metadata[metadata.KEY]).get(
                                'compression_mode')
                    if str(mode).lower() == 'message':      # by rosbag2, each for itself
                        content = [replace(each, data=_unzipped(each.data, LARGEST))
                                   if isinstance(each, Message) else each for each in content]
                except Exception as error:      # whatever a library makes of wrong bytes
                    self._note(index, f', at byte {begin}: {_reason(error)}')
                    continue
                counts.update([each.channel_id for each in content if isinstance(each, Message)])
                self._progress(before + stream.tell())
                yield content
        self._messages[index] = messages = sum(counts.values())
        statistics = summary.statistics if summary else None
        if statistics and statistics.message_count != messages:
            self._note(index, f': holds {messages} messages that can be read, its statistics '
                              f'count {statistics.message_count}')
        for channel, count in statistics.channel_message_counts.items() if statistics else ():
            if counts[channel] != count:
                self._note(index, f': holds {counts[channel]} messages of channel {channel} that '
                                  f'can be read, its statistics count {count}')
        read = sum(self._messages.values())
        if len(self._messages) == len(self.files) and read < self._count_in_metadata:
            self.damage.append(f'{self.path.name}: holds {read} messages that can be read, '
                               f'metadata.yaml counts {self._count_in_metadata}')


def records(path: str | Path, topics: Collection[str] | None = None, start: int = 0
            ) -> Iterator[Record]:
    """Yield every record of a bag, as :meth:`Bag.raw`; at its end BagError names any damage."""
    bag = Bag(path)
    yield from bag.records(topics, start)
    bag.refuse_damage()


@lru_cache
def _types(name: str, definition: bytes) -> Typestore:
    """Return the types that a definition gives; reading a definition takes 10 ms and more."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(definition.decode(), name))
    for _, fields in store.fielddefs.values():
        for _, (kind, content) in fields:
            if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                (kind, content), _ = content
            if kind == Nodetype.NAME and content not in store.fielddefs:
                raise ValueError(f'it does not define {content}')
    return store


def _are_alike(first: Schema, second: Schema) -> bool:
    """Return whether two definitions of one type have the same fields, whatever their comments."""
    if {first.encoding, second.encoding} != {'ros2msg'}:
        return True             # neither is decoded, or those alone that are in ros2msg
    with suppress(Exception):   # of any kind: a definition that cannot be read
        first_fields, second_fields = (
            {name: fields for name, (_, fields) in _types(each.name, each.data).fielddefs.items()}
            for each in (first, second))
        return first_fields == second_fields
    return False


def _record_spans(stream: BinaryIO, summary: Summary | None, kinds: Collection[int] = KINDS
                  ) -> Iterator[tuple[int, int, int]]:
    """
    Yield (first byte, kind, size [bytes]) of the records of some kinds in a file.

    The head of a record tells where the next record begins. The index of a finished file, if
    there is one, is more reliable about chunks and metadata, so the walk goes on at the index
    behind a damaged head, which is yielded as kind 0; without an index the walk ends there.
    """
    spans: list[tuple[int, int, int, int]] = []     # with the size of the message index behind it
    if summary:
        spans = [(index.chunk_start_offset, Opcode.CHUNK, index.chunk_length,
                  index.message_index_length) for index in summary.chunk_indexes]
        spans += [(index.offset, kind, index.length, 0)
                  for kind, indexes in ((Opcode.METADATA, summary.metadata_indexes),
                                        (Opcode.ATTACHMENT, summary.attachment_indexes))
                  for index in indexes]
    known = {first: (kind, size, behind) for first, kind, size, behind in spans
             if size > HEAD.size}
    starts = sorted(known)
    is_behind_data = False
    begin, end = len(MCAP0_MAGIC), stream.seek(0, SEEK_END)
    while begin + HEAD.size <= end:
        after = bisect(starts, begin)
        limit = starts[after] if after < len(starts) else end   # no record goes beyond this byte
        if begin in known:
            opcode, size, behind = known[begin]
            limit = end             # ... but a wrong index may say so
        else:
            stream.seek(begin)
            opcode, length = HEAD.unpack(stream.read(HEAD.size))
            size, behind = HEAD.size + length, 0
        if opcode == Opcode.DATA_END:       # a damaged summary follows, unless this is the damage
            is_behind_data, kinds = True, [Opcode.CHUNK]
        if begin + size > limit or summary and not opcode:
            if summary or size > LARGEST:       # else the file was cut in this record
                yield begin, 0, size
            begin = limit
            continue
        if opcode in kinds:
            yield begin, opcode, size
        begin += size + behind
    if summary and not is_behind_data:      # the walk went past the end of the data
        yield begin, 0, 0


def _record_at(stream: BinaryIO, begin: int, opcode: int, size: int) -> McapRecord:
    if not opcode:
        raise ValueError('no record')
    if size > LARGEST:
        raise ValueError(f'a record of {size} bytes')
    stream.seek(begin + HEAD.size)
    return _parsed(opcode, stream.read(size - HEAD.size), 0, size - HEAD.size)


def _unpacked(chunk: Chunk) -> list[McapRecord]:
    """Return the records in a chunk; ValueError for one that is damaged or too large."""
    if chunk.uncompressed_size > LARGEST:
        raise ValueError(f'a chunk of {chunk.uncompressed_size} bytes')
    if chunk.compression not in ('', 'lz4', 'zstd'):
        raise ValueError(f'compressed by {chunk.compression}, which is not known here')
    if chunk.compression == 'zstd':
        chunk = replace(chunk, compression='', data=_unzipped(chunk.data, chunk.uncompressed_size))
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)
    if size != chunk.uncompressed_size:
        raise ValueError(f'a chunk of {size} bytes that says {chunk.uncompressed_size}')
    content, records, begin = stream.read(size), [], 0
    while begin < size:
        opcode, length = HEAD.unpack_from(content, begin)
        begin, end = begin + HEAD.size, begin + HEAD.size + length
        if end > size:
            raise ValueError('a record that goes beyond its chunk')
        if opcode in KINDS:
            records.append(_parsed(opcode, content, begin, end))
        begin = end
    return records


def _unzipped(data: bytes, most: int) -> bytes:
    if zstandard.frame_content_size(data) > most:
        raise ValueError(f'packed data of more than {most} bytes')
    return bytes(zstandard.decompress(data, most))


def _parsed(opcode: int, content: bytes, begin: int, end: int) -> McapRecord:
    """Return the record of a kind, one of CONTENT, in the bytes from ``begin`` to ``end``."""
    if opcode == Opcode.MESSAGE:        # most are
        channel, sequence, time, published = MESSAGE.unpack_from(content, begin)
        return Message(channel, time, content[begin + MESSAGE.size:end], published, sequence)
    stream = BytesIO(content[begin:end])
    record: McapRecord = CONTENT[opcode].read(ReadDataStream(stream))
    if opcode in (Opcode.CHUNK, Opcode.ATTACHMENT) and stream.read(1):
        raise ValueError('a record that ends before its length says')       # which is damaged
    if opcode == Opcode.ATTACHMENT and CRC.unpack_from(content, end - CRC.size)[0] not in (
            0, crc32(content[begin:end - CRC.size])):
        raise CRCValidationError(0, 0, record)
    return record


def _may_be_mcap(file: Path) -> bool:
    with open(file, 'rb') as stream:        # which may be shorter, or empty: cut at its begin
        return bytes(MCAP0_MAGIC).startswith(stream.read(len(MCAP0_MAGIC)))


def _summary(file: Path) -> Summary | None:
    """Return the summary at the end of a finished file if the checksum is right, else None."""
    with open(file, 'rb') as stream, suppress(Exception):       # of any kind, for wrong bytes
        stream.seek(-37, SEEK_END)      # opcode and length, footer, magic
        opcode, _, start, _, stated, magic = unpack('<BQQQI8s', stream.read(37))
        if opcode != Opcode.FOOTER or magic != MCAP0_MAGIC:
            return None
        if not start:
            return Summary()            # a writer may leave it out
        stream.seek(start)
        if not stated or crc32(stream.read()[:-12]) == stated:
            stream.seek(0)
            return make_reader(stream).get_summary()
    return None


def _described_in(summary: Summary) -> list[Channel]:
    """Return the channels of an index whose schemas are in it too; a writer may omit schemas."""
    return [channel for channel in summary.channels.values()
            if not channel.schema_id or channel.schema_id in summary.schemas]


def _reason(error: Exception) -> str:
    if isinstance(error, CRCValidationError):
        return 'its checksum is wrong'
    if isinstance(error, UnicodeDecodeError):       # whose text quotes all that was decoded
        return 'a text is not UTF-8'
    text = ' '.join(str(error)[:10 * LINE].split()) or type(error).__name__
    return text if len(text) <= LINE else f'{text[:LINE]}...'


def software_of(about: Mapping[str, str]) -> dict[str, str]:
    """Return {name: version} of the software that recorded a bag; {} if not known."""
    with suppress(ValueError):
        versions = json.loads(about.get('software', ''))
        if isinstance(versions, dict):
            return {name: str(version) for name, version in versions.items()}
    return {}


def _repeated(about: Mapping[str, str]) -> dict[str, int]:
    """Return {topic: first new sequence number}: version 1 began a file with old messages."""
    try:
        sequences = json.loads(about['numbers'])
        return {topic: int(sequences[topic][0]) for topic in json.loads(about['repeats'])}
    except (KeyError, TypeError, ValueError, IndexError):
        return {}
