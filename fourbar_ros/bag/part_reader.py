# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The messages of one file of a bag, chunk by chunk."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

from fourbar_ros.bag.channels import Channels
from fourbar_ros.bag.records import Message, Progress
from fourbar_ros.errors import BagError
from fourbar_ros.formats.file_metadata import repeats_in
from fourbar_ros.formats.mcap_ending import chunk_index
from fourbar_ros.formats.mcap_records import (
    Damaged,
    HEAD,
    IS_MESSAGE,
    MAGIC,
    MESSAGE,
    parse,
    split,
    unpacked,
)
from fourbar_ros.formats.mcap_scan import Found, Scan
from mcap.opcode import Opcode
from mcap.records import Channel, Schema


class PartReader:
    """
    Reads one file.

    Parameters
    ----------
    path : Path
    name : Path
        What errors call it: the bag, if it has no other file.
    channels : Channels
        The channels of the bag; the file adds its own.
    is_first : bool
        The file is the first of the bag.
    wait : callable, optional
        As for :class:`~fourbar_ros.formats.mcap_scan.Scan`.
    damage : list
        Where to add what is wrong.

    Attributes
    ----------
    is_complete : bool
        The file was read up to its end.
    size : int
        Bytes read.

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
            # longer ones are the scan's to judge
            if len(begin) < len(MAGIC) and not MAGIC.startswith(begin):
                raise BagError(f'{self._path}: not an MCAP file')
            scan = Scan(file, self._wait, self._damage)
            self._channels.begin_file(self._is_first)
            # The checksum at the end covers these; a topic that was hit is seen before its
            # messages are read.
            for known in scan.ending.records if scan.ending else ():
                if isinstance(known, (Schema, Channel)):
                    self._channels.learn(known)
            repeats: dict[str, int] | None = {} if self._is_first else None
            for record in self._walk(file, scan, wanted, start):
                found = self._messages_of(scan, record)
                if found is None:
                    break                       # a power cut in the middle of this record
                if found:
                    # known before the first message; the file may have been empty
                    if repeats is None:
                        repeats = repeats_in(self._path)
                    yield self._without(found, repeats) if repeats else found
                if progress:
                    progress(scan.end)
            self.is_complete, self.size = scan.complete, scan.end

    def _walk(self, file: BinaryIO, scan: Scan, wanted: set[str] | None, start: int | None
              ) -> Iterable[Found]:
        """Return an iterator over the records of a file; an index selects those that matter."""
        index = None if wanted is None and start is None else chunk_index(file, scan.ending)
        here = self._channels.here
        if not index or not here:
            return scan
        numbers = {number for (kind, number), record in here.items()
                   if kind is Channel and (wanted is None or record.topic in wanted)}
        return scan.only([offset for offset, _, last, channels in index
                          if (start is None or last >= start)
                          and (not channels or channels & numbers)])

    def _messages_of(self, scan: Scan, record: Found) -> Sequence[Message] | None:
        """Return the messages of a record, None where zeros follow as a power cut leaves them."""
        offset, opcode, body = record
        try:
            return self._item(scan, offset, opcode, body)
        except Damaged as error:
            if scan.is_followed_by_zeros():
                return None
            if opcode:
                scan.spoil(offset, str(error))
            raise BagError(f'{self._name}: at byte {offset}: {error}; fourbar bag recover keeps '
                           'the rest') from None

    def _item(self, scan: Scan, offset: int, opcode: int | None, body: Any) -> Sequence[Message]:
        if opcode is None:
            raise Damaged(body)
        if opcode == Opcode.CHUNK:
            chunk = parse(opcode, body)
            found = self._messages(unpacked(chunk))
            scan.admit(offset, chunk, [item[2] for item in found])
            return found
        if opcode == Opcode.MESSAGE:
            return self._messages(HEAD.pack(opcode, len(body)) + body)
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            self._channels.learn(parse(opcode, body))
        return ()

    def _messages(self, content: bytes) -> list[Message]:
        """Return [(channel, sequence, log time, bytes)] of the content of a chunk."""
        found, unpack = [], MESSAGE.unpack_from
        for _, opcode, begin, end in split(content):
            if opcode == IS_MESSAGE:
                channel, sequence, stamp, _ = unpack(content, begin)
                found.append((channel, sequence, stamp, content[begin + 22:end]))
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._channels.learn(parse(opcode, content[begin:end]))
        return self._channels.renumbered(found)

    def _without(self, found: Sequence[Message], repeats: dict[str, int]) -> list[Message]:
        """
        Return messages without those that a part repeats at its beginning.

        Then ``repeats`` is emptied.
        """
        begins = {number: repeats.get(channel.topic, 0)
                  for number, channel in self._channels.by_number.items()}
        kept = [item for item in found if item[1] >= begins[item[0]]]
        if len(kept) == len(found):
            repeats.clear()
        return kept
