# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Offsets of the fields of serialised messages, so that numpy reads many messages at once.

``rosbags`` decodes one message at a time; in an array of equal layout a message takes a tenth of
that time.
"""
from collections.abc import Iterator, Sequence
from functools import cache, cached_property
from typing import Any, Literal

from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

HEADER = 4          # [bytes] before the data of a message
_FORMATS = {'bool': '?', 'byte': 'u1', 'octet': 'u1', 'char': 'u1'}


class MessageLayout:
    """
    The fields of all messages whose texts and sequences are as long as those of one message.

    ``size``: of each message [bytes].
    """

    def __init__(self, store: Typestore, type_name: str, data: bytes) -> None:
        """Walk over the fields of a type along the bytes of a message; BagError if it differs."""
        self._store, self._data, self._offset = store, data, HEADER
        self.size = len(data)
        self._most_padding = 3      # [bytes] behind the last field
        if len(data) < HEADER or data[0] or data[1] > 1:
            raise BagError(f'{type_name}: not a CDR message')
        self._order: Literal['<', '>'] = '<' if data[1] else '>'
        # (begin, end) of the bytes that all messages of the layout share: byte order, lengths
        self._shared = [(0, 2)]
        self._fields: dict[str, tuple[Any, int]] = {}       # {path: (format, offset)}
        try:
            self._walk(type_name, '')
            if not 0 <= len(data) - self._offset <= self._most_padding:
                raise IndexError
        except (IndexError, KeyError, ValueError):
            raise BagError(f'{type_name}: a message does not fit its definition') from None

    @cached_property
    def dtype(self) -> np.dtype[np.void]:
        """
        Return a record type with a field for each number, text or array of numbers.

        It is named by its path: ``header.stamp.sec``, ``position``, ``name[0]``.
        """
        formats, offsets = zip(*self._fields.values()) if self._fields else ((), ())
        return np.dtype({'names': list(self._fields), 'formats': list(formats),
                         'offsets': list(offsets), 'itemsize': self.size})

    def matching(self, block: Array) -> Array:
        """Return which rows of a block of messages, uint8 of shape (n, size), have this layout."""
        good = np.ones(len(block), bool)
        for begin, end in self._shared:
            shared = np.frombuffer(self._data, np.uint8, end - begin, begin)
            good &= (block[:, begin:end] == shared).all(axis=1)
        return good

    def _walk(self, type_name: str, path: str) -> None:
        """Note format and offset of each field of a type, from the offset reached so far on."""
        for name, (kind, definition) in self._store.fielddefs[type_name][1]:
            self._field(kind, definition, path + name)

    def _field(self, kind: Nodetype, definition: Any, path: str) -> None:
        """Read one field; ``kind`` and ``definition`` as in the fielddefs of rosbags."""
        if kind == Nodetype.NAME:
            self._walk(definition, f'{path}.')
        elif kind == Nodetype.BASE:
            self._base(definition[0], path, None)
        else:
            (item_kind, item), count = definition
            if kind == Nodetype.SEQUENCE:
                count = self._length()
            if item_kind == Nodetype.BASE and 'string' not in item[0]:
                self._base(item[0], path, count)
            else:
                for index in range(count):
                    self._field(item_kind, item, f'{path}[{index}]')

    def _base(self, kind: str, path: str, count: int | None) -> None:
        """Note a text, a number (``count`` None), or an array of numbers, aligned to its size."""
        if kind == 'string':
            length = self._length()
            self._fields[path] = f'S{max(length - 1, 0)}', self._offset     # no final zero
            self._offset += length
            return
        dtype = _dtype(kind, self._order)
        if count != 0:
            self._align(dtype.itemsize)
        elif dtype.itemsize == 8:
            self._most_padding += 4         # Fast CDR sizes a message as if it aligned these too
        self._fields[path] = dtype if count is None else (dtype, (count,)), self._offset
        self._offset += dtype.itemsize * (1 if count is None else count)

    def _length(self) -> int:
        """Read the length of a text or sequence: other lengths are another layout."""
        self._align(4)
        begin, self._offset = self._offset, self._offset + 4
        self._shared.append((begin, self._offset))
        length = int.from_bytes(self._data[begin:self._offset],
                                'little' if self._order == '<' else 'big')
        if length > len(self._data):
            raise IndexError
        return length

    def _align(self, size: int) -> None:
        self._offset += -(self._offset - HEADER) % size


@cache
def _dtype(kind: str, order: Literal['<', '>']) -> np.dtype[Any]:
    return np.dtype(_FORMATS.get(kind, kind)).newbyteorder(order)


def arrays(store: Typestore, type_name: str, messages: Sequence[bytes],
           known: list[MessageLayout]) -> Iterator[tuple[Array, Array]]:
    """Yield (indices, records) of messages by layout; new layouts are added to ``known``."""
    for rows, block in _blocks(messages):
        while len(rows):
            layout = next((each for each in known if each.size == block.shape[1]
                           and each.matching(block[:1])[0]), None)
            if layout is None:
                layout = MessageLayout(store, type_name, block[0].tobytes())
                known.append(layout)
            good = layout.matching(block)
            yield rows[good], np.ascontiguousarray(block[good]).view(layout.dtype)[:, 0]
            rows, block = rows[~good], block[~good]


def misfits(store: Typestore, type_name: str, messages: Sequence[bytes]) -> int:
    """Return how many messages do not fit the definition of their type."""
    count = 0
    for _, block in _blocks(messages):
        while len(block):
            try:
                block = block[~MessageLayout(store, type_name, block[0].tobytes()).matching(block)]
            except BagError:
                count, block = count + 1, block[1:]
    return count


def _blocks(messages: Sequence[bytes]) -> Iterator[tuple[Array, Array]]:
    """Yield (indices, bytes) of messages of equal size, bytes of shape (n, size)."""
    sizes = np.fromiter(map(len, messages), np.int64, len(messages))
    for size in np.unique(sizes).tolist():
        rows = np.flatnonzero(sizes == size)
        yield rows, np.frombuffer(b''.join([messages[row] for row in rows]),
                                  np.uint8).reshape(len(rows), size)
