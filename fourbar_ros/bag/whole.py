# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files and folders that stand under their names only when they are whole."""
from __future__ import annotations

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import shutil
import tempfile

from fourbar_ros.errors import BagError
from fourbar_ros.formats.file_system import locked_folder

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
        lock = locked_folder(folder)
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
        lock = locked_folder(folder)
        if lock is not None:
            shutil.rmtree(folder, ignore_errors=True)
            os.close(lock)
            removed.append(folder)
    return removed
