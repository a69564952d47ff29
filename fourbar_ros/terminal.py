# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables for terminals and pipes, by rich: wrapped where they must be, never cropped."""
from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

PIPE_WIDTH = 10_000     # columns of a pipe or file: nothing is wrapped there
LEAST_WIDTH = 100       # below it a terminal breaks the lines of a table itself


class PlainConsole(Console):
    """
    A console that prints no blanks at the end of a line into a pipe or file.

    A reader that ends early is told as BrokenPipeError; rich would exit with 1.
    """

    def on_broken_pipe(self) -> None:
        """Leave the error to the verb's caller."""
        raise BrokenPipeError

    def print(self, *objects: Any, **options: Any) -> None:      # noqa: A003
        """Print as the base class does."""
        if self.is_terminal:
            super().print(*objects, **options)
            return
        with self.capture() as text:
            super().print(*objects, **options)
        self.file.write(''.join(f'{line.rstrip()}\n' for line in text.get().splitlines()))


def make_console() -> Console:
    """Return the console that all verbs print to: as wide as the terminal, endless in a pipe."""
    console = PlainConsole(highlight=False, markup=False)
    console.width = max(console.width, LEAST_WIDTH) if console.is_terminal else PIPE_WIDTH
    return console


def make_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]] = ()) -> Table:
    """Return a table without lines; a ``>`` at the end of a head right-aligns its column."""
    table = Table(title=title or None, title_justify='left', title_style='bold', box=None,
                  padding=(0, 2, 0, 0), pad_edge=False, show_header=any(columns))
    for column in columns:
        table.add_column(column.rstrip('>'), justify='right' if column[-1:] == '>' else 'left',
                         overflow='fold')
    for row in rows:
        table.add_row(*row)
    return table
