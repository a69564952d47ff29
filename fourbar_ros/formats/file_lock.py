# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Locks that show whether a file is being written, or to whom a folder belongs.

A lock ends with the process, which shows whether it crashed. Windows has no such locks, and opens
no folders: there, what is open cannot be removed, and no file looks as if it were being written.
"""
from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import BinaryIO

try:
    import fcntl
except ImportError:
    fcntl = None        # type: ignore[assignment]

FOLDER = os.O_RDONLY | getattr(os, 'O_DIRECTORY', 0)
OPENS_FOLDERS = hasattr(os, 'O_DIRECTORY')


def mark_as_being_written(file: BinaryIO) -> None:
    """Lock an open file."""
    if fcntl:
        with contextlib.suppress(OSError):       # file systems without locks
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_being_written(path: str | Path) -> bool:
    """Return whether a recorder has this file open."""
    with open(path, 'rb') as file:
        try:
            if fcntl:
                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        except OSError:
            pass
        return False


def locked_folder(folder: Path) -> int | None:
    """
    Lock a folder; return the descriptor that holds the lock, None if that cannot be had.

    A folder that can be locked belongs to nobody.
    """
    if not fcntl:
        return None
    number = None
    try:
        number = os.open(folder, FOLDER)
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:             # locked, gone, or a file system without locks
        if number is not None:
            os.close(number)
        return None
    return number


def sync_folders(path: Path) -> None:
    """Bring the entries of a folder and of its parent to the disk: a file without one is lost."""
    for folder in (path, path.parent) if OPENS_FOLDERS else ():
        number = os.open(folder, FOLDER)
        try:
            os.fsync(number)
        finally:
            os.close(number)
