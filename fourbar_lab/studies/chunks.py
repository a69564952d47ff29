# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A chunk of a study: its designs drawn and computed, and why each design is left out.

A pure function of the study and the chunk's number: the same bits wherever it runs.
"""
from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

from fourbar_lab.studies.block import Block
from fourbar_lab.studies.design import Design, is_within
from fourbar_lab.studies.measures import CHANGE_POINT, CHEAP, CLASS
from fourbar_lab.studies.study import Bound, Study
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.parameters import ParameterValues
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np

# Why a design is not among the results, beside the constraints by name.
NOT_BUILT, FAILED = 'cannot be built', 'failed'
FEASIBLE = 'feasible'
# Designs that are tried for one that can be built.
TRIED = 100


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


class Computed(NamedTuple):
    """
    What was computed of designs.

    Parameters
    ----------
    columns : dict
        {measure or axis of a curve: array}, NaN where it was not computed.
    reasons : list of str
        Why each design is left out; :data:`FEASIBLE` if it is not.
    is_known : ndarray of bool
        Which designs have all columns.
    failures : list of (int, str)

    """

    columns: dict[str, Array]
    reasons: list[str]
    is_known: Array
    failures: list[tuple[int, str]]


def measured(study: Study, drawn: dict[str, Array]) -> Computed:
    """Return the measures of designs: {parameter that varies: values, shape (n,)}."""
    size = len(next(iter(drawn.values())))
    found, reasons = _together(study, drawn)
    columns = _columns(study, size, found)
    failures: list[tuple[int, str]] = []
    is_known = np.array([bool(reason) for reason in reasons])
    for i in np.nonzero(~is_known)[0].tolist():
        values = {name: column[i].item() for name, column in drawn.items()}
        reasons[i], one = _row(study, values)
        if reasons[i] == FAILED:
            failures.append((i, one[FAILED]))
        is_known[i] = bool(one) and reasons[i] != FAILED
        for name in one.keys() & columns.keys():
            columns[name][i] = one[name]
    return Computed(columns, reasons, is_known, failures)


def compute(study: Study, chunk: int) -> Chunk:
    """Return the results of one of the chunks of a study, counted from 0."""
    start, stop = study.rows_of(chunk)
    drawn = study.drawn(start, stop)
    found = measured(study, drawn)
    is_feasible = np.array([reason == FEASIBLE for reason in found.reasons])
    rows = np.nonzero(is_feasible | (found.is_known & study.keeps_all))[0]
    head = {'row': rows + start}
    if study.keeps_all:
        head[FEASIBLE] = is_feasible[rows]
    head |= {name: column[rows] for name, column in drawn.items()}
    columns: dict[str, Array] = {
        name: column[rows].astype(kinds_of(study)[name])
        for name, column in found.columns.items()}
    return Chunk(head | columns, dict(Counter(found.reasons)),
                 [(start + i, text) for i, text in found.failures])


def _columns(study: Study, size: int, found: dict[str, Array]) -> dict[str, Array]:
    """Return a column of ``size`` for each measure and curve, with what is found already."""
    shapes = {f'{curve.point}.{axis}': (size, curve.samples) for curve in study.curves
              for axis in 'xy'}
    columns = {}
    for name, kind in kinds_of(study).items():
        empty = np.full(shapes.get(name, (size,)), '' if kind is str else np.nan,
                        dtype=object if kind is str else float)
        columns[name] = found[name].astype(empty.dtype) if name in found else empty
    return columns


def _together(study: Study, drawn: dict[str, Array]) -> tuple[dict[str, Array], list[str]]:
    """Return measures of designs computed together, and why each is left out; '' is not done."""
    size = len(next(iter(drawn.values())))
    scene = _first_scene(study, drawn)
    if (scene is None or not scene.drive.speed or scene.linkage.is_driven_by_slide
            or scene.values['linkage.kind'] not in KINDS):      # one put together at run time
        return {}, [''] * size
    block = Block(study, scene, drawn)
    block.compute_cheap()
    reasons = np.full(size, FEASIBLE, dtype=object)
    cheap = [bound for bound in study.bounds if bound.measure.part in (CLASS, CHANGE_POINT)]
    later = [bound for bound in study.bounds if bound not in cheap]
    _exclude(block, reasons, cheap)
    rows = np.nonzero(block.is_done & ((reasons == FEASIBLE) | study.keeps_all))[0]
    block.compute(rows)
    _exclude(block, reasons, sorted(later, key=lambda bound: bound.measure.part not in CHEAP))
    reasons[~block.is_done] = ''
    return block.found, reasons.tolist()


def _exclude(block: Block, reasons: Array, bounds: list[Bound]) -> None:
    """Note the first bound that each design fails."""
    for bound in bounds:
        column = block.found.get(bound.measure.name)
        if column is not None:
            fine = np.array([is_within(value, *bound[1:]) for value in column.tolist()])
            reasons[~fine & (reasons == FEASIBLE)] = bound.measure.name


def _first_scene(study: Study, drawn: dict[str, Array]) -> Scene | None:
    """Return the scene of the first of some designs that can be built, or None."""
    for values in zip(*(column[:TRIED].tolist() for column in drawn.values())):
        try:
            return from_values({**study.values, **dict(zip(drawn, values))})
        except InvalidParameter:
            continue
    return None


def _row(study: Study, values: ParameterValues) -> tuple[str, dict[str, Any]]:
    """Return why a design is left out, or FEASIBLE, and what was computed of it."""
    try:
        scene = from_values({**study.values, **values})
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


def nothing(study: Study) -> dict[str, Array]:
    """Return the columns of a chunk of which no row is kept."""
    head: dict[str, Array] = {'row': np.zeros(0, np.int64)}
    if study.keeps_all:
        head[FEASIBLE] = np.zeros(0, bool)
    head |= {one.name: np.array(one.bounds)[:0] for one in study.vary}
    return head | {name: column.astype(kinds_of(study)[name])
                   for name, column in _columns(study, 0, {}).items()}


def kinds_of(study: Study) -> dict[str, type]:
    """Return {measure or axis of a curve: the type of its numbers, or texts}."""
    kinds = {measure.name: {CLASS: str, 'extrema': np.int32}.get(measure.part, float)
             for measure in study.measures}
    return kinds | {f'{curve.point}.{axis}': float for curve in study.curves for axis in 'xy'}
