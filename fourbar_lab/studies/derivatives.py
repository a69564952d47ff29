# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact derivatives of quantities, extrema and measures by parameters of a scene: lengths, masses.

Dual numbers over the trace of motion and loads give those by all parameters at once. With Q(x, p)
a quantity, x the input, p the parameters, and an extremum inside the input range at x*(p),

    (S1)  d Q(x*, p)/dp = Q_p(x*, p)         as Q_x = 0 there (envelope theorem)
    (S2)  d x*/dp = -Q_xp / Q_xx             (implicit function theorem)

where Q_xp and Q_xx come from a complex step of x through the same duals. A measure that jumps or
has no derivative (a count, a text, an infinite value, an end of the input that is a toggle
position) has NaN. Where two inputs or two dyads tie for an extremum it has a kink, and NaN for the
parameters that move them apart.
"""
from collections.abc import Sequence
from dataclasses import replace
from math import copysign, degrees, isfinite, isnan, nan, pi
from typing import Any, NamedTuple

from fourbar_lab.studies import measures as kinds
from fourbar_lab.studies.duals import derivatives_of, Dual, DUALS, value_of
from fourbar_lab.studies.measures import ANGLE, Design, Measure, Measures
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import CONSTANT, Extremum
from fourbar_ros.extrema.over_input import settled
from fourbar_ros.extrema.sampling import State
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.mechanisms.points import with_any_lengths
from fourbar_ros.mechanisms.quadrature import nodes
from fourbar_ros.mechanisms.quantities import Asked, OfDrive
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.tables import run
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.scene import parametric
from fourbar_ros.scene.parameters import find_parameter
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.settings import MACHINE
import numpy as np

INPUT = 'input'         # the input of the mechanism, as one more parameter
STEP = 2.0**-200        # of a complex step: its square is nothing beside any number
# An extremum farther than this [rad] from where the slope vanishes is not smooth: that of a
# transmission angle where another dyad becomes the one that is nearest to its toggle.
SHARP = 1e-5
# Inputs of a mean square: of a full turn, of a range. The mean is resolved if half of them give
# the same derivatives to this part of the largest.
TURN_NODES, RANGE_NODES, RESOLVED = 4096, 512, 1e-6
# Values tie if they differ by less than this part of them: a kink is nearer than any tolerance.
# Derivatives on its sides are the same if their effects, when a parameter changes by its own size,
# differ by less than this part of the largest, or of the measure.
TIE = SAME = 1e-9
FIXED = 8.0 * EPS       # by which an end of the stroke may be another input in another turn
SAMPLES = 64            # inputs at which a quantity that is constant has derivatives
LENGTHS = 'linkage.', 'dyads.', 'cylinder.'      # beginnings of the parameters that are lengths
TOGGLE = 'the input ends at a toggle position, which has no formula'
# Where values beside the end of a piece are taken; they differ by more, as a part of the largest,
# if a load jumps there.
BESIDE, JUMP = 2.0**-44, 1e-9


def differentiable(scene: Scene) -> tuple[str, ...]:
    """Return the parameters by which there are derivatives: numbers that a scene gives."""
    linkage = scene.linkage
    dimensions = [f'linkage.{name}' for name in linkage.length_names]
    if scene.kind == MACHINE:
        dimensions = ['dyads.', 'linkage.points.', *['cylinder.'] * (linkage.input == 'cylinder')]
    beginnings = (*dimensions, 'bodies.rods.', *[f'bodies.{link.name}.' for link in linkage.LINKS],
                  'gravity.', *[f'external.{link}.' for link in linkage.EXTERNAL._fields],
                  'springs.', 'torsion_springs.', 'forces.', 'points.', 'drive.speed')
    return tuple([name for name, value in scene.values.items() if name.startswith(beginnings)
                  and getattr(find_parameter(name), 'type', '') == 'double' and value == value])


class Derivatives:
    """
    Derivatives of the quantities of a scene by some of its parameters, by default all numbers.

    The input has the rate of the scene's drive and this acceleration. InvalidParameter if a name
    is no number that the scene gives.
    """

    def __init__(self, scene: Scene, names: Sequence[str] = (), acceleration: float = 0.0) -> None:
        scene.linkage.require_no_friction('an analysis of tolerances')
        known = differentiable(scene)
        for name in names:
            if name not in known:
                raise InvalidParameter(name, scene.values.get(name),
                                       'must be a number that the scene gives')
        self.scene, self.names, self.acceleration = scene, tuple(names) or known, acceleration
        self.quantities: dict[str, Asked] = {
            name: quantity for name, quantity in Measures(scene).quantities.items()
            if not isinstance(quantity, OfDrive)}
        # by these there are no derivatives, NaN: with other lengths there is another motion
        self.leaves_branch = np.array([
            scene.linkage.change_point_margin <= TIE and name.startswith(LENGTHS)
            for name in self.names])
        self._trace = Trace(self._formulas, 1, tuple([scene.values[name] for name in self.names]))

    def _formulas(self, n: NumberType, data: Sequence[Scalar]) -> Function:
        """Return input -> (fields of motion, of loads, quantities), for values of parameters."""
        linkage, values = self.scene.linkage, {**self.scene.values, **dict(zip(self.names, data))}
        constants = parametric.constants_of(self.scene, values, n)
        self.quantities |= parametric.point_quantities_of(
            self.scene, values, with_any_lengths(linkage, constants.lengths))

        def results(x: Scalar) -> tuple[Any, ...]:
            motion = linkage.motion_in(n, constants, x, values['drive.speed'], self.acceleration)
            loads = linkage.loads_in(n, constants, motion) if linkage.bodies else None
            return tuple(motion), tuple(loads or ()), [
                quantity.of(motion, loads or NoLoads()) if loads or not quantity.is_load else nan
                for quantity in self.quantities.values()]
        return results

    def _duals(self, indices: Sequence[int], x: Any) -> list[Any]:
        """Return results of the trace, by index, at inputs x: duals of parameters, or numbers."""
        # x is a dual too where derivatives by the input are asked for, see at_extremum(). Of a
        # parameter that leaves the branch, as of a change point, derivatives are NaN.
        trace = self._trace
        known = trace.numbers([Dual(self.scene.values[name], {name: 1.0}) for name in self.names])
        known[0] = x        # the input stands before the data
        steps = [i for i in trace.needed(indices) if not trace.steps[i].is_given]
        with np.errstate(all='ignore'):
            run(trace, steps, DUALS, known)
        unknown = {name: nan for name, leaves in zip(self.names, self.leaves_branch) if leaves}
        return [Dual(dual.value, {name: unknown.get(name, change)
                                  for name, change in dual.by.items()})
                if unknown and isinstance(dual, Dual) else dual
                for dual in [known[i] for i in indices]]

    def state(self, x: Array, with_loads: bool = True) -> State:
        """Return (motion, loads) at inputs x, shape (n,), whose fields are duals or numbers."""
        linkage, count = self.scene.linkage, len(self.scene.linkage.MOTION._fields)
        fields = self._duals([index for group in range(1 + with_loads)
                              for index in flat(self._trace.results[group])], x)
        return (linkage.MOTION(*fields[:count]),
                linkage.LOADS(*fields[count:]) if fields[count:] else NoLoads())

    def _quantity(self, name: str, x: Any) -> Any:
        return self._duals([flat(self._trace.results[2])[[*self.quantities].index(name)]], x)[0]

    def of(self, name: str, x: Array) -> tuple[Array, Array]:
        """Return values of a quantity at inputs x, shape (n,), and derivatives (parameters, n)."""
        dual, zero = self._quantity(name, x), np.zeros_like(x)
        slopes = derivatives_of(dual)
        return zero + value_of(dual), np.array([zero + slopes.get(parameter, 0.0)
                                                for parameter in self.names])

    def at_extremum(self, name: str, x: float) -> tuple[Array, Array]:
        """Return d Q/dp and d x*/dp inside the range, (S1) and (S2); NaN at a kink or a jump."""
        stepped = Dual(np.array([x + 1j * STEP]), {INPUT: 1.0})
        with np.errstate(all='ignore'):
            slopes = derivatives_of(self._quantity(name, stepped))
            # real parts are Q_p and Q_x, imaginary parts STEP times Q_xp and Q_xx
            *by, along = (np.ravel(slopes.get(parameter, 0.0) + 0j)[0]
                          for parameter in (*self.names, INPUT))
            # -STEP off is the way from x to the extremum: rounding, or it is not smooth
            off = along.real / along.imag if along else 0.0     # a constant quantity has no input
            if STEP * abs(off) > SHARP * self.scene.linkage.input_unit:
                off = nan
            by_parameters = np.array(by)
            return (by_parameters.real - off * by_parameters.imag,
                    -by_parameters.imag / along.imag + 0.0 * off)


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
    return [_OfMeasure(derivatives, design, measure).sensitivity() for measure in measures]


class _OfMeasure:
    """The derivatives of one measure of a design whose extrema were searched."""

    # Methods return them as *slopes*, shape (parameters,), in the order of derivatives.names.

    def __init__(self, derivatives: Derivatives, design: Design, measure: Measure) -> None:
        self._derivatives, self._design, self._measure = derivatives, design, measure
        self._source, self._value = design.measures.source(measure), design.of(measure)
        self._linkage, self._names, self._why_unknown = design.linkage, derivatives.names, ''
        # whether it follows from the inputs where extrema are, not from their values
        self._is_of_inputs = measure.part in ('max_at', 'min_at', kinds.TIME_RATIO)
        sizes = np.abs([derivatives.scene.values[name] for name in self._names])
        self._sizes = np.where(sizes > 0.0, sizes, 1.0)

    def sensitivity(self) -> Sensitivity:
        slopes = self._where_links_close()
        leaves = self._derivatives.leaves_branch
        if leaves.any() and self._measure.part != kinds.CHANGE_POINT:
            why = 'any change of a length leaves the change point, and with it the branch'
            slopes = np.where(leaves, self._unknown(why), slopes)
        return Sensitivity(self._measure, self._value, dict(zip(self._names, slopes.tolist())),
                           self._why_unknown if np.isnan(slopes).any() else '')

    def _shown(self, x: float) -> str:
        return f'{x:.6g} m' if self._linkage.is_driven_by_slide else f'{degrees(x):.6g} deg'

    def _unknown(self, why: str) -> Array:
        self._why_unknown = self._why_unknown or why
        return np.full(len(self._names), nan)

    def _where_links_close(self) -> Array:
        """Return the derivatives of the measure, as if the links closed at the same inputs."""
        part, linkage = self._measure.part, self._linkage
        # a full turn or a stroke depends on no parameter
        input_is_fixed = linkage.turns_fully or linkage.input_ranges == (linkage.stroke,)
        if isinstance(self._value, str) or part == 'extrema':
            return self._unknown('it is no number on a scale')
        if not isfinite(self._value):
            return self._unknown('it has no value' if isnan(self._value) else 'it is infinite')
        if part == kinds.CHANGE_POINT:
            return self._of_margin()
        if part in (kinds.INPUT_RANGE, *kinds.MEANS) and not input_is_fixed:
            return self._unknown(TOGGLE)
        if self._source and self._source not in self._derivatives.quantities:
            return self._unknown('it is of the drive at a rate of its own')
        if part in kinds.MEANS:
            cycle = copysign(linkage.cycle, self._design.rates[0])
            return (cycle if part == kinds.WORK else 1.0) * self._of_mean(part == 'rms')
        extrema: Sequence[Extremum] = ()
        if part in (kinds.SWING, kinds.STROKE):
            extrema = self._design.output_range.extrema
        elif part != kinds.INPUT_RANGE:
            extrema = self._design.extrema[self._source]
        if not extrema:     # the range of a fixed input, the swing of an output that turns fully
            return np.zeros_like(self._sizes)
        if part == 'peak':
            return self._of_largest([(sign * extremum.value, sign, extremum)
                                     for extremum in extrema for sign in (1.0, -1.0)])
        if part == kinds.LEAST_ANGLE:
            return -self._of_largest([
                (score, sign, of_dyad) for extremum in extrema for of_dyad in self._dyads(extremum)
                for score, sign in ((-of_dyad.value, -1.0), (of_dyad.value - pi, 1.0))])
        if part.startswith(('max', 'min')):
            return self._of_end(extrema, 1.0 if part.startswith('max') else -1.0)
        of_way = self._of_end(extrema, 1.0) - self._of_end(extrema, -1.0)
        if part != kinds.TIME_RATIO:        # a swing, a stroke, a span
            return of_way
        most, least = (self._design.extreme(self._source, end) for end in ('max', 'min'))
        assert most and least
        period = self._linkage.period
        forward = (most.input - least.input) % period
        slopes = -period / min(forward, period - forward)**2 * of_way   # of (period - short)/short
        if abs(forward - 0.5 * period) <= TIE:  # either stroke may become the slower one
            return self._agreed([slopes, -slopes], 'it has a kink: both strokes take as long')
        return slopes if forward < 0.5 * period else -slopes

    def _of_end(self, extrema: Sequence[Extremum], sign: float) -> Array:
        """Return the slopes of the largest (sign 1) or least (-1) extremum, or of its input."""
        slopes = self._of_largest([(sign * extremum.value, sign, extremum)
                                   for extremum in extrema])
        return slopes if self._is_of_inputs else sign * slopes

    def _of_largest(self, scores: Sequence[tuple[float, float, Extremum]]) -> Array:
        """Return the slopes of the largest score (score, sign, extremum), or of its input."""
        largest = max(score for score, *_ in scores)
        if not isfinite(largest):
            return self._unknown('it is infinite')
        tied = [(sign, extremum) for score, sign, extremum in scores
                if largest - score <= TIE * abs(largest)]
        first_two = ' and '.join(f'{extremum.quantity} at {self._shown(extremum.input)}'
                                 for _, extremum in tied[:2])
        why = f'it has a kink: {len(tied)} extrema tie, as {first_two}'
        slopes = [self._of_extremum(extremum) for _, extremum in tied]
        if not self._is_of_inputs:
            return self._agreed([sign * of_value for (sign, _), of_value in zip(tied, slopes)],
                                why)
        # which of several inputs counts is a choice of rounding
        return slopes[0] if len(tied) == 1 else self._unknown(why)

    def _agreed(self, sides: Sequence[Array], why: str, scale: float | None = None) -> Array:
        """
        Return the slopes beside a kink, NaN by parameters for which its sides differ, and why.

        ``scale``: of what they are derivatives; by default the size of the measure.
        """
        effects = self._effects(sides)
        scale = abs(float(self._value)) if scale is None else scale
        is_same = np.ptp(effects, axis=0) <= SAME * np.max(np.abs(effects), initial=scale)
        return sides[0] if is_same.all() else np.where(is_same, sides[0], self._unknown(why))

    def _effects(self, slopes: Sequence[Array]) -> Array:
        """Return what changes by their own sizes do; nothing of those that leave the branch."""
        return np.where(self._derivatives.leaves_branch, 0.0, np.asarray(slopes) * self._sizes)

    def _of_extremum(self, extremum: Extremum) -> Array:
        """Return the slopes of an extremum, or of its input, that all dyads that tie share."""
        dyads = self._dyads(extremum)
        why = f'it has a kink: {" and ".join(dyad.quantity for dyad in dyads)} tie'
        if np.ptp([dyad.value for dyad in dyads]) > TIE:
            return self._unknown(why)       # mu and pi - mu: it jumps
        return self._agreed([self._of_dyad(dyad) for dyad in dyads], why,
                            self._linkage.input_unit if self._is_of_inputs else None)

    def _of_dyad(self, extremum: Extremum) -> Array:
        name, x = extremum.quantity, extremum.input
        if extremum.kind == CONSTANT:
            _, slopes = self._derivatives.of(name, nodes(self._linkage, SAMPLES)[0])
            why = 'it is constant over the input, and any change makes extrema'
            of_input = self._unknown(why)           # the reason for values that differ too
            return of_input if self._is_of_inputs else self._agreed([*slopes.T], why)
        if not extremum.side:
            of_value, of_input = self._derivatives.at_extremum(name, x)
            if np.isnan(of_value[~self._derivatives.leaves_branch]).any():
                self._unknown(f'it has a kink or a jump at the input {self._shown(x)}')
            return of_input if self._is_of_inputs else of_value
        if any(abs(self._linkage.distance(x, end)) <= FIXED * max(abs(x), abs(end))
               for end in self._linkage.stroke or ()):      # an end that stays where it is
            _, slopes = self._derivatives.of(name, np.array([x]))
            return np.zeros_like(self._sizes) if self._is_of_inputs else slopes[:, 0]
        ends = self._linkage.pieces.ends if self._linkage.pieces else ()
        is_jump = any(abs(self._linkage.distance(x, end)) <= JUMP for end in ends)
        return self._unknown(f'it jumps at the input {self._shown(x)}' if is_jump else TOGGLE)

    def _angles(self, x: Array) -> tuple[tuple[str, ...], Array, Array]:
        """Return the transmission angles of all dyads at inputs x, (dyads, n), and which count."""
        names = tuple([name for name in self._linkage.MOTION._fields
                       if name.startswith(f'{ANGLE}_')]) or (ANGLE,)    # of a kind with one dyad
        angles = np.array(self._linkage.motion(x, fields=names))
        sines = np.abs(np.sin(angles))          # least next to a toggle: all that tie count
        return names, angles, sines - sines.min(axis=0) <= TIE

    def _dyads(self, extremum: Extremum) -> list[Extremum]:
        if extremum.quantity != ANGLE:
            return [extremum]
        tied = [extremum._replace(quantity=name, value=float(angle)) for name, (angle,), (counts,)
                in zip(*self._angles(np.array([extremum.input]))) if counts]
        return tied or [extremum]           # at a toggle there is no motion

    def _of_mean(self, is_of_squares: bool) -> Array:
        """Return d mean(Q) = mean(Q_p), or d sqrt(mean Q^2) = mean(Q Q_p) / sqrt(mean Q^2)."""
        name = self._source
        if self._linkage.pieces and self._derivatives.quantities[name].is_load:
            # an end that moves brings what the load jumps there
            ends = np.array(self._linkage.pieces.ends)
            tiny = BESIDE * np.maximum(np.abs(ends), 1.0)
            before, after = (self._derivatives.of(name, ends + side * tiny)[0]
                             for side in (-1.0, 1.0))
            jumps = np.abs(after - before) > JUMP * np.max(np.abs(before), initial=0.0)
            if jumps.any():
                return self._unknown(f'it jumps at the input {self._shown(ends[jumps][0])}')
        most, results = TURN_NODES if self._linkage.turns_fully else RANGE_NODES, []
        for points in (most, most // 2):
            x, weights = nodes(self._linkage, points)
            if name == ANGLE:       # of a machine the least angle of its dyads, which may change
                _, _, counts = self._angles(x)
                if (counts != counts[:, :1]).any() or counts[:, 0].sum() > 1:
                    return self._unknown('it jumps where another dyad is nearest to its toggle')
            values, slopes = self._derivatives.of(name, x)
            if (self._derivatives.quantities[name].unit == 'rad'
                    and np.abs(np.diff(values)).max() > pi):
                return self._unknown('the angle wraps')
            size = float(np.sqrt(np.sum(weights * values * values))) if is_of_squares else 1.0
            if size == 0.0:       # it grows whichever way a parameter goes: no derivative
                return np.where(slopes.any(axis=1), self._unknown('it is 0 at every input'), 0.0)
            if is_of_squares:       # a force of size 0 has no slope, and the product is 0
                slopes = np.where(values == 0.0, 0.0, values * slopes)
            mean, mean_size = [(weights * each).sum(axis=1) for each in (slopes, np.abs(slopes))]
            results.append(np.divide(settled(mean, mean_size), size))
        # how much the parameters move the result by both, which must agree
        effects = self._effects(results)
        if not np.ptp(effects, axis=0).max() <= RESOLVED * np.abs(effects).max():
            return self._unknown(f'{most} inputs do not resolve it')
        return np.asarray(results[0])

    def _of_margin(self) -> Array:
        """Return the derivatives of the distance from a change point."""
        # That is the least |sum of lengths with signs| over the sum of all lengths. A length that
        # is negative, as an offset may be, counts with its size.
        signs, lengths = parametric.margin_signs(self._linkage), np.array(self._linkage.lengths)
        if signs is None:
            return self._unknown('it has no formula in the lengths')
        total, sums = np.abs(lengths).sum(), signs @ np.abs(lengths)
        tied = np.abs(sums) - np.abs(sums).min() <= TIE * total
        sides = []      # of a kink: of a length that is 0, of a sum that is 0, of sums that tie
        for sign, margin in zip(signs[tied], sums[tied] / total):
            for of_sum in (1.0, -1.0) if abs(margin) <= TIE else (np.sign(margin),):
                for of_sizes in (np.where(lengths < 0.0, -1, 1), np.where(lengths > 0.0, 1, -1)):
                    by = dict(zip(self._linkage.length_names,
                                  of_sizes * (of_sum * sign - abs(margin)) / total))
                    sides.append(np.array([by.get(name.removeprefix('linkage.'), 0.0)
                                           for name in self._names]))
        return self._agreed(sides, 'it has a kink: sums of lengths tie, or one is 0')
