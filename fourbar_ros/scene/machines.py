# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The machine of dyads that the parameters of a scene describe."""
from collections.abc import Iterator, Sequence
from math import isnan
from typing import Any

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.machine.description import ANGLES, by_link, Cylinder, Dyad
from fourbar_ros.mechanisms.machine.machine import Machine, NO_BODY
from fourbar_ros.mechanisms.machine.solve.pairs import slides_of
from fourbar_ros.mechanisms.machine.structure import BASE, CYLINDER, DyadLengths, SLIDES
from fourbar_ros.mechanisms.machine.structure import DIMENSIONS as OF_KIND
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.number_types import direction_in, NumberType, REAL, Scalar
from fourbar_ros.scene.parameters import names_in, point_in
from fourbar_ros.scene.settings import ParameterValues

DIMENSIONS = 'length_1', 'length_2', 'offset', 'direction_1', 'direction_2', 'slot'
ROD_MODEL = 'rods'
POINTS = 'linkage.points'
COORDINATES = 'x', 'y', 'along', 'across', 'distance_1', 'distance_2'    # of a named point


def machine_of(values: ParameterValues) -> Machine:
    """Return the machine that values describe, without bodies; raises InvalidParameter."""
    names = values['linkage.dyads']
    if not names and values['linkage.input'] != CYLINDER:
        raise InvalidParameter('linkage.dyads', None, 'must be given: the names of the dyads, '
                                                      'in order')
    for name in names_in('dyads', values):
        if name not in names:
            raise InvalidParameter(f'dyads.{name}', None, 'is not listed in linkage.dyads'
                                                          f'{nearest(name, names)}')
    if values['linkage.mode'] != 2:         # not its default
        raise InvalidParameter('linkage.mode', values['linkage.mode'],
                               'the assembly modes of a machine are dyads.NAME.mode')
    for name in names:
        if ROD_MODEL in values[f'dyads.{name}.links']:
            raise InvalidParameter(f'dyads.{name}.links', ROD_MODEL,
                                   'bodies.rods is the model of all rods: choose another name')
    stroke = values['linkage.range']
    # {end of a dyad: the named point on which it hangs}
    hang = {f'{name}.{end}': point for name in names for end in ('first', 'second')
            if (point := values.get(f'dyads.{name}.{end}'))}
    # {joint: the parameter that names it}
    named = {BASE: 'linkage.pivot', **{
        f'{name}_inner': f'dyads.{name}.inner' for name in names}, **{
        f'{name}_{end}': f'dyads.{name}.{end}' for name in names for end in ('first', 'second')
        if f'{name}.{end}' in hang and end not in SLIDES.get(values[f'dyads.{name}.kind'], ())}}
    try:
        dyads = []
        for name in names:
            group = f'dyads.{name}'
            sizes = {field: values[f'{group}.{field}'] for field in DIMENSIONS}
            dyads.append(Dyad(
                name, values[f'{group}.kind'], hanging_point(f'{group}.first', values),
                hanging_point(f'{group}.second', values), tuple(values[f'{group}.links']),
                mode=values[f'{group}.mode'],
                **{field: None if isnan(size) else size for field, size in sizes.items()}))
        cylinder = None
        if values['linkage.input'] == CYLINDER:
            cylinder = Cylinder(
                point_in('cylinder.base', values), point_in('cylinder.pin', values),
                tuple(values['cylinder.links']), values['cylinder.mode'])
        machine = Machine(tuple(dyads), values['linkage.input'], values['linkage.output'] or None,
                          cylinder, stroke=tuple(stroke) if stroke else None,
                          carrier=values['linkage.carrier'], joint_names={
                              joint: values[parameter] for joint, parameter in named.items()
                              if values[parameter]})
    except InvalidParameter as error:
        parameter = named.get(error.name.removeprefix('joint_names.'))
        if parameter:
            raise InvalidParameter(parameter, error.value, error.allowed) from None
        # of a wrong dyads.D.first.link, where dyads.D.first names a point, the point is at fault
        end = '.'.join(error.name.split('.')[:3])
        point = values.get(end)
        if not point or error.name == end:
            raise
        raise InvalidParameter(f'{POINTS}.{point}', error.value,
                               f'{error.allowed} ({end})') from None
    for name in names_in(POINTS, values):
        if name not in hang.values():
            raise InvalidParameter(f'{POINTS}.{name}', None, 'no dyad hangs on this point')
    return machine


def lengths_of(machine: Machine, values: ParameterValues, n: NumberType
               ) -> tuple[DyadLengths, ...]:
    """
    Return lengths, points and directions of all dyads of a machine, in the arithmetic ``n``.

    With it a study computes many machines at once. ``machine`` has the same dyads; a cylinder is
    one of rod and tube. ``values``: all parameters; those that vary may be arrays. The points are
    (along, across) [m] on the links where a dyad hangs.
    """
    lengths = []
    for dyad in machine.stages:
        prefix, ends = (('cylinder.', ('pin', 'base'))
                        if machine.cylinder and dyad is machine.stages[0]
                        else (f'dyads.{dyad.name}.', ('first', 'second')))
        p, q = [hanging_point(f'{prefix}{end}', values, n)[1:] for end in ends]
        sizes: list[Scalar] = []
        for name in OF_KIND[dyad.kind]:
            value = values.get(prefix + name)
            if value is None or isinstance(value, float) and isnan(value):
                value = getattr(dyad, name)      # the default of an offset
            sizes += direction_in(n, value) if name in ANGLES else (value,)
        lengths.append(DyadLengths(p, q, tuple(sizes)))
    return tuple(lengths)


def with_named_points(machine: Mechanism, values: ParameterValues, n: NumberType,
                      lengths: Sequence[DyadLengths]) -> tuple[DyadLengths, ...]:
    """Return lengths of all dyads, in any arithmetic, with the points that ``values`` name."""
    assert isinstance(machine, Machine)
    rods = {f'dyads.{dyad.name}.{name}': size for dyad, of_dyad in zip(machine.stages, lengths)
            for name, size in zip(OF_KIND[dyad.kind], of_dyad.sizes) if 'length' in name}
    return tuple([of_dyad._replace(**{
        end: hanging_point(name, {**values, **rods}, n)[1:]
        for end, name in (('p', f'dyads.{dyad.name}.first'), ('q', f'dyads.{dyad.name}.second'))
        if values.get(name)}) for dyad, of_dyad in zip(machine.stages, lengths)])


def slides_in(machine: Mechanism, lengths: Sequence[DyadLengths] = ()
              ) -> Iterator[tuple[str, Point, tuple[float, float]]]:
    """
    Yield (sliding link, point of its carrier where it counts from, unit vector along the slide).

    The vector is in the frame of the carrier, on which the link slides. ``lengths``: of all dyads
    in any arithmetic, by default those of the machine.
    """
    assert isinstance(machine, Machine)
    links = machine.layout.links
    lengths = lengths or [dyad.lengths for dyad in machine.stages]
    for stage, of_dyad in zip(machine.layout.stages, lengths):
        for link, (carrier, point, along) in slides_of(stage, of_dyad):
            yield links[link], Point(links[carrier], *point), along


def bodies_of(machine: Machine, bodies: dict[str, Body] | None) -> Any:
    """Return the bodies of all links, massless where there is none; None for None."""
    return by_link('bodies', bodies, Body, machine.BODIES, NO_BODY)


def hanging_point(name: str, values: ParameterValues, n: NumberType = REAL) -> Point:
    """
    Return the point on which a dyad hangs: of NAME.link, .along, .across, or the one NAME names.

    Its coordinates [m] are of the arithmetic ``n``. With the length L of its link, a rod, and its
    distances d1 and d2 from both ends of this:

        2 L along = L^2 + (d1 - d2) (d1 + d2)
        (2 L across)^2 = (d1 + d2 + L) (d1 + d2 - L) (L + d1 - d2) (L - d1 + d2)

    InvalidParameter if there is no such point, or if it is given in two ways or in none.
    """
    point = values.get(name)
    if not point:
        return point_in(name, values)
    group = f'{POINTS}.{point}'
    if f'{group}.link' not in values:
        raise InvalidParameter(name, point, f'there is no such point in {POINTS}'
                               f'{nearest(point, names_in(POINTS, values))}')
    link, side = values[f'{group}.link'], values[f'{group}.side']
    x, y, along, across, d1, d2 = [
        None if isinstance(value, float) and isnan(value) else value for value in [
            values[f'{group}.{field}'] for field in COORDINATES]]
    of_ground, of_link, of_ends = [any(value is not None for value in pair)
                                   for pair in ((x, y), (along, across), (d1, d2))]
    if of_ground + of_link + of_ends > 1 or of_ground and link:
        raise InvalidParameter(group, None, 'stands twice: give x and y of the ground, or a link '
                               'with along and across, or with distances from its ends')
    if not (link or of_ground):
        raise InvalidParameter(f'{group}.link', None, 'must be given: the link that has the '
                               'point; or x and y, if it is of the ground')
    if bool(side) is not (of_ends and d1 is not None and d2 is not None):
        raise InvalidParameter(f'{group}.side', side or None, 'must be left or right, with '
                               'distance_1 and distance_2, and only then')
    if not of_ends:
        coordinates = (x, y) if of_ground else (along, across)
        return Point(link or GROUND, *[0.0 if value is None else value for value in coordinates])
    rod = next((f'dyads.{dyad}.length_{i}' for dyad in values['linkage.dyads']
                for i, name_of_link in enumerate(values[f'dyads.{dyad}.links'], 1)
                if name_of_link == link
                and f'length_{i}' in OF_KIND.get(values[f'dyads.{dyad}.kind'], ())), '')
    if not rod or d2 is None:
        raise InvalidParameter(f'{group}.distance_{1 if d2 is None else 2}', None,
                               'give along and across: ' + (
                                   'one distance from the first joint is along' if rod else
                                   f'{link} is no rod of a dyad, with pins at both ends'))
    length = values[rod]
    if d1 is None:
        return Point(link, length - d2, 0.0)
    square = (d1 + d2 + length) * (d1 + d2 - length) * (length + d1 - d2) * (length - d1 + d2)
    if isinstance(square, float) and square < 0.0:
        raise InvalidParameter(f'{group}.distance_2', d2, f'makes no triangle with distance_1 = '
                               f'{d1:g} and {rod} = {length:g}')
    height = n.sqrt(square) / (2.0 * length)
    return Point(link, 0.5 * (length + (d1 - d2) * (d1 + d2) / length),
                 height if side == 'left' else -height)
