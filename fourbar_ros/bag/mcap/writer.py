# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Write an MCAP file that stays whole up to the last flush, even after a crash.

The record types are the mcap library's, the order is ours: one append per flush. It is undone if
the disk refuses it, so that the file can always be finished in place. (The library's own Writer
counts messages that never reached the disk and cannot forget them; it also takes 3 us a message.)
The end of the file repeats definitions, counts, times and indices.
"""
from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
import struct
from typing import BinaryIO, Union
import zlib

from fourbar_ros.bag.mcap.records import (
    Damaged,
    encoded,
    HEAD,
    IS_MESSAGE,
    MAGIC,
    MESSAGE,
    parse,
    SEAL,
    seal,
    split,
    unpacked,
)
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
import zstandard

CHUNK_SIZE = 1 << 20          # [bytes] a chunk is closed at this size, flush or not
LEVEL = 1       # of zstd: 0.4 of the time and 1.03 of the size of the default, 3
# So many chunks repeat each schema and channel, under their checksum: one may get damaged.
COPIES = 2
_MESSAGE = struct.Struct('<BQHIQQ')
_INDEX = struct.Struct('<BQHI')

Definition = Union[Schema, Channel]
Index = Mapping[int, list[int]]          # {channel: [time, offset, time, offset, ...]}


class Container:
    """
    An MCAP file being written; ``file`` is an unbuffered binary file at its beginning.

    Every method leaves a file of whole records, also when it raises OSError.
    """

    def __init__(self, file: BinaryIO, profile: str, library: str) -> None:
        """Write the magic and the header, which names the profile and the writing library."""
        self._file = file
        self.size = 0                                  # [bytes] of whole records in the file
        self._crc = 0                                  # checksum of these bytes
        self._summary = Summary()
        self.schemas, self.channels = self._summary.schemas, self._summary.channels
        self.counts = self._summary.counts             # messages in the file, by channel
        self._compressor = zstandard.ZstdCompressor(level=LEVEL)
        # {channel: sequence number of its first message, of its last message}
        self.first: dict[int, int] = {}
        self.last: dict[int, int] = {}
        # {encoded schema or channel that later chunks must hold: copies in the file so far}
        self._pending: dict[bytes, int] = {}
        self._unchecked: set[bytes] = set()    # encoded definitions that no checksum covered
        self._length = 0                               # [bytes] that wait for the next chunk
        self._clear()
        self._append(MAGIC + encoded(Header(profile, library)))

    @property
    def start(self) -> int | None:
        """Return the log time of the first message in the file [ns], None if there is none."""
        return self._summary.start

    @property
    def end(self) -> int:
        """Return the log time of the last message in the file [ns]."""
        return self._summary.end

    def add_schema(self, name: str, text: str, encoding: str = 'ros2msg') -> int:
        """Define a message type for the next messages; return the number of the schema."""
        schema = Schema(len(self.schemas) + 1, text.encode(), encoding, name)
        self._define(self.schemas, schema)
        return int(schema.id)

    def add_channel(self, topic: str, schema: int, metadata: dict[str, str]) -> int:
        """Define a topic of CDR messages for the next messages; return its number."""
        channel = Channel(len(self.channels) + 1, topic, 'cdr', metadata, schema)
        self._define(self.channels, channel)
        return int(channel.id)

    def copy(self, record: Definition, checked: bool = True) -> bool:
        """
        Take a Schema or Channel of another file under the number it has.

        The same one again is no error. One that a checksum covers (``checked``) replaces one that
        none did, as long as no message was written under it; returns whether it did. Any other
        difference raises Damaged.
        """
        known = self.schemas if isinstance(record, Schema) else self.channels
        if isinstance(record, Channel) and record.schema_id not in (0, *self.schemas):
            raise Damaged(f'the schema of {record.topic} is missing')
        other, data = known.get(record.id), encoded(record)
        if other == record:
            if checked:
                self._unchecked.discard(data)
            return False
        if other is not None:
            old = encoded(other)
            is_free = old in self._unchecked and self._pending.get(old) == 0 and not self._index
            if not (checked and is_free):
                raise Damaged(
                    f'{type(record).__name__.lower()} {record.id} is another one than before')
            del self._pending[old]
        if not checked:
            self._unchecked.add(data)
        self._define(known, record)
        return other is not None

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record, sealed by a checksum, behind all messages so far."""
        self.flush()
        sealed = Metadata(name=name, metadata={**values, SEAL: ''})
        sealed.metadata[SEAL] = seal(sealed)
        offset, record = self.size, encoded(sealed)
        self._append(record)
        self._summary.add_metadata(offset, len(record), name)

    def add_message(self, channel: int, sequence: int, time: int, data: bytes,
                    published: int | None = None) -> None:
        """Take a message of a log time [ns], unchecked; the next :meth:`flush` writes it."""
        self.add_messages(time, ((channel, sequence, data),), published)

    def add_messages(self, time: int, messages: Iterable[tuple[int, int, bytes]],
                     published: int | None = None) -> None:
        """
        Take messages, (channel, sequence number, bytes), of one log time [ns].

        They are written by :meth:`flush`, called here once CHUNK_SIZE bytes wait. ``published``
        [ns] is when they were sent, by default the log time.
        """
        index, parts, last, length = self._index, self._parts, self.last, self._length
        published = time if published is None else published
        for channel, sequence, data in messages:
            if channel not in last:
                self.first[channel] = sequence
            last[channel] = sequence
            index[channel] += (time, length)
            size = len(data)
            parts.append(_MESSAGE.pack(IS_MESSAGE, MESSAGE.size + size, channel, sequence, time,
                                       published))
            parts.append(data)
            length += _MESSAGE.size + size
        self._length = length
        if length > CHUNK_SIZE:
            self.flush()

    def flush(self) -> None:
        """
        Write the messages taken so far as one chunk.

        On OSError the file is as before and the messages are gone.
        """
        if not self._index:
            return
        content, index = b''.join(self._parts), self._index
        try:
            self._append_chunk(self._chunk(content), index)
        finally:
            self._clear()

    def copy_chunk(self, body: bytes, check: Callable[[Chunk, list[int]], None]
                   ) -> list[Definition]:
        """
        Write a chunk of another file, given as the body of its record, with a new message index.

        ``check(chunk, log times [ns])`` may raise Damaged to refuse it; then nothing is written.
        The content is copied as it is, or packed anew behind the schemas and channels that this
        file still has to hold. Returns the schemas and channels in it that replaced damaged ones.
        """
        chunk = parse(Opcode.CHUNK, body)
        content, records = unpacked(chunk), []
        index: defaultdict[int, list[int]] = defaultdict(list)
        first: dict[int, int] = {}          # sequence numbers by channel, as in self.first
        last: dict[int, int] = {}
        for offset, opcode, start, end in split(content):
            if opcode == IS_MESSAGE:
                channel, sequence, time, _ = MESSAGE.unpack_from(content, start)
                first.setdefault(channel, sequence)
                last[channel] = sequence
                index[channel] += (time, offset)
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                records.append(parse(opcode, content[start:end]))
        known = self.channels.keys() | {r.id for r in records if isinstance(r, Channel)}
        if not index.keys() <= known:
            raise Damaged('chunk has messages of an unknown channel')
        check(chunk, times_of(index))
        replaced = [record for record in records if self.copy(record)]
        missing = self._definitions({encoded(record) for record in records})
        if missing and index:
            chunk = self._chunk(missing + content)
            for entries in index.values():          # the offsets, behind the times
                entries[1::2] = [offset + len(missing) for offset in entries[1::2]]
        if index:
            self._append_chunk(chunk, index)
            self.first = {**first, **self.first}
            self.last.update(last)
            self._clear()
        return replaced

    def finish(self) -> None:
        """Write the end: statistics and indices; on OSError the file stays as it was."""
        self.flush()
        if not self._summary.chunks:
            # no message, but a reader may ask for the topics
            self._append(self._definitions())
        self._append(self._summary.ending(self.size, self._crc))

    # --------------------------------------------------------------------------------------------

    def _clear(self) -> None:
        """Begin a new chunk with the definitions that it has to hold."""
        definitions = self._definitions()
        self._parts, self._length = [definitions], len(definitions)
        self._index: defaultdict[int, list[int]] = defaultdict(list)

    def _definitions(self, without: Collection[bytes] = ()) -> bytes:
        """Return the definitions that the next chunk has to hold, except ``without``."""
        return b''.join(data for data in self._pending if data not in without)

    def _chunk(self, content: bytes) -> Chunk:
        return Chunk('zstd', self._compressor.compress(content),
                     0, 0, zlib.crc32(content), len(content))

    def _define(self, known: dict[int, Definition], record: Definition) -> None:
        """Add a schema, or a channel and its schema, to the next chunks."""
        self.flush()
        known[record.id] = record
        if isinstance(record, Channel) and record.schema_id:
            self._pending[encoded(self.schemas[record.schema_id])] = 0
        self._pending.pop(encoded(record), None)       # behind its schema
        self._pending[encoded(record)] = 0
        self._clear()

    def _append_chunk(self, chunk: Chunk, index: Index) -> None:
        """
        Write a Chunk with its times and, behind it, one MessageIndex record a channel.

        The definitions in it count as one more copy; one with enough copies is not pending.
        """
        times = times_of(index)
        chunk.message_start_time, chunk.message_end_time = min(times), max(times)
        record = encoded(chunk)
        parts, at, offsets = [record], self.size + len(record), {}
        for channel, entries in index.items():
            offsets[channel] = at
            size = 8 * len(entries)
            parts.append(_INDEX.pack(Opcode.MESSAGE_INDEX, 6 + size, channel, size)
                         + struct.pack(f'<{len(entries)}Q', *entries))
            at += len(parts[-1])
        offset = self.size
        self._append(b''.join(parts))
        self._summary.add_chunk(chunk, offset, len(record), offsets, index,
                                at - offset - len(record))
        self._pending = {data: copies + 1 for data, copies in self._pending.items()
                         if copies + 1 < COPIES}

    def _append(self, data: bytes) -> None:
        """Write all bytes at the end of the file or, on OSError, none."""
        view = memoryview(data)
        try:
            while view:
                view = view[self._file.write(view):]
        except OSError:
            self._file.truncate(self.size)
            self._file.seek(self.size)
            raise
        self._crc = zlib.crc32(data, self._crc)
        self.size += len(data)


def times_of(index: Index) -> list[int]:
    """Return all log times of a message index {channel: [time, offset, time, offset, ...]}."""
    return [time for entries in index.values() for time in entries[::2]]


class Summary:
    """
    Collects the definitions, statistics and indices for the end of a file.

    ``counts``: messages by the number of their channel; ``start``, ``end``: log times of the first
    and the last message [ns].
    """

    def __init__(self) -> None:
        """Begin with an empty file."""
        self.schemas: dict[int, Schema] = {}           # by their numbers
        self.channels: dict[int, Channel] = {}
        self.counts: dict[int, int] = defaultdict(int)
        self.start: int | None = None
        self.end = 0
        # ChunkIndex records, and how many. Encoded, since an hour has 36 000 of them: 5 MB, as
        # objects they would take 40.
        self._chunk_indices, self.chunks = bytearray(), 0
        self._metadata_indices: list[MetadataIndex] = []

    def add_metadata(self, offset: int, length: int, name: str) -> None:
        """Note a metadata record at a place of the file."""
        self._metadata_indices.append(MetadataIndex(offset, length, name))

    def add_chunk(self, chunk: Chunk, offset: int, length: int, places: dict[int, int],
                  index: Mapping[int, list[int]], index_length: int) -> None:
        """
        Note a chunk and the message index behind it.

        ``places``: {channel: offset of its index}; ``index``: {channel: [time, offset, ...]}.
        """
        self.chunks += 1
        first, last = chunk.message_start_time, chunk.message_end_time
        self._chunk_indices += encoded(ChunkIndex(
            length, offset, chunk.compression, len(chunk.data), last, index_length, places, first,
            chunk.uncompressed_size))
        for channel, entries in index.items():
            self.counts[channel] += len(entries) // 2
        self.start = first if self.start is None else min(self.start, first)
        self.end = max(self.end, last)

    def ending(self, offset: int, crc: int) -> bytes:
        """
        Return the end of a file whose data end at ``offset`` and have the checksum ``crc``.

        It holds: mark of the end of the data, summary sections, their offsets, footer, magic.
        """
        end = encoded(DataEnd(crc))
        start = offset + len(end)
        parts, offsets = bytearray(), []
        for opcode, content in self._sections():
            if content:
                offsets.append(SummaryOffset(opcode, start + len(parts), len(content)))
            parts += content
        offset_start = start + len(parts)
        summary = parts + encoded(*offsets)
        crc = zlib.crc32(HEAD.pack(Opcode.FOOTER, 20) + struct.pack('<QQ', start, offset_start),
                         zlib.crc32(summary))
        return b''.join((end, summary, encoded(Footer(start, offset_start, crc)), MAGIC))

    def _sections(self) -> tuple[tuple[Opcode, bytes | bytearray], ...]:
        """Return (kind of records, encoded records) in the order of the specification."""
        statistics = Statistics(
            attachment_count=0, schema_count=len(self.schemas), channel_count=len(self.channels),
            chunk_count=self.chunks, metadata_count=len(self._metadata_indices),
            message_count=sum(self.counts.values()), channel_message_counts=dict(self.counts),
            message_start_time=self.start or 0, message_end_time=self.end)
        return ((Opcode.SCHEMA, encoded(*self.schemas.values())),
                (Opcode.CHANNEL, encoded(*self.channels.values())),
                (Opcode.STATISTICS, encoded(statistics)),
                (Opcode.CHUNK_INDEX, self._chunk_indices),
                (Opcode.METADATA_INDEX, encoded(*self._metadata_indices)))
