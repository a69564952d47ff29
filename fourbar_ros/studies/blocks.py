# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of many designs at once, where all their cranks turn fully.

Which designs that is, and which of them are safe, :mod:`fourbar_ros.extrema.full_turns` decides;
the others are left to :mod:`fourbar_ros.studies.one_design`.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.batch import find_extrema_many
from fourbar_ros.extrema.full_turns import search_turns, Turns
from fourbar_ros.extrema.methods import has_fast_rates
from fourbar_ros.extrema.sampling import needs_angles
from fourbar_ros.mechanisms.points import link_motion, point_of
from fourbar_ros.mechanisms.quantities import is_position
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.studies.designs import Designs
from fourbar_ros.studies.extents import Extent, extent_of_list
from fourbar_ros.studies.measures import (
    CHANGE_POINT,
    CHEAP,
    CLASS,
    INPUT_RANGE,
    LEAST_ANGLE,
    Measure,
    Measures,
    SWING,
    TIME_RATIO,
)
from fourbar_ros.studies.study import Study
import numpy as np

# Designs that are computed together: their samples stay in the cache.
TOGETHER = 128
# Samples of a turn, and of those that these do not resolve.
SAMPLES = (96, 192, 512)
# Nearer to a change point, relative to the sum of lengths, a type is left to exact sums.
NEAR = 1e-9


class Block:
    """
    Measures of designs of one study.

    Parameters
    ----------
    study : Study
    scene : Scene
        One that can be built.
    drawn : dict
        {parameter: values, shape (n,)}.

    """

    def __init__(self, study: Study, scene: Scene, drawn: dict[str, Array]):
        self.study, self.scene, self.drawn = study, scene, drawn
        self.size = len(next(iter(drawn.values())))
        self.found: dict[str, Array] = {}
        self.is_done = np.ones(self.size, bool)
        self._fields = Measures(scene).quantities
        self._output = scene.linkage.outputs[0].coordinate.position
        self._designs = Designs(scene, study.values, drawn)
        self.is_done &= self._designs.are_allowed()

    def compute_cheap(self) -> None:
        """Compute what follows from the lengths alone."""
        margins = self._designs.margins()
        if margins is None:
            if any(measure.part in (CLASS, CHANGE_POINT) for measure in self.study.measures):
                self.is_done[:] = False
            return
        self.is_done &= (np.abs(margins) > NEAR).all(axis=0)
        self.found[CHANGE_POINT] = np.abs(margins).min(axis=0)
        if any(measure.part == CLASS for measure in self.study.measures):
            self.found[CLASS] = self._classes(margins > 0.0)

    def _classes(self, signs: Array) -> Array:
        """Return the types: they follow from the signs of the margins."""
        keys = (1 << np.arange(len(signs))) @ signs
        names = np.full(self.size, '', dtype=object)
        for key in np.unique(keys[self.is_done]).tolist():
            alike = np.nonzero((keys == key) & self.is_done)[0]
            values = {name: column[alike[0]].item() for name, column in self.drawn.items()}
            try:
                names[alike] = from_values(self.study.values | values).linkage.classification
            except InvalidParameter:
                self.is_done[alike] = False
        return names.astype(str)

    def compute(self, rows: Array) -> None:
        """Compute everything for some designs, which are done after this or not."""
        needed = self._needed()
        parts = [measure.part for measure in self.study.measures if measure.part not in
                 (CLASS, CHANGE_POINT) and not (measure.quantity and measure.part != 'rms')]
        if (has_fast_rates(self.scene.linkage, needed, self.study.acceleration) and not parts
                and not self.study.curves):
            self._compute_rates(rows)
            return
        for count in SAMPLES:
            left = []
            for start in range(0, rows.size, TOGETHER):
                part = rows[start:start + TOGETHER]
                done = self._compute(part, count, needed)
                left.append(part[~done])
            rows = np.concatenate(left) if left else rows[:0]
        self.is_done[rows] = False

    def _compute_rates(self, rows: Array) -> None:
        """Compute extrema of rates alone, of any four-bars: their own search is much faster."""
        values = {name: np.broadcast_to(self.drawn.get(name, self.study.values[name]),
                                        self.size)[rows]
                  for name in ('linkage.a1', 'linkage.a2', 'linkage.a3', 'linkage.a4',
                               'linkage.mode', 'drive.speed')}
        moving = values['drive.speed'] != 0.0
        self.is_done[rows[~moving]] = False
        rows = rows[moving]
        found = find_extrema_many(*(column[moving] for column in values.values()))
        extents = {name: extent_of_list(part.index, part.theta1, part.value, rows.size)
                   for name, part in found.items()}
        for measure in self.study.measures:
            if measure.quantity:
                extent = extents[measure.quantity]
                self._column(measure.name)[rows] = extent.of(measure.part)
                self.is_done[rows[~extent.is_there]] = False     # those that cannot be assembled

    def _needed(self) -> list[str]:
        """Return the quantities whose extrema are needed."""
        names: dict[str, None] = {}
        for measure in self.study.measures:
            if measure.quantity:
                names[measure.quantity] = None
            elif measure.part == LEAST_ANGLE:
                names['transmission_angle'] = None
            elif measure.part not in CHEAP:
                names[self._output] = None
        return list(names) or ['transmission_angle']      # that alone says what turns fully

    def _compute(self, rows: Array, count: int, needed: list[str]) -> Array:
        """Compute some designs with a number of samples; return which are done."""
        drawn = {name: column[rows] for name, column in self.drawn.items()}
        fields = self._fields
        with_angles = any(needs_angles(fields[name]) for name in needed)
        designs = Designs(self.scene, self.study.values, drawn, with_angles)
        known = fields | designs.point_quantities()
        quantities = [known[name] for name in needed]
        turns = self._turns(designs, quantities, count)
        done = ~turns.is_doubtful
        extents: dict[int, Extent] = {}
        for measure in self.study.measures:
            if measure.part in (CLASS, CHANGE_POINT):
                continue
            values, good = self._measure(measure, turns, needed, extents)
            done &= good
            self._column(measure.name)[rows[done]] = values[done]
        for curve in self.study.curves:
            for name, values in zip((f'{curve.point}.x', f'{curve.point}.y'),
                                    self._curve(designs, curve.point, curve.samples)):
                self._column(name, curve.samples)[rows[done]] = values[done]
                done &= np.isfinite(values).all(axis=1)
        return done

    def _column(self, name: str, *samples: int) -> Array:
        """Return the column of a result, NaN where it is not found yet."""
        if name not in self.found:
            self.found[name] = np.full((self.size, *samples), np.nan)
        return self.found[name]

    def _turns(self, designs: Designs, quantities: Sequence[Any], count: int) -> Turns:
        with_loads = any(quantity.is_load for quantity in quantities)
        is_angle = np.array([is_position(quantity) and quantity.unit == 'rad'
                             for quantity in quantities], bool)

        def rows(x: Array) -> Array:
            state = designs.state(x, self.study.acceleration, with_loads)
            out = np.empty((len(quantities), *x.shape), x.dtype)
            for row, quantity in zip(out, quantities):
                row[:] = quantity.of(*state)
            return out

        return search_turns(rows, designs.size, count, is_angle)

    def _measure(self, measure: Measure, turns: Turns, needed: list[str],
                 extents: dict[int, Extent]) -> tuple[Array, Array]:
        """Return the values of a measure, and which are right; ``extents``: what they share."""
        size = turns.is_doubtful.size
        good = np.ones(size, bool)
        if measure.part == INPUT_RANGE:
            return np.full(size, 2.0 * pi), good
        name = measure.quantity or ('transmission_angle' if measure.part == LEAST_ANGLE
                                    else self._output)
        which = needed.index(name)
        if which not in extents:
            extents[which] = Extent(turns.samples[which], turns.counts[which],
                                    turns.places[which], turns.values[which])
        part = extents[which]
        if measure.part == 'rms':
            return part.rms()
        if measure.quantity:
            return part.of(measure.part), good
        if measure.part == LEAST_ANGLE:
            return np.minimum(part.of('min'), pi - part.of('max')), good
        if measure.part == TIME_RATIO:
            forward = np.mod(part.of('max_at') - part.of('min_at'), 2.0 * pi)
            backward = 2.0 * pi - forward
            with np.errstate(all='ignore'):
                ratio = np.maximum(forward, backward) / np.minimum(forward, backward)
            return np.where(part.is_there, ratio, np.nan), good
        if measure.part == SWING:
            return np.where(part.is_there, part.of('span'), 2.0 * pi), good
        return part.of('span'), part.is_there

    def _curve(self, designs: Designs, point: str, samples: int) -> tuple[Array, Array]:
        """Return x and y of a point, each of shape (n, samples)."""
        x = np.broadcast_to(2.0 * pi * np.arange(samples) / samples, (designs.size, samples))
        motion, _ = designs.state(x, 0.0, False)
        link = link_motion(designs.many, motion, self.scene.points[point].link)
        place = point_of(link, *designs.point(point))[:2]
        one, other = (np.broadcast_to(part, x.shape) for part in place)
        return one, other
