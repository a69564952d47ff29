"""The numbers of a bag as CSV, NPZ or Parquet: block by block, so that long bags need no memory."""
from __future__ import annotations

import csv
import shutil
import tempfile
import zipfile
from pathlib import Path

import numpy as np

from . import BagError
from .reader import Bag

FORMATS = ('csv', 'npz', 'parquet')


def export(path, out, format_='csv', topics=None, progress=None):
    """
    Write every topic of a bag as a table: log time [ns], then one column for every number and text.

    Array elements are columns of their own, ``position[0]``; of a JointState they carry the joint's name,
    ``position[crank]``. If the columns of a topic change on the way, a new table begins, NAME_2; in an
    .npz also if the lengths of texts do.

    Parameters
    ----------
    path : str or Path
        Bag.
    out : str or Path
        Folder for the tables (csv, parquet) or the .npz file; must not exist.
    format_ : str
        'csv', 'npz' (keys ``TOPIC/COLUMN``) or 'parquet' (needs pyarrow).
    topics : list of str, optional
        Only these.

    Returns
    -------
    written : dict
        Rows by table.

    """
    if format_ not in FORMATS:
        raise BagError(f'format {format_!r}: must be one of {", ".join(FORMATS)}')
    out = Path(out)
    if out.exists():
        raise BagError(f'{out}: exists already; nothing is overwritten')
    make = {'csv': _Csv, 'npz': _Npz, 'parquet': _Parquet}[format_]
    tables, names = {}, {}
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=f'.{out.name}.') as folder:
            for block in Bag(path).blocks(topics, progress=progress):
                for key, columns in _by_table(block, make.fixed).items():
                    if key not in tables:
                        topic = key[0]
                        number = names[topic] = names.get(topic, 0) + 1
                        name = topic.strip('/').replace('/', '.') + (f'_{number}' if number > 1 else '')
                        tables[key] = make(Path(folder), name, columns)
                    tables[key].add(columns)
            for written in tables.values():
                written.close()
            make.finish(Path(folder), tables.values(), out)
    except OSError as error:
        raise BagError(f'{error.filename or out}: {error.strerror}') from None
    return {written.name: written.rows for written in tables.values()}


def _by_table(block, fixed):
    """Return {key: columns} of a block: what goes into one table, in the order of the bag."""
    parts = {}
    for found in block:
        columns = table(found)
        key = (found.topic, *columns, *(fixed(values) for values in columns.values()))
        parts.setdefault(key, []).append((found.places, columns))
    return {key: _in_order(*zip(*found)) for key, found in parts.items()}


def _in_order(places, parts):
    """Return the rows of tables with the same columns as one, sorted by their places in the bag."""
    if len(parts) == 1:
        return parts[0]
    order = np.argsort(np.concatenate(places))
    return {name: np.concatenate([part[name] for part in parts])[order] for name in parts[0]}


def table(columns):
    """Return {column name: array of shape (n,)} of Columns."""
    found = {'log_time': columns.times}
    joints = columns.layout.texts.get('name', [])
    for leaf in columns.layout.leaves:
        values = columns.records[leaf.name]
        if leaf.format[0] == 'S':
            found[leaf.name] = np.char.decode(values, 'utf-8', 'replace').astype(f'U{values.dtype.itemsize}')
        elif leaf.shape:
            labels = joints if len(joints) == leaf.shape[0] else range(leaf.shape[0])
            found.update({f'{leaf.name}[{label}]': values[:, i] for i, label in enumerate(labels)})
        else:
            found[leaf.name] = values
    return found


class _Csv:
    """One file a table; numbers are written with all their digits."""

    @staticmethod
    def fixed(values):
        """Return what may not change within a column."""
        return None

    def __init__(self, folder, name, columns):
        self.name, self.rows = name, 0
        self._file = open(folder / f'{name}.csv', 'w', newline='', encoding='utf-8')
        self._writer = csv.writer(self._file)
        self._writer.writerow(columns)

    def add(self, columns):
        self._writer.writerows(zip(*(values.tolist() for values in columns.values())))
        self.rows += len(columns['log_time'])

    def close(self):
        self._file.close()

    @staticmethod
    def finish(folder, _, out):
        folder = shutil.copytree(folder, out)
        folder.chmod(0o755)


class _Npz:
    """Every column grows in a file of its own; they go into the .npz at the end."""

    @staticmethod
    def fixed(values):
        """Return what may not change within a column."""
        return values.dtype.str

    def __init__(self, folder, name, columns):
        self.name, self.rows, self._dtypes = name, 0, {}
        self._files = {column: open(folder / f'{name}.{i}', 'w+b') for i, column in enumerate(columns)}

    def add(self, columns):
        for column, values in columns.items():
            self._dtypes[column] = values.dtype
            self._files[column].write(np.ascontiguousarray(values).data.cast('B'))
        self.rows += len(columns['log_time'])

    def close(self):
        for file in self._files.values():
            file.flush()
            file.seek(0)

    @staticmethod
    def finish(folder, tables, out):
        part = folder / 'all.npz'
        with zipfile.ZipFile(part, 'w', zipfile.ZIP_STORED, allowZip64=True) as archive:
            for written in tables:
                for column, file in written._files.items():
                    with archive.open(f'{written.name}/{column}.npy', 'w', force_zip64=True) as entry:
                        np.lib.format.write_array_header_1_0(entry, {
                            'descr': np.lib.format.dtype_to_descr(written._dtypes[column]),
                            'fortran_order': False, 'shape': (written.rows,)})
                        shutil.copyfileobj(file, entry)
                    file.close()
        part.rename(out)


class _Parquet:
    """One file a table."""

    def __init__(self, folder, name, columns):
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            raise BagError('parquet needs pyarrow: pip install pyarrow') from None
        self.name, self.rows, self._arrow = name, 0, pyarrow
        first = pyarrow.table(columns)
        self._writer = pyarrow.parquet.ParquetWriter(folder / f'{name}.parquet', first.schema)

    def add(self, columns):
        self._writer.write_table(self._arrow.table(columns))
        self.rows += len(columns['log_time'])

    def close(self):
        self._writer.close()

    fixed, finish = staticmethod(_Csv.fixed), staticmethod(_Csv.finish)
