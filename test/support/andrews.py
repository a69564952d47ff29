# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Andrews' squeezer driven by its torque, to 25 digits by two routes.

By quadrature of the energy integral, t = integral of sqrt(J / (2 (E - V))) d beta, with places and
J from Cartesian coordinates of all links; and by Taylor series of the equation of motion in
time, in ball arithmetic. The first knows no equation of motion, the second no energy. Run as a
program it computes both again.
"""
from flint import acb, arb, ctx
from fourbar_ros.numerics.number_types import converted
import mpmath as mp
from support.arb_series import ARB_SERIES, Series, series_of
from support.cartesian import BITS, exact, of_mpmath
from support.machines import andrews, ANDREWS_BETA
from support.taylor import taylor

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


def by_quadrature(digits=25):
    """Return beta at the end: Newton's method on the time to reach an angle."""
    machine, spring, torque = andrews()
    with mp.workdps(digits + 8):
        start = mp.mpf(ANDREWS_BETA)
        at_rest = energies(machine, spring, torque, start)[1]

        def slowness(beta):
            inertia, potential = energies(machine, spring, torque, beta)
            return mp.sqrt(inertia / (2 * (at_rest - potential)))

        def time(beta):
            # beta = start + u^2: from rest the slowness has a root in its denominator
            end = mp.sqrt(beta - start)
            pieces = mp.linspace(0, end, 26)
            return mp.quad(lambda u: 2 * u * slowness(start + u * u) if u else mp.mpf(0), pieces,
                           method='gauss-legendre', maxdegree=5)
        beta, step = mp.mpf('15.81077119515'), mp.mpf(1)
        while abs(step) > mp.mpf(10)**(-digits):
            step = (mp.mpf(UNTIL) - time(beta)) / slowness(beta)
            beta += step
        return +beta


def by_taylor_series(steps=240, order=36, digits=45):
    """Return beta and its rate at the end."""
    machine, spring, torque = andrews()

    def derivative(state):
        beta, rate = state
        motion = machine.motion_formula(ARB_SERIES, converted(machine.constants, arb))
        fields = dict(zip(machine.MOTION._fields, motion(Series(beta), arb(1),
                                                         arb(0))))
        curves = {name: [series_of(fields[f'{part}_{name}']) for part in (
            'x', 'y', 'dx', 'dy', 'ddx', 'ddy', 'cos', 'sin', 'ratio', 'bend')]
            for name in machine.layout.moving}
        inertia = half_slope = 0
        for name, body in machine.bodies._asdict().items():
            _, _, dx, dy, ddx, ddy = point(curves[name], body.cg_along, body.cg_across)
            turn, bend = curves[name][8:]
            inertia += body.mass * (dx * dx + dy * dy) + body.inertia * turn * turn
            half_slope += body.mass * (dx * ddx + dy * ddy) + body.inertia * turn * bend
        x, y, dx, dy, _, _ = point(curves[spring.second.link], spring.second.along,
                                   spring.second.across)
        x, y = x - spring.first.along, y - spring.first.across
        length = (x * x + y * y).sqrt()
        force = (torque - spring.stiffness * (1 - spring.free_length / length)
                 * (x * dx + y * dy))
        return [rate, (force - half_slope * rate * rate) / inertia]

    return taylor(derivative, lambda: [ANDREWS_BETA, 0.0], UNTIL, steps, order, digits)


def point(curve, along, across):
    """Return place, first and second derivative of a point of a link."""
    x0, y0, dx, dy, ddx, ddy, c, s, turn, bend = curve
    x, y = along * c - across * s, along * s + across * c
    return (x0 + x, y0 + y, dx - turn * y, dy + turn * x,
            ddx - bend * y - turn * turn * x, ddy + bend * x - turn * turn * y)


if __name__ == '__main__':
    mp.mp.dps = 30
    print('Taylor series', *by_taylor_series())
    print('quadrature   ', by_quadrature())
