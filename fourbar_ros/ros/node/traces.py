# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
RViz markers that do not move: paths of points, toggles, dead points and extrema.

Toggles and dead points are pale poses. An extremum of the output's rate or acceleration, at the
scene's speed, is a dot at the first moving joint with a label beside the mechanism.
"""
from __future__ import annotations

from collections.abc import Iterator
from math import inf

from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms import picture, points
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.ros.node import markers as shapes
from fourbar_ros.scene.scene import Scene
import numpy as np
from visualization_msgs.msg import Marker, MarkerArray

SAMPLES = 361          # of a path over one range of the input
INSIDE = 1e-9          # share of the range by which a toggle is drawn inside, where a pose exists
TEXT = 0.05            # height of a label over the size of the mechanism
LETTER, SPACING = 0.6, 1.5      # width of a letter and distance of lines, over that height


def message(scene: Scene) -> MarkerArray:
    return MarkerArray(markers=[*paths(scene), *limits(scene), *extrema(scene)])


def paths(scene: Scene) -> Iterator[Marker]:
    """Yield the path of each point over each range, or the period, of the input."""
    mechanism, width = scene.linkage, 0.3 * shapes.WIDTH * shapes.size_of(scene.linkage)
    for name, point in scene.points.items():
        for index, (low, high) in enumerate(mechanism.input_ranges):
            low, high = mechanism.range_around(0.5 * (low + high))
            motion = mechanism.motion(np.linspace(low, high, SAMPLES))
            path = points.point_motion(mechanism, motion, *point).place
            yield shapes.marker(scene.frame_id, f'path of {name}', index, Marker.LINE_STRIP,
                                shapes.POINT, (width, 0.0, 0.0),
                                path[~np.isnan(path).any(axis=1)])


def limits(scene: Scene) -> Iterator[Marker]:
    """Yield the pose at each end of the input (unless it turns fully) and at each dead point."""
    mechanism = scene.linkage
    ends = [] if mechanism.turns_fully else [
        ('toggle', position) for low, high in mechanism.input_ranges
        for position in (low + INSIDE * (high - low), high - INSIDE * (high - low))]
    dead = [('dead point', point[0]) for point in mechanism.dead_points]
    width = 0.4 * shapes.WIDTH * shapes.size_of(mechanism)
    for index, (kind, position) in enumerate([*ends, *dead]):
        try:
            diagram = picture.diagram_of(mechanism, mechanism.motion(float(position)))
        except FourBarError:         # no pose there within rounding
            continue
        yield shapes.lines(scene.frame_id, f'{kind}s', index,
                           [bar[:2] for bar in diagram.bars], width, shapes.TOGGLE, 0.4)


def extrema(scene: Scene) -> Iterator[Marker]:
    """Yield a dot and a label for each extremum of the output's rate and acceleration."""
    mechanism, output = scene.linkage, scene.linkage.outputs[0].coordinate
    try:
        every = find_extrema(mechanism, (output.rate, output.acceleration), scene.drive.speed)
    except FourBarError:
        return
    labels, right = [], -inf
    for extremum in every:
        try:
            diagram = picture.diagram_of(mechanism, mechanism.motion(extremum.input))
        except FourBarError:
            continue
        joint = next(point for name, point in diagram.joints.items() if name not in diagram.ground)
        labels.append((joint, f'{extremum.kind} {extremum.quantity} {extremum.value:.4g}'))
        right = max(right, *(float(point[0]) for point in diagram.joints.values()))
    yield from column(scene.frame_id, labels, right, shapes.size_of(mechanism))


def column(frame: str, labels: list[tuple[Array, str]], right: float,
           size: float) -> Iterator[Marker]:
    """
    Yield dots, and their labels in a column right of x = ``right``, so that none overlap.

    ``labels``: (point of the dot [m], text); the column has their order from top to bottom. A
    line joins each dot to the label. ``size`` is that of the mechanism [m].
    """
    height, width = TEXT * size, shapes.WIDTH * size
    labels = sorted(labels, key=lambda label: -label[0][1])
    top = (sum(dot[1] for dot, _ in labels) / max(len(labels), 1)
           + 0.5 * SPACING * height * (len(labels) - 1))
    for row, (dot, text) in enumerate(labels):
        y, start = top - row * SPACING * height, right + SPACING * height
        middle = start + 0.5 * LETTER * height * len(text)       # RViz centres a text
        yield shapes.spheres(frame, 'extrema', 3 * row, [dot], 2.0 * width, shapes.EXTREMUM)
        label = shapes.marker(frame, 'extrema', 3 * row + 1, Marker.TEXT_VIEW_FACING,
                              shapes.EXTREMUM, (0.0, 0.0, height))
        label.pose.position, label.text = shapes.point(middle, y, 3.0 * width), text
        yield label
        yield shapes.lines(frame, 'extrema', 3 * row + 2, [(dot, (start, y))], 0.2 * width,
                           shapes.EXTREMUM, 0.5)
