# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The results of a study: ranges, shares, best designs, Pareto front, any design as a scene.

Parts are read one after the other, so memory is bounded: percentiles and figures use every row
up to :data:`SHOWN`, evenly spread rows of more; the best designs are found among all.
"""
from __future__ import annotations

from collections.abc import Iterator
from math import nan
from pathlib import Path
from typing import NamedTuple

from fourbar_lab.studies.folder import Folder
from fourbar_lab.studies.study import Study, StudyError
from fourbar_lab.studies.variation import Variation
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.files import as_text
from fourbar_ros.scene.parameters import find
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

SHOWN = 2**18       # rows of percentiles and figures
BEST = 5            # designs of an objective that are listed
PERCENTILES = (5, 50, 95)


class Summary(NamedTuple):
    """A column of numbers; all but ``mean`` and ``finite`` count infinities, none counts NaN."""

    name: str
    unit: str
    least: float
    percentiles: tuple[float, ...]      # 5, 50, 95
    greatest: float
    mean: float                         # of the finite values
    finite: int                         # how many they are


class Results:
    """
    The results in the folder of a study; StudyError if it holds none, or none yet.

    ``feasible_only``: leave out the rows that do not fulfil the constraints, if they were kept.
    """

    def __init__(self, path: str | Path, feasible_only: bool = True):
        """Read the manifest and the counts of all parts, but no results yet."""
        self.folder, self._feasible_only = Folder(path), feasible_only
        manifest = self.folder.manifest()
        self.study, self.units = manifest['study'], manifest['units']
        self.parts = self.folder.parts()                # {number of a chunk: its file}
        if not self.parts:
            raise StudyError(f'{path}: nothing is computed yet')
        self.counts, self.failures = self.folder.totals()
        # (measure, minimize or maximize); then names of columns
        self.objectives = [(one['measure']['name'], one['sense'])
                           for one in self.study['objectives']]
        self.varied = [one['name'] for one in self.study['vary']]
        self.measures = [one['name'] for one in self.study['measures'] if one['part'] != 'class']
        self.designs = sum(self.counts.values())        # that were computed
        from pyarrow import parquet
        # of them, how many are rows of the parts
        self.kept = sum(int(parquet.read_metadata(path).num_rows) for path in self.parts.values())

    @property
    def is_whole(self) -> bool:
        """Return whether every chunk is there."""
        return bool(self.designs == self.study['rows'])

    def blocks(self, names: list[str]) -> Iterator[dict[str, Array]]:
        """Yield {name: column} of one part after the other, so that memory is bounded."""
        from pyarrow import parquet
        feasible = ['feasible'] * (self.study['keeps_all'] and self._feasible_only)
        for path in self.parts.values():
            table = parquet.read_table(path, columns=[*names, *feasible])
            columns = {name: table[name].to_numpy() for name in names}
            if feasible:
                mask = table['feasible'].to_numpy().astype(bool)
                columns = {name: column[mask] for name, column in columns.items()}
            yield columns

    def sample(self, names: list[str]) -> dict[str, Array]:
        """Return columns: every row, or evenly spread ones of more than :data:`SHOWN`."""
        step = -(-max(self.kept, 1) // SHOWN)
        parts, before = [], 0               # rows of the parts before this one
        for block in self.blocks(names):    # from the next multiple of step on
            parts.append({name: column[-before % step::step] for name, column in block.items()})
            before += len(block[names[0]])
        return {name: np.concatenate([part[name] for part in parts]) for name in names}

    def summaries(self) -> list[Summary]:
        """Return a :class:`Summary` of each number that varies or is measured."""
        names = [*self.varied, *self.measures]
        return [_summary(name, self.units.get(name, ''), column)
                for name, column in self.sample(names).items()]

    def best(self, by: str | None = None, count: int = BEST, worst: bool = False) -> list[int]:
        """Return the rows that are best, or worst, in an objective (None: the first), in order."""
        name, sense = self._objective(by)
        sign = (1.0 if sense == 'minimize' else -1.0) * (-1.0 if worst else 1.0)
        rows, values = np.zeros(0, np.int64), np.zeros(0)
        for block in self.blocks(['row', name]):
            fine = ~np.isnan(block[name])
            rows = np.concatenate((rows, block['row'][fine]))
            values = np.concatenate((values, sign * block[name][fine]))
            order = np.lexsort((rows, values))[:count]
            rows, values = rows[order], values[order]
        return [int(row) for row in rows]

    def _objective(self, by: str | None) -> tuple[str, str]:
        """Return (measure, minimize or maximize) of an objective by its name; None: the first."""
        if not self.objectives:
            raise StudyError(f'{self.folder.path}: the study has no objectives: nothing is best')
        for name, sense in self.objectives:
            if by in (None, name):
                return name, sense
        raise StudyError(f'{by}: no objective of the study, which has '
                         f'{", ".join(name for name, _ in self.objectives)}')

    def front(self) -> dict[str, Array]:
        """Return {``row`` and objectives: columns} of the Pareto front, see :func:`unbeaten`."""
        names = [name for name, _ in self.objectives]
        signs = np.array([1.0 if sense == 'minimize' else -1.0 for _, sense in self.objectives])
        rows: Array = np.zeros(0, np.int64)
        points: Array = np.zeros((0, len(names)))       # objectives with signs: small is good
        for block in self.blocks(['row', *names]):
            new = np.stack([block[name] for name in names], axis=1) * signs
            fine = np.isfinite(new).all(axis=1)
            rows = np.concatenate((rows, block['row'][fine]))
            points = np.concatenate((points, new[fine]))
            kept = unbeaten(points)
            rows, points = rows[kept], points[kept]
        return {'row': rows, **dict(zip(names, (points * signs).T))}

    def design(self, row: int) -> ParameterValues:
        """Return {column: value} of one row, {} if it was not kept."""
        from pyarrow import parquet
        import pyarrow.compute as pc
        path = self.parts.get(row // self.study['chunk'])
        if path is None or not 0 <= row < self.study['rows']:
            raise StudyError(f'{self.folder.path}: row {row} is not computed')
        table = parquet.read_table(path)
        rows = table.filter(pc.equal(table['row'], row)).to_pylist()
        return rows[0] if rows else {}

    def scene_values(self, row: int) -> ParameterValues:
        """Return the parameters of the scene of one row that differ from the default."""
        manifest = self.study
        vary = tuple([Variation(**{**one, 'values': tuple(one['values'])})
                      for one in manifest['vary']])
        # a scene depends on the drawn parameters, not on the results
        study = Study(manifest['values'], vary, manifest['method'], manifest['rows'],
                      manifest['seed'], manifest['acceleration'], measures=(), bounds=(),
                      objectives=(), curves=(), keeps_all=manifest['keeps_all'],
                      chunk=manifest['chunk'])
        return {name: value for name, value in study.scene_values(row).items() if value == value
                and value != getattr(find(name), 'default', None)}

    def scene_text(self, row: int) -> str:
        """Return the scene file of one row; comments list its measures."""
        measured = {name: value for name, value in self.design(row).items()
                    if name in self.measures}
        if not 0 <= row < self.study['rows']:
            raise StudyError(f'{self.folder.path}: row {row}: there are {self.study["rows"]}')
        head = [f'# Row {row} of the study {self.folder.path.name}.']
        head += [f'# {name}: {value:.9g} {self.units.get(name, "")}'.rstrip()
                 for name, value in measured.items()]
        return '\n'.join(head) + '\n' + as_text(self.scene_values(row))


def _summary(name: str, unit: str, column: Array) -> Summary:
    """Return the :class:`Summary` of a column; NaN of one without numbers."""
    values = np.sort(np.asarray(column, dtype=float))
    values = values[~np.isnan(values)]
    if not values.size:
        return Summary(name, unit, nan, (nan,) * len(PERCENTILES), nan, nan, 0)
    # of the values themselves, by rank: between infinities there is nothing to interpolate
    ranks = values[[round(p / 100 * (values.size - 1)) for p in PERCENTILES]]
    finite = np.asarray(column, dtype=float)[np.isfinite(column)]
    return Summary(name, unit, float(values[0]), tuple(ranks.tolist()), float(values[-1]),
                   float(finite.mean()) if finite.size else nan, finite.size)


def unbeaten(points: Array) -> Array:
    """
    Return the indices of the Pareto front of points, shape (points, objectives); small is good.

    A point is beaten if another is as good in all objectives and better in one. In the order of
    the first objective a point can be beaten only by one before it.
    """
    order = np.lexsort(points.T[::-1])
    if points.shape[1] <= 2:        # better in the second than all before, or beaten
        last = points[order, -1]
        best_before = np.concatenate(([np.inf], np.minimum.accumulate(last)[:-1]))
        return np.sort(order[last < best_before])
    front = np.zeros((0, points.shape[1]))
    kept = []
    for i in order:
        if not (front <= points[i]).all(axis=1).any():
            front = np.concatenate((front, points[i][None]))
            kept.append(i)
    return np.array(sorted(kept), dtype=int)


def rank_correlations(columns: dict[str, Array], inputs: list[str],
                      outputs: list[str]) -> dict[str, dict[str, float]]:
    """Return {output: {input: Spearman's rank correlation}} over finite rows; 0 of a constant."""
    from scipy.stats import spearmanr
    correlations: dict[str, dict[str, float]] = {}
    for output in outputs:
        fine = np.isfinite(columns[output])
        values = columns[output][fine]
        correlations[output] = {
            name: float(spearmanr(columns[name][fine], values).statistic)
            if np.unique(values).size > 1 and np.unique(columns[name][fine]).size > 1 else 0.0
            for name in inputs}
    return correlations
