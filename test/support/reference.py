# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Reference for the tests: many digits and another formulation.

Positions from coordinates (intersection of two circles on the diagonal A-O4), rates and
accelerations from the differentiated loop, loads from the free bodies: nothing here is shared with
the package. The working precision leaves fifty digits after the cancellations of the worst case of
the tests.
"""
from functools import lru_cache
from typing import NamedTuple

import mpmath as mp
import numpy as np

EPS = float(np.finfo(float).eps)
DIGITS = 120
RELATIVE_STEP = mp.mpf(10)**-45     # of the difference quotients of :func:`condition`
mp.mp.dps = DIGITS


class Pose(NamedTuple):
    """Output and coupler angle and their derivatives by theta1."""

    y: mp.mpf
    b: mp.mpf
    dy: mp.mpf
    db: mp.mpf
    ddy: mp.mpf
    ddb: mp.mpf


class FreeBody(NamedTuple):
    """
    What moves one link: the sum of its joint forces, their moment about its CG.

    Its CG and end.
    """

    force: mp.mpc
    moment: mp.mpf
    centre: mp.mpc           # from the first joint: O1, A, O4
    end: mp.mpc              # second joint from the first
    acceleration: mp.mpc     # of the centre of gravity


def cross(r, f):
    return r.real * f.imag - r.imag * f.real


def pose(lengths, sign, x):
    """Return the :class:`Pose` for theta1 = x, or None at a toggle or out of range."""
    a1, a2, a3, a4 = map(mp.mpf, lengths)
    crank = a1 * mp.expj(x)
    diagonal = a4 - crank
    q = diagonal.real**2 + diagonal.imag**2
    along = (q + a2**2 - a3**2) / (2 * q)
    square = a2**2 / q - along**2
    if square <= 0:
        return None
    coupler = diagonal * mp.mpc(along, sign * mp.sqrt(square))
    output = coupler - diagonal
    area = cross(coupler, output)

    def rates(right):
        """Solve coupler b' - output y' = right."""
        return cross(right, output) / area, cross(right, coupler) / area

    db, dy = rates(-crank)
    ddb, ddy = rates(-1j * (crank + coupler * db**2 - output * dy**2))
    return Pose(mp.arg(output), mp.arg(coupler), dy, db, ddy, ddb)


def free_bodies(lengths, place, x, omega, alpha, bodies, applied, gravity):
    """
    Return three :class:`FreeBody`: crank, coupler, output link.

    ``bodies``: three of (mass, along, across, inertia); ``applied``: two of (force_x, force_y,
    along, across, couple) on coupler and output link; ``gravity``: (x, y). All of it numbers for
    mpmath.
    """
    angles = (x, place.b, place.y)
    rates = (omega, place.db * omega, place.dy * omega)
    second = (alpha, place.db * alpha + place.ddb * omega**2,
              place.dy * alpha + place.ddy * omega**2)
    of_a, links = 0, []
    for i, (mass, along, across, inertia) in enumerate(bodies):
        force_x, force_y, at_along, at_across, couple = (*applied, (0,) * 5)[(i - 1) % 3]
        turn, spin = mp.expj(angles[i]), mp.mpc(-rates[i]**2, second[i])
        centre, end = turn * mp.mpc(along, across), turn * lengths[i]
        acceleration = spin * centre + (of_a if i == 1 else 0)
        if i == 0:
            of_a = spin * end
        push = mp.mpc(force_x, force_y)
        links.append(FreeBody(mass * (acceleration - mp.mpc(*gravity)) - push,
                              inertia * second[i] - couple
                              - cross(turn * mp.mpc(at_along, at_across) - centre, push),
                              centre, end, acceleration))
    return links


def reactions(links):
    """
    Return (F41, F21, F32, F43, T41).

    F32 by Cramer, then the rest.
    """
    crank, coupler, output = links
    p, q = coupler.end, output.end
    about_a = coupler.moment + cross(coupler.centre, coupler.force)     # = p x F32
    about_o4 = output.moment + cross(output.centre, output.force)       # = -q x F32
    f32 = (about_a * q + about_o4 * p) / cross(p, q)
    f21 = f32 - coupler.force
    torque = crank.moment + cross(crank.centre, crank.force) - cross(crank.end, f21)
    return crank.force - f21, f21, f32, output.force + f32, torque


def condition(function, values):
    """
    Return f and its first-order condition.

    |f| + the sum of |v df/dv| over the values, per output of f.

    Times eps it is what an exact f would move by if each value and the result were rounded once.
    The first value is theta1, of which only the part beyond full turns counts. For a force (mpc)
    the modulus is taken, so that it is the condition of the vector.
    """
    base = function(values)
    total = [mp.mpf(0)] * len(base)
    for i, value in enumerate(values):
        weight = mp.fmod(value + mp.pi, 2 * mp.pi) - mp.pi if i == 0 else value
        if weight:
            moved = list(values)
            moved[i] = value + weight * RELATIVE_STEP
            total = [t + abs(f - g) for t, f, g in zip(total, function(moved), base)]
    return base, [t / RELATIVE_STEP + abs(f) for t, f in zip(total, base)]


MOTION_FIELDS = ('theta4', 'beta', 'omega4', 'omega_beta', 'omega2', 'omega3', 'alpha4',
                 'alpha_beta',
                 'alpha2', 'alpha3')


def motion_of(lengths, sign, x, omega, alpha):
    """
    Return the values of :data:`MOTION_FIELDS`.

    Rates and accelerations that are differences from them.
    """
    p = pose(lengths, sign, x)

    def second(slope, curvature):
        return slope * alpha + curvature * omega**2

    return (p.y, p.b, p.dy * omega, p.db * omega, (p.db - 1) * omega, (p.dy - p.db) * omega,
            second(p.dy, p.ddy), second(p.db, p.ddb), second(p.db - 1, p.ddb),
            second(p.dy - p.db, p.ddy - p.ddb))


# most of what loads depend on leaves the pose alone
_remembered_pose = lru_cache(maxsize=8)(pose)
LOAD_NAMES = ('f41', 'f21', 'f32', 'f43', 'driving_torque', 'shaking_force', 'shaking_moment')


def loads_of(lengths, sign, x, omega, alpha, bodies, applied, gravity):
    """Return the values of :data:`LOAD_NAMES`, forces as mpc."""
    place = _remembered_pose(tuple(lengths), sign, x)
    f41, f21, f32, f43, torque = reactions(
        free_bodies(lengths, place, x, omega, alpha, bodies, applied, gravity))
    return f41, f21, f32, f43, torque, -f41 - f43, -torque - lengths[3] * f43.imag


def random_lengths(rng, count):
    """Return an array (count, 4) of lengths in [0.1, 1] that close, of all classes [m]."""
    lengths = np.empty((0, 4))
    while len(lengths) < count:
        more = rng.uniform(0.1, 1.0, (2 * count, 4))
        lengths = np.concatenate((lengths, more[2.0 * more.max(1) < more.sum(1)]))
    return lengths[:count]
