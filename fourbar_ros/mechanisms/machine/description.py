# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What describes a machine: points, dyads, a cylinder. Each checks itself, the layout their order.

A dyad (Assur group of class II) is two links and three joints, each a pin (R) or a slide (P). The
letters name the outer joint on the link of ``first``, the inner joint, and the outer joint on the
link of ``second``.
"""
from collections import Counter
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields
from graphlib import CycleError, TopologicalSorter
from keyword import iskeyword
from math import sin
import re
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.machine import structure
from fourbar_ros.mechanisms.machine.solve.pairs import Joints
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DIMENSIONS, DyadLengths, Layout
from fourbar_ros.mechanisms.parts import CROSSED, GROUND, Length, OPEN
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.number_types import direction

# Squares and fourth powers of lengths are computed without scaling.
LONGEST, SHORTEST = 2.0**250, 2.0**-250     # [m]

ANGLES = ('direction_1', 'direction_2', 'slot')
# Directions nearer to each other than this [rad] are parallel.
PARALLEL = 1e-9


@dataclass(frozen=True)
class Dyad:
    """
    Two links and three joints between two points that move already.

    ======  ======================================================  ===========================
    kind    links                                                   dimensions
    ======  ======================================================  ===========================
    RRR     rods from ``first`` and ``second``, pinned together     length_1, length_2
    RRP     rod from ``first``, pinned to a block that slides       length_1, direction_2
            through ``second``
    RPR     block pinned at ``first``, which slides on a bar        offset
            pinned at ``second``
    RPP     block pinned at ``first`` in the slot of a yoke that    direction_2, slot
            slides through ``second``
    PRP     blocks that slide through ``first`` and through         direction_1, direction_2
            ``second``, pinned together
    ======  ======================================================  ===========================

    Parameters
    ----------
    name, kind : str
    first, second : Point
        Points of the ground, the driven link, or a link of a dyad before this one.
    links : tuple of 2 str
        Names of its links, the one at ``first`` first.
    length_1, length_2 : float
        Lengths of the rods [m], positive.
    offset : float
        Distance of the path of the block's pin from the pivot of the bar, to its left [m].
        0 if not given.
    direction_1, direction_2 : float
        Directions in which the first, the second link slides, from that of the link of
        ``first``, of ``second`` [rad].
    slot : float
        From the direction in which the yoke slides to its slot [rad], not a multiple of pi.
    mode : int
        Assembly mode: 2 or 1. RRR: turning from the first rod to the second by less than pi is to
        the left, right. RRP: the rod points along, against the direction of the slide. RPR: the
        block is ahead of the bar's pivot, behind. RPP and PRP have one mode, 2.

    """

    name: str
    kind: str
    first: Point
    second: Point
    links: tuple[str, str]
    length_1: float | None = None
    length_2: float | None = None
    offset: float | None = None
    direction_1: float | None = None
    direction_2: float | None = None
    slot: float | None = None
    mode: int = OPEN

    def __post_init__(self) -> None:
        require_name('name of a dyad', self.name)
        where = f'dyads.{self.name}'
        if self.kind not in DIMENSIONS:
            raise InvalidParameter(f'{where}.kind', self.kind,
                                   f'must be one of {", ".join(DIMENSIONS)}')
        checked: dict[str, Any] = {
            end: checked_point(f'{where}.{end}', getattr(self, end))
            for end in ('first', 'second')}
        checked['links'] = checked_links(f'{where}.links', self.links)
        wanted = DIMENSIONS[self.kind]
        for field in fields(self):
            value, is_dimension = getattr(self, field.name), field.default is None
            if is_dimension and field.name not in wanted and value is not None:
                raise InvalidParameter(f'{where}.{field.name}', value, f'a dyad {self.kind} has '
                                       f'{", ".join(wanted)} only')
        for name in wanted:
            value = getattr(self, name)
            if value is None:
                if name != 'offset':
                    raise InvalidParameter(f'{where}.{name}', value,
                                           f'a dyad {self.kind} needs it')
                value = 0.0
            checked[name] = (finite(f'{where}.{name}', value) if name in ANGLES
                             else checked_length(f'{where}.{name}', value, name == 'offset'))
        checked['mode'] = checked_mode(f'{where}.mode', self.mode,
                                       self.kind in structure.OF_ONE_MODE)
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        # slides must not be parallel on links that do not turn to each other
        if self.slot is not None and abs(sin(self.slot)) < PARALLEL:
            raise InvalidParameter(f'{where}.slot', self.slot, 'must not be parallel to the '
                                   'direction in which the yoke slides: not a multiple of pi')
        if self.kind == 'PRP' and self.first.link == self.second.link:
            # a PRP has both: checked
            turn = self.direction_2 - self.direction_1      # type: ignore[operator]
            if abs(sin(turn)) < PARALLEL:
                raise InvalidParameter(f'{where}.direction_2', self.direction_2,
                                       'must not be parallel to direction_1: the lines never meet')

    @property
    def dimensions(self) -> tuple[float, ...]:
        return tuple([getattr(self, name) for name in DIMENSIONS[self.kind]])

    @property
    def lengths(self) -> DyadLengths:
        """Return places and dimensions as its formulas take them, angles as cosine and sine."""
        sizes: list[float] = []
        for name in DIMENSIONS[self.kind]:
            value = getattr(self, name)
            sizes += direction(value) if name in ANGLES else (value,)
        return DyadLengths(self.first[1:], self.second[1:], tuple(sizes))

    @property
    def sign(self) -> float:
        return 1.0 if self.mode == OPEN else -1.0


class Cylinder(NamedTuple):
    """
    A cylinder that turns the crank: it is driven by its length.

    Parameters
    ----------
    base : Point
        Point where the tube is pinned. It is on the ground, or on a moving link to which the crank
        is pinned at (0, 0). In dyads that link then takes the place of the ground, and one dyad
        has the ground among its links: its first joint is the origin, its direction is x.
    pin : Point
        Point of the crank where the rod is pinned.
    links : tuple of 2 str
        Names of rod and tube.
    mode : int
        2: from O1-base to O1-pin one turns left by less than pi; 1: right. O1 is where the crank
        is pinned.

    """

    base: Point
    pin: Point
    links: tuple[str, str] = ('rod', 'tube')
    mode: int = OPEN


def require_name(parameter: str, name: Any) -> None:
    if not (isinstance(name, str) and re.fullmatch('[A-Za-z][A-Za-z0-9_]*', name)
            and not name.endswith('_') and '__' not in name and not iskeyword(name)):
        raise InvalidParameter(parameter, name, 'must be a name: letters, digits and single '
                               'underscores, a letter first')


def checked_length(name: str, value: Any, is_signed: bool = False) -> float:
    result = finite(name, value) if is_signed else finite(
        name, value, 'a length must be a positive number', above=0.0)
    if not (SHORTEST < abs(result) < LONGEST or is_signed and result == 0.0):
        raise InvalidParameter(name, value, f'must be between {SHORTEST:.3g} and {LONGEST:.3g} m: '
                                            'squares under- or overflow')
    return result


def checked_point(name: str, value: Any) -> Point:
    try:
        link, along, across = Point(*value)
    except TypeError:
        link = None
    if not isinstance(link, str):
        raise InvalidParameter(name, value, 'must be Point(link, along, across)')
    return Point(link, checked_length(f'{name}.along', along, True),
                 checked_length(f'{name}.across', across, True))


def checked_links(name: str, value: Any) -> tuple[str, str]:
    links = tuple(value) if isinstance(value, (tuple, list)) else ()
    if len(links) != 2:
        raise InvalidParameter(name, value, 'must be the names of two links')
    for link in links:
        require_name(name, link)
    return links


def checked_mode(name: str, value: Any, has_one: bool = False) -> int:
    if isinstance(value, bool) or value not in ((OPEN,) if has_one else (CROSSED, OPEN)):
        raise InvalidParameter(name, value, 'must be 2: it has one assembly mode' if has_one
                               else 'must be 1 or 2')
    return int(value)


def checked_cylinder(cylinder: Any, driven: str) -> Cylinder | None:
    if (cylinder is None) is (driven == CYLINDER):
        raise InvalidParameter('cylinder', cylinder, 'a machine has one if input is cylinder, '
                               'and only then')
    if cylinder is None:
        return None
    try:
        base, pin, links, mode = Cylinder(*cylinder)
    except TypeError:
        raise InvalidParameter('cylinder', cylinder, 'must be Cylinder(base, pin, links, '
                               'mode)') from None
    base, pin = checked_point('cylinder.base', base), checked_point('cylinder.pin', pin)
    require_name('cylinder.base.link', base.link)
    if base.link in (structure.CRANK_LINK, *links):
        raise InvalidParameter('cylinder.base', tuple(base), 'must be a point of the ground, or '
                               'of a moving link to which the crank is pinned')
    if pin.link != structure.CRANK_LINK:
        raise InvalidParameter('cylinder.pin', tuple(pin), 'must be a point of the crank, which '
                               'is pinned to the link at the base: a cylinder between links that '
                               'no pin joins closes an Assur group of a higher class')
    for name, point in (('base', base), ('pin', pin)):
        if not (point.along or point.across):
            raise InvalidParameter(f'cylinder.{name}', tuple(point), f'must be a point of the '
                                   f'{point.link} away from O1')
    return Cylinder(base, pin, checked_links('cylinder.links', links),
                    checked_mode('cylinder.mode', mode))


def with_lengths(dyad: Dyad, lengths: dict[str, float]) -> Dyad:
    """Return a dyad d with other lengths, {'d.first.along': 0.4, 'd.length_1': 1.2, ...}."""
    # They are any numbers, even arrays, so they are set past the checks of the frozen dataclass.
    copied = copy(dyad)
    for end in ('first', 'second'):
        names = {name: f'{dyad.name}.{end}.{name}' for name in ('along', 'across')}
        object.__setattr__(copied, end, getattr(dyad, end)._replace(**{
            name: lengths[of_scene] for name, of_scene in names.items() if of_scene in lengths}))
    for name in DIMENSIONS[dyad.kind]:
        if f'{dyad.name}.{name}' in lengths:
            object.__setattr__(copied, name, lengths[f'{dyad.name}.{name}'])
    return copied


def by_link(name: str, records: Any, kind: type, of_links: Any, default: Any) -> Any:
    """Return the records of links, {link: record} or a tuple, as one NamedTuple ``of_links``."""
    # Each is a kind, Body or Applied; links that no mapping names get the default. None stays
    # None.
    if records is None:
        return None
    if hasattr(records, '_asdict'):
        records = records._asdict()
    if not isinstance(records, Mapping):
        if not isinstance(records, Sequence) or len(records) != len(of_links._fields):
            raise InvalidParameter(name, records, f'must be a mapping {{link: {kind.__name__}}}, '
                                   f'or as many as {", ".join(of_links._fields)}')
        records = dict(zip(of_links._fields, records))
    for link, record in records.items():
        if link not in of_links._fields:
            raise InvalidParameter(f'{name}.{link}', None, 'there is no such link'
                                   f'{nearest(link, of_links._fields)}')
        if not isinstance(record, kind):
            raise InvalidParameter(f'{name}.{link}', record, f'must be of type {kind.__name__}')
    return of_links(**{link: records.get(link, default) for link in of_links._fields})


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


def layout_of(driver: str, dyads: Sequence[Dyad], output: str | None = None,
              carrier: str = GROUND) -> Layout:
    """Return the :class:`Layout` of dyads, a cylinder's own first; ``carrier``: of a Machine."""
    # InvalidParameter for a name twice, a link that is not there, or not yet: with the order of
    # dyads that works, or the links that no order solves.
    driven = structure.SLIDER_LINK if driver == 'slide' else structure.CRANK_LINK
    frame = dyads[0].second.link if driver == CYLINDER else carrier
    links, owners, stages = [frame, driven], {frame: '', driven: 'the driven link'}, []
    if frame != GROUND:
        owners[frame] = ('the link at the base of the cylinder' if driver == CYLINDER
                         else 'the link that carries the crank')
    names = set[str]()
    for dyad in dyads:
        where = f'dyads.{dyad.name}'
        if dyad.name in names:
            raise InvalidParameter('name of a dyad', dyad.name, 'stands twice')
        names.add(dyad.name)
        _require_new(where, dyad.links, owners)
        for end in ('first', 'second'):
            link = getattr(dyad, end).link
            if link in dyad.links:
                raise InvalidParameter(f'{where}.{end}.link', link, 'a dyad cannot hang on its '
                                       'own link')
            if link not in links:
                raise InvalidParameter(f'{where}.{end}.link', link,
                                       _why_not_there(dyads, link, links))
        stages.append(structure.Stage(
            dyad.name, dyad.kind, links.index(dyad.first.link), links.index(dyad.second.link),
            dyad.links, len(links)))
        links += dyad.links
        owners.update(dict.fromkeys(dyad.links, f'a link of dyad {dyad.name}'))
    if GROUND not in links:
        raise InvalidParameter('cylinder.base.link' if driver == CYLINDER else 'carrier', frame,
                               'a machine whose drive is on a link that moves has the ground '
                               'among the links of a dyad')
    joints = Joints(driver, stages, [dyad.lengths for dyad in dyads])
    layout = Layout(driver, tuple(links), tuple([
        stage if stage.name == CYLINDER else stage._replace(pair=joints.pair_of(stage))
        for stage in stages]), '')
    moving = layout.moving
    if output is not None and output not in moving:
        raise InvalidParameter('output', output, f'there is no such link{nearest(output, moving)}')
    layout = layout._replace(output=output or (driven if names == {CYLINDER} else moving[-1]))
    for names_of_fields in (structure.motion_fields(layout), structure.load_fields(layout)):
        name, count = Counter(names_of_fields).most_common(1)[0]
        if count > 1:           # as of a link called d_inner and a pin of dyad d
            raise InvalidParameter('dyads', name, 'would be the name of two results: change that '
                                                  'of a link or a dyad')
    return layout


def _why_not_there(dyads: Sequence[Dyad], link: str, known: Sequence[str]) -> str:
    """Return the text of an error for a link on which no dyad can hang yet, with what helps."""
    owner = next((dyad for dyad in dyads if link in dyad.links), None)
    if owner is None:
        return f'there is no such link{nearest(link, known)}'
    # {dyad: those on whose links it hangs}
    supports = {dyad.name: {support.name for support in dyads if support is not dyad
                            and {dyad.first.link, dyad.second.link} & {*support.links}}
                for dyad in dyads}
    try:
        order = ', '.join(TopologicalSorter(supports).static_order())
    except CycleError as error:
        in_cycle, *_ = error.args[1]
        for _ in dyads:             # then also those on which these hang, and so on
            supports = {name: direct.union(*[supports[support] for support in direct])
                        for name, direct in supports.items()}
        group = [link for dyad in dyads for link in dyad.links
                 if in_cycle in supports[dyad.name] and dyad.name in supports[in_cycle]]
        return (f'is a link of dyad {owner.name}, but no order of dyads works: the links '
                f'{", ".join(group)} close only together, an Assur group of a higher class. '
                'Drive another link, or hang one of their dyads on links before it')
    return f'is a link of dyad {owner.name}, which must stand before this one: {order} works'


def _require_new(where: str, links: Sequence[str], owners: dict[str, str]) -> None:
    """Refuse names of links that are equal or taken."""
    # owners: {link: what it is, in words}; the frame has none
    if links[0] == links[1]:
        raise InvalidParameter(f'{where}.links', tuple(links), 'must be two names')
    for link in links:
        if link == GROUND and owners.get(GROUND) == '':
            raise InvalidParameter(f'{where}.links', tuple(links), 'the ground is no link of a '
                                   'dyad, unless cylinder.base is a point of a moving link, or '
                                   'linkage.carrier is one')
        if link in owners:
            raise InvalidParameter(f'{where}.links', link, f'is {owners[link]} already')
