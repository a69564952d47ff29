# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
RViz markers of one pose: links, joints, points, and forces and moments to scale.

The largest force since the scene was applied is an arrow of 0.4 times the mechanism, and so is the
largest moment, which points along z, its axis.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import atan2, cos, isnan, sin
from typing import Union

from fourbar_ros.mechanisms import picture as pictures
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.ros.messages import Stamp
from fourbar_ros.scene.scene import Scene
from geometry_msgs.msg import Point
import numpy as np
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

LONGEST = 0.4          # length of the longest arrow over the size of the mechanism
WIDTH = 0.02           # width of a link over that size
Colour = tuple[float, float, float]
MarkerPoint = Union[Sequence[float], Array]       # x, y, or x, y, z [m]

LINK, JOINT, BLOCK = (0.20, 0.45, 0.70), (0.15, 0.15, 0.15), (0.45, 0.45, 0.45)
FORCE, MOMENT, POINT = (0.10, 0.55, 0.20), (0.75, 0.35, 0.05), (0.55, 0.30, 0.00)
TOGGLE, EXTREMUM = (0.80, 0.10, 0.10), (0.45, 0.15, 0.60)


def size_of(mechanism: Mechanism) -> float:
    """Return the size of a mechanism [m]: its longest length."""
    return max(map(abs, mechanism.lengths))


def maker(scene: Scene) -> Callable[[Stamp, Sequence[float]], MarkerArray | None]:
    """Return the function (stamp, values) -> MarkerArray, None where the pose is not known."""
    mechanism, groups = scene.linkage, scene.layout.groups
    largest: dict[str, float] = {}                       # force and moment so far

    def make(stamp: Stamp, values: Sequence[float]) -> MarkerArray | None:
        motion = mechanism.MOTION(*values[groups['motion']])
        if isnan(motion.transmission_angle):
            return None
        markers = pose(scene, motion)
        if mechanism.bodies is not None:
            loads = mechanism.LOADS(*values[groups['loads']])
            markers += arrows(scene, loads, pictures.diagram_of(mechanism, motion), largest)
        for each in markers:
            each.header.stamp.sec, each.header.stamp.nanosec = stamp
        return MarkerArray(markers=markers)
    return make


def pose(scene: Scene, motion: NamedFields) -> list[Marker]:
    """Return the markers of links, joints, blocks and points in a pose, a record of MOTION."""
    frame, width = scene.frame_id, WIDTH * size_of(scene.linkage)
    shapes = pictures.picture(scene.linkage, motion, scene.points)
    markers = [lines(frame, 'links', i, [bar[:2]], width * bar.width, LINK)
               for i, bar in enumerate(pictures.of_kind(pictures.Bar, shapes))]
    joints = [joint.point for joint in pictures.of_kind(pictures.NamedJoint, shapes)]
    markers.append(spheres(frame, 'joints', 0, joints, 1.8 * width, JOINT))
    for i, block in enumerate(pictures.of_kind(pictures.Block, shapes)):
        box = marker(frame, 'blocks', i, Marker.CUBE, BLOCK,
                     (5.0 * width, 3.0 * width, 2.0 * width))
        box.pose.position, half = point(*block.point), 0.5 * atan2(*block.direction[::-1])
        box.pose.orientation.z, box.pose.orientation.w = sin(half), cos(half)
        markers.append(box)
    if arms := pictures.of_kind(pictures.Arm, shapes):
        markers += [lines(frame, 'arms', 0, [(arm.start, arm.end) for arm in arms], 0.5 * width,
                          LINK, 0.6),
                    spheres(frame, 'points', 0, [arm.end for arm in arms], 2.0 * width, POINT)]
    return markers


def scale_of(largest: dict[str, float], kind: str, sizes: Iterable[float], longest: float
             ) -> float:
    """Return the scale at which the largest so far, kept, is ``longest`` [m]; 0 for zeros."""
    largest[kind] = max(largest.get(kind, 0.0), *sizes)
    return longest / largest[kind] if largest[kind] != 0.0 else 0.0


def arrows(scene: Scene, loads: NamedFields, diagram: pictures.Diagram, largest: dict[str, float]
           ) -> list[Marker]:
    """Return the arrows of forces and moments; none at a toggle, where loads are NaN."""
    frame, size = scene.frame_id, size_of(scene.linkage)
    forces = [*(force._replace(name=f'force {force.name}')
                for force in pictures.forces_of(diagram, loads)),
              pictures.Force('shaking force', '', pictures.ORIGIN,
                             np.array([loads.shaking_force_x, loads.shaking_force_y]))]
    moments = [('shaking moment', loads.shaking_moment),
               ('driving torque', getattr(loads, 'driving_torque', 0.0))]
    if any(np.isnan(force.vector).any() for force in forces):
        return []
    longest, width = LONGEST * size, 0.6 * WIDTH * size
    per_force = scale_of(largest, 'force', (force.size for force in forces), longest)
    per_moment = scale_of(largest, 'moment', (abs(value) for _, value in moments), longest)
    scale = width, 2.0 * width, 3.0 * width          # of the shaft, of the head, its length
    markers = [marker(frame, force.name, 0, Marker.ARROW, FORCE, scale,
                      [force.point, force.point + per_force * force.vector]) for force in forces]
    return markers + [marker(frame, name, 0, Marker.ARROW, MOMENT, scale,
                             [(0.0, 0.0), (0.0, 0.0, per_moment * value)])
                      for name, value in moments]


def marker(frame: str, group: str, index: int, kind: int, colour: Colour, scale: Iterable[float],
           points: Iterable[MarkerPoint] = (), opacity: float = 1.0) -> Marker:
    """Return a marker of a kind (``Marker.LINE_LIST``, say) through points, ``scale`` in [m]."""
    result = Marker(ns=group, id=index, type=kind, action=Marker.ADD,
                    color=ColorRGBA(r=colour[0], g=colour[1], b=colour[2], a=opacity))
    result.header.frame_id = frame
    result.scale.x, result.scale.y, result.scale.z = map(float, scale)
    result.pose.orientation.w = 1.0
    result.points = [point(*coordinates) for coordinates in points]
    return result


def lines(frame: str, group: str, index: int, pairs: Iterable[Iterable[MarkerPoint]],
          width: float, colour: Colour, opacity: float = 1.0) -> Marker:
    return marker(frame, group, index, Marker.LINE_LIST, colour, (width, 0.0, 0.0),
                  [end for pair in pairs for end in pair], opacity)


def spheres(frame: str, group: str, index: int, points: Iterable[MarkerPoint], size: float,
            colour: Colour) -> Marker:
    return marker(frame, group, index, Marker.SPHERE_LIST, colour, (size, size, size), points)


def point(x: float, y: float, z: float = 0.0) -> Point:
    return Point(x=float(x), y=float(y), z=float(z))
