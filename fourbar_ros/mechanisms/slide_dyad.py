"""
The triangle of which one side slides: the dyad of every mechanism that is driven by its slide.

A slider-crank driven by its slider, and, for an observer on its bar, an inverted one driven by its
cylinder.
"""
from __future__ import annotations

from math import frexp, fsum, ldexp, sqrt

from fourbar_ros.numerics.dialects import dialects, where
from fourbar_ros.mechanisms.four_bar.half_angle import difference_of_squares
from fourbar_ros.mechanisms.four_bar.motion import INFINITESIMAL


@dialects
def make_triangle(a1, a2, e, sign):
    """
    Return the function s -> angles x, b of a1 e^{ix} + a2 e^{ib} = s + i e, and their derivatives.

    With q = s^2 + e^2, f = a1^2 - a2^2, theta2 = b - x as the 4R's mu (:mod:`fourbar_ros.mechanisms.four_bar.motion`):

        (2 a1 a2 sin theta2)^2 = (K+ - s^2)(s^2 - K-),   K+- = (a1 +- a2)^2 - e^2
        theta2'' = 2 (K+ K- - s^4) / (2 a1 a2 sin theta2)^3
        x' = cos b / (a1 sin theta2),   b' = -cos x / (a2 sin theta2),   theta2' = -s / (a1 a2 sin theta2)
        x'' = (2 e - f theta2') s/q^2 - theta2'' (q - f)/(2 q),   b'' = ... + theta2'' (q + f)/(2 q)

    All is computed from the smaller of u = K+ - s^2 and w = s^2 - K-, as u + w = 4 a1 a2. Of links of very
    different length both are small beside s^2: hence q + f = 2 a1 (a1 + a2) - u = 2 a1 (a1 - a2) + w, and
    K+ K- - s^4 = s^2 (u - w) - u w where s^2 > 4 a1 a2.

    ``sign``: of sin(theta2). Lengths within a few powers of two of one. At s = 0 of a change point the
    values are those for s -> 0 from above.
    """
    def triangle(s, sign=sign, e=e, ee=e * e, f=(a1 - a2) * (a1 + a2), two_e=2.0 * e, two_1=2.0 * a1,
                 two_2=2.0 * a2, outer=difference_of_squares(a1, a2, e, 0.0),
                 inner=difference_of_squares(a1, -a2, e, 0.0),
                 product=difference_of_squares(a1, a2, e, 0.0) * difference_of_squares(a1, -a2, e, 0.0),
                 total=4.0 * a1 * a2, per=0.25 / (a1 * a2), half_1=0.5 / a1, half_2=0.5 / a2,
                 stretched_1=2.0 * a1 * (a1 + a2), stretched_2=2.0 * a2 * (a1 + a2),
                 folded_1=2.0 * a1 * (a1 - a2), folded_2=2.0 * a2 * (a2 - a1)):
        s = s + INFINITESIMAL
        square = s * s
        q = square + ee
        u, w = outer - square, square - inner
        # their sum is given: so the rounding of one is that of the other, as in the shape of a triangle
        u, w, more, less = where(u.real < w.real, (u, total - u, stretched_1 - u, stretched_2 - u),
                                 (total - w, w, folded_1 + w, folded_2 + w))
        root = sign * sqrt(u * w)
        cos_2, sin_2 = (w - u) * per + 0.0 * root, 2.0 * root * per
        per_q, scale = 1.0 / q, 1.0 / root
        more, less = more * per_q, less * per_q     # q + f, q - f
        turn = root * per_q
        cos_x, sin_x = (s * more + e * turn) * half_1, (e * more - s * turn) * half_1
        cos_b, sin_b = (s * less - e * turn) * half_2, (e * less + s * turn) * half_2
        dx, db, d2 = two_2 * cos_b * scale, -two_1 * cos_x * scale, -2.0 * s * scale
        bend = where(square.real < total, product - square * square, square * (u - w) - u * w)
        dd2 = 2.0 * bend * scale * scale * scale
        common, half = (two_e - f * d2) * s * per_q * per_q, 0.5 * dd2
        return (cos_x, sin_x, cos_b, sin_b, cos_2, sin_2, dx, db, d2,
                common - half * less, common + half * more, dd2, scale)
    return triangle


def power_of_two(*lengths):
    """Return the power of two in units of which the largest length is between one and two [m]."""
    return ldexp(0.5, frexp(max(map(abs, lengths)))[1])


def closes(p, r, e):
    """Return whether the triangle of :func:`make_triangle` closes for some s."""
    return fsum((p, r, -abs(e))) > 0.0


def margins(p, r, e):
    """Return r - p - |e| and p - r - |e| [m], which are zero at change points."""
    return fsum((r, -p, -abs(e))), fsum((p, -r, -abs(e)))


def reach(p, r, e):
    """Return (inner, outer) distances squared, minus e^2: (p - r)^2 - e^2 and (p + r)^2 - e^2 [m^2]."""
    return difference_of_squares(p, -r, e, 0.0), difference_of_squares(p, r, e, 0.0)


def slide_ranges(p, r, e):
    """Return the ranges of s in which the triangle of :func:`make_triangle` closes, from below [m]."""
    unit = power_of_two(p, r, e)
    inner, outer = reach(p / unit, r / unit, e / unit)
    far = unit * sqrt(outer)
    if inner <= 0.0:
        return ((-far, far),)
    near = unit * sqrt(inner)
    return ((-far, -near), (near, far))


def singular_slides(p, r, e):
    """Return the complex s where that triangle is flat, and those where it has no side q [m]."""
    unit = power_of_two(p, r, e)
    roots = [complex(unit * sqrt(k)) if k >= 0.0 else complex(0.0, unit * sqrt(-k))
             for k in reach(p / unit, r / unit, e / unit)]
    return [*roots, *(-z for z in roots if z.imag == 0.0 != z.real), *([complex(0.0, e)] if e else [])]
