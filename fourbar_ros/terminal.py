# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables for terminals and pipes that never crop a number: they wrap text, or stack rows."""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import Any

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions
from rich.measure import Measurement
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

PIPE_WIDTH = 10_000     # columns of a pipe or file: nothing is wrapped there
GAP = 2                 # blanks between two columns
WHOLE_WORDS: dict[str, Any] = {'break_long_words': False, 'break_on_hyphens': False}


def make_console() -> Console:
    """Return the console that all verbs print to: as wide as the terminal, endless in a pipe."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=PIPE_WIDTH)


class PlainTable:
    """
    A table without lines. Right-aligned columns are never wrapped; the others wrap between words.

    If the table is still too wide, each row becomes a block: its first cell, and below it the
    other cells with their heads. Print it with a rich console. ``columns`` are the heads; a ``>``
    at the end of one right-aligns its column.
    """

    def __init__(self, title: str, columns: Sequence[str]) -> None:
        self.title = title
        self.heads = [column.rstrip('>') for column in columns]
        self.is_right = [column.endswith('>') for column in columns]
        self.show_header = True
        self._rows: list[tuple[list[str], bool]] = []    # (cells, whether a section ends there)

    def add_row(self, *cells: str) -> None:
        """Add a row; missing cells are empty."""
        self._rows.append(([*cells, *[''] * (len(self.heads) - len(cells))], False))

    def add_section(self) -> None:
        """Leave an empty line after the rows so far."""
        if self._rows:
            self._rows[-1] = (self._rows[-1][0], True)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(1, options.max_width)

    def __rich_console__(self, console: Console,
                         options: ConsoleOptions) -> Iterator[Text | Segment]:
        """Yield title and rows, side by side or stacked, as wide as the console: rich calls it."""
        if self.title:
            yield from (Text(line, style='bold') for line in wrap(self.title, options.max_width,
                                                                  **WHOLE_WORDS))
        self._drop_empty_columns()
        if sum(self._least_widths()) + GAP * (len(self.heads) - 1) > options.max_width:
            yield from self._stacked(options.max_width)
            return
        # rich pads the last column too: that gap may stick out
        wide = options.update(width=options.max_width + GAP, height=None)
        for line in console.render_lines(self._as_rich(), wide, pad=False):
            yield from _without_blanks_at_end(line)
            yield Segment.line()

    def _drop_empty_columns(self) -> None:
        """Drop columns that have neither a head nor a cell."""
        kept = [i for i, head in enumerate(self.heads) if head
                or any(cells[i] for cells, _ in self._rows)]
        self.heads = [self.heads[i] for i in kept]
        self.is_right = [self.is_right[i] for i in kept]
        self._rows = [([cells[i] for i in kept], ends) for cells, ends in self._rows]

    def _least_widths(self) -> list[int]:
        """Return the least width of each column: its longest cell, or word where it may wrap."""
        rows = [cells for cells, _ in self._rows] + [self.heads] * self.show_header
        return [max((cell_len(part) for cells in rows
                     for part in ([cells[i]] if is_right else cells[i].split())), default=0)
                for i, is_right in enumerate(self.is_right)]

    def _as_rich(self) -> Table:
        """Return the rich table that lays out the columns side by side."""
        table = Table(box=None, padding=(0, GAP, 0, 0), show_header=self.show_header)
        for head, right, least in zip(self.heads, self.is_right, self._least_widths()):
            table.add_column(Text(head), justify='right' if right else 'left', no_wrap=right,
                             overflow='fold', min_width=least)
        for cells, ends_section in self._rows:
            table.add_row(*map(Text, cells))
            if ends_section:
                table.add_row(*map(Text, [''] * len(self.heads)))
        return table

    def _stacked(self, width: int) -> Iterator[Text]:
        """Yield lines of each row as a block: its first cell, then its 'head cell' pairs."""
        for cells, ends_section in self._rows:
            yield from map(Text, _filled(cells[:1], width))
            items = [f'{head.strip()} {cell}' if head.strip() not in ('', 'unit') else cell
                     for head, cell in zip(self.heads[1:], cells[1:]) if cell]
            yield from (Text('  ' + line) for line in _filled(items, width - 2))
            if ends_section:
                yield Text('')


def _filled(items: list[str], width: int) -> Iterator[str]:
    """Yield lines of ``width`` filled with items; only one longer than a line is broken."""
    line = ''
    for item in (part for whole in items for part in wrap(whole, width, **WHOLE_WORDS)):
        if line and cell_len(line) + GAP + cell_len(item) > width:
            yield line
            line = ''
        line += ' ' * GAP * bool(line) + item
    if line:
        yield line


def _without_blanks_at_end(line: list[Segment]) -> list[Segment]:
    """Return the segments of a line without blanks at its end."""
    line = list(line)
    while line:
        last = line.pop()
        if text := last.text.rstrip(' '):
            return [*line, Segment(text, last.style, last.control)]
    return line
