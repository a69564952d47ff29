# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The structure of a machine: which dyad hangs on which links, and the names of joints and fields.

How long the links are is in the :class:`DyadLengths` of each dyad. The records of a machine
(motion, loads, bodies) are NamedTuple types that are made at run time; their values pass from
process to process.
"""
from collections.abc import Iterator
from functools import cache
from types import SimpleNamespace
from typing import Any, NamedTuple

from fourbar_ros.mechanisms import parts
from fourbar_ros.mechanisms.load_table import DERIVED
from fourbar_ros.numerics.number_types import Scalar

CRANK_LINK, SLIDER_LINK, CYLINDER = 'crank', 'slider', 'cylinder'
# {kind of dyad: names of its dimensions, in order}: lengths and offsets [m], angles [rad]
DIMENSIONS = {
    'RRR': ('length_1', 'length_2'),
    'RRP': ('length_1', 'direction_2'),
    'RPR': ('offset',),
    'RPP': ('direction_2', 'slot'),
    'PRP': ('direction_1', 'direction_2'),
}
# Kinds that have one assembly mode.
OF_ONE_MODE = ('RPP', 'PRP')


class DyadLengths(NamedTuple):
    """What the formulas of a dyad take: lengths [m], and cosine and sine of each angle."""

    p: tuple[Scalar, Scalar]            # where it hangs on the link of ``first``: along, across
    q: tuple[Scalar, Scalar]            # ... of ``second``
    sizes: tuple[Scalar, ...]           # its dimensions
    reach: tuple[Scalar, ...] = ()      # sizes of p and q
    shape: tuple[Any, ...] = ()         # of links joined to each other, see :func:`.pairs.shaped`


JOINTS = ('first', 'inner', 'second')
# {kind: {joint that slides: which link of the dyad slides there, 0 the first, 1 the second}}
SLIDES = {'RRR': {}, 'RRP': {'second': 1}, 'RPR': {'inner': 0}, 'RPP': {'inner': 0, 'second': 1},
          'PRP': {'first': 0, 'second': 1}}
BASE = 'base'


class Pair(NamedTuple):
    """That the two links on which a dyad hangs are joined to each other, see :mod:`.pairs`."""

    frame: int          # index of the carrier from which the motion of the dyad is seen
    moving: int         # ... of the one that moves in it
    slides: bool        # whether a slide joins the carriers, else a pin
    # whether its branch goes on through flat positions; False if its lengths are those of a change
    # point, but it lies flat nowhere in the ranges: then its side is its mode, as of any dyad
    can_lie_flat: bool = True


class Stage(NamedTuple):
    """One dyad in the structure of a machine; of links 0 is the frame, 1 the driven one."""

    name: str
    kind: str
    first: int                  # index of the link that carries its end P
    second: int                 # ... its end Q
    links: tuple[str, str]      # names of its own links
    link: int                   # index of the first of them; the second is the next
    pair: Pair | None = None    # of a dyad between links that are joined to each other

    def slides(self) -> list[str]:
        return [self.links[i] for i in SLIDES[self.kind].values()]

    def joints(self) -> list[tuple[str, str]]:
        """Return its three joints: ('first', 'd_first'), ... of dyad d."""
        return [(joint, f'{self.name}_{joint}') for joint in JOINTS]

    def ends(self, joint: str) -> tuple[int, int]:
        """Return the indices of the two links of a joint, the carrier first."""
        return {'first': (self.first, self.link), 'inner': (self.link, self.link + 1),
                'second': (self.second, self.link + 1)}[joint]

    def pins(self) -> Iterator[tuple[str, int, int]]:
        """Yield (name, index of the carrier, of the second link) of its pins."""
        for joint, name in self.joints():
            if joint not in SLIDES[self.kind]:
                yield name, *self.ends(joint)


class Layout(NamedTuple):
    """The structure of a machine."""

    # The first of its links is the frame from which all is solved: the ground, or of a drive
    # between two moving links that which carries the crank or the base of the cylinder. The second
    # is the driven one.
    driver: str                     # 'crank', 'slide' or 'cylinder'
    links: tuple[str, ...]          # names of all links
    stages: tuple[Stage, ...]       # in order; with a cylinder its own first
    output: str                     # name of the link that the machine is used for
    # A crank that does not turn fully counts within the turn that begins at this angle [rad]: a
    # pair that lies flat in it may have its other side a turn later.
    seam: float | None = None

    @property
    def moving(self) -> tuple[str, ...]:
        """Return the names of the moving links; a frame that moves has the ground's place."""
        return tuple([self.links[0] if link == parts.GROUND else link for link in self.links[1:]])

    @property
    def ground(self) -> int:
        """Return the index of the ground; 0: it is the frame."""
        return self.links.index(parts.GROUND)

    @property
    def driven(self) -> str:
        return self.links[1]

    def turning(self) -> set[str]:
        turns = [0, int(self.driven == CRANK_LINK)]     # equal numbers: they turn together
        for stage in self.stages:
            of_first, of_second, new = turns[stage.first], turns[stage.second], stage.link
            turns += {'RRR': (new, new + 1), 'RRP': (new, of_second), 'RPR': (new, new),
                      'RPP': (of_second, of_second), 'PRP': (of_first, of_second)}[stage.kind]
        return {name for name, turn in zip(self.links, turns) if turn != turns[self.ground]}

    def slides(self) -> list[str]:
        driven = [SLIDER_LINK] if self.driven == SLIDER_LINK else []
        return driven + [link for stage in self.stages for link in stage.slides()]

    def pins(self) -> list[tuple[str, int, int]]:
        """Return (name, indices of both links) of the pins between moving links."""
        every = [(BASE, 0, 1)] + [pin for stage in self.stages for pin in stage.pins()]
        return [pin for pin in every if self.ground not in pin[1:]]

    def joints(self) -> list[tuple[str, bool]]:
        """Return (name, whether it slides) of all joints, the one of the driven link first."""
        return [(BASE, self.driver == parts.SLIDE)] + [
            (name, joint in SLIDES[stage.kind]) for stage in self.stages
            for joint, name in stage.joints()]


def coordinate(name: str) -> parts.Coordinate:
    return parts.Coordinate(f'theta_{name}', f'omega_{name}', f'alpha_{name}')


def travel(link: str) -> parts.Coordinate:
    return parts.Coordinate(f'slide_{link}', f'slide_{link}_velocity',
                            f'slide_{link}_acceleration')


COEFFICIENTS = ('x', 'y', 'dx', 'dy', 'ddx', 'ddy', 'cos', 'sin', 'ratio', 'bend')


@cache
def motion_fields(layout: Layout) -> tuple[str, ...]:
    """Return the names of the fields of a motion, see :func:`.motion.motion_of`."""
    fields: list[str] = []
    for link in layout.moving:
        fields += coordinate(link)
    for link in layout.slides():
        fields += (*travel(link), f'slide_{link}_ratio')
    for pin, _, _ in layout.pins():
        fields += coordinate(pin)
    fields += (f'transmission_angle_{stage.name}' for stage in layout.stages)
    fields += ('transmission_angle', 'condition', 'rate', 'acceleration')
    for link in layout.moving:
        fields += (f'{name}_{link}' for name in COEFFICIENTS)
    fields += (f'sine_{stage.name}' for stage in layout.stages)
    return tuple(fields)


@cache
def load_fields(layout: Layout) -> tuple[str, ...]:
    fields: list[str] = []
    for name, is_slide in layout.joints():
        fields += (f'{name}_x', f'{name}_y', name)
        if is_slide:
            fields += (f'{name}_normal', f'{name}_couple')
    return (*fields, 'driving_torque', 'driving_force', 'shaking_force_x', 'shaking_force_y',
            'shaking_force', 'shaking_moment', *(row.name for row in DERIVED))


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
    links, fields = tuple(_links(layout)), motion_fields(layout)
    coordinates = {'crank': coordinate(BASE if layout.ground else CRANK_LINK),
                   'slide': travel(SLIDER_LINK)}
    rod = layout.stages[0].links[0] if layout.driver == CYLINDER else ''
    if rod:
        coordinates = {CYLINDER: travel(rod)}
    shown = {coordinate(link): f'{link} ({text})' for link, text, *_ in links if link in turning}
    shown.update((travel(link), f'{link} slides') for link in layout.slides())
    driven = coordinates[layout.driver]
    names = {
        'TORQUE': 'T' if layout.ground else 'T_{41}',
        'SLIDE_DIRECTION': (f'cos_{rod}', f'sin_{rod}') if rod else None,
        'LINKS': links, 'JOINTS': tuple(_joints(layout)), 'REACTIONS': tuple(_reactions(layout)),
        'PARTS': shown, 'DRAWN': tuple(dict.fromkeys((driven, output_of(layout).coordinate))),
        'INPUTS': {layout.driver: driven}, 'OUTPUTS': {layout.driver: _outputs(layout, driven)},
        'MOTION': parts.record_type('MachineMotion', fields),
        'LOADS': parts.record_type('MachineLoads', load_fields(layout)),
        'BODIES': parts.record_type('MachineBodies', layout.moving),
        'EXTERNAL': parts.record_type('MachineExternal', layout.moving),
        'QUANTITIES': tuple(_quantities(layout, driven))}
    from fourbar_ros.mechanisms.quantities import fields_of  # it imports mechanisms
    meanings = fields_of(SimpleNamespace(**names), driven)
    names['MOTION'] = parts.documented(names['MOTION'], meanings, fields.index('rate'))
    names['LOADS'] = parts.documented(names['LOADS'], meanings)
    return names


def _links(layout: Layout) -> list[parts.Link]:
    """Return the moving links with their first joints: the driven one, then those of dyads."""
    # Where the frame moves, the ground is a link of a dyad, and the frame stands there.
    turning = layout.turning()
    links = [parts.Link(layout.driven, layout.driven, BASE if layout.ground else 'O1',
                        turns=layout.driven in turning)]
    for stage in layout.stages:
        joints = dict(stage.joints())
        for link, (role, joint, length) in zip(stage.links, LINKS_OF_DYADS[stage.kind]):
            links.append(
                parts.Link(layout.links[0], 'frame', BASE) if link == parts.GROUND else
                parts.Link(link, role, joints[joint], length and f'{stage.name}.{length}',
                           turns=link in turning))
    return links


def _reactions(layout: Layout) -> list[parts.Reaction]:
    """Return the reaction at each joint, exerted by the link on which the other hangs."""
    # At the inner joint of a dyad its second link acts on its first, as in solve/loads.py.
    links = layout.links
    bodies = {BASE: (links[0], links[1])}       # (acting, loaded)
    for stage in layout.stages:
        first, second = stage.links
        pairs = {'first': (links[stage.first], first), 'inner': (second, first),
                 'second': (links[stage.second], second)}
        bodies.update((name, pairs[joint]) for joint, name in stage.joints())
    return [parts.Reaction(name, ' on '.join(bodies[name]), name, is_slide * f'{name}_couple')
            for name, is_slide in layout.joints()]


def _joints(layout: Layout) -> list[parts.Joint]:
    """Return all joints: pins with the angle between links, slides with the place on them."""
    moving = {name for name, _, _ in layout.pins()}
    base = (travel(SLIDER_LINK) if layout.driven == SLIDER_LINK else
            coordinate(BASE if BASE in moving else CRANK_LINK))
    joints = [parts.Joint(BASE, base)]
    for stage in layout.stages:
        slides = SLIDES[stage.kind]
        for joint, name in stage.joints():
            if joint in slides:
                moves = travel(stage.links[slides[joint]])
            else:       # of two links that which is not the ground
                ends = stage.ends(joint)
                link = layout.links[ends[ends[1] != layout.ground]]
                moves = coordinate(name if name in moving else link)
            joints.append(parts.Joint(name, moves))
    return joints


def output_of(layout: Layout) -> parts.Output:
    """Return the output of a machine: the angle of its output link, or the slide of that."""
    link = layout.output
    if link in layout.turning():
        return parts.Output(coordinate(link), f'ratio_{link}')
    return parts.Output(travel(link), f'slide_{link}_ratio')


def _outputs(layout: Layout, driven: parts.Coordinate) -> tuple[parts.Output, ...]:
    turning = layout.turning()
    every = [output_of(layout),
             *(parts.Output(coordinate(link), f'ratio_{link}') for link in layout.moving
               if link in turning),
             *(parts.Output(travel(link), f'slide_{link}_ratio') for link in layout.slides())]
    return tuple(dict.fromkeys(output for output in every if output.coordinate != driven))


def _quantities(layout: Layout, driven: parts.Coordinate) -> list[parts.Quantity]:
    """Return the quantities beyond those of all mechanisms: of links, slides, dyads and joints."""
    turning, rows = layout.turning(), list[tuple[str, str, str]]()
    for link in [link for link in layout.moving if link in turning]:
        rows += zip(coordinate(link), ('rad', 'rad/s', 'rad/s^2'), (
            f'angle of {link}, from -pi to pi; its extrema go on', f'angular velocity of {link}',
            f'angular acceleration of {link}'))
    for link in layout.slides():
        rows += zip(travel(link), ('m', 'm/s', 'm/s^2'), [
            f'{name} of {link} along its slide' for name in ('position', 'velocity',
                                                             'acceleration')])
    rows += [(f'transmission_angle_{name}', 'rad', f'transmission angle of dyad {name}')
             for name in [stage.name for stage in layout.stages]]
    quantities = [parts.Quantity(*row, False) for row in rows]
    for name, is_slide in layout.joints():
        rows = [(name, 'N', f'magnitude of the reaction at joint {name}'),
                (f'{name}_normal', 'N', f'force square to the slide {name}'),
                (f'{name}_couple', 'N m', f'couple of the slide {name}')]
        quantities += [parts.Quantity(*row, True) for row in rows[:3 if is_slide else 1]]
    return [quantity for quantity in quantities if quantity.name not in driven]
