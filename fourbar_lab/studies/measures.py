# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures that a study can compute, by name, and their values for a design of any kind.

A quantity that can be searched for extrema has parts behind a dot: ``shaking_force.max``.
The mechanism as a whole has measures without a dot: ``swing``.
"""
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import nan, pi
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest, OutOfRange
from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.extrema.over_input import most_extreme, output_ranges, OutputRange, OverInput
from fourbar_ros.mechanisms.quantities import by_name, Named
from fourbar_ros.numerics.arrays import Values
from fourbar_ros.scene.scene import Scene
import numpy as np

# {part: (meaning, unit: that of the quantity, of the input, or another)}
QUANTITY, INPUT = 'quantity', 'input'
PARTS = {
    'max': ('largest value over the input', QUANTITY),
    'max_at': ('input where it is', INPUT),
    'min': ('least value over the input', QUANTITY),
    'min_at': ('input where it is', INPUT),
    'peak': ('largest magnitude', QUANTITY),
    'span': ('largest less least value', QUANTITY),
    'extrema': ('number of extrema, those at ends of the input included', ''),
    'rms': ('root mean square over the input at constant rate; infinite where it grows without '
            'bound at a toggle position', QUANTITY),
    'mean': ('mean over the input at constant rate', QUANTITY),
}
# The parts that the name of a quantity alone stands for.
USUAL = ('max', 'max_at', 'min', 'min_at', 'extrema')
CLASS, CHANGE_POINT = 'class', 'change_point_margin'
INPUT_RANGE, LEAST_ANGLE = 'input_range', 'least_transmission_angle'
SWING, STROKE, TIME_RATIO, WORK = 'swing', 'stroke', 'time_ratio', 'work'
ANGLE = 'transmission_angle'
OF_MECHANISM = {
    CLASS: ('type of the mechanism: which links turn fully', ''),
    CHANGE_POINT: ('distance from a change point, relative to the sum of the lengths', ''),
    INPUT_RANGE: ('width of the range of the input; of several, of that which holds drive.start, '
                  'or else of the widest', INPUT),
    LEAST_ANGLE: ('least angle between the lines of coupler and output over the input', 'rad'),
    SWING: ('angle that the output sweeps while the input goes over this range; 2 pi if it turns '
            'fully, whether it reverses on the way or not', 'rad'),
    STROKE: ('distance that the output slide travels while the input goes over this range', 'm'),
    TIME_RATIO: ('time of the slower stroke of the output over that of the faster one, at '
                 'constant speed of a fully turning crank; NaN where there is none, and where the '
                 'output is least or greatest at several inputs', ''),
    WORK: ('work of the drive in a cycle, at constant speed of a fully turning crank; NaN where '
           'there is none', 'J'),
}
# Integrals over the input: {part or measure: attribute of :class:`.OverInput`}.
MEANS = {'rms': 'rms', 'mean': 'mean', WORK: 'of_cycle'}
# Known without the motion, from lengths and input range alone.
CHEAP = (CLASS, CHANGE_POINT, INPUT_RANGE)


@dataclass(frozen=True)
class Measure:
    """A value or text of each design, a column of results: ``shaking_force.max``, ``swing``."""

    name: str
    unit: str
    quantity: str       # '' of a measure of the mechanism
    part: str           # in PARTS, or of the mechanism in OF_MECHANISM


class Extent(NamedTuple):
    """
    The largest and the least extremum of a quantity over the input, and the inputs where they are.

    Floats of one design, or arrays of shape (n,) of many. ``extrema`` counts them; where there is
    none, as of an output that turns fully, all other fields are NaN.
    """

    max: Values
    max_at: Values
    min: Values
    min_at: Values
    extrema: Values

    def of(self, part: str) -> Values:
        """Return a part of the quantity by name, all but rms, or its least transmission angle."""
        with np.errstate(invalid='ignore', divide='ignore'):   # inf - inf where loads are infinite
            span = self.max - self.min
            parts: dict[str, Values] = {
                **self._asdict(), 'span': span,
                'peak': np.maximum(np.abs(self.max), np.abs(self.min)),
                # at a toggle rounding may put it beyond 0
                LEAST_ANGLE: np.maximum(np.minimum(self.min, pi - self.max), 0.0)}
        return parts[part]


class Measures:
    """The measures of a scene by name, and the quantity that each follows from."""

    def __init__(self, scene: Scene):
        self._linkage = linkage = scene.linkage
        self.quantities: dict[str, Named] = by_name(linkage, scene.point_quantities)
        self.output = str(linkage.outputs[0].coordinate.position)       # as theta4

    def source(self, measure: Measure) -> str:
        """Return the quantity from whose values a measure follows; '' if no motion is needed."""
        if measure.part in CHEAP:
            return ''
        of_mechanism = {LEAST_ANGLE: ANGLE, WORK: self._linkage.drive_load}
        return of_mechanism.get(measure.part, measure.quantity or self.output)

    def smooth_sources(self, measure: Measure) -> list[str]:
        """Return the quantities the least of whose results is the measure: [] without motion."""
        # The transmission angle of a machine jumps where another dyad becomes the worst.
        source = self.source(measure)
        of_dyads = [name for name in self.quantities if name.startswith(f'{ANGLE}_')]
        return of_dyads if measure.part == LEAST_ANGLE and of_dyads else [source] * bool(source)

    def named(self, entry: str, name: str) -> list[Measure]:
        """Return the measures of a name in an entry of a study, several for a quantity alone."""
        linkage = self._linkage
        input_unit, why_no_loads = linkage.input_coordinate.unit, linkage.why_no_loads
        if name in OF_MECHANISM:
            _, unit = OF_MECHANISM[name]
            output_unit = linkage.outputs[0].coordinate.unit
            if name in (SWING, STROKE) and unit != output_unit:
                raise InvalidParameter(entry, name, f'the output of this {linkage.TITLE} is in '
                                                    f'{output_unit}: ask for '
                                                    f'{STROKE if name == SWING else SWING}')
            if name == WORK and why_no_loads:
                raise InvalidParameter(entry, name, f'is of a load, and {why_no_loads}')
            return [Measure(name, input_unit if unit == INPUT else unit, '', name)]
        source, _, part = name.rpartition('.')
        source, parts = (name, USUAL) if name in self.quantities else (source, (part,))
        if source not in self.quantities:
            names = [*OF_MECHANISM, *self.quantities]
            raise InvalidParameter(entry, name, f'unknown{nearest(source or name, names)}')
        if parts != USUAL and part not in PARTS:
            raise InvalidParameter(entry, name, f'unknown part{nearest(part, PARTS)}')
        quantity = self.quantities[source]
        if quantity.is_load and why_no_loads:
            raise InvalidParameter(entry, source, f'is a load, and {why_no_loads}')
        units = {QUANTITY: quantity.unit, INPUT: input_unit, '': ''}
        return [Measure(f'{source}.{p}', units[PARTS[p][1]], source, p) for p in parts]

    def single(self, entry: str, name: str) -> Measure:
        """Return the measure of this name; InvalidParameter if it stands for several or none."""
        measures = self.named(entry, name)
        if len(measures) > 1:
            raise InvalidParameter(
                entry, name, f'say which part of it: {name}.max or another of {", ".join(PARTS)}')
        return measures[0]


class Design:
    """One design, a scene: its measures, at the rate of its drive and an input acceleration."""

    def __init__(self, scene: Scene, acceleration: float = 0.0):
        self.scene, self.linkage = scene, scene.linkage
        self.rates = scene.drive.speed, acceleration        # of the input
        self.measures = Measures(scene)
        self.extrema: dict[str, list[Extremum]] = {}       # of each quantity searched so far

    def search(self, measures: Sequence[Measure]) -> None:
        """Find the extrema that some measures need, all in one search."""
        # the mean square over a full turn is an integral of something smooth; in a range, infinite
        # extrema at toggles tell that it diverges
        names = [self.measures.source(measure) for measure in measures
                 if measure.part != 'rms' or not self.linkage.turns_fully]
        new = [name for name in dict.fromkeys(names) if name and name not in self.extrema]
        if new:
            self.extrema |= {name: [] for name in new}
            for extremum in find_extrema(
                    self.linkage, [self.measures.quantities[name] for name in new], *self.rates,
                    conditions=False):
                self.extrema[extremum.quantity].append(extremum)

    def of(self, measure: Measure) -> float | str:
        """Return a measure whose extrema were searched, NaN if there is none; a class is text."""
        linkage, name = self.linkage, self.measures.source(measure)
        if measure.part == CLASS:
            return linkage.classification
        if measure.part == CHANGE_POINT:
            return linkage.change_point_margin
        if measure.part == INPUT_RANGE:
            low, high = self.input_range
            return high - low
        if measure.part in (SWING, STROKE):
            return self.output_range.width
        if measure.part in MEANS:
            over = OverInput(linkage, self.measures.quantities[name], *self.rates,
                             extrema=self.extrema.get(name))
            return float(getattr(over, MEANS[measure.part]))
        if measure.part == TIME_RATIO:
            return self.output_range.time_ratio(linkage.period) if linkage.turns_fully else nan
        most, least = self.extreme(name, 'max'), self.extreme(name, 'min')
        extent = Extent(nan, nan, nan, nan, 0)
        if most and least:
            extent = Extent(most.value, most.input, least.value, least.input,
                            len(self.extrema[name]))
        return float(extent.of(measure.part))

    def extreme(self, name: str, part: str) -> Extremum | None:
        """Return the largest or least (max, min) extremum of a quantity that was searched."""
        return most_extreme(self.extrema[name], 1 if part == 'max' else -1)

    @property
    def input_range(self) -> tuple[float, float]:
        """Return the range of the input [rad or m] with ``drive.start``, or else the widest."""
        linkage = self.linkage
        try:
            start, _ = linkage.range_around(self.scene.drive.start)
        except OutOfRange:
            return max(linkage.input_ranges, key=lambda bounds: bounds[1] - bounds[0])
        return min(linkage.input_ranges,
                   key=lambda bounds: abs(linkage.distance(bounds[0], start)))

    @cached_property
    def output_range(self) -> OutputRange:
        """Return what the output sweeps over :attr:`input_range`."""
        known = self.extrema.get(self.measures.output)
        return next(swept for swept in output_ranges(self.linkage, extrema=known)
                    if swept.inputs == self.input_range)
