# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Springs, dampers and forces over a position in a scene: where they act, from which table.

A table may stand in a CSV file beside the file of a scene, which is read with it: a scene itself
holds the numbers, and opens no file, whoever made it.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from math import atan2, hypot, inf, pi
from typing import Any

from fourbar_ros.errors import InvalidParameter, nearest, one_of
from fourbar_ros.mechanics.bodies import field_of
from fourbar_ros.mechanisms.curves import FIXED
from fourbar_ros.mechanisms.elements import (
    Attachment,
    Distance,
    Element,
    INPUT,
    LinkAngle,
    Over,
    PositionForce,
    Spring,
    TableForce,
    TorsionSpring,
    Way,
)
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.mechanisms.pieces import inside_pieces, span_of
from fourbar_ros.numerics.number_types import ARRAY
from fourbar_ros.scene.parameters import names_in, point_in
from fourbar_ros.scene.settings import APART, COUPLE, ParameterValues, POSITION_UNITS
from fourbar_ros.scene.units import quantity, UNITS, ValueInSI
import numpy as np

ROUNDED = 1e-6      # of a stroke: places typed in six digits reach its ends
WEAK, WEAKEST = 0.01, 1.0   # a spring with less than this part of the weight, or less [N], is weak
# forces.NAME.acts: (whether the direction turns with the link, angle from its x axis [rad])
ACTS = {'x': (False, 0.0), 'y': (False, 0.5 * pi), 'along': (True, 0.0),
        'across': (True, 0.5 * pi)}
DISTANCE = 'distance'
TABLE_UNITS = 'rad', 'm', 'N', 'N m', 'Pa'      # of both columns of a table
# angles of the kinds of mechanisms: (link, link from which the angle counts)
ANGLES = {'theta1': ('crank', GROUND), 'theta2': ('coupler', 'crank'),
          'theta4': ('output', GROUND), 'beta': ('coupler', GROUND)}


def element_names(values: ParameterValues) -> list[str]:
    """Return the names of springs and forces, as springs.back, in their order in a mechanism."""
    return [f'{family}.{name}' for family in ('springs', 'torsion_springs', 'forces')
            for name in names_in(family, values)]


def elements_of(values: ParameterValues, mechanism: Mechanism) -> tuple[Element, ...]:
    """Return springs and forces over a position of a scene; InvalidParameter names what."""
    names = element_names(values)
    if names and mechanism.bodies is None:
        raise InvalidParameter('bodies.crank.mass', None, 'must be given (or bodies.rods): '
                               f'{names[0]} needs masses')
    return tuple([(_force if name.startswith('forces') else _spring)(values, name, mechanism)
                  for name in names])


def beyond_tables(values: ParameterValues, mechanism: Mechanism) -> Iterator[str]:
    """Yield a line for each table whose force never acts, or ends before its position does."""
    for name, element in zip(element_names(values), mechanism.elements):
        if not isinstance(element, PositionForce) or not isinstance(element.value, TableForce) or (
                element.factor == 0.0 or not any(element.value.table.values)):
            continue
        table, over = element.value.table, values[f'{name}.over']
        low, high = span_of(mechanism, partial(element.position, ARRAY))
        first, last = table.places[0], table.places[-1]
        is_angle = isinstance(element.over, LinkAngle) or (
            element.over == INPUT and not mechanism.is_driven_by_slide)
        unit = values[f'{name}.place_unit'] or ('rad' if is_angle else 'm')
        ends = [f'{end / float(POSITION_UNITS[unit]):.6g}' for end in (first, last, low, high)]
        ranges = (f'its table goes from {ends[0]} to {ends[1]}, {over} from {ends[2]} to '
                  f'{ends[3]} {unit}')
        slack = ROUNDED * (high - low)
        if not _acts(values, mechanism, element):
            is_outside = not is_angle and (last < low or first > high)
            if element.is_one_way and not is_outside:
                ranges = f'{over} never goes {element.when} where its table has a force'
            is_in_mm = unit == 'm' and first * 1e-3 < high and last * 1e-3 > low
            yield (f'{name} never acts: {ranges}'
                   + (': did you mean mm?' if is_outside and is_in_mm else ''))
        elif element.value.period == inf and (
                low < first - slack and table.values[0]
                or high > last + slack and table.values[-1]):
            yield f'{name}: {ranges}: beyond its ends the force is that at the end'


def _acts(values: ParameterValues, mechanism: Mechanism, force: PositionForce) -> bool:
    """Return whether a force is not 0 at some input, in a direction in which the drive moves."""
    speed = values['drive.speed']
    is_one_way = mechanism.turns_fully and values['drive.source'] == 'timer' and speed
    x: Any = inside_pieces(mechanism)
    for rate in [speed] if is_one_way else [1.0, -1.0]:
        moving = {**mechanism.link_motions(mechanism.motion(x, rate)), GROUND: FIXED}
        if any(np.any(part) for push in force.forces(ARRAY, moving, x, rate, 1.0)
               for part in (push.force_x, push.force_y, push.couple)):
            return True
    return False


def weak_springs(values: ParameterValues, mechanism: Mechanism) -> Iterator[str]:
    """Yield a line for each spring that is weak beside the links: likely meant in N/mm."""
    weight = hypot(*field_of(mechanism.gravity)) * sum(
        body.mass for body in mechanism.bodies or ())       # NaN on an unknown base
    for name, element in zip(element_names(values), mechanism.elements):
        if not isinstance(element, Spring) or not element.stiffness:
            continue

        def pull(moving: Any, _: Any, spring: Spring = element) -> Any:
            per_length, _, square = spring.tension(ARRAY, moving)
            return per_length * np.sqrt(square)
        force = max(map(abs, span_of(mechanism, pull)))
        if force < max(WEAK * weight, min(WEAKEST, weight)):
            yield (f'{name}.stiffness = {element.stiffness:g} N/m: its force is at most '
                   f'{force:.3g} N, the links weigh {weight:.3g} N: did you mean '
                   f'{element.stiffness:g} N/mm?')


def _spring(values: ParameterValues, name: str, mechanism: Mechanism) -> Element:
    """Return the spring of the parameters ``name``.*, springs.NAME or torsion_springs.NAME."""
    links, turns = (GROUND, *mechanism.loads_of_links()), name.startswith('torsion')
    of_links = [f'{name}.{end}' if turns else f'{name}.{end}.link' for end in ('first', 'second')]
    for parameter in of_links:
        if values[parameter] not in links:
            raise InvalidParameter(parameter, values[parameter], one_of(links, values[parameter]))
    stiffness, damping = values[f'{name}.stiffness'], values[f'{name}.damping']
    if not turns and values[of_links[0]] == values[of_links[1]] == GROUND:
        raise InvalidParameter(of_links[1], None, 'must be given: both ends of '
                               f'{name} are on the ground')
    try:
        if turns:
            return TorsionSpring(values[of_links[0]], values[of_links[1]], stiffness,
                                 free_angle=values[f'{name}.free_angle'], damping=damping)
        first, second = (Attachment(*point_in(f'{name}.{end}', values))
                         for end in ('first', 'second'))
        return Spring(first, second, stiffness, free_length=values[f'{name}.free_length'],
                      damping=damping, preload=values[f'{name}.preload'])
    except InvalidParameter as error:
        if error.name != 'second':
            raise
        raise InvalidParameter(of_links[1], error.value, error.allowed) from None


def _force(values: ParameterValues, name: str, mechanism: Mechanism) -> PositionForce:
    """Return the force of the parameters ``name``.*, checked by computing with it once."""
    link, acts = values[f'{name}.link'], values[f'{name}.acts']
    links = tuple(mechanism.loads_of_links())
    for field, known in (('link', links), ('from.link', (GROUND, *links))):
        if values[f'{name}.{field}'] not in known:
            raise InvalidParameter(f'{name}.{field}', values[f'{name}.{field}'],
                                   one_of(known, values[f'{name}.{field}']))
    over = _over(values, name, mechanism)
    turns_with_link, direction = ACTS.get(acts, (False, 0.0))
    try:
        force = PositionForce(
            Attachment(*point_in(name, values)), _table(values, name, over, mechanism), over,
            None if acts == COUPLE else direction + values[f'{name}.direction'],
            link if turns_with_link else GROUND, values[f'{name}.factor'],
            Attachment(*point_in(f'{name}.from', values)) if acts == APART else None,
            values[f'{name}.when'])
        force.fitted(mechanism)
    except InvalidParameter as error:
        field = {'is_periodic': 'periodic', 'apart_from': 'from.link'}.get(error.name, error.name)
        raise InvalidParameter(f'{name}.{field}', error.value, error.allowed) from None
    return force


def _table(values: ParameterValues, name: str, over: Over, mechanism: Mechanism) -> ForceTable:
    """Return the table of a force in SI units; errors are in the units of the scene."""
    is_couple = values[f'{name}.acts'] == COUPLE
    is_angle = not mechanism.is_driven_by_slide if over == INPUT else isinstance(over, LinkAngle)
    if file := values[f'{name}.table']:
        raise InvalidParameter('table', file, 'only the file of a scene names that of a table, '
                               'which is read with it; here give places and values')
    if not values[f'{name}.places']:
        raise InvalidParameter('table', None, 'must be given, or places and values: what acts '
                               'where')
    places, place_size, _ = _column(
        values, name, 'place', ('rad',) if is_angle else ('m',),
        f'{"an angle" if is_angle else "a length"}: over is {values[f"{name}.over"]}')
    forces, force_size, kind = _column(values, name, 'value', *(
        (('N m',), 'a couple') if is_couple else (('N', 'Pa'), 'a force or pressure')))
    if kind == 'Pa' and values[f'{name}.factor'] == 1.0:
        raise InvalidParameter('factor', 1.0, 'must be the area [m^2] on which the pressure acts, '
                               'negative against the direction')
    table = ForceTable(places, forces, values[f'{name}.periodic'],
                       values[f'{name}.interpolation'] == 'linear')
    return replace(table, places=[place_size * place for place in table.places],
                   values=[force_size * force for force in table.values])


def _column(values: ParameterValues, name: str, column: str, kinds: tuple[str, ...], allowed: str
            ) -> tuple[list[float], float, str]:
    """
    Return a column of a table, place or value, the size of its unit in SI, and the SI unit.

    ``kinds``: the SI units that it may have.
    """
    items, unit = values[f'{name}.{column}s'], values[f'{name}.{column}_unit']
    numbers = [quantity(item, *TABLE_UNITS) if isinstance(item, str) else item for item in items]
    of_texts = {number.unit: item for item, number in zip(items, numbers)
                if isinstance(number, ValueInSI) and number.unit}
    unit = unit or next(iter(of_texts), kinds[0])
    kind = next(si for si in TABLE_UNITS if unit in UNITS[si])
    for si, item in of_texts.items():
        if si not in kinds:
            raise InvalidParameter(f'{column}s', item, f'must have a unit of {allowed}')
        if si != kind:
            raise InvalidParameter(f'{column}s', item, f'the unit of the rest is {unit}')
    if kind not in kinds:
        raise InvalidParameter(f'{column}_unit', unit, f'must be a unit of {allowed}')
    size = float(UNITS[kind][unit])
    if not of_texts:
        return numbers, size, kind
    return [number if getattr(number, 'unit', '') else size * number
            for number in numbers], 1.0, kind


def _over(values: ParameterValues, name: str, mechanism: Mechanism) -> Over:
    """
    Return the coordinate that forces.NAME.over names: the force is a function of it.

    It is the input, an angle or slide of the mechanism, a coordinate of a point, ``P.x``, or the
    distance of two points.
    """
    over, driven = values[f'{name}.over'], mechanism.input_coordinate.position
    inputs: dict[str, Over] = {INPUT: INPUT, driven: INPUT}
    known = {**inputs, **_coordinates(mechanism), **inputs, DISTANCE: Distance(
        Attachment(*point_in(name, values)), Attachment(*point_in(f'{name}.from', values)))}
    for point in names_in('points', values):
        attachment = Attachment(*point_in(f'points.{point}', values))
        known |= {f'{point}.x': Way(attachment), f'{point}.y': Way(attachment, direction=0.5 * pi)}
    if over not in known:
        raise InvalidParameter(f'{name}.over', over, f'there is no such coordinate'
                                                     f'{nearest(over, known)}')
    return known[over]


def _coordinates(mechanism: Mechanism) -> dict[str, Over]:
    """Return {name: coordinate} of the angles and slides of a mechanism: theta4, theta_LINK."""
    names = [coordinate.position for coordinate in mechanism.PARTS]
    links = {link.name for link in mechanism.LINKS}
    coordinates: dict[str, Over] = {}
    for name in names:
        link = name.removeprefix('theta_')
        if name in ANGLES:
            coordinates[name] = LinkAngle(*ANGLES[name])
        elif link != name and link in links:
            coordinates[name] = LinkAngle(link)
    if hasattr(mechanism, 'stages'):
        from fourbar_ros.scene.machines import slides_in
        for link, origin, (cosine, sine) in slides_in(mechanism):
            coordinates[f'slide_{link}'] = Way(Attachment(link), Attachment(*origin),
                                               atan2(sine, cosine))
    elif 'slide' in names:
        # of a bar that turns, along it from its pivot; else along x
        coordinates['slide'] = (Way(Attachment('coupler'), Attachment('output'))
                                if mechanism.SLIDE_DIRECTION else Way(Attachment('output')))
    return coordinates
