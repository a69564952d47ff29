# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Andrews' squeezer driven by its torque: where it is after 0.03 s, to 25 digits, and its energy.

Two routes agreed in the digits: quadrature of the energy integral, t = integral of
sqrt(J / (2 (E - V))) d beta, with J from Cartesian coordinates of all links, which knows no
equation of motion; and Taylor series of that equation in ball arithmetic, which knows no energy.
"""
from flint import acb, ctx
import mpmath as mp
from support.cartesian import BITS, exact, of_mpmath

UNTIL = 0.03
# beta and its rate then, where both routes agree.
ANDREWS_ANGLE = '15.810771195153705841647478'
ANDREWS_RATE = '1139.9203022591062132888514'


def energies(machine, spring, torque, beta):
    """Return J and the potential energy of spring and torque at an angle, by Cartesian links."""
    with ctx.workprec(BITS):
        found, inertia = exact(machine, (beta, 1, 0)), 0
        for name, body in machine.bodies._asdict().items():
            (_, z, _), (_, e, _) = found.link(name)
            rate = abs(z[0] + e[0] * acb(body.cg_along, body.cg_across))
            inertia += body.mass * rate * rate + body.inertia * found.angle(name, 1)[0]**2
        ends = [z[0] + e[0] * acb(at.along, at.across) for at in (spring.first, spring.second)
                for (z, *_), (e, *_) in [found.link(at.link)]]
        stretch = of_mpmath(abs(ends[1] - ends[0])) - mp.mpf(spring.free_length)
        inertia = of_mpmath(inertia)
    return inertia, mp.mpf(spring.stiffness) * stretch**2 / 2 - mp.mpf(torque) * beta
