# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A chunk of a study: its designs drawn and computed, and why each design is left out.

A pure function of the study and the index of the chunk: the same bits wherever it runs.
"""
from collections import Counter
from typing import Any, NamedTuple

from fourbar_lab.studies.block import compute_together
from fourbar_lab.studies.measures import CHEAP, CLASS, Design, INPUT_RANGE
from fourbar_lab.studies.study import Bound, Study
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.scene import from_values
import numpy as np

# Why a design is among the results or not; other reasons are constraints by name.
NOT_BUILT, FAILED, FEASIBLE = 'cannot be built', 'failed', 'feasible'


class Chunk(NamedTuple):
    """Results of one chunk."""

    columns: dict[str, Array]       # row, what varies, the measures; feasible if all are kept
    counts: dict[str, int]          # {reason: designs}, kept or left out by which constraint
    failures: list[tuple[int, str]]         # rows whose computation raised an error, and its text


def measured(study: Study, drawn: dict[str, Array]
             ) -> tuple[dict[str, Array], list[str], list[tuple[int, str]]]:
    """Return the measures of n designs, why each is left out, and (index, error) of failures."""
    # drawn: {parameter that varies: values, shape (n,)}. Measures are {name: array}, NaN where
    # none was computed; a reason may be FEASIBLE. As many designs as possible are computed
    # together, those in doubt one by one.
    size = len(next(iter(drawn.values())))
    columns: dict[str, Array] = {
        measure.name: np.full(size, '', object) if measure.part == CLASS else np.full(size, np.nan)
        for measure in study.measures}      # counts are floats here too: NaN if unknown
    is_done = compute_together(study, drawn, columns)
    reasons = np.full(size, FEASIBLE, dtype=object)
    failures: list[tuple[int, str]] = []
    for i in np.nonzero(~is_done)[0].tolist():
        values = {name: column[i].item() for name, column in drawn.items()}
        try:
            scene = from_values({**study.values, **values})
        except InvalidParameter:
            reasons[i] = NOT_BUILT
            continue
        try:
            results = _row(study, Design(scene, study.acceleration))
        except (FourBarError, ArithmeticError, ValueError) as error:
            reasons[i] = FAILED
            failures.append((i, f'{type(error).__name__}: {error}'))
            continue
        for name in results.keys() & columns.keys():
            columns[name][i] = results[name]
    for bound in _cheap_first(study):
        reasons[(reasons == FEASIBLE) & ~bound.allows_each(columns)] = bound.measure.name
    return columns, reasons.tolist(), failures


def compute(study: Study, chunk: int) -> Chunk:
    """Return the results of a chunk of a study, counted from 0."""
    rows = study.rows_of(chunk)
    drawn = study.drawn(rows.start, rows.stop)
    measures, reasons, failures = measured(study, drawn)
    kept = np.array([i for i, reason in enumerate(reasons) if reason == FEASIBLE
                     or study.keeps_all and reason not in (NOT_BUILT, FAILED)], int)
    columns: dict[str, Array] = {'row': kept + rows.start}
    if study.keeps_all:
        columns[FEASIBLE] = np.array([reasons[i] == FEASIBLE for i in kept], bool)
    columns |= {name: column[kept] for name, column in drawn.items()}
    types = {CLASS: str, 'extrema': np.int32}
    columns |= {measure.name: measures[measure.name][kept].astype(types.get(measure.part, float))
                for measure in study.measures}
    return Chunk(columns, dict(Counter(reasons)), [(rows[i], text) for i, text in failures])


def _cheap_first(study: Study) -> list[Bound]:
    return sorted(study.bounds, key=lambda bound: (bound.measure.part not in CHEAP,
                                                   bound.measure.part == INPUT_RANGE))


def _row(study: Study, design: Design) -> dict[str, Any]:
    """Return {measure: value} of a design; of one that is not kept only some are computed."""
    results: dict[str, Any] = {}
    for bound in _cheap_first(study):
        design.search([bound.measure])
        value = results[bound.measure.name] = design.of(bound.measure)
        if not study.keeps_all and not bound.allows(value):
            return results
    design.search(study.measures)
    return {measure.name: design.of(measure) for measure in study.measures}
