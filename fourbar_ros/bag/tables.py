# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Tables that grow block by block, in one format each: CSV, NPZ, Parquet.

CSV and NPZ keep no file open between blocks.
"""
from __future__ import annotations

import csv
import zipfile

from fourbar_ros.errors import BagError
import numpy as np

ROWS = 1 << 16          # of a column are in memory at once when it goes into the .npz


class Csv:
    """One file a table; numbers with all their digits, bytes in hexadecimal."""

    @staticmethod
    def fixed(values):
        """Return the property that is constant within a column; CSV has none."""
        return

    def __init__(self, folder, name, columns):
        self.name, self.rows = name, 0
        self._path = _in_folder(folder) / f'{name}.csv'
        with open(self._path, 'x', newline='', encoding='utf-8') as file:
            csv.writer(file).writerow(columns)

    def add(self, columns):
        """Append the rows of {column: values}."""
        texts = ([value.hex() for value in values] if values.dtype.kind == 'O' else values.tolist()
                 for values in columns.values())
        with open(self._path, 'a', newline='', encoding='utf-8') as file:
            csv.writer(file).writerows(zip(*texts))
        self.rows += len(columns['log_time'])

    def close(self):
        """Finish the file."""

    @staticmethod
    def finish(folder, _):
        """Return the file or folder to be moved to the requested name."""
        return _in_folder(folder)


def _in_folder(folder):
    """Return the folder of the tables, created with the usual permissions."""
    made = folder / 'tables'
    made.mkdir(exist_ok=True)
    return made


class Parquet:
    """One file a table; bytes as binary."""

    fixed, finish = staticmethod(Csv.fixed), staticmethod(Csv.finish)

    def __init__(self, folder, name, columns):
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            raise BagError('parquet requires pyarrow: pip install pyarrow') from None
        self.name, self.rows, self._arrow = name, 0, pyarrow
        schema = pyarrow.table(columns).schema
        self._writer = pyarrow.parquet.ParquetWriter(_in_folder(folder) / f'{name}.parquet',
                                                     schema)

    def add(self, columns):
        """Append the rows of {column: values}."""
        self._writer.write_table(self._arrow.table(columns))
        self.rows += len(columns['log_time'])

    def close(self):
        """Finish the file."""
        self._writer.close()


class Npz:
    """
    Each column grows in its own file; the files are moved into the .npz at the end.

    Texts are as wide as the longest of their column. Bytes of all rows are stored one after the
    other, and ``COLUMN.ends`` says where those of each row end.
    """

    @staticmethod
    def fixed(values):
        """Return the property that is constant within a column."""
        return values.dtype.kind if values.dtype.kind in 'UO' else values.dtype.str

    def __init__(self, folder, name, columns):
        self.name, self.rows = name, 0
        self._folder, self._arrays, self._ends = folder, {}, {}

    def add(self, columns):
        """Append the rows of {column: values}."""
        for column, values in columns.items():
            if values.dtype.kind == 'O':
                ends = self._ends.get(column, 0) + np.cumsum([len(value) for value in values])
                self._ends[column] = ends[-1]
                self._append(f'{column}.ends', ends)
                values = np.frombuffer(b''.join(values), np.uint8)
            self._append(column, values)
        self.rows += len(columns['log_time'])

    def _append(self, column, values):
        if column not in self._arrays:
            self._arrays[column] = _Array(self._folder / f'{self.name}.{len(self._arrays)}')
        self._arrays[column].append(values)

    def close(self):
        """Finish the files."""

    @staticmethod
    def finish(folder, tables):
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

    def __init__(self, path):
        self._path, self._parts = path, []          # [rows, dtype] of what follows each other

    def append(self, values):
        with open(self._path, 'ab') as file:
            file.write(values.tobytes())
        if self._parts and self._parts[-1][1] == values.dtype:
            self._parts[-1][0] += len(values)
        else:
            self._parts.append([len(values), values.dtype])

    def move_to(self, entry):
        """Write it as .npy and remove its file."""
        dtype = max((dtype for _, dtype in self._parts), key=lambda dtype: dtype.itemsize)
        np.lib.format.write_array_header_1_0(entry, {
            'descr': np.lib.format.dtype_to_descr(dtype), 'fortran_order': False,
            'shape': (sum(rows for rows, _ in self._parts),)})
        with open(self._path, 'rb') as file:
            for rows, own in self._parts:
                for begin in range(0, rows, ROWS):
                    part = file.read(min(ROWS, rows - begin) * own.itemsize)
                    entry.write(part if own == dtype
                                else np.frombuffer(part, own).astype(dtype).tobytes())
        self._path.unlink()
