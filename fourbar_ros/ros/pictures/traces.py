# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Markers that do not move: paths of points, and the poses that matter.

Toggles and dead points as pale poses; extrema of the output's rate and acceleration at the scene's
speed as labels at the first moving joint.
"""
from __future__ import annotations

from collections.abc import Iterator

from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.ros.pictures import shapes
from fourbar_ros.ros.pictures.markers import size_of, WIDTH
from fourbar_ros.scene.scene import Scene
import numpy as np
from visualization_msgs.msg import Marker, MarkerArray

SAMPLES = 361          # of a path over one range of the input
INSIDE = 1e-9          # a toggle is drawn so far inside the range, over its width


def message(scene: Scene) -> MarkerArray:
    """Return the MarkerArray of a scene."""
    return MarkerArray(markers=[*paths(scene), *limits(scene), *extrema(scene)])


def paths(scene: Scene) -> Iterator[Marker]:
    """Yield the path of each point over each range of the input."""
    mechanism, width = scene.linkage, 0.3 * WIDTH * size_of(scene.linkage)
    for name, point in scene.points.items():
        for number, (low, high) in enumerate(mechanism.input_ranges):
            motion = mechanism.motion(np.linspace(low, high, SAMPLES))
            places = point_motion(mechanism, motion, *point).place
            yield shapes.strip(scene.frame_id, f'path of {name}', number,
                               places[~np.isnan(places).any(axis=1)], width, shapes.POINT)


def limits(scene: Scene) -> Iterator[Marker]:
    """Yield the poses at the ends of the input and at dead points, and what they are."""
    mechanism = scene.linkage
    ends = [] if mechanism.turns_fully else [
        ('toggle', position) for low, high in mechanism.input_ranges
        for position in (low + INSIDE * (high - low), high - INSIDE * (high - low))]
    dead = [('dead point', point[0]) for point in mechanism.dead_points]
    width = 0.4 * WIDTH * size_of(mechanism)
    for number, (what, position) in enumerate([*ends, *dead]):
        try:
            diagram = mechanism.diagram(mechanism.motion(float(position)))
        except FourBarError:
            continue
        yield shapes.lines(scene.frame_id, f'{what}s', number,
                           [bar[:2] for bar in diagram.bars], width, shapes.TOGGLE, 0.4)


def extrema(scene: Scene) -> Iterator[Marker]:
    """Yield labels of the extrema of the output's rate and acceleration."""
    mechanism, output = scene.linkage, scene.linkage.outputs[0].coordinate
    size, number = size_of(mechanism), 0
    try:
        found = find_extrema(mechanism, (output.rate, output.acceleration), scene.drive.speed)
    except FourBarError:
        return
    for extremum in found:
        try:
            position = extremum.slide if mechanism.is_driven_by_slide else extremum.theta1
            diagram = mechanism.diagram(mechanism.motion(float(position)))
        except FourBarError:
            continue
        at = next(place for name, place in diagram.joints.items() if name not in diagram.ground)
        text = f'{extremum.kind} {extremum.quantity} {extremum.value:.4g}'
        yield shapes.spheres(scene.frame_id, 'extrema', number, [at], 2.0 * WIDTH * size,
                             shapes.EXTREMUM)
        yield shapes.label(scene.frame_id, 'extrema', number + 1, (*at, 3.0 * WIDTH * size), text,
                           0.05 * size, shapes.EXTREMUM)
        number += 2
