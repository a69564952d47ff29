# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What ``fourbar show`` tells of a scene as one record of plain values in SI units."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import inf, nan, pi, tau
from typing import Any

from fourbar_lab.drawing.poses import DrawnPose
from fourbar_ros import Mechanism, point_motion
from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.extrema.over_input import efficiency, output_ranges, OverInput
from fourbar_ros.mechanisms import parts, picture, quantities
from fourbar_ros.mechanisms.inertia import mean_rigid
from fourbar_ros.pipeline.stepper import STATUS_NAMES

ANGLE = 'transmission_angle'

LinkageRecord = dict[str, Any]             # text, numbers, lists and records
Intervals = Sequence[tuple[float, float]]


def record_of(linkage: Mechanism, extrema: Sequence[Extremum], points: picture.Points,
              pose: DrawnPose | None = None) -> LinkageRecord:
    """Return the properties of a linkage, its extrema and, with a pose, its state there."""
    record = properties_of(linkage) | {
        'extrema': [extremum._asdict() | {'theta1': counted(linkage, extremum.theta1)}
                    for extremum in extrema]}
    if pose:
        motion = pose.motion._asdict()
        joints = {field: motion.get(field, nan) for names in linkage.PARTS for field in names}
        of_points = {name: point_motion(linkage, pose.motion, *point)
                     for name, point in points.items()}
        record['pose'] = {
            'status': STATUS_NAMES[pose.status], 'motion': joints | {ANGLE: motion[ANGLE]},
            'loads': pose.loads and pose.loads._asdict(),
            'points': {name: {field: list(getattr(point, field))
                              for field in ('place', 'velocity', 'acceleration')}
                       for name, point in of_points.items()}}
    return record


def properties_of(linkage: Mechanism) -> LinkageRecord:
    """Return a linkage's own properties; an unknown value is NaN, ``bodies`` None if massless."""
    ends = {end for bounds in linkage.closing_ranges for end in bounds}
    toggles = [] if linkage.turns_fully else [end for bounds in linkage.input_ranges
                                              for end in bounds if end in ends]
    return {
        'lengths': dict(zip(linkage.length_names, linkage.lengths)),
        'class': linkage.description, 'mode': linkage.mode,
        'mode_name': linkage.modes[linkage.mode],
        'input': _with_ranges(linkage.input_coordinate, linkage.input_ranges)
        | {'turns_fully': linkage.turns_fully, 'period': linkage.period},
        'outputs': [_output(linkage, coordinate) for coordinate, _ in linkage.outputs],
        'dead_points': [_dead_point(linkage, point) for point in linkage.dead_points],
        'toggles': toggles,         # where the links of a dyad come in line
        'transmission_angles': transmission_angles(linkage),
        'change_point_margin': linkage.change_point_margin,
        'bodies': linkage.bodies and {name: asdict(body)
                                      for name, body in linkage.bodies._asdict().items()},
        'inertia_at_input': _inertia(linkage) if linkage.bodies else None,
        'held_rigid_mean': mean_rigid(linkage)._asdict() if linkage.bodies else None}


def counted(linkage: Mechanism, theta1: float) -> float:
    """Return an input as users count it: in its range, of full turns from 0 to its cycle."""
    if linkage.is_driven_by_slide:
        return theta1
    if linkage.turns_fully:
        return theta1 % linkage.cycle
    return min((theta1 + turns * tau for turns in (-1, 0, 1)), key=lambda angle: min(
        max(low - angle, angle - high) for low, high in linkage.input_ranges))


def _with_ranges(coordinate: parts.Coordinate, ranges: Intervals) -> LinkageRecord:
    return {'name': coordinate.position, 'unit': coordinate.unit,
            'ranges': [list(map(float, bounds)) for bounds in ranges]}


def _output(linkage: Mechanism, coordinate: parts.Coordinate) -> LinkageRecord:
    every = output_ranges(linkage, coordinate)
    ratio = every[0].time_ratio(linkage.period) if linkage.turns_fully else nan
    return _with_ranges(coordinate, sorted([(swept.low, swept.high) for swept in every])) | {
        'time_ratio': ratio}


def _dead_point(linkage: Mechanism, point: Any) -> LinkageRecord:
    """Return {coordinate: value} of a dead point, and whether the links are stretched there."""
    coordinates = linkage.input_coordinate, *(output.coordinate for output in linkage.outputs)
    values = counted(linkage, point[0]), *point[1:]
    record: LinkageRecord = {coordinate.position: value
                             for coordinate, value in zip(coordinates, values)}
    if hasattr(point, 'stretched'):
        record['stretched'] = bool(point.stretched)
    return record


def transmission_angles(linkage: Mechanism) -> dict[str, LinkageRecord]:
    """
    Return the extrema of the transmission angle; of a machine, of those of all of its dyads.

    The worst is farther from 90 degrees.
    """
    names = [name for name in quantities.positions(linkage, linkage.input)
             if name.startswith(ANGLE)]
    asked = [name for name in names if name != ANGLE] or names
    every = find_extrema(linkage, asked, conditions=False)
    record = {}
    for name in asked:
        extrema = [extremum for extremum in every if extremum.quantity == name]
        least, most = (pick(extrema, key=lambda extremum: extremum.value) for pick in (min, max))
        worst = max((least, most), key=lambda extremum: abs(extremum.value - 0.5 * pi))
        record[name] = {'least': least.value, 'most': most.value, 'worst': worst.value,
                        'worst_at': counted(linkage, worst.input)}
    return record


def _inertia(linkage: Mechanism) -> LinkageRecord:
    """
    Return least, largest and mean inertia at the input and where they are.

    In [kg m^2], of a driven slide [kg]; infinite where it grows without bound at an end.
    """
    inertia = OverInput(linkage, 'inertia')
    least, most = inertia.least, inertia.most
    assert least and most           # it is no angle
    return {'least': least.value, 'least_at': counted(linkage, least.input),
            'most': most.value, 'most_at': counted(linkage, most.input), 'mean': inertia.mean,
            'unbounded_at': [counted(linkage, extremum.input) for extremum in inertia.extrema
                             if extremum.value == inf]}


def drive_of(linkage: Mechanism, speed: float, acceleration: float,
             within: tuple[float, float] | None) -> LinkageRecord:
    """
    Return what a drive must hold and do, and its mechanical advantage, as {name: record}.

    ``work`` [J], ``mean_power`` [W] and efficiency of a cycle are NaN where the input does not
    turn fully; without loads there is the advantage alone.
    """
    names = [name for name, quantity in quantities.of_drive(linkage, linkage.input).items()
             if name.startswith(('holding', 'mechanical'))
             and (linkage.has_loads or not quantity.is_load)]
    record: LinkageRecord = {}
    every = find_extrema(linkage, names, speed, conditions=False, within=within)
    for name in names:
        of_name = [extremum for extremum in every if extremum.quantity == name]
        is_size = name == 'mechanical_advantage'      # its sign is the sense of the output
        least, most = (pick(of_name, key=lambda extremum: abs(extremum.value) if is_size
                            else extremum.value) for pick in (min, max))
        record[name] = {'unit': least.unit, **{key: value for key, extremum in (
            ('least', least), ('most', most)) for key, value in (
                (key, abs(extremum.value) if is_size else extremum.value),
                (f'{key}_at', counted(linkage, extremum.input)))}}
    if linkage.has_loads:
        load = OverInput(linkage, linkage.drive_load, speed, acceleration, within)
        work = load.of_cycle
        record['cycle'] = {'work': work, 'mean_power': work / linkage.cycle * speed,
                           'efficiency': nan if within else
                           efficiency(linkage, speed, acceleration)}
    return record
