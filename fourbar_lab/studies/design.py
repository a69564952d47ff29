# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of one design, by the search of :mod:`fourbar_ros.extrema.find`.

It covers mechanisms of any kind and every case: computation in blocks hands back doubtful designs.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite, nan, sqrt

from fourbar_lab.quadrature import MOST_OF_RANGE, nodes
from fourbar_lab.studies.measures import (
    CHANGE_POINT,
    CLASS,
    Extent,
    INPUT_RANGE,
    Measure,
    Measures,
    Searched,
    TIME_RATIO,
)
from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.scene.scene import Scene
import numpy as np

# Inputs of a mean square: doubled from, in a full turn at most to, until two results agree to this
# part.
POINTS, MOST_OF_TURN, AGREE = 128, 2**16, 1e-12


class Design:
    """One design, a scene: its measures, at the rate of its drive and an input acceleration."""

    def __init__(self, scene: Scene, acceleration: float = 0.0):
        self.scene, self.linkage = scene, scene.linkage
        self.rates = scene.drive.speed, acceleration        # of the input
        self._measures = Measures(scene)
        self.extrema: dict[str, list[Extremum]] = {}       # of each quantity searched so far

    def search(self, measures: Sequence[Measure]) -> None:
        """Find the extrema that some measures need, all in one search."""
        # the mean square over a full turn is an integral of something smooth; in a range, infinite
        # extrema at toggles tell that it diverges
        names = [self._measures.source(measure) for measure in measures
                 if measure.part != 'rms' or not self.linkage.turns_fully]
        new = [name for name in dict.fromkeys(names) if name and name not in self.extrema]
        if new:
            self.extrema |= {name: [] for name in new}
            for extremum in find_extrema(
                    self.linkage, [self._measures.quantities[name] for name in new], *self.rates,
                    conditions=False):
                self.extrema[extremum.quantity].append(extremum)

    def of(self, measure: Measure) -> float | str:
        """
        Return the value of a measure, NaN where the design has none; a class is text.

        :meth:`search` must have found its extrema.
        """
        linkage = self.linkage
        if measure.part == CLASS:
            return linkage.classification
        if measure.part == CHANGE_POINT:
            return linkage.change_point_margin
        if measure.part == INPUT_RANGE:
            return sum(high - low for low, high in linkage.input_ranges)
        if measure.part == 'rms':
            return self._rms(self._measures.quantities[measure.quantity])
        if measure.part == TIME_RATIO and not linkage.turns_fully:
            return nan
        name = self._measures.source(measure)
        most, least = self.extreme(name, 'max'), self.extreme(name, 'min')
        extent = (Extent(most.value, most.input, least.value, least.input,
                         len(self.extrema[name])) if most and least
                  else Extent(nan, nan, nan, nan, 0))
        return float(extent.of(measure.part))

    def extreme(self, name: str, part: str) -> Extremum | None:
        """Return the largest or least (max, min) extremum of a quantity that was searched."""
        choose = max if part == 'max' else min
        return choose(self.extrema[name], key=lambda extremum: extremum.value, default=None)

    def _rms(self, quantity: Searched) -> float:
        """
        Return the root mean square of a quantity over all ranges of the input.

        Points are doubled until two means agree; at the most points, the last one counts.
        """
        if any(not isfinite(extremum.value) for extremum in self.extrema.get(quantity.name, ())):
            return inf         # as one over the root of the distance, at least: not integrable
        points, mean = POINTS, nan
        while points <= (MOST_OF_TURN if self.linkage.turns_fully else MOST_OF_RANGE):
            x, weights = nodes(self.linkage, points)
            values = quantity.of(*self.linkage.motion_and_loads(x, *self.rates))
            before, mean = mean, float(np.sum(weights * np.square(values)))
            if abs(mean - before) <= AGREE * mean:
                break
            points *= 2
        return sqrt(mean)
