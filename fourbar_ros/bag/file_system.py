# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Locks and syncs of files and folders, where the system has them: Windows has neither.

A lock ends with the process, which shows whether it crashed. Without locks no file appears to be
in use, and no folder appears to have lost its owner.
"""
from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import BinaryIO

try:
    import fcntl
except ImportError:
    fcntl = None        # type: ignore[assignment]  # Windows has none


def mark_as_being_written(file: BinaryIO) -> None:
    """Lock an open file, so that readers see a recorder at work on it."""
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
    Lock a folder; return the descriptor that holds the lock, None if it cannot be locked.

    Success shows that no living process owns the folder. Close the descriptor to unlock it.
    """
    if not fcntl:
        return None
    number = None
    try:
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:             # locked, gone, or a file system without locks
        if number is not None:
            os.close(number)
        return None
    return number


def sync_folders(path: Path) -> None:
    """Bring the entries of a folder and of its parent to the disk: a file without one is lost."""
    if not fcntl:               # nor can folders be opened
        return
    for folder in (path, path.parent):
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
