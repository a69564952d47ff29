# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact derivatives of outputs, extrema and measures by the parameters of a scene: lengths, masses.

All of them at once, by dual numbers over the trace of motion and loads. With Q(x, p) a
quantity, x the input, p the parameters, and an extremum inside the input range at x*(p),

    (S1)  d Q(x*, p)/dp = Q_p(x*, p)         as Q_x = 0 there (envelope theorem)
    (S2)  d x*/dp = -Q_xp / Q_xx             (implicit function theorem)

where Q_xp and Q_xx come from a complex step of x through the same duals. A measure that jumps or
has no derivative (a count, a text, an infinite value, an end of the input that is a toggle
position) has NaN.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, nan, pi
from typing import Any, NamedTuple

from fourbar_lab.quadrature import nodes
from fourbar_lab.studies.design import Design
from fourbar_lab.studies.duals import derivatives_of, Dual, DUALS, value_of
from fourbar_lab.studies.measures import (
    CHANGE_POINT,
    INPUT_RANGE,
    LEAST_ANGLE,
    Measure,
    Measures,
    STROKE,
    SWING,
    TIME_RATIO,
)
from fourbar_lab.studies.parametric import (
    constants_of,
    is_machine,
    margin_signs,
    point_quantities_of,
)
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.extrema.sampling import State
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.mechanisms.points import with_any_lengths
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.tables import run
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.scene.parameters import find_parameter
from fourbar_ros.scene.scene import Scene
import numpy as np

INPUT = 'input'         # the input of the mechanism, as a parameter among the others
STEP = 2.0**-200        # of a complex step: its square is nothing beside any number
# An extremum farther than this [rad] from where the slope vanishes is no smooth one: that of a
# transmission angle where another dyad becomes the one that is nearest to its toggle.
SHARP = 1e-5
# Inputs of a mean square: of a full turn, of a range.
POINTS, NODES = 4096, 512


def usable(scene: Scene) -> tuple[str, ...]:
    """Return the parameters by which there are derivatives: numbers that a scene gives."""
    linkage = scene.linkage
    dimensions = [f'linkage.{name}' for name in linkage.length_names]
    if is_machine(scene):
        dimensions = ['dyads.', *['cylinder.'] * (linkage.input == 'cylinder')]
    beginnings = (*dimensions, 'bodies.rods.',
                  *[f'bodies.{link.name}.' for link in linkage.LINKS], 'gravity.',
                  *[f'external.{link}.' for link in linkage.EXTERNAL._fields], 'points.',
                  'drive.speed')
    return tuple([name for name, value in scene.values.items() if name.startswith(beginnings)
                  and getattr(find_parameter(name), 'type', '') == 'double' and value == value])


class Derivatives:
    """
    Derivatives of the quantities of a scene by some of its parameters, by default all numbers.

    The input has the rate of the scene's drive and this acceleration. InvalidParameter if one of
    the names is no number that the scene gives.
    """

    def __init__(self, scene: Scene, names: Sequence[str] = (), acceleration: float = 0.0) -> None:
        """Record the formulas of the scene with its parameters as data."""
        known = usable(scene)
        for name in names:
            if name not in known:
                raise InvalidParameter(name, scene.values.get(name),
                                       'must be a number that the scene gives')
        self.scene, self.names, self.acceleration = scene, tuple(names) or known, acceleration
        self._sharp = SHARP * scene.linkage.input_unit          # [rad or m]
        self.quantities = Measures(scene).quantities
        self._trace = Trace(self._make, 1, tuple([scene.values[name] for name in self.names]))

    def _make(self, numbers: NumberType, data: Sequence[Scalar]) -> Function:
        """Return input -> fields of motion and of loads, quantities, for data of parameters."""
        linkage, values = self.scene.linkage, {**self.scene.values, **dict(zip(self.names, data))}
        constants = constants_of(self.scene, values, numbers)
        with np.errstate(all='ignore'):
            move = linkage.motion_formula(numbers, constants)
            load = linkage.loads_formula(numbers, constants) if linkage.bodies else None
        self.quantities |= point_quantities_of(self.scene, values,
                                               with_any_lengths(linkage, constants.lengths))

        def results(x: Scalar) -> tuple[Any, ...]:
            """Return all results; without masses there are no loads."""
            fields = move(x, values['drive.speed'], self.acceleration)
            loads = load(fields) if load else ()
            state = (linkage.MOTION(*fields), linkage.LOADS(*loads) if loads else NoLoads())
            return tuple(fields), tuple(loads), [
                quantity.of(*state) if loads or not quantity.is_load else nan
                for quantity in self.quantities.values()]
        return results

    def _duals(self, places: Sequence[int], x: Any) -> list[Any]:
        """Return the numbers at some places of the trace at inputs x, which may be a dual."""
        trace, known = self._trace, [step.value for step in self._trace.steps]
        known[0] = x
        for i, name in enumerate(self.names):
            known[1 + i] = Dual(self.scene.values[name], {name: 1.0})
        steps = [i for i in trace.needed(places) if not trace.steps[i].is_given]
        with np.errstate(all='ignore'):
            run(trace, steps, DUALS, known)
        return [known[i] for i in places]

    def state(self, x: Array, with_loads: bool = True) -> State:
        """
        Return (motion, loads) at inputs x, shape (n,): fields are duals, or plain numbers.

        ``value_of(field)`` is its values, ``derivatives_of(field)`` {parameter: derivatives}.
        """
        linkage, count = self.scene.linkage, len(self.scene.linkage.MOTION._fields)
        fields = self._duals([place for part in range(1 + with_loads)
                              for place in flat(self._trace.part(part))], x)
        return (linkage.MOTION(*fields[:count]),
                linkage.LOADS(*fields[count:]) if fields[count:] else NoLoads())

    def _quantity(self, name: str, x: Any) -> Any:
        """Return a quantity as a dual at inputs x, which may be one themselves."""
        places = flat(self._trace.part(2))
        return self._duals([places[[*self.quantities].index(name)]], x)[0]

    def of(self, name: str, x: Array) -> tuple[Array, Array]:
        """Return values of a quantity at inputs x, shape (n,), and derivatives (parameters, n)."""
        dual = self._quantity(name, x)
        by, zero = derivatives_of(dual), np.zeros_like(x)
        return zero + value_of(dual), np.array([zero + by.get(one, 0.0) for one in self.names])

    def at_extremum(self, name: str, x: float) -> tuple[Array, Array]:
        """
        Return how value and place of an extremum inside the input range change, (S1) and (S2).

        Shape (parameters,) each, in the order of ``names``.
        NaN where the quantity has a kink or a jump; the place is NaN if the quantity is constant.
        """
        stepped = Dual(np.array([x + 1j * STEP]), {INPUT: 1.0})
        with np.errstate(all='ignore'):
            by = derivatives_of(self._quantity(name, stepped))
            # real parts are Q_p and Q_x, imaginary parts STEP times Q_xp and Q_xx
            *parts, slope = (np.ravel(by.get(one, 0.0) + 0j)[0] for one in (*self.names, INPUT))
            # -STEP off is the way from x to the place: rounding, or x is no smooth extremum
            off = slope.real / slope.imag if slope else 0.0     # a constant quantity has no place
            if STEP * abs(off) > self._sharp:
                off = nan
            slopes = np.array(parts)
            return slopes.real - off * slopes.imag, -slopes.imag / slope.imag + 0.0 * off


# --- of measures ---------------------------------------------------------------------------------

class Sensitivity(NamedTuple):
    """A measure, its value, and {parameter: its derivative}."""

    measure: Measure
    value: float | str
    by: dict[str, float]


def sensitivities(derivatives: Derivatives, measures: Sequence[Measure]) -> list[Sensitivity]:
    """Return the :class:`Sensitivity` of each measure of a scene."""
    design = Design(derivatives.scene, derivatives.acceleration)
    design.search([*measures, *(replace(measure, part='peak') for measure in measures
                                if measure.part == 'rms')])
    found = _MeasureDerivatives(derivatives, design)
    return [Sensitivity(measure, design.of(measure),
                        dict(zip(derivatives.names, found.of(measure).tolist())))
            for measure in measures]


class _MeasureDerivatives:
    """
    Derivatives of the measures of one design whose extrema are known.

    Each is an array of shape (parameters,), in the order of ``derivatives.names``.
    """

    def __init__(self, derivatives: Derivatives, design: Design) -> None:
        """Take the derivatives of quantities, and a design whose extrema were searched."""
        self._derivatives, self._design = derivatives, design
        self._names, self._source = derivatives.names, Measures(derivatives.scene).source
        self._unknown = np.full(len(derivatives.names), nan)
        linkage = design.linkage                # a full turn or a stroke depends on no parameter
        self._input_is_fixed = bool(linkage.turns_fully
                                    or linkage.input_ranges == (linkage.stroke,))

    def of(self, measure: Measure) -> Array:
        """Return the derivatives of a measure by every parameter, NaN where there is none."""
        part, name = measure.part, self._source(measure)
        if part == CHANGE_POINT:
            return self._of_margin()
        if part == INPUT_RANGE:
            return np.zeros(len(self._names)) if self._input_is_fixed else self._unknown
        if part == 'rms':
            return self._of_rms(name)
        most, least = (self._design.extreme(name, end) if name else None for end in ('max', 'min'))
        if most is None or least is None:           # an output that turns fully keeps its swing
            return np.zeros(len(self._names)) if part in (SWING, STROKE) else self._unknown
        (of_max, of_max_at), (of_min, of_min_at) = map(self._of_extremum, (most, least))
        if part == 'peak':
            larger, of_larger = ((most, of_max) if abs(most.value) >= abs(least.value)
                                 else (least, of_min))
            return of_larger if larger.value >= 0.0 else -of_larger
        if part == LEAST_ANGLE:
            return of_min if least.value <= pi - most.value else -of_max
        if part == TIME_RATIO and self._design.linkage.turns_fully:
            forward = (most.input - least.input) % (2.0 * pi)
            short = min(forward, 2.0 * pi - forward)        # ratio = (2 pi - short) / short
            factor = -2.0 * pi / short**2 * (1.0 if forward <= pi else -1.0)
            return factor * (of_max_at - of_min_at)
        return {'max': of_max, 'max_at': of_max_at, 'min': of_min, 'min_at': of_min_at,
                'span': of_max - of_min, SWING: of_max - of_min, STROKE: of_max - of_min
                }.get(part, self._unknown)

    def _of_extremum(self, extremum: Extremum) -> tuple[Array, Array]:
        """
        Return the derivatives of the value and of the place of an extremum.

        Inside the range by (S1), (S2); at an end of a stroke, which does not move, of the value.
        """
        name, x = extremum.quantity, extremum.input
        if not isfinite(extremum.value):
            return self._unknown, self._unknown
        if not extremum.side:
            return self._derivatives.at_extremum(name, x)
        if x in (self._design.linkage.stroke or ()):        # an end that stays where it is
            _, slopes = self._derivatives.of(name, np.array([x]))
            return slopes[:, 0], np.zeros(len(self._names))
        return self._unknown, self._unknown     # a toggle: the input turns back, with no formula

    def _of_rms(self, name: str) -> Array:
        """Return d sqrt(mean Q^2) = mean(Q Q_p) / sqrt(mean Q^2)."""
        if not self._input_is_fixed:
            return self._unknown
        linkage = self._design.linkage
        x, weights = nodes(linkage, POINTS if linkage.turns_fully else NODES)
        values, slopes = self._derivatives.of(name, x)
        size = float(np.sqrt(np.sum(weights * values * values)))
        if size == 0.0:       # it grows whichever way a parameter goes: no derivative
            return np.where(slopes.any(axis=1), nan, 0.0)
        return np.asarray((weights * values * slopes).sum(axis=1) / size)

    def _of_margin(self) -> Array:
        """
        Return the derivatives of the distance from a change point.

        That is the least |sum of lengths with signs| over the sum of all lengths. A length that is
        negative, as an offset may be, counts with its size.
        """
        linkage = self._derivatives.scene.linkage
        signs, lengths = margin_signs(linkage), np.array(linkage.lengths)
        if signs is None:
            return self._unknown
        sizes = np.abs(lengths)
        least = signs[np.abs(signs @ sizes).argmin()]
        least = least if least @ sizes > 0.0 else -least
        slopes = (least - least @ sizes / sizes.sum()) / sizes.sum() * np.where(lengths < 0, -1, 1)
        by = {f'linkage.{name}': slope for name, slope in zip(linkage.length_names, slopes)}
        return np.array([by.get(name, 0.0) for name in self._names])
