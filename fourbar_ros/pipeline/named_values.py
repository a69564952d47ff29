# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every number of a mechanism by name and unit, for answers that no fixed message has room for."""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanisms.quantities import known


class Named(NamedTuple):
    """A field of motion or loads, and its unit; empty for a pure number."""

    name: str
    unit: str


def names(mechanism: Any) -> tuple[Named, ...]:
    """
    Return the numbers of a mechanism that have a meaning of their own.

    Joints and moving parts with rates and accelerations, the angle of transmission, the condition;
    with masses also all loads.
    """
    coordinates = dict.fromkeys((*(joint.coordinate for joint in mechanism.JOINTS),
                                 *mechanism.PARTS))
    units: dict[str, str] = {}
    for coordinate in coordinates:
        units |= zip(coordinate, (coordinate.unit, f'{coordinate.unit}/s',
                                  f'{coordinate.unit}/s^2'))
    units |= {'transmission_angle': 'rad', 'condition': ''}
    if mechanism.bodies is not None:
        for reaction in mechanism.REACTIONS:
            units |= dict.fromkeys((reaction.x, reaction.y, reaction.magnitude), 'N')
            if reaction.couple:
                units[reaction.couple] = 'N m'
        units |= {quantity.name: quantity.unit
                  for quantity in known(mechanism, mechanism.input).values() if quantity.is_load}
    there = set(mechanism.MOTION._fields + mechanism.LOADS._fields)
    return tuple(Named(name, unit) for name, unit in units.items() if name in there)
