# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Forces of springs and dampers on the links, as external forces of the loads."""
from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Sequence
from functools import cache
from math import isfinite
from typing import Any, NamedTuple

from fourbar_ros.dynamics.contract import Curve, FIXED
from fourbar_ros.dynamics.elements import Element, GROUND, TorsionSpring
from fourbar_ros.dynamics.terms import deflection, place_of
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanics.bodies import Applied, applied_to
from fourbar_ros.numerics.number_types import REAL

Loaded = Callable[[float, float], Any]


class Acting(NamedTuple):
    """A force [N] at a place [m] and a couple [N m] on a link, along the ground axes."""

    link: str
    x: float
    y: float
    force_x: float
    force_y: float
    couple: float


def forces_of(element: Element, one: Curve, two: Curve) -> tuple[Acting, Acting]:
    """
    Return what a spring does to its first and to its second link.

    Parameters
    ----------
    element : Spring or TorsionSpring
    one, two : Curve
        Motion of its links over time: first derivatives are velocities.

    """
    first, second = element.links
    if isinstance(element, TorsionSpring):
        moment = (element.stiffness * deflection(REAL, one, two, element.free_angle)
                  + element.damping * (two[8] - one[8]))
        return (Acting(first, one[0], one[1], 0.0, 0.0, moment),
                Acting(second, two[0], two[1], 0.0, 0.0, -moment))
    x1, y1, u1, v1 = place_of(one, element.first.along, element.first.across)
    x2, y2, u2, v2 = place_of(two, element.second.along, element.second.across)
    x, y = x2 - x1, y2 - y1
    square = x * x + y * y
    pull = element.stiffness * (1.0 - (element.free_length / square**0.5
                                       if element.free_length else 0.0))
    if element.damping:
        pull += element.damping * (x * (u2 - u1) + y * (v2 - v1)) / square
    return (Acting(first, x1, y1, pull * x, pull * y, 0.0),
            Acting(second, x2, y2, -pull * x, -pull * y, 0.0))


def make_loaded(linkage: Any, elements: Sequence[Element]) -> Loaded:
    """
    Return the function (position, rate) -> linkage with the springs' forces of this moment.

    They come on top of its constant external forces, and act on any link, a driven crank too; the
    loads of that linkage are those with springs. It returns None where a force is not finite.
    """
    links = tuple(link.name for link in linkage.LINKS)
    given = [applied_to(linkage.external, link) for link in links]
    sprung = {link for element in elements for link in element.links} - {GROUND}
    on_links = _on_links(links)

    def loaded(position: float, rate: float) -> Any:
        try:
            motion = linkage.motion(position, rate, 0.0)
        except FourBarError:
            return linkage                               # it has no loads here either
        curves = {link: linkage.link_motion(motion, link) for link in sprung}
        try:
            acting = [force for element in elements for force in
                      forces_of(element, *(curves.get(link, FIXED) for link in element.links))]
        except ArithmeticError:                          # the ends of a spring meet
            return None
        if not all(isfinite(number) for force in acting for number in force[1:]):
            return None
        return linkage.with_external(on_links(
            *(_with(applied, curves[link], [force for force in acting if force.link == link])
              if link in sprung else applied for link, applied in zip(links, given))))
    return loaded


@cache
def _on_links(links: tuple[str, ...]) -> Any:
    """Return the type of a record of what acts on each of these links."""
    return namedtuple('OnLinks', links)  # noqa: PYI024


def _with(given: Applied, curve: Curve, acting: Sequence[Acting]) -> Applied:
    """Return an external force with others, moved to its point."""
    x, y, _, _ = place_of(curve, given.along, given.across)
    couple = given.couple + sum(force.couple + (force.x - x) * force.force_y
                                - (force.y - y) * force.force_x for force in acting)
    return Applied(given.force_x + sum(force.force_x for force in acting),
                   given.force_y + sum(force.force_y for force in acting), given.along,
                   given.across, couple)
