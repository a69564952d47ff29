# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Terms of one link, spring, damper or force over a position in the equation of motion.

Equations (E2) to (E5) and (E7) of :mod:`fourbar_ros.dynamics.model.equation`, for any number type.
The motion of a link is taken at unit rate and zero acceleration of the input: its velocities are
first derivatives with respect to the input q, its accelerations second ones.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, sin
from typing import NamedTuple

from fourbar_ros.dynamics.model.elements import (
    Attachment,
    LinkAngle,
    PositionForce,
    Spring,
    TorsionSpring,
    Way,
)
from fourbar_ros.mechanics.bodies import Applied, Body
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.points import LinkMotion, MovingPoint, point_of
from fourbar_ros.numerics.number_types import direction, NumberType, Scalar

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
        _, _, dx, dy, ddx, ddy, cosine, sine, turn, bend = link
        x, y = along * cosine - across * sine, along * sine + across * cosine        # S
        cross = x * dy - y * dx
        swing = inertia * turn + cross
        inertia_of = mass * (dx * dx + dy * dy) + turn * (swing + cross)                     # (E2)
        half_slope = (mass * (dx * ddx + dy * ddy) + bend * swing                            # (E3)
                      + turn * (x * ddy - y * ddx - turn * (x * dx + y * dy)))
        moment = couple + by_cosine * cosine + by_sine * sine
        return LinkTerms(inertia_of, half_slope, f_x * dx + f_y * dy + moment * turn)        # (E4)
    return terms


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
