"""
The extremes of the output's rate and acceleration at constant input speed: fast, one linkage or many.

With x = theta1, y = theta4, b = beta and u the elliptic parameter of :mod:`.elliptic`, the derivatives

    X = dx/du = a2 a3 sin(y-b),    Y = dy/du = a1 a2 sin(x-b),    B = db/du = a1 a3 sin(x-y)

are sines, and so dy/dx = Y/X, d2y/dx2 = g/X^3 and d3y/dx3 = k/X^5 with g = Y_u X - Y X_u and k = g_u X -
3 g X_u, which are smooth everywhere, toggles included. The roots of g are the extremes of theta4', those of k
the extremes of theta4''. No pair of roots of g can hide between two samples: a root of k lies between them.
"""
from __future__ import annotations

from functools import cache
from math import cos, fabs, fsum, pi, sin, sqrt
from types import FunctionType

import numpy as np

from .dialects import dialects, where
from .factors import difference_of_squares, half_angle_coefficients


@dialects
def sines(sh, ch, constants):
    """
    Return g, k, X, Y at sh, ch = sin, cos(theta1/2); the pose as in :func:`.kinematics.make_motion`.

    ``constants``: the sixteen of :func:`sine_constants`.
    """
    s1, s2, k, yA, yB, yC, yD, yM, bA, bB, bC, bD, bM, a12, a13, sign = constants
    ss, cc, sc = sh * sh, ch * ch, sh * ch
    u, w = s1 + k * cc, s2 + k * ss
    root = sign * sqrt(fabs(u * w))       # at a toggle u or w may round to less than zero
    m = yM * sc
    n, d = where(m * root > 0.0, (yB * ss + yD * cc, m + root), (m - root, yA * ss + yC * cc))
    scale = a13 / (n * n + d * d)
    cB, B = (d - n) * (d + n) * scale, -2.0 * n * d * scale
    m = bM * sc
    n, d = where(m * root < 0.0, (bB * ss + bD * cc, m - root), (m + root, bA * ss + bC * cc))
    scale = a12 / (n * n + d * d)
    cY, Y = (d - n) * (d + n) * scale, -2.0 * n * d * scale
    cX, X = 0.25 * (u - w), 0.5 * root
    YB, XB = Y - B, X - B
    Xu, Yu, Bu = cX * YB, cY * XB, cB * (X - Y)
    g = Yu * X - Y * Xu
    Xuu, Yuu = cX * (Yu - Bu) - X * YB * YB, cY * (Xu - Bu) - Y * XB * XB
    return g, (Yuu * X - Y * Xuu) * X - 3.0 * g * Xu, X, Y
