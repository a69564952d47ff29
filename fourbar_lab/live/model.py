# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page shows of a scene: poses of the mechanism, its curves and extrema; no page yet."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import degrees, remainder, tau

from fourbar_lab.drawing.collineation import has_axis
from fourbar_lab.drawing.curves import Curves, curves_of, extrema_of
from fourbar_lab.drawing.cycles import cycles, usual_points
from fourbar_lab.drawing.labels import Labels, labels_of
from fourbar_lab.drawing.poses import DrawnPose
from fourbar_lab.drawing.record import counted
from fourbar_ros.errors import in_words
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.quantities import Named, of_drive, OfDrive, positions, select
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.stepper import evaluate, OK
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

SAMPLES = 361           # of a cycle: one a degree of a full turn


@dataclass(frozen=True)
class Shown:
    """
    A scene as a page shows it: in one assembly mode, at one rate and acceleration of the input.

    What is expensive is computed when it is first asked for.
    """

    scene: Scene
    acceleration: float = 0.0       # of the input [rad/s^2] or [m/s^2]

    @property
    def linkage(self) -> Mechanism:
        """Return the mechanism with all that acts on it."""
        return self.scene.linkage

    @property
    def rate(self) -> float:
        """Return the rate of the input [rad/s] or [m/s]."""
        return float(self.scene.drive.speed)

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Return the ranges of the input [rad] or [m]; full turns, until all repeats, from 0."""
        linkage = self.linkage
        return ((0.0, tau * linkage.turns),) if linkage.turns_fully else linkage.input_ranges

    def nearest_input(self, position: float) -> float:
        """
        Return the input in the ranges that is nearest to a position.

        An angle counts in any turn: with a range from -1 to 1, the input nearest to 7.0 is 0.717.
        Ends of ranges are left out, which may be toggles.
        """
        if not (self.linkage.is_driven_by_slide
                or any(low <= position <= high for low, high in self.ranges)):
            position = counted(self.linkage, position if self.linkage.turns_fully
                               else remainder(position, tau))
        low, high = min(self.ranges, key=lambda ends: max(ends[0] - position,
                                                          position - ends[1]))
        margin = 0.0 if self.linkage.turns_fully else 1e-6 * (high - low)
        return min(max(position, low + margin), high - margin)

    @cached_property
    def quantities(self) -> dict[str, Named]:
        """Return {name: quantity} of all that can be drawn over the input."""
        linkage, driven = self.linkage, self.linkage.input
        chosen = select((), linkage, self.scene.point_quantities)
        return {**{quantity.name: quantity for quantity in chosen}, **positions(linkage, driven),
                **{name: quantity for name, quantity in of_drive(linkage, driven).items()
                   if linkage.has_loads or not quantity.is_load}}

    @cached_property
    def has_axis(self) -> bool:
        """Return whether it has a collineation axis."""
        return bool(self.poses) and has_axis(self.linkage)

    @property
    def usual_quantities(self) -> list[str]:
        """Return the names drawn first: the output's rates, the drive, the shaking force."""
        coordinate = self.linkage.outputs[0].coordinate
        wanted = (coordinate.rate, coordinate.acceleration, 'driving_torque', 'driving_force',
                  'shaking_force')
        return [name for name in wanted if name in self.quantities]

    def curves(self, names: Sequence[str] = ()) -> Curves:
        """Return quantities by name over the input; no names: all."""
        return curves_of(self.scene, self.linkage, names, self.rate, self.acceleration, SAMPLES)

    def extrema(self, names: Sequence[str]) -> list[Extremum]:
        """Return the extrema of quantities by name, over the input."""
        return extrema_of(self.scene, self.linkage, names, self.rate, self.acceleration)

    @property
    def what_lacks(self) -> str:
        """Return why there are no forces, or no extrema of them; empty: there are."""
        if why := self.linkage.why_no_loads:
            return f'no forces: {why}'
        locked = self.linkage.locked_ranges(self.rate, self.acceleration)
        return ('no extrema of forces: it locks itself by friction in '
                + in_words(locked, self.linkage.input_coordinate.unit) if locked else '')

    def pose(self, position: float) -> DrawnPose:
        """Return the status, motion and loads at an input; loads None without masses."""
        has_loads = self.linkage.has_loads
        status, motion, loads = evaluate(self.linkage, position, self.rate, self.acceleration,
                                         has_loads)
        return DrawnPose(status, motion, loads if has_loads else None)

    @cached_property
    def points(self) -> dict[str, tuple[str, float, float]]:
        """
        Return {name: (link, along, across)} of the points whose curves are drawn.

        Those of the scene, or the middle of the first link that no pivot of the ground holds.
        """
        return dict(usual_points(self.linkage, self.scene.points))

    @cached_property
    def traces(self) -> list[Array]:
        """Return the path of each point over each range, shape (n, 2) [m]."""
        motions = [self.linkage.motion(inputs) for inputs in cycles(self.linkage, SAMPLES)]
        return [point_motion(self.linkage, motion, *point).place
                for point in self.points.values() for motion in motions]

    def samples(self, most: int) -> list[tuple[float, DrawnPose]]:
        """
        Return (input, pose) at evenly spread inputs, about ``most`` in a turn or in all ranges.

        Toggles, where rates and loads are infinite, are left out.
        """
        inputs = np.concatenate(cycles(self.linkage, most // len(self.ranges), True,
                                       self.linkage.turns))
        poses = [(position, self.pose(position)) for position in inputs.tolist()]
        return [(position, pose) for position, pose in poses if pose.status == OK]

    @cached_property
    def poses(self) -> list[DrawnPose]:
        """Return some forty poses over the cycles: pictures get a size that suits all of them."""
        return [pose for _, pose in self.samples(37)]

    def values(self, pose: DrawnPose) -> dict[str, tuple[float, str]]:
        """Return {name: (value, unit)} of a pose: all joints, transmission angle, all loads."""
        values, (_, motion, loads) = {}, pose
        for coordinate in self.linkage.PARTS:
            is_angle = coordinate.unit == 'rad'
            units = ('deg', 'rad/s', 'rad/s²') if is_angle else ('m', 'm/s', 'm/s²')
            factors = (degrees(1.0) if is_angle else 1.0, 1.0, 1.0)
            for name, factor, unit in zip(coordinate, factors, units):
                values[name] = factor * getattr(motion, name), unit
        values['transmission_angle'] = degrees(motion.transmission_angle), 'deg'
        if loads is not None:
            values |= {quantity.name: (quantity.of(motion, loads), written(quantity.unit))
                       for quantity in self.quantities.values()
                       if quantity.is_load and not isinstance(quantity, OfDrive)}
        return values

    @cached_property
    def labels(self) -> Labels:
        """Return the letters of joints and forces in pictures, the same in every pose."""
        return (labels_of(diagram_of(self.linkage, self.poses[0].motion)) if self.poses
                else Labels({}, {}, {}, {}))

    def shown_input(self, position: float) -> float:
        """Return an input in the unit of the page: degrees, or m."""
        return position if self.linkage.is_driven_by_slide else degrees(position)

    @property
    def bounds(self) -> tuple[float, float]:
        """Return the ends of the input in the unit of the page."""
        return self.shown_input(self.ranges[0][0]), self.shown_input(self.ranges[-1][1])

    @property
    def input_unit(self) -> str:
        """Return the unit of the input on the page."""
        return 'm' if self.linkage.is_driven_by_slide else 'deg'


def written(unit: str) -> str:
    """Return a unit as the page writes it."""
    return unit.replace('^2', '²')


def shown(values: ParameterValues, acceleration: float = 0.0) -> Shown:
    """Return the page's view of a dict of parameters; InvalidParameter if one is impossible."""
    return Shown(from_values(values), acceleration)
