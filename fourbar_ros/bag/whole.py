# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files and folders that stand under their names only when they are whole."""
from __future__ import annotations

from collections.abc import Iterator
import contextlib
import fcntl
import os
from pathlib import Path
import shutil
import tempfile

from fourbar_ros.errors import BagError

MARK = '.fourbar-'          # in the name of a hidden folder, .NAME.fourbar-xxxxxxxx


@contextlib.contextmanager
def workshop(out: Path) -> Iterator[Path]:
    """
    Give a hidden folder beside ``out`` to build it in, to be moved to ``out`` when it is whole.

    Whatever happens, the folder is gone afterwards; after ``kill -9`` it is removed by the next
    call beside it. An OSError becomes a BagError.
    """
    if os.path.lexists(out):
        raise BagError(f'{out}: exists already; nothing is overwritten')
    folder = lock = None
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        remove_orphans(out.parent)
        folder = Path(tempfile.mkdtemp(dir=out.parent, prefix=f'.{out.name}{MARK}'))
        lock = _locked(folder)
        yield folder
    except OSError as error:
        name = out if not error.filename or str(folder) in str(error.filename) else error.filename
        raise BagError(f'{name}: {error.strerror or error}') from None
    finally:
        if folder:
            shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def remove_orphans(directory: Path) -> list[Path]:
    """Remove the hidden folders that killed processes left in a directory; return them."""
    removed = []
    for folder in directory.glob(f'.*{MARK}????????'):
        lock = _locked(folder)
        if lock is not None:
            shutil.rmtree(folder, ignore_errors=True)
            os.close(lock)
            removed.append(folder)
    return removed


def _locked(folder: Path) -> int | None:
    """
    Lock a folder; return the descriptor that holds the lock, None if that cannot be had.

    The lock ends with the process, so a folder that can be locked belongs to nobody.
    """
    number = None
    try:
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:             # locked, gone, or a file system without locks
        if number is not None:
            os.close(number)
        return None
    return number
