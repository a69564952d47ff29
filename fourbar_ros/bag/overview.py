# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Topics, times and state of a bag, and whether it is sound."""
from collections import Counter, defaultdict
from html import escape
from pathlib import Path
from sys import getsizeof
from typing import NamedTuple

from fourbar_ros.bag import metadata, origin, reader
from fourbar_ros.notebook import html_table, short_repr
from fourbar_ros.scene.files import as_text


class TopicInfo(NamedTuple):
    """A topic of a bag; counts of messages are None where nobody looked."""

    topic: str
    type: str
    messages: int
    missing: int | None         # by sequence numbers
    misfits: int | None         # do not fit the definition of their type


class Info(NamedTuple):
    """A bag in short."""

    path: Path
    is_finished: bool           # every file has an end: no crash, and no recorder at work
    size: int                   # of all files [bytes]
    files: int
    start: int | None           # log times of the first and the last message [ns]
    end: int | None
    topics: list[TopicInfo]
    about: dict[str, str]       # notes of the recorder: scene, software, units, ...
    damage: str                 # the first fault and how many there are; '' if none was read

    def __repr__(self) -> str:
        return short_repr('Info', {
            **self._asdict(), 'path': str(self.path), 'topics': len(self.topics), 'about': '...'})

    def _repr_html_(self) -> str:
        state = 'sound' if self.is_sound else self.damage or 'not sound'
        seconds = 1e-9 * ((self.end or 0) - (self.start or 0))
        return (f'<p>{escape(str(self.path))}: {state}, {self.size} bytes, {seconds:.6g} s</p>'
                + html_table(('topic', 'type', 'messages'), [topic[:3] for topic in self.topics]))

    @property
    def ended(self) -> str:
        """Return why the recording ended, if the bag states it."""
        return self.about.get('ended', '')

    @property
    def dropped(self) -> int:
        """Return how many messages the recorder had to drop, as it noted."""
        noted = self.about.get('dropped', '0')
        return int(noted) if noted.isdecimal() else 0

    @property
    def lost(self) -> str:
        """Return what a bag had lost when it was recovered; empty if nothing."""
        return self.about.get(metadata.LOST, '')

    @property
    def missing(self) -> int:
        return sum(topic.missing or 0 for topic in self.topics)

    @property
    def misfits(self) -> int:
        return sum(topic.misfits or 0 for topic in self.topics)

    @property
    def is_sound(self) -> bool:
        """Return whether the bag is finished, undamaged and lacks no message that is known."""
        return self.is_finished and not (self.damage or self.missing or self.dropped
                                         or self.lost or self.misfits)


def info(path: str | Path, check: bool = False, progress: reader.Progress | None = None) -> Info:
    """
    Return the :class:`Info` of a bag.

    Of a finished bag only the statistics at the end of each file are read; with ``check``, or if
    these or metadata.yaml disagree or are missing, every message is read. ``check`` compares
    checksums, and messages with their definitions, too. ``progress`` is called with the count of
    bytes read.
    """
    bag = reader.Bag(path, progress)
    counts: Counter[str] = Counter()
    missing: Counter[str] = Counter()
    misfits: Counter[str] = Counter()
    start = end = None
    is_read = check or not bag.is_consistent
    if is_read:
        following: dict[str, int] = {}      # {topic: sequence number that is due}
        waiting = defaultdict[str, list[bytes]](list)       # messages to be checked
        room = reader.ROOM

        def check_waiting() -> None:
            for topic, messages in waiting.items():
                misfits[topic] += bag.misfits(topic, messages)
            waiting.clear()

        # our recorder counts from 0, other recorders begin anywhere
        is_from_zero = 'topics' in bag.about and metadata.number_of(bag.files[0]) == 0
        for raw in bag.raw():
            due = following.get(raw.topic, 0 if is_from_zero else raw.sequence)
            gap = (raw.sequence - due) & 0xFFFFFFFF
            if gap < 1 << 31:       # sequence numbers of 32 bits wrap; a larger gap is a step back
                missing[raw.topic] += gap
            counts[raw.topic] += 1
            following[raw.topic] = raw.sequence + 1
            start = raw.time if start is None else min(start, raw.time)
            end = raw.time if end is None else max(end, raw.time)
            if check:
                waiting[raw.topic].append(raw.data)
                room -= getsizeof(raw.data)
                if room < 0:
                    check_waiting()
                    room = reader.ROOM
        check_waiting()
    else:
        times: list[int] = []
        for summary in bag.summaries:
            statistics = summary.statistics if summary else None
            if summary and statistics:
                for channel_id, channel in summary.channels.items():
                    counts[channel.topic] += statistics.channel_message_counts.get(channel_id, 0)
                if statistics.message_count:
                    times += statistics.message_start_time, statistics.message_end_time
        start, end = min(times, default=None), max(times, default=None)
    topics = [TopicInfo(topic, type_name, counts[topic], missing[topic] if is_read else None,
                        misfits[topic] if check else None)
              for topic, type_name in bag.types.items()]
    for index in range(len(bag.files)) if check else ():
        bag.check(index)
    about = bag.about       # reading this may add to the damage
    return Info(bag.path, bag.is_finished, bag.size, len(bag.files), start, end, topics, about,
                bag.damage_in_short)


def parameter_file(path: str | Path, source: str, node: str | None = None) -> str:
    """Return the scene of a bag as the text of a ROS 2 parameter file, driven by ``source``."""
    values = {name: value for name, value in origin.origin_of(path, node).scene.values.items()
              if value == value and value not in ('', [])}
    values.update({'drive.source': source, 'recording.start': False})
    return as_text(values)
