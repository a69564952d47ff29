# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The results of a study: ranges, best designs, front of two objectives, a design as a scene."""
from collections import Counter
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_lab.studies.engine import about, parts
from fourbar_lab.studies.study import StudyError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.files import as_text
from fourbar_ros.scene.parameters import without_defaults
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

BEST = 5            # designs of an objective that are listed
PERCENTILES = (5, 50, 95)


class Summary(NamedTuple):
    """A column of numbers; all but ``mean`` count infinities, none counts NaN."""

    name: str
    unit: str
    least: float
    percentiles: tuple[float, ...]      # 5, 50, 95
    greatest: float
    mean: float                         # of the finite values
    missing: int                        # how many are NaN


class Results:
    """
    The results in the folder of a study, also while it runs; StudyError if it holds none.

    ``study``: its entries as JSON has them; ``counts``: {reason: designs}, most frequent first;
    ``failures``: (row, text); ``columns`` of the parts, ``units`` of those that have one.
    """

    def __init__(self, folder: str | Path):
        from pyarrow import dataset
        self.folder = Path(folder)
        files = parts(self.folder)
        if not files:
            raise StudyError(f'{folder}: no study, or nothing of it is computed yet')
        heads = [about(path) for path in files.values()]
        self.study: dict[str, Any] = heads[0]['study']
        counts: Counter[str] = Counter()
        for head in heads:
            counts.update(head['counts'])
        self.counts = dict(counts.most_common())
        self.failures = [(row, text) for head in heads for row, text in head['failures']]
        self.objectives: dict[str, str] = self.study['objectives']
        self.varied = [entry['name'] for entry in self.study['vary']]
        self.measures = [measure['name'] for measure in self.study['measures']
                         if measure['part'] != 'class']
        self._data = dataset.dataset([str(path) for path in files.values()])
        # how many designs were computed, and how many of them are rows of the parts
        self.designs, self.kept = sum(counts.values()), self._data.count_rows()
        self.units = {field.name: field.metadata[b'unit'].decode()
                      for field in self._data.schema if field.metadata}

    def table(self, names: list[str]) -> dict[str, Array]:
        """Return {name: column} of the rows that fulfil the constraints, in order."""
        import pyarrow.compute as pc
        feasible = pc.field('feasible') if self.study['keeps_all'] else None
        table = self._data.to_table(names, filter=feasible)
        return {name: table[name].to_numpy() for name in names}

    def summaries(self) -> list[Summary]:
        """Return a :class:`Summary` of each number that varies or is measured."""
        return [summary(name, self.units.get(name, ''), self.table([name])[name])
                for name in [*self.varied, *self.measures]]

    def best(self, by: str | None = None, count: int = BEST, worst: bool = False) -> list[int]:
        """Return the rows that are best, or worst, in an objective (None: the first), in order."""
        if not self.objectives:
            raise StudyError(f'{self.folder}: the study has no objectives: nothing is best')
        by = by or next(iter(self.objectives))
        if by not in self.objectives:
            raise StudyError(f'{by}: no objective of the study, which has '
                             f'{", ".join(self.objectives)}')
        sign = (1.0 if self.objectives[by] == 'minimize' else -1.0) * (-1.0 if worst else 1.0)
        rows, values = self.table(['row', by]).values()
        order = np.argsort(sign * values, kind='stable')        # NaN is last
        return [int(row) for row in rows[order[:min(count, np.count_nonzero(values == values))]]]

    def front(self) -> dict[str, Array]:
        """
        Return {``row`` and the first two objectives: columns} of the Pareto front of these two.

        A design is beaten if another is as good in both and better in one: in the order of the
        first objective, a design before it is as good in the second.
        """
        names = list(self.objectives)[:2]
        columns = self.table(['row', *names])
        first, second = (columns[name] * (1.0 if self.objectives[name] == 'minimize' else -1.0)
                         for name in names)
        order = np.lexsort((second, first))
        order = order[np.isfinite(first[order]) & np.isfinite(second[order])]
        best_before = np.minimum.accumulate(np.append(np.inf, second[order]))[:-1]
        kept = order[second[order] < best_before]
        return {name: column[kept] for name, column in columns.items()}

    def design(self, row: int) -> ParameterValues:
        """Return {column: value} of one row; StudyError if it was not kept."""
        import pyarrow.compute as pc
        rows = self._data.to_table(filter=pc.field('row') == row).to_pylist()
        if not rows:
            raise StudyError(f'{self.folder}: row {row} is not among the {self.kept} designs kept '
                             f'of {self.study["rows"]}')
        return dict(rows[0])

    def scene_text(self, row: int) -> str:
        """Return the scene file of one row; comments list its measures."""
        design = self.design(row)
        head = [f'# Row {row} of the study {self.folder.name}.']
        head += [f'# {name}: {design[name]:.9g} {self.units.get(name, "")}'.rstrip()
                 for name in self.measures]
        values = {**self.study['values'], **{name: design[name] for name in self.varied}}
        return '\n'.join(head) + '\n' + as_text(without_defaults(values))


def summary(name: str, unit: str, column: Array) -> Summary:
    """Return the :class:`Summary` of a column; NaN if all of it is NaN."""
    values = np.asarray(column, dtype=float)
    values = values[~np.isnan(values)]
    if not values.size:
        return Summary(name, unit, nan, (nan,) * len(PERCENTILES), nan, nan, len(column))
    # of the values themselves: between infinities there is nothing to interpolate
    percentiles = np.percentile(values, PERCENTILES, method='nearest').tolist()
    finite = values[np.isfinite(values)]
    return Summary(name, unit, float(values.min()), tuple(percentiles), float(values.max()),
                   float(finite.mean()) if finite.size else nan, len(column) - values.size)
