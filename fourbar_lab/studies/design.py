# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of one design, by the search of :mod:`fourbar_ros.extrema.find`.

For mechanisms of any kind, and for every case: computation in blocks hands back what is in doubt.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, isfinite, nan, pi, sqrt
from typing import Union

from fourbar_lab.studies.measures import (
    CHANGE_POINT,
    CLASS,
    INPUT_RANGE,
    LEAST_ANGLE,
    Measure,
    Measures,
    Searched,
    STROKE,
    SWING,
    TIME_RATIO,
)
from fourbar_lab.studies.study import Curve
from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.mechanisms.points import link_motion, point_of
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.quadrature import between, full_turn
from fourbar_ros.scene.scene import Scene
import numpy as np

# Inputs of the quadrature of a mean square, doubled until two results agree.
POINTS, MOST_POINTS, MOST_NODES, AGREE = 128, 2**16, 1024, 1e-12


class Design:
    """
    One design: its measures by name.

    Parameters
    ----------
    scene : Scene
    acceleration : float
        Acceleration of the input, whose rate is that of the scene's drive.

    """

    def __init__(self, scene: Scene, acceleration: float = 0.0):
        self.scene, self.linkage = scene, scene.linkage
        self.rates = scene.drive.speed, acceleration
        self._quantities = Measures(scene).quantities
        self._found: dict[str, list[Extremum]] = {}

    def search(self, measures: Sequence[Measure]) -> None:
        """Find the extrema that some measures need, all at once."""
        names = dict.fromkeys(name for measure in measures for name in self._needs(measure))
        wanted = [name for name in names if name not in self._found]
        if wanted:
            self._found |= {name: [] for name in wanted}
            for extremum in find_extrema(self.linkage, [self._quantities[n] for n in wanted],
                                         *self.rates, conditions=False):
                self._found[extremum.quantity].append(extremum)

    def _needs(self, measure: Measure) -> tuple[str, ...]:
        """Return the quantities whose extrema a measure comes from."""
        if measure.quantity:
            is_smooth = measure.part == 'rms' and self.linkage.turns_fully
            return () if is_smooth else (measure.quantity,)
        if measure.part == LEAST_ANGLE:
            return ('transmission_angle',)
        return (self.output,) if measure.part in (SWING, STROKE, TIME_RATIO) else ()

    @property
    def output(self) -> str:
        """Return the position of the output, by name."""
        return str(self.linkage.outputs[0].coordinate.position)

    def of(self, measure: Measure) -> float | str:
        """Return a measure of the mechanism, or of a quantity over a cycle, as its maximum."""
        if not measure.quantity:
            return self._of_mechanism[measure.part](self)
        if measure.part == 'rms':
            return self.rms(self._quantities[measure.quantity])
        return self._part(self._found[measure.quantity], measure.part)

    def extreme(self, name: str, part: str) -> Extremum | None:
        """Return the largest or least (max, min) extremum of a quantity that was searched."""
        choose = max if part == 'max' else min
        return choose(self._found[name], key=lambda extremum: extremum.value, default=None)

    def place_of(self, extremum: Extremum) -> float:
        """Return the input at an extremum [rad or m]."""
        return extremum.slide if self.linkage.is_driven_by_slide else extremum.theta1

    def _part(self, found: list[Extremum], part: str) -> float:
        if part == 'extrema':
            return len(found)
        if not found:
            return nan
        most, least = (choose(found, key=lambda extremum: extremum.value)
                       for choose in (max, min))
        if part in ('max_at', 'min_at'):
            return self.place_of(most if part == 'max_at' else least)
        return {'max': most.value, 'min': least.value, 'span': most.value - least.value,
                'peak': max(abs(most.value), abs(least.value))}[part]

    def _swing(self) -> float:
        found = self._found[self.output]
        return self._part(found, 'span') if found else 2.0 * pi

    def _least_angle(self) -> float:
        found = self._found['transmission_angle']
        return min(self._part(found, 'min'), pi - self._part(found, 'max'))

    def _time_ratio(self) -> float:
        found = self._found[self.output]
        if not self.linkage.turns_fully or not found:
            return nan
        one, other = (self._part(found, part) for part in ('max_at', 'min_at'))
        forward = (one - other) % (2.0 * pi)
        backward = 2.0 * pi - forward
        return max(forward, backward) / min(forward, backward) if forward else nan

    _of_mechanism: dict[str, Callable[[Design], Union[float, str]]] = {
        CLASS: lambda self: self.linkage.classification,
        CHANGE_POINT: lambda self: self.linkage.change_point_margin,
        INPUT_RANGE: lambda self: sum(high - low for low, high in self.linkage.input_ranges),
        SWING: _swing, STROKE: _swing, LEAST_ANGLE: _least_angle, TIME_RATIO: _time_ratio}

    def rms(self, quantity: Searched) -> float:
        """Return the root mean square of a quantity over the input at constant rate."""
        if any(not isfinite(extremum.value) for extremum in self._found.get(quantity.name, ())):
            return inf         # as one over the root of the distance, at least: not integrable
        parts = [(self._mean_square(quantity, low, high), high - low)
                 for low, high in self.linkage.input_ranges]
        return sqrt(sum(mean * width for mean, width in parts)
                    / sum(width for _, width in parts))

    def _mean_square(self, quantity: Searched, low: float, high: float) -> float:
        """Return the mean of the square in a range, by twice as many points until two agree."""
        points, before, is_turn = POINTS, nan, self.linkage.turns_fully
        while points <= (MOST_POINTS if is_turn else MOST_NODES):
            x, weights = nodes(low, high, points, is_turn)
            values = quantity.of(*self.linkage.motion_and_loads(x, *self.rates))
            mean = float(np.sum(weights * np.square(values)))
            if abs(mean - before) <= AGREE * mean:
                return mean
            points, before = 2 * points, mean
        return before

    def curve(self, curve: Curve) -> tuple[Array, Array]:
        """Return x and y of a point of the scene at equal steps of the input."""
        low, high = self.linkage.input_ranges[-1]
        place = np.arange(curve.samples) / curve.samples
        x = (2.0 * pi * place if self.linkage.turns_fully
             else low + (high - low) * (place + 0.5 / curve.samples))
        link, along, across = self.scene.points[curve.point]
        motion = self.linkage.motion(x, *self.rates)
        place_x, place_y = point_of(link_motion(self.linkage, motion, link), along, across)[:2]
        return np.asarray(place_x), np.asarray(place_y)


def nodes(low: float, high: float, points: int, is_turn: bool) -> tuple[Array, Array]:
    """Return inputs and weights of a mean over a range of the input."""
    return full_turn(points) if is_turn else between(low, high, points)


def is_within(value: float | str, least: float, most: float, texts: tuple[str, ...] = ()) -> bool:
    """Return whether a value fulfils a constraint; a text, whether it contains one of them."""
    if isinstance(value, str):
        return any(text in value for text in texts)
    return isfinite(value) and least <= value <= most
