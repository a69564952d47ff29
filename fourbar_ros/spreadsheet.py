# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables as CSV: for programs, or for a spreadsheet whose decimal sign is a comma."""
from collections.abc import Callable, Iterable
import csv
import io
import os
from pathlib import Path
import sys
from types import SimpleNamespace
from typing import NamedTuple

STDOUT = Path('-')      # as a file: standard output
Rows = Iterable[Iterable[object]]


class CsvStyle(NamedTuple):
    """
    How a table is written as CSV.

    ``digits``: significant ones of a number, None for all. ``excel``: for a spreadsheet whose
    decimal sign is a comma: ``;`` between cells, NaN as an empty cell, and first the mark by which
    Excel knows UTF-8.
    """

    digits: int | None = None
    excel: bool = False

    def save(self, path: Path, heads: Iterable[str], rows: Rows) -> None:
        """Write a table to a file, or to standard output with the ends of lines of its system."""
        if path == STDOUT:
            sys.stdout.flush()
            self._write(lambda text: sys.stdout.buffer.write(text.encode()), heads, rows,
                        os.linesep)
            return
        with path.open('w', encoding='utf-8', newline='') as file:
            self._write(file.write, heads, rows)

    def text(self, heads: Iterable[str], rows: Rows) -> str:
        """Return a table as the text of a file."""
        text = io.StringIO()
        self._write(text.write, heads, rows)
        return text.getvalue()

    def _write(self, write: Callable[[str], object], heads: Iterable[str], rows: Rows,
               end: str = '\r\n') -> None:
        writer = csv.writer(SimpleNamespace(write=write), lineterminator=end,
                            delimiter=';' if self.excel else ',')
        write('\ufeff' if self.excel else '')
        writer.writerow(heads)
        writer.writerows(rows if self == CsvStyle() else
                         (map(self._cell, row) for row in rows))

    def _cell(self, value: object) -> object:
        """Return a number as the text of its cell, anything else as it is."""
        if not isinstance(value, float):
            return value
        text = repr(value) if self.digits is None else f'{value:.{self.digits}g}'
        if self.excel:
            return '' if value != value else text.replace('.', ',')
        return text
