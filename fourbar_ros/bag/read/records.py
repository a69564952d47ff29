# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded messages: one as it was sent, one decoded, or many as columns."""
from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.bag.cdr import Layout


Progress = Callable[[int], object]      # called with the number of bytes read
Message = tuple[int, int, int, bytes]   # channel, sequence number, log time [ns], data


def add_progress(progress: Progress, before: int, read: int) -> None:
    """Report the bytes read of a file, which lies behind ``before`` bytes of other files."""
    progress(before + read)


class Record(NamedTuple):
    """One recorded message: its topic, log time [ns] and the decoded message."""

    topic: str
    time: int
    message: SimpleNamespace


class Raw(NamedTuple):
    """One recorded message as it was sent."""

    topic: str
    type: str
    time: int
    sequence: int
    data: bytes
    channel: int            # two types on one topic are two channels


class Columns(NamedTuple):
    """
    Messages of one topic and layout, in order: n log times [ns], places in the bag, records.

    ``records`` is a structured array of shape (n,); the names of its fields are paths such as
    ``header.stamp.sec``.
    """

    topic: str
    times: Array
    places: Array
    records: Array
    layout: Layout

    @property
    def type(self) -> str:
        """Return the type of the messages."""
        return self.layout.type

    @property
    def tree(self) -> SimpleNamespace:
        """Return the fields as nested namespaces of arrays: ``tree.header.stamp.sec``."""
        return self.layout.tree(self.records)

    @property
    def fields(self) -> tuple[str, ...]:
        """Return the names of the fields."""
        return self.records.dtype.names or ()

    def at(self, rows: Array) -> Columns:
        """Return some of the messages, by a mask or by their rows."""
        return self._replace(times=self.times[rows], places=self.places[rows],
                             records=self.records[rows])

    @property
    def headed(self) -> Array:
        """Return ``stamps`` [ns] for messages that must have a header, else raise BagError."""
        if (stamps := self.stamps) is None:
            raise BagError(f'{self.topic}: {self.type} without a header')
        return stamps

    @property
    def stamps(self) -> Array | None:
        """Return header.stamp of each message [ns], None for a type without a header."""
        if 'header.stamp.sec' not in self.fields:
            return None
        return np.asarray(self.records['header.stamp.sec'].astype(np.int64) * 10**9
                          + self.records['header.stamp.nanosec'])
