# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Run a study: a folder of Parquet files, one part a chunk, computed by processes or a Dask cluster.

A part stands under its name only when it is whole, and carries the study and the versions that
made it. So whatever was killed, parts that exist are right, and missing ones are computed again.
"""
from collections.abc import Callable, Iterator
from concurrent import futures
from contextlib import AbstractContextManager, contextmanager
from dataclasses import asdict
from functools import lru_cache
from io import BytesIO
import json
import multiprocessing
from multiprocessing.connection import Connection
import os
from pathlib import Path
import signal
import threading
from typing import Any

from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.study import Study, StudyError
import fourbar_ros

# Version of the formulas: raise it when results change in their bits, so that a study begun before
# is not resumed.
KERNELS = '7'
PART = 'part-{:08d}.parquet'
KEY = b'fourbar_ros'    # of our metadata in a part
PATIENCE = 30.0         # [s] until a scheduler must have answered
KEPT = 'what is done is kept, --resume goes on'


@contextmanager
def processes(workers: int | None = None) -> Iterator[futures.Executor]:
    """Give a pool of processes, one a processor by default, that end with the context."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else None
    context = multiprocessing.get_context('spawn')
    theirs, ours = context.Pipe(duplex=False)       # closes even if this process is killed
    pool = futures.ProcessPoolExecutor(workers or usable, context, _begin_worker, (theirs,))
    try:
        yield pool
    finally:
        ours.close()                                # what runs is not waited for
        pool.shutdown(cancel_futures=True)


def _begin_worker(alive: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def follow() -> None:
        alive.poll(None)                            # nothing is ever sent
        os._exit(1)                                 # a chunk may hold the main thread for seconds

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def cluster(address: str) -> Iterator[futures.Executor]:
    """Give the executor of a Dask cluster by the address of its scheduler, tcp://host:8786."""
    import distributed
    try:
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise StudyError(f'no Dask scheduler answers at {address}: {error}') from None
    with client, client.get_executor(pure=False) as pool:
        yield pool


def run(study: Study, folder: str | Path,
        pool: Callable[[], AbstractContextManager[futures.Executor]] = processes, *,
        resume: bool = False, report: Callable[[int], object] = lambda there: None) -> int:
    """
    Compute the parts of a study that its folder does not hold yet; return how many designs.

    ``pool`` gives the executor: :func:`processes` or :func:`cluster`, with their arguments bound.
    ``report`` is told how many designs are there, first and as each part gets done. StudyError if
    the folder holds a study that is another or not to be resumed; if a worker fails or dies; if a
    part cannot be written.
    """
    folder = Path(folder)
    _begin(study, folder, resume)
    there = parts(folder).keys()
    before = done = sum(len(study.rows_of(chunk)) for chunk in there)
    report(done)
    try:
        with pool() as executor:
            work = [executor.submit(compute_part, study, chunk, made_with())
                    for chunk in range(study.chunks) if chunk not in there]
            for future in futures.as_completed(work):
                chunk, content = future.result()
                _write(folder / PART.format(chunk), content)
                done += len(study.rows_of(chunk))
                report(done)
    except (futures.BrokenExecutor, futures.CancelledError):    # chunks under way are lost
        raise StudyError(f'the workers are gone; {KEPT}') from None
    return done - before


def compute_part(study: Study, chunk: int, versions: dict[str, str]) -> tuple[int, bytes]:
    """Return a chunk's index and part; runs in a worker, which must have these versions."""
    if versions != made_with():
        raise StudyError(f'a worker has {made_with()}, and this command {versions}: install the '
                         'same there')
    try:
        return chunk, encode(study, chunk)
    except Exception as error:     # noqa: B902
        rows = study.rows_of(chunk)
        raise StudyError(f'rows {rows[0]} to {rows[-1]} could not be computed: '
                         f'{type(error).__name__}: {error}; {KEPT}') from None


def encode(study: Study, chunk: int) -> bytes:
    """Return the part of a chunk: a Parquet file, the same bytes for the same values."""
    import pyarrow
    from pyarrow import parquet
    results = compute(study, chunk)
    units = {varied.name: varied.unit for varied in study.vary}
    units |= {measure.name: measure.unit for measure in study.measures}
    arrays = [pyarrow.array(column) for column in results.columns.values()]
    fields = [pyarrow.field(name, array.type,
                            metadata={'unit': units[name]} if units.get(name) else None)
              for name, array in zip(results.columns, arrays)]
    text = _about(study, counts=results.counts, failures=results.failures)
    schema = pyarrow.schema(fields, {KEY: text})
    file = BytesIO()
    parquet.write_table(pyarrow.table(arrays, schema=schema), file, compression='zstd')
    return file.getvalue()


def _about(study: Study, **results: Any) -> str:
    return json.dumps({'made_with': made_with(), 'study': asdict(study), **results})


@lru_cache(maxsize=1)
def made_with() -> dict[str, str]:
    """Return the versions of all software that decides about the bits of the results."""
    from importlib.metadata import version
    return {'fourbar_ros': fourbar_ros.__version__, 'kernels': KERNELS,
            **{name: version(name) for name in ('numpy', 'scipy', 'pyarrow')}}


# --- the folder ----------------------------------------------------------------------------------

def parts(folder: Path) -> dict[int, Path]:
    """Return {chunk: its file} of the parts there are, in order."""
    return {int(path.stem.removeprefix('part-')): path
            for path in sorted(folder.glob('part-*.parquet'))}


def about(part: Path) -> dict[str, Any]:
    """Return counts, failures, study and versions of a part; StudyError if it is none."""
    from pyarrow import parquet
    try:
        record: dict[str, Any] = json.loads(parquet.read_schema(part).metadata[KEY])
        if not isinstance(record.get('study', {}).get('objectives'), dict):
            raise ValueError('it was computed by another version')
        return record
    except (OSError, KeyError, TypeError, ValueError) as error:     # ArrowInvalid is a ValueError
        raise StudyError(f'{part}: no part of a study: {" ".join(str(error).split())}') from None


def _begin(study: Study, folder: Path, resume: bool) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in folder.glob('.part-*'):                 # of a run that was killed
            path.unlink(missing_ok=True)
        is_foreign = any(not path.name.startswith(('.', 'part-')) for path in folder.iterdir())
    except OSError as error:
        raise StudyError(f'{folder}: {error.strerror}') from None
    if is_foreign:
        raise StudyError(f'{folder}: exists already and is no study of this version')
    there = parts(folder)
    if there and not resume:
        raise StudyError(f'{folder}: holds a study already; --resume goes on with it')
    ours = json.loads(_about(study))
    for path in there.values():
        theirs = about(path)
        differ = [name for group in ('made_with', 'study') for name, value in ours[group].items()
                  if value != theirs[group].get(name)]
        if differ:
            raise StudyError(f'{folder}: holds another study: {", ".join(differ)} '
                             f'{"differs" if len(differ) == 1 else "differ"}; give another folder')


def _write(path: Path, content: bytes) -> None:
    """Write a file that stands under its name only when it is whole and on the disk."""
    hidden = path.with_name(f'.{path.name}.{os.getpid()}')
    try:
        with hidden.open('wb') as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        hidden.replace(path)
    except OSError as error:
        hidden.unlink(missing_ok=True)
        raise StudyError(f'{path}: {error.strerror}; {KEPT}') from None
