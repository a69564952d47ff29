# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Parts that describe a machine: points, dyads, a cylinder. Each checks itself.

A dyad (Assur group of class II) is two links and three joints, each a pin (R) or a slide (P). The
letters name the outer joint on the link of ``first``, the inner joint, and the outer joint on the
link of ``second``.
"""
from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, fields
from keyword import iskeyword
from math import sin
import re
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.machine.structure import (
    CRANK_LINK,
    CYLINDER,
    DIMENSIONS,
    DyadLengths,
    OF_ONE_MODE,
)
from fourbar_ros.mechanisms.parts import CROSSED, OPEN
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
        """Check the fields, and store them as points, floats and an integer mode."""
        require_name('name of a dyad', self.name)
        where = f'dyads.{self.name}'
        if self.kind not in DIMENSIONS:
            raise InvalidParameter(f'{where}.kind', self.kind,
                                   f'must be one of {", ".join(DIMENSIONS)}')
        checked: dict[str, Any] = {
            end: checked_point(f'{where}.{end}', getattr(self, end))
            for end in ('first', 'second')}
        checked['links'] = checked_links(f'{where}.links', self.links)
        checked.update(self._checked_dimensions(where))
        checked['mode'] = checked_mode(f'{where}.mode', self.mode, self.kind in OF_ONE_MODE)
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        self._require_directions(where)

    def _checked_dimensions(self, where: str) -> dict[str, float]:
        """Return {name: value} of the dimensions of its kind, checked; others must be None."""
        wanted = DIMENSIONS[self.kind]
        for field in fields(self):
            value, is_dimension = getattr(self, field.name), field.default is None
            if is_dimension and field.name not in wanted and value is not None:
                raise InvalidParameter(f'{where}.{field.name}', value, f'a dyad {self.kind} has '
                                       f'{", ".join(wanted)} only')
        values = {name: getattr(self, name) for name in wanted}
        if values.get('offset', 0.0) is None:
            values['offset'] = 0.0
        for name, value in values.items():
            if value is None:
                raise InvalidParameter(f'{where}.{name}', value, f'a dyad {self.kind} needs it')
            values[name] = (finite(f'{where}.{name}', value) if name in ANGLES
                            else checked_length(f'{where}.{name}', value, name == 'offset'))
        return values

    def _require_directions(self, where: str) -> None:
        """Refuse slides that are parallel on links that do not turn to each other."""
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
        """Return its dimensions in the order of :data:`DIMENSIONS`."""
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
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
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
    """Raise InvalidParameter unless ``name`` can be part of a field, a topic and a frame."""
    if not (isinstance(name, str) and re.fullmatch('[A-Za-z][A-Za-z0-9_]*', name)
            and not name.endswith('_') and '__' not in name and not iskeyword(name)):
        raise InvalidParameter(parameter, name, 'must be a name: letters, digits and single '
                               'underscores, a letter first')


def checked_length(name: str, value: Any, is_signed: bool = False) -> float:
    """Return a length [m] as a float, positive unless signed, whose square does not overflow."""
    result = finite(name, value) if is_signed else finite(
        name, value, 'a length must be a positive number', above=0.0)
    if not (SHORTEST < abs(result) < LONGEST or is_signed and result == 0.0):
        raise InvalidParameter(name, value, f'must be between {SHORTEST:.3g} and {LONGEST:.3g} m: '
                                            'squares under- or overflow')
    return result


def checked_point(name: str, value: Any) -> Point:
    """Return a point whose link is a text and whose place is two finite numbers."""
    try:
        link, along, across = Point(*value)
    except TypeError:
        link = None
    if not isinstance(link, str):
        raise InvalidParameter(name, value, 'must be Point(link, along, across)')
    return Point(link, checked_length(f'{name}.along', along, True),
                 checked_length(f'{name}.across', across, True))


def checked_links(name: str, value: Any) -> tuple[str, str]:
    """Return the names of two links as a tuple; raise InvalidParameter for anything else."""
    links = tuple(value) if isinstance(value, (tuple, list)) else ()
    if len(links) != 2:
        raise InvalidParameter(name, value, 'must be the names of two links')
    for link in links:
        require_name(name, link)
    return links


def checked_mode(name: str, value: Any, has_one: bool = False) -> int:
    """Return an assembly mode, 1 or 2 (of a dyad that ``has_one``, 2), as an int."""
    if isinstance(value, bool) or value not in ((OPEN,) if has_one else (CROSSED, OPEN)):
        raise InvalidParameter(name, value, 'must be 2: it has one assembly mode' if has_one
                               else 'must be 1 or 2')
    return int(value)


def checked_cylinder(cylinder: Any, driven: str) -> Cylinder | None:
    """Return the checked cylinder of a machine; None if it has another drive."""
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
    if base.link in (CRANK_LINK, *links):
        raise InvalidParameter('cylinder.base', tuple(base), 'must be a point of the ground, or '
                               'of a moving link to which the crank is pinned')
    if pin.link != CRANK_LINK:
        raise InvalidParameter('cylinder.pin', tuple(pin), 'must be a point of the crank, which '
                               'is pinned to the link at the base: a cylinder between links that '
                               'no pin joins closes an Assur group of a higher class')
    for name, point in (('base', base), ('pin', pin)):
        if not (point.along or point.across):
            raise InvalidParameter(f'cylinder.{name}', tuple(point), f'must be a point of the '
                                   f'{point.link} away from O1')
    return Cylinder(base, pin, checked_links('cylinder.links', links),
                    checked_mode('cylinder.mode', mode))


def checked_dyads(values: Any, driven: str) -> tuple[Dyad, ...]:
    """Return one dyad or more, as a tuple; none will do with a cylinder, which is one."""
    dyads = tuple(values) if isinstance(values, (tuple, list)) else ()
    may_be_none = driven == CYLINDER and values in ((), [])
    if not (dyads or may_be_none) or not all(isinstance(dyad, Dyad) for dyad in dyads):
        raise InvalidParameter('dyads', values, 'must be one Dyad or more, in order')
    return dyads


def with_lengths(dyad: Dyad, lengths: dict[str, float]) -> Dyad:
    """
    Return a dyad d with other lengths, {'d.first.along': 0.4, 'd.length_1': 1.2, ...}.

    They are any numbers, even arrays, and not checked.
    """
    changed: dict[str, Any] = {
        end: getattr(dyad, end)._replace(**{
            name: lengths[f'{dyad.name}.{end}.{name}'] for name in ('along', 'across')
            if f'{dyad.name}.{end}.{name}' in lengths})
        for end in ('first', 'second')}
    changed.update((name, lengths[f'{dyad.name}.{name}']) for name in DIMENSIONS[dyad.kind]
                   if f'{dyad.name}.{name}' in lengths)
    copied = copy(dyad)
    for name, value in changed.items():
        object.__setattr__(copied, name, value)
    return copied


def by_link(name: str, records: Any, kind: type, of_links: Any, default: Any) -> Any:
    """
    Return the records of links, {link: record} or a tuple, as one NamedTuple ``of_links``.

    Each is a ``kind``, Body or Applied; links without one get the default. None stays None.
    """
    if records is None:
        return None
    if not isinstance(records, Mapping):
        records = (records._asdict() if hasattr(records, '_asdict')
                   else dict(zip(of_links._fields, records)))
    for link, record in records.items():
        if link not in of_links._fields:
            raise InvalidParameter(f'{name}.{link}', None, 'there is no such link'
                                   f'{nearest(link, of_links._fields)}')
        if not isinstance(record, kind):
            raise InvalidParameter(f'{name}.{link}', record, f'must be of type {kind.__name__}')
    return of_links(**{link: records.get(link, default) for link in of_links._fields})
