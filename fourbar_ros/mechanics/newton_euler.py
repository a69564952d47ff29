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

from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Applied, applied_to, Body, NOT_APPLIED
from fourbar_ros.numerics.number_types import Function


class LinkTerms(NamedTuple):
    """
    The constants of a link in the equations; lengths in a unit, origin at its first joint.

    Floats, or whatever numbers bodies are made of.
    """

    along: Any         # [kg unit * unit] mass times centre of gravity
    across: Any
    inertia: Any       # about the first joint
    hold_x: Any        # [N] minus weight and applied force
    hold_y: Any
    # [N unit] moment at rest: couple + by_cosine cos(angle) + by_sine sin(angle)
    couple: Any
    by_cosine: Any
    by_sine: Any


def about_first_joint(body: Body, unit: Any, gravity: tuple[Any, Any],
                      applied: Applied = NOT_APPLIED) -> LinkTerms:
    """Return the :class:`LinkTerms` of a link, with lengths in ``unit`` [m]."""
    mass, along, across = body.mass * unit, body.cg_along / unit, body.cg_across / unit
    inertia = body.inertia / unit + mass * (along * along + across * across)
    along, across = mass * along, mass * across
    g_x, g_y = gravity[0] / unit, gravity[1] / unit
    f_x, f_y = applied.force_x, applied.force_y
    p_along, p_across = applied.along / unit, applied.across / unit
    return LinkTerms(along, across, inertia, -mass * g_x - f_x, -mass * g_y - f_y,
                     -applied.couple / unit,
                     across * g_x - along * g_y + p_across * f_x - p_along * f_y,
                     across * g_y + along * g_x + p_across * f_y + p_along * f_x)


def crank_with_pin(bodies: Any, unit: Any, gravity: tuple[Any, Any], external: Any,
                   carried: LinkTerms, a1: Any) -> LinkTerms:
    """
    Return the :class:`LinkTerms` of the crank; lengths, and ``a1`` of the crank, in ``unit`` [m].

    Its moments about O1 include what it carries at its pin A: the mass of the next link and the
    force that holds that link at rest, in (N5) the terms m a^2 alpha1 and -a x W.
    """
    crank = about_first_joint(bodies.crank, unit, gravity, applied_to(external, 'crank'))
    return crank._replace(inertia=crank.inertia + bodies.coupler.mass * unit * a1 * a1,
                          by_cosine=crank.by_cosine + a1 * carried.hold_y,
                          by_sine=crank.by_sine - a1 * carried.hold_x)


def make_needs_of_pivoted(link: LinkTerms) -> Function:
    """
    Return the function (cosine, sine, square, alpha) -> F (x, y), M of (N1), (N2).

    For a link that turns about a fixed joint; cosine, sine: its direction, square: its rate
    squared.
    """
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = link

    def needs(cosine: Any, sine: Any, square: Any, alpha: Any) -> tuple[Any, Any, Any]:
        x, y = along * cosine - across * sine, along * sine + across * cosine
        return (hold_x - alpha * y - square * x, hold_y + alpha * x - square * y,       # (N1)
                inertia * alpha + by_cosine * cosine + by_sine * sine + couple)         # (N2)
    return needs


def make_needs_of_crank_and_carried(crank: LinkTerms, link: LinkTerms, mass: Any,
                                    a1: Any) -> Function:
    """
    Return the function for a crank and the link that it carries at its pin A.

    In parts that do not cancel.

    One function for both: a call takes as long as four products.

    Parameters
    ----------
    crank, link : LinkTerms
        Terms of the crank as :func:`crank_with_pin` returns them, and of the link that it carries.
    mass, a1
        Mass of the link [kg unit], length of the crank [unit].

    Returns
    -------
    callable
        (cos_x, sin_x, square1, alpha1 of the crank, cosine, sine, square, alpha of the link) ->
        F1 (x, y), F2 (x, y) of (N1) and (N3); M_O1 of both less M_A, and M_A, without the terms of
        a x r; a x r.

    """
    along1, across1, inertia1, hold1_x, hold1_y, couple1, by_cosine1, by_sine1 = crank
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = link

    def needs(cos_x: Any, sin_x: Any, square1: Any, alpha1: Any,
              cosine: Any, sine: Any, square: Any, alpha: Any) -> tuple[Any, ...]:
        x, y = along1 * cos_x - across1 * sin_x, along1 * sin_x + across1 * cos_x
        f1_x = hold1_x - alpha1 * y - square1 * x                                       # (N1)
        f1_y = hold1_y + alpha1 * x - square1 * y
        about_o1 = inertia1 * alpha1 + by_cosine1 * cos_x + by_sine1 * sin_x + couple1

        x, y = along * cosine - across * sine, along * sine + across * cosine
        at_x, at_y = a1 * cos_x, a1 * sin_x
        ahead, aside = at_x * x + at_y * y, at_x * y - at_y * x     # a . r, a x r
        f2_x = hold_x - mass * (alpha1 * at_y + square1 * at_x) - alpha * y - square * x     # (N3)
        f2_y = hold_y + mass * (alpha1 * at_x - square1 * at_y) + alpha * x - square * y
        # (N4)
        about_a = inertia * alpha + ahead * alpha1 + by_cosine * cosine + by_sine * sine + couple
        return f1_x, f1_y, f2_x, f2_y, about_o1 + ahead * alpha, about_a, aside         # (N5)
    return needs
