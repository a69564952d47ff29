# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Reference for the two sliders: many digits and another formulation.

Positions from coordinates, rates and accelerations from the differentiated loop as two equations
with two unknowns, loads from nine equations with nine unknowns: nothing here is shared with the
package.
"""
from typing import NamedTuple

from fourbar_ros.mechanisms.sliders import InvertedSlider, SliderCrank
import mpmath as mp
from support.reference import cross

KINDS = ((SliderCrank, 'crank'), (SliderCrank, 'slide'), (InvertedSlider, 'crank'),
         (InvertedSlider, 'slide'))
FIELDS = {SliderCrank: ('theta1', 'beta', 'slide', 'theta2', 'omega1', 'omega_beta',
                        'slide_velocity', 'omega2',
                        'alpha1', 'alpha_beta', 'slide_acceleration', 'alpha2'),
          InvertedSlider: ('theta1', 'theta4', 'slide', 'theta2', 'omega1', 'omega4',
                           'slide_velocity', 'omega2',
                           'alpha1', 'alpha4', 'slide_acceleration', 'alpha2')}
LOADS = ('f41', 'f21', 'f32', 'f43', 'guide_force', 'guide_couple', 'drive', 'shaking_force',
         'shaking_moment')


class Exact(NamedTuple):
    """Crank angle, angle of the other turning link and slide, with rates, accelerations."""

    angle: tuple
    rate: tuple
    acceleration: tuple


def solve(one, other, right):
    """Solve one p + other r = right for real p, r."""
    area = cross(one, other)
    return cross(right, other) / area, cross(one, right) / area


def slider_crank(lengths, is_crank, sign, given):
    a1, a2, e = lengths
    q, v, a = given
    if is_crank:
        x, rise = q, e - a1 * mp.sin(q)
        if abs(rise) >= a2:
            return None
        coupler = mp.mpc(sign * mp.sqrt(a2**2 - rise**2), rise)
        crank = a1 * mp.expj(x)
        s = (crank + coupler).real
    else:
        s, line = q, mp.mpc(q, e)
        square = line.real**2 + line.imag**2
        along = (square + a1**2 - a2**2) / (2 * square)
        height = a1**2 / square - along**2
        if height <= 0:
            return None
        crank = line * mp.mpc(along, -sign * mp.sqrt(height))
        coupler, x = line - crank, mp.arg(crank)
    if is_crank:        # 1j crank v + 1j coupler w = u
        w, u = solve(1j * coupler, mp.mpc(-1), -1j * crank * v)
        wa, ua = solve(1j * coupler, mp.mpc(-1), -1j * crank * a + crank * v**2 + coupler * w**2)
        return Exact((x, mp.arg(coupler), s), (v, w, u), (a, wa, ua))
    o, w = solve(1j * crank, 1j * coupler, mp.mpc(v))
    oa, wa = solve(1j * crank, 1j * coupler, mp.mpc(a) + crank * o**2 + coupler * w**2)
    return Exact((x, mp.arg(coupler), s), (o, w, v), (oa, wa, a))


def inverted_slider(lengths, is_crank, sign, given):
    a1, a4, h = lengths
    q, v, a = given
    if is_crank:
        crank = a1 * mp.expj(q)
        line = crank - a4
        square = line.real**2 + line.imag**2 - h**2
        if square <= 0:
            return None
        x, slide = q, sign * mp.sqrt(square)
    else:
        slide = q
        cosine = (a1**2 + a4**2 - slide**2 - h**2) / (2 * a1 * a4)
        if abs(cosine) >= 1:
            return None
        crank = a1 * mp.mpc(cosine, sign * mp.sqrt(1 - cosine**2))
        line, x = crank - a4, mp.arg(crank)
    turn = line / mp.mpc(slide, h)
    turn /= abs(turn)
    if is_crank:        # 1j crank o = 1j line w + turn u
        w, u = solve(1j * line, turn, 1j * crank * v)
        wa, ua = solve(1j * line, turn, 1j * crank * a - crank * v**2 + line * w**2
                       - 2j * w * u * turn)
        return Exact((x, mp.arg(turn), slide), (v, w, u), (a, wa, ua))
    o, w = solve(1j * crank, -1j * line, v * turn)
    oa, wa = solve(1j * crank, -1j * line, a * turn + crank * o**2 - line * w**2
                   + 2j * w * v * turn)
    return Exact((x, mp.arg(turn), slide), (o, w, v), (oa, wa, a))


def exact(kind, lengths, sign, given):
    """Return the Exact of a kind (type, input), or None at a toggle or out of range."""
    function = slider_crank if kind[0] is SliderCrank else inverted_slider
    return function([mp.mpf(v) for v in lengths], kind[1] == 'crank', sign,
                    [mp.mpf(v) for v in given])


def fields_of(kind, lengths, sign, given):
    """Return the values of FIELDS, theta2 wrapped."""
    e = exact(kind, lengths, sign, given)
    theta2 = mp.arg(mp.expj(e.angle[1] - e.angle[0]))
    return (*e.angle, theta2, *e.rate, e.rate[1] - e.rate[0], *e.acceleration,
            e.acceleration[1] - e.acceleration[0])


def loads_of(kind, lengths, sign, given, bodies, applied, gravity):
    """
    Return the values of LOADS, forces as mpc.

    Newton-Euler of three free bodies, solved as one system.

    Rows: for each link two of force and one of moment about its first joint. Unknown: F41, F21,
    two numbers for F32, two for F43 (one force of a guide is a number and a couple), the drive.
    """
    is_slider_crank, is_crank = kind[0] is SliderCrank, kind[1] == 'crank'
    e = exact(kind, lengths, sign, given)
    crank_end, turn = lengths[0] * mp.expj(e.angle[0]), mp.expj(e.angle[1])
    of_a = mp.mpc(-e.rate[0]**2, e.acceleration[0]) * crank_end
    spins = [mp.mpc(-w**2, a) for w, a in zip(e.rate[:2], e.acceleration[:2])]
    if is_slider_crank:
        arm = lengths[1] * turn
        frames = ((0, spins[0], mp.expj(e.angle[0])), (of_a, spins[1], turn),
                  (mp.mpc(e.acceleration[2]), 0, mp.mpc(1)))
        spin3, axis, origin3 = 0, mp.mpc(1), mp.mpc(e.angle[2], lengths[2])
    else:
        arm = crank_end - lengths[1]      # O4 to A
        frames = ((0, spins[0], mp.expj(e.angle[0])), (of_a, spins[1], turn), (0, spins[1], turn))
        spin3, axis, origin3 = e.acceleration[1], turn, mp.mpc(lengths[1])
    right, forces = [], []
    for i, ((mass, along, across, inertia), (origin_a, spin,
                                             frame)) in enumerate(zip(bodies, frames)):
        force_x, force_y, at_along, at_across, couple = (*applied, (0,) * 5)[(i - 1) % 3]
        centre, push = frame * mp.mpc(along, across), mp.mpc(force_x, force_y)
        needed = mass * (origin_a + spin * centre - mp.mpc(*gravity))
        alpha = (e.acceleration[0], e.acceleration[1], spin3)[i]
        right += [(needed - push).real, (needed - push).imag, inertia * alpha - couple
                  + cross(centre, needed)
                  - cross(frame * mp.mpc(at_along, at_across), push)]
        forces.append(needed - push)
    m = mp.zeros(9, 9)
    m[0, 0] = m[1, 1] = m[0, 2] = m[1, 3] = 1                        # crank: F41 + F21
    m[2, 2], m[2, 3] = -crank_end.imag, crank_end.real
    m[3, 2] = m[4, 3] = -1                                           # second link: F12 + F32
    normal = 1j * axis
    if is_slider_crank:
        m[3, 4] = m[4, 5] = 1
        m[5, 4], m[5, 5] = -arm.imag, arm.real
        # slider: F23 + guide (6) and couple (7)
        m[6, 4] = m[7, 5] = -1
        m[6, 6], m[7, 6], m[8, 7] = normal.real, normal.imag, 1
        if not is_crank:
            m[6, 8], m[7, 8] = axis.real, axis.imag
    else:
        # block: guide (4) and couple (5) at A
        m[3, 4], m[4, 4], m[5, 5] = normal.real, normal.imag, 1
        m[6, 4], m[7, 4], m[8, 5], m[8, 4] = -normal.real, -normal.imag, -1, -cross(arm, normal)
        m[6, 6] = m[7, 7] = 1                                        # bar: F43
        if not is_crank:
            m[3, 8], m[4, 8] = axis.real, axis.imag
            m[6, 8], m[7, 8], m[8, 8] = -axis.real, -axis.imag, -cross(arm, axis)
    if is_crank:
        m[2, 8] = 1
    f = mp.lu_solve(m, mp.matrix(right))
    drive = f[8] * axis if not is_crank else 0
    f41, f21 = mp.mpc(f[0], f[1]), mp.mpc(f[2], f[3])
    if is_slider_crank:
        f32, guide, couple = mp.mpc(f[4], f[5]), f[6], f[7]
        f43 = guide * normal + drive
        on_ground = -couple
    else:
        guide, couple, f43 = f[4], f[5], mp.mpc(f[6], f[7])
        f32, on_ground = guide * normal + drive, 0
    moment = on_ground - cross(origin3, f43) - (f[8] if is_crank else 0)
    return f41, f21, f32, f43, guide, couple, f[8], -f41 - f43, moment
