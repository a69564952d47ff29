# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Where the kinds close and where their formulas have poles, in closed form."""
from collections.abc import Iterable
from math import asin, asinh, atan2, atanh, log1p, pi, sqrt

from fourbar_ros.mechanisms.parts import Ranges
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.number_types import exact_sum, power_of_two, REAL, scaled


def singular_angles(a1: float, a2: float, a3: float, a4: float) -> list[complex]:
    """Return the complex angles from a4 to a1 at which a2 and a3 are in line, or A meets O4."""
    # Real ones are the ends of the ranges, to the last bit: cos^2(x/2) = -s1 / (4 a1 a4),
    # sin^2(x/2) = -s2 / (4 a1 a4); the last is q = 0.
    a1, a2, a3, a4 = scaled((a1, a2, a3, a4))
    root, squares = 2.0 * sqrt(a1 * a4), REAL.difference_of_squares
    # (M3) in loop.py
    s1, c1 = squares(a2, a3, a1, a4), squares(a2, a3, a1, -a4)
    s2, c2 = squares(a1, -a4, a2, -a3), squares(a1, a4, a2, -a3)
    outer, inner = sqrt(abs(s1)) / root, sqrt(abs(s2)) / root
    far = (complex(pi, 2.0 * asinh(outer)) if s1 >= 0.0 else
           complex(2.0 * atan2(sqrt(max(c1, 0.0)), sqrt(-s1))))
    near = (complex(0.0, 2.0 * asinh(inner)) if s2 >= 0.0 else
            complex(2.0 * atan2(sqrt(-s2), sqrt(max(c2, 0.0)))))
    return [far, -far, near, -near, complex(0.0, 2.0 * asinh(abs(a1 - a4) / root))]


def four_bar_ranges(a1: float, a2: float, a3: float, a4: float) -> Ranges:
    """Return the ranges (low, high) of the angle between a1 and a4 [rad]."""
    # One range (-pi, pi) when a1 turns fully, one through 0 or one through pi (high > pi), or two.
    # At an end that is no full turn, a2 and a3 are in line (toggle).
    far, _, near, *_ = [z.real for z in singular_angles(a1, a2, a3, a4)]
    if far == pi:
        return ((near, 2.0 * pi - near),) if near else ((-pi, pi),)
    return ((-far, -near), (near, far)) if near else ((-far, far),)


def turned_ranges(ranges: Iterable[tuple[float, float]]) -> Ranges:
    """Return ranges of an angle moved by half a turn, each so that it begins in [-pi, pi)."""
    turned = [(low + turn, high + turn) for low, high in ranges
              for turn in (-pi if low >= 0.0 else pi,)]      # exact beside pi
    return ((-pi, pi),) if turned == [(0.0, 2.0 * pi)] else tuple(sorted(turned))


def turned_angles(angles: Iterable[complex]) -> list[complex]:
    """Return complex angles moved by half a turn, their real parts in (-pi, pi]."""
    return [complex(x.real + (pi if x.real <= 0.0 else -pi), x.imag) for x in angles]


def reach(p: float, r: float, e: float) -> tuple[float, float]:
    """Return (p - r)^2 - e^2 and (p + r)^2 - e^2 [m^2]: s^2 of rods p, r folded, stretched."""
    return REAL.difference_of_squares(p, -r, e, 0.0), REAL.difference_of_squares(p, r, e, 0.0)


def slide_ranges(p: float, r: float, e: float) -> Ranges:
    """Return the ranges of s [m] in which p e^{ix} + r e^{ib} = s + i e, from low to high."""
    # At their ends the rods p and r are in line: toggles.
    near, far, *_ = [z.real for z in singular_slides(p, r, e)]
    return ((-far, -near), (near, far)) if near else ((-far, far),)


def singular_slides(p: float, r: float, e: float) -> list[complex]:
    """Return the complex s [m] where the rods p, r are in line, or s^2 + e^2 = 0, as a list."""
    unit = power_of_two(p, r, e)
    roots = [complex(unit * sqrt(k)) if k >= 0.0 else complex(0.0, unit * sqrt(-k))
             for k in reach(p / unit, r / unit, e / unit)]
    return [*roots, *(-z for z in roots if z.imag == 0.0 != z.real),
            *([complex(0.0, e)] if e else [])]


def rod_ranges(a1: float, a2: float, e: float) -> Ranges:
    """Return the ranges [rad] of a crank a1 whose rod a2 reaches a line in the distance e."""
    # (-pi, pi) of one that turns fully. At other ends the rod is square to the line: toggles.
    a1, a2, e = scaled((a1, a2, e))
    below, above = exact_sum((a2, -e, -a1)), exact_sum((a2, e, -a1))    # a2 -+ n at x = -+ pi/2
    low = atan2(e - a2, sqrt(-below * exact_sum((a2, -e, a1)))) if below < 0.0 else None
    high = atan2(e + a2, sqrt(-above * exact_sum((a2, e, a1)))) if above < 0.0 else None
    if low is None:
        return ((-pi, pi),) if high is None else ((-pi - high, high),)
    return ((low, pi - low),) if high is None else ((low, high), (pi - high, pi - low))


def singular_angles_of_rod(a1: float, a2: float, e: float) -> list[complex]:
    """Return the complex angles of such a crank at which the rod is square to the line."""
    # sin x = (e +- a2)/a1, also beyond +-1, where x is +-pi/2 + i arcosh.
    angles = []
    for r in (a2, -a2):
        side = 1.0 if e + r > 0.0 else -1.0
        excess = exact_sum((side * e, side * r, -a1)) / a1          # |sin x| - 1
        if excess >= 0.0:
            angles.append(complex(side * 0.5 * pi, log1p(excess + sqrt(excess * (2.0 + excess)))))
        else:
            angle = side * (0.5 * pi - 2.0 * asin(sqrt(-0.5 * excess)))
            angles += [complex(angle), complex(pi - angle)]
    return angles


def bar_ranges(a1: float, a4: float, h: float) -> Ranges:
    """Return the ranges [rad] of a crank a1 whose pin reaches a bar, h from its pivot a4 away."""
    # (-pi, pi) of one that turns fully, else one through pi, at whose ends the pin is at the foot.
    low = singular_angles_of_bar(a1, a4, h)[0].real
    return ((low, 2.0 * pi - low),) if low else ((-pi, pi),)


def singular_angles_of_bar(a1: float, a4: float, h: float) -> list[complex]:
    """Return the complex angles of the crank a1 of bar_ranges() at which its motion has poles."""
    # Its pin is there at the foot of the perpendicular on the bar, l = 0 of (B1) in slides.py, or
    # at the bar's pivot, q = 0; both are linear in tan^2(x/2). Of a complex pair one is given.
    a1, a4, h = scaled((a1, a4, h))
    near, far = reach(a1, a4, h)        # l^2 at x = 0 and at x = pi
    pole = complex(0.0, 2.0 * atanh(min(abs(a1 - a4) / (a1 + a4), 1.0 - EPS)))
    if near > 0.0:
        return [complex(0.0, 2.0 * atanh(min(sqrt(near / far), 1.0 - EPS))), pole]
    angle = 2.0 * atan2(sqrt(-near), sqrt(far))
    return [complex(angle), complex(-angle), pole]
