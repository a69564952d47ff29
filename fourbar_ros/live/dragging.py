# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Dragging a joint of the picture: which input brings it to the pointer."""
from __future__ import annotations

from functools import cached_property
from math import pi
from typing import Any

from fourbar_ros.live.model import Shown
from fourbar_ros.live.strokes import View
from fourbar_ros.numerics.arrays import Array
import numpy as np

DRAG_SAMPLES = 181          # of the cycles are places to drag a joint to
NEAR = 40.0                 # [px] a joint is caught from so far


def range_of(shown: Shown, position: float) -> tuple[float, float]:
    """Return the range of the input in which a position lies, a little inside of its ends."""
    low, high = min(shown.ranges, key=lambda ends: max(ends[0] - position, position - ends[1]))
    margin = 0.0 if shown.linkage.turns_fully else 1e-6 * (high - low)
    return low + margin, high - margin


def nearest_input(shown: Shown, position: float) -> float:
    """Return the input in the ranges that is nearest to a position, of angles in any turn."""
    turns = (0.0,) if shown.linkage.is_driven_by_slide else (0.0, -2.0 * pi, 2.0 * pi)
    near = []
    for turn in turns:
        low, high = range_of(shown, position + turn)
        near.append(min(max(position + turn, low), high))
    return min(zip(near, turns), key=lambda pair: abs(pair[0] - position - pair[1]))[0]


class Handle:
    """A joint that was caught with the pointer, and the inputs at which it is where."""

    def __init__(self, shown: Shown, motion: Any, view: View, pixel: tuple[float, float]):
        self.shown, self.view = shown, view
        diagram = shown.linkage.diagram(motion)
        distances = {name: float(np.hypot(*np.subtract(view.at(place), pixel)))
                     for name, place in diagram.joints.items() if name not in diagram.ground}
        self.joint = min(distances, key=lambda name: distances[name]) if distances else ''
        if not distances or distances[self.joint] > NEAR:
            self.joint = ''

    @cached_property
    def _path(self) -> tuple[Array, Array]:
        """Return the inputs and the pixels of the joint at them."""
        found = [(position, self.view.at(self.shown.linkage.diagram(motion).joints[self.joint]))
                 for position, motion, _ in self.shown.samples(DRAG_SAMPLES)]
        inputs, pixels = zip(*found)
        return np.array(inputs), np.array(pixels)

    def input_at(self, pixel: tuple[float, float], now: float) -> float:
        """Return the input that brings the joint nearest to a pixel; of two, the one near now."""
        inputs, pixels = self._path
        away = np.hypot(*(pixels - pixel).T)
        turn = np.array([abs(self.shown.linkage.distance(x, now)) for x in inputs])
        span = float(np.ptp(inputs)) or 1.0
        best = int(np.argmin(away + 20.0 * turn / span))
        return float(inputs[best]) + self._between(inputs, pixels, best, pixel)

    @staticmethod
    def _between(inputs: Array, pixels: Array, best: int,
                 pixel: tuple[float, float]) -> float:
        """Return how far beyond the best sample the foot of the pixel on its path lies."""
        one, other = max(best - 1, 0), min(best + 1, len(inputs) - 1)
        way, step = pixels[other] - pixels[one], inputs[other] - inputs[one]
        square = float(way @ way)
        if square == 0.0 or abs(step) > 0.1 * float(np.ptp(inputs)):
            return 0.0
        share = float(way @ (np.asarray(pixel) - pixels[best])) / square
        return min(max(share, -0.5), 0.5) * float(step)
