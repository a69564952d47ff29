# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The metadata of rosbag2 in an MCAP file, also in one that was cut off."""
from __future__ import annotations

from collections.abc import Iterator
import contextlib
import json
from pathlib import Path
from typing import BinaryIO

from fourbar_ros.bag.mcap.records import Damaged, HEAD, parse
from fourbar_ros.bag.mcap.scan import ending, Scan
from fourbar_ros.bag.rosbag2 import KEY, NUMBERS, RECORD, repeated
from fourbar_ros.bag.yaml_text import loaded, Told
from fourbar_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Metadata, MetadataIndex, Statistics


def metadata_in(path: str | Path) -> Told | None:
    """Return the rosbag2 metadata of a file, None if it has none."""
    found = None
    with open(path, 'rb') as file:
        for record in metadata_records(file):
            if record.name == RECORD and KEY in record.metadata:
                with contextlib.suppress(BagError):
                    found = loaded(record.metadata[KEY])
    return found if isinstance(found, dict) else None


def metadata_records(file: BinaryIO) -> Iterator[Metadata]:
    """Yield every undamaged metadata record, by the index if there is one."""
    end = ending(file)
    places = end.of(MetadataIndex) if end else ()
    is_told = places or end and any(not told.metadata_count for told in end.of(Statistics))
    for place in places:
        file.seek(place.offset)
        with contextlib.suppress(Damaged):
            yield parse(Opcode.METADATA, file.read(place.length)[HEAD.size:])
    for _, opcode, body in () if is_told else Scan(file):
        if opcode == Opcode.METADATA:
            yield parse(opcode, body)


def repeats_in(path: str | Path) -> dict[str, int]:
    """Return {topic: number of its first new message} of a later part of a split bag of ours."""
    try:
        about = (metadata_in(path) or {})['custom_data']
        numbers = json.loads(about[NUMBERS])
        return {topic: int(numbers[topic][0]) for topic in repeated(about)}
    except (KeyError, TypeError, ValueError, IndexError):
        return {}
