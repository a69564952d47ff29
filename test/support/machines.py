# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mechanisms with masses for tests of dynamics, and their energies to many digits."""
from contextlib import contextmanager

from flint import acb, arb, ctx
from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    FourBar,
    FourBarError,
    InvertedSlider,
    SliderCrank,
)
from fourbar_ros.dynamics.elements import Attachment, GROUND, Spring, TorsionSpring
from fourbar_ros.mechanisms.machine.describe.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np
from support.cartesian import exact, number, of_mpmath

EPS = 2.0**-52
KINDS = {'four-bar': (FourBar, 4, {}), 'slider-crank': (SliderCrank, 3, {'input': 'crank'}),
         'slider': (SliderCrank, 3, {'input': 'slide'}),
         'inverted': (InvertedSlider, 3, {'input': 'crank'}),
         'cylinder': (InvertedSlider, 3, {'input': 'slide'})}


def random_bodies(rng):
    return Bodies(*(Body(float(rng.uniform(0.2, 3.0)), *rng.uniform(-0.5, 0.8, 2).tolist(),
                         float(rng.uniform(0.05, 1.0))) for _ in range(3)))


def random_machines(name, seed, count):
    """Yield mechanisms of a kind with masses, gravity, loads, and an input away from toggles."""
    rng = np.random.default_rng(seed)
    kind, lengths, options = KINDS[name]
    while count:
        given = rng.uniform(0.3, 2.0, lengths)
        if lengths == 3:
            given[2] -= 1.0
        external = External(*(Applied(*rng.normal(size=5).tolist()) for _ in range(2)))
        try:
            mechanism = kind(*given.tolist(), mode=int(rng.integers(1, 3)),
                             bodies=random_bodies(rng), gravity=tuple(rng.normal(size=2).tolist()),
                             external=external, **options)
        except FourBarError:
            continue
        low, high = mechanism.input_ranges[int(rng.integers(len(mechanism.input_ranges)))]
        position = float(low + (high - low) * rng.uniform(0.1, 0.9))
        if mechanism.motion(position).condition < 10.0 * mechanism.input_unit:
            count -= 1
            yield mechanism, position


def random_elements(rng):
    """Return a spring with a damper between two links, one to the ground, and a torsion spring."""
    def point(link):
        return Attachment(link, *rng.uniform(-1.0, 1.0, 2).tolist())
    return (Spring(point('crank'), point('coupler'), *rng.uniform(0.1, 5.0, 3).tolist()),
            Spring(point(GROUND), point('output'), *rng.uniform(0.1, 5.0, 3).tolist()),
            TorsionSpring('crank', 'coupler', 3.0, float(rng.uniform(-0.4, 0.4)), 0.7))


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
    a, b = (-0.06934, -0.00227), (-0.03635, 0.03273)
    crank, ground = Point('crank', 0.007), 'ground'
    at_e = Point('K2', 0.028)
    dyads = (Dyad('E', 'RRR', crank, Point(ground, *b), ('K2', 'K3'), length_1=0.028,
                  length_2=0.035, mode=2),
             Dyad('G', 'RRR', at_e, Point(ground, *a), ('K4', 'K5'), length_1=0.02,
                  length_2=0.04, mode=1),
             Dyad('H', 'RRR', at_e, Point(ground, *a), ('K6', 'K7'), length_1=0.02,
                  length_2=0.04, mode=2))
    bodies = {'crank': Body(0.04325, 0.00092, 0.0, 2.194e-6),
              'K2': Body(0.00365, 0.0115, 0.0, 4.410e-7),
              'K3': Body(0.02373, 0.01874, 0.01043, 5.255e-6),
              'K4': Body(0.00706, 0.01421, 0.0, 5.667e-7),
              'K5': Body(0.07050, 0.02308, 0.00916, 1.169e-5),
              'K6': Body(0.00706, 0.01421, 0.0, 5.667e-7),
              'K7': Body(0.05498, 0.01228, -0.00449, 1.912e-5)}
    spring = Spring(Attachment(GROUND, 0.014, 0.072), Attachment('K3', 0.018, 0.02), 4530.0,
                    0.07785)
    return Machine(dyads, bodies=bodies), spring, 0.033


def jansen():
    """
    Return Theo Jansen's leg by his numbers, one unit a centimetre, crank pin first.

    One crank, three dyads: the upper triangle and the lower rod of the knee, and the foot.
    """
    a, b, c, d, e, f, g, j, k, low, m = (38.0, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 50.0, 61.9,
                                         7.8, 15.0)
    corner = (b * b + d * d - e * e) / (2.0 * b)
    pivot, pin = Point('ground', -a, -low), Point('crank', m)
    return Machine([
        Dyad('upper', 'RRR', pin, pivot, ('rod_j', 'triangle'), length_1=j, length_2=b, mode=1),
        Dyad('lower', 'RRR', pin, pivot, ('rod_k', 'rod_c'), length_1=k, length_2=c, mode=2),
        Dyad('foot', 'RRR', Point('triangle', corner, (d * d - corner * corner)**0.5),
             Point('rod_c', c), ('rod_f', 'shin'), length_1=f, length_2=g, mode=1)])
