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
position) has NaN. Where two inputs or two dyads tie for an extremum it has a kink, and NaN for the
parameters that move them apart.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, isnan, nan, pi, tau
from typing import Any, NamedTuple

from fourbar_lab.studies.design import Design
from fourbar_lab.studies.duals import derivatives_of, Dual, DUALS, value_of
from fourbar_lab.studies.measures import (
    ANGLE,
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
from fourbar_ros.extrema.find import CONSTANT, Extremum, ONE_SIDED
from fourbar_ros.extrema.sampling import State
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.mechanisms.points import with_any_lengths
from fourbar_ros.mechanisms.quadrature import nodes
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
# Inputs of a mean square: of a full turn, of a range. With half of them the derivatives differ by
# less than this part of the largest, or they are not resolved.
POINTS, NODES, RESOLVED = 4096, 512, 1e-6
# Values nearer than this part of them tie: the kink is nearer than any tolerance. Derivatives are
# the same on both sides of it if they differ by less than this part of the largest, or of the
# measure, when a parameter changes by its own size.
TIE = SAME = 1e-9
SAMPLES = 64            # inputs at which a quantity that is constant has derivatives
LENGTHS = 'linkage.', 'dyads.', 'cylinder.'      # beginnings of the parameters that are lengths
TOGGLE = 'the input ends at a toggle position, which has no formula'


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
    """A measure, its value, {parameter: its derivative}, and why some of these are NaN, or ''."""

    measure: Measure
    value: float | str
    by: dict[str, float]
    why_unknown: str


def sensitivities(derivatives: Derivatives, measures: Sequence[Measure]) -> list[Sensitivity]:
    """Return the :class:`Sensitivity` of each measure of a scene."""
    design = Design(derivatives.scene, derivatives.acceleration)
    design.search([*measures, *(replace(measure, part='peak') for measure in measures
                                if measure.part == 'rms')])
    results = []
    for measure in measures:
        value = design.of(measure)
        found = _MeasureDerivatives(derivatives, design, value)
        slopes = found.of(measure)
        results.append(Sensitivity(measure, value, dict(zip(derivatives.names, slopes.tolist())),
                                   found.why_unknown if np.isnan(slopes).any() else ''))
    return results


class _MeasureDerivatives:
    """
    The derivatives of one measure of a design whose extrema are known.

    Each is an array of shape (parameters,), in the order of ``derivatives.names``.
    """

    def __init__(self, derivatives: Derivatives, design: Design, value: float | str) -> None:
        """Take a design whose extrema were searched, and the value of the measure."""
        self._derivatives, self._design = derivatives, design
        self._value = value             # a text has no derivatives
        self._names, self._source = derivatives.names, Measures(derivatives.scene).source
        self._zero = np.zeros(len(derivatives.names))
        sizes = np.abs([derivatives.scene.values[name] for name in derivatives.names])
        self._sizes = np.where(sizes > 0.0, sizes, 1.0)
        self.why_unknown = ''
        linkage = design.linkage                # a full turn or a stroke depends on no parameter
        self._input_is_fixed = bool(linkage.turns_fully
                                    or linkage.input_ranges == (linkage.stroke,))

    def of(self, measure: Measure) -> Array:
        """Return the derivatives of a measure by every parameter, NaN where there is none."""
        slopes, linkage = self._of(measure), self._design.linkage
        if linkage.change_point_margin > TIE or measure.part == CHANGE_POINT:
            return slopes
        changes = [name.startswith(LENGTHS) for name in self._names]
        if not any(changes):
            return slopes
        return np.where(changes, self._unknown('at a change point any change of a length adds or '
                                               'takes poses'), slopes)

    def _of(self, measure: Measure) -> Array:
        """Return the derivatives of a measure, as if the links closed at the same inputs."""
        part, name = measure.part, self._source(measure)
        if isinstance(self._value, str) or part == 'extrema':
            return self._unknown('it is no number on a scale')
        if not isfinite(self._value):
            return self._unknown('it has no value' if isnan(self._value) else 'it is infinite')
        if part == CHANGE_POINT:
            return self._of_margin()
        if part == INPUT_RANGE:
            return self._zero if self._input_is_fixed else self._unknown(TOGGLE)
        if part == 'rms':
            return self._of_rms(name)
        extrema = (self._design.output_range.extrema if part in (SWING, STROKE)
                   else self._design.extrema[name])
        if not extrema:                         # an output that turns fully keeps its swing
            return self._zero
        if part == 'peak':
            return self._of_largest([(sign * extremum.value, sign, extremum)
                                     for extremum in extrema for sign in (1.0, -1.0)])[0]
        if part == LEAST_ANGLE:
            of_angle, _ = self._of_largest([
                (score, sign, of_dyad) for extremum in extrema for of_dyad in self._dyads(extremum)
                for score, sign in ((-of_dyad.value, -1.0), (of_dyad.value - pi, 1.0))])
            return -of_angle
        of_end = {}
        for end, sign in (('max', 1.0), ('min', -1.0)):
            if not part.startswith(('max', 'min')) or part.startswith(end):
                of_score, of_end[f'{end}_at'] = self._of_largest([
                    (sign * extremum.value, sign, extremum) for extremum in extrema])
                of_end[end] = sign * of_score
        if part == TIME_RATIO:
            return self._of_time_ratio(name, of_end['max_at'] - of_end['min_at'])
        return of_end[part] if part in of_end else of_end['max'] - of_end['min']    # of a span

    def _unknown(self, why: str) -> Array:
        """Return NaN for every parameter, and keep the reason if it is the first."""
        self.why_unknown = self.why_unknown or why
        return np.full(len(self._names), nan)

    def _agreed(self, slopes: Sequence[Array], why: str, scale: float = 0.0) -> Array:
        """
        Return the derivatives if all of some are the same, NaN for parameters where not.

        ``scale``: of what they are derivatives; by default the size of the measure.
        """
        effects, scale = np.asarray(slopes) * self._sizes, scale or abs(float(self._value))
        is_same = np.ptp(effects, axis=0) <= SAME * np.max(np.abs(effects), initial=scale)
        return slopes[0] if is_same.all() else np.where(is_same, slopes[0], self._unknown(why))

    def _of_largest(self, scores: Sequence[tuple[float, float, Extremum]]) -> tuple[Array, Array]:
        """
        Return the derivatives of the largest score, and of the input where it is.

        ``scores``: (score, sign, extremum); a score changes as sign times the extremum's value.
        """
        largest = max(score for score, *_ in scores)
        if not isfinite(largest):
            return self._unknown('it is infinite'), self._unknown('it is infinite')
        tied = [(sign, extremum) for score, sign, extremum in scores
                if largest - score <= TIE * abs(largest)]
        places = [f'{extremum.quantity} at {extremum.input:.6g}' for _, extremum in tied]
        why = (f'it has a kink: {len(tied)} extrema tie, as {" and ".join(places[:2])} '
               f'{self._design.linkage.input_coordinate.unit}')
        of_values, of_places = zip(*[self._of_extremum(extremum) for _, extremum in tied])
        of_score = self._agreed([sign * slopes for (sign, _), slopes in zip(tied, of_values)], why)
        # which of several inputs counts is a choice of rounding
        return of_score, of_places[0] if len(tied) == 1 else self._unknown(why)

    def _of_extremum(self, extremum: Extremum) -> tuple[Array, Array]:
        """Return the derivatives of value and place of an extremum; of dyads, what they share."""
        dyads = self._dyads(extremum)
        why = f'it has a kink: {" and ".join(dyad.quantity for dyad in dyads)} tie'
        if np.ptp([dyad.value for dyad in dyads]) > TIE:
            return self._unknown(why), self._unknown(why)       # mu and pi - mu: it jumps
        of_values, of_places = zip(*map(self._of_one, dyads))
        return (self._agreed(of_values, why),
                self._agreed(of_places, why, self._design.linkage.input_unit))

    def _of_one(self, extremum: Extremum) -> tuple[Array, Array]:
        """
        Return the derivatives of the value and of the place of an extremum.

        Inside the range by (S1), (S2); at an end of a stroke, which does not move, of the value.
        """
        name, x = extremum.quantity, extremum.input
        if extremum.kind == CONSTANT:
            _, slopes = self._derivatives.of(name, nodes(self._design.linkage, SAMPLES)[0])
            why = 'it is constant over the input, and any change makes extrema'
            return self._agreed([*slopes.T], why), self._unknown(why)
        if not extremum.side:
            of_value, of_place = self._derivatives.at_extremum(name, x)
            if np.isnan(of_value).any():
                self._unknown(f'it has a kink or a jump at the input {x:.6g}')
            return of_value, of_place
        if x in (self._design.linkage.stroke or ()):        # an end that stays where it is
            _, slopes = self._derivatives.of(name, np.array([x]))
            return slopes[:, 0], self._zero
        why = ('its extremum is at a flat position, where it jumps'
               if extremum.place == ONE_SIDED else TOGGLE)
        return self._unknown(why), self._unknown(why)

    def _angles(self, x: Array) -> tuple[tuple[str, ...], Array, Array]:
        """
        Return (names, values, which count) of the transmission angles of all dyads at inputs x.

        Shapes (dyads, n). Those of the dyads nearest to their toggle count, all that tie.
        """
        linkage = self._design.linkage
        names = tuple([name for name in linkage.MOTION._fields
                       if name.startswith(f'{ANGLE}_')]) or (ANGLE,)    # of a kind with one dyad
        angles = np.array(linkage.motion(x, fields=names))
        sines = np.abs(np.sin(angles))
        return names, angles, sines - sines.min(axis=0) <= TIE

    def _dyads(self, extremum: Extremum) -> list[Extremum]:
        """Return an extremum; of the transmission angle, those of the dyads that count there."""
        if extremum.quantity != ANGLE:
            return [extremum]
        names, angles, counts = self._angles(np.array([extremum.input]))
        return [extremum._replace(quantity=name, value=float(angle))
                for name, (angle,), (does_count,) in zip(names, angles, counts)
                if does_count] or [extremum]        # at a toggle it has no motion

    def _of_time_ratio(self, output: str, of_way: Array) -> Array:
        """Return the derivatives of (2 pi - short) / short, from those of the way between ends."""
        most, least = (self._design.extreme(output, end) for end in ('max', 'min'))
        assert most and least
        forward = (most.input - least.input) % tau
        slopes = -tau / min(forward, tau - forward)**2 * of_way
        if abs(forward - pi) <= TIE:            # either stroke may become the slower one
            return self._agreed([slopes, -slopes], 'it has a kink: both strokes take as long')
        return slopes if forward < pi else -slopes

    def _of_rms(self, name: str) -> Array:
        """Return d sqrt(mean Q^2) = mean(Q Q_p) / sqrt(mean Q^2)."""
        if not self._input_is_fixed:
            return self._unknown(TOGGLE)
        linkage, results = self._design.linkage, []
        most = POINTS if linkage.turns_fully else NODES
        for points in (most, most // 2):
            x, weights = nodes(linkage, points)
            if name == ANGLE:
                _, _, counts = self._angles(x)
                if (counts != counts[:, :1]).any() or counts[:, 0].sum() > 1:
                    return self._unknown('it jumps where another dyad is nearest to its toggle')
            values, slopes = self._derivatives.of(name, x)
            if (self._derivatives.quantities[name].unit == 'rad'
                    and np.abs(np.diff(values)).max() > pi):
                return self._unknown('the angle wraps')
            size = float(np.sqrt(np.sum(weights * values * values)))
            if size == 0.0:       # it grows whichever way a parameter goes: no derivative
                return np.where(slopes.any(axis=1), self._unknown('it is 0 at every input'), 0.0)
            # a size of 0 has no slope, and the product is 0
            results.append((weights * np.where(values, values * slopes, 0.0)).sum(axis=1) / size)
        effects = np.array(results) * self._sizes
        if not np.ptp(effects, axis=0).max() <= RESOLVED * np.abs(effects).max():
            return self._unknown(f'{most} inputs do not resolve it')
        return np.asarray(results[0])

    def _of_margin(self) -> Array:
        """
        Return the derivatives of the distance from a change point.

        That is the least |sum of lengths with signs| over the sum of all lengths. A length that is
        negative, as an offset may be, counts with its size.
        """
        linkage = self._derivatives.scene.linkage
        signs, lengths = margin_signs(linkage), np.array(linkage.lengths)
        if signs is None:
            return self._unknown('it has no formula in the lengths')
        total, sums = np.abs(lengths).sum(), signs @ np.abs(lengths)
        tied = np.abs(sums) - np.abs(sums).min() <= TIE * total
        slopes = []
        # one of each side: of a length that is 0, of a sum that is 0, of sums that tie
        for sign, margin in zip(signs[tied], sums[tied] / total):
            for of_sum in (1.0, -1.0) if abs(margin) <= TIE else (np.sign(margin),):
                for of_lengths in (np.where(lengths < 0.0, -1, 1), np.where(lengths > 0.0, 1, -1)):
                    by = dict(zip(linkage.length_names,
                                  of_lengths * (of_sum * sign - abs(margin)) / total))
                    slopes.append(np.array([by.get(name.removeprefix('linkage.'), 0.0)
                                            for name in self._names]))
        return self._agreed(slopes, 'it has a kink: sums of lengths tie, or one is 0')
