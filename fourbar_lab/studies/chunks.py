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
from fourbar_lab.studies.design import Design
from fourbar_lab.studies.measures import CHANGE_POINT, CHEAP, CLASS
from fourbar_lab.studies.study import Bound, Study
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

# Why a design is not among the results; other reasons are constraints by name.
NOT_BUILT, FAILED = 'cannot be built', 'failed'
FEASIBLE = 'feasible'
UNKNOWN = ''        # of a design that is not computed yet
# Designs that are tried for one that can be built.
TRIED = 100


class Chunk(NamedTuple):
    """
    Results of one chunk.

    ``columns``: {name: array of the rows kept}: ``row``, the parameters that vary, the measures,
    ``NAME.x`` and ``NAME.y`` of shape (rows, samples) of curves; ``feasible`` if all are kept.
    ``counts``: {reason: number} of its designs, kept or left out by which constraint;
    ``failures``: rows whose computation raised an error, and its text.
    """

    columns: dict[str, Array]
    counts: dict[str, int]
    failures: list[tuple[int, str]]


def measured(study: Study, drawn: dict[str, Array]
             ) -> tuple[dict[str, Array], list[str], list[tuple[int, str]]]:
    """
    Return the measures of n designs, why each is left out, and (index, error) of failures.

    ``drawn``: {parameter that varies: values, shape (n,)}. Measures are {name of a measure or of
    an axis of a curve: array}, NaN where it was not computed; a reason may be :data:`FEASIBLE`. As
    many as possible are computed together; those in doubt, and other kinds, one by one.
    """
    found, reasons = _together(study, drawn)
    columns = _columns(study, len(reasons), found)
    failures: list[tuple[int, str]] = []
    for i in [i for i, reason in enumerate(reasons) if reason == UNKNOWN]:
        reasons[i], results = _row(study, {name: column[i].item()
                                           for name, column in drawn.items()})
        if reasons[i] == FAILED:
            failures.append((i, results[FAILED]))
        for name in results.keys() & columns.keys():
            columns[name][i] = results[name]
    return columns, reasons, failures


def compute(study: Study, chunk: int) -> Chunk:
    """Return the results of one of the chunks of a study, counted from 0: of the rows kept."""
    start, stop = study.rows_of(chunk)
    drawn = study.drawn(start, stop)
    measures, reasons, failures = measured(study, drawn)
    kept = np.array([i for i, reason in enumerate(reasons) if reason == FEASIBLE
                     or study.keeps_all and reason not in (NOT_BUILT, FAILED)], int)
    columns: dict[str, Array] = {'row': kept + start}
    if study.keeps_all:
        columns[FEASIBLE] = np.array([reasons[i] == FEASIBLE for i in kept], bool)
    columns |= {name: column[kept] for name, column in drawn.items()}
    types = types_of(study)
    columns |= {name: column[kept].astype(types[name]) for name, column in measures.items()}
    return Chunk(columns, dict(Counter(reasons)), [(start + i, text) for i, text in failures])


def types_of(study: Study) -> dict[str, type]:
    """Return {measure or axis of a curve: the type of its numbers, or str}."""
    types = {measure.name: {CLASS: str, 'extrema': np.int32}.get(measure.part, float)
             for measure in study.measures}
    return types | {f'{curve.point}.{axis}': float for curve in study.curves for axis in 'xy'}


def _columns(study: Study, size: int, found: dict[str, Array]) -> dict[str, Array]:
    """
    Return {measure or axis of a curve: array of ``size`` designs}: as found, else NaN or ''.

    Numbers are floats here, counts too: NaN says that one is unknown. Texts are objects.
    """
    samples = {f'{curve.point}.{axis}': curve.samples for curve in study.curves for axis in 'xy'}
    columns = {}
    for name, kind in types_of(study).items():
        shape = (size, samples[name]) if name in samples else (size,)
        empty = (np.full(shape, '', dtype=object) if kind is str else np.full(shape, np.nan))
        columns[name] = found[name].astype(empty.dtype) if name in found else empty
    return columns


def _together(study: Study, drawn: dict[str, Array]) -> tuple[dict[str, Array], list[str]]:
    """
    Return {measure: array} of designs computed together, and why each is left out, or FEASIBLE.

    The reason is :data:`UNKNOWN` of those that this cannot compute: drives at rest, driven slides,
    machines (which are put together at run time), and whatever :class:`Block` is not sure of.
    """
    size = len(next(iter(drawn.values())))
    scene = _first_scene(study, drawn)
    if (scene is None or not scene.drive.speed or scene.linkage.is_driven_by_slide
            or scene.values['linkage.kind'] not in KINDS):
        return {}, [UNKNOWN] * size
    block = Block(study, scene, drawn)
    block.compute_cheap()
    reasons = np.full(size, FEASIBLE, dtype=object)
    early = [bound for bound in study.bounds if bound.measure.part in (CLASS, CHANGE_POINT)]
    _exclude(block, reasons, early)
    block.compute(np.nonzero(block.is_done & ((reasons == FEASIBLE) | study.keeps_all))[0])
    _exclude(block, reasons, [bound for bound in _cheap_first(study) if bound not in early])
    reasons[~block.is_done] = UNKNOWN
    return block.found, reasons.tolist()


def _exclude(block: Block, reasons: Array, bounds: list[Bound]) -> None:
    """Write the name of the first bound that each feasible design fails into ``reasons``."""
    for bound in bounds:
        column = block.found.get(bound.measure.name)
        if column is not None:
            fulfils = np.array([bound.allows(value) for value in column.tolist()])
            reasons[~fulfils & (reasons == FEASIBLE)] = bound.measure.name


def _cheap_first(study: Study) -> list[Bound]:
    """Return the constraints; the ones that need no motion come first: they drop most designs."""
    return sorted(study.bounds, key=lambda bound: bound.measure.part not in CHEAP)


def _first_scene(study: Study, drawn: dict[str, Array]) -> Scene | None:
    """Return the scene of the first of some designs that can be built, or None."""
    for values in zip(*(column[:TRIED].tolist() for column in drawn.values())):
        try:
            return from_values({**study.values, **dict(zip(drawn, values))})
        except InvalidParameter:
            continue
    return None


def _row(study: Study, values: ParameterValues) -> tuple[str, dict[str, Any]]:
    """
    Return why one design is left out, or FEASIBLE, and {column: its result}.

    ``values``: of the parameters that vary. If the computation raises an error, it returns
    :data:`FAILED` and {FAILED: its text}.
    """
    try:
        scene = from_values({**study.values, **values})
    except InvalidParameter:
        return NOT_BUILT, {}
    try:
        return _of_scene(study, Design(scene, study.acceleration))
    except (FourBarError, ArithmeticError, ValueError) as error:
        return FAILED, {FAILED: f'{type(error).__name__}: {error}'}


def _of_scene(study: Study, design: Design) -> tuple[str, dict[str, Any]]:
    """
    Return why a design is left out, or FEASIBLE, and {column: its result}.

    A failed constraint ends the work, unless rows that fail are kept.
    """
    results: dict[str, Any] = {}
    reason = FEASIBLE
    for bound in _cheap_first(study):
        design.search([bound.measure])
        value = results[bound.measure.name] = design.of(bound.measure)
        if reason == FEASIBLE and not bound.allows(value):
            reason = bound.measure.name
            if not study.keeps_all:
                return reason, results
    design.search(study.measures)
    results |= {measure.name: design.of(measure) for measure in study.measures}
    for curve in study.curves:
        results[f'{curve.point}.x'], results[f'{curve.point}.y'] = design.curve(curve)
    return reason, results
