# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Forces between linkages in a chain: on a link from outside, and on the drive.

All components are along the ground axes; couples and torques are positive counter-clockwise.
"""
from __future__ import annotations

from collections.abc import Callable
from math import isfinite, nan
from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Applied

NAMES = ('drive wrench force_x', 'drive wrench force_y', 'drive wrench torque')


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


def constant(scene: Any, link: str) -> Wrench:
    """Return the constant wrench of the scene on a link."""
    applied = getattr(scene.linkage.external, link)
    return Wrench(applied.force_x, applied.force_y, applied.couple)


def in_silence(scene: Any, link: str, last: Wrench | None) -> Wrench:
    """Return the wrench on a link while its topic is silent; ``last``: the newest one, if any."""
    policy = scene.wrenches.when_silent
    if policy == 'unknown':
        return UNKNOWN
    return last if policy == 'hold' and last is not None else constant(scene, link)


def external(scene: Any, acting: dict[str, Wrench]) -> Any:
    """Return the External of a scene with the acting wrenches; None if one is unknown."""
    if not all(wrench.is_known for wrench in acting.values()):
        return None
    given = scene.linkage.external._asdict()
    for link, (force_x, force_y, couple) in acting.items():
        given[link] = Applied(force_x, force_y, given[link].along, given[link].across, couple)
    return scene.linkage.EXTERNAL(**given)


def drive_wrench(linkage: Any,
                 place: dict[str, int]) -> Callable[[Any], tuple[float, float, float]]:
    """
    Return the function values -> (force_x, force_y, torque) of the linkage on its drive.

    Minus the driving torque; minus the driving force along the slide, in the direction that the
    mechanism states. NaN where that is not known. ``place``: where values stand.
    """
    drive = place['driving_force' if linkage.is_driven_by_slide else 'driving_torque']

    def turn(values: Any) -> Any:
        nothing = 0.0 * abs(values[drive])               # NaN where the drive is not known
        return nothing, nothing, -values[drive]

    def push(values: Any) -> Any:
        return -values[drive], 0.0 * abs(values[drive]), 0.0 * abs(values[drive])

    if not linkage.is_driven_by_slide or linkage.SLIDE_DIRECTION is None:
        return push if linkage.is_driven_by_slide else turn
    cosine, sine = (place[name] for name in linkage.SLIDE_DIRECTION)

    def push_along(values: Any) -> Any:
        force = -values[drive]
        return force * values[cosine], force * values[sine], 0.0 * abs(force)
    return push_along
