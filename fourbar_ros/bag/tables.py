# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Tables that grow block by block, in one format each: CSV, NPZ, Parquet.

CSV and NPZ keep no file open between blocks.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
import csv
from pathlib import Path
from typing import Any, IO
import zipfile

from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
import numpy as np

ROWS = 1 << 16          # of a column are in memory at once when it goes into the .npz


Rows = dict[str, Array]         # {column: its values, shape (n,)}


class Table(ABC):
    """A table being written: rows are appended, block by block."""

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        self.name, self.rows = name, 0

    @staticmethod
    def fixed(values: Array) -> str | None:
        """Return the property that is constant within a column; None: there is none."""
        return None

    @abstractmethod
    def add(self, columns: Rows) -> None:
        """Append the rows of {column: values}."""

    def close(self) -> None:        # noqa: B027 # of most there is nothing to finish
        """Finish the file."""

    @staticmethod
    def finish(folder: Path, tables: Iterable[Any]) -> Path:
        """Return the file or folder to be moved to the requested name."""
        return _in_folder(folder)


class Csv(Table):
    """One file a table; numbers with all their digits, bytes in hexadecimal."""

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        super().__init__(folder, name, columns)
        self._path = _in_folder(folder) / f'{name}.csv'
        with open(self._path, 'x', newline='', encoding='utf-8') as file:
            csv.writer(file).writerow(columns)

    def add(self, columns: Rows) -> None:
        """Append the rows of {column: values}."""
        texts = ([value.hex() for value in values] if values.dtype.kind == 'O' else values.tolist()
                 for values in columns.values())
        with open(self._path, 'a', newline='', encoding='utf-8') as file:
            csv.writer(file).writerows(zip(*texts))
        self.rows += len(columns['log_time'])


def _in_folder(folder: Path) -> Path:
    """Return the folder of the tables, created with the usual permissions."""
    made = folder / 'tables'
    made.mkdir(exist_ok=True)
    return made


class Parquet(Table):
    """One file a table; bytes as binary."""

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
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
        """Append the rows of {column: values}."""
        self._writer.write_table(self._arrow.table(columns))
        self.rows += len(columns['log_time'])

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()


class Npz(Table):
    """
    Each column grows in its own file; the files are moved into the .npz at the end.

    Texts are as wide as the longest of their column. Bytes of all rows are stored one after the
    other, and ``COLUMN.ends`` says where those of each row end.
    """

    @staticmethod
    def fixed(values: Array) -> str | None:
        """Return the property that is constant within a column."""
        return values.dtype.kind if values.dtype.kind in 'UO' else values.dtype.str

    def __init__(self, folder: Path, name: str, columns: Rows) -> None:
        super().__init__(folder, name, columns)
        self._folder = folder
        self._arrays: dict[str, _Array] = {}
        self._ends: dict[str, int] = {}

    def add(self, columns: Rows) -> None:
        """Append the rows of {column: values}."""
        for column, values in columns.items():
            if values.dtype.kind == 'O':
                ends = self._ends.get(column, 0) + np.cumsum([len(value) for value in values])
                self._ends[column] = ends[-1]
                self._append(f'{column}.ends', ends)
                values = np.frombuffer(b''.join(values), np.uint8)
            self._append(column, values)
        self.rows += len(columns['log_time'])

    def _append(self, column: str, values: Array) -> None:
        if column not in self._arrays:
            self._arrays[column] = _Array(self._folder / f'{self.name}.{len(self._arrays)}')
        self._arrays[column].append(values)

    @staticmethod
    def finish(folder: Path, tables: Iterable[Any]) -> Path:
        """Return the file or folder to be moved to the requested name."""
        part = folder / 'all.npz'
        with zipfile.ZipFile(part, 'w', zipfile.ZIP_STORED, allowZip64=True) as archive:
            for written in tables:
                for column, array in written._arrays.items():
                    with archive.open(f'{written.name}/{column}.npy', 'w',
                                      force_zip64=True) as entry:
                        array.move_to(entry)
        return part


class _Array:
    """One array in a file; texts in it may grow wider."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._parts: list[tuple[int, np.dtype[Any]]] = []     # rows of what follows each other

    def append(self, values: Array) -> None:
        with open(self._path, 'ab') as file:
            file.write(values.tobytes())
        if self._parts and self._parts[-1][1] == values.dtype:
            self._parts[-1] = self._parts[-1][0] + len(values), values.dtype
        else:
            self._parts.append((len(values), values.dtype))

    def move_to(self, entry: IO[bytes]) -> None:
        """Write it as .npy and remove its file."""
        dtype = max((dtype for _, dtype in self._parts), key=lambda dtype: dtype.itemsize)
        npy: Any = np.lib.format                    # numpy gives it no types
        npy.write_array_header_1_0(entry, {
            'descr': npy.dtype_to_descr(dtype), 'fortran_order': False,
            'shape': (sum(rows for rows, _ in self._parts),)})
        with open(self._path, 'rb') as file:
            for rows, own in self._parts:
                for begin in range(0, rows, ROWS):
                    part = file.read(min(ROWS, rows - begin) * own.itemsize)
                    entry.write(part if own == dtype
                                else np.frombuffer(part, own).astype(dtype).tobytes())
        self._path.unlink()
