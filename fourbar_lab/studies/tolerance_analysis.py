# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
How bad tolerances make a design: first order, corners of the box, proven bounds.

The box is centre +- size of every parameter that varies with ``uniform``, three deviations of
``normal``, all of a ``range``. What a study draws from it stands beside: Monte Carlo.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from math import inf, isfinite, nan, pi
from typing import Any, NamedTuple

from fourbar_lab.studies.boxes import Bounds, Box, enclosing, Make
from fourbar_lab.studies.chunks import measured
from fourbar_lab.studies.derivatives import Derivatives, sensitivities, Sensitivity
from fourbar_lab.studies.design import Design
from fourbar_lab.studies.measures import (
    CLASS,
    LEAST_ANGLE,
    Measure,
    Measures,
    STROKE,
    SWING,
)
from fourbar_lab.studies.parametric import formulas_of, is_machine
from fourbar_lab.studies.study import Study
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.quantities import is_position
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.duals import Dual, whole_of
from fourbar_ros.numerics.number_types import NumberType, Scalar
from fourbar_ros.scene.parameters import ParameterValues
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np

DEVIATIONS = 3.0
# Parameters of which all corners are computed; of more only the two where the first order is
# worst.
ALL_CORNERS = 8
# Pieces of the input to begin with, and samples of an angle that tell its turns.
PIECES, SAMPLES = 64, 4096
UNKNOWN = Bounds(-inf, inf)
ANGLE = 'transmission_angle'


class Tolerance(NamedTuple):
    """A parameter of the box: centre +- size."""

    name: str
    unit: str
    centre: float
    size: float


class Toleranced(NamedTuple):
    """
    A measure in a box of tolerances.

    Parameters
    ----------
    sensitivity : Sensitivity
        At the middle of the box.
    first_order : float
        Sum of |derivative| size.
    corners : Bounds
        Least and greatest value in corners of the box.
    proven : Bounds
        That hold for every mechanism of the box; infinite where nothing is proved.

    """

    sensitivity: Sensitivity
    first_order: float
    corners: Bounds
    proven: Bounds


def box_of(study: Study) -> tuple[Tolerance, ...]:
    """Return the box of a study; InvalidParameter for a list or a log_range."""
    found = []
    for one in study.vary:
        if one.kind in ('list', 'log_range'):
            raise InvalidParameter(f'vary.{one.name}', one.kind,
                                   'is not a tolerance; use uniform, normal or range')
        low, high = one.values
        centre, size = ((0.5 * (low + high), 0.5 * (high - low)) if one.kind == 'range' else
                        (low, high if one.kind == 'uniform' else DEVIATIONS * high))
        found.append(Tolerance(one.name, one.unit, centre, size))
    return tuple(found)


def tolerances(study: Study, prove: bool = True) -> list[Toleranced]:
    """
    Return a :class:`Toleranced` for each number that a study measures.

    Parameters
    ----------
    study : Study
    prove : bool
        Also prove bounds, which needs python-flint.

    Raises
    ------
    InvalidParameter
        It has no box, or the design in its middle cannot be built.

    """
    box = box_of(study)
    scene = from_values({**study.values, **{one.name: one.centre for one in box}})
    derivatives = Derivatives(scene, [one.name for one in box], study.acceleration)
    measures = [measure for measure in study.measures if measure.part != CLASS]
    found = sensitivities(derivatives, measures)
    corners = _corners(study, box, found)
    proven = (_Proofs(scene, study.acceleration, box, measures) if prove
              else dict.fromkeys([measure.name for measure in measures], UNKNOWN))
    return [Toleranced(one, sum(abs(one.by[tolerance.name]) * tolerance.size
                                for tolerance in box),
                       corners[one.measure.name], proven[one.measure.name]) for one in found]


def _corners(study: Study, box: Sequence[Tolerance],
             found: Sequence[Sensitivity]) -> dict[str, Bounds]:
    """Return the least and greatest value of each measure in corners of the box."""
    if len(box) <= ALL_CORNERS:
        signs = set(product((-1.0, 1.0), repeat=len(box)))
    else:
        worst = [tuple([1.0 if one.by[part.name] >= 0.0 else -1.0 for part in box])
                 for one in found]
        signs = {*worst, *(tuple([-sign for sign in one]) for one in worst)}
    places = np.array(sorted(signs)).T
    drawn = {one.name: one.centre + one.size * sign for one, sign in zip(box, places)}
    whole = replace(study, bounds=(), keeps_all=True)
    columns = measured(whole, drawn).columns
    return {one.measure.name: _extent(columns[one.measure.name]) for one in found}


def _extent(values: Array) -> Bounds:
    known = values[~np.isnan(values)]
    return Bounds(float(known.min()), float(known.max())) if known.size else Bounds(nan, nan)


class _Proofs:
    """Proven bounds of measures, by name."""

    def __init__(self, scene: Scene, acceleration: float, box: Sequence[Tolerance],
                 measures: Sequence[Measure]) -> None:
        self._design = Design(scene, acceleration)
        self._acceleration, self._tolerances = acceleration, box
        self._measures = {measure.name: measure for measure in measures}
        self._angles = _angles_of(scene)
        self._rows = list(dict.fromkeys(name for measure in measures
                                        for name in self._quantities(measure)))
        self._design.search([measures[0]._replace(quantity=name, part='max')
                             for name in self._rows])
        self._box = self._enclosed() if self._pieces() else None

    def __getitem__(self, name: str) -> Bounds:
        """Return the bounds of a measure."""
        measure = self._measures[name]
        found = [self._of(quantity, measure) for quantity in self._quantities(measure)
                 if self._box is not None]
        return Bounds(min([one.low for one in found], default=-inf),
                      min([one.high for one in found], default=inf))

    def _of(self, quantity: str, measure: Measure) -> Bounds:
        part = 'span' if measure.part in (SWING, STROKE) else measure.part
        most = UNKNOWN if part == 'min' else self._part(quantity, 'max')
        least = UNKNOWN if part == 'max' else self._part(quantity, 'min')
        return _of_parts(part, most, least)

    def _quantities(self, measure: Measure) -> Sequence[str]:
        """Return the quantities from whose extents a measure comes: the least of what they say."""
        if measure.part in (SWING, STROKE):
            return (self._design.output,)
        if measure.part == LEAST_ANGLE:
            return self._angles
        if measure.quantity == ANGLE and self._angles != (ANGLE,):
            return ()          # which dyad is nearest to its toggle, changes within a box
        return (measure.quantity,) if measure.part in ('max', 'min', 'peak', 'span') else ()

    def _part(self, quantity: str, end: str) -> Bounds:
        assert self._box is not None
        extremum = self._design.extreme(quantity, end)
        if extremum is None or not isfinite(extremum.value):
            return UNKNOWN
        row, places = self._rows.index(quantity), [self._design.place_of(extremum)]
        return self._box.most(row, places) if end == 'max' else self._box.least(row, places)

    def _pieces(self) -> list[tuple[float, float]]:
        """Return pieces that cover the input of every mechanism of the box; none if it varies."""
        linkage = self._design.linkage
        if linkage.turns_fully:
            ends = np.linspace(0.0, np.nextafter(2.0 * pi, 7.0), PIECES + 1)
        elif linkage.stroke is not None and linkage.input_ranges == (linkage.stroke,):
            low, high = linkage.stroke
            ends = np.linspace(low, high, PIECES + 1)
        else:
            return []
        return list(zip(ends[:-1].tolist(), ends[1:].tolist()))

    def _enclosed(self) -> Box:
        scene = self._design.scene
        widths = {one.name: one.size for one in self._tolerances}
        evaluate = enclosing(make_of(scene, self._rows, self._acceleration), scene.values, widths,
                             [self._reference(name) for name in self._rows])
        return Box(evaluate, self._pieces())

    def _reference(self, name: str) -> Callable[[float], float] | None:
        """Return a function near a quantity that is an angle, with its turns."""
        design = self._design
        quantity = Measures(design.scene).quantities[name]
        if not (is_position(quantity) and quantity.unit == 'rad'):
            return None
        pieces = self._pieces()
        x = np.linspace(pieces[0][0], pieces[-1][1], SAMPLES)
        values = np.unwrap(quantity.of(*design.linkage.motion_and_loads(x, *design.rates)))
        extremum = design.extreme(name, 'max')
        if extremum is not None:
            there = np.interp(design.place_of(extremum), x, values)
            values += 2.0 * pi * np.round((extremum.value - there) / (2.0 * pi))
        return lambda place: float(np.interp(place, x, values))


def _angles_of(scene: Scene) -> tuple[str, ...]:
    """Return the quantities that are transmission angles: those of all dyads."""
    found = tuple([name for name in Measures(scene).quantities if name.startswith(f'{ANGLE}_')])
    return found or (ANGLE,)


def make_of(scene: Scene, names: Sequence[str], acceleration: float) -> Make:
    """Return what makes, of a number type and parameters, the function of some quantities."""
    def make(numbers: NumberType, values: ParameterValues) -> Callable[[Dual], Sequence[Dual]]:
        formulas = formulas_of(scene, numbers, {**scene.values, **values})
        quantities = [formulas.quantities[name] for name in names]
        linkage, needs_loads = scene.linkage, any(one.is_load for one in quantities)
        of_machine = is_machine(scene)

        def rows(x: Dual) -> Sequence[Any]:
            fields = formulas.motion(x, formulas.rate, acceleration)
            loads = (linkage.LOADS(*formulas.loads(fields)) if formulas.loads and needs_loads
                     else None)
            motion = linkage.MOTION(*fields)
            if of_machine:
                _require_closing(linkage.transmission_sine(motion))
            return [quantity.of(motion, loads) for quantity in quantities]
        return rows
    return make


def _require_closing(sine: Scalar) -> None:
    """
    Refuse a piece and a box in which a dyad may not close, by the product of the sines of all.

    A quantity of a machine may be one of other dyads, and known where this one does not close.
    """
    if not (1.0 / whole_of(sine)).is_finite():
        raise ZeroDivisionError


def _of_parts(part: str, most: Bounds, least: Bounds) -> Bounds:
    """Return the bounds of a part from those of the largest and the least value."""
    if part == LEAST_ANGLE:
        return Bounds(min(least.low, pi - most.high), min(least.high, pi - most.low))
    if part == 'span':
        return Bounds(most.low - least.high, most.high - least.low)
    if part == 'peak':
        return Bounds(max(0.0, most.low, -least.high), max(most.high, -least.low))
    return most if part == 'max' else least
