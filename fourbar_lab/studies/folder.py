# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The folder of a study: a manifest, and one Parquet file for each chunk.

Every file stands under its name only when it is whole: it is written under another, synced, and
renamed. After any crash, files that exist are right; missing ones are computed again.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from functools import lru_cache
import hashlib
import json
import os
from pathlib import Path
import re
from typing import Any

from fourbar_lab.studies.chunks import Chunk, nothing
from fourbar_lab.studies.study import Study, StudyError
import fourbar_ros
import numpy as np

try:
    import fcntl
except ImportError:
    fcntl = None        # type: ignore[assignment]  # Windows has none

# Version of the formulas: raise it when results change in their bits, so that a study begun before
# is not resumed.
KERNELS = '3'
# The manifest is the metadata of a part without rows: readers of a folder of Parquet files stumble
# over any other file in it.
MANIFEST, PART = '_manifest.parquet', 'part-{:08d}.parquet'
OLD_MANIFEST = 'manifest.json'      # of early versions
_PART = re.compile(r'part-(\d{8,})\.parquet')
KEY = b'fourbar_ros'        # of our metadata in a part
MOST_FAILURES = 1000        # that are listed

Manifest = dict[str, Any]       # of a folder, as JSON


def as_json(study: Study) -> Manifest:
    """Return a study as JSON has it; NaN, "not given", is left out of the scene."""
    tree = asdict(study)
    tree['values'] = {name: value for name, value in study.values.items() if value == value}
    tree['vary'] = [one._asdict() for one in study.vary]
    for name in ('measures', 'objectives', 'curves', 'bounds'):
        tree[name] = [_plain(one) for one in getattr(study, name)]
    return tree


def _plain(record: Any) -> Manifest:
    """Return a named tuple as JSON has it: records within as dicts, infinities as texts."""
    return {name: _plain(value) if hasattr(value, '_asdict') else
            str(value) if isinstance(value, float) and not np.isfinite(value) else value
            for name, value in record._asdict().items()}


@lru_cache(maxsize=1)
def made_with() -> dict[str, str]:
    """Return the versions of all software that decides about the bits of the results."""
    from importlib.metadata import version
    return {'fourbar_ros': fourbar_ros.__version__, 'kernels': KERNELS,
            **{name: version(name) for name in ('numpy', 'scipy', 'pyarrow')}}


def fingerprint(study: Study) -> str:
    """Return a hash of all that decides about the results: study, scene, versions."""
    text = json.dumps([as_json(study), made_with()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def units_of(study: Study) -> dict[str, str]:
    """Return {column: unit} of the columns that have one."""
    units = {one.name: one.unit for one in study.vary}
    units |= {measure.name: measure.unit for measure in study.measures}
    units |= {f'{curve.point}.{axis}': 'm' for curve in study.curves for axis in 'xy'}
    return {name: unit for name, unit in units.items() if unit}


def encode(study: Study, chunk: Chunk, about: Manifest | None = None) -> bytes:
    """
    Return a chunk as a Parquet file; the same bytes for the same numbers.

    ``about``: metadata of the file; default: counts and failures of the chunk. Curves, of shape
    (rows, samples), become lists of fixed size.
    """
    import pyarrow
    from pyarrow import parquet

    units, arrays, fields = units_of(study), [], []
    for name, column in chunk.columns.items():
        if column.ndim == 2:
            flat = pyarrow.array(column.ravel())
            array = pyarrow.FixedSizeListArray.from_arrays(flat, column.shape[1])
        else:
            array = pyarrow.array(column.tolist() if column.dtype.kind == 'U' else column,
                                  pyarrow.string() if column.dtype.kind == 'U' else None)
        arrays.append(array)
        fields.append(pyarrow.field(name, array.type, metadata={'unit': units[name]}
                                    if name in units else None))
    about = about or {'counts': chunk.counts, 'failures': chunk.failures}
    schema = pyarrow.schema(fields, metadata={KEY: json.dumps(about, sort_keys=True).encode()})
    table = pyarrow.Table.from_arrays(arrays, schema=schema)
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(table, sink, compression='zstd')
    return bytes(sink.getvalue())


class Folder:
    """The folder of a study."""

    def __init__(self, path: str | Path):
        self.path = Path(path)

    def begin(self, study: Study, is_resumed: bool) -> None:
        """
        Write the manifest, or check that the folder holds this study; remove half-written files.

        StudyError if the folder holds something and is not to be resumed, or another study.
        """
        has_one = any((self.path / name).exists() for name in (MANIFEST, OLD_MANIFEST))
        there = self.manifest() if has_one else None
        if there is None:
            if self.path.exists() and (not self.path.is_dir() or any(
                    not path.name.startswith('.') for path in self.path.iterdir())):
                raise StudyError(f'{self.path}: exists already and is no study')
            try:
                self.path.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise StudyError(f'{self.path}: {error.strerror}') from None
        elif not is_resumed:
            raise StudyError(f'{self.path}: holds a study already; --resume goes on with it')
        elif there['fingerprint'] != fingerprint(study):
            raise StudyError(f'{self.path}: {_difference(there, study)}; give another folder')
        with self.locked():
            for path in self.path.glob('.*.new'):            # of a run that was killed
                path.unlink(missing_ok=True)
            if there is None:
                self._write(MANIFEST, encode(study, Chunk(nothing(study), {}, []), {
                    'fingerprint': fingerprint(study), 'made_with': made_with(),
                    'units': units_of(study), 'study': as_json(study)}))

    @contextmanager
    def locked(self) -> Iterator[None]:
        """
        Hold the folder meanwhile: StudyError if another command does, to compute the same.

        The lock is the kernel's, on the folder itself: it ends with its process in any case.
        """
        if fcntl is None:                   # Windows
            yield
            return
        held = os.open(self.path, os.O_RDONLY)
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(held)
            raise StudyError(f'{self.path}: another command computes it now') from None
        except OSError:                     # a file system without locks
            pass
        try:
            yield
        finally:
            os.close(held)

    def manifest(self) -> Manifest:
        """Return the manifest, of early versions too; StudyError if none can be read."""
        name = OLD_MANIFEST if (self.path / OLD_MANIFEST).exists() else MANIFEST
        try:
            manifest = (_about(self.path / name) if name == MANIFEST else
                        json.loads((self.path / name).read_text(encoding='utf-8')))
        except OSError as error:
            raise StudyError(f'{self.path}: no study: {name}: {error.strerror or error}') from None
        except (KeyError, TypeError, ValueError):
            raise StudyError(f'{self.path}: {name} is damaged') from None
        if not isinstance(manifest, dict) or 'fingerprint' not in manifest:
            raise StudyError(f'{self.path}: {name} is not one of a study')
        return manifest

    def _write(self, name: str, content: bytes) -> None:
        """Write a file that stands under its name only when it is whole and on the disk."""
        hidden = self.path / f'.{name}.new'
        try:
            with hidden.open('wb') as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            hidden.replace(self.path / name)
        except OSError as error:
            with suppress(OSError):
                hidden.unlink(missing_ok=True)
            raise StudyError(f'{self.path / name}: {error.strerror}; what is done is kept, '
                             '--resume goes on') from None

    def add(self, number: int, content: bytes) -> None:
        """Write the part of a chunk."""
        self._write(PART.format(number), content)

    def parts(self) -> dict[int, Path]:
        """Return {number of a chunk: its file} of the parts there are, in order."""
        parts = {int(match[1]): path for path in self.path.glob('part-*.parquet')
                 if (match := _PART.fullmatch(path.name))}
        return dict(sorted(parts.items()))

    def totals(self) -> tuple[dict[str, int], list[tuple[int, str]]]:
        """
        Return {reason: designs} over all parts, most frequent first, and the first failures.

        A failure is (row, text). StudyError if a part cannot be read.
        """
        counts: Counter[str] = Counter()
        failures: list[tuple[int, str]] = []
        for path in self.parts().values():
            try:
                of_part = _about(path)
                counts.update(of_part['counts'])
                failures += [(row, text) for row, text in of_part['failures']]
            except (OSError, KeyError, TypeError, ValueError) as error:
                raise StudyError(f'{path}: no part of a study: {error}') from None
            del failures[MOST_FAILURES:]
        return dict(counts.most_common()), failures


def _about(path: Path) -> Any:
    """Return the metadata of a Parquet file of ours; ValueError if it is none."""
    from pyarrow import parquet

    return json.loads(parquet.read_schema(path).metadata[KEY])      # ArrowInvalid is one


def _difference(there: Manifest, study: Study) -> str:
    """Return in what a study differs from that of a manifest, as text."""
    if there.get('made_with') != made_with():
        return (f'was begun with {_versions(there.get("made_with", {}))}, and this is '
                f'{_versions(made_with())}')
    ours, theirs = json.loads(json.dumps(as_json(study))), there.get('study', {})
    names = [name for name in ours if ours[name] != theirs.get(name)]
    return f'holds another study: {", ".join(names)} differ{"s" * (len(names) == 1)}'


def _versions(versions: dict[str, str]) -> str:
    """Return {package: version} as text."""
    return ', '.join(f'{name} {version}' for name, version in versions.items())
