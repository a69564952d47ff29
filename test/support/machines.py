# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mechanisms with masses for tests of dynamics, and their poses and energies to many digits."""
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


def exact_links(mechanism, q):
    """Return {link: (place of its first joint, angle)} in the current precision."""
    sign, a1 = mp.mpf(mechanism.sign), mp.mpf(mechanism.a1)
    if isinstance(mechanism, FourBar):
        a2, a3, a4 = mp.mpf(mechanism.a2), mp.mpf(mechanism.a3), mp.mpf(mechanism.a4)
        a = a1 * mp.expj(q)
        d = a4 - a
        r = abs(d)
        along = (a2**2 - a3**2 + r**2) / (2 * r)
        b = a + d / r * mp.mpc(along, sign * mp.sqrt(a2**2 - along**2))
        return {'crank': (mp.mpc(0), q), 'coupler': (a, mp.arg(b - a)),
                'output': (mp.mpc(a4), mp.arg(b - a4)), GROUND: (mp.mpc(0), mp.mpf(0))}
    e = mp.mpf(mechanism.offset)
    if isinstance(mechanism, SliderCrank):
        a2 = mp.mpf(mechanism.a2)
        if mechanism.input == 'crank':
            a = a1 * mp.expj(q)
            b = mp.mpc(a.real + sign * mp.sqrt(a2**2 - (e - a.imag)**2), e)
        else:
            b = mp.mpc(q, e)
            r = abs(b)
            along = (a1**2 - a2**2 + r**2) / (2 * r)
            a = b / r * mp.mpc(along, -sign * mp.sqrt(a1**2 - along**2))
        return {'crank': (mp.mpc(0), mp.arg(a)), 'coupler': (a, mp.arg(b - a)),
                'output': (b, mp.mpf(0)), GROUND: (mp.mpc(0), mp.mpf(0))}
    a4 = mp.mpf(mechanism.a4)
    if mechanism.input == 'crank':
        a = a1 * mp.expj(q)
        slide = sign * mp.sqrt(abs(a - a4)**2 - e**2)
    else:
        slide, r2 = q, q**2 + e**2
        cosine = (a1**2 + a4**2 - r2) / (2 * a1 * a4)
        a = a1 * mp.mpc(cosine, sign * mp.sqrt(1 - cosine**2))
    y = mp.arg((a - a4) / mp.mpc(slide, e))
    return {'crank': (mp.mpc(0), mp.arg(a)), 'coupler': (a, y), 'output': (mp.mpc(a4), y),
            GROUND: (mp.mpc(0), mp.mpf(0))}


def point_on(links, link, along, across):
    place, angle = links[link]
    return place + mp.expj(angle) * mp.mpc(along, across)


def exact_potential(mechanism, elements, q):
    """Return V(q), couples and springs included."""
    links, energy = exact_links(mechanism, q), mp.mpf(0)
    gravity = mp.mpc(*mechanism.gravity)
    for link, body in mechanism.bodies._asdict().items():
        at = point_on(links, link, body.cg_along, body.cg_across)
        energy -= body.mass * (gravity * mp.conj(at)).real
    for link, applied in mechanism.external._asdict().items():
        at = point_on(links, link, applied.along, applied.across)
        energy -= (mp.mpc(applied.force_x, applied.force_y) * mp.conj(at)).real
        energy -= applied.couple * links[link][1]
    for element in elements:
        energy += element.stiffness * exact_stretch(element, links)**2 / 2
    return energy


def exact_stretch(element, links):
    if isinstance(element, TorsionSpring):
        turn = links[element.second][1] - links[element.first][1] - mp.mpf(element.free_angle)
        return mp.arg(mp.expj(turn))
    one, two = element.first, element.second
    return abs(point_on(links, two.link, two.along, two.across)
               - point_on(links, one.link, one.along, one.across)) - element.free_length


def exact_inertia(mechanism, q):
    """Return J(q) from derivatives of the places of the centres of gravity and of the angles."""
    total = mp.mpf(0)
    for link, body in mechanism.bodies._asdict().items():
        def centre(x, link=link, body=body):
            return point_on(exact_links(mechanism, x), link, body.cg_along, body.cg_across)

        def direction(x, link=link):
            return mp.expj(exact_links(mechanism, x)[link][1])
        total += body.mass * abs(mp.diff(centre, q))**2
        total += body.inertia * abs(mp.diff(direction, q))**2
    return total


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
