# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The rows of a study, a chunk at a time: what was computed, what was left out and why.

A pure function of the study and the chunk's number: the same bits wherever it runs.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.scene import from_values
from fourbar_ros.studies.measures import CHEAP
from fourbar_ros.studies.one_design import Design, is_within
from fourbar_ros.studies.study import Study
import numpy as np

# Why a design is not among the results, beside the constraints by name.
NOT_BUILT, FAILED = 'cannot be built', 'failed'
FEASIBLE = 'feasible'


class Chunk(NamedTuple):
    """
    Results of one chunk.

    Parameters
    ----------
    columns : dict
        {name: array of the rows kept}: ``row``, the parameters that vary, the measures,
        ``NAME.x`` and ``NAME.y`` of shape (rows, samples) of curves; ``feasible`` if all are kept.
    counts : dict
        {reason: number} of the designs of this chunk: kept, left out by which constraint.
    failures : list of (int, str)
        Rows whose computation raised an error, and its text.

    """

    columns: dict[str, Array]
    counts: dict[str, int]
    failures: list[tuple[int, str]]


def compute(study: Study, number: int) -> Chunk:
    """Return the results of chunk ``number`` of a study."""
    start, stop = study.rows_of(number)
    drawn = study.drawn(start, stop)
    counts: dict[str, int] = {}
    failures: list[tuple[int, str]] = []
    kept: list[dict[str, Any]] = []
    for row, values in enumerate(zip(*(column.tolist() for column in drawn.values())), start):
        reason, found = _row(study, dict(zip(drawn, values)))
        if reason == FAILED:
            failures.append((row, found[FAILED]))
        counts[reason] = counts.get(reason, 0) + 1
        if reason == FEASIBLE or found and study.keeps_all and reason != FAILED:
            kept.append({'row': row, FEASIBLE: reason == FEASIBLE, **found})
    return Chunk(_as_columns(study, drawn, start, kept), counts, failures)


def _row(study: Study, values: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return why a design is left out, or FEASIBLE, and what was computed of it."""
    try:
        scene = from_values(study.values | values)
    except InvalidParameter:
        return NOT_BUILT, {}
    try:
        return _of_scene(study, Design(scene, study.acceleration))
    except (FourBarError, ArithmeticError, ValueError) as error:
        return FAILED, {FAILED: f'{type(error).__name__}: {error}'}


def _of_scene(study: Study, design: Design) -> tuple[str, dict[str, Any]]:
    found: dict[str, Any] = {}
    reason = FEASIBLE
    ordered = sorted(study.bounds, key=lambda bound: bound.measure.part not in CHEAP)
    for bound in ordered:
        design.search([bound.measure])
        value = found[bound.measure.name] = design.of(bound.measure)
        if reason == FEASIBLE and not is_within(value, *bound[1:]):
            reason = bound.measure.name
            if not study.keeps_all:
                return reason, found
    design.search(study.measures)
    for measure in study.measures:
        found[measure.name] = design.of(measure)
    for curve in study.curves:
        found[f'{curve.point}.x'], found[f'{curve.point}.y'] = design.curve(curve)
    return reason, found


def _as_columns(study: Study, drawn: dict[str, Array], start: int,
                kept: list[dict[str, Any]]) -> dict[str, Array]:
    """Return the rows kept as columns."""
    rows = np.array([found['row'] for found in kept], dtype=np.int64)
    columns: dict[str, Array] = {'row': rows}
    if study.keeps_all:
        columns[FEASIBLE] = np.array([found[FEASIBLE] for found in kept], dtype=bool)
    columns |= {name: column[rows - start] for name, column in drawn.items()}
    for measure in study.measures:
        values = [found[measure.name] for found in kept]
        columns[measure.name] = np.array(values, dtype=kind_of(measure.part))
    for curve in study.curves:
        for name in (f'{curve.point}.x', f'{curve.point}.y'):
            columns[name] = np.array([found[name] for found in kept]).reshape(-1, curve.samples)
    return columns


def nothing(study: Study) -> dict[str, Array]:
    """Return the columns of a chunk of which no row is kept."""
    drawn = {one.name: np.array(one.extremes) for one in study.vary}
    return _as_columns(study, drawn, 0, [])


def kind_of(part: str) -> type:
    """Return the type of the numbers, or texts, of a part of :mod:`.measures`."""
    return {'class': str, 'extrema': np.int32}.get(part, float)
