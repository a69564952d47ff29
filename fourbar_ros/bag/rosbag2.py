# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Bags as rosbag2 of Jazzy lays them out: folder, files, channels, metadata of version 9.

The folder NAME holds NAME_0.mcap, NAME_1.mcap, ... and metadata.yaml, whose content each file
also holds for itself.
"""
from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
import json
import os
from pathlib import Path
import re
import time
from typing import Any, BinaryIO, NamedTuple, TYPE_CHECKING

from fourbar_ros.bag.yaml_text import dumped, loaded, YamlMap
from fourbar_ros.errors import BagError

if TYPE_CHECKING:
    from fourbar_ros.bag.mcap.writer import Container


VERSION = 9
NOT_STARTED = 2**63 - 1     # rosbag2's starting time of a bag without messages
RECORD = 'rosbag2'          # name of the metadata record in the file; its one key:
KEY = 'serialized_metadata'
QOS, HASH = 'offered_qos_profiles', 'topic_type_hash'      # keys of the metadata of a channel
# Keys of custom_data: why recording ended; the damage that recover found; as JSON by topic the
# sequence numbers that were given, [first, next] (next is null until the end); as JSON by topic
# the messages that the recorder dropped; topics with a message that a later part of a split bag
# repeats (its number is before the first).
ENDED, LOST, NUMBERS, DROPPED, REPEATS = 'ended', 'lost', 'numbers', 'dropped', 'repeats'
SPLIT = 'split'             # why a part ended: another one follows
# rosbag2's duration for "no deadline": 2^63 - 1 ns
_ENDLESS = {'sec': 9223372036, 'nsec': 854775807}


class Channel(NamedTuple):
    """A recorded topic: name, type, schema text, type hash, queue depth, latched or not."""

    topic: str
    type: str
    schema: str
    hash: str
    depth: int
    latched: bool = False

    @property
    def qos(self) -> YamlMap:
        """Return the QoS profile as rosbag2 writes it."""
        return {'history': 'keep_last', 'depth': self.depth,
                'reliability': 'reliable', 'durability': 'transient_local' if self.latched
                else 'volatile',
                'deadline': _ENDLESS, 'lifespan': _ENDLESS, 'liveliness': 'automatic',
                'liveliness_lease_duration': _ENDLESS, 'avoid_ros_namespace_conventions': False}

    @property
    def metadata(self) -> dict[str, str]:
        """Return the metadata of the channel in the file."""
        return {QOS: dumped([self.qos]), HASH: self.hash}


def check_channels(channels: Collection[Channel]) -> None:
    """Raise BagError for a channel that no reader accepts: bad names or types, a topic twice."""
    for channel in channels:
        if not isinstance(channel, Channel):
            raise BagError(f'channel {channel!r}: must be a Channel')
        if not (isinstance(channel.topic, str) and channel.topic.startswith('/')):
            raise BagError(f'topic {channel.topic!r}: must be an absolute name')
        if not (isinstance(channel.type, str) and re.fullmatch(r'\w+/(msg|srv|action)/\w+',
                                                               channel.type)):
            raise BagError(f'{channel.topic}: type {channel.type!r}: must be package/msg/Name')
        if not (isinstance(channel.schema, str) and isinstance(channel.hash, str)
                and type(channel.depth) is int):
            raise BagError(f'{channel.topic}: schema and hash must be text, depth a whole number')
    if len({channel.topic for channel in channels}) != len(channels):
        raise BagError('a topic is given twice')


# --- metadata ------------------------------------------------------------------------------------

def describe(file_name: str, container: Container, about: Mapping[str, str],
             distro: str | None = None, packing: tuple[str, str] = ('', '')) -> YamlMap:
    """
    Return the metadata of a bag as rosbag2 of Jazzy writes it.

    ``packing`` is (compression_format, compression_mode) of messages that are compressed one by
    one. Counts, times and topics come from the container, QoS and hash from the channels. So file
    and metadata.yaml cannot differ: if they did, rosbags would yield no messages.
    """
    start = container.start
    begin = {'nanoseconds_since_epoch': NOT_STARTED if start is None else start}
    duration = {'nanoseconds': 0 if start is None else container.end - start}
    total = sum(container.counts.values())
    names = {number: schema.name for number, schema in container.schemas.items()}
    profiles = {text: profiles_of(text)
                for text in {c.metadata.get(QOS, '') for c in container.channels.values()}}
    topics = [{'topic_metadata': {
        'name': channel.topic, 'type': names.get(channel.schema_id, ''),
        'serialization_format': channel.message_encoding,
        'offered_qos_profiles': profiles[channel.metadata.get(QOS, '')],
        'type_description_hash': channel.metadata.get(HASH, '')},
        'message_count': container.counts.get(channel.id, 0)}
              for channel in container.channels.values()]
    return {
        'version': VERSION, 'storage_identifier': 'mcap', 'duration': duration,
        'starting_time': begin,
        'message_count': total, 'topics_with_message_count': topics,
        'compression_format': packing[0], 'compression_mode': packing[1],
        'relative_file_paths': [file_name],
        'files': [{'path': file_name, 'starting_time': begin, 'duration': duration,
                   'message_count': total}],
        'custom_data': about, 'ros_distro': distro or os.environ.get('ROS_DISTRO', 'jazzy'),
    }


def profiles_of(text: str) -> list[YamlMap]:
    """Return the QoS profiles in the metadata of a channel; empty if they cannot be read."""
    try:
        profiles = loaded(text)
    except BagError:
        return []
    return ([profile for profile in profiles if isinstance(profile, dict)]
            if isinstance(profiles, list) else [])


def about_of(metadata: Any) -> dict[str, str]:
    """Return the custom_data of rosbag2 metadata as {str: str}; empty for any other value."""
    about = metadata.get('custom_data') if isinstance(metadata, dict) else None
    return ({str(key): str(value) for key, value in about.items()} if isinstance(about, dict)
            else {})


def mapping_in(about: Mapping[str, str], key: str) -> YamlMap:
    """Return the dict stored as JSON under a key of custom_data, empty if there is none."""
    try:
        value = json.loads(about.get(key, '{}'))
    except (TypeError, ValueError, RecursionError):
        return {}
    return value if isinstance(value, dict) else {}


def repeated(about: Mapping[str, str]) -> set[str]:
    """Return the topics with a message that a later part of a split bag repeats (REPEATS)."""
    try:
        return set(json.loads(about[REPEATS]))
    except (KeyError, TypeError, ValueError):
        return set()


def joined(first: Mapping[str, str], last: Mapping[str, str]) -> dict[str, str]:
    """
    Return the custom_data of a split bag from the custom_data of its first and last parts.

    The last part tells why recording ended, the losses, and the last sequence numbers. All else
    comes from the first part if it has it: sequence numbers from the start. Messages that the last
    part repeats (REPEATS) are left out.
    """
    firsts, nexts = mapping_in(first, NUMBERS), mapping_in(last, NUMBERS)
    numbers = {topic: (firsts[topic][0], nexts[topic][1]) for topic in firsts.keys() & nexts.keys()
               if all(isinstance(pair, list) and len(pair) == 2
                      for pair in (firsts[topic], nexts[topic]))}
    both = ({key: value for key, value in last.items() if key != REPEATS}
            | {key: value for key, value in first.items() if key != ENDED})
    both |= {key: last[key] for key in (ENDED, DROPPED, LOST) if key in last}
    return both | ({NUMBERS: json.dumps(numbers)} if numbers else {})


def merged(parts: Sequence[YamlMap]) -> YamlMap:
    """
    Return the metadata of a split bag from the metadata of its parts, in order.

    Counts of messages are summed by topic and type; the times [ns] span all parts with a message.
    """
    if len(parts) == 1:
        return parts[0]
    files = [file for part in parts for file in part['files']]
    begun = [file for file in files if file['message_count']]
    starts = [int(file['starting_time']['nanoseconds_since_epoch']) for file in begun]
    ends = [start + file['duration']['nanoseconds'] for start, file in zip(starts, begun)]
    start, end = min(starts, default=NOT_STARTED), max(ends, default=NOT_STARTED)
    topics: dict[tuple[str, str], YamlMap] = {}
    for topic in (topic for part in parts for topic in part['topics_with_message_count']):
        key = topic['topic_metadata']['name'], topic['topic_metadata']['type']
        count = topics[key]['message_count'] if key in topics else 0
        topics[key] = {**topic, 'message_count': count + topic['message_count']}
    return {**parts[0], 'starting_time': {'nanoseconds_since_epoch': start},
            'duration': {'nanoseconds': end - start},
            'message_count': sum(part['message_count'] for part in parts),
            'topics_with_message_count': list(topics.values()), 'files': files,
            'relative_file_paths': [file['path'] for file in files],
            'custom_data': joined(parts[0]['custom_data'], parts[-1]['custom_data'])}


# --- the folder ----------------------------------------------------------------------------------

def write_metadata_file(folder: Path, metadata: Mapping[str, Any]) -> None:
    """Write metadata.yaml by a rename: whenever it is read, it is the old or the new one."""
    part = folder / 'metadata.yaml.part'
    part.write_text(dumped({'rosbag2_bagfile_information': metadata}), encoding='utf-8')
    part.replace(folder / 'metadata.yaml')


def create(directory: str | Path, name: str) -> tuple[Path, BinaryIO]:
    """
    Make the folder and the file of a new bag; return (path of the folder, open file).

    An empty name takes a fresh one from the clock. Raises BagError, also if the bag exists.
    """
    directory = Path(directory)
    fresh = not check_name(name)
    path = directory / (name or fresh_name())
    try:
        directory.mkdir(parents=True, exist_ok=True)
        while fresh and path.exists():                 # two in one millisecond
            path = directory / fresh_name()
        path.mkdir()
    except FileExistsError:
        what = path if directory.is_dir() else directory
        raise BagError(f'{what}: exists already; recordings never overwrite') from None
    except OSError as error:
        raise BagError(f'{path}: {error.strerror}') from None
    try:
        return path, open(path / f'{path.name}_0.mcap', 'x+b', buffering=0)
    except OSError as error:
        path.rmdir()
        raise BagError(f'{path}: {error.strerror}') from None


def create_part(folder: Path, number: int) -> tuple[Path, BinaryIO]:
    """Make file NAME_``number``.mcap of a bag that is split; return (path, open file)."""
    path = folder / f'{folder.name}_{number}.mcap'
    return path, open(path, 'x+b', buffering=0)


def free_name(directory: str | Path, name: str) -> str:
    """Return ``name`` or, if a bag has it, NAME_2, NAME_3, ...; empty stays empty."""
    free, number = check_name(name), 1
    while name and os.path.lexists(Path(directory, free)):
        number += 1
        free = f'{name}_{number}'
    return free


def fresh_name() -> str:
    """Return a name from the clock with milliseconds: fourbar_2026_11_23-18_26_05_123."""
    nanoseconds = time.time_ns()
    return time.strftime('fourbar_%Y_%m_%d-%H_%M_%S', time.localtime(nanoseconds // 10**9)) \
        + f'_{nanoseconds % 10**9 // 10**6:03d}'


def check_name(name: Any) -> str:
    """Return the name of a bag; raises BagError if it could lead out of the recording folder."""
    if (not isinstance(name, str) or name in ('.', '..') or '/' in name
            or not (name + 'x').isprintable()):
        raise BagError(f'bag name {name!r}: must be a plain name inside the recording directory')
    return name


def files_of(path: str | Path) -> list[Path]:
    """
    Return the .mcap files of a bag in order; of a split bag NAME_0.mcap, NAME_1.mcap, ...

    The folder decides, not metadata.yaml: after a crash that may lack the newest part.
    """
    path = Path(path)
    if not path.exists():
        raise BagError(f'{path}: no such bag')
    if path.is_file():
        return [path]
    files = sorted(path.glob('*.mcap'), key=part_of)
    if not files:
        raise BagError(f'{path}: holds no .mcap files{hint_of(path)}')
    if len({part_of(file)[0] for file in files}) > 1:       # unless metadata.yaml says otherwise
        order = _file_names(_metadata_file(path))
        if not {file.name for file in files} <= set(order):
            raise BagError(f'{path}: holds {len(files)} .mcap files of different bags, name one')
        files.sort(key=lambda file: order.index(file.name))
    return files


def hint_of(path: Path) -> str:
    """Return advice on how to convert a bag of another kind, empty if there is none."""
    if packed := sorted(path.glob('*.mcap.*')):
        tool = {'.zst': 'zstd -d', '.zstd': 'zstd -d', '.lz4': 'lz4 -d'}.get(packed[0].suffix,
                                                                             'unpack')
        return (f': {packed[0].name} is compressed as a whole; first: {tool} {packed[0]} -o '
                f'{packed[0].with_suffix("")}')
    if list(path.glob('*.db3*')):
        return (f': this is an sqlite3 bag; first: rosbags-convert --src {path} --dst {path}_mcap '
                '--dst-storage mcap')
    if list(path.glob('*.bag')):
        return ': this is a bag of ROS 1; rosbags-convert makes one of ROS 2'
    return ''


def part_of(file: Path) -> tuple[str, int]:
    """Return (name of the bag, number of the part) of a file NAME_N.mcap."""
    stem, _, number = file.stem.rpartition('_')
    return (stem, int(number)) if number.isdecimal() else (file.stem, 0)


def about_beside(file: Path) -> dict[str, str]:
    """
    Return the custom_data in metadata.yaml beside a last file if they say why recording ended.

    A full disk may take this small file where it takes no more of the bag itself.
    """
    metadata = _metadata_file(file.parent)
    about = about_of(metadata) if _file_names(metadata)[-1:] == [file.name] else {}
    return about if about.get(ENDED, SPLIT) != SPLIT else {}


def packing_of(metadata: Mapping[str, Any], file: Path) -> tuple[str, str]:
    """Return rosbag2's (compression_format, compression_mode) if messages are compressed."""
    for content in (metadata, _metadata_file(file.parent)):
        if str(content.get('compression_mode')).lower() == 'message':
            return str(content.get('compression_format')), 'message'
    return '', ''


def _file_names(metadata: Mapping[str, Any]) -> list[str]:
    """Return the names of the files of a bag, in order, by its metadata."""
    names = metadata.get('relative_file_paths')
    return [Path(str(name)).name for name in names] if isinstance(names, list) else []


def _metadata_file(folder: Path) -> YamlMap:
    """Return the content of metadata.yaml, an empty dict if there is none."""
    try:
        text = (folder / 'metadata.yaml').read_text(encoding='utf-8')
        content = loaded(text)['rosbag2_bagfile_information']
    except (OSError, UnicodeDecodeError, BagError, KeyError, TypeError):
        return {}
    return content if isinstance(content, dict) else {}
