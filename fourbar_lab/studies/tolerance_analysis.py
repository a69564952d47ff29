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
    ANGLE,
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
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

DEVIATIONS = 3.0
# Up to so many parameters all corners are computed; beyond, only the two where the first order is
# worst.
ALL_CORNERS = 8
# Pieces of the input to begin with, and samples of an angle that tell its turns.
PIECES, SAMPLES = 64, 4096
UNKNOWN = Bounds(-inf, inf)


class Tolerance(NamedTuple):
    """A parameter of the box: centre +- size."""

    name: str
    unit: str
    centre: float
    size: float


class Toleranced(NamedTuple):
    """A measure in a box of tolerances."""

    sensitivity: Sensitivity        # in the middle of the box
    first_order: float              # sum of |derivative| size
    corners: Bounds                 # least and greatest value in corners of the box
    proven: Bounds                  # for every mechanism of the box; infinite if not proved


def box_of(study: Study) -> tuple[Tolerance, ...]:
    """Return the box of a study; InvalidParameter for a list or a log_range."""
    box = []
    for one in study.vary:
        if one.kind in ('list', 'log_range'):
            raise InvalidParameter(f'vary.{one.name}', one.kind,
                                   'is not a tolerance; use uniform, normal or range')
        low, high = one.values
        centre, size = ((0.5 * (low + high), 0.5 * (high - low)) if one.kind == 'range' else
                        (low, high if one.kind == 'uniform' else DEVIATIONS * high))
        box.append(Tolerance(one.name, one.unit, centre, size))
    return tuple(box)


def tolerances(study: Study, prove: bool = True) -> list[Toleranced]:
    """
    Return a :class:`Toleranced` for each number that a study measures.

    ``prove``: also prove bounds, which needs python-flint. InvalidParameter if the study has no
    box, or the design in its middle cannot be built.
    """
    box = box_of(study)
    scene = from_values({**study.values, **{one.name: one.centre for one in box}})
    derivatives = Derivatives(scene, [one.name for one in box], study.acceleration)
    measures = [measure for measure in study.measures if measure.part != CLASS]
    at_middle = sensitivities(derivatives, measures)
    corners = _corners(study, box, at_middle)
    proofs = _Proofs(scene, study.acceleration, box, measures) if prove else None
    return [Toleranced(one, sum(abs(one.by[tolerance.name]) * tolerance.size
                                for tolerance in box),
                       corners[one.measure.name],
                       proofs.bounds_of(one.measure) if proofs else UNKNOWN) for one in at_middle]


def _corners(study: Study, box: Sequence[Tolerance],
             sensitivities: Sequence[Sensitivity]) -> dict[str, Bounds]:
    """
    Return {measure: its least and greatest value in corners of the box}.

    With many parameters (see :data:`ALL_CORNERS`) each measure has two corners: every parameter
    moves as its derivative rises, or the opposite way.
    """
    if len(box) <= ALL_CORNERS:
        signs = set(product((-1.0, 1.0), repeat=len(box)))
    else:
        worst = [tuple([1.0 if one.by[tolerance.name] >= 0.0 else -1.0 for tolerance in box])
                 for one in sensitivities]
        signs = {*worst, *(tuple([-sign for sign in one]) for one in worst)}
    columns = np.array(sorted(signs)).T         # (parameters, corners)
    drawn = {one.name: one.centre + one.size * sign for one, sign in zip(box, columns)}
    values = measured(replace(study, bounds=(), keeps_all=True), drawn).columns
    return {one.measure.name: _extent(values[one.measure.name]) for one in sensitivities}


def _extent(values: Array) -> Bounds:
    """Return the least and the greatest number, without NaN; NaN of none."""
    known = values[~np.isnan(values)]
    return Bounds(float(known.min()), float(known.max())) if known.size else Bounds(nan, nan)


class _Proofs:
    """
    Proven bounds of measures over a box of tolerances.

    All of them follow from bounds of the largest and the least value of quantities over the input;
    ``_box`` encloses these quantities in the order of ``_rows``.
    """

    def __init__(self, scene: Scene, acceleration: float, box: Sequence[Tolerance],
                 measures: Sequence[Measure]) -> None:
        """Find the quantities that the measures need, and their extrema in the middle."""
        self._design, self._measures = Design(scene, acceleration), Measures(scene)
        # a machine has one transmission angle for each dyad
        self._angles = tuple([name for name in self._measures.quantities
                              if name.startswith(f'{ANGLE}_')]) or (ANGLE,)
        self._rows = list(dict.fromkeys(name for measure in measures
                                        for name in self._quantities(measure)))
        self._design.search([measures[0]._replace(quantity=name, part='max')
                             for name in self._rows])
        pieces = self._pieces()
        # None if the range of the input depends on the parameters: then nothing is proved
        self._box = Box(enclosing(
            make_of(scene, self._rows, acceleration), scene.values,
            {one.name: one.size for one in box},
            [self._reference(name, pieces) for name in self._rows]), pieces) if pieces else None

    def bounds_of(self, measure: Measure) -> Bounds:
        """Return bounds of a measure that hold for every mechanism of the box."""
        if self._box is None:
            return UNKNOWN
        part = measure.part
        bounds = [_of_part(part,
                           UNKNOWN if part == 'min' else self._extreme(self._box, name, 'max'),
                           UNKNOWN if part == 'max' else self._extreme(self._box, name, 'min'))
                  for name in self._quantities(measure)]
        # of several angles the measure is the least
        return Bounds(min([one.low for one in bounds], default=-inf),
                      min([one.high for one in bounds], default=inf))

    def _quantities(self, measure: Measure) -> Sequence[str]:
        """Return the quantities whose bounds give the bounds of a measure; none: unknown."""
        if measure.part == LEAST_ANGLE:
            return self._angles
        if measure.quantity == ANGLE and self._angles != (ANGLE,):
            return ()          # which dyad is nearest to its toggle, changes within a box
        if measure.part in ('max', 'min', 'peak', 'span', SWING, STROKE):
            return (self._measures.source(measure),)
        return ()

    def _extreme(self, box: Box, quantity: str, end: str) -> Bounds:
        """Return bounds of the largest or least (max, min) value of a quantity over the input."""
        extremum = self._design.extreme(quantity, end)
        if extremum is None or not isfinite(extremum.value):
            return UNKNOWN
        bounds_of = box.most if end == 'max' else box.least
        return bounds_of(self._rows.index(quantity), [extremum.input])

    def _pieces(self) -> list[tuple[float, float]]:
        """Return pieces that cover the input of every mechanism of the box; none if it varies."""
        linkage = self._design.linkage
        if linkage.turns_fully:
            ends = np.linspace(0.0, np.nextafter(2.0 * pi, 7.0), PIECES + 1)
        elif linkage.stroke is not None and linkage.input_ranges == (linkage.stroke,):
            ends = np.linspace(*linkage.stroke, PIECES + 1)
        else:
            return []
        return list(zip(ends[:-1].tolist(), ends[1:].tolist()))

    def _reference(self, name: str, pieces: Sequence[tuple[float, float]]
                   ) -> Callable[[float], float] | None:
        """
        Return a function of the input near a quantity that is an angle, None of others.

        Formulas give angles but for whole turns. Interpolated samples follow the angle without
        jumps, and agree with the extremum that was found.
        """
        design, quantity = self._design, self._measures.quantities[name]
        if not (is_position(quantity) and quantity.unit == 'rad'):
            return None
        x = np.linspace(pieces[0][0], pieces[-1][1], SAMPLES)
        values = np.unwrap(quantity.of(*design.linkage.motion_and_loads(x, *design.rates)))
        extremum = design.extreme(name, 'max')
        if extremum is not None:
            there = np.interp(extremum.input, x, values)
            values += 2.0 * pi * np.round((extremum.value - there) / (2.0 * pi))
        return lambda place: float(np.interp(place, x, values))


def make_of(scene: Scene, names: Sequence[str], acceleration: float) -> Make:
    """
    Return a factory of functions: input -> values of the named quantities.

    It is called with a number type and {parameter: number of that type}; other parameters are
    those of the scene.
    """
    def make(numbers: NumberType, values: ParameterValues) -> Callable[[Dual], Sequence[Dual]]:
        """Return the function for parameters that are numbers of this type."""
        formulas = formulas_of(scene, numbers, {**scene.values, **values})
        quantities = [formulas.quantities[name] for name in names]
        linkage, needs_loads = scene.linkage, any(one.is_load for one in quantities)

        def evaluate(x: Dual) -> Sequence[Any]:
            """Return the quantities at an input; ZeroDivisionError where a dyad may not close."""
            fields = formulas.motion(x, formulas.rate, acceleration)
            loads = (linkage.LOADS(*formulas.loads(fields)) if formulas.loads and needs_loads
                     else None)
            motion = linkage.MOTION(*fields)
            if is_machine(scene):
                _require_closing(linkage.transmission_sine(motion))
            return [quantity.of(motion, loads) for quantity in quantities]
        return evaluate
    return make


def _require_closing(sine: Scalar) -> None:
    """
    Refuse (ZeroDivisionError) a piece and a box in which a dyad of a machine may not close.

    ``sine`` is the product of the sines of all transmission angles. A quantity may be one of other
    dyads, and known where this one does not close: its bounds would be of no mechanism.
    """
    if not (1.0 / whole_of(sine)).is_finite():
        raise ZeroDivisionError


def _of_part(part: str, most: Bounds, least: Bounds) -> Bounds:
    """Return the bounds of a part from the bounds of the largest and the least value."""
    if part == LEAST_ANGLE:
        return Bounds(min(least.low, pi - most.high), min(least.high, pi - most.low))
    if part in ('span', SWING, STROKE):
        return Bounds(most.low - least.high, most.high - least.low)
    if part == 'peak':
        return Bounds(max(0.0, most.low, -least.high), max(most.high, -least.low))
    return most if part == 'max' else least
