# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Forces of springs and dampers, and forces over a position, as external forces of the loads."""
from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Sequence
from functools import lru_cache
from math import isfinite
from typing import Any, NamedTuple, Union

from fourbar_ros.dynamics.model.elements import Element, PositionForce, Spring, TorsionSpring
from fourbar_ros.dynamics.model.terms import LinkMotions, make_push, make_tension
from fourbar_ros.errors import FourBarError, InvalidParameter, MissingBodies
from fourbar_ros.mechanics.bodies import Applied, applied_to, unchecked
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.mechanisms.points import FIXED, LinkMotion, point_of
from fourbar_ros.numerics.arrays import Array
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


def forces_of(element: Spring | TorsionSpring, one: LinkMotion, two: LinkMotion,
              n: NumberType = REAL) -> tuple[Acting, Acting]:
    """
    Return the forces of a spring and damper on its first and on its second link.

    ``one`` and ``two`` are the motions of these links over time, of numbers of the type ``n``.
    """
    first, second = element.links
    pull, growth, square = make_tension(n, element)(one, two)
    if element.damping:
        pull = pull + element.damping * growth / square
    if isinstance(element, TorsionSpring):
        return (Acting(first, one.x, one.y, 0.0, 0.0, pull),
                Acting(second, two.x, two.y, 0.0, 0.0, -pull))
    p = point_of(one, element.first.along, element.first.across)
    q = point_of(two, element.second.along, element.second.across)
    x, y = q.x - p.x, q.y - p.y
    return (Acting(first, p.x, p.y, pull * x, pull * y, 0.0),
            Acting(second, q.x, q.y, -pull * x, -pull * y, 0.0))


def _make_all(n: NumberType, linkage: Mechanism, elements: Sequence[Element]
              ) -> Callable[[LinkMotions, Any], list[Acting]]:
    """Return the function (motions of links over time, input) -> forces of all elements."""
    springs = [element for element in elements if not isinstance(element, PositionForce)]
    pushes = [(element, make_push(n, element, element.make_value(linkage)))
              for element in elements if isinstance(element, PositionForce)]

    def forces(links: LinkMotions, position: Scalar) -> list[Acting]:
        """Return two forces of each spring, then one of each force over a position."""
        acting = [force for spring in springs for force in
                  forces_of(spring, links[spring.links[0]], links[spring.links[1]], n)]
        for element, push in pushes:
            (value, _, e_x, e_y), point = push(links, position), element.point
            at = point_of(links[point.link], point.along, point.across)
            is_couple = element.direction is None
            acting.append(Acting(point.link, at.x, at.y, value * e_x, value * e_y,
                                 value if is_couple else 0.0))
        return acting
    return forces


def _links_of(elements: Sequence[Element], linkage: Mechanism) -> list[str]:
    """
    Return the moving links that elements name; refuse one that the mechanism does not have.

    Each once, in a fixed order: a formula recorded in another process has the same lines.
    """
    links = [link.name for link in linkage.LINKS]
    named = sorted({link for element in elements for link in element.links} - {GROUND})
    for link in named:
        if link not in links:
            raise InvalidParameter('link', link, f'must be one of {", ".join(links)}, {GROUND}')
    return named


def make_external(n: NumberType, linkage: Mechanism, elements: Sequence[Element]
                  ) -> Callable[[NamedFields, Scalar | Array, Any], Any]:
    """
    Return the function (motion, input, constant forces) -> forces on all links, with elements.

    The loads know external forces only. So springs, dampers and forces over a position are added
    to the constant external force of their link. Not checked to be finite; arguments and result
    are of the number type ``n``.
    """
    links = tuple(link.name for link in linkage.LINKS)
    named, forces = _links_of(elements, linkage), _make_all(n, linkage, elements)

    def external(motion: NamedFields, position: Scalar | Array, constant: Any) -> Any:
        """Return a record {link: :class:`Applied`}; a link without elements keeps its force."""
        motions = {link: linkage.link_motion(motion, link) for link in named}
        motions[GROUND] = FIXED
        acting, sums = forces(motions, position), []
        for link in links:
            applied = applied_to(constant, link)
            on_link = [force for force in acting if force.link == link]
            sums.append(unchecked(Applied, *_sum_of(applied, motions[link], on_link))
                        if link in named else applied)
        return _on_links(links)(*sums)
    return external


def make_loaded(linkage: Mechanism, elements: Sequence[Element]) -> Loaded:
    """
    Return the function (position, rate) -> linkage with the elements' forces of this moment.

    They come on top of its constant external forces, and act on any link, a driven crank too: so
    ``loads`` of that linkage include springs, dampers and forces over a position. It returns None
    where a force is not finite.
    """
    external = make_external(REAL, linkage, elements)

    def loaded(position: float, rate: float) -> Mechanism | None:
        """Return the linkage with the forces at this input and rate; accelerations have no say."""
        try:
            motion = linkage.motion(position, rate, 0.0)
        except FourBarError:
            return linkage                               # it has no loads here either
        try:
            forces = external(motion, position, linkage.external)
        except (ArithmeticError, InvalidParameter):      # ends of a spring meet, no finite value
            return None
        is_finite = all(isfinite(number) for force in forces
                        for number in (force.force_x, force.force_y, force.couple))
        return linkage.with_external(forces) if is_finite else None
    return loaded


def loads_with(linkage: Mechanism, elements: Sequence[Element], position: ArrayLike,
               rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0) -> NamedFields:
    """
    Return the loads of a prescribed motion with springs, dampers and forces over a position.

    ``position``, ``rate`` and ``acceleration`` of the input broadcast. The record is that of
    ``linkage.loads``: fields of the broadcast shape, NaN where there are no loads. Raises
    MissingBodies and InvalidParameter.
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
    record: NamedFields = linkage.LOADS(*(rows if shape else [float(row) for row in rows]))
    return record


@lru_cache(maxsize=64)
def _on_links(links: tuple[str, ...]) -> Any:
    """Return a type of records with a field for each link: the external force on it."""
    return namedtuple('OnLinks', links)  # noqa: PYI024


def _sum_of(constant: Applied, link: LinkMotion, acting: Sequence[Acting]) -> tuple[Scalar, ...]:
    """Return the fields of one external force that does the same as a constant one and others."""
    at = point_of(link, constant.along, constant.across)
    couple, force_x, force_y = 0.0, 0.0, 0.0
    for force in acting:                  # one by one: sum() rounds otherwise from Python 3.12 on
        couple = couple + (force.couple + (force.x - at.x) * force.force_y
                           - (force.y - at.y) * force.force_x)
        force_x, force_y = force_x + force.force_x, force_y + force.force_y
    return (constant.force_x + force_x, constant.force_y + force_y, constant.along,
            constant.across, constant.couple + couple)
