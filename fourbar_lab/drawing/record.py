# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What ``fourbar show`` tells of a scene as one record of plain values in SI units."""
from collections.abc import Callable, Sequence
from dataclasses import asdict
from math import inf, nan, pi
from typing import Any

from fourbar_lab.drawing.poses import DrawnPose
from fourbar_ros import Mechanism, point_motion
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import Extremum, find_extrema
from fourbar_ros.extrema.over_input import (
    dead_points,
    efficiency_of,
    most_extreme,
    output_ranges,
    OverInput,
)
from fourbar_ros.mechanisms import parts, picture, quantities
from fourbar_ros.mechanisms.friction import locking_joints
from fourbar_ros.mechanisms.inertia import mean_rigid
from fourbar_ros.pipeline.stepper import STATUS_NAMES
import numpy as np

ANGLE = 'transmission_angle'
DEAD = 1e-12        # of the usual rate of an output: less is that of a dead point

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
    return {
        'lengths': dict(zip(linkage.length_names, linkage.lengths)),
        'class': linkage.description, 'mode': linkage.mode,
        'mode_name': linkage.modes[linkage.mode],
        'input': _with_ranges(linkage.input_coordinate, linkage.input_ranges)
        | {'turns_fully': linkage.turns_fully, 'period': linkage.period},
        'outputs': [_output(linkage, coordinate) for coordinate, _ in linkage.outputs],
        'dead_points': _dead_points(linkage),
        'toggles': list(linkage.toggles),       # where the links of a dyad come in line
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
    turn, nearest = linkage.period, list[tuple[float, float]]()
    for low, high in linkage.input_ranges:
        angle = theta1 + turn * round((0.5 * (low + high) - theta1) / turn)
        nearest.append((max(low - angle, angle - high), angle))
    return min(nearest)[1]


def inputs_of(linkage: Mechanism, extremum: Extremum) -> list[float]:
    """Return where it is, as users count: in all turns of a cycle, as motion repeats before."""
    first = counted(linkage, extremum.input)
    if not linkage.turns_fully:
        return [first]
    drive = quantities.of_drive(linkage, linkage.input).get(extremum.quantity)
    links = drive.links(linkage) if drive else linkage
    is_load = drive.is_load if drive else extremum.quantity in linkage.LOADS._fields
    period = links.cycle if is_load else links.period
    return [first % period + turn * period for turn in range(round(linkage.cycle / period))]


def _with_ranges(coordinate: parts.Coordinate, ranges: Intervals) -> LinkageRecord:
    return {'name': coordinate.position, 'unit': coordinate.unit,
            'ranges': [list(map(float, bounds)) for bounds in ranges]}


def _output(linkage: Mechanism, coordinate: parts.Coordinate) -> LinkageRecord:
    every = sorted(output_ranges(linkage, coordinate), key=lambda swept: (swept.low, swept.high))
    ratio = every[0].time_ratio(linkage.period) if linkage.turns_fully else nan
    at = {name: [sorted(counted(linkage, x) for x in getattr(swept, name)) for swept in every]
          for name in ('least_at', 'most_at')}
    return _with_ranges(coordinate, [(swept.low, swept.high) for swept in every]) | at | {
        'time_ratio': ratio}


def _dead_points(linkage: Mechanism) -> list[LinkageRecord]:
    """Return where the output turns back: {name of input or output: its position there}."""
    coordinates = linkage.input_coordinate, *(output.coordinate for output in linkage.outputs)
    return [{**{coordinate.position: value for coordinate, value in zip(
                coordinates, (counted(linkage, point[0]), *point[1:]))},
             **({'stretched': bool(point.stretched)} if hasattr(point, 'stretched') else {})}
            for point in dead_points(linkage)]


def transmission_angles(linkage: Mechanism) -> dict[str, LinkageRecord]:
    """Return the extrema of the transmission angle, of a machine those of all of its dyads."""
    names = [name for name in quantities.positions(linkage, linkage.input)
             if name.startswith(ANGLE)]
    asked = [name for name in names if name != ANGLE] or names
    every = find_extrema(linkage, asked, conditions=False)
    record = {}
    for name in asked:
        least, most = _least_and_most(every, name)
        worst = _most((least, most), 1, lambda angle: abs(angle - 0.5 * pi))
        record[name] = {'least': least.value, 'most': most.value, 'worst': worst.value,
                        'worst_at': counted(linkage, worst.input)}
    return record


def _most(extrema: Sequence[Extremum], sense: int, size: Callable[[float], float] = float
          ) -> Extremum:
    """Return :func:`.most_extreme` of a quantity that is no angle which only turns on."""
    extremum = most_extreme(extrema, sense, size)
    assert extremum
    return extremum


def _inertia(linkage: Mechanism) -> LinkageRecord:
    """Return least, largest and mean inertia at the input [kg m^2 or kg] and where they are."""
    inertia = OverInput(linkage, 'inertia')
    least, most = inertia.least, inertia.most
    if not (least and most) or most.value < np.finfo(float).tiny:     # which has few digits
        raise InvalidParameter('bodies', None, 'too heavy or too light: the inertia at the input '
                               'is beyond all numbers')
    return _ends(linkage, least, most) | {
        'mean': inertia.mean, 'unbounded_at': [counted(linkage, extremum.input)
                                               for extremum in inertia.extrema
                                               if extremum.value == inf]}


def drive_of(linkage: Mechanism, speed: float, acceleration: float = 0.0,
             within: tuple[float, float] | None = None,
             extrema: Sequence[Extremum] | None = None, hold: float | None = None
             ) -> LinkageRecord:
    """
    Return what sizes a drive, as {name: record}; without loads its mechanical advantage alone.

    Where friction locks the linkage, ``locks`` says where, and there is neither ``effort`` nor
    ``cycle`` nor ``worst_pin``. Work [J], mean power [W] and efficiency of a cycle are NaN where
    the input does not turn fully. ``speed``, ``acceleration``: of the input, [rad/s, rad/s^2] or
    [m/s, m/s^2]; ``within``: the part of it that counts [rad or m]; ``extrema``: of all loads at
    these rates, if they are known; ``hold``: input [rad or m] of the record ``at_rest``.
    """
    record: LinkageRecord = {}
    if linkage.has_loads:
        if linkage.friction:
            record['locks'] = _locks(linkage, speed, acceleration, within)
        if not record.get('locks'):
            record |= _effort(linkage, speed, acceleration, within, extrema)
    if hold is not None:
        record['at_rest'] = _at_rest(linkage, hold)
    frictionless = linkage.without_friction
    names = [name for name, quantity in quantities.of_drive(linkage, linkage.input).items()
             if name.startswith(('holding', 'mechanical'))
             and (linkage.has_loads or not quantity.is_load)]
    # the sign of the advantage is the sense of the output: it counts by its size
    every = [extremum._replace(value=abs(extremum.value))
             if extremum.quantity == 'mechanical_advantage' else extremum for extremum in
             find_extrema(frictionless, names, speed, conditions=False, within=within)]
    for name in names:
        least, most = _least_and_most(every, name)
        record[name] = {'unit': least.unit} | _ends(linkage, least, most)
    return record


def _least_and_most(extrema: Sequence[Extremum], name: str) -> tuple[Extremum, Extremum]:
    of_name = [extremum for extremum in extrema if extremum.quantity == name]
    return _most(of_name, -1), _most(of_name, 1)


def _ends(linkage: Mechanism, least: Extremum, most: Extremum) -> LinkageRecord:
    return {'least': least.value, 'least_at': counted(linkage, least.input),
            'most': most.value, 'most_at': counted(linkage, most.input)}


def _effort(linkage: Mechanism, speed: float, acceleration: float,
            within: tuple[float, float] | None, extrema: Sequence[Extremum] | None
            ) -> LinkageRecord:
    pins = {reaction.magnitude: reaction.joint for reaction in linkage.REACTIONS
            if not reaction.couple}
    if extrema is None:
        extrema = find_extrema(linkage, [linkage.drive_load, *pins], speed, acceleration,
                               conditions=False, within=within)
    load = OverInput(linkage, linkage.drive_load, speed, acceleration, within,
                     [extremum for extremum in extrema
                      if extremum.quantity == linkage.drive_load])
    peak, work = _most(load.extrema, 1, abs), load.of_cycle
    pin = _most([extremum for extremum in extrema if extremum.quantity in pins], 1)
    without = (OverInput(linkage.without_friction, linkage.drive_load, speed, acceleration,
                         within).of_cycle if linkage.friction else work)
    return {
        'effort': {'unit': peak.unit, 'peak': peak.value,
                   'peak_at': counted(linkage, peak.input), 'root_mean_square': load.rms,
                   'peak_power': peak.value * speed if speed else 0.0,
                   'peak_power_at': counted(linkage, peak.input)},
        'cycle': {'work': work, 'without_friction': without, 'friction': work - without,
                  'efficiency': efficiency_of(work, without),
                  'mean_power': work / linkage.cycle * abs(speed)},
        'worst_pin': {'joint': pins[pin.quantity], 'load': pin.quantity, 'force': pin.value,
                      'at': counted(linkage, pin.input)}}


def _locks(linkage: Mechanism, speed: float, acceleration: float,
           within: tuple[float, float] | None) -> list[LinkageRecord]:
    """Return where a linkage locks itself, as users count inputs, and at which joints."""
    ranges, cycle = list(linkage.locked_ranges(speed, acceleration, within)), linkage.cycle
    if linkage.turns_fully and len(ranges) > 1 and (
            ranges[-1][1] - ranges[0][0] == cycle):     # one range, over the seam of the cycle
        ranges = [*ranges[1:-1], (ranges[-1][0], ranges[0][1] + cycle)]
    records = list[LinkageRecord]()
    for low, high in ranges:
        joints = locking_joints(linkage, (low, high), speed, acceleration)
        ends = ((0.0, cycle) if linkage.turns_fully and high - low >= cycle else
                (counted(linkage, low), counted(linkage, high)))
        records.append({'from': ends[0], 'to': ends[1], 'joints': list(joints)})
    return records


def flywheel_of(linkage: Mechanism, speed: float, most: float) -> LinkageRecord:
    """
    Return the smallest flywheel for a speed that fluctuates by ``most`` of its mean.

    With the constant torque of its cycle. Raises InvalidParameter for a crank that does not turn
    fully or locks, MissingBodies.
    """
    from fourbar_ros.dynamics.equation import Equation
    from fourbar_ros.dynamics.flywheel import flywheel_for
    if not linkage.turns_fully:
        raise InvalidParameter('fluctuation', most, 'is of a crank that turns fully')
    wheel = flywheel_for(Equation(linkage), speed, most)
    return {'most': most, 'inertia': wheel.inertia, 'torque': wheel.torque,
            'fluctuation': wheel.fluctuation}


def _at_rest(linkage: Mechanism, position: float) -> LinkageRecord:
    """Return the drives [N m or N] between which a linkage stays, and the way of its output."""
    lower, upper = linkage.holding(position)
    output = linkage.outputs[0].coordinate
    rate, usual = (getattr(linkage.motion(x, 1.0), output.rate) for x in (
        position, np.linspace(*linkage.input_ranges[0], 9)[1:-1]))
    is_dead = abs(rate) <= DEAD * np.max(np.abs(usual))
    return {'at': position, 'lower': lower, 'upper': upper, 'output': output.position,
            'way': 0 if is_dead else 1 if rate > 0.0 else -1}
