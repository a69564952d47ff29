# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Topics, times and state of a bag, and whether it is sound."""
from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.mcap.records import in_short
from fourbar_ros.bag.read.origin import origin_of
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Progress
from fourbar_ros.errors import BagError
from fourbar_ros.scene.files import as_text


class TopicInfo(NamedTuple):
    """
    One topic: messages in the bag, and messages that are missing by their numbers.

    Bags of our recorder tell which numbers were given, so gaps at both ends count. In other bags
    only gaps in between are seen, and only if all messages are read. None: not known.
    """

    topic: str
    type: str
    messages: int
    missing: int | None


class CountedTopic(NamedTuple):
    """
    A topic of a bag: its number of messages.

    ``last`` and ``gaps`` are its newest sequence number and the numbers left out before that;
    None if the messages were not read.
    """

    topic: str
    type: str
    messages: int
    last: int | None = None
    gaps: int | None = None


class Contents(NamedTuple):
    """Topics of a bag, log times of the first and the last message [ns], damage in one line."""

    topics: list[CountedTopic]
    start: int | None
    end: int | None
    damage: str = ''


class Info(NamedTuple):
    """
    A bag in short.

    Attributes
    ----------
    file : Path
        Its .mcap file; the folder of a split bag.
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
        The damage that ``recover`` found when it made this bag.
    damage : str
        Empty, or the faults of the file and their places; in a finished bag that was not read only
        the end is checked.
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
        """Return whether the bag is finished, undamaged and has no known gap."""
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
    contents = (None if check else _by_summaries(bag)) or _by_reading(bag, progress)
    topics = [TopicInfo(topic.topic, topic.type, topic.messages,
                        missing_of(numbers.get(topic.topic), topic.messages, topic.last,
                                   topic.gaps))
              for topic in contents.topics]
    state = 'being written' if being_written else 'cut' if bag.cut else 'finished'
    return Info(bag.file if len(bag.files) == 1 else bag.path, state, bag.size, contents.start,
                contents.end, topics, about, about.get(rosbag2.ENDED, ''), _dropped(about),
                about.get(rosbag2.LOST, ''), contents.damage, len(bag.files))


def _dropped(about: Mapping[str, str]) -> int:
    """Return how many messages the recorder had to drop, by its own notes."""
    noted = about.get(rosbag2.DROPPED, '')           # version 0.1.0 noted one number
    return int(noted) if noted.isdecimal() else sum(
        count for count in rosbag2.mapping_in(about, rosbag2.DROPPED).values()
        if isinstance(count, int))


def missing_of(numbers: Any, count: int, last: int | None = None, gaps: int | None = None
               ) -> int | None:
    """
    Return how many messages of a topic are missing, None if that is not known.

    Sequence numbers 5 to 14 were given, 8 messages are there: ``missing_of((5, 15), 8)`` is 2.

    ``numbers`` is the recorder's note (first, next), where ``next`` follows the last number that
    it gave. In a bag without an end ``next`` is None: then ``last``, the number of the newest
    message, counts as the end. ``gaps`` is the answer if the recorder noted nothing.
    """
    try:
        first, end = numbers
        if end is None:
            if last is None and count:              # the messages were not read
                return gaps
            end = first if last is None else last + 1
        return int(max(end - first - count, 0))
    except (TypeError, ValueError):                 # no pair of numbers
        return gaps


def _by_summaries(bag: Bag) -> Contents | None:
    """Return the contents by the statistics at the end of each file; None if one lacks them."""
    counts: Counter[tuple[str, str]] = Counter()
    starts, ends = [], []
    for part in bag.parts:
        summary = part.summary()
        if not summary or not summary.statistics:
            return None
        statistics, repeated = summary.statistics, rosbag2.repeated(part.about())
        names = {number: schema.name for number, schema in summary.schemas.items()}
        for channel in summary.channels.values():
            counts[channel.topic, names.get(channel.schema_id, '')] += (
                statistics.channel_message_counts.get(channel.id, 0) - (channel.topic in repeated))
        if statistics.message_count:
            starts.append(statistics.message_start_time)
            ends.append(statistics.message_end_time)
    return Contents([CountedTopic(*topic, count) for topic, count in counts.items()],
                    min(starts, default=None), max(ends, default=None))


def _by_reading(bag: Bag, progress: Progress | None) -> Contents:
    """
    Return the contents by reading every message, for a check or a bag without a sound index.

    Gaps count the sequence numbers that a channel skips. A message that a later part of a split
    bag repeats is not counted. Damage ends the reading; the contents say where it is.
    """
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
    repeated = rosbag2.repeated(bag.about())
    topics = [CountedTopic(channel.topic, bag.type_if_known(number),
                           max(counts[number] - (channel.topic in repeated), 0),
                           last.get(number), gaps[number])
              for number, channel in bag.channels.items()]
    return Contents(topics, start, end, in_short(bag.damage) or damage)


def parameter_file(path: str | Path, source: str, node: str | None = None) -> str:
    """Return the scene of a bag as the text of a ROS 2 parameter file, driven by ``source``."""
    values = {name: value for name, value in origin_of(path, node).scene.values.items()
              if value == value and value not in ('', [])}
    values.update({'drive.source': source, 'recording.start': False})
    return as_text(values)


def software_of(about: Mapping[str, str]) -> str:
    """Return the software that made a bag, as one line: fourbar_ros 1.0.0, numpy 2.1.0."""
    return ', '.join(f'{name} {version}'
                     for name, version in rosbag2.mapping_in(about, 'software').items())
