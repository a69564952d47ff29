# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The definitions in a bag: channels and schemas of all its files, and decoders for them."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from fourbar_ros.bag.records import Message
from fourbar_ros.errors import BagError
from fourbar_ros.formats import rosbag2
from fourbar_ros.formats.cdr import Decoder
from fourbar_ros.formats.mcap_records import Damaged, message_of
from mcap.records import Channel, Schema


class Channels:
    """
    The channels met so far, under numbers that hold for all files of a split bag.

    Attributes
    ----------
    by_number : dict
        {number: Channel}.
    here : dict
        {(Schema or Channel, number in the file that is read): definition}.

    """

    def __init__(self, path: Path) -> None:
        self.by_number: dict[int, Channel] = {}
        self.here: dict[tuple[type, int], Schema | Channel] = {}
        self._path, self._is_first = path, True
        self._schemas: dict[int, Schema] = {}
        self._decoders: dict[int, Decoder] = {}
        self._numbers: dict[tuple[type, int], int] = {}     # {(kind, number there): number here}
        self._plain: set[int] = set()                  # looked at
        self._packed: set[int] = set()                 # with compressed messages

    def begin_file(self, is_first: bool) -> None:
        """Forget the numbers of the file before."""
        self.here, self._numbers, self._is_first = {}, {}, is_first

    def learn(self, record: Schema | Channel) -> None:
        """Keep a definition; in the later files of a split bag it may have another number."""
        kind = type(record)
        if self.here.setdefault((kind, record.id), record) != record:
            raise Damaged(f'{kind.__name__.lower()} {record.id} is another one than before')
        if (kind, record.id) in self._numbers:
            return
        known = self.by_number if kind is Channel else self._schemas
        if kind is Channel:
            record = replace(record, schema_id=self._numbers.get((Schema, record.schema_id),
                                                                 record.schema_id))
        number = record.id
        if number in known and not _is_same(known[number], record):
            if self._is_first:
                raise Damaged(f'{kind.__name__.lower()} {record.id} is another one than before')
            number = next((n for n, other in known.items() if _is_same(other, record)),
                          max(known) + 1)
        known.setdefault(number, replace(record, id=number))
        self._numbers[kind, record.id] = number

    def of_topics(self, topics: set[str]) -> set[int]:
        """Return the numbers of the channels of these topics."""
        return {number for number, channel in self.by_number.items() if channel.topic in topics}

    def renumbered(self, found: list[Message]) -> list[Message]:
        """
        Return messages, (channel in the file, ...), under the numbers of the bag and unpacked.

        Raises Damaged for an unknown channel.
        """
        try:
            numbers = {number: self._numbers[Channel, number]
                       for number in {item[0] for item in found}}
        except KeyError:
            raise Damaged('message of an unknown channel') from None
        if any(number != here for here, number in numbers.items()):
            found = [(numbers[item[0]], *item[1:]) for item in found]
        return self._unpacked(found, set(numbers.values()) - self._plain) if numbers else found

    def _unpacked(self, found: list[Message], new: set[int]) -> list[Message]:
        """
        Return messages as they were sent.

        The first message of a channel shows whether they were compressed.
        """
        if new:
            first = {number: data for number, _, _, data in reversed(found)}
            self._packed |= {number for number in new
                             if self.by_number[number].message_encoding == 'cdr'
                             and message_of(first[number]) is not first[number]}
            self._plain |= new
        if not self._packed:
            return found
        return [(number, sequence, stamp, message_of(data) if number in self._packed else data)
                for number, sequence, stamp, data in found]

    # --- of a channel ---------------------------------------------------------------------------

    def of(self, topic: str) -> Channel:
        """Return the first channel of a topic."""
        return next(channel for channel in self.by_number.values() if channel.topic == topic)

    def schema(self, number: int) -> Schema:
        """Return the schema of a channel; raises BagError."""
        channel = self.by_number[number]
        schema = self._schemas.get(channel.schema_id)
        if schema is None:
            raise BagError(f'{self._path}: {channel.topic} has no schema')
        return schema

    def qos(self, topic: str) -> list[dict[str, Any]]:
        """Return the QoS profiles under which a topic was offered."""
        return rosbag2.profiles_of(self.of(topic).metadata.get(rosbag2.QOS, ''))

    def decoder(self, number: int) -> Decoder:
        """Return the Decoder of a channel; raises BagError."""
        if number not in self._decoders:
            schema, channel = self.schema(number), self.by_number[number]
            if channel.message_encoding != 'cdr' or schema.encoding != 'ros2msg':
                raise BagError(f'{self._path}: {channel.topic} is {channel.message_encoding!r} '
                               f'defined in {schema.encoding!r}; only cdr in ros2msg is decoded: '
                               'rosbags-convert makes that')
            try:
                self._decoders[number] = Decoder(schema.name, schema.data.decode())
            except UnicodeDecodeError:
                raise BagError(f'{self._path}: the schema of {channel.topic} is not '
                               'text') from None
        return self._decoders[number]


def _is_same(a: Schema | Channel, b: Schema | Channel) -> bool:
    """Return whether two definitions are the same but for number and QoS."""
    if isinstance(a, Channel):
        return (a.topic, a.message_encoding, a.schema_id) == (b.topic, b.message_encoding,
                                                              b.schema_id)
    return (a.name, a.encoding, a.data) == (b.name, b.encoding, b.data)
