# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What one link, one spring and one damper add to the equation of motion.

Equations (E2) to (E5) of :mod:`fourbar_ros.dynamics.equation`, for any number type.
"""
from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

from fourbar_ros.dynamics.contract import Curve
from fourbar_ros.dynamics.elements import Attachment, Element, Spring, TorsionSpring
from fourbar_ros.mechanics.bodies import Applied, Body
from fourbar_ros.numerics.number_types import NumberType

Vector = tuple[float, float]


def make_link_terms(body: Body, gravity: Vector, applied: Applied) -> Callable[[Curve], Any]:
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

    def terms(curve: Curve) -> Any:
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


def place_of(curve: Curve, along: float, across: float) -> tuple[Any, Any, Any, Any]:
    """Return the place of a point of a link and its derivative (x, y, x', y')."""
    x0, y0, dx, dy, _, _, cosine, sine, turn, _ = curve
    x, y = along * cosine - across * sine, along * sine + across * cosine
    return x0 + x, y0 + y, dx - turn * y, dy + turn * x


def _between(one: Curve, first: Attachment, two: Curve, second: Attachment) -> tuple[Any, Any]:
    """Return (l^2, r.r') of two points, r the vector between them and l its length."""
    x1, y1, dx1, dy1 = place_of(one, first.along, first.across)
    x2, y2, dx2, dy2 = place_of(two, second.along, second.across)
    x, y = x2 - x1, y2 - y1
    return x * x + y * y, x * (dx2 - dx1) + y * (dy2 - dy1)


def deflection(n: NumberType, one: Curve, two: Curve, free_angle: float) -> Any:
    """Return the angle of the second link relative to the first, less the free one, in +-pi."""
    cosine, sine = one[6] * two[6] + one[7] * two[7], one[6] * two[7] - one[7] * two[6]
    cos_0, sin_0 = cos(free_angle), sin(free_angle)
    return n.atan2(sine * cos_0 - cosine * sin_0, cosine * cos_0 + sine * sin_0)


def link_stiffness(curve: Curve, body: Body, gravity: Vector, applied: Applied) -> Any:
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


def element_stiffness(n: NumberType, element: Element, one: Curve, two: Curve) -> Any:
    """Return -dQ/dq of a spring, from (E5)."""
    if isinstance(element, TorsionSpring):
        turn, bend = two[8] - one[8], two[9] - one[9]
        twist = deflection(n, one, two, element.free_angle)
        return element.stiffness * (turn * turn + twist * bend)
    x1, y1, dx1, dy1 = place_of(one, element.first.along, element.first.across)
    x2, y2, dx2, dy2 = place_of(two, element.second.along, element.second.across)
    (ddx1, ddy1), (ddx2, ddy2) = _bend_of(one, element.first), _bend_of(two, element.second)
    x, y, dx, dy = x2 - x1, y2 - y1, dx2 - dx1, dy2 - dy1
    square, product = x * x + y * y, x * dx + y * dy
    share = element.free_length / square**0.5 if element.free_length else 0.0
    growth = dx * dx + dy * dy + x * (ddx2 - ddx1) + y * (ddy2 - ddy1)
    return element.stiffness * ((1.0 - share) * growth
                                + (share * product * product / square if element.free_length
                                   else 0.0))


def _bend_of(curve: Curve, point: Attachment) -> tuple[Any, Any]:
    """Return the second derivative (x'', y'') of the place of a point of a link."""
    _, _, _, _, ddx, ddy, cosine, sine, turn, bend = curve
    x = point.along * cosine - point.across * sine
    y = point.along * sine + point.across * cosine
    return ddx - bend * y - turn * turn * x, ddy + bend * x - turn * turn * y


def make_element_terms(n: NumberType,
                       element: Element) -> Callable[[Curve, Curve], tuple[Any, Any]]:
    """Return the function (curves of its two links) -> (Q, D) of a spring and damper, (E5)."""
    stiffness, damping = element.stiffness, element.damping
    if isinstance(element, TorsionSpring):
        free_angle = element.free_angle

        def turned(one: Curve, two: Curve) -> tuple[Any, Any]:
            turn = two[8] - one[8]
            return (-stiffness * deflection(n, one, two, free_angle) * turn,
                    damping * turn * turn)
        return turned
    first, second, free_length = element.first, element.second, element.free_length

    def stretched(one: Curve, two: Curve) -> tuple[Any, Any]:
        square, product = _between(one, first, two, second)
        share = free_length / square**0.5 if free_length else 0.0
        return ((share - 1.0) * stiffness * product,
                damping * product * product / square if damping else 0.0)
    return stretched


def element_energy(n: NumberType, element: Element, one: Curve, two: Curve) -> Any:
    """Return the potential energy of a spring [J]."""
    if isinstance(element, Spring):
        stretch = _between(one, element.first, two, element.second)[0]**0.5 - element.free_length
    else:
        stretch = deflection(n, one, two, element.free_angle)
    return 0.5 * element.stiffness * stretch * stretch


def work_of(curve: Curve, body: Body, gravity: Vector, applied: Applied) -> Any:
    """Return minus the potential energy of the weight and of the applied force."""
    x, y, _, _ = place_of(curve, body.cg_along, body.cg_across)
    p_x, p_y, _, _ = place_of(curve, applied.along, applied.across)
    return (body.mass * (gravity[0] * x + gravity[1] * y)
            + applied.force_x * p_x + applied.force_y * p_y)
