# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Several bags at once: found below folders, worked on by processes of their own."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
import os
from pathlib import Path
from typing import TypeVar

from fourbar_ros.bag import rosbag2
from fourbar_ros.errors import BagError, FourBarError

Result = TypeVar('Result')


def bags_below(paths: Iterable[str | Path]) -> list[Path]:
    """
    Return the bags at paths: bags themselves, or folders that hold bags at any depth.

    A bag in several of them is named once. Raises BagError where there is none.
    """
    found: dict[Path, Path] = {}
    for path in map(Path, paths):
        bags = _bags_in(path)
        if not bags:
            raise BagError(f'{path}: holds no bags{rosbag2.hint_of(path)}')
        found |= {bag.resolve(): bag for bag in reversed(bags) if bag.resolve() not in found}
    return sorted(found.values())


def _bags_in(path: Path) -> list[Path]:
    if not path.is_dir():
        rosbag2.files_of(path)                           # says that there is no such bag
        return [path]
    if next(path.glob('*.mcap'), None):
        try:
            rosbag2.files_of(path)
            return [path]
        except BagError:                                 # loose files of several bags
            return sorted(path.glob('*.mcap'))
    return [bag for below in sorted(path.iterdir()) if below.is_dir() for bag in _bags_in(below)]


def each(work: Callable[[Path], Result], bags: Sequence[Path], jobs: int = 0,
         done: Callable[[int], object] | None = None) -> list[Result | BagError]:
    """
    Return ``work(bag)`` for every bag in order, from ``jobs`` processes.

    An error takes the place of its result.

    Parameters
    ----------
    work : callable
        A function of a module, or a partial of one.
    bags : list
    jobs : int
        0: as many as there are processors.
    done : callable, optional
        Called with the number of bags that are done.

    """
    jobs = min(jobs or os.cpu_count() or 1, len(bags))
    if jobs < 2:
        return [_tell(_attempted(work, bag), number, done) for number, bag in enumerate(bags, 1)]
    # Spawned, not forked: this process may have threads.
    pool = ProcessPoolExecutor(jobs, mp_context=get_context('spawn'))
    try:
        futures = [pool.submit(_attempted, work, bag) for bag in bags]
        return [_tell(future.result(), number, done) for number, future in enumerate(futures, 1)]
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _tell(result: Result, number: int, done: Callable[[int], object] | None) -> Result:
    if done:
        done(number)
    return result


def _attempted(work: Callable[[Path], Result], bag: Path) -> Result | BagError:
    """Return the result of the work, or its error as text that any process can read."""
    try:
        return work(bag)
    except (FourBarError, OSError) as error:
        return BagError(str(error))
