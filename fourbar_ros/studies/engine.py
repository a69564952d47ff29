# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Run a study: chunks to an executor, parts to the folder, in any order, a few at a time.

Memory is bounded whatever the size: no more than :data:`AHEAD` chunks a worker are under way.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, FIRST_COMPLETED, Future, wait
import time
from typing import NamedTuple

from fourbar_ros.studies import StudyError
from fourbar_ros.studies.executors import Executor, Part
from fourbar_ros.studies.parts import Folder, made_with
from fourbar_ros.studies.study import Study

AHEAD = 2
# [s] between two looks whether the executor still lives.
LOOK = 1.0
# Times that workers may die without a chunk getting done in between.
DEATHS = 3


class Progress(NamedTuple):
    """How far a run is: designs done, of how many, how many of them in this run, [s] it took."""

    done: int
    total: int
    in_this_run: int
    seconds: float

    @property
    def rate(self) -> float:
        """Return the designs a second."""
        return self.in_this_run / self.seconds if self.seconds else 0.0

    @property
    def remaining(self) -> float:
        """Return the time that remains [s]; NaN before anything is done."""
        return (self.total - self.done) / self.rate if self.in_this_run else float('nan')


def run(study: Study, folder: Folder, executor: Executor,
        report: Callable[[Progress], None] = lambda progress: None) -> Progress:
    """
    Compute the chunks of a study that its folder does not hold yet.

    Parameters
    ----------
    study : Study
    folder : Folder
        After :meth:`.Folder.begin`.
    executor : Executor
    report : callable
        Called with a :class:`Progress` at the beginning and after each chunk.

    Raises
    ------
    StudyError
        The executor is gone, or its workers keep dying. What is done is kept.

    """
    there = folder.parts().keys()
    todo = (number for number in range(study.chunks) if number not in there)
    done = sum(_size(study, number) for number in there if number < study.chunks)
    progress, begun = Progress(done, study.rows, 0, 0.0), time.monotonic()
    report(progress)
    for part in _parts(study, executor, todo):
        _require_our_versions(part)
        folder.add(part.number, part.content)
        size = _size(study, part.number)
        progress = Progress(progress.done + size, study.rows, progress.in_this_run + size,
                            time.monotonic() - begun)
        report(progress)
    return progress


def _size(study: Study, number: int) -> int:
    start, stop = study.rows_of(number)
    return stop - start


def _parts(study: Study, executor: Executor, todo: Iterator[int]) -> Iterator[Part]:
    """Yield the parts of chunks as they get done."""
    under_way: dict[Future[Part], int] = {}
    again: list[int] = []
    deaths = 0
    while True:
        while len(under_way) < AHEAD * executor.workers:
            number = again.pop() if again else next(todo, None)
            if number is None:
                break
            under_way[executor.submit(study, number)] = number
        if not under_way:
            return
        finished, _ = wait(under_way, LOOK, FIRST_COMPLETED)
        executor.check()
        for future in finished:
            number = under_way.pop(future)
            try:
                part = future.result()
            except (Exception, CancelledError) as error:    # noqa: B902
                lost = [number, *under_way.values()]
                deaths += 1
                _go_on_after(error, executor, number, deaths)
                again += lost[::-1]
                under_way.clear()
                break
            deaths = 0
            yield part


def _go_on_after(error: BaseException, executor: Executor, number: int, deaths: int) -> None:
    """Let the executor recover from an error, or say that the run is over."""
    if deaths <= DEATHS and executor.recover(error):
        return
    executor.check()
    what = ' '.join(f'{type(error).__name__}: {error}'.split())
    raise StudyError(f'chunk {number} could not be computed: {what}; what is done is kept, '
                     '--resume goes on') from None


def _require_our_versions(part: Part) -> None:
    """Refuse results of other versions: their bits may differ."""
    if part.made_with != made_with():
        theirs, ours = part.made_with, made_with()
        differ = [f'{name} {theirs.get(name)}, here {ours[name]}' for name in ours
                  if theirs.get(name) != ours[name]]
        raise StudyError(f'a worker has {"; ".join(differ)}: install the same versions there')
