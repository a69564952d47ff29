# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page shows of a scene: a cycle of the mechanism, its extrema, the facts; no page yet."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil, degrees, isfinite, pi
from typing import Any

from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.points import point_motion, PointMotion
from fourbar_ros.mechanisms.quantities import is_published, positions, select
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.status import evaluate
from fourbar_ros.report.cycles import cycles, usual_points
from fourbar_ros.report.joint_labels import Labels, labels_of
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np

SAMPLES = 361           # of a cycle: one a degree of a full turn
LIMIT = 1e9             # a curve that grows beyond this many times its median leaves the chart


@dataclass(frozen=True)
class Cycle:
    """
    The mechanism over one range of its input at constant rate and acceleration.

    Parameters
    ----------
    inputs : array of shape (n,)
        Position of the input [rad] or [m], from low to high.
    motion, loads : NamedTuples of arrays of shape (n,)
        ``loads`` is None without masses.

    """

    inputs: Array
    motion: Any
    loads: Any


@dataclass(frozen=True)
class Shown:
    """
    A scene as a page shows it: in one assembly mode, at one rate and acceleration of the input.

    Parameters
    ----------
    scene : Scene
    acceleration : float
        Acceleration of the input [rad/s^2] or [m/s^2].
    speed : float, optional
        Rate of the input [rad/s] or [m/s], in place of ``drive.speed`` of the scene.

    """

    scene: Scene
    acceleration: float = 0.0
    speed: float | None = None

    @cached_property
    def linkage(self) -> Mechanism:
        """Return the mechanism, without masses where its loads do not follow from its motion."""
        found: Mechanism = self.scene.known_linkage
        return found

    @property
    def rate(self) -> float:
        """Return the rate of the input [rad/s] or [m/s]."""
        return self.scene.drive.speed if self.speed is None else self.speed

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Return the ranges of the input [rad] or [m]."""
        return self.linkage.input_ranges

    @cached_property
    def cycles(self) -> tuple[Cycle, ...]:
        """Return a :class:`Cycle` for each range of the input."""
        return tuple(Cycle(inputs, *self.linkage.motion_and_loads(
            inputs, self.rate, self.acceleration)) for inputs in cycles(self.linkage, SAMPLES))

    @cached_property
    def quantities(self) -> dict[str, Any]:
        """Return {name: quantity} of all that can be drawn over the input."""
        found = select((), self.linkage, self.scene.point_quantities)
        return ({quantity.name: quantity for quantity in found}
                | positions(self.linkage, self.linkage.input))

    @property
    def usual_quantities(self) -> list[str]:
        """Return the names drawn first: the output's rates, the drive, the shaking force."""
        coordinate = self.linkage.outputs[0].coordinate
        wanted = (coordinate.rate, coordinate.acceleration, 'driving_torque', 'driving_force',
                  'shaking_force')
        return [name for name in wanted if name in self.quantities]

    def curves(self, name: str) -> list[tuple[Array, Array]]:
        """Return (inputs, values) of a quantity for each range of the input."""
        quantity = self.quantities[name]
        return [(cycle.inputs, np.broadcast_to(quantity.of(cycle.motion, cycle.loads),
                                               cycle.inputs.shape)) for cycle in self.cycles]

    def extrema(self, names: Sequence[str]) -> list[Extremum]:
        """Return the extrema of these quantities; positions have none but at known places."""
        wanted = [self.quantities[name] for name in names]
        return find_extrema(self.linkage, [quantity.name if is_published(quantity) else quantity
                                           for quantity in wanted],
                            self.rate, self.acceleration, conditions=False) if wanted else []

    def place_of(self, extremum: Extremum) -> float:
        """Return the input of an extremum [rad] or [m], within the ranges."""
        if self.linkage.is_driven_by_slide:
            return extremum.slide
        angle = extremum.theta1
        inside = [angle + turn for turn in (0.0, -2.0 * pi, 2.0 * pi)
                  if any(low - 1e-9 <= angle + turn <= high + 1e-9 for low, high in self.ranges)]
        return inside[0] if inside else angle

    def pose(self, position: float, rate: float | None = None,
             acceleration: float | None = None) -> tuple[int, Any, Any]:
        """
        Return (status, motion, loads) at an input; loads None without masses.

        Rate and acceleration, where not given, are those of what is shown.
        """
        status, motion, loads = evaluate(
            self.linkage, position, self.rate if rate is None else rate,
            self.acceleration if acceleration is None else acceleration,
            self.linkage.bodies is not None)
        return status, motion, loads if self.linkage.bodies else None

    @cached_property
    def points(self) -> dict[str, tuple[str, float, float]]:
        """
        Return {name: (link, along, across)} of the points whose curves are drawn.

        Those of the scene, or the middle of the first link that no pivot of the ground holds.
        """
        return dict(usual_points(self.linkage, {
            name: (point.link, point.along, point.across)
            for name, point in self.scene.points.items()}))

    @cached_property
    def traces(self) -> dict[str, list[PointMotion]]:
        """Return {name: motion of the point over each range}."""
        return {name: [point_motion(self.linkage, cycle.motion, *point) for cycle in self.cycles]
                for name, point in self.points.items()}

    def samples(self, most: int) -> list[tuple[float, Any, Any]]:
        """
        Return some (input, motion, loads) over the cycles, at most about so many, where finite.

        Loads are None without masses.
        """
        found = []
        for cycle in self.cycles:
            step = max(1, ceil(len(cycle.inputs) * len(self.cycles) / most))
            for i in range(0, len(cycle.inputs), step):
                motion = _sample(cycle.motion, i)
                loads = _sample(cycle.loads, i) if self.linkage.bodies else None
                if isfinite(sum(motion) + sum(loads or ())):
                    found.append((float(cycle.inputs[i]), motion, loads))
        return found

    @cached_property
    def poses(self) -> list[tuple[Any, Any]]:
        """Return some forty (motion, loads) over the cycles, for the size of pictures."""
        return [(motion, loads) for _, motion, loads in self.samples(40)]

    @cached_property
    def labels(self) -> Labels:
        """Return what pictures call joints and forces: letters, the same in every pose."""
        return (labels_of(self.linkage.diagram(self.poses[0][0])) if self.poses
                else Labels({}, {}, {}, {}))

    def shown_input(self, position: float) -> float:
        """Return an input in the unit of the page: degrees, or m."""
        return position if self.linkage.is_driven_by_slide else degrees(position)

    @property
    def input_unit(self) -> str:
        """Return the unit of the input on the page."""
        return 'm' if self.linkage.is_driven_by_slide else 'deg'


def _sample(columns: Any, i: int) -> Any:
    """Return number i of a NamedTuple of arrays and of numbers that are the same everywhere."""
    return type(columns)(*[float(column[i] if np.ndim(column) else column) for column in columns])


def shown(values: dict[str, Any], acceleration: float = 0.0,
          speed: float | None = None) -> Shown:
    """
    Return what is shown of a flat dict of parameters.

    Raises
    ------
    InvalidParameter
        A value is impossible; the message names it and says what is allowed.

    """
    return Shown(from_values(values), acceleration, speed)
