# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Forces of springs and dampers, and forces over a position, as external forces of the loads."""
from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Sequence
from functools import lru_cache
from math import isfinite
from typing import Any, NamedTuple, Union

from fourbar_ros.dynamics.model.elements import (
    Element,
    PositionForce,
    Spring,
    TorsionSpring,
)
from fourbar_ros.dynamics.model.terms import Curves, deflection, make_push
from fourbar_ros.errors import FourBarError, InvalidParameter, MissingBodies
from fourbar_ros.mechanics.bodies import Applied, applied_to, unchecked
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.mechanisms.points import Curve, FIXED, point_of
from fourbar_ros.numerics.number_types import ARRAY, NumberType, REAL, Scalar
import numpy as np
from numpy.typing import ArrayLike

Loaded = Callable[[float, float], Union[Mechanism, None]]


class Acting(NamedTuple):
    """A force [N] at a place [m] and a couple [N m] on a link, along the ground axes."""

    link: str
    x: Scalar
    y: Scalar
    force_x: Scalar
    force_y: Scalar
    couple: Scalar


def forces_of(element: Spring | TorsionSpring, one: Curve, two: Curve,
              n: NumberType = REAL) -> tuple[Acting, Acting]:
    """
    Return what a spring does to its first and to its second link.

    Parameters
    ----------
    element : Spring or TorsionSpring
    one, two : LinkMotion
        Motion of its links over time: first derivatives are velocities.
    n : NumberType
        Of these.

    """
    first, second = element.links
    if isinstance(element, TorsionSpring):
        moment = (element.stiffness * deflection(n, one, two, element.free_angle)
                  + element.damping * (two[8] - one[8]))
        return (Acting(first, one[0], one[1], 0.0, 0.0, moment),
                Acting(second, two[0], two[1], 0.0, 0.0, -moment))
    p = point_of(one, element.first.along, element.first.across)
    q = point_of(two, element.second.along, element.second.across)
    x, y = q.x - p.x, q.y - p.y
    square = x * x + y * y
    pull = element.stiffness * (1.0 - (element.free_length / square**0.5
                                       if element.free_length else 0.0))
    if element.damping:
        pull += element.damping * (x * (q.v_x - p.v_x) + y * (q.v_y - p.v_y)) / square
    return (Acting(first, p.x, p.y, pull * x, pull * y, 0.0),
            Acting(second, q.x, q.y, -pull * x, -pull * y, 0.0))


def _make_all(n: NumberType, linkage: Mechanism, elements: Sequence[Element]
              ) -> Callable[[Curves, Any], list[Acting]]:
    """Return the function (curves by link, input) -> what all elements do."""
    springs = [element for element in elements if not isinstance(element, PositionForce)]
    pushes = [(element, make_push(n, element, element.make_value(linkage)))
              for element in elements if isinstance(element, PositionForce)]

    def acting(curves: Curves, position: Scalar) -> list[Acting]:
        found = [force for spring in springs for force in
                 forces_of(spring, curves[spring.links[0]], curves[spring.links[1]], n)]
        for element, push in pushes:
            (value, _, e_x, e_y), point = push(curves, position), element.point
            at = point_of(curves[point.link], point.along, point.across)
            is_couple = element.direction is None
            found.append(Acting(point.link, at.x, at.y, value * e_x, value * e_y,
                                value if is_couple else 0.0))
        return found
    return acting


def _known_links(linkage: Mechanism, elements: Sequence[Element]) -> set[str]:
    """Return the moving links of which elements need to know the motion."""
    links = [link.name for link in linkage.LINKS]
    named = {link for element in elements for link in element.links} - {GROUND}
    for link in named:
        if link not in links:
            raise InvalidParameter('link', link, f'must be one of {", ".join(links)}, {GROUND}')
    return named


def make_loaded(linkage: Mechanism, elements: Sequence[Element]) -> Loaded:
    """
    Return the function (position, rate) -> linkage with the elements' forces of this moment.

    They come on top of its constant external forces, and act on any link, a driven crank too; the
    loads of that linkage are those with them. It returns None where a force is not finite.
    """
    links = tuple(link.name for link in linkage.LINKS)
    given = [applied_to(linkage.external, link) for link in links]
    known, all_acting = _known_links(linkage, elements), _make_all(REAL, linkage, elements)
    on_links = _on_links(links)

    def loaded(position: float, rate: float) -> Mechanism | None:
        try:
            motion = linkage.motion(position, rate, 0.0)
        except FourBarError:
            return linkage                               # it has no loads here either
        curves = {link: linkage.link_motion(motion, link) for link in known}
        curves[GROUND] = FIXED
        try:
            acting = all_acting(curves, position)
            if not all(isfinite(number) for force in acting for number in force[1:]):
                return None
            return linkage.with_external(on_links(
                *(Applied(*_with(applied, curves[link], [force for force in acting
                                                         if force.link == link]))
                  if link in known else applied for link, applied in zip(links, given))))
        except (ArithmeticError, InvalidParameter):      # ends of a spring meet, a sum overflows
            return None
    return loaded


def make_external(n: NumberType, linkage: Mechanism, elements: Sequence[Element]
                  ) -> Callable[[NamedFields, Scalar, Any], Any]:
    """
    Return (motion, input, external forces) -> external forces with those of the elements.

    Of any number type, and unchecked.
    """
    links = tuple(link.name for link in linkage.LINKS)
    known, all_acting = _known_links(linkage, elements), _make_all(n, linkage, elements)

    def external(motion: NamedFields, position: Scalar, given: Any) -> Any:
        curves: dict[str, Curve] = {link: linkage.link_motion(motion, link) for link in known}
        curves[GROUND] = FIXED
        acting, found = all_acting(curves, position), []
        for link in links:
            applied = applied_to(given, link)
            here = [force for force in acting if force.link == link]
            found.append(unchecked(Applied, *_with(applied, curves[link], here)) if link in known
                         else applied)
        return _on_links(links)(*found)
    return external


def loads_with(linkage: Mechanism, elements: Sequence[Element], position: ArrayLike,
               rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0) -> NamedFields:
    """
    Return the loads of a prescribed motion with springs, dampers and forces over a position.

    Parameters
    ----------
    linkage : Mechanism
        With bodies.
    elements : sequence of Spring, TorsionSpring or PositionForce
    position, rate, acceleration : float or array_like
        Of the input, broadcast, as for ``linkage.loads``.

    Returns
    -------
    The record that ``linkage.loads`` gives; NaN where there are no loads.

    Raises
    ------
    MissingBodies, InvalidParameter

    """
    if linkage.bodies is None:
        raise MissingBodies
    given = np.broadcast_arrays(*(np.asarray(value, float) for value in
                                  (position, rate, acceleration)))
    shape = given[0].shape
    positions, rates, accelerations = (np.ravel(value) for value in given)
    with np.errstate(all='ignore'):
        motion = linkage.motion(positions, rates, accelerations)
        external = make_external(ARRAY, linkage, elements)(motion, positions, linkage.external)
        loads = linkage.with_external(external).make_loads(ARRAY)(motion)
    rows = [np.broadcast_to(row, positions.shape).reshape(shape) for row in loads]
    found: NamedFields = linkage.LOADS(*(rows if shape else [float(row) for row in rows]))
    return found


@lru_cache(maxsize=64)
def _on_links(links: tuple[str, ...]) -> Any:
    """Return the type of a record of what acts on each of these links."""
    return namedtuple('OnLinks', links)  # noqa: PYI024


def _with(given: Applied, curve: Curve, acting: Sequence[Acting]) -> tuple[Scalar, ...]:
    """Return the numbers of an external force with others, moved to its point."""
    at = point_of(curve, given.along, given.across)
    couple, force_x, force_y = 0.0, 0.0, 0.0
    for force in acting:                  # one by one: sum() rounds otherwise from Python 3.12 on
        couple = couple + (force.couple + (force.x - at.x) * force.force_y
                           - (force.y - at.y) * force.force_x)
        force_x, force_y = force_x + force.force_x, force_y + force.force_y
    return (given.force_x + force_x, given.force_y + force_y, given.along, given.across,
            given.couple + couple)
