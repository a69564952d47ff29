# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a machine is made with: checked, and changed."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.machine.description import (
    checked_links,
    checked_mode,
    checked_point,
    CRANK_LINK,
    CYLINDER,
    Cylinder,
    DIMENSIONS,
    Dyad,
    GROUND,
)


def checked_cylinder(given: Any, driven: str) -> Cylinder | None:
    """Return the cylinder, which a machine has that is driven by one, and no other."""
    if (given is None) is (driven == CYLINDER):
        raise InvalidParameter('cylinder', given, 'a machine has one if input is cylinder, '
                                                  'and only then')
    if given is None:
        return None
    try:
        base, pin, links, mode = Cylinder(*given)
    except TypeError:
        raise InvalidParameter('cylinder', given, 'must be Cylinder(base, pin, links, '
                                                  'mode)') from None
    base, pin = checked_point('cylinder.base', base), checked_point('cylinder.pin', pin)
    for name, point, link in (('base', base, GROUND), ('pin', pin, CRANK_LINK)):
        if point.link != link or not (point.along or point.across):
            raise InvalidParameter(f'cylinder.{name}', tuple(point),
                                   f'must be a point of the {link} away from O1')
    return Cylinder(base, pin, checked_links('cylinder.links', links),
                    checked_mode('cylinder.mode', mode))


def checked_dyads(given: Any) -> tuple[Dyad, ...]:
    """Return one dyad or more, as a tuple."""
    dyads = tuple(given) if isinstance(given, (tuple, list)) else ()
    if not dyads or not all(isinstance(dyad, Dyad) for dyad in dyads):
        raise InvalidParameter('dyads', given, 'must be one Dyad or more, in order')
    return dyads


def with_lengths(dyad: Dyad, given: dict[str, float]) -> Dyad:
    """Return a dyad with other lengths, by their names in a machine."""
    changed: dict[str, Any] = {
        place: getattr(dyad, place)._replace(**{
            name: given[f'{dyad.name}.{place}.{name}'] for name in ('along', 'across')
            if f'{dyad.name}.{place}.{name}' in given})
        for place in ('first', 'second')}
    changed.update((name, given[f'{dyad.name}.{name}']) for name in DIMENSIONS[dyad.kind]
                   if f'{dyad.name}.{name}' in given)
    return replace(dyad, **changed)


def by_link(name: str, given: Any, kind: type, whole: Any, default: Any) -> Any:
    """Return {link: record}, or a tuple of them, as ``whole``; None for None."""
    if given is None:
        return None
    if not isinstance(given, Mapping):
        given = given._asdict() if hasattr(given, '_asdict') else dict(zip(whole._fields, given))
    for link, record in given.items():
        if link not in whole._fields:
            raise InvalidParameter(f'{name}.{link}', None, 'there is no such link'
                                   f'{nearest(link, whole._fields)}')
        if not isinstance(record, kind):
            raise InvalidParameter(f'{name}.{link}', record, f'must be of type {kind.__name__}')
    return whole(**{link: given.get(link, default) for link in whole._fields})
