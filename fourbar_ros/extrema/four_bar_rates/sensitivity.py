# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How the output's rate and acceleration of a four-bar change with its lengths, in closed form."""
from __future__ import annotations

from collections.abc import Sequence


def rate_changes(lengths: Sequence[float], motion: Sequence[float], third: float) -> list[float]:
    """
    Return how theta4', theta4'' and theta4''' change with lengths: sum |d/da_i| a_i of each.

    The loop a1 e^ix + a2 e^ib = a4 + a3 e^iy, varied at constant x = theta1 and projected on the
    coupler, gives

        a3 sin(mu) dy = -cos(x-b) da1 - da2 + cos(mu) da3 + cos(b) da4,      mu = y - b.

    With da_i = a_i for one i, and differentiated three times with respect to x, that is what is
    wanted. All four together change nothing.

    Parameters
    ----------
    lengths : tuple of 4 floats
    motion : tuple
        Fields of Motion at unit input rate.
    third : float
        theta4'''.

    """
    a1, a2, a3, a4 = lengths
    y2, _, b1, cos_x, sin_x, cos_b, sin_b, _, _, cos_mu, sin_mu = (motion[11], *motion[16:18],
                                                                   *motion[19:])
    v = 1.0 / sin_mu
    cot, k = cos_mu * v, a1 / a2 * (a4 / a3)
    # mu', mu'', mu''' from the cosine law, cos(mu) = constant + k cos(x); those of x - b by mu
    m1 = k * sin_x * v
    m2 = k * cos_x * v - cot * m1 * m1
    m3 = m1 * (m1 * m1 - 3.0 * cot * m2) - m1
    w1, w2, w3 = 1.0 - b1, m2 - y2, m3 - third
    # derivatives of 1/sin(mu), cot(mu), cos(x-b)
    v1 = -cot * v * m1
    c1 = -v * v * m1
    v2 = -(c1 * v + cot * v1) * m1 - cot * v * m2
    c2 = -2.0 * v * v1 * m1 - v * v * m2
    v3 = -(c2 * v + 2.0 * c1 * v1 + cot * v2) * m1 - 2.0 * (c1 * v + cot * v1) * m2 - cot * v * m3
    c3 = -2.0 * (v1 * v1 + v * v2) * m1 - 4.0 * v * v1 * m2 - v * v * m3
    p, sine = cos_x * cos_b + sin_x * sin_b, sin_x * cos_b - cos_x * sin_b
    p1 = -sine * w1
    p2 = -p * w1 * w1 - sine * w2
    p3 = sine * (w1 * w1 * w1 - w3) - 3.0 * p * w1 * w2
    r1, r2 = a1 / a3, a2 / a3
    changes = []
    for by_1, by_2, by_3 in ((p1 * v + p * v1, v1, c1),
                             (p2 * v + 2.0 * p1 * v1 + p * v2, v2, c2),
                             (p3 * v + 3.0 * (p2 * v1 + p1 * v2) + p * v3, v3, c3)):
        by_1, by_2 = -r1 * by_1, -r2 * by_2
        changes.append(abs(by_1) + abs(by_2) + abs(by_3) + abs(by_1 + by_2 + by_3))
    return changes
