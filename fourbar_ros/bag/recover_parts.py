# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Make a whole bag of a split one: each part for itself, in a folder of the same layout."""
from __future__ import annotations

import shutil
import tempfile

from fourbar_ros.bag.recovered import Recovered
from fourbar_ros.errors import BagError
from fourbar_ros.formats import rosbag2
import yaml


def recover_parts(recover, path, out, progress=None):
    """
    Recover every file of a split bag into the folder ``out``.

    By the function ``recover(file, folder, progress)``. A part of which nothing is left is named
    among the damages; its number is not used again.
    """
    if out.exists():
        raise BagError(f'{out}: exists already; nothing is overwritten')
    found, metadata, damaged, read = [], [], [], 0
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix=f'.{out.name}.') as folder:
        work, whole = out.parent / folder / 'part', out.parent / folder / out.name
        whole.mkdir(parents=True)
        for source in rosbag2.files_of(path):
            try:
                made = recover(source, work / out.name,
                               progress and (lambda there, before=read: progress(before + there)))
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
                                   f'{out.name}_{rosbag2.part_of(source)[1]}.mcap'))
        if not found:
            raise BagError(f'{path}: nothing to recover')
        rosbag2.write_metadata_file(whole, rosbag2.merged(metadata))
        whole.rename(out)
    missing = {}
    for topic, count in (pair for made in found for pair in made.missing.items()):
        missing[topic] = missing.get(topic, 0) + count
    return Recovered(out, sum(made.messages for made in found), sum(made.lost for made in found),
                     damaged, missing,
                     all(made.was_whole for made in found) and not damaged)


def _moved(folder, whole, name):
    """Move the file of a recovered part under its name into the whole bag; return its metadata."""
    file, = folder.glob('*.mcap')
    file.rename(whole / name)
    told = yaml.safe_load((folder / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    shutil.rmtree(folder)
    told['relative_file_paths'], told['files'][0]['path'] = [name], name
    return told
