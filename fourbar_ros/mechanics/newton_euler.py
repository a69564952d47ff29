# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Newton-Euler for one rigid link: the force and the moment that its joints must transmit to it.

Notation: r is the mass of a link times the vector from its first joint to its centre of gravity. I
is its moment of inertia about that joint; omega and alpha are its rate and acceleration. W is the
weight and the applied force, C the moment of both and of the applied couple about the first joint.
k x turns a vector by 90 degrees. The joint forces of a link that turns about a fixed joint add up
to F, and their moment about it to M:

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

from collections.abc import Callable
from typing import NamedTuple, TypeVar

from fourbar_ros.mechanics.bodies import Applied, applied_to, Bodies, Body, External, NOT_APPLIED
from fourbar_ros.numerics.number_types import NumberType, Scalar
from fourbar_ros.numerics.vectors import Vector

Gravity = tuple[Scalar, Scalar]
_Loads = TypeVar('_Loads')


class LinkTerms(NamedTuple):
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
        Return ``inertial`` - C of (N2) and (N4): the moment that the joints must transmit.

        C, of weight and loads, depends on the direction of the link, a unit vector.
        """
        return (inertial + self.by_cosine * direction.x + self.by_sine * direction.y
                + self.couple)


class Turning(NamedTuple):
    """How a link turns: its direction as a unit vector, omega [rad/s] and alpha [rad/s^2]."""

    direction: Vector
    omega: Scalar
    alpha: Scalar


class Needs(NamedTuple):
    """The sum of joint forces on a link, F of (N1), and of their moments, M of (N2)."""

    force: Vector
    moment: Scalar


class NeedsOfCarried(NamedTuple):
    """
    The same of a link that a crank carries, in parts that do not cancel.

    F2 of (N3), M_A of (N4) without its term of a x r, and the products a . r and a x r.
    """

    force: Vector
    moment: Scalar
    a_dot_r: Scalar
    a_cross_r: Scalar


def about_first_joint(body: Body, unit: Scalar, gravity: Gravity,
                      applied: Applied = NOT_APPLIED) -> LinkTerms:
    """
    Return the constants of a link in the equations of motion about its first joint.

    Parameters
    ----------
    body, applied : Body, Applied
        In SI units; applied loads include no weight.
    unit : number
        A power of two [m] in which lengths are about one, so that no square of a length overflows.
    gravity : tuple of 2
        Field of gravity (x, y) [m/s^2].

    """
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
    Return the constants of a crank that carries a link; its length ``a1`` is in ``unit`` [m].

    Mass and weight of that link count at the pin A: the terms m a^2 alpha1 and -a x W of (N5) then
    do not cancel against others.
    """
    crank = about_first_joint(bodies.crank, unit, gravity, applied_to(external, 'crank'))
    return crank._replace(inertia=crank.inertia + carried.mass * a1 * a1,
                          by_cosine=crank.by_cosine + a1 * carried.held.y,
                          by_sine=crank.by_sine - a1 * carried.held.x)


def needs_of_pivoted(link: LinkTerms, turning: Turning) -> Needs:
    """Return the force and the moment that a link needs to turn about a fixed joint."""
    direction, omega, alpha = turning
    r = link.first_moment.along(direction)
    return Needs(link.held + r.normal * alpha - r * (omega * omega),                    # (N1)
                 link.moment(direction, link.inertia * alpha))                          # (N2)


def needs_of_crank_and_carried(crank: LinkTerms, of_crank: Turning, link: LinkTerms,
                               of_link: Turning, a1: Scalar) -> tuple[Needs, NeedsOfCarried]:
    """
    Return the force and the moment that a crank needs, and the link that it carries at its pin A.

    ``crank``: of :func:`crank_with_pin`. Its moment is that of both about O1, (N5), less M_A and
    without the term of a x r.
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


def joint_loads(n: NumberType, record: Callable[..., _Loads],
                forces: tuple[Vector, Vector, Vector], f32: Vector, f43: Vector,
                **others: Scalar) -> _Loads:
    """
    Return the loads of a chain of three moving links from known F32 and F43.

    ``forces``: F1, F2, F3 that the joints of each link must give. F21 and F41 follow by
    subtraction; the shaking force is summed over the links, not over the reactions: inner forces
    much larger than the sum would spoil it. ``others``: the fields of the record besides forces.
    """
    hypot, (F1, F2, F3) = n.hypot, forces
    f21 = f32 - F2
    f41 = F1 - f21
    shaking_force = -(F1 + F2 + F3)
    return record(
        f41_x=f41.x, f41_y=f41.y, f21_x=f21.x, f21_y=f21.y, f32_x=f32.x, f32_y=f32.y,
        f43_x=f43.x, f43_y=f43.y, f41=hypot(f41.x, f41.y), f21=hypot(f21.x, f21.y),
        f32=hypot(f32.x, f32.y), f43=hypot(f43.x, f43.y), shaking_force_x=shaking_force.x,
        shaking_force_y=shaking_force.y, shaking_force=hypot(shaking_force.x, shaking_force.y),
        **others)
