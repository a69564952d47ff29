# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The motion of the base, as an inertial measurement unit on it shows it."""
from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import hypot, inf, isfinite, nan

from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.pipeline.rate_estimator import Estimate, NANOSECOND
from fourbar_ros.scene.base import rotation_of
from fourbar_ros.scene.message_fields import nanoseconds

UNKNOWN = Base(nan, nan, nan, nan)
LONGER = 2.5         # a message may be lost


class Imu:
    """
    Turns the specific force and the rate of an IMU at O1 into the plane of the linkage.

    The angular acceleration is the slope of the newest ``window`` rates: late by half the window.
    It is unknown after a step back of the clock, a pause longer than ``gap`` [s], or one longer
    than LONGER steps before.
    """

    def __init__(self, rotation: Sequence[float], window: int, gap: float) -> None:
        self._axes, self._gap = rotation_of(rotation), nanoseconds(gap)
        self._rates: deque[tuple[int, float]] = deque(maxlen=window)     # stamps [ns], [rad/s]
        self._step = inf                     # between the last two messages [ns]
        # specific force [m/s^2] and rate [rad/s] of the last message that are left out
        self.out_of_plane = 0.0, 0.0

    def update(self, time: int, force: Sequence[float], rate: Sequence[float]) -> Base:
        """Return the base at a stamp [ns]; its angular acceleration may be NaN."""
        along_x, along_y, across = [sum(a * b for a, b in zip(axis, force)) for axis in self._axes]
        *tilting, turning = [sum(a * b for a, b in zip(axis, rate)) for axis in self._axes]
        self.out_of_plane = abs(across), hypot(*tilting)
        if self._rates:
            passed = time - self._rates[-1][0]
            if not 0 < passed <= min(self._gap, LONGER * self._step):
                self._rates.clear()
            self._step = passed if passed > 0 else inf
        if not isfinite(turning):
            self._rates.clear()
            return UNKNOWN
        self._rates.append((time, turning))
        if len(self._rates) < 2:
            return Base(along_x, along_y, turning, nan)
        points = [((stamp - time) * NANOSECOND, value - turning) for stamp, value in self._rates]
        return Base(along_x, along_y, turning, Estimate(points, 1).slope)
