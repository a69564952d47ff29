"""What is in a bag, and whether it is sound."""
from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from . import BagError
from .reader import Bag
from .recompute import scene_of


class TopicInfo(NamedTuple):
    """One topic: messages in the bag, and messages that are missing between them by their numbers."""

    topic: str
    type: str
    messages: int
    missing: int | None


class Info(NamedTuple):
    """
    A bag in short.

    Attributes
    ----------
    file : Path
    state : str
        'finished', 'being written', or 'cut'.
    size : int
        [bytes]
    start, end : int or None
        Log times of the first and the last message [ns].
    topics : list of TopicInfo
    about : dict
        What the recorder noted: scene, software, units, ...
    damage : str
        Empty, or what is wrong with the file and where; a finished bag that was not read is only asked for
        its end.

    """

    file: Path
    state: str
    size: int
    start: int | None
    end: int | None
    topics: list
    about: dict
    damage: str

    @property
    def is_sound(self):
        """Return whether the bag is finished, undamaged and has no gap that is known of."""
        return self.state == 'finished' and not self.damage and not any(topic.missing for topic in self.topics)


def info(path, check=False, progress=None):
    """
    Return the :class:`Info` of a bag.

    A finished bag is only asked for its summary; with ``check``, or if it has none, every message is read.
    """
    bag = Bag(path)
    try:
        about = bag.metadata().get('custom_data') or {}
    except BagError:
        about = {}
    being_written = bag.is_being_written
    summary = None if check else bag.summary()
    if summary and summary.statistics:
        topics, start, end, damage = *_told(summary), ''
    else:
        topics, start, end, damage = _count(bag, progress)
    state = 'being written' if being_written else 'cut' if bag.cut else 'finished'
    return Info(bag.file, state, bag.file.stat().st_size, start, end, topics, about, damage)


def _told(summary):
    """Return (topics, start, end) as the summary of a bag tells them."""
    statistics, names = summary.statistics, {number: schema.name for number, schema in summary.schemas.items()}
    topics = [TopicInfo(channel.topic, names.get(channel.schema_id, ''),
                        statistics.channel_message_counts.get(channel.id, 0), None)
              for channel in summary.channels.values()]
    begun = statistics.message_count > 0
    return topics, statistics.message_start_time if begun else None, statistics.message_end_time if begun else None


def _type_of(bag, topic):
    try:
        return bag.type_of(topic)
    except BagError:            # a bag without schemas, or the schema is what is damaged
        return ''


def _count(bag, progress):
    """Read everything; return (topics, start, end, damage)."""
    counts, last, missing = Counter(), {}, Counter()
    start = end = None
    damage = ''
    try:
        for chunk in bag.chunks(progress=progress):
            for number, sequence, stamp, _ in chunk:
                counts[number] += 1
                missing[number] += max(sequence - last.get(number, sequence) - 1, 0)
                last[number] = sequence
                start = stamp if start is None or stamp < start else start
                end = stamp if end is None or stamp > end else end
    except BagError as error:
        if not bag.damage:          # nothing is wrong at any byte: it is no bag at all
            raise
        damage = str(error)
    damage = '; '.join(bag.damage) or damage
    topics = [TopicInfo(channel.topic, _type_of(bag, channel.topic), counts[number], missing[number])
              for number, channel in bag.channels.items()]
    return topics, start, end, damage


def parameter_file(path, source):
    """Return the scene of a bag as the text of a ROS 2 parameter file, driven by ``source``."""
    import yaml
    scene, _ = scene_of(path)
    values = {name: value for name, value in scene.values.items() if value == value and value not in ('', [])}
    values.update({'drive.source': source, 'recording.start': False})
    tree = {}
    for name, value in values.items():
        *path_, last = name.split('.')
        place = tree
        for step in path_:
            place = place.setdefault(step, {})
        place[last] = list(value) if isinstance(value, tuple) else value
    return yaml.safe_dump({'/**': {'ros__parameters': tree}}, sort_keys=False)


def software_of(about):
    """Return what made a bag as one line."""
    try:
        return ', '.join(f'{name} {version}' for name, version in json.loads(about.get('software', '{}')).items())
    except ValueError:
        return ''
