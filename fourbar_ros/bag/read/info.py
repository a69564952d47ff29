# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What is in a bag, and whether it is sound."""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.mcap.records import in_short
from fourbar_ros.bag.read.origin import scene_of
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Progress
from fourbar_ros.errors import BagError
from fourbar_ros.scene.files import as_text


class TopicInfo(NamedTuple):
    """
    One topic: messages in the bag, and messages that are missing by their numbers.

    Bags of our recorder tell which numbers were given, so that gaps at both ends count; of others
    only those in between are seen, if all messages are read. None: not known.
    """

    topic: str
    type: str
    messages: int
    missing: int | None


class Counted(NamedTuple):
    """A topic as counted: messages, the newest sequence number and the gaps, if they were read."""

    topic: str
    type: str
    messages: int
    numbers: tuple[int | None, int] | tuple[()]


Told = tuple[list[Counted], 'int | None', 'int | None']         # topics, start and end [ns]


class Info(NamedTuple):
    """
    A bag in short.

    Attributes
    ----------
    file : Path
        Its .mcap file, of a split bag the folder.
    state : str
        'finished', 'being written', or 'cut'.
    size : int
        [bytes]
    start, end : int or None
        Log times of the first and the last message [ns].
    topics : list of TopicInfo
    about : dict
        What the recorder noted: scene, software, units, ...
    ended : str
        Why the recording ended, if the bag states it.
    dropped : int
        How many of the missing messages the recorder had to drop.
    lost : str
        What ``recover`` found damaged when it made this bag.
    damage : str
        Empty, or what is wrong with the file and where; a finished bag that was not read is only
        asked for its end.
    parts : int
        Files of a split bag.

    """

    file: Path
    state: str
    size: int
    start: int | None
    end: int | None
    topics: list[TopicInfo]
    about: dict[str, str]
    ended: str
    dropped: int
    lost: str
    damage: str
    parts: int = 1

    @property
    def missing(self) -> int:
        """Return how many messages are known to be missing."""
        return sum(topic.missing or 0 for topic in self.topics)

    @property
    def is_sound(self) -> bool:
        """Return whether the bag is finished, undamaged and has no gap that is known of."""
        has_numbers = (all(topic.missing is not None for topic in self.topics)
                       and rosbag2.NUMBERS in self.about)
        return (self.state == 'finished' and not self.damage and not self.missing
                and (has_numbers or not self.lost))


def info(path: str | Path, check: bool = False, progress: Progress | None = None) -> Info:
    """
    Return the :class:`Info` of a bag.

    A finished bag is only asked for its summary; with ``check``, or if it has none, every message
    is read.
    """
    bag = Bag(path)
    about = bag.about()
    numbers = rosbag2.mapping_in(about, rosbag2.NUMBERS)
    being_written = bag.is_being_written
    told = None if check else _joined([_told(part) for part in bag.parts])
    counted, start, end, damage = (*told, '') if told else _count(bag, progress)
    topics = [TopicInfo(topic.topic, topic.type, topic.messages,
                        missing_of(numbers.get(topic.topic), topic.messages, *topic.numbers))
              for topic in counted]
    state = 'being written' if being_written else 'cut' if bag.cut else 'finished'
    return Info(bag.file if len(bag.files) == 1 else bag.path, state, bag.size, start, end, topics,
                about,
                about.get(rosbag2.ENDED, ''), _dropped(about), about.get(rosbag2.LOST, ''), damage,
                len(bag.files))


def _dropped(about: Mapping[str, str]) -> int:
    told = about.get(rosbag2.DROPPED, '')           # of version 0.1.0 one number
    return int(told) if told.isdecimal() else sum(
        count for count in rosbag2.mapping_in(about, rosbag2.DROPPED).values()
        if isinstance(count, int))


def missing_of(numbers: Any, count: int, last: int | None = None, gaps: int | None = None
               ) -> int | None:
    """
    Return how many messages of a topic are missing, None if that is not known.

    Parameters
    ----------
    numbers : sequence or None
        What the recorder says that it gave: (first, next), next is None in a bag without an end.
    count : int
        Messages in the bag.
    last : int, optional
        Sequence number of the newest of them; in a bag without an end nobody knows what came after
        it.
    gaps : int, optional
        The answer where the recorder does not tell its numbers.

    """
    try:
        first, end = numbers
        if end is None and (last is not None or count):
            end = last + 1             # type: ignore[operator] # None: not known
        elif end is None:
            end = first
        found: int | None = max(end - first - count, 0)
        return found
    except (TypeError, ValueError):
        return gaps


def _told(bag: Bag) -> Told | None:
    """Return (topics, start, end) from the summary of one file, None if it lacks them."""
    summary = bag.summary()
    if not summary or not summary.statistics:
        return None
    statistics, names = summary.statistics, {number: schema.name
                                             for number, schema in summary.schemas.items()}
    repeated = rosbag2.repeated(bag.about())
    topics = [Counted(channel.topic, names.get(channel.schema_id, ''),
                      statistics.channel_message_counts.get(channel.id, 0)
                      - (channel.topic in repeated), ())
              for channel in summary.channels.values()]
    begun = statistics.message_count > 0
    return (topics, statistics.message_start_time if begun else None, statistics.message_end_time
            if begun else None)


def _joined(parts: Sequence[Told | None]) -> Told | None:
    """Return (topics, start, end) of all parts of a bag, None if one does not tell them."""
    known = [part for part in parts if part is not None]
    if len(known) < len(parts):
        return None
    topics: dict[tuple[str, str], Counted] = {}
    for topic in (topic for part in known for topic in part[0]):
        key = topic.topic, topic.type
        topics[key] = topic._replace(messages=topic.messages
                                     + (topics[key].messages if key in topics else 0))
    return (list(topics.values()), min((start for _, start, _ in known if start is not None),
                                       default=None),
            max((end for _, _, end in known if end is not None), default=None))


def _type_of(bag: Bag, number: int) -> str:
    try:
        return bag.type_of_channel(number)
    except BagError:            # a bag without schemas, or the schema is what is damaged
        return ''


def _count(bag: Bag, progress: Progress | None
           ) -> tuple[list[Counted], int | None, int | None, str]:
    """Read everything; return (topics, start, end, damage)."""
    counts: Counter[int] = Counter()
    gaps: Counter[int] = Counter()
    last: dict[int, int] = {}
    start: int | None = None
    end: int | None = None
    damage = ''
    try:
        for chunk in bag.chunks(progress=progress):
            for number, sequence, stamp, _ in chunk:
                counts[number] += 1
                gaps[number] += max(sequence - last.get(number, sequence) - 1, 0)
                last[number] = sequence
                start = stamp if start is None or stamp < start else start
                end = stamp if end is None or stamp > end else end
    except BagError as error:
        if not bag.damage:          # nothing is wrong at any byte: it is no bag at all
            raise
        damage = str(error)
    damage = in_short(bag.damage) or damage
    repeated = rosbag2.repeated(bag.about())
    topics = [Counted(channel.topic, _type_of(bag, number),
                      max(counts[number] - (channel.topic in repeated), 0),
                      (last.get(number), gaps[number]))
              for number, channel in bag.channels.items()]
    return topics, start, end, damage


def parameter_file(path: str | Path, source: str, node: str | None = None) -> str:
    """Return the scene of a bag as the text of a ROS 2 parameter file, driven by ``source``."""
    scene, _ = scene_of(path, node)
    values = {name: value for name, value in scene.values.items() if value == value
              and value not in ('', [])}
    values.update({'drive.source': source, 'recording.start': False})
    return as_text(values)


def software_of(about: Mapping[str, str]) -> str:
    """Return what made a bag as one line."""
    return ', '.join(f'{name} {version}'
                     for name, version in rosbag2.mapping_in(about, 'software').items())
