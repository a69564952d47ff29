# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact derivatives of outputs, extrema and measures by the parameters of a scene: lengths, masses.

All of them at once, by dual numbers through the formulas of motion and loads. With Q(x, p) a
quantity, x the input, p the parameters, and an extremum inside the input range at x*(p),

    (S1)  d Q(x*, p)/dp = Q_p(x*, p)         as Q_x = 0 there (envelope theorem)
    (S2)  d x*/dp = -Q_xp / Q_xx             (implicit function theorem)

where Q_xp and Q_xx come from a complex step of x through the same duals. A measure that jumps or
has no derivative (a count, a text, an infinite value, an end of the input that is a toggle
position) has NaN.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite, nan, pi
from typing import Any, NamedTuple

from fourbar_lab.studies.design import Design, nodes
from fourbar_lab.studies.measures import (
    CHANGE_POINT,
    INPUT_RANGE,
    LEAST_ANGLE,
    Measure,
    STROKE,
    SWING,
    TIME_RATIO,
)
from fourbar_lab.studies.parametric import dimensions_of, Formulas, formulas_of
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.extrema.sampling import State
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.duals import derivatives_of, Dual, duals_of, value_of
from fourbar_ros.numerics.number_types import ARRAY, COMPLEX_WITH_ANGLES
from fourbar_ros.scene.parameters import find
from fourbar_ros.scene.scene import Scene
import numpy as np

INPUT, STEP = 'input', 2.0**-200
# An extremum farther than this [rad] from where the slope vanishes is no smooth one: that of a
# transmission angle where another dyad becomes the one that is nearest to its toggle.
SHARP = 1e-5
# Inputs of a mean: of a full turn, of a range.
POINTS, NODES = 4096, 512

By = dict[str, Any]      # {parameter: derivative}


class AtExtremum(NamedTuple):
    """How an extremum moves: derivatives of its value and of its place by each parameter."""

    value: By
    place: By


def usable(scene: Scene) -> tuple[str, ...]:
    """Return the parameters that a scene gives and by which there are derivatives."""
    linkage = scene.linkage
    places = (*dimensions_of(scene), 'bodies.rods.',
              *[f'bodies.{link.name}.' for link in linkage.LINKS], 'gravity.',
              *[f'external.{link}.' for link in linkage.EXTERNAL._fields], 'points.',
              'drive.speed')
    known = [(name, find(name)) for name in scene.values if name.startswith(places)]
    return tuple([name for name, parameter in known
                  if parameter is not None and parameter.type == 'double'
                  and scene.values[name] == scene.values[name]])


class Derivatives:
    """
    Derivatives of the quantities of a scene by some of its parameters.

    Parameters
    ----------
    scene : Scene
        Of any mechanism.
    names : sequence of str, optional
        Parameters of the scene; default: all numbers that it gives.
    acceleration : float
        Of the input; its rate is that of the drive.

    Raises
    ------
    InvalidParameter
        A parameter is no number that the scene gives.

    """

    def __init__(self, scene: Scene, names: Sequence[str] = (), acceleration: float = 0.0) -> None:
        known = usable(scene)
        for name in names:
            if name not in known:
                raise InvalidParameter(name, scene.values.get(name),
                                       'must be a number that the scene gives')
        self.scene, self.names, self.acceleration = scene, tuple(names) or known, acceleration
        values = {**scene.values, **{name: Dual(scene.values[name], {name: 1.0})
                                     for name in self.names}}
        self._real = formulas_of(scene, duals_of(ARRAY), values)
        self._sharp = SHARP * scene.linkage.input_unit
        self._complex = formulas_of(scene, duals_of(COMPLEX_WITH_ANGLES), values)
        self.quantities = self._real.quantities

    def state(self, x: Array, with_loads: bool = True) -> State:
        """
        Return (motion, loads) at inputs x, shape (n,): fields are duals, or plain numbers.

        ``value_of`` and ``derivatives_of`` take them apart.
        """
        return self._state(self._real, x, with_loads)

    def _state(self, formulas: Formulas, x: Array | Dual, with_loads: bool) -> State:
        linkage = self.scene.linkage
        with np.errstate(all='ignore'):
            fields = formulas.motion(x, formulas.rate, self.acceleration)
            loads = (linkage.LOADS(*formulas.loads(fields)) if with_loads and formulas.loads
                     else NoLoads())
        return linkage.MOTION(*fields), loads

    def of(self, name: str, x: Array) -> tuple[Array, By]:
        """Return values of a quantity at inputs x, shape (n,), and {parameter: derivatives}."""
        quantity = self._real.quantities[name]
        with np.errstate(all='ignore'):
            dual = quantity.of(*self.state(x, quantity.is_load))
        value, by = value_of(dual), derivatives_of(dual)
        zero = np.zeros_like(x)
        return zero + value, {one: zero + by.get(one, 0.0) for one in self.names}

    def at_extremum(self, name: str, x: float) -> AtExtremum:
        """
        Return how an extremum of a quantity inside the input range moves, (S1) and (S2).

        NaN where the quantity has a kink or a jump; the place of what is constant is NaN.
        """
        quantity = self._complex.quantities[name]
        there = Dual(np.array([x + 1j * STEP]), {INPUT: 1.0})
        with np.errstate(all='ignore'):
            by = derivatives_of(quantity.of(*self._state(self._complex, there,
                                                         quantity.is_load)))
            parts = {one: np.ravel(by.get(one, 0.0) + 0j)[0] for one in (*self.names, INPUT)}
            slope = parts.pop(INPUT)
            off = slope.real / slope.imag if slope else 0.0     # what is constant has no place
            unknown = nan if STEP * abs(off) > self._sharp else 0.0
            moves = {one: float(-part.imag / slope.imag) + unknown
                     for one, part in parts.items()}
            # x is the place but for rounding: what slope is left there moves with it
            return AtExtremum({one: float(part.real - off * part.imag) + unknown
                               for one, part in parts.items()}, moves)


# --- of measures ---------------------------------------------------------------------------------

class Sensitivity(NamedTuple):
    """A measure, its value, and {parameter: its derivative}."""

    measure: Measure
    value: float | str
    by: By


def sensitivities(derivatives: Derivatives, measures: Sequence[Measure]) -> list[Sensitivity]:
    """Return the :class:`Sensitivity` of each measure of a scene."""
    design = Design(derivatives.scene, derivatives.acceleration)
    design.search([*measures, *(measure._replace(part='peak') for measure in measures
                                if measure.part == 'rms')])
    found = _Measured(derivatives, design)
    return [Sensitivity(measure, design.of(measure), found.by(measure)) for measure in measures]


class _Measured:
    """Derivatives of the measures of one design whose extrema are known."""

    def __init__(self, derivatives: Derivatives, design: Design) -> None:
        self._derivatives, self._design = derivatives, design
        self._none = dict.fromkeys(derivatives.names, nan)
        self._moves: dict[tuple[str, float], AtExtremum] = {}

    def by(self, measure: Measure) -> By:
        """Return the derivatives of a measure by every parameter."""
        if measure.part in self._of_mechanism:
            return self._of_mechanism[measure.part](self)
        return self._of_part(measure.quantity, measure.part) if measure.quantity else self._none

    def _of_part(self, name: str, part: str) -> By:
        if part == 'rms':
            return self._rms(name)
        if part == 'span':
            return _combined(self._of_part(name, 'max'), self._of_part(name, 'min'), -1.0)
        if part == 'peak':
            most, least = (self._design.extreme(name, end) for end in ('max', 'min'))
            if most is None or least is None:
                return self._none
            is_high = abs(most.value) >= abs(least.value)
            sign = 1.0 if (most if is_high else least).value >= 0.0 else -1.0
            return {one: sign * value for one, value in
                    self._of_part(name, 'max' if is_high else 'min').items()}
        end, _, of_place = part.partition('_at')
        extremum = self._design.extreme(name, end) if end in ('max', 'min') else None
        if extremum is None or not isfinite(extremum.value):
            return self._none
        return self._of_extremum(name, extremum, part.endswith('_at'))

    def _of_extremum(self, name: str, extremum: Extremum, is_place: bool) -> By:
        """Return the derivatives of value or place of an extremum."""
        x, design = self._design.place_of(extremum), self._design
        if not extremum.side:
            if (name, x) not in self._moves:
                self._moves[name, x] = self._derivatives.at_extremum(name, x)
            moves = self._moves[name, x]
            return dict(moves.place if is_place else moves.value)
        if x not in (design.linkage.stroke or ()):
            return self._none           # the input turns back there: no derivative by formula
        if is_place:
            return dict.fromkeys(self._none, 0.0)
        return {one: float(part[0]) for one, part in
                self._derivatives.of(name, np.array([x]))[1].items()}

    @property
    def _is_fixed(self) -> bool:
        """Return whether the input range does not depend on the parameters."""
        linkage = self._design.linkage
        return bool(linkage.turns_fully or linkage.input_ranges == (linkage.stroke,))

    def _rms(self, name: str) -> By:
        """Return d sqrt(mean Q^2) = mean(Q Q_p) / sqrt(mean Q^2)."""
        if not self._is_fixed:
            return self._none
        is_turn = self._design.linkage.turns_fully
        (low, high), = self._design.linkage.input_ranges
        x, weights = nodes(low, high, POINTS if is_turn else NODES, is_turn)
        values, by = self._derivatives.of(name, x)
        size = float(np.sqrt(np.sum(weights * values * values)))
        return {one: float(np.sum(weights * values * part)) / size for one, part in by.items()}

    def _sweep(self) -> By:
        name = self._design.output
        if self._design.extreme(name, 'max') is None:       # it turns fully
            return dict.fromkeys(self._none, 0.0)
        return self._of_part(name, 'span')

    def _least_angle(self) -> By:
        name = 'transmission_angle'
        least, most = (self._design.extreme(name, end) for end in ('min', 'max'))
        if least is None or most is None:
            return self._none
        if least.value <= pi - most.value:
            return self._of_part(name, 'min')
        return {one: -value for one, value in self._of_part(name, 'max').items()}

    def _time_ratio(self) -> By:
        name, design = self._design.output, self._design
        most, least = (design.extreme(name, end) for end in ('max', 'min'))
        if most is None or least is None or not design.linkage.turns_fully:
            return self._none
        forward = (most.theta1 - least.theta1) % (2.0 * pi)
        moves = _combined(self._of_part(name, 'max_at'), self._of_part(name, 'min_at'), -1.0)
        short = min(forward, 2.0 * pi - forward)
        factor = -2.0 * pi / short**2 * (1.0 if forward <= pi else -1.0)
        return {one: factor * value for one, value in moves.items()}

    def _range(self) -> By:
        return dict.fromkeys(self._none, 0.0) if self._is_fixed else self._none

    def _margin(self) -> By:
        """Return those of the least difference of sums of lengths, over the sum of all."""
        linkage = self._derivatives.scene.linkage
        sizes = [_with_parameter(f'linkage.{name}', length, self._none)
                 for name, length in zip(linkage.length_names, linkage.lengths)]
        margins = [sum((sign * size for sign, size in zip(signs, sizes)), start=Dual(0.0, {}))
                   for signs in linkage.MARGIN_SIGNS]
        given = np.abs([margin.value for margin in margins])
        if not margins or not np.allclose(given, np.abs(linkage.margins), 1e-12,
                                          1e-12 * sum(linkage.lengths)):
            return self._none           # other numbers than sums of lengths
        least = margins[int(given.argmin())]
        share = (least if least.value > 0.0 else -least) / sum(sizes, start=Dual(0.0, {}))
        by = derivatives_of(share)
        return {one: by.get(one, 0.0) for one in self._none}

    _of_mechanism: dict[str, Callable[[_Measured], By]] = {
        SWING: _sweep, STROKE: _sweep, LEAST_ANGLE: _least_angle, TIME_RATIO: _time_ratio,
        INPUT_RANGE: _range, CHANGE_POINT: _margin}


def _with_parameter(name: str, length: float, names: By) -> Dual:
    """Return the size of a length as a dual, constant if it is not among the parameters."""
    sign = -1.0 if length < 0.0 else 1.0
    return Dual(abs(length), {name: sign} if name in names else {})


def _combined(one: By, other: By, factor: float) -> By:
    return {name: value + factor * other[name] for name, value in one.items()}
