# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Message definitions (.msg): one parser for schemas in bags and for installed packages."""
from __future__ import annotations

import re
from typing import NamedTuple

from fourbar_ros.errors import BagError

PRIMITIVES = {'bool': '?', 'byte': 'u1', 'char': 'u1', 'float32': 'f4', 'float64': 'f8',
              'int8': 'i1',
              'uint8': 'u1', 'int16': 'i2', 'uint16': 'u2', 'int32': 'i4', 'uint32': 'u4',
              'int64': 'i8',
              'uint64': 'u8'}
STRINGS = ('string', 'wstring')
_FIELD = re.compile(r'([A-Za-z][\w/]*)(?:<=\d+)?(\[(?:(<=)?(\d+))?\])?\s+([A-Za-z]\w*)(?!\s*=|\w)')
_UNIT = re.compile(r'\s*\[([^\]]+)\]')      # our definitions begin every comment with the unit


class Field(NamedTuple):
    """
    A field of a message.

    ``count`` is None for a single value, -1 for a sequence; ``unit`` is the one in the comment.
    """

    name: str
    type: str
    count: int | None         # type: ignore[assignment] # no one counts fields
    unit: str = ''


class Definition:
    """The fields of a message type and of all types within it, from the text of a schema."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
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
    Return the fields that the text of one definition declares.

    Types without a package are those of ``owner``.
    """
    found = []
    for line in text.splitlines():
        line, _, comment = line.partition('#')
        match = _FIELD.match(line.strip())
        if match:
            kind, array, bounded, number, name = match.groups()
            if kind not in PRIMITIVES and kind not in STRINGS and '/' not in kind:
                kind = f'{owner.split("/")[0]}/{kind}'
            found.append(Field(name, kind, None if not array else int(number) if number
                               and not bounded else -1,
                               unit[1] if (unit := _UNIT.match(comment)) else ''))
    return found


def types_in(owner: str, text: str) -> list[str]:
    """Return the message types, ``package/msg/Name``, that the text of a definition uses."""
    packages = (field.type.split('/') for field in fields_in(owner, text)
                if field.type not in PRIMITIVES and field.type not in STRINGS)
    return [f'{package}/msg/{name}' for package, *_, name in packages]
