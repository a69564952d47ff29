"""Read a bag without ROS: a directory or a single .mcap file."""
from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import yaml
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from .writer import BagError


class Record(NamedTuple):
    """One recorded message: its topic, log time [ns] and the decoded message."""

    topic: str
    time: int
    message: Any


def file_of(path):
    """Return the .mcap file of a bag given as directory or file."""
    path = Path(path)
    if not path.exists():
        raise BagError(f'{path}: no such bag')
    if path.is_file():
        return path
    files = sorted(path.glob('*.mcap'))
    if not files:
        raise BagError(f'{path}: holds no .mcap file')
    return files[0]


def records(path, topics=None):
    """Yield every :class:`Record` in the order of writing; ``topics``: only these."""
    with open(file_of(path), 'rb') as file:
        try:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            for item in reader.iter_decoded_messages(topics, log_time_order=False):
                yield Record(item.channel.topic, item.message.log_time, item.decoded_message)
        except McapError as error:
            raise BagError(f'{path}: {error or type(error).__name__}') from None


def metadata(path):
    """Return the rosbag2 metadata kept in the file itself (the last record wins)."""
    with open(file_of(path), 'rb') as file:
        try:
            found = [record.metadata['serialized_metadata'] for record in make_reader(file).iter_metadata()
                     if record.name == 'rosbag2']
        except McapError as error:
            raise BagError(f'{path}: {error or type(error).__name__}') from None
    if not found:
        raise BagError(f'{path}: has no rosbag2 metadata')
    return yaml.safe_load(found[-1])
