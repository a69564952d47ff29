# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The structure of a machine and the names that follow: of links, joints, slides, fields.

Which dyad hangs on which links, not how long these are.
"""
from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import DERIVED
from fourbar_ros.mechanisms.machine.describe.description import (
    CRANK_LINK,
    CYLINDER,
    Dyad,
    PRP,
    RPP,
    RPR,
    RRP,
    RRR,
    SLIDER_LINK,
)
from fourbar_ros.mechanisms.parts import Coordinate, GROUND

PLACES = ('first', 'inner', 'second')
# {kind: {joint that slides: which link of the dyad slides there, 0 the first, 1 the second}}
SLIDES = {RRR: {}, RRP: {'second': 1}, RPR: {'inner': 0}, RPP: {'inner': 0, 'second': 1},
          PRP: {'first': 0, 'second': 1}}
BASE = 'base'


class Pair(NamedTuple):
    """That the two links on which a dyad hangs are joined to each other, see :mod:`.pairs`."""

    frame: int          # number of the one of them from which the motion of the dyad is seen
    slides: bool        # whether a slide joins them, else a pin


class Stage(NamedTuple):
    """One dyad in the structure of a machine; of links 0 is the frame, 1 the driven one."""

    name: str
    kind: str
    first: int                  # number of the link of its point ``first``
    second: int                 # ... ``second``
    links: tuple[str, str]      # names of its own links
    number: int                 # of the first of them; the second is the next
    pair: Pair | None = None    # of a dyad between links that are joined to each other

    @property
    def turns_first(self) -> bool:
        """Return whether its first link hangs on the one of a pair that moves in the frame."""
        return self.pair is not None and self.pair.frame == self.second

    def slides(self) -> list[str]:
        """Return the names of the links that slide, in the order of the joints."""
        return [self.links[i] for i in SLIDES[self.kind].values()]

    def joints(self) -> list[tuple[str, str]]:
        """Return (place, name) of its three joints: ('first', 'd_first'), ... of dyad d."""
        return [(place, f'{self.name}_{place}') for place in PLACES]

    def ends(self, place: str) -> tuple[int, int]:
        """Return the numbers of the links that a joint connects, the one that hangs last."""
        return {'first': (self.first, self.number), 'inner': (self.number, self.number + 1),
                'second': (self.second, self.number + 1)}[place]

    def pins(self) -> Iterator[tuple[str, int, int]]:
        """Yield (name, number of the link on which it hangs, of the other) of its pins."""
        for place, name in self.joints():
            if place not in SLIDES[self.kind]:
                yield name, *self.ends(place)


class Layout(NamedTuple):
    """
    The structure of a machine.

    The first of its ``links`` is the frame from which all is solved: the ground, or the link at
    the base of a cylinder between two moving links. The second is the driven one.
    """

    driver: str                     # 'crank', 'slide' or 'cylinder'
    links: tuple[str, ...]          # names of all links
    stages: tuple[Stage, ...]       # in order; with a cylinder its own first
    output: str                     # name of the link that the machine is used for

    @property
    def moving(self) -> tuple[str, ...]:
        """Return the names of the moving links; a frame that moves has the ground's place."""
        return tuple([self.links[0] if link == GROUND else link for link in self.links[1:]])

    @property
    def ground(self) -> int:
        """Return the number of the ground; 0: it is the frame."""
        return self.links.index(GROUND)

    @property
    def driven(self) -> str:
        """Return the name of the driven link."""
        return self.links[1]

    def turning(self) -> set[str]:
        """Return the names of the links that turn against the ground."""
        turns = [0, int(self.driven == CRANK_LINK)]     # equal numbers: they turn together
        for stage in self.stages:
            one, other, own = turns[stage.first], turns[stage.second], stage.number
            turns += {RRR: (own, own + 1), RRP: (own, other), RPR: (own, own),
                      RPP: (other, other), PRP: (one, other)}[stage.kind]
        return {name for name, turn in zip(self.links, turns) if turn != turns[self.ground]}

    def slides(self) -> list[str]:
        """Return the names of the links that slide."""
        driven = [SLIDER_LINK] if self.driven == SLIDER_LINK else []
        return driven + [link for stage in self.stages for link in stage.slides()]

    def pins(self) -> list[tuple[str, int, int]]:
        """Return (name, numbers of both links) of the pins between moving links."""
        every = [(BASE, 0, 1)] + [pin for stage in self.stages for pin in stage.pins()]
        return [pin for pin in every if self.ground not in pin[1:]]

    def joints(self) -> list[tuple[str, bool]]:
        """Return (name, whether it slides) of all joints, the one of the driven link first."""
        return [(BASE, self.driven == SLIDER_LINK)] + [
            (name, place in SLIDES[stage.kind]) for stage in self.stages
            for place, name in stage.joints()]


def layout_of(driver: str, dyads: Sequence[Dyad], output: str | None = None) -> Layout:
    """
    Return the :class:`Layout` of dyads, a cylinder's own first.

    Raises
    ------
    InvalidParameter
        A name twice, a link that is not there, or not yet: with the order of dyads that works, or
        the links that no order solves.

    """
    driven = SLIDER_LINK if driver == 'slide' else CRANK_LINK
    frame = dyads[0].second.link if driver == CYLINDER else GROUND
    links, owners, stages = [frame, driven], {frame: '', driven: 'the driven link'}, []
    if frame != GROUND:
        owners[frame] = 'the link at the base of the cylinder'
    names: set[str] = set()
    for dyad in dyads:
        where = f'dyads.{dyad.name}'
        if dyad.name in names:
            raise InvalidParameter('name of a dyad', dyad.name, 'stands twice')
        names.add(dyad.name)
        _require_new(where, dyad.links, owners)
        for place in ('first', 'second'):
            link = getattr(dyad, place).link
            if link in dyad.links:
                raise InvalidParameter(f'{where}.{place}.link', link, 'a dyad cannot hang on its '
                                                                      'own link')
            if link not in links:
                raise InvalidParameter(f'{where}.{place}.link', link,
                                       _why_not_there(dyads, link, links))
        stages.append(Stage(dyad.name, dyad.kind, links.index(dyad.first.link),
                            links.index(dyad.second.link), dyad.links, len(links)))
        links += dyad.links
        owners.update(dict.fromkeys(dyad.links, f'a link of dyad {dyad.name}'))
    if GROUND not in links:
        raise InvalidParameter('cylinder.base.link', frame, 'a machine with a cylinder on a link '
                               'that moves has the ground among the links of a dyad')
    layout = Layout(driver, tuple(links), tuple(stages), '')
    moving = layout.moving
    if output is not None and output not in moving:
        raise InvalidParameter('output', output,
                               f'there is no such link{nearest(output, moving)}')
    layout = layout._replace(output=output or (driven if names == {CYLINDER} else moving[-1]))
    _require_single(layout)
    return layout


def _why_not_there(dyads: Sequence[Dyad], link: str, known: Sequence[str]) -> str:
    """Return the text of an error for a link on which no dyad can hang yet, with what helps."""
    owner = next((dyad for dyad in dyads if link in dyad.links), None)
    if owner is None:
        return f'there is no such link{nearest(link, known)}'
    # {dyad: those on whose links it hangs}
    supports = {dyad.name: {other.name for other in dyads if other is not dyad
                            and {dyad.first.link, dyad.second.link} & {*other.links}}
                for dyad in dyads}
    try:
        order = ', '.join(TopologicalSorter(supports).static_order())
    except CycleError as error:
        in_cycle, *_ = error.args[1]
        for _ in dyads:             # then also those on which these hang, and so on
            supports = {name: own.union(*[supports[other] for other in own])
                        for name, own in supports.items()}
        group = [link for dyad in dyads for link in dyad.links
                 if in_cycle in supports[dyad.name] and dyad.name in supports[in_cycle]]
        return (f'is a link of dyad {owner.name}, but no order of dyads works: the links '
                f'{", ".join(group)} close only together, an Assur group of a higher class. '
                'Drive another link, or hang one of their dyads on links before it')
    return f'is a link of dyad {owner.name}, which must stand before this one: {order} works'


def _require_new(where: str, links: Sequence[str], owners: dict[str, str]) -> None:
    """Refuse names of links that are equal or taken; ``owners``: {link: what it is, in words}."""
    if links[0] == links[1]:
        raise InvalidParameter(f'{where}.links', tuple(links), 'must be two names')
    for link in links:
        if link == GROUND and not owners.get(GROUND, 'no frame'):
            raise InvalidParameter(f'{where}.links', tuple(links), 'the ground is no link of a '
                                   'dyad, unless cylinder.base is a point of a moving link')
        if link in owners:
            raise InvalidParameter(f'{where}.links', link, f'is {owners[link]} already')


def _require_single(layout: Layout) -> None:
    """Refuse names that make two fields alike, as a link called d_inner and a pin of dyad d."""
    for fields in (motion_fields(layout), load_fields(layout)):
        name, count = Counter(fields).most_common(1)[0]
        if count > 1:
            raise InvalidParameter('dyads', name, 'would be the name of two results: change that '
                                                  'of a link or a dyad')


# --- fields of the results -----------------------------------------------------------------------

def coordinate(name: str) -> Coordinate:
    """Return the coordinate of the angle of a link or a pin."""
    return Coordinate(f'theta_{name}', f'omega_{name}', f'alpha_{name}')


def travel(link: str) -> Coordinate:
    """Return the coordinate of a link that slides."""
    return Coordinate(f'slide_{link}', f'slide_{link}_velocity', f'slide_{link}_acceleration')


COEFFICIENTS = ('x', 'y', 'dx', 'dy', 'ddx', 'ddy', 'cos', 'sin', 'ratio', 'bend')


@cache
def motion_fields(layout: Layout) -> tuple[str, ...]:
    """Return the names of the fields of a motion, see :func:`.motion.motion_of`."""
    found: list[str] = []
    for link in layout.moving:
        found += coordinate(link)
    for link in layout.slides():
        found += (*travel(link), f'slide_{link}_ratio')
    for pin, _, _ in layout.pins():
        found += coordinate(pin)
    found += (f'transmission_angle_{stage.name}' for stage in layout.stages)
    found += ('transmission_angle', 'condition', 'rate', 'acceleration')
    for link in layout.moving:
        found += (f'{name}_{link}' for name in COEFFICIENTS)
    found += (f'sine_{stage.name}' for stage in layout.stages)
    return tuple(found)


@cache
def load_fields(layout: Layout) -> tuple[str, ...]:
    """Return the names of the fields of loads, see :func:`.loads.make_loads`."""
    found: list[str] = []
    for name, is_slide in layout.joints():
        found += (f'{name}_x', f'{name}_y', name)
        if is_slide:
            found += (f'{name}_normal', f'{name}_couple')
    return (*found, 'driving_torque', 'driving_force', 'shaking_force_x', 'shaking_force_y',
            'shaking_force', 'shaking_moment', *(row.name for row in DERIVED))
