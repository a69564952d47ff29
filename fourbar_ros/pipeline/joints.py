# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The joints of a JointState: joint = ratio * coordinate + offset, in and out.

Rates and accelerations scale likewise, joint' = ratio * coordinate'. Power is the same on both
sides, so the effort of the joint is the effort of the coordinate divided by the ratio.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple, TypeVar

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.message_fields import FieldMap
from fourbar_ros.scene.scene import Group

FloatOrArray = TypeVar('FloatOrArray', float, Array)


class Scale(NamedTuple):
    """joint = ratio * coordinate + offset; ``ratio`` is not zero, ``offset`` in [rad] or [m]."""

    ratio: float
    offset: float

    def to_input(self, position: FloatOrArray, velocity: FloatOrArray,
                 acceleration: FloatOrArray) -> tuple[FloatOrArray, FloatOrArray, FloatOrArray]:
        """Return the coordinate's motion from the joint's motion [rad, s] or [m, s]; NaN stays."""
        return ((position - self.offset) / self.ratio, velocity / self.ratio,
                acceleration / self.ratio)


class SceneJoints:
    """
    The joints of a scene as a JointState shows them, one sample after the other.

    ``layout`` places angles, rates and drive among the values; ``shown`` has ratios, offsets, and
    whether the last known positions are held.
    """

    def __init__(self, layout: FieldMap, shown: Group) -> None:
        """Look up once where among the values of a sample each joint has its own."""
        place, joints = layout.place, layout.joints
        self._scales = [Scale(*pair) for pair in zip(shown.ratios, shown.offsets)]
        self._positions = [place[joint.position] for joint, _ in joints]
        self._rates = [place[joint.rate] for joint, _ in joints]
        self._efforts = [None if effort is None else place.get(effort) for _, effort in joints]
        self._holds = shown.when_unknown == 'hold'
        self._last = (nan,) * len(joints)       # positions [rad, m] of the last known pose

    def of(self, values: Sequence[float]) -> tuple[float, ...]:
        """
        Return positions, rates and efforts of all joints from the values of one sample.

        They are in the order of joint_values(). Where a position is unknown, the last known
        positions stand in if they are to be held.
        """
        scales = self._scales
        positions = tuple(s.ratio * values[i] + s.offset for s, i in zip(scales, self._positions))
        if self._holds:
            if any(map(isnan, positions)):
                positions = self._last
            else:
                self._last = positions
        return (*positions, *(s.ratio * values[i] for s, i in zip(scales, self._rates)),
                *(0.0 if i is None else values[i] / s.ratio
                  for s, i in zip(scales, self._efforts)))
