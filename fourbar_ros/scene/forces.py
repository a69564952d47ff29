# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Forces over a position in a scene: where they act, over which coordinate, from which table.

A table may stand in a CSV file beside the file of a scene, which is read with it: a scene itself
holds the numbers, and opens no file, whoever made it.
"""
from __future__ import annotations

from math import atan2, pi

from fourbar_ros.dynamics.elements import Attachment, INPUT, LinkAngle, Place, PositionForce, Way
from fourbar_ros.dynamics.force_table import ForceTable
from fourbar_ros.dynamics.forces import make_loaded
from fourbar_ros.errors import InvalidParameter, nearest, one_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.scene.parameters import names_in, point_in
from fourbar_ros.scene.settings import COUPLE, OF_PLACES, OF_VALUES, ParameterValues
from fourbar_ros.scene.units import UNITS

FAMILY = 'forces'
# forces.NAME.acts: (whether the direction turns with the link, angle from its x axis [rad])
ACTS = {'x': (False, 0.0), 'y': (False, 0.5 * pi), 'along': (True, 0.0),
        'across': (True, 0.5 * pi)}
# angles of the kinds of linkages: (link, link from which its angle counts)
ANGLES = {'theta1': ('crank', GROUND), 'theta2': ('coupler', 'crank'),
          'theta4': ('output', GROUND), 'beta': ('coupler', GROUND)}


def forces_of(values: ParameterValues, linkage: Mechanism) -> tuple[PositionForce, ...]:
    """Return the forces over a position of a scene; InvalidParameter names the parameter."""
    names = names_in(FAMILY, values)
    if names and linkage.bodies is None:
        raise InvalidParameter('bodies.crank.mass', None, 'must be given (or bodies.rods): '
                               f'{FAMILY}.{names[0]} needs masses')
    return tuple([_force(values, f'{FAMILY}.{name}', linkage) for name in names])


def _force(values: ParameterValues, name: str, linkage: Mechanism) -> PositionForce:
    """Return the force of the parameters ``name``.*, checked by computing with it once."""
    own = {field: values[f'{name}.{field}'] for field in
           ('link', 'acts', 'direction', 'factor', 'periodic')}
    links = tuple(linkage.loads_of_links())
    if own['link'] not in links:
        raise InvalidParameter(f'{name}.link', own['link'], one_of(links, own['link']))
    over = _over(values, name, linkage)
    is_couple = own['acts'] == COUPLE
    turns, direction = ACTS.get(own['acts'], (False, 0.0))
    places, forces = _numbers(values, name, over, linkage)
    try:
        table = ForceTable(places, forces, own['periodic'],
                           values[f'{name}.interpolation'] == 'linear')
        force = PositionForce(
            Attachment(*point_in(name, values)), table, over,
            None if is_couple else direction + own['direction'],
            own['link'] if turns else GROUND, own['factor'])
        make_loaded(linkage, (force,))
    except InvalidParameter as error:
        field = 'periodic' if error.name == 'is_periodic' else error.name
        raise InvalidParameter(f'{name}.{field}', error.value, error.allowed) from None
    return force


def _numbers(values: ParameterValues, name: str, over: Place, linkage: Mechanism
             ) -> tuple[list[float], list[float]]:
    """
    Return the two columns of a table in SI units; refuse units that do not fit.

    Places in [rad] or [m], and forces [N], couples [N m] or pressures [Pa].
    """
    is_angle = (not linkage.is_driven_by_slide if over == INPUT else isinstance(over, LinkAngle))
    place_unit = values[f'{name}.place_unit'] or ('rad' if is_angle else 'm')
    is_couple = values[f'{name}.acts'] == COUPLE
    value_unit = values[f'{name}.value_unit'] or ('N m' if is_couple else 'N')
    if file := values[f'{name}.table']:
        raise InvalidParameter(f'{name}.table', file, 'only the file of a scene names that of a '
                               'table, which is read with it; here give places and values')
    if not values[f'{name}.places']:
        raise InvalidParameter(f'{name}.table', None, 'must be given, or places and values: what '
                                                      'acts where')
    if (place_unit in UNITS['rad']) is not is_angle:
        raise InvalidParameter(f'{name}.place_unit', place_unit, 'must be a unit of '
                               f'{"an angle" if is_angle else "a length"}: over is '
                               f'{values[f"{name}.over"]}')
    if value_unit in UNITS['Pa'] and (is_couple or values[f'{name}.factor'] == 1.0):
        raise InvalidParameter(f'{name}.factor', values[f'{name}.factor'], 'must be the area '
                               f'[m^2] on which the pressure [{value_unit}] acts, negative '
                               'against the direction')
    if value_unit not in UNITS['Pa'] and is_couple is not (value_unit in UNITS['N m']):
        raise InvalidParameter(f'{name}.value_unit', value_unit, 'must be a unit of '
                               f'{"a couple" if is_couple else "a force or pressure"}')
    by_place, by_value = float(OF_PLACES[place_unit]), float(OF_VALUES[value_unit])
    return ([by_place * place for place in values[f'{name}.places']],
            [by_value * value for value in values[f'{name}.values']])


def _over(values: ParameterValues, name: str, linkage: Mechanism) -> Place:
    """
    Return the coordinate that forces.NAME.over names: the force is a function of it.

    It is the input, an angle or slide of the linkage, or a coordinate of a point, ``P.x``.
    """
    over, driven = values[f'{name}.over'], linkage.input_coordinate.position
    known: dict[str, Place] = {INPUT: INPUT, driven: INPUT}
    known.update(item for item in _coordinates(linkage).items() if item[0] != driven)
    for point in names_in('points', values):
        place = Attachment(*point_in(f'points.{point}', values))
        known |= {f'{point}.x': Way(place), f'{point}.y': Way(place, direction=0.5 * pi)}
    if over not in known:
        raise InvalidParameter(f'{name}.over', over, f'there is no such coordinate'
                                                     f'{nearest(over, known)}')
    return known[over]


def _coordinates(linkage: Mechanism) -> dict[str, Place]:
    """Return {name: place} of the angles and slides of a mechanism: theta4, slide, theta_LINK."""
    names = [coordinate.position for coordinate in linkage.PARTS]
    places: dict[str, Place] = {}
    for name in names:
        link = name.removeprefix('theta_')
        if name in ANGLES:
            places[name] = LinkAngle(*ANGLES[name])
        elif link != name and link in [its.name for its in linkage.LINKS]:
            places[name] = LinkAngle(link)
    if hasattr(linkage, 'stages'):
        from fourbar_ros.scene.machines import slides_in
        places |= {f'slide_{link}': Way(Attachment(link), Attachment(*origin), atan2(sine, cosine))
                   for link, origin, (cosine, sine) in slides_in(linkage)}
    elif 'slide' in names:
        # of a bar that turns, along it from its pivot; else along x
        places['slide'] = (Way(Attachment('coupler'), Attachment('output'))
                           if linkage.SLIDE_DIRECTION else Way(Attachment('output')))
    return places
