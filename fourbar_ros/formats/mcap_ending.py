# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The end of a finished MCAP file: what its summary says of the data before it."""
from __future__ import annotations

import os
from struct import Struct
from typing import Any, BinaryIO, NamedTuple, TypeVar
import zlib

from fourbar_ros.formats.mcap_records import Damaged, MAGIC, parse, split, TYPES
from mcap.opcode import Opcode
from mcap.records import MetadataIndex, Statistics

_END = Struct('<BQQQI8s')           # the footer and the magic behind it
_CHUNK_INDEX, _ENTRY = Struct('<QQQQI'), Struct('<HQ')  # head of a chunk's index; a channel in it

Record = TypeVar('Record')
ChunkPlace = tuple[int, int, int, set[int]]     # offset, first and last log time, channels


class Ending(NamedTuple):
    """
    The end of a finished file.

    Where its summary begins, the records there, and what is wrong with it.
    """

    start: int
    records: tuple[Any, ...]
    damage: str = ''

    def of(self, kind: type[Record]) -> list[Record]:
        """Return the records of a type."""
        return [record for record in self.records if isinstance(record, kind)]

    @property
    def is_chunked(self) -> bool:
        """Return whether no message is outside of a chunk; False if that is not known."""
        return any(told.chunk_count or not told.message_count for told in self.of(Statistics))


def ending(file: BinaryIO) -> Ending | None:
    """Return the Ending of an open file, None if it was not finished."""
    at = os.fstat(file.fileno()).st_size - _END.size
    if at < len(MAGIC):
        return None
    file.seek(at)
    tail = file.read(_END.size)
    opcode, length, start, _, crc, magic = _END.unpack(tail)
    is_footer = (opcode, length) == (Opcode.FOOTER, 20)
    if not is_footer and magic != MAGIC:
        return None
    start = start or at
    if not is_footer or magic != MAGIC or not len(MAGIC) <= start <= at:
        return Ending(0, (), f'at byte {at}: the last bytes of the file are wrong')
    file.seek(start)
    summary = file.read(at - start)
    if crc not in (0, zlib.crc32(tail[:25], zlib.crc32(summary))):
        return Ending(0, (), f'at byte {at}: the index at the end of the file has a wrong '
                             'checksum')
    try:
        found = Ending(start, tuple(parse(opcode, summary[begin:end])
                                    for _, opcode, begin, end in split(summary)
                                    if opcode in TYPES))
        if any(place.offset + place.length > start for place in found.of(MetadataIndex)):
            raise Damaged('the index at the end of the file leads nowhere')
        return found
    except Damaged as error:           # of a writer without checksums
        return Ending(0, (), f'at byte {start}: {error}')


def chunk_index(file: BinaryIO, end: Ending | None) -> list[ChunkPlace] | None:
    """
    Return [(offset, first log time, last log time, channels)] of the chunks of a sound file.

    None if not all chunks are indexed, or messages lie outside of them.
    """
    told = end.of(Statistics) if end and not end.damage else []
    if end is None or not told or not told[0].chunk_count:
        return None
    file.seek(end.start)
    summary = file.read(os.fstat(file.fileno()).st_size - _END.size - end.start)
    found = [_place(summary, begin) for _, opcode, begin, _ in split(summary)
             if opcode == Opcode.CHUNK_INDEX]
    good = len(found) == told[0].chunk_count and all(place[0] < end.start for place in found)
    return sorted(found, key=lambda place: place[0]) if good else None


def _place(summary: bytes, begin: int) -> ChunkPlace:
    first, last, offset, _, size = _CHUNK_INDEX.unpack_from(summary, begin)
    begin += _CHUNK_INDEX.size
    return (offset, first, last,
            {number for number, _ in _ENTRY.iter_unpack(summary[begin:begin + size])})
