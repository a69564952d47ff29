"""
Walk through an MCAP file record by record: finished, cut by a crash, or still being written.

The library's readers want the index at the end of a file, which a crash never writes; its stream reader
takes 4 us a message, this one less than 1.
"""
from __future__ import annotations

import contextlib
import fcntl
import os
import zlib
from io import BytesIO
from struct import Struct

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Header, Metadata, Schema

from . import BagError

MAGIC = b'\x89MCAP0\r\n'
HEAD = Struct('<BQ')                # opcode and length of every record
IS_MESSAGE = int(Opcode.MESSAGE)     # compares in a tenth of the time
MESSAGE = Struct('<HIQQ')           # channel, sequence, log time, publish time: what a message starts with
_TYPES = {Opcode.HEADER: Header, Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel, Opcode.METADATA: Metadata,
          Opcode.CHUNK: Chunk}


class Damaged(BagError):
    """A record is whole but its content is not what it should be."""


class Scan:
    """
    Iterate over (offset, opcode, body) of the data section of an open file.

    Parameters
    ----------
    file : binary file
    bodies : set of opcodes, optional
        Only these records are read, the others are skipped and have body None.
    wait : callable, optional
        Called when the file ends early, returns whether to look again: for a bag being written.

    Attributes
    ----------
    end : int
        Offset behind the last whole record.
    complete : bool
        Whether the file was finished; False for one that was cut or is still being written.

    """

    def __init__(self, file, bodies=None, wait=None):
        self._file, self._bodies, self._wait = file, bodies, wait
        self.end, self.complete = 0, False

    def __iter__(self):
        if not self._there(len(MAGIC)):
            return
        if self._file.read(len(MAGIC)) != MAGIC:
            raise BagError(f'{self._file.name}: not an MCAP file')
        self.end = len(MAGIC)
        while self._there(HEAD.size):
            opcode, length = HEAD.unpack(self._file.read(HEAD.size))
            if opcode == 0 or not self._there(HEAD.size + length):
                return          # opcode 0: zeros, as a power cut leaves them
            self._file.seek(self.end + HEAD.size)
            if self._bodies is None or opcode in self._bodies:
                body = self._file.read(length)
            else:
                body = self._file.seek(length, os.SEEK_CUR) and None
            offset, self.end = self.end, self.end + HEAD.size + length
            if opcode == Opcode.DATA_END:
                self._file.seek(-len(MAGIC), os.SEEK_END)
                self.complete = self._file.tell() >= self.end and self._file.read() == MAGIC
                return
            yield offset, opcode, body

    def _there(self, length):
        """Return whether this many bytes follow the last whole record."""
        def there():
            return os.fstat(self._file.fileno()).st_size >= self.end + length

        while not there():
            if not (self._wait and self._wait()) and not there():      # its writer may just have finished
                return False
        self._file.seek(self.end)
        return True


def parse(opcode, body):
    """Return the record of the mcap library for a body."""
    try:
        return _TYPES[opcode].read(ReadDataStream(BytesIO(body)))
    except Exception as error:      # the library raises whatever the bytes lead it to
        raise Damaged(f'{Opcode(opcode).name.lower()} cannot be read: {type(error).__name__}') from None


def unpacked(chunk):
    """Return the content of a Chunk, checked against its CRC."""
    try:
        if chunk.compression == 'zstd':
            data = zstandard.ZstdDecompressor().decompress(chunk.data, chunk.uncompressed_size)
        elif chunk.compression == 'lz4':
            data = lz4.frame.decompress(chunk.data)
        elif chunk.compression == '':
            data = chunk.data
        else:
            raise Damaged(f'unknown compression {chunk.compression!r}')
    except (zstandard.ZstdError, RuntimeError, MemoryError) as error:
        raise Damaged(f'chunk cannot be decompressed: {error}') from None
    if len(data) != chunk.uncompressed_size or chunk.uncompressed_crc not in (0, zlib.crc32(data)):
        raise Damaged('chunk has a wrong checksum')
    return data


def split(data):
    """Yield (offset, opcode, start, end) of the records in the content of a chunk, the body being start:end."""
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


def mark_as_being_written(file):
    """Lock an open file; the lock goes with the process, so it tells a crashed bag from a living one."""
    with contextlib.suppress(OSError):       # file systems without locks
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_being_written(path):
    """Return whether a recorder has this file open."""
    with open(path, 'rb') as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        except OSError:
            pass
        return False
