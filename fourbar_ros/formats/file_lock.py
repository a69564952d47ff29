# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The lock that shows whether a file is being written."""
from __future__ import annotations

import contextlib
import fcntl
from pathlib import Path
from typing import BinaryIO


def mark_as_being_written(file: BinaryIO) -> None:
    """Lock an open file; the lock ends with the process, which shows whether it crashed."""
    with contextlib.suppress(OSError):       # file systems without locks
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_being_written(path: str | Path) -> bool:
    """Return whether a recorder has this file open."""
    with open(path, 'rb') as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        except OSError:
            pass
        return False
