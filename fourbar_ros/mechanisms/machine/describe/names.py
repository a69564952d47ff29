# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The facts that a machine states, LINKS to QUANTITIES, from its layout.

Its records (motion, loads, bodies) are NamedTuple types that are made at run time; their values
pass from process to process.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from fourbar_ros.mechanisms.machine.describe.description import ANGLES, Dyad
from fourbar_ros.mechanisms.machine.structure import (
    BASE,
    coordinate,
    CRANK_LINK,
    CYLINDER,
    DIMENSIONS,
    Layout,
    load_fields,
    motion_fields,
    SLIDER_LINK,
    SLIDES,
    travel,
)
from fourbar_ros.mechanisms.parts import (
    Coordinate,
    GROUND,
    Joint,
    Length,
    Link,
    Output,
    Quantity,
    Reaction,
    reaction,
    record_type,
)

# {kind of dyad: of both links the name in texts, the first joint, and which length it has}
LINKS_OF_DYADS = {
    'RRR': (('rod', 'first', 'length_1'), ('rod', 'second', 'length_2')),
    'RRP': (('rod', 'first', 'length_1'), ('block', 'inner', '')),
    'RPR': (('block', 'first', ''), ('bar', 'second', '')),
    'RPP': (('block', 'first', ''), ('yoke', 'second', '')),
    'PRP': (('block', 'inner', ''), ('block', 'inner', ''))}


@cache
def names_of(layout: Layout) -> dict[str, Any]:
    """Return the facts of :class:`.Mechanism` that follow from a layout, by name."""
    turning = layout.turning()
    links = tuple(_links(layout))
    coordinates = {'crank': coordinate(BASE if layout.ground else CRANK_LINK),
                   'slide': travel(SLIDER_LINK)}
    if layout.driver == CYLINDER:
        coordinates = {CYLINDER: travel(layout.stages[0].links[0])}
    parts = {coordinate(link): f'{link} ({text})' for link, text, *_ in links if link in turning}
    parts.update((travel(link), f'{link} slides') for link in layout.slides())
    driven = coordinates[layout.driver]
    return {
        'LINKS': links, 'JOINTS': tuple(_joints(layout)), 'REACTIONS': tuple(_reactions(layout)),
        'PARTS': parts, 'DRAWN': tuple(dict.fromkeys((driven, output_of(layout).coordinate))),
        'INPUTS': {layout.driver: driven}, 'OUTPUTS': {layout.driver: _outputs(layout, driven)},
        'MOTION': record_type('MachineMotion', motion_fields(layout)),
        'LOADS': record_type('MachineLoads', load_fields(layout)),
        'BODIES': record_type('MachineBodies', layout.moving),
        'EXTERNAL': record_type('MachineExternal', layout.moving),
        'QUANTITIES': tuple(_quantities(layout, driven))}


def _links(layout: Layout) -> list[Link]:
    """Return the moving links with their first joints: the driven one, then those of dyads."""
    turning = layout.turning()
    links = [Link(layout.driven, layout.driven, BASE if layout.ground else 'O1',
                  turns=layout.driven in turning)]
    for stage in layout.stages:
        joints = dict(stage.joints())
        for link, (role, joint, length) in zip(stage.links, LINKS_OF_DYADS[stage.kind]):
            links.append(Link(layout.links[0], 'frame', BASE) if link == GROUND else Link(
                link, role, joints[joint], length and f'{stage.name}.{length}',
                turns=link in turning))
    return links


def _reactions(layout: Layout) -> list[Reaction]:
    """Return the reaction at each joint, exerted by the link on which the other hangs."""
    links = layout.links
    bodies = {BASE: (links[0], links[1])}
    for stage in layout.stages:
        first, second = stage.links
        pairs = {'first': (links[stage.first], first), 'inner': (second, first),
                 'second': (links[stage.second], second)}
        bodies.update((name, pairs[joint]) for joint, name in stage.joints())
    return [reaction(name, ' on '.join(bodies[name]), name, f'{name}_couple' if is_slide else '')
            for name, is_slide in layout.joints()]


def _joints(layout: Layout) -> list[Joint]:
    """Return all joints: pins with the angle between links, slides with the place on them."""
    moving = {name for name, _, _ in layout.pins()}
    base = (travel(SLIDER_LINK) if layout.driven == SLIDER_LINK else
            coordinate(BASE if BASE in moving else CRANK_LINK))
    joints = [Joint(BASE, base)]
    for stage in layout.stages:
        slides = SLIDES[stage.kind]
        for joint, name in stage.joints():
            if joint in slides:
                moves = travel(stage.links[slides[joint]])
            else:       # of two links that which is not the ground
                ends = stage.ends(joint)
                link = layout.links[ends[ends[1] != layout.ground]]
                moves = coordinate(name if name in moving else link)
            joints.append(Joint(name, moves))
    return joints


def output_of(layout: Layout) -> Output:
    """Return the output of a machine: the angle of its output link, or the slide of that."""
    link = layout.output
    if link in layout.turning():
        return Output(coordinate(link), f'ratio_{link}')
    return Output(travel(link), f'slide_{link}_ratio')


def _outputs(layout: Layout, driven: Coordinate) -> tuple[Output, ...]:
    """Return all outputs, the one that the machine is used for first."""
    turning = layout.turning()
    every = [output_of(layout),
             *(Output(coordinate(link), f'ratio_{link}') for link in layout.moving
               if link in turning),
             *(Output(travel(link), f'slide_{link}_ratio') for link in layout.slides())]
    return tuple(dict.fromkeys(output for output in every if output.coordinate != driven))


def _quantities(layout: Layout, driven: Coordinate) -> list[Quantity]:
    """Return the quantities beyond those of all mechanisms: of links, slides, dyads and joints."""
    quantities = []
    for link in [link for link in layout.moving if link in layout.turning()]:
        quantities += _of_coordinate(coordinate(link), f'of {link}')
    for link in layout.slides():
        quantities += _of_coordinate(travel(link), f'of {link} along its slide')
    quantities += [Quantity(f'transmission_angle_{stage.name}', 'rad',
                            f'transmission angle of dyad {stage.name}', False)
                   for stage in layout.stages]
    for name, is_slide in layout.joints():
        quantities.append(Quantity(name, 'N', f'magnitude of the reaction at joint {name}', True))
        if is_slide:
            quantities += [Quantity(f'{name}_normal', 'N', f'force square to the slide {name}',
                                    True),
                           Quantity(f'{name}_couple', 'N m', f'couple of the slide {name}', True)]
    return [quantity for quantity in quantities if quantity.name not in driven]


def _of_coordinate(coordinate: Coordinate, text: str) -> list[Quantity]:
    """Return position, rate and acceleration of a coordinate; ``text``: whose it is."""
    unit, terms = coordinate.unit, ('position {}', 'velocity {}', 'acceleration {}')
    if unit == 'rad':
        terms = 'angle {}, continuous', 'angular velocity {}', 'angular acceleration {}'
    return [Quantity(name, unit + per, term.format(text), False)
            for name, per, term in zip(coordinate, ('', '/s', '/s^2'), terms)]


def lengths_of(dyads: Sequence[Dyad]) -> list[tuple[Length, float]]:
    """Return all lengths that are not zero: places of points, rods, offsets; and their values."""
    lengths = []
    for dyad in dyads:
        for end in ('first', 'second'):
            point = getattr(dyad, end)
            of = 'the ground' if point.link == GROUND else f'link {point.link}'
            lengths += [(Length(f'{dyad.name}.{end}.{name}', f'of a point of {of}', True), value)
                        for name, value in (('along', point.along), ('across', point.across))]
        lengths += [(Length(f'{dyad.name}.{name}', f'of dyad {dyad.name}', name == 'offset'),
                     getattr(dyad, name)) for name in DIMENSIONS[dyad.kind] if name not in ANGLES]
    return [(length, value) for length, value in lengths if value]
