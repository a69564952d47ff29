# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What the end of an MCAP file says of the data before it: definitions, counts, times, indices."""
from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
import struct
import zlib

from fourbar_ros.formats.mcap_records import encoded, HEAD, MAGIC
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)


class Summary:
    """
    Collects what a reader wants to find at the end of a file.

    Attributes
    ----------
    schemas, channels : dict
        Records by their numbers.
    counts : dict
        Messages in the file by the number of their channel.
    start, end : int
        Log times of the first and the last message [ns]; start is None before the first.

    """

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.counts: dict[int, int] = defaultdict(int)
        self.start: int | None = None
        self.end = 0
        # Encoded, since an hour has 36 000 of them: 5 MB, as objects they would take 40.
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
        """Return all that follows the data, which end at ``offset`` with the checksum ``crc``."""
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
