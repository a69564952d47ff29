# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Make a whole bag from the rest that a crash, a full disk or a bad copy left."""
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from fourbar_ros.bag import metadata
from fourbar_ros.bag.metadata import FileContent, TopicCount
from fourbar_ros.bag.reader import Bag, CONTENT, Progress
from fourbar_ros.errors import BagError
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.writer import Writer

NO_END = 'without an end: a crash, a kill, a power cut or a full disk'
CHUNK = 2**16       # [bytes] unpacked; the recorder ends a chunk after 0.1 s


class Recovered(NamedTuple):
    """The new bag: path, count of messages, damage of the old bag, whether that was whole."""

    path: Path
    messages: int
    damage: list[str]
    was_whole: bool


def recover(path: str | Path, out: str | Path | None = None, progress: Progress | None = None
            ) -> Recovered:
    """
    Copy all that can be read of a bag into a new bag with index, statistics and metadata.

    ``path`` is a folder or .mcap file, cut or not; ``out`` the folder of the new bag, by default
    ``NAME_recovered`` beside the old bag. The new bag appears only when it is whole; the old bag
    is only read. ``progress`` is called with the count of bytes read. Raises BagError if nothing
    can be read, or the new bag exists.
    """
    bag = Bag(path, progress)
    out = Path(out) if out else beside(bag.path)
    if out.exists():
        raise BagError(f'{out}: exists already')
    with metadata.folder_beside(out) as folder:
        files = [_copied(bag, index, folder / f'{out.name}_{metadata.number_of(file)}.mcap')
                 for index, file in enumerate(bag.files)]
        if not any(file.topics for file in files):
            raise BagError(f'{path}: nothing to recover: it holds no topic that can be read')
        whole = metadata.of_files(files)
        metadata.write(folder, whole)
        folder.rename(out)
    return Recovered(out, whole['message_count'], bag.damage,
                     bag.is_finished and bag.has_all_files and not bag.damage)


def beside(path: Path) -> Path:
    """Return the default path of the new bag: NAME_recovered beside NAME or NAME_0.mcap."""
    path = path.absolute()
    return path.with_name((path.name if path.is_dir() else path.stem.removesuffix('_0'))
                          + '_recovered')


def _copied(bag: Bag, index: int, path: Path) -> FileContent:
    """Copy all that can be read of a file of a bag to ``path``; return what the new file has."""
    about = bag.about_of(index)
    counts: Counter[int] = Counter()
    schemas: dict[int, tuple[Schema, int]] = {}         # {id in the old file: ..., new id}
    channels: dict[int, tuple[Channel, int]] = {}
    span: tuple[int, int] | None = None
    with open(path, 'xb') as stream:
        writer = Writer(stream, CHUNK, enable_data_crcs=True)
        writer.start('ros2', 'fourbar_ros recover')
        for records in bag.contents(index, CONTENT):
            for record in records:
                if isinstance(record, Schema) and record.id not in schemas:
                    schemas[record.id] = record, writer.register_schema(
                        record.name, record.encoding, record.data)
                elif isinstance(record, Channel) and record.id not in channels:
                    new = schemas[record.schema_id][1] if record.schema_id in schemas else 0
                    channels[record.id] = record, writer.register_channel(
                        record.topic, record.message_encoding, new, record.metadata)
                elif isinstance(record, Message) and record.channel_id not in channels:
                    bag.note_unknown(index, record.channel_id)
                elif isinstance(record, Message):
                    time = record.log_time
                    writer.add_message(channels[record.channel_id][1], time, record.data,
                                       record.publish_time, record.sequence)
                    counts[record.channel_id] += 1
                    span = (min(span[0], time), max(span[1], time)) if span else (time, time)
                elif isinstance(record, Metadata) and record.name != metadata.RECORD:
                    writer.add_metadata(record.name, record.metadata)
                elif isinstance(record, Attachment):
                    writer.add_attachment(record.create_time, record.log_time, record.name,
                                          record.media_type, record.data)
            if len(records) > 1:
                writer.flush()
        bag.check(index)
        if bag.summaries[index] is None:
            about['ended'] = NO_END
        if bag.damage:
            about[metadata.LOST] = '; '.join(filter(None, (about.get(metadata.LOST),
                                                           bag.damage_in_short)))
        topics = [TopicCount(channel.topic, schemas[channel.schema_id][0].name
                             if channel.schema_id in schemas else '', channel.message_encoding,
                             channel.metadata, counts[channel_id])
                  for channel_id, (channel, _) in channels.items()]
        made = FileContent(path.name, topics, span, about)
        text = metadata.dumped(metadata.of_files([made]))
        writer.add_metadata(metadata.RECORD, {metadata.KEY: text})
        writer.finish()
    return made
