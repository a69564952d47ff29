# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files and folders that stand under their names only when they are whole."""
from __future__ import annotations

import contextlib
import os
from pathlib import Path
import shutil
import tempfile

from fourbar_ros.errors import BagError


@contextlib.contextmanager
def workshop(out):
    """
    Give a hidden folder beside ``out`` to build it in.

    Move it to ``out`` from there when it is whole.

    Whatever happens, the folder is gone afterwards. An OSError becomes a BagError.
    """
    if os.path.lexists(out):
        raise BagError(f'{out}: exists already; nothing is overwritten')
    folder = None
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=out.parent, prefix=f'.{out.name}.'))
        yield folder
    except OSError as error:
        name = out if not error.filename or str(folder) in str(error.filename) else error.filename
        raise BagError(f'{name}: {error.strerror or error}') from None
    finally:
        if folder:
            shutil.rmtree(folder, ignore_errors=True)
