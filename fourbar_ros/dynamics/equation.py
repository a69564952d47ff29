# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Eksergian's equation of motion of any mechanism with one degree of freedom.

With q the input (an angle or a slide), primes for derivatives with respect to it, and w = dq/dt,

    J dw/dt + J'/2 w^2 = Q - D w + T                                                       (E1)

T being the torque (force) of the drive. A link of mass m, whose first joint X moves along the
curve X(q) while the link turns by theta(q), with S its first moment of mass about X (along the
ground axes) and I its moment of inertia about X, adds

    J    = m X'.X' + 2 theta' (S x X') + I theta'^2                                        (E2)
    J'/2 = m X'.X'' + theta'' (S x X') + theta' (S x X'') - theta'^2 (S.X')
           + I theta' theta''                                                              (E3)

Gravity g and a load applied to the link (force F at a point, couple C) add, with f = m g + F and c
the moment of all of these about X,

    Q = f.X' + c theta'                                                                    (E4)

A spring (k, free length l0) and damper d between two points the vector r apart, l = |r|, and a
torsion spring and damper between two links at the relative angle a, add

    Q = -k (1 - l0/l) r.r',   D = d (r.r'/l)^2;      Q = -k (a - a0) a',   D = d a'^2      (E5)

X', X'', theta', theta'' are the motion at unit rate and zero acceleration: exact, without
differences. Sources: Eksergian, Dynamical analysis of machines, J. Franklin Institute 209-211
(1930-31); Paul, Kinematics and Dynamics of Planar Machinery (1979), chapter 12.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, cos, sin
from typing import Any, NamedTuple

from fourbar_ros.dynamics.contract import Curve, curves_of, CurvesOf, FIXED, loads_of_links
from fourbar_ros.dynamics.elements import Attachment, Element, GROUND, Spring, TorsionSpring
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Applied, Body, NOT_APPLIED
import numpy as np

Vector = tuple[float, float]


class Terms(NamedTuple):
    """Terms of (E1) at one input; each a float, or an array of the input's shape."""

    inertia: Any          # J [kg m^2], of a slide [kg]
    half_slope: Any       # J'/2 [kg m^2/rad], [kg/m]
    force: Any            # Q of gravity, loads and springs [N m], [N]
    damping: Any          # D [N m s/rad], [N s/m]


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


def _deflection(one: Curve, two: Curve, free_angle: float) -> Any:
    """Return the angle of the second link relative to the first, less the free one, in +-pi."""
    cosine, sine = one[6] * two[6] + one[7] * two[7], one[6] * two[7] - one[7] * two[6]
    cos_0, sin_0 = cos(free_angle), sin(free_angle)
    y, x = sine * cos_0 - cosine * sin_0, cosine * cos_0 + sine * sin_0
    return atan2(y, x) if isinstance(y, float) else np.arctan2(y, x)


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


def element_stiffness(element: Element, one: Curve, two: Curve) -> Any:
    """Return -dQ/dq of a spring, from (E5)."""
    if isinstance(element, TorsionSpring):
        turn, bend = two[8] - one[8], two[9] - one[9]
        return element.stiffness * (turn * turn + _deflection(one, two, element.free_angle) * bend)
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


def make_element_terms(element: Element) -> Callable[[Curve, Curve], tuple[Any, Any]]:
    """Return the function (curves of its two links) -> (Q, D) of a spring and damper, (E5)."""
    stiffness, damping = element.stiffness, element.damping
    if isinstance(element, TorsionSpring):
        free_angle = element.free_angle

        def turned(one: Curve, two: Curve) -> tuple[Any, Any]:
            turn = two[8] - one[8]
            return -stiffness * _deflection(one, two, free_angle) * turn, damping * turn * turn
        return turned
    first, second, free_length = element.first, element.second, element.free_length

    def stretched(one: Curve, two: Curve) -> tuple[Any, Any]:
        square, product = _between(one, first, two, second)
        share = free_length / square**0.5 if free_length else 0.0
        return ((share - 1.0) * stiffness * product,
                damping * product * product / square if damping else 0.0)
    return stretched


def element_energy(element: Element, one: Curve, two: Curve) -> Any:
    """Return the potential energy of a spring [J]."""
    if isinstance(element, Spring):
        stretch = _between(one, element.first, two, element.second)[0]**0.5 - element.free_length
    else:
        stretch = _deflection(one, two, element.free_angle)
    return 0.5 * element.stiffness * stretch * stretch


class Equation:
    """
    The equation of motion (E1) of a mechanism with its springs and dampers.

    Parameters
    ----------
    mechanism : Mechanism
        With bodies; gravity and external loads are taken from it.
    elements : sequence of Spring or TorsionSpring
    extra_inertia : float
        Constant inertia on the input, as of a flywheel [kg m^2], [kg].
    make_curves : callable
        Of (mechanism, links), returns the function input -> curves of the links.

    Raises
    ------
    MissingBodies, InvalidParameter
        Without masses; for an element on a link that the mechanism does not have.

    """

    def __init__(self, mechanism: Any, elements: Sequence[Element] = (),
                 extra_inertia: float = 0.0,
                 make_curves: Callable[[Any, Sequence[str]], CurvesOf] = curves_of) -> None:
        self.mechanism, self.elements = mechanism, tuple(elements)
        self.extra_inertia = extra_inertia
        loads, gravity = loads_of_links(mechanism), mechanism.gravity
        self._curves = make_curves(mechanism, tuple(loads))
        self._bodies = [(i, *what) for i, what in enumerate(loads.values())
                        if what[0].mass or what[0].inertia or what[1] != NOT_APPLIED]
        self.has_couples = any(applied.couple for _, _, applied in self._bodies)
        self._links = [(i, make_link_terms(body, gravity, applied))
                       for i, body, applied in self._bodies]
        places = {**{name: i for i, name in enumerate(loads)}, GROUND: len(loads)}
        for name in (link for element in self.elements for link in element.links):
            if name not in places:
                raise InvalidParameter('link', name, f'must be one of {", ".join(places)}')
        self._springs = [(*(places[link] for link in element.links), make_element_terms(element))
                         for element in self.elements]

    def terms(self, position: Any) -> Terms:
        """Return J, J'/2, Q and D at an input or an array of inputs; errors as of ``motion``."""
        curves = [*self._curves(position), FIXED]
        inertia, half_slope, force, damping = self.extra_inertia, 0.0, 0.0, 0.0
        for i, terms_of in self._links:
            j, k, f = terms_of(curves[i])
            inertia, half_slope, force = inertia + j, half_slope + k, force + f
        for one, two, terms_of in self._springs:
            f, d = terms_of(curves[one], curves[two])
            force, damping = force + f, damping + d
        return Terms(inertia, half_slope, force, damping)

    def acceleration(self, position: Any, rate: Any, drive: Any = 0.0) -> Any:
        """Return dw/dt under the torque (force) of the drive on the input, by (E1)."""
        inertia, half_slope, force, damping = self.terms(position)
        return (force + drive - (damping + half_slope * rate) * rate) / inertia

    def torque(self, position: Any, rate: Any, acceleration: Any) -> Any:
        """Return the torque (force) of the drive that this motion needs, by (E1)."""
        inertia, half_slope, force, damping = self.terms(position)
        return inertia * acceleration + (half_slope * rate + damping) * rate - force

    def stiffness(self, position: Any) -> Any:
        """Return -dQ/dq [N m/rad], [N/m], exact as the other terms are."""
        curves = [*self._curves(position), FIXED]
        total = 0.0 * curves[0][6]
        for i, body, applied in self._bodies:
            total = total + link_stiffness(curves[i], body, self.mechanism.gravity, applied)
        for element, (one, two, _) in zip(self.elements, self._springs):
            total = total + element_stiffness(element, curves[one], curves[two])
        return total

    def couples(self, position: Any) -> Any:
        """Return the part of Q of couples applied to links, which do work over every turn."""
        if not self.has_couples:
            return 0.0
        curves = self._curves(position)
        return sum(applied.couple * curves[i][8] for i, _, applied in self._bodies)

    def potential(self, position: Any) -> Any:
        """Return V [J], Q = -V' but for :meth:`couples`: of gravity, constant forces, springs."""
        curves = [*self._curves(position), FIXED]
        energy = 0.0
        for i, body, applied in self._bodies:
            energy = energy - _work(curves[i], body, self.mechanism.gravity, applied)
        for element, (one, two, _) in zip(self.elements, self._springs):
            energy = energy + element_energy(element, curves[one], curves[two])
        return energy

    def energy(self, position: Any, rate: Any) -> Any:
        """Return kinetic plus potential energy [J]."""
        return 0.5 * self.terms(position).inertia * rate * rate + self.potential(position)


def _work(curve: Curve, body: Body, gravity: Vector, applied: Applied) -> Any:
    """Return minus the potential energy of the weight and of the applied force."""
    x, y, _, _ = place_of(curve, body.cg_along, body.cg_across)
    p_x, p_y, _, _ = place_of(curve, applied.along, applied.across)
    return (body.mass * (gravity[0] * x + gravity[1] * y)
            + applied.force_x * p_x + applied.force_y * p_y)
