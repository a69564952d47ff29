# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Several bags at once: find them below folders, work on each in a process of its own."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
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

    A bag in several of them is named once. Raises BagError for a path without a bag.
    """
    bags: dict[Path, Path] = {}           # by resolved path
    for path in map(Path, paths):
        new = _bags_in(path)
        if not new:
            raise BagError(f'{path}: holds no bags{rosbag2.hint_of(path)}')
        bags |= {bag.resolve(): bag for bag in reversed(new) if bag.resolve() not in bags}
    return sorted(bags.values())


def _bags_in(path: Path) -> list[Path]:
    """
    Return a bag itself, or the bags at any depth below a folder.

    If the .mcap files of a folder are not the parts of one bag, each counts as a bag.
    """
    if not path.is_dir():
        rosbag2.files_of(path)                           # raises BagError if it does not exist
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
    Return ``work(bag)`` for every bag in order; an error takes the place of its result.

    ``work`` is a function of a module, or a partial of one, so that other processes can import it;
    ``jobs`` the number of processes, 0 for as many as processors; ``done`` is called with the
    number of bags that are done.
    """
    jobs = min(jobs or os.cpu_count() or 1, len(bags))
    attempt = partial(_attempted, work)
    # Spawned, not forked: this process may have threads.
    pool = ProcessPoolExecutor(jobs, mp_context=get_context('spawn')) if jobs > 1 else None
    results = []
    try:
        for result in pool.map(attempt, bags) if pool else map(attempt, bags):
            results.append(result)
            if done:
                done(len(results))
        return results
    finally:
        if pool:
            pool.shutdown(wait=True, cancel_futures=True)


def _attempted(work: Callable[[Path], Result], bag: Path) -> Result | BagError:
    """Return the result of the work or a BagError, which unlike other errors can be pickled."""
    try:
        return work(bag)
    except (FourBarError, OSError) as error:
        return BagError(str(error))
