# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Newton-Euler for one rigid link: the force and the moment that its joints must transmit to it.

Notation: m is the mass of a link, r its mass times the vector from its first joint X to its centre
of gravity, I its moment of inertia about X; a is the acceleration of X, omega and alpha are the
rate and the acceleration of the link. W is the weight and the applied force, C the moment of both
and of the applied couple about X. k x turns a vector by 90 degrees. The joint forces of a link add
up to F, and their moment about X to M:

    (N1)  F = m a + alpha k x r - omega^2 r - W
    (N2)  M = I alpha + r x a - C

On a base that moves, with the specific force f at O1, the rate w and the angular acceleration e,
a link whose X is at p and moves with v and a on the base needs what a link without weight would
need on the ground that turns with omega + w and alpha + e, and whose X has the acceleration

    (N3)  a + f + e k x p + 2 w k x v - w^2 p

Plain arithmetic, for whatever numbers motions are made of.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Applied, Base, Body, Gravity
from fourbar_ros.numerics.number_types import Scalar


class Vector:
    """A vector along the ground axes, of any numbers; a factor stands on its right: a * x."""

    __slots__ = ('x', 'y')
    __array_ufunc__ = None       # arrays leave products with a vector to the vector

    def __init__(self, x: Scalar, y: Scalar) -> None:
        self.x, self.y = x, y

    def __add__(self, vector: Vector) -> Vector:
        return Vector(self.x + vector.x, self.y + vector.y)

    def __sub__(self, vector: Vector) -> Vector:
        return Vector(self.x - vector.x, self.y - vector.y)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y)

    def __mul__(self, factor: Scalar) -> Vector:
        return Vector(factor * self.x, factor * self.y)

    def __truediv__(self, divisor: Scalar) -> Vector:
        return Vector(self.x / divisor, self.y / divisor)

    @property
    def normal(self) -> Vector:
        """Return k x a: the vector turned by +90 degrees."""
        return Vector(-self.y, self.x)

    def dot(self, vector: Vector) -> Scalar:
        return self.x * vector.x + self.y * vector.y

    def cross(self, vector: Vector) -> Scalar:
        return self.x * vector.y - self.y * vector.x

    def along(self, direction: Vector) -> Vector:
        """Return on the ground axes a vector given along a unit vector (x) and to its left (y)."""
        return Vector(self.x * direction.x - self.y * direction.y,
                      self.x * direction.y + self.y * direction.x)


class Needs(NamedTuple):
    """The sum of joint forces on a link, F of (N1), and of their moments, M of (N2)."""

    force: Vector
    moment: Scalar


def needs_of(body: Body, unit: Scalar, gravity: Gravity, applied: Applied, link: Any) -> Needs:
    """Return what the joints must give a link, (N1) and (N2), about its first joint."""
    # unit: a power of two [m] in which lengths are about one, so that no square of a length
    # overflows; moments are in N unit. applied includes no weight; gravity: a field (x, y)
    # [m/s^2], or the motion of the base. link: its LinkMotion, lengths in unit, as seen from a
    # base that moves.
    # what hangs on data alone comes first: for a step of floats it is computed once
    mass, along, across = body.mass * unit, body.cg_along / unit, body.cg_across / unit
    inertia = body.inertia / unit + mass * (along * along + across * across)
    along, across = mass * along, mass * across
    g_x, g_y = ((0.0, 0.0) if isinstance(gravity, Base) else
                (gravity[0] / unit, gravity[1] / unit))
    f_x, f_y = applied.force_x, applied.force_y
    p_along, p_across = applied.along / unit, applied.across / unit
    held = Vector(-mass * g_x - f_x, -mass * g_y - f_y)      # [N] -W
    # -C: the arms of weight and applied force turn with the link, so
    # -C = couple + by_cosine cos(angle) + by_sine sin(angle)
    couple = -applied.couple / unit
    by_cosine = across * g_x - along * g_y + p_across * f_x - p_along * f_y
    by_sine = across * g_y + along * g_x + p_across * f_y + p_along * f_x

    a_x, a_y, omega, alpha = link.a_x, link.a_y, link.omega, link.alpha
    if isinstance(gravity, Base):
        w, e = gravity.rate, gravity.acceleration
        a_x = a_x + gravity.force_x / unit - e * link.y - 2.0 * (w * link.v_y) - w * w * link.x
        a_y = a_y + gravity.force_y / unit + e * link.x + 2.0 * (w * link.v_x) - w * w * link.y
        omega, alpha = omega + w, alpha + e                                             # (N3)
    r = Vector(along, across).along(Vector(link.cosine, link.sine))
    force = Vector(a_x, a_y) * mass + held + r.normal * alpha - r * (omega * omega)     # (N1)
    moment = inertia * alpha + r.x * a_y - r.y * a_x                                    # (N2)
    return Needs(force, moment + by_cosine * link.cosine + by_sine * link.sine + couple)
