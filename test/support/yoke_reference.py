# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Reference for the Scotch yoke: many digits and another formulation.

Positions from coordinates; rates by solving the differentiated loop; loads from the nine equations
of three free bodies as one system. Nothing here is shared with the package.
"""
import mpmath as mp
from support.reference import cross

FIELDS = ('theta1', 'theta2', 'slide', 'slot', 'omega1', 'omega2', 'slide_velocity',
          'slot_velocity',
          'alpha1', 'alpha2', 'slide_acceleration', 'slot_acceleration')
LOADS = ('f41', 'f21', 'f32', 'f43', 'guide_force', 'guide_couple', 'slot_couple', 'drive',
         'shaking_force',
         'shaking_moment')


def exact(driven, lengths, sign, given):
    """Return crank as a complex number, and (x, s, t) with their rates and accelerations."""
    a1, e = lengths
    q, v, a = given
    crank = a1 * mp.expj(q) if driven == 'crank' else mp.mpc(q, sign * mp.sqrt(a1**2 - q**2))
    spin = 1j * crank
    if driven == 'crank':
        rates, accelerations = (v, v * spin), (a, a * spin - v**2 * crank)
    else:
        omega = v / spin.real
        alpha = (a + omega**2 * crank.real) / spin.real
        rates, accelerations = (omega, omega * spin), (alpha, alpha * spin - omega**2 * crank)
    return crank, ((q if driven == 'crank' else mp.arg(crank), crank.real, crank.imag - e),
                   (rates[0], rates[1].real, rates[1].imag),
                   (accelerations[0], accelerations[1].real, accelerations[1].imag))


def fields_of(driven, lengths, sign, given):
    """Return the values of FIELDS."""
    _, ((x, s, t), (w, sv, tv), (al, sa, ta)) = exact(driven, lengths, sign, given)
    return (x, mp.arg(mp.expj(mp.pi / 2 - x)), s, t, w, -w, sv, tv, al, -al, sa, ta)


def loads_of(driven, lengths, sign, given, bodies, applied, gravity):
    """
    Return the values of LOADS, forces as mpc.

    Unknown: F41, F21, N, slot couple, guide and its couple, drive.
    """
    pin, (_, (w, _, _), (al, sa, _)) = exact(driven, lengths, sign, given)
    origin3, of_a = mp.mpc(pin.real, lengths[1]), mp.mpc(-w**2, al) * pin
    frames = ((0, mp.mpc(-w**2, al), pin / lengths[0], al), (of_a, 0, mp.mpc(0, 1), 0),
              (mp.mpc(sa), 0, mp.mpc(1), 0))
    right = []
    for i, ((mass, along, across, inertia), (origin, spin, frame,
                                             alpha)) in enumerate(zip(bodies, frames)):
        force_x, force_y, at_along, at_across, couple = (*applied, (0,) * 5)[(i - 1) % 3]
        centre, push = frame * mp.mpc(along, across), mp.mpc(force_x, force_y)
        needed = mass * (origin + spin * centre - mp.mpc(*gravity))
        right += [(needed - push).real, (needed - push).imag, inertia * alpha - couple
                  + cross(centre, needed)
                  - cross(frame * mp.mpc(at_along, at_across), push)]
    m = mp.zeros(9, 9)
    # crank: F41 + F21, moment of F21
    m[0, 0] = m[1, 1] = m[0, 2] = m[1, 3] = 1
    m[2, 2], m[2, 3] = -pin.imag, pin.real
    # block: F12 + N along x, couple (5)
    m[3, 2] = m[4, 3] = -1
    m[3, 4] = m[5, 5] = 1
    arm = pin - origin3
    # yoke: minus both; guide (6), couple (7)
    m[6, 4], m[8, 4], m[8, 5] = -1, arm.imag, -1
    m[7, 6] = m[8, 7] = 1
    m[2 if driven == 'crank' else 6, 8] = 1
    f = mp.lu_solve(m, mp.matrix(right))
    push = 0 if driven == 'crank' else f[8]
    f41, f21, f43 = mp.mpc(f[0], f[1]), mp.mpc(f[2], f[3]), mp.mpc(push, f[6])
    moment = -f[7] - cross(origin3, f43) - (f[8] if driven == 'crank' else 0)
    return f41, f21, mp.mpc(f[4]), f43, f[6], f[7], f[5], f[8], -f41 - f43, moment
