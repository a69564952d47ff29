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

MAGIC = b'\x89MCAP0\r\n'            # first and last bytes of a file
HEAD = Struct('<BQ')                # opcode and length of every record
IS_MESSAGE = int(Opcode.MESSAGE)    # an int compares in a tenth of the time of an enum
MESSAGE = Struct('<HIQQ')           # a message begins: channel, sequence, log and publish time
LARGEST = 1 << 28                   # [bytes] chunk or message; rosbag2's chunks have 0.75 MiB
OURS = 'fourbar_ros '               # so begins the field library of a header by our recorder
SEAL = 'crc32'                      # key of a metadata record: the checksum of all others
TYPES = {Opcode.HEADER: Header, Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel,
         Opcode.METADATA: Metadata, Opcode.CHUNK: Chunk, Opcode.DATA_END: DataEnd,
         Opcode.STATISTICS: Statistics, Opcode.METADATA_INDEX: MetadataIndex}
_U32, _U64 = Struct('<I'), Struct('<Q')
# Layout of the records in the data section: bytes at the start; texts or data that begin with
# their length; bytes at the end.
SHAPES = {int(opcode): shape for opcode, shape in {
    Opcode.HEADER: (0, (_U32, _U32), 0), Opcode.SCHEMA: (2, (_U32, _U32, _U32), 0),
    Opcode.CHANNEL: (4, (_U32, _U32, _U32), 0), Opcode.CHUNK: (28, (_U32, _U64), 0),
    Opcode.MESSAGE_INDEX: (2, (_U32,), 0), Opcode.ATTACHMENT: (16, (_U32, _U32, _U64), 4),
    Opcode.METADATA: (0, (_U32, _U32), 0), Opcode.DATA_END: (4, (), 0)}.items()}


class Damaged(BagError):
    """A record is whole but its content is wrong."""


def size_by_content(opcode: int, size: int, read: Callable[[Struct, int], int]) -> int:
    """
    Return the size of a body [bytes] by the lengths inside it; -1 if it ends before them.

    A whole record has exactly the ``size`` in its head; a flipped bit in a length shows so.
    ``read(struct, offset)`` returns the number at an offset of the body.
    """
    if opcode == IS_MESSAGE:
        return max(size, MESSAGE.size)
    offset, lengths, end = SHAPES[opcode]
    for length in lengths:
        if offset + length.size > size:
            return -1
        offset += length.size + read(length, offset)
    return offset + end


def in_short(damage: Sequence[str], most: int = 10) -> str:
    """Return the damages of a file as one line; of more than ``most`` the number of the rest."""
    rest = len(damage) - most
    return '; '.join(damage[:most]) + (f'; and at {rest} more places' if rest > 0 else '')


def parse(opcode: int, body: bytes) -> Any:
    """
    Return the body of a record as the mcap library's type for its opcode.

    Raises Damaged if it cannot be read, for metadata also if their checksum is wrong.
    """
    try:
        record = TYPES[opcode].read(ReadDataStream(BytesIO(body)))
    except Exception as error:      # the library raises whatever the bytes lead it to
        raise Damaged(f'{Opcode(opcode).name.lower()} cannot be read: '
                      f'{type(error).__name__}') from None
    # Where a text should be longer than the body, the library takes the rest. Encoded again such
    # a record differs from the body.
    if opcode == Opcode.METADATA and (record.metadata.get(SEAL) not in (None, seal(record))
                                      or encoded(record)[HEAD.size:] != body):
        raise Damaged(f'metadata {record.name!r} has a wrong checksum')
    return record


def encoded(*records: McapRecord) -> bytes:
    """Return records of the mcap library as bytes."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())


def seal(record: Metadata) -> str:
    """Return the checksum of a Metadata record, which MCAP itself gives none before the end."""
    items = (text for key, value in sorted(record.metadata.items()) if key != SEAL
             for text in (key, value))
    return f'{zlib.crc32(chr(0).join((record.name, *items)).encode()):08x}'


def unpacked(chunk: Chunk) -> bytes:
    """
    Return the content of a Chunk, checked against its size and CRC.

    A size that the data do not confirm is refused before memory is allocated for it.
    """
    size = chunk.uncompressed_size
    if chunk.compression not in UNPACK:
        raise Damaged(f'unknown compression {chunk.compression!r}')
    if chunk.compression and size > LARGEST:
        raise Damaged(f'chunk of {size} bytes; the limit is {LARGEST}')
    try:
        if (chunk.compression == 'zstd'
                and zstandard.frame_content_size(chunk.data) not in (-1, size)):
            raise Damaged('chunk states another size than its data have')
        data = UNPACK[chunk.compression](chunk.data, size)
    except Damaged:
        raise
    except Exception as error:      # of either library, or no memory for the stated size
        raise Damaged(f'chunk cannot be decompressed: {error}') from None
    if len(data) != size or chunk.uncompressed_crc not in (0, zlib.crc32(data)):
        raise Damaged('chunk has a wrong checksum')
    return data


def unzstd(data: bytes, size: int) -> bytes:
    """Return data decompressed by zstd, at most one byte more than ``size``."""
    with zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True) as stream:
        return bytes(stream.read(size + 1))


def unlz4(data: bytes, size: int) -> bytes:
    """Return data decompressed by lz4, at most one byte more than ``size``."""
    return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size + 1))


UNPACK: dict[str, Callable[[bytes, int], bytes]] = {       # by the compression of a chunk
    '': lambda data, size: data, 'zstd': unzstd, 'lz4': unlz4}
# The first bytes of a message that its writer compressed alone (rosbag2 with compression_mode
# message). A CDR message begins with a zero.
PACKED = {zstandard.FRAME_HEADER: unzstd, (0x184D2204).to_bytes(4, 'little'): unlz4}


def message_of(data: bytes) -> bytes:
    """Return a message uncompressed; uncompressed data are returned as they are."""
    unpack = PACKED.get(data[:4])
    if unpack is None:
        return data
    try:
        message = unpack(data, LARGEST)
    except Exception as error:      # of either library
        raise Damaged(f'message cannot be decompressed: {error}') from None
    if len(message) > LARGEST:
        raise Damaged(f'message of more than {LARGEST} bytes')
    if unpack is unzstd and zstandard.frame_content_size(data) not in (-1, len(message)):
        raise Damaged('message states another size than its data have')
    return message


def split(data: bytes) -> Iterator[tuple[int, int, int, int]]:
    """Yield (offset, opcode, begin, end) of the records in a chunk, begin and end of the body."""
    offset = 0
    while offset < len(data):
        begin = offset + HEAD.size
        if begin > len(data):
            raise Damaged('chunk ends inside a record')
        opcode, length = HEAD.unpack_from(data, offset)
        end = begin + length
        if end > len(data) or opcode == IS_MESSAGE and length < MESSAGE.size:
            raise Damaged('chunk ends inside a record')
        yield offset, opcode, begin, end
        offset = end
