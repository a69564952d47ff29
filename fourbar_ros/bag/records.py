# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded messages: one as it was sent, one decoded, or many as columns."""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Record(NamedTuple):
    """One recorded message: its topic, log time [ns] and the decoded message."""

    topic: str
    time: int
    message: Any


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
    Messages of one topic and one layout, in order.

    Log times [ns], their places in the bag, fields.
    """

    topic: str
    times: np.ndarray
    places: np.ndarray
    records: np.ndarray      # one row a message; field names are paths
    layout: Any

    @property
    def type(self):
        """Return the type of the messages."""
        return self.layout.type

    @property
    def tree(self):
        """Return the fields as nested namespaces of arrays: ``tree.header.stamp.sec``."""
        return self.layout.tree(self.records)

    @property
    def stamps(self):
        """Return the stamps of the headers [ns], None if the messages have none."""
        if 'header.stamp.sec' not in self.records.dtype.names:
            return None
        return (self.records['header.stamp.sec'].astype(np.int64) * 10**9
                + self.records['header.stamp.nanosec'])
