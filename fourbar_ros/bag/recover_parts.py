# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recover a split bag part by part into a folder of the same layout."""
from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
import shutil
from typing import Any

from fourbar_ros.bag.info import info, TopicInfo
from fourbar_ros.bag.records import behind, Progress
from fourbar_ros.bag.recovered import Recovered
from fourbar_ros.bag.whole import workshop
from fourbar_ros.errors import BagError
from fourbar_ros.formats import rosbag2, rosbag2_folder
import yaml


def recover_parts(recover: Callable[[Path, Path, Progress | None], Recovered], path: Path,
                  out: Path, progress: Progress | None = None) -> Recovered:
    """
    Recover every file of a split bag into the folder ``out``.

    ``recover(file, folder, progress)`` recovers one. A part of which nothing is left is named
    among the damages, and its number is not used again.
    """
    found, metadata, damaged, read = [], [], [], 0
    with workshop(out) as folder:
        work, whole = folder / 'part', folder / out.name
        whole.mkdir()
        for source in rosbag2_folder.files_of(path):
            try:
                made = recover(source, work / out.name,
                               partial(behind, progress, read) if progress else None)
            except BagError as error:
                if 'is being written' in str(error):
                    raise
                damaged.append(str(error))
                continue
            finally:
                read += source.stat().st_size
            found.append(made)
            damaged += [f'{source.name}: {text}' for text in made.damaged]
            metadata.append(_moved(work / out.name, whole,
                                   f'{out.name}_{rosbag2_folder.part_of(source)[1]}.mcap'))
        if not found:
            raise BagError(f'{path}: nothing to recover')
        rosbag2_folder.write_metadata_file(whole, rosbag2.merged(metadata))
        topics = info(whole).topics
        whole.rename(out)
    return Recovered(out, sum(topic.messages for topic in topics), sum(m.lost for m in found),
                     damaged, _missing(found, topics),
                     all(made.was_whole for made in found) and not damaged)


def _missing(found: Sequence[Recovered], topics: Sequence[TopicInfo]) -> dict[str, int]:
    """
    Return {topic: missing messages} of a recovered bag.

    The numbers of the whole bag show what a lost part held; its parts show losses where nobody
    numbered the messages.
    """
    missing: Counter[str] = Counter()
    for made in found:
        missing.update(made.missing)
    for topic in topics:
        missing[topic.topic] = max(missing[topic.topic], topic.missing or 0)
    return {topic: count for topic, count in missing.items() if count}


def _moved(folder: Path, whole: Path, name: str) -> dict[str, Any]:
    """Move the file of a recovered part under its name into the whole bag; return its metadata."""
    file, = folder.glob('*.mcap')
    file.rename(whole / name)
    text = (folder / 'metadata.yaml').read_text(encoding='utf-8')
    told = yaml.safe_load(text)['rosbag2_bagfile_information']
    shutil.rmtree(folder)
    told['relative_file_paths'], told['files'][0]['path'] = [name], name
    return told
