# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
RViz markers: of each pose, with forces and moments to scale, and traces, which do not move.

The largest force since the scene was applied is an arrow of 0.4 times the mechanism, and so is the
largest moment, which points along z, its axis. Traces are paths of points; toggles and dead points
as pale poses; and extrema of the output's rate and acceleration, at the scene's speed: dots at the
first moving joint with labels beside the mechanism.
"""
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import atan2, cos, inf, isnan, sin

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms import picture as pictures
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.points import point_motion
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
MarkerPoint = Sequence[float] | Array       # x, y, or x, y, z [m]

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
    old = [clearing(scene)]                              # of the scene before: once

    def make(stamp: Stamp, values: Sequence[float]) -> MarkerArray | None:
        motion = mechanism.MOTION(*values[groups['motion']])
        if isnan(motion.transmission_angle):
            return None
        markers = [*old, *pose(scene, motion)]
        old.clear()
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
    diagram = pictures.diagram_of(scene.linkage, motion)
    markers = [lines(frame, 'links', i, [bar[:2]], width * bar.width, LINK)
               for i, bar in enumerate(diagram.bars)]
    joints = [*diagram.joints.values()]
    markers.append(spheres(frame, 'joints', 0, joints, 1.8 * width, JOINT))
    for i, block in enumerate(diagram.blocks):
        box = marker(frame, 'blocks', i, Marker.CUBE, BLOCK,
                     (5.0 * width, 3.0 * width, 2.0 * width))
        box.pose.position = point(*diagram.joints[block.joint])
        half = 0.5 * atan2(*block.direction[::-1])
        box.pose.orientation.z, box.pose.orientation.w = sin(half), cos(half)
        markers.append(box)
    if arms := pictures.arms_of(scene.linkage, motion, scene.points):
        markers += [lines(frame, 'arms', 0, [(arm.start, arm.end) for arm in arms], 0.5 * width,
                          LINK, 0.6),
                    spheres(frame, 'points', 0, [arm.end for arm in arms], 2.0 * width, POINT)]
    return markers


def arrows(scene: Scene, loads: NamedFields, diagram: pictures.Diagram, largest: dict[str, float]
           ) -> list[Marker]:
    """
    Return the arrows of forces and moments; at a toggle, where loads are NaN, those before go.

    ``largest``: of 'force' [N] and 'moment' [N m] so far, kept here: its arrow is the longest.
    """
    def scale_of(kind: str, sizes: Iterable[float]) -> float:
        """Return the length of an arrow [m] for 1 N or 1 N m; 0.0 while all were zero."""
        largest[kind] = max(largest.get(kind, 0.0), *sizes)
        return LONGEST * size / largest[kind] if largest[kind] != 0.0 else 0.0

    frame, size = scene.frame_id, size_of(scene.linkage)
    forces = [*(force._replace(name=f'force {force.name}')
                for force in pictures.forces_of(diagram, loads)),
              pictures.Force('shaking force', '', pictures.ORIGIN,
                             np.array([loads.shaking_force_x, loads.shaking_force_y]))]
    moments = [('shaking moment', loads.shaking_moment),
               ('driving torque', getattr(loads, 'driving_torque', 0.0))]
    if any(np.isnan(force.vector).any() for force in forces):
        names = [force.name for force in forces] + [name for name, _ in moments]
        return [Marker(ns=name, action=Marker.DELETE) for name in names]
    width = 0.6 * WIDTH * size
    per_force = scale_of('force', (force.size for force in forces))
    per_moment = scale_of('moment', (abs(value) for _, value in moments))
    scale = width, 2.0 * width, 3.0 * width          # of the shaft, of the head, its length
    markers = [marker(frame, force.name, 0, Marker.ARROW, FORCE, scale,
                      [force.point, force.point + per_force * force.vector]) for force in forces]
    return markers + [marker(frame, name, 0, Marker.ARROW, MOMENT, scale,
                             [(0.0, 0.0), (0.0, 0.0, per_moment * value)])
                      for name, value in moments]


def clearing(scene: Scene) -> Marker:
    """Return what takes away all markers before it: programs keep those that no message moves."""
    result = Marker(action=Marker.DELETEALL)
    result.header.frame_id = scene.frame_id
    return result


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


# --- traces: what does not move ------------------------------------------------------------------

SAMPLES = 361          # of a path over one range of the input
INSIDE = 1e-9          # share of the range by which a toggle is drawn inside, where a pose exists
TEXT = 0.05            # height of a label over the size of the mechanism
LETTER, SPACING = 0.6, 1.5      # width of a letter and distance of lines, over that height


def traces(scene: Scene) -> MarkerArray:
    """Return the latched markers: paths of points, toggles, dead points and extrema."""
    return MarkerArray(markers=[clearing(scene), *paths(scene), *limits(scene),
                                *extrema(scene)])


def paths(scene: Scene) -> Iterator[Marker]:
    """Yield the path of each point over each range, or the period, of the input."""
    mechanism, width = scene.linkage, 0.3 * WIDTH * size_of(scene.linkage)
    for name, point in scene.points.items():
        for index, (low, high) in enumerate(mechanism.input_ranges):
            low, high = mechanism.range_around(0.5 * (low + high))
            motion = mechanism.motion(np.linspace(low, high, SAMPLES))
            path = point_motion(mechanism, motion, *point).place
            yield marker(scene.frame_id, f'path of {name}', index, Marker.LINE_STRIP, POINT,
                         (width, 0.0, 0.0), path[~np.isnan(path).any(axis=1)])


def limits(scene: Scene) -> Iterator[Marker]:
    """Yield the pose at each end of the input (unless it turns fully) and at each dead point."""
    mechanism = scene.linkage
    ends = [] if mechanism.turns_fully else [
        ('toggle', position) for low, high in mechanism.input_ranges
        for position in (low + INSIDE * (high - low), high - INSIDE * (high - low))]
    from fourbar_ros.extrema.over_input import dead_points  # other markers do not need it
    dead = [('dead point', point[0]) for point in dead_points(mechanism)]
    width = 0.4 * WIDTH * size_of(mechanism)
    for index, (kind, position) in enumerate([*ends, *dead]):
        try:
            diagram = pictures.diagram_of(mechanism, mechanism.motion(float(position)))
        except FourBarError:         # no pose there within rounding
            continue
        yield lines(scene.frame_id, f'{kind}s', index, [bar[:2] for bar in diagram.bars], width,
                    TOGGLE, 0.4)


def extrema(scene: Scene) -> Iterator[Marker]:
    """
    Yield a dot and a label for each extremum of the output's rate and acceleration.

    The labels are a column right of all joints, sorted by the heights of their dots, so that none
    overlap; a line joins each to its dot.
    """
    from fourbar_ros.extrema.find import find_extrema  # markers alone do not need it
    mechanism, output, frame = scene.linkage, scene.linkage.outputs[0].coordinate, scene.frame_id
    try:
        every = find_extrema(mechanism, (output.rate, output.acceleration), scene.drive.speed)
    except FourBarError:
        return
    labels, right = list[tuple[Array, str]](), -inf     # (dot [m], text); x of the joint rightmost
    for extremum in every:
        try:
            diagram = pictures.diagram_of(mechanism, mechanism.motion(extremum.input))
        except FourBarError:
            continue
        dot = next(joint for name, joint in diagram.joints.items() if name not in diagram.ground)
        labels.append((dot, f'{extremum.kind} {extremum.quantity} {extremum.value:.4g}'))
        right = max(right, *(float(joint[0]) for joint in diagram.joints.values()))
    height, width = TEXT * size_of(mechanism), WIDTH * size_of(mechanism)
    labels.sort(key=lambda label: -label[0][1])
    top = (sum(dot[1] for dot, _ in labels) / max(len(labels), 1)
           + 0.5 * SPACING * height * (len(labels) - 1))
    for row, (dot, text) in enumerate(labels):
        y, start = top - row * SPACING * height, right + SPACING * height
        middle = start + 0.5 * LETTER * height * len(text)       # RViz centres a text
        yield spheres(frame, 'extrema', 3 * row, [dot], 2.0 * width, EXTREMUM)
        label = marker(frame, 'extrema', 3 * row + 1, Marker.TEXT_VIEW_FACING, EXTREMUM,
                       (0.0, 0.0, height))
        label.pose.position, label.text = point(middle, y, 3.0 * width), text
        yield label
        yield lines(frame, 'extrema', 3 * row + 2, [(dot, (start, y))], 0.2 * width, EXTREMUM, 0.5)
