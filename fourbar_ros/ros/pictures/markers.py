# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Markers of one pose: what the diagram of the mechanism shows, with forces and moments to scale.

The longest force since the scene was applied is an arrow of 0.4 times the mechanism, and so is the
largest moment, along z, which is the axis it turns about.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, isnan
from typing import Any

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Diagram
from fourbar_ros.mechanisms.points import LinkMotion, point_of
from fourbar_ros.ros.messages import Stamp
from fourbar_ros.ros.pictures import shapes
from fourbar_ros.scene.scene import Scene
from visualization_msgs.msg import Marker, MarkerArray

LONGEST = 0.4          # of the longest arrow, over the size of the mechanism
WIDTH = 0.02           # of a link, over that size


def size_of(mechanism: Mechanism) -> float:
    """Return the size of a mechanism [m]."""
    return max(map(abs, mechanism.lengths))


def maker(scene: Scene) -> Callable[[Stamp, Sequence[float]], MarkerArray | None]:
    """Return the function (stamp, values) -> MarkerArray, None where the pose is not known."""
    mechanism = scene.linkage
    count = len(mechanism.MOTION._fields)
    loads_end = count + len(mechanism.LOADS._fields)
    scales = Scales(LONGEST * size_of(mechanism))

    def make(stamp: Stamp, values: Sequence[float]) -> MarkerArray | None:
        motion = mechanism.MOTION(*values[:count])
        if isnan(motion.transmission_angle):
            return None
        diagram = mechanism.diagram(motion)
        made = pose(scene, motion, diagram)
        loads = mechanism.LOADS(*values[count:loads_end])
        if mechanism.bodies is not None:
            made += arrows(scene, loads, diagram, scales)
        for one in made:
            one.header.stamp.sec, one.header.stamp.nanosec = stamp
        return MarkerArray(markers=made)
    return make


def pose(scene: Scene, motion: Any, diagram: Diagram) -> list[Marker]:
    """Return the markers of links, joints, blocks and points."""
    mechanism, frame = scene.linkage, scene.frame_id
    width = WIDTH * size_of(mechanism)
    made = [shapes.lines(frame, 'links', i, [bar[:2]], width * bar.width, shapes.LINK)
            for i, bar in enumerate(diagram.bars)]
    made.append(shapes.spheres(frame, 'joints', 0, diagram.joints.values(), 1.8 * width,
                               shapes.JOINT))
    made += [shapes.box(frame, 'blocks', i, block.place, atan2(*block.direction[::-1]),
                        (5.0 * width, 3.0 * width, 2.0 * width), shapes.BLOCK)
             for i, block in enumerate(diagram.blocks)]
    if scene.points:
        arms = [_arm(mechanism.link_motion(motion, link), along, across)
                for link, along, across in scene.points.values()]
        made += [shapes.lines(frame, 'arms', 0, arms, 0.5 * width, shapes.LINK, 0.6),
                 shapes.spheres(frame, 'points', 0, [end for _, end in arms], 2.0 * width,
                                shapes.POINT)]
    return made


def _arm(link: LinkMotion, along: float, across: float) -> tuple[shapes.Place, shapes.Place]:
    """Return the first joint of a link and a point on it."""
    return (link.x, link.y), point_of(link, along, across)[:2]


class Scales:
    """Lengths of arrows: the largest force and moment so far are ``longest`` [m]."""

    def __init__(self, longest: float) -> None:
        self._longest, self._force, self._moment = longest, 0.0, 0.0

    def force(self, largest: float) -> float:
        """Return the length of a newton [m/N], now that forces are as large as this."""
        self._force = max(self._force, largest)
        return self._longest / self._force if self._force else 0.0

    def moment(self, largest: float) -> float:
        """Return the length of a newton metre [m/(N m)]."""
        self._moment = max(self._moment, largest)
        return self._longest / self._moment if self._moment else 0.0


def arrows(scene: Scene, loads: Any, diagram: Diagram, scales: Scales) -> list[Marker]:
    """Return the arrows of the forces at the joints, shaking force, shaking moment and drive."""
    frame, width = scene.frame_id, 0.6 * WIDTH * size_of(scene.linkage)
    forces = [(f'force {name}', diagram.joints[at],
               *(getattr(loads, f'{name}_{axis}') for axis in 'xy'))
              for name, at in diagram.forces.items()]
    forces.append(('shaking force', (0.0, 0.0), loads.shaking_force_x, loads.shaking_force_y))
    moments = [('shaking moment', loads.shaking_moment),
               ('driving torque', getattr(loads, 'driving_torque', 0.0))]
    if any(isnan(value) for _, _, *force in forces for value in force):
        return []
    per_force = scales.force(max((f_x * f_x + f_y * f_y)**0.5 for _, _, f_x, f_y in forces))
    per_moment = scales.moment(max(abs(value) for _, value in moments))
    made = [shapes.arrow(frame, name, 0, at,
                         (at[0] + per_force * f_x, at[1] + per_force * f_y), width, shapes.FORCE)
            for name, at, f_x, f_y in forces]
    return made + [shapes.arrow(frame, name, 0, (0.0, 0.0), (0.0, 0.0, per_moment * value), width,
                                shapes.MOMENT) for name, value in moments]
