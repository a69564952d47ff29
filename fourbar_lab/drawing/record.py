# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""All that ``fourbar show`` tells of a scene as one record of plain values in SI units."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import nan
from typing import Any

from fourbar_lab.drawing.mobility import AXES, mobility
from fourbar_lab.drawing.poses import Pose
from fourbar_lab.drawing.tables import (
    counted,
    inertia_of,
    input_of,
    known_output_ranges,
    mode_name,
    toggles_of,
    transmission_bands,
)
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.mechanisms.inertia import mean_rigid
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.mechanisms.picture import Points
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.pipeline.stepper import STATUS_NAMES

Record = dict[str, Any]        # text, numbers, lists and records


def record_of(linkage: Mechanism, extrema: Sequence[Extremum], points: Points,
              pose: Pose | None = None) -> Record:
    """
    Return the properties of a linkage, its extrema and, with a pose, its state there.

    All in SI units; an unknown value is NaN; ``bodies`` is None without masses.
    """
    its_mobility = mobility(linkage)
    record: Record = {
        'lengths': dict(zip(linkage.length_names, linkage.lengths)),
        'class': linkage.description, 'mode': linkage.mode, 'mode_name': mode_name(linkage),
        'input': _with_ranges(linkage.input_coordinate, linkage.input_ranges)
        | {'turns_fully': linkage.turns_fully},
        'outputs': [_with_ranges(coordinate, ranges) | {'of_both_modes': of_both}
                    for coordinate, ranges, of_both in known_output_ranges(linkage)],
        'dead_points': [_dead_point(linkage, point) for point in linkage.dead_points],
        'toggles': toggles_of(linkage),
        'transmission_angles': {
            band.name: {'least': band.least.value, 'most': band.most.value,
                        'worst': band.worst.value, 'worst_at': input_of(linkage, band.worst)}
            for band in transmission_bands(linkage)},
        'change_point_margin': linkage.change_point_margin,
        'mobility': its_mobility and {
            'factors': its_mobility.factors._asdict(), 'place': its_mobility.place,
            'nearest_change_point': AXES[its_mobility.nearest]},
        'bodies': linkage.bodies and {name: asdict(body)
                                      for name, body in linkage.bodies._asdict().items()},
        'inertia_at_input': _inertia(linkage) if linkage.bodies else None,
        'held_rigid_mean': mean_rigid(linkage)._asdict() if linkage.bodies else None,
        'extrema': [extremum._asdict() | {'theta1': counted(linkage, extremum.theta1)}
                    for extremum in extrema]}
    if pose:
        record['pose'] = _pose(linkage, pose, points)
    return record


def _inertia(linkage: Mechanism) -> Record | None:
    """Return least, largest and mean inertia at the input, and where they are."""
    found = inertia_of(linkage)
    return found and {'least': found.least.value, 'least_at': input_of(linkage, found.least),
                      'most': found.most.value, 'most_at': input_of(linkage, found.most),
                      'mean': found.mean}


def _with_ranges(coordinate: Coordinate, ranges: Sequence[tuple[float, float]]) -> Record:
    return {'name': coordinate.position, 'unit': coordinate.unit,
            'ranges': [list(map(float, bounds)) for bounds in ranges]}


def _dead_point(linkage: Mechanism, point: Any) -> Record:
    """Return {coordinate: value} of a dead point, and whether the links are stretched there."""
    coordinates = linkage.input_coordinate, *(output.coordinate for output in linkage.outputs)
    values = counted(linkage, point[0]), *point[1:]
    record: Record = {coordinate.position: value
                      for coordinate, value in zip(coordinates, values)}
    if hasattr(point, 'stretched'):
        record['stretched'] = bool(point.stretched)
    return record


def _pose(linkage: Mechanism, pose: Pose, points: Points) -> Record:
    """Return the record of one pose: status, motion of the joints, loads, motion of points."""
    motion = pose.motion._asdict()
    joints = {field: motion.get(field, nan) for coordinate in linkage.PARTS
              for field in (coordinate.position, coordinate.rate, coordinate.acceleration)}
    motions = {name: point_motion(linkage, pose.motion, *point) for name, point in points.items()}
    return {'status': STATUS_NAMES[pose.status],
            'motion': joints | {'transmission_angle': motion['transmission_angle']},
            'loads': pose.loads and pose.loads._asdict(),
            'points': {name: {'place': list(its.place), 'velocity': list(its.velocity),
                              'acceleration': list(its.acceleration)}
                       for name, its in motions.items()}}
