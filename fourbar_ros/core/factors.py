"""
The bilinear factors of the six input-output equations, exact to the last bit.

Every coefficient of Eqs. (16)-(21) of the slides is a product of two sums +-a1 +-a2 +-a3 +-a4. Near a
change point one of these sums cancels; computed with ``math.fsum`` it keeps all its digits, and with
it everything that is built of products and of sums without cancellation.
"""
from __future__ import annotations

from math import fsum


def half_angle_coefficients(a1, a2, a3, a4):
    """
    Return A, B, C, D, M of the half-angle quadratic of one angle of a loop.

    In |a4 - a1 e^{ix} + a3 e^{iy}| = a2 the half-angle t = tan(y/2) solves p t^2 - 2 m t + r = 0 with
    p = A sh^2 + C ch^2, r = B sh^2 + D ch^2, m = M sh ch, where sh, ch = sin, cos(x/2): Eq. (16) of
    the slides, homogeneous in tan(x/2). Its discriminant is m^2 - p r = (2 a2 a3 sin mu)^2. Negative
    or exchanged lengths turn the same equation into those of the other pairs of angles.

    Returns
    -------
    tuple of 5 floats
        [m^2]

    """
    return (fsum((a1, -a2, -a3, a4)) * fsum((a1, a2, -a3, a4)),
            fsum((a1, -a2, a3, a4)) * fsum((a1, a2, a3, a4)),
            fsum((a1, -a2, a3, -a4)) * fsum((a1, a2, a3, -a4)),
            fsum((a1, a2, -a3, -a4)) * fsum((a1, -a2, -a3, -a4)),
            4.0 * a1 * a3)


def difference_of_squares(a, b, c, d):
    """Return (a + b)^2 - (c + d)^2 from its two factors [m^2]."""
    return fsum((a, b, c, d)) * fsum((a, b, -c, -d))
