# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Decode serialised messages (CDR) by the definition in the bag; no type is hard-coded.

A :class:`Layout` knows where each field lies in messages whose strings and sequences have the same
lengths. All messages of one layout are read as one numpy array of records, 50 times faster than
one by one. One parser reads message definitions (.msg) in bags and of installed packages.
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
import re
from struct import Struct
from types import SimpleNamespace
from typing import Any, NamedTuple, TypeAlias, Union

from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

DEPTH = 64                  # of definitions within each other
FIELDS = 10_000             # that may take no byte of a message: empty arrays, structures
HEADER = 4                  # [bytes] encapsulation header; alignment counts from behind it
# numpy's types as those of struct
_CODES = {'?': '?', 'u1': 'B', 'i1': 'b', 'f4': 'f', 'f8': 'd', 'i2': 'h', 'u2': 'H', 'i4': 'i',
          'u4': 'I', 'i8': 'q', 'u8': 'Q'}

Steps = tuple[Union[str, int], ...]      # names and indices that lead to a field
# A field in the tree: the number of its leaf, the name of its texts, or its parts.
Tree: TypeAlias = 'int | str | dict[str, Tree] | list[Tree]'


class Leaf(NamedTuple):
    """
    A number, an array of numbers or a string in a message.

    ``path`` leads to it, ``format`` is numpy's type, ``shape`` () or (length,), ``offset`` counts
    from the first byte of the message.
    """

    path: Steps
    format: str
    shape: tuple[int, ...]
    offset: int
    unit: str = ''

    @property
    def name(self) -> str:
        """Return the path as written in Python: header.stamp.sec, position[2]."""
        return ''.join(f'[{step}]' if isinstance(step, int) else f'.{step}'
                       for step in self.path)[1:]


class Layout:
    """
    Where the fields of a message lie: the same place in all messages with the same lengths.

    Attributes
    ----------
    dtype : numpy.dtype
        A message as a record; the names are paths, ``header.stamp.sec``.
    leaves : list of Leaf
    texts : dict
        Sequences of strings and empty strings by path; they belong to the layout (joint names
        change rarely).

    """

    def __init__(self, definition: Definition, data: bytes) -> None:
        """Walk through one serialised message by its definition and note where each field is."""
        self._data, self._definition = data, definition
        self.type, self.size = definition.name, len(data)
        # of the walk: current byte, fields so far, structs around the current field
        self._at, self._steps, self._depth = HEADER, 0, 0
        if self.size < HEADER or data[0] != 0 or data[1] > 1:
            raise BagError(f'{definition.name}: not a CDR message')
        self._order = '<' if data[1] else '>'
        # bytes (begin, end, value) that all messages of the layout share: byte order, lengths
        self._shared: list[tuple[int, int, bytes]] = [(0, 2, data[:2])]
        self.leaves: list[Leaf] = []
        self.texts: dict[str, str | list[str]] = {}
        try:
            self._tree = self._walk(definition.name, ())
        except (IndexError, ValueError):
            raise BagError(f'{definition.name}: a message is shorter than its definition '
                           'says') from None
        try:
            self.dtype = np.dtype({
                'names': [leaf.name for leaf in self.leaves],
                'offsets': [leaf.offset for leaf in self.leaves],
                'formats': [(leaf.format, leaf.shape) for leaf in self.leaves],
                'itemsize': self.size})
        # a field twice, more bytes than numpy can hold
        except ValueError as error:
            raise BagError(f'{definition.name}: {error}') from None

    def matches(self, data: bytes) -> bool:
        """Return whether a message has this layout."""
        if len(data) != self.size:
            return False
        # a loop, since all() takes four times as long, and a node asks for every input
        for begin, end, value in self._shared:
            if data[begin:end] != value:
                return False
        return True

    def matching(self, block: Array) -> Array:
        """Return which rows of a block of messages, uint8 of shape (n, size), have this layout."""
        good = np.ones(len(block), bool)
        for begin, end, value in self._shared:
            good &= (block[:, begin:end] == np.frombuffer(value, np.uint8)).all(axis=1)
        return good

    def tree(self, records: Array) -> SimpleNamespace:
        """
        Return the fields of n records (of ``dtype``) as nested namespaces of arrays.

        A number is an array of shape (n,), an array field one of shape (length, n):
        ``position[i]`` is joint i over time.
        """
        return self._namespace([records[leaf.name].T if leaf.shape else records[leaf.name]
                                for leaf in self.leaves])

    def message(self, data: bytes) -> SimpleNamespace:
        """Return one message as nested namespaces of numbers, lists and str."""
        values = self._struct.unpack(data)
        return self._namespace([
            list(values[begin:end]) if leaf.shape else
            values[begin].decode(errors='replace') if leaf.format[0] == 'S' else values[begin]
            for leaf, (begin, end) in zip(self.leaves, self._places)])

    def _namespace(self, values: Sequence[Any]) -> SimpleNamespace:
        """Return the values of all leaves as nested namespaces."""
        def build(node: Tree) -> Any:
            """Return the value, namespace, texts or list for a node of the tree."""
            if isinstance(node, int):
                return values[node]
            if isinstance(node, dict):
                return SimpleNamespace(**{name: build(child) for name, child in node.items()})
            return (self.texts[node] if isinstance(node, str)
                    else [build(child) for child in node])
        return SimpleNamespace(**{name: build(child) for name, child in self._tree.items()})

    @cached_property
    def _struct(self) -> Struct:
        """
        Return the layout for struct, which reads a single message faster than numpy.

        ``_places`` gets the (begin, end) of each leaf among the unpacked values.
        """
        codes, end_of_last, self._places, number = [self._order], 0, [], 0
        for leaf in self.leaves:
            count = leaf.shape[0] if leaf.shape else 1
            is_text = leaf.format[0] == 'S'
            size = int(leaf.format[1:]) if is_text else count * np.dtype(leaf.format).itemsize
            codes.append(f'{leaf.offset - end_of_last}x'
                         + (f'{size}s' if is_text else f'{count}{_CODES[leaf.format[-2:]]}'))
            end_of_last = leaf.offset + size
            self._places.append((number, number + count))
            number += count
        return Struct(''.join(codes) + f'{self.size - end_of_last}x')

    # --------------------------------------------------------------------------------------------

    def _walk(self, type_name: str, path: Steps) -> dict[str, Tree]:
        """Read a struct at the current byte; return {field: number of its leaf, or subtree}."""
        self._depth += 1
        if self._depth > DEPTH:
            raise BagError(f'{self.type}: a definition within itself, or more than {DEPTH} within '
                           'each other')
        tree = {field.name: self._field(field, (*path, field.name))
                for field in self._definition.fields(type_name)}
        self._depth -= 1
        return tree

    def _field(self, field: Field, path: Steps) -> Tree:
        """
        Read one field at the current byte; return its node in the tree (see Tree).

        BagError for more fields than the message has room for: a schema can ask for millions.
        """
        self._steps += 1
        if self._steps > 4 * self.size + FIELDS:
            raise BagError(f'{self.type}: more fields than a message of {self.size} bytes can '
                           'have')
        if field.type == 'wstring':
            raise BagError(f'{self.type}: wstring is not supported')
        count = (None if field.count is None else self._length() if field.count == SEQUENCE
                 else field.count)
        if field.type in PRIMITIVES:
            shape = () if count is None else (count,)
            return self._leaf(path, PRIMITIVES[field.type], shape, field.unit)
        if field.type == 'string':
            return self._string(path) if count is None else self._strings(path, count)
        if count is None:
            return self._walk(field.type, path)
        return [self._walk(field.type, (*path, i)) for i in range(count)]

    def _leaf(self, path: Steps, format_: str, shape: tuple[int, ...], unit: str = '') -> int:
        """Note numbers or a text at the current byte, aligned; return the number of the leaf."""
        size = 1 if format_[0] in 'S?' else int(format_[-1])
        if size > 1 and shape != (0,):
            self._at += -(self._at - HEADER) % size
        self.leaves.append(Leaf(path, format_ if size == 1 else self._order + format_, shape,
                                self._at, unit))
        self._at += size * (shape[0] if shape else 1)
        if self._at > self.size:
            raise IndexError
        return len(self.leaves) - 1

    def _length(self) -> int:
        """
        Read the length of a string or sequence at the current byte.

        It becomes part of the layout: messages with another length have another layout.
        """
        self._at += -(self._at - HEADER) % 4          # aligned to its 4 bytes
        end = self._at + 4
        if end > self.size:
            raise IndexError
        data = self._data[self._at:end]
        length = int.from_bytes(data, 'little' if self._order == '<' else 'big')
        self._shared.append((self._at, end, data))
        self._at = end
        if length > self.size:
            raise IndexError
        return length

    def _string(self, path: Steps) -> int | str:
        """Read a string: a leaf, since messages of one layout differ in texts of one length."""
        length = self._length()
        if length > 1:
            leaf = self._leaf(path, f'S{length - 1}', ())
            self._at += length - 1              # _leaf counts one byte; the final zero is no text
            if self._at > self.size:
                raise IndexError
            return leaf
        # an empty one has its final zero, or not even that
        self._at += length
        return self._text(path, '')

    def _strings(self, path: Steps, count: int) -> str:
        """
        Read a sequence of strings, such as joint names; return the name of its texts.

        Their bytes become part of the layout: a message with other names has another layout. So
        the texts are decoded once, not for each message.
        """
        texts = []
        for _ in range(count):
            length = self._length()
            begin, self._at = self._at, self._at + length
            texts.append(self._data[begin:begin + max(length - 1, 0)].decode(errors='replace'))
            # the entry that _length() has just made, extended by the text; without the padding
            # before the length, which holds old memory
            self._shared[-1] = begin - 4, self._at, self._data[begin - 4:self._at]
        if self._at > self.size:
            raise IndexError
        return self._text(path, texts)

    def _text(self, path: Steps, value: str | list[str]) -> str:
        """Keep texts that belong to the layout; return their name."""
        name = Leaf(path, '', (), 0).name
        self.texts[name] = value
        return name


class Decoder:
    """The messages of one channel: keeps the layouts it has met."""

    def __init__(self, type_name: str, schema_text: str) -> None:
        self.definition = Definition(type_name, schema_text)
        self._layouts: dict[int, list[Layout]] = {}        # by size of the message [bytes]

    def layout(self, data: bytes) -> Layout:
        """Return the Layout of a message, a known one where it matches."""
        known = self._layouts.setdefault(len(data), [])
        layout = next((layout for layout in known if layout.matches(data)), None)
        if layout is None:
            layout = Layout(self.definition, data)
            known.append(layout)
        return layout

    def message(self, data: bytes) -> SimpleNamespace:
        """Return one message as nested namespaces."""
        return self.layout(data).message(data)

    def arrays(self, messages: Sequence[bytes]) -> Iterator[tuple[Layout, Array, Array]]:
        """
        Yield (layout, rows, records) for a list of serialised messages, layout by layout.

        ``rows`` are their places in the list, ``records`` a numpy array of the layout's dtype.
        """
        sizes = np.fromiter(map(len, messages), np.int64, len(messages))
        for size in np.unique(sizes):
            rows = np.flatnonzero(sizes == size)
            block: Array = np.frombuffer(b''.join([messages[i] for i in rows]),
                                         np.uint8).reshape(len(rows), size)
            while len(rows):
                layout = self.layout(block[0].tobytes())
                good = layout.matching(block)
                same = block if good.all() else np.ascontiguousarray(block[good])
                yield layout, rows[good], same.view(layout.dtype)[:, 0]
                rows, block = rows[~good], block[~good]


PRIMITIVES = {'bool': '?', 'byte': 'u1', 'char': 'u1', 'float32': 'f4', 'float64': 'f8',
              'int8': 'i1', 'uint8': 'u1', 'int16': 'i2', 'uint16': 'u2', 'int32': 'i4',
              'uint32': 'u4', 'int64': 'i8', 'uint64': 'u8'}
STRINGS = ('string', 'wstring')
SEQUENCE = -1               # count of a field whose messages tell the length
_FIELD = re.compile(r'([A-Za-z][\w/]*)(?:<=\d+)?(\[(?:(<=)?(\d+))?\])?\s+([A-Za-z]\w*)(?!\s*=|\w)')
_UNIT = re.compile(r'\s*\[([^\]]+)\]')      # our definitions begin every comment with the unit


class Field(NamedTuple):
    """
    A field of a message.

    ``count``: None for a single value, the length of an array, or SEQUENCE; ``unit``: from the
    comment.
    """

    name: str
    type: str
    count: int | None         # type: ignore[assignment] # hides tuple.count, which nobody calls
    unit: str = ''


class Definition:
    """The fields of a message type and of all types within it, from the text of a schema."""

    def __init__(self, name: str, text: str) -> None:
        """Split the text of a schema into {package/Name: fields}."""
        self.name = name
        # behind lines of = come the types within it, each with a line MSG: package/Name
        parts = re.split(r'^=+[ \t]*\n', text.replace('\r', ''), flags=re.M)
        self._types = {short(name): fields_in(name, parts[0])}
        for part in parts[1:]:
            head, _, body = part.partition('\n')
            other = head.removeprefix('MSG:').strip()
            self._types[short(other)] = fields_in(other, body)

    def fields(self, type_name: str) -> list[Field]:
        """Return the fields of a type; an empty message has one byte on the wire."""
        try:
            return (self._types[short(type_name)]
                    or [Field('structure_needs_at_least_one_member', 'uint8', None)])
        except KeyError:
            raise BagError(f'{self.name}: the schema does not define {type_name}') from None


def short(name: str) -> str:
    """Return 'package/Name' of 'package/msg/Name'."""
    package, *_, last = name.rpartition('/') if '/' not in name else name.split('/')
    return f'{package}/{last}'


def fields_in(owner: str, text: str) -> list[Field]:
    """
    Return the fields that the text of one definition (.msg) declares; constants are none.

    ``float64[3] force  # [N] on B`` of the type ``owner`` 'a/msg/B' is Field('force', 'float64',
    3, 'N'). Types without a package belong to the owner's package.
    """
    fields = []
    for line in text.splitlines():
        line, _, comment = line.partition('#')
        if match := _FIELD.match(line.strip()):
            kind, array, bounded, number, name = match.groups()
            if kind not in PRIMITIVES and kind not in STRINGS and '/' not in kind:
                kind = f'{owner.split("/")[0]}/{kind}'
            is_sequence = bounded or not number
            count = None if not array else SEQUENCE if is_sequence else int(number)
            unit = _UNIT.match(comment)
            fields.append(Field(name, kind, count, unit[1] if unit else ''))
    return fields


def types_in(owner: str, text: str) -> list[str]:
    """Return the message types, ``package/msg/Name``, that the text of a definition uses."""
    packages = (field.type.split('/') for field in fields_in(owner, text)
                if field.type not in PRIMITIVES and field.type not in STRINGS)
    return [f'{package}/msg/{name}' for package, *_, name in packages]
