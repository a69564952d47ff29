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

from fourbar_ros.mechanics.bodies import Applied, Base, Body, Gravity, NOT_APPLIED
from fourbar_ros.numerics.number_types import Scalar
from fourbar_ros.numerics.vectors import Vector


class LinkConstants(NamedTuple):
    """
    The constants of a link in these equations, about its first joint.

    With lengths in a unit, kg unit for kg and N unit for N m, so that forces stay in N.
    """

    mass: Scalar             # times the unit
    first_moment: Vector     # mass times centre of gravity, along the link and to its left
    inertia: Scalar
    held: Vector             # [N] -W, the force that holds the link at rest
    # -C = couple + by_cosine cos(angle) + by_sine sin(angle), that turns with the link
    couple: Scalar
    by_cosine: Scalar
    by_sine: Scalar

    def moment(self, direction: Vector, inertial: Scalar) -> Scalar:
        """
        Return ``inertial`` - C of (N2): the moment that the joints must transmit.

        C, of weight and loads, depends on the direction of the link, a unit vector.
        """
        return (inertial + self.by_cosine * direction.x + self.by_sine * direction.y
                + self.couple)


class Needs(NamedTuple):
    """The sum of joint forces on a link, F of (N1), and of their moments, M of (N2)."""

    force: Vector
    moment: Scalar


def about_first_joint(body: Body, unit: Scalar, gravity: Gravity,
                      applied: Applied = NOT_APPLIED) -> LinkConstants:
    """
    Return the constants of a link in the equations of motion about its first joint.

    Parameters
    ----------
    body, applied : Body, Applied
        In SI units; applied loads include no weight.
    unit : number
        A power of two [m] in which lengths are about one, so that no square of a length overflows.
    gravity : tuple of 2, or Base
        Field of gravity (x, y) [m/s^2]; a base is left to :func:`on_base`.

    """
    mass, along, across = body.mass * unit, body.cg_along / unit, body.cg_across / unit
    inertia = body.inertia / unit + mass * (along * along + across * across)
    along, across = mass * along, mass * across
    g_x, g_y = ((0.0, 0.0) if isinstance(gravity, Base) else
                (gravity[0] / unit, gravity[1] / unit))
    f_x, f_y = applied.force_x, applied.force_y
    p_along, p_across = applied.along / unit, applied.across / unit
    return LinkConstants(mass, Vector(along, across), inertia,
                         Vector(-mass * g_x - f_x, -mass * g_y - f_y), -applied.couple / unit,
                         across * g_x - along * g_y + p_across * f_x - p_along * f_y,
                         across * g_y + along * g_x + p_across * f_y + p_along * f_x)


def on_base(base: Base, unit: Scalar, link: Any) -> Any:
    """
    Return the motion by which a link on a moving base is loaded, (N3).

    Its first joint and its direction are those on the base, its accelerations and its rate are
    those of the ground, less gravity. ``link``: a :class:`.LinkMotion` with lengths in ``unit``
    [m].
    """
    w, e = base.rate, base.acceleration
    f_x, f_y = base.force_x / unit, base.force_y / unit
    return link._replace(
        a_x=link.a_x + f_x - e * link.y - 2.0 * (w * link.v_y) - w * w * link.x,        # (N3)
        a_y=link.a_y + f_y + e * link.x + 2.0 * (w * link.v_x) - w * w * link.y,
        omega=link.omega + w, alpha=link.alpha + e)


def needs_of(link: LinkConstants, a: Vector, direction: Vector, omega: Scalar,
             alpha: Scalar) -> Needs:
    """Return what the joints must give a link whose first joint has the acceleration ``a``."""
    r = link.first_moment.along(direction)
    return Needs(a * link.mass + link.held + r.normal * alpha - r * (omega * omega),    # (N1)
                 link.moment(direction, link.inertia * alpha + r.x * a.y - r.y * a.x))  # (N2)
