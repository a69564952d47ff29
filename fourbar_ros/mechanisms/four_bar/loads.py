"""
Joint reactions, driving torque and shaking wrench: Newton-Euler in closed form.

The paper's 9x9 system, Eq. (9), solved once by hand. With M2 and M3 the moments that coupler and
output link need about A and O4, the two moment equations give the force at B directly,

    F32 = (M3/a3 e_b + M2/a2 e_y) / sin(mu),     e_b, e_y: directions of coupler and output link,

and every other reaction follows by subtraction. Moments about O1 are summed in parts that do not cancel:
see :func:`needs_of_crank_and_carried`.

Assumed: rigid links moving in one plane; joints without clearance and without friction (a joint
transmits a force through its centre and no couple); gravity uniform; external forces and couples
constant along the ground axes, at points fixed in their link. The drive is a pure torque on the crank.
"""
from __future__ import annotations

from math import frexp, hypot, ldexp
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import NOT_APPLIED
from fourbar_ros.numerics.dialects import dialects


class Loads(NamedTuple):
    """
    Loads for one input; each field a float, or an array of the input's shape.

    fij = force of link i ON link j (1 crank, 2 coupler, 3 output link, 4 ground) along the ground axes
    (x from O1 to O4); fji = -fij. Forces in [N], moments in [N m], counter-clockwise positive.
    """

    f41_x: float
    f41_y: float
    f21_x: float
    f21_y: float
    f32_x: float
    f32_y: float
    f43_x: float
    f43_y: float
    f41: float                # magnitudes
    f21: float
    f32: float
    f43: float
    driving_torque: float     # T41, of the drive on the crank
    shaking_force_x: float    # F14 + F34, on the ground
    shaking_force_y: float
    shaking_force: float      # magnitude
    shaking_moment: float     # on the ground about O1: T14 + (O4 - O1) x F34


def about_first_joint(body, unit, gravity, applied=NOT_APPLIED):
    """
    Return the constants of a link in the equations; lengths in ``unit``, origin at its first joint.

    Returns
    -------
    along, across : float
        Mass times centre of gravity [kg unit * unit].
    inertia : float
        About the first joint.
    hold_x, hold_y : float
        What the joint forces add up to at rest: minus weight and applied force [N].
    couple, by_cosine, by_sine : float
        Their moment at rest: couple + by_cosine cos(angle) + by_sine sin(angle) [N unit].

    """
    mass, along, across = body.mass * unit, body.cg_along / unit, body.cg_across / unit
    inertia = body.inertia / unit + mass * (along * along + across * across)
    along, across = mass * along, mass * across
    g_x, g_y = gravity[0] / unit, gravity[1] / unit
    f_x, f_y, p_along, p_across = applied.force_x, applied.force_y, applied.along / unit, applied.across / unit
    return (along, across, inertia, -mass * g_x - f_x, -mass * g_y - f_y, -applied.couple / unit,
            across * g_x - along * g_y + p_across * f_x - p_along * f_y,
            across * g_y + along * g_x + p_across * f_y + p_along * f_x)


def needs_of_pivoted(link, cosine, sine, square, alpha):
    """
    Return what the joint forces of a link that turns about a fixed joint add up to (x, y), and their moment about it.

    Plain arithmetic, for whatever numbers motions are made of; so is :func:`needs_of_crank_and_carried`.

    Parameters
    ----------
    link : tuple
        Of :func:`about_first_joint`, in its unit of length.
    cosine, sine, square, alpha : float
        Direction of the link, its rate squared and its acceleration.

    """
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = link
    x, y = along * cosine - across * sine, along * sine + across * cosine
    return (hold_x - alpha * y - square * x, hold_y + alpha * x - square * y,
            inertia * alpha + by_cosine * cosine + by_sine * sine + couple)


def needs_of_crank_and_carried(crank, link, mass, a1, cos_x, sin_x, crank_square, crank_alpha, cosine, sine, square, alpha):
    """
    Return the same of the crank and of the link whose first joint is the crank's pin A, in parts that do not cancel.

    With r the mass times centre of gravity of that link from A, the moments of its inertia forces are, about
    A and (apart from those of its mass at A and of what holds it there, which :func:`crank_with_pin` counts
    to the crank) about O1,

        I alpha + (A . r) alpha1 + (A x r) omega1^2      and      (A . r) alpha - (A x r) omega^2.

    One function for both: a call takes as long as four products.

    Returns
    -------
    f1_x, f1_y, f2_x, f2_y : float
        Sums of the joint forces of crank and link.
    about_o1, about_a : float
        Moment of both about O1, of the link about A, without the terms of A x r.
    aside : float
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
    return (f1_x, f1_y, hold_x - mass * (crank_alpha * at_y + crank_square * at_x) - alpha * y - square * x,
            hold_y + mass * (crank_alpha * at_x - crank_square * at_y) + alpha * x - square * y,
            about_o1 + ahead * alpha,
            inertia * alpha + ahead * crank_alpha + by_cosine * cosine + by_sine * sine + couple, aside)


def crank_with_pin(crank, carried, mass, a1, unit, gravity):
    """
    Return :func:`about_first_joint` of the crank, with moments about O1 that count what it carries at its pin A.

    That is the mass [kg unit] of the next link, and the force that holds that link at rest: m a1^2 alpha1 and
    A x force. ``carried``: that link's constants; ``a1`` in ``unit``.
    """
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = about_first_joint(crank, unit, gravity)
    return (along, across, inertia + mass * a1 * a1, hold_x, hold_y, couple,
            by_cosine + a1 * carried[4], by_sine - a1 * carried[3])


@dialects
def make_loads(a1, a2, a3, a4, bodies, gravity, external):
    """
    Return the function (fields of Motion) -> fields of :class:`Loads` for a fixed linkage.

    ``bodies``: three of :class:`~.bodies.Body`; ``gravity``: (x, y) of the field [m/s^2]; ``external``:
    two of :class:`~.bodies.Applied`. Lengths are scaled by a power of two into masses and inertias, so
    that no square of a length can overflow.
    """
    unit = ldexp(1.0, frexp(max(a1, a2, a3, a4))[1])
    a1, a2, a3, a4 = a1 / unit, a2 / unit, a3 / unit, a4 / unit
    crank, coupler, output = bodies
    mass2, carried = coupler.mass * unit, about_first_joint(coupler, unit, gravity, external.coupler)

    def loads(motion, a1=a1, a2=a2, a3=a3, a4=a4, unit=unit, mass2=mass2,
              crank=crank_with_pin(crank, carried, mass2, a1, unit, gravity), coupler=carried,
              output=about_first_joint(output, unit, gravity, external.output)):
        (_, omega, alpha, _, omega2, _, _, _, _, _, omega4, alpha4, _, omega_b, alpha_b, _, dy, db, _,
         cos_x, sin_x, cos_b, sin_b, cos_y, sin_y, _, sin_mu) = motion
        square = omega * omega
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            crank, coupler, mass2, a1, cos_x, sin_x, square, alpha, cos_b, sin_b, omega_b * omega_b, alpha_b)
        f3_x, f3_y, moment3 = needs_of_pivoted(output, cos_y, sin_y, omega4 * omega4, alpha4)

        moment2 = about_a + aside * square
        from_output, from_coupler = moment3 / (a3 * sin_mu), moment2 / (a2 * sin_mu)
        f32_x = from_output * cos_b + from_coupler * cos_y
        f32_y = from_output * sin_b + from_coupler * sin_y
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        f43_x, f43_y = f3_x + f32_x, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        # These from the links, not from the reactions: inner forces much larger than the sums would
        # spoil them. The torque is that of virtual power, at unit speed of the crank.
        torque = moment1 + about_a * db - aside * (omega_b * omega2) + moment3 * dy
        shaking_x, shaking_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)
        shaking_moment = aside * (omega2 * (omega + omega_b)) - (moment1 + about_a + moment3 + a4 * f3_y)
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y,
                hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y), hypot(f43_x, f43_y),
                unit * torque, shaking_x, shaking_y, hypot(shaking_x, shaking_y), unit * shaking_moment)
    return loads
