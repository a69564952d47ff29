# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of one design, by the search of :mod:`fourbar_ros.extrema.find`.

It covers mechanisms of any kind and every case: computation in blocks hands back doubtful designs.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import nan

from fourbar_lab.studies import measures as kinds
from fourbar_lab.studies.measures import Extent, Measure, Measures
from fourbar_ros.errors import OutOfRange
from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.extrema.over_input import output_ranges, OutputRange, OverInput
from fourbar_ros.scene.scene import Scene


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
        """
        Return the value of a measure, NaN where the design has none; a class is text.

        :meth:`search` must have found its extrema.
        """
        linkage, name = self.linkage, self.measures.source(measure)
        if measure.part == kinds.CLASS:
            return linkage.classification
        if measure.part == kinds.CHANGE_POINT:
            return linkage.change_point_margin
        if measure.part == kinds.INPUT_RANGE:
            low, high = self.input_range
            return high - low
        if measure.part in (kinds.SWING, kinds.STROKE):
            return self.output_range.width
        if measure.part == 'rms':
            return OverInput(linkage, self.measures.quantities[name], *self.rates,
                             extrema=self.extrema.get(name)).rms
        if measure.part == kinds.TIME_RATIO and not linkage.turns_fully:
            return nan
        most, least = self.extreme(name, 'max'), self.extreme(name, 'min')
        extent = (Extent(most.value, most.input, least.value, least.input,
                         len(self.extrema[name])) if most and least
                  else Extent(nan, nan, nan, nan, 0))
        return float(extent.of(measure.part))

    def extreme(self, name: str, part: str) -> Extremum | None:
        """Return the largest or least (max, min) extremum of a quantity that was searched."""
        choose = max if part == 'max' else min
        return choose(self.extrema[name], key=lambda extremum: extremum.value, default=None)

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
