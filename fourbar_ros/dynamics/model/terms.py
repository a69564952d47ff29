# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What one link, spring, damper and force over a position add to the equation of motion.

Equations (E2) to (E5) and (E7) of :mod:`fourbar_ros.dynamics.model.equation`, for any number type,
over the curves along which the links move.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import astuple
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
from fourbar_ros.errors import MissingBodies
from fourbar_ros.mechanics.bodies import Applied, Body
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.points import Curve, point_of
from fourbar_ros.numerics.number_types import direction, NumberType, Scalar

Vector = tuple[float, float]
Curves = Mapping[str, Curve]      # by link
DIFFERENCE = 6e-6      # of a place, for dF/ds: the cube root of eps


def make_link_terms(body: Body, gravity: Vector, applied: Applied
                    ) -> Callable[[Curve], tuple[Scalar, Scalar, Scalar]]:
    """Return the function curve -> (J, J'/2, Q) of one link, (E2) to (E4)."""
    mass, along, across = body.mass, body.mass * body.cg_along, body.mass * body.cg_across
    inertia = body.inertia + along * body.cg_along + across * body.cg_across
    (g_x, g_y), couple = gravity, applied.couple
    f_x, f_y = mass * g_x + applied.force_x, mass * g_y + applied.force_y
    # moment of weight and force about the first joint: by_cosine cos + by_sine sin
    by_cosine = (along * g_y - across * g_x
                 + applied.along * applied.force_y - applied.across * applied.force_x)
    by_sine = -(along * g_x + across * g_y
                + applied.along * applied.force_x + applied.across * applied.force_y)

    def terms(curve: Curve) -> tuple[Scalar, Scalar, Scalar]:
        _, _, dx, dy, ddx, ddy, cosine, sine, turn, bend = curve
        x, y = along * cosine - across * sine, along * sine + across * cosine        # S
        cross = x * dy - y * dx
        swing = inertia * turn + cross
        inertia_of = mass * (dx * dx + dy * dy) + turn * (swing + cross)                     # (E2)
        half_slope = (mass * (dx * ddx + dy * ddy) + bend * swing                            # (E3)
                      + turn * (x * ddy - y * ddx - turn * (x * dx + y * dy)))
        moment = couple + by_cosine * cosine + by_sine * sine
        return inertia_of, half_slope, f_x * dx + f_y * dy + moment * turn                   # (E4)
    return terms


def _between(one: Curve, first: Attachment, two: Curve,
             second: Attachment) -> tuple[Scalar, Scalar]:
    """Return (l^2, r.r') of two points, r the vector between them and l its length."""
    p, q = point_of(one, first.along, first.across), point_of(two, second.along, second.across)
    x, y = q.x - p.x, q.y - p.y
    return x * x + y * y, x * (q.v_x - p.v_x) + y * (q.v_y - p.v_y)


def deflection(n: NumberType, one: Curve, two: Curve, free_angle: float) -> Scalar:
    """Return the angle of the second link relative to the first, less the free one, in +-pi."""
    cosine, sine = one[6] * two[6] + one[7] * two[7], one[6] * two[7] - one[7] * two[6]
    cos_0, sin_0 = cos(free_angle), sin(free_angle)
    angle: Scalar = n.atan2(sine * cos_0 - cosine * sin_0, cosine * cos_0 + sine * sin_0)
    return angle


def link_stiffness(curve: Curve, body: Body, gravity: Vector, applied: Applied) -> Scalar:
    """Return -dQ/dq of the weight and the load of one link, from (E4)."""
    _, _, _, _, ddx, ddy, cosine, sine, turn, bend = curve
    stiffness = -applied.couple * bend
    for along, across, f_x, f_y in (
            (body.cg_along, body.cg_across, body.mass * gravity[0], body.mass * gravity[1]),
            (applied.along, applied.across, applied.force_x, applied.force_y)):
        x, y = along * cosine - across * sine, along * sine + across * cosine
        stiffness = (stiffness - f_x * ddx - f_y * ddy - bend * (x * f_y - y * f_x)
                     + turn * turn * (x * f_x + y * f_y))
    return stiffness


def element_stiffness(n: NumberType, element: Spring | TorsionSpring, one: Curve,
                      two: Curve) -> Scalar:
    """Return -dQ/dq of a spring, from (E5)."""
    if isinstance(element, TorsionSpring):
        turn, bend = two[8] - one[8], two[9] - one[9]
        twist = deflection(n, one, two, element.free_angle)
        return element.stiffness * (turn * turn + twist * bend)
    p = point_of(one, element.first.along, element.first.across)
    q = point_of(two, element.second.along, element.second.across)
    x, y, dx, dy = q.x - p.x, q.y - p.y, q.v_x - p.v_x, q.v_y - p.v_y
    square, product = x * x + y * y, x * dx + y * dy
    share = element.free_length / square**0.5 if element.free_length else 0.0
    growth = dx * dx + dy * dy + x * (q.a_x - p.a_x) + y * (q.a_y - p.a_y)
    return element.stiffness * ((1.0 - share) * growth
                                + (share * product * product / square if element.free_length
                                   else 0.0))


def make_element_terms(n: NumberType, element: Spring | TorsionSpring
                       ) -> Callable[[Curve, Curve], tuple[Scalar, Scalar]]:
    """Return the function (curves of its two links) -> (Q, D) of a spring and damper, (E5)."""
    stiffness, damping = element.stiffness, element.damping
    if isinstance(element, TorsionSpring):
        free_angle = element.free_angle

        def turned(one: Curve, two: Curve) -> tuple[Scalar, Scalar]:
            turn = two[8] - one[8]
            return (-stiffness * deflection(n, one, two, free_angle) * turn,
                    damping * turn * turn)
        return turned
    first, second, free_length = element.first, element.second, element.free_length

    def stretched(one: Curve, two: Curve) -> tuple[Scalar, Scalar]:
        square, product = _between(one, first, two, second)
        share = free_length / square**0.5 if free_length else 0.0
        return ((share - 1.0) * stiffness * product,
                damping * product * product / square if damping else 0.0)
    return stretched


def element_energy(n: NumberType, element: Spring | TorsionSpring, one: Curve,
                   two: Curve) -> Scalar:
    """Return the potential energy of a spring [J]."""
    stretch: Scalar
    if isinstance(element, Spring):
        stretch = _between(one, element.first, two, element.second)[0]**0.5 - element.free_length
    else:
        stretch = deflection(n, one, two, element.free_angle)
    return 0.5 * element.stiffness * stretch * stretch


def work_of(curve: Curve, body: Body, gravity: Vector, applied: Applied) -> Scalar:
    """Return minus the potential energy of the weight and of the applied force."""
    centre = point_of(curve, body.cg_along, body.cg_across)
    loaded = point_of(curve, applied.along, applied.across)
    return (body.mass * (gravity[0] * centre.x + gravity[1] * centre.y)
            + applied.force_x * loaded.x + applied.force_y * loaded.y)


class Pushing(NamedTuple):
    """
    A force over a position at one pose.

    Its value F, its place s, the unit vector e of its direction, (0, 0) of a couple.
    """

    value: Scalar
    place: Scalar
    along_x: Scalar
    along_y: Scalar


def make_push(n: NumberType, element: PositionForce,
              value: Callable[[Scalar], Scalar]
              ) -> Callable[[Curves, Scalar], Pushing]:
    """Return (curves by link, input) -> :class:`Pushing`; ``value``: s -> F(s)."""
    axes = element.axes
    c, s = (0.0, 0.0) if element.direction is None else direction(element.direction)

    def push(curves: Curves, position: Scalar) -> Pushing:
        place, cosine, sine = _place_of(n, element, curves, position), *curves[axes][6:8]
        return Pushing(n.call(value, place), place, c * cosine - s * sine, c * sine + s * cosine)
    return push


def _place_of(n: NumberType, element: PositionForce, curves: Curves,
              position: Scalar) -> Scalar:
    """Return the place s over which a force is given."""
    over = element.over
    if isinstance(over, LinkAngle):
        one, two = curves[over.relative_to], curves[over.link]
        angle: Scalar = n.atan2(one[6] * two[7] - one[7] * two[6],
                                one[6] * two[6] + one[7] * two[7])
        return angle
    if not isinstance(over, Way):
        return position
    (x, y, _, _), (cosine, sine) = _on_line(over, curves)
    return x * cosine + y * sine


def _on_line(over: Way, curves: Curves) -> tuple[list[Scalar], Vector]:
    """Return the vector from the origin to the point and its derivative, and the line's unit."""
    base, moving = curves[over.origin.link], curves[over.point.link]
    start = point_of(base, over.origin.along, over.origin.across)
    end = point_of(moving, over.point.along, over.point.across)
    c, s = direction(over.direction)
    return ([b - a for a, b in zip(start[:4], end[:4])],
            (c * base[6] - s * base[7], c * base[7] + s * base[6]))


def make_force_term(n: NumberType, element: PositionForce,
                    mechanism: Mechanism) -> Callable[[Curves, Scalar], Scalar]:
    """Return the function (curves by link, input) -> Q of a force over a position, (E7)."""
    push, point = make_push(n, element, element.make_value(mechanism)), element.point

    def term(curves: Curves, position: Scalar) -> Scalar:
        value, _, along_x, along_y = push(curves, position)
        if element.direction is None:
            return value * curves[point.link][8]
        pushed = point_of(curves[point.link], point.along, point.across)
        return value * (along_x * pushed.v_x + along_y * pushed.v_y)
    return term


def make_force_stiffness(n: NumberType, element: PositionForce,
                         mechanism: Mechanism
                         ) -> Callable[[Curves, Scalar, Scalar], Scalar]:
    """Return (curves by link, input, its derivative) -> -dQ/dq; dF/ds is a difference."""
    value, (link, along, across) = element.make_value(mechanism), astuple(element.point)
    push = make_push(n, element, value)

    def slope(place: Scalar) -> Scalar:
        step = DIFFERENCE * (1.0 + abs(place))
        found: Scalar = (value(place + step) - value(place - step)) / (2.0 * step)
        return found

    def stiffness(curves: Curves, position: Scalar, ratio: Scalar) -> Scalar:
        force, place, e_x, e_y = push(curves, position)
        curve, turn, over = curves[link], curves[element.axes][8], element.over
        growth: Scalar = n.call(slope, place)
        if isinstance(over, LinkAngle):
            ratio = curves[over.link][8] - curves[over.relative_to][8]
        elif isinstance(over, Way):
            (x, y, dx, dy), (cosine, sine) = _on_line(over, curves)
            turning = curves[over.origin.link][8]
            ratio = dx * cosine + dy * sine + turning * (y * cosine - x * sine)
        if element.direction is None:
            return -(growth * ratio * curve[8] + force * curve[9])
        _, _, dx, dy, ddx, ddy = point_of(curve, along, across)
        return -(growth * ratio * (e_x * dx + e_y * dy)
                 + force * (turn * (e_x * dy - e_y * dx) + e_x * ddx + e_y * ddy))
    return stiffness


def loads_of_links(mechanism: Mechanism) -> dict[str, tuple[Body, Applied]]:
    """Return {link: (body, what is applied to it)}; MissingBodies without masses."""
    if mechanism.bodies is None:
        raise MissingBodies
    return dict(mechanism.loads_of_links())
