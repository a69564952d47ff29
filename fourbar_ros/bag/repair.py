# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Make a whole bag from the rest that a crash, a full disk or a bad copy left.

A split bag is recovered part by part. The new bag stands under its name only when it is whole.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
import contextlib
from functools import partial
import json
from math import inf
import os
from pathlib import Path
import shutil
import tempfile
from typing import Any, BinaryIO, NamedTuple

from fourbar_ros import __version__
from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.file_system import is_being_written, locked_folder
from fourbar_ros.bag.mcap.records import Damaged, in_short, LARGEST, MESSAGE, OURS, parse, SEAL
from fourbar_ros.bag.mcap.scan import Scan
from fourbar_ros.bag.mcap.writer import Container
from fourbar_ros.bag.read.info import info, missing_of, TopicInfo
from fourbar_ros.bag.read.records import add_progress, Progress
from fourbar_ros.bag.yaml_text import dumped, loaded, YamlMap
from fourbar_ros.errors import BagError
from mcap import __version__ as mcap_version
from mcap.opcode import Opcode
from mcap.records import Channel, Schema, Statistics
import yaml

PROFILE = 'ros2'        # of a file whose header is damaged
NO_END = 'without an end: a crash, a kill, a power cut or a full disk'
MARK = '.fourbar-'      # in the name of a hidden folder, .NAME.fourbar-xxxxxxxx


class Recovered(NamedTuple):
    """
    The result of a recovery.

    Attributes
    ----------
    path : Path
        The new bag.
    messages : int
    lost : int
        Bytes of the old file that are not in the new one: its unfinished last record, damaged
        records.
    damaged : list of str
        Everything wrong with the old file: where and why.
    missing : dict
        {topic: messages that are not in the new bag}, by the old bag's statistics and our
        recorder's sequence numbers. The recorder numbers messages that it drops too.
    was_whole : bool
        The old bag was finished and nothing of it is lost.

    """

    path: Path
    messages: int
    lost: int
    damaged: list[str]
    missing: dict[str, int]
    was_whole: bool


def recover(path: str | Path, out: str | Path | None = None, progress: Progress | None = None
            ) -> Recovered:
    """
    Copy every whole record of a bag into a new bag with index, statistics and metadata.

    Chunks are copied as they are, checked against their CRC; the old bag is only read.

    ``path`` is a folder or .mcap file, cut or not; ``out`` the folder of the new bag, by default
    ``NAME_recovered`` beside the old one; ``progress`` is called with the number of bytes read.
    Raises BagError if the bag is being written or holds nothing, or the new one exists.
    """
    path, out = Path(path), Path(out) if out else beside(path)
    source, *later = rosbag2.files_of(path)
    if later:
        return _recover_parts(path, out, progress)
    if is_being_written(source):
        raise BagError(f'{path}: is being written; stop the recording first')
    with workshop(out) as folder:
        folder, file = rosbag2.create(folder, out.name)
        with open(source, 'rb') as old, file:
            scan = Scan(old)
            copy = _Copy(scan, file)
            copy.run(progress)
            if not copy.has_begun:
                raise BagError(f'{path}: nothing to recover: it ends before its first record')
            copy.finish(folder, source)
            lost = scan.lost + (0 if scan.complete else source.stat().st_size - scan.end)
        folder.rename(out)
    return Recovered(out, sum(copy.container.counts.values()), lost, scan.damage, copy.missing,
                     scan.complete and not scan.damage)


def beside(path: str | Path) -> Path:
    """Return the default path of the new bag: NAME_recovered beside NAME or NAME_0.mcap."""
    path = Path(path).absolute()
    return path.with_name((path.name if path.is_dir() else path.stem.removesuffix('_0'))
                          + '_recovered')


def _recover_parts(path: Path, out: Path, progress: Progress | None) -> Recovered:
    """
    Recover every file of a split bag into the folder ``out``.

    A part from which nothing can be recovered is named among the damages; its number is not used
    again.
    """
    recovered: list[Recovered] = []
    metadata: list[YamlMap] = []
    damaged, read = [], 0
    with workshop(out) as folder:
        work, whole = folder / 'part', folder / out.name
        whole.mkdir()
        for source in rosbag2.files_of(path):
            try:
                part = recover(source, work / out.name,
                               partial(add_progress, progress, read) if progress else None)
            except BagError as error:
                if 'is being written' in str(error):
                    raise
                damaged.append(str(error))
                continue
            finally:
                read += source.stat().st_size
            recovered.append(part)
            damaged += [f'{source.name}: {text}' for text in part.damaged]
            metadata.append(_moved(work / out.name, whole,
                                   f'{out.name}_{rosbag2.part_of(source)[1]}.mcap'))
        if not recovered:
            raise BagError(f'{path}: nothing to recover')
        rosbag2.write_metadata_file(whole, rosbag2.merged(metadata))
        topics = info(whole).topics
        whole.rename(out)
    return Recovered(out, sum(topic.messages for topic in topics),
                     sum(part.lost for part in recovered), damaged, _missing(recovered, topics),
                     all(part.was_whole for part in recovered) and not damaged)


def _missing(parts: Sequence[Recovered], topics: Sequence[TopicInfo]) -> dict[str, int]:
    """
    Return {topic: missing messages} of a recovered split bag.

    Sequence numbers over the whole bag show what a lost part held; the parts show losses where
    nobody numbered the messages. The larger one counts.
    """
    missing: Counter[str] = Counter()
    for part in parts:
        missing.update(part.missing)
    for topic in topics:
        missing[topic.topic] = max(missing[topic.topic], topic.missing or 0)
    return {topic: count for topic, count in missing.items() if count}


def _moved(folder: Path, whole: Path, name: str) -> YamlMap:
    """Move the file of a recovered part under its name into the whole bag; return its metadata."""
    file, = folder.glob('*.mcap')
    file.rename(whole / name)
    text = (folder / 'metadata.yaml').read_text(encoding='utf-8')
    metadata: YamlMap = yaml.safe_load(text)['rosbag2_bagfile_information']
    shutil.rmtree(folder)
    metadata['relative_file_paths'], metadata['files'][0]['path'] = [name], name
    return metadata


class _Copy:
    """
    Copies the sound records of a Scan into a new Container, ``container``.

    ``missing`` gets {topic: messages that are not in it}; ``has_begun`` is False if there was no
    record at all.
    """

    def __init__(self, scan: Scan, file: BinaryIO) -> None:
        self._scan, self._file = scan, file
        self.missing: dict[str, int] = {}
        self.has_begun = False
        self._metadata = ''             # rosbag2's metadata of the old file, as YAML

    def run(self, progress: Progress | None) -> None:
        """Copy all sound records; the scan notes the others, with offset and reason."""
        for offset, opcode, body in self._scan:
            try:
                if not self.has_begun:
                    self._begin(opcode, body)
                if opcode is not None:
                    self._copy_record(offset, opcode, body)
            except Damaged as error:
                self._scan.spoil(offset, str(error))
            if progress:
                progress(self._scan.end)

    def _begin(self, opcode: int | None, body: bytes) -> None:
        """Start the new file by the old header, and with the definitions at the old end."""
        header = parse(Opcode.HEADER, body) if opcode == Opcode.HEADER else None
        by = f'recovered by {OURS}{__version__}, mcap {mcap_version}'
        self.container = Container(self._file, header.profile if header else PROFILE,
                                   f'{header.library}; {by}' if header else by)
        self.has_begun, ending = True, self._scan.ending
        for record in (*ending.of(Schema), *ending.of(Channel)) if ending else ():
            self.container.copy(record)                # the chunk that has it may be damaged

    def _copy_record(self, offset: int, opcode: int, body: bytes) -> None:
        """
        Copy a record, or raise Damaged if it cannot be read or is not copied.

        Indices and statistics are left out: the new file gets its own.
        """
        container = self.container
        if opcode == Opcode.CHUNK:
            container.flush()                          # keeps the order of messages
            for record in container.copy_chunk(body, partial(self._scan.admit, offset)):
                self._scan.damage.append(f'before byte {offset}: {type(record).__name__.lower()} '
                                         f'{record.id} is another one than in the chunk there')
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            container.copy(parse(opcode, body), checked=False)
        elif opcode == Opcode.MESSAGE:                 # an unchunked file
            channel, sequence, time, published = MESSAGE.unpack_from(body)
            if channel not in container.channels:
                raise Damaged('message of an unknown channel')
            if len(body) > LARGEST:
                raise Damaged(f'message of more than {LARGEST} bytes')
            container.add_message(channel, sequence, time, body[MESSAGE.size:], published)
        elif opcode == Opcode.METADATA:
            record = parse(opcode, body)
            if record.name == rosbag2.RECORD:
                self._metadata = record.metadata.get(rosbag2.KEY) or ''
            else:
                container.add_metadata(record.name,
                                       {k: v for k, v in record.metadata.items() if k != SEAL})
        elif opcode == Opcode.ATTACHMENT:
            raise Damaged('an attachment; these are not copied')

    def finish(self, folder: Path, source: Path) -> None:
        """
        Write rosbag2's metadata and the end of the file.

        The metadata come from the old file and also list the losses. If they do not say why
        recording ended, metadata.yaml beside ``source`` may. ``folder`` is the new bag.
        """
        self.container.flush()
        try:
            old = loaded(self._metadata)
        except BagError:
            old = None
        old = old if isinstance(old, dict) else {}
        about = rosbag2.about_of(old)
        if rosbag2.ENDED not in about:
            about = rosbag2.joined(about, rosbag2.about_beside(source))
        about['recovered_by'] = f'{OURS}{__version__}'
        about.update(self._changed_entries(about))
        metadata = rosbag2.describe(f'{folder.name}_0.mcap', self.container, about,
                                    str(old.get('ros_distro') or ''),
                                    rosbag2.packing_of(old, source))
        self.container.add_metadata(rosbag2.RECORD, {rosbag2.KEY: dumped(metadata)})
        self.container.finish()
        rosbag2.write_metadata_file(folder, metadata)

    def _changed_entries(self, about: dict[str, str]) -> dict[str, str]:
        """
        Return the entries of custom_data about numbers, end and losses, for the new file.

        Notes in ``missing`` how many messages of each topic are not in it.
        """
        container, numbers = self.container, rosbag2.mapping_in(about, rosbag2.NUMBERS)
        statistics = self._scan.ending.of(Statistics) if self._scan.ending else []
        old_counts = statistics[0].channel_message_counts if statistics else {}
        repeated, still_repeated = rosbag2.repeated(about), []
        for number, channel in container.channels.items():
            pair = numbers.get(channel.topic)          # [first, next], if our recorder noted it
            count, last = container.counts.get(number, 0), container.last.get(number)
            is_repeated = channel.topic in repeated    # the part before has its first message
            if is_repeated and container.first.get(number, inf) < _first_number(pair):
                still_repeated.append(channel.topic)
                count -= 1
            by_numbers = missing_of(pair, count, last)
            missing = max(by_numbers or 0, old_counts.get(number, 0) - is_repeated - count)
            if by_numbers is not None:
                first, end = numbers[channel.topic]
                numbers[channel.topic] = first, first + count + missing if end is None else end
            if missing:
                self.missing[channel.topic] = missing
        entries = {}
        if not self._scan.complete and rosbag2.ENDED not in about:
            entries[rosbag2.ENDED] = NO_END
        if repeated:
            entries[rosbag2.REPEATS] = json.dumps(still_repeated)
        if numbers:
            entries[rosbag2.NUMBERS] = json.dumps(numbers)
        if self._scan.lost:
            entries[rosbag2.LOST] = in_short([*filter(None, [about.get(rosbag2.LOST)]),
                                              *self._scan.damage])
        return entries


def _first_number(pair: Any) -> int:
    """Return the first of the sequence numbers [first, next] of a channel, 0 if not noted."""
    is_pair = isinstance(pair, list) and pair and isinstance(pair[0], int)
    return pair[0] if is_pair else 0


@contextlib.contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """
    Give a hidden folder beside ``out``, in which to build a file or folder before moving it there.

    So ``out`` is whole whenever it exists. The folder is removed at the end, or after ``kill -9``
    by the next call with the same parent. An OSError becomes a BagError.
    """
    if os.path.lexists(out):
        raise BagError(f'{out}: exists already; nothing is overwritten')
    folder = lock = None
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        remove_orphans(out.parent)
        folder = Path(tempfile.mkdtemp(dir=out.parent, prefix=f'.{out.name}{MARK}'))
        lock = locked_folder(folder)
        yield folder
    except OSError as error:
        name = out if not error.filename or str(folder) in str(error.filename) else error.filename
        raise BagError(f'{name}: {error.strerror or error}') from None
    finally:
        if folder:
            shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def remove_orphans(directory: Path) -> list[Path]:
    """Remove the hidden folders of a workshop that killed processes left; return their paths."""
    removed = []
    for folder in directory.glob(f'.*{MARK}????????'):
        lock = locked_folder(folder)
        if lock is not None:
            shutil.rmtree(folder, ignore_errors=True)
            os.close(lock)
            removed.append(folder)
    return removed
