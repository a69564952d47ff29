# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mechanisms with masses for tests of dynamics, and their energies to many digits."""
from contextlib import contextmanager

from flint import acb, arb, ctx
from fourbar_ros import load_scene
from fourbar_ros.mechanisms.elements import Attachment, GROUND, Spring, TorsionSpring
import mpmath as mp
from support.cartesian import exact, number, of_mpmath
from support.samples import record


def random_elements(rng, mechanism):
    """Return a spring with a damper between two links, one to the ground, and a torsion spring."""
    first, second, *_, last = mechanism.BODIES._fields

    def point(link):
        return Attachment(link, *rng.uniform(-1.0, 1.0, 2).tolist())
    return (record(Spring, point(first), point(second), *rng.uniform(0.1, 5.0, 3).tolist()),
            record(Spring, point(GROUND), point(last), *rng.uniform(0.1, 5.0, 3).tolist()),
            TorsionSpring(first, second, 3.0, free_angle=float(rng.uniform(-0.4, 0.4)),
                          damping=0.7))


# --- energies by Cartesian coordinates of all links, for q in mpmath -----------------------------

@contextmanager
def pose(mechanism, q):
    """Give the Cartesian of a mechanism at unit rate, to more digits than mpmath has now."""
    with ctx.workprec(mp.mp.prec + 64):
        yield exact(mechanism, (q, 1, 0))


def point_on(found, link, along, across, order=0):
    """Return a point of a link, or its derivative by q."""
    place, e = found.link(link)
    return place[order][0] + e[order][0] * acb(along, across)


def exact_inertia(mechanism, q):
    """Return J(q)."""
    with pose(mechanism, q) as found:
        return of_mpmath(sum(
            number(body.mass) * abs(point_on(found, link, body.cg_along, body.cg_across, 1))**2
            + number(body.inertia) * found.angle(link, 1)[0]**2
            for link, body in mechanism.bodies._asdict().items()))


def exact_potential(mechanism, elements, q):
    """Return V(q), couples and springs included."""
    with pose(mechanism, q) as found:
        gravity, energy = acb(*mechanism.gravity), arb(0)
        for link, body in mechanism.bodies._asdict().items():
            at = point_on(found, link, body.cg_along, body.cg_across)
            energy -= body.mass * (gravity * at.conjugate()).real
        for link, applied in mechanism.external._asdict().items():
            at = point_on(found, link, applied.along, applied.across)
            energy -= (acb(applied.force_x, applied.force_y) * at.conjugate()).real
            energy -= applied.couple * found.angle(link, 0)[0]
        for element in elements:
            energy += element.stiffness * _stretch(element, found)**2 / 2
        return of_mpmath(energy)


def exact_stretch(mechanism, element, q):
    with pose(mechanism, q) as found:
        return of_mpmath(_stretch(element, found))


def _stretch(element, found):
    one, two = element.first, element.second
    if isinstance(element, TorsionSpring):
        turn = sum(sign * found.angle(link, 0)[0] for sign, link in ((1, two), (-1, one))
                   if link != GROUND) - element.free_angle
        return arb.atan2(turn.sin(), turn.cos())
    return abs(point_on(found, two.link, two.along, two.across)
               - point_on(found, one.link, one.along, one.across)) - element.free_length


# --- Andrews' squeezer: IVP Test Set, andrews.f; Hairer and Wanner, Solving ODEs II, VII.7 -------

ANDREWS_BETA = -0.0617138900142764496358948458001
# {link: (multiple of pi/2, printed initial angles)}: ours is the sum of both. In the test set's
# letters beta + Theta, gamma, Phi + delta, delta, Omega + epsilon, epsilon.
ANDREWS_POSE = {
    'K2': (2, (ANDREWS_BETA, 0.0)), 'K3': (-1, (0.455279819163070380255912382449,)),
    'K4': (1, (0.222668390165885884674473185609, 0.487364979543842550225598953530)),
    'K5': (0, (0.487364979543842550225598953530,)),
    'K6': (2, (-0.222668390165885884674473185609, 1.23054744454982119249735015568)),
    'K7': (-1, (1.23054744454982119249735015568,))}
UNTIL = 0.03
# Driven by its torque, beta and its rate then, to 25 digits by two routes: quadrature of the
# energy integral, t = integral of sqrt(J / (2 (E - V))) d beta, which knows no equation of motion;
# and Taylor series of that equation in ball arithmetic, which knows no energy.
ANDREWS_ANGLE = '15.810771195153705841647478'
ANDREWS_RATE = '1139.9203022591062132888514'


def andrews():
    """Return the seven bodies as a machine, its spring, and the torque on the crank."""
    spring = Spring(Attachment(GROUND, 0.014, 0.072), Attachment('K3', 0.018, 0.02), 4530.0,
                    free_length=0.07785)
    return load_scene('andrews').linkage, spring, 0.033
