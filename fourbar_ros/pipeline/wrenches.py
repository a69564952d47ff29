# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What acts from outside, as topics say: wrenches on links, the base; and the force on the drive.

All components are along the ground axes; couples and torques are positive counter-clockwise.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isfinite, nan
from typing import Any, cast, NamedTuple, Union

from fourbar_ros.mechanics.bodies import Applied, Base, External
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import BASE


class Wrench(NamedTuple):
    """Force [N] at the point given in the scene, and couple [N m], on a link; NaN: unknown."""

    force_x: float
    force_y: float
    couple: float


UNKNOWN = Wrench(nan, nan, nan)
ActingInput = Union[Wrench, Base]      # on a link, or the motion of the base


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
    if link == BASE.name:
        return last if scene.base.when_silent == 'hold' and last else Base(nan, nan, nan, nan)
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
