# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Run a study: chunks go to an executor, finished parts to the folder, in any order.

Memory is bounded whatever the size: at most :data:`AHEAD` chunks a worker are under way. An
executor is a pool of processes of this machine or a Dask cluster; both return
:class:`concurrent.futures.Future` objects, and the engine knows no more of them.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
import logging
import multiprocessing
from multiprocessing.connection import Connection
import os
import signal
import threading
import time
from typing import Any, NamedTuple, Protocol

from fourbar_lab.studies.chunks import Chunk, compute, FAILED, nothing
from fourbar_lab.studies.folder import encode, Folder, made_with
from fourbar_lab.studies.study import Study, StudyError

AHEAD = 2           # chunks under way for each worker: one is ready when another is done
LOOK = 1.0          # [s] between two looks whether the executor still lives
DEATHS = 3          # times that workers may die without a chunk getting done in between
QUIET = ('distributed', 'tornado.application', 'asyncio')   # they print what Cluster.check says
PATIENCE = 30.0     # [s] until a scheduler must have answered


class Progress(NamedTuple):
    """How far a run is, in designs."""

    done: int
    total: int
    in_this_run: int
    seconds: float          # since the beginning of this run

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
    Compute the chunks of a study that its folder, after :meth:`.Folder.begin`, does not hold yet.

    ``report`` is called at the beginning and after each chunk. StudyError if the executor is gone,
    its workers keep dying, the disk is full, or another command computes the same folder; what is
    done is kept.
    """
    with folder.locked():
        kept = folder.parts().keys()            # numbers of chunks
        todo = (number for number in range(study.chunks) if number not in kept)
        done = sum(_size(study, number) for number in kept if number < study.chunks)
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
    """Return how many designs a chunk has: the last one may have fewer than others."""
    start, stop = study.rows_of(number)
    return stop - start


def _parts(study: Study, executor: Executor, todo: Iterator[int]) -> Iterator[Part]:
    """
    Yield the parts of chunks as they get done.

    If a worker dies, all that was under way is submitted again, for its pool is gone with it.
    """
    under_way: dict[Future[Part], int] = {}
    again: list[int] = []               # chunks that were lost, the last one first
    deaths = 0                          # since the last part
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
                deaths += 1
                _recover(error, executor, number, deaths)
                again += reversed([number, *under_way.values()])
                under_way.clear()
                break
            deaths = 0
            yield part


def _recover(error: BaseException, executor: Executor, number: int, deaths: int) -> None:
    """Let the executor recover from the error of a chunk; StudyError if it cannot any more."""
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


class Part(NamedTuple):
    """A chunk as a worker returns it: its number, its Parquet file, versions that made it."""

    number: int
    content: bytes
    made_with: dict[str, str]


def compute_part(study: Study, number: int) -> Part:
    """Return a chunk as a file; runs in a worker. An error of ours makes its designs failed."""
    try:
        chunk = compute(study, number)
    except MemoryError:
        raise                      # of this machine now, not of the designs
    except Exception as error:     # noqa: B902
        start, stop = study.rows_of(number)
        text = f'rows {start} to {stop - 1}: {type(error).__name__}: {error}'
        chunk = Chunk(nothing(study), {FAILED: stop - start}, [(start, text)])
    return Part(number, encode(study, chunk), made_with())


class Executor(Protocol):
    """What the engine asks of an executor."""

    workers: int

    def submit(self, study: Study, number: int) -> Future[Part]:
        """Begin a chunk."""

    def recover(self, error: BaseException) -> bool:
        """Return whether work goes on after this error of a future, as a worker that died."""

    def check(self) -> None:
        """Raise StudyError if nothing will come any more."""

    def close(self) -> None:
        """End, and give up work under way."""


def _begin_worker(alive: Connection) -> None:
    """
    Prepare a worker: Ctrl-C is for the main process, and the worker ends when that does.

    ``alive`` is the pipe from there; it closes even if the main process is killed.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def follow() -> None:
        """Wait in a thread until the pipe closes, then kill this process."""
        alive.poll(None)           # nothing is ever sent
        # a chunk may hold the main thread for seconds; Windows kills with any signal
        os.kill(os.getpid(), getattr(signal, 'SIGKILL', signal.SIGTERM))

    threading.Thread(target=follow, daemon=True).start()


class Local:
    """Processes of this machine, by default one for each processor that this one may use."""

    def __init__(self, workers: int | None = None):
        usable = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else None
        self.workers = workers or usable or os.cpu_count() or 1
        self._begin()

    def _begin(self) -> None:
        """Start the pool, with a pipe: when this end closes, by a kill too, its workers end."""
        context = multiprocessing.get_context('spawn')
        theirs, self._alive = context.Pipe(duplex=False)
        self._pool = ProcessPoolExecutor(self.workers, context, _begin_worker, (theirs,))

    def submit(self, study: Study, number: int) -> Future[Part]:
        try:
            return self._pool.submit(compute_part, study, number)
        except BrokenProcessPool as error:
            self.recover(error)
            return self._pool.submit(compute_part, study, number)

    def recover(self, error: BaseException) -> bool:
        if not isinstance(error, BrokenProcessPool):
            return False
        self.close()
        self._begin()
        return True

    def check(self) -> None:
        pass

    def close(self) -> None:
        self._alive.close()            # ends the workers: what runs is not waited for
        # Its thread is: Python 3.11 may wake it at exit while it closes its pipe.
        self._pool.shutdown(wait=True, cancel_futures=True)


class Cluster:
    """
    A Dask cluster, by the address of its scheduler, as ``tcp://host:8786``.

    StudyError if it does not answer, or has other versions than this process.
    """

    def __init__(self, address: str):
        """Connect to the scheduler, within :data:`PATIENCE`, and count its threads."""
        import distributed
        self._address = address
        for name in QUIET:      # a scheduler that dies is one line of ours, not forty of theirs
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            self._client: Any = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise StudyError(f'no Dask scheduler answers at {address}: {error}') from None
        self._executor = self._client.get_executor(pure=False)
        self.workers = max(1, sum(self._client.nthreads().values()))

    def submit(self, study: Study, number: int) -> Future[Part]:
        found: Future[Part] = self._executor.submit(compute_part, study, number)
        return found

    def recover(self, error: BaseException) -> bool:
        return False                  # Dask moves the work of a lost worker itself

    def check(self) -> None:
        if self._client.status != 'running':
            raise StudyError(f'the scheduler at {self._address} is gone; what is done is kept, '
                             '--resume goes on')
        self.workers = max(1, len(self._client.scheduler_info(n_workers=-1)['workers']))

    def close(self) -> None:
        self._executor.shutdown(wait=False)       # cancels what is under way
        self._client.close(timeout=1.0)
