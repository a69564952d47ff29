"""
Joint reactions, driving torque and shaking wrench: Newton-Euler in closed form.

The paper's 9x9 system, Eq. (9), solved once by hand. With M2 and M3 the moments that coupler and
output link need about A and O4, the two moment equations give the force at B directly,

    F32 = (M3/a3 e_b + M2/a2 e_y) / sin(mu),     e_b, e_y: directions of coupler and output link,

and every other reaction follows by subtraction. Rigid links, frictionless joints, no clearance.
"""
from __future__ import annotations

from math import frexp, hypot, ldexp
from typing import NamedTuple

from .dialects import dialects


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


@dialects
def make_loads(a1, a2, a3, a4, bodies, gravity):
    """
    Return the function (fields of Motion) -> fields of :class:`Loads` for a fixed linkage.

    ``bodies``: three of :class:`~.bodies.Body`; ``gravity``: (x, y) of the field [m/s^2]. Lengths are
    scaled by a power of two into masses and inertias, so that no square of a length can overflow.
    """
    exponent = frexp(max(a1, a2, a3, a4))[1]
    a1, a2, a3, a4 = ldexp(a1, -exponent), ldexp(a2, -exponent), ldexp(a3, -exponent), ldexp(a4, -exponent)
    g_x, g_y = ldexp(gravity[0], -exponent), ldexp(gravity[1], -exponent)
    body1, body2, body3 = [(ldexp(body.mass, exponent), ldexp(body.cg_along, -exponent),
                            ldexp(body.cg_across, -exponent), ldexp(body.inertia, -exponent))
                           for body in bodies]

    def loads(motion, a1=a1, a2=a2, a3=a3, a4=a4, unit=ldexp(1.0, exponent), g_x=g_x, g_y=g_y,
              body1=body1, body2=body2, body3=body3):
        (_, omega, alpha, _, _, _, _, _, _, _, omega4, alpha4, _, omega_b, alpha_b, _, _, _,
         cos_x, sin_x, cos_b, sin_b, cos_y, sin_y, _, sin_mu) = motion

        # For each link: f = mass (acceleration - gravity) at its centre of gravity, and the moment
        # of inertia terms and of f about its first joint.
        mass, along, across, inertia = body1
        square = omega * omega
        x, y = along * cos_x - across * sin_x, along * sin_x + across * cos_x
        f1_x, f1_y = mass * (-alpha * y - square * x - g_x), mass * (alpha * x - square * y - g_y)
        moment1 = inertia * alpha + x * f1_y - y * f1_x
        x, y = a1 * cos_x, a1 * sin_x
        g2_x, g2_y = g_x + alpha * y + square * x, g_y - alpha * x + square * y    # gravity - that of A

        mass, along, across, inertia = body2
        square = omega_b * omega_b
        x, y = along * cos_b - across * sin_b, along * sin_b + across * cos_b
        f2_x, f2_y = mass * (-alpha_b * y - square * x - g2_x), mass * (alpha_b * x - square * y - g2_y)
        moment2 = inertia * alpha_b + x * f2_y - y * f2_x

        mass, along, across, inertia = body3
        square = omega4 * omega4
        x, y = along * cos_y - across * sin_y, along * sin_y + across * cos_y
        f3_x, f3_y = mass * (-alpha4 * y - square * x - g_x), mass * (alpha4 * x - square * y - g_y)
        moment3 = inertia * alpha4 + x * f3_y - y * f3_x

        from_output, from_coupler = moment3 / (a3 * sin_mu), moment2 / (a2 * sin_mu)
        f32_x = from_output * cos_b + from_coupler * cos_y
        f32_y = from_output * sin_b + from_coupler * sin_y
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        f43_x, f43_y = f3_x + f32_x, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        torque = moment1 - a1 * (cos_x * f21_y - sin_x * f21_x)
        shaking_x, shaking_y = -f41_x - f43_x, -f41_y - f43_y
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y,
                hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y), hypot(f43_x, f43_y),
                unit * torque, shaking_x, shaking_y, hypot(shaking_x, shaking_y),
                -unit * (torque + a4 * f43_y))
    return loads
