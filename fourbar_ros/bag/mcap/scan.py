# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Walk through an MCAP file record by record: finished, cut, being written or damaged.

The library's readers want the index at the end of a file, which a crash never writes; its stream
reader takes 4 us a message, this one less than 1. Neither checks the content of a record. Here the
lengths inside a record must fill it; if they do not, the walk continues at the next whole record.
The summary at the end of a finished file is checked against the data before it.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
import os
import re
from struct import Struct
from typing import Any, BinaryIO, NamedTuple, TypeVar
import zlib

from fourbar_ros.bag.mcap.records import (
    Damaged,
    HEAD,
    IS_MESSAGE,
    MAGIC,
    OURS,
    parse,
    SHAPES,
    size_by_content,
    split,
    TYPES,
)
from fourbar_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Chunk, MetadataIndex, Statistics

# kinds of records that can be in a chunk as well
_IN_CHUNKS_TOO = frozenset({Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE})
# [bytes] read at once in the search for the next record, at first and at most
_FIRST_WINDOW, _WINDOW = 1 << 12, 1 << 22

# offset, opcode and body of a record; for bytes that are no record: offset, None, the fault
Found = tuple[int, Any, Any]


class Scan:
    """
    Iterate over (offset, opcode, body) of the data section of an open file.

    Bytes that are no record, up to the next record, are (offset, None, the fault). ``wait`` is
    called when the file ends early and returns whether to look again, for a bag that is being
    written. Damage is added to the list ``damage``, if given.

    Attributes
    ----------
    end : int
        Offset behind the last record, or behind damage.
    complete : bool
        Whether the file was finished; False for one that was cut or is still being written.
    ending : Ending or None
    damage : list of str
        The faults of the file: where and why. The caller adds faults that it finds in records.
    lost : int
        Bytes that are damaged.

    """

    def __init__(self, file: BinaryIO, wait: Callable[[], bool] | None = None,
                 damage: list[str] | None = None) -> None:
        """Read the index at the end of the file, if there is one; parameters as of the class."""
        self._file, self._wait = file, wait
        self.end, self.complete, self.lost = 0, False, 0
        self.damage = [] if damage is None else damage
        self._damage_before = len(self.damage)
        self.ending = ending(file)
        if self.ending and self.ending.damage:
            self.damage.append(self.ending.damage)
        # [byte] where the data section ends and the index begins; 0: not known
        self._data_end = self.ending.start if self.ending else 0
        # whether all messages are in chunks, as far as known
        self._chunked = bool(self.ending and self._data_end and self.ending.is_chunked)
        # offsets of the chunks by (first and last log time, size, checksum)
        self._chunks: dict[tuple[int, int, int, int], int] = {}
        # newest log time so far [ns]; whether the header names our recorder
        self._last_time, self._is_ours = 0, False

    def __iter__(self) -> Iterator[Found]:
        """Yield the records one by one, with the checksum of the data computed on the way."""
        if not self._reaches(len(MAGIC), wait=True):
            return
        self._file.seek(0)
        magic = self._file.read(len(MAGIC))
        if magic != MAGIC:
            if not self._data_end and not self._record_at(len(MAGIC)):
                raise BagError(f'{self._file.name}: not an MCAP file')
            self.damage.append('at byte 0: the first bytes of the file are wrong')
        self.end, crc = len(MAGIC), zlib.crc32(magic)
        while self._data_end == 0 or self.end < self._data_end:
            offset, found = self.end, self._record_at(self.end, wait=True)
            if found is None:
                self.end = self._next_record(offset)
                if self.end == offset:
                    return                     # the file was cut here
                yield offset, None, self.spoil(offset, 'the type or a length of a record is wrong')
                continue
            head, opcode, body = found
            self.end += len(head) + len(body)
            if opcode == Opcode.DATA_END:
                self._finish(offset, parse(opcode, body).data_section_crc, crc)
                return
            crc = zlib.crc32(body, zlib.crc32(head, crc))
            self._chunked |= opcode == Opcode.CHUNK
            if self._is_sound(offset, opcode, body):
                yield offset, opcode, body
        self.complete = True        # though the mark of the end of the data, DATA_END, was damaged

    def only(self, offsets: Iterable[int]) -> Iterator[Found]:
        """Yield the records at these offsets, taken from the index, and skip all others."""
        for offset in offsets:
            self.end = offset + HEAD.size
            if record := self._record_at(offset):
                _, opcode, body = record
                self.end += len(body)
                yield offset, opcode, body
            else:
                yield offset, None, self.spoil(offset, 'the index leads to no record')
        self.complete = True

    def spoil(self, offset: int, why: str) -> str:
        """Note that the bytes from an offset up to ``end`` are damaged; return the reason."""
        self.damage.append(f'at byte {offset}: {why}')
        self.lost += self.end - offset
        return why

    def admit(self, offset: int, chunk: Chunk, times: Sequence[int]) -> None:
        """
        Note faults in the place of a sound Chunk, or in the times that it states.

        ``times`` are the log times of its messages [ns]: the checksum does not cover the first and
        the last one in its head. Our recorder's times never go back. Raises Damaged for a copy of
        an earlier chunk.
        """
        if not times:
            return
        first, last = min(times), max(times)
        if (chunk.message_start_time, chunk.message_end_time) != (first, last):
            self.damage.append(f'at byte {offset}: chunk states other times than its messages '
                               'have')
        key = (first, last, chunk.uncompressed_size, chunk.uncompressed_crc
               or zlib.crc32(chunk.data))
        other = self._chunks.setdefault(key, offset)
        if other != offset and (self._is_ours or first < last):
            raise Damaged(f'a copy of the chunk at byte {other}')
        if self._is_ours and first < self._last_time:
            self.damage.append(f'at byte {offset}: chunk is out of order: its messages are older '
                               'than those before it')
        self._last_time = max(self._last_time, last)

    def is_followed_by_zeros(self) -> bool:
        """Return whether an unfinished file ends in zeros, as a power cut leaves them."""
        self._file.seek(self.end)
        rest = self._file.read(_WINDOW) if not self.ending else b''
        return bool(rest) and not rest.strip(b'\0')

    def _is_sound(self, offset: int, opcode: int, body: bytes) -> bool:
        """Return whether a header or metadata record can be read; others are for the caller."""
        try:
            if opcode == Opcode.HEADER:
                self._is_ours = parse(opcode, body).library.startswith(OURS)
            return opcode != Opcode.METADATA or bool(parse(opcode, body))
        except Damaged as error:
            self.spoil(offset, str(error))
            return False

    def _finish(self, offset: int, stated_crc: int, crc: int) -> None:
        """
        Compare the checksum of the data with the one stored behind them; 0 means none.

        If no damage was found before, the change is outside the chunks.
        """
        self.ending = ending(self._file)       # a file being written may have got one meanwhile
        self.complete = self.ending is not None
        if len(self.damage) == self._damage_before and stated_crc not in (0, crc):
            self.damage.append(f'from byte 0 to {offset}: the data have a wrong checksum, but no '
                               'chunk has: a message index, the header or the checksum itself has '
                               'changed, or a chunk is missing')

    def _reaches(self, end: int, wait: bool = False) -> bool:
        """Return whether the file reaches up to this offset; ``wait``: for its writer."""
        def size() -> int:
            return os.fstat(self._file.fileno()).st_size

        while size() < end:
            if not (wait and self._wait and self._wait()):
                return size() >= end           # its writer may just have finished
        return True

    def _record_at(self, offset: int, wait: bool = False) -> tuple[bytes, int, bytes] | None:
        """Return (head, opcode, body) of the record at an offset, None if it is not whole."""
        begin = offset + HEAD.size
        if not self._reaches(begin, wait):
            return None
        self._file.seek(offset)
        head = self._file.read(HEAD.size)
        opcode, length = HEAD.unpack(head)
        if not self._can_be_at(offset, opcode, begin + length) or not self._reaches(
                begin + length, wait):
            return None
        self._file.seek(begin)
        body = self._file.read(length)
        size = size_by_content(opcode, length,
                               lambda number, at: number.unpack_from(body, at)[0])
        return (head, opcode, body) if size == length else None

    def _size_in_file(self, begin: int, opcode: int, length: int) -> int:
        """Return size_by_content() of the body at an offset, reading only the lengths inside."""
        def number_at(number: Struct, at: int) -> int:
            data = os.pread(self._file.fileno(), number.size, begin + at)
            return int(number.unpack(data)[0]) if len(data) == number.size else 0
        return size_by_content(opcode, length, number_at)

    def _can_be_at(self, offset: int, opcode: int, end: int) -> bool:
        """Return whether a record of this kind can stand from an offset to another."""
        ends = end == self._data_end
        if self._data_end and (end > self._data_end or (opcode == Opcode.DATA_END) != ends):
            return False
        if (opcode == Opcode.HEADER) != (offset == len(MAGIC)):
            return False
        # A message index that lost one bit looks like a message, which chunked files do not have.
        return opcode in SHAPES or opcode == IS_MESSAGE and not self._chunked

    def _next_record(self, offset: int) -> int:
        """
        Return the offset of the first whole record after a damaged one.

        It is looked for where the lengths in the damaged record lead, then byte by byte. If there
        is none: the end of the data section or, where that is not known, ``offset`` itself.
        """
        size = self._data_end or os.fstat(self._file.fileno()).st_size
        begin = offset + HEAD.size
        if begin > size or self._record_at(offset):         # its writer has just completed it
            return offset
        self._file.seek(offset)
        opcode, length = HEAD.unpack(self._file.read(HEAD.size))
        # One flipped bit spoils one of the two lengths: of the record, or of its content.
        ends = {begin + length}
        if opcode in SHAPES:
            ends.add(begin + self._size_in_file(begin, opcode, length))
        for end in sorted(ends):
            if offset < end <= size and (end == size or self._record_at(end)):
                return int(end)
        # In the remains of a chunk the search would take the messages of the chunk for records.
        outside_chunks = not self._chunked and opcode != Opcode.CHUNK
        return self._search(offset + 1, size, outside_chunks) or self._data_end or offset

    def _search(self, begin: int, size: int, outside_chunks: bool) -> int:
        """
        Return the offset of the next whole record from ``begin`` to ``size``, 0 for none.

        It tries every byte that can be the kind of a record shorter than 1 TiB.
        ``outside_chunks``: also schemas, channels and messages, which may stand alone there.
        """
        kinds = bytes(kind for kind in (*SHAPES, IS_MESSAGE)
                      if outside_chunks or kind not in _IN_CHUNKS_TOO)
        # a kind and its length: 8 bytes, the three highest are 0
        pattern = re.compile(b'[' + re.escape(kinds) + rb'](?=.{5}\0{3})', re.DOTALL)
        window = _FIRST_WINDOW
        while begin < size:
            self._file.seek(begin)
            part = self._file.read(window + HEAD.size)
            for match in pattern.finditer(part, 0, window):
                if match.start() + HEAD.size > len(part):
                    break
                offset = begin + match.start()
                opcode, length = HEAD.unpack_from(part, match.start())
                body = offset + HEAD.size
                # first by the lengths alone: most candidates are none, and bodies can be large
                if (body + length <= size and self._can_be_at(offset, opcode, body + length)
                        and self._size_in_file(body, opcode, length) == length
                        and self._record_at(offset)):
                    return offset
            begin, window = begin + window, min(2 * window, _WINDOW)
        return 0


_END = Struct('<BQQQI8s')           # the footer and the magic behind it
_CHUNK_INDEX, _ENTRY = Struct('<QQQQI'), Struct('<HQ')  # head of a chunk's index; a channel in it

Record = TypeVar('Record')


class ChunkPlace(NamedTuple):
    """A chunk in the index: its offset in the file, last log time [ns], numbers of channels."""

    offset: int
    last_time: int
    channels: set[int]


class Ending(NamedTuple):
    """The end of a finished file: offset of its summary, the records there, damage in it."""

    start: int
    records: tuple[Any, ...]
    damage: str = ''

    def of(self, kind: type[Record]) -> list[Record]:
        """Return the records of a type."""
        return [record for record in self.records if isinstance(record, kind)]

    @property
    def is_chunked(self) -> bool:
        """Return whether no message is outside of a chunk; False if that is not known."""
        return any(statistics.chunk_count or not statistics.message_count
                   for statistics in self.of(Statistics))


def ending(file: BinaryIO) -> Ending | None:
    """Return the Ending of an open file, checked by its CRC; None if the file has none."""
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
        records = tuple(parse(opcode, summary[begin:end])
                        for _, opcode, begin, end in split(summary) if opcode in TYPES)
        if any(record.offset + record.length > start
               for record in records if isinstance(record, MetadataIndex)):
            raise Damaged('the index at the end of the file leads nowhere')
        return Ending(start, records)
    except Damaged as error:           # of a writer without checksums
        return Ending(0, (), f'at byte {start}: {error}')


def chunk_index(file: BinaryIO, end: Ending | None) -> list[ChunkPlace] | None:
    """
    Return the chunks of a sound file by their offsets.

    None if not all chunks are indexed, or messages lie outside of them. Plain structs read it,
    since a bag of one hour has 36 000 chunks.
    """
    statistics = end.of(Statistics) if end and not end.damage else []
    if end is None or not statistics or not statistics[0].chunk_count:
        return None
    file.seek(end.start)
    summary = file.read(os.fstat(file.fileno()).st_size - _END.size - end.start)
    chunks = []
    for _, opcode, begin, _ in split(summary):
        if opcode == Opcode.CHUNK_INDEX:
            _, last, offset, _, size = _CHUNK_INDEX.unpack_from(summary, begin)
            begin += _CHUNK_INDEX.size
            numbers = {number for number, _ in _ENTRY.iter_unpack(summary[begin:begin + size])}
            chunks.append(ChunkPlace(offset, last, numbers))
    is_whole = (len(chunks) == statistics[0].chunk_count
                and all(chunk.offset < end.start for chunk in chunks))
    return sorted(chunks, key=lambda chunk: chunk.offset) if is_whole else None
