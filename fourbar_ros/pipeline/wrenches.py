# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Forces between linkages in a chain: on a link from outside, and on the drive.

All components are along the ground axes; couples and torques are positive counter-clockwise.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isfinite, nan
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Applied, External
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.scene.scene import Scene


class Wrench(NamedTuple):
    """Force [N] at the point given in the scene, and couple [N m], on a link; NaN: unknown."""

    force_x: float
    force_y: float
    couple: float

    @property
    def is_known(self) -> bool:
        """Return whether all components are finite."""
        return all(map(isfinite, self))


UNKNOWN = Wrench(nan, nan, nan)


def a_step_later(last: Wrench, before: Wrench | None) -> Wrench:
    """
    Return the wrench that is due a step after ``last``, on the line through it and the one before.

    Its error is the second difference of the wrench over a step, that of ``last`` itself the
    first. ``last`` itself where nothing finite was before.
    """
    if before is None:
        return last
    due = Wrench(*(2.0 * new - old for new, old in zip(last, before)))
    return due if due.is_known else last


def constant(scene: Scene, link: str) -> Wrench:
    """Return the constant wrench of the scene on a link."""
    applied = getattr(scene.linkage.external, link)
    return Wrench(applied.force_x, applied.force_y, applied.couple)


def in_silence(scene: Scene, link: str, last: Wrench | None) -> Wrench:
    """Return the wrench on a link while its topic is silent; ``last``: the newest one, if any."""
    policy = scene.wrenches.when_silent
    if policy == 'unknown':
        return UNKNOWN
    return last if policy == 'hold' and last is not None else constant(scene, link)


def external(scene: Scene, acting: Mapping[str, Wrench]) -> External | None:
    """Return the External of a scene with the acting wrenches; None if one is unknown."""
    if not all(wrench.is_known for wrench in acting.values()):
        return None
    given = scene.linkage.external._asdict()
    for link, (force_x, force_y, couple) in acting.items():
        given[link] = Applied(force_x, force_y, given[link].along, given[link].across, couple)
    found: External | None = scene.linkage.EXTERNAL(**given)
    return found


DriveWrench = Callable[[Sequence[float]], tuple[float, float, float]]


def drive_wrench(linkage: Mechanism, place: Mapping[str, int]) -> DriveWrench:
    """
    Return the function values -> (force_x, force_y, torque) of the linkage on its drive.

    Minus the driving torque; minus the driving force along the slide, in the direction that the
    mechanism states. NaN where that is not known. ``place``: where values stand.
    """
    drive = place['driving_force' if linkage.is_driven_by_slide else 'driving_torque']

    def turn(values: Sequence[float]) -> tuple[float, float, float]:
        nothing = 0.0 * abs(values[drive])               # NaN where the drive is not known
        return nothing, nothing, -values[drive]

    def push(values: Sequence[float]) -> tuple[float, float, float]:
        return -values[drive], 0.0 * abs(values[drive]), 0.0 * abs(values[drive])

    if not linkage.is_driven_by_slide or linkage.SLIDE_DIRECTION is None:
        return push if linkage.is_driven_by_slide else turn
    cosine, sine = (place[name] for name in linkage.SLIDE_DIRECTION)

    def push_along(values: Sequence[float]) -> tuple[float, float, float]:
        force = -values[drive]
        return force * values[cosine], force * values[sine], 0.0 * abs(force)
    return push_along
