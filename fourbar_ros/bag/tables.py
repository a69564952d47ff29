# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Write the numbers in a bag as tables: CSV, NumPy (.npz) or Parquet."""
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
import re
from typing import Any

from fourbar_ros import optional, spreadsheet
from fourbar_ros.bag import metadata, reader
from fourbar_ros.bag.outputs import names_in
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.units import in_unit, require_columns, UNITS
import numpy as np

FORMATS = ('csv', 'npz', 'parquet')
TopicTable = dict[str, Array]
# float64 f41  # [N] ...
FIELD = re.compile(r'^[ \t]*[^#\s]\S*[ \t]+(\w+)[ \t]*(?:#[ \t]*\[([^\]]+)\])?', re.M)


def export(path: str | Path, out: str | Path, kind: str | None = None,
           topics: Collection[str] | None = None, progress: reader.Progress | None = None,
           tell: Callable[[str], object] | None = None,
           style: spreadsheet.CsvStyle = spreadsheet.CsvStyle(),
           units: Mapping[str, str] | None = None) -> dict[str, int]:
    """
    Write each topic of a bag as a table; return {table: rows}.

    ``out``: a new folder for tables, a new .npz file for all, or a new .csv or .parquet file for
    one topic, or ``-``, which prints it as CSV; ``kind``: one of FORMATS, by default by the ending
    of ``out``, csv for a folder. A .npz, .csv or .parquet at the end must be that of ``kind``. The
    columns are log_time [ns], header.stamp [ns] and the fields, each item of an array, but not
    arrays of bytes. ``out`` appears only when it is complete.
    Topics that are not named and whose messages are not known here, as JSON, are left out;
    ``tell`` is called with a line for each. ``style``: of CSV. ``units``: {SI unit: unit in which
    to write what measures the same}; columns whose unit the definition of their message tells
    then have it behind their name. Raises BagError; InvalidParameter for units of no column;
    MissingPackage without pyarrow.
    """
    bag, out = reader.Bag(path, progress), Path(out)
    ending = out.suffix.removeprefix('.')
    kind = kind or (ending if ending in FORMATS else 'csv')
    names, left_out = list(topics or ()), list[BagError]()
    for topic in bag.types if not topics else ():
        try:
            bag.types_of(topic)
            names.append(topic)
        except BagError as error:
            left_out.append(error)
    if left_out and not names:
        raise left_out[0]
    if tell:
        for why in left_out:
            tell(f'left out: {why}')
    for topic in names:
        if topic not in bag.types:
            raise BagError(f'{topic}: not in the bag; it has {", ".join(sorted(bag.types))}')
    if not names:
        raise BagError(f'{path}: holds no topic that can be read')
    if kind != 'csv' and (out == spreadsheet.STDOUT or style != spreadsheet.CsvStyle()):
        raise BagError(f'{out}: standard output, digits and Excel are for csv, not {kind}')
    if (kind == 'npz' or ending in FORMATS) and ending != kind:
        raise BagError(f'{out}: is to be {kind}: name it {out.stem}.{kind}')
    is_file = ending == kind or out == spreadsheet.STDOUT
    if is_file and kind != 'npz' and len(names) != 1:
        raise BagError(f'{out}: a .{kind} file holds one topic; name it, or give a folder')
    if out.exists() and out != spreadsheet.STDOUT:
        raise BagError(f'{out}: exists already')
    tables = _tables(bag, names, units)
    bag.refuse_damage()
    if not tables:
        raise BagError(f'{path}: no message on {", ".join(names)}')
    if out == spreadsheet.STDOUT:
        for table in tables.values():
            _write_csv(out, table, style)
        return {name: len(table['log_time']) for name, table in tables.items()}
    with metadata.folder_beside(out) as folder:
        if kind == 'npz':
            arrays: Any = {f'{name}/{column}': values for name, table in tables.items()
                           for column, values in table.items()}
            np.savez(folder / 'all.npz', **arrays)
        else:
            for name, table in tables.items():
                file = folder / f'{name}.{kind}'
                if kind == 'csv':
                    _write_csv(file, table, style)
                    continue
                try:
                    import pyarrow as pa
                    from pyarrow import parquet
                except ModuleNotFoundError as error:
                    raise optional.MissingPackage('parquet', error) from None
                parquet.write_table(pa.table(table), file)
        (next(folder.iterdir()) if is_file else folder).rename(out)
    return {name: len(table['log_time']) for name, table in tables.items()}


def _tables(bag: reader.Bag, topics: Collection[str], units: Mapping[str, str] | None
            ) -> dict[str, TopicTable]:
    """
    Return {table: its columns}; ``fourbar.state`` is the topic /fourbar/state.

    Rows are sorted by log times, and as they were written; a column that not all messages of a
    topic have is NaN in the rest, or '' of texts, as which whole numbers stand there that have
    more digits than a float. ``units`` as of :func:`export`.
    """
    blocks: dict[str, list[TopicTable]] = {}
    indices: dict[str, list[Array]] = {}
    for columns in bag.columns(topics):
        blocks.setdefault(columns.topic, []).append(table_of(columns))
        indices.setdefault(columns.topic, []).append(columns.indices)
    tables: dict[str, TopicTable] = {}
    kinds = list[str]()         # SI units of the columns
    for topic, of_topic in blocks.items():
        known = units_in(bag, topic) if units is not None else {}
        name = topic.strip('/').replace('/', '.')
        if name in tables:
            raise BagError(f'{bag.path}: {topic} and another topic would both be the table '
                           f'{name}; export them one by one')
        order = np.lexsort((np.concatenate(indices[topic]),
                            np.concatenate([block['log_time'] for block in of_topic])))
        table = tables[name] = {}
        for column in dict.fromkeys(column for block in of_topic for column in block):
            values = np.concatenate([block[column] for block in of_topic if column in block])
            if len(values) < len(order):
                is_there = np.repeat([column in block for block in of_topic],
                                     [len(block['log_time']) for block in of_topic])
                if values.dtype.kind in 'iu' and (abs(values.astype(float)) >= 2.0**53).any():
                    values = values.astype(str)
                is_text, known_values = values.dtype.kind == 'U', values
                values = np.full(len(order), '' if is_text else np.nan,
                                 values.dtype if is_text else float)
                values[is_there] = known_values
            values = values[order]
            if units is not None and (si := unit_of(column, known)) in UNITS:
                unit = units.get(si, si)
                kinds.append(si)
                column, values = f'{column} [{unit}]', in_unit(values, si, unit)
            table[column] = values
    require_columns(units or {}, kinds)
    return tables


def units_in(bag: reader.Bag, topic: str) -> dict[str, str]:
    """Return {field: unit} by the comments in the definition of messages, where all agree."""
    units: dict[str, str] = {}
    for field, unit in FIELD.findall(bag.definition_of(topic)):
        if units.setdefault(field, unit) != unit:
            units[field] = ''
    return units


def unit_of(column: str, units: Mapping[str, str]) -> str:
    """Return the unit of a column as ``f21.x`` or ``position[crank]``; '' if nothing tells it."""
    return units.get(column.partition('[')[0].rpartition('.')[2], '')


def table_of(columns: reader.Columns) -> TopicTable:
    """Return the columns of messages: log time, stamp, each number and each text."""
    table, stamps = {'log_time': columns.times}, columns.stamps
    # the names of a JointState, unless they change or are equal: position[crank], else position[0]
    names = [{*columns.records[field].tolist()} for field in names_in(columns.records)]
    joints = [name.decode(errors='replace') for of_joint in names for name in of_joint]
    if stamps is not None:
        table['header.stamp'] = stamps
    for field in columns.records.dtype.names or ():
        values = columns.records[field]
        if field.startswith('header.stamp.') or (
                values.ndim > 1 and values.itemsize == 1 and values.dtype.kind != 'b'):
            continue            # bytes of a picture are no columns
        if values.dtype.kind == 'S':
            table[field] = np.array([text.decode(errors='replace') for text in values.tolist()])
        elif values.ndim == 1:
            table[field] = values
        else:               # a column for each number of an array
            are_named = len(set(joints)) == len(joints) == len(names) == values.shape[1]
            keys = joints if are_named else range(values.shape[1])
            table |= {f'{field}[{key}]': values[:, i] for i, key in enumerate(keys)}
    return table


def _write_csv(path: Path, table: TopicTable, style: spreadsheet.CsvStyle) -> None:
    style.save(path, table, zip(*(values.tolist() for values in table.values())))
