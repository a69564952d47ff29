# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which differences rounding explains.

Two versions of the software whose values are each within ACCURACY eps times condition of the exact
ones (docs/accuracy.md) differ by at most twice that. The condition of a value is the sum of
|p dv/dp| over all numbers p that it depends on, plus |v|.
"""
from __future__ import annotations

from collections.abc import Iterator
from math import isnan

from fourbar_ros.errors import FourBarError
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np
from numpy.typing import NDArray

ACCURACY = 5.0          # eps times condition
LIMIT = 2.0 * ACCURACY
PLAIN = 2.0             # eps of the value itself; less is not looked at closer: |v| <= condition
EPS = float(np.finfo(float).eps)
STEP = 2.0**-26         # relative; half of the digits of a difference quotient are good
GROUPS = ('linkage.', 'bodies.', 'gravity.', 'external.', 'points.')

Array = NDArray[np.float64]


class Condition:
    """
    The conditions of all values of a scene.

    Parameters
    ----------
    scene : Scene
    acting : dict
        Wrenches by link, as a :class:`~fourbar_ros.pipeline.stepper.Stepper` keeps them.

    """

    def __init__(self, scene: Scene, acting: dict[str, Wrench]):
        self._linkage = scene.linkage
        self._wanted = scene.needs_loads, 'points' in scene.outputs
        self._steppers = [Stepper(other, acting) for other in (scene, *_perturbed(scene))]

    def of(self, motions: Array) -> Array:
        """Return the conditions, shape (values, n), for motions (position, ...), shape (3, n)."""
        return np.array([self._of_one(motion) for motion in motions.T.tolist()]).T

    def _of_one(self, motion: list[float]) -> Array:
        first, *others = self._steppers
        values = self._values(first, motion)
        changed = [self._values(other, motion) for other in others]
        changed += [self._values(first, other) for other in self._moved(motion)]
        with np.errstate(invalid='ignore'):
            apart = abs(np.array(changed) - values) / STEP
        # NaN: there is no such value, or no pose beside this one; that only lowers the sum
        return np.nan_to_num(apart, posinf=0.0).sum(axis=0) + np.nan_to_num(abs(values))

    def _moved(self, motion: list[float]) -> Iterator[list[float]]:
        """Yield the motion with one of its numbers changed, an angle by its part of one turn."""
        steps = (self._linkage.distance(motion[0], 0.0), *motion[1:])
        for i, step in enumerate(steps):
            yield [*motion[:i], motion[i] + step * STEP, *motion[i + 1:]]

    def _values(self, stepper: Stepper, motion: list[float]) -> Array:
        position, rate, acceleration = motion
        return np.array(stepper.step(position, rate, acceleration, *self._wanted)[1], np.float64)


def _perturbed(scene: Scene) -> Iterator[Scene]:
    """Yield the scene with one of its numbers changed, for each that the mechanism depends on."""
    for name, value in scene.values.items():
        is_number = isinstance(value, float) and value and not isnan(value)
        if is_number and name.startswith(GROUPS) and not name.endswith('timeout'):
            try:
                yield from_values({**scene.values, name: value * (1.0 + STEP)})
            except FourBarError:        # not allowed: a body with less inertia than its mass has
                continue


def units(want: Array, have: Array, condition: Array) -> float:
    """
    Return the largest difference in eps times condition; infinite if a value is not finite.

    The arrays have one shape; where a condition is not known, 0 stands for it.
    """
    with np.errstate(invalid='ignore', divide='ignore'):
        apart = abs(want - have)
        apart[(want == have) | (np.isnan(want) & np.isnan(have))] = 0.0
        found = apart / (EPS * np.maximum(np.nan_to_num(condition), np.nan_to_num(abs(want))))
    found = np.where(apart == 0.0, 0.0, np.where(np.isnan(found), np.inf, found))
    return float(found.max(initial=0.0))


def needs_condition(want: Array, have: Array) -> NDArray[np.bool_]:
    """Return of which messages (last axis) a value differs by more than PLAIN eps of itself."""
    with np.errstate(invalid='ignore'):
        wide = abs(want - have) > PLAIN * EPS * abs(want)
    return np.asarray(wide if wide.ndim == 1 else wide.any(axis=tuple(range(wide.ndim - 1))))
