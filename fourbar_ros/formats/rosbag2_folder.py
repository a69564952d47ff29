# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The folder of a bag as rosbag2 lays it out: NAME/NAME_0.mcap, NAME_1.mcap, metadata.yaml."""
from __future__ import annotations

from collections.abc import Mapping
import os
from pathlib import Path
import time
from typing import Any, BinaryIO

from fourbar_ros.errors import BagError
from fourbar_ros.formats.rosbag2 import about_of, ENDED
from fourbar_ros.formats.yaml_text import dumped, loaded


def write_metadata_file(folder: Path, metadata: Mapping[str, Any]) -> None:
    """Write metadata.yaml, at once or not at all."""
    part = folder / 'metadata.yaml.part'
    part.write_text(dumped({'rosbag2_bagfile_information': metadata}), encoding='utf-8')
    part.replace(folder / 'metadata.yaml')


def create(directory: str | Path, name: str) -> tuple[Path, BinaryIO]:
    """
    Make the folder and the file of a bag, both new; return (path of the folder, open file).

    An empty name takes a fresh one from the clock. Raises BagError.
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
    """Make the next file of a bag that is split; return (path, open file)."""
    path = folder / f'{folder.name}_{number}.mcap'
    return path, open(path, 'x+b', buffering=0)


def free_name(directory: str | Path, name: str) -> str:
    """
    Return a name or, if it is taken, NAME_2, NAME_3, ...

    An empty name stays empty. Raises BagError.
    """
    found, number = check_name(name), 1
    while name and os.path.lexists(Path(directory, found)):
        number += 1
        found = f'{name}_{number}'
    return found


def fresh_name() -> str:
    """Return a name from the clock."""
    nanoseconds = time.time_ns()
    return time.strftime('fourbar_%Y_%m_%d-%H_%M_%S', time.localtime(nanoseconds // 10**9)) \
        + f'_{nanoseconds % 10**9 // 10**6:03d}'


def check_name(name: Any) -> str:
    """
    Return the name of a bag.

    Raises BagError if it could lead out of the recording directory.
    """
    if (not isinstance(name, str) or name in ('.', '..') or '/' in name
            or not (name + 'x').isprintable()):
        raise BagError(f'bag name {name!r}: must be a plain name inside the recording directory')
    return name


def file_of(path: str | Path) -> Path:
    """
    Return the .mcap file of a bag given as directory or file.

    Raises BagError if there are several.
    """
    files = files_of(path)
    if len(files) > 1:
        raise BagError(f'{path}: holds {len(files)} .mcap files, name one')
    return files[0]


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
    if len(files) > 1 and len({part_of(file)[0] for file in files}) > 1:
        told = _told_files(path)
        if not {file.name for file in files} <= told.keys():
            raise BagError(f'{path}: holds {len(files)} .mcap files of different bags, name one')
        files.sort(key=lambda file: told[file.name])
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
    Return the custom_data in the metadata.yaml of a file if they say why recording ended.

    Else an empty dict.
    """
    found = _metadata_file(file.parent)
    about = about_of(found) if file.name in _names(found) else {}
    return about if ENDED in about else {}


def packing_of(metadata: Mapping[str, Any], file: Path) -> tuple[str, str]:
    """Return rosbag2's (compression_format, compression_mode) if messages are compressed."""
    for told in (metadata, _metadata_file(file.parent)):
        if str(told.get('compression_mode')).lower() == 'message':
            return str(told.get('compression_format')), 'message'
    return '', ''


def _told_files(path: Path) -> dict[str, int]:
    """Return {name: place} of the files that metadata.yaml names."""
    return {name: place for place, name in enumerate(_names(_metadata_file(path)))}


def _names(metadata: Mapping[str, Any]) -> list[str]:
    told = metadata.get('relative_file_paths')
    return [Path(str(name)).name for name in told] if isinstance(told, list) else []


def _metadata_file(folder: Path) -> dict[str, Any]:
    """Return the content of metadata.yaml, an empty dict if there is none."""
    try:
        text = (folder / 'metadata.yaml').read_text(encoding='utf-8')
        found = loaded(text)['rosbag2_bagfile_information']
    except (OSError, UnicodeDecodeError, BagError, KeyError, TypeError):
        found = None
    return found if isinstance(found, dict) else {}
