# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Export the numbers of a bag as CSV, NPZ or Parquet, in blocks of bounded memory.

Tables grow block by block; CSV and NPZ keep no file open between blocks.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
import csv
from pathlib import Path
import re
from typing import Any, IO
import zipfile

from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Columns, Progress
from fourbar_ros.bag.repair import workshop
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

BYTES = ('u1', 'i1')        # formats of elements whose arrays are pictures, clouds and the like
FORMATS = ('csv', 'npz', 'parquet')
ONE_FILE = ('.csv', '.parquet')         # endings of a path that is to be a file with one table


def export(path: str | Path, out: str | Path, format_: str | None = None,
           topics: Sequence[str] | None = None, progress: Progress | None = None
           ) -> dict[str, int]:
    """
    Write every topic of a bag as a table: log time [ns], a column for every number and text.

    Array elements are columns of their own, ``position[0]``; in a JointState they carry the
    joint's name, ``position[crank]``. Arrays of bytes are one column. If the columns of a topic
    change on the way, a new table begins, NAME.2.

    Parameters
    ----------
    out : str or Path
        Folder for the tables (csv, parquet), the .npz file, or a .csv or .parquet file for the
        table of one topic; must not exist.
    format_ : str, optional
        'csv', 'npz' (keys ``TOPIC/COLUMN``) or 'parquet' (needs pyarrow); default: by the ending
        of ``out``, csv for a folder.

    Returns
    -------
    written : dict
        Rows by table.

    """
    out, bag = Path(out), Bag(path)
    format_ = format_ or format_of(out)
    if format_ not in FORMATS:
        raise BagError(f'format {format_!r}: must be one of {", ".join(FORMATS)}')
    if out.suffix in ONE_FILE and out.suffix != f'.{format_}':
        raise BagError(f'{out}: ends in {out.suffix}, but the format is {format_}')
    writers: dict[str, type[Table]] = {'csv': Csv, 'npz': Npz, 'parquet': Parquet}
    writer, names = writers[format_], _Names()
    tables: dict[tuple[Any, ...], Table] = {}
    with workshop(out) as folder:
        for block in bag.blocks(topics, progress=progress):
            for key, columns in _by_table(block, writer.fixed).items():
                if key not in tables:
                    tables[key] = writer(folder, names.of(key[0]), columns)
                tables[key].add(columns)
        missing = set(topics or ()) - {key[0] for key in tables}
        known = {channel.topic for channel in bag.channels.values()}
        if not missing <= known:
            raise BagError(f'{", ".join(sorted(missing - known))}: not in the bag; it has '
                           f'{", ".join(sorted(known))}')
        for written in tables.values():
            written.close()
        made = writer.finish(folder, tables.values())
        if out.suffix in ONE_FILE:
            files = sorted(made.iterdir())
            if len(files) != 1:
                raise BagError(f'{out}: one file holds one table, these are {len(files)}; select '
                               f'a topic with --topics ({", ".join(sorted(known))}), or give a '
                               'folder')
            made, = files
        made.rename(out)
    return {written.name: written.rows for written in tables.values()}


def format_of(out: str | Path) -> str:
    """Return the format by the ending of a path: csv, npz or parquet; csv for any other."""
    ending = Path(out).suffix.removeprefix('.')
    return ending if ending in FORMATS else 'csv'


class _Names:
    """Gives each table its own file name: /a/b and /a.b would both be a.b."""

    def __init__(self) -> None:
        self._taken: set[str] = set()
        self._numbers: dict[str, int] = {}

    def of(self, topic: str) -> str:
        """Return the name of the next table of a topic: a.b, then a.b.2, of /a/b."""
        base = re.sub(r'[^\w.~-]', '_', topic.strip('/').replace('/', '.')) or '_'
        while True:
            number = self._numbers[topic] = self._numbers.get(topic, 0) + 1
            name = base + (f'.{number}' if number > 1 else '')
            if name not in self._taken:
                self._taken.add(name)
                return name


def _by_table(block: Iterable[Columns], fixed: Callable[[Array], str | None]
              ) -> dict[tuple[Any, ...], Rows]:
    """
    Return {key: rows for one table} of a block, in the order of the bag.

    Messages go into one table if topic, type, names of columns and what is ``fixed`` in each
    column are equal; the key, which begins with the topic, holds all these.
    """
    parts: dict[tuple[Any, ...], list[tuple[Array, Rows]]] = {}
    for columns in block:
        rows = table(columns)
        key = columns.topic, columns.type, *rows, *map(fixed, rows.values())
        parts.setdefault(key, []).append((columns.places, rows))
    joined = {}
    for key, found in parts.items():
        order = np.argsort(np.concatenate([places for places, _ in found]))
        joined[key] = {name: np.concatenate([rows[name] for _, rows in found])[order]
                       for name in found[0][1]}
    return joined


def table(columns: Columns) -> Rows:
    """
    Return {column name: array of shape (n,)} of n messages.

    An element of an array is a column, ``position[crank]`` in a JointState; an array of bytes, as
    a picture, is one column of bytes objects.
    """
    rows = {'log_time': columns.times}
    joints = columns.layout.texts.get('name', [])
    for leaf in columns.layout.leaves:
        values = columns.records[leaf.name]
        if leaf.format[0] == 'S':
            rows[leaf.name] = np.char.decode(values, 'utf-8',
                                             'replace').astype(f'U{values.dtype.itemsize}')
        elif leaf.shape and leaf.format in BYTES:
            rows[leaf.name] = np.empty(len(values), object)
            rows[leaf.name][:] = [row.tobytes() for row in values]
        elif leaf.shape:
            labels = joints if len(joints) == leaf.shape[0] else range(leaf.shape[0])
            rows.update({f'{leaf.name}[{label}]': values[:, i] for i, label in enumerate(labels)})
        else:
            rows[leaf.name] = values
    return rows


ROWS = 1 << 16                  # so many of a column are in memory when it goes into the .npz
Rows = dict[str, Array]         # {column: its values, shape (n,)}


class Table(ABC):
    """A file format: a table to which rows are appended, block by block."""

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        self.name, self.rows = name, 0

    @staticmethod
    def fixed(values: Array) -> str | None:
        """Return the column property that the format needs constant, as its type, or None."""
        return None

    @abstractmethod
    def add(self, columns: Rows) -> None:
        """Append rows, {column: values}."""

    def close(self) -> None:        # noqa: B027 # most formats have nothing to finish
        """Finish the file."""

    @staticmethod
    def finish(folder: Path, tables: Iterable[Any]) -> Path:
        """Return the finished file or folder, which then moves to the requested name."""
        return _in_folder(folder)


class Csv(Table):
    """One file a table; numbers with all their digits, bytes in hexadecimal."""

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        super().__init__(folder, name, columns)
        self._path = _in_folder(folder) / f'{name}.csv'
        with open(self._path, 'x', newline='', encoding='utf-8') as file:
            csv.writer(file).writerow(columns)

    def add(self, columns: Rows) -> None:
        texts = ([value.hex() for value in values] if values.dtype.kind == 'O' else values.tolist()
                 for values in columns.values())
        with open(self._path, 'a', newline='', encoding='utf-8') as file:
            csv.writer(file).writerows(zip(*texts))
        self.rows += len(columns['log_time'])


def _in_folder(folder: Path) -> Path:
    """Make the folder of the tables, with the usual permissions; the workshop's are stricter."""
    made = folder / 'tables'
    made.mkdir(exist_ok=True)
    return made


class Parquet(Table):
    """One file a table; bytes as binary."""

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        """Open a file for rows with the names and types of ``columns``; needs pyarrow."""
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            raise BagError('parquet requires pyarrow: pip install pyarrow') from None
        super().__init__(folder, name, columns)
        self._arrow = pyarrow
        schema = pyarrow.table(columns).schema
        self._writer = pyarrow.parquet.ParquetWriter(_in_folder(folder) / f'{name}.parquet',
                                                     schema)

    def add(self, columns: Rows) -> None:
        self._writer.write_table(self._arrow.table(columns))
        self.rows += len(columns['log_time'])

    def close(self) -> None:
        self._writer.close()


class Npz(Table):
    """
    Each column grows in its own file; the files are moved into the .npz at the end.

    Texts are as wide as the longest of their column. Bytes of all rows are stored one after the
    other, and ``COLUMN.ends`` says where each row ends.
    """

    @staticmethod
    def fixed(values: Array) -> str | None:
        return values.dtype.kind if values.dtype.kind in 'UO' else values.dtype.str

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        super().__init__(folder, name, columns)
        self._folder = folder
        self._arrays: dict[str, _Array] = {}     # by column
        self._ends: dict[str, int] = {}          # bytes so far in columns of bytes

    def add(self, columns: Rows) -> None:
        """Append rows to the files of their columns; kind 'O' are bytes."""
        for column, values in columns.items():
            if values.dtype.kind == 'O':
                ends = self._ends.get(column, 0) + np.cumsum([len(value) for value in values])
                self._ends[column] = ends[-1]
                self._append(f'{column}.ends', ends)
                values = np.frombuffer(b''.join(values), np.uint8)
            self._append(column, values)
        self.rows += len(columns['log_time'])

    def _append(self, column: str, values: Array) -> None:
        """Append values to the file of a column."""
        if column not in self._arrays:
            self._arrays[column] = _Array(self._folder / f'{self.name}.{len(self._arrays)}')
        self._arrays[column].append(values)

    @staticmethod
    def finish(folder: Path, tables: Iterable[Any]) -> Path:
        """Move the columns of all tables into one .npz, as TABLE/COLUMN; return its path."""
        part = folder / 'all.npz'
        with zipfile.ZipFile(part, 'w', zipfile.ZIP_STORED, allowZip64=True) as archive:
            for written in tables:
                for column, array in written._arrays.items():
                    with archive.open(f'{written.name}/{column}.npy', 'w',
                                      force_zip64=True) as entry:
                        array.move_to(entry)
        return part


class _Array:
    """An array that grows in a file; its texts may get wider."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._parts: list[tuple[int, np.dtype[Any]]] = []     # (rows, dtype), one after the other

    def append(self, values: Array) -> None:
        """Append values to the file."""
        with open(self._path, 'ab') as file:
            file.write(values.tobytes())
        if self._parts and self._parts[-1][1] == values.dtype:
            self._parts[-1] = self._parts[-1][0] + len(values), values.dtype
        else:
            self._parts.append((len(values), values.dtype))

    def move_to(self, entry: IO[bytes]) -> None:
        """
        Write the array as .npy to an open entry of an archive and remove its own file.

        All texts get as wide as the widest, since an array has one type.
        """
        dtype = max((dtype for _, dtype in self._parts), key=lambda dtype: dtype.itemsize)
        npy: Any = np.lib.format                    # numpy gives it no types
        npy.write_array_header_1_0(entry, {
            'descr': npy.dtype_to_descr(dtype), 'fortran_order': False,
            'shape': (sum(rows for rows, _ in self._parts),)})
        with open(self._path, 'rb') as file:
            for rows, written in self._parts:
                for begin in range(0, rows, ROWS):
                    part = file.read(min(ROWS, rows - begin) * written.itemsize)
                    entry.write(part if written == dtype
                                else np.frombuffer(part, written).astype(dtype).tobytes())
        self._path.unlink()
