# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What acts from outside, as topics say: wrenches on links, the base; and the force on the drive.

All components are along the ground axes; couples and torques are positive counter-clockwise. The
motion of the base is as an inertial measurement unit on it shows it.
"""
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from math import hypot, inf, isfinite, nan
from typing import Any, cast, NamedTuple

from fourbar_ros.mechanics.bodies import Applied, Base, External, UNKNOWN_BASE
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.pipeline.rate_estimator import Estimate, NANOSECOND
from fourbar_ros.scene import base, message_fields, topics
from fourbar_ros.scene.scene import Scene


class Wrench(NamedTuple):
    """Force [N] at the point given in the scene, and couple [N m], on a link; NaN: unknown."""

    force_x: float
    force_y: float
    couple: float


UNKNOWN = Wrench(nan, nan, nan)
LONGER = 2.5         # steps between two messages of an IMU: one may be lost
ActingInput = Wrench | Base      # on a link, or the motion of the base


def acting_of(message: Any) -> ActingInput:
    """Return what acts by a message: of type Base a motion of the base, else a wrench."""
    if hasattr(message, 'rate'):
        return Base(message.force_x, message.force_y, message.rate, message.acceleration)
    force, torque = message.wrench.force, message.wrench.torque
    return Wrench(force.x, force.y, torque.z)


def a_step_later(last: Wrench, before: Wrench | None) -> Wrench:
    """
    Return the wrench a step after ``last``, extrapolated linearly from it and the one before.

    In a chain of nodes a reaction arrives one step late. After 1 N and 3 N it gives 5 N. Its error
    is the second difference of the wrench over a step; the error of ``last`` itself is the first.
    Returns ``last`` if there is none before, or if either is unknown.
    """
    if before is None:
        return last
    due = Wrench(*(2.0 * new - old for new, old in zip(last, before)))
    return due if all(map(isfinite, due)) else last


def constant(scene: Scene, link: str) -> Wrench:
    """Return the wrench on a link by external.LINK.force_x, .force_y, .couple of the scene."""
    applied = getattr(scene.linkage.external, link)
    return Wrench(applied.force_x, applied.force_y, applied.couple)


def in_silence(scene: Scene, link: str, last: ActingInput | None) -> ActingInput:
    """Return what acts on a link, or as base, in a silence, by the scene; ``last``: the newest."""
    if link == topics.BASE.name:
        return last if scene.base.when_silent == 'hold' and last else UNKNOWN_BASE
    policy = scene.wrenches.when_silent
    if policy == 'unknown':
        return UNKNOWN
    return last if policy == 'hold' and last is not None else constant(scene, link)


def loaded(linkage: Mechanism, scene: Scene, acting: Mapping[str, ActingInput]
           ) -> Mechanism | None:
    """
    Return a linkage with what acts on it, {link: Wrench, 'base': Base}; None if any is unknown.

    Wrenches act at the points that the scene gives, instead of its constant forces.
    """
    if not all(isfinite(value) for each in acting.values() for value in each):
        return None
    applied = scene.linkage.external._asdict()
    for name, each in acting.items():
        if isinstance(each, Base):
            linkage = linkage.with_base(each)
        else:
            point = applied[name]
            applied[name] = Applied(each.force_x, each.force_y, along=point.along,
                                    across=point.across, couple=each.couple)
    return linkage.with_external(cast(External, scene.linkage.EXTERNAL(**applied)))


DriveWrench = Callable[[Sequence[float]], tuple[float, float, float]]


def drive_wrench(linkage: Mechanism, index_of: Mapping[str, int]) -> DriveWrench:
    """
    Return the function values -> (force_x, force_y, torque) of the linkage on its drive.

    They are minus the driving torque [N m], or minus the driving force [N] in the direction of the
    slide. That is x unless the mechanism names values for its cosine and sine. All are NaN where
    the drive is not known. ``index_of``: {name: index in values}.
    """
    is_slide = linkage.is_driven_by_slide
    drive = index_of['driving_force' if is_slide else 'driving_torque']
    direction = linkage.SLIDE_DIRECTION if is_slide else None
    axes = [index_of[name] for name in direction or ()]        # none: along x

    def wrench(values: Sequence[float]) -> tuple[float, float, float]:
        load = -values[drive]
        zero = 0.0 * abs(load)                  # NaN where the drive is not known
        if not is_slide:
            return zero, zero, load
        if not axes:
            return load, zero, zero
        return load * values[axes[0]], load * values[axes[1]], zero
    return wrench


class Imu:
    """
    Turns the specific force and the rate of an IMU at O1 into the plane of the linkage.

    The angular acceleration is the slope of the newest ``window`` rates: late by half the window.
    It is unknown after a step back of the clock, a pause longer than ``gap`` [s], or one longer
    than LONGER steps before.
    """

    def __init__(self, rotation: Sequence[float], window: int, gap: float) -> None:
        self._axes, self._gap = base.rotation_of(rotation), message_fields.nanoseconds(gap)
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
            return UNKNOWN_BASE
        self._rates.append((time, turning))
        if len(self._rates) < 2:
            return Base(along_x, along_y, turning, nan)
        points = [((stamp - time) * NANOSECOND, value - turning) for stamp, value in self._rates]
        return Base(along_x, along_y, turning, Estimate(points, 1).slope)
