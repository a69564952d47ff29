# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of a mechanism as it is made: each error names the parameter and its allowed values."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import in_words, InvalidParameter, nearest
from fourbar_ros.mechanics.bodies import Applied, Base, Body, Gravity, UnknownBase
from fourbar_ros.numerics.arguments import finite, records

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.curves import Point
    from fourbar_ros.mechanisms.geometry import MechanismGeometry

LONGEST = 2.0**1000     # [m]
SHORTEST = 1e-100       # of the longest length
STROKE = 'must be [lowest, highest] of the driven joint, two finite numbers'


def checked(mechanism: MechanismGeometry) -> dict[str, Any]:
    """Return {field: checked value}, the numbers and records a mechanism computes with."""
    values: dict[str, Any] = _lengths(mechanism)
    if mechanism.input not in mechanism.INPUTS:
        raise InvalidParameter('input', mechanism.input,
                               f'must be one of {", ".join(mechanism.INPUTS)}')
    modes, mode = mechanism.modes, mechanism.mode
    if isinstance(mode, bool) or mode not in modes:
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)'
                               if len(modes) > 1 else
                               f'must be {min(modes)}: driven at its {mechanism.input} it has '
                               'one assembly mode')
    values.update(mode=int(mode), gravity=checked_gravity(mechanism.gravity),
                  external=records('external', mechanism.external, Applied, mechanism.EXTERNAL))
    if mechanism.bodies is not None:
        values['bodies'] = records('bodies', mechanism.bodies, Body, mechanism.BODIES)
    values['friction'] = friction_of(mechanism)
    return values


def friction_of(mechanism: MechanismGeometry) -> Any:
    if isinstance(mechanism.friction, tuple) and not mechanism.friction:
        return ()
    from fourbar_ros.mechanisms.friction import checked_friction  # few mechanisms have any
    return checked_friction(mechanism.REACTIONS, mechanism.friction)


def _lengths(mechanism: MechanismGeometry) -> dict[str, float]:
    """Return {name: length [m]}, each checked; the signed ones, as an offset, may be negative."""
    values = {}
    for name, _, is_signed in mechanism.LENGTHS:
        value = getattr(mechanism, name)
        values[name] = finite(name, value) if is_signed else finite(
            name, value, 'a length must be a positive number', above=0.0)
        if abs(values[name]) >= LONGEST:
            raise InvalidParameter(name, value, f'must be shorter than {LONGEST:.3g} m: sums '
                                                'of lengths overflow')
    longest = max(map(abs, values.values()), default=0.0)
    for name, _, is_signed in mechanism.LENGTHS:
        if not is_signed and values[name] < SHORTEST * longest:
            raise InvalidParameter(name, values[name], f'must be at least {SHORTEST:g} of the '
                                   f'longest, {longest:g} m: ratios of lengths overflow')
    return values


def check_joint_names(names: Mapping[str, str], points: Mapping[str, Sequence[Point]],
                      near: float = 0.0) -> None:
    """Refuse names of joints that there are not, empty ones, and one name at two points."""
    # points: {joint: the Point of each link there}, () where no joint shares it; near: points of
    # one link that are no farther apart are one [m]
    named = dict[str, list[str]]()      # {name: joints}
    for joint, name in names.items():
        parameter = f'joint_names.{joint}'
        if joint not in points:
            raise InvalidParameter(parameter, name,
                                   f'there is no such joint{nearest(joint, points)}')
        if not name:
            raise InvalidParameter(parameter, name, 'must be the name of a point')
        known = [point for earlier in named.get(name, ()) for point in points[earlier]]
        if name in named and not any(
                point.link == there.link and hypot(point.along - there.along,
                                                   point.across - there.across) <= near
                for point in points[joint] for there in known):
            raise InvalidParameter(parameter, name, 'names two joints that are not at one point, '
                                   f'{named[name][0]} and {joint}')
        named.setdefault(name, []).append(joint)


def check_stroke(mechanism: MechanismGeometry) -> None:
    stroke = mechanism.stroke
    if stroke is None:
        return
    low, high = two_numbers('stroke', stroke, STROKE)
    object.__setattr__(mechanism, 'stroke', (low, high))
    if not low < high:
        raise InvalidParameter('stroke', stroke, STROKE)
    if not mechanism.input_ranges:
        unit = mechanism.input_coordinate.unit
        raise InvalidParameter('stroke', (low, high), 'the links cannot close anywhere in it: '
                               f'they do in {in_words(mechanism.closing_ranges, unit)}')


def checked_gravity(gravity: Any) -> Gravity:
    if isinstance(gravity, UnknownBase):
        return gravity
    if isinstance(gravity, Base):
        return Base._make([finite(name, value) for name, value in gravity._asdict().items()])
    return two_numbers('gravity', gravity, 'must be two finite numbers (x, y), or a Base')


def required_base(base: Any) -> Base:
    """Refuse what is no Base, as two numbers, which are a field of gravity."""
    if not isinstance(base, Base):
        raise InvalidParameter('base', base, 'must be a Base')
    return base


def two_numbers(name: str, pair: Any,
                allowed: str = 'must be two finite numbers (x, y)') -> tuple[float, float]:
    try:
        x, y = pair
    except (TypeError, ValueError):
        raise InvalidParameter(name, pair, allowed) from None
    return finite(name, x, allowed), finite(name, y, allowed)
