# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Bags as rosbag2 of Jazzy lays them out: a folder of files, metadata of version 9.

The folder NAME holds NAME_0.mcap, NAME_1.mcap, ... and metadata.yaml; each file also holds such
metadata of that file. (``rosbags`` writes the same only when a bag is closed.)
"""
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache
import os
from pathlib import Path
from tempfile import TemporaryDirectory
import time
from typing import Any, NamedTuple

from fourbar_ros.errors import BagError
import yaml

RECORD, KEY = 'rosbag2', 'serialized_metadata'      # of the metadata record in a file
QOS, HASH = 'offered_qos_profiles', 'topic_type_hash'       # of the metadata of a channel
LOST = 'lost'       # of the custom_data: what could not be read when the bag was recovered
NOT_STARTED = 2**63 - 1     # rosbag2's starting time of a bag without messages
FOREVER = {'sec': 9223372036, 'nsec': 854775807}            # its "no deadline"
Metadata = dict[str, Any]


class Channel(NamedTuple):
    """A topic to record: name, type, text and hash of its definition, queue depth, latched."""

    topic: str
    type: str
    schema: str
    hash: str
    depth: int
    latched: bool = False

    @property
    def metadata(self) -> dict[str, str]:
        """Return the metadata of the channel in a file: quality of service, type hash."""
        qos = {'history': 'keep_last', 'depth': self.depth, 'reliability': 'reliable',
               'durability': 'transient_local' if self.latched else 'volatile',
               'deadline': FOREVER, 'lifespan': FOREVER, 'liveliness': 'automatic',
               'liveliness_lease_duration': FOREVER, 'avoid_ros_namespace_conventions': False}
        return {QOS: dumped([qos]), HASH: self.hash}


class TopicCount(NamedTuple):
    """A topic in a file: name, type, encoding, metadata of the channel, count of messages."""

    topic: str
    type: str
    encoding: str
    metadata: Mapping[str, str]
    messages: int


class _Plain(getattr(yaml, 'CSafeDumper', yaml.SafeDumper)):    # type: ignore[misc] # C's if any

    def ignore_aliases(self, data: Any) -> bool:
        return True         # rosbag2 reads none: equal profiles are written out twice


def dumped(value: Any) -> str:
    return yaml.dump(value, Dumper=_Plain, sort_keys=False, width=2**30)


@lru_cache
def loaded(text: str) -> Any:
    """Return the content of a YAML text; do not change it."""
    return yaml.load(text, getattr(yaml, 'CSafeLoader', yaml.SafeLoader))       # C's if any


def profiles(channel: Mapping[str, str]) -> list[dict[str, Any]]:
    """Return the offered quality of service of a channel by its metadata; [] if it has none."""
    with suppress(yaml.YAMLError):           # anybody may have made the bag
        offered = loaded(channel.get(QOS, ''))
        if isinstance(offered, list) and all(isinstance(each, dict) for each in offered):
            return offered
    return []


class FileContent(NamedTuple):
    """A file of a bag; ``span``: log times of the first and last message [ns], or None."""

    name: str
    topics: Sequence[TopicCount]
    span: tuple[int, int] | None
    about: Mapping[str, str]


def of_files(files: Sequence[FileContent]) -> Metadata:
    """Return the metadata, as of rosbag2, of a file or of all files of a split bag in order."""
    topics: dict[str, TopicCount] = {}
    for topic in (topic for file in files for topic in file.topics):
        before = topics[topic.topic].messages if topic.topic in topics else 0
        topics[topic.topic] = topic._replace(messages=before + topic.messages)
    spans = [file.span for file in files if file.span]
    whole = (min(start for start, _ in spans), max(end for _, end in spans)) if spans else None
    about = {**files[-1].about}
    if 'scene' in files[0].about:
        about['scene'] = files[0].about['scene']
    count = sum(topic.messages for topic in topics.values())
    return {
        'version': 9, 'storage_identifier': 'mcap', **_times(whole), 'message_count': count,
        'topics_with_message_count': [
            {'topic_metadata': {
                'name': topic.topic, 'type': topic.type, 'serialization_format': topic.encoding,
                'offered_qos_profiles': profiles(topic.metadata),
                'type_description_hash': topic.metadata.get(HASH, '')},
             'message_count': topic.messages} for topic in topics.values()],
        'compression_format': '', 'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [{'path': file.name, **_times(file.span),
                   'message_count': sum(topic.messages for topic in file.topics)}
                  for file in files],
        'custom_data': about, 'ros_distro': os.environ.get('ROS_DISTRO', 'jazzy')}


def _times(span: tuple[int, int] | None) -> Metadata:
    start, end = span or (NOT_STARTED, NOT_STARTED)
    return {'duration': {'nanoseconds': end - start},
            'starting_time': {'nanoseconds_since_epoch': start}}


def write(folder: Path, metadata: Metadata) -> None:
    """Write metadata.yaml by a rename: a reader always gets the old or the new text."""
    part = folder / 'metadata.yaml.part'
    part.write_text(dumped({'rosbag2_bagfile_information': metadata}), encoding='utf-8')
    part.replace(folder / 'metadata.yaml')


# --- names and files -----------------------------------------------------------------------------

def checked_name(name: Any) -> str:
    """Return the name of a bag; raises BagError if it could lead out of the recording folder."""
    if (not isinstance(name, str) or name in ('.', '..') or '/' in name
            or not (name + 'x').isprintable()):
        raise BagError(f'bag name {name!r}: must be a plain name inside the recording directory')
    return name


def fresh_name() -> str:
    """Return a name from the clock with milliseconds: fourbar_2026_11_23-18_26_05_123."""
    seconds, rest = divmod(time.time_ns(), 10**9)
    return time.strftime('fourbar_%Y_%m_%d-%H_%M_%S', time.localtime(seconds)) \
        + f'_{rest // 10**6:03d}'


def free_name(directory: Path, name: str) -> str:
    """Return ``name`` or, if a bag has it, NAME_2, NAME_3, ...; for '', a name from the clock."""
    free = name = checked_name(name) or fresh_name()
    count = 1
    while os.path.lexists(directory / free):
        count += 1
        free = f'{name}_{count}'
    return free


@contextmanager
def folder_beside(out: Path) -> Iterator[Path]:
    """Yield a folder to fill and then rename to ``out``, which so is whole. Raises BagError."""
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=f'.{out.name}.', dir=out.parent,
                                ignore_cleanup_errors=True) as name:        # it may be renamed
            os.chmod(name, 0o755)
            yield Path(name)
    except OSError as error:
        raise BagError(f'{out}: {error.strerror}') from None


def files_of(path: Path) -> list[Path]:
    """Return the .mcap files of a bag in order: one file, or NAME_0.mcap, NAME_1.mcap, ... ."""
    if path.is_file():
        return [path]
    if not path.exists():
        raise BagError(f'{path}: no such bag')
    # not those of metadata.yaml, which after a crash may lack the newest file
    files = sorted(path.glob('*.mcap'), key=number_of)
    if not files:
        raise BagError(f'{path}: holds no .mcap files{_how_to_convert(path)}')
    if len({file.stem.rpartition('_')[0] or file.stem for file in files}) > 1:
        raise BagError(f'{path}: holds {len(files)} .mcap files of different bags, name one')
    return files


def number_of(file: Path) -> int:
    """Return N of a file NAME_N.mcap; 0 for any other name."""
    suffix = file.stem.rpartition('_')[2]
    return int(suffix) if suffix.isdecimal() else 0


def _how_to_convert(path: Path) -> str:
    """Return the end of a message on a folder without .mcap files: what its bag is instead."""
    if packed := sorted(path.glob('*.mcap.*')):
        return f': {packed[0].name} is compressed as a whole; unpack it first'
    if list(path.glob('*.db3*')):
        return (f': this is an sqlite3 bag; first: rosbags-convert --src {path} --dst {path}_mcap '
                '--dst-storage mcap')
    if list(path.glob('*.bag')):
        return ': this is a bag of ROS 1; rosbags-convert makes one of ROS 2'
    return ''
