# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Forces of links, springs, dampers and forces over a position: in the equation of motion, as loads.

Equations (E2) to (E5) and (E7) of :mod:`fourbar_ros.dynamics.equation`, for any number type.
The motion of a link is taken at unit rate and zero acceleration of the input: its velocities are
first derivatives with respect to the input q, its accelerations second ones.
"""
from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from math import cos, isfinite, sin
from typing import Any, NamedTuple, Union

from fourbar_ros.dynamics.elements import (
    Attachment,
    Element,
    LinkAngle,
    PositionForce,
    Spring,
    TorsionSpring,
    Way,
)
from fourbar_ros.errors import FourBarError, InvalidParameter, MissingBodies
from fourbar_ros.mechanics.bodies import Applied, applied_to, Base, Body, unchecked
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.mechanisms.points import FIXED, LinkMotion, MovingPoint, point_of
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import ARRAY, direction, NumberType, REAL, Scalar
import numpy as np
from numpy.typing import ArrayLike

Vector = tuple[float, float]
LinkMotions = Mapping[str, LinkMotion]      # by name of the link, the ground among them


class LinkTerms(NamedTuple):
    """Terms that one link adds to (E1)."""

    inertia: Scalar          # J
    half_slope: Scalar       # J'/2
    force: Scalar            # Q of its weight and its applied load


class Tension(NamedTuple):
    """
    What a spring pulls with: of a linear spring over its length, of a torsion spring its moment.

    The damper adds ``damping`` times growth / square.
    """

    pull: Scalar         # k (1 - l0/l), or k (a - a0)
    growth: Scalar       # r.r', or a'
    square: Scalar       # l^2, or 1


def make_link_terms(body: Body, gravity: Vector, applied: Applied
                    ) -> Callable[[LinkMotion], LinkTerms]:
    """Return the function motion of a link -> its :class:`LinkTerms`, (E2) to (E4)."""
    mass, along, across = body.mass, body.mass * body.cg_along, body.mass * body.cg_across
    inertia = body.inertia + along * body.cg_along + across * body.cg_across
    (g_x, g_y), couple = gravity, applied.couple
    f_x, f_y = mass * g_x + applied.force_x, mass * g_y + applied.force_y
    # moment of weight and force about the first joint: by_cosine cos + by_sine sin
    by_cosine = (along * g_y - across * g_x
                 + applied.along * applied.force_y - applied.across * applied.force_x)
    by_sine = -(along * g_x + across * g_y
                + applied.along * applied.force_x + applied.across * applied.force_y)

    def terms(link: LinkMotion) -> LinkTerms:
        """Return the terms at one position; mass, inertia and load are those given above."""
        dx, dy, turn, cosine, sine = link.v_x, link.v_y, link.omega, link.cosine, link.sine
        x, y = along * cosine - across * sine, along * sine + across * cosine        # S
        cross = x * dy - y * dx
        swing = inertia * turn + cross
        inertia_of = mass * (dx * dx + dy * dy) + turn * (swing + cross)                     # (E2)
        half_slope = (mass * (dx * link.a_x + dy * link.a_y) + link.alpha * swing            # (E3)
                      + turn * (x * link.a_y - y * link.a_x - turn * (x * dx + y * dy)))
        moment = couple + by_cosine * cosine + by_sine * sine
        return LinkTerms(inertia_of, half_slope, f_x * dx + f_y * dy + moment * turn)        # (E4)
    return terms


def make_turning_force(body: Body, base: Base) -> Callable[[LinkMotion], Scalar]:
    """Return the function motion of a link -> Q of the turning of a base, (E8)."""
    mass, along, across = body.mass, body.mass * body.cg_along, body.mass * body.cg_across
    inertia = body.inertia + along * body.cg_along + across * body.cg_across
    square, turned = base.rate * base.rate, base.acceleration

    def turning_force(link: LinkMotion) -> Scalar:
        """Return what the base's rate and angular acceleration push the input with."""
        x, y, dx, dy, turn = link.x, link.y, link.v_x, link.v_y, link.omega
        cosine, sine = link.cosine, link.sine
        s_x, s_y = along * cosine - across * sine, along * sine + across * cosine
        m_x, m_y = mass * x + s_x, mass * y + s_y
        momentum = m_x * dy - m_y * dx + turn * (x * s_x + y * s_y + inertia)
        return (square * (m_x * dx + m_y * dy - turn * (x * s_y - y * s_x))
                - turned * momentum)                                                     # (E8)
    return turning_force


def apart(one: LinkMotion, first: Attachment, two: LinkMotion, second: Attachment) -> MovingPoint:
    """Return the vector from a point of one link to a point of another, with its derivatives."""
    p, q = point_of(one, first.along, first.across), point_of(two, second.along, second.across)
    return MovingPoint(*[b - a for a, b in zip(p, q)])


def deflection(n: NumberType, one: LinkMotion, two: LinkMotion, free_angle: float) -> Scalar:
    """
    Return the angle of the second link from the first, less the free angle, in (-pi, pi].

    It comes from sines and cosines of the directions, so no angle has to be unwrapped.
    """
    cosine = one.cosine * two.cosine + one.sine * two.sine
    sine = one.cosine * two.sine - one.sine * two.cosine
    cos_0, sin_0 = cos(free_angle), sin(free_angle)
    angle: Scalar = n.atan2(sine * cos_0 - cosine * sin_0, cosine * cos_0 + sine * sin_0)
    return angle


def make_tension(n: NumberType, element: Spring | TorsionSpring
                 ) -> Callable[[LinkMotion, LinkMotion], Tension]:
    """Return the function (motions of its two links) -> :class:`Tension` of a spring, (E5)."""
    stiffness = element.stiffness
    if isinstance(element, TorsionSpring):
        free_angle = element.free_angle
        return lambda one, two: Tension(stiffness * deflection(n, one, two, free_angle),
                                        two.omega - one.omega, 1.0)
    first, second, free_length = element.first, element.second, element.free_length

    def of_spring(one: LinkMotion, two: LinkMotion) -> Tension:
        x, y, dx, dy, _, _ = apart(one, first, two, second)
        square = x * x + y * y
        share = free_length / square**0.5 if free_length else 0.0
        return Tension(stiffness * (1.0 - share), x * dx + y * dy, square)
    return of_spring


def element_energy(n: NumberType, element: Spring | TorsionSpring, one: LinkMotion,
                   two: LinkMotion) -> Scalar:
    """Return the potential energy of a spring between two links [J]."""
    stretch: Scalar
    if isinstance(element, Spring):
        gap = apart(one, element.first, two, element.second)
        stretch = (gap.x * gap.x + gap.y * gap.y)**0.5 - element.free_length
    else:
        stretch = deflection(n, one, two, element.free_angle)
    return 0.5 * element.stiffness * stretch * stretch


def work_of(link: LinkMotion, body: Body, gravity: Vector, applied: Applied) -> Scalar:
    """Return minus the potential energy of the weight and the applied force of a link [J]."""
    centre = point_of(link, body.cg_along, body.cg_across)
    loaded = point_of(link, applied.along, applied.across)
    return (body.mass * (gravity[0] * centre.x + gravity[1] * centre.y)
            + applied.force_x * loaded.x + applied.force_y * loaded.y)


class Push(NamedTuple):
    """A force over a position at one pose of the mechanism."""

    value: Scalar        # F [N], or a couple [N m]
    place: Scalar        # s, at which F(s) was taken
    along_x: Scalar      # unit vector of its direction; (0, 0) for a couple
    along_y: Scalar


def make_push(n: NumberType, element: PositionForce, value: Callable[[Scalar], Scalar]
              ) -> Callable[[LinkMotions, Scalar], Push]:
    """Return (motions of links, input) -> :class:`Push`; ``value`` is the function s -> F(s)."""
    axes = element.axes
    c, s = (0.0, 0.0) if element.direction is None else direction(element.direction)

    def push(links: LinkMotions, position: Scalar) -> Push:
        """Return F and its direction, given relative to the link ``axes``, on the ground."""
        place, cosine, sine = (place_of(n, element, links, position), links[axes].cosine,
                               links[axes].sine)
        return Push(n.call(value, place), place, c * cosine - s * sine, c * sine + s * cosine)
    return push


def place_of(n: NumberType, element: PositionForce, links: LinkMotions,
             position: Scalar) -> Scalar:
    """Return the place s over which a force is given: a link's angle, a way, or the input."""
    over = element.over
    if isinstance(over, LinkAngle):
        one, two = links[over.relative_to], links[over.link]
        angle: Scalar = n.atan2(one.cosine * two.sine - one.sine * two.cosine,
                                one.cosine * two.cosine + one.sine * two.sine)
        return angle
    if not isinstance(over, Way):
        return position
    gap, (cosine, sine) = _on_line(over, links)
    return gap.x * cosine + gap.y * sine


def _on_line(over: Way, links: LinkMotions) -> tuple[MovingPoint, Vector]:
    """Return the vector from the origin of a way to its point, and the line's unit vector."""
    base, (c, s) = links[over.origin.link], direction(over.direction)
    return (apart(base, over.origin, links[over.point.link], over.point),
            (c * base.cosine - s * base.sine, c * base.sine + s * base.cosine))


def make_force_term(n: NumberType, element: PositionForce,
                    mechanism: Mechanism) -> Callable[[LinkMotions, Scalar], Scalar]:
    """Return the function (motions of links, input) -> Q of a force over a position, (E7)."""
    push, point = make_push(n, element, element.make_value(mechanism)), element.point

    def term(links: LinkMotions, position: Scalar) -> Scalar:
        """Return F e.P' of a force at the point P, or F theta' of a couple."""
        value, _, along_x, along_y = push(links, position)
        if element.direction is None:
            return value * links[point.link].omega
        pushed = point_of(links[point.link], point.along, point.across)
        return value * (along_x * pushed.v_x + along_y * pushed.v_y)
    return term


# --- as external forces of the loads -------------------------------------------------------------

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
        loads = linkage.loads_formula(ARRAY, linkage.with_external(external).constants)(motion)
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
