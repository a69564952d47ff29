"""
Newton-Euler for one rigid link: what its joints must give, as a force and a moment about a joint.

Notation: r = (x, y) is the mass of a link times the vector from its first joint to its centre of gravity,
omega and alpha its turning. Plain arithmetic, for whatever numbers motions are made of. The joint forces
of a link add up to

    (N1)  F = m a_joint + alpha k x r - omega^2 r - (weight + applied force)

and their moment about its first joint, if that is fixed, is

    (N2)  M = I alpha - (moments of weight, applied force and couple)

Of a link that a crank carries at its pin A, with a = A - O1 and omega1, alpha1 of the crank, they are

    (N3)  F2 = m (alpha1 k x a - omega1^2 a) + alpha k x r - omega^2 r - (weight + applied force)
    (N4)  about A:   I alpha + (a . r) alpha1 + (a x r) omega1^2 - (moments ...)
    (N5)  about O1:  (N4) + (a . r) alpha - (a x r) omega^2 + m a^2 alpha1 - a x (weight + applied force)
                          - (a . r) alpha1 - (a x r) omega1^2, less the moments of (N4)
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import NOT_APPLIED, Applied, Body


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
    couple: Any        # [N unit] moment at rest: couple + by_cosine cos(angle) + by_sine sin(angle)
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
    return LinkTerms(along, across, inertia, -mass * g_x - f_x, -mass * g_y - f_y, -applied.couple / unit,
                     across * g_x - along * g_y + p_across * f_x - p_along * f_y,
                     across * g_y + along * g_x + p_across * f_y + p_along * f_x)


def with_pin(crank: LinkTerms, carried: LinkTerms, mass: Any, a1: Any) -> LinkTerms:
    """
    Return the :class:`LinkTerms` of the crank, with moments about O1 that count what it carries at its pin A.

    That is the mass [kg unit] of the next link, and the force that holds that link at rest: m a1^2 alpha1 and
    A x force. ``a1``: length of the crank in the unit.
    """
    return crank._replace(inertia=crank.inertia + mass * a1 * a1,
                          by_cosine=crank.by_cosine + a1 * carried.hold_y,
                          by_sine=crank.by_sine - a1 * carried.hold_x)


def needs_of_pivoted(link: tuple[Any, ...], cosine: Any, sine: Any, square: Any,
                     alpha: Any) -> tuple[Any, Any, Any]:
    """
    Return force (x, y) and moment of (N1), (N2) for a link that turns about a fixed joint.

    Parameters
    ----------
    link : tuple
        Of the fields of :class:`LinkTerms`.
    cosine, sine, square, alpha
        Direction of the link, its rate squared and its acceleration.

    """
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = link
    x, y = along * cosine - across * sine, along * sine + across * cosine
    return (hold_x - alpha * y - square * x, hold_y + alpha * x - square * y,
            inertia * alpha + by_cosine * cosine + by_sine * sine + couple)


def needs_of_crank_and_carried(crank: tuple[Any, ...], link: tuple[Any, ...], mass: Any, a1: Any,
                               cos_x: Any, sin_x: Any, crank_square: Any, crank_alpha: Any,
                               cosine: Any, sine: Any, square: Any, alpha: Any) -> tuple[Any, ...]:
    """
    Return the same of the crank and of the link whose first joint is the crank's pin A, in parts that do not cancel.

    With r the mass times centre of gravity of that link from A, the moments of its inertia forces are, about
    A and (apart from those of its mass at A and of what holds it there, which :func:`with_pin` counts
    to the crank) about O1,

        I alpha + (A . r) alpha1 + (A x r) omega1^2      and      (A . r) alpha - (A x r) omega^2.

    One function for both: a call takes as long as four products.

    Returns
    -------
    f1_x, f1_y, f2_x, f2_y
        Sums of the joint forces of crank and link.
    about_o1, about_a
        Moment of both about O1, of the link about A, without the terms of A x r.
    aside
        A x r. In sums of both moments its factors nearly cancel where the link turns almost as fast as the
        crank, unless omega - omega1 is a factor.

    """
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = crank
    x, y = along * cos_x - across * sin_x, along * sin_x + across * cos_x
    f1_x, f1_y = hold_x - crank_alpha * y - crank_square * x, hold_y + crank_alpha * x - crank_square * y
    about_o1 = inertia * crank_alpha + by_cosine * cos_x + by_sine * sin_x + couple

    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = link
    x, y = along * cosine - across * sine, along * sine + across * cosine
    at_x, at_y = a1 * cos_x, a1 * sin_x
    ahead, aside = at_x * x + at_y * y, at_x * y - at_y * x
    f2_x = hold_x - mass * (crank_alpha * at_y + crank_square * at_x) - alpha * y - square * x
    f2_y = hold_y + mass * (crank_alpha * at_x - crank_square * at_y) + alpha * x - square * y
    return (f1_x, f1_y, f2_x, f2_y, about_o1 + ahead * alpha,
            inertia * alpha + ahead * crank_alpha + by_cosine * cosine + by_sine * sine + couple, aside)
