# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What textbooks and the seeds do, for comparison: each formula as printed, in doubles, without care.

``m`` is where sin, cos, sqrt, acos, atan2 come from: :data:`SCALAR` or :data:`ARRAY`. All
functions return y, b, y', b', y'', b'' (output and coupler angle and their derivatives by theta1 =
x).
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
