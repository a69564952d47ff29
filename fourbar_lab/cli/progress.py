# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Progress of a study: a bar on a terminal, elsewhere a line now and then."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fourbar_lab.studies.engine import Progress

EVERY = 30.0        # [s] between two lines about progress where there is no terminal


@contextmanager
def progress_shown() -> Iterator[Callable[[Progress], None]]:
    """Give the function that a run reports its progress to; the bar ends with the context."""
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar
    console = Console(stderr=True)
    text = '{task.fields[text]}'
    with Bar(BarColumn(), TextColumn(text), console=console, transient=True,
             disable=not console.is_terminal) as bar:
        task = bar.add_task('designs', text='', total=None)
        last = time.monotonic()          # when a line was printed

        def report(progress: Progress) -> None:
            """Move the bar; where there is no terminal, print a line now and then."""
            nonlocal last
            line = in_words(progress)
            bar.update(task, total=progress.total, completed=progress.done, text=line)
            if not console.is_terminal and time.monotonic() - last > EVERY:
                last = time.monotonic()
                print(line, file=sys.stderr, flush=True)
        yield report


def in_words(progress: Progress) -> str:
    """Return done, rate and remaining time as text."""
    text = f'{progress.done} of {progress.total} designs'
    if not progress.in_this_run:
        return text
    minutes, seconds = divmod(round(progress.remaining), 60)
    hours, minutes = divmod(minutes, 60)
    return f'{text}, {progress.rate:.0f}/s, {hours}:{minutes:02d}:{seconds:02d} remain'
