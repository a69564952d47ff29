# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a careful user would write, for comparison, in doubles; fourbar_ros/plain.py is the textbook.

``m`` is where sin, cos, sqrt, acos, atan2 come from: :data:`SCALAR` or :data:`ARRAY`.
"""
import math
from types import SimpleNamespace

import numpy as np

SCALAR = SimpleNamespace(sin=math.sin, cos=math.cos, sqrt=math.sqrt, acos=math.acos,
                         atan2=math.atan2)
ARRAY = SimpleNamespace(sin=np.sin, cos=np.cos, sqrt=np.sqrt, acos=np.arccos, atan2=np.arctan2)


def coordinates(lengths, sign, x, m=ARRAY):
    """
    Return y, b, y', b', y'', b'': output and coupler angle and their derivatives by theta1 = x.

    Two circles are intersected for B; rates and accelerations are from the differentiated loop.
    """
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
