# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The result of a recovery."""
from __future__ import annotations

from pathlib import Path
from typing import NamedTuple


class Recovered(NamedTuple):
    """
    What came out.

    Attributes
    ----------
    path : Path
        The new bag.
    messages : int
    lost : int
        Bytes of the old file that are not in the new one: its unfinished last record, damaged
        records.
    damaged : list of str
        Everything wrong with the old file: where and why.
    missing : dict
        {topic: messages that are not in the new bag}, by the numbers that our recorder gave, what
        it dropped itself among them, and by the old bag's statistics.
    was_whole : bool
        The old bag was finished and nothing of it is lost.

    """

    path: Path
    messages: int
    lost: int
    damaged: list[str]
    missing: dict[str, int]
    was_whole: bool
