# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The records of an MCAP file one by one: checked and parsed."""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from io import BytesIO
from struct import Struct
from typing import Any
import zlib

from fourbar_ros.errors import BagError
import lz4.frame
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    DataEnd,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
import zstandard

MAGIC = b'\x89MCAP0\r\n'              # first and last bytes of a file
HEAD = Struct('<BQ')                # opcode and length of every record
IS_MESSAGE = int(Opcode.MESSAGE)     # compares in a tenth of the time
# channel, sequence, log time, publish time: what a message starts with
MESSAGE = Struct('<HIQQ')
WRONG_TIMES = 'chunk states other times than its messages have'
# [bytes] a chunk or message is taken for; rosbag2's chunks have 0.75 MiB
LARGEST = 1 << 28
# what the library of a header begins with in a bag of our recorder
OURS = 'fourbar_ros '
SEAL = 'crc32'                      # key of a metadata record: the checksum of all others
TYPES = {Opcode.HEADER: Header, Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel,
         Opcode.METADATA: Metadata,
         Opcode.CHUNK: Chunk, Opcode.DATA_END: DataEnd, Opcode.STATISTICS: Statistics,
         Opcode.METADATA_INDEX: MetadataIndex}
_U32, _U64 = Struct('<I'), Struct('<Q')
# What is in the data section: bytes at the start of a body, the lengths of its texts, bytes at its
# end.
SHAPES = {int(opcode): shape for opcode, shape in {
    Opcode.HEADER: (0, (_U32, _U32), 0), Opcode.SCHEMA: (2, (_U32, _U32, _U32), 0),
    Opcode.CHANNEL: (4, (_U32, _U32, _U32), 0), Opcode.CHUNK: (28, (_U32, _U64), 0),
    Opcode.MESSAGE_INDEX: (2, (_U32,), 0), Opcode.ATTACHMENT: (16, (_U32, _U32, _U64), 4),
    Opcode.METADATA: (0, (_U32, _U32), 0), Opcode.DATA_END: (4, (), 0)}.items()}


class Damaged(BagError):
    """A record is whole but its content is not what it should be."""


def filled(opcode: int, size: int, read: Callable[[Struct, int], int]) -> int:
    """
    Return the size of a body according to the lengths inside it; -1 if it ends before them.

    ``read(struct, place)`` returns the number at a place of the body.
    """
    if opcode == IS_MESSAGE:
        return max(size, MESSAGE.size)
    begin, lengths, end = SHAPES[opcode]
    for length in lengths:
        if begin + length.size > size:
            return -1
        begin += length.size + read(length, begin)
    return begin + end


def in_short(damage: Sequence[str], most: int = 10) -> str:
    """Return what is wrong with a file as one line."""
    rest = len(damage) - most
    return '; '.join(damage[:most]) + (f'; and at {rest} more places' if rest > 0 else '')


def parse(opcode: int, body: bytes) -> Any:
    """Return the record of the mcap library for a body."""
    try:
        record = TYPES[opcode].read(ReadDataStream(BytesIO(body)))
    except Exception as error:      # the library raises whatever the bytes lead it to
        raise Damaged(f'{Opcode(opcode).name.lower()} cannot be read: '
                      f'{type(error).__name__}') from None
    # The library takes what is left where a text should be longer; written again it is not the
    # same.
    if opcode == Opcode.METADATA and (record.metadata.get(SEAL) not in (None, seal(record))
                                      or encoded(record)[HEAD.size:] != body):
        raise Damaged(f'metadata {record.name!r} has a wrong checksum')
    return record


def encoded(*records: McapRecord) -> bytes:
    """Return the bytes of records of the mcap library."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    found: bytes = builder.end()
    return found


def seal(record: Metadata) -> str:
    """Return the checksum of a Metadata record: an unfinished file has no other for it."""
    items = (text for key, value in sorted(record.metadata.items()) if key != SEAL
             for text in (key, value))
    return f'{zlib.crc32(chr(0).join((record.name, *items)).encode()):08x}'


def unpacked(chunk: Chunk) -> bytes:
    """Return the content of a Chunk, checked against its CRC."""
    try:
        data = _decompressed(chunk)
    except Damaged:
        raise
    except Exception as error:      # of either library, or no memory for the stated size
        raise Damaged(f'chunk cannot be decompressed: {error}') from None
    if len(data) != chunk.uncompressed_size or chunk.uncompressed_crc not in (0, zlib.crc32(data)):
        raise Damaged('chunk has a wrong checksum')
    return data


def _decompressed(chunk: Chunk) -> bytes:
    """
    Return the content of a Chunk.

    A size that the data do not confirm is refused before memory is allocated for it.
    """
    size = chunk.uncompressed_size
    if chunk.compression == '':
        found: bytes = chunk.data
        return found
    if size > LARGEST:
        raise Damaged(f'chunk of {size} bytes; the limit is {LARGEST}')
    if chunk.compression == 'zstd':
        if zstandard.frame_content_size(chunk.data) not in (-1, size):
            raise Damaged('chunk states another size than its data have')
        return unzstd(chunk.data, size)
    if chunk.compression == 'lz4':
        return unlz4(chunk.data, size)
    raise Damaged(f'unknown compression {chunk.compression!r}')


def unzstd(data: bytes, size: int) -> bytes:
    """Return what was compressed, at most one byte more than ``size``."""
    with zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True) as stream:
        found: bytes = stream.read(size + 1)
        return found


def unlz4(data: bytes, size: int) -> bytes:
    """Return what was compressed, at most one byte more than ``size``."""
    found: bytes = lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size + 1)
    return found


# What some writers (rosbag2 with compression_mode message) put in place of a message; CDR begins
# with a zero.
PACKED = {zstandard.FRAME_HEADER: unzstd, (0x184D2204).to_bytes(4, 'little'): unlz4}


def message_of(data: bytes) -> bytes:
    """Return the uncompressed message; data that were not compressed are returned as they are."""
    unpack = PACKED.get(data[:4])
    if unpack is None:
        return data
    try:
        found = unpack(data, LARGEST)
    except Exception as error:      # of either library
        raise Damaged(f'message cannot be decompressed: {error}') from None
    if len(found) > LARGEST:
        raise Damaged(f'message of more than {LARGEST} bytes')
    if unpack is unzstd and zstandard.frame_content_size(data) not in (-1, len(found)):
        raise Damaged('message states another size than its data have')
    return found


def tells_its_times(chunk: Chunk, times: Sequence[int]) -> bool:
    """
    Return whether a Chunk states the first and last of these log times.

    Its checksum does not cover them.
    """
    return not times or (chunk.message_start_time,
                         chunk.message_end_time) == (min(times), max(times))


def split(data: bytes) -> Iterator[tuple[int, int, int, int]]:
    """Yield (offset, opcode, start, end) of the records of a chunk; the body is start:end."""
    at, size, unpack = 0, len(data), HEAD.unpack_from
    while at < size:
        if at + 9 > size:
            raise Damaged('chunk ends inside a record')
        opcode, length = unpack(data, at)
        start, end = at + 9, at + 9 + length
        if end > size or opcode == IS_MESSAGE and length < MESSAGE.size:
            raise Damaged('chunk ends inside a record')
        yield at, opcode, start, end
        at = end
