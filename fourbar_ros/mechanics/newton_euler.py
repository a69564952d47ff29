# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Newton-Euler for one rigid link: what its joints must give, as a force and a moment about a joint.

Notation: r is the mass of a link times the vector from its first joint to its centre of gravity, I
its moment of inertia about that joint, omega and alpha its turning, W the weight and the applied
force, C the moment of both and of the applied couple about the first joint; k x turns a vector by
90 degrees. The joint forces of a link that turns about a fixed joint add up to F, and their moment
about it to M:

    (N1)  F = alpha k x r - omega^2 r - W
    (N2)  M = I alpha - C

For a crank O1-A (index 1), a = A - O1, and the link of mass m that it carries at its pin A (index
2):

    (N3)  F2 = m (alpha1 k x a - omega1^2 a) + alpha k x r - omega^2 r - W
    (N4)  M_A = I alpha + (a . r) alpha1 - C + (a x r) omega1^2
    (N5)  M_O1 of both = (I1 + m a^2) alpha1 + (a . r) alpha - C1 - a x W - (a x r) omega^2 + M_A

The terms of a x r are given apart: in the sums of both moments omega1^2 - omega^2 is to be taken
as the product (omega1 - omega)(omega1 + omega).

Plain arithmetic, for whatever numbers motions are made of.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Applied, applied_to, Bodies, Body, External, NOT_APPLIED
from fourbar_ros.numerics.number_types import Scalar
from fourbar_ros.numerics.vectors import Vector

Gravity = tuple[Scalar, Scalar]


class LinkTerms(NamedTuple):
    """The constants of a link in the equations; lengths in a unit, origin at its first joint."""

    mass: Scalar             # [kg unit]
    first_moment: Vector     # [kg unit^2] mass times centre of gravity, along the link
    inertia: Scalar          # about the first joint
    held: Vector             # [N] -W
    # [N unit] -C = couple + by_cosine cos(angle) + by_sine sin(angle)
    couple: Scalar
    by_cosine: Scalar
    by_sine: Scalar

    def moment(self, direction: Vector, inertial: Scalar) -> Scalar:
        """Return a moment less C, as in (N2) and (N4)."""
        return (inertial + self.by_cosine * direction.x + self.by_sine * direction.y
                + self.couple)


class Turning(NamedTuple):
    """How a link stands and turns: its direction as a unit vector, omega and alpha."""

    direction: Vector
    omega: Scalar
    alpha: Scalar


class Needs(NamedTuple):
    """What the joints of a link must give: F of (N1), M of (N2)."""

    force: Vector
    moment: Scalar


class NeedsOfCarried(NamedTuple):
    """
    What the joints of a link must give that a crank carries, in parts that do not cancel.

    F2 of (N3); M_A of (N4) without the term of a x r; a . r and a x r.
    """

    force: Vector
    moment: Scalar
    a_dot_r: Scalar
    a_cross_r: Scalar


def about_first_joint(body: Body, unit: Scalar, gravity: Gravity,
                      applied: Applied = NOT_APPLIED) -> LinkTerms:
    """Return the :class:`LinkTerms` of a link, with lengths in ``unit`` [m]."""
    mass, along, across = body.mass * unit, body.cg_along / unit, body.cg_across / unit
    inertia = body.inertia / unit + mass * (along * along + across * across)
    along, across = mass * along, mass * across
    g_x, g_y = gravity[0] / unit, gravity[1] / unit
    f_x, f_y = applied.force_x, applied.force_y
    p_along, p_across = applied.along / unit, applied.across / unit
    return LinkTerms(mass, Vector(along, across), inertia,
                     Vector(-mass * g_x - f_x, -mass * g_y - f_y), -applied.couple / unit,
                     across * g_x - along * g_y + p_across * f_x - p_along * f_y,
                     across * g_y + along * g_x + p_across * f_y + p_along * f_x)


def crank_with_pin(bodies: Bodies, unit: Scalar, gravity: Gravity, external: External,
                   carried: LinkTerms, a1: Scalar) -> LinkTerms:
    """
    Return the :class:`LinkTerms` of the crank; lengths, and ``a1`` of the crank, in ``unit`` [m].

    Its moments about O1 include what it carries at its pin A: the mass of the next link and the
    force that holds that link at rest, in (N5) the terms m a^2 alpha1 and -a x W.
    """
    crank = about_first_joint(bodies.crank, unit, gravity, applied_to(external, 'crank'))
    return crank._replace(inertia=crank.inertia + carried.mass * a1 * a1,
                          by_cosine=crank.by_cosine + a1 * carried.held.y,
                          by_sine=crank.by_sine - a1 * carried.held.x)


def needs_of_pivoted(link: LinkTerms, turning: Turning) -> Needs:
    """Return the needs of a link that turns about a fixed joint."""
    direction, omega, alpha = turning
    r = link.first_moment.along(direction)
    return Needs(link.held + r.normal * alpha - r * (omega * omega),                    # (N1)
                 link.moment(direction, link.inertia * alpha))                          # (N2)


def needs_of_crank_and_carried(crank: LinkTerms, of_crank: Turning, link: LinkTerms,
                               of_link: Turning, a1: Scalar) -> tuple[Needs, NeedsOfCarried]:
    """
    Return the needs of a crank and of the link that it carries at its pin A.

    ``crank`` as of :func:`crank_with_pin`. The moment of the crank is that of both about O1, (N5),
    less M_A and without the term of a x r.
    """
    direction, omega, alpha = of_link
    r, a = link.first_moment.along(direction), of_crank.direction * a1
    of_a = a.normal * of_crank.alpha - a * (of_crank.omega * of_crank.omega)
    carried = NeedsOfCarried(
        link.held + of_a * link.mass + r.normal * alpha - r * (omega * omega),          # (N3)
        link.moment(direction, link.inertia * alpha + a.dot(r) * of_crank.alpha),       # (N4)
        a.dot(r), a.cross(r))
    force, moment = needs_of_pivoted(crank, of_crank)
    return Needs(force, moment + carried.a_dot_r * alpha), carried                      # (N5)
