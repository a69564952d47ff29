# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What textbooks and the seeds do, for comparison: each formula as printed, in doubles, without care.

``m`` is where sin, cos, sqrt, acos, atan2 come from: :data:`SCALAR` or :data:`ARRAY`. The first
two return y, b, y', b', y'', b'' (output and coupler angle and their derivatives by theta1 = x).
"""
import math
from types import SimpleNamespace

import numpy as np

SCALAR = SimpleNamespace(sin=math.sin, cos=math.cos, sqrt=math.sqrt, acos=math.acos,
                         atan2=math.atan2)
ARRAY = SimpleNamespace(sin=np.sin, cos=np.cos, sqrt=np.sqrt, acos=np.arccos, atan2=np.arctan2)


def law_of_cosines(lengths, sign, x, m=ARRAY):
    """Angle at O4 by acos, coupler by atan2, rates and accelerations along the links."""
    a1, a2, a3, a4 = lengths
    ax, ay = a1 * m.cos(x), a1 * m.sin(x)
    square = a1 * a1 + a4 * a4 - 2.0 * a1 * a4 * m.cos(x)
    y = m.atan2(ay, ax - a4) - sign * m.acos((a3 * a3 + square - a2 * a2)
                                             / (2.0 * a3 * m.sqrt(square)))
    b = m.atan2(a3 * m.sin(y) - ay, a4 + a3 * m.cos(y) - ax)
    sine, cosine = m.sin(y - b), m.cos(y - b)
    dy, db = a1 * m.sin(x - b) / (a3 * sine), a1 * m.sin(x - y) / (a2 * sine)
    ddy = (a1 * m.cos(x - b) + a2 * db * db - a3 * dy * dy * cosine) / (a3 * sine)
    ddb = (a1 * m.cos(x - y) + a2 * db * db * cosine - a3 * dy * dy) / (a2 * sine)
    return y, b, dy, db, ddy, ddb


def coordinates(lengths, sign, x, m=ARRAY):
    """Intersect two circles for B; rates and accelerations from the differentiated loop."""
    a1, a2, a3, a4 = lengths
    ax, ay = a1 * m.cos(x), a1 * m.sin(x)
    dx, dy = a4 - ax, -ay
    square = dx * dx + dy * dy
    along = (square + a2 * a2 - a3 * a3) / (2.0 * square)
    across = sign * m.sqrt(a2 * a2 / square - along * along)
    ux, uy = along * dx - across * dy, along * dy + across * dx     # A to B
    wx, wy = ux - dx, uy - dy                                       # O4 to B
    area = ux * wy - uy * wx
    rate_y, rate_b = (ux * ay - uy * ax) / area, (wx * ay - wy * ax) / area
    px = ax + ux * rate_b * rate_b - wx * rate_y * rate_y
    py = ay + uy * rate_b * rate_b - wy * rate_y * rate_y
    return (m.atan2(wy, wx), m.atan2(uy, ux), rate_y, rate_b,
            (ux * px + uy * py) / area, (wx * px + wy * py) / area)


def free_bodies(lengths, motion, x, omega, alpha, bodies, applied, gravity, m=ARRAY):
    """
    Yield the free body of crank, coupler and output link.

    Sum of joint forces (x, y), their moment about the CG, then the CG and the other joint from
    the first joint (O1, A, O4).
    """
    y, b, dy, db, ddy, ddb = motion
    rates = (omega, alpha), (db * omega, db * alpha + ddb * omega * omega), (dy * omega,
                                                                             dy * alpha + ddy
                                                                             * omega * omega)
    at = 0.0, 0.0
    for i, ((mass, along, across,
             inertia), angle, (rate, second)) in enumerate(zip(bodies, (x, b, y), rates)):
        c, s = m.cos(angle), m.sin(angle)
        gx, gy, ex, ey = (along * c - across * s, along * s + across * c, lengths[i] * c,
                          lengths[i] * s)
        ox, oy = at if i == 1 else (0.0, 0.0)
        fx = mass * (ox - second * gy - rate * rate * gx - gravity[0])
        fy = mass * (oy + second * gx - rate * rate * gy - gravity[1])
        moment = inertia * second
        if i and applied:
            px, py, on, off, couple = applied[i - 1]
            rx, ry = on * c - off * s - gx, on * s + off * c - gy
            fx, fy, moment = fx - px, fy - py, moment - couple - (rx * py - ry * px)
        at = -second * ey - rate * rate * ex, second * ex - rate * rate * ey
        yield fx, fy, moment, gx, gy, ex, ey


def nine_by_nine(lengths, motion, x, omega, alpha, bodies, applied=(), gravity=(0.0, 0.0),
                 m=ARRAY):
    """
    Return F41, F21, F32, F43 (x, y each) and T41 on the last axis: the paper's Eq.

    (9), numpy's solve.
    """
    matrix, right = np.zeros((*np.shape(x), 9, 9)), np.zeros((*np.shape(x), 9))
    links = free_bodies(lengths, motion, x, omega, alpha, bodies, applied, gravity, m)
    for i, (fx, fy, moment, gx, gy, ex, ey) in enumerate(links):
        arms = [(-gx, -gy), (ex - gx, ey - gy)]
        if i == 2:
            arms.reverse()     # F32 acts at the end of the output link, F43 at its origin O4
        for column, sign, (rx, ry) in zip((2 * i, 2 * i + 2), (1.0 if i == 0 else -1.0, 1.0),
                                          arms):
            matrix[..., 3 * i, column] = matrix[..., 3 * i + 1, column + 1] = sign
            matrix[..., 3 * i + 2, column] = -sign * ry
            matrix[..., 3 * i + 2, column + 1] = sign * rx
        right[..., 3 * i], right[..., 3 * i + 1], right[..., 3 * i + 2] = fx, fy, moment
    matrix[..., 2, 8] = 1.0
    return np.linalg.solve(matrix, right[..., None])[..., 0]


FIELDS = ('theta4', 'beta', 'omega4', 'omega_beta', 'alpha4', 'alpha_beta', 'f41_x', 'f41_y',
          'f21_x', 'f21_y',
          'f32_x', 'f32_y', 'f43_x', 'f43_y', 'driving_torque')


def textbook(lengths, sign, bodies, x, w, acc, m=ARRAY):
    """
    Return :data:`FIELDS` at theta1 = x, omega1 = w, alpha1 = acc: the batch to beat.

    In as few operations as a careful user would write: diagonal and law of cosines, directions by
    projection, Cramer's rule for the rates, for the accelerations and for the force at B. Links
    with their centre of gravity on their line, without gravity. ``bodies``: (mass, cg_along, _,
    inertia) each.
    """
    (a1, a2, a3, a4), ((m1, c1, _, i1), (m2, c2, _, i2), (m3, c3, _, i3)) = lengths, bodies
    cx, sx = m.cos(x), m.sin(x)
    ax, ay = a1 * cx, a1 * sx
    q = a1 * a1 + a4 * a4 - 2.0 * a4 * ax
    y = m.atan2(ay, ax - a4) - sign * m.acos((a3 * a3 - a2 * a2 + q) / (2.0 * a3 * m.sqrt(q)))
    cy, sy = m.cos(y), m.sin(y)
    cb, sb = (a4 - ax + a3 * cy) / a2, (a3 * sy - ay) / a2
    b = m.atan2(sb, cb)
    c, s = cy * cb + sy * sb, sy * cb - cy * sb
    wy, wb = w * (sx * cb - cx * sb) * a1 / (a3 * s), w * (sx * cy - cx * sy) * a1 / (a2 * s)
    px, py = -acc * ay - w * w * ax, acc * ax - w * w * ay     # acceleration of A
    of_b, of_y = a2 * wb * wb, a3 * wy * wy
    ey = (of_b - px * cb - py * sb - of_y * c) / (a3 * s)
    eb = (of_b * c - of_y - px * cy - py * sy) / (a2 * s)
    f2x, f2y = m2 * (px - c2 * (eb * sb + wb * wb * cb)), m2 * (py + c2 * (eb * cb - wb * wb * sb))
    m2a, m3o = i2 * eb + c2 * (cb * f2y - sb * f2x), (i3 + m3 * c3 * c3) * ey
    p, r = m3o / (a3 * s), m2a / (a2 * s)
    f32x, f32y = p * cb + r * cy, p * sb + r * sy
    f21x, f21y = f32x - f2x, f32y - f2y
    f43x, f43y = (f32x - m3 * c3 * (ey * sy + wy * wy * cy),
                  f32y + m3 * c3 * (ey * cy - wy * wy * sy))
    f41x, f41y = m1 * c1 / a1 * px - f21x, m1 * c1 / a1 * py - f21y
    torque = (i1 + m1 * c1 * c1) * acc - ax * f21y + ay * f21x
    return y, b, wy, wb, ey, eb, f41x, f41y, f21x, f21y, f32x, f32y, f43x, f43y, torque
