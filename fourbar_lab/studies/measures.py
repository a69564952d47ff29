# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a study can compute of each design, by name.

A quantity that can be searched for extrema has parts behind a dot: ``shaking_force.max``.
The mechanism as a whole has measures of one name: ``swing``.
"""
from __future__ import annotations

from collections.abc import Iterable
from math import inf, pi, tau
from typing import NamedTuple, Union

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.parts import Quantity
from fourbar_ros.mechanisms.quantities import Function, known, positions
from fourbar_ros.scene.scene import Scene

Searched = Union[Quantity, Function]         # what extrema are searched of
# {part: (what it is, its unit: that of the quantity, of the input, or another)}
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
}
# What the name of a quantity alone stands for.
USUAL = ('max', 'max_at', 'min', 'min_at', 'extrema')
CLASS, CHANGE_POINT = 'class', 'change_point_margin'
INPUT_RANGE, LEAST_ANGLE = 'input_range', 'least_transmission_angle'
SWING, STROKE, TIME_RATIO = 'swing', 'stroke', 'time_ratio'
OF_MECHANISM = {
    CLASS: ('type of the mechanism: which links turn fully', ''),
    CHANGE_POINT: ('distance from a change point, relative to the sum of the lengths', ''),
    INPUT_RANGE: ('width of the input range', INPUT),
    LEAST_ANGLE: ('least angle between the lines of coupler and output over the input', 'rad'),
    SWING: ('angle that the output sweeps; 2 pi if it turns fully', 'rad'),
    STROKE: ('distance that the output slide travels', 'm'),
    TIME_RATIO: ('time of the slower stroke of the output over that of the faster one, at '
                 'constant speed of a fully turning crank; NaN where there is none', ''),
}
# Known before anything is computed of the motion.
CHEAP = (CLASS, CHANGE_POINT, INPUT_RANGE)


class Measure(NamedTuple):
    """
    A result of a study: a column.

    Parameters
    ----------
    name, unit, text : str
    quantity, part : str
        What it is of and which part; the quantity is empty for those of the mechanism.

    """

    name: str
    unit: str
    text: str
    quantity: str
    part: str


class Measures:
    """
    The measures that a scene has.

    Parameters
    ----------
    scene : Scene

    """

    def __init__(self, scene: Scene):
        linkage = scene.linkage
        self.quantities: dict[str, Searched] = {
            **known(linkage, linkage.input), **positions(linkage, linkage.input),
            **{quantity.name: quantity for quantity in scene.point_quantities}}
        self._why_no_loads = scene.why_no_loads
        self._input_unit = linkage.input_coordinate.unit
        self._output_unit = linkage.outputs[0].coordinate.unit
        self._kind = linkage.TITLE

    def named(self, entry: str, name: str) -> list[Measure]:
        """
        Return the measures that an entry of a study names, several for a quantity alone.

        Raises
        ------
        InvalidParameter
            Naming the entry and what there is.

        """
        if name in OF_MECHANISM:
            return [self._of_mechanism(entry, name)]
        quantity, _, part = name.rpartition('.')
        if name in self.quantities:
            return [self._of_quantity(entry, name, part) for part in USUAL]
        if quantity not in self.quantities:
            names = [*OF_MECHANISM, *self.quantities]
            raise InvalidParameter(entry, name, f'unknown{nearest(quantity or name, names)}')
        if part not in PARTS:
            raise InvalidParameter(entry, name, f'unknown part{nearest(part, PARTS)}')
        return [self._of_quantity(entry, quantity, part)]

    def one(self, entry: str, name: str) -> Measure:
        """Return the measure of this name; InvalidParameter if it stands for several or none."""
        found = self.named(entry, name)
        if len(found) > 1:
            raise InvalidParameter(entry, name, f'say which part of it: {name}.max or another of '
                                                f'{", ".join(PARTS)}')
        return found[0]

    def _of_mechanism(self, entry: str, name: str) -> Measure:
        text, unit = OF_MECHANISM[name]
        if name in (SWING, STROKE) and unit != self._output_unit:
            other = STROKE if name == SWING else SWING
            raise InvalidParameter(entry, name, f'the output of this {self._kind} is in '
                                                f'{self._output_unit}: ask for {other}')
        return Measure(name, self._input_unit if unit == INPUT else unit, text, '', name)

    def _of_quantity(self, entry: str, name: str, part: str) -> Measure:
        quantity, (text, unit) = self.quantities[name], PARTS[part]
        if quantity.is_load and self._why_no_loads:
            raise InvalidParameter(entry, name, f'is a load, and {self._why_no_loads}')
        unit = {QUANTITY: quantity.unit, INPUT: self._input_unit}.get(unit, unit)
        return Measure(f'{name}.{part}', unit, f'{quantity.text}: {text}', name, part)


def limits(measure: Measure) -> tuple[float, float]:
    """Return the least and the greatest value that a measure can have at all."""
    if measure.part in (SWING, INPUT_RANGE):
        return 0.0, tau if measure.unit == 'rad' else inf
    if measure.quantity == 'transmission_angle' and measure.part in ('min', 'max', 'span', 'rms'):
        return 0.0, pi
    return {LEAST_ANGLE: (0.0, 0.5 * pi), CHANGE_POINT: (0.0, 1.0), TIME_RATIO: (1.0, inf)}.get(
        measure.part, (0.0 if measure.part in (STROKE, 'peak', 'span', 'rms', 'extrema')
                       else -inf, inf))


def merged(measures: Iterable[Measure]) -> tuple[Measure, ...]:
    """Return measures without repetition, in their order."""
    return tuple(dict.fromkeys(measures))
