# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The machine of dyads that the parameters of a scene describe."""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import isnan
from typing import Any

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.machine.describe.description import ANGLES, by_link, Cylinder, Dyad
from fourbar_ros.mechanisms.machine.machine import Machine, NO_BODY
from fourbar_ros.mechanisms.machine.solve.pairs import slides_of
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths
from fourbar_ros.mechanisms.machine.structure import DIMENSIONS as OF_KIND
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.number_types import direction_in, NumberType, Scalar
from fourbar_ros.scene.parameters import names_in, point_in
from fourbar_ros.scene.settings import ParameterValues

DIMENSIONS = 'length_1', 'length_2', 'offset', 'direction_1', 'direction_2', 'slot'
ROD_MODEL = 'rods'


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
    if values['linkage.mode'] != 2:
        raise InvalidParameter('linkage.mode', values['linkage.mode'],
                               'the assembly modes of a machine are dyads.NAME.mode')
    for name in names:
        if ROD_MODEL in values[f'dyads.{name}.links']:
            raise InvalidParameter(f'dyads.{name}.links', ROD_MODEL,
                                   'bodies.rods is the model of all rods: choose another name')
    stroke = values['linkage.range']
    return Machine(tuple(_dyad(name, values) for name in names), values['linkage.input'],
                   values['linkage.output'] or None, _cylinder(values),
                   stroke=tuple(stroke) if stroke else None)


def lengths_of(machine: Machine, values: ParameterValues,
               arithmetic: NumberType) -> tuple[DyadLengths, ...]:
    """
    Return the lengths, points and directions of all dyads of a machine, in any arithmetic.

    With it a study computes many machines at once. ``machine`` has the same dyads. ``values``
    holds all parameters; those that vary may be arrays of the ``arithmetic``.
    """
    along, cylinder = partial(direction_in, arithmetic), machine.cylinder and machine.stages[0]
    return tuple([_lengths(dyad, values, along, dyad is cylinder) for dyad in machine.stages])


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


def _lengths(dyad: Dyad, values: ParameterValues,
             along: Callable[[Scalar], tuple[Scalar, Scalar]], is_cylinder: bool) -> DyadLengths:
    """
    Return the lengths of a dyad, or of the cylinder: a dyad of rod and tube.

    They are the points (along, across) [m] of the links where it hangs and its dimensions;
    ``along`` returns (cos, sin) of an angle.
    """
    prefix, ends = (('cylinder.', ('pin', 'base')) if is_cylinder else
                    (f'dyads.{dyad.name}.', ('first', 'second')))
    p, q = [(values[f'{prefix}{end}.along'], values[f'{prefix}{end}.across']) for end in ends]
    sizes: list[Scalar] = []
    for name in OF_KIND[dyad.kind]:
        value = values.get(prefix + name)
        if value is None or isinstance(value, float) and isnan(value):
            value = getattr(dyad, name)      # the default of an offset
        sizes += along(value) if name in ANGLES else (value,)
    return DyadLengths(p, q, tuple(sizes))


def _dyad(name: str, values: ParameterValues) -> Dyad:
    """Return the dyad of the parameters dyads.NAME.*; dimensions that are not given are None."""
    group = f'dyads.{name}'
    sizes = {field: values[f'{group}.{field}'] for field in DIMENSIONS}
    return Dyad(name, values[f'{group}.kind'], point_in(f'{group}.first', values),
                point_in(f'{group}.second', values), tuple(values[f'{group}.links']),
                mode=values[f'{group}.mode'],
                **{field: None if isnan(size) else size for field, size in sizes.items()})


def _cylinder(values: ParameterValues) -> Cylinder | None:
    if values['linkage.input'] != CYLINDER:
        return None
    return Cylinder(point_in('cylinder.base', values), point_in('cylinder.pin', values),
                    tuple(values['cylinder.links']), values['cylinder.mode'])
