# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where chunks are computed: processes of this machine, or a Dask cluster.

Both give :class:`concurrent.futures.Future` objects; the engine knows no more of them.
"""
from __future__ import annotations

from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
import multiprocessing
import os
import signal
import threading
from typing import Any, NamedTuple, Protocol

from fourbar_ros.studies import StudyError
from fourbar_ros.studies.parts import encode, made_with
from fourbar_ros.studies.rows import Chunk, compute, FAILED, nothing
from fourbar_ros.studies.study import Study

# [s] until a scheduler must have answered.
PATIENCE = 30.0


class Part(NamedTuple):
    """A chunk as a worker returns it: its number, the Parquet file, the versions behind it."""

    number: int
    content: bytes
    counts: dict[str, int]
    made_with: dict[str, str]


def compute_part(study: Study, number: int) -> Part:
    """Return a chunk as a file; runs in a worker."""
    try:
        chunk = compute(study, number)
    except MemoryError:
        raise                      # of this machine now, not of the designs
    except Exception as error:     # noqa: B902    an error of ours: listed, not fatal
        start, stop = study.rows_of(number)
        text = f'rows {start} to {stop - 1}: {type(error).__name__}: {error}'
        chunk = Chunk(nothing(study), {FAILED: stop - start}, [(start, text)])
    return Part(number, encode(study, chunk), chunk.counts, made_with())


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
        """End; what is under way is given up."""


def _begin_worker(alive: Any) -> None:
    """Leave Ctrl-C to the main process, and end when that ends, however, or closes its pipe."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def follow() -> None:
        alive.poll(None)           # nothing is ever sent
        # a chunk may hold the main thread for seconds; Windows kills with any signal
        os.kill(os.getpid(), getattr(signal, 'SIGKILL', signal.SIGTERM))

    threading.Thread(target=follow, daemon=True).start()


class Local:
    """
    Processes of this machine.

    Parameters
    ----------
    workers : int, optional
        How many; None: one for each processor that this process may use.

    """

    def __init__(self, workers: int | None = None):
        usable = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else None
        self.workers = workers or usable or os.cpu_count() or 1
        self._begin()

    def _begin(self) -> None:
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
        self._alive.close()            # what runs is not waited for
        self._pool.shutdown(wait=False, cancel_futures=True)


class Cluster:
    """
    A Dask cluster.

    Parameters
    ----------
    address : str
        Address of its scheduler, as ``tcp://host:8786``.

    Raises
    ------
    StudyError
        It does not answer, or has other versions than this process.

    """

    def __init__(self, address: str):
        import distributed
        self._address = address
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
