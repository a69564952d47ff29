# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One pose of a linkage, for ``fourbar show`` and ``fourbar draw``: angles in degrees."""
from collections.abc import Sequence
from math import degrees, hypot, radians
import re
from typing import NamedTuple

from fourbar_ros import FourBarError, Mechanism, point_motion
from fourbar_ros.mechanisms import load_table, parts, picture, quantities
from fourbar_ros.pipeline import stepper
from fourbar_ros.terminal import make_table
from rich.table import Table


class DrawnPose(NamedTuple):
    """Motion and loads (None without masses) at one input; status as in pipeline.stepper."""

    status: int
    motion: parts.NamedFields
    loads: parts.NamedFields | None


def position_of(linkage: Mechanism, user_input: float) -> float:
    return user_input if linkage.is_driven_by_slide else radians(user_input)


def evaluate_at(linkage: Mechanism, user_input: float, speed: float, acceleration: float,
                counted: str = '', at_toggles: bool = True) -> DrawnPose:
    """Return the pose at an input [degrees or m], ``counted`` so in words; or FourBarError."""
    sample = position_of(linkage, user_input), speed, acceleration
    status, motion, loads = stepper.evaluate(linkage, *sample, linkage.has_loads)
    if status == stepper.INVALID_INPUT:
        linkage.motion(*sample)       # raises where the input is not finite
    why = ''
    if status == stepper.OUT_OF_RANGE:
        ranges = ranges_in_words(linkage.input_coordinate, linkage.input_ranges)
        why = f'is outside the input range {ranges}{counted}'
    elif status == stepper.TOGGLE and not at_toggles:
        why = 'is a toggle position: rates and loads are unbounded'
    if why:
        unit = 'm' if linkage.is_driven_by_slide else 'deg'
        raise FourBarError(f'{linkage.input_coordinate.position} = {user_input:.12g} {unit} {why}')
    return DrawnPose(status, motion, loads if linkage.has_loads else None)


def shown(coordinate: parts.Coordinate, value: float) -> str:
    return f'{value:.6g} m' if coordinate.unit == 'm' else in_degrees(value)


def in_degrees(angle: float) -> str:
    return f'{degrees(angle):.4f} deg'


def ranges_in_words(coordinate: parts.Coordinate, ranges: Sequence[tuple[float, float]]) -> str:
    """Return ranges [rad or m] as text: '30.0000 to 60.0000, 90.0000 to 95.0000 deg'."""
    ends = [[shown(coordinate, end).split()[0] for end in bounds] for bounds in ranges]
    return f'{", ".join(map(" to ".join, ends))} {"m" if coordinate.unit == "m" else "deg"}'


def ten_digits(value: float) -> str:
    return f'{value + 0.0:.10g}'


# --- tables --------------------------------------------------------------------------------------

def motion_table(linkage: Mechanism, pose: DrawnPose) -> Table:
    driven = linkage.input_coordinate
    title = (f'at {driven.position} = {shown(driven, getattr(pose.motion, driven.position))}, '
             f'{getattr(pose.motion, driven.rate):g} {driven.unit}/s, '
             f'{getattr(pose.motion, driven.acceleration):g} {driven.unit}/s^2: '
             f'{stepper.STATUS_NAMES[pose.status]}')
    table = make_table(title, ('', 'position>', 'unit', 'rate>', 'acceleration>', 'unit', 'of'))
    for coordinate, part in linkage.PARTS.items():
        value, unit = shown(coordinate, getattr(pose.motion, coordinate.position)).split()
        rates = coordinate.unit
        table.add_row(coordinate.position, value, unit,
                      ten_digits(getattr(pose.motion, coordinate.rate)),
                      ten_digits(getattr(pose.motion, coordinate.acceleration)),
                      f'{rates}/s, {rates}/s^2', part)
    transmission_angle = pose.motion._asdict()['transmission_angle']
    table.add_row('transmission angle', *in_degrees(transmission_angle).split())
    return table


def loads_table(linkage: Mechanism, loads: parts.NamedFields) -> Table:
    table = make_table('loads', ('', 'x>', 'y>', 'magnitude>', 'unit', 'of'))
    values = loads._asdict()
    forces = (*linkage.REACTIONS,
              parts.Reaction('shaking force', 'linkage on ground', 'shaking_force'))
    # moments, power and the drive; what shakes stands at the end, as of the forces
    labelled = sorted((row for row in load_table.LOADS.values() if row.label),
                      key=lambda row: row.name.startswith('shaking'))
    for force in forces:
        table.add_row(force.symbol, *(ten_digits(values[field])
                                      for field in (force.x, force.y, force.magnitude)), 'N',
                      force.text)
    torque = re.sub('[_{}]', '', linkage.TORQUE)             # mathtext: T_{41} becomes T41
    for row in labelled:
        if row.name in values:
            table.add_row(row.label.replace('T41', torque), '', '', ten_digits(values[row.name]),
                          row.unit)
    known = quantities.known_quantities(linkage, linkage.input)
    in_table = {force.magnitude for force in forces} | {row.name for row in labelled}
    for name, value in values.items():               # loads that only one kind of mechanism has
        if name in known and name not in in_table:
            table.add_row(name.replace('_', ' '), '', '', ten_digits(value), known[name].unit)
    return table


def points_table(linkage: Mechanism, motion: parts.NamedFields, points: picture.Points) -> Table:
    rows = []
    for name, point in points.items():
        moved = point_motion(linkage, motion, *point)
        rows += [(label, field, ten_digits(x), ten_digits(y), ten_digits(hypot(x, y)), unit)
                 for label, field, (x, y), unit in (
                     (name, 'place', moved.place, 'm'), ('', 'velocity', moved.velocity, 'm/s'),
                     ('', 'acceleration', moved.acceleration, 'm/s^2'))]
    return make_table('points', ('', '', 'x>', 'y>', 'magnitude>', 'unit'), rows)
