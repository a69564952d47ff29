# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The messages of one file of a bag, chunk by chunk; the channels of all its files."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
import contextlib
from dataclasses import replace
import json
from pathlib import Path
from typing import BinaryIO

from fourbar_ros.bag.cdr import Decoder
from fourbar_ros.bag.mcap.records import (
    Damaged,
    HEAD,
    IS_MESSAGE,
    MAGIC,
    MESSAGE,
    message_of,
    parse,
    split,
    unpacked,
)
from fourbar_ros.bag.mcap.scan import chunk_index, ending, Found, Scan
from fourbar_ros.bag.read.records import Message, Progress
from fourbar_ros.bag.rosbag2 import KEY, NUMBERS, RECORD, repeated
from fourbar_ros.bag.yaml_text import loaded, YamlMap
from fourbar_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, MetadataIndex, Schema, Statistics


class PartReader:
    """
    Reads one file of a bag.

    ``name`` is the path in errors. The file adds its ``channels`` to the bag's and its faults to
    ``damage``. ``is_first``: it is the first of the bag; ``wait`` as in
    :class:`~fourbar_ros.bag.mcap.scan.Scan`. Afterwards ``is_complete`` tells whether it was read
    up to its end, ``size`` how many bytes.
    """

    def __init__(self, path: Path, name: Path, channels: Channels, is_first: bool,
                 wait: Callable[[], bool] | None, damage: list[str]):
        self._path, self._name, self._channels, self._damage = path, name, channels, damage
        self._wait, self._is_first = wait, is_first
        self.is_complete, self.size = False, 0

    def chunks(self, wanted: set[str] | None, start: int | None,
               progress: Progress | None) -> Iterator[Sequence[Message]]:
        """Yield lists of (channel, sequence, log time, bytes); arguments as in ``Bag.chunks``."""
        with open(self._path, 'rb') as file:
            begin = file.read(len(MAGIC))
            # a longer beginning is for the scan to judge
            if len(begin) < len(MAGIC) and not MAGIC.startswith(begin):
                raise BagError(f'{self._path}: not an MCAP file')
            scan = Scan(file, self._wait, self._damage)
            self._channels.begin_file(self._is_first)
            # The index at the end repeats schemas and channels under a checksum. Known beforehand,
            # they show a damaged one in the data before its messages are read.
            for definition in scan.ending.records if scan.ending else ():
                if isinstance(definition, (Schema, Channel)):
                    self._channels.learn(definition)
            repeats: dict[str, int] | None = {} if self._is_first else None
            for record in self._records(file, scan, wanted, start):
                messages = self._messages_of(scan, record)
                if messages is None:
                    break                       # a power cut in the middle of this record
                if messages:
                    # read now, since a file that is being written was empty before
                    if repeats is None:
                        repeats = repeats_in(self._path)
                    yield self._without(messages, repeats) if repeats else messages
                if progress:
                    progress(scan.end)
            self.is_complete, self.size = scan.complete, scan.end

    def _records(self, file: BinaryIO, scan: Scan, wanted: set[str] | None, start: int | None
                 ) -> Iterable[Found]:
        """Return the records of a file; with an index only the chunks that can have messages."""
        index = None if wanted is None and start is None else chunk_index(file, scan.ending)
        definitions = self._channels.in_file
        if not index or not definitions:
            return scan
        numbers = {number for (kind, number), record in definitions.items()
                   if kind is Channel and (wanted is None or record.topic in wanted)}
        return scan.only([chunk.offset for chunk in index
                          if (start is None or chunk.last_time >= start)
                          and (not chunk.channels or chunk.channels & numbers)])

    def _messages_of(self, scan: Scan, record: Found) -> Sequence[Message] | None:
        """
        Return the messages of a record; BagError says where it is damaged.

        None where only zeros follow, as a power cut leaves them: there the bag ends.
        """
        offset, opcode, body = record
        try:
            if opcode is None:
                raise Damaged(body)
            if opcode == Opcode.CHUNK:
                chunk = parse(opcode, body)
                messages = self._split(unpacked(chunk))
                scan.admit(offset, chunk, [time for _, _, time, _ in messages])
                return messages
            if opcode == Opcode.MESSAGE:
                return self._split(HEAD.pack(opcode, len(body)) + body)
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._channels.learn(parse(opcode, body))
            return ()
        except Damaged as error:
            if scan.is_followed_by_zeros():
                return None
            if opcode:
                scan.spoil(offset, str(error))
            raise BagError(f'{self._name}: at byte {offset}: {error}; fourbar bag recover keeps '
                           'the rest') from None

    def _split(self, content: bytes) -> list[Message]:
        """Return the messages in the content of a chunk, and learn its schemas and channels."""
        messages = []
        for _, opcode, begin, end in split(content):
            if opcode == IS_MESSAGE:
                channel, sequence, time, _ = MESSAGE.unpack_from(content, begin)
                messages.append((channel, sequence, time, content[begin + MESSAGE.size:end]))
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._channels.learn(parse(opcode, content[begin:end]))
        return self._channels.renumbered(messages)

    def _without(self, messages: Sequence[Message], repeats: dict[str, int]) -> list[Message]:
        """
        Return messages without the ones that a later part of a bag repeats at its beginning.

        ``repeats``: {topic: sequence number of its first new message}. It is emptied at the first
        list without a repeated message: none comes after that.
        """
        begins = {number: repeats.get(channel.topic, 0)
                  for number, channel in self._channels.by_number.items()}
        new = [message for message in messages if message[1] >= begins[message[0]]]
        if len(new) == len(messages):
            repeats.clear()
        return new


class Channels:
    """
    The channels met so far, under numbers that hold for all files of a split bag.

    The files number their schemas and channels each for itself: 3 can be another topic in the next
    file. ``by_number``: {number in the bag: channel}; ``in_file``: {(Schema or Channel, number in
    the file that is being read): definition as it stands there}.
    """

    def __init__(self, path: Path) -> None:
        """Begin without a channel; ``path``: the path of the bag, for errors."""
        self.by_number: dict[int, Channel] = {}
        self.in_file: dict[tuple[type, int], Schema | Channel] = {}
        self._path, self._is_first = path, True     # whether the file being read is the first
        self._schemas: dict[int, Schema] = {}       # by number in the bag
        self._decoders: dict[int, Decoder] = {}     # by number of the channel in the bag
        # {(Schema or Channel, number in the file that is being read): number in the bag}
        self._numbers_in_bag: dict[tuple[type, int], int] = {}
        # numbers in the bag of the channels whose first message was looked at, and among these of
        # the channels whose messages are compressed one by one
        self._examined: set[int] = set()
        self._packed: set[int] = set()

    def begin_file(self, is_first: bool) -> None:
        """Forget the numbers of the file before."""
        self.in_file, self._numbers_in_bag, self._is_first = {}, {}, is_first

    def learn(self, record: Schema | Channel) -> None:
        """
        Give a schema or channel of the current file its number in the bag.

        It keeps its own number if that is free or means the same. Otherwise, in a later file of a
        split bag, it gets the number of the equal definition in an earlier file. If there is none,
        it gets the next free number. Raises Damaged if a number changes its meaning within a file.
        """
        kind = type(record)
        changed = Damaged(f'{kind.__name__.lower()} {record.id} is another one than before')
        if self.in_file.setdefault((kind, record.id), record) != record:
            raise changed
        if (kind, record.id) in self._numbers_in_bag:
            return
        known = self.by_number if kind is Channel else self._schemas      # both by number in bag
        if kind is Channel:         # it names its schema by the number in the file
            number = self._numbers_in_bag.get((Schema, record.schema_id), record.schema_id)
            record = replace(record, schema_id=number)
        number = record.id
        if number in known and not _is_same(known[number], record):
            if self._is_first:
                raise changed
            number = next((n for n, other in known.items() if _is_same(other, record)),
                          max(known) + 1)
        known.setdefault(number, replace(record, id=number))
        self._numbers_in_bag[kind, record.id] = number

    def of_topics(self, topics: set[str]) -> set[int]:
        """Return the numbers of the channels of these topics."""
        return {number for number, channel in self.by_number.items() if channel.topic in topics}

    def renumbered(self, messages: list[Message]) -> list[Message]:
        """
        Return messages of the file under the channel numbers of the bag, and unpacked.

        Some writers compress each message; the first one of a channel shows whether its were.
        Raises Damaged for an unknown channel.
        """
        try:
            numbers = {number: self._numbers_in_bag[Channel, number]
                       for number in {message[0] for message in messages}}
        except KeyError:
            raise Damaged('message of an unknown channel') from None
        if any(number != in_bag for number, in_bag in numbers.items()):
            messages = [(numbers[message[0]], *message[1:]) for message in messages]
        if new := set(numbers.values()) - self._examined:
            first = {number: data for number, _, _, data in reversed(messages)}
            self._packed |= {number for number in new
                             if self.by_number[number].message_encoding == 'cdr'
                             and message_of(first[number]) is not first[number]}
            self._examined |= new
        if not self._packed:
            return messages
        return [(number, sequence, time, message_of(data) if number in self._packed else data)
                for number, sequence, time, data in messages]

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

    def decoder(self, number: int) -> Decoder:
        """Return the Decoder of a channel, made once; BagError if it is not CDR by ros2msg."""
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
    """Return whether two definitions are equal apart from their numbers and QoS."""
    if isinstance(a, Channel):
        return (a.topic, a.message_encoding, a.schema_id) == (b.topic, b.message_encoding,
                                                              b.schema_id)
    return (a.name, a.encoding, a.data) == (b.name, b.encoding, b.data)


# --- metadata of rosbag2 in a file, also in one that was cut off ---------------------------------

def metadata_in(path: str | Path) -> YamlMap | None:
    """Return the rosbag2 metadata of a file, None if it has none."""
    found = None
    with open(path, 'rb') as file:
        for record in metadata_records(file):
            if record.name == RECORD and KEY in record.metadata:
                with contextlib.suppress(BagError):
                    found = loaded(record.metadata[KEY])
    return found if isinstance(found, dict) else None


def metadata_records(file: BinaryIO) -> Iterator[Metadata]:
    """Yield every undamaged metadata record, by the index if there is one, else by a scan."""
    end = ending(file)
    places = end.of(MetadataIndex) if end else ()
    has_none = end and any(not statistics.metadata_count for statistics in end.of(Statistics))
    for place in places:
        file.seek(place.offset)
        with contextlib.suppress(Damaged):
            yield parse(Opcode.METADATA, file.read(place.length)[HEAD.size:])
    for _, opcode, body in () if places or has_none else Scan(file):
        if opcode == Opcode.METADATA:
            yield parse(opcode, body)


def repeats_in(path: str | Path) -> dict[str, int]:
    """
    Return {topic: sequence number of its first new message} of a later part of a split bag.

    Its keys are the topics with a repeated message; empty for bags of other recorders.
    """
    try:
        about = (metadata_in(path) or {})['custom_data']
        numbers = json.loads(about[NUMBERS])
        return {topic: int(numbers[topic][0]) for topic in repeated(about)}
    except (KeyError, TypeError, ValueError, IndexError):
        return {}
